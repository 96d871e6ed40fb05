//! Result of the command `solve`, formatted as JSON or text.

use std::time::Duration;

use crate::section::Section;
use crate::simulation::{Simulation, Solution, StressResult};
use crate::study::{Claim, PathSummary, Reference};

/// Result of `solve` with all further information about it.
pub(super) struct SolvedScene<'a> {
    pub simulation: &'a Simulation,
    pub solution: Solution,
    pub stress: StressResult,
    /// Sections of the scene; none if the iteration diverged.
    pub sections: Vec<Section>,
    /// Jumps and buckling on the load path to the result; `None` if unknown.
    pub path: Option<PathSummary>,
    pub reference: Option<Reference>,
    /// Claims of a result at rest.
    pub claims: Vec<Claim>,
    /// Sentences about limitations of the result.
    pub warnings: Vec<String>,
    /// Wall clock time of the whole command.
    pub wall: Duration,
    /// Time of the solve, without certification.
    pub solve: Duration,
    /// Parts of the wall clock time, which sum to it, with their names in JSON.
    pub parts: [(&'static str, Duration); 9],
}
