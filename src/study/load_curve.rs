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
}

/// Load–deflection curve of a cantilever scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LoadCurve {
    /// Samples from zero load to beyond the full load.
    pub samples: Vec<Sample>,
    /// Load factor at which the exact beam buckles, where the samples end; `None` if they reach the last load factor.
    pub buckles_at: Option<f64>,
    /// Limits of the error of linear theory, 3, 5 and 10 percent of the exact displacement, that it exceeds within the
    /// samples, each with the sample at the limit.
    pub departures: Vec<(f64, Sample)>,
}

/// Largest load factor of the curve.
const LARGEST_FACTOR: f64 = 1.25;
/// Number of samples: enough for a smooth line.
const SAMPLES: u32 = 50;
/// Number of bisections by which the load at a limit is found between two samples.
const BISECTIONS: u32 = 16;
/// Error limits of linear theory, percent; the article states that it is good to 3–5 %.
const DEPARTURES: [f64; 3] = [3.0, 5.0, 10.0];

impl LoadCurve {
    /// Returns the curve, if the scene can be simulated, and is a cantilever with an exact solution.
    pub fn new(scene: &Scene) -> Option<Self> {
        Simulation::new(scene).ok()?;
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
        let samples: Vec<Sample> = std::iter::once(Sample::default()).chain(loaded.iter().map(sample)).collect();
        let departure = |percent: f64| {
            let pair = samples.windows(2).find(|pair| pair[1].linear_error_percent() > percent)?;
            let (mut below, mut beyond) = (pair[0].factor, pair[1]);
            for _ in 0..BISECTIONS {
                let middle = sample(beam.path(0.5 * (below + beyond.factor), 1).last()?);
                if middle.linear_error_percent() > percent { beyond = middle } else { below = middle.factor }
            }
            Some((percent, beyond))
        };
        let departures = DEPARTURES.into_iter().filter_map(departure).collect();
        Some(Self { samples, buckles_at, departures })
    }
}
