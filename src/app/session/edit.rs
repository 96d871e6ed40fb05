//! Edits of a session: of its scene, its document and its file, each with undo.

use std::collections::VecDeque;

use super::*;
use crate::app::session::facts::Follower;
use crate::render::display_geometry::DisplayGeometry;
use crate::simulation::SimulationError;

/// Change of the model that can be undone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Edit {
    /// Change the scene with the control of this label. Edits with one control during one press are one undo step.
    Scene(&'static str, Box<Scene>),
    /// Open a scene in place of the current one.
    Open(Source),
    /// Replace the document, and the scene by one that may have been edited since the document was saved.
    Restore(Box<Version>),
    Undo,
    Redo,
}

/// Parts of the session that have changed since the window was last updated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Changed {
    pub scene: bool,
    pub mesh: bool,
    /// `true` if the scene comes from another document.
    pub document: bool,
    /// `true` if the mesh or the kind of analysis has changed, or an exploded motion has started again.
    pub restart: bool,
}

impl Session {
    /// Records the state of the pointer, see [`UndoHistory::record_press`].
    pub(crate) fn record_press(&mut self, now: f64, is_pressed: bool, goes_on: bool, double_click: f64) {
        self.frame.is_held = goes_on;
        self.undo.record_press(now, is_pressed, goes_on, double_click);
    }

    /// Applies an edit, and returns the parts that have changed, or the reason for which the session is unchanged. A large
    /// model is set up in the background: the display changes when it is solved, and its errors are reported as a [`Notice`].
    pub(crate) fn apply(&mut self, edit: Edit) -> Result<Changed, Sentence> {
        let before = self.present.clone();
        let has_exploded = self.is_motion() && matches!(self.model.simulation.status(), Status::Stopped(_));
        let (mut label, is_step) = (None, matches!(edit, Edit::Undo | Edit::Redo));
        let applied = match edit {
            Edit::Scene(control, scene) => {
                label = Some(control);
                self.set_scene(*scene)
            }
            Edit::Open(source) => {
                // A built-in scene keeps its edits. Chosen while it is the present scene, it is opened without them.
                let is_kept = source.built_in().is_some() && source != before.document.source;
                let earlier = self.undo.past.iter().rev().find(|version| version.document.source == source);
                let version = match earlier.filter(|_| is_kept).cloned() {
                    Some(version) => version,
                    None => {
                        let document = Document::open(source)?;
                        Version { scene: document.original.clone(), document }
                    }
                };
                self.replace(version)
            }
            Edit::Restore(version) => self.replace(*version),
            Edit::Undo => self.undo.undo(before.clone()).map_or(Ok(()), |step| self.go_to(step)),
            Edit::Redo => self.undo.redo(before.clone()).map_or(Ok(()), |step| self.go_to(step)),
        };
        applied.map_err(refusal)?;
        if !is_step && before != self.present {
            self.undo.record(before, label);
        }
        if label.is_some() {
            self.background.before.iter_mut().for_each(|before| before.label = label);
        }
        // With other settings an exploded body would still be kilometres long.
        if has_exploded && self.is_motion() {
            self.reset();
            self.changed.restart = true;
        }
        Ok(self.changed)
    }

    fn go_to(&mut self, step: Version) -> Result<(), SimulationError> {
        let is_same = step.document.source == self.present.document.source;
        if is_same { self.set_scene(step.scene) } else { self.replace(step) }
    }

    /// Changes the scene of the body, which continues from its current state if possible; an error leaves the session unchanged.
    pub(crate) fn set_scene(&mut self, scene: Scene) -> Result<(), SimulationError> {
        if self.is_for_background(&scene) {
            scene.validate()?;
            self.running |= !self.is_motion();
            self.request_scene(scene);
            self.poll();
            return Ok(());
        }
        let before = self.model.simulation.scene().clone();
        self.model.simulation.change_scene(&scene)?;
        let is_another_document = self.background.before.as_ref().is_some_and(|before| before.is_another_document);
        self.background = Background::default();
        if !has_mesh_of(&scene, &before) {
            self.model.geometry = Arc::new(DisplayGeometry::new(self.model.simulation.system().mesh()));
        }
        self.present.scene = scene;
        (self.frame.is_edited_now, self.running) = (true, self.running || !self.is_motion());
        self.scene_changed(&before);
        self.begin_accepted_at_rest();
        let known = self.model.linear.take();
        self.model.linear = solve_linear(self.model.simulation.scene(), self.model.simulation.system(), known);
        if is_another_document {
            self.start_document();
            self.reset();
        }
        Ok(())
    }

