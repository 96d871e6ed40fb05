//! What a motion has done so far, sample by sample: for plots and for the trail of the tip.

use std::collections::VecDeque;

use nalgebra::Vector2;

use crate::dynamics::Ledger;
use crate::simulation::Simulation;

/// Samples that are kept: the older ones go.
const MOST_SAMPLES: usize = 8192;

/// A time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// s.
    pub time: f64,
    /// Where the energy is.
    pub ledger: Ledger,
    /// Position of the first probe, m.
    pub position: Vector2<f64>,
    /// Its displacement, m.
    pub displacement: Vector2<f64>,
    /// Its velocity, m/s.
    pub velocity: Vector2<f64>,
}

/// Samples in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct History {
    samples: VecDeque<Sample>,
    /// The name of the probe.
    probe: String,
}

impl History {
    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
    }

    /// Forgets what came after a time, s.
    pub(crate) fn forget_after(&mut self, time: f64) {
        self.samples.truncate(self.samples.partition_point(|sample| sample.time <= time));
    }

    /// Adds where a motion is now; nothing of a search.
    pub(crate) fn record(&mut self, simulation: &Simulation) {
        let Some(motion) = simulation.motion() else { return };
        let state = simulation.state();
        let probe = simulation.problem().probes().first();
        let see = |nodal: &[Vector2<f64>]| probe.map_or_else(Vector2::zeros, |probe| probe.mean(nodal));
        if let Some(probe) = probe.filter(|probe| probe.name != self.probe) {
            self.probe.clone_from(&probe.name);
        }
        if self.samples.len() == MOST_SAMPLES {
            self.samples.pop_front();
        }
        let displacement = see(state.displacement());
        self.samples.push_back(Sample {
            time: state.time(),
            ledger: *motion.ledger(),
            position: see(simulation.system().mesh().nodes()) + displacement,
            displacement,
            velocity: see(state.velocity()),
        });
    }

    /// All samples, the oldest first.
    pub(crate) fn samples(&self) -> &VecDeque<Sample> {
        &self.samples
    }

    /// The name of the probe that is followed.
    pub(crate) fn probe(&self) -> &str {
        &self.probe
    }

    /// Samples of the last `duration` seconds, the oldest first.
    pub(crate) fn last(&self, duration: f64) -> impl Iterator<Item = &Sample> {
        let end = self.samples.back().map_or(0.0, |s| s.time);
        let first = self.samples.partition_point(|s| s.time < end - duration);
        self.samples.range(first..)
    }

    /// Samples of the `duration` seconds before a time, s, the oldest first.
    pub(crate) fn before(&self, time: f64, duration: f64) -> impl Iterator<Item = &Sample> {
        let [first, end] = [
            self.samples.partition_point(|s| s.time < time - duration),
            self.samples.partition_point(|s| s.time <= time),
        ];
        self.samples.range(first.min(end)..end)
    }

    /// The sample at a time, s: the last one not after it.
    pub(crate) fn at(&self, time: f64) -> Option<&Sample> {
        self.samples.get(self.samples.partition_point(|s| s.time <= time).checked_sub(1)?)
    }

    /// The axis along which the probe has moved more: 0 or 1.
    pub(crate) fn axis(&self) -> usize {
        let start = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
        let (low, high) =
            self.samples.iter().fold(start, |(low, high), s| (low.inf(&s.displacement), high.sup(&s.displacement)));
        usize::from(high.y - low.y >= high.x - low.x)
    }
}
