//! Playback of a motion: clock, recorded past, and the same motion under other integrators.

use crate::app::session::clock::RealTimeClock;
use crate::app::session::history::History;
use crate::scene::{Analysis, IntegratorKind, Scene};
use crate::simulation::{Motion, Simulation, Status};

/// Largest memory for the recorded moments of all motions, bytes.
const MAX_BYTES: usize = 64 << 20;
/// Shortest playing time between two recorded moments, s: one frame at 60 Hz, less rounding.
const BETWEEN_MOMENTS: f64 = 1.0 / 61.0;

/// The same motion under another integrator, for comparison.
#[derive(Debug)]
pub(crate) struct Companion {
    pub integrator: IntegratorKind,
    pub simulation: Simulation,
    pub history: History,
    /// `true` while the displayed moment is earlier than the one at which this motion was added.
    pub is_absent: bool,
}

/// Playback of a motion and its companions.
#[derive(Debug, Default)]
pub(crate) struct Playback {
    pub clock: RealTimeClock,
    pub history: History,
    /// Time of the displayed moment, s; `None` if it is the latest.
    pub shown: Option<f64>,
    /// Playing time since the start, s: simulated time over speed.
    pub played: f64,
    /// Playing time at which the last moment was recorded, s.
    kept: f64,
    /// The same motion under other integrators.
    pub companions: Vec<Companion>,
    /// Integrators that became unstable and were removed from the comparison, until they are reported, with their longest
    /// stable step, s, if they have one.
    pub unstable: Vec<(IntegratorKind, Option<f64>)>,
}

impl Playback {
    /// Makes the time steps that are due at `now`, s.
    pub(crate) fn advance(&mut self, now: f64, simulation: &mut Simulation) {
        let step = simulation.scene().dynamics.time_step;
        let mut steps = self.clock.begin(now, step);
        while steps.next() {
            self.make_step(simulation);
            if simulation.is_at_rest() && !self.companions_move() {
                break;
            }
        }
        self.clock.end(&steps, step);
        if self.played - self.kept >= BETWEEN_MOMENTS {
            self.keep_moment(simulation);
        }
    }

    /// Makes one time step of the motion and its companions.
    pub(crate) fn step(&mut self, simulation: &mut Simulation) {
        self.make_step(simulation);
        self.keep_moment(simulation);
    }

