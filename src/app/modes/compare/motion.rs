//! Comparison of two to four integrators, elements or meshes in motion side by side: one load, one clock, one camera,
//! one colour range.

use egui::{Color32, Panel, Rect, RichText, Role, Ui, WidgetInfo};
use nalgebra::Vector2;

use super::grid::{self, Preset, grow};
use super::panes::{self, ComparedPane, Condition, PaneChange, PaneDisplay, PaneInput, Panes};
use super::setting::PaneSetting;
use crate::app::diagnosis::drift_text;
use crate::app::language::{fill, joined, said, sentence, tr};
use crate::app::session::clock::{FRAMES, RealTimeClock};
use crate::app::session::compared_motion::ComparedMotion;
use crate::app::session::compared_solve::Equations;
use crate::app::session::facts::MotionTimeFact;
use crate::app::task::keyed::Keyed;
use crate::app::task::thread::QUIET_POLL;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::pointer::Interaction;
use crate::app::widgets::palette::Palette;
use crate::dynamics::INTEGRATORS;
use crate::format::{engineering, three_digits, two_digits};
use crate::render::{Camera, Margins, View};
use crate::scene::{ElementKind, Scene};
use crate::simulation::{Motion, Simulation};
use crate::state::largest;

/// Motion with settings of its own.
#[derive(Debug)]
pub struct MotionPane {
    setting: PaneSetting,
    motion: ComparedMotion,
    display: PaneDisplay,
    /// Computing time per simulated second, ms.
    time: Keyed<MotionTimeFact>,
}

impl MotionPane {
    /// Returns the settings of the pane.
    #[must_use]
    pub fn setting(&self) -> &PaneSetting {
        &self.setting
    }

    /// Returns the simulation; `None` if the scene cannot be set up with these settings.
    #[must_use]
    pub fn simulation(&self) -> Option<&Simulation> {
        self.motion.simulation()
    }

    /// Returns the computing time of a frame at 60 Hz, s; `None` until it has been measured.
    #[must_use]
    pub fn frame_seconds(&self) -> Option<f64> {
        Some(self.time.get(self.motion.scene()?)? / 1e3 / FRAMES)
    }

    /// Requests the computing time; returns `true` while it is pending.
    fn request_time(&mut self) -> bool {
        let scene = self.motion.scene().filter(|_| self.motion.is_sound());
        scene.is_some_and(|scene| self.time.request(scene))
    }

    /// Returns the area of the body in the window, points.
    #[must_use]
    pub fn place(&self) -> Option<Rect> {
        self.display.place
    }
}

impl ComparedPane for MotionPane {
    fn new(setting: PaneSetting) -> Self {
        Self { setting, motion: ComparedMotion::default(), display: PaneDisplay::default(), time: Keyed::default() }
    }

    fn own_setting(&self) -> PaneSetting {
        self.setting
    }

    fn color(&self, scene: &Scene, palette: &Palette) -> Color32 {
        palette.integrator(self.setting.integrator.unwrap_or(scene.dynamics.integrator))
    }

    fn change_setting(&mut self, setting: PaneSetting) {
        *self = Self::new(setting);
    }

    fn display(&self) -> &PaneDisplay {
        &self.display
    }

    fn condition(&self) -> Condition {
        if self.motion.is_setting_up() {
            Condition::Outdated
        } else if self.motion.is_sound() {
            Condition::Result
        } else {
            Condition::Failed
        }
    }

    fn parts(&mut self) -> (Option<(&Scene, f64)>, &mut PaneDisplay) {
        let displayed = self.motion.simulation().map(|simulation| (simulation.scene(), simulation.state().time()));
        (displayed, &mut self.display)
    }
}

/// Panes of motions, and their clock.
#[derive(Debug)]
pub(crate) struct MotionCompare {
    panes: Panes<MotionPane>,
    pub clock: RealTimeClock,
    /// Bounding box of all states of the bodies so far, m.
    swept: Option<[Vector2<f64>; 2]>,
    /// Number of panes whose motions have not stopped early.
    sound: usize,
    /// Largest displacement of the bodies so far, m: an automatic magnification that followed a motion would hide it.
    largest_displacement: f64,
    /// Playing time, s: longer than the simulated time in slow motion.
    played: f64,
    /// `true` while the computing time of a pane is measured: the motions wait, because they would slow it down.
    pub is_timing: bool,
}

impl Default for MotionCompare {
    fn default() -> Self {
        Self {
            panes: Panes::new(&integrators()),
            clock: RealTimeClock::default(),
            swept: None,
            sound: 0,
            largest_displacement: 0.0,
            played: 0.0,
            is_timing: false,
        }
    }
}

/// Returns settings with the first three implicit integrators of the registry.
fn integrators() -> Vec<PaneSetting> {
    INTEGRATORS.iter().filter(|i| !i.is_explicit()).take(3).map(|i| PaneSetting::of_integrator(i.kind)).collect()
}

impl MotionCompare {
    pub(crate) fn panes(&self) -> &[MotionPane] {
        &self.panes.list
    }

