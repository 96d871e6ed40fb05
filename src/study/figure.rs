//! A plot over linear axes: lines and marks, a table of present values, and both as CSV.

use nalgebra::Vector2;

use crate::export::csv_field;
use crate::scene::{Load, MethodKind, Scene};
use crate::sentence::{Sentence, sentence};

/// A quantity that every point of a figure has.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureQuantity {
    /// Name.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
}

impl FigureQuantity {
    /// Returns a quantity with its unit.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: &'static str) -> Self {
        Self { name: name.into(), unit }
    }

    /// Returns the name with the unit in brackets, the head of a column.
    fn heading(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} ({})", self.name, self.unit) }
    }
}

/// Colour of a series, by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Beam theory.
    BeamTheory,
    /// A method.
    Method(MethodKind),
    /// Unstable equilibria.
    Unstable,
    /// Present state of the scene.
    Scene,
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
    /// A filled circle at every point.
    Disc,
    /// A hollow circle at every point.
    Ring,
    /// A cross at every point.
    Cross,
}

impl Mark {
    /// Returns `true` if the points are joined.
    #[must_use]
    pub fn is_line(self) -> bool {
        matches!(self, Self::Line | Self::Dashes | Self::Dots)
    }
}

/// A point of a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigurePoint {
    /// Value of each quantity of the figure; `None` where the point has none.
    pub values: Vec<Option<f64>>,
    /// Status in a word, such as `stable`; may be empty.
    pub state: String,
    /// `true` if it belongs to the present load.
    pub is_present: bool,
}

impl FigurePoint {
    /// Returns a point that has all values.
    #[must_use]
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        Self { values: values.into_iter().map(Some).collect(), ..Self::default() }
    }
}

/// Points with one name, colour and mark.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureSeries {
    /// Name.
    pub name: String,
    /// Colour.
    pub ink: Ink,
    /// Line or mark.
    pub mark: Mark,
    /// `true` if the series may leave the picture instead of stretching it.
    pub may_leave: bool,
    /// Points, in the order in which a line joins them.
    pub points: Vec<FigurePoint>,
}

impl FigureSeries {
    /// Returns a series that stretches the picture.
    #[must_use]
    pub fn new(name: String, ink: Ink, mark: Mark, points: Vec<FigurePoint>) -> Self {
        Self { name, ink, mark, may_leave: false, points }
    }
}

/// A row of the table beside a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureRow {
    /// Name of the series.
    pub name: String,
    /// Colour.
    pub ink: Ink,
    /// Line or mark; that of a status without result, such as `diverged`, is a cross.
    pub mark: Mark,
    /// Present value with its unit; may be empty.
    pub value: String,
}

/// Series over two of their quantities, and a table of present values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// The scene's title.
    pub title: String,
    /// Quantities that each point has.
    pub quantities: Vec<FigureQuantity>,
    /// Indices of the quantities along the horizontal and the vertical axis.
    pub axes: [usize; 2],
    /// The series.
    pub series: Vec<FigureSeries>,
    /// Headings of the table: name and value.
    pub head: [String; 2],
    /// Rows of the table.
    pub rows: Vec<FigureRow>,
}

impl Figure {
    /// Returns the quantity along an axis: 0 is horizontal, 1 vertical.
    #[must_use]
    pub fn quantity(&self, axis: usize) -> Option<&FigureQuantity> {
        self.quantities.get(*self.axes.get(axis)?)
    }

    /// Returns the values of a point along both axes; `None` if one is missing.
    #[must_use]
    pub fn place(&self, point: &FigurePoint) -> Option<[f64; 2]> {
        let value = |axis: usize| point.values.get(axis).copied().flatten().filter(|v| v.is_finite());
        Some([value(self.axes[0])?, value(self.axes[1])?])
    }

    /// Returns `true` if both axes are displacements: the picture then has one scale.
    #[must_use]
    pub fn has_one_scale(&self) -> bool {
        let unit = |axis| self.quantity(axis).map(|quantity| quantity.unit);
        unit(0) == Some("m") && unit(1) == Some("m")
    }

