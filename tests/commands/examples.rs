//! Tests of the example programs.
#![allow(dead_code, reason = "the examples' own `main` is not called here")]

use crate::common::*;

#[path = "../../examples/figures.rs"]
mod figures;
#[path = "../../examples/game_loop.rs"]
mod game_loop;
#[path = "../../examples/grab.rs"]
mod grab;
#[path = "../../examples/load_curve.rs"]
mod load_curve;
#[path = "../../examples/mesh_study.rs"]
mod mesh_study;
#[path = "../../examples/own_mesh.rs"]
mod own_mesh;
#[path = "../../examples/swing_energy.rs"]
mod swing_energy;
#[path = "../../examples/warped.rs"]
mod warped;

#[test]
fn the_examples_have_their_results() {
    let (finished, tip) = game_loop::play().unwrap();
    // A frame that runs out of time leaves the rest to the next one, on any machine.
    assert!(finished > 0 && tip > 0.1 && tip < 4.0, "{finished} {tip}");
    let report = mesh_study::report("assets/scenes".as_ref()).unwrap();
    assert!(report.contains("stable Some(true)") && report.contains("an error of 1 % costs"), "{report}");
    let (distance, force) = grab::drag().unwrap();
    assert!(distance < 0.05 && force > 1.0 && force.is_finite(), "{distance} {force}");
    let (elements, largest) = own_mesh::hook().unwrap();
    assert_eq!(elements, 144);
    // The section at the crown carries 50 N at a lever of 0.95 m: 6 M / (t h²) = 3.2 kPa without curvature.
    assert!((2e3..8e3).contains(&largest), "{largest}");
    // The method on one page is that of the program.
    let (solved, tip) = (solve_u(&["article", "--set", "solver.tolerance=1e-13"]), warped::tip().unwrap());
    assert!((tip.x - solved.x).hypot(tip.y - solved.y) < 1e-10 * solved.norm(), "{tip:?}, {solved}");
}

#[test]
fn the_load_curve_leaves_linear_theory_where_the_exact_beam_does() {
    let csv = load_curve::curve().unwrap();
    let rows = numbers(&csv);
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
fn the_integrators_lose_different_energies() {
    let lost = |integrator| {
        let ledger = swing_energy::swing(integrator).unwrap();
        assert!(ledger.imbalance().abs() < 1e-9 * ledger.throughput, "{integrator:?} {ledger:?}");
        ledger.integrator
    };
    let [euler, tr_bdf2, conserving] =
        [IntegratorKind::ImplicitEuler, IntegratorKind::TrBdf2, IntegratorKind::EnergyMomentum].map(lost);
    assert!(euler > 10.0 * tr_bdf2.abs() && conserving.abs() < 1e-6, "{euler} {tr_bdf2} {conserving}");
}

/// The figures that take no solve are those of the documents; a changed table changes its figure.
#[test]
fn the_figures_of_the_documents_are_current() {
    let table = std::fs::read_to_string("docs/measurements/performance.md").unwrap();
    for (name, figure) in [("theory-rotation", figures::rotation()), ("front", figures::front(&table))] {
        for (theme, colors) in [("light", &figures::LIGHT), ("dark", &figures::DARK)] {
            let file = format!("assets/{name}-{theme}.svg");
            let kept = std::fs::read_to_string(&file).unwrap();
            assert!(kept == figure.svg(colors), "{file}: `cargo run --example figures --no-default-features` draws it");
        }
    }
}
