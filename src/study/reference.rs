//! Reference solutions: displacements that errors are measured against, each with a bound of its own error. The
//! reference is the exact beam ([`crate::exact_beam`]) if solutions on fine meshes confirm it, else the finest of
//! these.

use nalgebra::Matrix2;

use super::prelude::*;
use crate::exact_beam::ExactBeam;
use crate::format::engineering_pair;
use crate::mesh::Segment;
use crate::scene::Probe;
use crate::simulation::{Equilibrium, ProbeResult};

/// Origin of a reference solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum ReferenceSource {
    /// The geometrically exact beam.
    ExactBeam,
    /// A solution of the scene's rectangle or arch on a fine mesh.
    FineMesh,
    /// A solution on the scene's own mesh, refined.
    RefinedMesh,
}

impl From<&ReferenceSource> for Sentence {
    fn from(source: &ReferenceSource) -> Self {
        match source {
            ReferenceSource::ExactBeam => sentence!("the exact beam"),
            ReferenceSource::FineMesh => sentence!("a fine solution"),
            ReferenceSource::RefinedMesh => sentence!("a solution on the refined mesh"),
        }
    }
}

/// Reference displacement of a probe.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct ProbeReference {
    /// Displacement, m.
    pub displacement: Vector2<f64>,
    /// Bound of the reference's own error, percent of its length.
    pub own_error_percent: f64,
    /// Origin: exact beam or fine mesh.
    pub source: ReferenceSource,
}

impl ProbeReference {
    /// Returns the distance of a result from the reference, percent of the reference's displacement. The exact error
    /// differs from it by at most [`Self::own_error_percent`].
    #[must_use]
    pub fn error_percent(&self, result: &ProbeResult) -> Option<f64> {
        error_percent(result.u, self.displacement)
    }

    /// Returns a bound of the exact error of a result at this distance, percent, from the reference.
    pub(crate) fn error_bound(&self, error_percent: f64) -> f64 {
        error_percent + self.own_error_percent
    }

    /// Returns the distance between two displacements, percent of the reference's displacement.
    #[must_use]
    pub fn percent(&self, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
        100.0 * (a - b).norm() / self.displacement.norm()
    }

    /// Describes the reference's own error: `its own error at most 0.012 %`.
    #[must_use]
    pub fn own_error(&self) -> String {
        format!("its own error at most {} %", number(two_digits(self.own_error_percent)))
    }
}

impl From<&ProbeReference> for Sentence {
    fn from(reference: &ProbeReference) -> Self {
        sentence!(
            "%{reference} (its own error at most %{own} %)",
            reference = &reference.source,
            own = number(two_digits(reference.own_error_percent))
        )
    }
}

/// Point of a scene that is not at a node of the mesh.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MovedPoint {
    /// Table of the scene that names the point: `load.0`, `support.1`.
    pub key: String,
    /// Position at rest, m.
    pub at: [f64; 2],
    /// Distance to the node used instead, m.
    pub distance: f64,
}

impl From<&MovedPoint> for Sentence {
    fn from(point: &MovedPoint) -> Self {
        sentence!(
            "%{point} at %{place} acts on the nearest node, %{distance} away",
            point = point.key.clone(),
            place = engineering_pair(point.at, "m"),
            distance = engineering(point.distance, "m")
        )
    }
}

/// Reference solution of a scene.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Reference {
    /// Reference of every probe of the scene; `None` if the probe does not move, or no bound of the error is known.
    probes: Vec<Option<ProbeReference>>,
    /// Reason why the first probe has no reference, if it has none.
    missing: Sentence,
    /// Distance of the exact beam from the fine solution used instead, percent; `None` if the beam is used, or there is
    /// none.
    pub beam_off_by_percent: Option<f64>,
    /// Closed outlines of the deformed body, m; empty if no bound of the first probe's error is known.
    pub outline: Vec<Vec<Vector2<f64>>>,
    /// The same lines at rest, point by point, m.
    pub(crate) rest_outline: Vec<Vec<Vector2<f64>>>,
    /// Displacement of every point, which the outlines are of.
    displacements: DisplacementMap,
    /// Displacement of the first probe by linear theory on a fine mesh, m: its distance from the reference is the error
    /// of linear theory.
    pub linear: Option<Vector2<f64>>,
    /// Points of the scene at which the reference solution has no node.
    pub moved: Vec<MovedPoint>,
    /// `true` if the solution on a finer mesh has a fold: the reference is the last one without, and its own error covers
    /// 1.5 times the distance.
    pub folds: bool,
    /// `true` if all sides of a mesh file are straight: errors then refer to the polygon, not to a curved part that it
    /// approximates.
    pub is_polygon: bool,
    /// Number of unknowns of the finest mesh.
    pub unknowns: usize,
}

