//! A plot over linear axes: lines and marks, a table of present values, and both as CSV.

use super::prelude::*;
use crate::export::csv_field;

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
    pub fn new(name: impl Into<String>, unit: &'static str) -> Self {
        Self { name: name.into(), unit }
    }
}

/// Colour in a drawing, by its meaning: a file and each theme of the window have another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Background.
    Paper,
    /// Texts, and lines that belong to no series or to beam theory.
    Text,
    /// Lines of a grid.
    Grid,
    /// Reference solution.
    Reference,
    /// Line of a limit.
    Limit,
    /// Load of the scene.
    Load,
    /// A method or an integrator: the colours of its entry in the registry.
    Solution([[u8; 3]; 2]),
    /// Unstable equilibria.
    Unstable,
    /// Present state of the scene.
    Scene,
    /// Red, green and blue, the same on each background.
    Fixed([u8; 3]),
}

impl Ink {
    /// Returns the colour of a setting's integrator, or of its method at rest.
    pub(crate) fn of(setting: &Setting) -> Self {
        let integrator = setting.stepping.map(|stepping| stepping.integrator.entry().colors);
        Self::Solution(integrator.unwrap_or(setting.method.entry().colors))
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
    /// A filled circle at every point.
    Disc,
    /// A hollow circle at every point.
    Ring,
}

impl Mark {
    /// Returns `true` if the points are joined.
    pub fn is_line(self) -> bool {
        matches!(self, Self::Line | Self::Dashes | Self::Dots)
    }
}

/// A point of a series: the value of each quantity of the figure, not finite where the point has none.
pub type FigurePoint = Vec<f64>;

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
    /// Present value with its unit in the table beside the figure; may be empty. `None` if the table does not have the
    /// series.
    pub value: Option<String>,
}

impl FigureSeries {
    /// Returns a series that stretches the picture, with an empty value in the table.
    pub fn new(name: String, ink: Ink, mark: Mark, points: Vec<FigurePoint>) -> Self {
        Self { name, ink, mark, may_leave: false, points, value: Some(String::new()) }
    }

    /// Returns a row of the table that is not drawn.
    pub(super) fn row(name: String, ink: Ink, mark: Mark, value: String) -> Self {
        Self { value: Some(value), ..Self::new(name, ink, mark, Vec::new()) }
    }
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
}

impl Figure {
    /// Returns the rows of the table, each with the value of a series.
    pub fn rows(&self) -> impl Iterator<Item = (&FigureSeries, &str)> {
        let is_first = |(i, series): &(usize, &FigureSeries)| self.series[..*i].iter().all(|s| s.name != series.name);
        let first = self.series.iter().enumerate().filter(is_first);
        first.filter_map(|(_, series)| Some((series, series.value.as_deref()?)))
    }

    /// Returns the quantity along an axis: 0 is horizontal, 1 vertical.
    pub fn quantity(&self, axis: usize) -> Option<&FigureQuantity> {
        self.quantities.get(*self.axes.get(axis)?)
    }

    /// Returns the values of a point along both axes; `None` if one is missing.
    pub fn place(&self, point: &FigurePoint) -> Option<[f64; 2]> {
        let value = |axis: usize| point.get(axis).copied().filter(|v| v.is_finite());
        Some([value(self.axes[0])?, value(self.axes[1])?])
    }

    /// Returns `true` if both axes are displacements: the picture then has one scale.
    pub fn has_one_scale(&self) -> bool {
        let unit = |axis| self.quantity(axis).map(|quantity| quantity.unit);
        unit(0) == Some("m") && unit(1) == Some("m")
    }

    /// Returns the lower left and upper right corner of the picture, around the origin and all points. Points that may
    /// leave it extend it by at most 35 % of the extent of the others, of the larger one where both axes have one scale.
    pub fn corners(&self) -> [[f64; 2]; 2] {
        const LEAVES: f64 = 0.35;
        /// Margin around the points, as a fraction of the picture.
        const SPACE: f64 = 0.05;
        let places = |may_leave: bool| {
            let own = self.series.iter().filter(move |series| series.may_leave == may_leave);
            own.flat_map(|series| &series.points).filter_map(|point| self.place(point)).map(Vector2::from)
        };
        let around = |[low, high]: [Vector2<f64>; 2], p: Vector2<f64>| [low.inf(&p), high.sup(&p)];
        let mut whole = places(false).fold([Vector2::zeros(); 2], around);
        if whole[0] == whole[1] {
            whole = places(true).fold(whole, around);
        } else {
            let ([low, high], extent) = (whole, whole[1] - whole[0]);
            // The longer axis decides a common scale, so the shorter one has room.
            let room = LEAVES * if self.has_one_scale() { Vector2::repeat(extent.max()) } else { extent };
            let clamped = places(true).map(|p| p.sup(&(low - room)).inf(&(high + room)));
            whole = clamped.fold(whole, around);
        }
        let space = SPACE * (whole[1] - whole[0]);
        let [mut low, mut high] = [whole[0] - space, whole[1] + space];
        // An axis of loads begins at the edge of the picture, without a margin.
        if self.axes[0] == 0 && whole[0].x == 0.0 {
            low.x = 0.0;
        }
        for i in 0..2 {
            if low[i] >= high[i] {
                (low[i], high[i]) = (low[i] - 0.5, high[i] + 0.5);
            }
        }
        [low.into(), high.into()]
    }

    /// Formats the series as CSV, a row per point, in the units of the headings.
    pub fn csv(&self) -> String {
        let heading = |FigureQuantity { name, unit }: &FigureQuantity| match *unit {
            "" => name.clone(),
            unit => format!("{name} ({unit})"),
        };
        // Adding 0 turns −0 into 0.
        let value = |v: &f64| if v.is_finite() { (v + 0.0).to_string() } else { String::new() };
        let row = |name: &str, fields: Vec<String>| {
            let fields = fields.iter().map(|field| csv_field(field));
            std::iter::once(csv_field(name)).chain(fields).collect::<Vec<_>>().join(",") + "\n"
        };
        let head = row("series", self.quantities.iter().map(heading).collect());
        let points = self.series.iter().flat_map(|series| series.points.iter().map(move |point| (series, point)));
        let rows = points.map(|(series, point)| row(&series.name, point.iter().map(value).collect()));
        std::iter::once(head).chain(rows).collect()
    }
}

/// Axis of a scene's loads, or of the time step of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadAxis {
    /// Name of the quantity.
    pub name: Sentence,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Value of the scene itself.
    pub full: f64,
}

impl LoadAxis {
    /// Returns the axis of the only load, or of the first of several with the same unit; otherwise that of the load
    /// factor.
    pub fn of(scene: &Scene) -> Self {
        if scene.analysis == Analysis::Dynamic {
            return Self { name: sentence!("time step"), unit: "s", full: scene.dynamics.time_step };
        }
        let pulling: Vec<_> = scene.loads.iter().map(kind).filter(|(.., size)| *size > 0.0).collect();
        match pulling[..] {
            [(name, unit, full)] => Self { name: name.into(), unit, full },
            [(name, unit, full), ref others @ ..] if others.iter().all(|(_, other, _)| *other == unit) => {
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
pub fn dominant_axis(displacements: impl Iterator<Item = Vector2<f64>>) -> usize {
    let [x, y] = displacements.fold([0.0_f64; 2], |[x, y], u| [x.max(u.x.abs()), y.max(u.y.abs())]);
    usize::from(y >= x)
}
