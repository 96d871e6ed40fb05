//! Load–deflection curve of a cantilever in beam theory: linear, and geometrically exact.

use super::prelude::*;
use crate::exact_beam::{ExactBeam, PathPoint};

/// Load factor with its deflections.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sample {
    /// Load factor, relative to the scene's load.
    pub factor: f64,
    /// Displacement of the tip by linear beam theory, m.
    pub linear: Vector2<f64>,
    /// Displacement of the tip by the geometrically exact beam, m.
    pub exact: Vector2<f64>,
    /// Rotation of the tip, rad.
    pub rotation: f64,
    /// Largest strain at the clamp: that of the normal force, and half the height times the curvature.
    pub strain: f64,
}

impl Sample {
    /// Returns the difference between linear theory and the exact beam, relative to the exact displacement, percent.
    pub fn linear_error_percent(&self) -> f64 {
        error_percent(self.linear, self.exact).unwrap_or(0.0)
    }

    /// Returns the sample at a fraction of the way to another one.
    fn towards(&self, to: &Self, t: f64) -> Self {
        let between = |a: f64, b: f64| a + t * (b - a);
        Self {
            factor: between(self.factor, to.factor),
            linear: self.linear + (to.linear - self.linear) * t,
            exact: self.exact + (to.exact - self.exact) * t,
            rotation: between(self.rotation, to.rotation),
            strain: between(self.strain, to.strain),
        }
    }
}

/// Load–deflection curve of a cantilever scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LoadCurve {
    /// Samples from zero load to beyond the full load.
    pub samples: Vec<Sample>,
    /// Load factor at which the exact beam buckles, where the samples end; `None` if they reach the last load factor.
    pub buckles_at: Option<f64>,
    /// Limits of the error of linear theory, 3, 5 and 10 percent of the exact displacement, that it exceeds within the
    /// samples, each with the interpolated sample at the limit.
    pub departures: Vec<(f64, Sample)>,
}

/// Largest load factor of the curve.
const LARGEST_FACTOR: f64 = 1.25;
/// Number of samples: enough for a smooth line and for limits accurate to a percent of their load.
const SAMPLES: u32 = 50;
/// Smallest number of samples below a limit of linear theory with which the load at the limit is interpolated.
const MIN_BELOW: usize = 10;
/// Largest number of times that the part below a limit is sampled again.
const MAX_ZOOMS: u32 = 4;
/// Error limits of linear theory, percent; the article states that it is good to 3–5 %.
const DEPARTURES: [f64; 3] = [3.0, 5.0, 10.0];

impl LoadCurve {
    /// Returns the curve, if the scene is valid, and a cantilever with an exact solution and a probe at its tip.
    pub fn new(scene: &Scene) -> Option<Self> {
        scene.validate().ok()?;
        let Some(ExactBeam::Cantilever(beam)) = ExactBeam::of(scene) else { return None };
        let height = scene.beam.as_ref()?.height;
        let linear = beam.linear_tip_displacement();
        let rest = Vector2::new(beam.length, 0.0);
        let clamp_force = beam.tip_force + beam.weight * beam.length;
        let (loaded, buckles_at) = beam.path_to_critical(LARGEST_FACTOR, SAMPLES);
        let sample = |p: &PathPoint| Sample {
            factor: p.factor,
            linear: linear * p.factor,
            exact: p.tip.x - rest,
            rotation: p.tip.angle,
            strain: p.factor * (clamp_force.x * beam.stretch_compliance).abs()
                + 0.5 * height * (p.clamp_moment / beam.bending).abs(),
        };
        let from_rest = |loaded: &[PathPoint]| -> Vec<Sample> {
            std::iter::once(Sample::default()).chain(loaded.iter().map(sample)).collect()
        };
        let samples = from_rest(&loaded);
        let departure = |percent: f64| {
            let mut samples = samples.clone();
            // With too few samples below the limit, the part up to it is sampled again.
            for _ in 0..MAX_ZOOMS {
                let first = samples.iter().skip(1).position(|s| s.linear_error_percent() > percent)?;
                let Some(end) = samples.get(first + 1).filter(|_| first < MIN_BELOW) else { break };
                samples = from_rest(&beam.path(end.factor, SAMPLES));
            }
            let pair = samples.windows(2).find(|w| w[1].linear_error_percent() > percent)?;
            let [from, to] = [0, 1].map(|i| pair[i].linear_error_percent());
            Some((percent, pair[0].towards(&pair[1], ((percent - from) / (to - from)).clamp(0.0, 1.0))))
        };
        let departures = DEPARTURES.into_iter().filter_map(departure).collect();
        Some(Self { samples, buckles_at, departures })
    }
}
