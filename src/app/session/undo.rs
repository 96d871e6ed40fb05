//! Undo history of the scene.

use std::collections::VecDeque;

use super::*;

/// Largest number of undo steps.
const MAX_STEPS: usize = 200;

/// Scene of an earlier state of the session, and its document.
#[derive(Clone, Debug, PartialEq)]
pub struct Version {
    pub(crate) document: Document,
    pub(crate) scene: Scene,
}

/// Steps that can be undone and redone.
#[derive(Debug, Default)]
pub struct UndoHistory {
    pub(super) past: VecDeque<Version>,
    future: Vec<Version>,
    /// Label of the control edited during the current press: further edits with it belong to the same step.
    edited: Option<&'static str>,
    /// Label of the control edited during the previous press, and the end of that press, s: both clicks of a double
    /// click are one step.
    before: Option<(&'static str, f64)>,
}

impl UndoHistory {
    /// Records the state of the pointer at the time `now`, s: edits during one press, or during both presses of a double
    /// click, which are at most `double_click` s apart, are one step. `is_pressed` is `true` in the frame in which a button goes
    /// down, `goes_on` from that frame to the one in which it is released.
    pub(crate) fn record_press(&mut self, now: f64, is_pressed: bool, goes_on: bool, double_click: f64) {
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

    /// Records that the scene has changed; `before` is the version before the change, and `label` names the control if
    /// a value was edited.
    pub(crate) fn record(&mut self, before: Version, label: Option<&'static str>) {
        self.future.clear();
        if label.is_some() && self.edited == label {
            return;
        }
        self.edited = label;
        if self.past.len() == MAX_STEPS {
            self.past.pop_front();
        }
        self.past.push_back(before);
    }

    /// Returns the version before the last step; `present` can then be redone.
    pub(crate) fn undo(&mut self, present: Version) -> Option<Version> {
        self.edited = None;
        // A drag that ended where it began has changed nothing.
        while self.past.back() == Some(&present) {
            self.past.pop_back();
        }
        let before = self.past.pop_back()?;
        self.future.push(present);
        Some(before)
    }

    /// Returns the version that was undone last.
    pub(crate) fn redo(&mut self, present: Version) -> Option<Version> {
        self.edited = None;
        let after = self.future.pop()?;
        self.past.push_back(present);
        Some(after)
    }

    /// Returns the versions before and after the present one up to the next document.
    pub(crate) fn adjacent_versions(&mut self, source: &Source) -> impl Iterator<Item = &mut Version> {
        let is_same = |version: &&mut Version| version.document.source == *source;
        let past = self.past.iter_mut().rev().take_while(is_same);
        past.chain(self.future.iter_mut().rev().take_while(is_same))
    }

    /// Removes the steps beyond the first `depth`; they cannot be redone.
    pub(crate) fn take_back(&mut self, depth: usize) {
        self.edited = None;
        self.past.truncate(depth);
    }

    /// Returns `true` if there is an edit to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Returns `true` if there is an undone edit to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snapshot(force: f64) -> Version {
        let scene = Scene::beam(3.0, 1.0).clamp("left").force("right", [force, 0.0]);
        let source = Source { name: "article".into(), assignments: Vec::new() };
        Version { document: Document::new(source, scene.clone()), scene }
    }

    #[test]
    fn steps_are_undone_and_redone_and_an_edit_clears_the_redo_steps() {
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
    fn a_rolled_back_edit_cannot_be_redone() {
        let mut edits = UndoHistory::default();
        (0..4).for_each(|force| edits.record(snapshot(f64::from(force)), None));
        edits.take_back(7);
        assert_eq!(edits.past.len(), 4);
        edits.take_back(2);
        assert!(!edits.can_redo());
        assert_eq!(edits.undo(snapshot(2.0)), Some(snapshot(1.0)));
    }

    #[test]
    fn edits_of_one_press_are_one_undo_step_and_the_history_is_bounded() {
        let mut edits = UndoHistory::default();
        for force in 0..5 {
            edits.record(snapshot(f64::from(force)), Some("Force"));
        }
        edits.record(snapshot(5.0), Some("Direction"));
        assert_eq!(edits.undo(snapshot(6.0)), Some(snapshot(5.0)));
        assert_eq!(edits.undo(snapshot(5.0)), Some(snapshot(0.0)));
        (0..3 * MAX_STEPS).for_each(|_| edits.record(snapshot(0.0), None));
        assert_eq!(edits.past.len(), MAX_STEPS);
    }
}
