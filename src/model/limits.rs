//! Ranges of numbers. Those of single keys are in the list of keys: [`range`](super::keys::range).

use crate::format::number;
use crate::sentence::{Sentence, sentence};

/// Closed range and its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Unit, empty for pure numbers.
    pub unit: &'static str,
    /// Smallest accepted value.
    pub min: f64,
    /// Largest accepted value.
    pub max: f64,
}

impl Limit {
    pub(super) const fn new(unit: &'static str, min: f64, max: f64) -> Self {
        Self { unit, min, max }
    }

    /// Returns both ends as texts, the upper one with the unit.
    pub(super) fn ends(&self) -> [String; 2] {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        [number(self.min), number(self.max) + &unit]
    }

    /// Checks that `value` is in the range.
    ///
    /// # Errors
    /// The message for values out of range, NaN and infinities.
    pub fn check(&self, value: f64) -> Result<(), Sentence> {
        if value >= self.min && value <= self.max { Ok(()) } else { Err(self.expected(&number(value))) }
    }

    /// Returns the message for `got`, which is not a number in the range.
    pub fn expected(&self, got: &str) -> Sentence {
        let [low, high] = self.ends();
        sentence!("expected %{low} to %{high}, got %{got}", low, high, got)
    }
}

/// Total number of cells; limited by the memory of the factorization (about a million unknowns).
pub const TOTAL_CELLS: Limit = Limit::new("", 1.0, 250_000.0);
/// A coordinate.
pub const COORDINATE: Limit = Limit::new("m", -1e6, 1e6);
/// Width of a support or force.
pub const WIDTH: Limit = Limit::new("m", 0.0, 1e6);
/// Prescribed rotation of a support.
pub const ROTATION: Limit = Limit::new("rad", -100.0, 100.0);
/// Time limit of a solve.
pub const BUDGET_MS: Limit = Limit::new("ms", 1e-6, 1e6);
/// Playback speed of a motion, simulated seconds per second.
pub const PLAYBACK_SPEED: Limit = Limit::new("", 1e-6, 1e6);
