//! Section forces: normal force, shear force and bending moment in a cut through the body.
//!
//! They come from the nodal forces of the elements that the line crosses, not from a recovered stress. Let A be the
//! nodes in front of the line and fₑ the nodal forces of an element e. Elements with all nodes in A are in equilibrium,
//! so that
//!
//! G = Σ fₑ,ₐ,  M = Σ (xₐ − c) × fₑ,ₐ  over a ∈ A and the elements e with nodes on both sides
//!
//! are force and moment of the part in front on the part behind, on every mesh and for every line. They balance the
//! loads on the nodes in front, and in a motion their inertia; `load.rs` adds loads and inertia between these nodes and the
//! line.

mod cut;
mod load;

use std::f64::consts::PI;

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::{Kinematics, Problem, System, weighted_sum};
use crate::element::{Rotations, StrainRate, Sums};
use crate::mesh::{axis_angle, straightened};
use crate::model::{Beam, SectionLine};
use crate::rotation::Rotation;
use crate::scene::Plane;
use crate::sentence::{Sentence, sentence};
use crate::state::State;
use crate::step::warped_stress;
use crate::stress::NodalStress;
use cut::Cut;
pub use load::Wrench;
use load::beyond_nodes;
pub(crate) use load::{MotionBalance, NodalBalance};

/// Reason why a line has no section.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("{}", Sentence::from(self))]
#[non_exhaustive]
pub enum SectionError {
    /// The line does not cross the body.
    Missed,
    /// The line crosses the body in several places, and its point is in none of them.
    Several(usize),
    /// The body has no axis.
    NoAxis,
    /// The forces leave the range of f64.
    NotFinite,
}

impl From<&SectionError> for Sentence {
    fn from(error: &SectionError) -> Self {
        match error {
            SectionError::Missed => sentence!("expected a line that crosses the body at rest"),
            SectionError::Several(places) => sentence!(
                "expected a point of the body, got one outside it; the line crosses the body in %{places} places",
                places
            ),
            SectionError::NoAxis => sentence!("expected a scene with [beam], which has an axis"),
            SectionError::NotFinite => sentence!("the section forces are not finite"),
        }
    }
}

/// Normal force, shear force and bending moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct SectionForces {
    /// Normal force N along the normal, N; positive in tension.
    #[serde(rename = "normal_force")]
    pub normal: f64,
    /// Shear force V along the tangent, N.
    #[serde(rename = "shear_force")]
    pub shear: f64,
    /// Bending moment M about the middle of the cut, N m, counter-clockwise.
    pub moment: f64,
}

/// Stress at a point of a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPoint {
    /// Rest position, m.
    pub rest: Vector2<f64>,
    /// Distance η from the middle of the cut along the tangent, in the current state, m.
    pub along: f64,
    /// Recovered Cauchy stress, Pa: normal stress n·σn and shear stress t·σn; `None` where it is undefined.
    pub stress: Option<[f64; 2]>,
    /// Stresses of beam theory for a rectangular section, Pa: N/A − M η/I and V Q/(I t). `None` in a beam if the cut is
    /// not normal to its axis.
    pub beam: Option<[f64; 2]>,
}

/// Forces in a cut through the body: those that the part in front exerts on the part behind.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Section {
    /// Line of the cut.
    pub line: SectionLine,
    /// Ends of the cut at rest, m, in the order of the tangent.
    pub rest: [Vector2<f64>; 2],
    /// Ends of the cut in the current state, m.
    pub ends: [Vector2<f64>; 2],
    /// Ends of the cut that axes and lever arms refer to, m: those at rest in linear theory, else the current ones.
    axis: [Vector2<f64>; 2],
    /// Force, N.
    pub force: Vector2<f64>,
    /// Components of the force in the axes of the current cut, and the moment.
    pub forces: SectionForces,
    /// Forces of the recovered stress; their difference from [`Self::forces`] is the error of this stress.
    pub stress_forces: SectionForces,
    /// Stress along the cut, in the order of the tangent.
    pub points: Vec<SectionPoint>,
}

impl Section {
    /// Returns the middle of the cut, m, about which [`SectionForces::moment`] acts: in linear theory at rest, else in the
    /// current state.
    pub fn middle(&self) -> Vector2<f64> {
        (self.axis[0] + self.axis[1]) * 0.5
    }

