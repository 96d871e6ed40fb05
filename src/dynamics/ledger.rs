//! Energy ledger of a motion.

use nalgebra::Vector2;

use super::step::StepEnergy;
use crate::assembly::{Mass, Problem};
use crate::format::{engineering, percent};
use crate::sentence::{Sentence, sentence};
use crate::state::State;

/// Largest energy gained from the integrator, relative to the energy put in, with which a motion counts as a success.
const MAX_GAIN: f64 = 0.1;
/// Smallest energy gained, relative to the energy put in, for which the time step is reported as too long.
const MIN_NOTED_GAIN: f64 = 0.01;
/// Smallest fraction of the energy put in whose loss is noted.
const MIN_NOTED_LOSS: f64 = 0.1;

/// Energies of a motion, J, and the energy added and removed since its start: kinetic + elastic + potential +
/// dissipated + integrator − pulses − mouse_spring − edits = start, up to the rounding error [`Self::imbalance`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Ledger {
    /// Kinetic energy ½ v M v.
    pub kinetic: f64,
    /// Elastic energy of the body.
    pub elastic: f64,
    /// Potential of the constant loads, relative to rest.
    pub potential: f64,
    /// Energy removed by damping.
    pub dissipated: f64,
    /// Energy removed by the integrator; negative if it has added energy.
    pub integrator: f64,
    /// Work of pulses.
    pub pulses: f64,
    /// Work of mouse springs.
    pub mouse_spring: f64,
    /// Energy added by edits of the scene during the motion.
    pub edits: f64,
    /// Kinetic, elastic and potential energy at the start.
    pub start: f64,
    /// Largest kinetic energy since the start.
    pub largest_kinetic: f64,
    /// Sum of all energy converted from one kind into another.
    pub throughput: f64,
    /// Largest energy given to the body since the start, J: its kinetic and elastic energy at the start, and the work
    /// of loads, mouse springs, supports and edits on it, minus the work done by it.
    pub put_in: f64,
}

impl Ledger {
    /// Returns the ledger of a state at the start of a motion.
    pub(crate) fn open(problem: &Problem, mass: &Mass, is_lumped: bool, state: &State) -> Self {
        let mut ledger = Self::default();
        ledger.measure(problem, mass, is_lumped, state);
        ledger.start = ledger.total();
        ledger.note_put_in();
        ledger
    }

    /// Raises [`Self::put_in`] to the current value: the energy in the body plus all energy removed from it.
    fn note_put_in(&mut self) {
        self.put_in = self.put_in.max(self.kinetic + self.elastic + self.dissipated + self.integrator);
    }

    fn measure(&mut self, problem: &Problem, mass: &Mass, is_lumped: bool, state: &State) {
        self.kinetic = 0.5
            * match is_lumped {
                false => mass.energy_product(&state.velocity),
                true => state.velocity.iter().zip(&mass.lumped).map(|(v, m)| m * v.norm_squared()).sum(),
            };
        self.elastic = problem.elastic_energy(state);
        self.potential = problem.loads().potential(state, 1.0);
        self.largest_kinetic = self.largest_kinetic.max(self.kinetic);
    }

    /// Records a step that ended in `state`.
    pub(crate) fn record(
        &mut self,
        energies: &StepEnergy,
        problem: &Problem,
        mass: &Mass,
        is_lumped: bool,
        state: &State,
    ) {
        let before = *self;
        self.measure(problem, mass, is_lumped, state);
        self.dissipated += energies.dissipated;
        self.pulses += energies.pulses;
        self.mouse_spring += energies.mouse_spring;
        let changes = [self.kinetic - before.kinetic, self.elastic - before.elastic, self.potential - before.potential];
        let lost = energies.lost.unwrap_or_else(|| {
            energies.pulses + energies.mouse_spring - energies.dissipated - changes.iter().sum::<f64>()
        });
        self.integrator += lost;
        let recorded = [energies.dissipated, energies.pulses, energies.mouse_spring, lost];
        self.throughput += changes.iter().chain(&recorded).map(|v| v.abs()).sum::<f64>();
        self.note_put_in();
    }

    /// Returns `true` if the integrator has added more energy since `before` than the fraction `part` of the energy at
    /// that time plus the work done since.
    pub(crate) fn has_gained_since(&self, before: &Self, part: f64) -> bool {
        let work = (self.pulses - before.pulses).abs() + (self.mouse_spring - before.mouse_spring).abs();
        let there = before.kinetic + before.elastic + (self.potential - before.potential).abs();
        before.integrator - self.integrator > part * (there + work)
    }

