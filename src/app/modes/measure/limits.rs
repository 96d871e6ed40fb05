//! Loads up to which each method and element holds, with the load of the scene on the same axis; of a motion, time steps
//! up to which each integrator does.

use egui::EventFilter;

use crate::app::interface::*;
use crate::app::modes::measure::first_probe;
use crate::app::session::facts::with_default_methods;
use crate::format::six_digits;
use crate::plot::{ScaledAxis, rating_color};
use crate::study::Setting;
use crate::study::figure::LoadAxis;
use crate::study::limits::{self, MethodLimits, Rating, Strip, load_text};

/// Distance of slanted lines over a strip, points.
const HATCH: f32 = 6.0;
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

/// Turns from the scene `base` whose limits are shown to the lab's scene. Another load in the range of the limits does not
/// change them, nor do method and element.
pub(crate) fn turn_to(base: &mut Option<Scene>, scene: &Scene) {
    base.take_if(|base| part_of(base, scene).is_none());
    base.get_or_insert_with(|| scene.clone());
}

/// Shows the limits of the lab's scene: those of `base`, whose loads have the same proportions.
pub(crate) fn show(ui: &mut Ui, session: &Session, base: &Scene, actions: &mut Vec<Action>) {
    let (scene, shown, facts) = (session.scene(), session.drawn(), &session.facts().limits);
    let Some(part) = part_of(base, scene) else { return };
    let progress = facts.progress().map(|(done, _)| done as f32);
    if let Some(reason) = facts.failure(base) {
        ui.centered_and_justified(|ui| ui.weak(said(reason)));
        return;
    }
    let Some(limits) = facts.so_far(base) else {
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
        chart.curve(ui);
        for (row, strip) in limits.strips.iter().enumerate() {
            chart.strip(ui, row, strip, scene, actions);
        }
        let factor = placed.unwrap_or(part);
        if limits.contains(factor) {
            // While a load is not reached, the body is that of another one.
            let is_here = part_of(base, shown.scene()).is_none_or(|own| own == part);
            let length = first_probe(shown).filter(|_| is_here).map(|u| u.norm());
            chart.load_line(ui, factor, length);
        }
    });
}

/// Shows the key of the colours once limits are known; a line breaks between entries.
pub(crate) fn key(ui: &mut Ui, session: &Session, base: &Scene) {
    const BOX: Vec2 = vec2(10.0, 10.0);
    if session.facts().limits.so_far(base).is_none() {
        return;
    }
    ui.spacing_mut().item_spacing = vec2(10.0, 0.0);
    for (rating, name) in Rating::all(session.is_motion()) {
        legend::entry(ui, &said(&name), BOX, &|ui, rect| _ = ui.painter().rect_filled(rect, 0.0, color(rating)));
    }
    let ink = Palette::new(ui.visuals()).text;
    legend::entry(ui, tr("strains above 10 % or inverted"), BOX, &|ui, rect| {
        ui.painter().rect_stroke(rect, 0.0, Stroke::new(1.0, ink), egui::StrokeKind::Inside);
        hatch(ui, rect, ink);
    });
}

