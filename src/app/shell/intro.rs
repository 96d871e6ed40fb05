//! Opening animation: the load grows from zero to the scene's, and the body bends under it.

use crate::method::is_useful_start;
use crate::scene::{Load, MethodKind, Scene};
use crate::simulation::Simulation;

/// Duration, s.
const DURATION: f64 = 1.5;
/// Largest number of unknowns: every frame solves the model again.
const MAX_UNKNOWNS: usize = 2000;

/// Animation towards an equilibrium that is already known. Every frame is an equilibrium under a fraction of the load.
#[derive(Debug)]
pub(crate) struct Intro {
    /// Simulation under a fraction of the load.
    simulation: Simulation,
    /// Solution of linear theory under the same fraction.
    linear: Option<Simulation>,
    loads: Vec<Load>,
    /// Time of the start, s.
    start: Option<f64>,
}

impl Intro {
    /// Returns the animation of a static scene; `None` for a motion or a large model.
    pub(crate) fn new(simulation: &Simulation) -> Option<Self> {
        let scene = simulation.scene();
        let small = simulation.system().dofs() <= MAX_UNKNOWNS;
        if simulation.motion().is_some() || !small {
            return None;
        }
        let with = |method: MethodKind| {
            let mut scene = scaled(scene, &scene.loads, 0.0);
            scene.solver.method = method;
            let mut simulation = Simulation::with_system(&scene, simulation.system().clone()).ok()?;
            simulation.solve();
            Some(simulation)
        };
        Some(Self {
            simulation: with(scene.solver.method)?,
            linear: with(MethodKind::Linear),
            loads: scene.loads.clone(),
            start: None,
        })
    }

    /// Updates the body to the time `now`, s; returns `false` at the end.
    pub(crate) fn advance(&mut self, now: f64) -> bool {
        let start = *self.start.get_or_insert(now);
        let t = ((now - start) / DURATION).clamp(0.0, 1.0);
        // Smoothstep: starts and ends with zero velocity.
        let factor = t * t * (3.0 - 2.0 * t);
        let bodies = std::iter::once(&mut self.simulation).chain(self.linear.as_mut());
        let mut good = true;
        for body in bodies {
            let scene = scaled(body.scene(), &self.loads, factor);
            good &= body.change_scene(&scene).is_ok();
            body.solve();
            good &= is_useful_start(body.system(), body.state());
        }
        good && t < 1.0
    }

    /// Returns the body under the current fraction of the load.
    pub(crate) fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Returns the solution of linear theory under the same fraction.
    pub(crate) fn linear(&self) -> Option<&Simulation> {
        self.linear.as_ref()
    }
}

/// Returns the scene with `loads` times `factor`.
fn scaled(scene: &Scene, loads: &[Load], factor: f64) -> Scene {
    let mut scene = scene.clone();
    scene.loads = loads.to_vec();
    for load in &mut scene.loads {
        match load {
            Load::Force { force: vector, .. } | Load::Gravity { acceleration: vector, .. } => {
                *vector = vector.map(|v| v * factor);
            }
            Load::Moment { moment, .. } => *moment *= factor,
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Source, open};

    /// The deflection grows with the load, and the end is the solved equilibrium.
    #[test]
    fn the_body_goes_to_its_equilibrium_in_a_second_and_a_half() {
        let scene = open(&Source { name: "article".into(), assignments: Vec::new() }).unwrap();
        let mut solved = Simulation::new(&scene).unwrap();
        solved.solve();
        let mut intro = Intro::new(&solved).unwrap();
        let tip = |simulation: &Simulation| simulation.probe("tip").unwrap().y;
        assert!(tip(intro.simulation()).abs() < 1e-12, "it begins at rest");
        let mut last = 0.0;
        for frame in 0..=14 {
            assert!(intro.advance(100.0 + 0.1 * f64::from(frame)), "it ended after {frame} frames");
            let now = tip(intro.simulation());
            assert!(now <= last, "the tip went up from {last} to {now}");
            last = now;
        }
        assert!(!intro.advance(101.6), "it goes on");
        assert!((tip(intro.simulation()) - tip(&solved)).abs() < 1e-5);
        assert!(intro.linear().is_some());
        assert_eq!(intro.simulation().scene().loads, scene.loads);
    }
}
