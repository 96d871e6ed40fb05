//! Recorded time steps of a motion, for plots and for the trail of the tip.

use std::collections::VecDeque;

use nalgebra::Vector2;

use crate::dynamics::Ledger;
use crate::simulation::Simulation;

/// Largest number of samples; older ones are dropped.
const MAX_SAMPLES: usize = 8192;

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

/// Samples ordered by time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct History {
    samples: VecDeque<MotionSample>,
    /// Name of the probe.
    probe: String,
}

impl History {
    /// Removes all samples.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
    }

    /// Removes the samples after `time`, s.
    pub(crate) fn truncate_after(&mut self, time: f64) {
        self.samples.truncate(self.samples.partition_point(|sample| sample.time <= time));
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

    /// Returns all samples, the oldest first.
    pub(crate) fn samples(&self) -> &VecDeque<MotionSample> {
        &self.samples
    }

    /// Returns the name of the recorded probe.
    pub(crate) fn probe(&self) -> &str {
        &self.probe
    }

    /// Returns the samples of the last `duration` seconds, the oldest first.
    pub(crate) fn last(&self, duration: f64) -> impl Iterator<Item = &MotionSample> {
        let end = self.samples.back().map_or(0.0, |s| s.time);
        let first = self.samples.partition_point(|s| s.time < end - duration);
        self.samples.range(first..)
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
}
