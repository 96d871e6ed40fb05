//! Tests of section forces: the equilibrium of the part cut off, beam theory, and rotating and falling bodies.

use crate::common::*;

/// Returns the part of a polygon on the side of a line to which its normal points.
fn clipped(polygon: &[Vector2<f64>], line: SectionLine) -> Vec<Vector2<f64>> {
    let distance = |x: &Vector2<f64>| line.normal().dot(&(x - line.at));
    let mut part = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (from, to) = (distance(a), distance(&b));
        if from > 0.0 {
            part.push(*a);
        }
        if (from > 0.0) != (to > 0.0) {
            part.push(a + (b - a) * (from / (from - to)));
        }
    }
    part
}

/// Returns area and centroid of a polygon.
fn area_of(polygon: &[Vector2<f64>]) -> (f64, Vector2<f64>) {
    let (mut area, mut first) = (0.0, Vector2::zeros());
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        area += 0.5 * a.perp(&b);
        first += (a + b) * (a.perp(&b) / 6.0);
    }
    (area, first / area)
}

/// Returns the rectangle of a straight beam, and the ends of a named edge.
fn rectangle(scene: &Scene) -> ([Vector2<f64>; 4], impl Fn(&str) -> [Vector2<f64>; 2]) {
    let beam = scene.beam.as_ref().unwrap();
    let (l, h) = (beam.length, 0.5 * beam.height);
    let corners = [[0.0, -h], [l, -h], [l, h], [0.0, h]].map(Vector2::from);
    let edge = move |name: &str| match name {
        "bottom" => [corners[0], corners[1]],
        "right" => [corners[1], corners[2]],
        "top" => [corners[2], corners[3]],
        _ => [corners[3], corners[0]],
    };
    (corners, edge)
}

/// Returns the force in front of a line, N: point loads and reactions by nodes, edge loads and weight by size.
fn force_in_front(simulation: &Simulation, line: SectionLine) -> Vector2<f64> {
    let (scene, mesh) = (simulation.scene(), simulation.mesh());
    let size = scene.beam.as_ref().map_or(1.0, |beam| beam.length.hypot(beam.height));
    let is_in_front = |x: Vector2<f64>| line.normal().dot(&(x - line.at)) > 1e-9 * size;
    let (corners, edge) = rectangle(scene);
    let mut force = Vector2::zeros();
    for load in &scene.loads {
        match load {
            Load::Gravity { acceleration, .. } => {
                let area = area_of(&clipped(&corners, line)).0;
                let mass = scene.material.area_density() * if area > 0.0 { area } else { 0.0 };
                force += Vector2::from(*acceleration) * mass;
            }
            Load::Force { place: Place::Edge(name), force: total, .. } => {
                let [a, b] = edge(name);
                let [from, to] = [a, b].map(|x| line.normal().dot(&(x - line.at)));
                let share = match [from > 0.0, to > 0.0] {
                    [true, true] => 1.0,
                    [false, false] => 0.0,
                    [true, false] => from / (from - to),
                    [false, true] => to / (to - from),
                };
                force += Vector2::from(*total) * share;
            }
            Load::Force { place: Place::At(at), at_point, force: total, .. } => {
                let node = mesh.nodes()[mesh.nearest_node((*at).into()) as usize];
                let at = if *at_point { Vector2::from(*at) } else { node };
                force += if is_in_front(at) { Vector2::from(*total) } else { Vector2::zeros() };
            }
            _ => {}
        }
    }
    // Reactions are minus the residual of fixed unknowns; moments act on the nodes of their edges.
    let (forces, mask) = (simulation.forces(), &simulation.system().pattern().mask);
    let dead = simulation.problem().loads().dead_force();
    for (i, _) in mesh.nodes().iter().enumerate().filter(|(_, x)| is_in_front(**x)) {
        force -= forces.residual()[i].component_mul(&mask[i].map(|free| 1.0 - free));
        force += forces.external[i] - dead[i];
    }
    force
}

fn solved(scene: &Scene) -> Option<Simulation> {
    let mut scene = scene.clone();
    scene.solver.tolerance = 1e-13;
    let mut simulation = Simulation::new(&scene).ok()?;
    (*simulation.solve() == Status::Converged).then_some(simulation)
}

