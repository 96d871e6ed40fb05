//! Public interface of the lab: read and set by the window, screenshots, recordings and tests.

use super::*;
use crate::app::ThemeChoice;
use crate::app::language;
use crate::app::modes::compare::{Pane, PaneSetting};
use crate::app::modes::learn;
use crate::app::shell::settings::Settings;
use crate::app::viewport::camera_controller::Box2;
use crate::app::widgets::palette;
use crate::render::Frame;
use crate::simulation::SimulationError;
use crate::study::Study;

impl Lab {
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
        let (facts, scene) = (session.facts(), session.scene());
        let plots = view.drawer == Some(Drawer::Section) && self.desk.sections.is_pending();
        let at_rest = facts.reference.is_pending(scene) || facts.path.is_pending(scene) || facts.time.is_pending(scene);
        let at_rest = at_rest || (self.learns_rho() || session.lacks_rho()) && facts.rho.is_pending(scene);
        let at_rest = !session.is_motion() && at_rest;
        let measures = measure.is_pending(scene, view);
        session.is_working() || session.facts().certifying.is_some() || plots || measures || at_rest
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
