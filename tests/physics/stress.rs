//! Compares recovered stresses with closed forms, and the estimated mesh error with fine solutions, for every element.

use std::f64::consts::FRAC_PI_2;

use crate::common::*;

/// Young's modulus of all scenes in this file, Pa.
const YOUNG: f64 = 1e6;

/// Returns cell counts with equal node spacing: elements with two-noded sides get twice as many cells.
fn cells(kind: ElementKind, along: u32, across: u32) -> [u32; 2] {
    let pieces = if kind.entry().sides[0].len() == 2 { 2 } else { 1 };
    [along * pieces, across * pieces]
}

/// Returns the stresses of a plate with a hole of radius 1 under a unit stress along x (Kirsch 1898).
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

/// Solves a quarter of a ring around the hole, out to four radii, with Kirsch's tractions on all of its sides.
fn kirsch_plate(kind: ElementKind, cells: [u32; 2], pull: f64, turn: Rotation) -> Simulation {
    let plain = Scene::beam(1.0, 1.0).with_element(kind).with_cells(cells[0], cells[1]);
    let ring = |x: Vector2<f64>| {
        let (r, angle) = (4f64.powf(x.x), FRAC_PI_2 * (x.y + 0.5));
        r * Vector2::new(angle.cos(), angle.sin())
    };
    let mesh = Mesh::beam(plain.beam.as_ref().unwrap()).unwrap().moved(ring).unwrap();
    // Consistent nodal forces of the tractions, by Gauss's rule with three points per side.
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
            // The outward normal times the length.
            let normal = Vector2::new(along.y, -along.x);
            let normal = normal * normal.dot(&(at - inside)).signum();
            for (&n, w) in side.nodes().iter().zip(&shape) {
                forces[n as usize] += kirsch(at) * normal * (pull * weight * w);
            }
        }
    }
    // The imbalance due to the polygon and the quadrature rule is spread evenly, so that the supports carry no load.
    let loaded: Vec<usize> = (0..forces.len()).filter(|&n| forces[n].norm() > 0.0).collect();
    let count = loaded.len() as f64;
    let centre = loaded.iter().map(|&n| mesh.nodes()[n]).sum::<Vector2<f64>>() / count;
    let total = loaded.iter().map(|&n| forces[n]).sum::<Vector2<f64>>() / count;
    let arms: Vec<Vector2<f64>> = loaded.iter().map(|&n| mesh.nodes()[n] - centre).collect();
    let moment: f64 = loaded.iter().zip(&arms).map(|(&n, arm)| arm.perp(&forces[n])).sum();
    let inertia: f64 = arms.iter().map(|arm| arm.norm_squared()).sum();
    for (&n, arm) in loaded.iter().zip(&arms) {
        forces[n] -= total + Vector2::new(-arm.y, arm.x) * (moment / inertia);
    }
    let mesh = mesh.moved(|x| turn.apply(x)).unwrap();
    let mut scene = Scene::beam(1.0, 1.0).with_element(kind).with_material(Material::new(YOUNG, 0.3));
    let [a, b]: [[f64; 2]; 2] = [[4.0, 0.0], [0.0, 4.0]].map(|x| turn.apply(x.into()).into());
    scene = scene.support(a, &[Axis::X, Axis::Y]).support(b, &[Axis::Y]);
    for (x, force) in mesh.nodes().iter().zip(&forces).filter(|(_, f)| f.norm() > 0.0) {
        scene.loads.push(Load::force([x.x, x.y], turn.apply(*force)));
    }
    solved_on(&scene, mesh)
}

/// Stresses converge at all nodes of Kirsch's plate; the largest one at the hole converges to 3.
#[test]
fn stresses_at_a_hole_converge() {
    let pull = 1e-6 * YOUNG;
    for kind in ElementKind::all() {
        let mut errors = Vec::new();
        let mut concentration = 0.0;
        for n in [4, 8, 16] {
            let simulation = kirsch_plate(kind, cells(kind, n, n), pull, Rotation::IDENTITY);
            let (nodes, nodal) = (simulation.system().mesh().nodes(), simulation.nodal_stress());
            let off = nodes.iter().zip(nodal.cauchy()).map(|(x, s)| s.unwrap().plane / pull - kirsch(*x));
            errors.push((off.map(|off| off.norm_squared()).sum::<f64>() / nodes.len() as f64).sqrt());
            let top = simulation.system().mesh().nearest_node(Vector2::new(0.0, 1.0));
            concentration = nodal.cauchy().nth(top as usize).unwrap().unwrap().plane.m11 / pull;
            let (rms, error) = (errors[errors.len() - 1], simulation.stress_result().mesh_error_percent.unwrap());
            println!("{kind:?} {n}: K {concentration:.4}, rms {rms:.4}, mesh error {error:.2} %");
        }
        let bound = if kind.entry().points.len() == 1 { 0.1 } else { 0.03 };
        assert!((concentration - 3.0).abs() < bound, "{kind:?}: {concentration}");
        assert!(errors.windows(2).all(|e| e[1] < 0.55 * e[0]), "{kind:?}: {errors:?}");
    }
}

