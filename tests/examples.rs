//! Tests of the example programs.
#![allow(clippy::unwrap_used, dead_code, reason = "a test may fail; the examples' own `main` is not called here")]

#[path = "../examples/game_loop.rs"]
mod game_loop;
#[path = "../examples/load_curve.rs"]
mod load_curve;
#[path = "../examples/mesh_study.rs"]
mod mesh_study;

#[test]
fn the_game_keeps_its_beam_in_motion() {
    let (finished, tip) = game_loop::play().unwrap();
    // A frame that runs out of time leaves the rest to the next one, on any machine.
    assert!(finished > 0 && tip > 0.1 && tip < 4.0, "{finished} {tip}");
}

#[test]
fn the_load_curve_leaves_linear_theory_where_the_exact_beam_does() {
    let csv = load_curve::curve().unwrap();
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 20);
    for row in &rows {
        let [alpha, linear, newton, exact] = row[..] else { unreachable!("{row:?}") };
        assert!((linear - alpha / 3.0).abs() < 0.01 * alpha, "{row:?}");
        assert!((newton - exact).abs() < 0.002, "{row:?}");
    }
    // Mattiasson 1981 for α = 10.
    assert!((rows[19][3] - 0.8106).abs() < 0.001, "{:?}", rows[19]);
}

#[test]
fn the_mesh_is_studied() {
    let report = mesh_study::report("assets/scenes".as_ref()).unwrap();
    assert!(report.contains("stable Some(true)") && report.contains("an error of 1 % costs"), "{report}");
}
