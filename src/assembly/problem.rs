//! System with its material, loads and probes.

use std::sync::Arc;

use nalgebra::Vector2;

use super::{Kinematics, Loads, Matrix, MouseSpring, NodalProbe, SimulationError, Supports, System};
use crate::element::{ElementLoops, MatrixSum, Sums, Tangent, UNIT};
use crate::material::Lame;
use crate::scene::{Load, Material, Pulse, Scene};
use crate::state::State;

/// Discrete problem of a scene.
#[derive(Clone, Debug)]
pub struct Problem {
    system: Arc<System>,
    material: Material,
    /// Loads as in the scene.
    pub(crate) scene_loads: Vec<Load>,
    loads: Loads,
    supports: Supports,
    probes: Vec<NodalProbe>,
    pub(crate) mouse_spring: Option<MouseSpring>,
}

/// Extent of a change of the scene; each variant includes the ones before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// At most loads, probes and prescribed displacements; the internal forces of a state are unchanged.
    Loads,
    /// The stiffness too; states remain valid.
    Stiffness,
    /// The free unknowns or their couplings too.
    Unknowns,
    /// The mesh too.
    Mesh,
}

/// Nodal forces of a state, N.
#[derive(Clone, Debug)]
pub struct Forces {
    /// f_int, internal force of the elements.
    pub internal: Vec<Vector2<f64>>,
    /// Σ|fₑ|, sum of the elements' absolute forces, by component.
    pub magnitude: Vec<Vector2<f64>>,
    /// f_ext, external force of the loads.
    pub external: Vec<Vector2<f64>>,
    /// Residual force f_ext − f_int; on fixed unknowns it is minus the reaction.
    pub(crate) residual: Vec<Vector2<f64>>,
    /// The relative residual and the bound of its rounding error, if supports move the body and the residual is within
    /// that bound; [`Problem::balance`] then returns 0.
    pub(crate) below_rounding: Option<[f64; 2]>,
    /// Relative residual of the last [`Problem::balance`].
    pub(crate) relative_residual: f64,
}

impl Forces {
    /// Allocates the forces of `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        let zero = vec![Vector2::zeros(); nodes];
        Self {
            internal: zero.clone(),
            magnitude: zero.clone(),
            external: zero.clone(),
            residual: zero,
            below_rounding: None,
            relative_residual: 0.0,
        }
    }

    /// Returns f_ext − f_int of every node, N.
    pub fn residual(&self) -> &[Vector2<f64>] {
        &self.residual
    }
}

impl Problem {
    /// Returns the problem of a scene on a system.
    ///
    /// # Errors
    /// The invalid key and the expected value.
    pub fn new(scene: &Scene, system: Arc<System>) -> Result<Self, SimulationError> {
        let system = system.adapt(scene, None)?;
        Ok(Self {
            material: scene.material,
            scene_loads: scene.loads.clone(),
            loads: Loads::new(&scene.loads, &scene.material, &system)?,
            supports: Supports::new(&scene.supports, &scene.material, &system)?,
            probes: NodalProbe::of(&scene.probes, &system)?,
            system,
            mouse_spring: None,
        })
    }

