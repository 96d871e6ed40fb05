//! Expensive results of a scene, computed in the background; and the reference solution that follows a dragged load in a
//! thread of its own, where one load is solved at a time, and the newest is next.

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use super::*;
use crate::app::platform::IS_PAGE;
use crate::app::session::clock::FRAMES;
use crate::app::task::keyed::{Computed, Keyed, SentScene, facts};
use crate::app::task::solve::Quality;
use crate::app::task::thread::{Reporter, Task, Update};
use crate::format::number;
use crate::scene::{DynamicsSettings, Place, SolverSettings};
use crate::simulation::Equilibrium;
use crate::study::limits::MethodLimits;
use crate::study::{
    Extent, LoadCurve, LoadPath, MAX_CERTIFIED, PathFromRest, Study, StudyError, time_of_motion, times_from_rest,
};

/// Load–displacement curve of a scene at rest.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Curve {
    pub scene: SentScene,
    /// Load path on the scene's mesh; without states under linear theory.
    pub path: LoadPath,
    /// Beam theory of a cantilever.
    pub beam: Option<LoadCurve>,
}

facts! {
    /// Reference solution that errors are measured against.
    ReferenceFact by without_settings = "reference": Reference, |scene, observe, _| {
        found(Reference::find(scene, None, Extent::Quick, observe))
    };
    /// Load–displacement curve.
    CurveFact = "curve": Curve, |scene, observe, _| curve(scene, observe);
    /// End of the load path from rest, and the jumps on it.
    PathFact = "path": PathFromRest, |scene, observe, _| {
        Ok(Simulation::new(scene).ok().and_then(|simulation| LoadPath::from_rest(&simulation, observe)))
    };
    /// Limits of every method and element.
    LimitsFact by without_methods = "limits": MethodLimits, |scene, observe, partial| {
        found(MethodLimits::of(scene, observe, &|limits| partial(limits.clone())))
    };
    /// Errors and times of elements, meshes and methods; of a motion those on coarse meshes, as finer ones take minutes.
    StudyFact by without_settings = "study": Study, |scene, observe, partial| {
        let extent = if scene.analysis == Analysis::Dynamic { Extent::Quick } else { Extent::Full };
        found(Study::with_partial(scene, extent, observe, &mut |study| partial(study.clone())))
    };
    /// Spectral radius ρ of the warped iteration at the equilibrium.
    RhoFact by without_solver = "rho": f64, |scene, observe, _| Ok(fixed_point_rho(scene, observe));
    /// Time and result of a solve from rest.
    TimeFact = "time": SolveFromRest, |scene, observe, _| Ok(time_from_rest(scene, observe));
    /// Computing time of a solve from rest, or of a motion's frame at 60 Hz, s.
    CostFact = "cost": f64, |scene, observe, _| Ok(match scene.analysis {
        Analysis::Static => time_from_rest(scene, observe).map(|solve| solve.timings.total().as_secs_f64()),
        Analysis::Dynamic => time_of_motion(scene, observe).map(|per_second| per_second / 1e3 / FRAMES),
    });
}

/// Number of unknowns above which a result is certified in the background: its eigenvalues then take longer than
/// [`super::MAX_FRAME_WORK`].
const MAX_CERTIFIED_HERE: usize = 2000;
/// Largest number of unknowns of a body whose load curve is computed: a curve takes hundreds of iterations.
const MAX_CURVE_UNKNOWNS: u64 = 100_000;

fn curve(scene: &Scene, observe: Observer<'_>) -> Computed<Curve> {
    if scene.unknowns() > MAX_CURVE_UNKNOWNS {
        return Err(sentence!(
            "the load curve of more than %{n} unknowns takes minutes: `warpbeam curve` computes it",
            n = number(MAX_CURVE_UNKNOWNS as f64)
        ));
    }
    // Beam theory has the displacement of the tip.
    let is_at_tip = scene.probes.first().is_some_and(|probe| probe.place == Place::from("right"));
    let (path, beam) = (LoadPath::of(scene, observe), is_at_tip.then(|| LoadCurve::new(scene)).flatten());
    let has_curve = path.is_some() || beam.is_some();
    let curve = || Curve { scene: SentScene(scene.clone()), path: path.unwrap_or_default(), beam };
    Ok(has_curve.then(curve))
}

