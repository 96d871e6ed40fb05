//! Probes of a scene on the nodes of its mesh.

use nalgebra::Vector2;

use super::edge::weighted_sum;
use super::{NodeWeights, System};
use crate::scene::{Invalid, Place, Probe};

/// Probe as weights on nodes; the weights sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalProbe {
    /// Name in results.
    pub name: String,
    /// Place in the scene.
    pub place: Place,
    /// Nodes and weights.
    pub weights: NodeWeights,
}

impl NodalProbe {
    /// Returns the probes of a scene.
    pub(super) fn of(probes: &[Probe], system: &System) -> Result<Vec<Self>, Invalid> {
        probes.iter().enumerate().map(|(i, probe)| Self::new(probe, system, &format!("probe.{i}"))).collect()
    }

    fn new(probe: &Probe, system: &System, key: &str) -> Result<Self, Invalid> {
        let weights = match &probe.place {
            Place::Edge(name) => system.edge(name, key)?.1.weights.to_vec(),
            Place::At(at) => system.mesh().weights_at((*at).into()).ok_or_else(|| {
                Invalid::new(format!("{key}.at"), format!("expected a point of the body, got {at:?} outside it"))
            })?,
        };
        Ok(Self { name: probe.name.clone(), place: probe.place.clone(), weights })
    }

    /// Returns the weighted mean of a nodal field.
    pub fn mean(&self, field: &[Vector2<f64>]) -> Vector2<f64> {
        weighted_sum(field, &self.weights)
    }
}
