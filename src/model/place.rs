//! Places on a body; supports, loads and probes at them.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::dynamics::Pulse;
use super::error::Invalid;
use super::{is_default, refuse_if};
use crate::format::{number, six_digits};

/// Whole edge or single point.
///
/// ```
/// use warpbeam::{Place, Probe, Scene};
///
/// let scene = Scene::beam(10.0, 1.0).probe("tip", "right").probe("middle", [5.0, 0.0]);
/// let Probe { name, place, .. } = &scene.probes[0];
/// assert_eq!((name.as_str(), place), ("tip", &Place::Edge("right".to_owned())));
/// assert_eq!(scene.probes[1].place, Place::At([5.0, 0.0]));
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Place {
    /// Named edge: `left`, `right`, `bottom`, `top`, or a name of the mesh file.
    Edge(String),
    /// Rest coordinates, m.
    At([f64; 2]),
}

impl From<&str> for Place {
    fn from(edge: &str) -> Self {
        Self::Edge(edge.to_owned())
    }
}

impl From<[f64; 2]> for Place {
    fn from(at: [f64; 2]) -> Self {
        Self::At(at)
    }
}

impl From<Vector2<f64>> for Place {
    fn from(at: Vector2<f64>) -> Self {
        Self::At(at.into())
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Edge(edge) => f.write_str(edge),
            Self::At(at) => {
                let [x, y] = at.map(|v| number(six_digits(v)));
                write!(f, "({x}, {y})")
            }
        }
    }
}

impl Place {
    /// Makes a place from the two keys of a table, of which exactly one must be given.
    fn new(edge: Option<String>, at: Option<[f64; 2]>) -> Result<Self, &'static str> {
        match (edge, at) {
            (Some(edge), None) => Ok(Self::Edge(edge)),
            (None, Some(at)) => Ok(Self::At(at)),
            (None, None) => Err("expected edge = \"…\" or at = [x, y], got neither"),
            (Some(_), Some(_)) => Err("expected edge = \"…\" or at = [x, y], got both"),
        }
    }

    /// Returns the values of the two keys of a table.
    fn keys(self) -> (Option<String>, Option<[f64; 2]>) {
        match self {
            Self::Edge(edge) => (Some(edge), None),
            Self::At(at) => (None, Some(at)),
        }
    }
}

/// Support: nodes or a point that are fixed, or moved along a prescribed displacement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "SupportTable", into = "SupportTable")]
#[non_exhaustive]
pub struct Support {
    /// Edge with all its nodes, or point.
    pub place: Place,
    /// `true` for a support of its point itself, which lies in an element: the displacement there is prescribed, through
    /// the shape functions. `false` for one of the node nearest to the point. Without meaning on an edge, and outside the
    /// body, where the nearest node is used.
    pub at_point: bool,
    /// Length around the point, m, over which the mean displacement is prescribed: of the body's outline, or of the
    /// horizontal line through an inner point; 0 for the point itself. Needs `at_point`.
    pub width: f64,
    /// Fixed directions.
    pub fix: Vec<Axis>,
    /// Prescribed displacement, m, in the fixed directions; applied in load steps, with the loads.
    pub displacement: [f64; 2],
    /// Prescribed rotation of an edge about its middle, rad, counter-clockwise, full turns included; applied in load
    /// steps.
    pub turn: f64,
}

impl Support {
    /// Returns a support of an edge, or of the node nearest to a point, without prescribed displacement.
    pub fn new(place: impl Into<Place>, fix: &[Axis]) -> Self {
        Self { place: place.into(), at_point: false, width: 0.0, fix: fix.to_vec(), displacement: [0.0; 2], turn: 0.0 }
    }

    /// Returns a support of a point of the body, m, and not of its nearest node.
    pub fn point(at: impl Into<Vector2<f64>>, fix: &[Axis]) -> Self {
        Self { at_point: true, ..Self::new(at.into(), fix) }
    }

    /// Returns `true` if a displacement or rotation is prescribed.
    pub fn moves(&self) -> bool {
        self.displacement != [0.0; 2] || self.turn != 0.0
    }

    /// Returns `true` if both fix the same unknowns, whatever displacements they prescribe.
    pub(crate) fn fixes_as(&self, other: &Self) -> bool {
        (&self.place, self.at_point, self.width, &self.fix) == (&other.place, other.at_point, other.width, &other.fix)
    }

    pub(super) fn validate(&self, key: &str) -> Result<(), Invalid> {
        refuse_if(self.fix.is_empty(), format!("{key}.fix"), "expected \"x\", \"y\" or both, got none")?;
        let [x, y] = [Axis::X, Axis::Y].map(|axis| self.fix.contains(&axis));
        for (word, fixed, value) in [("x", x, self.displacement[0]), ("y", y, self.displacement[1])] {
            let message = format!("expected 0 along {word}, which this support does not fix, got {}", number(value));
            refuse_if(value != 0.0 && !fixed, format!("{key}.displacement"), message)?;
        }
        let (turns, key) = (self.turn != 0.0, format!("{key}.turn"));
        let message = "expected edge = \"…\" for this support: a single node cannot be rotated";
        refuse_if(turns && !matches!(self.place, Place::Edge(_)), key.as_str(), message)?;
        let message = "expected fix = [\"x\", \"y\"] for this support: a rotation moves nodes along both axes";
        refuse_if(turns && !(x && y), key, message)
    }
}