    /// Returns the unit tangent from the first end to the second: in linear theory at rest, else in the current state.
    pub fn tangent(&self) -> Vector2<f64> {
        (self.axis[1] - self.axis[0]).normalize()
    }

    /// Returns the unit normal: the tangent, rotated clockwise by 90°.
    pub fn normal(&self) -> Vector2<f64> {
        let tangent = self.tangent();
        Vector2::new(tangent.y, -tangent.x)
    }

    /// Computes the section of a state along a line; `nodal` is the recovered stress of the state, `None` to leave out the
    /// stress along the line.
    pub(crate) fn of(
        problem: &Problem,
        state: &State,
        kinematics: Kinematics,
        balance: &NodalBalance<'_>,
        nodal: Option<&NodalStress>,
        line: SectionLine,
    ) -> Result<Self, SectionError> {
        let system = problem.system();
        let mesh = system.mesh();
        let cut = cut_of(system, line)?;
        let moved: Vec<Vector2<f64>> = mesh.nodes().iter().zip(state.displacement()).map(|(x, u)| x + u).collect();
        let positions = match kinematics {
            Kinematics::Linear => mesh.nodes(),
            Kinematics::Corotated => &moved,
        };
        let [Some(first), Some(last)] = [cut.points.first(), cut.points.last()] else {
            return Err(SectionError::Missed);
        };
        let mut section = Self {
            line,
            rest: [first, last].map(|point| weighted_sum(mesh.nodes(), &point.weights)),
            ends: [first, last].map(|point| weighted_sum(&moved, &point.weights)),
            axis: [first, last].map(|point| weighted_sum(positions, &point.weights)),
            force: Vector2::zeros(),
            forces: SectionForces::default(),
            stress_forces: SectionForces::default(),
            points: Vec::new(),
        };
        let middle = section.middle();
        let mut sum = beyond_nodes(problem, positions, &cut, (balance, state.time()), middle);
        for (node, force) in element_forces(problem, state, balance.motion.as_ref(), &cut) {
            sum.add(positions[node as usize] - middle, force);
        }
        section.force = sum.force;
        section.forces = section.components(sum);
        if let Some(nodal) = nodal {
            section.add_stress(&cut, nodal, problem, positions);
        }
        let forces = section.forces;
        let is_finite = [forces.normal, forces.shear, forces.moment].iter().all(|v| v.is_finite());
        if is_finite { Ok(section) } else { Err(SectionError::NotFinite) }
    }

    /// Returns `true` if the cut is normal to the axis of a beam at rest, as beam theory assumes: 1° more would let a normal
    /// stress σ appear as a shear stress of 0.017 σ.
    fn is_normal_to_axis(&self, beam: &Beam) -> bool {
        const TOLERANCE: f64 = 1.0 / 180.0 * PI;
        let [along, _] = straightened(beam, (self.rest[0] + self.rest[1]) * 0.5);
        (self.line.angle - axis_angle(beam, along)).sin().abs() < TOLERANCE.sin()
    }

    /// Returns the normal and shear stress of beam theory, Pa, at a distance from the middle of the cut, m.
    pub(crate) fn beam_stress(&self, thickness: f64, along: f64) -> [f64; 2] {
        let height = (self.axis[1] - self.axis[0]).norm();
        let (area, eta) = (height * thickness, 2.0 * along / height);
        let SectionForces { normal, shear, moment } = self.forces;
        let bending = 12.0 * moment * along / (area * height * height);
        [normal / area - bending, 1.5 * shear / area * (1.0 - eta * eta)]
    }

    fn components(&self, Wrench { force, moment }: Wrench) -> SectionForces {
        SectionForces { normal: force.dot(&self.normal()), shear: force.dot(&self.tangent()), moment }
    }

