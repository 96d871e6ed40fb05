//! Two parts from Gmsh beside CalculiX 2.20 on the same nodes; `tests/data/calculix/make.py` makes its numbers.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{scene_with, solved};
use nalgebra::Vector2;

/// A row of `results.csv`.
struct Row {
    scene: &'static str,
    method: &'static str,
    displacement: Vector2<f64>,
}

fn rows() -> Vec<Row> {
    let table = include_str!("data/calculix/results.csv").lines().skip(1);
    let rows = table.map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let displacement = Vector2::new(cells[2].parse().unwrap(), cells[3].parse().unwrap());
        Row { scene: cells[0], method: cells[1], displacement }
    });
    rows.collect()
}

/// Linear theory is the same theory: to the six digits that CalculiX prints, and to what shear across a thin wedge leaves
/// in plane stress. With large rotations CalculiX's law, Saint-Venant-Kirchhoff's, differs to the order of the strain.
#[test]
fn displacements_are_those_of_calculix() {
    let rows = rows();
    assert_eq!(rows.len(), 4);
    for Row { scene, method, displacement } in rows {
        let force = if scene == "bracket" { "[0,-200]" } else { "[0,-2]" };
        let set = [format!("load.0.force={force}"), format!("solver.method={method}")];
        let solution = solved(&scene_with(scene, &[&set[0], &set[1]])).solution();
        let difference = (solution.probes[0].u - displacement).norm() / displacement.norm();
        let bound = if method == "linear" { 5e-5 } else { 0.2 * solution.deformation.max_strain };
        assert!(difference < bound, "{scene} {method}: {difference:.2e}, bound {bound:.2e}");
    }
}
