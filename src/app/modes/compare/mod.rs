//! Comparison of two to four settings side by side: one load, one camera, one colour range, and the load curve under
//! them.

use std::sync::Arc;

use egui::{
    Align2, Color32, ComboBox, Context, FontId, Panel, Rect, RichText, Role, Sense, Ui, WidgetInfo, pos2, vec2,
};
use nalgebra::Vector2;
use web_time::{Duration, Instant};

use self::grid::{Grid, PaneBody, PaneChange, Preset, grow};
use self::pane::{Doing, Equations, FrameConditions};
use self::setting::PANES;
use self::trace::Trace;
use crate::app::action::Action;
use crate::app::diagnosis::{error_color, reference_text};
use crate::app::language::{count, fill, percent, said, sentence, tr};
use crate::app::panel::PANEL_WIDTH;
use crate::app::session::playback::Playback;
use crate::app::task::thread::POLL;
use crate::app::view_options::ViewOptions;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::overlay;
use crate::app::viewport::pointer::{HitTargets, Interaction};
use crate::app::viewport::projection::Projection;
use crate::app::widgets::buttons::{Icon, choice, icon_button};
use crate::app::widgets::legend::Mark;
use crate::app::widgets::palette::{BODY, HEADLINE, Palette, SMALL};
use crate::app::widgets::text::{UNKNOWN, semibold};
use crate::assembly::System;
use crate::format::{engineering, two_digits};
use crate::method::METHODS;
use crate::render::{Camera, Margins, View};
use crate::scene::{ElementKind, MethodKind, Scene};
use crate::study::{Reference, Setting};

mod grid;
mod motion;
mod pane;
mod setting;
pub(crate) mod trace;

pub(crate) use grid::PaneInput;
pub(crate) use motion::MotionCompare;
pub use motion::{MotionPane, MotionPaneSetting};
pub use pane::{Pane, PaneEnd};
pub use setting::{PaneSetting, PaneSettingError, parse_panes};

/// Time for the iterations of all panes between two frames.
const WORK: Duration = Duration::from_millis(12);
/// Height of the load curve, points, and its largest fraction of the window's height.
const TRACE_HEIGHT: f32 = 190.0;
const TRACE_SHARE: f32 = 0.28;
/// In a window lower than this, points, the load curve is hidden unless the user opens it.
const LOW: f32 = 560.0;
/// Limit of the same kind for panes in two rows, points.
const LOW_FOR_TWO_ROWS: f32 = 680.0;

/// Input of the comparison of equilibria.
pub(crate) struct CompareInput<'a> {
    pub common: PaneInput<'a>,
    /// Scene that the existing equations belong to.
    pub shown: &'a Scene,
    pub system: &'a Arc<System>,
    pub reference: Option<&'a Reference>,
    pub running: bool,
    /// Setting that Budget has chosen.
    pub chosen: Option<Setting>,
}

/// Panes, and their common state.
#[derive(Debug)]
pub(crate) struct Compare {
    panes: Vec<Pane>,
    trace: Trace,
    /// `true` if the load curve is shown; `None` means if there is room.
    shows_trace: Option<bool>,
    /// Camera of all panes; `None` before the first frame.
    controller: Option<CameraController>,
    /// Empty playback, because bodies at rest have no past.
    still: Playback,
}

impl Default for Compare {
    fn default() -> Self {
        let mut compare = Self {
            panes: Vec::new(),
            trace: Trace::default(),
            shows_trace: None,
            controller: None,
            still: Playback::default(),
        };
        compare.set(&METHODS_PRESET.map(PaneSetting::of_method));
        compare
    }
}

const METHODS_PRESET: [MethodKind; 3] = [MethodKind::Linear, MethodKind::Warped, MethodKind::Newton];

impl Compare {
    pub(crate) fn panes(&self) -> &[Pane] {
        &self.panes
    }

    pub(crate) fn traced(&self) -> Vec<(PaneSetting, [f64; 3])> {
        self.trace.dots()
    }

