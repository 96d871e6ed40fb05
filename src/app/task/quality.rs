//! Quality of an equilibrium other than its convergence, computed once per state.

use nalgebra::Vector2;

use crate::scene::Material;
use crate::sentence::Sentence;
use crate::simulation::{Deformation, Simulation, StressResult};
use crate::stress::{inversion_warning, strain_warning};

/// Quality of the last state that was evaluated.
#[derive(Clone, Debug, Default)]
pub(crate) struct Quality {
    of: Option<(Vec<Vector2<f64>>, Material)>,
    /// Estimated discretization error in the energy norm, percent.
    pub mesh_error_percent: Option<f64>,
    /// Largest principal strain that is recovered at a node.
    pub max_strain: f64,
    /// Largest von Mises stress (Cauchy) that is recovered at a node, Pa, and the node's position at rest, m.
    pub largest_stress: Option<(f64, Vector2<f64>)>,
    /// Reason why this stress depends on the mesh.
    pub singularity: Option<Sentence>,
    /// Number of elements that are turned inside out, and number of all elements.
    inside_out: [usize; 2],
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
        let stress = StressResult::of(simulation.problem(), &nodal, &error);
        self.mesh_error_percent = stress.mesh_error_percent;
        self.largest_stress = stress.largest.map(|largest| (largest.von_mises, largest.at));
        self.singularity = stress.singularity.as_ref().map(Sentence::from);
        let deformation = Deformation::of(simulation.problem(), simulation.state(), &nodal);
        self.max_strain = deformation.max_strain;
        self.inside_out = [deformation.inverted_elements, simulation.mesh().element_count()];
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
            return self.inside_out[0] > 0;
        }
        simulation.system().elements().smallest_area_ratio(simulation.displacement()) <= 0.0
    }

    /// Returns the warnings for inverted elements and for large strains.
    pub(crate) fn warnings(&self) -> impl Iterator<Item = Sentence> {
        let [inverted, all] = self.inside_out;
        inversion_warning(inverted, all).into_iter().chain(strain_warning(self.max_strain))
    }
}