/// Returns the reason for which a displacement of a scene with this bound of its error, m, has no reference, if it has none;
/// `largest` is the largest displacement of the body, m.
fn missing(scene: &Scene, displacement: Vector2<f64>, error: Option<f64>, largest: f64) -> Sentence {
    /// Displacement relative to the largest one that is only rounding error.
    const ROUNDING: f64 = 1e-9;
    match error {
        _ if displacement.norm() <= ROUNDING * largest => {
            sentence!("no reference solution: the probe does not move")
        }
        _ if scene.acts_on_points() => sentence!(
            "no reference solution: under a point the displacement grows without limit on finer meshes; give the \
             support or force there a width"
        ),
        None => sentence!("no reference solution: finer and finer meshes give no bound of its error at the probe"),
        Some(_) => sentence!(
            "no reference solution: its error at the probe may be more than %{percent} %",
            percent = number(LARGEST_OWN_ERROR)
        ),
    }
}

displayed!(ReferenceSource, ProbeReference, MovedPoint, Reference);

impl From<&Reference> for Sentence {
    fn from(reference: &Reference) -> Self {
        let known = reference.first().map_or_else(|| (&reference.missing).into(), |first| (&first).into());
        match reference.beam_off_by_percent {
            Some(off) => {
                sentence!("%{reference}; beam theory differs by %{off} %", reference = known, off = format!("{off:.1}"))
            }
            None => known,
        }
    }
}

/// Limitation of a reference with [`Reference::folds`].
pub const FOLDS: &str = "on finer meshes the material folds at the corner of a support, and the fold may grow with \
                                each of them: the error of the reference covers half more than that of the first";

/// Largest bound of a reference's own error, percent; with a larger bound there is no reference.
const LARGEST_OWN_ERROR: f64 = 20.0;
/// Largest distance between the exact beam and a fine solution with which the beam is used, percent.
const CONFIRMED: f64 = 0.25;
/// Largest ratio of this distance to the fine solution's own error with which the beam is also used, unless the beam's
/// error is then larger than the following bound, percent: a fine solution that is itself inaccurate confirms nothing.
const MARGIN: f64 = 1.5;
const MAX_CONFIRMED_ERROR: f64 = 1.0;

impl Reference {
    /// Returns the reference of the solution on the finest mesh of a search: the displacements of the probes, m, with the
    /// bounds of their errors, and linear theory on the same mesh. For probes at its tip it is the exact beam if the
    /// solution confirms it.
    pub(super) fn of_finest(
        scene: &Scene,
        finest: &Simulation,
        solved: &[(Vector2<f64>, Option<f64>)],
        linear: &Simulation,
        moved: Vec<MovedPoint>,
        folds: bool,
    ) -> Self {
        const STRAIGHT: f64 = 1e-9;
        let source = if scene.beam.is_some() { ReferenceSource::FineMesh } else { ReferenceSource::RefinedMesh };
        let mesh = finest.system().mesh();
        let is_straight = |side: &Segment| {
            let [a, b] = side.ends().map(|n| mesh.node(n));
            side.nodes().iter().all(|&n| (b - a).perp(&(mesh.node(n) - a)).abs() <= STRAIGHT * (b - a).norm_squared())
        };
        let [rest_outline, outline] = outlines(finest);
        let lines = outline.iter().flatten().zip(rest_outline.iter().flatten());
        let largest = lines.map(|(now, rest)| (now - rest).norm()).fold(0.0, f64::max);
        let mut reference = Self {
            probes: solved.iter().map(|&(u, error)| probe(u, error?, source)).collect(),
            missing: solved.first().map(|&(u, error)| missing(scene, u, error, largest)).unwrap_or_default(),
            linear: first_probe(linear).ok(),
            moved,
            folds,
            is_polygon: scene.beam.is_none() && mesh.outline().iter().all(is_straight),
            unknowns: finest.system().dofs(),
            ..Self::default()
        };
        if reference.first().is_some() {
            (reference.rest_outline, reference.outline) = (rest_outline, outline);
            reference.displacements = DisplacementMap::of(finest);
        }
        let Some((beam, tip)) = exact(scene) else { return reference };
        for (i, (_, &(u, own))) in scene.probes.iter().zip(solved).enumerate().filter(|(_, (p, _))| is_at_tip(p)) {
            let off = (u - tip).norm();
            let within = |own: f64| off <= MARGIN * own && off + own <= 0.01 * MAX_CONFIRMED_ERROR * tip.norm();
            if off <= 0.01 * CONFIRMED * tip.norm() || own.is_some_and(within) {
                // Without a bound the error of the fine solution is taken as its distance from the beam.
                reference.probes[i] = probe(tip, off + own.unwrap_or(off), ReferenceSource::ExactBeam);
                if i == 0 && reference.first().is_some() {
                    reference.draw(scene, &beam);
                }
            } else if i == 0 {
                reference.beam_off_by_percent = error_percent(tip, u);
            }
        }
        reference
    }

