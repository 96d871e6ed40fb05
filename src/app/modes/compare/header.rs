//! Headers of the panes, with their pickers and results, and the key under them.

use egui::{Align2, Color32, FontId, Rect, RichText, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::pane::{Condition, Pane};
use super::setting::PANES;
use super::{CompareInput, PaneChange, grid};
use crate::app::diagnosis::{coarse_text, drift_text, error_color, error_text, error_tip};
use crate::app::language::{area_text, sentence};
use crate::app::prelude::*;
use crate::app::view_options::ViewOptions;
use crate::app::widgets::legend::LegendMark;
use crate::app::widgets::palette::{BODY, HEADLINE, Palette, SMALL};
use crate::app::widgets::text::semibold;
use crate::dynamics::INTEGRATORS;
use crate::format::{engineering, engineering_pair, three_digits, two_digits};
use crate::method::METHODS;
use crate::simulation::Motion;

/// Shows the pickers of a pane behind a mark of its colour, the button that closes it, and its result.
pub(super) fn show(ui: &mut Ui, panes: &[Pane], number: usize, input: &CompareInput<'_>) -> PaneChange {
    let (pane, scene) = (panes.get(number)?, input.scene);
    let palette = Palette::new(ui.visuals());
    let in_motion = scene.analysis == Analysis::Dynamic;
    let name: &str = &fill!("Pane %{n}", n = number + 1);
    let (mut setting, mut is_closed) = (pane.setting, false);
    ui.horizontal(|ui| {
        let (bar, _) = ui.allocate_exact_size(vec2(10.0, 18.0), Sense::hover());
        ui.painter().rect_filled(bar, 3.0, pane.color(scene, &palette));
        let close = panes.len() > *PANES.start() && input.view.bars;
        let room = ui.available_width() - if close { 34.0 } else { 0.0 } - 12.0;
        // Widths of the pickers as fractions of the row, and the largest width, points.
        let (shares, widest) = if in_motion { ([0.5, 0.2, 0.3], 190.0) } else { ([0.38, 0.25, 0.37], 120.0) };
        let widths = shares.map(|share: f32| (share * room).clamp(30.0, widest));
        if in_motion {
            let (entries, panels) =
                (INTEGRATORS.iter().map(|e| (e.kind, e.id, e.about)), scene.dynamics.integrator.id());
            grid::pick(ui, &palette, (name, "integrator"), widths[0], (&mut setting.integrator, panels), entries);
        } else {
            let (entries, panels) = (METHODS.iter().map(|e| (e.kind, e.id, e.about)), scene.solver.method.id());
            grid::pick(ui, &palette, (name, "method"), widths[0], (&mut setting.method, panels), entries);
        }
        let (entries, panels) = (scene.elements().map(|e| (e, e.id(), e.entry().about)), scene.element().id());
        grid::pick(ui, &palette, (name, "element"), widths[1], (&mut setting.element, panels), entries);
        grid::mesh_picker(ui, &palette, name, widths[2], &mut setting.cells, scene);
        is_closed = close && grid::close_button(ui, number);
    });
    if in_motion {
        motion_result(ui, name, pane, panes.first().filter(|_| number > 0));
    } else {
        result(ui, name, pane, input);
        kept_probes(ui, pane, input.view);
    }
    if is_closed { Some(None) } else { (setting != pane.setting).then_some(Some(setting)) }
}

/// Largest number of probes in a header, so that the bodies keep their room.
const MAX_PROBES: usize = 3;

/// Returns the number of probes that a header shows, the first of the scene; a narrow window has no room for them.
pub(super) fn shown_probes(scene: &Scene, view: &ViewOptions) -> usize {
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
    let setting = pane.setting.of(input.scene);
    let (run, iterations) = (&pane.run, count(pane.run.iterations(), "iteration"));
    let failure = run.end().and_then(|end| end.status.failure_sentence());
    let (bad, text) = if let Some(reason) = run.refused() {
        (true, sentence(&said(reason)))
    } else if let Some(reason) = failure {
        (true, fill!("Does not converge: %{reason}.", reason = said(&reason)))
    } else if let Some(end) = run.end() {
        let stopped = if end.status == Status::Converged { "" } else { tr(", stopped") };
        let inverted = if end.is_inside_out { format!(", {}", tr("inverted elements")) } else { String::new() };
        // Images without bars omit the time, which differs from run to run.
        let time = pane.shown_seconds(input).filter(|_| input.view.bars);
        let time = time.map_or_else(String::new, |time| format!("{} · ", engineering(two_digits(time), "s")));
        let area = area_text(end.area_change);
        (false, format!("{time}{}{stopped}{inverted} · {area}", count(end.iterations, "iteration")))
    } else if run.is_away() {
        (false, fill!("solving: %{iterations}", iterations = iterations))
    } else {
        (false, if input.session.is_running() { iterations } else { tr("paused").to_owned() })
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
        // Until the pane has a result, the error is that of an earlier load.
        let is_current = pane.condition() == Condition::Result;
        let color = if is_current { error_color(&palette, bound) } else { palette.secondary };
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
    let is_cut = whole.elided && run.end().is_some() && bad;
    let galley = if is_cut { lay_out(tr("Does not converge")) } else { whole };
    let at = Align2::LEFT_CENTER.anchor_size(pos2(left, rect.center().y), galley.size());
    painter.galley(at.min, galley, ink);
    let error = error.map_or_else(String::new, |error| fill!("error %{error}, ", error = percent(error)));
    let spoken = format!("{name}: {}: {error}{text}", setting.text());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &spoken));
    let error_tip = error_tip(input.reference, input.session.facts().reference.failure(input.scene));
    response.on_hover_text(format!("{text}\n{error_tip}\n{}", tr("Time and iterations: of a solve from rest")));
}

/// Shows the computing time of a frame, the energy drift, and the distance of the first probe from that of the `first`
/// pane; or the reason for which there are none.
fn motion_result(ui: &mut Ui, name: &str, pane: &Pane, first: Option<&Pane>) {
    let palette = Palette::new(ui.visuals());
    let stopped = pane.simulation().and_then(|simulation| simulation.status().failure_sentence());
    let failure = pane.run.refused().cloned().or(stopped);
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

fn numbers(pane: &Pane, first: Option<&Pane>) -> String {
    let cost = pane.seconds().map(|frame| fill!("%{time} a frame", time = engineering(two_digits(frame), "s")));
    let drift = pane
        .simulation()
        .and_then(Simulation::motion)
        .map(Motion::ledger)
        .map(|ledger| fill!("drift %{drift}", drift = drift_text(ledger.drift_of_input())));
    let apart = first.and_then(|first| first.run.answer()).zip(pane.run.answer()).map(|(first, own)| {
        fill!("%{distance} from pane 1", distance = engineering(three_digits((own - first).norm()), "m"))
    });
    joined(cost.into_iter().chain(drift).chain(apart))
}

/// Paints the key of lines and colours for all panes, with their factor of the displacement.
pub(super) fn key(ui: &Ui, rect: Rect, view: &ViewOptions, (range, magnification): ([f64; 2], f64), in_motion: bool) {
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
    if view.exact && !in_motion {
        entry(tr("reference"), LegendMark::Dashes, palette.exact);
    }
    if view.rest_outline && !in_motion {
        entry(tr("rest"), LegendMark::Outline, palette.rest);
    }
    grid::color_key(ui, rect, x, view, range);
}
