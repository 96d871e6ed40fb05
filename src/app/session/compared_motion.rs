//! Motion of one of several compared settings of a scene.

use std::sync::Arc;

use nalgebra::Vector2;

use crate::app::session::compared_solve::Equations;
use crate::app::task::background_solve::BackgroundSolve;
use crate::app::task::solve::{MAX_PANE_UNKNOWNS, Model, SolveRequest, SolveStart};
use crate::render::display_geometry::DisplayGeometry;
use crate::scene::Scene;
use crate::sentence::Sentence;
use crate::simulation::{Simulation, Status, probe_results};

/// Motion of a scene, for comparison with others.
#[derive(Debug, Default)]
pub(crate) struct ComparedMotion {
    /// Scene that the simulation has, or was refused for.
    scene: Option<Scene>,
    simulation: Option<Box<Simulation>>,
    /// Background work that sets up the motion, if its mesh is large.
    setting_up: Option<Box<BackgroundSolve>>,
    /// Display geometry of a mesh that was made in the background.
    geometry: Option<Arc<DisplayGeometry>>,
    /// Reason for which there is no simulation.
    refused: Option<Sentence>,
}

impl ComparedMotion {
    /// Returns the scene; `None` before the first [`Self::set_scene`].
    pub(crate) fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// Returns the simulation; `None` if the scene cannot be set up.
    pub(crate) fn simulation(&self) -> Option<&Simulation> {
        self.simulation.as_deref()
    }

    /// Returns the reason for which there is no motion, or for which it has stopped.
    pub(crate) fn failure(&self) -> Option<Sentence> {
        self.refused.clone().or_else(|| self.simulation()?.status().failure_sentence())
    }

    /// Returns `true` if there is a motion that has not become unstable.
    pub(crate) fn is_sound(&self) -> bool {
        self.simulation().is_some_and(|simulation| !matches!(simulation.status(), Status::Stopped(_)))
    }

    /// Returns `true` if the body moves.
    pub(crate) fn moves(&self) -> bool {
        self.simulation().is_some_and(|simulation| !simulation.is_at_rest())
    }

    /// Returns `true` while the motion is set up in the background.
    pub(crate) fn is_setting_up(&self) -> bool {
        self.setting_up.is_some()
    }

    /// Returns the equations of the motion, for motions on the same mesh.
    pub(crate) fn equations(&self) -> Option<Equations> {
        let simulation = self.simulation()?;
        Some(Equations::new(simulation.scene(), simulation.system(), self.geometry.clone()))
    }

    /// Applies a changed scene; a mesh that is among `equations` is not made again, and a motion of a large one is set
    /// up in the background. Returns `true` if the motion has to restart, because beam, mesh or any `[dynamics]`
    /// setting has changed, or it is ready.
    pub(crate) fn set_scene(&mut self, wanted: Scene, equations: &[Equations]) -> bool {
        let is_ready = self.poll();
        if self.scene.as_ref() == Some(&wanted) {
            return is_ready;
        }
        let before = self.scene.as_ref().filter(|_| self.simulation.is_some());
        let goes_on = before.is_some_and(|before| {
            (&before.beam, &before.mesh, &before.dynamics) == (&wanted.beam, &wanted.mesh, &wanted.dynamics)
        });
        let made = match self.simulation.take().filter(|_| goes_on) {
            Some(mut simulation) => simulation.change_scene(&wanted).map(|()| simulation),
            None => {
                (self.setting_up, self.geometry) = (None, None);
                let model = Equations::of(equations, &wanted).map_or(Model::New, Model::Equations);
                if wanted.unknowns() > MAX_PANE_UNKNOWNS {
                    self.set_up(&wanted, model);
                    self.scene = Some(wanted);
                    return true;
                }
                let made = model.set_up(&wanted).map_err(|rejected| rejected.error);
                made.map(|(bodies, _)| Box::new(bodies.simulation))
            }
        };
        self.refused = made.as_ref().err().map(Sentence::from);
        self.simulation = made.ok();
        self.scene = Some(wanted);
        !goes_on
    }

