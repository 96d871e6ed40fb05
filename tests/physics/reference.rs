//! Compares reference solutions with independent solutions: the claimed error is right to
//! within the reference's own error.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::*;

/// Returns a mesh of six-node triangles on a grid with a line at every point of a scene, cut from lower left to upper
/// right. It shares no code with the meshes of reference solutions.
fn six_node_grid(scene: &Scene, beam: &Beam, cells: [usize; 2]) -> Mesh {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut add = |place: &Place| {
        if let Place::At(at) = place {
            points.push(*at);
        }
    };
    scene.supports.iter().for_each(|s| add(&s.place));
    scene.probes.iter().for_each(|p| add(&p.place));
    for load in &scene.loads {
        if let Load::Force { place, .. } = load {
            add(place);
        }
    }
    let ends = [[0.0, beam.length], [-0.5 * beam.height, 0.5 * beam.height]];
    // Corners and midpoints alternate. Cells are smaller towards the ends, where slender beams are clamped.
    let lines = [0, 1].map(|axis| {
        let [low, high] = ends[axis];
        let graded = |t: f64| 0.5 * (t + 0.5 * (1.0 - (PI * t).cos()));
        let mut lines: Vec<f64> =
            (0..=cells[axis]).map(|i| low + (high - low) * graded(i as f64 / cells[axis] as f64)).collect();
        for point in &points {
            // The nearest inner line moves to the point.
            let at = point[axis];
            let inner = 1..lines.len() - 1;
            let near = |v: f64| (v - at).abs() < 1e-9 * (high - low);
            if !lines.iter().any(|&v| near(v)) {
                let nearest = inner.clone().min_by(|&a, &b| (lines[a] - at).abs().total_cmp(&(lines[b] - at).abs()));
                let taken =
                    nearest.is_none_or(|n| points.iter().any(|p| p[axis] != at && (lines[n] - p[axis]).abs() < 1e-12));
                match nearest.filter(|_| !taken) {
                    Some(n) => lines[n] = at,
                    None => lines.push(at),
                }
            }
        }
        lines.sort_by(f64::total_cmp);
        let middles: Vec<f64> = lines.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        let pairs = lines.iter().zip(middles.iter().map(Some).chain([None]));
        pairs.flat_map(|(&a, m)| [Some(a), m.copied()]).flatten().collect::<Vec<f64>>()
    });
    let [nx, ny] = [lines[0].len(), lines[1].len()];
    let node = |i: usize, j: usize| (i * ny + j) as u32;
    let nodes = lines[0].iter().flat_map(|&x| lines[1].iter().map(move |&y| Vector2::new(x, y))).collect();
    let mut connectivity = Vec::new();
    for (i, j) in (0..nx - 1).step_by(2).flat_map(|i| (0..ny - 1).step_by(2).map(move |j| (i, j))) {
        let [a, b, c, d] = [node(i, j), node(i + 2, j), node(i + 2, j + 2), node(i, j + 2)];
        let middle = node(i + 1, j + 1);
        connectivity.extend([a, b, c, node(i + 1, j), node(i + 2, j + 1), middle]);
        connectivity.extend([a, c, d, middle, node(i + 1, j + 2), node(i, j + 1)]);
    }
    let edge = |points: Vec<u32>| points.windows(3).step_by(2).filter_map(Segment::new).collect::<Vec<_>>();
    let edges = BTreeMap::from([
        ("left".to_owned(), edge((0..ny).map(|j| node(0, j)).collect())),
        ("right".to_owned(), edge((0..ny).map(|j| node(nx - 1, j)).collect())),
        ("bottom".to_owned(), edge((0..nx).map(|i| node(i, 0)).collect())),
        ("top".to_owned(), edge((0..nx).map(|i| node(i, ny - 1)).collect())),
    ]);
    Mesh::new(nodes, ElementKind::T6, connectivity, edges).unwrap()
}

