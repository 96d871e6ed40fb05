//! Comparison of two to four integrators, elements or meshes in motion side by side: one load, one clock, one camera,
//! one colour range.

use egui::{Panel, Rect, RichText, Role, Sense, Ui, WidgetInfo, vec2};
use nalgebra::Vector2;
use web_time::Instant;

use super::grid::{self, Grid, PaneBody, PaneChange, PaneInput, Preset, grow};
use super::setting::PANES;
use super::{mesh_picker, pick};
use crate::app::language::{fill, joined, percent, said, sentence, tr};
use crate::app::session::clock::{FRAMES, RealTimeClock};
use crate::app::session::playback::Playback;
use crate::app::viewport::arrow::Forces;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::overlay;
use crate::app::viewport::pointer::{HitTargets, Interaction, Pointer};
use crate::app::viewport::projection::Projection;
use crate::app::widgets::palette::Palette;
use crate::dynamics::INTEGRATORS;
use crate::format::{engineering, three_digits, two_digits};
use crate::render::display_geometry::DisplayGeometry;
use crate::render::{Camera, Margins, View};
use crate::scene::{ElementKind, IntegratorKind, Scene};
use crate::sentence::Sentence;
use crate::simulation::{Motion, Simulation, Status, probe_results};

/// Settings of a pane; `None` means the setting of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionPaneSetting {
    /// Integrator.
    pub integrator: Option<IntegratorKind>,
    /// Element.
    pub element: Option<ElementKind>,
    /// Cells along and across.
    pub cells: Option<[u32; 2]>,
}

impl MotionPaneSetting {
    fn of_integrator(integrator: IntegratorKind) -> Self {
        Self { integrator: Some(integrator), ..Self::default() }
    }

    fn of_element(element: ElementKind) -> Self {
        Self { element: Some(element), ..Self::default() }
    }

    /// Returns the scene with these settings.
    #[must_use]
    pub fn apply(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.dynamics.integrator = self.integrator.unwrap_or(scene.dynamics.integrator);
        scene.set_element(self.element.unwrap_or(scene.element()));
        if let (Some(beam), Some(cells)) = (&mut scene.beam, self.cells) {
            beam.cells = cells;
        }
        scene
    }
}

/// Motion with settings of its own.
#[derive(Debug)]
pub struct MotionPane {
    setting: MotionPaneSetting,
    /// Scene with the settings, as set in the simulation.
    scene: Option<Scene>,
    simulation: Option<Box<Simulation>>,
    /// Reason for which there is no simulation.
    refused: Option<Sentence>,
    /// Computing time of a step, s: an exponentially weighted mean.
    seconds: Option<f64>,
    geometry: DisplayGeometry,
    body_mesh: BodyMesh,
    /// Colour range of this pane alone; all panes are drawn with a common range that contains it.
    range: [f64; 2],
    place: Option<Rect>,
    pointer: Pointer,
}

impl MotionPane {
    fn new(setting: MotionPaneSetting) -> Self {
        Self {
            setting,
            scene: None,
            simulation: None,
            refused: None,
            seconds: None,
            geometry: DisplayGeometry::default(),
            body_mesh: BodyMesh::default(),
            range: [0.0; 2],
            place: None,
            pointer: Pointer::default(),
        }
    }

    /// Returns the settings of the pane.
    #[must_use]
    pub fn setting(&self) -> &MotionPaneSetting {
        &self.setting
    }

    /// Returns the simulation; `None` if the scene cannot be set up with these settings.
    #[must_use]
    pub fn simulation(&self) -> Option<&Simulation> {
        self.simulation.as_deref()
    }

    /// Returns the area of the body in the window, points.
    #[must_use]
    pub fn place(&self) -> Option<Rect> {
        self.place
    }

