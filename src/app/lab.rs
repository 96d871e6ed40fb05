//! The lab: a scene, its simulation, and how it is looked at. Window, shot and tests show it through [`Lab::ui`].

use std::time::Duration;

use egui::{CentralPanel, Color32, Panel, Rect, Sense, Ui};
use nalgebra::Vector2;

use super::ThemeChoice;
use super::action::{Action, Drawer, MOST_ITERATIONS, ViewOptions};
use super::budget::{Budget, question};
use super::drawing::Drawing;
use super::finder::{Finder, LISTEN};
use super::motion_plot;
use super::overlay::{self, Overlay};
use super::panel::{self, PanelInput, PanelState, status_words};
use super::playback::Playback;
use super::pointer::{self, Look, Reach};
use super::quality::Quality;
use super::recorder::Recorder;
use super::{help, keys, plot};
use crate::assembly::Mass;
use crate::dynamics::lowest_frequency;
use crate::render::{Camera, Frame, Margins};
use crate::scene::{self, Analysis, IntegratorKind, MethodKind, Scene, SceneError, Source};
use crate::simulation::{Field, Simulation, SimulationError, Status};
use crate::state::State;
use crate::stress::{NodalStress, RecoveryScratch};
use crate::study::{LoadCurve, Reference, Study};
use crate::timings::Timings;

/// Width of the panel, points.
pub const PANEL_WIDTH: f32 = 324.0;

/// Points kept free around the body when the view is fitted: room for the load's arrow, the key above, the legend below.
const FIT_MARGINS: Margins = Margins { sides: 76.0, top: 84.0, bottom: 152.0 };

/// Height of what is shown under the body, points.
const DRAWER_HEIGHT: f32 = 270.0;

/// How long a message stays.
const TOAST: Duration = Duration::from_secs(4);

/// What the lab asks of the window that shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Save a picture.
    Screenshot,
}

/// Everything the window shows.
#[derive(Debug)]
pub struct Lab {
    source: Source,
    scene: Scene,
    simulation: Simulation,
    /// The same scene under linear theory; `None` where it could not be set up.
    linear: Option<Simulation>,
    running: bool,
    view: ViewOptions,
    panel: PanelState,
    /// `None`: follows the body.
    camera: Option<Camera>,
    fitted: Camera,
    view_rect: Rect,
    adapter: String,
    toast: Option<(String, f64)>,
    drawing: Drawing,
    shape: Shape,
    /// What errors are measured against; looked for when the body has come to rest.
    truth: Finder<Reference>,
    curve: Finder<LoadCurve>,
    budget: Budget,
    /// The lowest natural frequency, Hz.
    frequency: Finder<f64>,
    playback: Playback,
    /// Of a body in motion: all that it has swept, m.
    swept: Option<[Vector2<f64>; 2]>,
    recorder: Option<Recorder>,
    quality: Quality,
    /// Iterations a displayed frame.
    iterations: u32,
    /// Time of the last iterations made for one displayed frame.
    timings: Timings,
}

/// Why a scene is not shown.
#[derive(Debug, thiserror::Error)]
enum OpenError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// What is drawn of the body at present, kept between frames.
#[derive(Debug, Default)]
struct Shape {
    nodes: Vec<Vector2<f64>>,
    points: Vec<Vector2<f64>>,
    nodal: Option<NodalStress>,
    scratch: RecoveryScratch,
    /// At quadrature points or nodes.
    known: Vec<Option<f64>>,
    /// At the corners of what is drawn.
    values: Vec<[Option<f64>; 3]>,
    range: [f64; 2],
    /// What the range is of.
    field: Option<Field>,
    line_color: [u8; 4],
    background: [u8; 3],
    surround: [u8; 3],
    absent_color: [u8; 3],
}

