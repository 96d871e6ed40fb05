//! A value that is computed in the background and invalidated by edits.

use std::ops::ControlFlow;

use crate::app::task::thread::{Task, Update};
use crate::scene::Scene;

/// Receives the fraction that is done; breaks to cancel.
pub(crate) type Watch<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Computes a value that a scene may or may not have.
pub(crate) type Compute<T> = fn(&Scene, Watch<'_>) -> Option<T>;

/// A value that a scene may or may not have, computed in the background.
#[derive(Debug)]
pub(crate) struct Lazy<T> {
    compute: Compute<T>,
    /// Fraction of the present computation that is done.
    done: f64,
    /// Value of the present scene: `None` while it is not known, `Some(None)` if the scene has none.
    value: Option<Option<T>>,
    /// Value of the previous scene.
    previous: Option<T>,
    /// The computation, and `true` if it is of the present scene. One thread at a time: edits do not pile up.
    running: Option<(Task<f64, Option<T>>, bool)>,
}

impl<T: Send + 'static> Lazy<T> {
    pub(crate) fn new(compute: Compute<T>) -> Self {
        Self { compute, done: 0.0, value: None, previous: None, running: None }
    }

    /// Forgets the value, which was another scene's.
    pub(crate) fn invalidate(&mut self) {
        self.previous = self.value.take().unwrap_or_else(|| self.previous.take());
        if let Some((task, is_current)) = &mut self.running {
            (*is_current, self.done) = (false, 0.0);
            task.cancel();
        }
    }

    /// Polls the computation, and starts it where the value is not known. Returns `true` while it is pending.
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

    /// Fraction that is done, while the value is being computed.
    pub(crate) fn progress(&self) -> Option<f64> {
        self.running.as_ref().map(|_| self.done)
    }

    /// Computes the value, however long it takes.
    pub(crate) fn wait(&mut self, scene: &Scene) {
        if self.value.is_none() {
            self.value = Some((self.compute)(scene, &mut |_| ControlFlow::Continue(())));
            self.running = None;
        }
    }

    /// The value, once it is known.
    pub(crate) fn get(&self) -> Option<&T> {
        self.value.as_ref().and_then(Option::as_ref)
    }

    /// The value; the previous scene's while it is not known.
    pub(crate) fn latest(&self) -> Option<&T> {
        self.value.as_ref().map_or(self.previous.as_ref(), Option::as_ref)
    }

    /// `true` while the value is not known.
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
        // A scene without the value has no previous one either.
        length.invalidate();
        length.wait(&Scene { beam: None, ..scene });
        assert_eq!((length.latest(), length.is_pending()), (None, false));
    }
}
