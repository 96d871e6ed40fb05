//! Recovered stresses against closed forms, and the estimate of the mesh's error against fine solutions; every element.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix2, Vector2};
use warpbeam::mesh::Mesh;
use warpbeam::rotation::Rotation;
use warpbeam::{Axis, ElementKind, Load, Material, Scene, Simulation, Status};

/// Young's modulus of all scenes here, Pa.
const YOUNG: f64 = 1e6;

/// Cells as fine as their nodes allow: two-noded sides get twice as many.
fn cells(kind: ElementKind, along: u32, across: u32) -> [u32; 2] {
    let pieces = if kind.entry().sides[0].len() == 2 { 2 } else { 1 };
    [along * pieces, across * pieces]
}

fn solved_on(scene: &Scene, mesh: Mesh) -> Simulation {
    let mut simulation = Simulation::with_mesh(scene, mesh).unwrap();
    let status = simulation.solve().clone();
    assert_eq!(status, Status::Converged, "{}", simulation.residual());
    simulation
}

/// Kirsch 1898: stresses of a plate with a hole of radius 1 pulled along x by a unit stress.
fn kirsch(x: Vector2<f64>) -> Matrix2<f64> {
    let (r2, angle) = (x.norm_squared(), x.y.atan2(x.x));
    let (a, b) = (1.0 / r2, 1.0 / (r2 * r2));
    let (c, s) = ((2.0 * angle).cos(), (2.0 * angle).sin());
    let rr = 0.5 * (1.0 - a) + 0.5 * (1.0 - 4.0 * a + 3.0 * b) * c;
    let tt = 0.5 * (1.0 + a) - 0.5 * (1.0 + 3.0 * b) * c;
    let rt = -0.5 * (1.0 + 2.0 * a - 3.0 * b) * s;
    let turn = Rotation::from_angle(angle).matrix();
    turn * Matrix2::new(rr, rt, rt, tt) * turn.transpose()
}

/// A quarter of a ring around the hole, out to four radii, with Kirsch's tractions on all of its sides: no plate need be
/// infinite, no support need be oblique when it is turned.
fn kirsch_plate(kind: ElementKind, cells: [u32; 2], pull: f64, turn: Rotation) -> Simulation {
    let plain = Scene::beam(1.0, 1.0).with_element(kind).with_cells(cells[0], cells[1]);
    let ring = |x: Vector2<f64>| {
        let (r, angle) = (4f64.powf(x.x), FRAC_PI_2 * (x.y + 0.5));
        r * Vector2::new(angle.cos(), angle.sin())
    };
    let mesh = Mesh::beam(plain.beam.as_ref().unwrap()).unwrap().moved(ring).unwrap();
    // Consistent nodal forces of the tractions, by Gauss's three points a side.
    let mut forces = vec![Vector2::zeros(); mesh.nodes().len()];
    let gauss = [(-0.6f64.sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6f64.sqrt(), 5.0 / 9.0)];
    let inside = 2.0 * Vector2::new(PI / 4.0, PI / 4.0).map(f64::cos);
    for side in ["right", "bottom", "top"].iter().flat_map(|edge| &mesh.edges()[*edge]) {
        let x: Vec<Vector2<f64>> = side.nodes().iter().map(|&n| mesh.nodes()[n as usize]).collect();
        for (t, weight) in gauss {
            let (shape, slope) = match x.len() {
                2 => (vec![0.5 - 0.5 * t, 0.5 + 0.5 * t], vec![-0.5, 0.5]),
                _ => (vec![0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)], vec![t - 0.5, -2.0 * t, t + 0.5]),
            };
            let at: Vector2<f64> = x.iter().zip(&shape).map(|(x, w)| x * *w).sum();
            let along: Vector2<f64> = x.iter().zip(&slope).map(|(x, w)| x * *w).sum();
            // The normal times the length, outwards.
            let normal = Vector2::new(along.y, -along.x);
            let normal = normal * normal.dot(&(at - inside)).signum();
            for (&n, w) in side.nodes().iter().zip(&shape) {
                forces[n as usize] += kirsch(at) * normal * (pull * weight * w);
            }
        }
    }
    let mesh = mesh.moved(|x| turn.apply(x)).unwrap();
    let mut scene = Scene::beam(1.0, 1.0).with_element(kind).with_material(Material::new(YOUNG, 0.3));
    let [a, b]: [[f64; 2]; 2] = [[4.0, 0.0], [0.0, 4.0]].map(|x| turn.apply(x.into()).into());
    scene = scene.support(a, &[Axis::X, Axis::Y]).support(b, &[Axis::Y]);
    for (x, force) in mesh.nodes().iter().zip(&forces).filter(|(_, f)| f.norm() > 0.0) {
        scene.loads.push(Load::force([x.x, x.y], turn.apply(*force).into()));
    }
    solved_on(&scene, mesh)
}