    /// Updates everything that depends on the simulation's scene after it has changed from `before`.
    pub(super) fn scene_changed(&mut self, before: &Scene) {
        self.changed.scene = true;
        self.fallback.keep(&self.model.simulation);
        let scene = self.model.simulation.scene();
        if scene == before {
            return;
        }
        self.frame.is_from_rest = false;
        let is_another_mesh = !has_mesh_of(scene, before);
        let is_another_body = is_another_mesh || scene.analysis != before.analysis;
        self.changed.mesh |= is_another_mesh;
        self.changed.restart |= is_another_body;
        self.playback.change_scene(&self.model.simulation, is_another_body);
        let facts = &mut self.facts;
        facts.reference.turn_to(scene);
        facts.path.turn_to(scene);
        facts.rho.turn_to(scene);
        facts.time.turn_to(scene);
        // A time step with other settings takes another time.
        let is_another_step = is_another_body || (&scene.dynamics, &scene.solver) != (&before.dynamics, &before.solver);
        if scene.analysis == Analysis::Dynamic && is_another_step {
            self.frame.timings = Timings::default();
        }
    }

    pub(crate) fn replace(&mut self, Version { document, scene }: Version) -> Result<(), SimulationError> {
        if self.is_for_background(&scene) {
            scene.validate()?;
            self.request_scene(scene);
            self.present.document = document;
            self.check_file();
            self.background.from_rest = true;
            self.background.before.iter_mut().for_each(|before| before.is_another_document = true);
            self.poll();
            return Ok(());
        }
        self.set_scene(scene)?;
        self.present.document = document;
        self.check_file();
        self.start_document();
        self.reset();
        Ok(())
    }

    /// Resets everything that belongs to the document to its default.
    pub(super) fn start_document(&mut self) {
        self.changed.document = true;
        self.running = true;
        self.playback = Playback::default();
        self.facts.live = Follower::default();
        self.frame.is_slow = false;
    }

    /// Makes the current scene the unedited scene of a document; the undo history is cleared.
    pub(crate) fn rebase(&mut self, source: Source) {
        self.present.document = Document::new(source, self.present.scene.clone());
        self.undo = UndoHistory::default();
        self.frame.is_slow = false;
    }

    /// Saves the scene to a file, which is the document from now on, or returns the reason for which that file is unchanged.
    /// Undo does not return to the previous file.
    pub(crate) fn save(&mut self, path: &Path) -> Result<(), Sentence> {
        let saved = self.present.document.save(&self.present.scene, path)?;
        let before = std::mem::replace(&mut self.present.document, saved);
        let in_background = self.background.before.iter_mut().map(|before| &mut before.version);
        let earlier = in_background.chain(self.undo.adjacent_versions(&before.source));
        for version in earlier.filter(|version| version.document.source == before.source) {
            version.document.clone_from(&self.present.document);
        }
        self.is_outdated = false;
        Ok(())
    }

    /// Checks whether the scene's file has changed on disk.
    pub(crate) fn check_file(&mut self) {
        self.is_outdated = self.present.document.has_changed();
    }

    /// Keeps the scene although its file has changed on disk, and stops reporting that change.
    pub(crate) fn ignore_file_change(&mut self) {
        self.present.document.text = self.present.document.read();
        self.is_outdated = false;
    }

    /// Returns the scene with load number `load` as in its document; `None` if the document has no load of the same
    /// kind with this number.
    pub(crate) fn with_original_load(&self, load: usize) -> Option<Scene> {
        let original = self.present.document.original.loads.get(load)?;
        let mut scene = self.present.scene.clone();
        let present = scene.loads.get_mut(load)?;
        if std::mem::discriminant(original) != std::mem::discriminant(present) {
            return None;
        }
        present.clone_from(original);
        Some(scene)
    }
}

/// Returns the name of the support or load that a key of a scene belongs to, with its number in the panel, or the key.
pub(crate) fn object_name(key: &str) -> String {
    let mut parts = key.split('.');
    match (parts.next(), parts.next().and_then(|i| i.parse::<usize>().ok())) {
        (Some("support"), Some(i)) => fill!("Support %{n}", n = i + 1),
        (Some("load"), Some(i)) => fill!("Load %{n}", n = i + 1),
        _ => key.to_owned(),
    }
}

/// Returns the reason for which an edit was refused, in the words of the panel.
fn refusal(error: SimulationError) -> Sentence {
    match error {
        SimulationError::Scene(invalid) if invalid.key == "support" => {
            sentence!("the body could move freely: supports must hold it along x, along y and against rotation")
        }
        SimulationError::Scene(invalid) => Sentence::located(object_name(&invalid.key), invalid.message.clone()),
        other => (&other).into(),
    }
}

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
