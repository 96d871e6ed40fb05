//! The load–deflection plot: linear theory, the exact beam, every method's point, and where linear theory leaves.

use egui::{Color32, Ui};
use egui_plot::{Corner, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points, VLine};

use crate::simulation::Status;
use crate::study::LoadCurve;

/// A colour for every method of the registry, told apart by brightness too.
pub(super) fn method_colors(dark: bool) -> [Color32; 4] {
    let of = |[r, g, b]: [u8; 3]| Color32::from_rgb(r, g, b);
    if dark {
        [[240, 150, 60], [255, 105, 97], [90, 200, 250], [110, 220, 140]].map(of)
    } else {
        [[200, 90, 0], [190, 20, 30], [0, 100, 180], [0, 120, 80]].map(of)
    }
}

/// Shows the plot, or says why there is none.
pub(super) fn show(ui: &mut Ui, curve: Option<&LoadCurve>) {
    let Some(curve) = curve else {
        ui.centered_and_justified(|ui| {
            ui.weak("No load curve: it needs a beam clamped left, loaded on its right edge or by its weight.");
        });
        return;
    };
    let text = ui.visuals().text_color();
    let methods = method_colors(ui.visuals().dark_mode);
    let [linear, ..] = methods;
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
            for limit in &curve.limits {
                let name = format!("linear off by {} %: {:.1}°", limit.percent, limit.at.rotation.to_degrees().abs());
                plot.vline(
                    VLine::new(name, 100.0 * limit.at.factor)
                        .color(linear.gamma_multiply(0.7))
                        .style(LineStyle::dashed_dense()),
                );
            }
            for (point, color) in curve.methods.iter().zip(methods) {
                let off = point.tip.norm() > 1.35 * top;
                let word = match point.status {
                    Status::Converged if off => ", off the picture",
                    Status::Converged => "",
                    _ => ", not converged",
                };
                let at = if off { Vec::new() } else { vec![[100.0, point.tip.norm()]] };
                let shape = if point.status == Status::Converged { MarkerShape::Circle } else { MarkerShape::Cross };
                let points = Points::new(format!("{}{word}", point.method.id()), at);
                plot.points(points.color(color).radius(5.0).shape(shape));
            }
        });
}
