//! Tests of the values at a material point: F, R and S, strain and stress.

use crate::common::*;

/// A point's values are those of the fields that colour the body: recovered ones, and the elements' own.
#[test]
fn a_point_has_the_values_of_the_fields() {
    for (id, method) in
        [("cantilever", MethodKind::Newton), ("bracket", MethodKind::Newton), ("article", MethodKind::Linear)]
    {
        let simulation = solved(&scene(id).with_method(method));
        let mesh = simulation.system().mesh();
        let points = mesh.element().entry().points;
        for element in [0, mesh.element_count() / 2, mesh.element_count() - 1] {
            for (i, rule) in points.iter().enumerate() {
                let point = MaterialPoint { element, at: rule.at };
                let nodal = simulation.nodal_stress();
                let recovered = simulation.point_state(point, PointValues::Recovered).unwrap();
                let raw = simulation.point_state(point, PointValues::Raw).unwrap();
                let is_of_points = |field: &Field| !field.is_of_elements() && *field != Field::ReferenceDistance;
                for field in Field::ALL.into_iter().filter(is_of_points) {
                    let mut values = Vec::new();
                    simulation.field(field, &mut values);
                    let raw_value = values[element * points.len() + i].unwrap();
                    // The displacement is not recovered.
                    let smooth_value = field.smooth_at(mesh, &nodal, point);
                    assert_eq!(smooth_value.is_none(), field.is_of_displacement(), "{field:?}");
                    for (state, value) in [recovered, raw].iter().zip([smooth_value.unwrap_or(raw_value), raw_value]) {
                        let own = state.field(field).unwrap();
                        let same = (value - own).abs() < 1e-9 * (own.abs() + 1e-6);
                        assert!(same, "{id} {field:?} {:?}: {value} {own}", state.values);
                    }
                }
            }
        }
        let beyond = MaterialPoint { element: mesh.element_count(), at: [0.2, 0.2] };
        assert!(simulation.point_state(beyond, PointValues::Raw).is_none());
    }
}

/// Checks that F, R, S, ε and σ of a point follow from each other by definition.
fn check_consistency(point: &PointState, material: &Material, about: &str) {
    let identity = Matrix2::identity();
    let (f, size) = (point.gradient, 1.0 + point.gradient.norm());
    let strain = if point.is_linear {
        (f + f.transpose()) * 0.5 - identity
    } else {
        // The polar factors of F.
        let r = Rotation::from_angle((f.m21 - f.m12).atan2(f.m11 + f.m22)).matrix();
        assert!((r - point.rotation.matrix()).norm() < 1e-9 * size, "{about}: {r}");
        assert!((r.transpose() * f - point.stretch).norm() < 1e-9 * size, "{about}: {}", point.stretch);
        r.transpose() * f - identity
    };
    assert!((strain - point.strain.plane).norm() < 1e-9 * size, "{about}: {strain} {}", point.strain.plane);
    let largest = strain.symmetric_eigenvalues().amax();
    assert!((largest - point.field(Field::LargestStrain).unwrap()).abs() < 1e-9 * size, "{about}: {largest}");
    // σ = J⁻¹ R T S Rᵀ in plane strain and plane stress; T itself in linear theory.
    let biot = material.lame().stress(&strain);
    let thinned = -strain.trace() * material.poisson / (1.0 - material.poisson);
    let zz = if material.plane == Plane::Strain { 0.0 } else { thinned };
    let stress = if point.is_linear {
        biot
    } else {
        let r = point.rotation.matrix();
        r * biot * point.stretch * r.transpose() / (f.determinant() * (1.0 + zz))
    };
    // An inverted point has no stress.
    let Some(own) = point.cauchy.map(|stress| stress.plane) else {
        return assert!(point.stretch.determinant() <= 0.0 || 1.0 + zz <= 0.0, "{about}: no stress");
    };
    assert!((own - stress).norm() < 1e-7 * (stress.norm() + 1e-3 * material.young), "{about}: {own} {stress}");
}

#[test]
fn the_numbers_of_a_point_follow_from_each_other() {
    let mut scenes = Vec::new();
    for id in ["article", "shear", "cantilever", "bracket", "jelly", "swing"] {
        scenes.extend(scene(id).elements().map(|e| (format!("{id} {e:?}"), scene(id).with_element(e))));
    }
    scenes.push(("linear".to_owned(), scene("article").with_method(MethodKind::Linear)));
    let mut differ = 0;
    for (about, scene) in scenes {
        let mut simulation = Simulation::new(&scene).unwrap();
        // Motions stop halfway; other scenes are solved to equilibrium.
        (0..40).for_each(|_| _ = simulation.step());
        let count = simulation.system().mesh().element_count();
        for (element, at) in [(0, [0.2, 0.3]), (count / 2, [0.5, 0.1]), (count - 1, [0.0, 0.4])] {
            let point = MaterialPoint { element, at };
            let states = [PointValues::Recovered, PointValues::Raw].map(|v| simulation.point_state(point, v).unwrap());
            for state in &states {
                check_consistency(state, &scene.material, &format!("{about} {element} {:?}", state.values));
            }
            differ += u32::from((states[0].gradient - states[1].gradient).norm() > 1e-4);
        }
    }
    assert!(differ > 10, "recovered and raw values are the same");
}

/// R is the identity, while the field of rotation angles shows how far the body turns.
#[test]
fn linear_theory_measures_without_a_rotation() {
    let simulation = solved(&scene("article").with_method(MethodKind::Linear));
    for values in [PointValues::Recovered, PointValues::Raw] {
        let state = simulation.point_state(MaterialPoint { element: 9, at: [0.2, 0.3] }, values).unwrap();
        assert_eq!(state.rotation, Rotation::IDENTITY);
        assert!(state.field(Field::RotationAngle).unwrap() < -40.0);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nodes.csv");
    warpbeam::export::write(&simulation, &path).unwrap();
    let csv = std::fs::read_to_string(path).unwrap();
    let (header, rows) = table(&csv);
    let column = header.iter().position(|name| *name == "rotation_deg").unwrap();
    assert!(rows.iter().all(|row| row[column] == "0"), "{csv}");
}
