//! Linear finite elements, article eqs. (1) and (3): K (x − X) = f. Right while rotations are small, absurdly long
//! beyond.

use super::status::StallDetector;
use super::{Iteration, IterationError, Method, MethodEntry, MotionMethod, Restart, Verdict};
use crate::assembly::Kinematics;
use crate::element::Tangent;
use crate::scene::MethodKind;

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Linear,
    id: "linear",
    about: "Linear FEM: one solve, right only while rotations stay small; beams swell beyond.",
    start: || Box::<Linear>::default(),
    motion: Some(MotionMethod::Linear),
};

/// The warped iteration with every rotation the identity: the first solve is the answer, further ones refine it.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    stall: StallDetector,
    /// Whether the workspace holds the factor of K.
    factorized: bool,
    solved: bool,
}

impl Method for Linear {
    fn copy(&self) -> Box<dyn Method> {
        Box::new(Self { factorized: false, ..self.clone() })
    }

    fn restart(&mut self, why: Restart) {
        let keeps_factor = matches!(why, Restart::AtRest | Restart::NewLoads);
        *self = Self { factorized: self.factorized && keeps_factor, ..Self::default() };
    }

    fn kinematics(&self) -> Kinematics {
        Kinematics::Linear
    }

    fn iterate(&mut self, it: &mut Iteration<'_>) -> Result<(), IterationError> {
        let held = it.problem.hand().is_some();
        if !self.factorized || held {
            it.assemble(Tangent::WARPED, 1.0);
            it.factorize()?;
            // A hand's tangent is not constant.
            self.factorized = !held;
        }
        if !self.solved && !held {
            // The answer does not depend on where the body was; a large displacement would only round it.
            it.state.displacement.reset();
            it.forces.residual.copy_from_slice(&it.forces.external);
            self.solved = true;
        }
        it.put_supports(1.0, Kinematics::Linear);
        it.step().map(|step| self.stall.steps.stepped(step))
    }

    fn judge(&mut self, it: &mut Iteration<'_>) -> Verdict {
        if !it.supports_are_at(1.0, Kinematics::Linear) {
            return Verdict::Continue;
        }
        self.stall.judge(it)
    }
}
