//! Warped stiffness: Müller and Gross 2004, "Interactive Virtual Materials"; article eq. (2), R K (Rᵀ x − X) = f.
//!
//! A fixed-point iteration x ← A(R)⁻¹ (f + R K X), R the polar factor of x. Where it converges the result is an exact
//! equilibrium of the corotated energy; it converges while the load is small: for a cantilever up to about P L²/(E I) = 3.

use nalgebra::Vector2;

use super::status::{Watch, farthest};
use super::{Frame, FrameError, Method, Occasion, Verdict};
use crate::assembly::System;
use crate::rotation::Rotation;

pub(super) const ABOUT: &str = "Warped stiffness: the article's iteration, every element seen turned back. Large rotations, but it diverges under large loads.";

/// The article's iteration.
#[derive(Clone, Debug, Default)]
pub struct Warped(Watch);

impl Method for Warped {
    fn begin(&mut self, _: Occasion) {
        *self = Self::default();
    }

    fn rotate(&self, system: &System, u: &[Vector2<f64>], r: &mut [Rotation]) {
        system.elements.rotations(u, r);
    }

    fn corotates(&self) -> bool {
        true
    }

    fn step_ratio(&self) -> Option<f64> {
        self.0.steps.ratio()
    }

    fn solve(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        frame.step_with_warped_stiffness().map(|step| self.0.steps.stepped(step))
    }

    fn judge(&mut self, frame: &mut Frame<'_>) -> Verdict {
        self.0.judge(frame.residual, frame.goal.tolerance, farthest(frame.system, frame.u))
    }
}