/// Returns the equilibrium on a mesh of about `nodes` nodes, found from rest or from a coarser mesh.
fn independent(scene: &Scene, nodes: f64, coarser: Option<&Simulation>) -> Option<Simulation> {
    let beam = scene.beam.clone().unwrap();
    let ratio = beam.length / beam.height;
    // The grid has (2 nx + 1) (2 ny + 1) nodes, with square cells if there are enough of them.
    let across = (0.25 * nodes / ratio.max(1.0 / ratio)).sqrt().round().max(2.0);
    let along = (0.25 * nodes / across).round();
    let cells = if ratio >= 1.0 { [along, across] } else { [across, along] }.map(|n| n as usize);
    let mut scene = scene.clone();
    (scene.solver.method, scene.solver.max_iterations) = (MethodKind::Newton, 300);
    let mesh = six_node_grid(&scene, &beam, cells);
    let mut simulation = Simulation::with_mesh(&scene, mesh).unwrap();
    if let Some(coarser) = coarser {
        // By rounding, a node of a side may lie outside.
        let nearest = |x| coarser.displacement()[coarser.mesh().nearest_node(x) as usize];
        let start = |&x: &Vector2<f64>| displacement_at(coarser, x).unwrap_or_else(|| nearest(x));
        let start: Vec<_> = simulation.system().mesh().nodes().iter().map(start).collect();
        simulation.start_from(&start).unwrap();
    }
    (*simulation.solve() == Status::Converged).then_some(simulation)
}

/// Compares a reference with two independent solutions: returns its own error, the distance of those, percent, and words if
/// |claimed − true error| is more than the own error and 1.5 times that distance. `None` if these cannot judge it.
fn compare(seed: u64) -> Option<(f64, f64, Option<String>)> {
    let scene = random::scene(seed);
    let own = ended(&scene);
    let first = Reference::find(&scene, Some(&own), Extent::Quick, &go_on).ok()?.first()?;
    let coarse = independent(&scene, 5e3, None)?;
    let fine = independent(&scene, 14e3, Some(&coarse))?.probe("probe").unwrap();
    let claimed = first.error_percent(&own.solution().probes[0]).unwrap();
    let percent = |a: Vector2<f64>| 100.0 * (a - fine).norm() / fine.norm();
    let apart = Some(percent(coarse.probe("probe").unwrap())).filter(|apart| *apart <= 5.0)?;
    let error = percent(own.probe("probe").unwrap());
    let text = format!(
        "{seed}: claimed {claimed:.4} %, true {error:.4} %, own {:.4} %, independent ones {apart:.4} % apart, {}",
        first.own_error_percent, first.source
    );
    // The errors are percentages of different displacements, so that a large error has a large difference.
    let most = (first.own_error_percent + 1.5 * apart) * (1.0 + 0.01 * error) + 1e-5;
    Some((first.own_error_percent, apart, ((claimed - error).abs() > most).then_some(text)))
}