    /// Sets the stresses along the cut, and their forces; `positions` are those of the nodes that arms refer to, m.
    fn add_stress(&mut self, cut: &Cut, nodal: &NodalStress, problem: &Problem, positions: &[Vector2<f64>]) {
        let (middle, tangent, normal) = (self.middle(), self.tangent(), self.normal());
        let (material, mesh) = (problem.material(), problem.system().mesh());
        let is_normal = problem.system().beam().is_none_or(|beam| self.is_normal_to_axis(beam));
        let mut sum = Wrench::default();
        // Arm and traction per length, stress times thickness, at the point before; `None` after an undefined stress.
        let mut before: Option<(Vector2<f64>, [Vector2<f64>; 2])> = None;
        for point in &cut.points {
            let at = weighted_sum(positions, &point.weights);
            let along = tangent.dot(&(at - middle));
            let local = nodal.mean(&point.weights);
            let stress = local.cauchy(material, nodal.kinematics()).map(|stress| stress.plane);
            self.points.push(SectionPoint {
                rest: weighted_sum(mesh.nodes(), &point.weights),
                along,
                stress: stress.map(|stress| [normal, tangent].map(|axis| axis.dot(&(stress * normal)))),
                beam: is_normal.then(|| self.beam_stress(material.thickness, along)),
            });
            let thickness = match (material.plane, nodal.kinematics()) {
                (Plane::Stress, Kinematics::Corotated) => material.thickness * (1.0 + local.strain(material).zz),
                _ => material.thickness,
            };
            let columns = stress.map(|stress| [stress.column(0) * thickness, stress.column(1) * thickness]);
            if let (Some((last, [x, y])), Some(now)) = (before, &columns) {
                // Traction times length: σ times the normal of this piece of the cut. Arms and tractions are linear.
                let piece = at - last;
                let traction = |x: &Vector2<f64>, y: &Vector2<f64>| x * piece.y - y * piece.x;
                let (a, b) = (traction(&x, &y), traction(&now[0], &now[1]));
                let [from, to] = [last, at].map(|at| at - middle);
                sum.force += (a + b) * 0.5;
                sum.moment += (from.perp(&a) + to.perp(&b)) / 3.0 + (from.perp(&b) + to.perp(&a)) / 6.0;
            }
            before = columns.map(|columns| (at, columns));
        }
        self.stress_forces = self.components(sum);
    }
}

/// Returns the cut of a line: that at its point, or else the only one.
fn cut_of(system: &System, line: SectionLine) -> Result<Cut, SectionError> {
    let mut cuts = Cut::all(system.mesh(), system.size(), line);
    let count = cuts.len();
    let chosen = match cuts.iter().position(|cut| cut.contains(0.0, system.size())) {
        Some(chosen) => chosen,
        None if count == 1 => 0,
        None if count == 0 => return Err(SectionError::Missed),
        None => return Err(SectionError::Several(count)),
    };
    Ok(cuts.swap_remove(chosen))
}

/// Returns the distances of the ends of the cut of a line from [`SectionLine::at`] along its tangent, at rest, m; `None`
/// if it has none.
#[cfg(feature = "app")]
pub(crate) fn cut_ends(system: &System, line: SectionLine) -> Option<[f64; 2]> {
    let points = cut_of(system, line).ok()?.points;
    Some([points.first()?.along, points.last()?.along])
}

/// Returns the nodes in front with the forces of the cut's elements on them, N: elastic, and in a motion viscous.
fn element_forces(
    problem: &Problem,
    state: &State,
    motion: Option<&MotionBalance>,
    cut: &Cut,
) -> Vec<(u32, Vector2<f64>)> {
    let system = problem.system();
    let mesh = system.mesh();
    let connectivity: Vec<u32> =
        cut.elements.iter().filter_map(|&element| mesh.elements().nth(element)).flatten().copied().collect();
    let elements = (mesh.entry().loops)(mesh.nodes(), &connectivity);
    let each = system.elements().rotation_count() / mesh.element_count().max(1);
    let own = |&element: &usize| state.rotations().iter().skip(element * each).take(each).copied();
    let rotations: Vec<Rotation> = cut.elements.iter().flat_map(own).collect();
    let mut forces = vec![Vector2::zeros(); mesh.nodes().len()];
    let mut magnitude = forces.clone();
    let moduli = problem.material().membrane();
    let sums = Sums { force: &mut forces, magnitude: &mut magnitude, matrix: None };
    elements.sweep(moduli, state.compensated(), warped_stress(moduli, Rotations::Given(&rotations)), sums);
    if let Some(MotionBalance { viscosity, damped, .. }) = motion {
        elements.viscous_force(*viscosity, damped, StrainRate::Velocity(state.velocity()), &mut forces);
    }
    let mut nodes = connectivity;
    nodes.sort_unstable();
    nodes.dedup();
    nodes.retain(|&node| cut.side.is_in_front(mesh.node(node)));
    nodes.into_iter().map(|node| (node, forces[node as usize])).collect()
}
