//! Loads up to which each method and element holds, with the load of the scene on the same axis; of a motion, time steps
//! up to which each integrator does.

use super::*;
use crate::plot::LimitsChart;
use crate::study::limits::{self, MethodLimits, Rating, Strip, load_text};

/// Widths of the columns left and right of the strips, points.
const NAMES: f32 = 92.0;
const INTEGRATORS: f32 = 120.0;
const ENDS: f32 = 150.0;
/// Height of a line of small text, points.
const LINE: f32 = 18.0;
/// Height of the line that shows the progress, points.
const PROGRESS: f32 = 3.0;
/// Fraction of the height that the strips take from the curve, and the smallest height of the curve, points: in a lower
/// window it is omitted.
const SHARE: f32 = 0.62;
const MIN_CURVE: f32 = 40.0;
/// Smallest and largest height of a strip with the space below it, points.
const ROW: [f32; 2] = [13.0, 19.0];
/// Largest height of a strip of a motion, which has no curve.
const HIGH_ROW: f32 = 40.0;

/// Shows the limits of the lab's scene: those of a scene whose loads have the same proportions.
pub(crate) fn show(ui: &mut Ui, session: &Session, fact: &Keyed<facts::LimitsFact>, actions: &mut Vec<Action>) {
    let (scene, shown) = (session.scene(), session.drawn());
    let Some((base, part)) = fact.asked().and_then(|base| Some((base, part_of(base, scene)?))) else { return };
    let progress = fact.progress().map(|(done, _)| done as f32);
    if let Some(reason) = fact.failure(base) {
        ui.centered_and_justified(|ui| ui.weak(said(reason)));
        return;
    }
    let Some(limits) = fact.so_far(base) else {
        ui.add_space(0.3 * ui.available_height());
        ui.vertical_centered(|ui| {
            ui.weak(tr(match scene.analysis {
                Analysis::Static => "Solving with every method and element, from a hundredth to ten times the load",
                Analysis::Dynamic => "Computing the reference solution, and the motion with every integrator",
            }));
            ui.add(ProgressBar::new(progress.unwrap_or_default()).show_percentage().desired_width(240.0));
        });
        return;
    };
    // Its room stays after the limits are complete, so that nothing moves.
    let line = Rect::from_min_size(ui.next_widget_position(), vec2(ui.available_width(), PROGRESS));
    ui.add_space(PROGRESS);
    if let Some(done) = progress {
        ui.put(line, ProgressBar::new(done).desired_height(PROGRESS).corner_radius(0));
    }
    let mut axis = LoadAxis::of(base);
    if let Some(Beam { cells: [n, m], .. }) = &base.beam {
        axis.name = sentence!("%{load} on %{n} × %{m} cells", load = axis.name, n = *n, m = *m);
    }
    // A low window scrolls.
    let least = 3.0 * LINE + ROW[0] * limits.strips.len() as f32;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let size = vec2(ui.available_width(), ui.available_height().max(least));
        let (below, _) = ui.allocate_exact_size(size, Sense::hover());
        let chart = StripChart::new(ui, below, limits, &axis);
        let placed = chart.handle(ui, part);
        let edited = placed.map(|factor| with_part(base, scene, &axis, factor)).filter(|edited| edited != scene);
        actions.extend(edited.map(|edited| Action::Edit(chart.label(), Box::new(edited))));
        for (row, strip) in limits.strips.iter().enumerate() {
            chart.strip(ui, row, strip, scene, actions);
        }
        let factor = placed.unwrap_or(part);
        // While a load is not reached, the body is that of another one.
        let is_here = part_of(base, shown.scene()).is_none_or(|own| own == part);
        let length = first_probe(shown).filter(|_| is_here).map(|u| u.norm());
        chart.paint(ui, scene, Some((factor, length)).filter(|_| limits.contains(factor)));
    });
}

