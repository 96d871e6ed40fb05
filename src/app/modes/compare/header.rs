//! Layout of the panes, their headers with pickers and results, and the key under them.

use egui::emath::GuiRounding;

use super::*;
use crate::app::diagnosis::{coarse_text, drift_text, error_color, error_text, error_tip, strain_text};

/// Space between panes, points.
const GAP: f32 = 6.0;
/// Height of a pane's header without probes, and of a line with a probe, points.
const HEADER: f32 = 60.0;
const PROBE: f32 = 18.0;
/// Height of the key under the panes, points.
const KEY: f32 = 26.0;
/// Smallest width of a pane in a row of three, points.
const NARROWEST: f32 = 290.0;

/// Shows the pickers of a pane behind a mark of its colour, the button that closes it, and its result.
pub(super) fn show(ui: &mut Ui, panes: &[Pane], number: usize, input: &CompareInput<'_>) -> PaneChange {
    let (pane, scene) = (panes.get(number)?, input.scene);
    let palette = Palette::new(ui.visuals());
    let in_motion = scene.analysis == Analysis::Dynamic;
    let name: &str = &fill!("Pane %{n}", n = number + 1);
    let (mut setting, mut is_closed) = (pane.setting, false);
    ui.horizontal(|ui| {
        let (bar, _) = ui.allocate_exact_size(vec2(10.0, 18.0), Sense::hover());
        ui.painter().rect_filled(bar, 3.0, palette.solution(&pane.setting.apply(scene)));
        let close = panes.len() > *PANES.start() && input.view.layout.bars;
        let room = ui.available_width() - if close { 34.0 } else { 0.0 } - 12.0;
        // Widths of the pickers as fractions of the row, and the largest width, points.
        let (shares, widest) = if in_motion { ([0.5, 0.2, 0.3], 190.0) } else { ([0.38, 0.25, 0.37], 120.0) };
        let widths = shares.map(|share: f32| (share * room).clamp(30.0, widest));
        if in_motion {
            let (entries, panels) =
                (INTEGRATORS.iter().map(|e| (e.kind, e.id, e.about)), scene.dynamics.integrator.id());
            pick(ui, &palette, (name, "integrator"), widths[0], (&mut setting.integrator, panels), entries);
        } else {
            let (entries, panels) = (METHODS.iter().map(|e| (e.kind, e.id, e.about)), scene.solver.method.id());
            pick(ui, &palette, (name, "method"), widths[0], (&mut setting.method, panels), entries);
        }
        let (entries, panels) = (scene.elements().map(|e| (e, e.id(), e.entry().about)), scene.element().id());
        pick(ui, &palette, (name, "element"), widths[1], (&mut setting.element, panels), entries);
        mesh_picker(ui, &palette, name, widths[2], &mut setting.cells, scene);
        is_closed = close && close_button(ui, number);
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
    if view.layout.narrow { 0 } else { scene.probes.len().min(MAX_PROBES) }
}

/// Shows the displacements of the probes.
fn kept_probes(ui: &mut Ui, pane: &Pane, view: &ViewOptions) {
    let Some(simulation) = pane.simulation().filter(|_| pane.run.is_sound()) else { return };
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
    let failure = run.end.as_ref().and_then(|end| end.status.failure_sentence());
    let (bad, text) = if let Some(reason) = run.refused() {
        (true, sentence(&said(reason)))
    } else if let Some(reason) = failure {
        (true, fill!("Does not converge: %{reason}.", reason = said(&reason)))
    } else if let Some(end) = &run.end {
        let stopped = if end.status == Status::Converged { "" } else { tr(", stopped") };
        let is_inverted = end.deformation.inverted_elements > 0;
        let inverted = if is_inverted { format!(", {}", tr("inverted elements")) } else { String::new() };
        // Images without bars omit the time, which differs from run to run.
        let time = pane.shown_seconds(input).filter(|_| input.view.layout.bars);
        let time = time.map_or_else(String::new, |time| format!("{} · ", engineering(two_digits(time), "s")));
        let area = area_text(end.deformation.area_change);
        (false, format!("{time}{}{stopped}{inverted} · {area}", count(end.iterations, "iteration")))
    } else if run.is_away() {
        (false, fill!("solving: %{iterations}", iterations = iterations))
    } else {
        (false, if input.session.is_running() { iterations } else { tr("paused").to_owned() })
    };
    let error = pane.error_percent.filter(|_| !bad);
    let strained = run.end.as_ref().filter(|_| !bad).and_then(|end| strain_text(end.deformation.max_strain));
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
        let is_current = pane.run.is_sound();
        let color = if is_current { error_color(&palette, bound) } else { palette.secondary };
        let galley = painter.layout_no_wrap(number, FontId::proportional(HEADLINE), color);
        let at = Align2::LEFT_CENTER.anchor_size(pos2(left, rect.center().y), galley.size());
        semibold(painter, at.min, &galley, color);
        left = at.right() + 12.0;
        if strained.is_some() {
            // The tooltip has the words, for which there is no room.
            let font = FontId::proportional(HEADLINE);
            let mark = painter.text(pos2(left - 8.0, rect.center().y), Align2::LEFT_CENTER, "!", font, palette.warning);
            left = mark.right() + 8.0;
        }
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
    let is_cut = whole.elided && run.end.is_some() && bad;
    let galley = if is_cut { lay_out(tr("Does not converge")) } else { whole };
    let at = Align2::LEFT_CENTER.anchor_size(pos2(left, rect.center().y), galley.size());
    painter.galley(at.min, galley, ink);
    let error = error.map_or_else(String::new, |error| fill!("error %{error}, ", error = percent(error)));
    let text = joined(strained.into_iter().chain([text]));
    let spoken = format!("{name}: {setting}: {error}{text}");
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &spoken));
    let error_tip = error_tip(input.reference, input.session.facts.reference.failure(input.scene));
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
    let mut x = rect.left() + 12.0;
    if magnification != 1.0 {
        let text = bars::magnified(magnification);
        x = painter.text(pos2(x, middle), Align2::LEFT_CENTER, text, font.clone(), palette.text).right() + 16.0;
    }
    let mut entry = |text: &str, mark: LegendMark, color: Color32| {
        mark.paint(&painter, pos2(x, middle), color);
        let at = pos2(x + LegendMark::WIDTH + 6.0, middle);
        let place = painter.text(at, Align2::LEFT_CENTER, text, font.clone(), palette.secondary);
        x = place.right() + 16.0;
    };
    if view.lines.exact && !in_motion {
        entry(tr("reference"), LegendMark::Dashes, palette.exact);
    }
    if view.lines.rest_outline && !in_motion {
        entry(tr("rest"), LegendMark::Outline, palette.rest);
    }
    // The common colour bar is at the right end, with its title if there is room for it.
    let bar = if rect.width() < 560.0 { 70.0 } else { 130.0 };
    let (factor, unit) = view.field.display_unit();
    let range = range.map(|end| factor * end);
    let (power, symbol) = prefix(&range, unit);
    let [low, high] = range.map(|v| engineering(three_digits(v / 10f64.powi(power)), ""));
    let put = |right: f32, text: String| {
        painter.text(pos2(right, middle), Align2::RIGHT_CENTER, text, font.clone(), palette.text).left() - 8.0
    };
    let right = put(rect.right() - 12.0, format!("{high} {symbol}{unit}"));
    let bar = Rect::from_center_size(pos2(right - 0.5 * bar, middle), vec2(bar, 10.0));
    bars::color_bar(&painter, bar, palette.map(view.field));
    let end = put(bar.left() - 8.0, low);
    if end - x > 140.0 {
        painter.text(pos2(end, middle), Align2::RIGHT_CENTER, tr(view.field.name()), font, palette.secondary);
    }
}

