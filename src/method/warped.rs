//! Warped stiffness: Müller and Gross 2004, "Interactive Virtual Materials"; article eq. (2), R K (Rᵀ x − X) = f.
//!
//! A fixed-point iteration x ← A(R)⁻¹ (f + R K X), R the polar factor of x. Where it converges the result is an exact
//! equilibrium of the corotated energy; it converges while the load is small: for a cantilever up to about P L²/(E I) = 3.

use super::status::{StallDetector, farthest};
use super::{Iteration, IterationError, Method, MethodEntry, Restart, Verdict};
use crate::element::Tangent;
use crate::scene::MethodKind;

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Warped,
    id: "warped",
    about: "Warped stiffness: the article's iteration, every element seen turned back. Large rotations, but it diverges under large loads.",
    colors: [[128, 50, 190], [202, 160, 255]],
    start: || Box::<Warped>::default(),
};

/// The article's iteration.
#[derive(Clone, Debug, Default)]
pub struct Warped(StallDetector);

impl Method for Warped {
    fn restart(&mut self, _: Restart) {
        *self = Self::default();
    }

    fn tangent(&self) -> Option<Tangent> {
        Some(Tangent::WARPED)
    }

    fn step_ratio(&self) -> Option<f64> {
        self.0.steps.ratio()
    }

    fn iterate(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        it.assemble(Tangent::WARPED, 1.0);
        it.factorize()?;
        it.step().map(|step| self.0.steps.stepped(step))
    }

    fn judge(&mut self, it: &mut Iteration<'_>) -> Verdict {
        self.0.judge(it.residual, it.tolerances.residual, farthest(it.system(), it.state))
    }
}
