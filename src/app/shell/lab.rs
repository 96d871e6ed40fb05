//! [`Lab`]: the complete content of a window. Window, screenshots and tests all show it through [`Lab::ui`].

use super::*;
use crate::app::modes::compare::{Compare, Pane, PaneSetting};
use crate::app::modes::learn::{self, Learn};
use crate::app::modes::measure::Measure;
use crate::app::modes::plots::SectionPlot;
use crate::app::session::Notice;
use crate::app::session::document::Document;
use crate::app::session::recovery::Unsaved;
use crate::app::shell::file_dialog::FileDialog;
use crate::app::shell::gallery::Gallery;
use crate::app::shell::settings::Settings;
use crate::app::viewport::camera_controller::Box2;
use crate::app::viewport::main_view::{CardContent, Content, MainView};
use crate::app::widgets::palette;
use crate::app::{ThemeChoice, language};
use crate::render::Frame;
use crate::simulation::SimulationError;
use crate::study::Study;

/// Request of the lab to the window that shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Save an image of the window.
    Screenshot,
    /// Close the window.
    Close,
    /// Remove the copy of unsaved edits left by a crashed window.
    DiscardCopy,
}

/// Model with its view and tools. The mode Learn has a desk of its own.
pub struct Desk {
    /// Model.
    pub session: Session,
    pub(crate) viewport: MainView,
    /// Display options.
    pub view: ViewOptions,
    pub(super) panel: PanelState,
    pub(super) compare: Compare,
    pub(super) measure: Measure,
    pub(super) sections: SectionPlot,
}

impl Desk {
    pub(super) fn new(session: Session) -> Self {
        Self {
            viewport: MainView::new(session.simulation().system().mesh()),
            view: ViewOptions::default(),
            panel: PanelState::default(),
            compare: Compare::new(session.is_motion()),
            measure: Measure::default(),
            sections: SectionPlot::default(),
            session,
        }
    }

    /// Returns `true` if the calculation or the motion that is shown has ended.
    pub(super) fn has_ended(&self) -> bool {
        match self.view.mode {
            Mode::Compare => !self.compare.goes_on(),
            _ => self.session.has_ended(),
        }
    }
}

/// Story while it is told.
pub(super) struct Story {
    /// Time of the start, s.
    pub start: Option<f64>,
    /// Index of the current part, and the time until its end, s.
    pub part: usize,
    pub left: f64,
    pub is_still: bool,
    /// `true` if the body is compared with the reference solution: under the scene's load.
    pub compares: bool,
    /// View options before the story.
    pub view: ViewOptions,
    /// The user's desk, if the story was started in Learn.
    pub aside: Option<Box<Desk>>,
}

/// Complete content of a window.
pub struct Lab {
    /// Desk of the scene, or of the mode Learn.
    pub desk: Desk,
    pub(super) learn: Learn,
    /// In Learn, the user's desk, which is restored when the mode ends.
    pub(super) aside: Option<Box<Desk>>,
    /// Story of the first start, while it is told.
    pub(super) story: Option<Box<Story>>,
    pub(super) dialog: Option<FileDialog>,
    /// Action that would lose unsaved edits, while the user is asked about them.
    pub(super) question: Option<Action>,
    /// Edits left by a crashed window, while they are offered.
    pub left: Option<Unsaved>,
    /// Requests to the window after this frame.
    pub(super) requests: Vec<Request>,
    /// Settings that neither the display options nor egui has.
    pub settings: Settings,
    /// Message, and the time until which it is shown, s.
    pub(super) toast: Option<(String, f64)>,
    /// Warnings, and the number of them that the user has closed.
    pub(super) warnings: Vec<String>,
    pub(super) closed_warnings: usize,
    pub(super) gallery: Gallery,
    /// `true` if an edit during the last [`Self::ui`] has left parts that show the scene before it, which are to be laid
    /// out again before they are displayed.
    pub is_mixed: bool,
}

