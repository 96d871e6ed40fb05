//! The load–deflection plot. Of a cantilever: linear theory, the exact beam, every method's point, and where linear theory
//! leaves. Of any other scene: its load path, what is unstable dashed.

use egui::{Align2, Color32, RichText, Ui};
use egui_plot::{
    Corner, GridInput, GridMark, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints,
    Points, Text, VLine,
};

use super::language::{fill, tr, translated};
use super::overlay::boxed_text;
use super::palette::{Palette, SMALL};
use crate::scene::{MethodKind, Scene};
use crate::simulation::Status;
use crate::study::path_chart::{Ordinate, Piece, drawn, unstable_words};
use crate::study::{Departure, LoadCurve, LoadPath, MethodPoint};
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
                    Piece::Unstable => (unstable_words(path), unstable, LineStyle::dashed_loose()),
                    Piece::Jump => ("it jumps", unstable, LineStyle::dotted_dense()),
                };
                plot.line(Line::new(tr(name), PlotPoints::from(points)).color(color).width(2.0).style(style));
            }
            for (at, words) in drawn.bifurcations(path) {
                plot.points(Points::new(translated(&words), vec![at]).color(unstable).radius(5.0));
            }
            let at: Vec<[f64; 2]> = drawn.points.last().map(|p| p.0).into_iter().collect();
            plot.points(Points::new(tr("the scene"), at).color(palette.text).radius(4.0));
        });
}

/// What is drawn says beside it what it is: a legend would lie over the points.
fn beam(ui: &mut Ui, curve: &LoadCurve) {
    /// Linear theory leaves the picture above so many times the largest true deflection, instead of stretching it.
    const LEAVES: f64 = 1.35;
    let palette = Palette::new(ui.visuals());
    let linear = palette.method(MethodKind::Linear);
    let samples = |value: fn(&crate::study::Sample) -> f64| -> Vec<[f64; 2]> {
        curve.samples.iter().map(|s| [100.0 * s.factor, value(s)]).collect()
    };
    let exact = samples(|s| s.truth.norm());
    let top = exact.iter().map(|p| p[1]).fold(f64::MIN_POSITIVE, f64::max);
    let straight: Vec<[f64; 2]> =
        samples(|s| s.linear.norm()).into_iter().take_while(|p| p[1] <= LEAVES * top).collect();
    let plot = still(&palette, "load curve", (tr("load, of the scene's"), "%"), (tr("tip displacement"), "m"));
    plot.show(ui, |plot| {
        let lines = [
            ("linear theory", straight, linear, 1.5, Align2::LEFT_TOP),
            ("exact beam", exact, palette.exact, 2.0, Align2::RIGHT_BOTTOM),
        ];
        for (name, line, color, width, anchor) in lines {
            if let Some(&end) = line.last() {
                plot.text(label(end, tr(name), color, anchor));
            }
            plot.line(Line::new(tr(name), PlotPoints::from(line)).color(color).width(width));
        }
        for departure in &curve.departures {
            let at = VLine::new(departure_words(std::slice::from_ref(departure)), 100.0 * departure.at.factor);
            plot.vline(at.color(linear.gamma_multiply(0.7)).style(LineStyle::dashed_dense()));
        }
        if let Some(last) = curve.departures.last() {
            let beside = [100.0 * last.at.factor, 0.0];
            plot.text(label(beside, &departure_words(&curve.departures), linear, Align2::LEFT_BOTTOM));
        }
        for point in &curve.methods {
            let at = [100.0, point.tip.norm()];
            if at[1] <= LEAVES * top {
                let shape = if point.status == Status::Converged { MarkerShape::Circle } else { MarkerShape::Cross };
                let points = Points::new(tr(point.method.id()), vec![at]);
                plot.points(points.color(palette.method(point.method)).radius(5.0).shape(shape));
            }
        }
        for (height, words) in method_labels(&curve.methods, top, LEAVES * top) {
            plot.text(label([100.0, height], &words, palette.text, Align2::LEFT_TOP));
        }
    });
}

/// Words beside a place in a plot.
fn label(at: [f64; 2], words: &str, color: Color32, anchor: Align2) -> Text {
    let lines: Vec<String> = words.lines().map(|line| format!("  {line}  ")).collect();
    let words = RichText::new(lines.join("\n")).size(SMALL).color(color);
    Text::new("", PlotPoint::from(at), words).anchor(anchor).allow_hover(false)
}

/// Where linear theory leaves the truth, by how much and after which rotation.
fn departure_words(departures: &[Departure]) -> String {
    let each = |value: &dyn Fn(&Departure) -> String| departures.iter().map(value).collect::<Vec<_>>().join(", ");
    let percent = each(&|departure| departure.percent.to_string());
    let angles = each(&|departure| format!("{:.1}°", departure.at.rotation.to_degrees().abs()));
    fill!("linear off by %{percent} %: at %{angles}", percent = percent, angles = angles)
}

/// What stands beside the points of the methods, and how high: one text for those that are as good as one. Those that are
/// higher than `highest` are named there.
fn method_labels(methods: &[MethodPoint], top: f64, highest: f64) -> Vec<(f64, String)> {
    /// Points nearer to each other than this part of the picture share a text.
    const NEAR: f64 = 0.08;
    let mut named: Vec<(f64, String)> = methods
        .iter()
        .map(|point| {
            let height = point.tip.norm();
            let word = match point.status {
                Status::Converged if height > highest => tr(", off the picture"),
                Status::Converged => "",
                _ => tr(", not converged"),
            };
            (height.min(highest), format!("{}{word}", tr(point.method.id())))
        })
        .collect();
    named.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = named.chunk_by(|a, b| b.0 - a.0 < NEAR * top);
    let texts = groups.map(|group| {
        let words: Vec<&str> = group.iter().map(|(_, words)| words.as_str()).collect();
        // What is more than a name has a line of its own.
        let separator = if group.iter().any(|(height, _)| *height == highest) { "\n" } else { ", " };
        (group[group.len() / 2].0, words.join(separator))
    });
    texts.collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn points_that_lie_together_share_a_text() {
        let point = |method, deflection: f64| MethodPoint {
            method,
            tip: Vector2::new(0.0, -deflection),
            status: Status::Converged,
            stable: None,
        };
        let methods = [
            point(MethodKind::Linear, 90.0),
            point(MethodKind::Warped, 2.0),
            point(MethodKind::Newton, 2.01),
            point(MethodKind::Auto, 1.0),
            MethodPoint { status: Status::Running, ..point(MethodKind::Warped, 500.0) },
        ];
        let texts: Vec<String> = method_labels(&methods, 3.0, 4.0).into_iter().map(|(_, words)| words).collect();
        assert_eq!(texts, ["auto", "warped, newton", "linear, off the picture\nwarped, not converged"]);
    }
}
