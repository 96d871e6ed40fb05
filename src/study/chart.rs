//! Pictures (SVG) over axes: error over time, both logarithmic, with the Pareto front and a legend; lines of elements; and
//! the axes of all of them.

use std::fmt::Write as _;

use crate::scene::ElementKind;
use crate::words::number;

/// Size of every picture.
pub(super) const SIZE: [f64; 2] = [860.0, 560.0];

/// Where the axes are in a picture: what lies around them.
pub(super) struct Margins {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

const MARGINS: Margins = Margins { left: 80.0, right: 190.0, top: 48.0, bottom: 60.0 };
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
    ends: [f64; 2],
}

impl Axis {
    /// Decades around these values, between two places.
    fn new(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let (low, high) = values
            .filter(|v| *v > 0.0 && v.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Self { from: 0.0, to: 1.0, ends };
        }
        Self { from: low.floor(), to: high.ceil().max(low.floor() + 1.0), ends }
    }

    fn place(&self, value: f64) -> f64 {
        let fraction = (value.max(f64::MIN_POSITIVE).log10() - self.from) / (self.to - self.from);
        let [start, end] = self.ends;
        start + (end - start) * fraction.clamp(0.0, 1.0)
    }

    /// The decades: where they are, and their numbers.
    fn ticks(&self) -> Vec<(f64, String)> {
        let decades = (self.from as i32..=self.to as i32).map(|e| 10f64.powi(e));
        decades.map(|value| (self.place(value), number(value))).collect()
    }
}

impl Chart<'_> {
    pub fn svg(&self) -> String {
        let times = self.points.iter().map(|p| p.time).chain(self.mark.iter().map(|m| m.time));
        let x = Axis::new(times, MARGINS.across());
        let y = Axis::new(self.points.iter().map(|p| p.error), MARGINS.up());
        let mut svg = MARGINS.head(&self.title);
        MARGINS.grid(&mut svg, [x.ticks(), y.ticks()], [self.time_label, self.error_label]);
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
        let [bottom, top] = MARGINS.up();
        if let Some(mark) = &self.mark {
            let at = x.place(mark.time);
            let _ = writeln!(
                svg,
                "<line x1=\"{at}\" y1=\"{top}\" x2=\"{at}\" y2=\"{bottom}\" stroke=\"#555\" stroke-width=\"1.5\" stroke-dasharray=\"6 4\"/>\
                 <text x=\"{at}\" y=\"{}\" text-anchor=\"middle\" fill=\"#333\">{}</text>",
                top - 6.0,
                mark.label
            );
        }
    }

    fn key(&self, svg: &mut String) {
        let [_, right] = MARGINS.across();
        let mut row = MARGINS.top + 10.0;
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

impl Margins {
    /// Left and right ends of the horizontal axis.
    pub fn across(&self) -> [f64; 2] {
        [self.left, SIZE[0] - self.right]
    }

    /// Lower and upper ends of the vertical axis.
    pub fn up(&self) -> [f64; 2] {
        [SIZE[1] - self.bottom, self.top]
    }

    /// The start of a picture.
    pub fn head(&self, title: &str) -> String {
        self.head_of(title, SIZE[0])
    }

    /// The start of a picture of this width.
    pub fn head_of(&self, title: &str, width: f64) -> String {
        let (height, left) = (SIZE[1], self.left);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" font-family=\"Ubuntu, sans-serif\" font-size=\"13\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{left}\" y=\"28\" font-size=\"16\">{}</text>\n",
            escape(title)
        )
    }

    /// Lines at places of both axes with their words, and what the axes mean.
    pub fn grid(&self, svg: &mut String, lines: [Vec<(f64, String)>; 2], labels: [&str; 2]) {
        self.grid_of(svg, SIZE[0], lines, labels);
    }

    /// The same in a picture of this width.
    pub fn grid_of(
        &self,
        svg: &mut String,
        width: f64,
        [x, y]: [Vec<(f64, String)>; 2],
        [x_label, y_label]: [&str; 2],
    ) {
        let ([left, right], [bottom, top]) = ([self.left, width - self.right], self.up());
        for (at, words) in x {
            let _ = writeln!(
                svg,
                "<line x1=\"{at:.1}\" y1=\"{top}\" x2=\"{at:.1}\" y2=\"{bottom}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{words}</text>",
                bottom + 18.0
            );
        }
        for (at, words) in y {
            let _ = writeln!(
                svg,
                "<line x1=\"{left}\" y1=\"{at:.1}\" x2=\"{right}\" y2=\"{at:.1}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{words}</text>",
                left - 8.0,
                at + 4.0
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * (left + right),
            SIZE[1] - 14.0,
            escape(x_label),
            0.5 * (top + bottom),
            escape(y_label)
        );
    }
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
        let x = Axis::new(points().map(|p| p.0), MARGINS.across());
        let y = Axis::new(points().map(|p| p.1), MARGINS.up());
        let mut svg = MARGINS.head(&self.title);
        MARGINS.grid(&mut svg, [x.ticks(), y.ticks()], [self.x_label, self.y_label]);
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
            let [_, right] = MARGINS.across();
            let row = MARGINS.top + 10.0 + ROW * i as f64;
            let symbol = shape(right + 22.0, row, *element, *color, 5.0);
            let at = [right + 36.0, row + 4.0];
            let _ = writeln!(svg, "{symbol}<text x=\"{}\" y=\"{}\">{}</text>", at[0], at[1], element.id());
        }
        svg.push_str("</svg>\n");
        svg
    }
}

/// A mark for every element: as many corners as it has nodes.
pub(super) fn shape(x: f64, y: f64, element: ElementKind, [r, g, b]: [u8; 3], size: f64) -> String {
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