    fn motions(&mut self) -> impl Iterator<Item = &mut ComparedMotion> {
        self.panes.list.iter_mut().map(|pane| &mut pane.motion)
    }

    /// Returns `true` while a body moves.
    pub(crate) fn moves(&self) -> bool {
        self.panes.list.iter().any(|pane| pane.motion.moves()) || self.is_setting_up()
    }

    /// Returns `true` while the motion of a pane is set up in the background.
    fn is_setting_up(&self) -> bool {
        self.panes.list.iter().any(|pane| pane.motion.is_setting_up())
    }

    /// Restarts all motions.
    pub(crate) fn reset(&mut self) {
        self.motions().for_each(ComparedMotion::reset);
        (self.swept, self.largest_displacement) = (None, 0.0);
        self.clock.rest();
    }

    /// Fits the camera to all bodies.
    pub(crate) fn fit(&mut self) {
        self.swept = None;
        self.panes.fit();
    }

    /// Makes one time step in all panes.
    pub(crate) fn step(&mut self) {
        let time_step = self.panes.list.iter().find_map(|pane| Some(pane.motion.scene()?.dynamics.time_step));
        self.played += time_step.unwrap_or_default() / self.clock.speed();
        self.motions().for_each(ComparedMotion::step);
    }

    /// Applies the scene, and makes the time steps that are due at `now`, s. All panes are at the same time: a slow one
    /// slows all of them down, and they wait for those that are being set up or timed. `own` are the equations of the body
    /// in Explore.
    pub(crate) fn advance(&mut self, scene: &Scene, own: &Equations, now: f64, running: bool) {
        let mut starts_over = false;
        let known = self.panes.list.iter().filter_map(|pane| pane.motion.equations());
        let mut equations: Vec<Equations> = std::iter::once(own.clone()).chain(known).collect();
        for pane in &mut self.panes.list {
            starts_over |= pane.motion.set_scene(pane.setting.apply(scene), &equations);
            equations.extend(pane.motion.equations());
        }
        if starts_over {
            self.reset();
        }
        if !running || self.is_setting_up() || self.is_timing || !self.moves() {
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
        self.panes.camera()
    }

    /// Returns `true` if the user has moved the camera.
    pub(crate) fn is_moved(&self) -> bool {
        self.panes.is_moved()
    }

    /// Returns the bodies of the panes for the render pass.
    pub(crate) fn views(&self, wireframe: bool, pixels_per_point: f32) -> Vec<View<'_>> {
        self.panes.views(wireframe, pixels_per_point)
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
                settings: elements.iter().map(|&element| PaneSetting::of_element(element)).collect(),
                enabled: elements.len() > 1,
                tip: "All elements that the mesh can have, with the panel's integrator",
                unless: "The mesh of this file can have one element only",
            },
        ];
        let frame = egui::Frame::NONE.inner_margin(egui::Margin::symmetric(12, 4));
        Panel::top("presets").resizable(false).frame(frame).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                let present = self.panes.settings();
                if let Some(settings) = grid::preset_buttons(ui, &present, presets) {
                    self.panes.set(&settings);
                    self.swept = None;
                }
                if grid::add_button(ui, present.len()) {
                    let used = |kind| present.iter().any(|setting| setting.integrator == Some(kind));
                    // An explicit integrator may explode at the time step of the others.
                    let unused = INTEGRATORS.iter().filter(|entry| !used(entry.kind)).min_by_key(|e| e.is_explicit());
                    let unused = unused.map(|entry| entry.kind);
                    self.panes.add(unused.map(PaneSetting::of_integrator).unwrap_or_default());
                }
                let time = self.panes().iter().find_map(|pane| Some(pane.simulation()?.state().time()));
                ui.label(RichText::new(fill!("t = %{time}", time = format!("{:.2} s", time.unwrap_or(0.0)))));
            });
        });
    }

    /// Shows the panes; returns the pointer's interaction with their load.
    pub(crate) fn show(&mut self, ui: &mut Ui, input: &PaneInput<'_>) -> Interaction {
        self.magnify(input);
        let mut known = vec![input.own.clone()];
        for MotionPane { motion, display, .. } in &mut self.panes.list {
            known.extend(motion.equations());
            if let Some(simulation) = motion.simulation() {
                display.update(simulation, (input.view, None), self.panes.magnification, Some(self.played), &known);
                known.extend(display.equations(simulation.scene()));
            }
            display.body_mesh.color(ui.visuals(), input.view.field);
        }
        let range = self.panes.share_colors(input.view, |pane| pane.motion.is_sound());
        let whole = ui.available_rect_before_wrap();
        let layout = self.panes.lay_out(ui, 0);
        self.fit_camera(ui, input);
        // One pane after the other is timed, after a drag.
        self.is_timing =
            !ui.input(|i| i.pointer.any_down()) && self.panes.list.iter_mut().any(MotionPane::request_time);
        if self.is_timing {
            ui.ctx().request_repaint_after(QUIET_POLL);
        }
        let interaction =
            self.panes.show(ui, &layout, (input, &[]), |panes, ui, number| header(panes, ui, number, input));
        let left = grid::magnification_key(ui, layout.key, self.panes.magnification);
        grid::color_key(ui, layout.key, left, input.view, range);
        ui.advance_cursor_after_rect(whole);
        interaction
    }

    /// Sets the common factor of the drawn displacement; the largest displacement of all sound motions so far counts.
    fn magnify(&mut self, input: &PaneInput<'_>) {
        let sound = self.panes.list.iter().filter(|pane| pane.motion.is_sound());
        let bodies = sound.filter_map(MotionPane::simulation);
        let now = bodies.map(|body| largest(body.displacement())).fold(0.0, f64::max);
        self.largest_displacement = self.largest_displacement.max(now);
        let factor = input.view.magnification.factor(input.own.system().size(), self.largest_displacement);
        if self.panes.magnification != factor {
            (self.panes.magnification, self.swept) = (factor, None);
        }
    }

    /// Fits the camera to all states of the bodies so far, unless the user has moved it.
    fn fit_camera(&mut self, ui: &Ui, input: &PaneInput<'_>) {
        /// Distance up to which the camera follows points, in sizes of the body.
        const LARGEST_REACH: f64 = 3.0;
        let Some(size) = self.panes.common_size() else { return };
        let Some(first) = self.panes().iter().find_map(MotionPane::simulation) else { return };
        let rest: [Vector2<f64>; 2] = first.system().mesh().bounds().into();
        // The states of a motion that is about to explode would hide the others.
        let reach = LARGEST_REACH * (rest[1] - rest[0]).norm();
        let is_near = |p: &&Vector2<f64>| (*p - rest[0]).norm() < reach;
        let sound = || self.panes.list.iter().filter(|pane| pane.motion.is_sound());
        // A body that has left is not looked for.
        let count = sound().count();
        if count < self.sound {
            self.swept = None;
        }
        self.sound = count;
        let points = sound().flat_map(|pane| pane.display.body_mesh.points()).filter(is_near);
        let swept = points.fold(self.swept.unwrap_or(rest), grow);
        self.swept = Some(swept);
        let holds = self.panes.holds();
        let controller = self.panes.controller.get_or_insert_with(|| CameraController::new(rest));
        if !holds {
            controller.set_whole(swept);
        }
        let margins = Margins { sides: 40.0, top: 40.0, bottom: 44.0 };
        self.panes.aim(ui, |[low, high]| Camera::fit(low, high, size, margins), input.eases);
    }
}

