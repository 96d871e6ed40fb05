//! The trade as a picture (SVG): error over time, both logarithmic, with the Pareto front.

use super::chart::{Chart, Mark, Point};
use super::colors::color;
use super::motion::{MotionStudy, REAL_TIME};
use super::trade::{Measurement, Study};
use crate::dynamics::INTEGRATORS;
use crate::method::METHODS;
use crate::scene::MethodKind;

/// Errors below this are drawn at it: they are rounding, or chance.
const SMALLEST_ERROR: f64 = 1e-3;
/// Errors above this are drawn at it: those of an iteration that diverges are off the picture.
const LARGEST_ERROR: f64 = 1e3;

/// The error at which a measurement is drawn, percent.
#[must_use]
pub fn drawn_error(m: &Measurement) -> f64 {
    m.error.bound().clamp(SMALLEST_ERROR, LARGEST_ERROR)
}

/// Draws the study.
#[must_use]
pub fn svg(study: &Study) -> String {
    let point = |m: &Measurement| Point {
        time: m.milliseconds(),
        error: drawn_error(m),
        element: m.setting.element,
        color: color(m.setting.method.id(), false),
        faint: !m.converged,
        front: m.pareto,
        title: m.setting.to_string(),
    };
    let chart = Chart {
        title: format!("{}: error against time", study.scene),
        time_label: "time of a solve, ms",
        error_label: "error bound, % of the true displacement",
        points: study.measurements.iter().map(point).collect(),
        legend: METHODS.iter().map(|m| (m.id, color(m.id, false))).collect(),
        faint_label: None,
        mark: None,
    };
    chart.svg()
}

/// Draws the study of a motion.
#[must_use]
pub fn motion_svg(study: &MotionStudy) -> String {
    let points = study.measurements.iter().filter_map(|m| {
        Some(Point {
            time: m.milliseconds,
            error: study.resolved(m.error?.bound()).clamp(SMALLEST_ERROR, LARGEST_ERROR),
            element: m.setting.element,
            color: color(m.setting.integrator.id(), false),
            faint: m.setting.method == MethodKind::Linear,
            front: m.pareto,
            title: m.setting.to_string(),
        })
    });
    let chart = Chart {
        title: format!("{}: error of its path against time", study.scene),
        time_label: "time of computing a simulated second, ms",
        error_label: "error bound of the path, % of how far it leads",
        points: points.collect(),
        legend: INTEGRATORS.iter().map(|i| (i.id, color(i.id, false))).collect(),
        faint_label: Some("linear theory"),
        mark: Some(Mark { time: REAL_TIME, label: "real time" }),
    };
    chart.svg()
}
