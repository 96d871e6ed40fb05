//! Compares two parts from Gmsh with CalculiX 2.20 on the same nodes;
//! `tests/data/calculix/make.py` computes its numbers.

use crate::common::*;

/// Row of `results.csv`.
struct Row {
    scene: &'static str,
    method: &'static str,
    displacement: Vector2<f64>,
    /// Position of a node, in units of the mesh file; `von_mises` is the stress there, Pa.
    at: [f64; 2],
    von_mises: f64,
}

fn rows() -> Vec<Row> {
    let rows = include_str!("../data/calculix/results.csv").lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        let displacement = Vector2::new(number(2), number(3));
        Row { scene: cells[0], method: cells[1], displacement, at: [number(4), number(5)], von_mises: number(6) }
    });
    rows.collect()
}

/// Solves the row's scene with CalculiX's load and method.
fn solved_like(row: &Row) -> Simulation {
    let force = if row.scene == "bracket" { "[0,-200]" } else { "[0,-2]" };
    let set = [format!("load.0.force={force}"), format!("solver.method={}", row.method)];
    solved(&scene_with(row.scene, &[&set[0], &set[1]]))
}

/// The results agree to six digits, except in plane stress (CalculiX shears a wedge), in large rotations, and for stresses
/// at the nodes, which the programs recover differently.
#[test]
fn displacements_and_stresses_are_those_of_calculix() {
    let rows = rows();
    assert_eq!(rows.len(), 4);
    for row in rows {
        let simulation = solved_like(&row);
        let solution = simulation.solution();
        let difference = (solution.probes[0].u - row.displacement).norm() / row.displacement.norm();
        let bound = if row.method == "linear" { 5e-5 } else { 0.2 * solution.deformation.max_strain };
        assert!(difference < bound, "{} {}: {difference:.2e}, bound {bound:.2e}", row.scene, row.method);
        let scale = simulation.scene().mesh.as_ref().unwrap().scale.unwrap_or(1.0);
        let node = simulation.system().mesh().nearest_node((row.at.map(|x| x * scale)).into());
        let own = simulation.nodal_stress().cauchy().nth(node as usize).unwrap().unwrap().von_mises();
        let difference = own / row.von_mises - 1.0;
        assert!(difference.abs() < 0.08, "{} {}: {own:.4e} and {:.4e}", row.scene, row.method, row.von_mises);
    }
}

/// Winkler's curved bar under the bending moment of the nose's force in the deformed clip and the force itself.
#[test]
fn the_back_of_the_clip_has_winklers_stress() {
    let simulation = solved(&scene("clip"));
    let (solution, stress) = (simulation.solution(), simulation.stress_result());
    let (force, thickness, inner, outer) = (2.0, 3e-3, 5e-3, 7e-3);
    let [nose, back] = [0, 1].map(|i| &solution.probes[i]);
    let center_of_section = back.x.x - 0.5 * (outer - inner);
    let moment = force * (nose.x.x - center_of_section);
    let (area, middle) = (thickness * (outer - inner), 0.5 * (inner + outer));
    let neutral = (outer - inner) / f64::ln(outer / inner);
    let bending = moment * (neutral - inner) / (area * (middle - neutral) * inner);
    let expected = -(bending + force / area);
    let [xx, yy, _, xy] = stress.probes[1].cauchy.unwrap().components();
    let smallest = 0.5 * (xx + yy) - (0.5 * (xx - yy)).hypot(xy);
    assert!((smallest / expected - 1.0).abs() < 0.05, "{smallest:.4e} Pa, Winkler {expected:.4e} Pa");
}
