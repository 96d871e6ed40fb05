//! The load curve, traced while the load is dragged: what every pane has answered to the loads so far.

use egui::{Align2, FontId, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use egui_plot::{Line, MarkerShape, PlotBounds, PlotPoints, Points, VLine};

use super::pane::{Doing, Pane};
use super::setting::PaneSetting;
use crate::app::action::Action;
use crate::app::budget::{marker, question};
use crate::app::finder::Finder;
use crate::app::language::{fill, tr};
use crate::app::palette::{BODY, Palette, SMALL};
use crate::app::plot::still;
use crate::scene::limits::{self, Limit};
use crate::scene::{Load, MethodKind, Place, Scene};
use crate::study::{LoadCurve, Reference};
use crate::words::{engineering, three_digits};

/// Dots of a setting that are kept.
const MOST_DOTS: usize = 500;
/// Dots nearer to each other than this, parts of their load, are one.
const SAME_LOAD: f64 = 2e-3;

/// So many times smaller than what the plot reaches, a load would not be seen.
const TINY: f64 = 50.0;

/// The load that is traced: the first force, else the first moment, else the weight.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    name: &'static str,
    /// Of the edits of it.
    label: &'static str,
    limit: Limit,
    /// Its number among the scene's loads.
    load: usize,
    magnitude: f64,
    /// Of unit length; absent without load.
    direction: Option<[f64; 2]>,
}

impl Axis {
    fn of(scene: &Scene) -> Option<Self> {
        let kinds: [fn(&Load) -> bool; 3] = [
            |load| matches!(load, Load::Force { .. }),
            |load| matches!(load, Load::Moment { .. }),
            |load| matches!(load, Load::Gravity { .. }),
        ];
        let load = kinds.iter().find_map(|is_kind| scene.loads.iter().position(is_kind))?;
        let (name, label, limit, vector) = match scene.loads.get(load)? {
            Load::Force { force, .. } => ("force", "Force", limits::FORCE, *force),
            Load::Moment { moment, .. } => ("moment", "Moment", limits::MOMENT, [*moment, 0.0]),
            Load::Gravity { acceleration, .. } => ("gravity", "Gravity", limits::ACCELERATION, *acceleration),
        };
        let magnitude = vector[0].hypot(vector[1]);
        let direction = (magnitude > 0.0).then(|| vector.map(|v| v / magnitude));
        Some(Self { name, label, limit, load, magnitude, direction })
    }

    /// Makes it another magnitude.
    fn set(&self, scene: &mut Scene, direction: [f64; 2], magnitude: f64) {
        let vector = direction.map(|v| v * magnitude);
        match scene.loads.get_mut(self.load) {
            Some(Load::Force { force, .. }) => *force = vector,
            Some(Load::Moment { moment, .. }) => *moment = vector[0],
            Some(Load::Gravity { acceleration, .. }) => *acceleration = vector,
            None => {}
        }
    }

    /// What scenes that differ in the magnitude only have in common.
    fn family(&self, scene: &Scene) -> Scene {
        let mut family = question(scene);
        self.set(&mut family, [0.0; 2], 0.0);
        family
    }
}

/// An answer to a load.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dot {
    load: f64,
    deflection: f64,
    /// Whether it is an equilibrium.
    good: bool,
}

/// What has been answered so far.
#[derive(Debug)]
pub(super) struct Trace {
    axis: Option<Axis>,
    family: Option<Scene>,
    direction: Option<[f64; 2]>,
    series: Vec<(PaneSetting, Vec<Dot>)>,
    exact: Finder<Vec<[f64; 2]>>,
    /// The exact curve that was found last.
    line: Vec<[f64; 2]>,
    /// What is true of the loads that were there: plane elasticity may differ from the exact beam.
    truths: Vec<[f64; 2]>,
    /// The load at the right edge.
    reach: f64,
}

impl Default for Trace {
    fn default() -> Self {
        Self {
            axis: None,
            family: None,
            direction: None,
            series: Vec::new(),
            exact: Finder::new(exact_line),
            line: Vec::new(),
            truths: Vec::new(),
            reach: 0.0,
        }
    }
}

/// The exact deflection of the first probe over the load that is traced.
fn exact_line(scene: &Scene) -> Option<Vec<[f64; 2]>> {
    let axis = Axis::of(scene).filter(|axis| axis.magnitude > 0.0)?;
    // Along the curve of several loads all of them would grow.
    let pulls = |load: &&Load| match load {
        Load::Force { force: v, .. } | Load::Gravity { acceleration: v, .. } => *v != [0.0; 2],
        Load::Moment { moment, .. } => *moment != 0.0,
    };
    if scene.loads.iter().filter(pulls).count() > 1 || scene.probes.first()?.place != Place::from("right") {
        return None;
    }
    let curve = LoadCurve::new(scene)?;
    Some(curve.samples.iter().map(|s| [s.factor * axis.magnitude, s.truth.norm()]).collect())
}