    /// Compares these settings, at most four.
    pub(crate) fn set(&mut self, settings: &[PaneSetting]) {
        self.panes = settings.iter().take(*PANES.end()).map(|&setting| Pane::new(setting)).collect();
        self.fit();
    }

    fn settings(&self) -> Vec<PaneSetting> {
        self.panes.iter().map(|pane| pane.setting).collect()
    }

    /// Returns the camera of all panes.
    pub(crate) fn camera(&self) -> Camera {
        self.controller.as_ref().map_or(Camera { center: Vector2::zeros(), scale: 1.0 }, CameraController::camera)
    }

    /// Fits the camera to all bodies.
    pub(crate) fn fit(&mut self) {
        self.controller.iter_mut().for_each(CameraController::fit);
    }

    /// Restarts all panes from rest.
    pub(crate) fn reset(&mut self) {
        self.panes.iter_mut().for_each(Pane::reset);
    }

    /// Makes one iteration in all panes that have not ended; if all have, restarts them from rest.
    pub(crate) fn step(&mut self) {
        if !self.is_iterating() {
            self.reset();
        }
        self.panes.iter_mut().for_each(Pane::step);
    }

    /// Returns `true` if a pane is still iterating.
    pub(crate) fn is_iterating(&self) -> bool {
        self.panes.iter().any(|pane| !pane.is_settled())
    }

    /// Returns the existing equations that the panes can share.
    fn equations(&self, scene: &Scene, system: &Arc<System>) -> Vec<Equations> {
        let own = std::iter::once(Equations::new(scene, system));
        let panes = self.panes.iter().filter_map(|pane| {
            let simulation = pane.simulation()?;
            Some(Equations::new(simulation.scene(), simulation.system()))
        });
        own.chain(panes).collect()
    }

    /// Solves all panes, and waits for them.
    pub(crate) fn settle(&mut self, scene: &Scene, system: &Arc<System>) {
        self.trace.follow(scene);
        for i in 0..self.panes.len() {
            let equations = self.equations(scene, system);
            self.panes[i].settle(scene, &equations);
            self.trace.record(scene, &self.panes[i]);
        }
        self.trace.settle(scene);
    }

