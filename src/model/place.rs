//! Places on a body, and what is put there: supports, loads, probes.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::dynamics::Pulse;
use super::error::Invalid;
use super::{is_zero, limits};
use crate::words::number;

/// A whole edge or one point.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// A named edge: `left`, `right`, `bottom`, `top`, or one of a mesh file.
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

/// Why a table of a scene is none of a support, a load or a probe.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum TableError {
    /// No place.
    #[error("expected edge = \"…\" or at = [x, y], got neither")]
    NoPlace,
    /// Two places.
    #[error("expected edge = \"…\" or at = [x, y], got both")]
    TwoPlaces,
    /// Other keys than a force has.
    #[error("a load of kind \"force\" has the keys edge or at, and force = [fx, fy] in N")]
    Force,
    /// Other keys than gravity has.
    #[error("a load of kind \"gravity\" has the one key acceleration = [ax, ay] in m/s²")]
    Gravity,
    /// Other keys than a moment has.
    #[error("a load of kind \"moment\" has the keys edge, and moment in N m")]
    Moment,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Edge(edge) => f.write_str(edge),
            Self::At([x, y]) => write!(f, "({}, {})", number(*x), number(*y)),
        }
    }
}

impl Place {
    /// From the two keys of a table, of which exactly one is given.
    fn new(edge: Option<String>, at: Option<[f64; 2]>) -> Result<Self, TableError> {
        match (edge, at) {
            (Some(edge), None) => Ok(Self::Edge(edge)),
            (None, Some(at)) => Ok(Self::At(at)),
            (None, None) => Err(TableError::NoPlace),
            (Some(_), Some(_)) => Err(TableError::TwoPlaces),
        }
    }

    /// The two keys of a table.
    fn keys(self) -> (Option<String>, Option<[f64; 2]>) {
        match self {
            Self::Edge(edge) => (Some(edge), None),
            Self::At(at) => (None, Some(at)),
        }
    }

    pub(super) fn validate(&self, key: &str) -> Result<(), Invalid> {
        match self {
            Self::Edge(_) => Ok(()),
            Self::At(at) => at.iter().try_for_each(|&v| {
                limits::COORDINATE.check(v).map_err(|e| Invalid::new(format!("{key}.at"), e.to_string()))
            }),
        }
    }
}

/// Nodes that stay where they are, or are taken somewhere else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "SupportTable", into = "SupportTable")]
#[non_exhaustive]
pub struct Support {
    /// An edge, whose nodes are all fixed, or a point, whose nearest node is.
    pub place: Place,
    /// The directions in which they are fixed.
    pub fix: Vec<Axis>,
    /// Where the place is taken, m, in the directions in which it is fixed; put on in load steps, with the loads.
    pub displacement: [f64; 2],
    /// How far an edge is turned about its middle, rad, counter-clockwise, full turns included; put on in load steps.
    pub turn: f64,
}

impl Support {
    /// Fixed here in these directions, where it is.
    #[must_use]
    pub fn new(place: impl Into<Place>, fix: &[Axis]) -> Self {
        Self { place: place.into(), fix: fix.to_vec(), displacement: [0.0; 2], turn: 0.0 }
    }

    /// Whether it takes its place somewhere else.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.displacement != [0.0; 2] || self.turn != 0.0
    }

    /// Whether both fix the same unknowns, wherever they take them.
    pub(crate) fn fixes_as(&self, other: &Self) -> bool {
        (&self.place, &self.fix) == (&other.place, &other.fix)
    }

    pub(super) fn validate(&self, key: &str) -> Result<(), Invalid> {
        self.place.validate(key)?;
        if self.fix.is_empty() {
            return Err(Invalid::new(format!("{key}.fix"), "expected \"x\", \"y\" or both, got none"));
        }
        let refuse = |name: &str, message: String| Err(Invalid::new(format!("{key}.{name}"), message));
        for (axis, word, value) in [(Axis::X, "x", self.displacement[0]), (Axis::Y, "y", self.displacement[1])] {
            limits::COORDINATE.check(value).or_else(|e| refuse("displacement", e.to_string()))?;
            if value != 0.0 && !self.fix.contains(&axis) {
                let message =
                    format!("expected 0 along {word}, which this support does not fix, got {}", number(value));
                return refuse("displacement", message);
            }
        }
        limits::TURN.check(self.turn).or_else(|e| refuse("turn", e.to_string()))?;
        if self.turn != 0.0 && !matches!(self.place, Place::Edge(_)) {
            return refuse(
                "turn",
                "expected edge = \"…\" beside it: a single node has no direction to turn".to_owned(),
            );
        }
        if self.turn != 0.0 && !(self.fix.contains(&Axis::X) && self.fix.contains(&Axis::Y)) {
            return refuse("turn", "expected fix = [\"x\", \"y\"] beside it: a turn moves nodes both ways".to_owned());
        }
        Ok(())
    }
}

/// A direction of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// Along the rest beam.
    X,
    /// Across it.
    Y,
}

/// A displacement to report: the mean over an edge, or of a material point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ProbeTable", into = "ProbeTable")]
#[non_exhaustive]
pub struct Probe {
    /// What it is called in results.
    pub name: String,
    /// The edge it averages over, or the material point it follows.
    pub place: Place,
}

/// A load. Forces and gravity are dead: they keep their direction as the body turns; a moment turns with its edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LoadTable", into = "LoadTable")]
#[non_exhaustive]
pub enum Load {
    /// A total force, N: over an edge as uniform traction, or on the nearest node.
    Force {
        /// Where it pulls.
        place: Place,
        /// Its components, N.
        force: [f64; 2],
        /// When it pulls; always where there is none.
        pulse: Option<Pulse>,
    },
    /// A moment, N m, positive counter-clockwise, on a straight edge; it turns with the edge.
    Moment {
        /// The edge.
        edge: String,
        /// N m.
        moment: f64,
        /// When it turns; always where there is none.
        pulse: Option<Pulse>,
    },
    /// The weight of the body under this acceleration, m/s².
    Gravity {
        /// Its components, m/s².
        acceleration: [f64; 2],
        /// When it acts; always where there is none.
        pulse: Option<Pulse>,
    },
}