/// Results of the current scene; each is `None` until it has been computed.
#[derive(Default)]
pub(crate) struct Facts {
    pub reference: Keyed<ReferenceFact>,
    pub path: Keyed<PathFact>,
    pub rho: Keyed<RhoFact>,
    pub time: Keyed<TimeFact>,
    /// Certification of a copy of the displayed body.
    pub certifying: Option<Task<(), Box<(Simulation, Quality)>>>,
    pub(super) live: Follower,
    /// Body that is solved from rest to measure the time of a dragged load, and the last such solve with its scene.
    pub(super) timed: Option<(Simulation, SolveFromRest)>,
}

impl Facts {
    /// Requests the results of a scene at rest, with ρ if it is shown, or computes them and `waits`; returns `true` while one
    /// of them is pending, or another one (`is_busy`).
    pub(super) fn request_at_rest(&mut self, scene: &Scene, shows_rho: bool, is_busy: bool, waits: bool) -> bool {
        let reference = self.reference.obtain(scene, waits);
        let path = self.path.obtain(scene, waits);
        let rho = shows_rho && self.rho.obtain(scene, waits);
        // Solves are timed after the other computations, which would slow them down.
        reference || path || rho || is_busy || self.time.obtain(scene, waits)
    }
}

/// Returns the scene with default values of all settings that a study varies. The reference solution depends only on
/// the other values.
pub(crate) fn without_settings(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let first = scene.elements().next().unwrap_or_default();
    scene.set_element(first);
    if let Some(beam) = &mut scene.beam {
        beam.cells = [1, 1];
    }
    scene.solver = SolverSettings { tolerance: scene.solver.tolerance, ..SolverSettings::default() };
    let any = DynamicsSettings::default();
    let dynamics = &mut scene.dynamics;
    (dynamics.integrator, dynamics.time_step, dynamics.iterations) = (any.integrator, any.time_step, any.iterations);
    scene
}

/// Returns the scene with the default solver, on which its equilibrium does not depend.
pub(crate) fn without_solver(scene: &Scene) -> Scene {
    Scene { solver: SolverSettings::default(), ..scene.clone() }
}

/// Returns the scene with default values of all settings that its limits do not depend on: they are those of every
/// method and element at rest, and of every integrator in motion.
pub(crate) fn without_methods(scene: &Scene) -> Scene {
    // An early stop has a strip of its own.
    let stops = scene.analysis == Analysis::Static && scene.solver.accept_after > 0;
    if stops { scene.clone() } else { with_default_methods(scene.clone()) }
}

/// Returns a scene with the default integrator, or with the default method and the first element.
pub(crate) fn with_default_methods(mut scene: Scene) -> Scene {
    if scene.analysis == Analysis::Dynamic {
        scene.dynamics.integrator = DynamicsSettings::default().integrator;
        return scene;
    }
    let first = scene.elements().next().unwrap_or_default();
    scene.set_element(first);
    let any = SolverSettings::default();
    (scene.solver.method, scene.solver.max_error_percent) = (any.method, any.max_error_percent);
    scene
}

fn found<V>(found: Result<V, StudyError>) -> Computed<V> {
    found.map(Some).map_err(|error| (&error).into())
}

/// Returns ρ of the warped iteration at a scene's equilibrium, which is computed with Newton's method because the
/// warped iteration may diverge; `None` of a larger body than results are certified of.
fn fixed_point_rho(scene: &Scene, observe: Observer<'_>) -> Option<f64> {
    if scene.analysis != Analysis::Static || scene.unknowns() > MAX_CERTIFIED as u64 {
        return None;
    }
    let mut scene = scene.clone().with_method(MethodKind::Newton);
    scene.solver.accept_after = 0;
    let mut simulation = Simulation::new(&scene).ok()?;
    if simulation.solve_watched(&mut |_| observe(Progress::at(0.0))).is_break() {
        return None;
    }
    simulation.certify().fixed_point_rho.filter(|_| simulation.status().is_success())
}

