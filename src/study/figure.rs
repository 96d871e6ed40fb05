//! A plot over linear axes: lines and marks, a table of present values, and both as CSV and as a picture (SVG).

use std::fmt::Write as _;

use nalgebra::Vector2;

use super::chart::{Margins, escape, shape};
use super::colors::color;
use crate::export::csv_field;
use crate::scene::{ElementKind, Load, MethodKind, Scene};
use crate::words::{number, prefix, ticks};

/// A quantity that every point of a figure has.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
}

impl Quantity {
    /// A quantity with its unit.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: &'static str) -> Self {
        Self { name: name.into(), unit }
    }

    /// The name with the unit in brackets: the head of a column.
    fn heading(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} ({})", self.name, self.unit) }
    }
}

/// Colour of a series, by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// The exact solution.
    Exact,
    /// A method.
    Method(MethodKind),
    /// Unstable equilibria.
    Unstable,
    /// The scene as it stands.
    Scene,
}

impl Ink {
    fn on_paper(self) -> [u8; 3] {
        match self {
            Self::Exact => [0x00, 0x7d, 0x73],
            Self::Method(method) => color(method.id(), false),
            Self::Unstable => [0xbe, 0x14, 0x1e],
            Self::Scene => [0x1c, 0x21, 0x28],
        }
    }
}

/// Line or mark of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A solid line.
    Line,
    /// A dashed line.
    Dashes,
    /// A dotted line.
    Dots,
    /// The mark of an element at every point.
    Element(ElementKind),
    /// A filled circle at every point.
    Disc,
    /// A hollow circle at every point.
    Ring,
    /// A cross at every point.
    Cross,
    /// A plus at every point.
    Plus,
}

impl Mark {
    /// `true` if the points are joined.
    #[must_use]
    pub fn is_line(self) -> bool {
        matches!(self, Self::Line | Self::Dashes | Self::Dots)
    }
}

/// A point of a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigurePoint {
    /// The value of each quantity of the figure; `None` where it has none.
    pub values: Vec<Option<f64>>,
    /// Error of the displacement, percent of the exact one, where that is known.
    pub error_percent: Option<f64>,
    /// Status in a word, such as `stable`; empty where there is nothing to say.
    pub state: String,
    /// `true` if it belongs to the present load.
    pub is_present: bool,
}

impl FigurePoint {
    /// A point that has all values.
    #[must_use]
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        Self { values: values.into_iter().map(Some).collect(), ..Self::default() }
    }
}

/// Points that share a name and a look.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureSeries {
    /// Its name.
    pub name: String,
    /// Its colour.
    pub ink: Ink,
    /// Its look.
    pub mark: Mark,
    /// `true` if the series may leave the picture instead of stretching it.
    pub may_leave: bool,
    /// Its points.
    pub points: Vec<FigurePoint>,
}

/// A row of the table beside a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureRow {
    /// Name of the series.
    pub name: String,
    /// Its colour.
    pub ink: Ink,
    /// Its look.
    pub mark: Mark,
    /// Present value in words; empty where there is none.
    pub value: String,
    /// Error in words; empty where it is not known.
    pub error: String,
    /// `true` if the value says that there is no result.
    pub is_bad: bool,
}

/// Series over two of their quantities, and a table of present values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// The scene's title.
    pub title: String,
    /// Quantities of every point.
    pub quantities: Vec<Quantity>,
    /// The quantities along the horizontal and the vertical axis.
    pub axes: [usize; 2],
    /// Lower left and upper right corner of the picture; `None` shows all points.
    pub bounds: Option<[[f64; 2]; 2]>,
    /// The series.
    pub series: Vec<FigureSeries>,
    /// Head of the table: name, value and error.
    pub head: [String; 3],
    /// Head of the column of errors in CSV.
    pub error_name: String,
    /// Rows of the table.
    pub rows: Vec<FigureRow>,
}

