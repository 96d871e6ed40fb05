//! Field of a state in the form in which it is displayed: components that are interpolated over every element.

use nalgebra::Vector2;

use crate::assembly::Kinematics;
use crate::mesh::{MaterialPoint, Mesh};
use crate::scene::Material;
use crate::simulation::{Field, PointValues, Simulation};
use crate::stress::{Local, NodalStress, RecoveryScratch, visit_points};

/// Values that are interpolated over an element before the value of a field is taken of them: ε₁₁, ε₂₂, ε₁₂, cos θ,
/// sin θ; or u_x, u_y; or the value itself. The others are 0.
pub(crate) type Components = [f64; 5];

impl Field {
    /// Returns the factor from values to displayed values, and their unit: strains are displayed in percent.
    pub(crate) fn display_unit(self) -> (f64, &'static str) {
        if self.unit().is_empty() { (100.0, "%") } else { (1.0, self.unit()) }
    }

    /// Returns the ends of the colour map for values up to a magnitude: from 0, or symmetric about 0 if values of both
    /// signs occur; from 0 to 1 where all values are 0.
    pub(crate) fn range(self, largest: f64) -> [f64; 2] {
        let largest = if largest > 0.0 { largest } else { 1.0 };
        [if self.has_sign() { -largest } else { 0.0 }, largest]
    }

    /// Returns the source of the components if `wanted` is chosen: the displacement is known at the nodes, and a field
    /// of elements is never recovered there.
    pub(crate) fn source(self, wanted: PointValues) -> PointValues {
        match self {
            _ if self.is_of_elements() => PointValues::Raw,
            _ if self.is_of_displacement() => PointValues::Recovered,
            _ => wanted,
        }
    }

    /// Returns the value of interpolated components. The shader `mesh.wgsl` computes the same at every pixel.
    pub(crate) fn of_components(self, c: Components, material: &Material, kinematics: Kinematics) -> Option<f64> {
        let [x, y, ..] = c;
        if self.is_of_elements() {
            return x.is_finite().then_some(x);
        }
        self.of_vector([x, y].into()).or_else(|| self.of(&Local::of_components(c), material, kinematics))
    }
}

/// Field of a state. Its components are interpolated over every element, and its value at a point is computed from
/// them: the von Mises stress of a bent beam vanishes at its neutral axis, although it is large at all nodes.
#[derive(Debug)]
pub(crate) struct InterpolatedField {
    pub field: Field,
    /// Source of the components.
    pub values: PointValues,
    pub material: Material,
    pub kinematics: Kinematics,
    /// Components at the nodes or at every quadrature point, by [`Self::values`]; NaN where the field has no value.
    pub components: Vec<Components>,
    /// Largest magnitude of components that are not of the rotation.
    pub largest_component: f64,
    nodal: NodalStress,
    scratch: RecoveryScratch,
    of_elements: Vec<Option<f64>>,
}

impl Default for InterpolatedField {
    fn default() -> Self {
        let material = Material::default();
        Self {
            field: Field::default(),
            values: PointValues::Raw,
            material,
            kinematics: Kinematics::Corotated,
            components: Vec::new(),
            largest_component: 0.0,
            nodal: NodalStress::empty(material),
            scratch: RecoveryScratch::default(),
            of_elements: Vec::new(),
        }
    }
}

impl InterpolatedField {
    /// Computes the field of a simulation's current state.
    #[cfg(test)]
    pub(crate) fn new(simulation: &Simulation, field: Field, values: PointValues) -> Self {
        let mut new = Self::default();
        new.update(simulation, field, values, &[]);
        new
    }

