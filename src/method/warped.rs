//! Warped stiffness: Müller and Gross 2004, "Interactive Virtual Materials"; article eq. (2), R K (Rᵀ x − X) = f.
//!
//! Fixed-point iteration x ← A(R)⁻¹ (f + R K X), R the polar factor of x. If it converges, the result is an exact
//! equilibrium of the corotated energy; it converges for small loads: for a cantilever up to about P L²/(E I) = 3.
//!
//! Large rotations of supports are applied in parts, one iteration each, and the load with them.

use super::status::StallDetector;
use super::{Criteria, IterationError, Method, MethodEntry, MethodReport, Restart, Verdict};
use crate::assembly::Kinematics;
use crate::element::Tangent;
use crate::scene::MethodKind;
use crate::step::{Iteration, Linearization, Operation};

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Warped,
    id: "warped",
    about: "Warped stiffness: the article's fixed-point iteration, in which the stiffness of every element rotates \
            with it. Allows large rotations, but diverges under large loads.",
    start: || Box::<Warped>::default(),
    colors: [[128, 50, 190], [202, 160, 255]],
};

/// Method `warped`, the article's iteration.
#[derive(Clone, Debug, Default)]
pub struct Warped {
    stall: StallDetector,
    /// Part of the load; `None` for the whole.
    load_factor: Option<f64>,
    load_steps: u32,
    /// `true` if a mouse spring pulls the body: a hand is no load of the scene, and Newton's steps follow it.
    is_pulled: bool,
}

impl Method for Warped {
    fn copy(&self) -> Box<dyn Method> {
        Box::new(self.clone())
    }

    fn restart(&mut self, _: Restart) {
        *self = Self::default();
    }

    fn linearization(&self) -> Linearization {
        let tangent = if self.is_pulled { Tangent::EXACT } else { Tangent::WARPED };
        Linearization::corotated(tangent, self.load_factor.unwrap_or(1.0))
    }

    fn report(&self) -> MethodReport {
        MethodReport { load_steps: self.load_steps.max(1), ..MethodReport::DEFAULT }
    }

    fn plan(&mut self, it: &mut Iteration<'_>, _: &Criteria) -> Result<Operation, IterationError> {
        if it.supports_rotate_in_steps() {
            (self.load_factor, self.load_steps) = (Some(0.0), 0);
        }
        if let Some(factor) = self.load_factor.filter(|factor| *factor < 1.0) {
            self.load_factor = Some((factor + it.problem.supports().largest_load_step()).min(1.0));
            self.load_steps += 1;
            it.workspace.tangent = None;
        }
        self.is_pulled = it.problem.mouse_spring().is_some();
        it.carry(self.linearization());
        it.put_supports(self.linearization());
        Ok(if self.is_pulled { Operation::FactorizeIndefinite } else { Operation::Factorize })
    }

    fn check_convergence(&mut self, it: &mut Iteration<'_>, criteria: &Criteria, _: Option<f64>) -> Verdict {
        if self.load_factor.is_some_and(|factor| factor < 1.0) || !it.supports_are_at(1.0, Kinematics::Corotated) {
            return Verdict::Continue;
        }
        self.stall.check_convergence(it, criteria)
    }
}
