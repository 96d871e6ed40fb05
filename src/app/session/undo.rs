//! What has been done to the scene, so that it can be undone.

use std::collections::VecDeque;

use crate::app::session::document::Document;
use crate::scene::Scene;

/// So many steps are remembered.
const MOST: usize = 200;

/// A scene as it was, and where it came from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Version {
    pub document: Document,
    pub scene: Scene,
    /// Iterations a displayed frame.
    pub iterations: u32,
}

/// The pointer in one frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Press {
    /// Time, s.
    pub now: f64,
    /// `true` in the frame in which a button goes down.
    pub is_pressed: bool,
    /// `true` from the frame in which a button goes down to the one in which it comes up.
    pub goes_on: bool,
    /// Longest time between the presses of a double click, s.
    pub double_click: f64,
}

/// The steps that can be undone and done again.
#[derive(Debug, Default)]
pub(crate) struct UndoHistory {
    past: VecDeque<Version>,
    future: Vec<Version>,
    /// What the present press has edited: to edit it again is the same step.
    edited: Option<&'static str>,
    /// What the press before has edited, and when that was over, s: both clicks of a double click are one step.
    before: Option<(&'static str, f64)>,
}

impl UndoHistory {
    /// Follows the pointer: edits of one press, or of both presses of a double click, are one step.
    pub(crate) fn follow_press(&mut self, press: Press) {
        let Press { now, is_pressed, goes_on, double_click } = press;
        if goes_on && !is_pressed {
            return;
        }
        if let Some(label) = self.edited.take() {
            self.before = Some((label, now));
        }
        if is_pressed {
            self.edited = self.before.take().filter(|(_, over)| now - over <= double_click).map(|(label, _)| label);
        }
    }

    /// The scene is no longer as it was `before`; `label` says what was edited, if it was a value.
    pub(crate) fn record(&mut self, before: Version, label: Option<&'static str>) {
        self.future.clear();
        if label.is_some() && self.edited == label {
            return;
        }
        self.edited = label;
        if self.past.len() == MOST {
            self.past.pop_front();
        }
        self.past.push_back(before);
    }

    /// The step before the present one, which can be done again then.
    pub(crate) fn undo(&mut self, present: Version) -> Option<Version> {
        self.edited = None;
        // A drag that came back to where it began has changed nothing.
        while self.past.back() == Some(&present) {
            self.past.pop_back();
        }
        let before = self.past.pop_back()?;
        self.future.push(present);
        Some(before)
    }

    /// The step that was undone last.
    pub(crate) fn redo(&mut self, present: Version) -> Option<Version> {
        self.edited = None;
        let after = self.future.pop()?;
        self.past.push_back(present);
        Some(after)
    }

    /// Steps that can be undone.
    pub(crate) fn depth(&self) -> usize {
        self.past.len()
    }

    /// Forgets what has been done since there were so many steps, for good.
    pub(crate) fn take_back(&mut self, depth: usize) {
        self.edited = None;
        self.past.truncate(depth);
    }

    pub(crate) fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    pub(crate) fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Source;

    fn snapshot(force: f64) -> Version {
        let scene = Scene::beam(3.0, 1.0).clamp("left").force("right", [force, 0.0]);
        let source = Source { name: "article".into(), assignments: Vec::new() };
        Version { document: Document::new(source, scene.clone()), scene, iterations: 1 }
    }

    #[test]
    fn steps_are_undone_and_done_again_and_an_edit_forgets_those_undone() {
        let mut edits = UndoHistory::default();
        assert_eq!(edits.undo(snapshot(0.0)), None);
        edits.record(snapshot(0.0), None);
        edits.record(snapshot(1.0), None);
        assert_eq!(edits.undo(snapshot(2.0)), Some(snapshot(1.0)));
        assert_eq!(edits.redo(snapshot(1.0)), Some(snapshot(2.0)));
        assert_eq!(edits.undo(snapshot(2.0)), Some(snapshot(1.0)));
        assert_eq!(edits.undo(snapshot(1.0)), Some(snapshot(0.0)));
        assert!(!edits.can_undo() && edits.can_redo());
        edits.record(snapshot(0.0), None);
        assert!(edits.can_undo() && !edits.can_redo());
    }

    #[test]
    fn what_is_taken_back_cannot_be_done_again() {
        let mut edits = UndoHistory::default();
        (0..4).for_each(|force| edits.record(snapshot(f64::from(force)), None));
        edits.take_back(7);
        assert_eq!(edits.depth(), 4);
        edits.take_back(2);
        assert!(!edits.can_redo());
        assert_eq!(edits.undo(snapshot(2.0)), Some(snapshot(1.0)));
    }

    #[test]
    fn what_one_press_edits_is_one_step_and_the_past_is_bounded() {
        let mut edits = UndoHistory::default();
        for force in 0..5 {
            edits.record(snapshot(f64::from(force)), Some("Force"));
        }
        edits.record(snapshot(5.0), Some("Direction"));
        assert_eq!(edits.undo(snapshot(6.0)), Some(snapshot(5.0)));
        assert_eq!(edits.undo(snapshot(5.0)), Some(snapshot(0.0)));
        (0..3 * MOST).for_each(|_| edits.record(snapshot(0.0), None));
        assert_eq!(edits.past.len(), MOST);
    }
}
