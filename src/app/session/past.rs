//! Recorded moments of the last seconds of a motion.

use std::collections::VecDeque;

use crate::simulation::{Moment, Simulation};

/// Largest number of moments: fifteen seconds of playing time at 60 Hz.
const MAX_MOMENTS: usize = 900;

/// Moments of a motion ordered by time.
#[derive(Debug, Default)]
pub(crate) struct Past {
    moments: VecDeque<Moment>,
    /// Dropped moments whose memory is reused.
    spare: Vec<Moment>,
}

impl Past {
    /// Records the current state of a motion, and drops the oldest moments if they exceed `most_bytes`. Does nothing
    /// for a model at rest.
    pub(crate) fn record(&mut self, simulation: &Simulation, most_bytes: usize) {
        let now = simulation.state().time();
        if self.moments.back().is_some_and(|last| last.state().time() == now) {
            return;
        }
        if let Some(bytes) = self.moments.front().map(Moment::bytes) {
            let most = (most_bytes / bytes.max(1)).min(MAX_MOMENTS);
            while self.moments.len() >= most.max(1) {
                self.spare.extend(self.moments.pop_front());
            }
            self.spare.truncate(1);
            if most == 0 {
                self.clear();
                return;
            }
        }
        let Some(motion) = simulation.motion() else { return };
        let recorded = match self.spare.pop() {
            Some(mut moment) => {
                motion.copy_moment(&mut moment);
                moment
            }
            None => motion.moment(),
        };
        self.moments.push_back(recorded);
    }

    /// Removes all moments.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Removes the moments after `time`, s.
    pub(crate) fn truncate_after(&mut self, time: f64) {
        self.moments.truncate(self.moments.partition_point(|moment| moment.state().time() <= time));
    }

    /// Returns the moments, the oldest first.
    pub(crate) fn moments(&self) -> &VecDeque<Moment> {
        &self.moments
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
        self.moments.iter().chain(&self.spare).map(Moment::bytes).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{IntegratorKind, Scene};

    /// Returns a record of `steps` steps of 1 s that is limited to the memory of `most` moments, and the bytes of one
    /// moment.
    fn after(steps: u32, most: usize) -> (Past, usize) {
        let scene = Scene::beam(2.0, 1.0).clamp("left").moving(IntegratorKind::TrBdf2, 1.0);
        let mut simulation = Simulation::new(&scene).unwrap();
        let bytes = simulation.motion().unwrap().moment().bytes();
        let mut past = Past::default();
        for _ in 0..steps {
            past.record(&simulation, most * bytes);
            // A second record of the same time is ignored.
            past.record(&simulation, most * bytes);
            simulation.step();
            assert!(past.bytes() <= most.max(1) * bytes, "{} bytes", past.bytes());
        }
        (past, bytes)
    }

    #[test]
    fn memory_and_count_are_bounded() {
        let (past, _) = after(20, 7);
        let times: Vec<f64> = past.moments().iter().map(|moment| moment.state().time()).collect();
        assert_eq!(times, [13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0], "the last seven");
        assert!(after(20, 0).0.moments().len() <= 1, "no room for two");
        assert_eq!(after(1000, 5000).0.moments().len(), MAX_MOMENTS);
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
        past.clear();
        assert_eq!((past.nearest(1.0), past.bytes()), (None, 0));
    }
}
