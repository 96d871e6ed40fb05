//! The lab: a scene, its simulation, and how it is looked at. Window, shot and tests show it through [`Lab::ui`].

use crate::app::widgets::text::boxed_text;
use std::path::Path;
use std::time::Duration;

use egui::{CentralPanel, Color32, Panel, Rect, Sense, Ui};
use nalgebra::Vector2;

use crate::app::ThemeChoice;
use crate::app::action::{Action, MOST_ITERATIONS};
use crate::app::diagnosis::{self, Errors};
use crate::app::language::{self, Language, fill, spaced, tr, translated};
use crate::app::modes::budget::{Budget, question};
use crate::app::modes::compare::{Compare, CompareInput, MotionCompare, MotionPane, Pane, PaneInput, PaneSetting};
use crate::app::modes::explore::load_curve::Curve;
use crate::app::modes::explore::{figure, load_curve, motion_plot};
use crate::app::modes::learn::{self, Learn, Shown, Start};
use crate::app::panel::{self, PanelState};
use crate::app::readout::Readout;
use crate::app::session::document::Document;
use crate::app::session::playback::Playback;
use crate::app::session::quality::Quality;
use crate::app::session::recovery::Unsaved;
use crate::app::session::undo::{Edits, Snapshot};
use crate::app::shell::file_dialog::{Answer, FileDialog, Purpose};
use crate::app::shell::gallery::Gallery;
use crate::app::shell::intro::Intro;
use crate::app::shell::settings::Settings;
use crate::app::shell::{help, shortcuts, status_bar, toolbar};
use crate::app::task::lazy::{Finder, Watch};
use crate::app::task::solve::{Start as Beginning, note_residual, solve_linear};
use crate::app::task::thread::LISTEN;
use crate::app::view_options::Drawer;
use crate::app::view_options::Mode;
use crate::app::view_options::Toggle;
use crate::app::view_options::ViewOptions;
use crate::app::viewport::arrow::{Forces, vector};
use crate::app::viewport::body_mesh::Shape;
use crate::app::viewport::camera_controller::Eye;
use crate::app::viewport::crossing::passes_through_itself;
use crate::app::viewport::handle::{Handle, Pull};
use crate::app::viewport::overlay::{self, Overlay};
use crate::app::viewport::pointer::{Body, Look, Pointer, Reach, Wish};
use crate::app::viewport::projection::Projection;
use crate::app::viewport::projection::viewport;
use crate::app::viewport::{probe, time_line};
use crate::app::widgets::load_scale::OpeningLoads;
use crate::app::widgets::palette::{self, Palette};
use crate::assembly::Mass;
use crate::dynamics::lowest_frequency;
use crate::mesh::MaterialPoint;
use crate::render::display_geometry::Drawing;
use crate::render::{Camera, Frame, Margins, View};
use crate::scene::{IntegratorKind, Load, MethodKind, Scene, SceneError, Source};
use crate::simulation::{Field, PointValues, Simulation, SimulationError, Status};
use crate::state::State;
use crate::study::{Effort, Extent, LoadPath, MotionStudy, PathSummary, Reference, Study};
use crate::timings::Timings;
use crate::words;

mod beside;
mod unsaved;

use beside::Beside;
use unsaved::{Departure, Question};

/// Width of the panel, points.
pub const PANEL_WIDTH: f32 = 284.0;

/// A window narrower than this, points, has no place for the panel: it lies over the body, and can be put away.
const NARROW: f32 = 900.0;

/// Height of the bar along the bottom, points.
const HEADLINE_HEIGHT: f32 = 42.0;

/// Points kept free around the body when the view is fitted: room for the load's arrow, the key above, the legend below.
const FIT_MARGINS: Margins = Margins { sides: 76.0, top: 84.0, bottom: 152.0 };
/// The same over a card, which leaves less of the view.
const CARD_MARGINS: Margins = Margins { sides: 76.0, top: 74.0, bottom: 44.0 };
/// The same beside a colour bar at the top.
const BESIDE_MARGINS: Margins = Margins { sides: 284.0, top: 40.0, bottom: 30.0 };
/// The same over anything else that leaves less of the view: the status stands in it.
const LOW_MARGINS: Margins = Margins { bottom: 84.0, ..CARD_MARGINS };

/// Height of what is shown under the body, points; at most a part of the window's.
const DRAWER_HEIGHT: f32 = 270.0;
const DRAWER_SHARE: f32 = 0.45;

/// How long a message stays.
const TOAST: Duration = Duration::from_secs(4);

/// What the lab asks of the window that shows it.
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

/// Everything the window shows.
#[derive(Debug)]
pub struct Lab {
    document: Document,
    /// What is wanted: what is shown, but for a large body that is on its way.
    scene: Scene,
    /// What can be undone.
    edits: Edits,
    /// What is shown; a copy of it while it is being solved beside the window.
    simulation: Simulation,
    /// The same scene under linear theory; `None` where it could not be set up.
    linear: Option<Simulation>,
    beside: Beside,
    running: bool,
    view: ViewOptions,
    panel: PanelState,
    eye: Eye,
    /// What it keeps free around the body.
    margins: Margins,
    /// Whether the view takes its time on the way to where it looks.
    eases: bool,
    view_rect: Rect,
    pointer: Pointer,
    /// The material point whose values are shown.
    probe: Option<MaterialPoint>,
    /// The file that is asked for.
    dialog: Option<FileDialog>,
    /// Question about unsaved edits.
    question: Question,
    /// Edits that a crashed window has left, while they are offered.
    left: Option<Unsaved>,
    /// `true` once the window is to close.
    closes: bool,
    /// Whether the scene's file has been written by somebody else.
    is_outdated: bool,
    settings: Settings,
    adapter: String,
    toast: Option<(String, f64)>,
    drawing: Drawing,
    shape: Shape,
    /// What errors are measured against; looked for when the body has come to rest.
    truth: Finder<Reference>,
    curve: Finder<Curve>,
    /// Where the body jumps on its way from rest.
    jump: Finder<PathSummary>,
    budget: Budget,
    compare: Compare,
    /// The comparison of motions.
    motions: MotionCompare,
    /// The lowest natural frequency, Hz.
    frequency: Finder<f64>,
    playback: Playback,
    /// Last equilibrium, shown in the place of what diverges.
    converged: Option<Simulation>,
    /// `true` while it is.
    shows_converged: bool,
    /// Of a body in motion: all that it has swept, m.
    swept: Option<[Vector2<f64>; 2]>,
    /// Checks of the outline for crossings.
    crossing: Crossing,
    /// Progress of the scene's recording, while it is made.
    recording: Option<String>,
    gallery: Gallery,
    quality: Quality,
    /// Iterations a displayed frame.
    iterations: u32,
    /// Time of the last iterations made for one displayed frame.
    timings: Timings,
    /// The residual after every iteration since the last change.
    residuals: Vec<f64>,
    /// The first seconds, while they last.
    intro: Option<Intro>,
    /// The cards, in the mode that has them.
    learn: Option<Box<Learn>>,
    /// The card that was shown last, from 0.
    card: usize,
}

/// Checks of the body's outline: whether a crossing was reported, when the last check was, s, and which shape it saw.
#[derive(Debug, Default)]
struct Crossing {
    is_said: bool,
    checked: f64,
    stamp: u64,
}

/// Why a scene is not shown.
#[derive(Debug, thiserror::Error)]
enum OpenError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

