//! Quality of an equilibrium other than its convergence, computed once per state.

use crate::app::prelude::*;
use crate::scene::Material;
use crate::simulation::{Deformation, StressResult};
use crate::stress::{inversion_warning, strain_warning};

/// Quality of the last state that was evaluated.
#[derive(Clone, Debug, Default)]
pub(crate) struct Quality {
    of: Option<(Vec<Vector2<f64>>, Material)>,
    pub stress: StressResult,
    pub deformation: Deformation,
    /// Number of elements.
    elements: usize,
}

impl Quality {
    /// Certifies the result of a simulation, and computes its quality.
    pub(crate) fn certified(simulation: &mut Simulation) -> Self {
        let mut quality = Self::default();
        simulation.certify();
        quality.update(simulation);
        quality
    }

    /// Computes the quality of the current state, unless it is already known.
    pub(crate) fn update(&mut self, simulation: &Simulation) {
        if self.is_of(simulation) {
            return;
        }
        let nodal = simulation.nodal_stress();
        let error = simulation.mesh_error(&nodal);
        self.stress = StressResult::of(simulation.problem(), &nodal, &error);
        self.deformation = Deformation::of(simulation.problem(), simulation.state(), &nodal);
        self.elements = simulation.mesh().element_count();
        self.of = Some((simulation.displacement().to_vec(), *simulation.problem().material()));
    }

    /// Returns `true` if the quality is that of the simulation's state.
    pub(crate) fn is_of(&self, simulation: &Simulation) -> bool {
        let (u, material) = (simulation.displacement(), simulation.problem().material());
        self.of.as_ref().is_some_and(|(known, of)| known == u && of == material)
    }

    /// Returns `true` if an element is turned inside out, which no real body can be. For a state that has not been
    /// evaluated it is computed here.
    pub(crate) fn is_inside_out(&self, simulation: &Simulation) -> bool {
        if self.is_of(simulation) {
            return self.deformation.inverted_elements > 0;
        }
        simulation.system().elements().smallest_area_ratio(simulation.displacement()) <= 0.0
    }

    /// Returns the warnings for inverted elements and for large strains.
    pub(crate) fn warnings(&self) -> impl Iterator<Item = Sentence> {
        let Deformation { inverted_elements, max_strain, .. } = self.deformation;
        inversion_warning(inverted_elements, self.elements).into_iter().chain(strain_warning(max_strain))
    }
}