impl Trace {
    /// Goes on with the scene; another scene, or another direction of its load, begins a new curve.
    pub(super) fn follow(&mut self, scene: &Scene) {
        /// Directions that differ by less, as parts of a unit vector, are the same.
        const SAME_DIRECTION: f64 = 1e-6;
        self.axis = Axis::of(scene);
        let family = self.axis.map(|axis| axis.family(scene));
        let direction = self.axis.and_then(|axis| axis.direction);
        let turned = self.direction.zip(direction).is_some_and(|(a, b)| {
            // Along it or against it is the same curve no more.
            (a[0] - b[0]).hypot(a[1] - b[1]) > SAME_DIRECTION
        });
        if family != self.family || turned {
            *self = Self { axis: self.axis, family, ..Self::default() };
        }
        self.direction = direction.or(self.direction);
    }

    /// Looks for the exact curve, where that is not known far enough.
    pub(super) fn ask(&mut self, scene: &Scene, ctx: &egui::Context) {
        if self.needs_exact() {
            self.exact.forget();
        }
        if self.axis.is_some_and(|axis| axis.magnitude > 0.0) {
            self.exact.ask(scene, ctx);
        }
        self.take_exact();
    }

    /// Finds the exact curve, however long it takes.
    pub(super) fn settle(&mut self, scene: &Scene) {
        if self.needs_exact() {
            self.exact.forget();
        }
        self.exact.settle(scene);
        self.take_exact();
    }

    fn take_exact(&mut self) {
        if let Some(line) = self.exact.get()
            && self.line != *line
        {
            self.line.clone_from(line);
        }
    }

    /// Whether the exact curve that is known ends before the load, or is too coarse for it.
    fn needs_exact(&self) -> bool {
        let (Some(end), Some(axis)) = (self.exact.get().and_then(|line| line.last()), self.axis) else { return false };
        axis.magnitude > end[0] || axis.magnitude > 0.0 && TINY * axis.magnitude < end[0]
    }

    /// Notes what is true of the present load.
    pub(super) fn record_truth(&mut self, truth: Option<&Reference>) {
        let (Some(axis), Some(truth)) = (self.axis, truth.and_then(Reference::first)) else { return };
        let dot = [axis.magnitude, truth.displacement.norm()];
        self.truths.retain(|other| (other[0] - dot[0]).abs() > SAME_LOAD * dot[0]);
        self.truths.push(dot);
        if self.truths.len() > MOST_DOTS {
            self.truths.remove(0);
        }
    }

    /// The true deflection under a load, where that is known; else that of the exact beam.
    fn exact_at(&self, load: f64) -> Option<f64> {
        let truth = self.truths.iter().find(|dot| dot[0] == load).map(|dot| dot[1]);
        let piece = || self.line.windows(2).find(|w| (w[0][0]..=w[1][0]).contains(&load));
        let between = |w: &[[f64; 2]]| w[0][1] + (load - w[0][0]) / (w[1][0] - w[0][0]) * (w[1][1] - w[0][1]);
        truth.or_else(|| piece().map(between))
    }

    /// Notes what a pane has answered to the present load. Says whether that is new.
    pub(super) fn record(&mut self, scene: &Scene, pane: &Pane) -> bool {
        let (Some(axis), Some((probe, good))) = (self.axis, pane.answer()) else { return false };
        let dot = Dot { load: axis.magnitude, deflection: probe.u.norm(), good };
        let setting = pane.setting.of(scene);
        let number = self.series.iter().position(|(own, _)| *own == setting).unwrap_or_else(|| {
            self.series.push((setting, Vec::new()));
            self.series.len() - 1
        });
        let dots = &mut self.series[number].1;
        let same = |other: &Dot| (other.load - dot.load).abs() <= SAME_LOAD * dot.load.max(f64::MIN_POSITIVE);
        match dots.iter_mut().find(|other| same(other)) {
            Some(other) if *other == dot => return false,
            Some(other) => *other = dot,
            None => dots.push(dot),
        }
        if dots.len() > MOST_DOTS {
            dots.remove(0);
        }
        true
    }

    /// Every dot that is an equilibrium: setting, load, deflection.
    pub(super) fn dots(&self) -> Vec<(PaneSetting, [f64; 2])> {
        let dots = self.series.iter().flat_map(|(setting, dots)| dots.iter().map(move |dot| (*setting, *dot)));
        dots.filter(|(_, dot)| dot.good).map(|(setting, dot)| (setting, [dot.load, dot.deflection])).collect()
    }

