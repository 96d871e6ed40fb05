//! Load curve of a comparison, traced while the load is dragged: the results of every pane for all loads so far.

use egui::{Pos2, Ui, WidgetInfo, pos2};
use egui_plot::PlotResponse;
use nalgebra::Vector2;

use super::pane::Pane;
use super::setting::PaneSetting;
use crate::app::action::Action;
use crate::app::language::{fill, percent, tr};
use crate::app::modes::figure::{self, Parts};
use crate::app::modes::limits::load_curve::{axes, displacement_text, pair, quantities};
use crate::app::session::compared_solve::Activity;
use crate::app::session::facts::without_settings;
use crate::app::task::keyed::{Keyed, facts};
use crate::app::task::thread::POLL;
use crate::app::view_options::CurvePlot;
use crate::exact_beam::error_percent;
use crate::format::{engineering, three_digits};
use crate::progress::Observer;
use crate::scene::limits::{self, Limit};
use crate::scene::{Load, MethodKind, Place, Scene};
use crate::study::figure::{Figure, FigurePoint, FigureQuantity, FigureRow, FigureSeries, Ink, Mark, dominant_axis};
use crate::study::{LoadCurve, Reference};

/// Largest number of dots per setting.
const MAX_DOTS: usize = 500;
/// Relative difference of loads below which two dots are the same.
const SAME_LOAD: f64 = 2e-3;

/// The plot is rescaled if the load is smaller than its range by more than this factor.
const TINY: f64 = 50.0;

/// Load that is traced: the first force, else the first moment, else gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TraceAxis {
    name: &'static str,
    /// Label of its edits.
    label: &'static str,
    limit: Limit,
    /// Index among the scene's loads.
    load: usize,
    magnitude: f64,
    /// Unit vector of the load; `None` for a zero load.
    direction: Option<[f64; 2]>,
}

impl TraceAxis {
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

    /// Sets the magnitude of the load.
    fn set(&self, scene: &mut Scene, direction: [f64; 2], magnitude: f64) {
        let vector = direction.map(|v| v * magnitude);
        match scene.loads.get_mut(self.load) {
            Some(Load::Force { force, .. }) => *force = vector,
            Some(Load::Moment { moment, .. }) => *moment = vector[0],
            Some(Load::Gravity { acceleration, .. }) => *acceleration = vector,
            None => {}
        }
    }

    /// Returns the scene without the load's magnitude and the panes' settings: scenes with the same family share a
    /// curve.
    fn family(&self, scene: &Scene) -> Scene {
        let mut family = without_settings(scene);
        self.set(&mut family, [0.0; 2], 0.0);
        family
    }
}

/// Result for one load.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dot {
    load: f64,
    /// Displacement of the first probe, m.
    u: Vector2<f64>,
    /// `true` if the result is an equilibrium.
    good: bool,
}

/// Results so far.
#[derive(Debug)]
pub(super) struct Trace {
    axis: Option<TraceAxis>,
    family: Option<Scene>,
    direction: Option<[f64; 2]>,
    series: Vec<(PaneSetting, Vec<Dot>)>,
    exact: Keyed<ExactLine>,
    /// Reference solutions for the loads so far; they may differ from the exact beam, because they solve plane
    /// elasticity.
    references: Vec<Exact>,
    /// Load at the right edge of the plot.
    reach: f64,
    /// Most informative quantities of this curve; `None` until a part of it is known.
    usual: Option<CurvePlot>,
}

/// Load, and displacement of the first probe in the exact solution under it, m.
pub(crate) type Exact = (f64, Vector2<f64>);

impl Default for Trace {
    fn default() -> Self {
        Self {
            axis: None,
            family: None,
            direction: None,
            series: Vec::new(),
            exact: Keyed::default(),
            references: Vec::new(),
            reach: 0.0,
            usual: None,
        }
    }
}

facts! {
    /// Curve of the exact beam.
    ExactLine by with_round_load = "exact-line": Vec<Exact>, |scene, observe| Ok(exact_line(&with_round_load(scene), observe));
}