impl Lab {
    /// Creates a lab with `scene`, iterating from rest.
    pub fn new(source: Source, scene: Scene, simulation: Simulation) -> Self {
        Self {
            desk: Desk::new(Session::new(source, scene, simulation)),
            learn: Learn::new(0),
            aside: None,
            story: None,
            dialog: None,
            question: None,
            left: None,
            requests: Vec::new(),
            settings: Settings::default(),
            toast: None,
            warnings: Vec::new(),
            closed_warnings: 0,
            gallery: Gallery::default(),
            is_mixed: false,
        }
    }

    /// Creates a lab that shows the first built-in scene until `scene`, which is large, has been meshed in the
    /// background; `None` if the built-in scene cannot be shown.
    pub(crate) fn opening(source: Source, scene: Scene) -> Option<Self> {
        let (own, meanwhile) = built_in(registry::DEFAULT)?;
        let mut simulation = Simulation::new(&meanwhile).ok()?;
        simulation.solve();
        let mut lab = Self::new(own, meanwhile, simulation);
        let session = &mut lab.desk.session;
        if let Err(error) = session.replace(Unsaved { document: Document::new(source, scene.clone()), scene }) {
            session.notices.push(Notice { label: None, message: (&error).into() });
        }
        Some(lab)
    }

    /// Returns `true` if motions are compared; the body of Explore is then paused.
    pub(super) fn compares_motions(&self) -> bool {
        self.desk.view.mode == Mode::Compare && self.desk.session.is_motion()
    }

    /// Iterates to equilibrium, or as far as a displayed frame has time, if the lab runs; or makes the time steps that are due
    /// at `now`, s (any clock that runs in real time). Returns `true` if more remain.
    pub fn advance(&mut self, now: f64) -> bool {
        if self.story.is_some() {
            self.advance_story(now);
        } else if self.compares_motions() {
            let Desk { session, compare, .. } = &mut self.desk;
            session.poll();
            session.playback.clock.rest();
            compare.advance_motions(session, now);
        } else if self.desk.session.advance(now) {
            self.learn.line = learn::UNTIL;
        }
        self.apply_session_changes();
        self.story.is_some() || self.iterates()
    }

    /// Returns `true` if the next frame changes the body.
    pub fn iterates(&self) -> bool {
        if self.compares_motions() {
            return self.desk.session.is_running() && self.desk.compare.goes_on() && !self.desk.compare.is_timing;
        }
        self.desk.session.iterates()
    }

    /// Iterates until the status is final, or to the end of the motion's duration, and computes all displayed results.
    pub fn solve(&mut self) {
        let has_search = *self.simulation().status() == Status::Running;
        let learns_rho = self.learns_rho();
        self.desk.session.solve(learns_rho);
        self.apply_session_changes();
        let Desk { session, view, compare, measure, sections, .. } = &mut self.desk;
        measure.obtain(session, view, false, true);
        if session.is_motion() {
            return;
        }
        if view.drawer == Some(Drawer::Section) {
            sections.wait(session.simulation());
        }
        if view.mode == Mode::Compare {
            compare.solve_to_end(session, view.layout.bars);
        }
        if has_search {
            self.learn.line = learn::UNTIL;
        }
    }

    /// Returns the desk of the user's scene, which Learn puts aside; `None` while the story is told on it.
    pub(super) fn own_desk(&self) -> Option<&Desk> {
        let aside = self.story.as_ref().map_or(&self.aside, |story| &story.aside);
        aside.as_deref().or_else(|| self.story.is_none().then_some(&self.desk))
    }

    /// Returns `true` if a card of Learn shows ρ at the equilibrium.
    pub(super) fn learns_rho(&self) -> bool {
        self.aside.is_some() && self.learn.shows_rho()
    }

