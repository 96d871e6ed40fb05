//! Reference solutions of a scene on refined meshes, up to one with a small error.

use std::cmp::Reverse;
use std::ops::ControlFlow;

use super::convergence::remaining_error;
use super::prelude::*;
use super::reference::{MovedPoint, Reference, first_probe, is_unstable, probes_of};
use crate::assembly::Forces;
use crate::mesh::{bent, straightened};
use crate::method::{Workspace, is_stable};
use crate::rotation::Rotation;
use crate::scene::Beam;
use crate::state::{largest, largest_distance};

/// Largest number of unknowns of a mesh, of a search of each [`Extent`].
const MAX_UNKNOWNS: [usize; 3] = [3500, 10_000, 700_000];
/// Largest sum of unknowns over all solves.
const MAX_WORK: [f64; 3] = [1e5, 5e5, f64::INFINITY];
/// Error, relative to the displacement, below which no finer mesh is tried.
const GOOD_ENOUGH: [f64; 3] = [1e-3, 1e-3, 1e-4];

/// Returns the element of fine solutions: the one of the highest degree that the scene's mesh can have, which converges
/// fastest.
pub(super) fn finest_element(scene: &Scene) -> ElementKind {
    scene.elements().min_by_key(|e| Reverse(e.entry().degree())).unwrap_or_else(|| scene.element())
}

/// Number of refinements of a beam's coarsest mesh, whose number of cells is chosen so that the finest mesh is about as
/// large as the budget.
const REFINEMENTS: i32 = 3;
/// Distances of mesh lines from the ends of a slender beam, relative to its height; sections do not stay plane there.
const LAYERS: [f64; 3] = [0.25, 1.0, 4.0];
/// Number of meshes needed to show a rate of convergence.
const MIN_MESHES: usize = 3;
/// Distance between two mesh lines, relative to the cell size in the other direction, below which they are merged.
const NARROWEST: f64 = 1e-4;
/// Iteration limit of Newton's method per mesh.
const MAX_ITERATIONS: u32 = 1000;
/// Number of solves on a mesh for which there must be work left.
const MIN_SOLVES_LEFT: f64 = 4.0;
/// Part of the work that a solve towards a fold may add.
const FOLD_SHARE: f64 = 1.5;
/// Distance of the folds on still finer meshes, relative to that of the first: a fold has no limit, and grows with them.
const FARTHER_FOLD: f64 = 1.5;
const TOLERANCE: f64 = 1e-11;

impl Reference {
    /// Computes the reference solution of a scene by a quick search.
    ///
    /// ```
    /// use warpbeam::{MovedPoint, ProbeReference, Reference, ReferenceSource, Scene, Simulation};
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]).probe("tip", "right");
    /// let reference = Reference::of(&scene)?;
    /// for MovedPoint { key, distance, .. } in &reference.moved {
    ///     println!("{key} acts on a node {distance} m away");
    /// }
    /// assert!(reference.moved.is_empty(), "the scene names edges, not points");
    /// let reference: ProbeReference = reference.first().ok_or("no reference")?;
    /// // P L³/(3 E I) = 4 mm, and a little more by shear.
    /// assert!((reference.displacement.y + 0.004).abs() < 0.0001);
    /// assert_eq!(reference.source, ReferenceSource::ExactBeam);
    /// let mut beam = Simulation::new(&scene)?;
    /// beam.solve();
    /// let error = reference.percent(beam.probe("tip").unwrap_or_default(), reference.displacement);
    /// assert!(error < 2.0, "the tip is off by {error} %");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Same errors as [`Self::find`].
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        Self::find(scene, None, Extent::Quick, &|_| ControlFlow::Continue(()))
    }

    /// Computes the reference solution of a scene: of several equilibria the one to which loading from rest leads. With
    /// `near`, a simulation of the scene on a mesh of its own, that mesh is refined. The example of [`crate::Study::new`]
    /// has an observer.
    ///
    /// # Errors
    /// [`StudyError`]: the scene is dynamic or has no probe, its mesh is too fine to be refined, the fine solutions do
    /// not converge, or the search was cancelled.
    pub fn find(
        scene: &Scene,
        near: Option<&Simulation>,
        extent: Extent,
        observe: Observer<'_>,
    ) -> Result<Self, StudyError> {
        match near {
            Some(_) => scene.validate_all_but_geometry(None),
            None => scene.validate(),
        }
        .map_err(SimulationError::from)?;
        if scene.analysis == Analysis::Dynamic {
            return Err(StudyError::InMotion);
        }
        if scene.probes.is_empty() {
            return Err(StudyError::NoProbe);
        }
        if near.is_some_and(|near| is_unstable(near, true)) {
            return Err(StudyError::Unstable);
        }
        match on_fine_meshes(scene, near, extent, observe) {
            Err(StudyError::NoReference) => Self::of_slender(scene).ok_or(StudyError::NoReference),
            found => found,
        }
    }
}