    /// Starts to set up a scene in the background.
    fn set_up(&mut self, scene: &Scene, model: Model) {
        let request = SolveRequest {
            scene: scene.clone(),
            model,
            start: SolveStart::Present,
            iterations: Some(0),
            residuals: Vec::new(),
            is_displayed: false,
        };
        match BackgroundSolve::start(request) {
            Ok(solve) => (self.setting_up, self.refused) = (Some(Box::new(solve)), None),
            Err(error) => self.refused = Some(error.to_string().into()),
        }
    }

    /// Takes the motion that was set up in the background; returns `true` if it is ready.
    fn poll(&mut self) -> bool {
        let Some(solve) = &mut self.setting_up else { return false };
        let Some(ended) = solve.poll_end() else { return false };
        self.setting_up = None;
        match ended {
            Ok(solved) => {
                self.geometry = solved.snapshot.geometry;
                self.simulation = Some(Box::new(solved.snapshot.bodies.simulation));
            }
            Err(reason) => self.refused = Some(reason),
        }
        true
    }

    /// Returns to the start.
    pub(crate) fn reset(&mut self) {
        self.simulation.iter_mut().for_each(|simulation| simulation.reset());
    }

    /// Makes one time step, unless the motion has become unstable.
    pub(crate) fn step(&mut self) {
        if self.is_sound()
            && let Some(simulation) = &mut self.simulation
        {
            simulation.step();
        }
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
        assert!(motion.set_scene(fall(9.81, IntegratorKind::TrBdf2), &[]));
        (0..5).for_each(|_| motion.step());
        let tip = motion.tip().unwrap();
        assert!(tip.y < 0.0);
        assert!(!motion.set_scene(fall(20.0, IntegratorKind::TrBdf2), &[]), "the motion continues");
        assert_eq!(motion.tip(), Some(tip));
        assert!(motion.set_scene(fall(20.0, IntegratorKind::ImplicitEuler), &[]));
        assert_eq!(motion.tip(), Some(Vector2::zeros()));
    }

    /// Neither another integrator nor another damping makes the mesh again; a large motion is set up in the background.
    #[test]
    fn a_mesh_is_made_once_and_a_large_motion_in_the_background() {
        let scene = |cells: u32, damping: f64, integrator| {
            let scene = Scene::beam(20.0, 0.5).with_cells(cells, 2).clamp("left").gravity([0.0, -9.81]);
            let mut scene = scene.probe("tip", "right").moving(integrator, 0.01);
            scene.dynamics.damping.stiffness = damping;
            scene
        };
        let mut motion = ComparedMotion::default();
        assert!(motion.set_scene(scene(1000, 0.0, IntegratorKind::TrBdf2), &[]));
        assert!(motion.is_setting_up() && motion.simulation().is_none() && !motion.moves());
        while !motion.set_scene(scene(1000, 0.0, IntegratorKind::TrBdf2), &[]) {
            std::thread::yield_now();
        }
        assert!(motion.moves() && motion.equations().unwrap().has_geometry());
        let system = motion.simulation().unwrap().system().clone();
        for (damping, integrator) in [(1e-3, IntegratorKind::TrBdf2), (1e-3, IntegratorKind::ImplicitEuler)] {
            let equations: Vec<_> = motion.equations().into_iter().collect();
            assert!(motion.set_scene(scene(1000, damping, integrator), &equations));
            while !motion.set_scene(scene(1000, damping, integrator), &[]) {
                std::thread::yield_now();
            }
            assert!(Arc::ptr_eq(motion.simulation().unwrap().system(), &system), "{integrator:?}");
        }
    }

    #[test]
    fn an_unstable_motion_stops_and_names_the_reason() {
        let scene = Scene::beam(2.0, 0.5).clamp("left").gravity([0.0, -9.81]);
        let mut motion = ComparedMotion::default();
        motion.set_scene(scene.moving(IntegratorKind::SymplecticEuler, 0.01), &[]);
        for _ in 0..1000 {
            if !motion.is_sound() {
                break;
            }
            motion.step();
        }
        assert!(motion.failure().is_some() && !motion.is_sound());
        let stopped = motion.simulation().unwrap().state().clone();
        motion.step();
        assert!(*motion.simulation().unwrap().state() == stopped, "an unstable motion makes no more steps");
        motion.reset();
        assert!(motion.is_sound() && motion.failure().is_none());
    }
}
