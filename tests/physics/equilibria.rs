//! Tests of exact equilibria: six-node triangles, Newton's method, certificates, and required accuracies.

use crate::common::*;
use warpbeam::study::rho_text;

/// Returns the load factor and the number of load steps of a search.
fn load_stepping(simulation: &Simulation) -> (f64, u32) {
    let search = simulation.equilibrium().unwrap();
    (search.load_factor(), search.load_steps())
}

fn tip(simulation: &Simulation) -> Vector2<f64> {
    simulation.solution().probes[0].x
}

/// T6 20×1 is within its bound in every row; 40×2 has a tighter bound, for slender beams under moderate loads.
#[test]
fn the_reference_table_is_met() {
    let mut worst = [0.0f64; 3];
    // A row has the kind of load, L/H, α, the angle, two numbers of the elastica and two of Reissner's beam, in units of L.
    for row in include_str!("../data/cantilever.csv").lines().filter(|line| !line.starts_with('#')).skip(1) {
        let (kind, values) = row.split_once(',').unwrap();
        let values: Vec<f64> = values.split(',').map(|value| value.parse().unwrap()).collect();
        let [length, alpha, angle, _, _, x, y, ..] = values[..] else { panic!("{row}") };
        let moderate = length == 50.0 && alpha <= 10.0;
        for (cells, bound, slot) in
            [("[20,1]", if moderate { 0.003 } else { 0.01 }, usize::from(moderate)), ("[40,2]", 0.0005, 2)]
        {
            if slot == 2 && !moderate {
                continue;
            }
            let mut scene = cantilever(length, alpha, &[&format!("beam.cells={cells}")]);
            let direction = Vector2::new(angle.to_radians().cos(), angle.to_radians().sin());
            // EI = 1e6/12; the weight per length is ρ g with ρ = 1000.
            let per_length = alpha * 1e6 / 12.0 / length.powi(3);
            scene.loads = if kind == "gravity" {
                vec![Load::gravity(direction * per_length / 1000.0)]
            } else {
                vec![Load::force("right", direction * per_length * length)]
            };
            let error = (tip(&solved(&scene)) / length - Vector2::new(x, y)).norm();
            worst[slot] = worst[slot].max(error);
            assert!(error <= bound, "{cells} {row}: {:.4} % of L", 100.0 * error);
        }
    }
    let [all, slender, fine] = worst.map(|worst| 100.0 * worst);
    println!("worst errors, % of L: 20×1 {all:.3}, 20×1 slender {slender:.3}, 40×2 slender {fine:.4}");
}

/// Solves from rest under the whole load need no more iterations than these bounds.
#[test]
fn newton_needs_few_solves() {
    let mut most = [0; 4];
    for nu in ["0", "0.3", "0.49"] {
        for (class, lengths, alphas, bound) in [
            (0, &[10.0, 20.0, 50.0][..], &[0.01, 0.1, 1.0, 3.0, 10.0][..], 9),
            (1, &[500.0], &[0.01, 0.1, 1.0, 3.0, 10.0], 15),
            // Some of these follow the path from rest.
            (2, &[10.0, 20.0, 50.0], &[100.0], 80),
            (3, &[10.0, 20.0, 50.0], &[1000.0], 160),
        ] {
            for (&length, &alpha) in pairs(lengths, alphas) {
                let mut simulation = solved(&cantilever(length, alpha, &[&format!("material.poisson={nu}")]));
                let solves = simulation.iterations();
                most[class] = most[class].max(solves);
                assert!(solves <= bound, "L/H {length}, α {alpha}, ν {nu}: {solves} solves");
                assert_eq!(simulation.certify().stable, Some(true));
            }
        }
    }
    println!("most solves: α ≤ 10 {}, L/H = 500 {}, α = 100 {}, α = 1000 {}", most[0], most[1], most[2], most[3]);
}