/// Time and result of a solve from rest.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct SolveFromRest {
    /// Median times of repeated solves.
    pub timings: Timings,
    /// Number of iterations.
    pub iterations: u32,
    /// `true` if it ends with a result.
    pub is_solved: bool,
    /// Displacement of the first probe at the end, m; `None` if the scene has no probe.
    pub displacement: Option<Vector2<f64>>,
}

impl SolveFromRest {
    /// Returns time and result of a simulation that has been solved from rest.
    fn of(simulation: &Simulation) -> Self {
        Self {
            timings: *simulation.timings(),
            iterations: simulation.iterations(),
            is_solved: simulation.status().is_success(),
            displacement: first_probe(simulation),
        }
    }
}

/// Times the solve of a scene from rest; returns `None` for a motion, and if the scene cannot be solved or the
/// computation is cancelled.
fn time_from_rest(scene: &Scene, observe: Observer<'_>) -> Option<SolveFromRest> {
    let mut simulation = Simulation::new(scene).ok().filter(|simulation| simulation.motion().is_none())?;
    // Without a load there is no iteration.
    let timings = times_from_rest(&mut simulation, u32::MAX, observe)?.pop().unwrap_or_default();
    Some(SolveFromRest { timings, ..SolveFromRest::of(&simulation) })
}

/// Returns the displacement of a body's first probe, m.
pub(crate) fn first_probe(body: &Simulation) -> Option<Vector2<f64>> {
    Some(body.problem().probes().first()?.mean(body.displacement()))
}

/// Reference solution under a load, and the displacements that it is compared with.
pub(crate) struct Live {
    /// Scene without the settings on which the reference does not depend.
    pub key: Scene,
    pub reference: Reference,
    /// Displacements of the first probe, m: of the body, and by linear theory.
    pub own: Option<Vector2<f64>>,
    pub linear: Option<Vector2<f64>>,
}

impl Live {
    /// Returns `true` if the reference is that of a scene under any loads.
    pub(crate) fn is_of_body(&self, scene: &Scene) -> bool {
        Scene { loads: self.key.loads.clone(), ..without_settings(scene) } == self.key
    }

    /// Returns `true` if the reference is that of a scene, and not of the load before.
    pub(crate) fn is_of(&self, scene: &Scene) -> bool {
        self.key == without_settings(scene)
    }

    /// Returns `true` if a body has moved far since its reference was asked for, which then says nothing about it.
    pub(crate) fn is_late(&self, body: &Simulation) -> bool {
        /// Distance relative to the size of the body.
        const FAR: f64 = 0.05;
        let moved = self.own.zip(first_probe(body)).map(|(asked, now)| (now - asked).norm());
        moved.is_some_and(|moved| moved > FAR * body.system().size())
    }
}

/// Reference solution that follows the load.
#[derive(Default)]
pub(crate) struct Follower {
    /// Key of the scene that was solved last, or is being solved.
    asked: Option<Scene>,
    pub running: Option<Task<(), Option<Box<Live>>>>,
    /// Last reference; `None` if the last load has none that is found soon.
    pub known: Option<Box<Live>>,
}

impl Follower {
    /// Takes the reference that has been found; returns `true` while one is pending.
    pub(crate) fn poll(&mut self) -> bool {
        let Some(task) = &self.running else { return false };
        match task.poll() {
            Update::None | Update::Progress(()) => return true,
            Update::Done(found) => self.known = found,
            Update::Died => self.known = None,
        }
        self.running = None;
        false
    }

    /// Requests the reference of a scene at rest; returns `true` while it is pending. A page has no thread for it: there
    /// the error is shown at rest.
    pub(crate) fn request(&mut self, scene: &Scene, own: Option<Vector2<f64>>, linear: Option<Vector2<f64>>) -> bool {
        if self.poll() {
            return true;
        }
        let key = without_settings(scene);
        if IS_PAGE || self.asked.as_ref() == Some(&key) {
            return false;
        }
        self.asked = Some(key.clone());
        let scene = scene.clone();
        let work = move |_: &Reporter<_, _>| {
            let reference = Reference::find(&scene, None, Extent::Drag, &|_| ControlFlow::Continue(())).ok()?;
            Some(Box::new(Live { key, reference, own, linear }))
        };
        self.running = Task::start("follow", work).ok();
        self.running.is_some()
    }
}