    /// Returns the exact beam for a body too slender for any mesh: the assumption of plane sections has an error of the
    /// order of height over length. `None` if this ratio is not small, or a probe is not at the tip.
    pub(super) fn of_slender(scene: &Scene) -> Option<Self> {
        /// Largest height over length for which the beam's own error is known.
        const STUBBY: f64 = 0.02;
        let (rectangle, (beam, tip)) = (scene.beam.as_ref()?, exact(scene)?);
        let ratio = rectangle.height / rectangle.length;
        if ratio > STUBBY || !scene.probes.iter().all(is_at_tip) {
            return None;
        }
        let probes = vec![probe(tip, ratio * tip.norm(), ReferenceSource::ExactBeam); scene.probes.len()];
        let mut reference = Self { probes, ..Self::default() };
        reference.draw(scene, &beam);
        Some(reference)
    }

    /// Takes outline and displacements from the exact beam of a scene, if it has an outline.
    fn draw(&mut self, scene: &Scene, beam: &ExactBeam) {
        if let Some([rest, line]) = scene.beam.as_ref().and_then(|rectangle| beam.outline(rectangle.height)) {
            self.displacements = DisplacementMap::of_beam([&rest, &line]);
            (self.rest_outline, self.outline) = (vec![rest], vec![line]);
        }
    }

    /// Returns the displacement at material points with these rest positions, m; `None` outside the body, and
    /// everywhere if there is no outline.
    #[must_use]
    pub fn displacements_at(&self, points: &[Vector2<f64>]) -> Vec<Option<Vector2<f64>>> {
        self.displacements.at(points)
    }

    /// Returns the references of the probes, in the scene's order; `None` if a probe does not move, or no bound of its
    /// error is known.
    #[must_use]
    pub fn probes(&self) -> &[Option<ProbeReference>] {
        &self.probes
    }

    /// Returns sentences about limitations of the reference.
    #[must_use]
    pub fn limits(&self) -> Vec<String> {
        let limits = [
            (self.folds, FOLDS),
            (
                self.is_polygon,
                "errors refer to the polygon of the file's straight sides, not to the curved part it stands for",
            ),
            (
                self.probes.contains(&None),
                "the error of some probes is unknown: they do not move, or their displacement does not converge on \
                 finer meshes",
            ),
        ];
        let moved = self.moved.iter().map(|point| format!("in the reference solution, {point}"));
        moved.chain(limits.into_iter().filter(|(holds, _)| *holds).map(|(_, text)| text.to_owned())).collect()
    }

    /// Returns the reference of the first probe, by which settings are compared.
    #[must_use]
    pub fn first(&self) -> Option<ProbeReference> {
        self.probes.first().copied().flatten()
    }
}

/// Largest number of unknowns of solutions that are certified automatically; beyond, certification takes much longer
/// than the solve or its reference.
pub const MAX_CERTIFIED: usize = 100_000;

