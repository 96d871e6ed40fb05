//! The trade: error against time of everything measured on this machine, and the dial that picks from it.

use std::time::Duration;

use egui::{Button, Color32, Context, FontId, ProgressBar, RichText, ScrollArea, Ui};
use egui_plot::{GridInput, GridMark, HLine, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points, VLine};

use super::background::{Background, News};
use super::field::{Messages, NumberField};
use super::format;
use super::plot::method_colors;
use crate::method::METHODS;
use crate::scene::{ElementKind, Scene, SolverSettings, limits};
use crate::study::plot::drawn_error;
use crate::study::{Demand, Measurement, Setting, Study};

/// The study of the lab's scene.
#[derive(Debug, Default)]
pub(super) struct Trade {
    background: Option<Background>,
    study: Option<Study>,
    /// What was measured, but for what is varied.
    of: Option<Scene>,
    error: Option<String>,
    messages: Messages,
}

/// How often a study that runs is listened to.
const LISTEN: Duration = Duration::from_millis(100);

/// A scene without what a study varies.
fn question(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.set_element(ElementKind::default());
    if let Some(beam) = &mut scene.beam {
        beam.cells = [1, 1];
    }
    scene.solver = SolverSettings { tolerance: scene.solver.tolerance, ..SolverSettings::default() };
    scene
}

impl Trade {
    /// Starts to measure a scene; what was measured before goes.
    pub(super) fn measure(&mut self, scene: &Scene) {
        *self = Self { of: Some(question(scene)), ..Self::default() };
        match Background::start(scene.clone()) {
            Ok(background) => self.background = Some(background),
            Err(error) => self.error = Some(error),
        }
    }

    /// Calls the study off; what has been measured stays.
    pub(super) fn cancel(&mut self) {
        self.background = None;
    }

    /// Whether a study runs.
    pub(super) fn runs(&self) -> bool {
        self.background.is_some()
    }

    /// What has been measured.
    pub(super) fn study(&self) -> Option<&Study> {
        self.study.as_ref()
    }

    /// Takes a study made elsewhere.
    pub(super) fn set(&mut self, scene: &Scene, study: Study) {
        *self = Self { of: Some(question(scene)), study: Some(study), ..Self::default() };
    }

    /// Hears how far the study is.
    pub(super) fn listen(&mut self, ctx: &Context) {
        let Some(background) = &mut self.background else { return };
        match background.listen(&mut self.study) {
            News::Running => ctx.request_repaint_after(LISTEN),
            News::Ended(result) => {
                self.error = result.err();
                self.background = None;
            }
        }
    }

    /// Shows dial and plot for the lab's scene, which makes so many iterations a frame.
    pub(super) fn show(&mut self, ui: &mut Ui, scene: &Scene, iterations: u32) -> Option<Asked> {
        let shown = Shown {
            scene,
            study: self.study.as_ref(),
            meeting: self.study.as_ref().map(|s| s.meeting(Demand::from(&scene.solver))).unwrap_or_default(),
            current: self.of.as_ref() == Some(&question(scene)),
            progress: self.background.as_ref().map(|b| (b.share, b.now.as_str())),
            error: self.error.as_deref(),
            iterations,
        };
        let mut asked = None;
        let messages = &mut self.messages;
        ui.add_space(4.0);
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(DIAL_WIDTH);
                dial(ui, &shown, messages, &mut asked);
            });
            ui.vertical(|ui| {
                legend(ui);
                plot(ui, &shown);
            });
        });
        asked
    }
}

/// What dial and plot are shown.
struct Shown<'a> {
    scene: &'a Scene,
    study: Option<&'a Study>,
    /// What of it meets the scene's demand, fastest first.
    meeting: Vec<&'a Measurement>,
    /// Whether the study is of the body and loads that the lab shows.
    current: bool,
    /// Share that is done and what is measured now, while a study runs.
    progress: Option<(f32, &'a str)>,
    /// Why there is no study.
    error: Option<&'a str>,
    /// Iterations the lab makes a frame.
    iterations: u32,
}