/// Returns the sections of a line from both sides, and the differences of their forces, N, and moments, N m.
fn from_both_sides(simulation: &Simulation, line: SectionLine) -> Option<([Section; 2], f64, f64)> {
    let back = SectionLine { angle: line.angle + PI, ..line };
    let [section, behind] = [simulation.section(line).ok()?, simulation.section(back).ok()?];
    let off = (section.force + behind.force).norm();
    let moment = (section.forces.moment + behind.forces.moment).abs();
    Some(([section, behind], off, moment))
}

/// Returns the largest force of the elements on a node, N: rounding errors are relative to it.
fn largest_force(simulation: &Simulation) -> f64 {
    simulation.forces().magnitude.iter().map(|f| f.norm()).fold(0.0, f64::max)
}

/// The section seen from the other side has the opposite force and moment.
#[test]
fn sections_of_random_scenes_balance_the_part_cut_off() {
    let mut checked = 0;
    for seed in sampled(500..600, 4) {
        let mut scene = random::scene(seed);
        let mut random = Random(seed);
        let beam = scene.beam.clone().unwrap();
        if let Some(Load::Force { place: Place::At(at), at_point, .. }) = scene.loads.first_mut() {
            *at_point = true;
            *at = [random.between(0.0, beam.length), random.between(-0.5, 0.5) * beam.height];
        }
        let Some(simulation) = solved(&scene) else { continue };
        let scale = largest_force(&simulation);
        for _ in 0..3 {
            let at = Vector2::new(random.between(0.0, beam.length), random.between(-0.5, 0.5) * beam.height);
            let line = SectionLine { at, angle: random.between(-3.0, 3.0) };
            let ([section, behind], off, moment_off) = from_both_sides(&simulation, line).unwrap();
            assert!(off < 1e-8 * scale, "seed {seed}, {line:?}: {off} N from the other side, largest force {scale} N");
            let off = (section.force - force_in_front(&simulation, line)).norm();
            assert!(off < 1e-8 * scale, "seed {seed}, {line:?}: {off} N off, largest force {scale} N");
            let arm = (section.ends[1] - section.ends[0]).norm().max(beam.length);
            assert!(moment_off < 1e-8 * scale * arm, "seed {seed}, {line:?}: {moment_off} N m, {scale} N, {arm} m");
            let (own, other) = (section.forces, behind.forces);
            let same = (own.normal - other.normal).abs() + (own.shear - other.shear).abs();
            assert!(same < 1e-8 * scale, "seed {seed}, {line:?}: N and V differ by {same} N");
            checked += 1;
        }
    }
    assert!(checked > 50, "{checked}");
}

/// Under linear theory the moments of a cantilever are those of statics, for every element and inclined lines too.
#[test]
fn moments_under_weight_and_edge_loads_are_those_of_statics() {
    let (l, h, weight, total, tip) = (10.0, 1.0, -3.0, Vector2::new(2.0, -7.0), Vector2::new(5.0, 4.0));
    for element in ElementKind::all() {
        let scene = Scene::beam(l, h).with_element(element).with_cells(7, 2).with_method(MethodKind::Linear);
        let scene = scene.clamp("left").force("top", total).force("right", tip).gravity([0.0, weight]);
        let simulation = solved(&scene).unwrap();
        let mass = simulation.scene().material.area_density();
        let scale = mass * -weight * l * h * l;
        for (x, y, angle) in [(3.0, 0.1, 0.0), (5.0, 0.0, 0.0), (4.1, -0.2, 0.6), (7.7, 0.3, -0.9), (0.0, 0.0, 0.0)] {
            let line = SectionLine { at: [x, y].into(), angle };
            let section = simulation.section(line).unwrap();
            let (corners, _) = rectangle(&scene);
            let (area, centroid) = area_of(&clipped(&corners, line));
            // The top runs from its crossing to the end.
            let from = x - (0.5 * h - y) * angle.tan();
            let top = (total * ((l - from) / l), Vector2::new(0.5 * (from + l), 0.5 * h));
            let own = (Vector2::new(0.0, weight) * (mass * area), centroid);
            let middle = section.middle();
            let wanted: f64 = [top, own, (tip, Vector2::new(l, 0.0))].iter().map(|(f, at)| (at - middle).perp(f)).sum();
            let off = (section.forces.moment - wanted).abs();
            assert!(off < 1e-8 * scale, "{element:?} {line:?}: {} N m, statics {wanted} N m", section.forces.moment);
            let force = top.0 + own.0 + tip;
            assert!((section.force - force).norm() < 1e-8 * scale / l, "{element:?} {line:?}: {:?}", section.force);
        }
    }
}

