//! Playback of a motion: clock and recorded past.

use crate::app::session::clock::RealTimeClock;
use crate::app::session::history::History;
use crate::simulation::Simulation;

/// Largest memory for the recorded moments, bytes.
const MAX_BYTES: usize = 64 << 20;
/// Shortest playing time between two recorded moments, s: one frame at 60 Hz, less rounding.
const BETWEEN_MOMENTS: f64 = 1.0 / 61.0;

/// Playback of a motion.
#[derive(Debug, Default)]
pub(crate) struct Playback {
    pub clock: RealTimeClock,
    pub history: History,
    /// Time of the displayed moment, s; `None` if it is the latest.
    pub shown: Option<f64>,
    /// Playing time since the start, s: simulated time over speed.
    pub played: f64,
    /// Playing time at which the last moment was recorded, s.
    kept: f64,
}

impl Playback {
    /// Makes the time steps that are due at `now`, s.
    pub(crate) fn advance(&mut self, now: f64, simulation: &mut Simulation) {
        let step = simulation.scene().dynamics.time_step;
        let mut steps = self.clock.begin(now, step);
        while steps.next() {
            self.make_step(simulation);
            if simulation.is_at_rest() {
                break;
            }
        }
        self.clock.end(&steps, step);
        if self.played - self.kept >= BETWEEN_MOMENTS {
            self.keep_moment(simulation);
        }
    }

    /// Makes one time step of the motion.
    pub(crate) fn step(&mut self, simulation: &mut Simulation) {
        self.make_step(simulation);
        self.keep_moment(simulation);
    }

    fn make_step(&mut self, simulation: &mut Simulation) {
        self.discard_future();
        if self.history.samples.is_empty() {
            self.history.record(simulation);
            self.keep_moment(simulation);
        }
        let before = simulation.state().time();
        simulation.step();
        self.played += (simulation.state().time() - before) / self.clock.speed;
        self.history.record(simulation);
    }

    /// Records the current moment of the motion.
    fn keep_moment(&mut self, simulation: &Simulation) {
        self.history.keep_moment(simulation, MAX_BYTES);
        self.kept = self.played;
    }

    /// Returns the times of the first and the last recorded moment, s; `None` if there is only one or none.
    pub(crate) fn span(&self) -> Option<[f64; 2]> {
        let moments = &self.history.moments;
        let ends = [moments.front()?.state().time(), moments.back()?.state().time()];
        (ends[0] < ends[1]).then_some(ends)
    }

    /// Displays the recorded moment closest to `time`, s. Later moments are kept until the next step.
    pub(crate) fn show_moment(&mut self, time: f64, simulation: &mut Simulation) {
        self.keep_latest(simulation);
        let Some(time) = self.history.nearest(time) else { return };
        self.show_exactly(time, simulation);
    }

    /// Displays the next recorded moment (`forward`) or the previous one. Returns `false` if there is none.
    pub(crate) fn show_neighbour(&mut self, forward: bool, simulation: &mut Simulation) -> bool {
        self.keep_latest(simulation);
        let Some(time) = self.history.neighbour(simulation.state().time(), forward) else { return false };
        self.show_exactly(time, simulation);
        true
    }

    fn keep_latest(&mut self, simulation: &Simulation) {
        if self.shown.is_none() && !self.history.samples.is_empty() {
            self.keep_moment(simulation);
        }
    }

    fn show_exactly(&mut self, time: f64, simulation: &mut Simulation) {
        // The grabbed state is another moment.
        simulation.release();
        let Some(moment) = self.history.at(time) else { return };
        if simulation.return_to(moment).is_err() {
            return;
        }
        self.shown = (self.span().is_some_and(|[_, last]| time < last)).then_some(time);
    }

    /// Removes the moments after the displayed one.
    fn discard_future(&mut self) {
        if let Some(time) = self.shown.take() {
            self.history.truncate_after(time);
        }
    }

    fn discard_past(&mut self) {
        self.history.moments.clear();
        (self.shown, self.kept) = (None, self.played);
    }

    /// Returns to the start of the scene.
    pub(crate) fn reset(&mut self, simulation: &mut Simulation) {
        simulation.reset();
        self.restart();
    }

    fn restart(&mut self) {
        self.history.clear();
        self.discard_past();
        self.clock.rest();
    }

    /// Adapts to a change of the scene to that of the motion; `is_another` is `true` if the body has changed. Removes the
    /// recorded moments, which belong to the previous scene, and the trail of a motion that restarts.
    pub(crate) fn change_scene(&mut self, simulation: &Simulation, is_another: bool) {
        self.discard_future();
        self.discard_past();
        self.history.truncate_after(simulation.state().time());
        if is_another {
            self.restart();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::INTEGRATORS;
    use crate::scene::{IntegratorKind, Scene};
    use crate::state::State;

    /// Returns a falling beam after ten steps, with its last five states.
    fn falling(kind: IntegratorKind) -> (Playback, Simulation, Vec<State>) {
        let scene = Scene::beam(2.0, 0.5).clamp("left").gravity([0.0, -9.81]).moving(kind, 0.01);
        let (mut playback, mut simulation) = (Playback::default(), Simulation::new(&scene).unwrap());
        let mut states = Vec::new();
        for _ in 0..10 {
            playback.step(&mut simulation);
            states.push(simulation.state().clone());
        }
        (playback, simulation, states.split_off(5))
    }

    #[test]
    fn every_motion_returns_to_the_same_moment() {
        // The steps are too long for explicit integrators.
        for integrator in INTEGRATORS.iter().filter(|entry| !entry.is_explicit()) {
            let (mut playback, mut simulation, states) = falling(integrator.kind);
            for own in states.iter().rev() {
                playback.show_moment(own.time(), &mut simulation);
                assert!(simulation.state() == own, "{}: {}", integrator.id, own.time());
                let at_present = own.time() == states[4].time();
                assert_eq!(playback.shown.is_none(), at_present);
            }
            // Continuing from an earlier moment repeats the same steps.
            playback.show_moment(states[2].time(), &mut simulation);
            playback.step(&mut simulation);
            let distance = |a: &State, b: &State| (a.displacement()[1] - b.displacement()[1]).norm();
            assert!(distance(simulation.state(), &states[3]) < 1e-9, "{}", integrator.id);
            assert_eq!(playback.span().map(|span| span[1]), Some(simulation.state().time()), "the future is gone");
            assert_eq!(playback.history.samples.back().map(|s| s.time), Some(simulation.state().time()));
        }
    }
}
