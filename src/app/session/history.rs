//! Record of a motion: samples of its time steps for plots and for the trail of the tip, and the moments of its last
//! seconds.

use std::collections::VecDeque;

use crate::app::prelude::*;
use crate::dynamics::Ledger;
use crate::simulation::Moment;

/// Largest number of samples; older ones are dropped.
const MAX_SAMPLES: usize = 8192;
/// Largest number of moments: fifteen seconds of playing time at 60 Hz.
const MAX_MOMENTS: usize = 900;

/// Recorded time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotionSample {
    /// Simulated time, s.
    pub time: f64,
    /// Energy ledger.
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
    /// Removes all samples and moments.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
        self.moments.clear();
    }

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

    #[cfg(test)]
    fn bytes(&self) -> usize {
        self.moments.iter().map(Moment::bytes).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert!(past.bytes() <= most.max(1) * bytes, "{} bytes", past.bytes());
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
        assert_eq!((past.nearest(1.0), past.bytes()), (None, 0));
    }
}