/// Shows the button that closes a pane, at the right end of its row; returns `true` if it was pressed.
fn close_button(ui: &mut Ui, number: usize) -> bool {
    let close = |ui: &mut Ui| {
        let button = egui::Button::new(RichText::new("×").size(18.0)).frame(false);
        let button = ui.add(button.min_size(vec2(24.0, 24.0)));
        let text = fill!("Close pane %{n}", n = number + 1);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &text));
        button.on_hover_text(text).clicked()
    };
    ui.with_layout(Layout::right_to_left(Align::Center), close).inner
}

/// Divides a rectangle into the headers and the bodies of `panes` panes, and the key under them. Headers have lines for
/// `probes` probes.
pub(super) fn divide(whole: Rect, panes: usize, probes: usize) -> (Vec<[Rect; 2]>, Rect) {
    let header = HEADER + PROBE * probes as f32;
    let key = whole.with_min_y(whole.bottom() - KEY);
    let split = |cell: Rect| {
        // Rounded to pixels, so that the render pass and the painter have the same centre.
        let body = cell.with_min_y((cell.top() + header).min(cell.bottom())).round_ui();
        [Rect::from_min_max(cell.min, body.right_top()), body]
    };
    (cells(whole.with_max_y(key.top()), panes).into_iter().map(split).collect(), key)
}

/// Returns the areas of `panes` panes in equal columns, side by side or in two rows.
fn cells(rect: Rect, panes: usize) -> Vec<Rect> {
    let is_one_row = panes <= 2 || panes == 3 && (rect.width() - 2.0 * GAP) / 3.0 >= NARROWEST;
    let columns = if is_one_row { panes } else { panes.div_ceil(2) }.max(1);
    let part = |length: f32, count: usize| ((length - GAP * (count - 1) as f32) / count as f32).floor().max(0.0);
    let size = vec2(part(rect.width(), columns), part(rect.height(), panes.div_ceil(columns).max(1)));
    let place = |i: usize| vec2((i % columns) as f32, (i / columns) as f32) * (size + Vec2::splat(GAP));
    (0..panes).map(|i| Rect::from_min_size(rect.min + place(i), size)).collect()
}

/// Shows a picker of a pane: a value of its own, or that of the panel.
fn pick<T: Copy + PartialEq>(
    ui: &mut Ui,
    palette: &Palette,
    (pane, what): (&str, &str),
    width: f32,
    (value, panels): (&mut Option<T>, &str),
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
        if choice(ui, palette, value.is_none(), "as in the panel", &about).clicked() {
            *value = None;
        }
    };
    combo(ui, pane, what, id, width, &mut menu);
}

fn combo(ui: &mut Ui, pane: &str, what: &str, text: &str, width: f32, menu: &mut dyn FnMut(&mut Ui)) {
    let (label, text) = (format!("{pane} {}", tr(what)), tr(text));
    let combo = ComboBox::from_id_salt(&label).selected_text(RichText::new(text)).width(width).height(420.0).truncate();
    // The width of a combo box is its least one.
    let size = vec2(width, ui.spacing().interact_size.y);
    let inside = ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| combo.show_ui(ui, menu));
    let response = inside.inner.response;
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(text.to_owned()),
        ..WidgetInfo::labeled(Role::ComboBox, true, &label)
    });
}

/// Shows a picker of meshes that are finer or coarser than the panel's.
fn mesh_picker(ui: &mut Ui, palette: &Palette, pane: &str, width: f32, cells: &mut Option<[u32; 2]>, scene: &Scene) {
    /// Largest number of cells offered.
    const MAX_CELLS: u64 = 40_000;
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
        let small = offered.filter(|[a, b]| u64::from(*a) * u64::from(*b) <= MAX_CELLS);
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