/// Computes the reference solution as [`Reference::find`]: on each mesh the end of the load path from rest.
fn on_fine_meshes(
    original: &Scene,
    near: Option<&Simulation>,
    extent: Extent,
    observe: Observer<'_>,
) -> Result<Reference> {
    let mut scene = original.clone();
    // Quadrilaterals of beams lock neither in bending nor near incompressibility.
    scene.set_element(if scene.beam.is_some() { ElementKind::Q4 } else { finest_element(&scene) });
    (scene.solver.method, scene.solver.accept_after) = (MethodKind::Newton, 0);
    scene.solver.max_iterations = MAX_ITERATIONS;
    scene.solver.tolerance = scene.solver.tolerance.min(TOLERANCE);
    let (mut mesh, moved) = coarsest(&mut scene, near, extent)?;
    let has_point = scene.acts_on_points();
    let mut work = 0.0;
    let mut solutions: Vec<Vec<Vector2<f64>>> = Vec::new();
    let mut finest: Option<Simulation> = None;
    let (mut solved, mut folds) = (Vec::new(), false);
    loop {
        let mut simulation = Simulation::with_mesh(&scene, bent_to_arch(&scene, &mesh)?)?;
        let start = finest.as_ref().map(|coarser| coarser.mesh().prolonged(coarser.displacement()));
        if let Some(start) = &start {
            simulation.start_from(start).map_err(|_| StudyError::NoReference)?;
        }
        solve(&mut simulation, extent, &mut work, observe)?;
        let is_solved = *simulation.status() == Status::Converged;
        if is_solved && start.is_some_and(|start| is_far(&start, &simulation)) {
            // Near a critical load, the coarser solution may lead to another equilibrium.
            simulation.reset();
            solve(&mut simulation, extent, &mut work, observe)?;
        }
        if *simulation.status() == Status::Running && finest.is_some() && has_fold(&scene, &simulation) {
            // The bound needs the state that the fold leads to.
            work -= FOLD_SHARE * MAX_WORK[extent as usize];
            solve(&mut simulation, extent, &mut work, observe)?;
        }
        let next = 4 * simulation.system().dofs();
        match (simulation.status(), &finest) {
            (Status::Converged, _) if !has_fold(&scene, &simulation) => {
                solutions.push(probes_of(&simulation));
                solved = with_errors(&solutions, has_point);
                finest = Some(simulation);
            }
            // A finer mesh may have a solution.
            (_, None) => {}
            (Status::Converged, Some(_)) => {
                for ((u, error), folded) in solved.iter_mut().zip(probes_of(&simulation)) {
                    let distance = (folded - *u).norm();
                    *error = Some(error.unwrap_or(distance) + FARTHER_FOLD * distance);
                }
                folds = true;
                break;
            }
            // The budget is spent; use the previous meshes.
            (Status::Running, Some(_)) => break,
            // Without an equilibrium on a finer mesh, the coarser one was no solution of the continuous problem.
            (_, Some(_)) => return Err(StudyError::NoReference),
        }
        let is_fine_enough = solutions.len() >= MIN_MESHES && is_good_enough(&solved, extent);
        let needed = work + MIN_SOLVES_LEFT * next as f64;
        if is_fine_enough || next > MAX_UNKNOWNS[extent as usize] || needed > MAX_WORK[extent as usize] {
            break;
        }
        mesh = mesh.refined();
    }
    let simulation = finest.ok_or(StudyError::NoReference)?;
    // A state with inverted elements is not a solution of the continuous problem.
    let is_inverted = simulation.system().elements().smallest_area_ratio(simulation.displacement()) <= 0.0;
    let (problem, state) = (simulation.problem(), simulation.state());
    let mut workspace = Workspace::new(simulation.system()).map_err(SimulationError::from)?;
    let mut forces = Forces::new(state.displacement().len());
    // Descent of the energy may end in an unstable equilibrium.
    if is_inverted || !is_stable(problem, state, 1.0, &mut forces, &mut workspace) {
        return Err(StudyError::NoReference);
    }
    let mut linear = Simulation::with_system(&scene.with_method(MethodKind::Linear), simulation.system().clone())?;
    linear.solve();
    let mut reference = Reference::of_finest(original, &simulation, &solved);
    (reference.linear, reference.moved, reference.folds) = (first_probe(&linear).ok(), moved, folds);
    Ok(reference)
}