#[test]
fn claimed_errors_are_true_within_the_own_error_of_the_reference() {
    // All 300 scenes take a quarter of an hour.
    let seeds = sampled(0..300_u64, 20);
    // The longest test of its program: the threads of the others are free at its end.
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let untaken = || std::iter::from_fn(|| seeds.get(next.fetch_add(1, Ordering::Relaxed)).copied());
    let judged: Vec<_> = std::thread::scope(|scope| {
        let judge = || untaken().filter_map(compare).collect::<Vec<_>>();
        let parts: Vec<_> = (0..threads).map(|_| scope.spawn(judge)).collect();
        parts.into_iter().flat_map(|part| part.join().unwrap()).collect()
    });
    let wrong: Vec<_> = judged.iter().filter_map(|(.., wrong)| wrong.as_ref()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(judged.len() * 10 >= seeds.len() * 7, "{judged:?}");
    // Most independent solutions are more accurate than the reference, and many references are sharp.
    assert!(judged.iter().filter(|(own, apart, _)| apart < own).count() * 2 >= judged.len(), "{judged:?}");
    assert!(judged.iter().filter(|(own, ..)| *own < 0.3).count() * 5 >= judged.len() * 2, "{judged:?}");
}

/// Fine meshes fold at the corner of the clamp under large loads; the bound covers the folded state.
#[test]
fn the_reference_does_not_jump_to_a_fold() {
    let scene = |force: f64| {
        let scene = Scene::beam(5.0, 1.0).with_element(ElementKind::Q4).with_method(MethodKind::Newton);
        scene.clamp("left").force("right", [0.0, -force]).probe("tip", "right")
    };
    let references = [100e3, 104e3, 105e3].map(|force| {
        let reference = Reference::of(&scene(force)).unwrap();
        assert!(reference.folds, "{force} N");
        reference.first().unwrap()
    });
    for pair in references.windows(2) {
        let apart = pair[1].percent(pair[0].displacement, pair[1].displacement);
        assert!(apart < 2.0 && apart < pair[1].own_error_percent, "{apart} %");
    }
    let fine = ended(&scene(105e3).with_cells(80, 8));
    let error = references[2].error_percent(&fine.solution().probes[0].clone()).unwrap();
    let own = references[2].own_error_percent;
    assert!((4.0..own).contains(&error), "{error} % of {own}");
    assert!(!Reference::of(&scene(30e3)).unwrap().folds);
}

/// Returns the displacements of the probes of a scene on its mesh with cells this number of times as small, m.
fn on_finer_cells(scene: &Scene, times: u32) -> Option<Vec<Vector2<f64>>> {
    let mut scene = scene.clone().with_method(MethodKind::Newton).with_element(ElementKind::Q4);
    let beam = scene.beam.as_mut()?;
    beam.cells = beam.cells.map(|cells| cells * times);
    scene.solver.max_iterations = 300;
    let mut simulation = Simulation::new(&scene).ok()?;
    let solved = *simulation.solve() == Status::Converged;
    solved.then(|| simulation.solution().probes.iter().map(|probe| probe.u).collect())
}

/// Cells a 32nd of the scene's own size judge the bounds: a logarithm may hide behind a part that converges.
#[test]
fn bounds_beside_points_hold_on_finer_meshes() {
    let seeds = sampled(0..200_u64, 40);
    let in_full = sweeps_run_in_full();
    let (mut judged, mut wrong) = (0, Vec::new());
    for seed in seeds {
        let scene = random::scene_with_points(seed);
        let Ok(reference) = Reference::of(&scene) else { continue };
        let Some(finer) = on_finer_cells(&scene, if in_full { 32 } else { 16 }) else { continue };
        let Some(coarser) = (if in_full { Some(finer.clone()) } else { on_finer_cells(&scene, 8) }) else { continue };
        for (known, (u, coarser)) in reference.probes().iter().zip(finer.into_iter().zip(coarser)) {
            let Some(known) = known else { continue };
            judged += 1;
            let (off, apart) = (known.percent(u, known.displacement), known.percent(u, coarser));
            if off > known.own_error_percent + apart {
                wrong.push(format!("{seed}: {off} %, {apart} % apart, {}", known.own_error()));
            }
        }
    }
    assert!(wrong.is_empty(), "of {judged}: {wrong:#?}");
    assert!(judged > 5, "{judged} bounds");
}

/// Scenes whose bounds were too small: displacements on finer meshes are within them.
#[test]
fn bounds_cover_what_finer_meshes_have_shown() {
    let bounds = |name: &str| {
        let scene = scene(&file(name));
        Reference::of(&scene).unwrap().probes().to_vec()
    };
    // p1 on meshes 32 times as fine as the scene's own.
    assert!(bounds("bound60")[1].unwrap().own_error_percent > 0.11);
    // Six-node triangles with nodes at the forces, 42,000 unknowns.
    let p0 = bounds("bound95")[0].unwrap();
    let off = 100.0 * ((p0.displacement.y - 12.490e-3).abs() + 0.001e-3) / 12.490e-3;
    assert!(off < p0.own_error_percent, "{off} % of {} %", p0.own_error_percent);
    // The fold on 86 × 32 cells of six-node triangles, which moves on.
    let fold: Vec<_> = bounds("fold").into_iter().flatten().collect();
    assert!(fold[0].own_error_percent > 11.3 && fold[1].own_error_percent > 8.5, "{fold:?}");
}
