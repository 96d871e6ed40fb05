//! The lab: everything that a window shows. Window, screenshots and tests show it through [`Lab::ui`].

use std::path::Path;

use egui::Rect;
use nalgebra::Vector2;

use crate::app::ThemeChoice;
use crate::app::language::{self, Language, tr};
use crate::app::modes::budget::Budget;
use crate::app::modes::compare::{Compare, MotionCompare, MotionPane, Pane, PaneInput, PaneSetting};
use crate::app::modes::learn::{self, Learn};
use crate::app::panel::PanelState;
use crate::app::readout::Readout;
use crate::app::session::document::Document;
use crate::app::session::recovery::Unsaved;
use crate::app::session::{Notice, Session};
use crate::app::shell::file_dialog::FileDialog;
use crate::app::shell::gallery::Gallery;
use crate::app::shell::intro::Intro;
use crate::app::shell::settings::Settings;
use crate::app::view_options::{Drawer, Mode, ViewOptions};
use crate::app::viewport::handle::Handle;
use crate::app::viewport::view::{CardContent, Content, Viewport};
use crate::app::widgets::load_scale::OpeningLoads;
use crate::app::widgets::palette;
use crate::mesh::MaterialPoint;
use crate::render::{Camera, Frame, View};
use crate::scene::{IntegratorKind, Scene, Source};
use crate::simulation::{Simulation, SimulationError};
use crate::state::State;
use crate::study::{MotionStudy, Study};

/// Requests of the lab to the window that shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Save a picture.
    Screenshot,
    /// Close the window.
    Close,
    /// Remove the copy of unsaved edits that a crashed window has left.
    ForgetCopy,
    /// Record the window, or end the recording.
    Record,
    /// Record the scene from its start, or end that recording.
    RecordScene,
}

/// A model with its view and its tools. Learn has one of its own.
#[derive(Debug)]
pub(super) struct Desk {
    pub session: Session,
    pub viewport: Viewport,
    pub view: ViewOptions,
    pub panel: PanelState,
    pub budget: Budget,
    pub compare: Compare,
    pub motions: MotionCompare,
}

impl Desk {
    pub(super) fn new(session: Session) -> Self {
        Self {
            viewport: Viewport::new(session.simulation().system().mesh()),
            session,
            view: ViewOptions::default(),
            panel: PanelState::default(),
            budget: Budget::default(),
            compare: Compare::default(),
            motions: MotionCompare::default(),
        }
    }

    /// The input of the panes of Compare.
    pub(super) fn pane_input<'a>(
        session: &'a Session,
        view: &'a ViewOptions,
        panel: &PanelState,
        eases: bool,
    ) -> PaneInput<'a> {
        PaneInput {
            scene: session.scene(),
            view,
            direction: panel.force_direction(),
            opening: OpeningLoads::of(&session.document().original),
            eases,
        }
    }
}

/// The mode Learn while it is shown.
#[derive(Debug)]
pub(super) struct Lesson {
    pub learn: Learn,
    /// The user's desk, which comes back at the end.
    pub aside: Desk,
}

/// Request that would lose the edits.
#[derive(Clone, Debug)]
pub(super) enum Departure {
    Close,
    Open(Source),
    AskForFile,
}

/// State of the question.
#[derive(Debug, Default)]
pub(super) enum Question {
    #[default]
    None,
    /// The question is shown.
    Asked(Departure),
    /// "Save" was answered, and the dialog asks for a file.
    Saving(Departure),
}

/// Everything that a window shows.
#[derive(Debug)]
pub struct Lab {
    pub(super) desk: Desk,
    pub(super) lesson: Option<Box<Lesson>>,
    /// The card that was shown last, from 0.
    pub(super) card: usize,
    pub(super) intro: Option<Intro>,
    pub(super) dialog: Option<FileDialog>,
    /// Question about unsaved edits.
    pub(super) question: Question,
    /// Edits that a crashed window has left, while they are offered.
    pub(super) left: Option<Unsaved>,
    /// `true` once the window is to close.
    pub(super) closes: bool,
    pub(super) settings: Settings,
    /// Name of the graphics adapter.
    pub(super) adapter: String,
    /// A message, and the time until which it is shown, s.
    pub(super) toast: Option<(String, f64)>,
    /// Progress of the scene's recording, while it is made.
    pub(super) recording: Option<String>,
    pub(super) gallery: Gallery,
}

