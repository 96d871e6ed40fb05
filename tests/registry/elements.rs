//! Tests that every element must pass.

use crate::common::*;
use crate::{Test, suite};
use libtest_mimic::Trial;
use warpbeam::element::{ElementType, RulePoint, Sums};
use warpbeam::solver::Factor;

/// Returns the measures of the deformation of a state.
fn deformation_of(problem: &Problem, state: &State) -> Deformation {
    Deformation::of(problem, state, &NodalStress::of(problem, state, Kinematics::Corotated))
}

const TESTS: &[Test<ElementKind>] = tests! {
    the_id_is_the_name_in_scene_files shape_functions_are_one_at_their_node_and_zero_at_others
    shape_functions_sum_to_one local_gradients_are_derivatives sides_run_around
    quadrature_rules_integrate_the_products_of_shape_functions values_at_points_are_interpolated
    children_and_lattice_cover_the_cell clockwise_elements_are_reversed refinement_keeps_the_body
    material_points_are_found_in_curved_elements patch_test uniform_traction_gives_uniform_strain
    fields_of_a_uniform_stretch the_strains_at_points_add_up_to_the_energy areas_and_inversions_are_those_of_the_map
    the_rotation_at_points_is_the_local_one rigid_motions_give_no_force_and_no_energy
    the_force_is_the_gradient_of_the_energy the_tangent_is_the_derivative_of_the_force
    the_stiffness_and_the_offset_make_up_the_force the_positive_part_of_g_is_no_less_than_g
    the_work_between_two_states_is_the_difference_of_energies
    damping_is_the_stiffness_at_rest_and_does_not_damp_rotation works_are_reciprocal a_moment_is_a_couple
    the_energy_norm_converges_at_its_rate
};

pub fn trials() -> Vec<Trial> {
    suite("element", ELEMENTS.iter().map(|e| (e.id.to_owned(), e.kind)), TESTS)
}

/// Returns points inside a cell.
fn samples(entry: &ElementType) -> Vec<[f64; 2]> {
    (entry.cell.lattice)(5).points.into_iter().map(|[x, y]| [0.9 * x + 0.03, 0.9 * y + 0.02]).collect()
}

fn the_id_is_the_name_in_scene_files(kind: ElementKind) {
    assert_eq!(toml::Value::try_from(kind).unwrap().as_str(), Some(kind.id()));
    assert_eq!(kind.entry().kind, kind);
}

fn shape_functions_are_one_at_their_node_and_zero_at_others(kind: ElementKind) {
    let entry = kind.entry();
    for (b, &at) in entry.nodes.iter().enumerate() {
        for (a, n) in (entry.shape)(at).into_iter().enumerate() {
            assert!((n - if a == b { 1.0 } else { 0.0 }).abs() < 1e-15, "N{a} at node {b}: {n}");
        }
        assert_eq!(entry.node_at(at), Some(b));
    }
    let corners = entry.cell.corners.len();
    assert_eq!(&entry.nodes[..corners], entry.cell.corners);
    assert!(entry.node_at([0.123, 0.456]).is_none());
}

fn shape_functions_sum_to_one(kind: ElementKind) {
    let entry = kind.entry();
    for at in samples(entry) {
        assert!(((entry.shape)(at).iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let gradient: Vector2<f64> = (entry.local_gradients)(at).iter().sum();
        assert!(gradient.norm() < 1e-14, "{gradient}");
        let weights = (entry.cell.corner_weights)(at);
        let back = [0, 1].map(|i| weights.iter().zip(entry.cell.corners).map(|(w, c)| w * c[i]).sum::<f64>());
        assert!((back[0] - at[0]).abs() < 1e-15 && (back[1] - at[1]).abs() < 1e-15);
    }
}

fn local_gradients_are_derivatives(kind: ElementKind) {
    const STEP: f64 = 1e-5;
    let entry = kind.entry();
    for [x, y] in samples(entry) {
        let shape = entry.shape;
        let along = |from: [f64; 2], to: [f64; 2]| -> Vec<f64> {
            shape(from).into_iter().zip(shape(to)).map(|(a, b)| (b - a) / (2.0 * STEP)).collect()
        };
        let (dx, dy) = (along([x - STEP, y], [x + STEP, y]), along([x, y - STEP], [x, y + STEP]));
        for ((g, dx), dy) in (entry.local_gradients)([x, y]).iter().zip(dx).zip(dy) {
            assert!((g - Vector2::new(dx, dy)).norm() < 1e-9, "{g} {dx} {dy}");
        }
    }
}

fn sides_run_around(kind: ElementKind) {
    let entry = kind.entry();
    let corners = entry.cell.corners.len();
    assert_eq!(entry.sides.len(), corners);
    for (i, side) in entry.sides.iter().enumerate() {
        assert_eq!((side[0], side[side.len() - 1]), (i, (i + 1) % corners));
        // Nodes are equally spaced.
        let place = |n: usize| Vector2::from(entry.nodes[n]);
        for (j, &n) in side.iter().enumerate() {
            let t = j as f64 / (side.len() - 1) as f64;
            assert!((place(n) - (place(side[0]) * (1.0 - t) + place(side[side.len() - 1]) * t)).norm() < 1e-15);
        }
    }
}

/// Returns points and weights of a cell: its lattice of small triangles, and the rule of degree 2 in each.
fn fine_rule(entry: &ElementType, pieces: u32) -> Vec<([f64; 2], f64)> {
    let lattice = (entry.cell.lattice)(pieces);
    let in_triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|p| Vector2::from(lattice.points[p as usize]));
        let weight = 0.5 * (b - a).perp(&(c - a)) / 3.0;
        [[a, b, c], [b, c, a], [c, a, b]].map(|[p, q, r]| ((p * (2.0 / 3.0) + q / 6.0 + r / 6.0).into(), weight))
    };
    lattice.triangles.iter().flat_map(in_triangle).collect()
}