/// Direction of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// x: horizontal, along a beam at rest.
    X,
    /// y: vertical, across a beam at rest.
    Y,
}

/// Displacement to report: the mean over an edge, or of a material point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ProbeTable", into = "ProbeTable")]
#[non_exhaustive]
pub struct Probe {
    /// Name in results.
    pub name: String,
    /// Edge that is averaged over, or material point.
    pub place: Place,
}

/// Straight line through a body at rest, along which it is cut.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionLine {
    /// Rest position of a point of the line, m.
    pub at: Vector2<f64>,
    /// Direction of the line's normal, rad, counter-clockwise from the x axis. The normal points to the part of the
    /// body in front of the line.
    #[serde(skip_serializing_if = "is_default", default)]
    pub angle: f64,
}

impl SectionLine {
    /// Returns the unit normal at rest.
    pub fn normal(&self) -> Vector2<f64> {
        Vector2::new(self.angle.cos(), self.angle.sin())
    }

    /// Returns the unit tangent at rest: the normal, rotated counter-clockwise by 90°.
    pub(crate) fn tangent(&self) -> Vector2<f64> {
        Vector2::new(-self.angle.sin(), self.angle.cos())
    }
}

/// Load. Forces and gravity are dead loads: they keep their direction as the body rotates; a moment rotates with its
/// edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LoadTable", into = "LoadTable")]
#[non_exhaustive]
pub enum Load {
    /// Total force, N: uniform traction over an edge, or force at a point.
    Force {
        /// Edge or point.
        place: Place,
        /// `true` for a force at its point itself: it acts on the nodes of the element there in proportion to their shape
        /// functions, so that force and moment are those of the point. `false` for one on the node nearest to the
        /// point. Without meaning on an edge, and outside the body, where the nearest node is used.
        at_point: bool,
        /// Length around the point, m, over which the force is uniform: of the body's outline, or of the horizontal line
        /// through an inner point; 0 for the point itself. Needs `at_point`.
        width: f64,
        /// Components, N.
        force: [f64; 2],
        /// Time dependence; `None` for a constant load.
        pulse: Option<Pulse>,
    },
    /// Moment on a straight edge, positive counter-clockwise; it rotates with the edge.
    Moment {
        /// Edge.
        edge: String,
        /// Moment, N m.
        moment: f64,
        /// Time dependence; `None` for a constant load.
        pulse: Option<Pulse>,
    },
    /// Weight of the body.
    Gravity {
        /// Components of the acceleration, m/s².
        acceleration: [f64; 2],
        /// Time dependence; `None` for a constant load.
        pulse: Option<Pulse>,
    },
}

impl Load {
    /// Returns a dead force, N, on an edge or on the node nearest to a point.
    pub fn force(place: impl Into<Place>, force: impl Into<Vector2<f64>>) -> Self {
        Self::Force { place: place.into(), at_point: false, width: 0.0, force: force.into().into(), pulse: None }
    }

    /// Returns a dead force, N, at a point of the body, m, and not on its nearest node.
    pub fn point_force(at: impl Into<Vector2<f64>>, force: impl Into<Vector2<f64>>) -> Self {
        Self::Force { place: at.into().into(), at_point: true, width: 0.0, force: force.into().into(), pulse: None }
    }

    /// Returns a moment, N m, on an edge.
    pub fn moment(edge: &str, moment: f64) -> Self {
        Self::Moment { edge: edge.to_owned(), moment, pulse: None }
    }

    /// Returns the weight of the body under an acceleration, m/s².
    pub fn gravity(acceleration: impl Into<Vector2<f64>>) -> Self {
        Self::Gravity { acceleration: acceleration.into().into(), pulse: None }
    }

    /// Returns the load's pulse; `None` for a constant load.
    pub fn pulse(&self) -> Option<Pulse> {
        match self {
            Self::Force { pulse, .. } | Self::Moment { pulse, .. } | Self::Gravity { pulse, .. } => *pulse,
        }
    }

    /// Returns `true` for a moment.
    pub fn is_moment(&self) -> bool {
        matches!(self, Self::Moment { .. })
    }
}

// Tables as written in TOML. `#[serde(tag)]` and `#[serde(flatten)]` are not used, because they lose the line of an
// error.

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SupportTable {
    edge: Option<String>,
    at: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "is_default")]
    acts_on: ActsOn,
    #[serde(skip_serializing_if = "is_default")]
    width: f64,
    fix: Vec<Axis>,
    #[serde(skip_serializing_if = "is_default")]
    displacement: [f64; 2],
    #[serde(skip_serializing_if = "is_default")]
    turn: f64,
}