    fn dots_of(&self, setting: PaneSetting) -> &[Dot] {
        self.series.iter().find(|(own, _)| *own == setting).map_or(&[], |(_, dots)| dots)
    }

    /// Shows the curve of the panes; a press in it sets the load.
    pub(super) fn show(&mut self, ui: &mut Ui, scene: &Scene, panes: &[Pane], actions: &mut Vec<Action>) {
        let Some(axis) = self.axis else {
            ui.centered_and_justified(|ui| ui.weak(tr("The scene has no load whose curve could be traced.")));
            return;
        };
        let list = (0.3 * ui.available_width()).clamp(150.0, 250.0);
        let whole = ui.available_rect_before_wrap();
        let split = whole.right() - list;
        let plot = Rect::from_min_max(whole.min, pos2(split - 10.0, whole.bottom()));
        ui.scope_builder(egui::UiBuilder::new().max_rect(plot), |ui| self.plot(ui, axis, scene, panes, actions));
        let names = Rect::from_min_max(pos2(split, whole.top()), whole.max);
        ui.scope_builder(egui::UiBuilder::new().max_rect(names), |ui| self.names(ui, axis, scene, panes));
    }

    fn plot(&mut self, ui: &mut Ui, axis: Axis, scene: &Scene, panes: &[Pane], actions: &mut Vec<Action>) {
        let palette = Palette::new(ui.visuals());
        // A picture whose edge moved under a pointer that scrubs in it would run away.
        let pressed = ui.input(|i| i.pointer.any_down());
        let settled = axis.magnitude > 0.9 * self.reach || TINY * axis.magnitude < self.reach;
        if axis.magnitude > self.reach || settled && !pressed && axis.magnitude > 0.0 {
            self.reach = 1.25 * axis.magnitude;
        }
        let reach = if self.reach > 0.0 { self.reach } else { 1.0 };
        let seen = |p: &&[f64; 2]| p[0] <= 1.001 * reach;
        let line: Vec<[f64; 2]> = self.line.iter().filter(seen).copied().collect();
        let settings: Vec<PaneSetting> = panes.iter().map(|pane| pane.setting.of(scene)).collect();
        let good = |linear: bool| {
            let of = settings.iter().filter(move |s| linear || s.method != Some(MethodKind::Linear));
            let dots = of.flat_map(|&s| self.dots_of(s)).filter(|dot| dot.good && dot.load <= reach);
            dots.map(|dot| dot.deflection).fold(0.0, f64::max)
        };
        // Linear theory leaves the picture instead of stretching it.
        let truths: Vec<[f64; 2]> = self.truths.iter().filter(seen).copied().collect();
        let known = line.iter().chain(&truths).map(|p| p[1]).fold(good(false), f64::max);
        let top = 1.2 * if known > 0.0 { known } else { good(true) };
        let top = if top > 0.0 { top } else { 1.0 };
        let unit = axis.limit.unit;
        let probe = tr(scene.probes.first().map_or("probe", |probe| probe.name.as_str()));
        let plot = still(&palette, "trace", (tr(axis.name), unit), (&fill!("%{probe} moves", probe = probe), "m"));
        let response = plot.show(ui, |plot| {
            plot.set_plot_bounds(PlotBounds::from_min_max([0.0, 0.0], [reach, top]));
            let now = VLine::new(tr("now"), axis.magnitude).color(palette.load.gamma_multiply(0.7)).width(1.0);
            plot.vline(now.allow_hover(false));
            if !line.is_empty() {
                plot.line(Line::new(tr("exact beam"), PlotPoints::from(line)).color(palette.exact).width(2.0));
            }
            plot.points(Points::new(tr("exact"), truths).color(palette.exact).radius(5.0).shape(MarkerShape::Plus));
            // Dots in the same place lie in each other.
            for (setting, smaller) in settings.iter().copied().zip([0.0, 1.0, 2.0, 3.0]) {
                let (Some(method), Some(element)) = (setting.method, setting.element) else { continue };
                let (color, shape) = (palette.method(method), marker(element).0);
                let dots = self.dots_of(setting);
                let drawn = |good: bool, now: bool| -> Vec<[f64; 2]> {
                    let own = dots.iter().filter(|dot| dot.good == good && (dot.load == axis.magnitude) == now);
                    let places = own.map(|dot| [dot.load, if good { dot.deflection } else { 0.03 * top }]);
                    places.filter(|p| p[1] <= top && p[0] <= reach).collect()
                };
                let name = setting.words();
                plot.points(
                    Points::new(name.clone(), drawn(true, false)).color(color).radius(3.8 - 0.7 * smaller).shape(shape),
                );
                plot.points(
                    Points::new(name.clone(), drawn(true, true)).color(color).radius(7.0 - 1.5 * smaller).shape(shape),
                );
                let failed = [drawn(false, false), drawn(false, true)].concat();
                let failed = Points::new(fill!("%{setting} does not converge", setting = name), failed);
                plot.points(failed.color(color).radius(4.0).shape(MarkerShape::Cross));
            }
        });
        let area = response.response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
        area.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, tr("Load curve")));
        if area.is_pointer_button_down_on()
            && let Some(at) = area.interact_pointer_pos()
            && let Some(direction) = self.direction
        {
            /// A dot so near, points, is meant.
            const NEAR: f32 = 5.0;
            let load = |x: f32| response.transform.value_from_position(pos2(x, at.y)).x;
            let (low, high) = (load(at.x - NEAR), load(at.x + NEAR));
            let dots = settings.iter().flat_map(|&s| self.dots_of(s)).map(|dot| dot.load);
            let dot = dots.filter(|l| (low..=high).contains(l)).min_by(|a, b| {
                let off = |l: f64| (l - load(at.x)).abs();
                off(*a).total_cmp(&off(*b))
            });
            let wanted = dot.unwrap_or_else(|| three_digits(load(at.x))).clamp(0.0, axis.limit.max.min(reach));
            if wanted != axis.magnitude {
                let mut scene = Box::new(scene.clone());
                axis.set(&mut scene, direction, wanted);
                actions.push(Action::Edit(axis.label, scene));
            }
        }
    }

    /// Who is who, and what each says of the present load.
    fn names(&self, ui: &mut Ui, axis: Axis, scene: &Scene, panes: &[Pane]) {
        let palette = Palette::new(ui.visuals());
        ui.spacing_mut().item_spacing.y = 2.0;
        let load = engineering(three_digits(axis.magnitude), axis.limit.unit);
        let head = format!("{} {load}", tr(axis.name));
        ui.add_space(2.0);
        ui.label(egui::RichText::new(head).color(palette.load)).on_hover_text(tr("Press in the plot to set it"));
        if !self.line.is_empty() || !self.truths.is_empty() {
            let value = self.exact_at(axis.magnitude).map(|u| engineering(three_digits(u), "m"));
            row(ui, &palette, palette.exact, None, tr("exact"), &value.unwrap_or_default(), false);
        }
        for pane in panes {
            let setting = pane.setting.of(scene);
            let (Some(method), Some(element)) = (setting.method, setting.element) else { continue };
            let (value, bad) = match (pane.answer(), pane.doing()) {
                (_, Doing::Refused(_)) => (tr("no solution").to_owned(), true),
                (Some((probe, true)), _) => (engineering(three_digits(probe.u.norm()), "m"), false),
                (Some((_, false)), _) => (tr("does not converge").to_owned(), true),
                (None, _) => (tr("iterates").to_owned(), false),
            };
            let mark = Some(marker(element).0);
            row(ui, &palette, palette.method(method), mark, &setting.words(), &value, bad);
        }
    }
}

