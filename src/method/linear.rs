//! Linear finite elements, article eqs. (1) and (3): K (x − X) = f. Right while rotations are small, absurdly long
//! beyond.

use nalgebra::Vector2;

use super::status::{Watch, farthest};
use super::{Frame, FrameError, Method, Occasion, Verdict};
use crate::assembly::System;
use crate::rotation::Rotation;

pub(super) const ABOUT: &str = "Linear FEM: one solve, right only while rotations stay small; beams swell beyond.";

/// The warped frame with every rotation the identity.
#[derive(Clone, Debug, Default)]
pub struct Linear(Watch);

impl Method for Linear {
    fn begin(&mut self, _: Occasion) {
        *self = Self::default();
    }

    fn rotate(&self, _: &System, _: &[Vector2<f64>], r: &mut [Rotation]) {
        r.fill(Rotation::IDENTITY);
    }

    fn corotates(&self) -> bool {
        false
    }

    fn solve(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        frame.step_with_warped_stiffness().map(|step| self.0.steps.stepped(step))
    }

    fn judge(&mut self, frame: &mut Frame<'_>) -> Verdict {
        self.0.judge(frame.residual, frame.goal.tolerance, farthest(frame.system, frame.u))
    }
}