impl Lab {
    /// A lab with this scene, iterating from rest.
    #[must_use]
    pub fn new(source: Source, scene: Scene, simulation: Simulation) -> Self {
        let drawing = Drawing::new(simulation.system().mesh());
        let (low, high) = simulation.system().mesh().bounds();
        let mut lab = Self {
            document: Document::new(source, scene.clone()),
            linear: None,
            scene,
            edits: Edits::default(),
            simulation,
            beside: Beside::default(),
            running: true,
            view: ViewOptions::default(),
            panel: PanelState::default(),
            eye: Eye::new([low, high]),
            margins: FIT_MARGINS,
            eases: false,
            view_rect: Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1.0, 1.0)),
            pointer: Pointer::default(),
            probe: None,
            dialog: None,
            question: Question::None,
            left: None,
            closes: false,
            is_outdated: false,
            settings: Settings::default(),
            adapter: String::new(),
            toast: None,
            drawing,
            shape: Shape::default(),
            truth: Finder::new(find_reference),
            curve: Finder::new(|scene, _| Curve::of(scene)),
            jump: Finder::new(|scene, _| LoadPath::summary_of(scene)),
            budget: Budget::default(),
            compare: Compare::default(),
            motions: MotionCompare::default(),
            frequency: Finder::new(|scene, _| natural_frequency(scene)),
            playback: Playback::default(),
            converged: None,
            shows_converged: false,
            swept: None,
            crossing: Crossing::default(),
            recording: None,
            gallery: Gallery::default(),
            quality: Quality::default(),
            iterations: 1,
            timings: Timings::default(),
            residuals: Vec::new(),
            intro: None,
            learn: None,
            card: 0,
        };
        lab.solve_linear();
        lab
    }

    /// A lab that shows the first of the built-in scenes until this one, which is large, has been meshed beside the
    /// window; `None` where that cannot be shown.
    pub(crate) fn opening(source: Source, scene: Scene) -> Option<Self> {
        let (own, meanwhile) = learn::article()?;
        let mut simulation = Simulation::new(&meanwhile).ok()?;
        simulation.solve();
        let mut lab = Self::new(own, meanwhile, simulation);
        if let Err(error) = lab.adopt(Document::new(source, scene.clone()), scene) {
            lab.beside.unsaid = Some(error.to_string());
        }
        Some(lab)
    }

    /// Names what draws the lab.
    pub fn set_adapter(&mut self, adapter: String) {
        self.adapter = adapter;
    }

    /// Shows or hides the panel and the bars: without them the view is all of the picture.
    pub fn set_panel(&mut self, shown: bool) {
        self.view.bars = shown;
    }

    /// Lets the load grow before the eyes of who opens the window: nothing waits for it, and any input ends it.
    pub(crate) fn introduce(&mut self) {
        self.intro = Intro::new(&self.simulation);
    }

    /// Shows the load curve under the body.
    pub fn show_curve(&mut self) {
        self.view.drawer = Some(Drawer::Curve);
    }

    /// Shows a card of the mode Learn, which count from 1; the lab as it is comes back at the end of the mode.
    pub fn show_card(&mut self, number: usize) {
        let card = number.saturating_sub(1).min(learn::CARDS.len() - 1);
        if self.learn.is_some() {
            self.go_to_card(card);
        } else {
            self.card = card;
            self.view.mode = Mode::Learn;
            self.enter_or_leave();
        }
    }

    /// The number of the card that is shown, from 1, and of how many; `None` in other modes.
    #[must_use]
    pub fn card(&self) -> Option<(usize, usize)> {
        self.learn.as_ref().map(|_| (self.card + 1, learn::CARDS.len()))
    }

    /// How it is looked at.
    pub(crate) fn view(&self) -> &ViewOptions {
        &self.view
    }

    /// Shows a study under the body.
    pub fn show_study(&mut self, study: Study) {
        if self.learn.is_none() {
            self.view.mode = Mode::Budget;
        }
        self.budget.set(&self.scene, study);
    }

    /// Shows panes side by side, one a setting, under the same load: two to four. Nothing happens in motion.
    pub fn show_comparison(&mut self, settings: &[PaneSetting]) {
        if self.moves() {
            return;
        }
        self.view.mode = Mode::Compare;
        self.compare.set(settings);
    }

    /// The panes that are compared.
    #[must_use]
    pub fn panes(&self) -> &[Pane] {
        self.compare.panes()
    }

    /// The panes in which motions are compared.
    #[must_use]
    pub fn motion_panes(&self) -> &[MotionPane] {
        self.motions.panes()
    }

    /// `true` if motions are compared: the body of Explore waits.
    fn compares_motions(&self) -> bool {
        self.view.mode == Mode::Compare && self.moves()
    }

    /// Equilibria that the comparison has traced under the present kind of load: the setting; the load, and both components
    /// of the first probe's displacement, m.
    #[must_use]
    pub fn traced(&self) -> Vec<(PaneSetting, [f64; 3])> {
        self.compare.traced()
    }

    /// What has been measured of the scene, and whether more is being measured.
    #[must_use]
    pub fn study(&self) -> (Option<&Study>, bool) {
        (self.budget.study(), self.budget.runs())
    }

    /// Measurements of the scene's motion.
    #[must_use]
    pub fn motion_study(&self) -> Option<&MotionStudy> {
        self.budget.motion_study()
    }

    /// Iterations a displayed frame.
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    /// Shows the body in a state of its own, if it is one.
    pub(crate) fn restore(&mut self, state: &State) -> bool {
        self.simulation.restore(state).is_ok()
    }

    /// Looks through this camera, and colours with this range, whatever the body does.
    pub(crate) fn fix_view(&mut self, camera: Camera, range: [f64; 2]) {
        self.eye.look(camera);
        self.view.fixed_range = Some(range);
    }

    /// Shows or hides the outlines at rest and of the linear solution.
    pub fn set_outlines(&mut self, shown: bool) {
        self.view.rest_outline = shown;
        self.view.ghost = shown;
        self.view.exact = shown;
    }

    /// The scene as it stands.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The simulation as it stands.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The same scene under linear theory, where there is that.
    #[must_use]
    pub fn linear(&self) -> Option<&Simulation> {
        self.linear.as_ref()
    }

    /// Displacement of the linear solution, m, where there is one.
    #[must_use]
    pub fn linear_displacement(&self) -> Option<&[Vector2<f64>]> {
        self.linear.as_ref().map(Simulation::displacement)
    }

    /// The view's place in the window, points.
    #[must_use]
    pub fn view_rect(&self) -> Rect {
        self.view_rect
    }

    /// Where the tips of the loads' arrows are in the window, points, with the number of each among the scene's loads.
    #[must_use]
    pub fn arrow_tips(&self) -> Vec<(usize, egui::Pos2)> {
        let projection = Projection { camera: self.camera(), rect: self.view_rect };
        self.handles(&projection).iter().map(|handle| (handle.load(), handle.tip())).collect()
    }

    /// Places in the window, points, that the arrows of the loads begin at, or go round.
    #[must_use]
    pub fn arrow_feet(&self) -> Vec<egui::Pos2> {
        let projection = Projection { camera: self.camera(), rect: self.view_rect };
        self.handles(&projection).iter().map(Handle::foot).collect()
    }

    /// The camera of the last [`Self::ui`].
    #[must_use]
    pub fn camera(&self) -> Camera {
        match self.view.mode {
            Mode::Compare if self.moves() => self.motions.camera(),
            Mode::Compare => self.compare.camera(),
            _ => self.eye.camera(),
        }
    }

    /// Title of the window: the scene's name, a star where it has been edited, and the name of its file.
    #[must_use]
    pub fn title(&self) -> String {
        let edited = if self.scene == self.document.original { "" } else { "*" };
        language::speak(self.settings.language);
        let file = self.document.path().and_then(Path::file_name);
        let file = file.map_or_else(String::new, |file| format!(" ({})", file.to_string_lossy()));
        format!("{}{edited}{file} \u{2013} warpbeam", tr(&self.scene.name))
    }

    /// Makes the iterations of one displayed frame if it runs, or the time steps that are due at `now`, s of any clock
    /// that goes with the wall's; says whether there are others to make.
    pub fn advance(&mut self, now: f64) -> bool {
        self.tend();
        if self.compares_motions() {
            self.playback.pace.rest();
            self.motions.advance(&self.scene, now, self.running);
            return self.iterates();
        }
        match (self.iterates(), self.moves()) {
            _ if self.is_beside() => self.playback.pace.rest(),
            (true, true) => {
                self.playback.advance(now, &mut self.simulation);
                self.timings = *self.simulation.last_iteration();
            }
            (true, false) => self.iterate(self.iterations),
            (false, _) => self.playback.pace.rest(),
        }
        self.iterates()
    }

    /// Whether there is an edit to undo.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.edits.can_undo()
    }

    /// Whether there is an undone edit to do again.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.edits.can_redo()
    }

    /// Lets the view take its time on the way to where it looks, as in a window, or not, as in pictures.
    pub fn set_easing(&mut self, eases: bool) {
        self.eases = eases;
    }

    /// The material point whose values are shown beside the body.
    #[must_use]
    pub fn probed(&self) -> Option<MaterialPoint> {
        self.probe
    }

    /// Looks as it was left.
    pub fn set_settings(&mut self, ctx: &egui::Context, settings: Settings) {
        palette::install(ctx);
        if let Some(theme) = settings.theme {
            ctx.set_theme(egui::Theme::from(theme));
        }
        self.view.panel = settings.panel;
        self.view.drawer = settings.drawer;
        self.view.color_with(settings.color());
        self.settings = settings;
        if let Some(path) = self.document.path() {
            self.settings.add_recent(path);
        }
    }

    /// Shows everything in this language from now on.
    pub fn set_language(&mut self, language: Language) {
        self.settings.language = language;
    }

    /// What it is shown in.
    #[must_use]
    pub fn language(&self) -> Language {
        self.settings.language
    }

    /// The window that shows it has this size, points.
    pub fn set_window_size(&mut self, size: [f32; 2]) {
        self.settings.set_size(size);
    }

    /// What is to be remembered of how it is looked at.
    #[must_use]
    pub fn settings(&self, ctx: &egui::Context) -> Settings {
        let theme = match ctx.options(|options| options.theme_preference) {
            egui::ThemePreference::Dark => Some(ThemeChoice::Dark),
            egui::ThemePreference::Light => Some(ThemeChoice::Light),
            egui::ThemePreference::System => None,
        };
        // The cards have a view of their own, which is not remembered.
        let ViewOptions { panel, drawer, field, .. } =
            *self.learn.as_ref().map_or(&self.view, |learn| learn.view_before());
        let mut settings = self.settings.clone();
        (settings.theme, settings.panel, settings.drawer) = (theme, panel, drawer);
        settings.set_color(field);
        settings
    }

    /// Whether the scene is one in time.
    fn moves(&self) -> bool {
        self.simulation.motion().is_some()
    }

    /// So many iterations, or one time step.
    pub(crate) fn iterate(&mut self, iterations: u32) {
        if self.moves() {
            self.playback.step(&mut self.simulation);
            self.timings = *self.simulation.last_iteration();
            return;
        }
        self.timings = Timings::default();
        for _ in 0..iterations {
            if *self.simulation.status() == Status::Running {
                self.simulation.step();
                self.timings.add(self.simulation.last_iteration());
                note_residual(&self.simulation, &mut self.residuals);
            }
        }
        if let Some(learn) = &mut self.learn {
            learn.line = learn::UNTIL;
        }
    }

    /// Whether the next frame changes the body.
    #[must_use]
    pub fn iterates(&self) -> bool {
        if self.compares_motions() {
            return self.running && self.motions.moves();
        }
        self.running && (!self.simulation.is_at_rest() || self.playback.companions_move())
    }

    /// Iterates to the end, or steps to the end of the scene's duration, and finds out what is known of the result.
    pub fn solve(&mut self) {
        self.finish_beside();
        while *self.simulation.status() == Status::Running {
            self.iterate(1);
        }
        if self.moves() {
            self.frequency.settle(&self.scene);
            return;
        }
        self.simulation.certify();
        self.quality.follow(&self.simulation);
        self.truth.settle(&self.scene);
        if let Some(learn) = &mut self.learn {
            learn.settle(&self.scene);
        }
        if self.view.mode == Mode::Compare {
            self.compare.settle(&self.scene, self.simulation.system());
        }
        self.jump.settle(&self.scene);
        if self.view.drawer == Some(Drawer::Curve) {
            self.curve.settle(&self.scene);
        }
    }

    /// Shows the plots of a motion under the body.
    pub fn show_motion_plots(&mut self) {
        self.view.drawer = Some(Drawer::Motion);
    }

    /// Shows the same motion under another integrator as an outline beside the body, or no longer.
    pub fn compare_with(&mut self, integrator: IntegratorKind) {
        if self.moves() && integrator != self.scene.dynamics.integrator {
            self.playback.toggle(integrator, &self.simulation);
        }
    }

    /// Sets the speed of a motion, simulated seconds a second: 1, or slow motion.
    pub fn set_speed(&mut self, speed: f64) {
        self.playback.pace.set_speed(speed);
    }

    /// Whether something is still being found out of the scene beside the window.
    #[must_use]
    pub fn is_searching(&self) -> bool {
        if self.is_working() {
            return true;
        }
        let open = match self.view.drawer {
            Some(Drawer::Curve) => self.curve.is_open(),
            Some(Drawer::Motion) => self.frequency.is_open(),
            _ => false,
        };
        let learns = self.learn.as_ref().is_some_and(|learn| learn.is_looking());
        open || learns || (self.truth.is_open() || self.jump.is_open()) && !self.moves()
    }

    /// What is drawn of the body, as of the last [`Self::ui`].
    #[must_use]
    pub fn frame(&self) -> Frame<'_> {
        self.shape.frame(&self.drawing, self.view.wireframe)
    }

    /// What the body's pass draws, as of the last [`Self::ui`], with this many pixels a point.
    pub(crate) fn views(&self, pixels_per_point: f32) -> Vec<View<'_>> {
        match self.view.mode {
            Mode::Compare if self.moves() => return self.motions.views(self.view.wireframe, pixels_per_point),
            Mode::Compare => return self.compare.views(self.view.wireframe, pixels_per_point),
            _ => {}
        }
        let viewport = viewport(self.view_rect, pixels_per_point);
        vec![View { viewport, frame: self.frame(), camera: self.camera() }]
    }

    fn update_shape(&mut self, visuals: &egui::Visuals) {
        self.keep_converged();
        self.shows_converged = self.hides_divergence();
        let own = self.converged.as_ref().filter(|_| self.shows_converged).unwrap_or(&self.simulation);
        let simulation = self.intro.as_ref().map_or(own, Intro::simulation);
        // Colours that jump from frame to frame say nothing of a motion.
        let played = self.swept.is_some().then(|| self.playback.played());
        self.shape.update(simulation, &self.drawing, &self.view, played);
        self.shape.color(visuals, self.view.field);
    }

    /// Keeps a copy of a body that has come to rest.
    fn keep_converged(&mut self) {
        let simulation = &self.simulation;
        let is_kept = |kept: &Simulation| kept.state() == simulation.state() && kept.scene() == simulation.scene();
        if matches!(simulation.status(), Status::Converged | Status::Accepted)
            && !self.converged.as_ref().is_some_and(is_kept)
        {
            self.converged = simulation.snapshot();
        }
    }

    /// `true` where the last equilibrium is to be drawn instead of a state that diverges. A card of the article shows the latter.
    fn hides_divergence(&self) -> bool {
        let simulation = &self.simulation;
        let same_body = |kept: &Simulation| std::sync::Arc::ptr_eq(kept.system(), simulation.system());
        if self.learn.is_some() || !self.converged.as_ref().is_some_and(same_body) {
            return false;
        }
        match simulation.status() {
            Status::Diverged(_) => true,
            // Under the pointer it has not been given up yet.
            Status::Running if !self.pointer.holds() || self.moves() => false,
            Status::Running | Status::NotConverged(_) => {
                let projection = Projection { camera: self.camera(), rect: self.view_rect };
                let mut places =
                    simulation.system().mesh().nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u);
                let leaves = |place| !self.view_rect.contains(projection.point(place));
                simulation.residual() > 1.0 || self.eye.shows_whole() && places.any(leaves)
            }
            _ => false,
        }
    }

    /// What toolbar, panel and headlines show.
    fn input(&self) -> Readout<'_> {
        Readout {
            truth: self.truth.get(),
            jump: self.jump.get(),
            equilibrium_rho: self.learn.as_ref().and_then(|learn| learn.rho()),
            quality: &self.quality,
            reference_progress: self.truth.progress(),
            shows_converged: self.shows_converged,
            scene: &self.scene,
            original: &self.document.original,
            scene_name: self.document.source.name.to_str().unwrap_or_default(),
            simulation: &self.simulation,
            linear: self.linear.as_ref(),
            running: self.running,
            ended: match self.view.mode {
                Mode::Compare if self.moves() => !self.motions.moves(),
                Mode::Compare => !self.compare.is_iterating(),
                _ => self.simulation.is_at_rest() && !self.playback.companions_move(),
            },
            playback: &self.playback,
            frequency: self.frequency.latest().copied(),
            iterations: self.iterations,
            timings: &self.timings,
            residuals: &self.residuals,
            can_undo: self.edits.can_undo(),
            can_redo: self.edits.can_redo(),
            adapter: &self.adapter,
            language: self.settings.language,
        }
    }

    /// Shows everything but the body, which is drawn under it, and does what was asked for.
    pub fn ui(&mut self, ui: &mut Ui) -> Vec<Request> {
        palette::install(ui.ctx());
        language::speak(self.settings.language);
        let mut actions = Vec::new();
        self.edits.listen(ui.ctx());
        self.hear_of_files(ui.ctx(), &mut actions);
        self.find_out(ui.ctx());
        self.budget.listen(ui.ctx());
        self.go_on_with_intro(ui.ctx());
        for (integrator, step) in self.playback.take_unstable() {
            let integrator = tr(integrator.id());
            let words = match step {
                Some(step) => {
                    let step = words::engineering(step, "s");
                    fill!(
                        "%{integrator} is unstable: its longest stable step is %{step}",
                        integrator = integrator,
                        step = step
                    )
                }
                None => fill!("%{integrator} is unstable: its steps fail", integrator = integrator),
            };
            self.say(ui.ctx(), words);
        }
        if let Some(words) = self.beside.unsaid.take() {
            self.say(ui.ctx(), words);
        }
        self.view.narrow = ui.available_width() < NARROW;
        // Enter ends a text within its frame: the other keys of that frame were typed into it.
        let was_typing = ui.ctx().text_edit_focused();
        if self.view.bars {
            self.bars(ui, &mut actions);
        }
        if !self.has_dialog() && !was_typing {
            actions.extend(shortcuts::actions(ui.ctx()));
        }
        match self.view.mode {
            Mode::Explore => self.plots(ui, &mut actions),
            Mode::Learn => self.learn(ui, &mut actions),
            Mode::Compare => self.comparison_bars(ui, &mut actions),
            Mode::Budget => self.budget(ui, &mut actions),
        }
        let mut requests = Vec::new();
        for action in actions {
            self.act(ui.ctx(), action, &mut requests);
        }
        let mut actions = Vec::new();
        CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| match self.view.mode {
            Mode::Compare => self.comparison(ui, &mut actions, &mut requests),
            _ => self.body_view(ui, &mut actions, &mut requests),
        });
        if self.view.bars && self.view.narrow && self.view.sheet && self.view_rect.width() >= 160.0 {
            self.sheet(ui, &mut actions);
        }
        for action in actions {
            self.act(ui.ctx(), action, &mut requests);
        }
        help::show(ui.ctx(), &mut self.view.help);
        self.offer_unsaved(ui.ctx(), &mut requests);
        self.ask_to_save(ui.ctx());
        self.ask_for_file(ui.ctx());
        requests.extend(std::mem::take(&mut self.closes).then_some(Request::Close));
        if self.is_working() {
            ui.ctx().request_repaint_after(LISTEN);
        } else if self.iterates() || self.intro.is_some() {
            ui.ctx().request_repaint();
        }
        requests
    }

    /// The bars along the top and the bottom, and the panel where it has its place.
    fn bars(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let errors = diagnosis::errors(&self.input());
        let bar = |ui: &Ui| unfilled(ui).inner_margin(egui::Margin::symmetric(12, 0));
        let top = Panel::top("toolbar")
            .exact_size(toolbar::height(ui.ctx().content_rect().width()))
            .resizable(false)
            .frame(bar(ui));
        let mut gallery = std::mem::take(&mut self.gallery);
        top.show(ui, |ui| toolbar::show(ui, &self.input(), &mut gallery, &self.view, actions));
        self.gallery = gallery;
        // Compared panes have each their own; over a card a low window has no room for it.
        let is_low_card = self.learn.is_some() && learn::is_low(ui.ctx());
        if self.view.mode != Mode::Compare && !is_low_card {
            let bottom = Panel::bottom("headline").exact_size(HEADLINE_HEIGHT).resizable(false).frame(bar(ui));
            bottom.show(ui, |ui| status_bar::show(ui, &self.input(), &errors, &self.view, actions));
        }
        if self.view.panel && !self.view.narrow {
            let frame = unfilled(ui).inner_margin(egui::Margin { left: 12, right: 8, top: 8, bottom: 4 });
            let panel = Panel::right("panel").exact_size(PANEL_WIDTH).resizable(false).frame(frame);
            panel.show(ui, |ui| self.panel(ui, &errors, actions));
        }
    }

    /// The panel over the body, where the window is narrow.
    fn sheet(&mut self, ui: &Ui, actions: &mut Vec<Action>) {
        let errors = diagnosis::errors(&self.input());
        let rect = self.view_rect;
        let width = PANEL_WIDTH.min(rect.width());
        egui::Area::new(egui::Id::unique("sheet"))
            .order(egui::Order::Foreground)
            .fixed_pos(rect.right_top() - egui::vec2(width, 0.0))
            .constrain(false)
            .show(ui.ctx(), |ui| {
                let palette = Palette::new(ui.visuals());
                let margin = egui::Margin { left: 12, right: 8, top: 8, bottom: 4 };
                let frame = egui::Frame::new().fill(palette.panel).inner_margin(margin);
                frame.stroke(egui::Stroke::new(1.0, palette.line)).show(ui, |ui| {
                    ui.set_width((width - 22.0).max(0.0));
                    ui.set_height((rect.height() - 14.0).max(0.0));
                    self.panel(ui, &errors, actions);
                });
            });
        if ui.input(|i| i.key_pressed(egui::Key::Escape)) && !ui.ctx().text_edit_focused() {
            self.view.sheet = false;
        }
    }

    fn panel(&mut self, ui: &mut Ui, errors: &Errors, actions: &mut Vec<Action>) {
        // The panel's own memory is apart from what it shows.
        let (mut state, mut view) = (std::mem::take(&mut self.panel), self.view.clone());
        panel::show(ui, &self.input(), errors, &mut state, &mut view, actions);
        (self.panel, self.view) = (state, view);
    }

    /// Lets the load of the first seconds grow, until they are over or somebody does something.
    fn go_on_with_intro(&mut self, ctx: &egui::Context) {
        if self.intro.is_none() {
            return;
        }
        let (now, touched) = ctx.input(|i| {
            let idle = |event: &egui::Event| {
                matches!(event, egui::Event::PointerMoved(_) | egui::Event::WindowFocused(_) | egui::Event::PointerGone)
            };
            (i.time, i.events.iter().any(|event| !idle(event)))
        });
        // Not before it is known where all of it goes: the view stands still then.
        let waits = self.iterates() || self.truth.is_open();
        let goes_on = waits || self.intro.as_mut().is_some_and(|intro| intro.advance(now));
        if touched || !goes_on {
            self.intro = None;
        }
    }

    /// Looks for what is known of the scene and of its result, once the body is at rest: a dragged slider need not wait.
    fn find_out(&mut self, ctx: &egui::Context) {
        if self.moves() {
            // A dragged slider does not wait for it.
            if !ctx.input(|i| i.pointer.any_down()) {
                self.frequency.ask(&self.scene, ctx);
            }
            return;
        }
        if self.iterates() || self.is_working() {
            return;
        }
        // The errand has found it of a large body.
        if !self.is_beside() {
            self.simulation.certify();
            self.quality.follow(&self.simulation);
        }
        self.truth.ask(&self.scene, ctx);
        self.jump.ask(&self.scene, ctx);
        if self.view.drawer == Some(Drawer::Curve) {
            self.curve.ask(&self.scene, ctx);
        }
    }

    /// The plots under the body, where they are open.
    fn plots(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let Some(drawer) = self.view.drawer else { return };
        drawer_panel(ui).show(ui, |ui| match drawer {
            Drawer::Curve => {
                load_curve::show(ui, self.curve.latest(), !self.curve.is_open(), self.view.curve_plot, actions);
            }
            Drawer::Motion => {
                let frequency = self.frequency.get().copied();
                let integrator = self.scene.dynamics.integrator;
                motion_plot::show(ui, &mut self.view.motion_plot, &self.playback, integrator, frequency);
            }
        });
    }

    /// Error against time, under the body.
    fn budget(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        drawer_panel(ui).show(ui, |ui| self.budget.show(ui, &self.scene, actions));
    }

    /// The presets over the panes that are compared, and the load curve under them.
    fn comparison_bars(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        if self.moves() {
            let (motions, input) = self.compared_motions();
            return motions.bars(ui, &input);
        }
        let (compare, input) = self.compared();
        compare.bars(ui, &input, actions);
    }

    /// The panes that are compared, in the place of the body.
    fn comparison(&mut self, ui: &mut Ui, actions: &mut Vec<Action>, requests: &mut Vec<Request>) {
        let rect = ui.available_rect_before_wrap();
        self.view_rect = rect;
        let wish = if self.moves() {
            let (motions, input) = self.compared_motions();
            motions.show(ui, &input)
        } else {
            // The truth does not depend on how the lab's own setting gets on.
            if !self.compare.is_iterating() {
                self.truth.ask(&self.scene, ui.ctx());
            }
            let (compare, input) = self.compared();
            compare.show(ui, &input)
        };
        self.take_wish(ui.ctx(), &wish, requests);
        let painter = ui.painter_at(rect);
        self.show_work(ui, rect, actions);
        self.paint_recording(ui, &painter, rect);
        self.paint_toast(ui, &painter, rect);
    }

    /// The comparison, and its input.
    fn compared(&mut self) -> (&mut Compare, CompareInput<'_>) {
        let Self { compare, scene, simulation, truth, view, budget, panel, document, .. } = self;
        let input = CompareInput {
            common: PaneInput {
                scene,
                view,
                direction: panel.force_direction(),
                opening: OpeningLoads::of(&document.original),
                eases: self.eases,
            },
            shown: simulation.scene(),
            system: simulation.system(),
            truth: truth.get(),
            running: self.running,
            chosen: budget.chosen(),
        };
        (compare, input)
    }

    /// The comparison of motions, and its input.
    fn compared_motions(&mut self) -> (&mut MotionCompare, PaneInput<'_>) {
        let Self { motions, scene, view, panel, document, .. } = self;
        let input = PaneInput {
            scene,
            view,
            direction: panel.force_direction(),
            opening: OpeningLoads::of(&document.original),
            eases: self.eases,
        };
        (motions, input)
    }

    /// The cards, under the body.
    fn learn(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        // What cards remember is apart from what they show.
        let Some(mut learn) = self.learn.take() else { return };
        let shown = Shown { input: self.input(), study: self.budget.study(), progress: self.budget.progress() };
        // What lies over the body has Escape first.
        let sheet = self.view.narrow && self.view.sheet;
        let keys = !self.has_dialog() && !self.view.help && !sheet;
        learn.show(ui, &shown, keys, actions);
        self.learn = Some(learn);
    }

    /// Puts the lab aside for another with the article's beam where the mode asks for cards, and takes it back after.
    fn enter_or_leave(&mut self) {
        match (self.view.mode == Mode::Learn, self.learn.take()) {
            (true, None) => {
                let article = learn::article()
                    .and_then(|(source, scene)| Some(Self::new(source, scene.clone(), Simulation::new(&scene).ok()?)));
                let Some(mut lab) = article else {
                    self.view.mode = Mode::Explore;
                    return;
                };
                lab.adapter.clone_from(&self.adapter);
                lab.settings = std::mem::take(&mut self.settings);
                lab.gallery = std::mem::take(&mut self.gallery);
                lab.eases = self.eases;
                // A card has the controls that it needs: the panel is folded away until it is asked for.
                let (bars, narrow) = (self.view.bars, self.view.narrow);
                let (mode, panel, raw) = (Mode::Learn, false, true);
                lab.view = ViewOptions { mode, bars, panel, narrow, raw, ..ViewOptions::default() };
                (lab.view_rect, lab.card) = (self.view_rect, self.card);
                self.intro = None;
                self.view.mode = Mode::Explore;
                let before = Box::new(std::mem::replace(self, lab));
                self.learn = Some(Box::new(Learn::new(before, self.card)));
                self.set_card_up();
            }
            (false, Some(learn)) => {
                let (mode, drawer) = (self.view.mode, self.view.drawer);
                let (before, card) = learn.leave();
                let (settings, gallery) = (std::mem::take(&mut self.settings), std::mem::take(&mut self.gallery));
                *self = *before;
                (self.card, self.settings, self.gallery) = (card, settings, gallery);
                self.view.mode = mode;
                // Plots that were asked for from a card are shown.
                self.view.drawer = drawer.map(|_| Drawer::of(&self.scene)).or(self.view.drawer);
            }
            (_, same) => self.learn = same,
        }
    }

    fn go_to_card(&mut self, card: usize) {
        if let Some(learn) = &mut self.learn {
            learn.go_to(card);
            self.card = card;
            self.set_card_up();
        }
    }

    /// Makes scene and view what the card wants.
    fn set_card_up(&mut self) {
        let Some(setup) = self.learn.as_ref().map(|learn| learn.card().setup) else { return };
        let Some((source, mut scene)) = learn::article() else { return };
        (setup.edit)(&mut scene);
        let reach = setup.reach.and_then(|reach| {
            let mut scene = scene.clone();
            reach(&mut scene);
            let mut simulation = Simulation::new(&scene).ok()?;
            simulation.solve();
            Some(simulation)
        });
        // The article's beam has every card's scene.
        if self.set_scene(scene).is_err() {
            return;
        }
        if let Some(learn) = &mut self.learn {
            learn.reach = reach;
        }
        self.document = Document::new(source, self.scene.clone());
        self.edits = Edits::default();
        self.panel.clear();
        self.view.color_with(setup.field);
        self.view.fixed_range = None;
        (self.view.exact, self.view.rest_outline, self.view.ghost) = (setup.exact, setup.rest, false);
        self.eye.fit();
        self.iterations = 1;
        self.running = setup.start != Start::Waiting;
        if setup.start != Start::Now {
            self.reset();
            // The view follows what has converged; until then there is room for the beam to bend, and for its arrow.
            let (low, high) = self.simulation.system().mesh().bounds();
            let low = low - Vector2::new(0.3, 1.15) * (high.x - low.x);
            self.eye.follow([low, high]);
            let least =
                self.least_margins([low, high], [self.view_rect.width(), self.view_rect.height()].map(f64::from));
            let arrow = f64::from(0.25 * self.view_rect.height()).clamp(30.0, 120.0);
            self.margins = Margins { bottom: least.bottom + arrow, ..least };
        }
    }

    /// Takes a scene that should be as good as the present one; says so where it is not.
    fn edit(&mut self, ctx: &egui::Context, scene: Scene) {
        if let Err(error) = self.set_scene(scene) {
            self.say(ctx, translated(&error.to_string()));
        }
    }

    fn body_view(&mut self, ui: &mut Ui, actions: &mut Vec<Action>, requests: &mut Vec<Request>) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        // What is pressed is what was seen: the last picture.
        let projection = Projection { camera: self.camera(), rect: self.view_rect };
        let (apart, handles) = (self.is_apart(), self.handles(&projection));
        let size = [rect.width(), rect.height()].map(f64::from);
        let system = self.simulation.system().clone();
        let reach = Reach {
            camera: projection.camera,
            mesh: (!apart).then_some(system.mesh()),
            positions: &self.shape.nodes,
            outline: &self.drawing.boundary,
            handles: &handles,
            scales: self.eye.scales(size),
        };
        self.view_rect = rect;
        let body = match self.is_beside() {
            true => Body::Seen,
            false => Body::InHand(&mut self.simulation, &mut self.playback),
        };
        let wish = self.pointer.follow(ui, &response, &reach, body);
        self.take_wish(ui.ctx(), &wish, requests);
        self.update_shape(ui.visuals());
        if let Some(learn) = self.learn.as_ref().filter(|learn| learn.is_apart()) {
            self.shape.displace(|points| learn.place(&self.simulation, &self.drawing, points));
        }
        match wish.look {
            Look::Same => {}
            Look::At(camera) => self.eye.look(camera),
            Look::Fit => self.eye.fit(),
        }
        self.follow(ui, size);
        // On a card a click takes a triangle.
        let probed = wish.clicked.flatten().filter(|_| self.learn.is_none());
        if let (Some(point), Some(click)) = (probed, response.interact_pointer_pos()) {
            let kept = self.probe.and_then(|kept| self.in_view(kept));
            self.probe = (!kept.is_some_and(|kept| probe::is_on(kept, click))).then_some(point);
        }
        let painter = ui.painter_at(rect);
        let errors = diagnosis::errors(&self.input());
        let (words, bad) = diagnosis::status_words(&self.simulation, true, self.shows_converged);
        let shown = self.intro.as_ref().map_or(&self.simulation, Intro::simulation);
        let moves = self.simulation.problem().supports().move_the_body();
        let reactions = if moves { self.simulation.support_reactions() } else { Vec::new() };
        let overlay = Overlay {
            scene: shown.scene(),
            system: shown.system(),
            drawing: &self.drawing,
            options: &self.view,
            camera: self.camera(),
            positions: &self.shape.nodes,
            apart,
            ghost: self.ghost(),
            exact: if self.intro.is_some() { &[] } else { self.exact() },
            errors: if self.intro.is_some() { Errors::default() } else { errors },
            time: shown.state().time(),
            direction: self.panel.force_direction(),
            opening: OpeningLoads::of(&self.document.original),
            hot: self.pointer.hot_handle(),
            hand: self.simulation.hand(),
            playback: &self.playback,
            reactions: &reactions,
            color_range: self.shape.range,
            // Beside bars the status says it.
            warning: (bad && !self.view.bars).then_some(&words),
        };
        overlay::paint(&painter, rect, &overlay, ui.visuals());
        if self.view.bars && self.moves() && self.learn.is_none() {
            let taken = (overlay::scale_bar_width(&self.camera()), overlay::has_legend_below(rect.size()));
            let now = self.simulation.state().time();
            time_line::show(ui, rect, taken, (&self.playback, now), actions);
        }
        if let Some(learn) = &mut self.learn {
            let view = learn::View {
                simulation: &self.simulation,
                drawing: &self.drawing,
                points: self.shape.points(),
                camera: self.eye.camera(),
                rect,
                palette: Palette::new(ui.visuals()),
            };
            if let (true, Some(at)) = (response.clicked(), response.interact_pointer_pos()) {
                learn.pick(&view, at);
            }
            learn.paint(&painter, &view);
        }
        if !apart {
            self.show_values(ui, &painter);
        }
        if self.view.bars && self.intro.is_none() {
            let mut free = rect;
            if self.view.narrow && self.view.sheet && rect.width() > 1.5 * PANEL_WIDTH {
                free.max.x -= PANEL_WIDTH;
            }
            if free.width() >= 160.0 && free.height() >= 90.0 {
                self.status(ui, free, &errors, actions);
                self.show_work(ui, free, actions);
            }
        }
        self.note_crossing(ui);
        self.paint_recording(ui, &painter, rect);
        self.paint_toast(ui, &painter, rect);
    }

    /// Says once per scene that the body passes through itself.
    fn note_crossing(&mut self, ui: &Ui) {
        /// Time between two checks of a body that moves, s.
        const EVERY: f64 = 0.1;
        let now = ui.input(|i| i.time);
        let is_shown = self.view.bars && self.learn.is_none() && self.intro.is_none() && self.toast.is_none();
        let is_due = !self.iterates() || now - self.crossing.checked >= EVERY;
        let is_sound = match self.simulation.status() {
            Status::Converged | Status::Accepted => true,
            Status::Running | Status::Finished => self.moves(),
            _ => false,
        };
        let is_another = self.crossing.stamp != self.shape.stamp();
        if self.crossing.is_said || !(is_shown && is_due && is_sound && is_another) {
            return;
        }
        (self.crossing.checked, self.crossing.stamp) = (now, self.shape.stamp());
        let mesh = self.simulation.system().mesh();
        if passes_through_itself(mesh, &self.drawing.boundary, &self.shape.nodes) {
            self.crossing.is_said = true;
            self.say(ui.ctx(), tr("The body passes through itself: contact is not modelled").to_owned());
        }
    }

    /// How it stands, over the body; why; and what would help.
    fn status(&self, ui: &Ui, rect: Rect, errors: &Errors, actions: &mut Vec<Action>) {
        const WIDEST: f32 = 460.0;
        /// The same beside a small body.
        const WIDEST_BESIDE: f32 = 250.0;
        let input = self.input();
        let palette = Palette::new(ui.visuals());
        let narrow = rect.width() < 640.0;
        // Where two lines would lie over the body there is one.
        let is_low = rect.height() < 220.0;
        let (words, bad) = diagnosis::summary(&input);
        // A card that leaves the body little room says itself that all is well.
        let is_tight = self.learn.is_some() && rect.height() < 300.0;
        if is_tight && !(bad || self.view.why || diagnosis::is_stale(&input)) {
            return;
        }
        let above = if narrow { overlay::LEGEND_HEIGHT + 10.0 } else { 44.0 };
        let chip = |tint| egui::Frame::new().fill(tint).corner_radius(6.0).inner_margin(egui::Margin::symmetric(10, 5));
        let id = egui::Id::unique("status");
        let widest = if is_tight { WIDEST_BESIDE } else { WIDEST };
        let (pivot, at, width) = self.place_off_handles(rect, above, widest.min(rect.width() - 28.0));
        let area = egui::Area::new(id).order(egui::Order::Middle).fixed_pos(at).pivot(pivot).constrain_to(rect);
        area.show(ui.ctx(), |ui| {
            ui.set_max_width(width);
            if self.view.why {
                chip(palette.panel).show(ui, |ui| {
                    for line in diagnosis::explanation(&input) {
                        ui.add(egui::Label::new(spaced(line.into(), palette::BODY)).wrap());
                    }
                });
            }
            // The other modes have their own way on.
            let remedy = diagnosis::remedy(&input, errors).filter(|_| self.view.mode == Mode::Explore);
            let help = |ui: &mut Ui, remedy: &diagnosis::Remedy| {
                let pressed = ui.button(&remedy.offer).on_hover_text(&remedy.words).clicked();
                pressed.then(|| Action::Edit(remedy.edits, remedy.scene.clone()))
            };
            if let Some(remedy) = remedy.as_ref().filter(|_| !is_low) {
                chip(palette.error_chip).show(ui, |ui| {
                    ui.horizontal_wrapped(|ui| {
                        ui.colored_label(palette.error, &remedy.words);
                        actions.extend(help(ui, remedy));
                    });
                });
            }
            let tint = if bad { palette.error_chip } else { palette.panel };
            chip(tint).show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    ui.colored_label(if bad { palette.error } else { palette.text }, words);
                    if let Some(remedy) = remedy.as_ref().filter(|_| is_low) {
                        actions.extend(help(ui, remedy));
                    }
                    if diagnosis::is_stale(&input) && ui.button(tr("Step now")).clicked() {
                        actions.push(Action::Step);
                    }
                    let why = ui.link(tr("why?"));
                    if why.clicked() {
                        actions.push(Action::Toggle(Toggle::Why));
                    }
                });
            });
        });
    }

    /// Corner, place and largest width of a message over the view: the lower left, beside the tips of arrows that it would
    /// hide, or another corner.
    fn place_off_handles(&self, view: Rect, above: f32, widest: f32) -> (egui::Align2, egui::Pos2, f32) {
        const SIDE: f32 = 14.0;
        /// Height that two messages may have, points.
        const HEIGHT: f32 = 100.0;
        const CLEAR: f32 = 18.0;
        const NARROWEST: f32 = 220.0;
        let lower_left = view.left_bottom() + egui::vec2(SIDE, -above);
        let covered = Rect::from_min_max(lower_left - egui::vec2(0.0, HEIGHT), lower_left + egui::vec2(widest, 0.0));
        let covered = covered.expand(CLEAR);
        let hidden = self.arrow_tips().into_iter().map(|(_, tip)| tip).filter(|tip| covered.contains(*tip));
        let columns: Vec<f32> = hidden.map(|tip| tip.x).collect();
        let first = columns.iter().copied().fold(f32::INFINITY, f32::min);
        let last = columns.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let (left, right) = (first - CLEAR - lower_left.x, view.right() - SIDE - last - CLEAR);
        if left >= NARROWEST {
            return (egui::Align2::LEFT_BOTTOM, lower_left, left.min(widest));
        }
        if right >= NARROWEST {
            let low = view.right_bottom() - egui::vec2(SIDE, overlay::LEGEND_HEIGHT + 10.0);
            return (egui::Align2::RIGHT_BOTTOM, low, right.min(widest));
        }
        (egui::Align2::LEFT_TOP, view.left_top() + egui::vec2(SIDE, 44.0), widest)
    }

    /// The true outline, m, where it is known of what is shown.
    fn exact(&self) -> &[Vec<Vector2<f64>>] {
        let shown = self.view.exact && !self.moves() && !self.iterates() && self.simulation.hand().is_none();
        let reference = self.truth.get().filter(|_| shown);
        reference.map_or(&[], |reference| &reference.outline)
    }

    /// Sets the load whose arrow has been dragged, or puts it back.
    fn take_wish(&mut self, ctx: &egui::Context, wish: &Wish, requests: &mut Vec<Request>) {
        if let Some((load, pull)) = wish.load {
            self.panel.choose_force(load);
            let mut scene = Box::new(self.scene.clone());
            let (label, set) = match pull {
                Pull::Force(magnitude, degrees) => {
                    self.panel.keep_force_direction(degrees);
                    ("Force", scene.set_force(load, vector(magnitude, degrees)))
                }
                Pull::Moment(moment) => ("Moment", scene.set_moment(load, moment)),
            };
            // There is such a load: its arrow was taken.
            if set.is_ok() && *scene != self.scene {
                self.act(ctx, Action::Edit(label, scene), requests);
                ctx.request_repaint();
            }
        }
        if let Some(load) = wish.restore
            && let Some(restored) = self.with_original_load(load)
        {
            let label = if restored.loads.get(load).is_some_and(Load::is_moment) { "Moment" } else { "Force" };
            self.act(ctx, Action::Edit(label, Box::new(restored)), requests);
            ctx.request_repaint();
        }
    }

    /// Whether the elements are drawn elsewhere: they cannot be pulled there, and have no loads.
    fn is_apart(&self) -> bool {
        self.learn.as_ref().is_some_and(|learn| learn.is_apart())
    }

    /// What the arrows of the last picture are of.
    fn forces(&self) -> Forces<'_> {
        Forces {
            scene: self.simulation.scene(),
            system: self.simulation.system(),
            positions: &self.shape.nodes,
            time: self.simulation.state().time(),
            direction: self.panel.force_direction(),
            opening: OpeningLoads::of(&self.document.original),
        }
    }

    /// The tips of the last picture's arrows; none where the elements are drawn elsewhere.
    fn handles(&self, projection: &Projection) -> Vec<Handle> {
        if self.is_apart() { Vec::new() } else { self.forces().handles(projection) }
    }

    /// The scene with one of its loads as in its file; `None` where that has none such there.
    fn with_original_load(&self, load: usize) -> Option<Scene> {
        let original = self.document.original.loads.get(load)?;
        let mut scene = self.scene.clone();
        let present = scene.loads.get_mut(load)?;
        if std::mem::discriminant(original) != std::mem::discriminant(present) {
            return None;
        }
        present.clone_from(original);
        Some(scene)
    }

    /// Where a material point is in the window.
    fn in_view(&self, point: MaterialPoint) -> Option<egui::Pos2> {
        let place = probe::place(self.simulation.system().mesh(), &self.shape.nodes, point)?;
        Some(Projection { camera: self.camera(), rect: self.view_rect }.point(place))
    }

    /// The value of the field that colours the body, at a material point.
    fn field_at(&self, point: MaterialPoint) -> (Field, Option<f64>) {
        let field = self.view.field;
        let value = match self.view.raw && !field.is_of_elements() {
            true => self.shown().point_state(point, PointValues::Raw).and_then(|state| state.field(field)),
            false => self.shape.value_at(&self.view, self.simulation.system().mesh(), point),
        };
        (field, value)
    }

    /// The body that is drawn, but for an intro.
    fn shown(&self) -> &Simulation {
        self.converged.as_ref().filter(|_| self.shows_converged).unwrap_or(&self.simulation)
    }

    /// Shows the values under the pointer, and those at the point that is kept.
    fn show_values(&mut self, ui: &Ui, painter: &egui::Painter) {
        if let Some((point, at)) = self.pointer.over_body() {
            let mesh = self.simulation.system().mesh();
            if let Some(u) = probe::place(mesh, self.shown().displacement(), point) {
                probe::paint_hover(ui, painter, at, self.field_at(point), u);
            }
        }
        let Some(point) = self.probe else { return };
        let values = if self.view.raw { PointValues::Raw } else { PointValues::Recovered };
        let (Some(state), Some(at)) = (self.shown().point_state(point, values), self.in_view(point)) else { return };
        if probe::show_card(ui, painter, self.view_rect, at, self.view.field, &state) {
            self.probe = None;
        }
    }

    /// Fits the view to the body at rest and now, while nobody has moved it. What has not converged is not followed: it
    /// may be anywhere.
    fn follow(&mut self, ui: &Ui, size: [f64; 2]) {
        // A view that moved with the body would move the place under a pointer that holds it.
        if self.pointer.holds() {
            return;
        }
        let status = self.simulation.status();
        let is_sound = if self.moves() {
            !matches!(status, Status::Stopped(_))
        } else {
            status.is_success() || self.shows_converged
        };
        if is_sound {
            let (mut low, mut high) = self.simulation.system().mesh().bounds();
            if let (Some([swept_low, swept_high]), true) = (self.swept, self.moves()) {
                (low, high) = (low.inf(&swept_low), high.sup(&swept_high));
            }
            let mut include = |points: &mut dyn Iterator<Item = Vector2<f64>>| {
                for p in points {
                    (low, high) = (low.inf(&p), high.sup(&p));
                }
            };
            include(&mut self.shape.points().iter().copied());
            if self.intro.is_some() {
                // Where it is going to be.
                let rest = self.simulation.system().mesh().nodes();
                for u in std::iter::once(self.simulation.displacement()).chain(self.linear_displacement()) {
                    include(&mut rest.iter().zip(u).map(|(x, u)| x + u));
                }
            }
            include(&mut self.exact().iter().flatten().copied());
            if let Some(reach) = self.reach() {
                include(&mut positions(reach).into_iter());
            }
            self.swept = Some([low, high]).filter(|_| self.moves());
            self.eye.follow([low, high]);
            self.margins = self.with_room_for_arrows(self.least_margins([low, high], size), [low, high], size);
        }
        let [low, high] = self.eye.whole();
        let fitted = self.fit(low, high, size);
        let dt = f64::from(ui.input(|i| i.stable_dt));
        if self.eye.aim(fitted, self.eases.then_some(dt)) {
            ui.ctx().request_repaint();
        }
    }

    /// The camera that shows a box, m, and the linear solution beside it, in a view of this size, points.
    pub(crate) fn fit(&self, mut low: Vector2<f64>, mut high: Vector2<f64>, view: [f64; 2]) -> Camera {
        if let Some(linear) = self.ghost() {
            // The linear solution of a large load is absurdly long; the body must not shrink to a dot beside it.
            const LARGEST: f64 = 1.5;
            let size = (high - low).norm();
            let nodes = self.simulation.system().mesh().nodes();
            let ghost: Vec<_> = nodes.iter().zip(linear).map(|(x, u)| x + u).collect();
            let (ghost_low, ghost_high) = ghost.iter().fold((low, high), |(low, high), p| (low.inf(p), high.sup(p)));
            if (ghost_high - ghost_low).norm() < LARGEST * size {
                (low, high) = (ghost_low, ghost_high);
            }
        }
        Camera::fit(low, high, view, self.margins)
    }

    /// Returns the margins around a box, m, whatever the loads.
    fn least_margins(&self, [low, high]: [Vector2<f64>; 2], view: [f64; 2]) -> Margins {
        let has_legend_on_top = overlay::has_legend_on_top(view[1] as f32);
        if self.learn.is_some() && has_legend_on_top {
            // Under the colour bar or beside it, whichever shows more.
            let scale = |margins: &Margins| Camera::fit(low, high, view, *margins).scale;
            return if scale(&BESIDE_MARGINS) > scale(&CARD_MARGINS) { BESIDE_MARGINS } else { CARD_MARGINS };
        }
        match (self.learn.is_some(), has_legend_on_top) {
            (true, _) => CARD_MARGINS,
            (false, true) => LOW_MARGINS,
            (false, false) => FIT_MARGINS,
        }
    }

    /// The largest body that the slider of a card reaches, while the card has its own mesh.
    fn reach(&self) -> Option<&Simulation> {
        let reach = self.learn.as_ref()?.reach.as_ref()?;
        has_mesh_of(reach.scene(), self.simulation.scene()).then_some(reach)
    }

    /// Returns the margins around a box, m: the least ones, and the room that arrows need beyond them.
    fn with_room_for_arrows(&self, least: Margins, [low, high]: [Vector2<f64>; 2], view: [f64; 2]) -> Margins {
        /// Beyond a tip, points: its force stands there.
        const BEYOND: f32 = 36.0;
        let size = egui::vec2(view[0] as f32, view[1] as f32);
        let camera = Camera::fit(low, high, view, least);
        let projection = Projection { camera, rect: Rect::from_min_size(egui::Pos2::ZERO, size) };
        if self.is_apart() {
            return least;
        }
        let mut arrows = self.forces().arrows(&projection);
        if let Some(reach) = self.reach() {
            let forces =
                Forces { scene: reach.scene(), system: reach.system(), positions: &positions(reach), ..self.forces() };
            arrows.extend(forces.arrows(&projection));
        }
        let on_top = overlay::has_legend_on_top(size.y);
        arrows.iter().fold(least, |margins, arrow| {
            let tip = arrow.tip();
            // Beside the colour bar, not on it.
            let bar = if tip.x > size.x - overlay::LEGEND_WIDTH { overlay::LEGEND_HEIGHT } else { 0.0 };
            let above = if on_top && arrow.way.y < 0.0 { bar } else { 0.0 };
            let below = if on_top { 0.0 } else { bar };
            let beyond = |outside: f32| f64::from((outside + BEYOND).max(0.0));
            Margins {
                sides: margins.sides.max(least.sides + beyond((-tip.x).max(tip.x - size.x))),
                top: margins.top.max(least.top + beyond(above - tip.y)),
                bottom: margins.bottom.max(least.bottom + beyond(tip.y - size.y + below)),
            }
        })
    }

    /// The linear solution, if it is to be shown.
    fn ghost(&self) -> Option<&[Vector2<f64>]> {
        let wanted = self.view.ghost && self.simulation.method() != MethodKind::Linear;
        let linear = match &self.intro {
            Some(intro) => intro.linear().map(Simulation::displacement),
            None => self.linear_displacement(),
        };
        linear.filter(|_| wanted)
    }

    fn act(&mut self, ctx: &egui::Context, action: Action, requests: &mut Vec<Request>) {
        match action {
            Action::Open(id) => {
                self.depart(ctx, Departure::Open(Source { name: id.into(), assignments: Vec::new() }));
            }
            Action::OpenFile => self.depart(ctx, Departure::AskForFile),
            Action::Drop(path) => self.depart(ctx, Departure::Open(Source { name: path, assignments: Vec::new() })),
            Action::Reload => self.open(ctx, self.document.source.clone()),
            Action::Save => self.save_here(ctx),
            Action::SaveAs => self.ask_where_to_save(),
            Action::Undo => {
                let step = self.edits.undo(self.snapshot());
                self.go_to(ctx, step);
            }
            Action::Redo => {
                let step = self.edits.redo(self.snapshot());
                self.go_to(ctx, step);
            }
            Action::Escape if self.view.help => self.view.help = false,
            Action::Cancel => self.cancel_work(),
            Action::Escape if self.is_working() => self.cancel_work(),
            Action::Escape => self.probe = None,
            Action::Edit(label, scene) => {
                let before = self.snapshot();
                if let Err(error) = self.set_scene(*scene) {
                    self.panel.messages.insert(label, error.to_string());
                } else {
                    self.panel.messages.remove(label);
                    self.remember(before, Some(label));
                    self.blame(label);
                }
            }
            // What has come to its end has nothing to pause.
            Action::ToggleRun if self.running && self.input().ended => {}
            Action::ToggleRun => {
                self.running ^= true;
                if !self.running {
                    self.call_off();
                }
            }
            Action::Step | Action::Forward if self.compares_motions() => {
                self.running = false;
                self.motions.step();
            }
            Action::Step if self.view.mode == Mode::Compare => {
                self.running = false;
                self.compare.step();
            }
            Action::Step if self.is_beside() => {
                self.running = false;
                let start = if self.simulation.is_at_rest() { Beginning::AtRest } else { Beginning::There };
                self.restart_beside(start, Some(1));
            }
            Action::Step => {
                self.running = false;
                let ended = !self.moves() && self.simulation.is_at_rest();
                // On the card of the pseudocode a step goes to the next line, and one line iterates.
                let line = self.learn.as_ref().and_then(|learn| learn.next_line(&self.simulation, ended));
                if ended && line.is_none_or(|line| line == learn::AT_REST) {
                    self.reset();
                }
                if line.is_none_or(|line| line == learn::SOLVE) {
                    self.iterate(1);
                }
                if let (Some(learn), Some(line)) = (&mut self.learn, line) {
                    learn.line = line;
                }
            }
            Action::Scrub(_) | Action::Back | Action::Mark if self.compares_motions() => {}
            Action::Scrub(_) | Action::Back | Action::Forward if !self.moves() || self.is_beside() => {}
            Action::Scrub(time) => {
                self.running = false;
                self.playback.show_moment(time, &mut self.simulation);
                ctx.request_repaint();
            }
            Action::Back => {
                self.running = false;
                self.playback.show_neighbour(false, &mut self.simulation);
                ctx.request_repaint();
            }
            Action::Forward => {
                self.running = false;
                if !self.playback.show_neighbour(true, &mut self.simulation) {
                    self.iterate(1);
                }
                ctx.request_repaint();
            }
            Action::Reset => self.reset(),
            Action::Mark => {
                self.playback.mark(&self.simulation);
                let words = if self.playback.is_marked() { "Reset goes to here" } else { "Reset goes to the start" };
                self.say(ctx, tr(words).to_owned());
            }
            Action::Speed(speed) => {
                self.playback.pace.set_speed(speed);
                self.motions.pace.set_speed(speed);
            }
            Action::Compare(integrator) => self.compare_with(integrator),
            Action::Iterations(iterations) => self.iterations = iterations.clamp(1, MOST_ITERATIONS),
            Action::Fit => {
                self.eye.fit();
                self.compare.fit();
                self.motions.fit();
            }
            // The other kind has nothing to plot.
            Action::Toggle(Toggle::Drawer(drawer)) if drawer != Drawer::of(&self.scene) => {}
            Action::Toggle(what) => {
                self.view.toggle(what);
                self.enter_or_leave();
                ctx.request_repaint();
            }
            Action::Card(card) => {
                self.go_to_card(card);
                ctx.request_repaint();
            }
            Action::Color(field) => self.view.color_with(field),
            Action::ToggleTheme => {
                let dark = ctx.theme() == egui::Theme::Dark;
                ctx.set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Action::ToggleLanguage => self.settings.language = self.settings.language.other(),
            Action::Plot(plot) => {
                self.view.curve_plot = Some(plot);
                ctx.request_repaint();
            }
            Action::Export(figure, file) => {
                let words = match figure::save(&figure, file) {
                    Ok(path) => fill!("Saved %{file}", file = path.display()),
                    Err(reason) => fill!("Not saved: %{reason}", reason = translated(&reason.to_string())),
                };
                self.say(ctx, words);
                ctx.request_repaint();
            }
            Action::Screenshot => requests.push(Request::Screenshot),
            Action::Record => requests.push(Request::Record),
            Action::RecordScene => requests.push(Request::RecordScene),
            Action::Copy => self.copy(ctx),
            Action::CopyRust => self.copy_rust(ctx),
            Action::Measure(true) => {
                // Full studies of motions take many minutes.
                let extent = if self.learn.is_some() || self.moves() { Extent::Quick } else { Extent::Full };
                self.budget.measure(&self.scene, extent);
            }
            Action::Measure(false) => self.budget.cancel(),
            Action::Apply(scene, iterations) => {
                let before = self.snapshot();
                self.edit(ctx, *scene);
                self.iterations = iterations.clamp(1, MOST_ITERATIONS);
                self.remember(before, None);
            }
        }
    }

    /// The scene as it stands, to come back to.
    fn snapshot(&self) -> Snapshot {
        Snapshot { document: self.document.clone(), scene: self.scene.clone(), iterations: self.iterations }
    }

    /// Keeps how it was before something was changed, if it was.
    fn remember(&mut self, before: Snapshot, label: Option<&'static str>) {
        if before != self.snapshot() {
            self.edits.record(before, label);
        }
    }

    /// Goes to a step of the past or the future.
    fn go_to(&mut self, ctx: &egui::Context, step: Option<Snapshot>) {
        let Some(Snapshot { document, scene, iterations }) = step else { return };
        let gone = if document.source == self.document.source {
            self.panel.messages.clear();
            self.set_scene(scene)
        } else {
            self.adopt(document, scene)
        };
        match gone {
            Ok(()) => self.iterations = iterations,
            Err(error) => self.say(ctx, translated(&error.to_string())),
        }
    }

    fn reset(&mut self) {
        self.compare.reset();
        self.motions.reset();
        if self.is_beside() {
            return self.restart_beside(Beginning::AtRest, None);
        }
        self.playback.reset(&mut self.simulation);
        self.residuals.clear();
        self.swept = None;
        if let Some(learn) = &mut self.learn {
            learn.line = 0;
        }
    }

    /// Changes the scene under the body; it goes on from where it is if it can. A large one is taken on beside the
    /// window, and shown once something of it is known; what is wrong with its mesh is said then.
    ///
    /// # Errors
    /// What is wrong with the scene. The lab is unchanged then.
    pub fn set_scene(&mut self, scene: Scene) -> Result<(), SimulationError> {
        if self.goes_beside(&scene) {
            scene.validate()?;
            self.wish_for(scene);
            self.tend();
            return Ok(());
        }
        let before = self.simulation.scene().clone();
        self.simulation.change_scene(&scene)?;
        self.recall();
        if !has_mesh_of(&scene, &before) {
            self.drawing = Drawing::new(self.simulation.system().mesh());
        }
        self.scene = scene;
        self.take_over(&before);
        self.solve_linear();
        Ok(())
    }

    /// Makes everything beside the simulation belong to its scene, which was another one before.
    fn take_over(&mut self, before: &Scene) {
        self.intro = None;
        let scene = self.simulation.scene();
        if scene == before {
            return;
        }
        let is_another = !has_mesh_of(scene, before);
        if is_another {
            self.eye.set_body(self.simulation.system().mesh().bounds().into());
            self.probe = None;
        }
        let is_another = is_another || scene.analysis != before.analysis;
        if is_another {
            self.swept = None;
        }
        self.playback.follow(scene, is_another);
        self.frequency.forget();
        if question(before) != question(scene) {
            self.truth.forget();
        }
        self.curve.forget();
        self.jump.forget();
        self.view.drawer = self.view.drawer.map(|_| Drawer::of(scene));
    }

    /// Opens a scene in the place of the present one; says so where that fails.
    fn open(&mut self, ctx: &egui::Context, source: Source) {
        if let Err(error) = self.try_open(source) {
            self.say(ctx, translated(&error.to_string()));
        }
    }

    fn try_open(&mut self, source: Source) -> Result<(), OpenError> {
        let before = self.snapshot();
        let document = Document::open(source)?;
        let scene = document.original.clone();
        self.adopt(document, scene)?;
        if let Some(path) = self.document.path() {
            self.settings.add_recent(path);
        }
        self.remember(before, None);
        Ok(())
    }

    /// Takes a scene from somewhere else.
    fn adopt(&mut self, document: Document, scene: Scene) -> Result<(), SimulationError> {
        let beside = self.goes_beside(&scene);
        if beside {
            scene.validate()?;
            self.wish_for(scene);
            self.adopt_beside(document);
            return Ok(());
        }
        self.set_scene(scene)?;
        self.document = document;
        self.is_outdated = false;
        self.start_fresh();
        self.reset();
        Ok(())
    }

    /// Forgets what belonged to the scene before, also that it was paused.
    fn start_fresh(&mut self) {
        self.running = true;
        self.playback = Playback::default();
        self.panel.clear();
        self.budget = Budget::default();
        self.curve = Finder::new(|scene, _| Curve::of(scene));
        self.compare = Compare::default();
        self.motions = MotionCompare::default();
        self.iterations = 1;
        self.eye = Eye::new(self.simulation.system().mesh().bounds().into());
        self.probe = None;
        self.view.why = false;
        self.view.fixed_range = None;
        self.crossing = Crossing::default();
    }

    /// Saves the scene to a file; returns what there is to say of it, or why it failed.
    fn save(&mut self, path: &Path) -> Result<String, String> {
        self.document = self.document.save(&self.scene, path).map_err(|reason| translated(&reason.to_string()))?;
        self.settings.add_recent(path);
        self.is_outdated = false;
        Ok(fill!("Saved %{file}", file = path.display()))
    }

    /// Saves the scene to its file, or asks for one.
    fn save_here(&mut self, ctx: &egui::Context) {
        let Some(path) = self.document.path().map(Path::to_owned) else { return self.ask_where_to_save() };
        match self.save(&path) {
            Ok(words) => {
                self.say(ctx, words);
                self.after_save(ctx);
            }
            Err(reason) => {
                self.question = Question::None;
                self.say(ctx, fill!("Not saved: %{reason}", reason = reason));
            }
        }
    }

    fn ask_where_to_save(&mut self) {
        let name = self.document.path().and_then(Path::file_name).and_then(|name| name.to_str());
        let name = name.map_or_else(|| format!("{}.toml", self.document.source.name.display()), str::to_owned);
        let name = if name == "-.toml" { "scene.toml".to_owned() } else { name };
        self.dialog = Some(FileDialog::new(Purpose::Save, self.document.path(), &name));
    }

    /// Shows the dialog that asks for a file, and does what it answers.
    fn ask_for_file(&mut self, ctx: &egui::Context) {
        let Some(mut dialog) = self.dialog.take() else { return };
        let done = match dialog.show(ctx, self.settings.recent()) {
            None => Err(None),
            Some(Answer::Cancel) => {
                self.question = Question::None;
                Ok(None)
            }
            Some(Answer::File(path)) => match dialog.purpose {
                Purpose::Open => {
                    let source = Source { name: path, assignments: Vec::new() };
                    self.try_open(source).map(|()| None).map_err(|error| Some(error.to_string()))
                }
                Purpose::Save => self.save(&path).map(Some).map_err(Some),
            },
        };
        match done {
            Ok(None) => {}
            Ok(Some(words)) => {
                self.say(ctx, words);
                self.after_save(ctx);
            }
            Err(message) => {
                message.into_iter().for_each(|message| dialog.refuse(message));
                self.dialog = Some(dialog);
            }
        }
        if self.dialog.is_none() {
            ctx.request_repaint();
        }
    }

    /// Opens what is dropped on the window. When the window gets the focus, looks whether the scene's file has been
    /// written by somebody else, and offers it.
    fn hear_of_files(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let (dropped, is_back) = ctx.input(|i| {
            let dropped = i.raw.dropped_files.last().map(|file| file.path().to_owned());
            (dropped, i.events.contains(&egui::Event::WindowFocused(true)))
        });
        actions.extend(dropped.map(Action::Drop));
        self.is_outdated |= is_back && self.document.has_changed();
        if !self.is_outdated {
            return;
        }
        banner(ctx, "outdated", |ui| {
            ui.label(fill!("%{file} has changed on disk.", file = self.document.source.name.display()));
            if ui.button(tr("Reload")).clicked() {
                actions.push(Action::Reload);
            }
            if ui.button(tr("Keep this one")).clicked() {
                self.document.ignore_change();
                self.is_outdated = false;
            }
        });
    }

    fn solve_linear(&mut self) {
        let known = self.linear.take();
        self.linear = solve_linear(self.simulation.scene(), self.simulation.system(), known);
    }

    fn copy(&mut self, ctx: &egui::Context) {
        match self.scene.to_toml() {
            Ok(toml) => {
                ctx.copy_text(format!("# Save as scene.toml, then: warpbeam solve scene.toml\n{toml}"));
                self.say(ctx, tr("Scene copied as TOML").to_owned());
            }
            Err(error) => self.say(ctx, fill!("The scene could not be written as TOML: %{error}", error = error)),
        }
    }

    fn copy_rust(&mut self, ctx: &egui::Context) {
        ctx.copy_text(self.scene.to_rust(&self.document.source.folder()));
        self.say(ctx, tr("Scene copied as a Rust program").to_owned());
    }

    /// Paints the progress of the scene's recording.
    fn paint_recording(&self, ui: &Ui, painter: &egui::Painter, rect: Rect) {
        let Some(progress) = &self.recording else { return };
        let place = rect.center_bottom() - egui::vec2(0.0, 48.0);
        let color = ui.visuals().strong_text_color();
        boxed_text(painter, place, egui::Align2::CENTER_BOTTOM, progress, ui.visuals(), color, 400.0);
        ui.ctx().request_repaint_after(LISTEN);
    }

    /// Shows the progress of the scene's recording; `None` once it has ended.
    pub(crate) fn show_recording(&mut self, progress: Option<String>) {
        self.recording = progress;
    }

    /// Place that the scene comes from.
    pub(crate) fn source(&self) -> &Source {
        &self.document.source
    }

    /// Shows a message for a while.
    pub fn say(&mut self, ctx: &egui::Context, message: String) {
        self.toast = Some((message, ctx.input(|i| i.time) + TOAST.as_secs_f64()));
    }

    fn paint_toast(&mut self, ui: &Ui, painter: &egui::Painter, rect: Rect) {
        let Some((message, until)) = &self.toast else {
            return;
        };
        let left = until - ui.input(|i| i.time);
        if left <= 0.0 {
            self.toast = None;
            return;
        }
        boxed_text(
            painter,
            rect.center_bottom() - egui::vec2(0.0, 24.0),
            egui::Align2::CENTER_BOTTOM,
            message,
            ui.visuals(),
            ui.visuals().strong_text_color(),
            rect.width() - 48.0,
        );
        // For those who hear the window.
        let said = ui.interact(
            Rect::from_center_size(rect.center_bottom(), egui::Vec2::ZERO),
            egui::Id::unique("toast"),
            Sense::empty(),
        );
        said.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, message));
        ui.ctx().request_repaint_after(Duration::from_secs_f64(left.clamp(0.0, TOAST.as_secs_f64())));
    }
}

