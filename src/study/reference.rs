//! What errors are measured against, one truth for one scene everywhere: the exact beam of [`crate::truth`] where plane
//! elasticity agrees with it, else a fine six-node solution.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Vector2;

use super::StudyError;
use super::refined::refined_probes;
use crate::assembly::System;
use crate::mesh::{Mesh, Segment};
use crate::scene::{Analysis, ElementKind, MethodKind, Place, Scene};
use crate::simulation::{ProbeResult, Simulation, SimulationError, Status};
use crate::truth::{BeamTruth, error_percent};

/// Where a truth comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TruthSource {
    /// The geometrically exact beam.
    ExactBeam,
    /// A fine six-node solution of the scene's rectangle.
    FineSolution,
    /// The six-node solution on the scene's mesh, refined.
    RefinedMesh,
    /// No truth but an estimate of it: the scene's own mesh refined once, extrapolated; see [`refined_probes`].
    Estimate,
}

impl std::fmt::Display for TruthSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::ExactBeam => "the exact beam",
            Self::FineSolution => "a fine t6 solution",
            Self::RefinedMesh => "the fine solution on its refined mesh",
            Self::Estimate => "an estimate, from its mesh refined once",
        })
    }
}

/// What a probe would see without any error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeTruth {
    /// Its displacement, m.
    pub displacement: Vector2<f64>,
    /// How that is known.
    pub source: TruthSource,
}

impl ProbeTruth {
    /// The distance of a result from the truth, over the true displacement, percent; `None` where nothing moves.
    #[must_use]
    pub fn error_percent(&self, result: &ProbeResult) -> Option<f64> {
        error_percent(result.u, self.displacement)
    }
}

/// The truth of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Of every probe of the scene.
    probes: Vec<ProbeTruth>,
    /// Its own estimated error at the first probe, percent: of the exact beam, how far plane elasticity is from it; 0
    /// where that is not known.
    pub error_percent: f64,
    /// How far the exact beam is from the fine solution that had to replace it, percent.
    pub beam_off_by_percent: Option<f64>,
    /// The true outline of the body, m: closed lines.
    pub outline: Vec<Vec<Vector2<f64>>>,
    /// What linear theory gives for the first probe without an error of its mesh, m: what is missing to the truth is the
    /// theory's.
    pub linear: Option<Vector2<f64>>,
}

impl std::fmt::Display for Reference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.first().source)?;
        if self.error_percent > 0.0 {
            write!(f, " (its own error about {:.1e} %)", self.error_percent)?;
        }
        self.beam_off_by_percent
            .map_or(Ok(()), |off| write!(f, "; beam theory, with its small strains, is {off:.1} % off"))
    }
}

/// Cells along a beam that is fine enough to be the truth.
const FINE: u32 = 64;
/// Elements of a mesh from a file that is: it is refined until it has as many, and at least once.
const FINE_ELEMENTS: usize = 2000;
/// Elements of a mesh from a file beyond which its refinement is too dear to be a by-product of a solve.
pub(super) const MOST_ELEMENTS: usize = 4000;

/// The exact beam is the truth if a fine solution is no farther from it than this, percent. A stubby beam under a large
/// load is: its strains are large, and a section does not stay straight.
const BEAM_AGREES: f64 = 0.5;

/// A solution on a fine mesh and its estimated error.
struct Fine {
    probes: Vec<Vector2<f64>>,
    outline: Vec<Vec<Vector2<f64>>>,
    linear: Option<Vector2<f64>>,
    error_percent: f64,
    source: TruthSource,
}

