//! Field of a state in the form in which it is displayed: components that are interpolated over every element.

use nalgebra::Matrix2;

use crate::assembly::Kinematics;
use crate::mesh::{MaterialPoint, Mesh};
use crate::rotation::Rotation;
use crate::scene::Material;
use crate::simulation::{Field, PointValues, Simulation};
use crate::stress::{Local, NodalStress, RecoveryScratch, visit_points};

impl Field {
    /// Returns the factor from values to displayed values, and their unit: strains are displayed in percent.
    pub(crate) fn display_unit(self) -> (f64, &'static str) {
        if self == Self::LargestStrain { (100.0, "%") } else { (1.0, self.unit()) }
    }

    /// Returns `true` if values of both signs occur.
    pub(crate) fn has_sign(self) -> bool {
        self == Self::RotationAngle
    }

    /// Returns the ends of the colour map for values up to a magnitude: from 0, or symmetric about 0 if values of both
    /// signs occur; from 0 to 1 where all values are 0.
    pub(crate) fn range(self, largest: f64) -> [f64; 2] {
        let largest = if largest > 0.0 { largest } else { 1.0 };
        [if self.has_sign() { -largest } else { 0.0 }, largest]
    }

    /// Returns the components that are interpolated over an element before [`Self::of_components`] takes the value of
    /// them: ε₁₁, ε₂₂, ε₁₂, or cos θ, sin θ, 0.
    pub(crate) fn components(self, local: &Local) -> [f64; 3] {
        match self {
            Self::RotationAngle => [local.rotation.c, local.rotation.s, 0.0],
            _ => [local.strain.m11, local.strain.m22, local.strain.m12],
        }
    }

    /// Returns the value of interpolated components; the component of a field of elements is its value. The shader
    /// `mesh.wgsl` computes the same at every pixel.
    pub(crate) fn of_components(self, [x, y, z]: [f64; 3], material: &Material, kinematics: Kinematics) -> Option<f64> {
        let (strain, rotation) = match self {
            Self::MeshError => return x.is_finite().then_some(x),
            Self::RotationAngle => (Matrix2::zeros(), Rotation { c: x, s: y }),
            _ => (Matrix2::new(x, z, z, y), Rotation::IDENTITY),
        };
        self.of(&Local { strain, rotation }, material, kinematics)
    }
}

/// Field of a state. Its components are interpolated over every element, and its value at a point is computed from
/// them: the von Mises stress of a bent beam vanishes at its neutral axis, although it is large at all nodes.
#[derive(Debug)]
pub(crate) struct InterpolatedField {
    field: Field,
    values: PointValues,
    material: Material,
    kinematics: Kinematics,
    /// Components, see [`Field::components`]: at the nodes if they are recovered, else at every quadrature point.
    components: Vec<[f64; 3]>,
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
            nodal: NodalStress::empty(material),
            scratch: RecoveryScratch::default(),
            of_elements: Vec::new(),
        }
    }
}

impl InterpolatedField {
    /// Computes the field of a simulation's current state.
    pub(crate) fn new(simulation: &Simulation, field: Field, values: PointValues) -> Self {
        let mut new = Self::default();
        new.update(simulation, field, values);
        new
    }

    /// Computes the field of another state, without allocating if the mesh is the same. A field of elements is never
    /// recovered at the nodes.
    pub(crate) fn update(&mut self, simulation: &Simulation, field: Field, values: PointValues) {
        let (problem, state, kinematics) = (simulation.problem(), simulation.state(), simulation.kinematics());
        self.values = source(field, values);
        (self.field, self.material, self.kinematics) = (field, *problem.material(), kinematics);
        self.components.clear();
        if field.is_of_elements() {
            simulation.field(field, &mut self.of_elements);
            self.components.extend(self.of_elements.iter().map(|value| [value.unwrap_or(f64::NAN), 0.0, 0.0]));
        } else if values == PointValues::Recovered {
            self.nodal.update(problem, state, kinematics, &mut self.scratch);
            self.components.extend(self.nodal.nodes().iter().map(|local| field.components(local)));
        } else {
            let components = &mut self.components;
            visit_points(problem, state, kinematics, &mut |_, local| components.push(field.components(&local)));
        }
    }

    /// Returns `true` if only the simulation's displacements can differ from those of this field.
    pub(crate) fn has_settings(&self, simulation: &Simulation, field: Field, values: PointValues) -> bool {
        (self.field, self.values) == (field, source(field, values))
            && self.material == *simulation.problem().material()
            && self.kinematics == simulation.kinematics()
    }

    /// Returns the displayed field.
    pub(crate) fn field(&self) -> Field {
        self.field
    }

    /// Returns the material of the body.
    pub(crate) fn material(&self) -> Material {
        self.material
    }

    /// Returns the strain measure of the state.
    pub(crate) fn kinematics(&self) -> Kinematics {
        self.kinematics
    }

    /// Returns the source of the components.
    pub(crate) fn values(&self) -> PointValues {
        self.values
    }

    /// Returns the components at the nodes or at every quadrature point, by [`Self::values`]; NaN where the field has
    /// no value.
    pub(crate) fn components(&self) -> &[[f64; 3]] {
        &self.components
    }

    /// Returns the value of interpolated components.
    pub(crate) fn value(&self, components: [f64; 3]) -> Option<f64> {
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
    /// interpolated between the corners is.
    pub(crate) fn largest(&self, mesh: &Mesh) -> f64 {
        let largest = |largest: f64, value: Option<f64>| value.map_or(largest, |value| largest.max(value.abs()));
        match self.values {
            PointValues::Recovered => self.components.iter().map(|own| self.value(*own)).fold(0.0, largest),
            PointValues::Raw => {
                let entry = mesh.entry();
                let corners: Vec<Vec<f64>> = entry.cell.corners.iter().map(|at| (entry.point_weights)(*at)).collect();
                let elements = self.components.chunks_exact(entry.points.len().max(1));
                let at_corners = elements
                    .flat_map(|own| corners.iter().map(move |weights| weighted_sum(own.iter().map(Some).zip(weights))));
                at_corners.map(|components| self.value(components?)).fold(0.0, largest)
            }
        }
    }

    /// Returns the range of values that the colour map covers; see [`Field::range`].
    pub(crate) fn range(&self, mesh: &Mesh) -> [f64; 2] {
        self.field.range(self.largest(mesh))
    }
}

/// Returns the source of a field's components: a field of elements is never recovered at the nodes.
fn source(field: Field, wanted: PointValues) -> PointValues {
    if field.is_of_elements() { PointValues::Raw } else { wanted }
}

/// Returns a weighted sum of components; `None` if one is missing or the sum is not finite.
pub(crate) fn weighted_sum<'a>(
    mut weighted: impl Iterator<Item = (Option<&'a [f64; 3]>, &'a f64)>,
) -> Option<[f64; 3]> {
    let sum = weighted.try_fold([0.0; 3], |sum, (components, weight)| {
        let components = components?;
        Some([0, 1, 2].map(|i: usize| sum[i] + weight * components[i]))
    })?;
    sum.iter().all(|c| c.is_finite()).then_some(sum)
}