impl Session {
    pub(super) fn certify(&mut self) {
        self.model.simulation.certify();
        self.fallback.keep(&self.model.simulation);
        let mut quality = std::mem::take(&mut self.model.quality);
        quality.update(self.drawn());
        self.model.quality = quality;
    }

    /// Certifies the result, that of a large body in the background; returns `true` while that is pending.
    fn request_certificate(&mut self) -> bool {
        if let Some(task) = &self.facts.certifying {
            match task.poll() {
                Update::None | Update::Progress(()) => return true,
                Update::Done(certified) => {
                    let (own, simulation) = (&self.model.simulation, &certified.0);
                    let is_current = simulation.state() == own.state()
                        && simulation.scene() == own.scene()
                        && simulation.status() == own.status()
                        && own.mouse_spring().is_none();
                    if is_current {
                        (self.model.simulation, self.model.quality) = *certified;
                        self.certify();
                    }
                }
                Update::Died => self.certify(),
            }
            self.facts.certifying = None;
        }
        let is_known = !self.model.simulation.equilibrium().is_some_and(Equilibrium::needs_certificate)
            && self.model.quality.is_of(self.drawn());
        let is_small = self.model.simulation.system().dofs() <= MAX_CERTIFIED_HERE;
        let copy = self.model.simulation.equilibrium().filter(|_| !(is_known || is_small || IS_PAGE));
        let started = copy.map(Equilibrium::snapshot).and_then(|mut copy| {
            let work = move |_: &Reporter<_, _>| {
                let quality = Quality::certified(&mut copy);
                Box::new((copy, quality))
            };
            Task::start("certify", work).ok()
        });
        self.facts.certifying = started;
        if self.facts.certifying.is_none() {
            self.certify();
        }
        self.facts.certifying.is_some()
    }

    /// Requests the results of the scene once the body is at rest; returns `true` while one of them is pending. Its time is
    /// measured while nothing else is computed (`is_busy`). During a press only the results that a frame has time for are
    /// requested, and the reference that follows the load.
    pub(crate) fn request_facts(&mut self, shows_rho: bool, is_busy: bool, is_pressed: bool) -> bool {
        if self.is_motion() || self.iterates() || self.is_working() {
            return false;
        }
        // A background solve has certified its result.
        let certifies = !self.is_in_background() && self.request_certificate();
        let follows = self.follow_reference();
        if is_pressed {
            self.time_in_frame();
            return follows || certifies;
        }
        let shows_rho = shows_rho || self.lacks_rho();
        self.facts.request_at_rest(&self.present.scene, shows_rho, is_busy, false) || follows || certifies
    }

    /// Requests the reference that follows the load of a body of few unknowns, also at rest: it is then known when a drag
    /// begins. Returns `true` while it is pending.
    fn follow_reference(&mut self) -> bool {
        let simulation = &self.model.simulation;
        let is_found = simulation.status().is_success();
        let is_wanted = (is_found || is_lost(simulation)) && simulation.mouse_spring().is_none();
        if !is_wanted || simulation.system().dofs() > MAX_CERTIFIED_HERE {
            return self.facts.live.poll();
        }
        let linear = self.model.linear.as_ref().and_then(first_probe);
        self.facts.live.request(&self.present.scene, first_probe(simulation).filter(|_| is_found), linear)
    }

    /// Returns `true` while the reference that follows the load is being computed.
    pub fn is_following(&self) -> bool {
        self.facts.live.running.is_some()
    }