/// Every case in the range of parameters ends certified.
#[test]
fn every_case_of_the_box_is_certified() {
    let mut missed = Vec::new();
    let elements = [["beam.element=t3", "beam.cells=[80,4]"], ["beam.element=t6", "beam.cells=[20,1]"]];
    let planes = ["material.plane=stress", "material.plane=strain"];
    let poissons = ["material.poisson=0", "material.poisson=0.3", "material.poisson=0.49"];
    let loads = pairs([5.0, 10.0, 50.0, 500.0], [0.01, 1.0, 10.0, 30.0, 100.0, 1000.0]);
    let cases = pairs(pairs(elements, pairs(planes, poissons)), loads);
    for (([element, cells], (plane, nu)), (length, alpha)) in sampled(cases, 5) {
        let mut simulation = ended(&cantilever(length, alpha, &[element, cells, plane, nu]));
        let (status, iterations) = (simulation.status().clone(), simulation.iterations());
        assert!(simulation.displacement().iter().all(|u| u.x.is_finite() && u.y.is_finite()));
        if status != Status::Converged || simulation.certify().stable != Some(true) {
            missed.push(format!("{length} {nu} {plane} {element} α {alpha}: {status:?} after {iterations}"));
        }
    }
    assert!(missed.is_empty(), "{} missed: {missed:#?}", missed.len());
}

/// An end moment of 2πEI/L bends the beam into a circle.
#[test]
fn the_beam_rolls_up_to_a_circle() {
    let mut simulation = solved(&scene("roll-up"));
    let gap = tip(&simulation).norm() / 50.0;
    assert!(gap < 0.005, "{gap}");
    assert!(simulation.iterations() <= 30, "{} solves", simulation.iterations());
    assert_eq!(simulation.certify().stable, Some(true));
    println!("gap {:.3} % of L after {} solves", 100.0 * gap, simulation.iterations());
}

/// The side load selects the direction; the result is the buckled, stable equilibrium.
#[test]
fn the_column_buckles() {
    let mut simulation = solved(&scene("column"));
    assert_eq!(simulation.certify().stable, Some(true));
    assert!(tip(&simulation).y > 5.0);
    let other = solved(&scene_with("column", &["load.0.force=[-700,-2]"]));
    // The result is the mirror image, except for the mesh's diagonals, which are not symmetric.
    let mirrored = Vector2::new(tip(&simulation).x, -tip(&simulation).y);
    assert!((tip(&other) - mirrored).norm() < 0.002 * 20.0, "{} {mirrored}", tip(&other));
    let mut straight = solved(&scene_with("column", &["load.0.force=[-700,0]", "beam.diagonals=same"]));
    assert_eq!(straight.certify().stable, Some(false));
    assert!(tip(&straight).y.abs() < 1e-3, "{}", tip(&straight));
    // The straight column is an equilibrium under any axial load, exactly so for ν = 0.
    let euler = PI.powi(2) * 1e6 / 12.0 / (4.0 * 20.0 * 20.0);
    for (share, stable) in [(0.5, true), (0.95, true), (1.05, false), (1.5, false)] {
        let force = share * euler;
        for method in ["warped", "newton"] {
            let set = [format!("load.0.force=[{},0]", -force), format!("solver.method={method}")];
            let mut simulation = Simulation::new(&scene_with("column", &[&set[0], &set[1]])).unwrap();
            let u: Vec<_> =
                simulation.system().mesh().nodes().iter().map(|x| Vector2::new(-force / 1e6 * x.x, 0.0)).collect();
            simulation.start_from(&u).unwrap();
            assert_eq!(*simulation.status(), Status::Converged, "residual {:e}", simulation.residual());
            assert_eq!(simulation.certify().stable, Some(stable), "{share} of Euler's load, {method}");
        }
    }
}

/// Solves a scene, and returns the length of its last step relative to the one before.
fn last_ratio(simulation: &mut Simulation) -> f64 {
    let mut lengths = [0.0; 2];
    while *simulation.status() == Status::Running {
        let before = simulation.displacement().to_vec();
        simulation.step();
        let step = simulation.displacement().iter().zip(&before).map(|(u, before)| (u - before).norm_squared());
        lengths = [lengths[1], step.sum::<f64>().sqrt()];
    }
    lengths[1] / lengths[0]
}