/// Returns `true` for an equilibrium whose exact tangent is not positive definite. Such a state has no reference solution,
/// because a solve on another mesh leads to another equilibrium. One that has not been examined is examined if it is small
/// and `may_examine`, otherwise it counts as stable.
pub fn is_unstable(simulation: &Simulation, may_examine: bool) -> bool {
    let examines = may_examine && simulation.system().dofs() <= MAX_CERTIFIED;
    let certificate =
        |search: Equilibrium<'_>| search.certificate().or_else(|| examines.then(|| search.snapshot().certify()));
    *simulation.status() == Status::Converged
        && !simulation.is_linear()
        && simulation.equilibrium().and_then(certificate).and_then(|c| c.stable) == Some(false)
}

/// Returns the exact beam of a scene with the displacement of its tip, m.
fn exact(scene: &Scene) -> Option<(ExactBeam, Vector2<f64>)> {
    let beam = ExactBeam::of(scene)?;
    Some((beam, beam.tip_displacement()?))
}

fn is_at_tip(probe: &Probe) -> bool {
    probe.place == Place::from("right")
}

/// Returns the reference of a probe; `None` if its error, m, is too large a fraction of its displacement.
fn probe(displacement: Vector2<f64>, error: f64, source: ReferenceSource) -> Option<ProbeReference> {
    let own_error_percent = 100.0 * error / displacement.norm();
    (own_error_percent <= LARGEST_OWN_ERROR).then_some(ProbeReference { displacement, own_error_percent, source })
}

pub(super) fn system_of(scene: &Scene) -> Result<Arc<System>> {
    Ok(Arc::new(System::new(scene)?))
}

/// Returns the displacement of every probe, m.
pub(super) fn probes_of(simulation: &Simulation) -> Vec<Vector2<f64>> {
    let displacement = simulation.displacement();
    simulation.problem().probes().iter().map(|p| p.mean(displacement)).collect()
}

/// Returns the displacement of the first probe, m.
pub(super) fn first_probe(simulation: &Simulation) -> Result<Vector2<f64>> {
    let probe = simulation.problem().probes().first().ok_or(StudyError::NoProbe)?;
    Ok(probe.mean(simulation.displacement()))
}

/// Returns the closed outlines of a body at rest and in its state, m, node by node.
fn outlines(simulation: &Simulation) -> [Vec<Vec<Vector2<f64>>>; 2] {
    let (mesh, u) = (simulation.system().mesh(), simulation.displacement());
    let lines = Mesh::closed_lines(mesh.outline().into_iter().map(|side| (side.ends(), side)));
    let placed = |place: &dyn Fn(&u32) -> Vector2<f64>| {
        lines.iter().map(|line| line.iter().flat_map(Segment::nodes).map(place).collect()).collect()
    };
    [placed(&|&n| mesh.node(n)), placed(&|&n| mesh.node(n) + u[n as usize])]
}

/// Displacement that is linear over triangles.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct DisplacementMap {
    /// Rest positions of the corners, m.
    rest: Vec<Vector2<f64>>,
    /// Displacements of the corners, m.
    displacements: Vec<Vector2<f64>>,
    /// Corners of every triangle.
    triangles: Vec<[u32; 3]>,
}

impl DisplacementMap {
    /// Returns the displacement of a simulation, from node to node.
    fn of(simulation: &Simulation) -> Self {
        let mesh = simulation.system().mesh();
        let triangles = mesh.elements().flat_map(|nodes| triangles(mesh, nodes)).collect();
        Self { rest: mesh.nodes().to_vec(), displacements: simulation.displacement().to_vec(), triangles }
    }

    /// Returns the displacement of an exact beam, whose sections stay plane, from its outlines at rest and now, m, as of
    /// [`ExactBeam::outline`](crate::exact_beam::ExactBeam::outline).
    fn of_beam([rest, moved]: [&[Vector2<f64>]; 2]) -> Self {
        let displacements = rest.iter().zip(moved).map(|(x, now)| now - x).collect();
        // The outline runs along the lower side, back along the upper side, and ends where it begins.
        let stations = (rest.len().saturating_sub(1) / 2) as u32;
        let quads = (1..stations).map(|i| [i - 1, i, 2 * stations - 1 - i, 2 * stations - i]);
        let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Self { rest: rest.to_vec(), displacements, triangles }
    }