    /// Returns the bodies of the panes for the render pass.
    pub(crate) fn views(&self, wireframe: bool, pixels_per_point: f32) -> Vec<View<'_>> {
        let camera = self.camera();
        let seen = self.panes.iter().filter_map(|pane| {
            grid::view(pane.place, (&pane.body_mesh, &pane.geometry), camera, wireframe, pixels_per_point)
        });
        seen.collect()
    }

    fn advance(&mut self, ctx: &Context, input: &CompareInput<'_>) {
        let (moves, holds) = ctx.input(|i| (i.pointer.delta() != egui::Vec2::ZERO, i.pointer.any_down()));
        self.trace.follow(input.common.scene);
        let equations =
            if self.is_changed(input.common.scene) { self.equations(input.shown, input.system) } else { Vec::new() };
        let mut is_new = false;
        let share = WORK / u32::try_from(self.panes.len().max(1)).unwrap_or(1);
        for pane in &mut self.panes {
            let until = Instant::now() + share;
            pane.advance(input.common.scene, &equations, FrameConditions { moves, holds, runs: input.running, until });
            is_new |= self.trace.record(input.common.scene, pane);
            pane.judge(input.reference);
        }
        if !holds || !moves {
            self.trace.ask(input.common.scene, ctx);
        }
        self.trace.record_reference(input.reference);
        let busy = |pane: &Pane| !pane.is_settled() && !pane.is_away() && !pane.waits();
        if is_new || input.running && self.panes.iter().any(busy) {
            ctx.request_repaint();
        } else if self.panes.iter().any(Pane::is_away) {
            ctx.request_repaint_after(POLL);
        }
    }

    /// Returns `true` if a pane has a new scene or has not ended.
    fn is_changed(&self, scene: &Scene) -> bool {
        self.panes.iter().any(|pane| pane.scene() != Some(&pane.setting.apply(scene)) || !pane.is_settled())
    }

    /// Shows the presets above the panes, and the load curve under them.
    pub(crate) fn bars(&mut self, ui: &mut Ui, input: &CompareInput<'_>, actions: &mut Vec<Action>) {
        let height = ui.ctx().content_rect().height();
        let panel = if input.common.view.bars && input.common.view.panel && !input.common.view.narrow {
            PANEL_WIDTH
        } else {
            0.0
        };
        let one_row = grid::first_row(self.panes.len(), ui.ctx().content_rect().width() - panel) == self.panes.len();
        let low = if one_row { LOW } else { LOW_FOR_TWO_ROWS };
        let shows_trace = self.shows_trace.unwrap_or(height >= low);
        let frame = egui::Frame::NONE.inner_margin(egui::Margin::symmetric(12, 4));
        if input.common.view.bars {
            Panel::top("presets").resizable(false).frame(frame).show(ui, |ui| self.presets(ui, input, shows_trace));
        }
        if shows_trace {
            let height = TRACE_HEIGHT.min(TRACE_SHARE * height);
            let panel = Panel::bottom("trace").exact_size(height).resizable(false).frame(frame);
            panel.show(ui, |ui| {
                self.trace.show(ui, input.common.scene, &self.panes, input.common.view.curve_plot, actions);
            });
        }
    }

    fn presets(&mut self, ui: &mut Ui, input: &CompareInput<'_>, shows_trace: bool) {
        let elements: Vec<ElementKind> = input.common.scene.elements().collect();
        let join = |names: Vec<&str>| names.join(" | ");
        let methods = join(METHODS_PRESET.iter().map(|method| tr(method.id())).collect());
        let meshed = join(elements.iter().map(|element| element.id()).collect());
        let method = (input.common.scene.solver.method == MethodKind::Warped).then_some(MethodKind::Newton);
        let chosen = [PaneSetting::default(), input.chosen.map(PaneSetting::from).unwrap_or_default()];
        let presets = [
            Preset {
                name: methods,
                settings: METHODS_PRESET.map(PaneSetting::of_method).to_vec(),
                enabled: true,
                tip: "Three methods on the panel's mesh",
                unless: "",
            },
            Preset {
                name: meshed,
                settings: elements
                    .iter()
                    .map(|&element| PaneSetting { method, ..PaneSetting::of_element(element) })
                    .collect(),
                enabled: elements.len() > 1,
                tip: "All elements that the mesh can have, with the panel's method; newton in place of warped, which \
                      may diverge",
                unless: "The mesh of this file can have one element only",
            },
            Preset {
                name: tr("current | budget").to_owned(),
                settings: chosen.to_vec(),
                enabled: input.chosen.is_some(),
                tip: "The current setting next to the fastest that meets the limits of Budget",
                unless: "Measure in Budget first: its fastest setting is compared with the current one",
            },
        ];
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            if let Some(settings) = grid::preset_buttons(ui, &self.settings(), presets) {
                self.set(&settings);
            }
            if grid::add_button(ui, self.panes.len()) {
                let used = |method: MethodKind| self.panes.iter().any(|pane| pane.setting.method == Some(method));
                let unused = METHODS.iter().map(|entry| entry.kind).find(|&method| !used(method));
                self.panes.push(Pane::new(unused.map(PaneSetting::of_method).unwrap_or_default()));
                self.fit();
            }
            let icon = if shows_trace { Icon::Close } else { Icon::Open };
            let button = icon_button(ui, icon, tr("Load curve"), Some(tr("Load curve")), shows_trace);
            if button.on_hover_text(tr("The load curve, drawn while the load is dragged")).clicked() {
                self.shows_trace = Some(!shows_trace);
            }
        });
    }

    /// Shows the panes; returns the pointer's interaction with their load.
    pub(crate) fn show(&mut self, ui: &mut Ui, input: &CompareInput<'_>) -> Interaction {
        self.advance(ui.ctx(), input);
        for pane in &mut self.panes {
            pane.update_shape(input.common.view, ui.visuals());
        }
        self.share_colors(input.common.view);
        let whole = ui.available_rect_before_wrap();
        let Grid { cells, key } = Grid::new(whole, self.panes.len());
        for (pane, cell) in self.panes.iter_mut().zip(&cells) {
            pane.place = Some(grid::body_place(*cell));
        }
        self.look(ui, input);
        let (change, interaction) = grid::show_panes(ui, &cells, (self, input), Self::header, Self::body);
        self.show_values(ui, input.common.view);
        self.key(ui, key, input.common.view);
        match change {
            Some((number, Some(setting))) => {
                if let Some(pane) = self.panes.get_mut(number) {
                    pane.set(setting);
                    ui.ctx().request_repaint();
                }
            }
            Some((number, None)) if self.panes.len() > *PANES.start() => {
                self.panes.remove(number);
                self.fit();
                ui.ctx().request_repaint();
            }
            _ => {}
        }
        ui.advance_cursor_after_rect(whole);
        interaction
    }

    /// Shows the values at the point of the body under the pointer, in every pane.
    fn show_values(&self, ui: &Ui, view: &ViewOptions) {
        let under = self.panes.iter().enumerate().find_map(|(number, pane)| Some((number, pane.under_pointer()?)));
        let Some((number, (rest, at))) = under else { return };
        for (i, pane) in self.panes.iter().enumerate() {
            pane.show_value(ui, view, rest, self.camera(), (i == number).then_some(at));
        }
    }

    /// Gives all panes the same colour range: that of the equilibria.
    fn share_colors(&mut self, view: &ViewOptions) {
        let any = self.panes.iter().any(|pane| pane.range.is_some() && !pane.has_failed());
        let counted = self.panes.iter().filter(|pane| !any || !pane.has_failed()).filter_map(|pane| pane.range);
        let range = view.fixed_range.unwrap_or(grid::common_range(counted));
        self.panes.iter_mut().for_each(|pane| pane.body_mesh.range = range);
    }

    /// Fits the camera to all bodies and the reference solution, unless the user has moved it. Panes that have not
    /// converged are ignored.
    fn look(&mut self, ui: &Ui, input: &CompareInput<'_>) {
        let Some(size) = grid::common_size(self.panes.iter().filter_map(Pane::place)) else { return };
        let (low, high) = input.system.mesh().bounds();
        let rest = [low, high];
        let iterates = self.is_iterating();
        let margins = self.margins(input, size);
        let controller = self.controller.get_or_insert_with(|| CameraController::new(rest));
        if !self.panes.iter().any(|pane| pane.pointer.holds()) {
            let reference = input.reference.filter(|_| input.common.view.exact);
            let mut bounds = reference.into_iter().flat_map(|reference| &reference.outline).flatten().fold(rest, grow);
            let is_linear = |pane: &Pane| pane.scene().is_some_and(|s| s.solver.method == MethodKind::Linear);
            let (linear, others): (Vec<&Pane>, Vec<&Pane>) =
                self.panes.iter().filter(|pane| pane.is_sound()).partition(|pane| is_linear(pane));
            bounds = others.iter().flat_map(|pane| pane.body_mesh.points()).fold(bounds, grow);
            // The solution of linear theory may be so large that the other bodies would be shown too small.
            const LARGEST: f64 = 1.5;
            let size_of = |[low, high]: [Vector2<f64>; 2]| (high - low).norm();
            let with = linear.iter().flat_map(|pane| pane.body_mesh.points()).fold(bounds, grow);
            let known = !others.is_empty() || reference.is_some();
            if !known || size_of(with) < LARGEST * size_of(bounds) {
                bounds = with;
            }
            if !iterates || controller.whole() == rest {
                controller.set_body(rest);
                controller.follow(bounds);
            }
        }
        grid::aim(ui, controller, |[low, high]| Camera::fit(low, high, size, margins), input.common.eases);
    }

    /// Returns the margins around the bodies when the camera is fitted, points: room for supports, load arrows and
    /// their labels.
    fn margins(&self, input: &CompareInput<'_>, [width, height]: [f64; 2]) -> Margins {
        let place = Rect::from_min_size(egui::Pos2::ZERO, vec2(width as f32, height as f32));
        let forces = self.panes.first().and_then(|pane| pane.forces(input.common.direction, input.common.opening));
        let arrows = forces.map(|forces| forces.arrows(&Projection { camera: self.camera(), rect: place }));
        let longest = |along: fn(egui::Vec2) -> f32| {
            arrows.iter().flatten().map(|arrow| f64::from(along(arrow.vector))).fold(0.0, f64::max)
        };
        let (top, bottom) = ((0.08 * height).min(30.0), (0.16 * height).min(44.0));
        Margins { sides: 40.0, top: top + longest(|vector| -vector.y), bottom: bottom + longest(|vector| vector.y) }
    }

    /// Shows the pickers of a pane, and its result.
    fn header(&self, ui: &mut Ui, number: usize, input: &CompareInput<'_>, change: &mut PaneChange<PaneSetting>) {
        let Some(pane) = self.panes.get(number) else { return };
        let palette = Palette::new(ui.visuals());
        let shown = pane.setting.of(input.common.scene);
        let name = fill!("Pane %{n}", n = number + 1);
        ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
        ui.horizontal(|ui| {
            let color = shown.method.map_or(palette.text, |method| palette.method(method));
            let (bar, _) = ui.allocate_exact_size(vec2(10.0, 18.0), Sense::hover());
            ui.painter().rect_filled(bar, 3.0, color);
            let mut setting = pane.setting;
            let close = self.panes.len() > *PANES.start() && input.common.view.bars;
            let room = ui.available_width() - if close { 34.0 } else { 0.0 } - 12.0;
            let widths = [0.38, 0.25, 0.37].map(|share| (share * room).clamp(30.0, 120.0));
            let method = METHODS.iter().map(|entry| (entry.kind, entry.id, entry.about));
            let panels = (input.common.scene.solver.method.id(), "as in the panel");
            pick(ui, &palette, (&name, "method"), widths[0], (&mut setting.method, panels), method);
            let elements = input.common.scene.elements().map(|e| (e, e.id(), e.entry().about));
            let panels = (input.common.scene.element().id(), "as in the panel");
            pick(ui, &palette, (&name, "element"), widths[1], (&mut setting.element, panels), elements);
            mesh_picker(ui, &palette, &name, widths[2], &mut setting.cells, input.common.scene);
            if setting != pane.setting {
                *change = Some((number, Some(setting)));
            }
            if close && grid::close_button(ui, number) {
                *change = Some((number, None));
            }
        });
        self.result(ui, &name, pane, input);
    }

    /// Shows error, time and iterations, or the reason for which there are none.
    fn result(&self, ui: &mut Ui, name: &str, pane: &Pane, input: &CompareInput<'_>) {
        let palette = Palette::new(ui.visuals());
        let setting = pane.setting.of(input.common.scene);
        let (bad, text) = match pane.doing() {
            Doing::Refused(reason) => (true, sentence(&said(reason))),
            Doing::Rests(end) => match end.status.failure_sentence() {
                Some(reason) => (true, fill!("Does not converge: %{reason}.", reason = said(&reason))),
                None => {
                    let stopped = if end.status.is_success() { "" } else { tr(", stopped") };
                    let time = engineering(two_digits(end.seconds), "s");
                    // Images without bars omit the time, which differs from run to run.
                    let time = if input.common.view.bars { format!("{time} · ") } else { String::new() };
                    (false, format!("{time}{}{stopped}", count(end.iterations, "iteration")))
                }
            },
            Doing::Works(iterations) => {
                (false, fill!("solving: %{iterations}", iterations = count(iterations, "iteration")))
            }
            Doing::Iterates(_) if !input.running => (false, tr("paused").to_owned()),
            Doing::Iterates(iterations) => (false, count(iterations, "iteration")),
        };
        let error = pane.error.filter(|_| !bad);
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 26.0), Sense::hover());
        let painter = ui.painter();
        let mut left = rect.left();
        if bad {
            painter.rect_filled(rect, 4.0, palette.error_chip);
            left += 6.0;
        } else {
            let number = error.map_or_else(|| UNKNOWN.to_owned(), percent);
            let color = error_color(&palette, error);
            let galley = painter.layout_no_wrap(number, FontId::proportional(HEADLINE), color);
            let at = Align2::LEFT_CENTER.anchor_size(pos2(left, rect.center().y), galley.size());
            semibold(painter, at.min, &galley, color);
            left = at.right() + 12.0;
        }
        let (size, ink) = if bad { (SMALL, palette.error) } else { (BODY, palette.secondary) };
        let mut job = egui::text::LayoutJob::simple_singleline(text.clone(), FontId::proportional(size), ink);
        job.wrap = egui::text::TextWrapping::truncate_at_width((rect.right() - left - 4.0).max(0.0));
        let galley = painter.layout_job(job);
        let at = Align2::LEFT_CENTER.anchor_size(pos2(left, rect.center().y), galley.size());
        painter.galley(at.min, galley, ink);
        let error = error.map_or_else(String::new, |error| fill!("error %{error}, ", error = percent(error)));
        let spoken = format!("{name}: {}: {error}{text}", setting.text());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &spoken));
        let tip = fill!(
            "Error: relative error of the first probe's displacement vector, compared with %{reference}. Time and \
             iterations: of a solve from rest.",
            reference = reference_text(input.reference)
        );
        response.on_hover_text(format!("{text}\n{tip}"));
    }

    /// Shows the overlays of a pane's body.
    fn body(&mut self, ui: &Ui, number: usize, place: Rect, input: &CompareInput<'_>) -> Interaction {
        let (camera, Some(controller)) = (self.camera(), &mut self.controller) else { return Interaction::default() };
        let Some(pane) = self.panes.get_mut(number) else { return Interaction::default() };
        // States that are no result show no values.
        let system = pane.system().filter(|_| pane.is_sound() && !pane.is_outdated()).cloned();
        let forces = pane.forces(input.common.direction, input.common.opening);
        let handles = forces.map_or_else(Vec::new, |forces| forces.handles(&Projection { camera, rect: place }));
        let reach = HitTargets {
            mesh: system.as_ref().map(|system| system.mesh()),
            camera,
            positions: &pane.body_mesh.nodes,
            outline: &pane.geometry.boundary,
            handles: &handles,
            scales: controller.scales([place.width(), place.height()].map(f64::from)),
        };
        let wish = grid::follow(ui, (number, place), &mut pane.pointer, &reach, controller);
        let Some(pane) = self.panes.get(number) else { return wish };
        let palette = Palette::new(ui.visuals());
        let painter = ui.painter_at(place);
        if let (Some(system), Some(scene)) = (pane.system(), pane.scene()) {
            let exact: &[_] =
                input.reference.filter(|_| input.common.view.exact).map_or(&[], |reference| &reference.outline);
            let (geometry, body_mesh, hot) = (&pane.geometry, &pane.body_mesh, pane.pointer.hot_handle());
            let body = PaneBody { scene, system, geometry, body_mesh, exact, time: 0.0, hot };
            body.paint(ui, place, camera, &input.common, &self.still);
        }
        if number == 0 {
            overlay::scale_bar(&painter, place, &camera, &palette);
        }
        if pane.is_outdated() {
            painter.rect_filled(place, 0.0, palette.canvas.gamma_multiply(0.6));
            painter.text(
                place.center(),
                Align2::CENTER_CENTER,
                tr("solving…"),
                FontId::proportional(BODY),
                palette.text,
            );
        } else if pane.has_failed() {
            // A state that is not an equilibrium is dimmed, because it is no result.
            painter.rect_filled(place, 0.0, palette.canvas.gamma_multiply(0.55));
        }
        wish
    }

    /// Paints the key of lines and colours for all panes.
    fn key(&self, ui: &Ui, rect: Rect, view: &ViewOptions) {
        let palette = Palette::new(ui.visuals());
        let painter = ui.painter_at(rect);
        let font = FontId::proportional(SMALL);
        let middle = rect.center().y;
        let mut x = rect.left() + 12.0;
        let mut entry = |text: &str, mark: Mark, color: Color32| {
            mark.paint(&painter, pos2(x, middle), color);
            let at = pos2(x + Mark::WIDTH + 6.0, middle);
            let place = painter.text(at, Align2::LEFT_CENTER, tr(text), font.clone(), palette.secondary);
            x = place.right() + 16.0;
        };
        if view.exact {
            entry("reference", Mark::Dashes, palette.exact);
        }
        if view.rest_outline {
            entry("rest", Mark::Outline, palette.rest);
        }
        let Some(range) = self.panes.first().map(|pane| pane.body_mesh.range) else { return };
        grid::color_key(ui, rect, x, view, range);
    }
}