/// Cook's membrane on n × n cells: the middle of the loaded edge rises by 23.96.
#[test]
fn cooks_membrane_converges() {
    let middle = |element: ElementKind, n: u32| {
        // A unit square, mapped to the membrane.
        let square = Scene::beam(1.0, 1.0).with_cells(n, n).with_element(element);
        let mesh = Mesh::beam(square.beam.as_ref().unwrap()).unwrap();
        let map = |x: Vector2<f64>| Vector2::new(48.0 * x.x, 44.0 * x.x + (x.y + 0.5) * (44.0 - 28.0 * x.x));
        let rename = |name: &str| if name == "left" { "clamp" } else { "end" }.to_owned();
        let edges = ["left", "right"].map(|name| (rename(name), mesh.edges()[name].clone()));
        let mesh = mesh.moved(map).unwrap().with_edges(edges.into()).unwrap();
        solved_on(&scene("cook"), mesh).solution().probes[0].u.y
    };
    let t3: Vec<f64> = [8, 16, 32, 64].map(|n| middle(ElementKind::T3, n)).to_vec();
    let t6: Vec<f64> = [4, 8, 16, 32].map(|n| middle(ElementKind::T6, n)).to_vec();
    println!("Cook's membrane: T3 {t3:?}, T6 {t6:?}");
    for values in [&t3, &t6] {
        let errors: Vec<f64> = values.iter().map(|v| (v - 23.96).abs()).collect();
        assert!(errors.windows(2).all(|w| w[1] < 0.7 * w[0] || w[1] < 0.01), "{values:?}");
    }
    assert!((t6[3] - 23.96).abs() < 0.01, "{t6:?}");
    assert!((t3[3] - 23.96).abs() < 0.15, "{t3:?}");
}

/// Out of iterations, Newton keeps the last equilibrium that it reached, and reports its part of the load.
#[test]
fn a_failure_keeps_the_last_good_state() {
    let mut kept = 0;
    for limit in 1..30 {
        let set = format!("solver.max_iterations={limit}");
        let mut simulation = ended(&scene_with("column", &[&set]));
        let status = simulation.status().clone();
        let size = largest(simulation.displacement());
        assert!(size < 40.0, "after {limit}: {size}");
        if status != Status::Converged {
            assert_eq!(simulation.iterations(), limit);
            assert_eq!(simulation.certify().stable, Some(true), "after {limit}: not a stable state");
            kept += 1;
        }
    }
    assert!(kept > 10);
}

/// If the load of a solved body changes, the solve continues from its state and gives the result of a start at rest.
#[test]
fn a_changed_load_is_followed_from_where_the_body_is() {
    let mut dragged = solved(&cantilever(20.0, 2.0, &[]));
    for alpha in [4.0, 30.0, 200.0, 1.0, 50.0] {
        let scene = cantilever(20.0, alpha, &[]);
        dragged.change_scene(&scene).unwrap();
        assert_eq!(*dragged.solve(), Status::Converged);
        assert!((tip(&dragged) - tip(&solved(&scene))).norm() < 1e-6, "α {alpha}");
    }
}

/// Steps of the warped iteration shrink by ρ, which grows with the load.
#[test]
fn steps_shrink_by_rho() {
    let mut before = 0.0;
    for factor in [0.6, 0.8, 1.0] {
        let mut scene = scene("cantilever").with_method(MethodKind::Warped);
        scene.scale_loads(factor);
        (scene.solver.tolerance, scene.solver.max_iterations) = (1e-11, 2000);
        let mut simulation = Simulation::new(&scene).unwrap();
        let ratio = last_ratio(&mut simulation);
        assert_eq!(*simulation.status(), Status::Converged);
        let rho = simulation.certify().fixed_point_rho.unwrap();
        assert!((ratio / rho - 1.0).abs() < 0.01, "{factor}: {ratio} {rho}");
        assert!(ratio > before && ratio < 1.0);
        before = ratio;
        let says = rho_text(rho).to_string();
        assert!(says.contains("converges near") && says.contains(&format!("{rho:.3}")), "{says}");
    }
    for (rho, text) in [
        (1.0, "leaves this equilibrium: an iteration multiplies a disturbance by ρ = 1.000"),
        (999.0, "ρ = 999.000"),
        (1e3, "ρ = 1.0e3"),
    ] {
        assert!(rho_text(rho).to_string().contains(text), "{}", rho_text(rho));
    }
}

