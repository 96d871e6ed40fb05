//! Value of a scene that is computed in the background, and belongs to the scene that it was computed from.

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use crate::app::prelude::*;
use crate::app::task::thread::{Data, Reporter, Task, Update};
use crate::mesh::Mesh;
use crate::scene::SceneError;

/// Result of a computation: a value, or `None` if the scene has none, or the reason why the computation failed.
pub(crate) type Computed<V> = Result<Option<V>, Sentence>;

/// Function that computes the value of a scene; its last argument receives the value so far each time a part of it is
/// known.
pub(crate) type Compute<V> = fn(&Scene, Observer<'_>, &(dyn Fn(V) + Sync)) -> Computed<V>;

/// Kind of value of a scene that is computed in the background.
pub(crate) trait Fact: 'static {
    /// Name of the computation.
    const NAME: &'static str;
    type Value: Data;
    /// Returns the part of a scene that the value depends on: scenes with the same key have the same value.
    const KEY: fn(&Scene) -> Scene = Scene::clone;
    const COMPUTE: Compute<Self::Value>;
}

#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum FactProgress<V> {
    /// Fraction done, and what is computed now, if it is something else than before.
    Now(f64, Option<Sentence>),
    SoFar(V),
}

/// Defines kinds of values, each by its name, its type, the function that computes it, and `by` its key where that is not
/// the whole scene.
macro_rules! facts {
    ($($(#[$about:meta])* $kind:ident $(by $key:path)? = $name:literal: $value:ty, $compute:expr;)*) => {$(
        $(#[$about])*
        pub(crate) struct $kind;

        impl $crate::app::task::keyed::Fact for $kind {
            const NAME: &'static str = $name;
            type Value = $value;
            $(const KEY: fn(&$crate::scene::Scene) -> $crate::scene::Scene = $key;)?
            const COMPUTE: $crate::app::task::keyed::Compute<$value> = $compute;
        }
    )*};
}
pub(crate) use facts;

/// Scene that can be sent as data.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "SceneParts", try_from = "SceneParts")]
pub(crate) struct SentScene(pub Scene);

/// Text of a scene, and of its mesh file.
type SceneParts = (String, Option<String>);

impl From<SentScene> for SceneParts {
    fn from(SentScene(scene): SentScene) -> Self {
        let mesh = scene.mesh.as_ref().and_then(|mesh| mesh.text.as_deref()).map(str::to_owned);
        // A scene that cannot be written gives an empty text, which the receiver refuses.
        (scene.to_toml().unwrap_or_default(), mesh)
    }
}

impl TryFrom<SceneParts> for SentScene {
    type Error = SceneError;

    fn try_from((toml, text): SceneParts) -> Result<Self, SceneError> {
        let mut scene = Scene::from_toml(&toml)?;
        if let (Some(mesh), Some(text)) = (&mut scene.mesh, text) {
            mesh.element = mesh.element.or_else(|| Mesh::gmsh_element(&text));
            mesh.text = Some(text.into());
        }
        Ok(Self(scene))
    }
}

/// Computes the value of a scene in a thread, or in a worker of a web page.
pub(crate) fn work<F: Fact>(
    scene: SentScene,
    reporter: &Reporter<FactProgress<F::Value>, Computed<F::Value>>,
) -> Computed<F::Value> {
    let observe = |progress: Progress<'_>| reporter.report(FactProgress::Now(progress.fraction, progress.now.cloned()));
    // A cancellation is seen by the next report of progress.
    (F::COMPUTE)(&scene.0, &observe, &|value| _ = reporter.report(FactProgress::SoFar(value)))
}

type FactTask<F> = Task<FactProgress<<F as Fact>::Value>, Computed<<F as Fact>::Value>>;

/// Value of the scene that was last asked for, computed in the background.
pub(crate) struct Keyed<F: Fact> {
    /// Scene that was asked for, and its key.
    asked: Option<(Scene, Scene)>,
    /// Value of the scene that was asked for; `None` until it has been computed.
    computed: Option<Computed<F::Value>>,
    /// Value of the scene before.
    previous: Option<F::Value>,
    /// Running computation, and `true` if it is for the scene that was asked for. Only one runs at a time, so that edits
    /// do not pile up.
    running: Option<(FactTask<F>, bool)>,
    /// Fraction of the running computation that is done, what is computed now, and the value so far.
    done: (f64, Sentence),
    so_far: Option<F::Value>,
}

impl<F: Fact> Default for Keyed<F> {
    fn default() -> Self {
        Self { asked: None, computed: None, previous: None, running: None, done: Default::default(), so_far: None }
    }
}

impl<F: Fact> Keyed<F> {
    /// Returns the key of a scene, whose sections only read results.
    fn key(scene: &Scene) -> Scene {
        (F::KEY)(&Scene { sections: Vec::new(), ..scene.clone() })
    }

    /// Turns to a scene: if its key is another one, the computation for the scene before is cancelled.
    pub(crate) fn turn_to(&mut self, scene: &Scene) {
        if self.is_of(scene) {
            return;
        }
        let computed = self.computed.take().map(|computed| computed.ok().flatten());
        self.previous = computed.unwrap_or_else(|| self.previous.take());
        self.cancel();
        self.asked = Some((scene.clone(), Self::key(scene)));
    }

    /// Returns `true` if the scene has the key of the one that was last asked for.
    pub(crate) fn is_of(&self, scene: &Scene) -> bool {
        self.asked.as_ref().is_some_and(|(asked, key)| asked == scene || *key == Self::key(scene))
    }

    pub(crate) fn clear(&mut self) {
        (self.asked, self.computed, self.previous) = (None, None, None);
        self.cancel();
    }

    /// Stops the computation; the part of the value that has been computed is the value.
    pub(crate) fn stop(&mut self) {
        self.computed = Some(Ok(self.so_far.take()));
        self.cancel();
    }

    /// Turns to a scene whose value was computed elsewhere.
    pub(crate) fn set(&mut self, scene: &Scene, value: F::Value) {
        self.clear();
        self.turn_to(scene);
        self.computed = Some(Ok(Some(value)));
    }

    fn cancel(&mut self) {
        (self.done, self.so_far) = Default::default();
        if let Some((task, is_current)) = &mut self.running {
            *is_current = false;
            task.cancel();
        }
    }

    /// Turns to a scene, polls the computation, and starts it if the value is unknown. Returns `true` while it is pending.
    pub(crate) fn request(&mut self, scene: &Scene) -> bool {
        self.turn_to(scene);
        if self.computed.is_some() {
            return false;
        }
        if let Some((task, is_current)) = &self.running {
            let computed = loop {
                match task.poll() {
                    Update::Progress(_) if !*is_current => {}
                    Update::Progress(FactProgress::Now(done, now)) => {
                        self.done = (done, now.unwrap_or(std::mem::take(&mut self.done.1)));
                    }
                    Update::Progress(FactProgress::SoFar(value)) => self.so_far = Some(value),
                    Update::None => return true,
                    Update::Done(computed) => break computed,
                    Update::Died => break Err(sentence!("the computation ended unexpectedly")),
                }
            };
            if *is_current {
                (self.computed, self.so_far) = (Some(computed), None);
            }
            self.running = None;
        }
        if self.computed.is_none() {
            self.done = Default::default();
            match Task::run(F::NAME, SentScene(scene.clone()), work::<F>) {
                Ok(task) => self.running = Some((task, true)),
                Err(error) => self.computed = Some(Err(error.to_string().into())),
            }
        }
        true
    }

    /// Returns the fraction done, and what is computed now, while the value is being computed.
    pub(crate) fn progress(&self) -> Option<(f64, &Sentence)> {
        self.running.as_ref().map(|_| (self.done.0, &self.done.1))
    }

    /// Computes the value of a scene, and waits for it.
    pub(crate) fn wait(&mut self, scene: &Scene) {
        self.turn_to(scene);
        if self.computed.is_none() {
            self.computed = Some((F::COMPUTE)(scene, &|_| ControlFlow::Continue(()), &|_| ()));
            (self.running, self.so_far) = (None, None);
        }
    }

    /// Requests the value of a scene, or computes it and `waits`; returns `true` while it is pending.
    pub(crate) fn obtain(&mut self, scene: &Scene, waits: bool) -> bool {
        if waits {
            self.wait(scene);
        }
        !waits && self.request(scene)
    }

    fn computed(&self, scene: &Scene) -> Option<&Computed<F::Value>> {
        self.computed.as_ref().filter(|_| self.is_of(scene))
    }

    /// Returns the value of a scene, if it has been computed and the scene has one.
    pub(crate) fn get(&self, scene: &Scene) -> Option<&F::Value> {
        self.computed(scene)?.as_ref().ok()?.as_ref()
    }

    /// Returns the value of a scene, or the part of it that has been computed.
    pub(crate) fn so_far(&self, scene: &Scene) -> Option<&F::Value> {
        self.known().filter(|_| self.is_of(scene)).map(|(_, value)| value)
    }

    /// Returns the scene that was last asked for.
    pub(crate) fn asked(&self) -> Option<&Scene> {
        Some(&self.asked.as_ref()?.0)
    }

    /// Returns the scene that was last asked for, with its value or the part of it that has been computed.
    pub(crate) fn known(&self) -> Option<(&Scene, &F::Value)> {
        let computed = self.computed.as_ref().and_then(|computed| computed.as_ref().ok()?.as_ref());
        Some((self.asked()?, computed.or(self.so_far.as_ref())?))
    }

    /// Returns the reason why the value of a scene could not be computed.
    pub(crate) fn failure(&self, scene: &Scene) -> Option<&Sentence> {
        self.computed(scene)?.as_ref().err()
    }

    /// Returns the value, or that of the scene before until it has been computed.
    pub(crate) fn latest(&self) -> Option<&F::Value> {
        match &self.computed {
            Some(computed) => computed.as_ref().ok()?.as_ref(),
            None => self.previous.as_ref(),
        }
    }

    /// Returns `true` until the value of a scene has been computed.
    pub(crate) fn is_pending(&self, scene: &Scene) -> bool {
        self.computed(scene).is_none()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::thread;

    use super::*;
    use crate::app::session::facts::without_solver;
    use crate::scene::{open, registry};

    facts! {
        Length by without_solver = "length": f64, |scene, _, _| match &scene.beam {
            Some(beam) if beam.length > 100.0 => Err("too long".into()),
            Some(beam) if beam.length > 50.0 => std::panic::panic_any("meant"),
            beam => Ok(beam.as_ref().map(|beam| beam.length)),
        };
        /// The value of a beam of 2 m has a second part when its computation is cancelled.
        Parts = "parts": f64, |scene, observe, partial| {
            RUNNING.fetch_add(1, Ordering::Relaxed);
            partial(1.0);
            while scene.beam.as_ref().is_some_and(|beam| beam.length == 2.0) && observe(Progress::at(0.5)).is_continue() {
                thread::yield_now();
            }
            RUNNING.fetch_sub(1, Ordering::Relaxed);
            Ok(Some(2.0))
        };
    }
    static RUNNING: AtomicU32 = AtomicU32::new(0);

    #[test]
    fn the_previous_value_stays_until_the_next_is_known() {
        let [short, long] = [2.0, 3.0].map(|length| Scene::beam(length, 1.0));
        let mut length = Keyed::<Length>::default();
        length.wait(&short);
        assert_eq!((length.get(&short), length.latest()), (Some(&2.0), Some(&2.0)));
        assert_eq!(length.get(&long), None, "a value belongs to its scene");
        length.turn_to(&long);
        assert_eq!((length.get(&long), length.latest(), length.is_pending(&long)), (None, Some(&2.0), true));
        length.wait(&long);
        assert_eq!(length.latest(), Some(&3.0));
        // For a scene that has no value, the previous value is not returned either.
        let other = Scene { beam: None, ..short };
        length.wait(&other);
        assert_eq!((length.latest(), length.is_pending(&other)), (None, false));
    }

    #[test]
    fn scenes_with_the_same_key_share_a_value() {
        let scene = Scene::beam(2.0, 1.0);
        let mut length = Keyed::<Length>::default();
        length.wait(&scene);
        let mut other = scene.clone();
        other.solver.max_iterations += 1;
        let other = other.section([1.0, 0.0], 0.0);
        assert_eq!(length.get(&other), Some(&2.0));
        assert!(!length.request(&other));
    }

    /// A stopped computation is awaited before the next one starts: two at a time would slow each other down.
    #[test]
    fn a_stopped_computation_keeps_its_part() {
        let scene = Scene::beam(2.0, 1.0);
        let mut parts = Keyed::<Parts>::default();
        while parts.so_far(&scene).is_none() {
            assert!(parts.request(&scene));
        }
        parts.stop();
        assert!(!parts.request(&scene) && parts.get(&scene) == Some(&1.0));
        let other = Scene::beam(3.0, 1.0);
        while parts.request(&other) {
            assert!(RUNNING.load(Ordering::Relaxed) < 2);
        }
        assert_eq!(parts.get(&other), Some(&2.0));
    }

    #[test]
    fn a_failure_is_a_value_with_its_reason() {
        for (size, reason) in [(200.0, "too long"), (60.0, "the computation ended unexpectedly")] {
            let scene = Scene::beam(size, 1.0);
            let mut length = Keyed::<Length>::default();
            while length.request(&scene) {
                thread::yield_now();
            }
            assert_eq!(length.failure(&scene).map(ToString::to_string).as_deref(), Some(reason));
            assert_eq!((length.get(&scene), length.is_pending(&scene)), (None, false));
        }
    }

    /// Every built-in scene, with its mesh, arrives as it was sent.
    #[test]
    fn a_sent_scene_arrives_unchanged() {
        for built_in in registry::BUILT_IN {
            let scene = open(&Source { name: built_in.id.into(), assignments: Vec::new() }).unwrap();
            let parts = SceneParts::from(SentScene(scene.clone()));
            assert_eq!(SentScene::try_from(parts).unwrap().0, scene, "{}", built_in.id);
        }
    }
}