impl Figure {
    /// The quantity along an axis: 0 is the horizontal one.
    #[must_use]
    pub fn quantity(&self, axis: usize) -> Option<&Quantity> {
        self.quantities.get(*self.axes.get(axis)?)
    }

    /// The place of a point in the picture; `None` where it has none.
    #[must_use]
    pub fn place(&self, point: &FigurePoint) -> Option<[f64; 2]> {
        let value = |axis: usize| point.values.get(axis).copied().flatten().filter(|v| v.is_finite());
        Some([value(self.axes[0])?, value(self.axes[1])?])
    }

    /// `true` if both axes are displacements: the picture then has one scale.
    #[must_use]
    pub fn has_one_scale(&self) -> bool {
        let unit = |axis| self.quantity(axis).map(|quantity| quantity.unit);
        unit(0) == Some("m") && unit(1) == Some("m")
    }

    /// Lower left and upper right corner of the picture: around the origin and all points, of which those that may leave it
    /// count up to a third beyond the others.
    #[must_use]
    pub fn corners(&self) -> [[f64; 2]; 2] {
        const LEAVES: f64 = 0.35;
        /// Space around the points, parts of the picture.
        const SPACE: f64 = 0.05;
        if let Some(corners) = self.bounds {
            return corners;
        }
        let places = |may_leave: bool| {
            let own = self.series.iter().filter(move |series| series.may_leave == may_leave);
            own.flat_map(|series| &series.points).filter_map(|point| self.place(point))
        };
        let around = |[low, high]: [[f64; 2]; 2], p: [f64; 2]| {
            [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
        };
        let grown = |[low, high]: [[f64; 2]; 2], part: f64| {
            let by = [0, 1].map(|i| part * (high[i] - low[i]));
            [[low[0] - by[0], low[1] - by[1]], [high[0] + by[0], high[1] + by[1]]]
        };
        let mut whole = places(false).fold([[0.0; 2]; 2], around);
        if whole[0] == whole[1] {
            whole = places(true).fold(whole, around);
        } else {
            let [low, high] = grown(whole, LEAVES);
            let clamped = places(true).map(|p| [0, 1].map(|i| p[i].clamp(low[i], high[i])));
            whole = clamped.fold(whole, around);
        }
        let [mut low, mut high] = grown(whole, SPACE);
        // A load begins at the edge of the picture.
        if self.axes[0] == 0 && whole[0][0] == 0.0 {
            low[0] = 0.0;
        }
        for i in 0..2 {
            if low[i] >= high[i] {
                (low[i], high[i]) = (low[i] - 0.5, high[i] + 0.5);
            }
        }
        [low, high]
    }

    /// The series as a table (CSV), a row a point, in the units of the head.
    #[must_use]
    pub fn csv(&self) -> String {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let (has_errors, has_states) =
            (points().any(|p| p.error_percent.is_some()), points().any(|p| !p.state.is_empty()));
        let mut head = vec!["series".to_owned()];
        head.extend(self.quantities.iter().map(Quantity::heading));
        head.extend(has_errors.then(|| format!("{} (%)", self.error_name)));
        head.extend(has_states.then(|| "state".to_owned()));
        let mut text = csv_row(&head);
        // A sum with 0 has no sign of its own.
        let value = |v: Option<f64>| v.filter(|v| v.is_finite()).map_or_else(String::new, |v| (v + 0.0).to_string());
        for series in &self.series {
            for point in &series.points {
                let mut row = vec![series.name.clone()];
                row.extend(point.values.iter().copied().map(value));
                row.extend(has_errors.then(|| value(point.error_percent)));
                row.extend(has_states.then(|| point.state.clone()));
                text.push_str(&csv_row(&row));
            }
        }
        text
    }

    /// The picture (SVG), with the table beside it.
    #[must_use]
    pub fn svg(&self) -> String {
        const TABLE: f64 = 330.0;
        let margins = Margins { left: 86.0, right: TABLE + 30.0, top: 56.0, bottom: 64.0 };
        let width = super::chart::SIZE[0] + TABLE;
        let ends = [[margins.left, width - margins.right], margins.up()];
        let corners = self.shaped_corners([ends[0][1] - ends[0][0], ends[1][0] - ends[1][1]]);
        let at = |p: [f64; 2]| {
            [0, 1].map(|i| {
                let [from, to] = ends[i];
                from + (to - from) * (p[i] - corners[0][i]) / (corners[1][i] - corners[0][i])
            })
        };
        let mut svg = margins.head_of(&self.title, width);
        let mut labels = [String::new(), String::new()];
        let mut marks = [Vec::new(), Vec::new()];
        for i in 0..2 {
            let Some(quantity) = self.quantity(i) else { continue };
            let (low, high) = (corners[0][i], corners[1][i]);
            let (power, symbol) = prefix(&[low, high], quantity.unit);
            let unit = format!("{symbol}{}", quantity.unit);
            labels[i] = if unit.is_empty() { quantity.name.clone() } else { format!("{}, {unit}", quantity.name) };
            let place = |value: f64| at(if i == 0 { [value, corners[0][1]] } else { [corners[0][0], value] })[i];
            marks[i] = ticks(low, high, 8).into_iter().map(|v| (place(v), tick(v / 10f64.powi(power)))).collect();
        }
        margins.grid_of(&mut svg, width, marks, [&labels[0], &labels[1]]);
        let [[left, right], [bottom, top]] = ends;
        let _ = writeln!(
            svg,
            "<clipPath id=\"axes\"><rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\"/></clipPath>\n<g clip-path=\"url(#axes)\">",
            right - left,
            bottom - top
        );
        // Marks in the same place lie in each other.
        let mut size = 6.5;
        for series in &self.series {
            let places: Vec<[f64; 2]> = series.points.iter().filter_map(|p| self.place(p)).map(at).collect();
            draw(&mut svg, series.ink, series.mark, &places, size);
            if matches!(series.mark, Mark::Element(_) | Mark::Disc) {
                size = (size - 1.2).max(2.0);
            }
        }
        svg.push_str("</g>\n");
        self.svg_table(&mut svg, right + 24.0, width - 14.0);
        svg.push_str("</svg>\n");
        svg
    }

    /// The corners, with one scale for both axes where they have one, in a picture of this size.
    fn shaped_corners(&self, [width, height]: [f64; 2]) -> [[f64; 2]; 2] {
        let [mut low, mut high] = self.corners();
        if self.has_one_scale() {
            let scale = ((high[0] - low[0]) / width).max((high[1] - low[1]) / height);
            for (i, size) in [width, height].into_iter().enumerate() {
                let missing = 0.5 * (scale * size - (high[i] - low[i]));
                (low[i], high[i]) = (low[i] - missing, high[i] + missing);
            }
        }
        [low, high]
    }

    fn svg_table(&self, svg: &mut String, left: f64, right: f64) {
        const ROW: f64 = 21.0;
        const ERRORS: f64 = 56.0;
        let text = |x: f64, y: f64, anchor: &str, words: &str| {
            format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>\n", escape(words))
        };
        let has_errors = self.rows.iter().any(|row| !row.error.is_empty());
        let values = if has_errors { right - ERRORS } else { right };
        let mut y = 66.0;
        let mut put = |[name, value, error]: [&str; 3], y: f64| {
            svg.push_str(&text(left + 26.0, y, "start", name));
            svg.push_str(&text(values, y, "end", value));
            svg.push_str(&text(right, y, "end", if has_errors { error } else { "" }));
        };
        let [name, value, error] = &self.head;
        put([name, value, error], y);
        for row in &self.rows {
            y += ROW;
            put([&row.name, &row.value, &row.error], y);
        }
        let mut y = 66.0 - 4.5;
        for row in &self.rows {
            y += ROW;
            let places = if row.mark.is_line() { vec![[left, y], [left + 20.0, y]] } else { vec![[left + 10.0, y]] };
            draw(svg, row.ink, row.mark, &places, 4.5);
        }
    }
}

/// Draws a series at its places in the picture.
fn draw(svg: &mut String, ink: Ink, mark: Mark, places: &[[f64; 2]], size: f64) {
    let rgb = ink.on_paper();
    let color = format!("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
    if mark.is_line() {
        let dashes = match mark {
            Mark::Dashes => " stroke-dasharray=\"9 5\"",
            Mark::Dots => " stroke-dasharray=\"2 5\"",
            _ => "",
        };
        let line: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2.2\" stroke-linejoin=\"round\"{dashes}/>",
            line.join(" ")
        );
        return;
    }
    for &[x, y] in places {
        let lines = |corners: [[f64; 2]; 4]| {
            let [a, b, c, d] = corners.map(|[u, v]| format!("{:.1} {:.1}", x + size * u, y + size * v));
            format!("<path d=\"M{a}L{b}M{c}L{d}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>")
        };
        let drawn = match mark {
            Mark::Element(element) => shape(x, y, element, rgb, size),
            Mark::Ring => {
                format!(
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{size}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>"
                )
            }
            Mark::Cross => lines([[-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [1.0, -1.0]]),
            Mark::Plus => lines([[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]]),
            _ => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{size}\" fill=\"{color}\"/>"),
        };
        let _ = writeln!(svg, "{drawn}");
    }
}

fn csv_row(fields: &[String]) -> String {
    let fields: Vec<_> = fields.iter().map(|field| csv_field(field)).collect();
    fields.join(",") + "\n"
}

/// A number at an axis, without the rounding of its steps.
fn tick(value: f64) -> String {
    let short: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    number(if short == 0.0 { 0.0 } else { short })
}

/// The axis of a scene's loads.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadAxis {
    /// Name and unit.
    pub quantity: Quantity,
    /// Value under the scene's own loads.
    pub full: f64,
}

