//! Comparison of two to four settings side by side: one load, one camera, one colour range.

use egui::{Align2, Color32, Context, FontId, Panel, Rect, RichText, Role, Sense, Ui, WidgetInfo, pos2, vec2};
use nalgebra::Vector2;
use web_time::{Duration, Instant};

use self::grid::{Preset, grow};
use self::panes::{ComparedPane, Condition, PaneChange, Panes};
use crate::app::diagnosis::{coarse_text, error_color, error_text, error_tip};
use crate::app::language::{area_text, count, fill, joined, percent, said, sentence, tr};
use crate::app::session::compared_solve::{Activity, ComparedSolve, Equations, FrameConditions};
use crate::app::session::live::Live;
use crate::app::task::thread::{POLL, QUIET_POLL};
use crate::app::view_options::{Magnification, ViewOptions};
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::overlay;
use crate::app::viewport::pointer::Interaction;
use crate::app::viewport::projection::Projection;
use crate::app::widgets::legend::LegendMark;
use crate::app::widgets::palette::{BODY, HEADLINE, Palette, SMALL};
use crate::app::widgets::text::semibold;
use crate::format::{engineering, engineering_pair, three_digits, two_digits};
use crate::method::METHODS;
use crate::render::{Camera, Margins, View};
use crate::scene::{ElementKind, MethodKind, Scene};
use crate::sentence::Sentence;
use crate::simulation::Status;
use crate::state::largest;
use crate::study::{Reference, Setting, SolveFromRest};

mod grid;
mod motion;
mod pane;
mod panes;
mod setting;

pub(crate) use motion::MotionCompare;
pub use motion::MotionPane;
pub use pane::Pane;
pub(crate) use panes::PaneInput;
pub use setting::{PaneSetting, PaneSettingError, parse_panes};

/// Time for the iterations of all panes between two frames.
const WORK: Duration = Duration::from_millis(12);
/// Input of the comparison of equilibria.
pub(crate) struct CompareInput<'a> {
    pub common: PaneInput<'a>,
    /// Reference solution of the load, or the one that follows it.
    pub reference: Option<&'a Reference>,
    /// Reference solution that follows the load, if errors are measured against it.
    pub live: Option<&'a Live>,
    /// Reason why it could not be computed.
    pub reference_failure: Option<&'a Sentence>,
    /// Time of a solve from rest with the panel's settings; `None` until it has been measured.
    pub from_rest: Option<&'a SolveFromRest>,
    pub running: bool,
    /// Fastest measured setting within the limits.
    pub chosen: Option<Setting>,
}

impl<'a> CompareInput<'a> {
    /// Returns the reference solution of the load itself.
    fn exact(&self) -> Option<&'a Reference> {
        self.reference.filter(|_| self.live.is_none())
    }
}

/// Panes with equilibria of one scene.
#[derive(Debug)]
pub(crate) struct Compare {
    panes: Panes<Pane>,
}

impl Default for Compare {
    fn default() -> Self {
        Self { panes: Panes::new(&METHODS_PRESET.map(PaneSetting::of_method)) }
    }
}

const METHODS_PRESET: [MethodKind; 3] = [MethodKind::Linear, MethodKind::Warped, MethodKind::Newton];

impl Compare {
    pub(crate) fn panes(&self) -> &[Pane] {
        &self.panes.list
    }

    /// Compares these settings, at most four.
    pub(crate) fn set(&mut self, settings: &[PaneSetting]) {
        self.panes.set(settings);
    }

    /// Returns `true` if a pane has the settings of the scene.
    pub(crate) fn shows(&self, scene: &Scene) -> bool {
        self.panes.list.iter().any(|pane| pane.setting.apply(scene) == *scene)
    }

    /// Returns the camera of all panes.
    pub(crate) fn camera(&self) -> Camera {
        self.panes.camera()
    }

    /// Returns `true` if the user has moved the camera.
    pub(crate) fn is_moved(&self) -> bool {
        self.panes.is_moved()
    }

    /// Fits the camera to all bodies.
    pub(crate) fn fit(&mut self) {
        self.panes.fit();
    }

