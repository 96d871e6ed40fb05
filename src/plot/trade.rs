//! Studies as drawings: error over time with the Pareto front, both axes logarithmic.

use super::axes::{MARGINS, ROW, ScaledAxis, mark};
use super::drawing::{Anchor, Color, Drawing, DrawingItem, INK, Outline, Shape, Stroke, Text, solid};
use crate::dynamics::INTEGRATORS;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};
use crate::study::color;
use crate::study::motion::REAL_TIME;
use crate::study::{Study, StudyReference};

/// Errors below this are drawn at it: they are rounding, or chance.
pub const SMALLEST_ERROR: f64 = 1e-3;
/// Errors above this are drawn at it: those of an iteration that diverges are off the picture.
pub const LARGEST_ERROR: f64 = 1e3;
/// Width of a line.
const WIDTH: f64 = 1.5;

/// Draws the study.
pub fn study(study: &Study) -> Drawing {
    let moves = matches!(study.reference, StudyReference::Motion(_));
    let points = study.measurements.iter().filter(|m| m.error.is_some()).map(|m| Point {
        time: m.milliseconds,
        error: study.error_bound(m).clamp(SMALLEST_ERROR, LARGEST_ERROR),
        element: m.setting.element,
        color: color(m.setting.stepping.map_or(m.setting.method.id(), |stepping| stepping.integrator.id()), false),
        faint: if moves { m.setting.method == MethodKind::Linear } else { !m.converged },
        front: m.pareto,
        title: m.setting.to_string(),
    });
    let points = points.collect();
    let chart = if moves {
        Chart {
            title: format!("{}: error of its path against time", study.scene),
            time_label: "computing time per simulated second, ms",
            error_label: "error bound of the path, % of its largest displacement",
            points,
            legend: INTEGRATORS.iter().map(|i| (i.id, color(i.id, false))).collect(),
            faint_label: Some("linear theory"),
            mark: Some(TradeMark { time: REAL_TIME, label: "real time" }),
        }
    } else {
        Chart {
            title: format!("{}: error against time", study.scene),
            time_label: "time of a solve, ms",
            error_label: "error bound, % of the reference displacement",
            points,
            legend: METHODS.iter().map(|m| (m.id, color(m.id, false))).collect(),
            faint_label: None,
            mark: None,
        }
    };
    chart.draw()
}

/// A measurement in a chart.
struct Point {
    time: f64,
    error: f64,
    element: ElementKind,
    color: Color,
    faint: bool,
    /// `true` if the Pareto front runs through it.
    front: bool,
    /// Text beside the pointer.
    title: String,
}

/// A time that stands out.
struct TradeMark<'a> {
    time: f64,
    label: &'a str,
}

/// Error over time.
struct Chart<'a> {
    title: String,
    time_label: &'a str,
    error_label: &'a str,
    points: Vec<Point>,
    /// Colours with their meaning; each is shown with every element.
    legend: Vec<(&'a str, Color)>,
    /// Meaning of faint points, if the legend says.
    faint_label: Option<&'a str>,
    mark: Option<TradeMark<'a>>,
}

const DASHED: Stroke = Stroke { width: WIDTH, dashes: &[6.0, 4.0] };

impl Chart<'_> {
    fn draw(&self) -> Drawing {
        let times = self.points.iter().map(|p| p.time).chain(self.mark.iter().map(|m| m.time));
        let x = ScaledAxis::decades(times, MARGINS.across());
        let y = ScaledAxis::decades(self.points.iter().map(|p| p.error), MARGINS.up());
        let mut drawing = MARGINS.start(self.title.as_str());
        MARGINS.grid(&mut drawing, [x.ticks(), y.ticks()], [self.time_label, self.error_label]);
        if let Some(mark) = &self.mark {
            let ([bottom, top], at) = (MARGINS.up(), x.place(mark.time));
            drawing.line(vec![[at, top], [at, bottom]], [0x55; 3], DASHED);
            let label = Text::new([at, top - 6.0], Anchor::Middle, mark.label);
            drawing.items.push(DrawingItem::Text(Text { color: INK, ..label }));
        }
        let place = |point: &Point| [x.place(point.time), y.place(point.error)];
        let mut front: Vec<&Point> = self.points.iter().filter(|p| p.front).collect();
        front.sort_by(|a, b| a.time.total_cmp(&b.time));
        drawing.line(front.into_iter().map(place).collect(), INK, solid(WIDTH));
        for point in &self.points {
            let shape = mark(place(point), point.element, point.color, if point.front { 5.5 } else { 3.5 });
            let opacity = if point.faint { 0.45 } else { 1.0 };
            drawing.add(Shape { opacity, title: point.title.clone(), ..shape });
        }
        self.key(&mut drawing);
        drawing
    }

    fn key(&self, drawing: &mut Drawing) {
        let [_, right] = MARGINS.across();
        let mut row = MARGINS.top + 10.0;
        let mut add = |symbol: Option<Shape>, text: &str| {
            symbol.into_iter().for_each(|symbol| drawing.add(symbol));
            drawing.text([right + 36.0, row + 4.0], Anchor::Start, text);
            row += ROW;
            row
        };
        let mut row = MARGINS.top + 10.0;
        for (label, color) in &self.legend {
            for element in ElementKind::all() {
                let symbol = mark([right + 22.0, row], element, *color, 5.0);
                row = add(Some(symbol), &format!("{} {label}", element.id()));
            }
        }
        let line = |row: f64, stroke: Stroke| {
            Some(Shape::stroked(Outline::Line(vec![[right + 12.0, row], [right + 32.0, row]]), INK, stroke))
        };
        row = add(line(row, solid(WIDTH)), "Pareto front");
        if let Some(mark) = &self.mark {
            add(line(row, DASHED), mark.label);
        }
        if let Some(label) = self.faint_label {
            add(None, &format!("faint: {label}"));
        }
    }
}