/// N, V and M of beam theory, and stresses that integrate to them, along a cantilever that hardly bends.
#[test]
fn stresses_along_a_section_are_those_of_beam_theory() {
    for element in ElementKind::all() {
        let scene =
            Scene::beam(10.0, 1.0).with_element(element).with_cells(80, 8).clamp("left").force("right", [0.0, -1.0]);
        let sections = solved(&scene).unwrap().sections(11).unwrap();
        assert_eq!(sections.len(), 11);
        for (i, Section { forces, stress_forces, points, rest, .. }) in sections.iter().enumerate() {
            assert!((rest[0].x - i as f64).abs() < 1e-9 && (rest[1] - rest[0]).norm() > 0.999, "{i}: {rest:?}");
            let off = [(forces.shear + 1.0).abs(), (forces.moment + 10.0 - i as f64).abs()];
            assert!(off[0] < 1e-6 && off[1] < 1e-3, "{i} {forces:?}");
            // The recovered stress is not that of beam theory near the ends.
            if (2..9).contains(&i) {
                let off = [(stress_forces.moment / forces.moment - 1.0).abs(), (stress_forces.shear + 1.0).abs()];
                assert!(off[0] < 0.03 && off[1] < 0.05, "{element:?} {i}: {stress_forces:?}");
                for point in points {
                    let [normal, shear] = point.stress.unwrap();
                    let (largest, mean) = (6.0 * forces.moment.abs(), 1.0);
                    assert!((normal - point.beam.unwrap()[0]).abs() < 0.04 * largest, "{element:?} {i}: {point:?}");
                    assert!((shear - point.beam.unwrap()[1]).abs() < 0.5 * mean, "{element:?} {i}: {point:?}");
                }
            }
        }
    }
}

/// Sections of bodies from mesh files, each cut seen from both sides.
#[test]
fn sections_of_mesh_files_are_opposite_from_both_sides() {
    for (id, at, angle) in [("bracket", [0.05, 0.05], 0.0), ("clip", [0.0, 0.0], 0.0), ("cook", [20.0, 20.0], 0.3)] {
        let simulation = solved(&scene(id)).unwrap();
        let (low, high) = simulation.mesh().bounds();
        let middle = (low + high) * 0.5 + Vector2::from(at) * 1e-3;
        let lines = (0..20)
            .map(|i| SectionLine { at: middle + (high - low) * (0.04 * (f64::from(i) - 10.0)), angle: angle + 0.3 });
        let (mut found, scale) = (0, largest_force(&simulation));
        for line in lines {
            let Some((_, off, moment)) = from_both_sides(&simulation, line) else { continue };
            found += 1;
            assert!(off < 1e-8 * scale, "{id} {line:?}: {off} N of {scale} N");
            assert!(moment < 1e-8 * scale * simulation.system().size(), "{id}");
        }
        assert!(found > 3, "{id}: {found}");
    }
}

/// Returns a simulation of a scene of `tests/data/scenes`, at its end.
fn at_the_end(name: &str) -> Simulation {
    ended(&scene(&file(name)))
}