/// Where the nodes of a body are, m.
fn positions(simulation: &Simulation) -> Vec<Vector2<f64>> {
    simulation.system().mesh().nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u).collect()
}

/// Whether both have the same mesh.
fn has_mesh_of(scene: &Scene, other: &Scene) -> bool {
    scene.beam == other.beam && scene.mesh == other.mesh
}

/// The reference solution of a scene, where there is one.
fn find_reference(scene: &Scene, watch: Watch<'_>) -> Option<Reference> {
    Reference::find(scene, None, Effort::Bounded, &mut |progress| watch(progress.fraction)).ok()
}

/// The lowest natural frequency of a scene's body about rest, Hz.
fn natural_frequency(scene: &Scene) -> Option<f64> {
    let simulation = Simulation::new(scene).ok()?;
    let problem = simulation.problem();
    let mass = Mass::new(problem.system(), scene.material.area_density());
    Some(lowest_frequency(problem, &mass)? / std::f64::consts::TAU)
}

/// Shows a message with its answers in a row under the toolbar.
fn banner(ctx: &egui::Context, id: &str, contents: impl FnOnce(&mut Ui)) {
    let width = ctx.content_rect().width();
    let area = egui::Area::new(egui::Id::unique(id))
        .default_width(width - 24.0)
        .anchor(egui::Align2::CENTER_TOP, egui::vec2(0.0, toolbar::height(width) + 8.0));
    area.show(ctx, |ui| egui::Frame::popup(ui.style()).show(ui, |ui| ui.horizontal_wrapped(contents)));
}

/// Where plots are, under the body.
fn drawer_panel(ui: &Ui) -> Panel {
    let height = DRAWER_HEIGHT.min(DRAWER_SHARE * ui.ctx().content_rect().height());
    Panel::bottom("drawer").exact_size(height).resizable(false).frame(unfilled(ui))
}

/// A panel's frame without its background: the body's pass has filled that.
fn unfilled(ui: &Ui) -> egui::Frame {
    egui::Frame::side_top_panel(ui.style()).fill(Color32::TRANSPARENT)
}