    /// Computes the field of another state, without allocating if the mesh is the same. A field of elements is never
    /// recovered at the nodes. `reference` are the displacements of the reference solution at the nodes, m; without
    /// them the distance to it has no values.
    pub(crate) fn update(
        &mut self,
        simulation: &Simulation,
        field: Field,
        values: PointValues,
        reference: &[Option<Vector2<f64>>],
    ) {
        let (problem, state, kinematics) = (simulation.problem(), simulation.state(), simulation.kinematics());
        self.values = field.source(values);
        (self.field, self.material, self.kinematics) = (field, *problem.material(), kinematics);
        self.components.clear();
        if field.is_of_elements() {
            simulation.field(field, &mut self.of_elements);
            self.components
                .extend(self.of_elements.iter().map(|value| [value.unwrap_or(f64::NAN), 0.0, 0.0, 0.0, 0.0]));
        } else if field == Field::ReferenceDistance {
            let own = reference.iter().copied().chain(std::iter::repeat(None));
            self.components.extend(state.displacement().iter().zip(own).map(|(u, own)| {
                let [x, y] = own.map_or([f64::NAN; 2], |own| (u - own).into());
                [x, y, 0.0, 0.0, 0.0]
            }));
        } else if field.is_of_displacement() {
            self.components.extend(state.displacement().iter().map(|u| [u.x, u.y, 0.0, 0.0, 0.0]));
        } else if values == PointValues::Recovered {
            self.nodal.update(problem, state, kinematics, &mut self.scratch);
            self.components.extend(self.nodal.nodes().iter().map(Local::components));
        } else {
            let components = &mut self.components;
            visit_points(problem, state, &mut |_, local| components.push(local.components()));
        }
        let magnitudes = self.components.iter().flat_map(|own| &own[..3]).map(|c| c.abs());
        self.largest_component = magnitudes.fold(0.0, f64::max);
    }

    /// Returns `true` if only the simulation's displacements can differ from those of this field.
    pub(crate) fn has_settings(&self, simulation: &Simulation, field: Field, values: PointValues) -> bool {
        (self.field, self.values) == (field, field.source(values))
            && self.material == *simulation.problem().material()
            && self.kinematics == simulation.kinematics()
    }

    /// Returns the value of interpolated components.
    pub(crate) fn value(&self, components: Components) -> Option<f64> {
        self.field.of_components(components, &self.material, self.kinematics)
    }

    /// Returns the value at a material point of the mesh; `None` if there is no such point, or no value.
    pub(crate) fn at(&self, mesh: &Mesh, point: MaterialPoint) -> Option<f64> {
        let components = match self.values {
            PointValues::Recovered => {
                weighted_sum(mesh.weights(point)?.iter().map(|(node, w)| (self.components.get(*node as usize), w)))
            }
            PointValues::Raw => {
                let weights = (mesh.entry().point_weights)(point.at);
                let own = self.components.chunks_exact(weights.len().max(1)).nth(point.element)?;
                weighted_sum(own.iter().map(Some).zip(&weights))
            }
        };
        self.value(components?)
    }

    /// Returns the largest magnitude of the values at the nodes, or at the corners of every element if the components
    /// are not recovered; 0 without values. Inside an element the value is smaller, because a norm of a strain that is
    /// interpolated between the corners is. A component that is rounding error beside the others is not magnified.
    pub(crate) fn largest(&self, mesh: &Mesh) -> f64 {
        /// Ratio of a component to the others that is rounding error.
        const ROUNDING: f64 = 1e-9;
        let noise = match self.field.unit() {
            "Pa" => ROUNDING * self.material.young * self.largest_component,
            "" | "m" => ROUNDING * self.largest_component,
            _ => 0.0,
        };
        let largest = |largest: f64, value: Option<f64>| value.map_or(largest, |value| largest.max(value.abs()));
        match self.values {
            PointValues::Recovered => self.components.iter().map(|own| self.value(*own)).fold(noise, largest),
            PointValues::Raw => {
                let entry = mesh.entry();
                let corners: Vec<Vec<f64>> = entry.cell.corners.iter().map(|at| (entry.point_weights)(*at)).collect();
                let elements = self.components.chunks_exact(entry.points.len().max(1));
                let at_corners = elements
                    .flat_map(|own| corners.iter().map(move |weights| weighted_sum(own.iter().map(Some).zip(weights))));
                at_corners.map(|components| self.value(components?)).fold(noise, largest)
            }
        }
    }
}

/// Returns a weighted sum of components; `None` if one is missing or the sum is not finite.
pub(crate) fn weighted_sum<'a>(
    mut weighted: impl Iterator<Item = (Option<&'a Components>, &'a f64)>,
) -> Option<Components> {
    let sum = weighted.try_fold([0.0; 5], |sum: Components, (components, weight)| {
        let components = components?;
        Some(std::array::from_fn(|i| sum[i] + weight * components[i]))
    })?;
    sum.iter().all(|c| c.is_finite()).then_some(sum)
}
