//! Reference solutions of a scene on refined meshes, up to one with a small error.

use std::cmp::Reverse;
use std::ops::ControlFlow;

use super::convergence::remaining_error;
use super::prelude::*;
use super::reference::{MovedPoint, Reference, is_unstable, probes_of};
use crate::assembly::Forces;
use crate::element::ElementType;
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
    let mut scene = prepared(original);
    scene.solver.tolerance = scene.solver.tolerance.min(TOLERANCE);
    let (mut meshes, moved) = Meshes::of(&mut scene, near, extent)?;
    let has_point = scene.acts_on_points();
    let mut work = 0.0;
    let mut solutions: Vec<Vec<Vector2<f64>>> = Vec::new();
    let mut start: Option<Vec<Vector2<f64>>> = None;
    let mut finest = None;
    let mut fold: Vec<f64> = Vec::new();
    loop {
        let mut simulation = Simulation::with_mesh(&scene, meshes.mesh()?)?;
        if let Some(start) = &start {
            simulation.start_from(start).map_err(|_| StudyError::NoReference)?;
        }
        let mut status = solve(&mut simulation, extent, &mut work, observe)?;
        if status == Status::Converged && start.as_ref().is_some_and(|start| is_far(start, &simulation)) {
            // Near a critical load, the coarser solution may lead to another equilibrium.
            simulation.reset();
            status = solve(&mut simulation, extent, &mut work, observe)?;
        }
        if status == Status::Running && !solutions.is_empty() && has_fold(&scene, &simulation) {
            // The bound needs the state that the fold leads to.
            work -= FOLD_SHARE * MAX_WORK[extent as usize];
            status = solve(&mut simulation, extent, &mut work, observe)?;
        }
        let converged = match status {
            Status::Converged => true,
            // The budget is spent; use the previous meshes.
            Status::Running if !solutions.is_empty() => break,
            _ => false,
        };
        let unknowns = simulation.system().dofs();
        let is_folded = converged && has_fold(&scene, &simulation);
        let converged = converged && !is_folded;
        if is_folded && let Some(last) = solutions.last() {
            fold = probes_of(&simulation).iter().zip(last).map(|(folded, u)| (folded - u).norm()).collect();
            break;
        }
        if converged {
            solutions.push(probes_of(&simulation));
        } else if !solutions.is_empty() {
            // If a finer mesh has no equilibrium near the coarser one's, the latter was not a solution of the
            // continuous problem.
            return Err(StudyError::NoReference);
        }
        let fine_enough = solutions.len() >= MIN_MESHES && is_good_enough(&solutions, has_point, extent);
        let next = 4 * unknowns;
        let next_fits =
            next <= MAX_UNKNOWNS[extent as usize] && work + MIN_SOLVES_LEFT * next as f64 <= MAX_WORK[extent as usize];
        let carried = (!fine_enough && next_fits).then(|| meshes.refine(simulation.displacement()));
        if converged {
            finest = Some(simulation);
        }
        let Some(carried) = carried else { break };
        start = converged.then_some(carried);
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
    let mut errors = errors(&solutions, has_point);
    for (error, distance) in errors.iter_mut().zip(&fold) {
        *error = Some(error.unwrap_or(*distance) + FARTHER_FOLD * distance);
    }
    scene.solver.method = MethodKind::Linear;
    let mut linear = Simulation::with_system(&scene, simulation.system().clone())?;
    linear.solve();
    let solved: Vec<_> = solutions.pop().unwrap_or_default().into_iter().zip(errors).collect();
    Ok(Reference::of_finest(original, &simulation, &solved, &linear, moved, !fold.is_empty()))
}