/// Shows the key of the colours; a line breaks between entries.
pub(crate) fn key(ui: &mut Ui, session: &Session) {
    const BOX: Vec2 = vec2(10.0, 10.0);
    ui.spacing_mut().item_spacing = vec2(10.0, 0.0);
    for (ink, name) in Rating::ALL.map(|rating| rating.entry(session.is_motion())) {
        legend::entry(ui, &said(&name), BOX, &|ui, rect| {
            _ = ui.painter().rect_filled(rect, 0.0, Palette::new(ui.visuals()).ink(ink));
        });
    }
    legend::entry(ui, tr("strains above 10 % or inverted"), BOX, &|ui, rect| {
        let outline = Stroke::new(1.0, ui.visuals().text_color());
        ui.painter().rect_stroke(rect, 0.0, outline, StrokeKind::Inside);
        plot::hatch(&mut ChartPainter::new(ui, rect.min), [[0.0; 2], [BOX.x.into(), BOX.y.into()]], Ink::Text);
    });
}

/// Returns the part of the base's loads, or of its time step, that a scene has; `None` if the limits of the base are not
/// those of the scene.
pub(super) fn part_of(base: &Scene, scene: &Scene) -> Option<f64> {
    /// Relative rounding error of loads.
    const ROUNDING: f64 = 1e-9;
    let stops = |scene: &Scene| (scene.solver.accept_after, scene.element(), scene.solver.method);
    if scene.solver.accept_after > 0 && stops(scene) != stops(base) {
        return None;
    }
    let moves = scene.analysis == Analysis::Dynamic;
    let alike = |scene: &Scene| {
        let mut own = facts::with_default_methods(scene.clone());
        own.solver.accept_after = 0;
        own.sections.clear();
        if moves {
            own.dynamics.time_step = base.dynamics.time_step;
        } else {
            own.scale_loads(0.0);
        }
        own
    };
    if alike(base) != alike(scene) {
        return None;
    }
    if moves {
        let part = scene.dynamics.time_step / base.dynamics.time_step;
        let [shortest, longest] = limits::TIME_STEPS;
        return (shortest..=longest).contains(&part).then_some(part);
    }
    let [full, own] = [base, scene].map(|scene| load_values(scene).collect::<Vec<f64>>());
    let largest = full.iter().copied().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let Some((index, largest)) = largest.filter(|(_, value)| *value != 0.0) else {
        return (full == own).then_some(1.0);
    };
    let part = own.get(index)? / largest;
    let rounding = ROUNDING * part * largest.abs();
    let is_part =
        full.len() == own.len() && full.iter().zip(&own).all(|(full, own)| (part * full - own).abs() <= rounding);
    let [low, high] = limits::RANGE;
    (is_part && (low * (1.0 - ROUNDING)..=high * (1.0 + ROUNDING)).contains(&part)).then_some(part)
}

/// Returns the components of the loads and of the prescribed displacements and rotations of supports, in their order.
fn load_values(scene: &Scene) -> impl Iterator<Item = f64> {
    let supports =
        scene.supports.iter().flat_map(|support| [support.displacement[0], support.displacement[1], support.turn]);
    let loads = scene.loads.iter().flat_map(|load| match load {
        Load::Force { force: v, .. } | Load::Gravity { acceleration: v, .. } => *v,
        Load::Moment { moment, .. } => [*moment, 0.0],
    });
    supports.chain(loads)
}

/// Returns a scene with a part of the base's loads or time step, rounded to three digits.
fn with_part(base: &Scene, scene: &Scene, axis: &LoadAxis, factor: f64) -> Scene {
    let factor = three_digits(factor * axis.full) / axis.full;
    let mut placed = scene.clone();
    match placed.analysis {
        Analysis::Static => {
            let mut part = base.clone();
            part.scale_loads(factor);
            (placed.loads, placed.supports) = (part.loads, part.supports);
        }
        Analysis::Dynamic => placed.dynamics.time_step = factor * axis.full,
    }
    placed
}

