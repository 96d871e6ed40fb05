//! Warped stiffness: Müller and Gross 2004, "Interactive Virtual Materials"; article eq. (2), R K (Rᵀ x − X) = f.
//!
//! Fixed-point iteration x ← A(R)⁻¹ (f + R K X), R the polar factor of x. If it converges, the result is an exact
//! equilibrium of the corotated energy; it converges for small loads: for a cantilever up to about P L²/(E I) = 3.
//!
//! Large rotations of supports are applied in parts, one iteration each, and the load with them.

use super::status::StallDetector;
use super::{Iteration, IterationError, Method, MethodEntry, MotionMethod, Restart, Verdict};
use crate::assembly::Kinematics;
use crate::element::Tangent;
use crate::scene::MethodKind;

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Warped,
    id: "warped",
    about: "Warped stiffness: the article's fixed-point iteration, in which the stiffness of every element rotates \
            with it. Allows large rotations, but diverges under large loads.",
    start: || Box::<Warped>::default(),
    motion: Some(MotionMethod::Warped),
};

/// Method `warped`, the article's iteration.
#[derive(Clone, Debug)]
pub struct Warped {
    stall: StallDetector,
    load_factor: f64,
    load_steps: u32,
}

impl Default for Warped {
    fn default() -> Self {
        Self { stall: StallDetector::default(), load_factor: 1.0, load_steps: 1 }
    }
}

impl Method for Warped {
    fn copy(&self) -> Box<dyn Method> {
        Box::new(self.clone())
    }

    fn restart(&mut self, _: Restart) {
        *self = Self::default();
    }

    fn tangent(&self) -> Option<Tangent> {
        Some(Tangent::WARPED)
    }

    fn load_factor(&self) -> f64 {
        self.load_factor
    }

    fn load_steps(&self) -> u32 {
        self.load_steps
    }

    fn step_ratio(&self) -> Option<f64> {
        self.stall.steps.ratio()
    }

    fn iterate(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        if it.supports_rotate_in_steps() {
            (self.load_factor, self.load_steps) = (0.0, 0);
        }
        if self.load_factor < 1.0 {
            self.load_factor = (self.load_factor + it.problem.supports().largest_load_step()).min(1.0);
            self.load_steps += 1;
            it.workspace.tangent = None;
        }
        it.carry(self.load_factor);
        it.assemble(Tangent::WARPED, self.load_factor);
        it.factorize()?;
        it.put_supports(self.load_factor, Kinematics::Corotated);
        it.step().map(|step| self.stall.steps.stepped(step))
    }

    fn check_convergence(&mut self, it: &mut Iteration<'_>) -> Verdict {
        if self.load_factor < 1.0 || !it.supports_are_at(1.0, Kinematics::Corotated) {
            return Verdict::Continue;
        }
        self.stall.check_convergence(it)
    }
}