impl Reference {
    /// Finds it.
    ///
    /// # Errors
    /// [`StudyError`]: the body is in motion, there is nothing to see, the fine solution was not found, or the scene's mesh is so fine already
    /// that refining it would take too long.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        scene.validate().map_err(SimulationError::from)?;
        if scene.analysis == Analysis::Dynamic {
            return Err(StudyError::InMotion);
        }
        if scene.probes.is_empty() {
            return Err(StudyError::NoProbe);
        }
        let exact = BeamTruth::of(scene);
        let beam = exact.and_then(|t| t.tip_displacement());
        let height = scene.beam.as_ref().map_or(0.0, |beam| beam.height);
        let beam_outline = || exact.and_then(|t| t.outline(height)).map(|line| vec![line]);
        let at_tip: Vec<bool> = scene.probes.iter().map(|p| p.place == Place::from("right")).collect();
        match (beam, fine(scene)) {
            (Some(beam), Ok(fine)) => {
                let off = at_tip.iter().zip(&fine.probes).find(|(at_tip, _)| **at_tip);
                let off = off.and_then(|(_, &u)| error_percent(u, beam));
                let agrees = off.is_none_or(|off| off <= BEAM_AGREES);
                let probes = at_tip.iter().zip(&fine.probes).map(|(&at_tip, &u)| match at_tip && agrees {
                    true => ProbeTruth { displacement: beam, source: TruthSource::ExactBeam },
                    false => ProbeTruth { displacement: u, source: fine.source },
                });
                let first_is_beam = agrees && at_tip[0];
                Ok(Self {
                    probes: probes.collect(),
                    error_percent: if first_is_beam { off.unwrap_or(0.0) } else { fine.error_percent },
                    beam_off_by_percent: off.filter(|_| !agrees),
                    outline: beam_outline().filter(|_| first_is_beam).unwrap_or(fine.outline),
                    linear: fine.linear,
                })
            }
            // Extremely slender: nothing to compare with, and nothing better.
            (Some(beam), Err(StudyError::NoTruth)) if at_tip.iter().all(|&at_tip| at_tip) => Ok(Self {
                probes: vec![ProbeTruth { displacement: beam, source: TruthSource::ExactBeam }; at_tip.len()],
                error_percent: 0.0,
                beam_off_by_percent: None,
                outline: beam_outline().unwrap_or_default(),
                linear: None,
            }),
            (_, Ok(Fine { probes, outline, linear, error_percent, source })) => Ok(Self {
                probes: probes.into_iter().map(|displacement| ProbeTruth { displacement, source }).collect(),
                error_percent,
                beam_off_by_percent: None,
                outline,
                linear,
            }),
            (_, Err(error)) => Err(error),
        }
    }

    /// [`Self::of`], or where there is none to be found at the price of a solve, an estimate of it, which says so.
    ///
    /// # Errors
    /// As [`Self::of`], where there is no estimate either.
    pub fn or_estimate(scene: &Scene) -> Result<Self, StudyError> {
        let missing = match Self::of(scene) {
            Err(error @ (StudyError::TooFine { .. } | StudyError::NoTruth)) => error,
            known => return known,
        };
        let mut scene = scene.clone();
        scene.solver.method = MethodKind::Newton;
        scene.solver.max_iterations = scene.solver.max_iterations.max(200);
        let mut simulation = Simulation::new(&scene)?;
        if *simulation.solve() != Status::Converged {
            return Err(missing);
        }
        let probes = refined_probes(&simulation).map_err(|_| missing)?;
        Ok(Self {
            error_percent: 0.0,
            probes: probes
                .into_iter()
                .map(|displacement| ProbeTruth { displacement, source: TruthSource::Estimate })
                .collect(),
            beam_off_by_percent: None,
            outline: Vec::new(),
            linear: None,
        })
    }

    /// The truth of every probe, in the scene's order.
    #[must_use]
    pub fn probes(&self) -> &[ProbeTruth] {
        &self.probes
    }

    /// The truth of the first probe, by which settings are compared.
    #[must_use]
    pub fn first(&self) -> ProbeTruth {
        // There is one: a reference without probes is never made.
        let none = ProbeTruth { displacement: Vector2::zeros(), source: TruthSource::FineSolution };
        self.probes.first().copied().unwrap_or(none)
    }

    /// The distance between two displacements over the first probe's true one, percent.
    #[must_use]
    pub fn percent(&self, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
        100.0 * (a - b).norm() / self.first().displacement.norm()
    }
}

/// The element of fine solutions: six-node triangles, which converge fastest, or what the quadrilaterals of a file can be.
pub(super) fn finest_element(scene: &Scene) -> ElementKind {
    scene.elements().find(|&e| e == ElementKind::T6).unwrap_or_else(|| scene.element())
}