/// Returns `true` if a solution is so far from the one it was started from that it may be another equilibrium.
fn is_far(start: &[Vector2<f64>], simulation: &Simulation) -> bool {
    /// Distance relative to the largest displacement.
    const FAR: f64 = 0.03;
    let u = simulation.displacement();
    largest_distance(start, u) > FAR * largest(u).max(largest(start))
}

/// Returns `true` if a rectangle has a fold, as the corner of a clamp has under large compression: the law between stress
/// and strain then resists no longer, and a fine mesh jumps to a state in which the surface touches itself. Meshes of
/// files may have cracks, whose sides rotate apart.
fn has_fold(scene: &Scene, simulation: &Simulation) -> bool {
    /// Angle between two elements at a node, rad; without folds `article` has up to 46°, with folds 94° to 180°.
    const FOLDED: f64 = 60.0 * std::f64::consts::PI / 180.0;
    if scene.beam.is_none() {
        return false;
    }
    let mesh = simulation.system().mesh();
    let mut first: Vec<Option<Rotation>> = vec![None; mesh.nodes().len()];
    mesh.elements().zip(simulation.element_rotations()).any(|(nodes, rotation)| {
        nodes.iter().any(|&node| {
            let first = first[node as usize].get_or_insert(rotation);
            let relative = rotation.apply_inverse(first.apply(Vector2::x()));
            relative.y.atan2(relative.x).abs() > FOLDED
        })
    })
}

/// Returns the displacement of every probe in the last of these solutions, m, with the bound of its error.
fn with_errors(solutions: &[Vec<Vector2<f64>>], has_point: bool) -> Vec<(Vector2<f64>, Option<f64>)> {
    let of = |probe: usize| solutions.iter().map(|u| u[probe]).collect::<Vec<_>>();
    let last = solutions.last().into_iter().flatten().enumerate();
    last.map(|(probe, &u)| (u, remaining_error(&of(probe), has_point))).collect()
}

/// Returns `true` if the errors of all probes with significant displacement are small enough to stop the search.
fn is_good_enough(solved: &[(Vector2<f64>, Option<f64>)], extent: Extent) -> bool {
    /// Displacement relative to the largest of all probes below which a probe is ignored.
    const LITTLE: f64 = 0.01;
    let largest = solved.iter().map(|(u, _)| u.norm()).fold(0.0, f64::max);
    let mut counts = solved.iter().filter(|(u, _)| u.norm() > LITTLE * largest);
    counts.all(|(u, error)| error.is_some_and(|error| error <= GOOD_ENOUGH[extent as usize] * u.norm()))
}

