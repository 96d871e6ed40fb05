//! Reference solution that follows a dragged load in a thread of its own. One load is solved at a time, and the newest is
//! next.

use crate::app::platform::IS_PAGE;
use crate::app::prelude::*;
use crate::app::session::facts::without_settings;
use crate::app::task::thread::{Reporter, Task, Update};
use crate::study::LiveReference;

/// Displacements of the first probe, m: of the body, and by linear theory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Compared {
    pub own: Option<Vector2<f64>>,
    pub linear: Option<Vector2<f64>>,
}

/// Returns the displacement of a body's first probe, m.
pub(crate) fn first_probe(body: &Simulation) -> Option<Vector2<f64>> {
    Some(body.problem().probes().first()?.mean(body.displacement()))
}

/// Reference solution under a load, and the displacements that it is compared with.
#[derive(Debug)]
pub(crate) struct Live {
    /// Scene without the settings on which the reference does not depend.
    key: Scene,
    pub reference: Reference,
    pub compared: Compared,
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
        let moved = self.compared.own.zip(first_probe(body)).map(|(asked, now)| (now - asked).norm());
        moved.is_some_and(|moved| moved > FAR * body.system().size())
    }
}

type LiveTask = Task<(), (Option<Box<LiveReference>>, Option<Box<Live>>)>;

/// Reference solution that follows the load.
#[derive(Debug, Default)]
pub(crate) struct Follower {
    /// Key of the scene that was solved last, or is being solved.
    asked: Option<Scene>,
    solutions: Option<Box<LiveReference>>,
    running: Option<LiveTask>,
    known: Option<Box<Live>>,
}

impl Follower {
    /// Returns the last reference; `None` if the last load has none that is found soon.
    pub(crate) fn known(&self) -> Option<&Live> {
        self.known.as_deref()
    }

    pub(crate) fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Takes the reference that has been found; returns `true` while one is pending.
    pub(crate) fn poll(&mut self) -> bool {
        let Some(task) = &self.running else { return false };
        match task.poll() {
            Update::None | Update::Progress(()) => return true,
            Update::Done(found) => (self.solutions, self.known) = found,
            Update::Died => self.known = None,
        }
        self.running = None;
        false
    }

    /// Requests the reference of a scene at rest; returns `true` while it is pending. A page has no thread for it: there
    /// the error is shown at rest.
    pub(crate) fn request(&mut self, scene: &Scene, compared: Compared) -> bool {
        if self.poll() {
            return true;
        }
        let key = without_settings(scene);
        if IS_PAGE || self.asked.as_ref() == Some(&key) {
            return false;
        }
        self.asked = Some(key.clone());
        let (scene, solutions) = (scene.clone(), self.solutions.take());
        let work = move |_: &Reporter<_, _>| {
            let solutions = solutions.filter(|solutions| solutions.suits(&scene));
            let mut solutions = solutions.or_else(|| LiveReference::new(&scene).map(Box::new));
            let reference = solutions.as_mut().and_then(|solutions| solutions.follow(&scene));
            (solutions, reference.map(|reference| Box::new(Live { key, reference, compared })))
        };
        self.running = Task::start("follow", work).ok();
        self.running.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_is_that_of_a_body_under_any_load() {
        let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]).probe("tip", "right");
        let (reference, compared) = (Reference::of(&scene).unwrap(), Compared::default());
        let live = Live { key: without_settings(&scene), reference, compared };
        let (mut heavier, mut longer) = (scene.clone(), scene);
        heavier.scale_loads(2.0);
        assert!(live.is_of_body(&heavier) && !live.is_of(&heavier));
        longer.beam.as_mut().unwrap().length = 20.0;
        assert!(!live.is_of_body(&longer));
    }
}
