//! Ranges of numbers: those that the window, the commands and the list of keys share.

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
    #[must_use]
    pub fn expected(&self, got: &str) -> Sentence {
        let [low, high] = self.ends();
        sentence!("expected %{low} to %{high}, got %{got}", low, high, got)
    }
}

/// Beam length.
pub const LENGTH: Limit = Limit::new("m", 1e-6, 1e6);
/// Beam height.
pub const HEIGHT: Limit = Limit::new("m", 1e-6, 1e6);
/// Cells along one direction.
pub const CELLS: Limit = Limit::new("", 1.0, 100_000.0);
/// Total number of cells; limited by the memory of the factorization (about a million unknowns).
pub const TOTAL_CELLS: Limit = Limit::new("", 1.0, 250_000.0);
/// Young's modulus.
pub const YOUNG: Limit = Limit::new("Pa", 1e-6, 1e15);
/// Poisson ratio, plane stress.
pub const POISSON_STRESS: Limit = Limit::new("", -0.99, 0.5);
/// Poisson ratio, plane strain, where ½ is incompressible and λ infinite.
pub const POISSON_STRAIN: Limit = Limit::new("", -0.99, 0.4999);
/// Density.
pub const DENSITY: Limit = Limit::new("kg/m³", 0.0, 1e6);
/// Thickness out of the plane.
pub const THICKNESS: Limit = Limit::new("m", 1e-6, 1e6);
/// Magnitude of a force.
pub const FORCE: Limit = Limit::new("N", 0.0, 1e15);
/// A moment.
pub const MOMENT: Limit = Limit::new("N m", -1e15, 1e15);
/// Direction of a force or of gravity, from the x axis, counter-clockwise.
pub const DIRECTION: Limit = Limit::new("°", -180.0, 180.0);
/// Magnitude of gravity.
pub const ACCELERATION: Limit = Limit::new("m/s²", 0.0, 1e6);
/// A coordinate.
pub const COORDINATE: Limit = Limit::new("m", -1e6, 1e6);
/// Width of a support or force.
pub const WIDTH: Limit = Limit::new("m", 0.0, 1e6);
/// Prescribed rotation of a support.
pub const ROTATION: Limit = Limit::new("rad", -100.0, 100.0);
/// Iterations after which a result is accepted without convergence; 0 for never.
pub const ACCEPT_AFTER: Limit = Limit::new("", 0.0, 100_000.0);
/// Requested largest error.
pub const MAX_ERROR_PERCENT: Limit = Limit::new("%", 1e-6, 100.0);
/// Time limit of a solve.
pub const BUDGET_MS: Limit = Limit::new("ms", 1e-6, 1e6);
/// Playback speed of a motion, simulated seconds per second.
pub const PLAYBACK_SPEED: Limit = Limit::new("", 1e-6, 1e6);
/// Time step of a dynamic scene.
pub const TIME_STEP: Limit = Limit::new("s", 1e-9, 1e3);
/// Duration of a headless run.
pub const DURATION: Limit = Limit::new("s", 1e-9, 1e6);
/// Mass-proportional factor α of Rayleigh damping.
pub const MASS_DAMPING: Limit = Limit::new("1/s", 0.0, 1e6);
/// Stiffness-proportional factor β of Rayleigh damping.
pub const STIFFNESS_DAMPING: Limit = Limit::new("s", 0.0, 1e6);
