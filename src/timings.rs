//! Where the time goes.

use std::time::{Duration, Instant};

/// Time spent in each stage of an iteration or a time step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings {
    /// Rotations and turns of edges found apart, at the end of time steps; those of an iteration are found in the sweep
    /// that assembles.
    pub rotate: Duration,
    /// Rotations, stiffness, forces, residual.
    pub assemble: Duration,
    /// Numeric factorization.
    pub factorize: Duration,
    /// Forward and back substitution, update.
    pub solve: Duration,
    /// What is known of the result: its stability, and ρ.
    pub certify: Duration,
}

impl Timings {
    /// All stages together.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.rotate + self.assemble + self.factorize + self.solve + self.certify
    }

    /// Adds other timings, stage by stage.
    pub fn add(&mut self, other: &Self) {
        self.rotate += other.rotate;
        self.assemble += other.assemble;
        self.factorize += other.factorize;
        self.solve += other.solve;
        self.certify += other.certify;
    }
}

/// Runs `work` and adds the time it took to `stage`.
pub(crate) fn timed<T>(stage: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *stage += start.elapsed();
    result
}
