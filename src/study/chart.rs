//! Error over time as a picture (SVG), both logarithmic, with the Pareto front and a legend.

use std::fmt::Write as _;

use crate::scene::ElementKind;
use crate::words::number;

const SIZE: [f64; 2] = [860.0, 560.0];
const LEFT: f64 = 80.0;
const RIGHT: f64 = 190.0;
const TOP: f64 = 48.0;
const BOTTOM: f64 = 60.0;
const ROW: f64 = 22.0;

/// A measurement in a picture.
pub(super) struct Point {
    pub time: f64,
    pub error: f64,
    pub element: ElementKind,
    pub color: [u8; 3],
    pub faint: bool,
    /// Whether the Pareto front runs through it.
    pub front: bool,
    /// What a pointer on it is told.
    pub title: String,
}

/// A time that stands out.
pub(super) struct Mark<'a> {
    pub time: f64,
    pub label: &'a str,
}

pub(super) struct Chart<'a> {
    pub title: String,
    pub time_label: &'a str,
    pub error_label: &'a str,
    pub points: Vec<Point>,
    /// Colours with what they stand for; each is shown with every element.
    pub legend: Vec<(&'a str, [u8; 3])>,
    /// What faint points are, if the legend says.
    pub faint_label: Option<&'a str>,
    pub mark: Option<Mark<'a>>,
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

impl Chart<'_> {
    pub fn svg(&self) -> String {
        let times = self.points.iter().map(|p| p.time).chain(self.mark.iter().map(|m| m.time));
        let x = Axis::new(times, LEFT, SIZE[0] - LEFT - RIGHT);
        let y = Axis::new(self.points.iter().map(|p| p.error), SIZE[1] - BOTTOM, -(SIZE[1] - TOP - BOTTOM));
        let mut svg = head(&self.title);
        grid(&mut svg, [&x, &y], [self.time_label, self.error_label]);
        self.mark(&mut svg, &x);
        let mut front: Vec<&Point> = self.points.iter().filter(|p| p.front).collect();
        front.sort_by(|a, b| a.time.total_cmp(&b.time));
        let mut line = String::new();
        for point in front {
            let _ = write!(line, "{:.1},{:.1} ", x.place(point.time), y.place(point.error));
        }
        let _ = writeln!(svg, "<polyline points=\"{line}\" fill=\"none\" stroke=\"#333\" stroke-width=\"1.5\"/>");
        for point in &self.points {
            let size = if point.front { 5.5 } else { 3.5 };
            let shape = shape(x.place(point.time), y.place(point.error), point.element, point.color, size);
            let opacity = if point.faint { 0.45 } else { 1.0 };
            let _ = writeln!(svg, "<g opacity=\"{opacity}\">{shape}<title>{}</title></g>", escape(&point.title));
        }
        self.key(&mut svg);
        svg.push_str("</svg>\n");
        svg
    }

    fn mark(&self, svg: &mut String, x: &Axis) {
        let bottom = SIZE[1] - BOTTOM;
        if let Some(mark) = &self.mark {
            let at = x.place(mark.time);
            let _ = writeln!(
                svg,
                "<line x1=\"{at}\" y1=\"{TOP}\" x2=\"{at}\" y2=\"{bottom}\" stroke=\"#555\" stroke-width=\"1.5\" stroke-dasharray=\"6 4\"/>\
                 <text x=\"{at}\" y=\"{}\" text-anchor=\"middle\" fill=\"#333\">{}</text>",
                TOP - 6.0,
                mark.label
            );
        }
    }

    fn key(&self, svg: &mut String) {
        let right = SIZE[0] - RIGHT;
        let mut row = TOP + 10.0;
        let mut add = |symbol: &str, words: &str, row: &mut f64| {
            let _ = writeln!(svg, "{symbol}<text x=\"{}\" y=\"{}\">{words}</text>", right + 36.0, *row + 4.0);
            *row += ROW;
        };
        for (label, color) in &self.legend {
            for element in ElementKind::all() {
                let symbol = shape(right + 22.0, row, element, *color, 5.0);
                add(&symbol, &format!("{} {label}", element.id()), &mut row);
            }
        }
        let line = |row: f64, dashes: &str| {
            format!(
                "<line x1=\"{}\" y1=\"{row}\" x2=\"{}\" y2=\"{row}\" stroke=\"#333\" stroke-width=\"1.5\"{dashes}/>",
                right + 12.0,
                right + 32.0
            )
        };
        let symbol = line(row, "");
        add(&symbol, "Pareto front", &mut row);
        if let Some(mark) = &self.mark {
            let symbol = line(row, " stroke-dasharray=\"6 4\"");
            add(&symbol, mark.label, &mut row);
        }
        if let Some(label) = self.faint_label {
            add("", &format!("faint: {label}"), &mut row);
        }
    }
}