/// Solves a ring of 120° with radii 2 and 3, rotated by `turn`, clamped at one end and bent by a moment at the other.
fn curved_beam(kind: ElementKind, moment: f64, turn: Rotation) -> Simulation {
    let [along, across] = cells(kind, 32, 6);
    let plain = Scene::beam(1.0, 1.0).with_element(kind).with_cells(along, across);
    let ring = |x: Vector2<f64>| {
        let (r, angle) = (2.5 + x.y, -2.0 / 3.0 * PI * x.x);
        turn.apply(r * Vector2::new(angle.cos(), angle.sin()))
    };
    let mesh = Mesh::beam(plain.beam.as_ref().unwrap()).unwrap().moved(ring).unwrap();
    let scene = Scene::beam(1.0, 1.0).with_element(kind).with_material(Material::new(YOUNG, 0.3));
    solved_on(&scene.clamp("left").moment("right", moment), mesh)
}

/// Timoshenko and Goodier, *Theory of Elasticity*, art. 29. The moment opens the ring.
#[test]
fn stresses_of_a_curved_beam_are_golovins() {
    let (a, b, moment) = (2.0f64, 3.0f64, 1e-4 * YOUNG / 12.0);
    let (a2, b2, log) = (a * a, b * b, (b / a).ln());
    let n = (b2 - a2).powi(2) - 4.0 * a2 * b2 * log * log;
    for kind in ElementKind::all() {
        let simulation = curved_beam(kind, moment, Rotation::IDENTITY);
        let nodal = simulation.nodal_stress();
        let largest = 4.0 * moment / n * (b2 - a2 + 2.0 * b2 * log);
        let mut worst = 0.0f64;
        for (x, stress) in simulation.system().mesh().nodes().iter().zip(nodal.cauchy()) {
            let (r, angle) = (x.norm(), x.y.atan2(x.x));
            // Only nodes away from both ends count, where the tractions differ.
            if (angle + PI / 3.0).abs() > PI / 9.0 {
                continue;
            }
            let common = a2 * b2 / (r * r) * log;
            let radial = common + b2 * (r / b).ln() + a2 * (a / r).ln();
            let hoop = -common + b2 * (r / b).ln() + a2 * (a / r).ln() + b2 - a2;
            let turn = Rotation::from_angle(angle).matrix();
            let own = turn.transpose() * stress.unwrap().plane * turn;
            let exact = Matrix2::new(radial, 0.0, 0.0, hoop) * (4.0 * moment / n);
            worst = worst.max((own - exact).amax().min((own + exact).amax()));
        }
        println!("{kind:?}: {:.2} % of the largest hoop stress", 100.0 * worst / largest);
        let bound = if kind.entry().points.len() == 1 { 0.06 } else { 0.015 };
        assert!(worst < bound * largest, "{kind:?}: {worst} of {largest}");
    }
}

/// Solves a beam with L/H = 10 and ν = 0 under small loads, rotated by `turn`.
fn straight_beam(kind: ElementKind, moment: f64, force: f64, turn: Rotation) -> Simulation {
    let [along, across] = cells(kind, 40, 4);
    let scene = Scene::beam(10.0, 1.0).with_element(kind).with_cells(along, across);
    let mesh = Mesh::beam(scene.beam.as_ref().unwrap()).unwrap().moved(|x| turn.apply(x)).unwrap();
    let scene = scene.with_material(Material::new(YOUNG, 0.0)).clamp("left").moment("right", moment);
    solved_on(&scene.force("right", turn.apply(Vector2::new(0.0, force))), mesh)
}

/// σ_xx = −M y / I and τ = 3/2 Q/A (1 − 4 y²/h²) hold at every node away from the ends, including the faces.
#[test]
fn stresses_of_a_beam_are_those_of_the_book() {
    let load = 1e-5 * YOUNG / 12.0;
    for kind in ElementKind::all() {
        let bent = straight_beam(kind, load, 0.0, Rotation::IDENTITY);
        let (m, q) = (bent.nodal_stress(), straight_beam(kind, 0.0, load, Rotation::IDENTITY).nodal_stress());
        let nodes = bent.system().mesh().nodes();
        let (mut normal, mut shear) = (0.0f64, 0.0f64);
        for ((x, m), q) in nodes.iter().zip(m.cauchy()).zip(q.cauchy()) {
            if (x.x - 5.0).abs() < 3.0 {
                let exact = Matrix2::new(-12.0 * load * x.y, 0.0, 0.0, 0.0);
                normal = normal.max((m.unwrap().plane - exact).amax() / (6.0 * load));
                let exact = 1.5 * load * (1.0 - 4.0 * x.y * x.y);
                shear = shear.max((q.unwrap().plane.m12 - exact).abs() / (1.5 * load));
            }
        }
        println!("{kind:?}: M y/I to {:.3} %, shear to {:.2} % of the largest", 100.0 * normal, 100.0 * shear);
        assert!(normal < if kind.entry().points.len() == 1 { 0.06 } else { 0.005 }, "{kind:?}: {normal}");
        // Linear patches approximate the parabola worst on the faces; quadratic ones are more accurate.
        assert!(shear < if kind.entry().sides[0].len() == 2 { 0.25 } else { 0.03 }, "{kind:?}: {shear}");
    }
}