    /// Returns the bodies of the panes for the render pass.
    pub(crate) fn views(&self, wireframe: bool, pixels_per_point: f32) -> Vec<View<'_>> {
        self.panes.views(wireframe, pixels_per_point)
    }

    /// Restarts all panes from rest.
    pub(crate) fn reset(&mut self) {
        self.panes.list.iter_mut().for_each(Pane::reset);
    }

    /// Makes one iteration in all panes that have not ended; if all have, restarts them from rest.
    pub(crate) fn step(&mut self) {
        if !self.is_iterating() {
            self.reset();
        }
        self.panes.list.iter_mut().for_each(|pane| pane.solve.step());
    }

    /// Returns `true` if a pane is still iterating.
    pub(crate) fn is_iterating(&self) -> bool {
        self.panes.list.iter().any(|pane| !pane.solve.is_settled())
    }

    /// Returns the existing equations that the panes can share.
    fn equations(&self, own: &Equations) -> Vec<Equations> {
        std::iter::once(own.clone()).chain(self.panes.list.iter().flat_map(Pane::equations)).collect()
    }

    /// Solves all panes, and waits for them; `times` them, too.
    pub(crate) fn solve_to_end(&mut self, scene: &Scene, own: &Equations, times: bool) {
        let mut equations = self.equations(own);
        for pane in &mut self.panes.list {
            pane.solve.solve_to_end(pane.setting.apply(scene), &equations);
            equations.extend(pane.equations());
            if times {
                pane.wait_for_time();
            }
        }
    }

    fn advance(&mut self, ctx: &Context, input: &CompareInput<'_>) {
        let holds = ctx.input(|i| i.pointer.any_down());
        let equations =
            if self.is_changed(input.common.scene) { self.equations(&input.common.own) } else { Vec::new() };
        let share = WORK / u32::try_from(self.panes.list.len().max(1)).unwrap_or(1);
        for pane in &mut self.panes.list {
            let until = Instant::now() + share;
            let frame = FrameConditions { holds, runs: input.running, until };
            pane.solve.advance(pane.setting.apply(input.common.scene), &equations, frame);
            pane.is_dragged = holds && input.running;
            pane.update_error(input);
        }
        let mut solves = self.panes.list.iter().map(|pane| &pane.solve);
        let busy = |solve: &ComparedSolve| !solve.is_settled() && !solve.is_away() && !solve.waits();
        if input.running && solves.clone().any(busy) {
            ctx.request_repaint();
        } else if solves.any(ComparedSolve::is_away) {
            ctx.request_repaint_after(POLL);
        } else if !holds && self.panes.list.iter_mut().any(Pane::request_time) {
            // One pane after the other is timed.
            ctx.request_repaint_after(QUIET_POLL);
        }
    }

    /// Returns `true` if a pane has a new scene or has not ended.
    fn is_changed(&self, scene: &Scene) -> bool {
        let is_changed = |pane: &Pane| pane.scene() != Some(&pane.setting.apply(scene)) || !pane.solve.is_settled();
        self.panes.list.iter().any(is_changed)
    }

    /// Shows the presets above the panes.
    pub(crate) fn bars(&mut self, ui: &mut Ui, input: &CompareInput<'_>) {
        if input.common.view.bars {
            let frame = egui::Frame::NONE.inner_margin(egui::Margin::symmetric(12, 4));
            Panel::top("presets").resizable(false).frame(frame).show(ui, |ui| self.presets(ui, input));
        }
    }

    fn presets(&mut self, ui: &mut Ui, input: &CompareInput<'_>) {
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
                name: tr("current | fastest").to_owned(),
                settings: chosen.to_vec(),
                enabled: input.chosen.is_some(),
                tip: "The current setting next to the fastest that meets both limits of How fast, in Measure",
                unless: "Measure how fast the settings are first: the fastest is compared with the current one",
            },
        ];
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            let present = self.panes.settings();
            if let Some(settings) = grid::preset_buttons(ui, &present, presets) {
                self.set(&settings);
            }
            if grid::add_button(ui, present.len()) {
                let used = |method: MethodKind| present.iter().any(|setting| setting.method == Some(method));
                let unused = METHODS.iter().map(|entry| entry.kind).find(|&method| !used(method));
                self.panes.add(unused.map(PaneSetting::of_method).unwrap_or_default());
            }
        });
    }

    /// Shows the panes; returns the pointer's interaction with their load.
    pub(crate) fn show(&mut self, ui: &mut Ui, input: &CompareInput<'_>) -> Interaction {
        self.advance(ui.ctx(), input);
        self.magnify(input);
        let mut known = self.equations(&input.common.own);
        for pane in &mut self.panes.list {
            let is_own = || pane.setting.apply(input.common.scene) == *input.common.scene;
            pane.keep_equilibrium(input.common.last.filter(|_| is_own()));
            pane.update_display((input.common.view, input.exact()), self.panes.magnification, ui.visuals(), &known);
            known.extend(pane.equations());
        }
        let range = self.panes.share_colors(input.common.view, |_| true);
        let whole = ui.available_rect_before_wrap();
        let grid = self.panes.lay_out(ui, shown_probes(input.common.scene, input.common.view));
        let reference = input.reference.filter(|_| input.common.view.exact);
        let exact = reference.map(|reference| overlay::magnified_outline(reference, self.panes.magnification));
        let exact = exact.unwrap_or_default();
        self.fit_camera(ui, input, &exact);
        let interaction =
            self.panes.show(ui, &grid, (&input.common, &exact), |panes, ui, number| header(panes, ui, number, input));
        self.show_values(ui, input.common.view);
        key(ui, grid.key, input.common.view, (range, self.panes.magnification));
        ui.advance_cursor_after_rect(whole);
        interaction
    }

    /// Sets the common factor of the drawn displacement; the largest displacement of the results counts.
    fn magnify(&mut self, input: &CompareInput<'_>) {
        let (choice, size) = (input.common.view.magnification, input.common.own.system().size());
        let counts = choice == Magnification::Automatic;
        let sound = self.panes.list.iter().filter(|pane| counts && pane.solve.is_sound());
        let results = sound.filter_map(|pane| pane.solve.displayed());
        let longest = results.map(|body| largest(body.displacement())).fold(0.0, f64::max);
        self.panes.magnification = choice.factor(size, longest);
    }

    /// Shows the values at the point of the body under the pointer, in every pane.
    fn show_values(&self, ui: &Ui, view: &ViewOptions) {
        let panes = self.panes.list.iter().enumerate();
        let under = panes.clone().find_map(|(number, pane)| Some((number, pane.under_pointer()?)));
        let Some((number, (rest, at))) = under else { return };
        for (i, pane) in panes {
            pane.show_value(ui, view, rest, self.camera(), (i == number).then_some(at));
        }
    }

    /// Fits the camera to all bodies and the outline `exact` of the reference solution, m, unless the user
    /// has moved it. Panes that have not converged are ignored.
    fn fit_camera(&mut self, ui: &Ui, input: &CompareInput<'_>, exact: &[Vec<Vector2<f64>>]) {
        let Some(size) = self.panes.common_size() else { return };
        let (low, high) = input.common.own.system().mesh().bounds();
        let rest = [low, high];
        let iterates = self.is_iterating();
        let margins = self.margins(input, size);
        let holds = self.panes.holds();
        let controller = self.panes.controller.get_or_insert_with(|| CameraController::new(rest));
        if !holds {
            let mut bounds = exact.iter().flatten().fold(rest, grow);
            let is_linear = |pane: &Pane| pane.scene().is_some_and(|s| s.solver.method == MethodKind::Linear);
            let (linear, others): (Vec<&Pane>, Vec<&Pane>) =
                self.panes.list.iter().filter(|pane| pane.solve.is_sound()).partition(|pane| is_linear(pane));
            bounds = others.iter().flat_map(|pane| pane.display.body_mesh.points()).fold(bounds, grow);
            // The solution of linear theory may be so large that the other bodies would be shown too small.
            const LARGEST: f64 = 1.5;
            let size_of = |[low, high]: [Vector2<f64>; 2]| (high - low).norm();
            let with = linear.iter().flat_map(|pane| pane.display.body_mesh.points()).fold(bounds, grow);
            let has_reference = input.reference.is_some() && input.common.view.exact;
            let known = !others.is_empty() || has_reference;
            if !known || size_of(with) < LARGEST * size_of(bounds) {
                bounds = with;
            }
            if !iterates || controller.whole() == rest {
                controller.set_body(rest);
                controller.set_whole(bounds);
            }
        }
        self.panes.aim(ui, |[low, high]| Camera::fit(low, high, size, margins), input.common.eases);
    }

    /// Returns the margins around the bodies when the camera is fitted, points: room for supports, load arrows and
    /// their labels.
    fn margins(&self, input: &CompareInput<'_>, [width, height]: [f64; 2]) -> Margins {
        let place = Rect::from_min_size(egui::Pos2::ZERO, vec2(width as f32, height as f32));
        let first = self.panes.list.first();
        let forces = first.and_then(|pane| pane.display.forces(pane.scene()?, 0.0, &input.common));
        let arrows = forces.map(|forces| forces.arrows(&Projection { camera: self.camera(), rect: place }));
        let longest = |along: fn(egui::Vec2) -> f32| {
            arrows.iter().flatten().map(|arrow| f64::from(along(arrow.vector))).fold(0.0, f64::max)
        };
        let (top, bottom) = ((0.08 * height).min(30.0), (0.16 * height).min(44.0));
        Margins { sides: 40.0, top: top + longest(|vector| -vector.y), bottom: bottom + longest(|vector| vector.y) }
    }
}