    /// Returns the displacement at every point, m; `None` outside the body. Points that are outside by a little, as on a
    /// curved side, have the displacement of the nearest triangle, continued.
    fn at(&self, points: &[Vector2<f64>]) -> Vec<Option<Vector2<f64>>> {
        /// Largest distance outside a triangle, relative to its height.
        const OUTSIDE: f64 = 0.5;
        // A triangle is compared with the points around it, which are found by x.
        let mut by_x: Vec<(usize, &Vector2<f64>)> = points.iter().enumerate().collect();
        by_x.sort_by(|(_, a), (_, b)| a.x.total_cmp(&b.x));
        let mut found = vec![(-OUTSIDE, None); points.len()];
        for triangle in &self.triangles {
            let corner = |corner: u32| (self.rest[corner as usize], self.displacements[corner as usize]);
            let [(a, u), (b, v), (c, w)] = triangle.map(corner);
            // Barycentric coordinates; a triangle without area has none.
            let Some(inverse) = Matrix2::from_columns(&[b - a, c - a]).try_inverse() else { continue };
            // Points at the largest distance are as far away as the triangle is large.
            let [low, high] = [a.inf(&b).inf(&c), a.sup(&b).sup(&c)];
            let [low, high] = [low * 2.0 - high, high * 2.0 - low];
            let first = by_x.partition_point(|(_, at)| at.x < low.x);
            let around = by_x[first..].iter().take_while(|(_, at)| at.x <= high.x);
            for &(point, at) in around.filter(|(_, at)| (low.y..=high.y).contains(&at.y)) {
                let part = inverse * (at - a);
                let weights = [1.0 - part.x - part.y, part.x, part.y];
                let depth = weights.into_iter().fold(f64::INFINITY, f64::min);
                if depth.total_cmp(&found[point].0).is_ge() {
                    found[point] =
                        (depth, Some([u, v, w].into_iter().zip(weights).map(|(u, weight)| u * weight).sum()));
                }
            }
        }
        found.into_iter().map(|(_, u)| u).collect()
    }
}

/// Divides an element into triangles between its nodes.
fn triangles(mesh: &Mesh, nodes: &[u32]) -> Vec<[u32; 3]> {
    let around = mesh.sides(nodes).flat_map(|side| {
        // The last node of a side is the first of the next.
        let (_, own) = side.nodes().split_last().unwrap_or((&0, &[]));
        own.to_vec()
    });
    match around.collect::<Vec<u32>>()[..] {
        [a, b, c] => vec![[a, b, c]],
        [a, b, c, d] => vec![[a, b, c], [a, c, d]],
        [a, ab, b, bc, c, ca] => vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The map has the displacement of every node, also on a curved outline, of the nodes of another mesh of the same
    /// body, and none far outside; that of an exact beam has the displacement of its tip.
    #[test]
    fn the_map_has_the_displacement_of_every_point() {
        let scene = |element, cells: [u32; 2]| {
            let scene = Scene::beam(10.0, 1.0).with_cells(cells[0], cells[1]).with_element(element).clamp("left");
            let mut scene = scene.force("right", [0.0, -3e3]).probe("tip", "right");
            scene.beam.as_mut().unwrap().rise = 0.4;
            scene
        };
        for element in [ElementKind::T3, ElementKind::T6, ElementKind::Q4] {
            let solved = |scene: &Scene| {
                let mut simulation = Simulation::new(scene).unwrap();
                simulation.solve();
                simulation
            };
            let (fine, coarse) = (solved(&scene(element, [40, 4])), solved(&scene(element, [7, 1])));
            let map = DisplacementMap::of(&fine);
            let largest = fine.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
            for (own, u) in map.at(fine.mesh().nodes()).into_iter().zip(fine.displacement()) {
                assert!((own.unwrap() - u).norm() < 1e-9 * largest, "{element:?}");
            }
            assert!(map.at(coarse.mesh().nodes()).iter().all(Option::is_some), "{element:?}");
            assert_eq!(map.at(&[Vector2::new(20.0, 5.0), Vector2::repeat(f64::NAN)]), [None, None]);
        }
        let straight = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -3e3]).probe("tip", "right");
        let beam = ExactBeam::of(&straight).unwrap();
        let [rest, moved] = beam.outline(1.0).unwrap();
        let map = DisplacementMap::of_beam([&rest, &moved]);
        let tip = map.at(&[Vector2::new(10.0, 0.0)])[0].unwrap();
        let exact = beam.tip_displacement().unwrap();
        assert!((tip - exact).norm() < 1e-6 * exact.norm(), "{tip} {exact}");
    }
}
