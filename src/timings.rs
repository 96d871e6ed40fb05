//! Computing time by stage.

use web_time::{Duration, Instant};

/// Time spent in each stage of an iteration or a time step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Timings {
    /// Rotations and edge angles computed separately at the end of time steps. Those of an iteration are computed in
    /// the loop over the elements and counted in `linearize`.
    pub rotate: Duration,
    /// Rotations, stiffness, forces, residual.
    pub linearize: Duration,
    /// Numeric factorization.
    pub factorize: Duration,
    /// Forward and back substitution.
    pub solve: Duration,
    /// Update of the displacement.
    pub advance: Duration,
    /// Stability of the result, and ρ.
    pub certify: Duration,
}

impl Timings {
    /// Returns the sum of all stages.
    pub fn total(&self) -> Duration {
        self.rotate + self.linearize + self.factorize + self.solve + self.advance + self.certify
    }

    /// Adds `other`, stage by stage.
    pub fn add(&mut self, other: &Self) {
        self.rotate += other.rotate;
        self.linearize += other.linearize;
        self.factorize += other.factorize;
        self.solve += other.solve;
        self.advance += other.advance;
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