/// Shows the pickers of a pane, and its result.
fn header(panes: &Panes<Pane>, ui: &mut Ui, number: usize, input: &CompareInput<'_>) -> PaneChange {
    let (pane, scene) = (panes.list.get(number)?, input.common.scene);
    let palette = Palette::new(ui.visuals());
    let color = pane.color(scene, &palette);
    let widths = ([0.38, 0.25, 0.37], 120.0);
    let change = panes.show_pickers(ui, (number, color), &input.common, widths, |ui, name, widths, setting| {
        let entries = METHODS.iter().map(|entry| (entry.kind, entry.id, entry.about));
        let panels = (scene.solver.method.id(), "as in the panel");
        grid::pick(ui, &palette, (name, "method"), widths[0], (&mut setting.method, panels), entries);
        grid::element_picker(ui, &palette, name, widths[1], &mut setting.element, scene);
        grid::mesh_picker(ui, &palette, name, widths[2], &mut setting.cells, scene);
    });
    result(ui, &panes::pane_name(number), pane, input);
    kept_probes(ui, pane, input.common.view);
    change
}

/// Largest number of probes in a header, so that the bodies keep their room.
const MAX_PROBES: usize = 3;

/// Returns the number of probes that a header shows, the first of the scene; a narrow window has no room for them.
fn shown_probes(scene: &Scene, view: &ViewOptions) -> usize {
    if view.narrow { 0 } else { scene.probes.len().min(MAX_PROBES) }
}

