//! Where the energy goes.

use nalgebra::Vector2;

use super::Inertia;
use super::step::Booking;
use crate::assembly::{Mass, Problem};
use crate::state::State;

/// The energies of a motion, J, and what has been added and taken since its start. They sum to what was there at the
/// start: [`Self::imbalance`] is what rounding leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Ledger {
    /// ½ v M v.
    pub kinetic: f64,
    /// Stored in the body.
    pub elastic: f64,
    /// Potential of the loads that act always, relative to rest.
    pub potential: f64,
    /// Taken by damping.
    pub dissipated: f64,
    /// Taken by the integrator; negative where it has added energy.
    pub integrator: f64,
    /// Work of loads in time.
    pub pulses: f64,
    /// Work of hands.
    pub hands: f64,
    /// Put in by edits of the scene in mid-motion.
    pub edits: f64,
    /// Kinetic, elastic and potential energy at the start.
    pub start: f64,
    /// The largest kinetic energy so far.
    pub largest_kinetic: f64,
    /// All that was ever turned from one kind into another.
    pub throughput: f64,
    /// The most energy that the body has been given since the start, J: its kinetic and elastic energy then, and the work of
    /// loads, hands, supports and edits, less the work that it has done on them.
    pub put_in: f64,
}

impl Ledger {
    /// That of a state at the start of a motion.
    pub(crate) fn open(problem: &Problem, mass: &Mass, inertia: Inertia, state: &State) -> Self {
        let mut ledger = Self::default();
        ledger.measure(problem, mass, inertia, state);
        ledger.start = ledger.total();
        ledger.note_put_in();
        ledger
    }

    /// Raises [`Self::put_in`] to what has been given now: all that is left of it, and all that was taken from it.
    fn note_put_in(&mut self) {
        self.put_in = self.put_in.max(self.kinetic + self.elastic + self.dissipated + self.integrator);
    }

    fn measure(&mut self, problem: &Problem, mass: &Mass, inertia: Inertia, state: &State) {
        self.kinetic = kinetic_energy(mass, inertia, state);
        self.elastic = problem.elastic_energy(state);
        self.potential = problem.loads().potential(state, 1.0);
        self.largest_kinetic = self.largest_kinetic.max(self.kinetic);
    }

    /// Books a step that has led to `state`.
    pub(crate) fn book(&mut self, booking: &Booking, problem: &Problem, mass: &Mass, inertia: Inertia, state: &State) {
        let before = *self;
        self.measure(problem, mass, inertia, state);
        self.dissipated += booking.dissipated;
        self.pulses += booking.pulses;
        self.hands += booking.hand;
        let changes = [self.kinetic - before.kinetic, self.elastic - before.elastic, self.potential - before.potential];
        let lost = booking
            .lost
            .unwrap_or_else(|| booking.pulses + booking.hand - booking.dissipated - changes.iter().sum::<f64>());
        self.integrator += lost;
        let booked = [booking.dissipated, booking.pulses, booking.hand, lost];
        self.throughput += changes.iter().chain(&booked).map(|v| v.abs()).sum::<f64>();
        self.note_put_in();
    }

    /// Whether the integrator has added more, since an earlier ledger, than this part of the energy there was then and
    /// of the work done since.
    pub(crate) fn has_gained_since(&self, before: &Self, part: f64) -> bool {
        let work = (self.pulses - before.pulses).abs() + (self.hands - before.hands).abs();
        let there = before.kinetic + before.elastic + (self.potential - before.potential).abs();
        before.integrator - self.integrator > part * (there + work)
    }

    /// Books an edit that leaves the state where it is.
    pub(crate) fn edit(&mut self, problem: &Problem, mass: &Mass, inertia: Inertia, state: &State) {
        let before = self.total();
        self.measure(problem, mass, inertia, state);
        self.edits += self.total() - before;
        self.throughput += (self.total() - before).abs();
        self.note_put_in();
    }

    /// Books that the state is seen under another theory from now on: what it differs by is the integrator's.
    pub(crate) fn change_theory(&mut self, problem: &Problem, mass: &Mass, inertia: Inertia, state: &State) {
        let before = self.total();
        self.measure(problem, mass, inertia, state);
        self.integrator -= self.total() - before;
        self.throughput += (self.total() - before).abs();
    }

    /// Kinetic, elastic and potential energy, J.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.potential
    }

    /// What the sum of all entries lacks, J: rounding, where every entry is right.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        self.total() - self.start + self.dissipated + self.integrator - self.pulses - self.hands - self.edits
    }

    /// The energy that the integrator has added, over the largest kinetic energy; 0 where nothing has moved.
    #[must_use]
    pub fn drift(&self) -> f64 {
        let drift = -self.integrator / self.largest_kinetic;
        if drift.is_finite() { drift } else { 0.0 }
    }

    /// The energy that the integrator has added, over [`Self::put_in`]; negative where it has lost energy, down to −1, and 0
    /// where nothing was put in.
    #[must_use]
    pub fn drift_of_input(&self) -> f64 {
        let drift = -self.integrator / self.put_in;
        if drift.is_finite() { drift } else { 0.0 }
    }
}

/// ½ v M v, J.
fn kinetic_energy(mass: &Mass, inertia: Inertia, state: &State) -> f64 {
    0.5 * match inertia {
        Inertia::Consistent => mass.energy_product(&state.velocity),
        Inertia::Lumped => state.velocity.iter().zip(mass.lumped()).map(|(v, m)| m * v.norm_squared()).sum(),
    }
}

/// Momentum of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Momentum {
    /// Σ M v, kg m/s.
    pub linear: Vector2<f64>,
    /// Σ x × M v about the origin, kg m²/s, counter-clockwise.
    pub angular: f64,
}

impl Momentum {
    /// Of a state.
    #[must_use]
    pub fn of(problem: &Problem, mass: &Mass, inertia: Inertia, state: &State) -> Self {
        let mut nodal = state.velocity.clone();
        match inertia {
            Inertia::Consistent => mass.multiply(&state.velocity, &mut nodal),
            Inertia::Lumped => nodal.iter_mut().zip(mass.lumped()).for_each(|(p, m)| *p *= *m),
        }
        let positions = problem.system().mesh().nodes().iter().zip(&state.displacement).map(|(x, u)| x + u);
        Self { linear: nodal.iter().sum(), angular: positions.zip(&nodal).map(|(x, p)| x.perp(p)).sum() }
    }
}

#[cfg(test)]
mod tests {
    use super::Ledger;

    /// What an integrator has added counts against the energy there was, by how much the potential has changed, and the
    /// work done since; a loss never does.
    #[test]
    fn a_gain_is_measured_by_what_was_there_and_done() {
        let before = Ledger {
            kinetic: 3.0,
            elastic: 2.0,
            potential: -1.0,
            integrator: 0.5,
            pulses: 1.0,
            hands: -2.0,
            ..Ledger::default()
        };
        // There were 3 + 2 J, and 2.5 J of potential have come; the works since are 1.5 J and 3 J.
        let after = |added: f64| Ledger {
            kinetic: 40.0,
            elastic: 50.0,
            potential: 1.5,
            integrator: 0.5 - added,
            pulses: -0.5,
            hands: -5.0,
            ..before
        };
        for (added, gained) in [(2.99, false), (3.01, true), (0.0, false), (-10.0, false)] {
            assert_eq!(after(added).has_gained_since(&before, 0.25), gained, "{added} J of 12 J");
        }
    }
}