impl Lab {
    /// A lab with this scene, iterating from rest.
    #[must_use]
    pub fn new(source: Source, scene: Scene, simulation: Simulation) -> Self {
        Self {
            desk: Desk::new(Session::new(source, scene, simulation)),
            lesson: None,
            card: 0,
            intro: None,
            dialog: None,
            question: Question::None,
            left: None,
            closes: false,
            settings: Settings::default(),
            adapter: String::new(),
            toast: None,
            recording: None,
            gallery: Gallery::default(),
        }
    }

    /// A lab that shows the first built-in scene until this one, which is large, has been meshed in the background;
    /// `None` if the built-in scene cannot be shown.
    pub(crate) fn opening(source: Source, scene: Scene) -> Option<Self> {
        let (own, meanwhile) = learn::article()?;
        let mut simulation = Simulation::new(&meanwhile).ok()?;
        simulation.solve();
        let mut lab = Self::new(own, meanwhile, simulation);
        let session = &mut lab.desk.session;
        if let Err(error) = session.replace(Document::new(source, scene.clone()), scene) {
            session.notify(Notice::Rejected { label: None, message: error.to_string() });
        }
        Some(lab)
    }

    /// Sets the name of the graphics adapter.
    pub fn set_adapter(&mut self, adapter: String) {
        self.adapter = adapter;
    }

    /// Shows or hides the panel and the bars: without them the view is all of the picture.
    pub fn set_panel(&mut self, shown: bool) {
        self.desk.view.bars = shown;
    }

    /// Animates the growth of the load when the window opens. Nothing waits for it, and any input ends it.
    pub(crate) fn introduce(&mut self) {
        self.intro = Intro::new(self.desk.session.simulation());
    }

    /// Shows the load curve under the body.
    pub fn show_curve(&mut self) {
        self.desk.view.drawer = Some(Drawer::Curve);
    }

    /// Shows the plots of a motion under the body.
    pub fn show_motion_plots(&mut self) {
        self.desk.view.drawer = Some(Drawer::Motion);
    }

    /// Shows a card of the mode Learn, which count from 1. The present scene comes back at the end of the mode.
    pub fn show_card(&mut self, number: usize) {
        let card = number.saturating_sub(1).min(learn::CARDS.len() - 1);
        if self.lesson.is_some() {
            self.go_to_card(card);
        } else {
            self.card = card;
            self.desk.view.mode = Mode::Learn;
            self.enter_or_leave();
        }
    }

    /// The number of the card that is shown, from 1, and of how many; `None` in other modes.
    #[must_use]
    pub fn card(&self) -> Option<(usize, usize)> {
        self.lesson.as_ref().map(|_| (self.card + 1, learn::CARDS.len()))
    }

    /// Shows a study under the body.
    pub fn show_study(&mut self, study: Study) {
        if self.lesson.is_none() {
            self.desk.view.mode = Mode::Budget;
        }
        self.desk.budget.set(self.desk.session.scene(), study);
    }

    /// Shows panes side by side, one a setting, under the same load: two to four. A scene in motion is not compared so.
    pub fn show_comparison(&mut self, settings: &[PaneSetting]) {
        if self.desk.session.is_motion() {
            return;
        }
        self.desk.view.mode = Mode::Compare;
        self.desk.compare.set(settings);
    }

    /// The panes that are compared.
    #[must_use]
    pub fn panes(&self) -> &[Pane] {
        self.desk.compare.panes()
    }

    /// The panes in which motions are compared.
    #[must_use]
    pub fn motion_panes(&self) -> &[MotionPane] {
        self.desk.motions.panes()
    }

    /// `true` if motions are compared: the body of Explore waits.
    pub(super) fn compares_motions(&self) -> bool {
        self.desk.view.mode == Mode::Compare && self.desk.session.is_motion()
    }

    /// Equilibria that the comparison has traced under the present kind of load: the setting; the load, and both components
    /// of the first probe's displacement, m.
    #[must_use]
    pub fn traced(&self) -> Vec<(PaneSetting, [f64; 3])> {
        self.desk.compare.traced()
    }