/// Shows a picker of a pane: a value of its own, or that of the panel.
fn pick<T: Copy + PartialEq>(
    ui: &mut Ui,
    palette: &Palette,
    (pane, what): (&str, &str),
    width: f32,
    (value, (panels, of_panel)): (&mut Option<T>, (&str, &str)),
    entries: impl Iterator<Item = (T, &'static str, &'static str)> + Clone,
) {
    let id = value.and_then(|own| entries.clone().find(|entry| entry.0 == own)).map_or(panels, |entry| entry.1);
    let mut menu = |ui: &mut Ui| {
        ui.set_width(280.0);
        for (kind, id, about) in entries.clone() {
            if choice(ui, palette, *value == Some(kind), id, about).clicked() {
                *value = Some(kind);
            }
        }
        let about = fill!("Follows the panel, now %{setting}", setting = tr(panels));
        if choice(ui, palette, value.is_none(), of_panel, &about).clicked() {
            *value = None;
        }
    };
    combo(ui, pane, what, id, width, &mut menu);
}

fn combo(ui: &mut Ui, pane: &str, what: &str, text: &str, width: f32, menu: &mut dyn FnMut(&mut Ui)) {
    let (label, text) = (format!("{pane} {}", tr(what)), tr(text));
    let combo = ComboBox::from_id_salt(&label).selected_text(RichText::new(text)).width(width).height(420.0).truncate();
    let response = combo.show_ui(ui, menu).response;
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, true, &label);
        info.current_text_value = Some(text.to_owned());
        info
    });
}