/// Shows the pickers of a pane, and its result.
fn header(panes: &Panes<MotionPane>, ui: &mut Ui, number: usize, input: &PaneInput<'_>) -> PaneChange {
    let (pane, scene) = (panes.list.get(number)?, input.scene);
    let palette = Palette::new(ui.visuals());
    let color = pane.color(scene, &palette);
    let widths = ([0.5, 0.2, 0.3], 190.0);
    let change = panes.show_pickers(ui, (number, color), input, widths, |ui, name, widths, setting| {
        let entries = INTEGRATORS.iter().map(|entry| (entry.kind, entry.id, entry.about));
        let panels = (scene.dynamics.integrator.id(), "as in the panel");
        grid::pick(ui, &palette, (name, "integrator"), widths[0], (&mut setting.integrator, panels), entries);
        grid::element_picker(ui, &palette, name, widths[1], &mut setting.element, scene);
        grid::mesh_picker(ui, &palette, name, widths[2], &mut setting.cells, scene);
    });
    let first = panes.list.first().filter(|_| number > 0);
    result(ui, &panes::pane_name(number), pane, first);
    change
}

/// Shows the computing time of a frame, the energy drift, and the distance of the first probe from that of the `first`
/// pane; or the reason for which there are none.
fn result(ui: &mut Ui, name: &str, pane: &MotionPane, first: Option<&MotionPane>) {
    let palette = Palette::new(ui.visuals());
    let failure = pane.motion.failure();
    let text = failure.as_ref().map_or_else(|| numbers(pane, first), |reason| sentence(&said(reason)));
    let color = if failure.is_some() { palette.error } else { palette.text };
    let response = ui.add(egui::Label::new(RichText::new(&text).color(color)).truncate());
    let spoken = format!("{name}: {text}");
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &spoken));
    response.on_hover_text(tr(
        "Computing time of a frame at 60 Hz, as in Measure; energy that the integrator has added; distance of the \
         first probe from the first pane's at the same time",
    ));
}

fn numbers(pane: &MotionPane, first: Option<&MotionPane>) -> String {
    let cost = pane.frame_seconds().map(|frame| fill!("%{time} a frame", time = engineering(two_digits(frame), "s")));
    let drift = pane
        .simulation()
        .and_then(Simulation::motion)
        .map(Motion::ledger)
        .map(|ledger| fill!("drift %{drift}", drift = drift_text(ledger.drift_of_input())));
    let apart = first.and_then(|first| first.motion.tip()).zip(pane.motion.tip()).map(|(first, own)| {
        fill!("%{distance} from pane 1", distance = engineering(three_digits((own - first).norm()), "m"))
    });
    joined(cost.into_iter().chain(drift).chain(apart))
}
