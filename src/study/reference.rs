//! What a study measures errors against: a fine six-node solution whose own error is estimated from one half as fine, or
//! the exact beam of [`crate::truth`] where it is as good as that.

use nalgebra::Vector2;

use super::StudyError;
use crate::assembly::System;
use crate::mesh::Mesh;
use crate::scene::{ElementKind, MethodKind, Scene};
use crate::simulation::{Simulation, SimulationError, Status};
use crate::truth::{Truth, error_percent};

/// The true displacement of a scene's first probe.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Displacement, m.
    pub displacement: Vector2<f64>,
    /// Where it comes from, in words.
    pub source: &'static str,
    /// Its own estimated error, percent: of the exact beam, how far plane elasticity is from it; 0 where that is not known.
    pub error_percent: f64,
    /// How far the exact beam is from the fine solution that had to replace it, percent.
    pub beam_off_by_percent: Option<f64>,
}

impl std::fmt::Display for Reference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.source)?;
        if self.error_percent > 0.0 {
            write!(f, " (its own error about {:.1e} %)", self.error_percent)?;
        }
        self.beam_off_by_percent
            .map_or(Ok(()), |off| write!(f, "; beam theory, with its small strains, is {off:.1} % off"))
    }
}

/// Cells along a beam that is fine enough to be the truth.
const FINE: u32 = 64;
/// Triangles of a mesh from a file that is: it is refined until it has as many, and at least once.
const FINE_TRIANGLES: usize = 2000;

/// The exact beam is the truth if a fine solution is no farther from it than this, percent. A stubby beam under a large
/// load is: its strains are large, and a section does not stay straight.
const BEAM_AGREES: f64 = 0.5;

impl Reference {
    /// Finds it.
    ///
    /// # Errors
    /// [`StudyError`]: nothing moves, or the fine solution was not found.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        let at_right = scene.probes.first().ok_or(StudyError::NoProbe)?.edge.as_deref() == Some("right");
        let beam = Truth::of(scene).filter(|_| at_right).and_then(|t| t.tip_displacement());
        let exact = |displacement, error_percent| Self {
            displacement,
            source: "the exact beam",
            error_percent,
            beam_off_by_percent: None,
        };
        moving(match (beam, Self::fine(scene)) {
            (Some(beam), Ok(fine)) => {
                let off = error_percent(fine.displacement, beam).unwrap_or(0.0);
                let agrees = off <= BEAM_AGREES;
                if agrees { exact(beam, off) } else { Self { beam_off_by_percent: Some(off), ..fine } }
            }
            // Extremely slender: nothing to compare with, and nothing better.
            (Some(beam), Err(StudyError::NoTruth)) => exact(beam, 0.0),
            (_, fine) => fine?,
        })
    }

    /// The distance between two displacements over the true one's length, percent.
    pub(super) fn percent(&self, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
        100.0 * (a - b).norm() / self.displacement.norm()
    }

    /// The fine six-node solution.
    fn fine(scene: &Scene) -> Result<Self, StudyError> {
        let mut scene = scene.clone();
        scene.set_element(ElementKind::T6);
        let (coarse, fine, source) = match scene.beam.clone() {
            Some(beam) => {
                let mut solve = |along: u32| {
                    let across = (f64::from(along) * beam.height / beam.length).round().max(1.0) as u32;
                    if let Some(beam) = &mut scene.beam {
                        beam.cells = [along, across];
                    }
                    end(&scene, MethodKind::Newton, system_of(&scene)?)
                };
                (solve(FINE / 2)?, solve(FINE)?, "a fine t6 solution")
            }
            None => {
                let system = system_of(&scene)?;
                let mut mesh = system.mesh.clone();
                let mut coarse = end(&scene, MethodKind::Newton, system)?;
                let solve = |mesh: &Mesh| {
                    let system = System::with_mesh(&scene, mesh.clone()).map_err(SimulationError::from)?;
                    end(&scene, MethodKind::Newton, system)
                };
                mesh = mesh.refined();
                let mut fine = solve(&mesh)?;
                while mesh.triangle_count() < FINE_TRIANGLES {
                    mesh = mesh.refined();
                    coarse = std::mem::replace(&mut fine, solve(&mesh)?);
                }
                (coarse, fine, "the t6 solution of its refined mesh")
            }
        };
        let error_percent = error_percent(coarse, fine).unwrap_or(0.0);
        Ok(Self { displacement: fine, source, error_percent, beam_off_by_percent: None })
    }
}

/// The reference, if it moves at all: errors are relative to it.
fn moving(reference: Reference) -> Result<Reference, StudyError> {
    if reference.displacement.norm() > 0.0 { Ok(reference) } else { Err(StudyError::NoProbe) }
}

/// The equations of a scene.
pub(super) fn system_of(scene: &Scene) -> Result<System, StudyError> {
    Ok(System::new(scene).map_err(SimulationError::from)?)
}

/// Displacement of the first probe where a method ends, given all the iterations it needs.
pub(super) fn end(scene: &Scene, method: MethodKind, system: System) -> Result<Vector2<f64>, StudyError> {
    let mut scene = scene.clone();
    scene.solver.method = method;
    scene.solver.max_iterations = scene.solver.max_iterations.max(200);
    let mut simulation = Simulation::with_system(&scene, system)?;
    if *simulation.solve() != Status::Converged && method == MethodKind::Newton {
        return Err(StudyError::NoTruth);
    }
    probe(&simulation)
}

/// Displacement of the first probe, m.
pub(super) fn probe(simulation: &Simulation) -> Result<Vector2<f64>, StudyError> {
    let probe = simulation.system().probes.first().ok_or(StudyError::NoProbe)?;
    Ok(probe.mean(simulation.displacement()))
}