impl Load {
    /// A dead force, N, at a place.
    #[must_use]
    pub fn force(place: impl Into<Place>, force: [f64; 2]) -> Self {
        Self::Force { place: place.into(), force, pulse: None }
    }

    /// A moment, N m, on an edge.
    #[must_use]
    pub fn moment(edge: &str, moment: f64) -> Self {
        Self::Moment { edge: edge.to_owned(), moment, pulse: None }
    }

    /// The weight of the body under an acceleration, m/s².
    #[must_use]
    pub fn gravity(acceleration: [f64; 2]) -> Self {
        Self::Gravity { acceleration, pulse: None }
    }

    /// When it acts; always where there is none.
    #[must_use]
    pub fn pulse(&self) -> Option<Pulse> {
        match self {
            Self::Force { pulse, .. } | Self::Moment { pulse, .. } | Self::Gravity { pulse, .. } => *pulse,
        }
    }

    /// Whether it is a moment.
    #[must_use]
    pub fn is_moment(&self) -> bool {
        matches!(self, Self::Moment { .. })
    }

    pub(super) fn validate(&self, key: &str) -> Result<(), Invalid> {
        if let Some(pulse) = self.pulse() {
            pulse.validate(key)?;
        }
        let check = |name: &str, limit: limits::Limit, value: f64| {
            limit.check(value).map_err(|e| Invalid::new(format!("{key}.{name}"), e.to_string()))
        };
        match self {
            Self::Force { place, force, .. } => {
                place.validate(key)?;
                check("force", limits::FORCE, force[0].hypot(force[1]))
            }
            Self::Moment { moment, .. } => check("moment", limits::MOMENT, *moment),
            Self::Gravity { acceleration, .. } => {
                check("acceleration", limits::ACCELERATION, acceleration[0].hypot(acceleration[1]))
            }
        }
    }
}

// The tables as TOML writes them. Not `#[serde(tag)]` or `#[serde(flatten)]`: these would lose the line of an error.

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SupportTable {
    #[serde(skip_serializing_if = "Option::is_none", default)]
    edge: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    at: Option<[f64; 2]>,
    fix: Vec<Axis>,
    #[serde(skip_serializing_if = "is_zero", default)]
    displacement: [f64; 2],
    #[serde(skip_serializing_if = "is_zero", default)]
    turn: f64,
}

impl TryFrom<SupportTable> for Support {
    type Error = TableError;

    fn try_from(SupportTable { edge, at, fix, displacement, turn }: SupportTable) -> Result<Self, TableError> {
        Ok(Self { place: Place::new(edge, at)?, fix, displacement, turn })
    }
}

impl From<Support> for SupportTable {
    fn from(support: Support) -> Self {
        let (edge, at) = support.place.keys();
        Self { edge, at, fix: support.fix, displacement: support.displacement, turn: support.turn }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProbeTable {
    name: String,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    edge: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    at: Option<[f64; 2]>,
}

impl TryFrom<ProbeTable> for Probe {
    type Error = TableError;

    fn try_from(ProbeTable { name, edge, at }: ProbeTable) -> Result<Self, TableError> {
        Ok(Self { name, place: Place::new(edge, at)? })
    }
}

impl From<Probe> for ProbeTable {
    fn from(probe: Probe) -> Self {
        let (edge, at) = probe.place.keys();
        Self { name: probe.name, edge, at }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LoadTable {
    kind: LoadKind,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    edge: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    at: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    force: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    acceleration: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    moment: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pulse: Option<Pulse>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum LoadKind {
    Force,
    Gravity,
    Moment,
}

impl TryFrom<LoadTable> for Load {
    type Error = TableError;

    fn try_from(table: LoadTable) -> Result<Self, TableError> {
        let LoadTable { kind, edge, at, force, acceleration, moment, pulse } = table;
        match (kind, force, acceleration, moment) {
            (LoadKind::Force, Some(force), None, None) => {
                Ok(Self::Force { place: Place::new(edge, at)?, force, pulse })
            }
            (LoadKind::Force, ..) => Err(TableError::Force),
            (LoadKind::Gravity, None, Some(acceleration), None) if edge.is_none() && at.is_none() => {
                Ok(Self::Gravity { acceleration, pulse })
            }
            (LoadKind::Gravity, ..) => Err(TableError::Gravity),
            (LoadKind::Moment, None, None, Some(moment)) if at.is_none() => {
                Ok(Self::Moment { edge: edge.ok_or(TableError::Moment)?, moment, pulse })
            }
            (LoadKind::Moment, ..) => Err(TableError::Moment),
        }
    }
}

impl From<Load> for LoadTable {
    fn from(load: Load) -> Self {
        let pulse = load.pulse();
        let empty = |kind| Self { kind, edge: None, at: None, force: None, acceleration: None, moment: None, pulse };
        match load {
            Load::Force { place, force, .. } => {
                let (edge, at) = place.keys();
                Self { edge, at, force: Some(force), ..empty(LoadKind::Force) }
            }
            Load::Moment { edge, moment, .. } => {
                Self { edge: Some(edge), moment: Some(moment), ..empty(LoadKind::Moment) }
            }
            Load::Gravity { acceleration, .. } => Self { acceleration: Some(acceleration), ..empty(LoadKind::Gravity) },
        }
    }
}