/// What a click or a drag asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Asked {
    /// Measure, or stop measuring.
    Measure(bool),
    /// Another demand.
    Demand(Demand),
    /// This setting.
    Apply(Setting),
}

const DIAL_WIDTH: f32 = 384.0;

fn dial(ui: &mut Ui, shown: &Shown<'_>, messages: &mut Messages, asked: &mut Option<Asked>) {
    ui.horizontal(|ui| {
        if let Some((share, now)) = shown.progress {
            if ui.button("Cancel").on_hover_text("Stop measuring; what has been measured stays").clicked() {
                *asked = Some(Asked::Measure(false));
            }
            ui.add(ProgressBar::new(share).desired_width(120.0).show_percentage());
            ui.add(egui::Label::new(RichText::new(now).small()).truncate());
        } else {
            let tip = "Measure error and time of every element, mesh, method and number of iterations, on this machine";
            if ui.button("Measure").on_hover_text(tip).clicked() {
                *asked = Some(Asked::Measure(true));
            }
            let words = match (shown.error, shown.study) {
                (Some(error), _) => RichText::new(error).small().color(ui.visuals().error_fg_color),
                (None, None) => RichText::new("Nothing measured yet: it takes some seconds.").small(),
                (None, Some(_)) if !shown.current => {
                    let color = ui.visuals().warn_fg_color;
                    RichText::new("The body or its load has changed since.").small().color(color)
                }
                (None, Some(study)) => RichText::new(format!("Error against {}.", study.reference)).small(),
            };
            ui.add(egui::Label::new(words).truncate());
        }
    });
    let demand = Demand::from(&shown.scene.solver);
    let time = NumberField {
        label: "Time ≤",
        tooltip: "At most so many milliseconds a frame. A frame at 60 Hz has 16.",
        limit: limits::BUDGET_MS,
        slider: 1e-3..=1e3,
        logarithmic: Some(1e-3),
        whole: false,
    };
    let error = NumberField {
        label: "Error ≤",
        tooltip: "At most so many percent of the true displacement.",
        limit: limits::MAX_ERROR_PERCENT,
        slider: 1e-3..=100.0,
        logarithmic: Some(1e-3),
        whole: false,
    };
    if let Some(budget_ms) = time.show(ui, messages, demand.budget_ms) {
        *asked = Some(Asked::Demand(Demand { budget_ms, ..demand }));
    }
    if let Some(max_error_percent) = error.show(ui, messages, demand.max_error_percent) {
        *asked = Some(Asked::Demand(Demand { max_error_percent, ..demand }));
    }
    let meeting = &shown.meeting;
    ui.horizontal(|ui| {
        let best = meeting.first();
        let apply = ui.add_enabled(best.is_some(), Button::new("Apply the fastest"));
        let apply = apply
            .on_hover_text("Use the fastest setting that meets both")
            .on_disabled_hover_text("No setting that has been measured meets both limits");
        if let (true, Some(best)) = (apply.clicked(), best) {
            *asked = Some(Asked::Apply(best.setting));
        }
        let measured = shown.study.map_or(0, |s| s.measurements.len());
        ui.label(format!("{} of {measured} settings meet both", meeting.len()));
    });
    list(ui, shown, asked);
}

/// The settings that meet the demand, fastest first; a click applies one.
fn list(ui: &mut Ui, shown: &Shown<'_>, asked: &mut Option<Asked>) {
    let meeting = &shown.meeting;
    let applied = Setting::of(shown.scene, shown.iterations);
    let row_height = ui.spacing().interact_size.y;
    ScrollArea::vertical().auto_shrink([false, false]).show_rows(ui, row_height, meeting.len(), |ui, rows| {
        for m in meeting.get(rows).unwrap_or_default() {
            let words = format!(
                "{:>7} ms {:>7} % {}",
                format::short(m.milliseconds()),
                format::short(m.error.bound()),
                m.setting
            );
            let label = ui.add(
                Button::selectable(m.setting == applied, RichText::new(words).font(FontId::monospace(11.0))).truncate(),
            );
            let e = &m.error;
            let parts = format!(
                "Click to apply. {} unknowns. Error: mesh {} %, stopped early {} %, linear theory {} %.",
                m.dofs,
                format::short(e.discretization),
                format::short(e.iteration),
                format::short(e.model)
            );
            if label.on_hover_text(parts).clicked() {
                *asked = Some(Asked::Apply(m.setting));
            }
        }
    });
}