    /// Measures the time of a solve from rest, if it was short at the last rest; if that failed, if the last search was.
    fn time_in_frame(&mut self) {
        /// Largest time of a solve in a frame.
        const SHORT: Duration = Duration::from_millis(2);
        let last = self.facts.time.latest().filter(|solve| solve.is_solved);
        let time = last.map_or(self.frame.timings.total(), |solve| solve.timings.total());
        if time >= SHORT || self.timed_solve().is_some() {
            return;
        }
        let timed = self.facts.timed.take().map(|(timed, _)| timed);
        let timed = timed.filter(|timed| Arc::ptr_eq(timed.system(), self.model.simulation.system()));
        let timed =
            timed.or_else(|| Simulation::with_system(&self.present.scene, self.model.simulation.system().clone()).ok());
        let Some(mut timed) = timed.filter(|_| !IS_PAGE) else { return };
        if timed.change_scene(&self.present.scene).is_ok() {
            timed.reset();
            timed.solve();
            let solve = SolveFromRest::of(&timed);
            self.facts.timed = Some((timed, solve));
        }
    }

    /// Requests the reference solution, in any state of the body, or computes it and `waits`; returns `true` while it is
    /// pending.
    pub(crate) fn obtain_reference(&mut self, waits: bool) -> bool {
        self.facts.reference.obtain(&self.present.scene, waits)
    }

    /// Returns `true` if the warped iteration has ended without a result that has a ρ of its own.
    pub(crate) fn lacks_rho(&self) -> bool {
        let is_warped = self.present.scene.solver.method == MethodKind::Warped && !self.is_motion();
        is_warped && self.has_ended() && *self.model.simulation.status() != Status::Converged
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;
    use crate::app::task::keyed::Fact;
    use crate::scene::open;

    /// The load curve of a very large body is refused at once, with the command that computes it.
    #[test]
    fn the_curve_of_a_very_large_body_is_refused() {
        let scene = Scene::beam(10.0, 1.0).with_cells(4000, 40).clamp("left").force("right", [0.0, -1.0]);
        let refused =
            (CurveFact::COMPUTE)(&scene.probe("tip", "right"), &|_| ControlFlow::Continue(()), &|_| ()).unwrap_err();
        assert!(refused.to_string().contains("`warpbeam curve`"), "{refused}");
    }

    /// A cancelled computation ends before its first solve: each search asks before each of its steps.
    #[test]
    fn results_are_cancelled() {
        fn asked<F: Fact>(scene: &Scene) -> u32 {
            let asked = AtomicU32::new(0);
            let observe = |_: Progress<'_>| {
                asked.fetch_add(1, Ordering::Relaxed);
                ControlFlow::Break(())
            };
            let _ = (F::COMPUTE)(scene, &observe, &|_| ());
            asked.into_inner()
        }
        for id in ["cantilever", "snap"] {
            let scene = open(&crate::scene::Source { name: id.into(), assignments: Vec::new() }).unwrap();
            let all = [asked::<ReferenceFact>(&scene), asked::<CurveFact>(&scene), asked::<PathFact>(&scene)];
            assert!(all.iter().all(|asked| (1..4).contains(asked)), "{id}: {all:?}");
        }
    }

    /// The reference that follows a load is found however far the load jumps.
    #[test]
    fn a_load_that_jumps_has_a_reference() {
        let mut scene = open(&crate::scene::Source { name: "incline".into(), assignments: Vec::new() }).unwrap();
        for factor in [1.0, -0.9, -1.1, -1.0, -0.5] {
            scene.scale_loads(factor);
            let found = Reference::find(&scene, None, Extent::Drag, &|_| ControlFlow::Continue(()));
            assert!(found.unwrap().first().is_some(), "{factor}");
        }
    }

    #[test]
    fn a_reference_is_that_of_a_body_under_any_load() {
        let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]).probe("tip", "right");
        let reference = Reference::of(&scene).unwrap();
        let live = Live { key: without_settings(&scene), reference, own: None, linear: None };
        let (mut heavier, mut longer) = (scene.clone(), scene);
        heavier.scale_loads(2.0);
        assert!(live.is_of_body(&heavier) && !live.is_of(&heavier));
        longer.beam.as_mut().unwrap().length = 20.0;
        assert!(!live.is_of_body(&longer));
    }
}
