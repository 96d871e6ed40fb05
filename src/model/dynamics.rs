//! Time integration settings and initial velocities of a dynamic scene.

use serde::{Deserialize, Serialize};

/// Time integration settings of a dynamic scene. [`Scene::moving`](crate::Scene::moving) sets integrator and time
/// step.
///
/// ```
/// use warpbeam::{Analysis, Damping, DynamicsSettings, Scene, Simulation, Start};
///
/// let mut damping = Damping::default();
/// damping.mass = 2.0; // 1/s
/// let mut dynamics = DynamicsSettings::default();
/// (dynamics.time_step, dynamics.duration, dynamics.damping) = (0.01, 0.5, damping);
/// let mut start = Start::default();
/// start.velocity = [3.0, 0.0]; // m/s
/// let mut scene = Scene::beam(1.0, 0.1).probe("end", "right");
/// (scene.analysis, scene.dynamics, scene.start) = (Analysis::Dynamic, dynamics, start);
///
/// // Mass-proportional damping slows a free body down as exp(−α t): after half a second by 1/e.
/// let mut body = Simulation::new(&scene)?;
/// body.solve();
/// let velocity = body.probe_velocity("end").ok_or("no such probe")?;
/// assert!((velocity.x - 3.0 / std::f64::consts::E).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct DynamicsSettings {
    /// Time step h, s.
    pub time_step: f64,
    /// Time after which a headless run ends, s.
    pub duration: f64,
    /// Solves per time step, or per stage of one; 0 repeats until the solver's tolerance is met.
    pub iterations: u32,
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Rayleigh damping.
    pub damping: Damping,
}

impl Default for DynamicsSettings {
    fn default() -> Self {
        Self {
            time_step: 1.0 / 60.0,
            duration: 10.0,
            iterations: 1,
            integrator: IntegratorKind::default(),
            damping: Damping::default(),
        }
    }
}

/// Rayleigh damping: mass-proportional and stiffness-proportional.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct Damping {
    /// Mass-proportional factor α, 1/s: a mode of angular frequency ω decays at the rate α/2.
    pub mass: f64,
    /// Stiffness-proportional factor β, s: a mode decays at the rate β ω²/2. Rigid motion is not damped.
    pub stiffness: f64,
}

/// Time integration schemes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum IntegratorKind {
    /// First order, as in the article and in games.
    ImplicitEuler,
    /// Second order, damps modes that the time step cannot resolve.
    #[default]
    TrBdf2,
    /// Second order, conserves energy, momentum and angular momentum.
    EnergyMomentum,
    /// Explicit; no equations are solved.
    SymplecticEuler,
}

/// Initial velocities of a dynamic scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct Start {
    /// Velocity of the body, m/s.
    pub velocity: [f64; 2],
    /// Angular velocity about the centre of mass, rad/s, counter-clockwise.
    pub spin: f64,
}

/// Time dependence of a load: the factor is sin²(π (t − start)/duration) during the pulse and 0 at other times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pulse {
    /// Start, s.
    pub start: f64,
    /// Duration, s.
    pub duration: f64,
}

impl Pulse {
    /// Returns the factor of the load at a time, s.
    ///
    /// ```
    /// use warpbeam::Pulse;
    /// let pulse = Pulse { start: 1.0, duration: 0.2 };
    /// assert_eq!((pulse.factor(0.9), pulse.factor(1.1), pulse.factor(1.3)), (0.0, 1.0, 0.0));
    /// ```
    pub fn factor(&self, time: f64) -> f64 {
        let t = (time - self.start) / self.duration;
        if (0.0..=1.0).contains(&t) { (std::f64::consts::PI * t).sin().powi(2) } else { 0.0 }
    }

    /// Returns the integral of the factor from one time to another, s.
    ///
    /// ```
    /// use warpbeam::Pulse;
    /// let pulse = Pulse { start: 1.0, duration: 0.2 };
    /// assert_eq!(pulse.impulse(0.0, 9.0), 0.1);
    /// ```
    pub fn impulse(&self, from: f64, to: f64) -> f64 {
        use std::f64::consts::TAU;
        // ∫ sin²(π t/d) dt = t/2 − d/4π sin(2π t/d).
        let until = |time: f64| {
            let part = ((time - self.start) / self.duration).clamp(0.0, 1.0);
            self.duration * (0.5 * part - (TAU * part).sin() / (2.0 * TAU))
        };
        match (from <= self.start, to >= self.end()) {
            (true, true) => 0.5 * self.duration,
            _ => until(to) - until(from),
        }
    }

    /// Returns the mean of the factor from one time to another.
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        if to > from { self.impulse(from, to) / (to - from) } else { self.factor(from) }
    }

    /// Returns the end of the pulse, s.
    pub fn end(&self) -> f64 {
        self.start + self.duration
    }
}
