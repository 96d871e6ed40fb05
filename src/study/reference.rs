//! Reference solutions: displacements that errors are measured against, each with a bound of its own error. The
//! reference is the exact beam ([`crate::exact_beam`]) if solutions on fine meshes confirm it, else the finest of
//! these.

use nalgebra::Matrix2;

use super::prelude::*;
use crate::exact_beam::ExactBeam;
use crate::format::engineering_pair;
use crate::mesh::Segment;
use crate::scene::{Beam, Probe};
use crate::simulation::{Equilibrium, ProbeResult};
use crate::state::largest;

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
    pub fn error_percent(&self, result: &ProbeResult) -> Option<f64> {
        error_percent(result.u, self.displacement)
    }

    /// Returns a bound of the exact error of a result at this distance, percent, from the reference.
    pub(crate) fn error_bound(&self, error_percent: f64) -> f64 {
        error_percent + self.own_error_percent
    }

    /// Returns the distance between two displacements, percent of the reference's displacement.
    pub fn percent(&self, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
        100.0 * (a - b).norm() / self.displacement.norm()
    }

    /// Describes the reference's own error: `its own error at most 0.012 %`.
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
    /// Body under the load; empty if no bound of the first probe's error is known.
    body: DeformedBody,
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

/// Returns the reason for which a displacement of a scene, m, has no reference, if it has none; `largest` is the largest
/// displacement of the body, m.
fn missing(scene: &Scene, displacement: Vector2<f64>, largest: f64) -> Sentence {
    /// Displacement relative to the largest one that is only rounding error.
    const ROUNDING: f64 = 1e-9;
    match scene.acts_on_points() {
        _ if displacement.norm() <= ROUNDING * largest => {
            sentence!("no reference solution: the probe does not move")
        }
        true => sentence!(
            "no reference solution: under a point the displacement grows without limit on finer meshes; give the \
             support or force there a width"
        ),
        false => sentence!(
            "no reference solution: finer and finer meshes show no error at the probe below %{percent} %",
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
    /// bounds of their errors. For probes at its tip it is the exact beam if the solution confirms it.
    pub(super) fn of_finest(scene: &Scene, finest: &Simulation, solved: &[(Vector2<f64>, Option<f64>)]) -> Self {
        const STRAIGHT: f64 = 1e-9;
        let source = if scene.beam.is_some() { ReferenceSource::FineMesh } else { ReferenceSource::RefinedMesh };
        let (mesh, displacement) = (finest.system().mesh(), finest.displacement());
        let is_straight = |side: &Segment| {
            let [a, b] = side.ends().map(|n| mesh.node(n));
            side.nodes().iter().all(|&n| (b - a).perp(&(mesh.node(n) - a)).abs() <= STRAIGHT * (b - a).norm_squared())
        };
        let missing = |&(u, _): &_| missing(scene, u, largest(displacement));
        let mut reference = Self {
            probes: solved.iter().map(|&(u, error)| probe(u, error?, source)).collect(),
            missing: solved.first().map(missing).unwrap_or_default(),
            is_polygon: scene.beam.is_none() && mesh.outline().iter().all(is_straight),
            unknowns: finest.system().dofs(),
            ..Self::default()
        };
        let exact = exact(scene);
        for (i, &(u, own)) in solved.iter().enumerate().filter(|(i, _)| is_at_tip(&scene.probes[*i])) {
            let Some((_, tip)) = exact else { break };
            let off = (u - tip).norm();
            let within = |own: f64| off <= MARGIN * own && off + own <= 0.01 * MAX_CONFIRMED_ERROR * tip.norm();
            if off <= 0.01 * CONFIRMED * tip.norm() || own.is_some_and(within) {
                // Without a bound the error of the fine solution is taken as its distance from the beam.
                reference.probes[i] = probe(tip, off + own.unwrap_or(off), ReferenceSource::ExactBeam);
            } else if i == 0 {
                reference.beam_off_by_percent = error_percent(tip, u);
            }
        }
        if let Some(first) = reference.first() {
            let beam = exact.filter(|_| first.source == ReferenceSource::ExactBeam);
            let body = beam.and_then(|(beam, _)| DeformedBody::of_beam(scene.beam.as_ref()?, &beam));
            reference.body = body.unwrap_or_else(|| DeformedBody::new(mesh, displacement.to_vec()));
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
        Some(Self { probes, body: DeformedBody::of_beam(rectangle, &beam).unwrap_or_default(), ..Self::default() })
    }

    /// Returns the closed outlines of the body with a multiple of its displacement, m; none if no bound of the first probe's
    /// error is known.
    pub fn outline(&self, magnification: f64) -> Vec<Vec<Vector2<f64>>> {
        let DeformedBody { rest, displacements, outline, .. } = &self.body;
        let place = |&n: &u32| rest[n as usize] + displacements[n as usize] * magnification;
        outline.iter().map(|line| line.iter().map(place).collect()).collect()
    }

    /// Returns the displacement at material points with these rest positions, m; `None` outside the body, and everywhere if
    /// there is no outline. Points that are outside by a little, as on a curved side, have the displacement of the nearest
    /// triangle, continued.
    pub fn displacements_at(&self, points: &[Vector2<f64>]) -> Vec<Option<Vector2<f64>>> {
        /// Largest distance outside a triangle, relative to its height.
        const OUTSIDE: f64 = 0.5;
        let DeformedBody { rest, displacements, triangles, .. } = &self.body;
        // A triangle is compared with the points around it, which are found by x.
        let mut by_x: Vec<(usize, &Vector2<f64>)> = points.iter().enumerate().collect();
        by_x.sort_by(|(_, a), (_, b)| a.x.total_cmp(&b.x));
        let mut found = vec![(-OUTSIDE, None); points.len()];
        for triangle in triangles {
            let corner = |corner: u32| (rest[corner as usize], displacements[corner as usize]);
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

    /// Returns the references of the probes, in the scene's order; `None` if a probe does not move, or no bound of its
    /// error is known.
    pub fn probes(&self) -> &[Option<ProbeReference>] {
        &self.probes
    }

    /// Returns sentences about limitations of the reference.
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

/// Body whose displacement is linear over triangles.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct DeformedBody {
    /// Rest positions of the nodes, m.
    rest: Vec<Vector2<f64>>,
    /// Displacements of the nodes, m.
    displacements: Vec<Vector2<f64>>,
    /// Nodes of every triangle.
    triangles: Vec<[u32; 3]>,
    /// Nodes of the closed lines around the body.
    outline: Vec<Vec<u32>>,
}

impl DeformedBody {
    /// Returns the body of a mesh with these displacements of its nodes, m.
    fn new(mesh: &Mesh, displacements: Vec<Vector2<f64>>) -> Self {
        let lattice = (mesh.entry().cell.lattice)(mesh.entry().degree() as u32);
        let own: Vec<_> = lattice.points.iter().filter_map(|&point| mesh.entry().node_at(point)).collect();
        let triangles = mesh.elements().flat_map(|nodes| {
            lattice.triangles.iter().map(|corners| corners.map(|corner| nodes[own[corner as usize]]))
        });
        let sides = mesh.outline().into_iter().map(|side| (side.ends(), side.nodes().to_vec()));
        Self {
            rest: mesh.nodes().to_vec(),
            displacements,
            triangles: triangles.collect(),
            outline: Mesh::closed_lines(sides).into_iter().map(|line| line.concat()).collect(),
        }
    }

    /// Returns the body of an exact beam, whose sections stay plane; `None` if its displacement is not known.
    fn of_beam(rectangle: &Beam, beam: &ExactBeam) -> Option<Self> {
        let sections = beam.section_displacements(rectangle.height)?;
        let cells = [sections.len() as u32 - 1, 1];
        let mesh = Mesh::beam(&Beam { cells, element: ElementKind::Q4, ..rectangle.clone() }).ok()?;
        Some(Self::new(&mesh, sections.concat()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body has the displacement of every node, also on a curved outline, of the nodes of another mesh of the same body,
    /// and none far outside; that of an exact beam has the displacement of its tip.
    #[test]
    fn a_body_has_the_displacement_of_every_point() {
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
            let reference = Reference {
                body: DeformedBody::new(fine.mesh(), fine.displacement().to_vec()),
                ..Reference::default()
            };
            for (own, u) in reference.displacements_at(fine.mesh().nodes()).into_iter().zip(fine.displacement()) {
                assert!((own.unwrap() - u).norm() < 1e-9 * largest(fine.displacement()), "{element:?}");
            }
            assert!(reference.displacements_at(coarse.mesh().nodes()).iter().all(Option::is_some), "{element:?}");
            assert_eq!(reference.displacements_at(&[Vector2::new(20.0, 5.0), Vector2::repeat(f64::NAN)]), [None, None]);
        }
        let straight = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -3e3]).probe("tip", "right");
        let beam = ExactBeam::of(&straight).unwrap();
        let body = DeformedBody::of_beam(straight.beam.as_ref().unwrap(), &beam).unwrap();
        let tip = Reference { body, ..Reference::default() }.displacements_at(&[Vector2::new(10.0, 0.0)])[0].unwrap();
        let exact = beam.tip_displacement().unwrap();
        assert!((tip - exact).norm() < 1e-6 * exact.norm(), "{tip} {exact}");
    }
}
