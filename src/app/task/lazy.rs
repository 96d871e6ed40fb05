//! Value that is computed in the background and invalidated by edits.

use std::ops::ControlFlow;

use crate::app::task::thread::{Task, Update};
use crate::scene::Scene;

/// Callback that receives the fraction done; it breaks to cancel.
pub(crate) type Watch<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Function that computes the value of a scene; `None` if the scene has none.
pub(crate) type Compute<T> = fn(&Scene, Watch<'_>) -> Option<T>;

/// Value of a scene, computed in the background; a scene may have none.
#[derive(Debug)]
pub(crate) struct Lazy<T> {
    compute: Compute<T>,
    /// Fraction of the current computation that is done.
    done: f64,
    /// Value of the current scene: `None` until it has been computed, `Some(None)` if the scene has none.
    value: Option<Option<T>>,
    /// Value of the previous scene.
    previous: Option<T>,
    /// Running computation, and `true` if it is for the current scene. Only one thread runs at a time, so that edits do
    /// not pile up.
    running: Option<(Task<f64, Option<T>>, bool)>,
}

impl<T: Send + 'static> Lazy<T> {
    pub(crate) fn new(compute: Compute<T>) -> Self {
        Self { compute, done: 0.0, value: None, previous: None, running: None }
    }

    /// Invalidates the value after an edit of the scene.
    pub(crate) fn invalidate(&mut self) {
        self.previous = self.value.take().unwrap_or_else(|| self.previous.take());
        if let Some((task, is_current)) = &mut self.running {
            (*is_current, self.done) = (false, 0.0);
            task.cancel();
        }
    }

    /// Forgets the value and the previous one.
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
            let (compute, scene) = (self.compute, scene.clone());
            self.done = 0.0;
            match Task::start("lazy value", move |reporter| compute(&scene, &mut |done| reporter.report(done))) {
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
            self.value = Some((self.compute)(scene, &mut |_| ControlFlow::Continue(())));
            self.running = None;
        }
    }

    /// Returns the value, if it has been computed and the scene has one.
    pub(crate) fn get(&self) -> Option<&T> {
        self.value.as_ref().and_then(Option::as_ref)
    }

    /// Returns the value, or the previous scene's value until it has been computed.
    pub(crate) fn latest(&self) -> Option<&T> {
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

    #[test]
    fn the_previous_value_stays_until_the_next_is_known() {
        let scene = Scene::beam(2.0, 1.0);
        let mut length = Lazy::new(|scene: &Scene, _| scene.beam.as_ref().map(|beam| beam.length));
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