    pub(super) fn content(&self) -> Content<'_> {
        let Self { desk: Desk { session, view, panel, .. }, learn, aside, .. } = self;
        content(session, view, panel, aside.is_some().then_some(learn))
    }

    pub(super) fn viewport_and_content(&mut self) -> (&mut MainView, Content<'_>) {
        let Self { desk: Desk { session, viewport, view, panel, .. }, learn, aside, .. } = self;
        (viewport, content(session, view, panel, aside.is_some().then_some(learn)))
    }

    // Read and set by the window, screenshots, recordings and tests.

    /// Shows card `number` of the mode Learn, from 1. The current scene is restored when the mode ends.
    pub fn show_card(&mut self, number: usize) {
        if self.aside.is_some() {
            self.go_to_card(number.saturating_sub(1));
        } else {
            self.learn.go_to(number.saturating_sub(1));
            self.desk.view.mode = Mode::Learn;
            self.enter_or_leave();
        }
    }

    /// Returns the number of the displayed card, from 1, and the number of cards; `None` in other modes.
    pub fn card(&self) -> Option<(usize, usize)> {
        self.aside.as_ref().map(|_| (self.learn.card + 1, learn::CARDS.len()))
    }

    /// Shows a speed–accuracy study in the mode Measure.
    pub fn show_study(&mut self, study: Study) {
        self.show_tab(MeasureTab::HowFast);
        self.desk.measure.budget.set(self.desk.session.scene(), study);
    }

    /// Shows a tab of the mode Measure.
    pub fn show_tab(&mut self, tab: MeasureTab) {
        (self.desk.view.mode, self.desk.view.tab) = (Mode::Measure, tab);
    }

    /// Shows two to four panes side by side under the same load, one per setting. Does nothing for a motion.
    pub fn show_comparison(&mut self, settings: &[PaneSetting]) {
        if self.desk.session.is_motion() {
            return;
        }
        self.desk.view.mode = Mode::Compare;
        self.desk.compare.set(settings);
    }

    /// Returns the panes that are compared.
    pub fn panes(&self) -> &[Pane] {
        &self.desk.compare.panes
    }

    /// Returns the study of the scene, if there is one, and `true` if measurements are in progress.
    pub fn study(&self) -> (Option<&Study>, bool) {
        (self.desk.measure.budget.study(), self.desk.measure.budget.runs())
    }

    /// Returns the camera that shows a box, m, and the linear solution, in a view of size `view`, points.
    pub(crate) fn fit(&self, whole: Box2, view: [f64; 2]) -> Camera {
        self.desk.viewport.fitted(&self.content(), whole, view)
    }

    /// Returns the scene with its edits.
    pub fn scene(&self) -> &Scene {
        self.desk.session.scene()
    }

    /// Returns the displayed simulation.
    pub fn simulation(&self) -> &Simulation {
        self.desk.session.simulation()
    }

    /// Returns the area of the view in the window, points.
    pub fn view_rect(&self) -> Rect {
        self.desk.viewport.view.rect
    }

    /// Returns the tips of the load arrows in the window, points, with the index of each load in the scene.
    pub fn arrow_tips(&self) -> Vec<(usize, Pos2)> {
        let arrows = self.desk.viewport.arrows(&self.content());
        arrows.iter().map(|arrow| (arrow.load, arrow.tip())).collect()
    }

    /// Returns the start points of force arrows, and the centres of moment arrows, in the window, points.
    pub fn arrow_feet(&self) -> Vec<Pos2> {
        self.desk.viewport.arrows(&self.content()).iter().map(|arrow| arrow.from).collect()
    }

    /// Returns the camera of the last [`Self::ui`].
    pub fn camera(&self) -> Camera {
        match self.desk.view.mode {
            Mode::Compare => self.desk.compare.camera(),
            _ => self.desk.viewport.camera.shown,
        }
    }

    /// Returns the title of the window: the scene's name, an asterisk if it has been edited, and the name of its file.
    pub fn title(&self) -> String {
        let session = &self.desk.session;
        let edited = if session.is_edited() && self.story.is_none() { "*" } else { "" };
        language::speak(self.settings.language);
        let file = session.document().path().and_then(Path::file_name);
        let file = file.map_or_else(String::new, |file| format!(" ({})", file.to_string_lossy()));
        format!("{}{edited}{file} \u{2013} warpbeam", tr(&session.scene().name))
    }

    /// Turns the animation of the camera on, as in a window, or off, as in images.
    pub fn set_easing(&mut self, eases: bool) {
        self.desk.viewport.eases = eases;
    }

    /// Returns the pinned material point, whose values are shown over the body.
    pub fn probed(&self) -> Option<MaterialPoint> {
        self.desk.viewport.probe
    }

    /// Changes the scene of the body, which continues from its current state if possible. A large model is set up in
    /// the background; errors of its mesh are shown later as a message.
    ///
    /// # Errors
    /// [`SimulationError`]; the lab is unchanged.
    pub fn set_scene(&mut self, scene: Scene) -> Result<(), SimulationError> {
        self.desk.session.set_scene(scene)?;
        self.apply_session_changes();
        Ok(())
    }

    /// Returns `true` while a displayed result of the scene is being computed in the background.
    pub fn is_computing(&self) -> bool {
        let Desk { session, view, measure, .. } = &self.desk;
        let (facts, scene) = (&session.facts, session.scene());
        let plots = view.drawer == Some(Drawer::Section) && self.desk.sections.is_pending();
        let at_rest = facts.reference.is_pending(scene) || facts.path.is_pending(scene) || facts.time.is_pending(scene);
        let at_rest = at_rest || (self.learns_rho() || session.lacks_rho()) && facts.rho.is_pending(scene);
        let at_rest = !session.is_motion() && at_rest;
        let measures = measure.is_pending(scene, view);
        session.is_working() || session.facts.certifying.is_some() || plots || measures || at_rest
    }

    /// Restores the saved settings.
    pub fn set_settings(&mut self, ctx: &Context, settings: Settings) {
        palette::install(ctx);
        if let Some(theme) = settings.theme {
            ctx.set_theme(egui::Theme::from(theme));
        }
        let view = &mut self.desk.view;
        view.layout.panel = settings.panel;
        let scene = self.desk.session.scene();
        view.drawer = settings.drawer.filter(|drawer| *drawer == Drawer::of(scene));
        view.color_with(settings.color());
        self.settings = settings;
        if let Some(path) = self.desk.session.document().path() {
            self.settings.add_recent(path);
        }
    }

    /// Returns the settings to be saved.
    pub fn settings(&self, ctx: &Context) -> Settings {
        let theme = match ctx.options(|options| options.theme_preference) {
            egui::ThemePreference::Dark => Some(ThemeChoice::Dark),
            egui::ThemePreference::Light => Some(ThemeChoice::Light),
            egui::ThemePreference::System => None,
        };
        let mut settings = self.settings.clone();
        settings.theme = theme;
        // The cards of Learn and the story have view options of their own, which are not saved.
        if let Some(view) = self.own_desk().map(|desk| &desk.view) {
            (settings.panel, settings.drawer) = (view.layout.panel, view.drawer);
            settings.set_color(view.field);
        }
        settings
    }

    /// Returns the input of the body's render pass, as of the last [`Self::ui`].
    pub fn frame(&self) -> Frame<'_> {
        self.desk.viewport.view.body.frame(self.desk.view.lines.wireframe)
    }

    /// Returns the displayed bodies, as of the last [`Self::ui`], at this number of pixels per point.
    pub(crate) fn views(&self, pixels_per_point: f32) -> Vec<View<'_>> {
        let Desk { viewport, view: ViewOptions { mode, lines, .. }, compare, .. } = &self.desk;
        match mode {
            Mode::Compare => compare.views(lines.wireframe, pixels_per_point),
            _ => vec![viewport.view.view(viewport.camera.shown, lines.wireframe, pixels_per_point)],
        }
    }
}

fn content<'a>(
    session: &'a Session,
    options: &'a ViewOptions,
    panel: &PanelState,
    learn: Option<&'a Learn>,
) -> Content<'a> {
    Content {
        session,
        options,
        direction: panel.force_direction(),
        card: learn.map(|learn| CardContent { is_apart: learn.is_apart(), reach: learn.reach.as_ref() }),
    }
}