/// A body rotated by 37° has rotated stresses; quantities relative to the body are unchanged.
#[test]
fn stresses_rotate_with_the_body() {
    let turn = Rotation::from_angle(37f64.to_radians());
    let load = 1e-4 * YOUNG / 12.0;
    for kind in ElementKind::all() {
        for (name, scene) in [
            ("plate", &|turn| kirsch_plate(kind, cells(kind, 4, 4), 1e-10 * YOUNG, turn) as Simulation),
            ("ring", &|turn| curved_beam(kind, load, turn)),
            ("beam", &|turn| straight_beam(kind, load, load, turn)),
        ] as [(&str, &dyn Fn(Rotation) -> Simulation); 3]
        {
            let (straight, turned) = (scene(Rotation::IDENTITY), scene(turn));
            let (a, b) = (straight.nodal_stress(), turned.nodal_stress());
            let largest = a.largest_von_mises().unwrap().1;
            for (a, b) in a.cauchy().zip(b.cauchy()) {
                let expected = turn.matrix() * a.unwrap().plane * turn.matrix().transpose();
                let off = (b.unwrap().plane - expected).amax();
                assert!(off < 1e-7 * largest, "{kind:?} {name}: {off} of {largest}");
            }
            let [a, b] = [&straight, &turned].map(|body| body.stress_result().mesh_error_percent.unwrap());
            assert!((a - b).abs() < 1e-6 * a, "{kind:?} {name}: {a} {b}");
        }
    }
}

/// At 18 % strain the section is thinner in both directions; Biot's stress is relative to the section at rest.
#[test]
fn cauchy_stress_is_the_force_per_deformed_area() {
    for kind in ElementKind::all() {
        let pull = 0.18 * YOUNG;
        let scene = Scene::beam(4.0, 1.0).with_element(kind).with_cells(4, 2).support("left", &[Axis::X]);
        let scene = scene.with_material(Material::new(YOUNG, 0.3)).support([0.0, -0.5], &[Axis::Y]);
        let simulation = solved(&scene.force("right", [pull, 0.0]));
        let nodal = simulation.nodal_stress();
        let section = (1.0 - 0.3 * 0.18f64).powi(2);
        for (local, cauchy) in nodal.nodes().iter().zip(nodal.cauchy()) {
            let biot = local.biot(nodal.material());
            assert!((biot.von_mises() - pull).abs() < 1e-6 * pull, "{kind:?}: {biot:?}");
            assert!((cauchy.unwrap().von_mises() - pull / section).abs() < 1e-6 * pull, "{kind:?}: {cauchy:?}");
        }
        assert!((simulation.solution().deformation.max_strain - 0.18).abs() < 5e-4);
        assert!(simulation.stress_result().mesh_error_percent.unwrap() < 1e-4);
    }
}

/// Returns the distance of the elements' strains from those of a fine solution, and its estimate from the recovered strains,
/// both in percent of the fine solution's energy norm.
fn mesh_errors(scene: &Scene, fine: &Simulation) -> (f64, Option<f64>) {
    let coarse = solved(scene);
    let (mesh, nodal) = (fine.system().mesh(), fine.nodal_stress());
    let rule: Vec<_> = scene.element().entry().mass_points.iter().map(|point| (point.at, point.weight)).collect();
    let exact = |x| nodal.mean(&mesh.weights(mesh.locate(x).unwrap()).unwrap()).strain;
    let error = strain_error(coarse.problem(), coarse.state(), &rule, exact);
    (100.0 * error, coarse.stress_result().mesh_error_percent)
}