/// Supports fix exactly their unknowns, node by node.
#[test]
fn supports_fix_the_components_that_they_name() {
    let scene = Scene::beam(4.0, 1.0).with_cells(4, 2).clamp("left").support([4.0, -0.5], &[Axis::Y]);
    let simulation = Simulation::new(&scene.support([4.0, 0.5], &[Axis::X])).unwrap();
    let (mesh, pattern) = (simulation.system().mesh(), simulation.system().pattern());
    for (node, x) in (0..).zip(mesh.nodes()) {
        let expected = match (x.x, x.y) {
            (0.0, _) => [true, true],
            (4.0, -0.5) => [false, true],
            (4.0, 0.5) => [true, false],
            _ => [false, false],
        };
        assert_eq!(pattern.fixed(node), expected, "at {x}");
        assert_eq!([0, 1].map(|axis| pattern.mask[node as usize][axis] == 0.0), expected);
    }
    // The product of a nodal vector with one over the free unknowns: fixed unknowns do not count.
    let nodal: Vec<_> = mesh.nodes().iter().map(|x| Vector2::new(1.0 + x.x, 2.0 - 3.0 * x.y)).collect();
    let free: Vec<f64> = (0..simulation.system().dofs()).map(|i| (i as f64 + 1.0).sqrt()).collect();
    let mut spread = vec![Vector2::zeros(); nodal.len()];
    pattern.add_free(&free, 1.0, &mut spread);
    let product: f64 = nodal.iter().zip(&spread).map(|(a, b)| a.dot(b)).sum();
    assert!((pattern.dot(&nodal, &free) / product - 1.0).abs() < 1e-12 && product > 1.0);
    let plain = pattern.norm(&spread);
    assert!((plain / free.iter().map(|v| v * v).sum::<f64>().sqrt() - 1.0).abs() < 1e-12);
    for size in [1e-250, 1e-160, 1e160, 1e250] {
        let scaled: Vec<_> = spread.iter().map(|v| v * size).collect();
        assert!((pattern.norm(&scaled) / (plain * size) - 1.0).abs() < 1e-12, "{size:e}");
    }
    assert_eq!(pattern.fixed(mesh.nodes().len() as u32), [true, true], "no node moves where there is none");
    // The check of the supports gives the same result for bodies of any size at any position.
    for size in [1e-4, 1.0, 1e4] {
        let simulation = Simulation::new(&(Scene::beam(10.0 * size, size).clamp("left").force("right", [0.0, -1.0])));
        assert!(simulation.is_ok(), "{size} m: {:?}", simulation.err());
        // A body supported along its middle line only can rotate, at any position.
        let hinged = Scene::beam(10.0 * size, size).with_cells(4, 2).support([0.0, 0.0], &[Axis::X, Axis::Y]);
        assert!(Simulation::new(&hinged).is_err());
        let two = hinged.support([10.0 * size, 0.0], &[Axis::X]);
        assert!(Simulation::new(&two).is_err(), "two bars in line");
        assert!(Simulation::new(&two.support([10.0 * size, 0.0], &[Axis::Y])).is_ok());
    }
    let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]).with_method(MethodKind::Linear);
    let near = solved(&scene);
    let far = solved_on(&scene, near.mesh().moved(|x| x + Vector2::new(1e6, -3e6)).unwrap());
    let off = largest_distance(near.displacement(), far.displacement());
    assert!(off < 1e-6 * largest(near.displacement()), "{off}");
}

