//! How far a result at rest is to be trusted beside its convergence: found once for a state.

use nalgebra::Vector2;

use crate::scene::Material;
use crate::simulation::{Deformation, Simulation};
use crate::stress::strain_warning;

/// What has been found of the last state that was asked about.
#[derive(Debug, Default)]
pub(super) struct Quality {
    of: Option<(Vec<Vector2<f64>>, Material)>,
    /// The mesh's own error in the energy norm, estimated, percent.
    pub mesh_error_percent: Option<f64>,
    /// The largest principal strain.
    pub max_strain: f64,
}

impl Quality {
    /// Finds it of the present state, unless that is the last one.
    pub(super) fn follow(&mut self, simulation: &Simulation) {
        let (u, material) = (simulation.displacement(), simulation.problem().material());
        if self.of.as_ref().is_some_and(|(known, of)| known == u && of == material) {
            return;
        }
        self.mesh_error_percent = simulation.mesh_error(&simulation.nodal_stress()).percent;
        self.max_strain = Deformation::of(simulation.problem(), simulation.state()).max_strain;
        self.of = Some((u.to_vec(), *material));
    }

    /// What is to be said of large strains.
    pub(super) fn warning(&self) -> Option<String> {
        strain_warning(self.max_strain)
    }
}