    /// Applies a changed scene. Returns `true` if the motion has to restart, because integrator, element or mesh have
    /// changed.
    fn follow(&mut self, scene: &Scene) -> bool {
        let wanted = self.setting.apply(scene);
        if self.scene.as_ref() == Some(&wanted) {
            return false;
        }
        let before = self.scene.as_ref().filter(|_| self.simulation.is_some());
        let goes_on = before.is_some_and(|before| {
            (&before.beam, &before.mesh, &before.dynamics) == (&wanted.beam, &wanted.mesh, &wanted.dynamics)
        });
        let made = match self.simulation.take().filter(|_| goes_on) {
            Some(mut simulation) => simulation.change_scene(&wanted).map(|()| simulation),
            None => Simulation::new(&wanted).map(Box::new),
        };
        self.refused = made.as_ref().err().map(Sentence::from);
        self.simulation = made.ok();
        if let (Some(simulation), false) = (&self.simulation, goes_on) {
            self.geometry = DisplayGeometry::new(simulation.system().mesh());
            self.body_mesh = BodyMesh::default();
            self.seconds = None;
        }
        self.scene = Some(wanted);
        !goes_on
    }

    /// Returns `true` if the pane has a motion that has not become unstable.
    fn is_sound(&self) -> bool {
        self.simulation.as_ref().is_some_and(|simulation| !matches!(simulation.status(), Status::Stopped(_)))
    }

    fn moves(&self) -> bool {
        self.simulation.as_ref().is_some_and(|simulation| !simulation.is_at_rest())
    }

    fn step(&mut self) {
        const FADING: f64 = 0.95;
        let is_stopped = |simulation: &Simulation| matches!(simulation.status(), Status::Stopped(_));
        let Some(simulation) = self.simulation.as_mut().filter(|simulation| !is_stopped(simulation)) else { return };
        let begun = Instant::now();
        simulation.step();
        let seconds = begun.elapsed().as_secs_f64();
        self.seconds = Some(self.seconds.map_or(seconds, |mean| FADING * mean + (1.0 - FADING) * seconds));
    }

    /// Returns the displacement of the first probe, m.
    fn tip(&self) -> Option<Vector2<f64>> {
        let simulation = self.simulation.as_ref()?;
        Some(probe_results(simulation.problem(), simulation.state()).first()?.u)
    }
}

/// Panes of motions, their clock and their camera.
#[derive(Debug)]
pub(crate) struct MotionCompare {
    panes: Vec<MotionPane>,
    pub clock: RealTimeClock,
    controller: Option<CameraController>,
    /// Bounding box of all states of the bodies so far, m.
    swept: Option<[Vector2<f64>; 2]>,
    /// Playing time, s: longer than the simulated time in slow motion.
    played: f64,
    still: Playback,
}

impl Default for MotionCompare {
    fn default() -> Self {
        let mut compare = Self {
            panes: Vec::new(),
            clock: RealTimeClock::default(),
            controller: None,
            swept: None,
            played: 0.0,
            still: Playback::default(),
        };
        compare.set(&integrators());
        compare
    }
}

/// Returns settings with the first three implicit integrators of the registry.
fn integrators() -> Vec<MotionPaneSetting> {
    INTEGRATORS.iter().filter(|i| !i.is_explicit()).take(3).map(|i| MotionPaneSetting::of_integrator(i.kind)).collect()
}

impl MotionCompare {
    pub(crate) fn panes(&self) -> &[MotionPane] {
        &self.panes
    }

    /// Compares these settings, at most four.
    fn set(&mut self, settings: &[MotionPaneSetting]) {
        self.panes = settings.iter().take(*PANES.end()).map(|&setting| MotionPane::new(setting)).collect();
        (self.controller, self.swept) = (None, None);
    }

    /// Returns `true` while a body moves.
    pub(crate) fn moves(&self) -> bool {
        self.panes.iter().any(MotionPane::moves)
    }

    /// Restarts all motions.
    pub(crate) fn reset(&mut self) {
        self.panes.iter_mut().filter_map(|pane| pane.simulation.as_mut()).for_each(|simulation| simulation.reset());
        self.swept = None;
        self.clock.rest();
    }

    /// Fits the camera to all bodies.
    pub(crate) fn fit(&mut self) {
        self.controller.iter_mut().for_each(CameraController::fit);
    }