    /// Changes from the scene `before` to another one, checking and recomputing only what differs. A mouse spring stays
    /// attached if the mesh is the same.
    ///
    /// # Errors
    /// Same errors as [`Self::new`]; the problem is then unchanged.
    pub fn update(&mut self, before: &Scene, scene: &Scene) -> Result<Change, SimulationError> {
        let system = self.system.adapt(scene, Some(before))?;
        let same_mesh = system.shares_mesh(&self.system);
        let same_system = Arc::ptr_eq(&system, &self.system);
        let same_probes =
            self.probes.iter().map(|p| (&p.name, &p.place)).eq(scene.probes.iter().map(|p| (&p.name, &p.place)));
        let probes = if same_mesh && same_probes { None } else { Some(NodalProbe::of(&scene.probes, &system)?) };
        let same_weight = self.material.area_density() == scene.material.area_density();
        let loads = if same_system && same_weight && self.scene_loads == scene.loads {
            None
        } else {
            Some(Loads::new(&scene.loads, &scene.material, &system)?)
        };
        let supports = if same_system && before.supports == scene.supports {
            None
        } else {
            Some(Supports::new(&scene.supports, &scene.material, &system)?)
        };
        let change = if !same_mesh {
            Change::Mesh
        } else if !same_system {
            Change::Unknowns
        } else if scene.material.membrane() != self.material.membrane() {
            Change::Stiffness
        } else {
            Change::Loads
        };
        if let Some(probes) = probes {
            self.probes = probes;
        }
        if let Some(loads) = loads {
            self.scene_loads.clone_from(&scene.loads);
            self.loads = loads;
        }
        if let Some(supports) = supports {
            self.supports = supports;
        } else if change == Change::Stiffness {
            self.supports.set_stiffness(&scene.material, &system);
        }
        self.mouse_spring = match change {
            Change::Mesh => None,
            Change::Unknowns => self.mouse_spring.as_ref().map(|spring| spring.adapt(&system)),
            Change::Stiffness | Change::Loads => self.mouse_spring.take(),
        };
        self.system = system;
        self.material = scene.material;
        Ok(change)
    }

    /// Returns the system.
    pub fn system(&self) -> &Arc<System> {
        &self.system
    }

    /// Returns the material of the whole body.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Returns the nodal loads.
    pub fn loads(&self) -> &Loads {
        &self.loads
    }

    /// Returns the supports, with their prescribed displacements.
    pub fn supports(&self) -> &Supports {
        &self.supports
    }

    /// Returns the mouse spring, if there is one.
    pub fn mouse_spring(&self) -> Option<&MouseSpring> {
        self.mouse_spring.as_ref()
    }

    /// Sets loads and mouse spring to a time, s.
    pub(crate) fn set_time(&mut self, time: f64) {
        self.set_stage(time, &|pulse| pulse.factor(time));
    }

    /// Sets the mouse spring to a time, s, and every pulse to a factor of its full size; see [`Loads::set_pulses`].
    pub(crate) fn set_stage(&mut self, time: f64, factor: &dyn Fn(&Pulse) -> f64) {
        self.loads.set_pulses(factor);
        if let Some(spring) = &mut self.mouse_spring {
            spring.set_time(time);
        }
    }

    /// Sets every pulse to a factor of its full size; see [`Loads::set_pulses`].
    pub(crate) fn set_pulses(&mut self, factor: &dyn Fn(&Pulse) -> f64) {
        self.loads.set_pulses(factor);
    }

    /// Returns the probes.
    pub fn probes(&self) -> &[NodalProbe] {
        &self.probes
    }

    /// Computes as [`Self::linearize`] the discrete gradient of the elastic energy between two states; see
    /// [`crate::element::Elements::linearize_between`].
    pub(crate) fn linearize_between(
        &self,
        states: [&State; 2],
        forces: &mut Forces,
        tangent: Option<(Tangent, &mut Matrix)>,
    ) {
        let states = states.map(|state| (state.compensated(), &*state.rotations));
        self.sum(forces, tangent, |elements, moduli, sums| elements.linearize_between(moduli, states, sums));
    }

