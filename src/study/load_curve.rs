//! Load against deflection of a cantilever: linear theory, the truth, and what each method makes of the full load.

use std::sync::Arc;

use nalgebra::Vector2;

use crate::assembly::System;
use crate::method::METHODS;
use crate::scene::{MethodKind, Place, Scene};
use crate::simulation::{Simulation, Status};
use crate::truth::{BeamTruth, error_percent};

/// A load factor with its deflections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Fraction of the scene's load.
    pub factor: f64,
    /// Displacement of the tip by linear beam theory, m.
    pub linear: Vector2<f64>,
    /// By the geometrically exact beam, m.
    pub truth: Vector2<f64>,
    /// Turn of the tip, rad.
    pub rotation: f64,
    /// Largest bending strain: half the height times the curvature at the clamp.
    pub strain: f64,
}

impl Sample {
    /// The distance of linear theory from the truth, over the true displacement, percent.
    #[must_use]
    pub fn linear_error_percent(&self) -> f64 {
        error_percent(self.linear, self.truth).unwrap_or(0.0)
    }
}

/// Where linear theory leaves the truth by more than so much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// Percent of the true displacement.
    pub percent: f64,
    /// The first sample beyond, interpolated.
    pub at: Sample,
}

/// What a method makes of the full load.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodPoint {
    /// The method.
    pub method: MethodKind,
    /// Displacement of the tip, m: of the last finite state where it did not converge.
    pub tip: Vector2<f64>,
    /// How it ended.
    pub status: Status,
    /// `false` if the end is an unstable equilibrium; `None` where that is not known.
    pub stable: Option<bool>,
}

/// The curve of a scene that has a cantilever's truth.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCurve {
    /// From no load to past the full one.
    pub samples: Vec<Sample>,
    /// Load factor at which the exact beam buckles, where the samples end; `None` where they go on to the end.
    pub buckles_at: Option<f64>,
    /// For 3, 5 and 10 percent, as far as the samples reach.
    pub departures: Vec<Departure>,
    /// Every method, on the scene's own mesh.
    pub methods: Vec<MethodPoint>,
}

/// How far past the full load the curve goes.
const LARGEST_FACTOR: f64 = 1.25;
/// Samples of the curve: enough for a smooth line and for limits to a percent of their load.
const SAMPLES: u32 = 50;
/// The errors of linear theory at which it is said to leave the truth; the article says it is good to 3–5 %.
const DEPARTURES: [f64; 3] = [3.0, 5.0, 10.0];

impl LoadCurve {
    /// The curve, if the scene has a cantilever's truth and a probe at its tip.
    #[must_use]
    pub fn new(scene: &Scene) -> Option<Self> {
        let Some(BeamTruth::Cantilever(beam)) = BeamTruth::of(scene) else { return None };
        // What cannot be simulated has no curve.
        let system = Simulation::new(scene).ok()?.system().clone();
        let height = scene.beam.as_ref()?.height;
        let linear = beam.linear_tip_displacement();
        let rest = Vector2::new(beam.length, 0.0);
        let none =
            Sample { factor: 0.0, linear: Vector2::zeros(), truth: Vector2::zeros(), rotation: 0.0, strain: 0.0 };
        let (loaded, buckles_at) = beam.path_to_critical(LARGEST_FACTOR, SAMPLES);
        let samples: Vec<Sample> = std::iter::once(none)
            .chain(loaded.into_iter().map(|p| Sample {
                factor: p.factor,
                linear: linear * p.factor,
                truth: p.tip.x - rest,
                rotation: p.tip.angle,
                strain: 0.5 * height * (p.clamp_moment / beam.bending).abs(),
            }))
            .collect();
        let departures = DEPARTURES.into_iter().filter_map(|percent| departure(&samples, percent)).collect();
        let methods = METHODS.iter().filter_map(|entry| method_point(scene, entry.kind, &system)).collect();
        Some(Self { samples, buckles_at, departures, methods })
    }
}

/// Where the error of linear theory first passes `percent`.
fn departure(samples: &[Sample], percent: f64) -> Option<Departure> {
    let pair = samples.windows(2).find(|w| w[1].linear_error_percent() > percent)?;
    let [a, b] = [pair[0], pair[1]];
    let (from, to) = (a.linear_error_percent(), b.linear_error_percent());
    let t = ((percent - from) / (to - from)).clamp(0.0, 1.0);
    let between = |a: f64, b: f64| a + t * (b - a);
    let at = Sample {
        factor: between(a.factor, b.factor),
        linear: a.linear + (b.linear - a.linear) * t,
        truth: a.truth + (b.truth - a.truth) * t,
        rotation: between(a.rotation, b.rotation),
        strain: between(a.strain, b.strain),
    };
    Some(Departure { percent, at })
}

fn method_point(scene: &Scene, method: MethodKind, system: &Arc<System>) -> Option<MethodPoint> {
    let mut scene = scene.clone();
    scene.solver.method = method;
    scene.solver.accept_after = 0;
    let mut simulation = Simulation::with_system(&scene, system.clone()).ok()?;
    simulation.solve();
    let probe = simulation.problem().probes().iter().find(|p| p.place == Place::from("right"))?;
    let tip = probe.mean(simulation.displacement());
    let stable = simulation.certify().stable;
    Some(MethodPoint { method, tip, status: simulation.status().clone(), stable })
}
