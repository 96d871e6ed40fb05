//! What takes a while to find out of a scene, found beside the window.

use std::ops::ControlFlow;

use egui::Context;

use crate::app::task::thread::{Heard, Job, LISTEN};
use crate::scene::Scene;

/// Is told the fraction that is done, and calls the search off.
pub(crate) type Watch<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Search for something that a scene may or may not have.
pub(crate) type Search<T> = fn(&Scene, Watch<'_>) -> Option<T>;

/// Something that a scene may or may not have.
#[derive(Debug)]
pub(crate) struct Finder<T> {
    find: Search<T>,
    /// Fraction of the present search that is done.
    done: f64,
    /// Of the present scene: not known yet, or what was found.
    found: Option<Option<T>>,
    /// What was found of the scene before.
    before: Option<T>,
    /// What the thread will say, and whether it is of the present scene. One thread at a time: edits do not pile up.
    running: Option<(Job<f64, Option<T>>, bool)>,
}

impl<T: Send + 'static> Finder<T> {
    /// Nothing known yet.
    pub(crate) fn new(find: Search<T>) -> Self {
        Self { find, done: 0.0, found: None, before: None, running: None }
    }

    /// Forgets what belonged to another scene.
    pub(crate) fn forget(&mut self) {
        self.before = self.found.take().unwrap_or_else(|| self.before.take());
        if let Some((job, current)) = &mut self.running {
            (*current, self.done) = (false, 0.0);
            job.call_off();
        }
    }

    /// Hears what has been found, and starts to look where nothing is known; `ctx` is asked to come back.
    pub(crate) fn ask(&mut self, scene: &Scene, ctx: &Context) {
        if self.found.is_some() {
            return;
        }
        if let Some((job, current)) = &self.running {
            let found = loop {
                match job.hear() {
                    Heard::News(done) => self.done = if *current { done } else { 0.0 },
                    Heard::Nothing => {
                        ctx.request_repaint_after(LISTEN);
                        return;
                    }
                    Heard::Done(found) => break found,
                    Heard::Died => break None,
                }
            };
            if *current {
                self.found = Some(found);
            }
            self.running = None;
        }
        if self.found.is_none() {
            let (find, scene) = (self.find, scene.clone());
            self.done = 0.0;
            match Job::start("finder", move |line| find(&scene, &mut |done| line.say(done))) {
                Ok(job) => self.running = Some((job, true)),
                Err(_) => self.found = Some(None),
            }
            ctx.request_repaint_after(LISTEN);
        }
    }

    /// Fraction that is done, while it is being computed.
    pub(crate) fn progress(&self) -> Option<f64> {
        self.running.as_ref().map(|_| self.done)
    }

    /// Finds out, however long it takes.
    pub(crate) fn settle(&mut self, scene: &Scene) {
        if self.found.is_none() {
            self.found = Some((self.find)(scene, &mut |_| ControlFlow::Continue(())));
            self.running = None;
        }
    }

    /// What was found.
    pub(crate) fn get(&self) -> Option<&T> {
        self.found.as_ref().and_then(Option::as_ref)
    }

    /// What was found; while nothing is known yet, what was found of the scene before.
    pub(crate) fn latest(&self) -> Option<&T> {
        self.found.as_ref().map_or(self.before.as_ref(), Option::as_ref)
    }

    /// Whether nothing is known yet.
    pub(crate) fn is_open(&self) -> bool {
        self.found.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_found_before_stays_until_the_next_is_known() {
        let scene = Scene::beam(2.0, 1.0);
        let mut finder = Finder::new(|scene: &Scene, _| scene.beam.as_ref().map(|beam| beam.length));
        finder.settle(&scene);
        assert_eq!((finder.get(), finder.latest()), (Some(&2.0), Some(&2.0)));
        finder.forget();
        finder.forget();
        assert_eq!((finder.get(), finder.latest(), finder.is_open()), (None, Some(&2.0), true));
        finder.settle(&Scene::beam(3.0, 1.0));
        assert_eq!(finder.latest(), Some(&3.0));
        // What is known not to be has nothing of before.
        finder.forget();
        finder.settle(&Scene { beam: None, ..scene });
        assert_eq!((finder.latest(), finder.is_open()), (None, false));
    }
}