    /// The measurements of the scene, and `true` if more are being made.
    #[must_use]
    pub fn study(&self) -> (Option<&Study>, bool) {
        (self.desk.budget.study(), self.desk.budget.runs())
    }

    /// Measurements of the scene's motion.
    #[must_use]
    pub fn motion_study(&self) -> Option<&MotionStudy> {
        self.desk.budget.motion_study()
    }

    /// Iterations a displayed frame.
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.desk.session.iterations()
    }

    /// Displays a state; returns `false` if it does not fit the mesh.
    pub(crate) fn restore(&mut self, state: &State) -> bool {
        self.desk.session.restore(state)
    }

    /// Fixes the camera and the range of colours.
    pub(crate) fn fix_view(&mut self, camera: Camera, range: [f64; 2]) {
        self.desk.viewport.look(camera);
        self.desk.view.fixed_range = Some(range);
    }

    /// Returns the camera that shows a box, m, and the linear solution, in a view of this size, points.
    pub(crate) fn fit(&self, low: Vector2<f64>, high: Vector2<f64>, view: [f64; 2]) -> Camera {
        self.desk.viewport.fitted(&self.content(), low, high, view)
    }

    /// Shows or hides the outlines at rest and of the linear solution.
    pub fn set_outlines(&mut self, shown: bool) {
        let view = &mut self.desk.view;
        (view.rest_outline, view.ghost, view.exact) = (shown, shown, shown);
    }

    /// The scene, with its edits.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        self.desk.session.scene()
    }

    /// Place that the scene comes from.
    pub(crate) fn source(&self) -> &Source {
        &self.desk.session.document().source
    }

    /// The displayed simulation.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        self.desk.session.simulation()
    }

    /// Linear theory's solution of the scene, where there is one.
    #[must_use]
    pub fn linear(&self) -> Option<&Simulation> {
        self.desk.session.linear()
    }

    /// Displacement of the linear solution, m, where there is one.
    #[must_use]
    pub fn linear_displacement(&self) -> Option<&[Vector2<f64>]> {
        self.linear().map(Simulation::displacement)
    }

    /// The view's place in the window, points.
    #[must_use]
    pub fn view_rect(&self) -> Rect {
        self.desk.viewport.rect()
    }

    /// Tips of the loads' arrows in the window, points, with the number of each among the scene's loads.
    #[must_use]
    pub fn arrow_tips(&self) -> Vec<(usize, egui::Pos2)> {
        let arrows = self.desk.viewport.arrows(&self.content());
        arrows.iter().map(|arrow| (arrow.load(), arrow.tip())).collect()
    }

    /// Feet of the arrows of forces, and centres of those of moments, in the window, points.
    #[must_use]
    pub fn arrow_feet(&self) -> Vec<egui::Pos2> {
        self.desk.viewport.arrows(&self.content()).iter().map(Handle::foot).collect()
    }

    /// The camera of the last [`Self::ui`].
    #[must_use]
    pub fn camera(&self) -> Camera {
        match self.desk.view.mode {
            Mode::Compare if self.desk.session.is_motion() => self.desk.motions.camera(),
            Mode::Compare => self.desk.compare.camera(),
            _ => self.desk.viewport.camera(),
        }
    }

    /// Title of the window: the scene's name, a star where it has been edited, and the name of its file.
    #[must_use]
    pub fn title(&self) -> String {
        let session = &self.desk.session;
        let edited = if session.is_edited() { "*" } else { "" };
        language::speak(self.settings.language);
        let file = session.document().path().and_then(Path::file_name);
        let file = file.map_or_else(String::new, |file| format!(" ({})", file.to_string_lossy()));
        format!("{}{edited}{file} \u{2013} warpbeam", tr(&session.scene().name))
    }

    /// Makes the iterations of one displayed frame if it runs, or the time steps that are due at `now`, s of any clock
    /// that goes with real time; returns `true` if there are others to make.
    pub fn advance(&mut self, now: f64) -> bool {
        if self.compares_motions() {
            let Desk { session, motions, .. } = &mut self.desk;
            session.poll();
            session.rest();
            motions.advance(session.scene(), now, session.is_running());
        } else if self.desk.session.advance(now) {
            self.show_last_line();
        }
        self.iterates()
    }

    /// Lights up the last line of the pseudocode, after an iteration.
    pub(super) fn show_last_line(&mut self) {
        if let Some(lesson) = &mut self.lesson {
            lesson.learn.line = learn::UNTIL;
        }
    }

    /// `true` if the next frame changes the body.
    #[must_use]
    pub fn iterates(&self) -> bool {
        if self.compares_motions() {
            return self.desk.session.is_running() && self.desk.motions.moves();
        }
        self.desk.session.iterates()
    }

    /// Makes iterations, or one time step.
    pub(crate) fn iterate(&mut self, iterations: u32) {
        self.desk.session.iterate(iterations);
        if !self.desk.session.is_motion() {
            self.show_last_line();
        }
    }

    /// Iterates to the end, or to the end of the motion's duration, and computes everything that is shown of the result.
    pub fn solve(&mut self) {
        let Desk { session, view, compare, .. } = &mut self.desk;
        session.solve(view.drawer == Some(Drawer::Curve));
        if session.is_motion() {
            return;
        }
        if let Some(lesson) = &mut self.lesson {
            lesson.learn.settle(session.scene());
        }
        if view.mode == Mode::Compare {
            compare.settle(session.scene(), session.simulation().system());
        }
        self.show_last_line();
    }

    /// `true` if there is an edit to undo.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.desk.session.can_undo()
    }

    /// `true` if there is an undone edit to do again.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.desk.session.can_redo()
    }

    /// Lets the camera move smoothly, as in a window, or at once, as in pictures.
    pub fn set_easing(&mut self, eases: bool) {
        self.desk.viewport.set_easing(eases);
    }

    /// The material point whose values are shown over the body.
    #[must_use]
    pub fn probed(&self) -> Option<MaterialPoint> {
        self.desk.viewport.probe()
    }

    /// Sets the size, in unknowns, above which a model is meshed and solved in the background.
    pub fn set_most_unknowns(&mut self, most: f64) {
        self.desk.session.set_most_unknowns(most);
    }

    /// `true` while a model is meshed or solved in the background.
    #[must_use]
    pub fn is_working(&self) -> bool {
        self.desk.session.is_working()
    }

    /// Changes the scene under the body, which continues from its present state if it can. A large model is set up in the
    /// background; errors of its mesh are shown then.
    ///
    /// # Errors
    /// [`SimulationError`]; the lab is unchanged.
    pub fn set_scene(&mut self, scene: Scene) -> Result<(), SimulationError> {
        self.desk.session.set_scene(scene)?;
        self.follow_session();
        Ok(())
    }

    /// Shows the same motion under another integrator as an outline, or no longer.
    pub fn compare_with(&mut self, integrator: IntegratorKind) {
        self.desk.session.toggle_companion(integrator);
    }

    /// Sets the speed of a motion, simulated seconds per second: 1, or slow motion.
    pub fn set_speed(&mut self, speed: f64) {
        self.desk.session.set_speed(speed);
    }

    /// `true` while something that is shown of the scene is being computed in the background.
    #[must_use]
    pub fn is_searching(&self) -> bool {
        let Desk { session, view, .. } = &self.desk;
        let facts = session.facts();
        let plots = match view.drawer {
            Some(Drawer::Curve) => facts.curve.is_pending(),
            Some(Drawer::Motion) => facts.frequency.is_pending(),
            _ => false,
        };
        let learns = self.lesson.as_ref().is_some_and(|lesson| lesson.learn.is_looking());
        let at_rest = !session.is_motion() && (facts.reference.is_pending() || facts.jump.is_pending());
        session.is_working() || plots || learns || at_rest
    }

    /// Restores the saved settings.
    pub fn set_settings(&mut self, ctx: &egui::Context, settings: Settings) {
        palette::install(ctx);
        if let Some(theme) = settings.theme {
            ctx.set_theme(egui::Theme::from(theme));
        }
        let view = &mut self.desk.view;
        view.panel = settings.panel;
        view.drawer = settings.drawer;
        view.color_with(settings.color());
        self.settings = settings;
        if let Some(path) = self.desk.session.document().path() {
            self.settings.add_recent(path);
        }
    }

    /// Sets the language of every text.
    pub fn set_language(&mut self, language: Language) {
        self.settings.language = language;
    }

    /// The language of every text.
    #[must_use]
    pub fn language(&self) -> Language {
        self.settings.language
    }

    /// Notes the size of the window, points.
    pub fn set_window_size(&mut self, size: [f32; 2]) {
        self.settings.set_size(size);
    }

    /// The settings to be saved.
    #[must_use]
    pub fn settings(&self, ctx: &egui::Context) -> Settings {
        let theme = match ctx.options(|options| options.theme_preference) {
            egui::ThemePreference::Dark => Some(ThemeChoice::Dark),
            egui::ThemePreference::Light => Some(ThemeChoice::Light),
            egui::ThemePreference::System => None,
        };
        // The cards have a view of their own, which is not saved.
        let desk = self.lesson.as_ref().map_or(&self.desk, |lesson| &lesson.aside);
        let ViewOptions { panel, drawer, field, .. } = desk.view;
        let mut settings = self.settings.clone();
        (settings.theme, settings.panel, settings.drawer) = (theme, panel, drawer);
        settings.set_color(field);
        settings
    }

    /// The drawn body, as of the last [`Self::ui`].
    #[must_use]
    pub fn frame(&self) -> Frame<'_> {
        self.desk.viewport.frame(&self.content())
    }

    /// The drawn bodies, as of the last [`Self::ui`], at this number of pixels a point.
    pub(crate) fn views(&self, pixels_per_point: f32) -> Vec<View<'_>> {
        let Desk { view, session, compare, motions, .. } = &self.desk;
        match view.mode {
            Mode::Compare if session.is_motion() => motions.views(view.wireframe, pixels_per_point),
            Mode::Compare => compare.views(view.wireframe, pixels_per_point),
            _ => vec![self.desk.viewport.view(&self.content(), pixels_per_point)],
        }
    }

    /// Shows the progress of the scene's recording; `None` once it has ended.
    pub(crate) fn show_recording(&mut self, progress: Option<String>) {
        self.recording = progress;
    }

    /// Everything that the view of the body shows.
    pub(super) fn content(&self) -> Content<'_> {
        let Self { desk: Desk { session, view, panel, .. }, intro, lesson, .. } = self;
        content(session, view, panel, intro.as_ref(), lesson.as_deref())
    }

    /// The view of the body, and everything that it shows.
    pub(super) fn viewport_and_content(&mut self) -> (&mut Viewport, Content<'_>) {
        let Self { desk: Desk { session, viewport, view, panel, .. }, intro, lesson, .. } = self;
        (viewport, content(session, view, panel, intro.as_ref(), lesson.as_deref()))
    }

    /// The state that bars, panel and cards show.
    pub(super) fn readout(&self) -> Readout<'_> {
        let Desk { session, viewport, view, compare, motions, .. } = &self.desk;
        let facts = session.facts();
        Readout {
            reference: facts.reference.get(),
            jump: facts.jump.get(),
            equilibrium_rho: self.lesson.as_ref().and_then(|lesson| lesson.learn.rho()),
            quality: session.quality(),
            reference_progress: facts.reference.progress(),
            shows_converged: viewport.shows_converged(),
            scene: session.scene(),
            original: &session.document().original,
            scene_name: session.document().source.name.to_str().unwrap_or_default(),
            simulation: session.simulation(),
            linear: session.linear(),
            running: session.is_running(),
            ended: match view.mode {
                Mode::Compare if session.is_motion() => !motions.moves(),
                Mode::Compare => !compare.is_iterating(),
                _ => session.has_ended(),
            },
            playback: session.playback(),
            frequency: facts.frequency.latest().copied(),
            iterations: session.iterations(),
            timings: session.timings(),
            residuals: session.residuals(),
            can_undo: session.can_undo(),
            can_redo: session.can_redo(),
            adapter: &self.adapter,
            language: self.settings.language,
        }
    }
}

fn content<'a>(
    session: &'a Session,
    options: &'a ViewOptions,
    panel: &PanelState,
    intro: Option<&'a Intro>,
    lesson: Option<&'a Lesson>,
) -> Content<'a> {
    Content {
        session,
        options,
        direction: panel.force_direction(),
        animation: intro.map(|intro| (intro.simulation(), intro.linear())),
        card: lesson
            .map(|lesson| CardContent { is_apart: lesson.learn.is_apart(), reach: lesson.learn.reach.as_ref() }),
    }
}