/// A mark at every decade.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    (low.ceil() as i64..=high.floor() as i64).map(|e| GridMark { value: e as f64, step_size: 1.0 }).collect()
}

fn decade_words(mark: GridMark) -> String {
    limits::number(10f64.powf(mark.value.round()))
}

/// Where a measurement is in the plot: both logarithms.
fn place(m: &Measurement) -> [f64; 2] {
    [m.milliseconds().max(f64::MIN_POSITIVE).log10(), drawn_error(m).log10()]
}

/// What colours and shapes mean, in one line: the plot has no room for a list.
fn legend(ui: &mut Ui) {
    let colors = method_colors(ui.visuals().dark_mode);
    ui.horizontal(|ui| {
        ui.add_space(56.0);
        ui.spacing_mut().item_spacing.x = 10.0;
        for (method, color) in METHODS.iter().zip(colors) {
            ui.label(RichText::new(method.kind.id()).small().strong().color(color));
        }
        ui.label(RichText::new("triangles t3, circles t6; nothing beats the line").small());
    });
}

fn plot(ui: &mut Ui, shown: &Shown<'_>) {
    let demand = Demand::from(&shown.scene.solver);
    let (dark, text) = (ui.visuals().dark_mode, ui.visuals().text_color());
    let colors = method_colors(dark);
    let measured: &[Measurement] = shown.study.map_or(&[], |s| &s.measurements);
    let nearest = |x: f64, y: f64| {
        let distance = |m: &Measurement| (place(m)[0] - x).hypot(place(m)[1] - y);
        measured.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    Plot::new("trade")
        .x_axis_label("time of a frame, ms")
        .y_axis_label("error, %")
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(|mark, _| decade_words(mark))
        .y_axis_formatter(|mark, _| decade_words(mark))
        .label_formatter(|at| match at {
            egui_plot::HoverPosition::NearDataPoint { position, .. } => nearest(position.x, position.y).map(|m| {
                format!("{}\n{} ms, {} %", m.setting, format::short(m.milliseconds()), format::short(m.error.bound()))
            }),
            egui_plot::HoverPosition::Elsewhere { .. } => None,
        })
        .include_x(-2.5)
        .include_x(2.5)
        .include_y(-3.0)
        .include_y(2.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show(ui, |plot| {
            for element in ElementKind::ALL {
                let shape = if element.degree() == 1 { MarkerShape::Up } else { MarkerShape::Circle };
                for (method, color) in METHODS.iter().map(|m| m.kind).zip(colors) {
                    let own = measured.iter().filter(|m| (m.setting.element, m.setting.method) == (element, method));
                    let points: Vec<[f64; 2]> = own.map(place).collect();
                    let name = format!("{} {}", element.id(), method.id());
                    plot.points(Points::new(name, points).color(color).shape(shape).radius(3.5));
                }
            }
            let front: Vec<[f64; 2]> = shown.study.iter().flat_map(|s| s.front()).map(place).collect();
            plot.line(Line::new("Pareto front", PlotPoints::from(front)).color(text).width(1.5));
            let limit = Color32::from_gray(128);
            let style = LineStyle::dashed_dense();
            plot.vline(VLine::new("at most", demand.budget_ms.log10()).color(limit).style(style));
            plot.hline(HLine::new("at most", demand.max_error_percent.log10()).color(limit).style(style));
            if let Some(best) = shown.meeting.first() {
                let ring = Points::new("fastest", vec![place(best)]).color(text).filled(false).radius(8.0);
                plot.points(ring);
            }
        });
}
