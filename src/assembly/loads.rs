//! What pulls: dead forces, and moments that turn with their edges.
//!
//! In the plane such a moment is conservative: its potential is −M θ, θ the angle its edge has turned, and its nodal
//! forces are M ∇θ.

use nalgebra::{Matrix2, Vector2};

use super::{Kinematics, Matrix, System};
use crate::scene::{Invalid, Load, Material, Place};
use crate::state::State;

/// The loads of a scene on its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Loads {
    dead: Vec<Vector2<f64>>,
    moments: Vec<Moment>,
}

/// A moment on a straight edge.
#[derive(Clone, Debug, PartialEq)]
struct Moment {
    /// The edge's number.
    edge: usize,
    /// N m, positive counter-clockwise.
    moment: f64,
    /// Where the blocks of its tangent go.
    slots: Vec<u32>,
}

impl Loads {
    /// The loads of a scene on a system that couples the edges of its moments.
    pub(super) fn new(loads: &[Load], material: &Material, system: &System) -> Result<Self, Invalid> {
        let mut dead = vec![Vector2::zeros(); system.mesh().nodes().len()];
        let mut moments = Vec::new();
        for (i, load) in loads.iter().enumerate() {
            let key = format!("load.{i}");
            match load {
                Load::Force { place: Place::At(at), force } => {
                    dead[system.mesh().nearest_node((*at).into()) as usize] += Vector2::from(*force);
                }
                Load::Force { place: Place::Edge(name), force } => {
                    for &(node, weight) in system.edge(name, &key)?.1.weights() {
                        dead[node as usize] += Vector2::from(*force) * weight;
                    }
                }
                Load::Gravity { acceleration } => {
                    let per_area = Vector2::from(*acceleration) * material.area_density();
                    dead.iter_mut().zip(system.nodal_areas()).for_each(|(f, area)| *f += per_area * *area);
                }
                Load::Moment { edge: name, moment } => {
                    let (edge, straight) = system.edge(name, &key)?;
                    if !straight.is_straight() {
                        let message = format!("expected a straight edge, got \"{name}\", which is not");
                        return Err(Invalid::new(format!("{key}.edge"), message));
                    }
                    let nodes: Vec<u32> = straight.arms().iter().map(|&(node, _)| node).collect();
                    moments.push(Moment { edge, moment: *moment, slots: system.pattern().block_slots(&nodes) });
                }
            }
        }
        Ok(Self { dead, moments })
    }

    /// Nodal force of the dead loads, N.
    #[must_use]
    pub fn dead_force(&self) -> &[Vector2<f64>] {
        &self.dead
    }

    /// Number of every edge that carries a moment, with the moment, N m.
    pub fn moments(&self) -> impl Iterator<Item = (usize, f64)> {
        self.moments.iter().map(|m| (m.edge, m.moment))
    }

    /// The external nodal force f_ext at this load factor, N. Linear theory knows the directions at rest only.
    pub fn force(
        &self,
        system: &System,
        u: &[Vector2<f64>],
        kinematics: Kinematics,
        factor: f64,
        force: &mut [Vector2<f64>],
    ) {
        for (f, dead) in force.iter_mut().zip(&self.dead) {
            *f = dead * factor;
        }
        for Moment { edge, moment, .. } in &self.moments {
            let edge = &system.edges()[*edge];
            let d = match kinematics {
                Kinematics::Corotated => edge.direction(u),
                Kinematics::Linear => edge.direction_at_rest(),
            };
            // M ∇θ. Where the edge has shrunk to a point θ has no gradient, and none is added.
            let turned = Vector2::new(-d.y, d.x) * (factor * moment / d.norm_squared());
            if turned.iter().all(|v| v.is_finite()) {
                for &(node, c) in edge.arms() {
                    force[node as usize] += turned * c;
                }
            }
        }
    }

    /// Adds the derivative of −f_ext at this load factor: the Hessian of the moments' potential, N/m.
    pub fn add_stiffness(&self, system: &System, u: &[Vector2<f64>], factor: f64, matrix: &mut Matrix) {
        for Moment { edge, moment, slots } in &self.moments {
            let edge = &system.edges()[*edge];
            let d = edge.direction(u);
            let (p, q) = (2.0 * d.x * d.y, d.y * d.y - d.x * d.x);
            let hessian = Matrix2::new(p, q, q, -p) * (-factor * moment / d.norm_squared().powi(2));
            if !hessian.iter().all(|v| v.is_finite()) {
                continue;
            }
            let mut slots = slots.iter();
            let values = matrix.slots();
            let mut add = |value: f64| {
                if let Some(&slot) = slots.next() {
                    values[slot as usize] += value;
                }
            };
            for (i, &(_, a)) in edge.arms().iter().enumerate() {
                for &(_, b) in &edge.arms()[..i] {
                    [hessian.m11, hessian.m12, hessian.m21, hessian.m22].into_iter().for_each(|h| add(h * a * b));
                }
                [hessian.m11, hessian.m21, hessian.m22].into_iter().for_each(|h| add(h * a * a));
            }
        }
    }

    /// Potential of the loads relative to rest at this load factor, J: minus the work they have done at full size.
    #[must_use]
    pub fn potential(&self, state: &State, factor: f64) -> f64 {
        let dead: f64 = self.dead.iter().zip(&state.displacement).map(|(f, u)| f.dot(u)).sum();
        let moments: f64 = self.moments.iter().map(|m| m.moment * state.turns[m.edge]).sum();
        -factor * (dead + moments)
    }
}
