//! The load–deflection plot: linear theory, the exact beam, every method's point, and where linear theory leaves.

use egui::Ui;
use egui_plot::{
    Corner, GridInput, GridMark, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points, VLine,
};

use super::palette::Palette;
use crate::scene::MethodKind;
use crate::simulation::Status;
use crate::study::LoadCurve;
use crate::words::{engineering, ticks};

/// A plot that stands still, with round ticks and values in engineering units.
pub(super) fn still<'a>(palette: &Palette, id: &str, x: (&str, &'static str), y: (&str, &'static str)) -> Plot<'a> {
    /// Grid lines so far apart, points, are drawn in full, and so are their numbers.
    const CLEAR: f32 = 40.0;
    /// A value between ticks, to three digits.
    fn value(value: f64, unit: &str) -> String {
        engineering(format!("{value:.2e}").parse().unwrap_or(value), unit)
    }
    let ((x_name, x_unit), (y_name, y_unit)) = (x, y);
    Plot::new(id.to_owned())
        .x_axis_label(x_name.to_owned())
        .y_axis_label(y_name.to_owned())
        .x_grid_spacer(round_marks)
        .y_grid_spacer(round_marks)
        .x_axis_formatter(move |mark, _| engineering(mark.value, x_unit))
        .y_axis_formatter(move |mark, _| engineering(mark.value, y_unit))
        .label_formatter(move |at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{}, {}", value(position.x, x_unit), value(position.y, y_unit)))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .grid_color(palette.line)
        .grid_spacing(egui::Rangef::new(8.0, CLEAR))
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
}

/// Marks 1, 2 or 5 · 10ⁿ apart.
fn round_marks(input: GridInput) -> Vec<GridMark> {
    const MOST: u32 = 9;
    let (low, high) = input.bounds;
    let ticks = ticks(low, high, MOST);
    let step_size = ticks.windows(2).next().map_or(high - low, |pair| pair[1] - pair[0]);
    ticks.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// Shows the plot, or says why there is none: not yet, or not at all.
pub(super) fn show(ui: &mut Ui, curve: Option<&LoadCurve>, looked_for: bool) {
    let Some(curve) = curve else {
        ui.centered_and_justified(|ui| {
            ui.weak(if looked_for {
                "No load curve: it needs a beam clamped left, loaded on its right edge or by its weight."
            } else {
                "Looking for the load curve."
            });
        });
        return;
    };
    let palette = Palette::new(ui.visuals());
    let linear = palette.method(MethodKind::Linear);
    let samples = |value: fn(&crate::study::Sample) -> f64| -> Vec<[f64; 2]> {
        curve.samples.iter().map(|s| [100.0 * s.factor, value(s)]).collect()
    };
    still(&palette, "load curve", ("load, of the scene's", "%"), ("tip displacement", "m"))
        .legend(Legend::default().position(Corner::RightBottom).follow_insertion_order(true))
        .show(ui, |plot| {
            let exact = samples(|s| s.truth.norm());
            let top = exact.iter().map(|p| p[1]).fold(0.0, f64::max);
            // Linear theory leaves the picture instead of stretching it.
            let straight: Vec<[f64; 2]> = samples(|s| s.linear.norm())
                .into_iter()
                .take_while(|p| p[1] <= 1.35 * top.max(f64::MIN_POSITIVE))
                .collect();
            plot.line(Line::new("linear theory", PlotPoints::from(straight)).color(linear).width(1.5));
            plot.line(Line::new("exact beam", PlotPoints::from(exact)).color(palette.exact).width(2.0));
            for departure in &curve.departures {
                let name =
                    format!("linear off by {} %: {:.1}°", departure.percent, departure.at.rotation.to_degrees().abs());
                plot.vline(
                    VLine::new(name, 100.0 * departure.at.factor)
                        .color(linear.gamma_multiply(0.7))
                        .style(LineStyle::dashed_dense()),
                );
            }
            for point in &curve.methods {
                let off = point.tip.norm() > 1.35 * top;
                let word = match point.status {
                    Status::Converged if off => ", off the picture",
                    Status::Converged => "",
                    _ => ", not converged",
                };
                let at = if off { Vec::new() } else { vec![[100.0, point.tip.norm()]] };
                let shape = if point.status == Status::Converged { MarkerShape::Circle } else { MarkerShape::Cross };
                let points = Points::new(format!("{}{word}", point.method.id()), at);
                plot.points(points.color(palette.method(point.method)).radius(5.0).shape(shape));
            }
        });
}
