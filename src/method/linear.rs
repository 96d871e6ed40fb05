//! Linear finite elements, article eqs. (1) and (3): K (x − X) = f. Valid while rotations are small; beyond, bodies
//! grow far too long.

use super::status::StallDetector;
use super::{Criteria, IterationError, Method, MethodEntry, Restart, Verdict};
use crate::assembly::Kinematics;
use crate::element::Tangent;
use crate::scene::MethodKind;
use crate::step::{Iteration, Linearization, Operation, RotationUpdate};

pub(super) const ENTRY: MethodEntry = MethodEntry {
    kind: MethodKind::Linear,
    id: "linear",
    about: "Linear FEM: one solve, accurate only for small rotations; under larger ones the area of the body grows.",
    start: || Box::<Linear>::default(),
    colors: [[200, 90, 0], [240, 150, 60]],
};

/// The warped iteration with identity rotations: the first solve gives the result, further ones refine it.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    stall: StallDetector,
    /// `true` if the workspace holds the factor of K.
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

    fn linearization(&self) -> Linearization {
        Linearization { kinematics: Kinematics::Linear, tangent: None, load_factor: 1.0 }
    }

    fn plan(&mut self, it: &mut Iteration<'_>, _: &Criteria) -> Result<Operation, IterationError> {
        // The tangent of a mouse spring is not constant.
        let held = it.problem.mouse_spring().is_some();
        let keeps_factor = self.factorized && !held;
        if !keeps_factor {
            it.linearize(
                RotationUpdate::Keep,
                Linearization { tangent: Some(Tangent::WARPED), ..self.linearization() },
            );
        }
        if !self.solved && !held {
            // The result does not depend on the previous state; a large displacement would only add rounding errors.
            it.state.displacement.reset();
            it.forces.residual.copy_from_slice(&it.forces.external);
            self.solved = true;
        }
        it.put_supports(self.linearization());
        Ok(if keeps_factor { Operation::Solve } else { Operation::Factorize })
    }

    fn check_convergence(&mut self, it: &mut Iteration<'_>, criteria: &Criteria, step: Option<f64>) -> Verdict {
        self.factorized = step.map_or(self.factorized, |_| it.problem.mouse_spring().is_none());
        if !it.supports_are_at(1.0, Kinematics::Linear) {
            return Verdict::Continue;
        }
        self.stall.check_convergence(it, criteria)
    }
}
