//! How far a result at rest is to be trusted beside its convergence: found once for a state.

use nalgebra::Vector2;

use crate::scene::Material;
use crate::simulation::{Deformation, Simulation};
use crate::stress::strain_warning;

/// What has been found of the last state that was asked about.
#[derive(Debug, Default)]
pub(crate) struct Quality {
    of: Option<(Vec<Vector2<f64>>, Material)>,
    /// The mesh's own error in the energy norm, estimated, percent.
    pub mesh_error_percent: Option<f64>,
    /// The largest principal strain.
    pub max_strain: f64,
    /// Whether an element is turned inside out.
    is_inside_out: bool,
}

impl Quality {
    /// Finds it of the present state, unless that is the last one.
    pub(crate) fn follow(&mut self, simulation: &Simulation) {
        if self.is_of(simulation) {
            return;
        }
        self.mesh_error_percent = simulation.mesh_error(&simulation.nodal_stress()).percent;
        let deformation = Deformation::of(simulation.problem(), simulation.state());
        (self.max_strain, self.is_inside_out) = (deformation.max_strain, deformation.inverted_elements > 0);
        self.of = Some((simulation.displacement().to_vec(), *simulation.problem().material()));
    }

    fn is_of(&self, simulation: &Simulation) -> bool {
        let (u, material) = (simulation.displacement(), simulation.problem().material());
        self.of.as_ref().is_some_and(|(known, of)| known == u && of == material)
    }

    /// Whether an element is turned inside out, somewhere: no body does that. Of a state that is not known it is found.
    pub(crate) fn is_inside_out(&self, simulation: &Simulation) -> bool {
        if self.is_of(simulation) {
            return self.is_inside_out;
        }
        simulation.system().elements().smallest_area_ratio(simulation.displacement()) <= 0.0
    }

    /// What is to be said of large strains.
    pub(crate) fn warning(&self) -> Option<String> {
        strain_warning(self.max_strain)
    }
}