/// Iterates until the status is final or the budget is spent, and adds the unknowns of all iterations to `work`.
fn solve(simulation: &mut Simulation, extent: Extent, work: &mut f64, observe: Observer<'_>) -> Result<()> {
    let unknowns = simulation.system().dofs();
    let now = sentence!("the reference solution, %{n} unknowns", n = unknowns);
    let fraction = (unknowns as f64 / MAX_UNKNOWNS[extent as usize] as f64).min(1.0);
    while *simulation.status() == Status::Running && *work <= MAX_WORK[extent as usize] {
        check(observe(Progress { fraction, now: Some(&now) }))?;
        let before = simulation.iterations();
        simulation.step();
        *work += f64::from(simulation.iterations() - before) * unknowns as f64;
    }
    Ok(())
}

/// Returns the coarsest mesh of a scene, of an arch before it is bent, and the points of the scene that have no node: they are
/// moved to the nearest one, which is the same on every mesh.
fn coarsest(scene: &mut Scene, near: Option<&Simulation>, extent: Extent) -> Result<(Mesh, Vec<MovedPoint>)> {
    let meshed = |scene: &Scene| System::mesh_of(scene).map_err(SimulationError::from);
    let own = match (&scene.beam, near) {
        (Some(beam), _) => grid(scene, beam).ok_or(StudyError::NoReference)?,
        (None, Some(near)) => near.mesh().clone(),
        (None, None) => meshed(scene)?,
    };
    let unknowns = scene.mesh.as_ref().map_or(2 * own.nodes().len(), |_| scene.unknowns() as usize);
    if scene.beam.is_none() && 4 * unknowns > MAX_UNKNOWNS[extent as usize] {
        return Err(StudyError::TooFine { elements: own.element_count() });
    }
    let body = bent_to_arch(scene, &own)?;
    let moved = moved_points(scene, &body);
    for (_, place, width) in places(scene) {
        if let (Place::At(at), None) = (place, width) {
            *at = body.node(body.nearest_node((*at).into())).into();
        }
    }
    // A mesh given by the caller is kept.
    let is_final = scene.mesh.is_none() || own.element() == scene.element();
    Ok((if is_final { own } else { meshed(scene)? }, moved))
}

/// Returns the mesh of a body: that of a beam is bent to its arch.
fn bent_to_arch(scene: &Scene, straight: &Mesh) -> Result<Mesh> {
    match scene.beam.as_ref().filter(|beam| beam.rise != 0.0) {
        None => Ok(straight.clone()),
        Some(beam) => straight.moved(|x| bent(beam, x.x / beam.length, x.y)).map_err(|_| StudyError::NoReference),
    }
}

/// Returns the places of a scene's supports and forces, each with the key of its table, and with its width if it acts at
/// the point itself instead of on the nearest node.
fn places(scene: &mut Scene) -> impl Iterator<Item = (String, &mut Place, Option<f64>)> {
    let supports = scene.supports.iter_mut().enumerate();
    let supports = supports.map(|(i, s)| (format!("support.{i}"), &mut s.place, s.at_point.then_some(s.width)));
    let loads = scene.loads.iter_mut().enumerate().filter_map(|(i, load)| match load {
        Load::Force { place, at_point, width, .. } => Some((format!("load.{i}"), place, at_point.then_some(*width))),
        _ => None,
    });
    supports.chain(loads)
}

/// Returns the points of a scene, of supports and forces that act on nodes, whose nearest node of its mesh is farther away
/// than rounding errors.
pub fn moved_points(scene: &Scene, mesh: &Mesh) -> Vec<MovedPoint> {
    const ROUNDING: f64 = 1e-9;
    let (low, high) = mesh.bounds();
    let moved = |(key, place, width): (String, &mut Place, Option<f64>)| {
        let Place::At(at) = *place else { return None };
        let distance = (mesh.node(mesh.nearest_node(at.into())) - Vector2::from(at)).norm();
        let is_on_node = width.is_none() || mesh.locate(at.into()).is_none();
        let is_moved = is_on_node && distance > ROUNDING * (high - low).norm();
        is_moved.then_some(MovedPoint { key, at, distance })
    };
    places(&mut scene.clone()).filter_map(moved).collect()
}

