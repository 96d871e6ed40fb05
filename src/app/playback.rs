//! A motion in the window: its pace, its past, the place to go back to, and the same motion under other integrators.

use std::time::{Duration, Instant};

use nalgebra::Vector2;

use super::history::History;
use super::pace::Pace;
use crate::mesh::MaterialPoint;
use crate::scene::{Analysis, IntegratorKind, Scene};
use crate::simulation::{Motion, Simulation, Status};
use crate::state::State;

/// Of a frame so much may go into steps: the rest is for drawing.
const WORK: Duration = Duration::from_millis(24);

/// The same motion under another integrator, to be compared.
#[derive(Debug)]
pub(super) struct Companion {
    pub integrator: IntegratorKind,
    pub simulation: Simulation,
    pub history: History,
}

/// What a window of moving things has beside the body.
#[derive(Debug, Default)]
pub(super) struct Playback {
    pub pace: Pace,
    pub history: History,
    /// Where a reset goes, in place of the start.
    here: Option<State>,
    companions: Vec<Companion>,
    /// Integrators that became unstable and were taken out of the comparison since this was last asked for, with their longest
    /// stable step, s, where they have one.
    unstable: Vec<(IntegratorKind, Option<f64>)>,
}

impl Playback {
    /// Makes the time steps that are due at `now`, s.
    pub(super) fn advance(&mut self, now: f64, simulation: &mut Simulation) {
        let step = simulation.scene().dynamics.time_step;
        let due = self.pace.begin(now, step);
        let begun = Instant::now();
        let mut made = 0;
        while made < due && (made == 0 || begun.elapsed() < WORK) {
            self.step(simulation);
            made += 1;
            if simulation.is_at_rest() && !self.companions_move() {
                break;
            }
        }
        self.pace.end(due, made, step);
    }

    /// One time step of everything that moves.
    pub(super) fn step(&mut self, simulation: &mut Simulation) {
        if self.history.samples().is_empty() {
            self.history.record(simulation);
        }
        simulation.step();
        self.history.record(simulation);
        for companion in &mut self.companions {
            companion.simulation.step();
            companion.history.record(&companion.simulation);
        }
        // Its energies would set the axes of everything else.
        let unstable = &mut self.unstable;
        self.companions.retain(|companion| {
            let stopped = matches!(companion.simulation.status(), Status::Stopped(_));
            if stopped {
                let step = companion.simulation.motion().and_then(Motion::critical_step);
                unstable.push((companion.integrator, step));
            }
            !stopped
        });
    }

    /// Takes the integrators that became unstable since the last call, with their longest stable step, s.
    pub(super) fn take_unstable(&mut self) -> Vec<(IntegratorKind, Option<f64>)> {
        std::mem::take(&mut self.unstable)
    }

    /// The same motion under other integrators.
    pub(super) fn companions(&self) -> &[Companion] {
        &self.companions
    }

    /// Whether one of these moves still.
    pub(super) fn companions_move(&self) -> bool {
        self.companions.iter().any(|c| !c.simulation.is_at_rest())
    }

    /// Back to the start of the scene, or to the place that was marked.
    pub(super) fn reset(&mut self, simulation: &mut Simulation) {
        let here = self.here.clone();
        let bodies = std::iter::once(simulation).chain(self.companions.iter_mut().map(|c| &mut c.simulation));
        for body in bodies {
            body.reset();
            if let Some(here) = &here {
                // A mark of a body that is no more was forgotten with it.
                let _ = body.restore(here);
            }
        }
        self.start_anew();
    }

    /// A reset goes to where the body is now, from now on; or to the start again.
    pub(super) fn mark(&mut self, simulation: &Simulation) {
        self.here = if self.here.is_none() { Some(simulation.state().clone()) } else { None };
    }

    /// Whether a reset goes to a marked place.
    pub(super) fn is_marked(&self) -> bool {
        self.here.is_some()
    }

    fn start_anew(&mut self) {
        self.history.clear();
        self.companions.iter_mut().for_each(|c| c.history.clear());
        self.pace.rest();
    }

    /// The scene under the body has changed; `is_another` says whether the body has.
    pub(super) fn follow(&mut self, scene: &Scene, is_another: bool) {
        if is_another {
            self.here = None;
            self.start_anew();
        }
        let moves = scene.analysis == Analysis::Dynamic;
        self.companions.retain_mut(|c| {
            let differs = c.integrator != scene.dynamics.integrator;
            moves && differs && c.simulation.change_scene(&with(scene, c.integrator)).is_ok()
        });
    }

    /// Shows the same motion under another integrator, from where the body is now; or no longer.
    pub(super) fn toggle(&mut self, kind: IntegratorKind, simulation: &Simulation) {
        let before = self.companions.len();
        self.companions.retain(|c| c.integrator != kind);
        if self.companions.len() == before {
            self.add(kind, simulation);
        }
    }

    fn add(&mut self, integrator: IntegratorKind, simulation: &Simulation) {
        let scene = with(simulation.scene(), integrator);
        // On the body's own equations: nothing of them is made twice.
        let Ok(mut companion) = Simulation::with_system(&scene, simulation.system().clone()) else { return };
        if companion.restore(simulation.state()).is_ok() {
            self.companions.push(Companion { integrator, simulation: companion, history: History::default() });
        }
    }

    /// Takes hold of the same point of everything that moves.
    pub(super) fn grab(&mut self, point: MaterialPoint) {
        for companion in &mut self.companions {
            companion.simulation.grab(point);
        }
    }

    /// Pulls everything to the same place.
    pub(super) fn pull_to(&mut self, place: Vector2<f64>) {
        for companion in &mut self.companions {
            // A pointer has a finite place.
            let _ = companion.simulation.pull_to(place);
        }
    }

    /// Lets everything go.
    pub(super) fn release(&mut self) {
        self.companions.iter_mut().for_each(|c| c.simulation.release());
    }
}

fn with(scene: &Scene, integrator: IntegratorKind) -> Scene {
    let mut scene = scene.clone();
    scene.dynamics.integrator = integrator;
    scene
}
