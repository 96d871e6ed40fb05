//! What a body does at a material point: F, R and S, strain and stress.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{scene, solved};
use nalgebra::{Matrix2, Vector2};
use warpbeam::mesh::MaterialPoint;
use warpbeam::rotation::Rotation;
use warpbeam::scene::{ElementKind, MethodKind};
use warpbeam::simulation::{Field, Simulation};
use warpbeam::{Material, Scene};

/// A body that is stretched by S and turned by R has F = R S everywhere, and the strain S − I makes its stress.
#[test]
fn a_turned_and_stretched_body_has_its_f_r_and_s_at_every_point() {
    let rotation = Rotation::from_angle(1.1);
    let stretch = Matrix2::new(1.2, 0.07, 0.07, 0.9);
    let f = rotation.matrix() * stretch;
    for element in ElementKind::all() {
        let scene = Scene::beam(3.0, 1.0).with_cells(3, 2).with_element(element);
        let scene = scene.with_material(Material::new(1e5, 0.25)).moving(warpbeam::IntegratorKind::TrBdf2, 0.01);
        let mut simulation = Simulation::new(&scene).unwrap();
        let mesh = simulation.system().mesh().clone();
        let u: Vec<_> = mesh.nodes().iter().map(|x| f * x - x).collect();
        simulation.start_from(&u).unwrap();
        for at in [Vector2::new(0.3, 0.2), Vector2::new(1.6, -0.4), Vector2::new(2.95, 0.01)] {
            let point = simulation.point_state(mesh.locate(at).unwrap()).unwrap();
            assert!((point.rest - at).norm() < 1e-12, "{element:?}");
            assert!((point.displacement - (f * at - at)).norm() < 1e-12, "{element:?}");
            assert!((point.gradient - f).norm() < 1e-12, "{element:?}: {}", point.gradient);
            assert!((point.rotation.angle() - 1.1).abs() < 1e-12, "{element:?}");
            assert!((point.stretch - stretch).norm() < 1e-12, "{element:?}: {}", point.stretch);
            assert!((point.strain.plane - (stretch - Matrix2::identity())).norm() < 1e-9, "{element:?}");
            // Plane stress: T = E/(1 − ν²) ((1 − ν) ε + ν tr ε I), thinned by ε₃₃ = −ν/(1 − ν) tr ε; σ = R T S Rᵀ/J.
            let strain = stretch - Matrix2::identity();
            let biot = (strain * 0.75 + Matrix2::identity() * (0.25 * strain.trace())) * (1e5 / (1.0 - 0.0625));
            let thinned = 1.0 - strain.trace() / 3.0;
            let turned = rotation.matrix() * biot * stretch * rotation.matrix().transpose();
            let stress = turned / (f.determinant() * thinned);
            let stress = (stress + stress.transpose()) * 0.5;
            let own = point.cauchy.unwrap().plane;
            assert!((own - stress).norm() < 1e-7 * stress.norm(), "{element:?}: {own} {stress}");
        }
    }
}

/// The point's numbers are those of the fields that colour the body: recovered ones, and the elements' own.
#[test]
fn a_point_has_the_values_of_the_fields() {
    for (id, method) in
        [("cantilever", MethodKind::Newton), ("bracket", MethodKind::Newton), ("article", MethodKind::Linear)]
    {
        let mut scene = scene(id);
        scene.solver.method = method;
        let simulation = solved(&scene);
        let mesh = simulation.system().mesh();
        let points = mesh.element().entry().points;
        for element in [0, mesh.element_count() / 2, mesh.element_count() - 1] {
            for rule in points {
                let point = MaterialPoint { element, at: rule.at };
                let state = simulation.point_state(point).unwrap();
                let nodal = simulation.nodal_stress();
                for (field, own) in [
                    (Field::VonMises, state.cauchy.unwrap().von_mises()),
                    (Field::LargestStrain, state.largest_strain()),
                ] {
                    let value = field.smooth_at(mesh, &nodal, point).unwrap();
                    assert!((value - own).abs() < 1e-9 * (own.abs() + 1e-6), "{id} {field:?}: {value} {own}");
                }
                let (mut values, own) = (Vec::new(), state.rotation.angle().to_degrees());
                simulation.field(Field::RotationAngle, &mut values);
                let value = Field::raw_at(mesh, &values, point).unwrap();
                let expected = if method == MethodKind::Linear { 0.0 } else { own };
                assert!((value - expected).abs() < 1e-9 * (own.abs() + 1e-6), "{id}: {value} {expected}");
            }
        }
        assert!(simulation.point_state(MaterialPoint { element: mesh.element_count(), at: [0.2, 0.2] }).is_none());
        assert_eq!(Field::raw_at(mesh, &[], MaterialPoint { element: 0, at: [0.2, 0.2] }), None);
    }
}