    fn make_step(&mut self, simulation: &mut Simulation) {
        self.discard_future();
        if self.history.samples.is_empty() {
            self.history.record(simulation);
            self.keep_moment(simulation);
        }
        let before = simulation.state().time();
        simulation.step();
        self.played += (simulation.state().time() - before) / self.clock.speed;
        self.history.record(simulation);
        for companion in &mut self.companions {
            companion.simulation.step();
            companion.history.record(&companion.simulation);
        }
        // Energies of an unstable companion would set the scale of all axes.
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

    /// Records the current moment of the motion and its companions.
    fn keep_moment(&mut self, simulation: &Simulation) {
        let most_bytes = MAX_BYTES / (1 + self.companions.len());
        self.history.keep_moment(simulation, most_bytes);
        for companion in self.companions.iter_mut().filter(|companion| !companion.is_absent) {
            companion.history.keep_moment(&companion.simulation, most_bytes);
        }
        self.kept = self.played;
    }

    /// Returns the times of the first and the last recorded moment, s; `None` if there is only one or none.
    pub(crate) fn span(&self) -> Option<[f64; 2]> {
        let moments = &self.history.moments;
        let ends = [moments.front()?.state().time(), moments.back()?.state().time()];
        (ends[0] < ends[1]).then_some(ends)
    }

    /// Displays the recorded moment closest to `time`, s. Later moments are kept until the next step.
    pub(crate) fn show_moment(&mut self, time: f64, simulation: &mut Simulation) {
        self.keep_latest(simulation);
        let Some(time) = self.history.nearest(time) else { return };
        self.show_exactly(time, simulation);
    }

    /// Displays the next recorded moment (`forward`) or the previous one. Returns `false` if there is none.
    pub(crate) fn show_neighbour(&mut self, forward: bool, simulation: &mut Simulation) -> bool {
        self.keep_latest(simulation);
        let Some(time) = self.history.neighbour(simulation.state().time(), forward) else { return false };
        self.show_exactly(time, simulation);
        true
    }

    fn keep_latest(&mut self, simulation: &Simulation) {
        if self.shown.is_none() && !self.history.samples.is_empty() {
            self.keep_moment(simulation);
        }
    }

    fn show_exactly(&mut self, time: f64, simulation: &mut Simulation) {
        // The grabbed state is another moment.
        simulation.release();
        self.each(Simulation::release);
        let Some(moment) = self.history.at(time) else { return };
        if simulation.return_to(moment).is_err() {
            return;
        }
        self.shown = (self.span().is_some_and(|[_, last]| time < last)).then_some(time);
        for companion in &mut self.companions {
            let moment = companion.history.at(time);
            companion.is_absent = moment.is_none_or(|moment| companion.simulation.return_to(moment).is_err());
        }
    }

    /// Removes the moments after the displayed one. Companions that had not been added at that moment start there.
    fn discard_future(&mut self) {
        let shown = self.shown.take();
        let is_whole = self.companions.iter().all(|companion| !companion.is_absent);
        let latest = self.history.moments.back().map(|moment| moment.state().time()).filter(|_| !is_whole);
        let Some(time) = shown.or(latest) else { return };
        self.history.truncate_after(time);
        let here = self.history.at(time);
        for companion in &mut self.companions {
            companion.history.truncate_after(time);
            if let Some(here) = here.filter(|_| companion.is_absent) {
                // Cannot fail: the state belongs to the same body.
                let _ = companion.simulation.restore(here.state());
                companion.is_absent = false;
            }
        }
    }

    fn discard_past(&mut self) {
        self.history.clear_moments();
        self.companions.iter_mut().for_each(|companion| companion.history.clear_moments());
        (self.shown, self.kept) = (None, self.played);
    }

    /// Returns `true` if a companion is still moving.
    pub(crate) fn companions_move(&self) -> bool {
        self.companions.iter().any(|c| !c.simulation.is_at_rest())
    }

    /// Returns to the start of the scene.
    pub(crate) fn reset(&mut self, simulation: &mut Simulation) {
        simulation.reset();
        self.each(Simulation::reset);
        self.restart();
    }

    fn restart(&mut self) {
        self.history.clear();
        self.companions.iter_mut().for_each(|c| {
            c.history.clear();
            c.is_absent = false;
        });
        self.discard_past();
        self.clock.rest();
    }

    /// Adapts to a change of the scene to that of the motion; `is_another` is `true` if the body has changed. Removes the
    /// recorded moments, which belong to the previous scene, and the trail of a motion that restarts.
    pub(crate) fn change_scene(&mut self, simulation: &Simulation, is_another: bool) {
        let scene = simulation.scene();
        self.discard_future();
        self.discard_past();
        self.history.truncate_after(simulation.state().time());
        if is_another {
            self.restart();
        }
        let moves = scene.analysis == Analysis::Dynamic;
        self.companions.retain_mut(|c| {
            let differs = c.integrator != scene.dynamics.integrator;
            let stays = moves && differs && c.simulation.change_scene(&with(scene, c.integrator)).is_ok();
            c.history.truncate_after(c.simulation.state().time());
            stays
        });
    }

    /// Adds the same motion under another integrator, starting from the current state, or removes it.
    pub(crate) fn toggle(&mut self, integrator: IntegratorKind, simulation: &Simulation) {
        let before = self.companions.len();
        self.companions.retain(|c| c.integrator != integrator);
        if self.companions.len() < before {
            return;
        }
        let scene = with(simulation.scene(), integrator);
        // The companion shares the body's equations.
        let Ok(mut companion) = Simulation::with_system(&scene, simulation.system().clone()) else { return };
        if companion.restore(simulation.state()).is_ok() {
            let mut history = History::default();
            history.keep_moment(&companion, MAX_BYTES);
            self.companions.push(Companion { integrator, simulation: companion, history, is_absent: false });
        }
    }

    /// Grabs, pulls or releases every companion.
    pub(crate) fn each(&mut self, change: impl Fn(&mut Simulation)) {
        self.companions.iter_mut().for_each(|companion| change(&mut companion.simulation));
    }
}

fn with(scene: &Scene, integrator: IntegratorKind) -> Scene {
    let mut scene = scene.clone();
    scene.dynamics.integrator = integrator;
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::INTEGRATORS;
    use crate::state::State;

    /// Returns a falling beam, to which a companion is added after five of ten steps, with its last five pairs of
    /// states.
    fn falling(kind: IntegratorKind) -> (Playback, Simulation, Vec<[State; 2]>) {
        let scene = Scene::beam(2.0, 0.5).clamp("left").gravity([0.0, -9.81]).moving(kind, 0.01);
        let (mut playback, mut simulation) = (Playback::default(), Simulation::new(&scene).unwrap());
        (0..5).for_each(|_| playback.step(&mut simulation));
        playback.toggle(IntegratorKind::ImplicitEuler, &simulation);
        let mut states = Vec::new();
        for _ in 0..5 {
            playback.step(&mut simulation);
            let companion = playback.companions[0].simulation.state().clone();
            states.push([simulation.state().clone(), companion]);
        }
        (playback, simulation, states)
    }

    #[test]
    fn all_motions_return_to_the_same_moment() {
        // The steps are too long for explicit integrators.
        for integrator in INTEGRATORS.iter().filter(|entry| !entry.is_explicit()) {
            let (mut playback, mut simulation, states) = falling(integrator.kind);
            for [own, other] in states.iter().rev() {
                playback.show_moment(own.time(), &mut simulation);
                assert!(simulation.state() == own, "{}: {}", integrator.id, own.time());
                let companion = &playback.companions[0];
                assert!(!companion.is_absent && companion.simulation.state() == other, "{}", own.time());
                let at_present = own.time() == states[4][0].time();
                assert_eq!(playback.shown.is_none(), at_present);
            }
            // Continuing from an earlier moment repeats the same steps.
            playback.show_moment(states[2][0].time(), &mut simulation);
            playback.step(&mut simulation);
            let distance = |a: &State, b: &State| (a.displacement()[1] - b.displacement()[1]).norm();
            assert!(distance(simulation.state(), &states[3][0]) < 1e-9, "{}", integrator.id);
            assert!(distance(playback.companions[0].simulation.state(), &states[3][1]) < 1e-9);
            assert_eq!(playback.span().map(|span| span[1]), Some(simulation.state().time()), "the future is gone");
            assert_eq!(playback.history.samples.back().map(|s| s.time), Some(simulation.state().time()));
        }
    }

    #[test]
    fn a_companion_is_absent_before_it_was_added() {
        let (mut playback, mut simulation, _) = falling(IntegratorKind::TrBdf2);
        playback.show_moment(0.02, &mut simulation);
        assert!(playback.companions[0].is_absent);
        playback.step(&mut simulation);
        let is_along = |playback: &Playback, simulation: &Simulation| {
            let companion = &playback.companions[0];
            !companion.is_absent && companion.simulation.state().time() == simulation.state().time()
        };
        assert!(is_along(&playback, &simulation));
        // A companion added at an earlier moment starts at the latest moment if that one is continued.
        playback.toggle(IntegratorKind::ImplicitEuler, &simulation);
        playback.step(&mut simulation);
        playback.show_moment(0.01, &mut simulation);
        playback.toggle(IntegratorKind::ImplicitEuler, &simulation);
        playback.show_moment(1.0, &mut simulation);
        assert!(playback.companions[0].is_absent && playback.shown.is_none());
        playback.step(&mut simulation);
        assert!(is_along(&playback, &simulation));
    }
}