/// Returns the scene without the panes' settings, and with its load raised to the next power of four: the exact curve up
/// to there is fine enough for all loads from a quarter of it.
fn with_round_load(scene: &Scene) -> Scene {
    let mut round = without_settings(scene);
    if let Some(axis) = TraceAxis::of(scene)
        && let Some(direction) = axis.direction
    {
        let load = 4f64.powf(axis.magnitude.log(4.0).ceil()).min(axis.limit.max);
        axis.set(&mut round, direction, load);
    }
    round
}

/// Returns the displacement of the first probe of the exact beam over the traced load.
fn exact_line(scene: &Scene, observe: Observer<'_>) -> Option<Vec<Exact>> {
    let axis = TraceAxis::of(scene).filter(|axis| axis.magnitude > 0.0)?;
    // The load curve scales all loads together, so it applies to a single load only.
    if has_several_loads(scene) || scene.probes.first()?.place != Place::from("right") {
        return None;
    }
    let curve = LoadCurve::observed(scene, observe)?;
    Some(curve.samples.iter().map(|s| (s.factor * axis.magnitude, s.exact)).collect())
}

fn has_several_loads(scene: &Scene) -> bool {
    let pulls = |load: &&Load| match load {
        Load::Force { force: v, .. } | Load::Gravity { acceleration: v, .. } => *v != [0.0; 2],
        Load::Moment { moment, .. } => *moment != 0.0,
    };
    scene.loads.iter().filter(pulls).count() > 1
}

impl Trace {
    /// Updates the trace to a scene; another scene or another direction of its load starts a new curve.
    pub(super) fn set_scene(&mut self, scene: &Scene) {
        /// Largest difference between two unit vectors that count as the same direction.
        const SAME_DIRECTION: f64 = 1e-6;
        self.axis = TraceAxis::of(scene);
        let family = self.axis.map(|axis| axis.family(scene));
        let direction = self.axis.and_then(|axis| axis.direction);
        let has_rotated = self.direction.zip(direction).is_some_and(|(a, b)| {
            // The curve of the opposite direction is another one, too.
            (a[0] - b[0]).hypot(a[1] - b[1]) > SAME_DIRECTION
        });
        if family != self.family || has_rotated {
            *self = Self { axis: self.axis, family, ..Self::default() };
        }
        self.direction = direction.or(self.direction);
    }

    /// Requests the exact curve up to the current load.
    pub(super) fn request_exact(&mut self, scene: &Scene, ctx: &egui::Context) {
        if self.axis.is_some_and(|axis| axis.magnitude > 0.0) && self.exact.request(scene) {
            ctx.request_repaint_after(POLL);
        }
    }

    /// Computes the exact curve, and waits for it.
    pub(super) fn wait(&mut self, scene: &Scene) {
        self.exact.wait(scene);
    }

    /// Returns the exact curve; until that of the current load is known, the last one.
    fn line(&self) -> &[Exact] {
        self.exact.latest().map_or(&[], Vec::as_slice)
    }

    /// Records the reference solution for the current load.
    pub(super) fn record_reference(&mut self, reference: Option<&Reference>) {
        let (Some(axis), Some(reference)) = (self.axis, reference.and_then(Reference::first)) else { return };
        let dot = (axis.magnitude, reference.displacement);
        self.references.retain(|other| (other.0 - dot.0).abs() > SAME_LOAD * dot.0);
        self.references.push(dot);
        if self.references.len() > MAX_DOTS {
            self.references.remove(0);
        }
    }

    /// Returns the displacement of the reference solution at a load, m, if it is known.
    fn reference_at(&self, load: f64) -> Option<Vector2<f64>> {
        self.references.iter().find(|dot| dot.0 == load).map(|dot| dot.1)
    }

    /// Returns the displacement of the reference solution under a load if it is known, else that of the exact beam.
    fn exact_at(&self, load: f64) -> Option<Vector2<f64>> {
        self.reference_at(load).or_else(|| self.exact_beam_at(load))
    }

    /// Returns the displacement of the exact beam at a load, m, interpolated on its curve; `None` if it is not known.
    fn exact_beam_at(&self, load: f64) -> Option<Vector2<f64>> {
        let piece = self.line().windows(2).find(|w| (w[0].0..=w[1].0).contains(&load))?;
        let [(from, a), (to, b)] = [piece[0], piece[1]];
        Some(a + (b - a) * ((load - from) / (to - from)))
    }

