//! The trade as a picture (SVG): error over time, both logarithmic, with the Pareto front.

use std::fmt::Write as _;

use super::trade::{Measurement, Study};
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};

const SIZE: [f64; 2] = [860.0, 560.0];
const LEFT: f64 = 80.0;
const RIGHT: f64 = 190.0;
const TOP: f64 = 48.0;
const BOTTOM: f64 = 60.0;
/// Errors below this are drawn at it: they are rounding, or chance.
const SMALLEST_ERROR: f64 = 1e-3;
/// Errors above this are drawn at it: those of an iteration that diverges are off the picture.
const LARGEST_ERROR: f64 = 1e3;

/// The error at which a measurement is drawn, percent.
#[must_use]
pub fn drawn_error(m: &Measurement) -> f64 {
    m.error.bound().clamp(SMALLEST_ERROR, LARGEST_ERROR)
}

struct Axis {
    from: f64,
    to: f64,
    start: f64,
    length: f64,
}

impl Axis {
    /// Decades around these values.
    fn new(values: impl Iterator<Item = f64>, start: f64, length: f64) -> Self {
        let (low, high) = values
            .filter(|v| *v > 0.0 && v.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Self { from: 0.0, to: 1.0, start, length };
        }
        Self { from: low.floor(), to: high.ceil().max(low.floor() + 1.0), start, length }
    }

    fn place(&self, value: f64) -> f64 {
        let fraction = (value.max(f64::MIN_POSITIVE).log10() - self.from) / (self.to - self.from);
        self.start + self.length * fraction.clamp(0.0, 1.0)
    }

    fn decades(&self) -> impl Iterator<Item = f64> {
        (self.from as i32..=self.to as i32).map(|e| 10f64.powi(e))
    }
}

fn color(method: MethodKind) -> String {
    let [r, g, b] = method.entry().color(false);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Draws the study.
#[must_use]
pub fn svg(study: &Study) -> String {
    let x = Axis::new(study.measurements.iter().map(Measurement::milliseconds), LEFT, SIZE[0] - LEFT - RIGHT);
    let y = Axis::new(study.measurements.iter().map(drawn_error), SIZE[1] - BOTTOM, -(SIZE[1] - TOP - BOTTOM));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"Ubuntu, sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{LEFT}\" y=\"28\" font-size=\"16\">{}: error against time</text>\n",
        SIZE[0],
        SIZE[1],
        escape(&study.scene)
    );
    let (right, bottom) = (SIZE[0] - RIGHT, SIZE[1] - BOTTOM);
    for t in x.decades() {
        let at = x.place(t);
        let _ = writeln!(
            svg,
            "<line x1=\"{at}\" y1=\"{TOP}\" x2=\"{at}\" y2=\"{bottom}\" stroke=\"#ddd\"/><text x=\"{at}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            bottom + 18.0,
            crate::words::number(t)
        );
    }
    for e in y.decades() {
        let at = y.place(e);
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{at}\" x2=\"{right}\" y2=\"{at}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
            LEFT - 8.0,
            at + 4.0,
            crate::words::number(e)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">time of a solve, ms</text>\n\
         <text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">error bound, % of the true displacement</text>",
        0.5 * (LEFT + right),
        SIZE[1] - 14.0,
        0.5 * (TOP + bottom)
    );
    let mut points = String::new();
    for m in study.front() {
        let _ = write!(points, "{:.1},{:.1} ", x.place(m.milliseconds()), y.place(drawn_error(m)));
    }
    let _ = writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"#333\" stroke-width=\"1.5\"/>");
    for m in &study.measurements {
        mark(&mut svg, x.place(m.milliseconds()), y.place(drawn_error(m)), m);
    }
    let mut row = TOP + 10.0;
    for method in METHODS.iter().map(|m| m.kind) {
        for element in ElementKind::all() {
            let shape = shape(right + 22.0, row, element, &color(method), 5.0);
            let _ = writeln!(
                svg,
                "{shape}<text x=\"{}\" y=\"{}\">{} {}</text>",
                right + 36.0,
                row + 4.0,
                element.id(),
                method.id()
            );
            row += 22.0;
        }
    }
    let _ = writeln!(
        svg,
        "<line x1=\"{}\" y1=\"{row}\" x2=\"{}\" y2=\"{row}\" stroke=\"#333\" stroke-width=\"1.5\"/><text x=\"{}\" y=\"{}\">Pareto front</text>",
        right + 12.0,
        right + 32.0,
        right + 36.0,
        row + 4.0
    );
    svg.push_str("</svg>\n");
    svg
}

fn mark(svg: &mut String, x: f64, y: f64, m: &Measurement) {
    let size = if m.pareto { 5.5 } else { 3.5 };
    let shape = shape(x, y, m.setting.element, &color(m.setting.method), size);
    let opacity = if m.converged { 1.0 } else { 0.45 };
    let _ = writeln!(svg, "<g opacity=\"{opacity}\">{shape}<title>{}</title></g>", m.setting);
}

/// A mark for every element: as many corners as it has nodes.
fn shape(x: f64, y: f64, element: ElementKind, color: &str, size: f64) -> String {
    let corners = element.entry().nodes.len();
    let path: Vec<String> = (0..corners)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
            format!("{:.1} {:.1}", x + size * s, y - size * c)
        })
        .collect();
    format!("<path d=\"M{}Z\" fill=\"{color}\"/>", path.join("L"))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