/// On smooth scenes, the estimate is between half and twice the true error for every element.
#[test]
fn the_mesh_error_is_about_the_true_one() {
    for (id, tip) in [("cantilever", 1), ("gravity", 2), ("elastica", 1), ("incline", 1), ("roll-up", 1)] {
        let scene = scene(id);
        let beam = scene.beam.clone().unwrap();
        let fine_across = ((120.0 * beam.height / beam.length).round() as u32).max(2);
        let fine = solved(&scene.clone().with_element(ElementKind::T6).with_cells(120, fine_across));
        for kind in ElementKind::all() {
            for along in [10, 20, 40] {
                let across = ((f64::from(along) * beam.height / beam.length).round() as u32).max(tip);
                let (exact, estimate) = mesh_errors(&scene.clone().with_element(kind).with_cells(along, across), &fine);
                let text = format!("{id} {kind:?} {along}×{across}: {exact} %, {estimate:?} %");
                if kind == ElementKind::Q4 && across == 1 {
                    // In a single row every cell has the same error, which recovery cannot detect.
                    assert_eq!(estimate, None, "{text}");
                    continue;
                }
                let effectivity = estimate.unwrap() / exact;
                println!("{text}: effectivity {effectivity:.2}");
                assert!((0.5..2.0).contains(&effectivity), "{text}");
            }
        }
    }
}

/// Where the mesh is too coarse for an estimate, its field has no values either.
#[test]
fn the_field_of_the_mesh_error_is_known_where_the_error_is() {
    let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1e3]).with_element(ElementKind::Q4);
    for (across, is_known) in [(1, false), (2, true)] {
        let simulation = solved(&scene.clone().with_cells(10, across));
        let error = simulation.stress_result().mesh_error_percent;
        let mut values = Vec::new();
        simulation.field(Field::MeshError, &mut values);
        assert_eq!(values.len(), 4 * simulation.mesh().element_count());
        assert_eq!(error.is_some(), is_known);
        assert!(values.iter().all(|value| value.is_some() == is_known), "{values:?}");
    }
}

/// The estimate detects elements that lock, however well the solution has converged.
#[test]
fn the_mesh_error_is_large_where_elements_lock() {
    let t3 = scene("elastica").with_element(ElementKind::T3).with_cells(20, 1);
    let article = scene_with("article", &["solver.method=\"newton\""]);
    // Six-node triangles fifty times as long as high lock in volume: the error is 65 %.
    let material = Material { plane: Plane::Strain, ..Material::new(YOUNG, 0.4999) };
    let flat = Scene::beam(1000.0, 1.0).with_element(ElementKind::T6).with_cells(20, 1).with_material(material);
    let flat = flat.clamp("left").force("right", [0.0, -0.01 * YOUNG / 12.0 / 1e6]).probe("tip", "right");
    for (name, scene) in [("t3", t3), ("article", article), ("flat", flat)] {
        let simulation = solved(&scene);
        let percent = simulation.stress_result().mesh_error_percent.unwrap();
        let u = simulation.probe("tip").unwrap();
        println!("{name}: mesh error {percent:.1} % in the energy norm");
        assert!(percent > 30.0, "{name}: {percent}");
        if name == "flat" {
            // With E' = E/(1 − ν²), w = P L³ / 3 E' I.
            let w = -0.01 * 1000.0 / 3.0 * (1.0 - 0.4999 * 0.4999);
            println!("  tip {} % off", 100.0 * (u.y - w) / w);
            assert!((u.y / w - 0.35).abs() < 0.1, "{} {w}", u.y);
        } else {
            let reference = Reference::of(simulation.scene()).unwrap().first().unwrap();
            let off = reference.percent(u, reference.displacement);
            println!("  tip {off:.1} % off");
            assert!(off > 30.0, "{name}: {off}");
        }
    }
}

/// JSON, CSV and VTU contain the same number, with the node's number in the mesh file.
#[test]
fn files_and_json_agree_to_the_last_digit() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| folder.path().join(name).display().to_string();
    let csv = out("a.csv");
    let json = solve_json(&["bracket", "--reference=none", "--out", &csv]);
    let vtu = out("a.vtu");
    solve_json(&["bracket", "--reference=none", "--out", &vtu]);
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let csv = std::fs::read_to_string(csv).unwrap();
    let rows = numbers(&csv);
    let column = |name: &str| csv.lines().next().unwrap().split(',').position(|c| c == name).unwrap();
    let in_csv = largest(&mut rows.iter().map(|row| row[column("von_mises")]));
    let vtu = std::fs::read_to_string(vtu).unwrap();
    let array = vtu.split("von Mises (Cauchy) [Pa]").nth(1).unwrap().split("</DataArray>").next().unwrap();
    let in_vtu = largest(&mut array.lines().skip(1).map(|v| v.parse().unwrap()));
    let (node, own) = solved(&scene("bracket")).stress_result().largest.unwrap();
    assert_eq!((in_csv, in_vtu), (own, own));
    assert!((json["max_von_mises"]["value"].as_f64().unwrap() - in_csv).abs() <= 1e-14 * in_csv);
    let row = rows.iter().find(|row| row[column("von_mises")] == in_csv).unwrap();
    assert_eq!(json["max_von_mises"]["node"].as_f64(), Some(row[column("file_node")]));
    assert_eq!(row[0], f64::from(node));
}