/// The weight once settled, ½ ρ A ω² (L²/4 − x²) in rotation, nothing in free fall.
#[test]
fn sections_in_motion_carry_the_inertia() {
    let settled = at_the_end("settled");
    let weight = 1000.0 * 0.4 * 10.0;
    for (i, section) in settled.sections(9).unwrap().iter().enumerate() {
        let wanted = Vector2::new(0.0, -weight * (4.0 - 0.5 * i as f64));
        assert!((section.force - wanted).norm() < 1e-3 * weight, "{i}: {:?} N, {wanted:?} N", section.force);
    }
    let spinning = at_the_end("spinning-bar");
    for (i, section) in spinning.sections(33).unwrap().iter().enumerate() {
        let x = 0.125 * i as f64 - 2.0;
        let wanted = 0.5 * 1000.0 * 0.4 * 100.0 * (4.0 - x * x);
        let SectionForces { normal, shear, moment } = section.forces;
        let off = (normal - wanted).abs().max(shear.abs()).max(moment.abs());
        assert!(off < 0.004 * 80e3, "{x} m: {:?}, N = {wanted}", section.forces);
        let is_end = i == 0 || i == 32;
        assert!(!is_end || off < 1e-5 * 80e3, "{x} m: {:?}", section.forces);
    }
    let mut falling = Scene::beam(4.0, 1.0).with_cells(8, 2).gravity([0.0, -9.81]).moving(IntegratorKind::TrBdf2, 0.01);
    falling.dynamics.duration = 0.2;
    let falling = ended(&falling);
    let weight = 9.81 * 4.0 * falling.scene().material.area_density();
    for section in falling.sections(5).unwrap() {
        assert!(section.force.norm() < 1e-6 * weight, "{:?}", section.forces);
    }
}

/// Sections balance from both sides; a free end carries no force, and the clamp minus the reaction.
#[test]
fn sections_of_a_swinging_body_balance_loads_inertia_and_reaction() {
    for (element, integrator) in ElementKind::all().flat_map(|e| IntegratorKind::all().map(move |i| (e, i))) {
        let scene = Scene::beam(4.0, 0.4).with_cells(8, 2).with_element(element).clamp("left");
        let mut scene = scene.gravity([0.0, -9.81]).force("top", [300.0, 900.0]).moving(integrator, 0.01);
        scene.beam.as_mut().unwrap().rise = 0.6;
        scene.material.young = 2e7;
        (scene.dynamics.damping.stiffness, scene.dynamics.damping.mass) = (0.02, 1.0);
        if integrator == IntegratorKind::SymplecticEuler {
            scene.dynamics.time_step = 2e-6;
        }
        (scene.dynamics.iterations, scene.solver.tolerance) = (0, 1e-11);
        let mut simulation = Simulation::new(&scene).unwrap();
        (0..20).for_each(|_| _ = simulation.step());
        let scale = 9.81 * 1.6 * simulation.scene().material.area_density();
        for (x, angle) in [(0.3, 0.1), (1.1, -0.7), (2.0, 0.0), (2.6, 1.2), (3.7, 0.4)] {
            let line = SectionLine { at: [x, 0.6 - 0.15 * (x - 2.0) * (x - 2.0)].into(), angle };
            let (_, off, moment) = from_both_sides(&simulation, line).unwrap();
            assert!(off < 1e-8 * scale, "{element:?} {integrator:?} {line:?}: {off} N of {scale} N");
            // Integrators damp half way through the step, where lever arms are others: by 2e-4 for those of first order.
            let exact = if integrator.entry().order == 1 { 1e-3 } else { 1e-6 };
            assert!(moment < exact * scale, "{element:?} {integrator:?} {line:?}: {moment} N m of {scale} N m");
        }
        let ends = simulation.sections(2).unwrap();
        let free = ends[1].force.norm() + ends[1].forces.moment.abs();
        assert!(free < 1e-6 * scale, "{element:?} {integrator:?}: {free} N at the free end");
        // Forces of other integrators are not those at the end of a step.
        if integrator == IntegratorKind::ImplicitEuler {
            let reaction = simulation.support_reactions()[0].force;
            let off = (ends[0].force + reaction).norm();
            assert!(off < 1e-6 * scale, "{element:?}: {:?} N, reaction {reaction:?} N", ends[0].force);
        }
    }
}

/// A cut through an arch's crown divides the weight, whichever way it is seen.
#[test]
fn curved_elements_are_weighed_with_their_curved_sides() {
    let arch = at_the_end("heavy-arch");
    let whole: f64 = arch.system().nodal_areas().iter().sum();
    assert!((whole - 10.982).abs() < 1e-3, "{whole}");
    for angle in [0.0, PI] {
        let section = arch.section(SectionLine { at: [5.0, 2.0].into(), angle }).unwrap();
        let half = if angle == 0.0 { -0.5 * whole } else { 0.5 * whole };
        assert!((section.force - Vector2::new(0.0, half)).norm() < 1e-9, "{angle}: {:?}", section.force);
    }
    // The parts in front of two parallel lines differ by the part between them.
    let weight = |x: f64, angle: f64| arch.section(SectionLine { at: [x, 2.0].into(), angle }).unwrap().force.y;
    for angle in [0.0, 0.3, -0.5] {
        let step = 1e-4;
        for x in [3.9, 4.7, 5.3, 6.1] {
            let middle = arch.section(SectionLine { at: [x, 2.0].into(), angle }).unwrap();
            let width = (middle.rest[1] - middle.rest[0]).norm() * step * angle.cos();
            let off = weight(x + 0.5 * step, angle) - weight(x - 0.5 * step, angle) - width;
            assert!(off.abs() < 1e-3 * width, "{x} m, {angle}: {off} N of {width} N");
        }
    }
}

