//! Motion of one of several compared settings of a scene, whose time steps are timed.

use nalgebra::Vector2;
use web_time::Instant;

use crate::scene::Scene;
use crate::sentence::Sentence;
use crate::simulation::{Simulation, Status, probe_results};

/// Motion of a scene, for comparison with others.
#[derive(Debug, Default)]
pub(crate) struct ComparedMotion {
    /// Scene that the simulation has, or was refused for.
    scene: Option<Scene>,
    simulation: Option<Box<Simulation>>,
    /// Reason for which there is no simulation.
    refused: Option<Sentence>,
    /// Computing time of a step, s: an exponentially weighted mean.
    seconds: Option<f64>,
}

impl ComparedMotion {
    /// Returns the time step of the scene, s; `None` before the first [`Self::set_scene`].
    pub(crate) fn time_step(&self) -> Option<f64> {
        self.scene.as_ref().map(|scene| scene.dynamics.time_step)
    }

    /// Returns the simulation; `None` if the scene cannot be set up.
    pub(crate) fn simulation(&self) -> Option<&Simulation> {
        self.simulation.as_deref()
    }

    /// Returns the reason for which there is no motion, or for which it has stopped.
    pub(crate) fn failure(&self) -> Option<Sentence> {
        self.refused.clone().or_else(|| self.simulation()?.status().failure_sentence())
    }

    /// Returns the computing time of a step, s.
    pub(crate) fn step_seconds(&self) -> Option<f64> {
        self.seconds
    }

    /// Returns `true` if there is a motion that has not become unstable.
    pub(crate) fn is_sound(&self) -> bool {
        self.simulation().is_some_and(|simulation| !matches!(simulation.status(), Status::Stopped(_)))
    }

    /// Returns `true` if the body moves.
    pub(crate) fn moves(&self) -> bool {
        self.simulation().is_some_and(|simulation| !simulation.is_at_rest())
    }

    /// Applies a changed scene. Returns `true` if the motion has to restart, because beam, mesh or any `[dynamics]`
    /// setting has changed.
    pub(crate) fn set_scene(&mut self, wanted: Scene) -> bool {
        if self.scene.as_ref() == Some(&wanted) {
            return false;
        }
        let before = self.scene.as_ref().filter(|_| self.simulation.is_some());
        let goes_on = before.is_some_and(|before| {
            (&before.beam, &before.mesh, &before.dynamics) == (&wanted.beam, &wanted.mesh, &wanted.dynamics)
        });
        let made = match self.simulation.take().filter(|_| goes_on) {
            Some(mut simulation) => simulation.change_scene(&wanted).map(|()| simulation),
            None => Simulation::new(&wanted).map(Box::new),
        };
        self.refused = made.as_ref().err().map(Sentence::from);
        self.simulation = made.ok();
        if !goes_on {
            self.seconds = None;
        }
        self.scene = Some(wanted);
        !goes_on
    }

    /// Returns to the start.
    pub(crate) fn reset(&mut self) {
        self.simulation.iter_mut().for_each(|simulation| simulation.reset());
    }

    /// Makes one time step, unless the motion has become unstable.
    pub(crate) fn step(&mut self) {
        const FADING: f64 = 0.95;
        if !self.is_sound() {
            return;
        }
        let Some(simulation) = &mut self.simulation else { return };
        let begun = Instant::now();
        simulation.step();
        let seconds = begun.elapsed().as_secs_f64();
        self.seconds = Some(self.seconds.map_or(seconds, |mean| FADING * mean + (1.0 - FADING) * seconds));
    }

    /// Returns the displacement of the first probe, m.
    pub(crate) fn tip(&self) -> Option<Vector2<f64>> {
        let simulation = self.simulation()?;
        Some(probe_results(simulation.problem(), simulation.state()).first()?.u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::IntegratorKind;

    #[test]
    fn a_changed_load_continues_the_motion_and_a_changed_integrator_restarts_it() {
        let fall = |acceleration: f64, integrator| {
            let scene = Scene::beam(2.0, 0.5).clamp("left").gravity([0.0, -acceleration]).probe("tip", "right");
            scene.moving(integrator, 0.01)
        };
        let mut motion = ComparedMotion::default();
        assert!(motion.set_scene(fall(9.81, IntegratorKind::TrBdf2)));
        (0..5).for_each(|_| motion.step());
        let tip = motion.tip().unwrap();
        assert!(tip.y < 0.0 && motion.step_seconds().is_some());
        assert!(!motion.set_scene(fall(20.0, IntegratorKind::TrBdf2)), "the motion continues");
        assert_eq!(motion.tip(), Some(tip));
        assert!(motion.set_scene(fall(20.0, IntegratorKind::ImplicitEuler)));
        assert!(motion.step_seconds().is_none() && motion.tip() == Some(Vector2::zeros()));
    }

    #[test]
    fn an_unstable_motion_stops_and_names_the_reason() {
        let scene = Scene::beam(2.0, 0.5).clamp("left").gravity([0.0, -9.81]);
        let mut motion = ComparedMotion::default();
        motion.set_scene(scene.moving(IntegratorKind::SymplecticEuler, 0.01));
        for _ in 0..1000 {
            if !motion.is_sound() {
                break;
            }
            motion.step();
        }
        assert!(motion.failure().is_some() && !motion.is_sound());
        let (stopped, seconds) = (motion.simulation().unwrap().state().clone(), motion.step_seconds());
        motion.step();
        assert!(*motion.simulation().unwrap().state() == stopped, "an unstable motion makes no more steps");
        assert_eq!(motion.step_seconds(), seconds, "a step that was not made is not timed");
        motion.reset();
        assert!(motion.is_sound() && motion.failure().is_none());
    }
}