    /// Records a pane's result for the current load. Returns `true` if it is new.
    pub(super) fn record(&mut self, scene: &Scene, pane: &Pane) -> bool {
        let (Some(axis), Some((probe, good))) = (self.axis, pane.solve.answer()) else { return false };
        let dot = Dot { load: axis.magnitude, u: probe.u, good };
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
        if dots.len() > MAX_DOTS {
            dots.remove(0);
        }
        true
    }

    /// Returns every dot that is an equilibrium: setting, load, and both components of the displacement.
    pub(super) fn dots(&self) -> Vec<(PaneSetting, [f64; 3])> {
        let dots = self.series.iter().flat_map(|(setting, dots)| dots.iter().map(move |dot| (*setting, *dot)));
        dots.filter(|(_, dot)| dot.good).map(|(setting, dot)| (setting, [dot.load, dot.u.x, dot.u.y])).collect()
    }

    fn dots_of(&self, setting: PaneSetting) -> &[Dot] {
        self.series.iter().find(|(own, _)| *own == setting).map_or(&[], |(_, dots)| dots)
    }

    /// Shows the curve of the panes; a press in it sets the load.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        (panes, is_running): (&[Pane], bool),
        chosen: Option<CurvePlot>,
        actions: &mut Vec<Action>,
    ) {
        const OFFERED: [CurvePlot; 3] = [CurvePlot::Path, CurvePlot::X, CurvePlot::Y];
        let Some(axis) = self.axis else {
            ui.centered_and_justified(|ui| ui.weak(tr("The scene has no load to draw a curve for.")));
            return;
        };
        // The axis does not change during a press: the load under the pointer would otherwise run away.
        let pressed = ui.input(|i| i.pointer.any_down());
        let settled = axis.magnitude > 0.9 * self.reach || TINY * axis.magnitude < self.reach;
        if axis.magnitude > self.reach || settled && !pressed && axis.magnitude > 0.0 {
            self.reach = 1.25 * axis.magnitude;
        }
        let shown = chosen.filter(|plot| OFFERED.contains(plot)).unwrap_or_else(|| self.usual(axis));
        let drawn = self.figure(axis, scene, (panes, is_running), shown);
        let parts = Parts::of(ui.available_rect_before_wrap());
        ui.scope_builder(egui::UiBuilder::new().max_rect(parts.plot), |ui| {
            let response = figure::plot(ui, "trace", &drawn, Some(axis.magnitude));
            self.set_load(response, axis, scene, &drawn, actions);
        });
        ui.scope_builder(egui::UiBuilder::new().max_rect(parts.table), |ui| {
            figure::controls(ui, &drawn, &OFFERED, shown, actions);
            figure::table(ui, &drawn);
        });
    }

    /// Returns the default quantities of the curve, chosen once, when the first results are known.
    fn usual(&mut self, axis: TraceAxis) -> CurvePlot {
        let known: Vec<Vector2<f64>> = self.exact_at(axis.magnitude).into_iter().collect();
        let curved = |s: &&(PaneSetting, Vec<Dot>)| s.0.method != Some(MethodKind::Linear);
        let answers =
            self.series.iter().filter(curved).flat_map(|(_, dots)| dots).filter(|dot| dot.good).map(|dot| dot.u);
        let known: Vec<Vector2<f64>> = known.into_iter().chain(answers).collect();
        if self.usual.is_none() && !known.is_empty() {
            self.usual = Some(CurvePlot::component(dominant_axis(known.iter().copied())));
        }
        self.usual.unwrap_or(CurvePlot::Y)
    }

    /// Returns the figure of the panes' curves, and their results for the current load.
    fn figure(&self, axis: TraceAxis, scene: &Scene, (panes, is_running): (&[Pane], bool), shown: CurvePlot) -> Figure {
        let reach = if self.reach > 0.0 { self.reach } else { 1.0 };
        let exact = |all: &[Exact]| -> Vec<FigurePoint> {
            let seen = all.iter().filter(|(load, _)| *load <= 1.001 * reach);
            seen.map(|&(load, u)| figure::point(load, u)).collect()
        };
        let series = |name: &str, ink, mark, may_leave, points| FigureSeries {
            name: name.to_owned(),
            ink,
            mark,
            may_leave,
            points,
        };
        let (mut all, mut rows) = (Vec::new(), Vec::new());
        let references = [
            (
                series(tr("exact beam"), Ink::BeamTheory, Mark::Line, false, exact(self.line())),
                self.exact_beam_at(axis.magnitude),
            ),
            (
                series(tr("reference"), Ink::Exact, Mark::Plus, false, exact(&self.references)),
                self.reference_at(axis.magnitude),
            ),
        ];
        let answers = panes.iter().filter_map(|pane| pane.solve.answer()).filter(|(_, good)| *good);
        let known = references.iter().filter_map(|(_, u)| *u);
        let column: Vec<Vector2<f64>> = known.chain(answers.map(|(probe, _)| probe.u)).collect();
        let pair = |u| pair(u, &column);
        for (curve, u) in references.into_iter().filter(|(curve, _)| !curve.points.is_empty()) {
            let (name, value) = (curve.name.clone(), u.map(pair).unwrap_or_default());
            let FigureSeries { ink, mark, .. } = curve;
            rows.push(FigureRow { name, ink, mark, value, error: String::new(), is_bad: false });
            all.push(curve);
        }
        let stretches = all.is_empty() && panes.iter().all(|p| p.setting.of(scene).method == Some(MethodKind::Linear));
        for pane in panes {
            let setting = pane.setting.of(scene);
            let (Some(method), Some(element)) = (setting.method, setting.element) else { continue };
            let (name, ink, is_linear) = (setting.text(), Ink::Method(method), method == MethodKind::Linear);
            let dots: Vec<&Dot> = self.dots_of(setting).iter().filter(|dot| dot.load <= reach).collect();
            // Where the scene has one load, the solution of linear theory is proportional to it: one good point gives the
            // whole line.
            if let Some(dot) = dots.iter().rfind(|dot| dot.good && dot.load > 0.0)
                && is_linear
                && !has_several_loads(scene)
            {
                let ends = [0.0, reach].map(|load| figure::point(load, dot.u * (load / dot.load)));
                let name = fill!("%{setting}, scaled", setting = name);
                all.push(series(&name, ink, Mark::Line, true, ends.to_vec()));
            }
            let points = dots.iter().map(|dot| self.point(dot, axis.magnitude)).collect();
            all.push(series(&name, ink, Mark::Element(element), is_linear && !stretches, points));
            let (value, is_bad) = match (pane.solve.answer(), pane.solve.activity()) {
                (_, Activity::Refused(_)) => (tr("no solution").to_owned(), true),
                (Some((probe, true)), _) => (pair(probe.u), false),
                (Some((_, false)), _) => (tr("does not converge").to_owned(), true),
                (None, Activity::Iterates(_)) if !is_running => (tr("paused").to_owned(), false),
                (None, _) => (tr("iterating").to_owned(), false),
            };
            let error = pane.error.filter(|_| !is_bad).map(percent).unwrap_or_default();
            rows.push(FigureRow { name, ink, mark: Mark::Element(element), value, error, is_bad });
        }
        let load = engineering(three_digits(axis.magnitude), axis.limit.unit);
        let bounds = self.bounds(&all, reach, axes(shown));
        // The other loads stay.
        let name = match scene.loads.len() {
            1 => tr(axis.name).to_owned(),
            _ => fill!("%{kind}, load %{n} alone", kind = tr(axis.name), n = axis.load + 1),
        };
        let quantity = FigureQuantity::new(name, axis.limit.unit);
        Figure {
            title: format!("{}: {}", tr(&scene.name), tr("Load curve")),
            quantities: quantities(quantity, scene),
            axes: axes(shown),
            bounds,
            series: all,
            head: [format!("{} {load}", tr(axis.name)), displacement_text(scene), ERROR.to_owned()],
            error_name: fill!("error %{measure}", measure = ERROR),
            rows,
        }
    }

    /// Returns a dot of the curve; a dot that is not an equilibrium has no displacement.
    fn point(&self, dot: &Dot, present: f64) -> FigurePoint {
        let u = dot.good.then_some(dot.u);
        let exact = self.exact_at(dot.load);
        FigurePoint {
            values: vec![Some(dot.load), u.map(|u| u.x), u.map(|u| u.y)],
            error_percent: u.zip(exact).and_then(|(u, exact)| error_percent(u, exact)),
            state: tr(if dot.good { "converged" } else { "does not converge" }).to_owned(),
            is_present: dot.load == present,
        }
    }

    /// Returns the corners of the plot: its loads range up to `reach`, whatever the results.
    fn bounds(&self, series: &[FigureSeries], reach: f64, axes: [usize; 2]) -> Option<[[f64; 2]; 2]> {
        if axes[0] != 0 {
            return None;
        }
        let free = Figure { axes, series: series.to_vec(), ..Figure::default() };
        let [low, high] = free.corners();
        Some([[0.0, low[1]], [reach, high[1]]])
    }

    /// Sets the load to the pressed position of the plot; in the path plot, to that of the nearest point.
    fn set_load(
        &self,
        response: PlotResponse<()>,
        axis: TraceAxis,
        scene: &Scene,
        drawn: &Figure,
        actions: &mut Vec<Action>,
    ) {
        /// Distance within which a dot is hit, points.
        const NEAR: f32 = 5.0;
        let transform = response.transform;
        let area = response.response;
        let cursor = if drawn.axes[0] == 0 { egui::CursorIcon::ResizeHorizontal } else { egui::CursorIcon::Crosshair };
        let area = area.on_hover_cursor(cursor);
        area.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, tr("Load curve")));
        let pressed = area.is_pointer_button_down_on() || area.clicked();
        let (Some(at), Some(direction)) = (area.interact_pointer_pos().filter(|_| pressed), self.direction) else {
            return;
        };
        let reach = if self.reach > 0.0 { self.reach } else { 1.0 };
        let dots = || drawn.series.iter().filter(|s| !s.mark.is_line()).flat_map(|s| &s.points);
        let wanted = if drawn.axes[0] == 0 {
            let load = |x: f32| transform.value_from_position(pos2(x, at.y)).x;
            let near = load(at.x - NEAR)..=load(at.x + NEAR);
            let loads = dots().filter_map(|dot| dot.values.first().copied().flatten()).filter(|l| near.contains(l));
            let off = |l: f64| (l - load(at.x)).abs();
            let dot = loads.min_by(|a, b| off(*a).total_cmp(&off(*b)));
            Some(dot.unwrap_or_else(|| three_digits(load(at.x))))
        } else {
            let distance = |p: &FigurePoint| {
                let [x, y] = drawn.place(p)?;
                let place: Pos2 = transform.position_from_point(&egui_plot::PlotPoint::new(x, y));
                Some((place.distance(at), p.values.first().copied().flatten()?))
            };
            let nearest = |points: &mut dyn Iterator<Item = &FigurePoint>| {
                points.filter_map(distance).min_by(|a, b| a.0.total_cmp(&b.0))
            };
            let dot = nearest(&mut dots()).filter(|dot| dot.0 <= NEAR);
            let whole = || nearest(&mut drawn.series.iter().flat_map(|s| &s.points));
            dot.or_else(whole).map(|(_, load)| load)
        };
        let Some(wanted) = wanted.map(|load| load.clamp(0.0, axis.limit.max.min(reach))) else { return };
        if wanted != axis.magnitude {
            let mut scene = Box::new(scene.clone());
            axis.set(&mut scene, direction, wanted);
            actions.push(Action::Edit(axis.label, scene));
        }
    }
}

/// Symbol of the relative error of the displacement.
const ERROR: &str = "|Δu|/|u|";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Source, open};

    /// The exact curve of a beam that is pushed along its axis ends where the beam buckles, below the load.
    #[test]
    fn an_exact_curve_that_ends_below_the_load_is_not_computed_again() {
        let pushed = |force: f64| {
            let assignments = vec![format!("load.0.force=[{force},0]")];
            open(&Source { name: "article".into(), assignments }).unwrap()
        };
        let scene = pushed(-30_000.0);
        let mut trace = Trace::default();
        trace.set_scene(&scene);
        trace.wait(&scene);
        let end = trace.line().last().map(|point| point.0);
        assert!(end.is_some_and(|end| end < 30_000.0), "{end:?}");
        assert!(!trace.exact.request(&scene));
        // Loads up to the next power of four share the curve.
        assert!(!trace.exact.request(&pushed(-20_000.0)) && trace.exact.request(&pushed(-100_000.0)));
    }
}
