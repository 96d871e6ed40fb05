//! The load–deflection plot: linear theory, the exact beam, every method's point, and where linear theory leaves.

use egui::{Color32, Ui};
use egui_plot::{Corner, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points, VLine};

use crate::scene::MethodKind;
use crate::simulation::Status;
use crate::study::LoadCurve;

/// The colour of a method.
pub(super) fn method_color(method: MethodKind, dark: bool) -> Color32 {
    let [r, g, b] = method.entry().color(dark);
    Color32::from_rgb(r, g, b)
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
    let text = ui.visuals().text_color();
    let dark = ui.visuals().dark_mode;
    let linear = method_color(MethodKind::Linear, dark);
    let samples = |value: fn(&crate::study::Sample) -> f64| -> Vec<[f64; 2]> {
        curve.samples.iter().map(|s| [100.0 * s.factor, value(s)]).collect()
    };
    Plot::new("load curve")
        .legend(Legend::default().position(Corner::RightBottom).follow_insertion_order(true))
        .x_axis_label("load, % of the scene's")
        .y_axis_label("tip displacement, m")
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show(ui, |plot| {
            let exact = samples(|s| s.truth.norm());
            let top = exact.iter().map(|p| p[1]).fold(0.0, f64::max);
            // Linear theory leaves the picture instead of stretching it.
            let straight: Vec<[f64; 2]> = samples(|s| s.linear.norm())
                .into_iter()
                .take_while(|p| p[1] <= 1.35 * top.max(f64::MIN_POSITIVE))
                .collect();
            plot.line(Line::new("linear theory", PlotPoints::from(straight)).color(linear).width(1.5));
            plot.line(Line::new("exact beam", PlotPoints::from(exact)).color(text).width(2.0));
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
                plot.points(points.color(method_color(point.method, dark)).radius(5.0).shape(shape));
            }
        });
}
