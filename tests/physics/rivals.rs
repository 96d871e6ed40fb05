//! Compares warpbeam with rapier2d as an independent implementation: both come to rest in the
//! same state on the same mesh.

#[path = "../../src/bin/rivals/rapier.rs"]
mod rapier;

use std::process::Command;

use crate::common::{scene_with, solved, stdout};
use rapier::{Rapier, RapierSolver, Swing};
use warpbeam::assembly::{Problem, System};

/// In plane stress and plane strain, rapier2d's implementation of the same energy has the same equilibrium.
#[test]
fn rapier_rests_where_we_do() {
    for set in [
        &["material.plane=stress"][..],
        &["material.plane=strain", "material.poisson=0.4"],
        &["load.0.force=[-200,-1500]", "material.thickness=0.5"],
    ] {
        let set: Vec<&str> = set.iter().copied().chain(["beam.cells=[20,2]", "solver.method=newton"]).collect();
        let ours = solved(&scene_with("cantilever", &set));
        let end = ours.probe("tip").unwrap();
        let swing = Swing { solver: RapierSolver::Fem, frequency_factor: 0.05, damping: 1.0, cg_iterations: 500 };
        let mut rapier = Rapier::new(ours.problem(), end, swing).unwrap();
        assert_eq!(rapier.displacement().norm(), 0.0);
        for _ in 0..400 {
            rapier.step();
        }
        let error = (rapier.displacement() - end).norm() / end.norm();
        assert!(error < 2e-3, "{set:?}: {} {end}", rapier.displacement());
    }
}

#[test]
fn rapier_refuses_scenes_that_it_cannot_model() {
    let swing = Swing { solver: RapierSolver::Fem, frequency_factor: 0.05, damping: 1.0, cg_iterations: 20 };
    let end = nalgebra::Vector2::new(0.0, 1.0);
    for (id, set) in
        [("roll-up", "beam.element=t3"), ("cantilever", "beam.element=t6"), ("cantilever", "support.0.fix=[\"x\"]")]
    {
        let also = "support=[{edge=\"left\",fix=[\"x\"]},{at=[0,0],fix=[\"y\"]}]";
        let set = if set.starts_with("support") { also } else { set };
        let scene = scene_with(id, &[set]);
        let problem = Problem::new(&scene, System::new(&scene).unwrap().into()).unwrap();
        assert!(Rapier::new(&problem, end, swing).is_none(), "{id} {set}");
    }
}

/// The command measures rapier2d and warpbeam's methods side by side.
#[test]
fn the_program_measures_rivals() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    // One small mesh from a file is the fastest case to measure.
    let mesh = include_str!("../data/square.msh");
    std::fs::write(folder.path().join("square.msh"), mesh).unwrap();
    let scene = "name = \"Square\"\n[mesh]\nfile = \"square.msh\"\n[material]\nyoung = 1e4\npoisson = 0.3\ndensity = 20\n[[support]]\nedge = \"wall\"\n\
        fix = [\"x\", \"y\"]\n[[load]]\nkind = \"gravity\"\nacceleration = [0, -10]\n[[probe]]\nname = \"corner\"\nat = [1, 0]\n";
    let path = folder.path().join("square.toml");
    std::fs::write(&path, scene).unwrap();
    let args = [path.to_str().unwrap(), "--quick", "--out", out];
    let output = Command::new(env!("CARGO_BIN_EXE_rivals")).args(args).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", crate::common::stderr(&output));
    assert!(stdout(&output).contains("rapier2d on the same three-node meshes"));
    let table = std::fs::read_to_string(folder.path().join("rivals.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|l| l.split(',').collect()).collect();
    assert_eq!(rows.iter().map(|r| r[0]).collect::<Vec<_>>(), ["fem", "constraints"]);
    assert!(rows.iter().all(|r| r.len() == 15 && r[4].parse::<f64>().unwrap() > 0.0), "{table}");
    assert!(rows[0][5].parse::<u32>().unwrap() > 0, "fem never rests: {table}");
}