/// The fine solution.
fn fine(scene: &Scene) -> Result<Fine, StudyError> {
    let mut scene = scene.clone();
    scene.set_element(finest_element(&scene));
    let (coarse, fine, source) = match scene.beam.clone() {
        Some(beam) => {
            let mut solve = |along: u32| {
                let across = (f64::from(along) * beam.height / beam.length).round().max(1.0) as u32;
                if let Some(beam) = &mut scene.beam {
                    beam.cells = [along, across];
                }
                run_to_end(&scene, MethodKind::Newton, &system_of(&scene)?)
            };
            (solve(FINE / 2)?, solve(FINE)?, TruthSource::FineSolution)
        }
        None => {
            let system = system_of(&scene)?;
            if system.mesh().element_count() > MOST_ELEMENTS {
                return Err(StudyError::TooFine { elements: system.mesh().element_count() });
            }
            let solve = |mesh: &Mesh| {
                let system = System::with_mesh(&scene, mesh.clone()).map_err(SimulationError::from)?;
                run_to_end(&scene, MethodKind::Newton, &Arc::new(system))
            };
            let mut coarse = run_to_end(&scene, MethodKind::Newton, &system)?;
            let mut mesh = system.mesh().refined();
            let mut fine = solve(&mesh)?;
            while mesh.element_count() < FINE_ELEMENTS {
                mesh = mesh.refined();
                coarse = std::mem::replace(&mut fine, solve(&mesh)?);
            }
            (coarse, fine, TruthSource::RefinedMesh)
        }
    };
    let probes = probe_displacements(&fine);
    let first = probes.first().copied().unwrap_or_default();
    let coarse = probe_displacements(&coarse).first().copied().unwrap_or_default();
    let error_percent = error_percent(coarse, first).unwrap_or(0.0);
    let linear = end(fine.scene(), MethodKind::Linear, fine.system())?.first().copied();
    Ok(Fine { probes, outline: outline(&fine), linear, error_percent, source })
}

/// The closed lines around a body, m, node by node.
fn outline(simulation: &Simulation) -> Vec<Vec<Vector2<f64>>> {
    let (mesh, u) = (simulation.system().mesh(), simulation.displacement());
    let mut sides: BTreeMap<u32, Vec<Segment>> = BTreeMap::new();
    for side in mesh.outline() {
        sides.entry(side.ends()[0]).or_default().push(side);
    }
    let mut lines = Vec::new();
    while let Some((&first, _)) = sides.first_key_value() {
        let (mut line, mut corner) = (Vec::new(), first);
        while let Some(own) = sides.get_mut(&corner) {
            let Some(side) = own.pop() else { break };
            if own.is_empty() {
                sides.remove(&corner);
            }
            line.extend(side.nodes().iter().map(|&n| mesh.nodes()[n as usize] + u[n as usize]));
            corner = side.ends()[1];
        }
        lines.push(line);
    }
    lines
}

/// The equations of a scene.
pub(super) fn system_of(scene: &Scene) -> Result<Arc<System>, StudyError> {
    Ok(Arc::new(System::new(scene).map_err(SimulationError::from)?))
}

/// A method run to its end, given all the iterations it needs.
fn run_to_end(scene: &Scene, method: MethodKind, system: &Arc<System>) -> Result<Simulation, StudyError> {
    let mut scene = scene.clone();
    scene.solver.method = method;
    scene.solver.max_iterations = scene.solver.max_iterations.max(200);
    let mut simulation = Simulation::with_system(&scene, system.clone())?;
    if *simulation.solve() != Status::Converged && method == MethodKind::Newton {
        return Err(StudyError::NoTruth);
    }
    Ok(simulation)
}

/// Displacements of the probes where a method ends, given all the iterations it needs.
pub(super) fn end(scene: &Scene, method: MethodKind, system: &Arc<System>) -> Result<Vec<Vector2<f64>>, StudyError> {
    Ok(probe_displacements(&run_to_end(scene, method, system)?))
}

fn probe_displacements(simulation: &Simulation) -> Vec<Vector2<f64>> {
    let displacement = simulation.displacement();
    simulation.problem().probes().iter().map(|p| p.mean(displacement)).collect()
}

/// Displacement of the first probe, m.
pub(super) fn first_probe(simulation: &Simulation) -> Result<Vector2<f64>, StudyError> {
    let probe = simulation.problem().probes().first().ok_or(StudyError::NoProbe)?;
    Ok(probe.mean(simulation.displacement()))
}