    /// Returns the lower left and upper right corner of the picture, around the origin and all points. Points that may
    /// leave it extend it by at most 35 % of the extent of the others, of the larger one where both axes have one scale.
    #[must_use]
    pub fn corners(&self) -> [[f64; 2]; 2] {
        const LEAVES: f64 = 0.35;
        /// Margin around the points, as a fraction of the picture.
        const SPACE: f64 = 0.05;
        let places = |may_leave: bool| {
            let own = self.series.iter().filter(move |series| series.may_leave == may_leave);
            own.flat_map(|series| &series.points).filter_map(|point| self.place(point))
        };
        let around = |[low, high]: [[f64; 2]; 2], p: [f64; 2]| {
            [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
        };
        let extents = |[low, high]: [[f64; 2]; 2]| [0, 1].map(|i| high[i] - low[i]);
        let grown = |[low, high]: [[f64; 2]; 2], by: [f64; 2]| {
            [[low[0] - by[0], low[1] - by[1]], [high[0] + by[0], high[1] + by[1]]]
        };
        let mut whole = places(false).fold([[0.0; 2]; 2], around);
        if whole[0] == whole[1] {
            whole = places(true).fold(whole, around);
        } else {
            let [width, height] = extents(whole);
            // The longer axis decides a common scale, so the shorter one has room.
            let room = if self.has_one_scale() { [width.max(height); 2] } else { [width, height] };
            let [low, high] = grown(whole, room.map(|extent| LEAVES * extent));
            let clamped = places(true).map(|p| [0, 1].map(|i| p[i].clamp(low[i], high[i])));
            whole = clamped.fold(whole, around);
        }
        let [mut low, mut high] = grown(whole, extents(whole).map(|extent| SPACE * extent));
        // An axis of loads begins at the edge of the picture, without a margin.
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

    /// Formats the series as CSV, a row per point, in the units of the headings.
    #[must_use]
    pub fn csv(&self) -> String {
        let has_states = self.series.iter().flat_map(|series| &series.points).any(|p| !p.state.is_empty());
        let mut head = vec!["series".to_owned()];
        head.extend(self.quantities.iter().map(FigureQuantity::heading));
        head.extend(has_states.then(|| "state".to_owned()));
        let mut text = csv_row(&head);
        // Adding 0 turns −0 into 0.
        let value = |v: Option<f64>| v.filter(|v| v.is_finite()).map_or_else(String::new, |v| (v + 0.0).to_string());
        for series in &self.series {
            for point in &series.points {
                let mut row = vec![series.name.clone()];
                row.extend(point.values.iter().copied().map(value));
                row.extend(has_states.then(|| point.state.clone()));
                text.push_str(&csv_row(&row));
            }
        }
        text
    }
}

fn csv_row(fields: &[String]) -> String {
    let fields: Vec<_> = fields.iter().map(|field| csv_field(field)).collect();
    fields.join(",") + "\n"
}

/// Axis of a scene's loads.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadAxis {
    /// Name of the quantity.
    pub name: Sentence,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Value under the scene's own loads.
    pub full: f64,
}

impl LoadAxis {
    /// Returns the axis of the only load, or of the first of several with the same unit; otherwise that of the load
    /// factor.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let pulling: Vec<(&'static str, &'static str, f64)> =
            scene.loads.iter().map(kind).filter(|(_, _, size)| *size > 0.0).collect();
        let one_unit = pulling.windows(2).all(|pair| pair[0].1 == pair[1].1);
        match pulling.first() {
            Some(&(name, unit, full)) if pulling.len() == 1 => Self { name: name.into(), unit, full },
            Some(&(name, unit, full)) if one_unit => {
                Self { name: sentence!("first %{load}, the others in proportion", load = name), unit, full }
            }
            _ => Self { name: sentence!("load factor"), unit: "", full: 1.0 },
        }
    }
}

/// Returns name, unit and size of a load.
fn kind(load: &Load) -> (&'static str, &'static str, f64) {
    match load {
        Load::Force { force: [x, y], .. } => ("force", "N", x.hypot(*y)),
        Load::Moment { moment, .. } => ("moment", "N m", moment.abs()),
        Load::Gravity { acceleration: [x, y], .. } => ("gravity", "m/s²", x.hypot(*y)),
    }
}

/// Returns the axis of the larger component: 0 is x.
#[must_use]
pub fn dominant_axis(displacements: impl Iterator<Item = Vector2<f64>>) -> usize {
    let [x, y] = displacements.fold([0.0_f64; 2], |[x, y], u| [x.max(u.x.abs()), y.max(u.y.abs())]);
    usize::from(y >= x)
}