/// The start of a picture.
fn head(title: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"Ubuntu, sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{LEFT}\" y=\"28\" font-size=\"16\">{}</text>\n",
        SIZE[0],
        SIZE[1],
        escape(title)
    )
}

/// The lines of the decades with their numbers, and what the axes mean.
fn grid(svg: &mut String, [x, y]: [&Axis; 2], labels: [&str; 2]) {
    let (right, bottom) = (SIZE[0] - RIGHT, SIZE[1] - BOTTOM);
    for t in x.decades() {
        let at = x.place(t);
        let _ = writeln!(
            svg,
            "<line x1=\"{at}\" y1=\"{TOP}\" x2=\"{at}\" y2=\"{bottom}\" stroke=\"#ddd\"/><text x=\"{at}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            bottom + 18.0,
            number(t)
        );
    }
    for e in y.decades() {
        let at = y.place(e);
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{at}\" x2=\"{right}\" y2=\"{at}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
            LEFT - 8.0,
            at + 4.0,
            number(e)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
         <text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        0.5 * (LEFT + right),
        SIZE[1] - 14.0,
        labels[0],
        0.5 * (TOP + bottom),
        labels[1]
    );
}

/// Lines over logarithmic axes, one an element.
pub(super) struct LogLog<'a> {
    pub title: String,
    pub x_label: &'a str,
    pub y_label: &'a str,
    pub series: Vec<Series>,
}

/// The line of an element.
pub(super) struct Series {
    pub element: ElementKind,
    pub color: [u8; 3],
    pub points: Vec<(f64, f64)>,
}

impl LogLog<'_> {
    pub fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|s| &s.points);
        let x = Axis::new(points().map(|p| p.0), LEFT, SIZE[0] - LEFT - RIGHT);
        let y = Axis::new(points().map(|p| p.1), SIZE[1] - BOTTOM, -(SIZE[1] - TOP - BOTTOM));
        let mut svg = head(&self.title);
        grid(&mut svg, [&x, &y], [self.x_label, self.y_label]);
        for (i, Series { element, color, points }) in self.series.iter().enumerate() {
            let [r, g, b] = color;
            let places: Vec<[f64; 2]> = points.iter().map(|p| [x.place(p.0), y.place(p.1)]).collect();
            let line: String = places.iter().map(|[x, y]| format!("{x:.1},{y:.1} ")).collect();
            let _ = writeln!(
                svg,
                "<polyline points=\"{line}\" fill=\"none\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"1.5\"/>"
            );
            for [x, y] in places {
                let _ = writeln!(svg, "{}", shape(x, y, *element, *color, 4.5));
            }
            let row = TOP + 10.0 + ROW * i as f64;
            let symbol = shape(SIZE[0] - RIGHT + 22.0, row, *element, *color, 5.0);
            let at = [SIZE[0] - RIGHT + 36.0, row + 4.0];
            let _ = writeln!(svg, "{symbol}<text x=\"{}\" y=\"{}\">{}</text>", at[0], at[1], element.id());
        }
        svg.push_str("</svg>\n");
        svg
    }
}

/// A mark for every element: as many corners as it has nodes.
fn shape(x: f64, y: f64, element: ElementKind, [r, g, b]: [u8; 3], size: f64) -> String {
    let corners = element.entry().nodes.len();
    let path: Vec<String> = (0..corners)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
            format!("{:.1} {:.1}", x + size * s, y - size * c)
        })
        .collect();
    format!("<path d=\"M{}Z\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>", path.join("L"))
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