/// Returns a scene with element and method of fine solutions.
pub(super) fn prepared(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    // Quadrilaterals of beams lock neither in bending nor near incompressibility.
    scene.set_element(if scene.beam.is_some() { ElementKind::Q4 } else { finest_element(&scene) });
    scene.solver.method = MethodKind::Newton;
    scene.solver.max_iterations = MAX_ITERATIONS;
    scene.solver.accept_after = 0;
    scene
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

/// Returns the bounds of the errors of the last solution, m, for each probe.
pub(super) fn errors(solutions: &[Vec<Vector2<f64>>], has_point: bool) -> Vec<Option<f64>> {
    let probes = solutions.last().map_or(0, Vec::len);
    let of = |probe: usize| solutions.iter().filter_map(|u| u.get(probe).copied()).collect::<Vec<_>>();
    (0..probes).map(|probe| remaining_error(&of(probe), has_point)).collect()
}

/// Returns `true` if the errors of all probes with significant displacement are small enough to stop the search.
fn is_good_enough(solutions: &[Vec<Vector2<f64>>], has_point: bool, extent: Extent) -> bool {
    /// Displacement relative to the largest of all probes below which a probe is ignored.
    const LITTLE: f64 = 0.01;
    let Some(last) = solutions.last() else { return false };
    let largest = last.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let counts = last.iter().zip(errors(solutions, has_point)).filter(|(u, _)| u.norm() > LITTLE * largest);
    counts.into_iter().all(|(u, error)| error.is_some_and(|error| error <= GOOD_ENOUGH[extent as usize] * u.norm()))
}

/// Iterates until the status is final or the budget is spent, and adds the unknowns of all iterations to `work`.
fn solve(simulation: &mut Simulation, extent: Extent, work: &mut f64, observe: Observer<'_>) -> Result<Status> {
    let unknowns = simulation.system().dofs();
    let now = sentence!("the reference solution, %{n} unknowns", n = unknowns);
    let fraction = (unknowns as f64 / MAX_UNKNOWNS[extent as usize] as f64).min(1.0);
    while *simulation.status() == Status::Running && *work <= MAX_WORK[extent as usize] {
        check(observe(Progress { fraction, now: Some(&now) }))?;
        let before = simulation.iterations();
        simulation.step();
        *work += f64::from(simulation.iterations() - before) * unknowns as f64;
    }
    Ok(simulation.status().clone())
}

/// Sequence of meshes, each with every element of the previous one cut into four.
pub(super) struct Meshes {
    /// Mesh before the beam is bent to its arch; the mesh itself if there is no arch.
    straight: Mesh,
    /// Arch that the beam is bent to.
    arch: Option<Beam>,
}

impl Meshes {
    /// Returns the coarsest mesh of a scene. Points of the scene without a node are moved to the nearest one.
    pub(super) fn of(scene: &mut Scene, near: Option<&Simulation>, extent: Extent) -> Result<(Self, Vec<MovedPoint>)> {
        if let Some(beam) = scene.beam.clone() {
            let straight = grid(scene, &beam).ok_or(StudyError::NoReference)?;
            let meshes = Self { straight, arch: (beam.rise != 0.0).then_some(beam) };
            let moved = moved_points(scene, &meshes.mesh()?);
            return Ok((meshes, moved));
        }
        let meshed = |scene: &Scene| System::mesh_of(scene).map_err(SimulationError::from);
        let own = near.map_or_else(|| meshed(scene), |near| Ok(near.system().mesh().clone()))?;
        // A mesh given by the caller is kept.
        let element = if scene.mesh.is_some() { scene.element() } else { own.element() };
        if 4 * unknowns_of(&own, element.entry()) > MAX_UNKNOWNS[extent as usize] {
            return Err(StudyError::TooFine { elements: own.element_count() });
        }
        // The same nodes are used for the scene's points on every mesh, including the scene's own.
        let moved = moved_points(scene, &own);
        for (_, place, width) in places(scene) {
            if let (Place::At(at), None) = (place, width) {
                *at = own.node(own.nearest_node((*at).into())).into();
            }
        }
        let straight = if own.element() == element { own } else { meshed(scene)? };
        Ok((Self { straight, arch: None }, moved))
    }

    /// Returns the current mesh.
    pub(super) fn mesh(&self) -> Result<Mesh> {
        match &self.arch {
            None => Ok(self.straight.clone()),
            Some(beam) => {
                self.straight.moved(|x| bent(beam, x.x / beam.length, x.y)).map_err(|_| StudyError::NoReference)
            }
        }
    }

    /// Refines the mesh; returns a displacement of the previous mesh interpolated to it.
    pub(super) fn refine(&mut self, displacement: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        let carried = self.straight.prolonged(displacement);
        self.straight = self.straight.refined();
        carried
    }
}

/// Returns the approximate number of unknowns of a mesh converted to another element, by Euler's formula for a mesh
/// without holes.
fn unknowns_of(mesh: &Mesh, element: &ElementType) -> usize {
    let elements = mesh.element_count();
    let corners = element.cell.corners.len();
    // Every side belongs to two elements, so there are as many sides as elements times half their corners.
    let vertices = elements * (corners - 2) / 2;
    let on_sides = element.degree() - 1;
    2 * (vertices + on_sides * elements * corners / 2)
}

/// Returns the places of a scene's supports and forces, each with the key of its table, and with its width if it acts at
/// the point itself instead of on the nearest node.
pub(super) fn places(scene: &mut Scene) -> impl Iterator<Item = (String, &mut Place, Option<f64>)> {
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
    let mut own = scene.clone();
    let probes = scene.probes.iter().map(|probe| (&probe.place, 0.0));
    let points = places(&mut own).map(|(_, place, width)| (&*place, width.unwrap_or(0.0))).chain(probes);
    // A width has lines at its ends, so that each mesh resolves it.
    let points = points.flat_map(|(place, width)| match *place {
        Place::At(at) if width == 0.0 => vec![at],
        Place::At([x, y]) => vec![[x - 0.5 * width, y], [x + 0.5 * width, y]],
        Place::Edge(_) => Vec::new(),
    });
    let points = points.map(|at| straightened(beam, at.into())).map(|[along, across]| [along * size[0], across]);
    let (mut columns, mut rows): (Vec<f64>, Vec<f64>) = points.map(|[x, y]| (x, y + 0.5 * size[1])).unzip();
    let halvings = 2f64.powi(REFINEMENTS);
    // The finest mesh has 2 (2³ nx + 1) (2³ ny + 1) unknowns.
    let nodes = 0.5 * MAX_UNKNOWNS[Extent::Quick as usize] as f64;
    let cells = |short: f64, extra: usize| {
        (((nodes / (halvings * short + 1.0) - 1.0) / halvings).floor() - extra as f64).max(1.0)
    };
    let square = (nodes / halvings.powi(2) * size[0].min(size[1]) / size[0].max(size[1])).sqrt().round().max(1.0);
    let long = usize::from(size[1] > size[0]);
    let wanted = if long == 0 { &mut columns } else { &mut rows };
    if cells(square, 0) * size[1 - long] < 2.0 * size[long] {
        wanted.extend(LAYERS.into_iter().flat_map(|layer| {
            let layer = layer * size[1 - long];
            [layer, size[long] - layer]
        }));
    }
    let extra = wanted.len();
    let mut counts = [square; 2];
    counts[long] = cells(square, extra);
    let lines = [(columns, 0), (rows, 1)]
        .map(|(wanted, axis)| lines(size[axis], wanted, counts[axis], NARROWEST * size[1 - axis] / counts[1 - axis]));
    let cells = [&lines[0], &lines[1]].map(|lines| lines.len() as u32 - 1);
    let uniform = Mesh::beam(&Beam { cells, rise: 0.0, element: scene.element(), ..beam.clone() }).ok()?;
    let graded = |x: Vector2<f64>| {
        let [x, y] = [on_lines(&lines[0], x.x / size[0]), on_lines(&lines[1], x.y / size[1] + 0.5)];
        Vector2::new(x, y - 0.5 * size[1])
    };
    uniform.moved(graded).ok()
}

/// Returns the boundaries of about `cells` equal intervals from 0 to `end`, with one at each value of `wanted` that is
/// not nearer than `narrowest` to another.
fn lines(end: f64, mut wanted: Vec<f64>, cells: f64, narrowest: f64) -> Vec<f64> {
    wanted.retain(|v| (narrowest..=end - narrowest).contains(v));
    wanted.sort_by(f64::total_cmp);
    wanted.dedup_by(|b, a| *b - *a < narrowest);
    let mut lines = vec![0.0];
    let mut from = 0.0;
    for to in wanted.into_iter().chain([end]) {
        let count = (cells * (to - from) / end).round().max(1.0);
        lines.extend((1..count as u32).map(|i| from + (to - from) * f64::from(i) / count));
        lines.push(to);
        from = to;
    }
    lines
}

/// Maps a fraction, 0 to 1, of equal cells to the position on these lines.
fn on_lines(lines: &[f64], part: f64) -> f64 {
    // Nodes are at corners of cells and half way between them, so that lines are met without rounding errors.
    let halves = (2.0 * part * (lines.len() - 1) as f64).round() as usize;
    let (line, odd) = (halves / 2, halves % 2 == 1);
    match lines.get(line..) {
        Some([here, next, ..]) if odd => 0.5 * (here + next),
        Some([here, ..]) => *here,
        _ => lines.last().copied().unwrap_or(part),
    }
}