/// Returns `true` if a scene has the method and element of a strip, or its integrator.
fn is_used(strip: &Strip, scene: &Scene) -> bool {
    let Setting { element, method, iterations, stepping, .. } = strip.setting;
    match stepping {
        Some(stepping) => scene.dynamics.integrator == stepping.integrator,
        None => (scene.element(), scene.solver.method, scene.solver.accept_after) == (element, method, iterations),
    }
}

/// The chart in the window, and the columns beside it.
struct StripChart<'a> {
    chart: LimitsChart<'a>,
    /// Upper left corner of the chart.
    corner: Pos2,
    /// Area of the strips with their names and ends.
    rows: Rect,
}

impl<'a> StripChart<'a> {
    fn new(ui: &Ui, whole: Rect, limits: &'a MethodLimits, loads: &'a LoadAxis) -> Self {
        let widths =
            limits.strips.iter().filter_map(|strip| strip.end(loads)).map(|end| {
                ui.painter().layout_no_wrap(said(&end), FontId::proportional(SMALL), Color32::WHITE).size().x
            });
        let ends = widths.fold(ENDS, f32::max) + 20.0;
        let names = if limits.duration.is_some() { INTEGRATORS } else { NAMES };
        let count = limits.strips.len().max(1) as f32;
        let room = whole.height() - 3.0 * LINE;
        let row = (SHARE * room / count).clamp(ROW[0], ROW[1]);
        let has_curve = !limits.reference.is_empty() && room - row * count >= MIN_CURVE;
        let high = if limits.reference.is_empty() { HIGH_ROW } else { ROW[1] };
        let row = if has_curve { row } else { (room / count).clamp(ROW[0], high) };
        let bottom = whole.height() - 2.0 * LINE;
        let strips = bottom - row * count;
        let chart = LimitsChart {
            limits,
            loads,
            across: [names, whole.width() - ends].map(f64::from),
            curve: [LINE, strips - 8.0].map(f64::from),
            has_curve,
            strips: f64::from(strips) + 1.0,
            row: row.into(),
            height: f64::from(row) - 3.0,
        };
        let rows = Rect::from_x_y_ranges(whole.x_range(), whole.top() + strips..=whole.top() + bottom);
        Self { chart, corner: whole.min, rows }
    }

