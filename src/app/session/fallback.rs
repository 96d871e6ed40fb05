//! Bodies drawn in place of a search that has found no equilibrium.

use super::*;
use crate::simulation::Equilibrium;

/// Last equilibrium, and the body at rest.
#[derive(Debug, Default)]
pub(crate) struct Fallback {
    equilibrium: Option<Simulation>,
    rest: Option<Simulation>,
}

impl Fallback {
    /// Keeps a copy of an equilibrium; for a state that is none, makes the body at rest.
    pub(crate) fn keep(&mut self, simulation: &Simulation) {
        let is_found = *simulation.status() == Status::Converged && simulation.mouse_spring().is_none();
        if is_found && !self.equilibrium.as_ref().is_some_and(|kept| is_same_state(kept, simulation)) {
            self.equilibrium = simulation.equilibrium().map(Equilibrium::snapshot);
        }
        let is_wanted = is_lost(simulation) || simulation.residual() > WILD;
        if is_wanted && !self.rest.as_ref().is_some_and(|rest| is_same_body(rest, simulation)) {
            let mut scene = simulation.scene().clone();
            scene.scale_loads(0.0);
            self.rest = Simulation::with_system(&scene, simulation.system().clone()).ok();
        }
    }

    /// Returns the last equilibrium of a simulation's body if its load points the same way, or else the body at rest.
    pub(crate) fn of(&self, simulation: &Simulation) -> Option<&Simulation> {
        let of_body = |kept: &&Simulation| is_same_body(kept, simulation);
        let equilibrium = self.equilibrium.as_ref().filter(of_body);
        let equilibrium = equilibrium.filter(|kept| point_the_same_way(kept.scene(), simulation.scene()));
        equilibrium.or(self.rest.as_ref().filter(of_body))
    }
}

/// Returns `true` if a search has ended without an equilibrium.
pub(crate) fn is_lost(simulation: &Simulation) -> bool {
    matches!(simulation.status(), Status::Diverged(_) | Status::NotConverged(_))
}

/// Returns `true` if both have the same state of the same scene, and its certificate.
fn is_same_state(one: &Simulation, other: &Simulation) -> bool {
    let certificate = |of: &Simulation| of.equilibrium().and_then(|search| search.certificate());
    one.state() == other.state() && one.scene() == other.scene() && certificate(one) == certificate(other)
}

fn is_same_body(one: &Simulation, other: &Simulation) -> bool {
    Arc::ptr_eq(one.system(), other.system())
}

/// Returns `true` if each load of a scene is within 90° of that of the other scene.
fn point_the_same_way(one: &Scene, other: &Scene) -> bool {
    let dot = |[a, b]: [f64; 2], [c, d]: [f64; 2]| a * c + b * d;
    let within = |pair: (&Load, &Load)| match pair {
        (Load::Force { force: a, .. }, Load::Force { force: b, .. }) => dot(*a, *b) >= 0.0,
        (Load::Gravity { acceleration: a, .. }, Load::Gravity { acceleration: b, .. }) => dot(*a, *b) >= 0.0,
        (Load::Moment { moment: a, .. }, Load::Moment { moment: b, .. }) => a * b >= 0.0,
        _ => false,
    };
    one.loads.len() == other.loads.len() && one.loads.iter().zip(&other.loads).all(within)
}