    /// Records an edit that leaves the state unchanged.
    pub(crate) fn edit(&mut self, problem: &Problem, mass: &Mass, is_lumped: bool, state: &State) {
        let before = self.total();
        self.measure(problem, mass, is_lumped, state);
        self.edits += self.total() - before;
        self.throughput += (self.total() - before).abs();
        self.note_put_in();
    }

    /// Records that the state's energy is computed by another theory from now on; the difference counts as energy of
    /// the integrator.
    pub(crate) fn change_theory(&mut self, problem: &Problem, mass: &Mass, is_lumped: bool, state: &State) {
        let before = self.total();
        self.measure(problem, mass, is_lumped, state);
        self.integrator -= self.total() - before;
        self.throughput += (self.total() - before).abs();
    }

    /// Returns the sum of the kinetic energy, the elastic energy and the potential of the loads, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.potential
    }

    /// Returns the deviation of the sum of all entries from the energy at the start, J: rounding error, if every entry
    /// is right.
    pub fn imbalance(&self) -> f64 {
        self.total() - self.start + self.dissipated + self.integrator - self.pulses - self.mouse_spring - self.edits
    }

    /// Returns the energy added by the integrator relative to the largest kinetic energy; 0 if nothing has moved.
    pub fn drift(&self) -> f64 {
        let drift = -self.integrator / self.largest_kinetic;
        if drift.is_finite() { drift } else { 0.0 }
    }

    /// Returns the energy added by the integrator relative to [`Self::put_in`]; negative if it has lost energy, down to
    /// −1, and 0 if no energy was put in.
    pub fn drift_of_input(&self) -> f64 {
        let drift = -self.integrator / self.put_in;
        if drift.is_finite() { drift } else { 0.0 }
    }

    /// Returns `true` if the integrator has added more than a tenth of the energy put in: the motion is not that of the
    /// body.
    pub fn has_gained_too_much(&self) -> bool {
        self.drift_of_input() > MAX_GAIN
    }

    /// Returns a warning if the integrator has added more than a hundredth of the energy put in, or lost more than a tenth.
    #[doc(hidden)]
    pub fn drift_warning(&self) -> Option<Sentence> {
        let drift = self.drift_of_input();
        let (energy, percent) = (engineering(self.integrator.abs(), "J"), percent(100.0 * drift.abs()));
        match drift {
            _ if drift > MIN_NOTED_GAIN => Some(sentence!(
                "the integrator gained %{energy}, %{percent} of the energy put in: the time step is too long",
                energy,
                percent
            )),
            _ if drift < -MIN_NOTED_LOSS => Some(sentence!(
                "the integrator lost %{energy}, %{percent} of the energy put in: shorter time steps lose less",
                energy,
                percent
            )),
            _ => None,
        }
    }
}

/// Momentum and angular momentum of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Momentum {
    /// Σ M v, kg m/s.
    pub linear: Vector2<f64>,
    /// Σ x × M v about the origin, kg m²/s, counter-clockwise.
    pub angular: f64,
}

impl Momentum {
    /// Computes the momentum of a state.
    pub(crate) fn of(problem: &Problem, mass: &Mass, is_lumped: bool, state: &State) -> Self {
        let mut nodal = state.velocity.clone();
        match is_lumped {
            false => mass.multiply(&state.velocity, &mut nodal),
            true => nodal.iter_mut().zip(&mass.lumped).for_each(|(p, m)| *p *= *m),
        }
        let positions = problem.system().mesh().nodes().iter().zip(&state.displacement).map(|(x, u)| x + u);
        Self { linear: nodal.iter().sum(), angular: positions.zip(&nodal).map(|(x, p)| x.perp(p)).sum() }
    }
}

#[cfg(test)]
mod tests {
    use super::Ledger;

    /// Energy added by the integrator is compared with the energy at the earlier time, the change of the potential, and
    /// the work since; losses never count.
    #[test]
    fn an_energy_gain_is_relative_to_the_initial_energy_and_the_work() {
        let before = Ledger {
            kinetic: 3.0,
            elastic: 2.0,
            potential: -1.0,
            integrator: 0.5,
            pulses: 1.0,
            mouse_spring: -2.0,
            ..Ledger::default()
        };
        // The energy was 3 + 2 J, the potential changes by 2.5 J, and the works since are 1.5 J and 3 J.
        let after = |added: f64| Ledger {
            kinetic: 40.0,
            elastic: 50.0,
            potential: 1.5,
            integrator: 0.5 - added,
            pulses: -0.5,
            mouse_spring: -5.0,
            ..before
        };
        for (added, gained) in [(2.99, false), (3.01, true), (0.0, false), (-10.0, false)] {
            assert_eq!(after(added).has_gained_since(&before, 0.25), gained, "{added} J of 12 J");
        }
    }
}