/// Returns the coarsest mesh of a beam's straight rectangle, with cells about as long as high if there are enough, with
/// lines through every point of the scene and finer cells at the ends of a slender beam. `None` if its cells are too
/// thin.
fn grid(scene: &Scene, beam: &Beam) -> Option<Mesh> {
    let size = [beam.length, beam.height];
    let (mut own, mut wanted) = (scene.clone(), [Vec::new(), Vec::new()]);
    let probes = scene.probes.iter().map(|probe| (&probe.place, 0.0));
    for (place, width) in places(&mut own).map(|(_, place, width)| (&*place, width.unwrap_or(0.0))).chain(probes) {
        let Place::At([x, y]) = *place else { continue };
        // A width has lines at its ends, so that each mesh resolves it.
        let ends: &[f64] = if width == 0.0 { &[0.0] } else { &[-0.5, 0.5] };
        for end in ends {
            let [along, across] = straightened(beam, Vector2::new(x + end * width, y));
            wanted[0].push(along * size[0]);
            wanted[1].push(across + 0.5 * size[1]);
        }
    }
    let halvings = 2f64.powi(REFINEMENTS);
    // The finest mesh has 2 (2³ nx + 1) (2³ ny + 1) unknowns.
    let nodes = 0.5 * MAX_UNKNOWNS[Extent::Quick as usize] as f64;
    let cells = |short: f64| ((nodes / (halvings * short + 1.0) - 1.0) / halvings).floor();
    let square = (nodes / halvings.powi(2) * size[0].min(size[1]) / size[0].max(size[1])).sqrt().round().max(1.0);
    let long = usize::from(size[1] > size[0]);
    let [length, height] = [size[long], size[1 - long]];
    if cells(square).max(1.0) * height < 2.0 * length {
        wanted[long].extend(LAYERS.iter().flat_map(|layer| [layer * height, length - layer * height]));
    }
    let mut counts = [square; 2];
    counts[long] = (cells(square) - wanted[long].len() as f64).max(1.0);
    let [columns, rows] = [0, 1].map(|axis| {
        let narrowest = NARROWEST * size[1 - axis] / counts[1 - axis];
        lines(size[axis], std::mem::take(&mut wanted[axis]), counts[axis], narrowest)
    });
    let cells = [&columns, &rows].map(|lines| lines.len() as u32 - 1);
    let [nx, ny] = cells.map(f64::from);
    // A mesh with cells of 1 m × 1 m has its nodes at the numbers of the lines.
    let numbers = Mesh::beam(&Beam { length: nx, height: ny, cells, rise: 0.0, ..beam.clone() }).ok()?;
    let line = |lines: &[f64], number: f64| lines[number.round() as usize];
    numbers.moved(|x| Vector2::new(line(&columns, x.x), line(&rows, x.y + 0.5 * ny) - 0.5 * size[1])).ok()
}

/// Returns the boundaries of about `cells` equal intervals from 0 to `end`, with one at each value of `wanted` that is
/// not nearer than `narrowest` to another.
fn lines(end: f64, mut wanted: Vec<f64>, cells: f64, narrowest: f64) -> Vec<f64> {
    wanted.retain(|v| (narrowest..=end - narrowest).contains(v));
    wanted.sort_by(f64::total_cmp);
    wanted.dedup_by(|b, a| *b - *a < narrowest);
    let mut lines = vec![0.0];
    for to in wanted.into_iter().chain([end]) {
        let from = lines[lines.len() - 1];
        let count = (cells * (to - from) / end).round().max(1.0);
        lines.extend((1..count as u32).map(|i| from + (to - from) * f64::from(i) / count));
        lines.push(to);
    }
    lines
}