impl LoadAxis {
    /// The one load, or the first of several that have one unit; the load factor where their units differ.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let pulling: Vec<(&'static str, &'static str, f64)> =
            scene.loads.iter().map(kind).filter(|(_, _, size)| *size > 0.0).collect();
        let one_unit = pulling.windows(2).all(|pair| pair[0].1 == pair[1].1);
        match pulling.first() {
            Some(&(name, unit, full)) if pulling.len() == 1 => Self { quantity: Quantity::new(name, unit), full },
            Some(&(name, unit, full)) if one_unit => {
                let name = format!("first {name}, the others in proportion");
                Self { quantity: Quantity::new(name, unit), full }
            }
            _ => Self { quantity: Quantity::new("load factor", ""), full: 1.0 },
        }
    }
}

/// Name, unit and size of a load.
fn kind(load: &Load) -> (&'static str, &'static str, f64) {
    match load {
        Load::Force { force: [x, y], .. } => ("force", "N", x.hypot(*y)),
        Load::Moment { moment, .. } => ("moment", "N m", moment.abs()),
        Load::Gravity { acceleration: [x, y], .. } => ("gravity", "m/s²", x.hypot(*y)),
    }
}

/// Returns `true` if displacements go along both axes: their path then says more than one component.
#[must_use]
pub fn leaves_the_axes(displacements: impl Iterator<Item = Vector2<f64>>) -> bool {
    /// Part of the larger component below which the smaller one is not seen.
    const SEEN: f64 = 0.05;
    let [x, y] = largest_components(displacements);
    x.min(y) > SEEN * x.max(y)
}

/// Returns the axis of the larger component: 0 is x.
#[must_use]
pub fn dominant_axis(displacements: impl Iterator<Item = Vector2<f64>>) -> usize {
    let [x, y] = largest_components(displacements);
    usize::from(y >= x)
}

fn largest_components(displacements: impl Iterator<Item = Vector2<f64>>) -> [f64; 2] {
    displacements.fold([0.0_f64; 2], |[x, y], u| [x.max(u.x.abs()), y.max(u.y.abs())])
}