    /// Returns the name of the quantity along the axis.
    fn label(&self) -> &'static str {
        if self.chart.limits.duration.is_some() { "Time step" } else { "Load" }
    }

    /// Lets the pointer and the arrow keys set the load; returns the new part of the load.
    fn handle(&self, ui: &Ui, factor: f64) -> Option<f64> {
        /// Factor by which an arrow key changes the load.
        const STEP: f64 = 1.05;
        let LimitsChart { limits, loads, across: [left, right], curve: [top, _], .. } = self.chart;
        let ([low, high], axis) = (limits.range, self.chart.axis());
        let top = self.rows.top().min(self.corner.y + top as f32);
        let x = |place: f64| self.corner.x + place as f32;
        let area = Rect::from_x_y_ranges(x(left)..=x(right), top..=self.rows.bottom());
        let response = ui.interact(area, ui.scope_id().with("load"), Sense::drag());
        let value = factor * loads.full;
        response.widget_info(|| WidgetInfo::slider(true, value, tr(self.label())));
        let response = response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
        // A press that is a click belongs to a strip.
        if response.dragged() && ui.input(|i| i.pointer.is_decidedly_dragging()) {
            let factor = |at: Pos2| axis.value(f64::from(at.x - self.corner.x)).clamp(low, high);
            return response.interact_pointer_pos().map(factor);
        }
        if !response.has_focus() {
            return None;
        }
        let arrows = egui::EventFilter { horizontal_arrows: true, ..egui::EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let [less, more] = [egui::Key::ArrowLeft, egui::Key::ArrowRight].map(|key| ui.input(|i| i.num_presses(key)));
        let change = STEP.powf(more as f64 - less as f64);
        (change != 1.0).then(|| (factor * change).clamp(low.min(factor), high.max(factor)))
    }

    /// Shows a strip; a click uses its method and element.
    fn strip(&self, ui: &Ui, row: usize, strip: &Strip, scene: &Scene, actions: &mut Vec<Action>) {
        let LimitsChart { loads, row: height, .. } = self.chart;
        let (palette, top) = (Palette::new(ui.visuals()), self.rows.top() + (height * row as f64) as f32);
        let rect = Rect::from_x_y_ranges(self.rows.x_range(), top..=top + height as f32);
        let name = strip.name(|id| tr(id).to_owned());
        let Setting { element, method, iterations, stepping, .. } = strip.setting;
        let is_used = is_used(strip, scene);
        let [good, usable, converges, law] = strip.words(loads).map(|words| said(&words));
        let done = format!("{:.0} %", 100.0 * strip.done);
        let text = match stepping {
            _ if strip.done < 1.0 => "%{name}: %{done} of the loads are solved",
            Some(_) => {
                "%{name}: within 1 %: %{good}; within 5 %: %{usable}; finishes: %{finishes}; strains above 10 %: %{law}"
            }
            None => {
                "%{name}: within 1 %: %{good}; within 5 %: %{usable}; converges: %{converges}; strains above 10 %: %{law}"
            }
        };
        let text = fill!(text, name, done, good, usable, finishes = converges, converges, law);
        let response = ui.interact(rect, ui.scope_id().with(("strip", row)), Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_used, &text));
        let edge = if response.has_focus() || response.hovered() { palette.accent } else { Color32::TRANSPARENT };
        let fill = if is_used { palette.chosen } else { Color32::TRANSPARENT };
        ui.painter().rect(rect, 3.0, fill, Stroke::new(1.0, edge), StrokeKind::Inside);
        let tip = if is_used { text } else { format!("{text}\n{}", tr("Click to use it")) };
        if response.on_hover_text(tip).clicked() && !is_used {
            let label = if stepping.is_some() { "Integrator" } else { "Method" };
            actions.push(Action::edit(label, scene, |scene| match stepping {
                Some(stepping) => scene.dynamics.integrator = stepping.integrator,
                None => {
                    (scene.solver.method, scene.solver.accept_after) = (method, iterations);
                    scene.set_element(element);
                }
            }));
        }
    }

    /// Paints the chart, with a line at a load and a ring at the displacement of the body under it.
    fn paint(&self, ui: &Ui, scene: &Scene, load: Option<(f64, Option<f64>)>) {
        let (chart, mut drawing) = (&self.chart, ChartPainter::new(ui, self.corner));
        chart.grid(&mut drawing);
        let ink = |strip: &Strip| if is_used(strip, scene) { Ink::Text } else { Ink::of(&strip.setting) };
        chart.draw(&mut drawing, &|name| said(name), &ink);
        chart.name(&mut drawing, 33.0, &|name| said(name));
        if let Some((factor, displacement)) = load {
            let (x, [top, _], [left, right]) = (chart.axis().place(factor), chart.curve, chart.across);
            drawing.line(&[[x, top], [x, chart.bottom()]], Ink::Load, 2.0, &[]);
            // In a low window the strips take the room of the text.
            if chart.strips >= top {
                let at = [x.clamp(left, right), top - 5.0];
                drawing.text(at, Anchor::Middle, Ink::Load, &load_text(chart.loads, factor));
            }
            let y = chart.up().zip(displacement.filter(|u| *u > 0.0)).map(|(up, u)| up.place(u));
            // A body that is far off the reference has no place in the chart.
            if let Some(y) = y.filter(|y| (top..chart.curve[1]).contains(y)) {
                drawing.circle([x, y], 5.0, Ink::Load, Some(2.0));
            }
        }
        let name = said(&chart.limits.axis_text(chart.loads));
        // Painted like the other labels of the axis, it has no widget of its own.
        let place =
            Rect::from_x_y_ranges(self.rows.x_range(), self.rows.bottom() + LINE..=self.rows.bottom() + 2.0 * LINE);
        let response = ui.interact(place, ui.scope_id().with("axis"), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &name));
    }
}
