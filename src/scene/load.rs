//! Places on a mesh, and the loads put there.

use serde::{Deserialize, Serialize};

use super::error::Invalid;
use super::limits;

/// A whole edge or one point.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// A named edge: `left`, `right`, `bottom` or `top`.
    Edge(String),
    /// Rest coordinates, m.
    At([f64; 2]),
}

impl Place {
    /// The whole of a named edge.
    #[must_use]
    pub fn edge(name: &str) -> Self {
        Self::Edge(name.to_owned())
    }

    /// From the two keys of a table, of which exactly one is given.
    ///
    /// # Errors
    /// What was expected, otherwise.
    pub fn new(edge: Option<String>, at: Option<[f64; 2]>) -> Result<Self, String> {
        match (edge, at) {
            (Some(edge), None) => Ok(Self::Edge(edge)),
            (None, Some(at)) => Ok(Self::At(at)),
            (None, None) => Err("expected edge = \"…\" or at = [x, y], got neither".to_owned()),
            (Some(_), Some(_)) => Err("expected edge = \"…\" or at = [x, y], got both".to_owned()),
        }
    }

    pub(super) fn validate(&self, key: &str) -> Result<(), Invalid> {
        match self {
            Self::Edge(_) => Ok(()),
            Self::At(at) => at.iter().try_for_each(|&v| {
                limits::COORDINATE.check(v).map_err(|message| Invalid::new(format!("{key}.at"), message))
            }),
        }
    }
}

/// A load. Forces and gravity are dead: they keep their direction as the body turns; a moment turns with its edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LoadTable", into = "LoadTable")]
pub enum Load {
    /// A total force, N: over an edge as uniform traction, or on the nearest node.
    Force {
        /// Where it pulls.
        place: Place,
        /// Its components, N.
        force: [f64; 2],
    },
    /// A moment, N m, positive counter-clockwise, on a straight edge; it turns with the edge.
    Moment {
        /// The edge.
        edge: String,
        /// N m.
        moment: f64,
    },
    /// The weight of the body under this acceleration, m/s².
    Gravity {
        /// Its components, m/s².
        acceleration: [f64; 2],
    },
}

impl Load {
    pub(super) fn validate(&self, key: &str) -> Result<(), Invalid> {
        let magnitude = |key: String, limit: limits::Limit, v: &[f64; 2]| {
            limit.check(v[0].hypot(v[1])).map_err(|message| Invalid::new(key, message))
        };
        match self {
            Self::Force { place, force } => {
                place.validate(key)?;
                magnitude(format!("{key}.force"), limits::FORCE, force)
            }
            Self::Moment { moment, .. } => {
                limits::MOMENT.check(*moment).map_err(|message| Invalid::new(format!("{key}.moment"), message))
            }
            Self::Gravity { acceleration } => {
                magnitude(format!("{key}.acceleration"), limits::ACCELERATION, acceleration)
            }
        }
    }
}

/// The load as TOML writes it. Not `#[serde(tag)]`: that would lose the line of an error.
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
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum LoadKind {
    Force,
    Gravity,
    Moment,
}

impl TryFrom<LoadTable> for Load {
    type Error = String;

    fn try_from(table: LoadTable) -> Result<Self, String> {
        let LoadTable { kind, edge, at, force, acceleration, moment } = table;
        match (kind, force, acceleration, moment) {
            (LoadKind::Force, Some(force), None, None) => Ok(Self::Force { place: Place::new(edge, at)?, force }),
            (LoadKind::Force, ..) => {
                Err("a load of kind \"force\" has the keys edge or at, and force = [fx, fy] in N".to_owned())
            }
            (LoadKind::Gravity, None, Some(acceleration), None) if edge.is_none() && at.is_none() => {
                Ok(Self::Gravity { acceleration })
            }
            (LoadKind::Gravity, ..) => {
                Err("a load of kind \"gravity\" has the one key acceleration = [ax, ay] in m/s²".to_owned())
            }
            (LoadKind::Moment, None, None, Some(moment)) if at.is_none() => match edge {
                Some(edge) => Ok(Self::Moment { edge, moment }),
                None => Err("a load of kind \"moment\" has the keys edge and moment in N m, got no edge".to_owned()),
            },
            (LoadKind::Moment, ..) => Err("a load of kind \"moment\" has the keys edge, and moment in N m".to_owned()),
        }
    }
}

impl From<Load> for LoadTable {
    fn from(load: Load) -> Self {
        let empty = |kind| Self { kind, edge: None, at: None, force: None, acceleration: None, moment: None };
        match load {
            Load::Force { place, force } => {
                let (edge, at) = match place {
                    Place::Edge(edge) => (Some(edge), None),
                    Place::At(at) => (None, Some(at)),
                };
                Self { edge, at, force: Some(force), ..empty(LoadKind::Force) }
            }
            Load::Moment { edge, moment } => Self { edge: Some(edge), moment: Some(moment), ..empty(LoadKind::Moment) },
            Load::Gravity { acceleration } => Self { acceleration: Some(acceleration), ..empty(LoadKind::Gravity) },
        }
    }
}
