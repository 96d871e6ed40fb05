//! The load–deflection plot. Of a cantilever: linear theory, the exact beam, every method's point, and where linear theory
//! leaves. Of any other scene: its load path, what is unstable dashed.

use egui::{Align2, Ui};
use egui_plot::{
    Corner, GridInput, GridMark, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points, VLine,
};

use super::language::{fill, tr, translated};
use super::overlay::boxed_text;
use super::palette::Palette;
use crate::scene::{MethodKind, Scene};
use crate::simulation::Status;
use crate::study::path_chart::{Ordinate, Piece, drawn};
use crate::study::{LoadCurve, LoadPath};
use crate::words::{engineering, three_digits, ticks};

/// What is known of a scene's load and deflection.
#[derive(Debug)]
pub(super) enum Curve {
    /// Of a cantilever.
    Beam(LoadCurve),
    /// Of any scene at rest; of the scene with it.
    Path(Box<(LoadPath, Scene)>),
}

impl Curve {
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let path = || Some(Self::Path(Box::new((LoadPath::of(scene)?, scene.clone()))));
        LoadCurve::new(scene).map(Self::Beam).or_else(path)
    }
}

/// A plot that stands still, with round ticks and values in engineering units.
pub(super) fn still<'a>(palette: &Palette, id: &str, x: (&str, &'static str), y: (&str, &'static str)) -> Plot<'a> {
    /// A value between ticks, to three digits.
    fn value(value: f64, unit: &str) -> String {
        engineering(three_digits(value), unit)
    }
    let ((x_name, x_unit), (y_name, y_unit)) = (x, y);
    Plot::new(id.to_owned())
        .x_axis_label(x_name.to_owned())
        .y_axis_label(y_name.to_owned())
        .x_grid_spacer(|input| round_marks(input, APART[0]))
        .y_grid_spacer(|input| round_marks(input, APART[1]))
        .x_axis_formatter(move |mark, range| {
            // In the corner stands the number of the other axis.
            let in_corner = mark.value - range.start() < CORNER * (range.end() - range.start());
            if in_corner { String::new() } else { engineering(mark.value, x_unit) }
        })
        .y_axis_formatter(move |mark, _| engineering(mark.value, y_unit))
        .label_formatter(move |at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{}, {}", value(position.x, x_unit), value(position.y, y_unit)))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .grid_color(palette.line)
        .grid_spacing(egui::Rangef::new(NEAREST, APART[1]))
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
}

/// Grid lines nearer to each other than this, points, are not drawn.
const NEAREST: f32 = 8.0;
/// Numbers so far apart, points, have room: beside each other, and over each other.
const APART: [f32; 2] = [40.0, 26.0];

/// The part of an axis, from its beginning, over which its numbers would touch those of the other axis.
const CORNER: f64 = 0.02;

/// Marks 1, 2 or 5 · 10ⁿ apart, as many as have room for their numbers.
fn round_marks(input: GridInput, apart: f32) -> Vec<GridMark> {
    const MOST: f64 = 9.0;
    let (low, high) = input.bounds;
    let room = (high - low) / input.base_step_size * f64::from(NEAREST / apart);
    let ticks = ticks(low, high, room.clamp(2.0, MOST) as u32);
    let step_size = ticks.windows(2).next().map_or(high - low, |pair| pair[1] - pair[0]);
    ticks.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// Shows the plot, that of the scene before while a new one is looked for; or says why there is none: not yet, or not at
/// all.
pub(super) fn show(ui: &mut Ui, curve: Option<&Curve>, looked_for: bool) {
    let at = ui.available_rect_before_wrap().center_top() + egui::vec2(0.0, 10.0);
    match curve {
        Some(Curve::Beam(curve)) => beam(ui, curve),
        Some(Curve::Path(of)) => path(ui, &of.0, &of.1),
        None => {
            ui.centered_and_justified(|ui| {
                ui.weak(tr(if looked_for {
                    "No load curve: linear theory knows one straight line only."
                } else {
                    "The load curve comes when the body has come to rest."
                }));
            });
        }
    }
    if curve.is_some() && !looked_for {
        let words = "As it was before the last change; the new one comes when the body has come to rest.";
        boxed_text(
            ui.painter(),
            at,
            Align2::CENTER_TOP,
            tr(words),
            ui.visuals(),
            ui.visuals().weak_text_color(),
            520.0,
        );
    }
}

fn path(ui: &mut Ui, path: &LoadPath, scene: &Scene) {
    let palette = Palette::new(ui.visuals());
    let drawn = drawn(path, scene, &Ordinate::Usual);
    let [stable, unstable] = [MethodKind::Newton, MethodKind::Warped].map(|method| palette.method(method));
    // Where the curve is not: a load's begins low, that of a support that moves falls again.
    let corner = if path.driven.is_some() { Corner::RightTop } else { Corner::LeftTop };
    still(&palette, "load path", (&translated(&drawn.x_label), ""), (&translated(&drawn.y_label), ""))
        .legend(Legend::default().position(corner).follow_insertion_order(true))
        .show(ui, |plot| {
            for (points, piece) in drawn.pieces(path) {
                let (name, color, style) = match piece {
                    Piece::Stable => ("stable", stable, LineStyle::Solid),
                    Piece::Unstable => ("unstable under force control", unstable, LineStyle::dashed_loose()),
                    Piece::Jump => ("it jumps", unstable, LineStyle::dotted_dense()),
                };
                plot.line(Line::new(tr(name), PlotPoints::from(points)).color(color).width(2.0).style(style));
            }
            let at: Vec<[f64; 2]> = drawn.points.last().map(|p| p.0).into_iter().collect();
            plot.points(Points::new(tr("the scene"), at).color(palette.text).radius(4.0));
        });
}

fn beam(ui: &mut Ui, curve: &LoadCurve) {
    let palette = Palette::new(ui.visuals());
    let linear = palette.method(MethodKind::Linear);
    let samples = |value: fn(&crate::study::Sample) -> f64| -> Vec<[f64; 2]> {
        curve.samples.iter().map(|s| [100.0 * s.factor, value(s)]).collect()
    };
    still(&palette, "load curve", (tr("load, of the scene's"), "%"), (tr("tip displacement"), "m"))
        .legend(Legend::default().position(Corner::RightBottom).follow_insertion_order(true))
        .show(ui, |plot| {
            let exact = samples(|s| s.truth.norm());
            let top = exact.iter().map(|p| p[1]).fold(0.0, f64::max);
            // Linear theory leaves the picture instead of stretching it.
            let straight: Vec<[f64; 2]> = samples(|s| s.linear.norm())
                .into_iter()
                .take_while(|p| p[1] <= 1.35 * top.max(f64::MIN_POSITIVE))
                .collect();
            plot.line(Line::new(tr("linear theory"), PlotPoints::from(straight)).color(linear).width(1.5));
            plot.line(Line::new(tr("exact beam"), PlotPoints::from(exact)).color(palette.exact).width(2.0));
            for departure in &curve.departures {
                let name = fill!(
                    "linear off by %{percent} %: %{angle}",
                    percent = departure.percent,
                    angle = format!("{:.1}°", departure.at.rotation.to_degrees().abs())
                );
                plot.vline(
                    VLine::new(name, 100.0 * departure.at.factor)
                        .color(linear.gamma_multiply(0.7))
                        .style(LineStyle::dashed_dense()),
                );
            }
            for point in &curve.methods {
                let off = point.tip.norm() > 1.35 * top;
                let word = match point.status {
                    Status::Converged if off => tr(", off the picture"),
                    Status::Converged => "",
                    _ => tr(", not converged"),
                };
                let at = if off { Vec::new() } else { vec![[100.0, point.tip.norm()]] };
                let shape = if point.status == Status::Converged { MarkerShape::Circle } else { MarkerShape::Cross };
                let points = Points::new(format!("{}{word}", tr(point.method.id())), at);
                plot.points(points.color(palette.method(point.method)).radius(5.0).shape(shape));
            }
        });
}
