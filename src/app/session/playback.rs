//! Playback of a motion: clock, and the past with samples of the time steps, for plots and for the trail of the tip, and
//! with the moments of the last seconds.

use std::collections::VecDeque;

use crate::app::prelude::*;
use crate::app::session::clock::{RealTimeClock, make_steps};
use crate::dynamics::Ledger;
use crate::simulation::Moment;

/// Largest memory for the recorded moments, bytes.
const MAX_BYTES: usize = 64 << 20;
/// Shortest playing time between two recorded moments, s: one frame at 60 Hz, less rounding.
const BETWEEN_MOMENTS: f64 = 1.0 / 61.0;

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
        let due = self.clock.begin(now, step);
        let made = make_steps(due, || {
            self.make_step(simulation);
            !simulation.is_at_rest()
        });
        self.clock.end(due, made, step);
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
        self.history.samples.clear();
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

/// Largest number of samples; older ones are dropped.
const MAX_SAMPLES: usize = 8192;
/// Largest number of moments: fifteen seconds of playing time at 60 Hz.
const MAX_MOMENTS: usize = 900;

/// Recorded time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotionSample {
    /// Simulated time, s.
    pub time: f64,
    pub ledger: Ledger,
    /// Position of the first probe, m.
    pub position: Vector2<f64>,
    /// Displacement of the first probe, m.
    pub displacement: Vector2<f64>,
}

/// Samples and moments ordered by time.
#[derive(Debug, Default)]
pub(crate) struct History {
    pub samples: VecDeque<MotionSample>,
    /// Name of the probe.
    pub probe: String,
    pub moments: VecDeque<Moment>,
}

impl History {
    /// Removes the samples and moments after `time`, s.
    pub(crate) fn truncate_after(&mut self, time: f64) {
        self.samples.truncate(self.samples.partition_point(|sample| sample.time <= time));
        self.moments.truncate(self.moments.partition_point(|moment| moment.state().time() <= time));
    }

    /// Records the current state of a motion; does nothing for a model at rest.
    pub(crate) fn record(&mut self, simulation: &Simulation) {
        let Some(motion) = simulation.motion() else { return };
        let state = simulation.state();
        let probe = simulation.problem().probes().first();
        let see = |nodal: &[Vector2<f64>]| probe.map_or_else(Vector2::zeros, |probe| probe.mean(nodal));
        if let Some(probe) = probe.filter(|probe| probe.name != self.probe) {
            self.probe.clone_from(&probe.name);
        }
        if self.samples.len() == MAX_SAMPLES {
            self.samples.pop_front();
        }
        let displacement = see(state.displacement());
        self.samples.push_back(MotionSample {
            time: state.time(),
            ledger: *motion.ledger(),
            position: see(simulation.system().mesh().nodes()) + displacement,
            displacement,
        });
    }

    /// Returns the samples of the last `duration` seconds, the oldest first.
    pub(crate) fn last(&self, duration: f64) -> impl Iterator<Item = &MotionSample> {
        self.before(self.samples.back().map_or(0.0, |s| s.time), duration)
    }

    /// Returns the samples of the `duration` seconds before `time`, s, the oldest first.
    pub(crate) fn before(&self, time: f64, duration: f64) -> impl Iterator<Item = &MotionSample> {
        let [first, end] = [
            self.samples.partition_point(|s| s.time < time - duration),
            self.samples.partition_point(|s| s.time <= time),
        ];
        self.samples.range(first.min(end)..end)
    }

    /// Returns the axis along which the probe's displacement varies most: 0 for x, 1 for y.
    pub(crate) fn axis(&self) -> usize {
        let start = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
        let (low, high) =
            self.samples.iter().fold(start, |(low, high), s| (low.inf(&s.displacement), high.sup(&s.displacement)));
        usize::from(high.y - low.y >= high.x - low.x)
    }