fn integrate(entry: &ElementType, pieces: u32, g: impl Fn([f64; 2]) -> f64) -> f64 {
    fine_rule(entry, pieces).into_iter().map(|(at, weight)| weight * g(at)).sum()
}

fn quadrature_rules_integrate_the_products_of_shape_functions(kind: ElementKind) {
    let entry = kind.entry();
    let apply =
        |rule: &[RulePoint], g: &dyn Fn([f64; 2]) -> f64| -> f64 { rule.iter().map(|p| p.weight * g(p.at)).sum() };
    for rule in [entry.points, entry.mass_points] {
        assert!(rule.iter().all(|p| p.weight > 0.0 && (entry.cell.depth)(p.at) > 0.0));
        assert!((apply(rule, &|_| 1.0) - entry.cell.area).abs() < 1e-14);
    }
    // Integrands are products of local gradients, and of shape functions. The fine rule has an error of order h³.
    for (a, b) in (0..entry.nodes.len()).flat_map(|a| (0..=a).map(move |b| (a, b))) {
        let stiffness = |at| {
            let g = (entry.local_gradients)(at);
            g[a].x * g[b].y + g[a].y * g[b].y
        };
        let mass = |at| (entry.shape)(at)[a] * (entry.shape)(at)[b];
        let difference = apply(entry.points, &stiffness) - integrate(entry, 48, stiffness);
        assert!(difference.abs() < 1e-5, "stiffness {a} {b}: {difference:e}");
        let difference = apply(entry.mass_points, &mass) - integrate(entry, 48, mass);
        assert!(difference.abs() < 1e-6, "mass {a} {b}: {difference:e}");
    }
}

