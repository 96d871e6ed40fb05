//! Value that is computed in the background and invalidated by edits.

use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use crate::app::task::sent_scene::SentScene;
use crate::app::task::thread::{Data, Reporter, Task, Update, Work};
use crate::scene::Scene;

/// Callback that receives the fraction done; it breaks to cancel.
pub(crate) type Watch<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Kind of value of a scene that is computed in the background.
pub(crate) trait Fact: Debug + 'static {
    /// Name of the computation.
    const NAME: &'static str;
    type Value: Data + Debug;

    /// Computes the value of a scene; `None` if the scene has none.
    fn compute(scene: &Scene, watch: Watch<'_>) -> Option<Self::Value>;
}

/// Defines kinds of values, each by its name, its type and the function that computes it.
macro_rules! facts {
    ($($(#[$about:meta])* $kind:ident = $name:literal: $value:ty, $compute:expr;)*) => {$(
        $(#[$about])*
        #[derive(Debug)]
        pub(crate) struct $kind;

        impl $crate::app::task::lazy::Fact for $kind {
            const NAME: &'static str = $name;
            type Value = $value;

            fn compute(
                scene: &$crate::scene::Scene,
                watch: $crate::app::task::lazy::Watch<'_>,
            ) -> Option<$value> {
                let compute: fn(&$crate::scene::Scene, $crate::app::task::lazy::Watch<'_>) -> Option<$value> = $compute;
                compute(scene, watch)
            }
        }
    )*};
}
pub(crate) use facts;

/// Request for a value.
#[derive(Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct FactWork<F>(SentScene, PhantomData<fn() -> F>);

impl<F: Fact> Work for FactWork<F> {
    const NAME: &'static str = F::NAME;
    type Progress = f64;
    type Output = Option<F::Value>;

    fn run(self, reporter: &Reporter<f64, Self::Output>) -> Self::Output {
        F::compute(&self.0.0, &mut |done| reporter.report(done))
    }
}

/// Running computation of a value.
type FactTask<F> = Task<f64, Option<<F as Fact>::Value>>;

/// Value of a scene, computed in the background; a scene may have none.
#[derive(Debug)]
pub(crate) struct Lazy<F: Fact> {
    /// Fraction of the current computation that is done.
    done: f64,
    /// Value of the current scene: `None` until it has been computed, `Some(None)` if the scene has none.
    value: Option<Option<F::Value>>,
    /// Value of the previous scene.
    previous: Option<F::Value>,
    /// Running computation, and `true` if it is for the current scene. Only one thread runs at a time, so that edits do
    /// not pile up.
    running: Option<(FactTask<F>, bool)>,
}

impl<F: Fact> Default for Lazy<F> {
    fn default() -> Self {
        Self { done: 0.0, value: None, previous: None, running: None }
    }
}

impl<F: Fact> Lazy<F> {
    /// Invalidates the value after an edit of the scene.
    pub(crate) fn invalidate(&mut self) {
        self.previous = self.value.take().unwrap_or_else(|| self.previous.take());
        if let Some((task, is_current)) = &mut self.running {
            (*is_current, self.done) = (false, 0.0);
            task.cancel();
        }
    }

    /// Removes the value and the previous one.
    pub(crate) fn clear(&mut self) {
        self.invalidate();
        self.previous = None;
    }

    /// Polls the computation, and starts it if the value is unknown. Returns `true` while it is pending.
    pub(crate) fn request(&mut self, scene: &Scene) -> bool {
        if self.value.is_some() {
            return false;
        }
        if let Some((task, is_current)) = &self.running {
            let value = loop {
                match task.poll() {
                    Update::Progress(done) => self.done = if *is_current { done } else { 0.0 },
                    Update::None => return true,
                    Update::Done(value) => break value,
                    Update::Died => break None,
                }
            };
            if *is_current {
                self.value = Some(value);
            }
            self.running = None;
        }
        if self.value.is_none() {
            self.done = 0.0;
            match Task::run(FactWork::<F>(SentScene(scene.clone()), PhantomData)) {
                Ok(task) => self.running = Some((task, true)),
                Err(_) => self.value = Some(None),
            }
        }
        true
    }

    /// Returns the fraction done while the value is being computed.
    pub(crate) fn progress(&self) -> Option<f64> {
        self.running.as_ref().map(|_| self.done)
    }

    /// Computes the value, and waits for it.
    pub(crate) fn wait(&mut self, scene: &Scene) {
        if self.value.is_none() {
            self.value = Some(F::compute(scene, &mut |_| ControlFlow::Continue(())));
            self.running = None;
        }
    }

    /// Returns the value, if it has been computed and the scene has one.
    pub(crate) fn get(&self) -> Option<&F::Value> {
        self.value.as_ref().and_then(Option::as_ref)
    }

    /// Returns the value, or the previous scene's value until it has been computed.
    pub(crate) fn latest(&self) -> Option<&F::Value> {
        self.value.as_ref().map_or(self.previous.as_ref(), Option::as_ref)
    }

    /// Returns `true` until the value has been computed.
    pub(crate) fn is_pending(&self) -> bool {
        self.value.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    facts! {
        Length = "length": f64, |scene, _| scene.beam.as_ref().map(|beam| beam.length);
    }

    #[test]
    fn the_previous_value_stays_until_the_next_is_known() {
        let scene = Scene::beam(2.0, 1.0);
        let mut length = Lazy::<Length>::default();
        length.wait(&scene);
        assert_eq!((length.get(), length.latest()), (Some(&2.0), Some(&2.0)));
        length.invalidate();
        length.invalidate();
        assert_eq!((length.get(), length.latest(), length.is_pending()), (None, Some(&2.0), true));
        length.wait(&Scene::beam(3.0, 1.0));
        assert_eq!(length.latest(), Some(&3.0));
        // For a scene that has no value, the previous value is not returned either.
        length.invalidate();
        length.wait(&Scene { beam: None, ..scene });
        assert_eq!((length.latest(), length.is_pending()), (None, false));
    }
}