/// A reset before, at or after the end restores the start of the scene and discards all results.
#[test]
fn a_reset_goes_back_to_the_start() {
    for id in ["cantilever", "swing", "spin"] {
        for method in [MethodKind::Newton, MethodKind::Auto] {
            let mut scene = scene(id).with_method(method);
            if id != "cantilever" {
                scene.dynamics.duration = 0.2;
            }
            let fresh = Simulation::new(&scene).unwrap();
            let mut simulation = ended(&scene);
            let place = |s: &Simulation| (s.displacement().to_vec(), s.state().velocity().to_vec(), s.state().time());
            assert!(place(&simulation) != place(&fresh));
            if id == "cantilever" {
                assert!(simulation.residual() <= scene.solver.tolerance.max(1e-3), "{:e}", simulation.residual());
                assert_eq!(simulation.equilibrium().unwrap().certificate(), None, "nobody has asked");
                let certificate = simulation.certify();
                assert_eq!(certificate.stable, Some(true));
                assert_eq!(simulation.equilibrium().unwrap().certificate(), Some(certificate));
            }
            simulation.reset();
            assert!(place(&simulation) == place(&fresh), "{id} {method:?}");
            assert_eq!((simulation.status(), simulation.iterations()), (fresh.status(), 0));
            assert_eq!(simulation.residual(), fresh.residual());
            assert_eq!(simulation.equilibrium().and_then(Equilibrium::certificate), None);
        }
    }
}

/// `auto` takes load steps to the result of Newton's method. Out of iterations, it keeps an equilibrium of less load.
#[test]
fn auto_takes_load_steps_where_needed() {
    for (id, factor) in [("cantilever", 60.0), ("elastica", 30.0)] {
        let mut scene = scene(id);
        scene.scale_loads(factor);
        let newton = solved(&scene.clone().with_method(MethodKind::Newton));
        let auto = solved(&scene.with_method(MethodKind::Auto));
        assert_eq!(auto.equilibrium().unwrap().auto_report().unwrap().decision, Decision::LoadSteps, "{id}");
        assert_eq!(load_stepping(&auto), load_stepping(&newton), "{id}");
        assert!(auto.equilibrium().unwrap().load_steps() > 1);
        assert!((tip(&auto) - tip(&newton)).norm() < 1e-6 * tip(&newton).norm(), "{id}");
    }
    // The last iterate balances the reported part of the load; the residual is that of the whole load.
    for (method, factor, limit) in
        [(MethodKind::Newton, 3.0, 50), (MethodKind::Newton, 30.0, 60), (MethodKind::Auto, 30.0, 60)]
    {
        let part = |factor: f64, limit: u32| {
            let mut scene = scene("roll-up").with_method(method);
            scene.scale_loads(factor);
            scene.solver.max_iterations = limit;
            ended(&scene)
        };
        let mut stopped = part(factor, limit);
        assert_eq!(*stopped.status(), Status::NotConverged(Reason::IterationLimit(limit)));
        let (reached, steps) = load_stepping(&stopped);
        assert!(reached > 0.0 && reached < 1.0 && steps > 1, "{method:?}: {reached} in {steps} steps");
        let (problem, state) = (stopped.problem(), stopped.state());
        let residual = problem.balance(state, Kinematics::Corotated, reached, &mut forces_at(problem, state));
        assert!(residual < 2e-3 && stopped.residual() > 1e-3, "{method:?}: {residual} {}", stopped.residual());
        if factor > 3.0 {
            assert!(steps > 3, "{method:?}: {reached} in {steps} steps");
            continue;
        }
        assert_eq!(stopped.certify().stable, Some(true));
        let [a, b] = [&stopped, &part(factor * reached, 400)].map(|s| s.probe("tip").unwrap());
        assert!((a - b).norm() < 1e-3 * b.norm(), "{a} {b}");
    }
}

/// The warped iteration reports why it ends: it converges, stalls, or diverges.
#[test]
fn the_warped_iteration_reports_why_it_ends() {
    let end = |factor: f64, tolerance: f64| {
        let mut scene = scene("cantilever").with_method(MethodKind::Warped);
        scene.scale_loads(factor);
        scene.solver.tolerance = tolerance;
        let mut simulation = Simulation::new(&scene).unwrap();
        let end = (simulation.solve().clone(), simulation.iterations(), simulation.residual());
        assert_eq!(load_stepping(&simulation), (1.0, 1), "all of the load at once");
        assert_eq!(simulation.status().is_success(), *simulation.status() == Status::Converged);
        end
    };
    for (factor, tolerance) in [(1.0, 1e-8), (0.5, 1e-14)] {
        let (status, _, residual) = end(factor, tolerance);
        assert!(status == Status::Converged && residual <= tolerance, "{factor}: {status:?}, {residual:e}");
    }
    let (status, iterations, residual) = end(10.0, 1e-8);
    assert!(matches!(status, Status::Diverged(Reason::Stalled(30))), "{status:?}");
    assert!(residual > 1e-3 && iterations < 60, "{residual} {iterations}");
    let (status, iterations, _) = end(1e8, 1e-8);
    assert!(matches!(status, Status::Diverged(Reason::RanAway(_))) && iterations == 1, "{status:?} {iterations}");
}

