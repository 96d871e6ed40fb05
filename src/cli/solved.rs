//! The result of the command `solve`, which the JSON object and the printed text render.

use std::time::Duration;

use crate::mesh::Mesh;
use crate::scene::Scene;
use crate::simulation::{Solution, StressResult};
use crate::study::{PathSummary, Reference};
use crate::timings::Timings;

/// Durations of the parts of a solve.
pub(super) struct Spent {
    /// The whole, by the clock.
    pub wall: Duration,
    /// Reading, meshing, the order of elimination.
    pub set_up: Duration,
    /// The solve.
    pub stages: Timings,
    /// Recovering stresses, and estimating the mesh's error from them.
    pub stress: Duration,
    /// Finding the reference solution.
    pub reference: Duration,
}

impl Spent {
    /// The whole, by the clock.
    pub(super) fn wall(&self) -> Duration {
        self.wall
    }

    /// The four stages of the solve.
    pub(super) fn solve(&self) -> Duration {
        self.stages.total().saturating_sub(self.stages.certify)
    }

    /// The parts that sum to the whole, each with the name it has in JSON.
    pub(super) fn parts(&self) -> [(&'static str, Duration); 9] {
        let Self { wall, set_up, stages, stress, reference } = *self;
        let Timings { rotate, assemble, factorize, solve, certify } = stages;
        let other = wall.saturating_sub(set_up + stages.total() + stress + reference);
        [
            ("rotate", rotate),
            ("assemble", assemble),
            ("factorize", factorize),
            ("solve", solve),
            ("certify", certify),
            ("set_up", set_up),
            ("stress", stress),
            ("reference", reference),
            ("other", other),
        ]
    }
}

/// A result with everything that `solve` finds out about it.
pub(super) struct Solved<'a> {
    pub scene: &'a Scene,
    pub mesh: &'a Mesh,
    pub solution: &'a Solution,
    pub stress: &'a StressResult,
    /// Jumps and buckling on the load path to the result; `None` where that is not known.
    pub path: Option<PathSummary>,
    pub reference: Option<&'a Reference>,
    /// Sentences about what limits the result.
    pub warnings: &'a [String],
    pub spent: &'a Spent,
}