    /// Records the current moment of a motion, and drops the oldest moments if they exceed `most_bytes`. Does nothing
    /// for a model at rest.
    pub(super) fn keep_moment(&mut self, simulation: &Simulation, most_bytes: usize) {
        let now = simulation.state().time();
        let is_kept = self.moments.back().is_some_and(|last| last.state().time() == now);
        let Some(motion) = simulation.motion().filter(|_| !is_kept) else { return };
        let moment = motion.moment();
        let most = (most_bytes / moment.bytes().max(1)).min(MAX_MOMENTS);
        self.moments.push_back(moment);
        self.moments.drain(..self.moments.len().saturating_sub(most));
    }

    /// Returns the moment at exactly `time`, s.
    pub(crate) fn at(&self, time: f64) -> Option<&Moment> {
        let after = self.moments.partition_point(|moment| moment.state().time() < time);
        self.moments.get(after).filter(|moment| moment.state().time() == time)
    }

    /// Returns the time of the moment closest to `time`, s.
    pub(crate) fn nearest(&self, time: f64) -> Option<f64> {
        let after = self.moments.partition_point(|moment| moment.state().time() < time);
        let near = self.moments.range(after.saturating_sub(1)..self.moments.len().min(after + 1));
        near.map(|moment| moment.state().time()).min_by(|a, b| (a - time).abs().total_cmp(&(b - time).abs()))
    }

    /// Returns the time, s, of the first moment after `time` (`forward`) or of the last one before it.
    pub(crate) fn neighbour(&self, time: f64, forward: bool) -> Option<f64> {
        let at = if forward {
            self.moments.partition_point(|moment| moment.state().time() <= time)
        } else {
            self.moments.partition_point(|moment| moment.state().time() < time).checked_sub(1)?
        };
        self.moments.get(at).map(|moment| moment.state().time())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::INTEGRATORS;
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

    fn bytes_of(past: &History) -> usize {
        past.moments.iter().map(Moment::bytes).sum()
    }

    /// Returns a record of `steps` steps of 1 s that is limited to the memory of `most` moments, and the bytes of one
    /// moment.
    fn after(steps: u32, most: usize) -> (History, usize) {
        let scene = Scene::beam(2.0, 1.0).clamp("left").moving(IntegratorKind::TrBdf2, 1.0);
        let mut simulation = Simulation::new(&scene).unwrap();
        let bytes = simulation.motion().unwrap().moment().bytes();
        let mut past = History::default();
        for _ in 0..steps {
            past.keep_moment(&simulation, most * bytes);
            // A second record of the same time is ignored.
            past.keep_moment(&simulation, most * bytes);
            simulation.step();
            assert!(bytes_of(&past) <= most.max(1) * bytes, "{} bytes", bytes_of(&past));
        }
        (past, bytes)
    }

    #[test]
    fn memory_and_count_are_bounded() {
        let (past, _) = after(20, 7);
        let times: Vec<f64> = past.moments.iter().map(|moment| moment.state().time()).collect();
        assert_eq!(times, [13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0], "the last seven");
        assert!(after(20, 0).0.moments.len() <= 1, "no room for two");
        assert_eq!(after(1000, 5000).0.moments.len(), MAX_MOMENTS);
    }

    #[test]
    fn moments_are_found_by_their_time() {
        let (mut past, _) = after(10, 100);
        assert_eq!([-3.0, 4.4, 4.6, 30.0].map(|time| past.nearest(time)), [0.0, 4.0, 5.0, 9.0].map(Some));
        assert_eq!((past.neighbour(4.0, false), past.neighbour(4.0, true)), (Some(3.0), Some(5.0)));
        assert_eq!((past.neighbour(0.0, false), past.neighbour(9.0, true)), (None, None));
        assert!(past.at(4.0).is_some() && past.at(4.5).is_none());
        past.truncate_after(4.0);
        assert_eq!(past.nearest(30.0), Some(4.0));
        past.moments.clear();
        assert_eq!((past.nearest(1.0), bytes_of(&past)), (None, 0));
    }
}