/// In linear theory lever arms are those at rest, but the ends of the cut have moved with the body.
#[test]
fn linear_theory_has_lever_arms_at_rest() {
    let strip = at_the_end("moved-edge");
    let solution = strip.solution();
    let moments = [solution.reaction.moment, solution.supports[0].moment];
    assert!(moments.iter().all(|moment| moment.abs() < 1e-6), "{moments:?}");
    let section = strip.section(SectionLine { at: [5.0, 0.0].into(), angle: 0.0 }).unwrap();
    assert!((section.forces.normal + 1000.0).abs() < 1e-6 && section.forces.moment.abs() < 1e-6, "{section:?}");
    let moved = section.ends[0] - section.rest[0];
    assert!((moved - Vector2::new(-0.005, 0.49985)).norm() < 5e-5, "{moved:?}");
    assert_eq!((section.middle(), section.normal()), (Vector2::new(5.0, 0.0), Vector2::x()));
}

#[test]
fn lines_that_miss_a_body_or_cross_it_in_several_places_are_refused() {
    use warpbeam::SectionError;
    let bracket = Simulation::new(&scene("article")).unwrap();
    let (low, high) = bracket.mesh().bounds();
    let line = |at: Vector2<f64>, angle| SectionLine { at, angle };
    let far = high + (high - low);
    assert_eq!(bracket.section(line(far, 0.0)).unwrap_err(), SectionError::Missed);
    // A point outside, on a line that crosses the body once.
    assert!(bracket.section(line(Vector2::new(0.5 * (low.x + high.x), far.y), 0.0)).is_ok());
    let mut arch = Scene::beam(10.0, 0.2).with_cells(40, 2).clamp("left");
    arch.beam.as_mut().unwrap().rise = 3.0;
    let arch = Simulation::new(&arch).unwrap();
    let across = line(Vector2::new(5.0, 1.0), std::f64::consts::FRAC_PI_2);
    assert_eq!(arch.section(across).unwrap_err(), SectionError::Several(2));
    assert!(arch.sections(7).unwrap().iter().all(|section| (section.ends[1] - section.ends[0]).norm() < 0.201));
}

/// The recovered shear stress at a bent beam's free surface is half the axial stress times sin 2α.
#[test]
fn a_slanted_cut_has_no_stress_of_beam_theory() {
    let scene = Scene::beam(10.0, 1.0).with_cells(80, 8).with_element(ElementKind::Q4).clamp("left");
    let beam = solved(&scene.force("right", [0.0, -1.0])).unwrap();
    let at = |angle: f64| beam.section(SectionLine { at: [5.0, 0.0].into(), angle: angle.to_radians() }).unwrap();
    let (normal, slanted) = (at(0.0), at(30.0));
    assert!(normal.points.iter().all(|point| point.beam.is_some()));
    assert!(at(0.5).points.iter().chain(&at(180.0).points).all(|point| point.beam.is_some()));
    assert!(slanted.points.iter().all(|point| point.beam.is_none()));
    let axial = |section: &Section| section.points.last().unwrap().stress.unwrap();
    // The upper end of the slanted cut is half a metre times tan 30° nearer to the clamp.
    let x = 5.0 - 0.5 * 30f64.to_radians().tan();
    let there = beam.section(SectionLine { at: [x, 0.0].into(), angle: 0.0 }).unwrap();
    let expected = 0.5 * axial(&there)[0] * 60f64.to_radians().sin();
    let shear = axial(&slanted)[1];
    assert!((shear.abs() - expected.abs()).abs() < 0.05 * expected.abs(), "{shear} {expected}");
}