fn values_at_points_are_interpolated(kind: ElementKind) {
    let entry = kind.entry();
    for (i, point) in entry.points.iter().enumerate() {
        for (j, weight) in (entry.point_weights)(point.at).into_iter().enumerate() {
            assert!((weight - if i == j { 1.0 } else { 0.0 }).abs() < 1e-14, "{i} {j}: {weight}");
        }
    }
    for at in samples(entry) {
        assert!(((entry.point_weights)(at).iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}

fn children_and_lattice_cover_the_cell(kind: ElementKind) {
    let entry = kind.entry();
    let polygon = |corners: &[[f64; 2]]| -> f64 {
        let at = |i: usize| Vector2::from(corners[i % corners.len()]);
        0.5 * (0..corners.len()).map(|i| at(i).perp(&at(i + 1))).sum::<f64>()
    };
    let parts: Vec<f64> = entry.cell.children.iter().map(|c| polygon(c)).collect();
    assert_eq!(parts.len(), 4);
    assert!(parts.iter().all(|&area| (area - 0.25 * entry.cell.area).abs() < 1e-15));
    for pieces in [1, 2, 5] {
        assert!((integrate(entry, pieces, |_| 1.0) - entry.cell.area).abs() < 1e-14 * entry.cell.area.max(1.0));
        let lattice = (entry.cell.lattice)(pieces);
        for (side, points) in entry.sides.iter().zip(&lattice.sides) {
            let [from, to] = [points[0], points[points.len() - 1]].map(|p| lattice.points[p as usize]);
            assert_eq!((from, to), (entry.nodes[side[0]], entry.nodes[side[side.len() - 1]]));
        }
    }
}

/// Returns a mesh of the square [0, 2] × [−1, 1] with irregular elements and, where the element
/// allows it, curved inner sides.
fn irregular_mesh(kind: ElementKind) -> Mesh {
    let mesh = Mesh::beam(Scene::beam(2.0, 2.0).with_cells(4, 3).with_element(kind).beam.as_ref().unwrap()).unwrap();
    let warp = |x: Vector2<f64>| {
        let bump = x.x * (2.0 - x.x) * (1.0 - x.y * x.y);
        x + Vector2::new(0.12 * (3.0 * x.y + 1.0).sin(), 0.1 * (2.0 * x.x).cos()) * bump
    };
    mesh.moved(warp).unwrap()
}

/// Supports the body like a bar: the left edge along x, one corner of it along y.
fn irregular_scene(plane: Plane) -> Scene {
    let material = Material { thickness: 0.5, plane, ..Material::new(100.0, 0.3) };
    Scene::named("Irregular").with_material(material).support("left", &[Axis::X]).support([0.0, -1.0], &[Axis::Y])
}

fn problem(scene: &Scene, kind: ElementKind) -> Problem {
    Problem::new(scene, System::with_mesh(scene, irregular_mesh(kind)).unwrap().into()).unwrap()
}

fn nodes(problem: &Problem) -> &[Vector2<f64>] {
    problem.system().mesh().nodes()
}

/// Returns the state in which the node at X is at `place(X)`, whether it is supported or not.
fn state(problem: &Problem, place: impl Fn(Vector2<f64>) -> Vector2<f64>) -> State {
    let u: Vec<_> = nodes(problem).iter().map(|&x| place(x) - x).collect();
    problem.system().state_of(&u).unwrap()
}

fn is_inside(x: &Vector2<f64>) -> bool {
    x.x > 1e-9 && x.x < 2.0 - 1e-9 && x.y.abs() < 1.0 - 1e-9
}

fn clockwise_elements_are_reversed(kind: ElementKind) {
    let mesh = irregular_mesh(kind);
    let over = kind.entry().turned_over();
    let clockwise: Vec<u32> = mesh.elements().flat_map(|e| over.iter().map(|&i| e[i]).collect::<Vec<_>>()).collect();
    assert_ne!(clockwise, mesh.connectivity());
    assert_eq!(Mesh::new(mesh.nodes().to_vec(), kind, clockwise, mesh.edges().clone()).unwrap(), mesh);
}

fn refinement_keeps_the_body(kind: ElementKind) {
    let mesh = irregular_mesh(kind);
    let fine = mesh.refined();
    assert_eq!(fine.element_count(), 4 * mesh.element_count());
    assert_eq!(&fine.nodes()[..mesh.nodes().len()], mesh.nodes());
    let again = Mesh::new(fine.nodes().to_vec(), kind, fine.connectivity().to_vec(), fine.edges().clone());
    assert_eq!(again.as_ref(), Ok(&fine), "elements turned over, or edges that are no sides");
    assert_eq!(fine.outline().len(), 2 * mesh.outline().len(), "not conforming");
    let scene = irregular_scene(Plane::Stress);
    let area = |mesh: Mesh| -> f64 { System::with_mesh(&scene, mesh).unwrap().nodal_areas().iter().sum() };
    assert!((area(mesh.clone()) - 4.0).abs() < 1e-12);
    assert!((area(fine.clone()) - 4.0).abs() < 1e-12);
    for (name, segments) in mesh.edges() {
        assert_eq!(fine.edges()[name].len(), 2 * segments.len());
        let nodes = fine.edge_nodes(name).unwrap();
        assert!(mesh.edge_nodes(name).unwrap().iter().all(|n| nodes.contains(n)));
    }
}

/// A point of an element is located again from the position that the shape functions give it.
fn material_points_are_found_in_curved_elements(kind: ElementKind) {
    let bend = |x: Vector2<f64>| Rotation::from_angle(0.6 * x.x).apply(Vector2::new(0.0, x.y - 3.0));
    let mesh = irregular_mesh(kind).moved(bend).unwrap();
    let entry = kind.entry();
    for (element, own) in mesh.elements().enumerate() {
        for at in samples(entry).into_iter().filter(|&at| (entry.cell.depth)(at) > 1e-6) {
            let weights = mesh.weights(MaterialPoint { element, at }).unwrap();
            assert_eq!(weights.iter().map(|w| w.0).collect::<Vec<_>>(), own);
            let place: Vector2<f64> = weights.iter().map(|&(n, w)| mesh.nodes()[n as usize] * w).sum();
            let found = mesh.locate(place).unwrap();
            assert_eq!(found.element, element);
            let off = Vector2::from(found.at) - Vector2::from(at);
            assert!(off.norm() < 1e-9, "element {element}: {:?} for {at:?}", found.at);
        }
    }
    assert_eq!(mesh.weights(MaterialPoint { element: mesh.element_count(), at: [0.1, 0.1] }), None);
    assert_eq!(mesh.locate(Vector2::new(50.0, 0.0)), None);
    // A node on a side is located in some element, whatever the rounding.
    assert!(mesh.nodes().iter().all(|&x| mesh.locate(x).is_some()));
}

/// The patch test holds in linear theory, and in the warped formulation with an added rotation by 70°.
fn patch_test(kind: ElementKind) {
    let turn = Rotation::from_angle(70f64.to_radians());
    let (gradient, stretch) = (Matrix2::new(0.02, -0.01, 0.03, -0.015), Matrix2::new(1.02, 0.01, 0.01, 0.97));
    for plane in [Plane::Stress, Plane::Strain] {
        let problem = problem(&irregular_scene(plane), kind);
        let mut linear = state(&problem, |x| x + gradient * x + Vector2::new(0.4, -0.1));
        problem.system().update_rotations(&mut linear, Kinematics::Linear);
        let turned = state(&problem, |x| turn.apply(stretch * x));
        assert!(turned.rotations().iter().all(|r| (r.c - turn.c).hypot(r.s - turn.s) < 1e-13));
        for state in [linear, turned] {
            let forces = forces_at(&problem, &state);
            let largest = largest(&forces.internal);
            for (x, f) in nodes(&problem).iter().zip(&forces.internal).filter(|(x, _)| is_inside(x)) {
                assert!(f.norm() < 1e-12 * largest, "{plane:?} at {x}: {f}");
            }
        }
    }
}

/// Patch test through the public interface: displacements p/E along and −ν p/E across, with every method.
fn uniform_traction_gives_uniform_strain(kind: ElementKind) {
    for method in METHODS {
        let mut scene = irregular_scene(Plane::Stress).force("right", [3.0, 0.0]).with_method(method.kind);
        scene.solver.tolerance = 1e-13;
        let simulation = solved_on(&scene, irregular_mesh(kind));
        let strain = 3.0 / (100.0 * 0.5 * 2.0);
        // `auto` uses linear theory here; the others iterate to the tolerance.
        for (x, u) in simulation.system().mesh().nodes().iter().zip(simulation.displacement()) {
            let expected = Vector2::new(strain * x.x, -0.3 * strain * (x.y + 1.0));
            assert!((u - expected).norm() < 1e-12, "{}: {u} {expected}", method.id);
        }
    }
}

/// The fields of a rotated body have closed forms; the von Mises stress in plane strain includes that across the plane.
fn fields_of_a_uniform_stretch(kind: ElementKind) {
    let degrees = -70.0f64;
    let turn = Rotation::from_angle(degrees.to_radians());
    let (xx, xy, yy) = (-0.04, 0.013, 0.02);
    let strain = Matrix2::new(xx, xy, xy, yy);
    for plane in [Plane::Stress, Plane::Strain] {
        let problem = problem(&irregular_scene(plane), kind);
        let state = state(&problem, |x| turn.apply(x + strain * x) + Vector2::new(2.0, -1.0));
        // E = 100, ν = 0.3.
        let (young, poisson) = (100.0, 0.3);
        let shear = young / (2.0 * (1.0 + poisson));
        let pressure_part = match plane {
            Plane::Stress => young * poisson / (1.0 - poisson * poisson),
            Plane::Strain => young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        } * (xx + yy);
        let (sx, sy, t) = (pressure_part + 2.0 * shear * xx, pressure_part + 2.0 * shear * yy, 2.0 * shear * xy);
        // σ = T S / J in the axes of the material, with the ratio of volumes J.
        let stretch = Matrix2::identity() + strain;
        let thickness = if plane == Plane::Strain { 1.0 } else { 1.0 - poisson / (1.0 - poisson) * (xx + yy) };
        let volume = stretch.determinant() * thickness;
        let own = Matrix2::new(sx, t, t, sy) * stretch / volume;
        let z = if plane == Plane::Strain { poisson * (sx + sy) / volume } else { 0.0 };
        let mean = (own.trace() + z) / 3.0;
        let deviator =
            (own.m11 - mean).powi(2) + (own.m22 - mean).powi(2) + (z - mean).powi(2) + 2.0 * own.m12 * own.m21;
        let spatial = turn.matrix() * own * turn.matrix().transpose();
        let symmetric = Matrix2::new(own.m11, own.m12, own.m12, own.m22);
        let (stresses, strains) = (symmetric.symmetric_eigenvalues(), strain.symmetric_eigenvalues());
        let largest = strain.symmetric_eigenvalues().amax();
        for (field, expected) in [
            (Field::VonMises, (1.5 * deviator).sqrt()),
            (Field::MaterialStressX, own.m11),
            (Field::MaterialStressY, own.m22),
            (Field::MaterialShearStress, own.m12),
            (Field::StressX, spatial.m11),
            (Field::StressY, spatial.m22),
            (Field::ShearStress, spatial.m12),
            (Field::LargerPrincipalStress, stresses.max()),
            (Field::SmallerPrincipalStress, stresses.min()),
            (Field::StrainX, xx),
            (Field::StrainY, yy),
            (Field::ShearStrain, 2.0 * xy),
            (Field::LargerPrincipalStrain, strains.max()),
            (Field::SmallerPrincipalStrain, strains.min()),
            (Field::EnergyDensity, 0.5 * (sx * xx + sy * yy) + t * xy),
            (Field::LargestStrain, largest),
            (Field::RotationAngle, degrees),
        ] {
            let mut values = Vec::new();
            field.values(&problem, &state, Kinematics::Corotated, &mut values);
            assert_eq!(values.len(), problem.system().elements().point_count());
            for value in values {
                let value = value.unwrap();
                assert!((value - expected).abs() < 1e-11 * expected.abs(), "{plane:?} {field:?}: {value} {expected}");
            }
        }
        let deformation = deformation_of(&problem, &state);
        assert!((deformation.max_rotation_deg - degrees.abs()).abs() < 1e-9, "{deformation:?}");
        assert!((deformation.max_strain - largest).abs() < 1e-12, "{deformation:?}");
        assert_eq!(deformation.inverted_elements, 0);
    }
}

/// The energy includes the part of an element's own modes.
fn the_strains_at_points_add_up_to_the_energy(kind: ElementKind) {
    for plane in [Plane::Stress, Plane::Strain] {
        let problem = problem(&irregular_scene(plane), kind);
        let (elements, moduli) = (problem.system().elements(), problem.material().membrane());
        for place in [bent, |x: Vector2<f64>| Vector2::new(x.x + 0.2 * x.x * x.y, x.y - 0.1 * x.x * x.x)] {
            let state = state(&problem, place);
            let (mut sum, mut next) = (0.0, 0);
            elements.visit_strains(moduli, state.displacement(), state.rotations(), &mut |q, _, strain| {
                assert_eq!(q, next);
                next += 1;
                sum += elements.point_area(q) * moduli.energy_density(strain);
            });
            assert_eq!(next, elements.point_count());
            let energy = problem.elastic_energy(&state);
            assert!((sum - energy).abs() < 1e-12 * energy, "{plane:?}: {sum} {energy}");
        }
    }
}

/// Area ratios and inverted elements agree with the Jacobians of the shape functions.
fn areas_and_inversions_are_those_of_the_map(kind: ElementKind) {
    let problem = problem(&irregular_scene(Plane::Stress), kind);
    let (entry, mesh) = (kind.entry(), problem.system().mesh());
    let places: [fn(Vector2<f64>) -> Vector2<f64>; 4] = [
        |x| x,
        bent,
        |x| Vector2::new(x.x * x.x * 0.4, x.y + 0.3 * x.x),
        // A fold: part of the body is inverted.
        |x| Vector2::new((2.0 * x.x).sin(), x.y + 0.2 * x.x * x.y),
    ];
    // The area inside the outline; a side is a parabola through its nodes.
    let inside = |x: &dyn Fn(u32) -> Vector2<f64>| -> f64 {
        let side = |side: &Segment| match *side.nodes() {
            [a, middle, b] => (x(a).perp(&x(middle)) + x(middle).perp(&x(b))) / 1.5 - x(a).perp(&x(b)) / 6.0,
            _ => 0.5 * x(side.ends()[0]).perp(&x(side.ends()[1])),
        };
        mesh.outline().iter().map(side).sum()
    };
    let mut inversions = Vec::new();
    for place in places {
        let state = state(&problem, place);
        let rest = |node: u32| mesh.nodes()[node as usize];
        let change = inside(&|node| rest(node) + state.displacement()[node as usize]) / inside(&rest) - 1.0;
        assert!((deformation_of(&problem, &state).area_change - change).abs() < 1e-12, "{change}");
        let (mut least, mut inverted) = (f64::INFINITY, 0);
        for own in mesh.elements() {
            let rest: Vec<_> = own.iter().map(|&n| mesh.nodes()[n as usize]).collect();
            let now: Vec<_> = own.iter().zip(&rest).map(|(&n, x)| x + state.displacement()[n as usize]).collect();
            let area = |nodes: &[Vector2<f64>], at| entry.jacobian(nodes, at).determinant();
            let ratios: Vec<_> = entry.points.iter().map(|p| area(&now, p.at) / area(&rest, p.at)).collect();
            inverted += usize::from(ratios.iter().any(|ratio| *ratio <= 0.0));
            least = ratios.into_iter().fold(least, f64::min);
        }
        let found = problem.system().elements().smallest_area_ratio(state.displacement());
        assert!((found - least).abs() < 1e-12, "{found} {least}");
        assert_eq!(deformation_of(&problem, &state).inverted_elements, inverted);
        inversions.push(inverted);
    }
    assert!(inversions[..2] == [0, 0] && inversions[3] > 1 && inversions[3] < mesh.element_count(), "{inversions:?}");
}

/// The ends of the body are rotated against each other by more than two radians.
fn the_rotation_at_points_is_the_local_one(kind: ElementKind) {
    let scene = Scene::beam(16.0, 1.0).with_cells(16, 1).with_element(kind).clamp("left");
    let problem = Problem::new(&scene, System::new(&scene).unwrap().into()).unwrap();
    let radius = 6.0;
    let roll = |x: Vector2<f64>| {
        Rotation::from_angle(x.x / radius).apply(Vector2::new(0.0, x.y - radius)) + Vector2::new(0.0, radius)
    };
    let state = state(&problem, roll);
    let elements = problem.system().elements();
    assert_eq!(elements.point_count(), elements.points_per_element() * problem.system().mesh().element_count());
    assert_eq!(elements.points_per_element(), kind.entry().points.len());
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    let moduli = problem.material().membrane();
    elements.visit_strains(moduli, state.displacement(), state.rotations(), &mut |q, h, _| {
        let own = warpbeam::rotation::polar(&(Matrix2::identity() + h)).unwrap();
        let seen = state.rotations()[elements.rotation_of(q)];
        let off = (own.c * seen.s - own.s * seen.c).atan2(own.c * seen.c + own.s * seen.s);
        assert!(off.abs() < 0.12, "point {q}: {own:?} {seen:?}");
        (first, last) = (first.min(own.angle()), last.max(own.angle()));
    });
    assert!(last - first > 2.0, "{first} to {last}");
}

fn rigid_motions_give_no_force_and_no_energy(kind: ElementKind) {
    let problem = problem(&irregular_scene(Plane::Strain), kind);
    for degrees in [0.0f64, 1e-6, 10.0, 90.0, 179.0, -135.0] {
        let turn = Rotation::from_angle(degrees.to_radians());
        let state = state(&problem, |x| turn.apply(x) + Vector2::new(3.0, -20.0));
        // A strain of 1 gives forces of about 100 N; coordinates of 20 give rounding errors of 20 ε.
        assert!(forces_at(&problem, &state).internal.iter().all(|f| f.norm() < 1e-11), "{degrees}°");
        assert!(problem.elastic_energy(&state) < 1e-25, "{degrees}°");
    }
}

/// Maps a point to a bent, stretched and rotated body.
fn bent(x: Vector2<f64>) -> Vector2<f64> {
    Rotation::from_angle(0.8 + 0.3 * x.x).apply(x) * (1.0 + 0.1 * x.y - 0.2 * x.x)
}

/// f_int is the gradient of the energy, where R follows x.
fn the_force_is_the_gradient_of_the_energy(kind: ElementKind) {
    let problem = problem(&irregular_scene(Plane::Strain), kind);
    let start = state(&problem, bent);
    let forces = forces_at(&problem, &start);
    check_gradient(&forces.internal, 1e-5, 1e-8 * largest(&forces.internal), |node, step| {
        let mut u = start.displacement().to_vec();
        u[node] += step;
        problem.elastic_energy(&problem.system().state_of(&u).unwrap())
    });
}

/// A + G and the moment's own tangent are the derivative of f_int − f_ext; A + max(G, 0) is positive definite.
fn the_tangent_is_the_derivative_of_the_force(kind: ElementKind) {
    const FACTOR: f64 = 0.7;
    let problem = problem(&irregular_scene(Plane::Strain).moment("right", 3.0), kind);
    let start = state(&problem, bent);
    let numeric = numeric_stiffness(&problem, &start, FACTOR, 1e-6);
    let dense = |tangent| dense(&problem, &start, tangent).0;
    // The loads' own stiffness is that of the moment.
    let (pattern, u) = (problem.system().pattern(), start.displacement());
    let mut loads = Matrix::new(pattern);
    problem.loads().add_stiffness(problem.system(), u, FACTOR, &mut loads);
    let exact = dense(Tangent::EXACT) + columns(&problem, |unit, image| loads.multiply(pattern, unit, image));
    let error = (&numeric - &exact).norm() / exact.norm();
    assert!(error < 1e-8, "{error:e}");
    // A + G is exact, and A with only the positive part of G is positive definite.
    let parts = dense(Tangent::WARPED) + dense(Tangent::GEOMETRIC);
    assert!((parts - dense(Tangent::EXACT)).norm() < 1e-12 * exact.norm());
    assert!(dense(Tangent::DEFINITE).symmetric_eigenvalues().min() > 0.0);
}

/// A + max(G, 0) exceeds A + G by a positive semidefinite matrix, in compression, tension and bending.
fn the_positive_part_of_g_is_no_less_than_g(kind: ElementKind) {
    let problem = problem(&irregular_scene(Plane::Stress), kind);
    for (along, across) in [(0.9, 0.9), (1.1, 1.05), (0.8, 1.2)] {
        let start = state(&problem, |x| bent(Vector2::new(along * x.x, across * x.y)));
        let [exact, definite, geometric, warped] =
            [Tangent::EXACT, Tangent::DEFINITE, Tangent::GEOMETRIC, Tangent::WARPED]
                .map(|t| dense(&problem, &start, t).0);
        let positive = (&definite - warped).symmetric_eigenvalues();
        assert!(positive.min() > -1e-12 * exact.norm(), "{positive}");
        assert!(geometric.clone().symmetric_eigenvalues().min() < -1e-3 * exact.norm(), "G is positive by itself");
        let added = (&definite - &exact).symmetric_eigenvalues();
        assert!(added.min() > -1e-12 * exact.norm() && added.max() > 1e-3 * geometric.norm(), "{added}");
        // The added part is at most the norm of G times the number of elements.
        assert!(added.max() <= geometric.norm() * problem.system().mesh().element_count() as f64);
        assert!(definite.symmetric_eigenvalues().min() > 0.0);
    }
}

/// The two states may be far apart. The force has no resultant and no moment.
fn the_work_between_two_states_is_the_difference_of_energies(kind: ElementKind) {
    let problem = problem(&irregular_scene(Plane::Strain), kind);
    let (system, moduli) = (problem.system(), problem.material().membrane());
    let turned = |degrees: f64, place: fn(Vector2<f64>) -> Vector2<f64>| {
        let turn = Rotation::from_angle(degrees.to_radians());
        state(&problem, |x| turn.apply(place(x)) + Vector2::new(0.3, -0.7))
    };
    let other = |x: Vector2<f64>| Vector2::new(x.x + 0.3 * x.x * x.y, 0.9 * x.y + 0.1 * x.x * x.x - 0.2 * x.y * x.x);
    let mut pairs = vec![(turned(0.0, |x| x), turned(-40.0, bent)), (turned(20.0, bent), turned(20.0, bent))];
    pairs.extend([1e-4, 30.0, 100.0, 178.0, -120.0].map(|degrees| (turned(10.0, bent), turned(10.0 + degrees, other))));
    for (a, b) in &pairs {
        let states = [(a.compensated(), a.rotations()), (b.compensated(), b.rotations())];
        let mut force = vec![Vector2::zeros(); nodes(&problem).len()];
        let mut magnitude = force.clone();
        let sums = Sums { force: &mut force, magnitude: &mut magnitude, matrix: None };
        system.elements().linearize_between(moduli, states, sums);
        let energies = [a, b].map(|state| problem.elastic_energy(state));
        let moves = b.displacement().iter().zip(a.displacement()).map(|(b, a)| b - a);
        let work: f64 = moves.zip(&force).map(|(d, f)| d.dot(f)).sum();
        let scale = energies[0] + energies[1] + 1e-9;
        assert!((work - (energies[1] - energies[0])).abs() < 1e-12 * scale, "{work} {energies:?}");
        let net: Vector2<f64> = force.iter().sum();
        let middle =
            a.displacement().iter().zip(b.displacement()).zip(nodes(&problem)).map(|((a, b), x)| x + (a + b) * 0.5);
        let moment: f64 = middle.zip(&force).map(|(x, f)| x.perp(f)).sum();
        assert!(net.norm() < 1e-11 * scale, "{net}");
        assert!(moment.abs() < 1e-11 * scale, "{moment}");
    }
}

/// The viscous matrix is positive semidefinite in any state.
fn damping_is_the_stiffness_at_rest_and_does_not_damp_rotation(kind: ElementKind) {
    use warpbeam::element::StrainRate;
    let problem = problem(&irregular_scene(Plane::Strain), kind);
    let (system, moduli) = (problem.system(), problem.material().membrane());
    let count = nodes(&problem).len();
    let force = |u: &[Vector2<f64>], rate: StrainRate<'_>| {
        let mut force = vec![Vector2::zeros(); count];
        system.elements().viscous_force(moduli, u, rate, &mut force);
        force
    };
    let rest = vec![Vector2::zeros(); count];
    let v: Vec<_> = nodes(&problem).iter().map(|x| Vector2::new((3.0 * x.y).sin() + x.x, x.x * x.y)).collect();
    let small: Vec<_> = v.iter().map(|v| v * 1e-3).collect();
    let mut strained = problem.system().state_of(&small).unwrap();
    system.update_rotations(&mut strained, Kinematics::Linear);
    let elastic = forces_at(&problem, &strained);
    let viscous = force(&rest, StrainRate::Velocity(&small));
    let size = largest(&viscous);
    assert!(elastic.internal.iter().zip(&viscous).all(|(a, b)| (a - b).norm() < 1e-12 * size));
    // The same in a bent state, with free unknowns only.
    let start = state(&problem, bent);
    let u = start.displacement();
    let n = system.dofs();
    let free = DVector::from_fn(n, |i, _| ((i * 7 % 11) as f64 - 5.0) * 0.1);
    let mut moving = rest.clone();
    system.pattern().add_free(free.as_slice(), 1.0, &mut moving);
    let mut values = vec![0.0; system.pattern().row_indices.len() + 1];
    system.elements().viscous_matrix(moduli, u, system.slots(), &mut values);
    values.truncate(system.pattern().row_indices.len());
    let mut dense = DMatrix::zeros(n, n);
    for (column, bounds) in system.pattern().column_starts.windows(2).enumerate() {
        let entries = bounds[0]..bounds[1];
        for (&row, &value) in system.pattern().row_indices[entries.clone()].iter().zip(&values[entries]) {
            dense[(row, column)] = value;
            dense[(column, row)] = value;
        }
    }
    let by_matrix = &dense * &free;
    let by_force = restrict(&problem, &force(u, StrainRate::Velocity(&moving)));
    assert!((by_force - &by_matrix).norm() < 1e-12 * by_matrix.norm());
    assert!(dense.clone().symmetric_eigenvalues().min() > -1e-12 * dense.norm());
    // Force of a rigid motion from one state to another, and work of damping between any two states.
    let turn = Rotation::from_angle(2.5);
    let turned = nodes(&problem).iter().zip(u).map(|(x, u)| turn.apply(x + u) + Vector2::new(1.0, 2.0) - x);
    let turned: Vec<_> = turned.collect();
    let between = |a: &[Vector2<f64>], b: &[Vector2<f64>]| {
        let middle: Vec<_> = a.iter().zip(b).map(|(a, b)| (a + b) * 0.5).collect();
        force(&middle, StrainRate::Difference(&[(1.0, b), (-1.0, a)]))
    };
    assert!(between(u, &turned).iter().all(|f| f.norm() < 1e-11));
    // Green's strain is quadratic in x: its difference is its rate at the midpoint, for any time between.
    let halves: Vec<_> = rest.iter().zip(u).map(|(a, b)| (a + b) * 0.5).collect();
    let quick: Vec<_> = u.iter().map(|u| u * 4.0).collect();
    let by_rate = force(&halves, StrainRate::Velocity(&quick));
    let by_difference = force(&halves, StrainRate::Difference(&[(4.0, u), (-1.0, &rest), (-3.0, &rest)]));
    let size = largest(&by_rate);
    assert!(by_rate.iter().zip(&by_difference).all(|(a, b)| (a - b).norm() < 1e-12 * size));
    let work = |a: &[Vector2<f64>], b: &[Vector2<f64>]| -> f64 {
        between(a, b).iter().zip(a.iter().zip(b)).map(|(f, (a, b))| f.dot(&(b - a))).sum()
    };
    assert!(work(&rest, u) > 0.0 && work(&turned, &small) > 0.0 && work(&small, u) > 0.0);
}

/// A = Σ R Ke Rᵀ is the derivative of f_int with R kept, and f_int = A x − R K X.
fn the_stiffness_and_the_offset_make_up_the_force(kind: ElementKind) {
    let problem = problem(&irregular_scene(Plane::Stress), kind);
    let start = state(&problem, |x| Rotation::from_angle(0.4 * x.x).apply(x));
    let (a, _) = dense(&problem, &start, Tangent::WARPED);
    let with_rotations_of_start = |u: Vec<Vector2<f64>>| {
        let state = start.with_displacement(u).unwrap();
        forces_at(&problem, &state).internal.to_vec()
    };
    // A displacement of free nodes by d changes the force by exactly A d, because the force is linear in x for fixed R.
    // Neither state is the one that R belongs to, where R may add a force of its own.
    let d = DVector::from_fn(a.nrows(), |i, _| ((i * 7 % 11) as f64 - 5.0) * 0.01);
    let moved = |times: f64| {
        let mut moved = start.displacement().to_vec();
        problem.system().pattern().add_free(d.as_slice(), times, &mut moved);
        with_rotations_of_start(moved)
    };
    let change: Vec<_> = moved(2.0).iter().zip(&moved(1.0)).map(|(a, b)| a - b).collect();
    assert!((restrict(&problem, &change) - &a * d).norm() < 1e-10);
    // With all nodes at the origin, f_int is −R K X, which is exact in a rigidly rotated body.
    let turn = Rotation::from_angle(1.1);
    let turned = state(&problem, |x| turn.apply(x));
    let offset = forces_at(&problem, &turned.with_displacement(nodes(&problem).iter().map(|x| -x).collect()).unwrap());
    let magnitude = largest(&offset.internal);
    assert!(magnitude > 1.0);
    // A x − R K X vanishes in a rigidly rotated body.
    assert!(forces_at(&problem, &turned).internal.iter().all(|f| f.norm() < 1e-12 * magnitude));
}

/// Betti's theorem: each of two loads does the same work along the displacement of the other.
fn works_are_reciprocal(kind: ElementKind) {
    let tip = |force: [f64; 2], at: [f64; 2]| {
        let scene = irregular_scene(Plane::Strain).force(at, force).with_method(MethodKind::Linear);
        solved_on(&scene, irregular_mesh(kind))
    };
    let loads = [([1.0, 2.0], [2.0, 1.0]), ([-3.0, 0.5], [1.0, -1.0]), ([0.2, -1.0], [2.0, -1.0])];
    for (force, at) in loads {
        for (other_force, other_at) in loads {
            let (one, other) = (tip(force, at), tip(other_force, other_at));
            let along = |simulation: &Simulation, force: [f64; 2], at: [f64; 2]| {
                let node = simulation.system().mesh().nearest_node(at.into()) as usize;
                simulation.displacement()[node].dot(&Vector2::from(force))
            };
            let (a, b) = (along(&other, force, at), along(&one, other_force, other_at));
            assert!((a - b).abs() < 1e-12 * a.abs().max(1e-3), "{a} {b}");
        }
    }
}

/// A moment has no net force and the same size about any point.
fn a_moment_is_a_couple(kind: ElementKind) {
    let problem = problem(&irregular_scene(Plane::Stress).moment("right", 3.0), kind);
    let state = state(&problem, |x| Rotation::from_angle(2.0 + 0.1 * x.y).apply(x));
    let mut force = vec![Vector2::zeros(); nodes(&problem).len()];
    problem.loads().force(problem.system(), state.displacement(), Kinematics::Corotated, 1.0, &mut force);
    let net: Vector2<f64> = force.iter().sum();
    let positions = nodes(&problem).iter().zip(state.displacement()).map(|(x, u)| x + u);
    let moment: f64 = positions.zip(&force).map(|(x, f)| x.perp(f)).sum();
    assert!(net.norm() < 1e-12 && (moment - 3.0).abs() < 1e-12, "{net} {moment}");
}

/// Returns the displacement gradient of u = (sin 1.3x · cos 0.7y, sin x · sin(1.1y + 0.4)), zero on the left edge.
fn smooth_gradient(x: Vector2<f64>) -> Matrix2<f64> {
    let (a, b) = (1.3 * x.x, 0.7 * x.y);
    let (c, d) = (x.x, 1.1 * x.y + 0.4);
    Matrix2::new(1.3 * a.cos() * b.cos(), -0.7 * a.sin() * b.sin(), c.cos() * d.sin(), 1.1 * c.sin() * d.cos())
}

/// The rate is hᵖ with the degree p of the shape functions, under the loads of a smooth field in linear theory.
fn the_energy_norm_converges_at_its_rate(kind: ElementKind) {
    let degree = (kind.entry().sides[0].len() - 1) as f64;
    let errors = [4, 8, 16].map(|n| energy_norm_error(kind, n));
    let rate = (errors[1] / errors[2]).log2();
    assert!((rate - degree).abs() < 0.1, "{errors:?} {rate}");
}

/// Returns ‖ε − ε_h‖ over ‖ε‖ in the energy norm on n × n cells, including incompatible modes, which belong to no ∇N.
fn energy_norm_error(kind: ElementKind, n: u32) -> f64 {
    let material = Material { thickness: 0.5, plane: Plane::Strain, ..Material::new(100.0, 0.3) };
    let scene = Scene::beam(1.0, 1.0).with_cells(n, n).with_element(kind).with_material(material).clamp("left");
    let problem = Problem::new(&scene, System::new(&scene).unwrap().into()).unwrap();
    let entry = kind.entry();
    let moduli = material.membrane();
    let strain_at = |x: Vector2<f64>| (smooth_gradient(x) + smooth_gradient(x).transpose()) * 0.5;
    // The error of this rule is negligible compared with the measured one.
    let rule = fine_rule(entry, 4);
    // f_a = ∫ σ(u) ∇N_a dA.
    let mut force = vec![Vector2::zeros(); nodes(&problem).len()];
    for own in problem.system().mesh().elements() {
        let rest: Vec<_> = own.iter().map(|&n| nodes(&problem)[n as usize]).collect();
        for &(at, small) in &rule {
            let jacobian = entry.jacobian(&rest, at);
            let x: Vector2<f64> = rest.iter().zip((entry.shape)(at)).map(|(x, n)| x * n).sum();
            let stress = moduli.stress(&strain_at(x)) * (small * jacobian.determinant());
            let to_global = jacobian.try_inverse().unwrap().transpose();
            for (&node, g) in own.iter().zip((entry.local_gradients)(at)) {
                force[node as usize] += stress * (to_global * g);
            }
        }
    }
    let system = problem.system();
    let mut matrix = Matrix::new(system.pattern());
    problem.linearize(&system.at_rest(), &mut Forces::new(force.len()), Some((Tangent::WARPED, &mut matrix)));
    let mut factor = Factor::new(system.symbolic().unwrap()).unwrap();
    factor.factorize(matrix.values()).unwrap();
    let mut free = restrict(&problem, &force).as_slice().to_vec();
    factor.solve_in_place(&mut free);
    let mut u = vec![Vector2::zeros(); force.len()];
    system.pattern().add_free(&free, 1.0, &mut u);
    strain_error(&problem, &system.at_rest().with_displacement(u).unwrap(), &rule, strain_at)
}