impl Lab {
    /// A lab with this scene, iterating from rest.
    #[must_use]
    pub fn new(source: Source, scene: Scene, simulation: Simulation) -> Self {
        let drawing = Drawing::new(simulation.system().mesh());
        let mut lab = Self {
            source,
            linear: None,
            scene,
            simulation,
            running: true,
            view: ViewOptions::default(),
            panel: PanelState::default(),
            camera: None,
            fitted: Camera { center: Vector2::zeros(), scale: 1.0 },
            view_rect: Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1.0, 1.0)),
            adapter: String::new(),
            toast: None,
            drawing,
            shape: Shape::default(),
            truth: Finder::new(|scene| Reference::of(scene).ok()),
            curve: Finder::new(LoadCurve::new),
            budget: Budget::default(),
            frequency: Finder::new(natural_frequency),
            playback: Playback::default(),
            swept: None,
            recorder: None,
            quality: Quality::default(),
            iterations: 1,
            timings: Timings::default(),
        };
        lab.solve_linear();
        lab
    }

    /// Names what draws the lab.
    pub fn set_adapter(&mut self, adapter: String) {
        self.adapter = adapter;
    }

    /// Shows or hides the panel.
    pub fn set_panel(&mut self, shown: bool) {
        self.view.panel = shown;
    }

    /// Shows the load curve under the body.
    pub fn show_curve(&mut self) {
        self.view.drawer = Some(Drawer::Curve);
    }

    /// Shows a study under the body.
    pub fn show_study(&mut self, study: Study) {
        self.view.drawer = Some(Drawer::Budget);
        self.budget.set(&self.scene, study);
    }

    /// What has been measured of the scene, and whether more is being measured.
    #[must_use]
    pub fn study(&self) -> (Option<&Study>, bool) {
        (self.budget.study(), self.budget.runs())
    }

    /// Iterations a displayed frame.
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    /// Shows the body in a state of its own, if it is one.
    pub(super) fn restore(&mut self, state: &State) -> bool {
        self.simulation.restore(state).is_ok()
    }

    /// Looks through this camera, and colours with this range, whatever the body does.
    pub(super) fn fix_view(&mut self, camera: Camera, range: [f64; 2]) {
        self.camera = Some(camera);
        self.view.fixed_range = Some(range);
    }

    /// Shows or hides the outlines at rest and of the linear solution.
    pub fn set_outlines(&mut self, shown: bool) {
        self.view.rest_outline = shown;
        self.view.ghost = shown;
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

    /// The camera of the last [`Self::ui`].
    #[must_use]
    pub fn camera(&self) -> Camera {
        self.camera.unwrap_or(self.fitted)
    }

    /// Title for the window.
    #[must_use]
    pub fn title(&self) -> String {
        format!("{} \u{2013} warpbeam", self.scene.name)
    }

    /// Makes the iterations of one displayed frame if it runs, or the time steps that are due at `now`, s of any clock
    /// that goes with the wall's; says whether there are others to make.
    pub fn advance(&mut self, now: f64) -> bool {
        match (self.iterates(), self.moves()) {
            (true, true) => {
                self.playback.advance(now, &mut self.simulation);
                self.timings = *self.simulation.last_iteration();
            }
            (true, false) => self.iterate(self.iterations),
            (false, _) => self.playback.pace.rest(),
        }
        self.iterates()
    }

    /// Whether the scene is one in time.
    fn moves(&self) -> bool {
        self.scene.analysis == Analysis::Dynamic
    }

    /// So many iterations, or one time step.
    pub(super) fn iterate(&mut self, iterations: u32) {
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
            }
        }
    }

    /// Whether the next frame changes the body.
    #[must_use]
    pub fn iterates(&self) -> bool {
        self.running && (!self.simulation.is_at_rest() || self.playback.companions_move())
    }

    /// Iterates to the end, or steps to the end of the scene's duration, and finds out what is known of the result.
    pub fn solve(&mut self) {
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

    /// Sets the speed of a motion, simulated seconds a second: 1/8 to 1.
    pub fn set_speed(&mut self, speed: f64) {
        self.playback.pace.set_speed(speed);
    }

    /// Whether something is still being found out of the scene beside the window.
    #[must_use]
    pub fn is_searching(&self) -> bool {
        let open = match self.view.drawer {
            Some(Drawer::Curve) => self.curve.is_open(),
            Some(Drawer::Motion) => self.frequency.is_open(),
            _ => false,
        };
        open || self.truth.is_open() && !self.moves()
    }

    /// What is drawn of the body, as of the last [`Self::ui`].
    #[must_use]
    pub fn frame(&self) -> Frame<'_> {
        let shape = &self.shape;
        Frame {
            positions: &shape.points,
            triangles: &self.drawing.triangles,
            values: &shape.values,
            range: shape.range,
            lines: if self.view.wireframe { &self.drawing.lines } else { &[] },
            line_color: shape.line_color,
            background: shape.background,
            surround: shape.surround,
            absent_color: shape.absent_color,
        }
    }

    fn update_shape(&mut self, visuals: &egui::Visuals) {
        let shape = &mut self.shape;
        shape.nodes.clear();
        let rest = self.simulation.system().mesh().nodes();
        shape.nodes.extend(rest.iter().zip(self.simulation.displacement()).map(|(x, u)| x + u));
        let nodes = &shape.nodes;
        self.drawing.points(&|n| nodes[n as usize], &mut shape.points);
        let field = self.view.field;
        if self.view.raw || field.is_of_elements() {
            self.simulation.field(field, &mut shape.known);
            self.drawing.values(&shape.known, &mut shape.values);
        } else {
            self.simulation.smooth_field(field, (&mut shape.nodal, &mut shape.scratch), &mut shape.known);
            self.drawing.nodal_values(&shape.known, field.period(), &mut shape.values);
        }
        let range = panel::range_of(&shape.known);
        // Colours that jump from frame to frame say nothing of a motion: its range only grows.
        let before = self.swept.map(|_| shape.range).filter(|_| shape.field == Some(self.view.field));
        let grown = before.map_or(range, |[low, high]| [low.min(range[0]), high.max(range[1])]);
        shape.field = Some(self.view.field);
        shape.range = self.view.fixed_range.unwrap_or(grown);
        shape.background = if visuals.dark_mode { [22, 24, 28] } else { [244, 245, 247] };
        // What is behind panels: these fill nothing themselves, which is dear where a processor draws.
        let [r, g, b, _] = visuals.panel_fill.to_array();
        shape.surround = [r, g, b];
        shape.absent_color = if visuals.dark_mode { [90, 90, 96] } else { [170, 170, 176] };
        shape.line_color = if visuals.dark_mode { [0, 0, 0, 110] } else { [0, 0, 0, 90] };
    }

    /// Sizes and colours that the defaults get wrong here.
    fn style(ctx: &egui::Context) {
        ctx.all_styles_mut(|style| {
            style.text_styles.insert(egui::TextStyle::Small, egui::FontId::proportional(11.0));
        });
    }

    /// Shows everything but the body, which is drawn under it, and does what was asked for.
    pub fn ui(&mut self, ui: &mut Ui) -> Vec<Request> {
        Self::style(ui.ctx());
        let mut actions = Vec::new();
        self.find_out(ui.ctx());
        self.budget.listen(ui.ctx());
        if self.view.panel {
            let input = PanelInput {
                truth: self.truth.get(),
                quality: &self.quality,
                scene: &self.scene,
                scene_name: self.source.name.to_str().unwrap_or_default(),
                simulation: &self.simulation,
                running: self.running,
                playback: &self.playback,
                iterations: self.iterations,
                timings: &self.timings,
                adapter: &self.adapter,
            };
            let panel = Panel::left("panel").exact_size(PANEL_WIDTH).resizable(false).frame(unfilled(ui));
            panel.show(ui, |ui| panel::show(ui, &input, &mut self.panel, &mut self.view, &mut actions));
        }
        actions.extend(keys::actions(ui.ctx(), self.view.help));
        self.drawer(ui, &mut actions);
        let mut requests = Vec::new();
        for action in actions {
            self.act(ui.ctx(), action, &mut requests);
        }
        CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.body_view(ui));
        help::show(ui.ctx(), &mut self.view.help);
        if self.iterates() {
            ui.ctx().request_repaint();
        }
        requests
    }

    /// Looks for what is known of the scene and of its result, once the body is at rest: a dragged slider need not wait.
    fn find_out(&mut self, ctx: &egui::Context) {
        if self.moves() {
            if self.view.drawer == Some(Drawer::Motion) {
                self.frequency.ask(&self.scene, ctx);
            }
            return;
        }
        if self.iterates() {
            return;
        }
        self.simulation.certify();
        self.quality.follow(&self.simulation);
        self.truth.ask(&self.scene, ctx);
        if self.view.drawer == Some(Drawer::Curve) {
            self.curve.ask(&self.scene, ctx);
        }
    }

    fn drawer(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let Some(drawer) = self.view.drawer else { return };
        let panel = Panel::bottom("drawer").exact_size(DRAWER_HEIGHT).resizable(false).frame(unfilled(ui));
        panel.show(ui, |ui| match drawer {
            Drawer::Curve => plot::show(ui, self.curve.get(), !self.curve.is_open()),
            Drawer::Motion => {
                let frequency = self.frequency.get().copied();
                let integrator = self.scene.dynamics.integrator;
                motion_plot::show(ui, &mut self.view.motion_plot, &self.playback, integrator, frequency);
            }
            Drawer::Budget => self.budget.show(ui, &self.scene, self.iterations, actions),
        });
    }

    /// Takes a scene that should be as good as the present one; says so where it is not.
    fn edit(&mut self, ctx: &egui::Context, scene: Scene) {
        if let Err(error) = self.set_scene(scene) {
            self.say(ctx, error.to_string());
        }
    }

    fn body_view(&mut self, ui: &mut Ui) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        self.view_rect = rect;
        // What is pressed is what was seen: the last picture.
        let reach = Reach { camera: self.camera(), positions: &self.shape.nodes, outline: &self.drawing.boundary };
        let holds = pointer::hold(ui, &response, &reach, &mut self.simulation, &mut self.playback);
        self.update_shape(ui.visuals());
        self.follow(rect);
        match pointer::look(ui, &response, self.camera(), holds) {
            Look::Same => {}
            Look::At(camera) => self.camera = Some(camera),
            Look::Fit => self.camera = None,
        }
        let painter = ui.painter_at(rect);
        let (words, bad) = status_words(&self.simulation, true);
        let overlay = Overlay {
            scene: &self.scene,
            system: self.simulation.system(),
            drawing: &self.drawing,
            options: &self.view,
            camera: self.camera(),
            positions: &self.shape.nodes,
            ghost: self.ghost(),
            time: self.simulation.state().time(),
            hand: self.simulation.hand(),
            playback: &self.playback,
            color_range: self.shape.range,
            warning: bad.then_some(&words),
        };
        overlay::paint(&painter, rect, &overlay, ui.visuals());
        self.paint_recording(ui, &painter, rect);
        self.paint_toast(ui, &painter, rect);
    }

    /// Fits the view to the body at rest and now, while nobody has moved it.
    fn follow(&mut self, rect: Rect) {
        // A view that moved with the body would move the place under a pointer that holds it.
        if self.simulation.hand().is_some() {
            return;
        }
        let mesh = self.simulation.system().mesh();
        let (mut low, mut high) = mesh.bounds();
        if let (Some([swept_low, swept_high]), true) = (self.swept, self.moves()) {
            (low, high) = (low.inf(&swept_low), high.sup(&swept_high));
        }
        let mut include = |positions: &mut dyn Iterator<Item = Vector2<f64>>| {
            for p in positions {
                low = low.inf(&p);
                high = high.sup(&p);
            }
        };
        include(&mut self.shape.points.iter().copied());
        self.swept = Some([low, high]).filter(|_| self.moves());
        self.fitted = self.fit(low, high, [f64::from(rect.width()), f64::from(rect.height())]);
    }

    /// The camera that shows a box, m, and the linear solution beside it, in a view of this size, points.
    pub(super) fn fit(&self, mut low: Vector2<f64>, mut high: Vector2<f64>, view: [f64; 2]) -> Camera {
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
        Camera::fit(low, high, view, FIT_MARGINS)
    }

    /// The linear solution, if it is to be shown.
    fn ghost(&self) -> Option<&[Vector2<f64>]> {
        let wanted = self.view.ghost && self.scene.solver.method != MethodKind::Linear;
        self.linear_displacement().filter(|_| wanted)
    }

    fn act(&mut self, ctx: &egui::Context, action: Action, requests: &mut Vec<Request>) {
        match action {
            Action::Open(id) => self.open(ctx, id),
            Action::Edit(label, scene) => {
                if let Err(error) = self.set_scene(*scene) {
                    self.panel.messages.insert(label, error.to_string());
                } else {
                    self.panel.messages.remove(label);
                }
            }
            Action::ToggleRun => self.running ^= true,
            Action::Step => {
                self.running = false;
                self.iterate(1);
            }
            Action::Reset => self.reset(),
            Action::Mark => {
                self.playback.mark(&self.simulation);
                let words = if self.playback.is_marked() { "Reset goes to here" } else { "Reset goes to the start" };
                self.say(ctx, words.to_owned());
            }
            Action::Speed(speed) => self.playback.pace.set_speed(speed),
            Action::Compare(integrator) => self.compare_with(integrator),
            Action::Iterations(iterations) => self.iterations = iterations.clamp(1, MOST_ITERATIONS),
            Action::Fit => self.camera = None,
            Action::Toggle(what) => self.view.toggle(what),
            Action::Color(field) => self.view.color_with(field),
            Action::ToggleTheme => {
                let dark = ctx.theme() == egui::Theme::Dark;
                ctx.set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Action::Screenshot => requests.push(Request::Screenshot),
            Action::Record => self.record(ctx),
            Action::Copy => self.copy(ctx),
            Action::Measure(true) => self.budget.measure(&self.scene),
            Action::Measure(false) => self.budget.cancel(),
            Action::Apply(setting) => {
                self.edit(ctx, setting.apply(&self.scene));
                self.iterations = setting.iterations.clamp(1, MOST_ITERATIONS);
            }
        }
    }

    fn reset(&mut self) {
        self.playback.reset(&mut self.simulation);
        self.swept = None;
    }

    /// Changes the scene under the body; it goes on from where it is if it can.
    ///
    /// # Errors
    /// What is wrong with the scene. The lab is unchanged then.
    pub fn set_scene(&mut self, scene: Scene) -> Result<(), SimulationError> {
        self.simulation.change_scene(&scene)?;
        let is_another = self.scene.beam != scene.beam || self.scene.mesh != scene.mesh;
        if is_another {
            self.drawing = Drawing::new(self.simulation.system().mesh());
        }
        let is_another = is_another || self.scene.analysis != scene.analysis;
        if is_another {
            self.swept = None;
        }
        self.playback.follow(&scene, is_another);
        self.frequency.forget();
        if question(&self.scene) != question(&scene) {
            self.truth.forget();
        }
        self.curve.forget();
        self.scene = scene;
        self.solve_linear();
        Ok(())
    }

    fn open(&mut self, ctx: &egui::Context, id: &str) {
        let source = Source { name: id.into(), assignments: Vec::new() };
        let opened = scene::open(&source).map_err(OpenError::from).and_then(|scene| Ok(self.set_scene(scene)?));
        match opened {
            Ok(()) => {
                self.source = source;
                self.playback = Playback::default();
                self.reset();
                self.panel.clear();
                self.budget = Budget::default();
                self.iterations = 1;
                self.camera = None;
                self.view.fixed_range = None;
            }
            Err(error) => self.say(ctx, error.to_string()),
        }
    }

    fn solve_linear(&mut self) {
        if self.scene.analysis == Analysis::Dynamic {
            self.linear = None;
            return;
        }
        let scene = Scene {
            solver: scene::SolverSettings { method: MethodKind::Linear, ..self.scene.solver.clone() },
            ..self.scene.clone()
        };
        // On the body's own equations: nothing of them is made twice.
        let system = self.simulation.system();
        let shared = self.linear.as_mut().filter(|linear| std::sync::Arc::ptr_eq(linear.system(), system));
        let reused = shared.is_some_and(|linear| linear.change_scene(&scene).is_ok());
        if !reused {
            self.linear = Simulation::with_system(&scene, system.clone()).ok();
        }
        if let Some(linear) = &mut self.linear {
            linear.solve();
        }
    }

    fn copy(&mut self, ctx: &egui::Context) {
        match self.scene.to_toml() {
            Ok(toml) => {
                ctx.copy_text(format!("# Save as scene.toml, then: warpbeam solve scene.toml\n{toml}"));
                self.say(ctx, "Scene copied as TOML".to_owned());
            }
            Err(error) => self.say(ctx, format!("The scene could not be written as TOML: {error}")),
        }
    }

    /// Records the scene beside the window, or ends the recording that is made.
    fn record(&mut self, ctx: &egui::Context) {
        if let Some(recorder) = &self.recorder {
            return recorder.stop();
        }
        let theme = if ctx.theme() == egui::Theme::Dark { ThemeChoice::Dark } else { ThemeChoice::Light };
        match Recorder::start(self.source.clone(), self.scene.clone(), theme) {
            Ok(recorder) => self.recorder = Some(recorder),
            Err(reason) => self.say(ctx, format!("No recording: {reason}")),
        }
    }

    /// Shows how far the recording is.
    fn paint_recording(&mut self, ui: &Ui, painter: &egui::Painter, rect: Rect) {
        let Some(recorder) = &mut self.recorder else { return };
        if let Some(words) = recorder.listen() {
            self.recorder = None;
            return self.say(ui.ctx(), words);
        }
        let words = format!("{}: {:.0} % (V stops it)", recorder.words, 100.0 * recorder.fraction);
        let place = rect.center_bottom() - egui::vec2(0.0, 48.0);
        let color = ui.visuals().strong_text_color();
        overlay::boxed_text(painter, place, egui::Align2::CENTER_BOTTOM, &words, ui.visuals(), color, 400.0);
        ui.ctx().request_repaint_after(LISTEN);
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
        overlay::boxed_text(
            painter,
            rect.center_bottom() - egui::vec2(0.0, 24.0),
            egui::Align2::CENTER_BOTTOM,
            message,
            ui.visuals(),
            ui.visuals().strong_text_color(),
            rect.width() - 48.0,
        );
        ui.ctx().request_repaint_after(Duration::from_secs_f64(left.clamp(0.0, TOAST.as_secs_f64())));
    }
}

/// The lowest natural frequency of a scene's body about rest, Hz.
fn natural_frequency(scene: &Scene) -> Option<f64> {
    let simulation = Simulation::new(scene).ok()?;
    let problem = simulation.problem();
    let mass = Mass::new(problem.system(), scene.material.area_density());
    Some(lowest_frequency(problem, &mass)? / std::f64::consts::TAU)
}

/// A panel's frame without its background: the body's pass has filled that.
fn unfilled(ui: &Ui) -> egui::Frame {
    egui::Frame::side_top_panel(ui.style()).fill(Color32::TRANSPARENT)
}