/// Shows the displacements of the probes.
fn kept_probes(ui: &mut Ui, pane: &Pane, view: &ViewOptions) {
    let Some(simulation) = pane.simulation().filter(|_| pane.condition() == Condition::Result) else { return };
    for probe in simulation.problem().probes().iter().take(shown_probes(simulation.scene(), view)) {
        let u = probe.mean(simulation.displacement());
        let u = engineering_pair([u.x, u.y].map(three_digits), "m");
        let text = RichText::new(format!("{}: u = {u}", tr(&probe.name))).size(SMALL);
        ui.add(egui::Label::new(text).truncate());
    }
}

/// Shows error, time and iterations, or the reason for which there are none.
fn result(ui: &mut Ui, name: &str, pane: &Pane, input: &CompareInput<'_>) {
    let palette = Palette::new(ui.visuals());
    let setting = pane.setting.of(input.common.scene);
    let (bad, text) = match pane.solve.activity() {
        Activity::Refused(reason) => (true, sentence(&said(reason))),
        Activity::Rests(end) => match end.status.failure_sentence() {
            Some(reason) => (true, fill!("Does not converge: %{reason}.", reason = said(&reason))),
            None => {
                let stopped = if end.status == Status::Converged { "" } else { tr(", stopped") };
                let inverted = if end.is_inside_out { format!(", {}", tr("inverted elements")) } else { String::new() };
                // Images without bars omit the time, which differs from run to run.
                let time = pane.shown_seconds(input).filter(|_| input.common.view.bars);
                let time = time.map_or_else(String::new, |time| format!("{} · ", engineering(two_digits(time), "s")));
                let area = area_text(end.area_change);
                (false, format!("{time}{}{stopped}{inverted} · {area}", count(end.iterations, "iteration")))
            }
        },
        Activity::Works(iterations) => {
            (false, fill!("solving: %{iterations}", iterations = count(iterations, "iteration")))
        }
        Activity::Iterates(_) if !input.running => (false, tr("paused").to_owned()),
        Activity::Iterates(iterations) => (false, count(iterations, "iteration")),
    };
    let error = pane.error.filter(|_| !bad);
    let judged = error.zip(input.reference.and_then(Reference::first));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 26.0), Sense::hover());
    let painter = ui.painter();
    let mut left = rect.left();
    if bad {
        painter.rect_filled(rect, 4.0, palette.error_chip);
        left += 6.0;
    } else {
        let bound = judged.map(|(error, first)| first.error_bound(error));
        let number = error_text(error, bound, input.live.is_some());
        let color = error_color(&palette, bound);
        let galley = painter.layout_no_wrap(number, FontId::proportional(HEADLINE), color);
        let at = Align2::LEFT_CENTER.anchor_size(pos2(left, rect.center().y), galley.size());
        semibold(painter, at.min, &galley, color);
        left = at.right() + 12.0;
    }
    let coarse = judged.and_then(|(error, first)| coarse_text(error, &first));
    let text = joined(coarse.into_iter().chain([text]));
    let (size, ink) = if bad { (SMALL, palette.error) } else { (BODY, palette.secondary) };
    let room = (rect.right() - left - 4.0).max(0.0);
    let lay_out = |text: &str| {
        let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), FontId::proportional(size), ink);
        job.wrap = egui::text::TextWrapping::truncate_at_width(room);
        painter.layout_job(job)
    };
    let whole = lay_out(&text);
    // A narrow pane has the reason in the tooltip only.
    let is_cut = whole.elided && matches!(pane.solve.activity(), Activity::Rests(_)) && bad;
    let galley = if is_cut { lay_out(tr("Does not converge")) } else { whole };
    let at = Align2::LEFT_CENTER.anchor_size(pos2(left, rect.center().y), galley.size());
    painter.galley(at.min, galley, ink);
    let error = error.map_or_else(String::new, |error| fill!("error %{error}, ", error = percent(error)));
    let spoken = format!("{name}: {}: {error}{text}", setting.text());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &spoken));
    let error_tip = error_tip(input.reference, input.reference_failure);
    response.on_hover_text(format!("{text}\n{error_tip}\n{}", tr("Time and iterations: of a solve from rest")));
}

/// Paints the key of lines and colours for all panes, with their factor of the displacement.
fn key(ui: &Ui, rect: Rect, view: &ViewOptions, (range, magnification): ([f64; 2], f64)) {
    let palette = Palette::new(ui.visuals());
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(SMALL);
    let middle = rect.center().y;
    let mut x = grid::magnification_key(ui, rect, magnification);
    let mut entry = |text: &str, mark: LegendMark, color: Color32| {
        mark.paint(&painter, pos2(x, middle), color);
        let at = pos2(x + LegendMark::WIDTH + 6.0, middle);
        let place = painter.text(at, Align2::LEFT_CENTER, text, font.clone(), palette.secondary);
        x = place.right() + 16.0;
    };
    if view.exact {
        entry(tr("reference"), LegendMark::Dashes, palette.exact);
    }
    if view.rest_outline {
        entry(tr("rest"), LegendMark::Outline, palette.rest);
    }
    grid::color_key(ui, rect, x, view, range);
}