/// A mark, a name, and a value at the right.
fn row(
    ui: &mut Ui,
    palette: &Palette,
    color: egui::Color32,
    mark: Option<MarkerShape>,
    name: &str,
    value: &str,
    bad: bool,
) {
    const MARK: f32 = 18.0;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    let painter = ui.painter();
    let center = rect.left_center() + vec2(6.0, 0.0);
    match mark {
        None => _ = painter.line_segment([center - vec2(6.0, 0.0), center + vec2(6.0, 0.0)], Stroke::new(2.0, color)),
        Some(MarkerShape::Up) => {
            let corners = [vec2(0.0, -5.0), vec2(5.0, 4.0), vec2(-5.0, 4.0)].map(|d| center + d);
            painter.add(egui::Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
        }
        Some(MarkerShape::Square) => {
            painter.rect_filled(Rect::from_center_size(center, vec2(8.0, 8.0)), 0.0, color);
        }
        Some(_) => _ = painter.circle_filled(center, 4.5, color),
    }
    let ink = if bad { palette.error } else { palette.text };
    let value_galley = painter.layout_no_wrap(value.to_owned(), FontId::proportional(SMALL), ink);
    let room = (rect.width() - MARK - value_galley.size().x - 8.0).max(0.0);
    let mut job = egui::text::LayoutJob::simple_singleline(name.to_owned(), FontId::proportional(BODY), palette.text);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room);
    let name_galley = painter.layout_job(job);
    let at = Align2::LEFT_CENTER.anchor_size(rect.left_center() + vec2(MARK, 0.0), name_galley.size());
    painter.galley(at.min, name_galley, palette.text);
    let at = Align2::RIGHT_CENTER.anchor_size(rect.right_center(), value_galley.size());
    painter.galley(at.min, value_galley, ink);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, format!("{name}: {value}")));
    response.on_hover_text(format!("{name}: {value}"));
}