impl TryFrom<SupportTable> for Support {
    type Error = &'static str;

    fn try_from(table: SupportTable) -> Result<Self, Self::Error> {
        let SupportTable { edge, at, acts_on, width, fix, displacement, turn } = table;
        let (place, at_point) = acts_on.place(edge, at, width)?;
        Ok(Self { place, at_point, width, fix, displacement, turn })
    }
}

impl From<Support> for SupportTable {
    fn from(support: Support) -> Self {
        let Support { place, at_point, width, fix, displacement, turn } = support;
        let (edge, at) = place.keys();
        let (acts_on, width) = ActsOn::of(at_point, width, at);
        Self { acts_on, width, edge, at, fix, displacement, turn }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProbeTable {
    name: String,
    edge: Option<String>,
    at: Option<[f64; 2]>,
}

impl TryFrom<ProbeTable> for Probe {
    type Error = &'static str;

    fn try_from(ProbeTable { name, edge, at }: ProbeTable) -> Result<Self, Self::Error> {
        Ok(Self { name, place: Place::new(edge, at)? })
    }
}

impl From<Probe> for ProbeTable {
    fn from(probe: Probe) -> Self {
        let (edge, at) = probe.place.keys();
        Self { name: probe.name, edge, at }
    }
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct LoadTable {
    kind: LoadKind,
    edge: Option<String>,
    at: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "is_default")]
    acts_on: ActsOn,
    #[serde(skip_serializing_if = "is_default")]
    width: f64,
    force: Option<[f64; 2]>,
    acceleration: Option<[f64; 2]>,
    moment: Option<f64>,
    pulse: Option<Pulse>,
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum LoadKind {
    #[default]
    Force,
    Gravity,
    Moment,
}

/// Nodes on which a force or support at a point acts: the nearest one, or those of the element there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ActsOn {
    #[default]
    Node,
    Point,
}

impl ActsOn {
    /// Returns the keys of a place at `at`; without meaning on an edge. A width says that the point is meant.
    fn of(at_point: bool, width: f64, at: Option<[f64; 2]>) -> (Self, f64) {
        match at {
            Some(_) if at_point && width == 0.0 => (Self::Point, 0.0),
            Some(_) if at_point => (Self::Node, width),
            _ => (Self::Node, 0.0),
        }
    }

    /// Makes a place from the other keys, with `true` if its point is meant and not the nearest node.
    fn place(self, edge: Option<String>, at: Option<[f64; 2]>, width: f64) -> Result<(Place, bool), &'static str> {
        match (Place::new(edge, at)?, self == Self::Point || width != 0.0) {
            (Place::Edge(_), true) => Err("expected at = [x, y] with acts_on = \"point\" or a width, got an edge"),
            placed => Ok(placed),
        }
    }
}

impl TryFrom<LoadTable> for Load {
    type Error = &'static str;

    fn try_from(table: LoadTable) -> Result<Self, Self::Error> {
        let LoadTable { kind, edge, at, acts_on, width, force, acceleration, moment, pulse } = table;
        let is_whole = at.is_none() && acts_on == ActsOn::Node && width == 0.0;
        match (kind, force, acceleration, moment, edge) {
            (LoadKind::Force, Some(force), None, None, edge) => {
                let (place, at_point) = acts_on.place(edge, at, width)?;
                Ok(Self::Force { place, at_point, width, force, pulse })
            }
            (LoadKind::Gravity, None, Some(acceleration), None, None) if is_whole => {
                Ok(Self::Gravity { acceleration, pulse })
            }
            (LoadKind::Moment, None, None, Some(moment), Some(edge)) if is_whole => {
                Ok(Self::Moment { edge, moment, pulse })
            }
            (LoadKind::Force, ..) => {
                Err("expected edge or at, and force = [fx, fy] in N, for a load of kind \"force\"")
            }
            (LoadKind::Gravity, ..) => {
                Err("expected only acceleration = [ax, ay] in m/s² for a load of kind \"gravity\"")
            }
            (LoadKind::Moment, ..) => Err("expected edge, and moment in N m, for a load of kind \"moment\""),
        }
    }
}

impl From<Load> for LoadTable {
    fn from(load: Load) -> Self {
        let table = Self { pulse: load.pulse(), ..Self::default() };
        match load {
            Load::Force { place, at_point, width, force, .. } => {
                let (edge, at) = place.keys();
                let (acts_on, width) = ActsOn::of(at_point, width, at);
                Self { edge, at, acts_on, width, force: Some(force), ..table }
            }
            Load::Moment { edge, moment, .. } => {
                Self { kind: LoadKind::Moment, edge: Some(edge), moment: Some(moment), ..table }
            }
            Load::Gravity { acceleration, .. } => {
                Self { kind: LoadKind::Gravity, acceleration: Some(acceleration), ..table }
            }
        }
    }
}