/// Shows a picker of meshes that are finer or coarser than the panel's.
fn mesh_picker(ui: &mut Ui, palette: &Palette, pane: &str, width: f32, cells: &mut Option<[u32; 2]>, scene: &Scene) {
    /// Largest number of cells offered.
    const MOST: u64 = 40_000;
    let mesh_text = |[along, across]: [u32; 2]| format!("{along}×{across}");
    let Some(beam) = &scene.beam else {
        return combo(ui, pane, "mesh", "as meshed", width, &mut |ui| {
            ui.label(tr("The mesh is that of the file."));
        });
    };
    let own = beam.cells;
    let text = mesh_text(cells.unwrap_or(own));
    combo(ui, pane, "mesh", &text, width, &mut |ui| {
        ui.set_width(200.0);
        let about = fill!("Follows the panel, now %{setting}", setting = mesh_text(own));
        if choice(ui, palette, cells.is_none(), "as in the panel", &about).clicked() {
            *cells = None;
        }
        let coarser = own.map(|n| n.div_ceil(2));
        let finer = [1, 2, 4, 8, 16].map(|times| own.map(|n| n.saturating_mul(times)));
        let offered = std::iter::once(coarser).filter(|&c| c != own).chain(finer);
        let small = offered.filter(|[a, b]| u64::from(*a) * u64::from(*b) <= MOST);
        let other = cells.filter(|own| !small.clone().any(|offered| offered == *own));
        for offered in small.chain(other) {
            let about = match offered {
                _ if offered == own => "as in the panel now; does not follow it later",
                _ if offered[0] < own[0] => "coarser",
                _ => "finer",
            };
            if choice(ui, palette, *cells == Some(offered), &mesh_text(offered), about).clicked() {
                *cells = Some(offered);
            }
        }
    });
}