#[test]
fn measure_kirsch() {
    for kind in ElementKind::all() {
        for n in [2, 4, 8, 16] {
            let simulation = kirsch_plate(kind, cells(kind, n, n), 1e-6 * YOUNG, Rotation::IDENTITY);
            let nodal = simulation.nodal_stress();
            let mesh = simulation.system().mesh();
            let (mut inner, mut outer, mut count) = (0.0f64, 0.0f64, [0.0; 2]);
            let rim: Vec<u32> = mesh.outline().iter().flat_map(|s| s.nodes().to_vec()).collect();
            let mut concentration = 0.0;
            for (i, (x, stress)) in mesh.nodes().iter().zip(nodal.cauchy()).enumerate() {
                let stress = stress.unwrap().plane / (1e-6 * YOUNG);
                let off = (stress - kirsch(*x)).norm_squared();
                if rim.contains(&(i as u32)) {
                    outer += off;
                    count[1] += 1.0
                } else {
                    inner += off;
                    count[0] += 1.0
                }
                if (x - Vector2::new(0.0, 1.0)).norm() < 1e-9 {
                    concentration = stress.m11;
                }
            }
            let error = simulation.mesh_error(&nodal);
            println!(
                "{kind:?} {n}: K {concentration:.4} inner rms {:.4} outer rms {:.4} zz {:?}",
                (inner / count[0]).sqrt(),
                (outer / count[1]).sqrt(),
                error.percent
            );
        }
    }
}

/// The distance of the elements' strains from those of a fine solution, and their own recovered ones' estimate of it, in
/// the energy norm, percent of the fine solution's.
fn true_and_estimated(scene: &Scene, fine_cells: [u32; 2]) -> (f64, f64, f64) {
    let coarse = common::solved(scene);
    let fine = common::solved(&scene.clone().with_element(ElementKind::T6).with_cells(fine_cells[0], fine_cells[1]));
    let (fine_mesh, fine_nodal) = (fine.system().mesh(), fine.nodal_stress());
    let mesh = coarse.system().mesh();
    let entry = mesh.element().entry();
    let moduli = coarse.problem().material().lame();
    let mut strains = Vec::new();
    let state = coarse.state();
    let elements = coarse.system().elements();
    elements.visit_strains(moduli, state.displacement(), state.rotations(), &mut |_, _, s| strains.push(*s));
    let (mut error, mut energy) = (0.0, 0.0);
    for (own, strains) in mesh.elements().zip(strains.chunks(entry.points.len())) {
        let rest: Vec<_> = own.iter().map(|&n| mesh.nodes()[n as usize]).collect();
        for point in entry.mass_points {
            let area = point.weight * entry.jacobian(&rest, point.at).determinant();
            let x: Vector2<f64> = rest.iter().zip((entry.shape)(point.at)).map(|(x, w)| x * w).sum();
            let at = fine_mesh.weights(fine_mesh.locate(x).unwrap()).unwrap();
            let exact = fine_nodal.mean(&at).strain;
            let found: Matrix2<f64> = strains.iter().zip((entry.point_weights)(point.at)).map(|(s, w)| s * w).sum();
            error += area * moduli.energy_density(&(found - exact));
            energy += area * moduli.energy_density(&exact);
        }
    }
    let tip = |s: &Simulation| s.probe("tip").unwrap_or_default();
    let off = 100.0 * (tip(&coarse) - tip(&fine)).norm() / tip(&fine).norm();
    let guess = warpbeam::study::refined_probes(&coarse).map(|g| g.first().copied().unwrap_or_default());
    if let Ok(guess) = guess {
        let estimate = 100.0 * (tip(&coarse) - guess).norm() / guess.norm();
        println!("    refined: tip off {off:.3} estimate {estimate:.3} effectivity {:.2}", estimate / off);
    } else {
        println!("{guess:?}");
    }
    (100.0 * (error / energy).sqrt(), coarse.mesh_error(&coarse.nodal_stress()).percent.unwrap(), off)
}

#[test]
fn measure_effectivity() {
    for id in ["cantilever", "gravity", "elastica", "roll-up", "incline", "bridge", "article"] {
        let scene = common::scene(id);
        let beam = scene.beam.clone().unwrap();
        for kind in ElementKind::all() {
            for n in [1, 2, 4] {
                let along = 10 * n;
                let across = ((f64::from(along) * beam.height / beam.length).round() as u32).max(1);
                let scene = scene.clone().with_element(kind).with_cells(along, across);
                let fine = [160, ((160.0 * beam.height / beam.length).round() as u32).max(2)];
                let (exact, estimate, tip) = true_and_estimated(&scene, fine);
                println!(
                    "{id} {kind:?} {along}x{across}: true {exact:.3} estimate {estimate:.3} effectivity {:.2} tip {tip:.3}",
                    estimate / exact
                );
            }
        }
    }
    // 65 % off: cells fifty times as long as high.
    for (poisson, along) in [(0.4999, 20), (0.3, 20)] {
        for kind in ElementKind::all() {
            let mut material = Material::new(1e6, poisson);
            material.plane = warpbeam::Plane::Strain;
            let force = 1e6 / 12.0 / (1000.0 * 1000.0) * 0.01;
            let scene = Scene::beam(1000.0, 1.0)
                .with_element(kind)
                .with_cells(along, 1)
                .with_material(material)
                .clamp("left")
                .force("right", [0.0, -force])
                .probe("tip", "right");
            let (exact, estimate, tip) = true_and_estimated(&scene, [400, 2]);
            println!(
                "slender {poisson} {kind:?}: true {exact:.3} estimate {estimate:.3} effectivity {:.2} tip {tip:.3}",
                estimate / exact
            );
        }
    }
}