    /// Makes one time step in all panes.
    pub(crate) fn step(&mut self) {
        let time_step = |pane: &MotionPane| pane.scene.as_ref().map(|scene| scene.dynamics.time_step);
        self.played += self.panes.iter().find_map(time_step).unwrap_or_default() / self.clock.speed();
        self.panes.iter_mut().for_each(MotionPane::step);
    }

    /// Applies the scene, and makes the time steps that are due at `now`, s. All panes are at the same time: a slow one
    /// slows all of them down.
    pub(crate) fn advance(&mut self, scene: &Scene, now: f64, running: bool) {
        let mut starts_over = false;
        for pane in &mut self.panes {
            starts_over |= pane.follow(scene);
        }
        if starts_over {
            self.reset();
        }
        if !running || !self.moves() {
            return self.clock.rest();
        }
        let step = scene.dynamics.time_step;
        let mut steps = self.clock.begin_steps(now, step);
        while self.moves() && steps.next() {
            self.step();
        }
        self.clock.end_steps(&steps, step);
    }

    pub(crate) fn camera(&self) -> Camera {
        self.controller.as_ref().map_or(Camera { center: Vector2::zeros(), scale: 1.0 }, CameraController::camera)
    }

    /// Returns the bodies of the panes for the render pass.
    pub(crate) fn views(&self, wireframe: bool, pixels_per_point: f32) -> Vec<View<'_>> {
        let camera = self.camera();
        let seen = self.panes.iter().filter_map(|pane| {
            grid::view(pane.place, (&pane.body_mesh, &pane.geometry), camera, wireframe, pixels_per_point)
        });
        seen.collect()
    }

    /// Shows the presets above the panes.
    pub(crate) fn bars(&mut self, ui: &mut Ui, input: &PaneInput<'_>) {
        if !input.view.bars {
            return;
        }
        let elements: Vec<ElementKind> = input.scene.elements().collect();
        let presets = [
            Preset {
                name: tr("integrators").to_owned(),
                settings: integrators(),
                enabled: true,
                tip: "Three integrators on the panel's mesh",
                unless: "",
            },
            Preset {
                name: elements.iter().map(|element| element.id()).collect::<Vec<_>>().join(" | "),
                settings: elements.iter().map(|&element| MotionPaneSetting::of_element(element)).collect(),
                enabled: elements.len() > 1,
                tip: "All elements that the mesh can have, with the panel's integrator",
                unless: "The mesh of this file can have one element only",
            },
        ];
        let frame = egui::Frame::NONE.inner_margin(egui::Margin::symmetric(12, 4));
        Panel::top("presets").resizable(false).frame(frame).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                let present: Vec<_> = self.panes.iter().map(|pane| pane.setting).collect();
                if let Some(settings) = grid::preset_buttons(ui, &present, presets) {
                    self.set(&settings);
                }
                if grid::add_button(ui, self.panes.len()) {
                    let used = |kind| present.iter().any(|setting| setting.integrator == Some(kind));
                    let unused = INTEGRATORS.iter().map(|entry| entry.kind).find(|&kind| !used(kind));
                    self.panes.push(MotionPane::new(unused.map(MotionPaneSetting::of_integrator).unwrap_or_default()));
                }
                let time = self.panes.iter().find_map(|pane| Some(pane.simulation()?.state().time()));
                ui.label(RichText::new(fill!("t = %{time}", time = format!("{:.2} s", time.unwrap_or(0.0)))));
            });
        });
    }

    /// Shows the panes; returns the pointer's interaction with their load.
    pub(crate) fn show(&mut self, ui: &mut Ui, input: &PaneInput<'_>) -> Interaction {
        for pane in &mut self.panes {
            if let Some(simulation) = &pane.simulation {
                pane.body_mesh.range = pane.range;
                pane.body_mesh.update(simulation, &pane.geometry, input.view, Some(self.played));
                pane.range = pane.body_mesh.range;
            }
            pane.body_mesh.color(ui.visuals(), input.view.field);
        }
        let ranges = self.panes.iter().filter(|pane| pane.is_sound()).map(|pane| pane.range);
        let shared = input.view.fixed_range.unwrap_or(grid::common_range(ranges));
        self.panes.iter_mut().for_each(|pane| pane.body_mesh.range = shared);
        let whole = ui.available_rect_before_wrap();
        let Grid { cells, key } = Grid::new(whole, self.panes.len());
        for (pane, cell) in self.panes.iter_mut().zip(&cells) {
            pane.place = Some(grid::body_place(*cell));
        }
        self.look(ui, input);
        let (change, interaction) = grid::show_panes(ui, &cells, (self, input), Self::header, Self::body);
        grid::color_key(ui, key, key.left(), input.view, shared);
        match change {
            Some((number, Some(setting))) => {
                if let Some(pane) = self.panes.get_mut(number) {
                    *pane = MotionPane::new(setting);
                    ui.ctx().request_repaint();
                }
            }
            Some((number, None)) if self.panes.len() > *PANES.start() => _ = self.panes.remove(number),
            _ => {}
        }
        ui.advance_cursor_after_rect(whole);
        interaction
    }

    /// Fits the camera to all states of the bodies so far, unless the user has moved it.
    fn look(&mut self, ui: &Ui, input: &PaneInput<'_>) {
        let Some(size) = grid::common_size(self.panes.iter().filter_map(MotionPane::place)) else { return };
        let Some(first) = self.panes.iter().find_map(MotionPane::simulation) else { return };
        let rest = first.system().mesh().bounds().into();
        let sound = self.panes.iter().filter(|pane| pane.is_sound());
        let swept = sound.flat_map(|pane| pane.body_mesh.points()).fold(self.swept.unwrap_or(rest), grow);
        self.swept = Some(swept);
        let controller = self.controller.get_or_insert_with(|| CameraController::new(rest));
        if !self.panes.iter().any(|pane| pane.pointer.holds()) {
            controller.follow(swept);
        }
        let margins = Margins { sides: 40.0, top: 40.0, bottom: 44.0 };
        grid::aim(ui, controller, |[low, high]| Camera::fit(low, high, size, margins), input.eases);
    }

    /// Shows the pickers of a pane, and its result.
    fn header(&self, ui: &mut Ui, number: usize, input: &PaneInput<'_>, change: &mut PaneChange<MotionPaneSetting>) {
        let Some(pane) = self.panes.get(number) else { return };
        let palette = Palette::new(ui.visuals());
        let name = fill!("Pane %{n}", n = number + 1);
        ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
        ui.horizontal(|ui| {
            let integrator = pane.setting.integrator.unwrap_or(input.scene.dynamics.integrator);
            let (bar, _) = ui.allocate_exact_size(vec2(10.0, 18.0), Sense::hover());
            ui.painter().rect_filled(bar, 3.0, palette.integrator(integrator));
            let mut setting = pane.setting;
            let close = self.panes.len() > *PANES.start() && input.view.bars;
            let room = ui.available_width() - if close { 34.0 } else { 0.0 } - 12.0;
            let widths = [0.4, 0.18, 0.26].map(|share| (share * room).clamp(30.0, 150.0));
            let panels = (input.scene.dynamics.integrator.id(), "as in the panel");
            let entries = INTEGRATORS.iter().map(|entry| (entry.kind, entry.id, entry.about));
            pick(ui, &palette, (&name, "integrator"), widths[0], (&mut setting.integrator, panels), entries);
            let elements = input.scene.elements().map(|e| (e, e.id(), e.entry().about));
            let panels = (input.scene.element().id(), "as in the panel");
            pick(ui, &palette, (&name, "element"), widths[1], (&mut setting.element, panels), elements);
            mesh_picker(ui, &palette, &name, widths[2], &mut setting.cells, input.scene);
            if setting != pane.setting {
                *change = Some((number, Some(setting)));
            }
            if close && grid::close_button(ui, number) {
                *change = Some((number, None));
            }
        });
        self.result(ui, &name, number, pane);
    }

    /// Shows the computing time of a frame, the energy drift, and the distance of the first probe from that of the
    /// first pane; or the reason for which there are none.
    fn result(&self, ui: &mut Ui, name: &str, number: usize, pane: &MotionPane) {
        let palette = Palette::new(ui.visuals());
        let failure = pane.refused.as_ref().map(said).or_else(|| match pane.simulation()?.status() {
            Status::Stopped(reason) => Some(said(reason)),
            _ => None,
        });
        let text = failure.as_deref().map_or_else(|| self.numbers(number, pane), sentence);
        let color = if failure.is_some() { palette.error } else { palette.text };
        let response = ui.add(egui::Label::new(RichText::new(&text).color(color)).truncate());
        let spoken = format!("{name}: {text}");
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &spoken));
        response.on_hover_text(tr(
            "Computing time of a frame at 60 Hz; energy that the integrator has added; distance of the first probe \
             from the first pane's at the same time",
        ));
    }

    fn numbers(&self, number: usize, pane: &MotionPane) -> String {
        let step = pane.scene.as_ref().map_or(1.0, |scene| scene.dynamics.time_step);
        let cost = pane.seconds.map(|seconds| {
            let frame = seconds / step / FRAMES;
            fill!("%{time} a frame", time = engineering(two_digits(frame), "s"))
        });
        let drift = pane.simulation().and_then(Simulation::motion).map(Motion::ledger).map(|ledger| {
            let drift = 100.0 * ledger.drift_of_input();
            let text = if drift.abs() < 1e-6 { "0 %".to_owned() } else { percent(drift) };
            fill!("drift %{drift}", drift = text)
        });
        let first = self.panes.first().filter(|_| number > 0).and_then(MotionPane::tip);
        let apart = first.zip(pane.tip()).map(|(first, own)| {
            fill!("tip differs by %{distance}", distance = engineering(three_digits((own - first).norm()), "m"))
        });
        joined(cost.into_iter().chain(drift).chain(apart))
    }

    /// Shows the overlays of a pane's body.
    fn body(&mut self, ui: &Ui, number: usize, place: Rect, input: &PaneInput<'_>) -> Interaction {
        let (camera, Some(controller)) = (self.camera(), &mut self.controller) else { return Interaction::default() };
        let Some(pane) = self.panes.get_mut(number) else { return Interaction::default() };
        let Some(simulation) = pane.simulation.as_deref() else { return Interaction::default() };
        let forces = Forces {
            scene: simulation.scene(),
            system: simulation.system(),
            positions: &pane.body_mesh.nodes,
            time: simulation.state().time(),
            direction: input.direction,
            opening: input.opening,
        };
        let handles = forces.handles(&Projection { camera, rect: place });
        let reach = HitTargets {
            mesh: Some(simulation.system().mesh()),
            camera,
            positions: &pane.body_mesh.nodes,
            outline: &pane.geometry.boundary,
            handles: &handles,
            scales: controller.scales([place.width(), place.height()].map(f64::from)),
        };
        let wish = grid::follow(ui, (number, place), &mut pane.pointer, &reach, controller);
        let Some(pane) = self.panes.get(number) else { return wish };
        let Some(simulation) = pane.simulation() else { return wish };
        let palette = Palette::new(ui.visuals());
        let painter = ui.painter_at(place);
        let (geometry, body_mesh, hot) = (&pane.geometry, &pane.body_mesh, pane.pointer.hot_handle());
        let (scene, system, time) = (simulation.scene(), simulation.system(), simulation.state().time());
        let camera = self.camera();
        PaneBody { scene, system, geometry, body_mesh, exact: &[], time, hot }.paint(
            ui,
            place,
            camera,
            input,
            &self.still,
        );
        if number == 0 {
            overlay::scale_bar(&painter, place, &camera, &palette);
        }
        if !pane.is_sound() {
            painter.rect_filled(place, 0.0, palette.canvas.gamma_multiply(0.55));
        }
        wish
    }
}