    /// Computes internal forces, their magnitude, and a tangent if requested, by a loop over the elements.
    pub(crate) fn sum(
        &self,
        Forces { internal: force, magnitude, .. }: &mut Forces,
        tangent: Option<(Tangent, &mut Matrix)>,
        add: impl FnOnce(&ElementLoops, Lame, Sums<'_>),
    ) {
        force.fill(Vector2::zeros());
        magnitude.fill(Vector2::zeros());
        let (elements, moduli, slots) = (self.system.elements(), self.material.membrane(), self.system.slots());
        let Some((tangent, matrix)) = tangent else {
            return add(elements, moduli, Sums { force, magnitude, matrix: None });
        };
        matrix.clear();
        matrix.sum(|values| {
            add(elements, moduli, Sums { force, magnitude, matrix: Some(MatrixSum { tangent, slots, values }) });
        });
    }

    /// Adds the loads' part, at this load factor and for a body at rest, to a tangent of the elements, N/m: the mouse
    /// spring if the tangent contains A, the moments if it is exact.
    pub(crate) fn add_load_stiffness(&self, state: &State, tangent: Tangent, load_factor: f64, matrix: &mut Matrix) {
        if tangent.is_exact() {
            let factor = load_factor * tangent.geometric;
            self.loads.add_stiffness(&self.system, &state.displacement, factor, matrix);
        }
        if let Some(spring) = self.mouse_spring.as_ref().filter(|_| tangent.warped != 0.0) {
            spring.add_largest_stiffness(load_factor * tangent.warped, matrix);
        }
    }

    /// Computes f_ext and the residual force for the internal force of the last [`Self::linearize`], for a body at
    /// rest; returns the relative residual ‖f_ext − f_int‖ / ‖Σ|fₑ|‖ over the free unknowns. If the element forces
    /// vanish, the residual is relative to the load. If supports move the body, it is 0 within the rounding error; see
    /// [`Forces`].
    pub fn balance(&self, state: &State, kinematics: Kinematics, load_factor: f64, forces: &mut Forces) -> f64 {
        forces.relative_residual = self.balanced(state, kinematics, load_factor, forces);
        forces.relative_residual
    }

    fn balanced(&self, state: &State, kinematics: Kinematics, load_factor: f64, forces: &mut Forces) -> f64 {
        let Forces { internal, magnitude, external, residual, below_rounding, .. } = forces;
        *below_rounding = None;
        self.loads.force(&self.system, &state.displacement, kinematics, load_factor, external);
        if let Some(spring) = &self.mouse_spring {
            spring.add_force(spring.force_at_rest(&state.displacement) * load_factor, external);
        }
        for (residual, (external, internal)) in residual.iter_mut().zip(external.iter().zip(internal)) {
            *residual = *external - *internal;
        }
        let pattern = self.system.pattern();
        let residual = pattern.norm(residual);
        if residual == 0.0 {
            return 0.0;
        }
        let scale = pattern.norm_of_bounds(magnitude).max(pattern.norm(external));
        let bound =
            if self.supports.move_the_body() { self.supports.rounding(&self.system, &state.displacement) } else { 0.0 };
        if residual <= bound {
            *below_rounding = Some([residual, bound].map(|v| v / scale)).filter(|pair| pair[1].is_finite());
            return 0.0;
        }
        residual / scale
    }

    /// Returns a bound of the rounding error of the relative residual of the last [`Self::balance`], to first order in
    /// the unit roundoff: residuals below it are as good as double precision allows. `None` if a mouse spring is
    /// attached. `scratch` is a nodal work vector.
    pub fn residual_floor(&self, state: &State, forces: &Forces, scratch: &mut [Vector2<f64>]) -> Option<f64> {
        if self.mouse_spring.is_some() {
            return None;
        }
        let Forces { magnitude, external, residual, .. } = forces;
        scratch.fill(Vector2::zeros());
        let moduli = self.material.membrane();
        self.system.elements().add_rounding(moduli, state.compensated(), &state.rotations, scratch);
        self.loads.add_rounding(&self.system, &state.displacement, external, scratch);
        let sums = f64::from(self.system.valence());
        for (bound, ((magnitude, external), residual)) in
            scratch.iter_mut().zip(magnitude.iter().zip(external).zip(residual))
        {
            *bound += (magnitude * sums + external.abs() + residual.abs()) * UNIT;
        }
        let pattern = self.system.pattern();
        let bound = pattern.norm_of_bounds(scratch) / pattern.norm_of_bounds(magnitude).max(pattern.norm(external));
        bound.is_finite().then_some(bound)
    }

    /// Returns the elastic energy, J.
    pub fn elastic_energy(&self, state: &State) -> f64 {
        self.system.elements().energy(self.material.membrane(), state.compensated(), &state.rotations)
    }

    /// Returns the elastic energy plus the potential of loads and mouse spring at this load factor, J; equilibria are
    /// its stationary points.
    pub fn energy(&self, state: &State, load_factor: f64) -> f64 {
        let spring = self.mouse_spring.as_ref().map_or(0.0, |spring| spring.energy(&state.displacement));
        self.elastic_energy(state) + self.loads.potential(state, load_factor) + load_factor * spring
    }
}
