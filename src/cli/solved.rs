//! Result of the command `solve`, formatted as JSON or text.

use std::time::Duration;

use crate::section::Section;
use crate::simulation::{Simulation, Solution, StressResult};
use crate::study::{Claim, PathSummary, Reference};
use crate::timings::Timings;

/// Durations of the parts of a solve.
pub(super) struct Spent {
    /// Wall clock time of the whole command.
    pub wall: Duration,
    /// Reading, meshing and ordering.
    pub set_up: Duration,
    /// Stages of the solve.
    pub stages: Timings,
    /// Recovery of stresses, and estimate of the mesh's error.
    pub stress: Duration,
    /// Computation of the reference solution.
    pub reference: Duration,
}

impl Spent {
    /// Returns the time of the solve, without certification.
    pub(super) fn solve(&self) -> Duration {
        self.stages.total().saturating_sub(self.stages.certify)
    }

    /// Returns the parts, which sum to the whole, with their names in JSON.
    pub(super) fn parts(&self) -> [(&'static str, Duration); 9] {
        let Self { wall, set_up, stages, stress, reference } = *self;
        let Timings { rotate, linearize, factorize, solve, advance, certify } = stages;
        let other = wall.saturating_sub(set_up + stages.total() + stress + reference);
        [
            ("rotate", rotate),
            ("assemble", linearize),
            ("factorize", factorize),
            ("solve", solve + advance),
            ("certify", certify),
            ("set_up", set_up),
            ("stress", stress),
            ("reference", reference),
            ("other", other),
        ]
    }
}

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
    pub spent: Spent,
}