/// The body starts from rest if a new support fixes an unknown that has moved; otherwise it keeps its state.
#[test]
fn a_support_on_moved_nodes_restarts_the_search() {
    let scene = Scene::beam(10.0, 1.0).with_cells(10, 2).clamp("left").force("right", [50.0, -300.0]);
    let mut scene = scene.with_method(MethodKind::Newton);
    scene.solver.max_iterations = 100;
    for axis in [Axis::X, Axis::Y] {
        let mut simulation = solved(&scene);
        assert!(simulation.displacement().iter().any(|u| u.x.abs() > 1e-3 && u.y.abs() > 1e-3));
        simulation.change_scene(&scene.clone().support([10.0, 0.5], &[axis])).unwrap();
        assert!(simulation.displacement().iter().all(|u| u.norm() == 0.0), "{axis:?}");
    }
    let mut simulation = solved(&scene);
    simulation.change_scene(&scene.clone().support([0.0, 0.5], &[Axis::X])).unwrap();
    assert!(simulation.displacement().iter().any(|u| u.norm() > 0.0), "it holds what was held");
}

/// The status says that the result was accepted. If the search converges earlier, the status is converged.
#[test]
fn a_result_is_accepted_after_the_iterations_that_a_scene_asks_for() {
    for method in ["newton", "warped"] {
        for n in [1, 3, 5] {
            let asked = [format!("solver.method={method}"), format!("solver.accept_after={n}")];
            let scene = scene_with("cantilever", &asked.each_ref().map(String::as_str));
            let accepted = ended(&scene);
            let status = accepted.status().clone();
            let mut whole = scene.clone();
            whole.solver.accept_after = 0;
            let mut stepped = Simulation::new(&whole).unwrap();
            (0..n).for_each(|_| _ = stepped.step());
            let converged = *stepped.status() == Status::Converged;
            assert_eq!(status, if converged { Status::Converged } else { Status::Accepted }, "{method} {n}");
            assert!(status.is_success() && accepted.iterations() <= n);
            assert_eq!(accepted.solution().probes[0].u, stepped.solution().probes[0].u, "{method} {n}");
        }
    }
}

/// A support that slides has its reaction where the body is.
#[test]
fn reactions_balance_moments_about_the_current_places() {
    let beam = Scene::beam(10.0, 1.0).with_cells(20, 2).with_method(MethodKind::Newton);
    let rolling = beam.support([0.0, -0.5], &[Axis::X, Axis::Y]).support([10.0, -0.5], &[Axis::Y]);
    let scene = rolling.force([5.0, 0.5], [100.0, -6000.0]);
    let unmoved = Simulation::new(&scene).unwrap().solution().reaction;
    assert!(unmoved.force.norm() < 1e-9 && unmoved.moment.abs() < 1e-9, "{unmoved:?}");
    let simulation = solved(&scene);
    let places = simulation.system().mesh().nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u);
    let external = &simulation.forces().external;
    let force: Vector2<f64> = external.iter().sum();
    let moment: f64 = places.zip(external).map(|(x, f)| x.perp(f)).sum();
    let reaction = simulation.solution().reaction;
    assert!((reaction.force + force).norm() < 1e-6 * force.norm(), "{reaction:?} {force}");
    assert!((reaction.moment + moment).abs() < 1e-6 * moment.abs(), "{reaction:?} {moment}");
    assert!(largest(simulation.displacement()) > 0.3, "it is bent, so that lever arms differ");
}