/// Returns the part of the base's loads, or of its time step, that a scene has; `None` if the limits of the base are not
/// those of the scene.
fn part_of(base: &Scene, scene: &Scene) -> Option<f64> {
    /// Relative rounding error of loads.
    const ROUNDING: f64 = 1e-9;
    let stops = |scene: &Scene| (scene.solver.accept_after, scene.element(), scene.solver.method);
    if scene.solver.accept_after > 0 && stops(scene) != stops(base) {
        return None;
    }
    let moves = scene.analysis == Analysis::Dynamic;
    let alike = |scene: &Scene| {
        let mut own = with_default_methods(scene.clone());
        own.solver.accept_after = 0;
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

fn color(rating: Rating) -> Color32 {
    let [r, g, b] = rating_color(rating);
    Color32::from_rgb(r, g, b)
}

/// Draws slanted lines over a rectangle.
fn hatch(ui: &Ui, rect: Rect, ink: Color32) {
    let painter = ui.painter_at(rect);
    // Lines of neighbouring rectangles meet.
    let mut x = (rect.left() / HATCH).floor() * HATCH - rect.height();
    while x < rect.right() {
        painter.line_segment([pos2(x, rect.bottom()), pos2(x + rect.height(), rect.top())], Stroke::new(1.0, ink));
        x += HATCH;
    }
}

/// Places of the chart in the window: the curve above the strips, on one axis of loads.
struct StripChart<'a> {
    limits: &'a MethodLimits,
    axis: &'a LoadAxis,
    across: ScaledAxis,
    palette: Palette,
    curve: Rect,
    strips: Rect,
    row: f32,
    /// Width of the column of names.
    names: f32,
    /// Width of the column of the loads at the ends of the strips.
    ends: f32,
    /// `true` if the curve has room.
    has_curve: bool,
}

impl<'a> StripChart<'a> {
    fn new(ui: &Ui, whole: Rect, limits: &'a MethodLimits, axis: &'a LoadAxis) -> Self {
        let widths =
            limits.strips.iter().filter_map(|strip| strip.end(axis, limits.range)).map(|end| {
                ui.painter().layout_no_wrap(said(&end), FontId::proportional(SMALL), Color32::WHITE).size().x
            });
        let ends = widths.fold(ENDS, f32::max) + 20.0;
        let names = if limits.duration.is_some() { INTEGRATORS } else { NAMES };
        let (left, right) = (whole.left() + names, whole.right() - ends);
        let count = limits.strips.len().max(1) as f32;
        let room = whole.height() - 3.0 * LINE;
        let row = (SHARE * room / count).clamp(ROW[0], ROW[1]);
        let has_curve = !limits.reference.is_empty() && room - row * count >= MIN_CURVE;
        let high = if limits.reference.is_empty() { HIGH_ROW } else { ROW[1] };
        let row = if has_curve { row } else { (room / count).clamp(ROW[0], high) };
        let bottom = whole.bottom() - 2.0 * LINE;
        let top = bottom - row * count;
        Self {
            limits,
            axis,
            across: ScaledAxis::of(limits.range, [left, right].map(f64::from)),
            palette: Palette::new(ui.visuals()),
            curve: Rect::from_min_max(pos2(left, whole.top() + LINE), pos2(right, top - 8.0)),
            strips: Rect::from_min_max(pos2(left, top), pos2(right, bottom)),
            row,
            names,
            ends,
            has_curve,
        }
    }

    /// Returns the name of the quantity along the axis.
    fn label(&self) -> &'static str {
        if self.limits.duration.is_some() { "Time step" } else { "Load" }
    }

    /// Returns the place of a part of the load.
    fn x(&self, factor: f64) -> f32 {
        self.across.place(factor) as f32
    }

    fn text(&self, ui: &Ui, at: egui::Pos2, align: Align2, text: &str, color: Color32) {
        ui.painter().text(at, align, text, FontId::proportional(SMALL), color);
    }

    /// Lets the pointer and the arrow keys set the load; returns the new part of the load.
    fn handle(&self, ui: &Ui, factor: f64) -> Option<f64> {
        /// Factor by which an arrow key changes the load.
        const STEP: f64 = 1.05;
        let [low, high] = self.limits.range;
        let area = self.curve.union(self.strips);
        let response = ui.interact(area, ui.scope_id().with("load"), Sense::drag());
        let value = factor * self.axis.full;
        response.widget_info(|| WidgetInfo::slider(true, value, tr(self.label())));
        let response = response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
        // A press that is a click belongs to a strip.
        if response.dragged() && ui.input(|i| i.pointer.is_decidedly_dragging()) {
            let factor = |at: egui::Pos2| self.across.value(f64::from(at.x)).clamp(low, high);
            return response.interact_pointer_pos().map(factor);
        }
        if !response.has_focus() {
            return None;
        }
        let arrows = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let [less, more] = [egui::Key::ArrowLeft, egui::Key::ArrowRight].map(|key| ui.input(|i| i.num_presses(key)));
        let change = STEP.powf(more as f64 - less as f64);
        (change != 1.0).then(|| (factor * change).clamp(low.min(factor), high.max(factor)))
    }

    /// Draws the length of the reference displacement over the load, and the axis of loads.
    fn curve(&self, ui: &Ui) {
        let Self { palette, curve, strips, .. } = self;
        let painter = ui.painter();
        for (x, factor) in self.across.values().into_iter().map(|(place, factor)| (place as f32, factor)) {
            let ends = [pos2(x, curve.top()), pos2(x, strips.bottom())];
            painter.line_segment(ends, Stroke::new(1.0, palette.line));
            let text = painter.layout_no_wrap(load_text(self.axis, factor), FontId::proportional(SMALL), palette.text);
            painter.galley(pos2(x - 0.5 * text.size().x, strips.bottom() + 2.0), text, palette.text);
        }
        let at = pos2(strips.center().x, strips.bottom() + LINE);
        let name = said(&limits::axis_text(self.limits, self.axis));
        self.text(ui, at, Align2::CENTER_TOP, &name, palette.secondary);
        if let Some(critical) = self.limits.critical().filter(|&critical| self.limits.contains(critical)) {
            let x = self.x(critical);
            let ends = [pos2(x, curve.top()), pos2(x, strips.bottom())];
            painter.add(egui::Shape::dashed_line(&ends, Stroke::new(1.5, palette.error), 6.0, 4.0));
            // Painted like the other labels of the axis, it has no widget of its own.
            let place = Rect::from_center_size(at + vec2(0.0, 0.5 * LINE), vec2(strips.width(), LINE));
            let response = ui.interact(place, ui.scope_id().with("axis"), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &name));
        }
        let Some(up) = self.up() else { return };
        // Only as many decades as have room for their labels.
        let room = (curve.height() / LINE).max(1.0) as usize;
        let values = up.values();
        let step = values.len().saturating_sub(1) / room + 1;
        let lengths: Vec<f64> = values.iter().map(|(_, length)| *length).collect();
        let (power, symbol) = prefix(&lengths, "m");
        for (y, length) in values.into_iter().step_by(step).map(|(place, length)| (place as f32, length)) {
            painter.line_segment([pos2(curve.left(), y), pos2(curve.right(), y)], Stroke::new(1.0, palette.line));
            let at = pos2(curve.left() - 8.0, y);
            let text = format!("{} {symbol}m", number(six_digits(length / 10f64.powi(power))));
            self.text(ui, at, Align2::RIGHT_CENTER, &text, palette.secondary);
        }
        for known in self.limits.reference.split(|(_, u)| u.is_none()) {
            let lengths = known.iter().filter_map(|(factor, u)| Some((*factor, u.map(|u| Vector2::norm(&u))?)));
            let points = lengths.filter(|(_, u)| *u > 0.0).map(|(factor, u)| pos2(self.x(factor), up.place(u) as f32));
            painter.line(points.collect(), Stroke::new(2.0, palette.exact));
        }
        let at = pos2(curve.right() + 10.0, curve.top());
        let text = tr("reference displacement\nof the first probe");
        self.text(ui, at, Align2::LEFT_TOP, text, palette.exact);
    }

    /// Returns the vertical axis of the curve; `None` if no reference displacement is known, or the curve has no room.
    fn up(&self) -> Option<ScaledAxis> {
        /// Space above and below the curve, as a ratio of displacements.
        const EDGE: f64 = 1.2589;
        let lengths = self.limits.reference.iter().filter_map(|(_, u)| u.map(|u| u.norm())).filter(|u| *u > 0.0);
        let range = lengths.fold([f64::INFINITY, 0.0_f64], |[low, high], u| [low.min(u), high.max(u)]);
        let ends = [self.curve.bottom(), self.curve.top()].map(f64::from);
        let range = [range[0] / EDGE, range[1] * EDGE];
        (self.has_curve && range[1].is_finite() && range[1] > 0.0).then(|| ScaledAxis::of(range, ends))
    }

    /// Shows a strip; a click uses its method and element.
    fn strip(&self, ui: &Ui, row: usize, strip: &Strip, scene: &Scene, actions: &mut Vec<Action>) {
        let Self { palette, strips, .. } = self;
        let top = strips.top() + self.row * row as f32;
        let right = strips.right() + self.ends;
        let rect = Rect::from_min_max(pos2(strips.left() - self.names, top), pos2(right, top + self.row));
        let name = strip.name(|id| tr(id).to_owned());
        let Setting { element, method, iterations, stepping, .. } = strip.setting;
        let is_used = match stepping {
            Some(stepping) => scene.dynamics.integrator == stepping.integrator,
            None => (scene.element(), scene.solver.method, scene.solver.accept_after) == (element, method, iterations),
        };
        let [good, usable, converges, law] = strip.words(self.axis, self.limits.range).map(|words| said(&words));
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
        ui.painter().rect(rect, 3.0, fill, Stroke::new(1.0, edge), egui::StrokeKind::Inside);
        let own = stepping.map_or_else(|| palette.method(method), |stepping| palette.integrator(stepping.integrator));
        let ink = if is_used { palette.text } else { own };
        self.text(ui, pos2(strips.left() - 10.0, rect.center().y), Align2::RIGHT_CENTER, &name, ink);
        let bar = |from: f32, to: f32| Rect::from_x_y_ranges(from..=to, top + 1.0..=top + self.row - 2.0);
        if strip.done < 1.0 {
            ui.painter().rect_filled(bar(strips.left(), strips.right()), 0.0, palette.line);
        }
        // The colours of a strip that is not complete may still change.
        let strength = if strip.done < 1.0 { 0.35 } else { 1.0 };
        for piece in strip.pieces(self.limits.range) {
            let [from, to] = piece.range.map(|factor| self.x(factor));
            let bar = bar(from, to);
            ui.painter().rect_filled(bar, 0.0, color(piece.rating).gamma_multiply(strength));
            if piece.is_beyond_law {
                hatch(ui, bar, Color32::from_black_alpha(200));
            }
        }
        let (end, ink) = match strip.done < 1.0 {
            true => (Some(fill!("%{done} solved", done)), palette.secondary),
            false => (strip.end(self.axis, self.limits.range).map(|end| said(&end)), palette.text),
        };
        if let Some(end) = end {
            self.text(ui, pos2(strips.right() + 10.0, rect.center().y), Align2::LEFT_CENTER, &end, ink);
        }
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

    /// Draws the line of the scene's load, and a ring at the displacement of the body.
    fn load_line(&self, ui: &Ui, factor: f64, displacement: Option<f64>) {
        let (x, color) = (self.x(factor), self.palette.load);
        ui.painter().line_segment([pos2(x, self.curve.top()), pos2(x, self.strips.bottom())], Stroke::new(2.0, color));
        let half = 60.0_f32.min(0.5 * self.strips.width());
        let at = x.clamp(self.strips.left() + half - self.names, self.strips.right() - half + 24.0);
        // In a low window the strips take the room of the text.
        if self.strips.top() >= self.curve.top() {
            let at = pos2(at, self.curve.top() - 1.0);
            self.text(ui, at, Align2::CENTER_BOTTOM, &load_text(self.axis, factor), color);
        }
        if let (Some(up), Some(u)) = (self.up(), displacement.filter(|u| *u > 0.0)) {
            let y = up.place(u) as f32;
            // A body that is far off the reference has no place in the plot.
            if y > self.curve.top() {
                ui.painter().circle_stroke(pos2(x, y), 5.0, Stroke::new(2.0, color));
            }
        }
    }
}
