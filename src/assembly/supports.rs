//! Supports on nodes and at points between them, with their prescribed displacements.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::edge::weighted_sum;
use super::held_points::{Constraint, HeldPoints, axes};
use super::hold::nodes_of;
use super::pattern::component;
use super::{Kinematics, Matrix, NodeWeights, System};
use crate::displacement::Displacement;
use crate::element::{MatrixSum, Sums, Tangent};
use crate::format::number;
use crate::mesh::Mesh;
use crate::rotation::Rotation;
use crate::scene::{Invalid, Material, Place, Support};
use crate::state::State;

/// Support on the nodes of a mesh, or at a point between them.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalSupport {
    /// Place in the scene.
    pub place: Place,
    /// Fixed nodes; for x and y, `true` if the component is fixed. A component fixed by several supports belongs to the
    /// first. Empty if a point between nodes is held.
    pub nodes: Vec<(u32, [bool; 2])>,
    /// Components, x and y, of a point between nodes that are fixed; `None` for a support on nodes.
    pub point: Option<[bool; 2]>,
    /// Nodes with their weights: the middle of an edge, or a point between nodes, is their weighted mean.
    pub weights: NodeWeights,
    /// Length over which a point is held, m.
    pub width: f64,
    /// Prescribed displacement at full load, m.
    pub displacement: Vector2<f64>,
    /// Prescribed rotation about the middle, rad.
    pub rotation: f64,
    /// Middle at rest, m.
    pub middle: Vector2<f64>,
}

impl NodalSupport {
    fn moves(&self) -> bool {
        self.rotation != 0.0 || self.displacement != Vector2::zeros()
    }

    /// Returns the prescribed displacement of a point at rest position `x`, m: u = (R(λφ) − I)(X − M) + λd; angle and
    /// displacement grow with the load factor λ. In linear theory u = λ(φ × (X − M) + d), so that a common rotation of
    /// all supports causes no strain in it.
    fn take(&self, x: Vector2<f64>, factor: f64, kinematics: Kinematics) -> Vector2<f64> {
        if !self.moves() {
            return Vector2::zeros();
        }
        let arm = x - self.middle;
        let angle = factor * self.rotation;
        let rotated = match kinematics {
            Kinematics::Linear => Vector2::new(-arm.y, arm.x) * angle,
            Kinematics::Corotated => rotated_by(arm, angle),
        };
        rotated + self.displacement * factor
    }
}

/// Returns (R − I) times an arm, R the rotation by an angle, rad.
fn rotated_by(arm: Vector2<f64>, angle: f64) -> Vector2<f64> {
    // cos − 1 = −2 sin² of half the angle keeps the digits of small angles.
    let (s, versine) = (angle.sin(), -2.0 * (0.5 * angle).sin().powi(2));
    Vector2::new(versine * arm.x - s * arm.y, s * arm.x + versine * arm.y)
}

/// Supports of a scene on the nodes of its mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Supports {
    all: Vec<NodalSupport>,
    /// Equations of supports at points between nodes.
    held: HeldPoints,
    moves: bool,
    /// `true` if the supports' frame turns with the line through them; `false` if it turns with the mean of their rotations.
    keeps_its_shape: bool,
    largest_load_step: f64,
    /// Diagonal of the stiffness at rest over the free unknowns, N/m, if supports move.
    diagonal: Vec<f64>,
}

/// Rigid motion: a rotation about `from` followed by the translation from `from` to `to`.
#[derive(Clone, Copy, Debug)]
struct RigidMotion {
    from: Vector2<f64>,
    to: Vector2<f64>,
    angle: f64,
}

impl RigidMotion {
    /// Returns the displacement of a point.
    fn displacement(&self, x: Vector2<f64>) -> Vector2<f64> {
        rotated_by(x - self.from, self.angle) + (self.to - self.from)
    }

    /// Moves a body.
    fn apply(&self, mesh: &Mesh, state: &mut State) {
        for (node, x) in mesh.nodes().iter().enumerate() {
            let by = self.displacement(x + state.displacement[node]);
            (0..2).for_each(|axis| state.displacement.advance(node, axis, by[axis]));
        }
        let rotation = Rotation::from_angle(self.angle);
        for r in &mut state.rotations {
            *r = Rotation { c: rotation.c * r.c - rotation.s * r.s, s: rotation.s * r.c + rotation.c * r.s };
        }
        state.edge_angles.iter_mut().for_each(|t| *t += self.angle);
    }
}

/// Largest angle by which a support may rotate relative to the others in a load step, rad: the adjacent elements rotate
/// by it in one step, and fold over at a right angle or more.
pub(crate) const LARGEST_TURN: f64 = 0.5;

impl Supports {
    /// Returns the supports of a scene on a system.
    pub(super) fn new(supports: &[Support], material: &Material, system: &System) -> Result<Self, Invalid> {
        let mesh = system.mesh();
        let mut owner: HashMap<(u32, usize), usize> = HashMap::new();
        let mut all: Vec<NodalSupport> = Vec::with_capacity(supports.len());
        for (i, support) in supports.iter().enumerate() {
            let key = format!("support.{i}");
            let held = system.held.points.iter().find(|point| point.support == i);
            let nodes = if held.is_none() { nodes_of(support, mesh, &key)? } else { Vec::new() };
            let point = held.map(|point| point.axes);
            let weights = match (&support.place, held) {
                (Place::Edge(name), _) => system.edge(name, &key)?.1.weights.to_vec(),
                (Place::At(_), Some(point)) => point.weights.clone(),
                (Place::At(_), None) => nodes.iter().map(|&node| (node, 1.0)).collect(),
            };
            let middle = weighted_sum(mesh.nodes(), &weights);
            let place = support.place.clone();
            let (displacement, rotation) = (support.displacement.into(), support.turn);
            let width = support.width;
            let mut new =
                NodalSupport { place, nodes: Vec::new(), point, weights, width, displacement, rotation, middle };
            for node in nodes {
                let mut own = axes(support);
                for (axis, own) in own.iter_mut().enumerate().filter(|(_, own)| **own) {
                    let Some(&first) = owner.get(&(node, axis)) else {
                        owner.insert((node, axis), i);
                        continue;
                    };
                    *own = false;
                    let x = mesh.node(node);
                    if !agree(&all[first], &new, x, axis, system.size()) {
                        let there = format!("({}, {})", number(x.x), number(x.y));
                        let message = format!(
                            "expected the same displacement as support.{first} at the node {there}, which \
                             both fix"
                        );
                        return Err(Invalid::new(&key, message));
                    }
                }
                new.nodes.push((node, own));
            }
            all.push(new);
        }
        let moves = all.iter().any(NodalSupport::moves);
        let held = system.held.clone();
        let mut result = Self { all, held, moves, keeps_its_shape: true, largest_load_step: 1.0, diagonal: Vec::new() };
        result.check_redundant(system)?;
        if moves {
            result.set_frame(mesh);
            result.set_stiffness(material, system);
        }
        Ok(result)
    }

    /// Rejects a held point to which other supports prescribe another displacement.
    fn check_redundant(&self, system: &System) -> Result<(), Invalid> {
        let mesh = system.mesh();
        for (support, constraint) in &self.held.redundant {
            for factor in [0.5, 1.0] {
                let mut u = vec![Vector2::zeros(); mesh.nodes().len()];
                for (node, axis, target) in self.targets(mesh, factor, Kinematics::Corotated) {
                    u[node as usize][axis] = target;
                }
                let axis = constraint.terms.keys().next().map_or(0, |unknown| unknown % 2) as usize;
                let moved: f64 = constraint.terms.iter().map(|(&unknown, c)| c * component(&u, unknown)).sum();
                if (moved - self.target(constraint, axis, factor, Kinematics::Corotated)).abs() > SAME * system.size() {
                    let message = "expected the displacement that other supports give this point, which they hold";
                    return Err(Invalid::new(format!("support.{support}"), message));
                }
            }
        }
        Ok(())
    }

    /// Returns Σ h g of an equation between displacements along an axis, m.
    fn target(&self, constraint: &Constraint, axis: usize, factor: f64, kinematics: Kinematics) -> f64 {
        let g = |support: &NodalSupport| support.take(support.middle, factor, kinematics)[axis];
        constraint.targets.iter().map(|(&support, h)| self.all.get(support).map_or(0.0, |support| h * g(support))).sum()
    }

    /// Iterates over the unknowns that depend on others, with their displacement, m, for those of the others.
    fn dependent<'a>(
        &'a self,
        factor: f64,
        kinematics: Kinematics,
        u: &'a [Vector2<f64>],
    ) -> impl Iterator<Item = (u32, f64)> + 'a {
        self.held.dependent.iter().map(move |dependent| {
            let on = &dependent.on;
            let others: f64 = on.terms.iter().map(|(&unknown, c)| c * component(u, unknown)).sum();
            (dependent.unknown, others + self.target(on, dependent.unknown as usize % 2, factor, kinematics))
        })
    }

    /// Returns `true` if held points are at their positions for this load factor, up to rounding errors.
    fn points_are_at(&self, factor: f64, kinematics: Kinematics, u: &[Vector2<f64>]) -> bool {
        let largest = || u.iter().map(|u| u.amax()).fold(0.0, f64::max);
        self.dependent(factor, kinematics, u)
            .all(|(unknown, value)| (component(u, unknown) - value).abs() <= SAME * largest())
    }

    /// Iterates over the supports at points between nodes, with the force, N, of each on its point, for f_ext − f_int of
    /// every node.
    pub(crate) fn point_forces<'a>(
        &'a self,
        residual: &'a [Vector2<f64>],
    ) -> impl Iterator<Item = (&'a NodalSupport, Vector2<f64>)> + 'a {
        let points = self.all.iter().enumerate().filter(|(_, support)| support.point.is_some());
        points.map(move |(i, support)| (support, self.held.force(i, residual)))
    }

    /// Returns f_ext − f_int of every node, N, with the forces of supports at points between nodes among f_ext: what is
    /// left belongs to supports on nodes.
    pub(crate) fn with_point_forces<'a>(&self, residual: &'a [Vector2<f64>]) -> Cow<'a, [Vector2<f64>]> {
        let mut result = Cow::Borrowed(residual);
        for (support, force) in self.point_forces(residual) {
            for &(node, weight) in &support.weights {
                result.to_mut()[node as usize] += force * weight;
            }
        }
        result
    }

    /// Recomputes the stiffness for another material.
    pub(super) fn set_stiffness(&mut self, material: &Material, system: &System) {
        if !self.moves {
            return;
        }
        let (rest, mut matrix) = (system.at_rest(), Matrix::new(system.pattern()));
        let mut scratch = [rest.displacement.to_vec(), rest.displacement.to_vec()];
        let [force, magnitude] = &mut scratch;
        let (elements, moduli) = (system.elements(), material.membrane());
        matrix.sum(|values| {
            let sum = MatrixSum { tangent: Tangent::WARPED, slots: system.slots(), values };
            let states = [(rest.compensated(), &*rest.rotations); 2]; // Between equal states: the tangent there.
            elements.linearize_between(moduli, states, Sums { force, magnitude, matrix: Some(sum) });
        });
        self.diagonal = matrix.diagonal(system.pattern()).collect();
    }

    /// Returns the supports, in the order of the scene.
    pub fn all(&self) -> &[NodalSupport] {
        &self.all
    }

    /// Returns `true` if any displacement or rotation is prescribed.
    pub fn move_the_body(&self) -> bool {
        self.moves
    }

    /// Returns the largest fraction of the prescribed motion that may be applied in one load step from rest.
    pub(crate) fn largest_load_step(&self) -> f64 {
        self.largest_load_step
    }

    /// Returns the rounding error of forces in balance, N, for this displacement: a body that is only moved rigidly by
    /// its supports has no element forces to compare a residual with.
    pub(super) fn rounding(&self, system: &System, u: &[Vector2<f64>]) -> f64 {
        /// A few times the unit roundoff.
        const ROUNDING: f64 = 2e-15;
        let free = self.diagonal.iter().zip(&system.pattern().free);
        let squares = free.map(|(k, &unknown)| (k * u[unknown as usize / 2][unknown as usize % 2]).powi(2));
        ROUNDING * squares.sum::<f64>().sqrt()
    }

    /// Iterates over the fixed components, as node and axis, with their displacement at this load factor, m.
    fn targets(&self, mesh: &Mesh, factor: f64, kinematics: Kinematics) -> impl Iterator<Item = (u32, usize, f64)> {
        self.all.iter().flat_map(move |support| {
            support.nodes.iter().flat_map(move |&(node, own)| {
                let u = support.take(mesh.node(node), factor, kinematics);
                (0..2).filter(move |&axis| own[axis]).map(move |axis| (node, axis, u[axis]))
            })
        })
    }

    /// Sets the fixed components of a displacement to their values at this load factor.
    pub(crate) fn put(&self, mesh: &Mesh, factor: f64, kinematics: Kinematics, u: &mut Displacement) {
        for (node, axis, target) in self.targets(mesh, factor, kinematics) {
            u.put(node, axis, target);
        }
        let dependent: Vec<(u32, f64)> = self.dependent(factor, kinematics, u).collect();
        for (unknown, value) in dependent {
            u.put(unknown / 2, unknown as usize % 2, value);
        }
    }

    /// Returns `true` if the fixed components of a displacement are exactly those of [`Self::put`], and those of held
    /// points up to rounding errors. The comparison of nodes is exact because after a full rotation they equal the rest
    /// position up to rounding, but the body is not at rest.
    pub(crate) fn are_at(&self, mesh: &Mesh, factor: f64, kinematics: Kinematics, u: &[Vector2<f64>]) -> bool {
        self.targets(mesh, factor, kinematics).all(|(node, axis, target)| u[node as usize][axis] == target)
            && self.points_are_at(factor, kinematics, u)
    }

    /// Returns `true` if the fixed components of a displacement are zero.
    pub(crate) fn are_at_rest(&self, u: &[Vector2<f64>]) -> bool {
        let mut nodes = self.all.iter().flat_map(|support| &support.nodes);
        nodes.all(|&(node, own)| (0..2).all(|axis| !own[axis] || u[node as usize][axis] == 0.0))
            && self.points_are_at(0.0, Kinematics::Corotated, u)
    }

    /// Returns the rigid motion that best approximates the motion of the fixed components from this displacement, or from
    /// rest, to their positions at a load factor (least squares; the angle in closed form, as that of a polar factor), and
    /// how well it does: 1 for a rigid motion, 0 if the angle is not determined.
    fn rigid_motion(&self, mesh: &Mesh, factor: f64, u: Option<&[Vector2<f64>]>) -> (RigidMotion, f64) {
        let mut increments: BTreeMap<u32, [Vector2<f64>; 2]> = BTreeMap::new();
        for (node, axis, target) in self.targets(mesh, factor, Kinematics::Corotated) {
            let now = mesh.node(node) + u.map_or_else(Vector2::zeros, |u| u[node as usize]);
            increments.entry(node).or_insert([now; 2])[1][axis] = mesh.node(node)[axis] + target;
        }
        let points = self.all.iter().filter_map(|support| {
            let target = support.middle + support.take(support.middle, factor, Kinematics::Corotated);
            let now = support.middle + u.map_or_else(Vector2::zeros, |u| weighted_sum(u, &support.weights));
            Some([now, now.zip_zip_map(&target, &support.point?.into(), |now, to, fixed| if fixed { to } else { now })])
        });
        let increments: Vec<[Vector2<f64>; 2]> = increments.into_values().chain(points).collect();
        let count = increments.len().max(1) as f64;
        let [from, to] =
            [0, 1].map(|end| increments.iter().map(|increment| increment[end]).sum::<Vector2<f64>>() / count);
        let (c, s, size) = increments.iter().fold((0.0, 0.0, 0.0), |(c, s, size), increment| {
            let (a, b) = (increment[0] - from, increment[1] - to);
            (c + a.dot(&b), s + a.perp(&b), size + a.norm_squared())
        });
        let (angle, quality) = (f64::atan2(s, c), f64::hypot(s, c) / size);
        let quality = if quality.is_finite() { quality } else { 0.0 };
        (RigidMotion { from, to, angle: if angle.is_finite() { angle } else { 0.0 } }, quality)
    }

    /// Returns the rigid motion from rest of the supports' frame at a load factor.
    fn frame(&self, mesh: &Mesh, factor: f64) -> RigidMotion {
        let motion = self.rigid_motion(mesh, factor, None).0;
        RigidMotion { angle: if self.keeps_its_shape { motion.angle } else { factor * self.mean_rotation() }, ..motion }
    }

    /// Returns the rigid motion of the supports' frame from one load factor to another.
    fn frame_motion(&self, mesh: &Mesh, factors: [f64; 2]) -> RigidMotion {
        let [before, after] = factors.map(|factor| self.frame(mesh, factor));
        let angle = self.with_full_turns(after.angle - before.angle, factors[1] - factors[0]);
        RigidMotion { from: before.to, to: after.to, angle }
    }

    /// Returns an angle with the full turns that bring it closest to the mean rotation over a step of the load factor.
    fn with_full_turns(&self, angle: f64, step: f64) -> f64 {
        angle + TAU * ((step * self.mean_rotation() - angle) / TAU).round()
    }

    /// Iterates over the prescribed rotations of edges that are fixed in both directions, rad.
    fn rotations(&self) -> impl Iterator<Item = f64> {
        let is_held = |s: &&NodalSupport| s.nodes.len() > 1 && s.nodes.iter().any(|(_, own)| *own == [true; 2]);
        self.all.iter().filter(is_held).map(|s| s.rotation)
    }

    fn mean_rotation(&self) -> f64 {
        self.rotations().sum::<f64>() / self.rotations().count().max(1) as f64
    }

    /// Chooses the rotation of the frame, and the largest step in which no support rotates by more than [`LARGEST_TURN`]
    /// relative to it.
    fn set_frame(&mut self, mesh: &Mesh) {
        /// Steps of the load factor over one and a half of the motion.
        const STEP: f64 = 1.0 / 64.0;
        const COUNT: u32 = 96;
        /// Ratio of the distances between supports, after and before, below which the line through them may turn suddenly.
        const CLOSE: f64 = 0.1;
        let factors = || (0..=COUNT).map(|part| f64::from(part) * STEP);
        self.keeps_its_shape = factors().all(|factor| self.rigid_motion(mesh, factor, None).1 > CLOSE);
        let angles: Vec<f64> = factors().map(|factor| self.frame(mesh, factor).angle).collect();
        let turns = angles.windows(2).map(|pair| {
            let frame = self.with_full_turns(pair[1] - pair[0], STEP) / STEP;
            self.rotations().map(|rotation| (rotation - frame).abs()).fold(0.0, f64::max)
        });
        self.largest_load_step = (LARGEST_TURN / turns.fold(0.0, f64::max)).min(1.0);
    }

    /// Moves the body with the supports' frame from one load factor to another. Only the rest of the supports' motion
    /// deforms it. A component beside a fixed one of the same node moves as it does on the body at rest: it cannot be
    /// rotated with the frame, and the sum of its motions in several steps is thus that in one.
    pub(crate) fn carry_with_frame(&self, system: &System, factors: [f64; 2], state: &mut State) {
        if factors[0] == factors[1] {
            return;
        }
        let (mesh, u) = (system.mesh(), state.displacement.to_vec());
        let (before, motion) = (self.frame(mesh, factors[0]), self.frame_motion(mesh, factors));
        motion.apply(mesh, state);
        for (node, mask) in system.pattern().mask.iter().enumerate().filter(|(_, mask)| mask.x != mask.y) {
            let x = mesh.nodes()[node];
            let by = motion.displacement(x + before.displacement(x)) - motion.displacement(x + u[node]);
            (0..2).for_each(|axis| state.displacement.advance(node, axis, by[axis] * mask[axis]));
        }
    }

    /// Returns the rotation of the supports' frame at a load factor.
    pub(crate) fn frame_rotation(&self, mesh: &Mesh, factor: f64) -> Rotation {
        Rotation::from_angle(self.frame(mesh, factor).angle)
    }

    /// Moves the body by the rigid motion that best approximates the supports' motion to a load factor; the supports
    /// move with the body. Returns `true` if it rotated the body.
    pub(crate) fn carry(&self, mesh: &Mesh, factor: f64, state: &mut State) -> bool {
        /// Smallest angle, rad; smaller rotations are left to the solution of the equations.
        const SMALL: f64 = 1e-2;
        let mut motion = self.rigid_motion(mesh, factor, Some(&state.displacement)).0;
        if self.are_at_rest(&state.displacement) {
            // From rest the supports may make several full rotations; later steps are small.
            motion.angle = self.with_full_turns(motion.angle, factor);
        }
        let turns = motion.angle.abs() >= SMALL;
        if turns {
            motion.apply(mesh, state);
        }
        turns
    }
}

/// Rounding error of a displacement relative to the size of the body or of its displacement.
const SAME: f64 = 1e-12;

/// Returns `true` if two supports that both fix a component of a node prescribe the same displacement over their whole
/// motion.
fn agree(first: &NodalSupport, second: &NodalSupport, x: Vector2<f64>, axis: usize, size: f64) -> bool {
    [0.5, 1.0].iter().all(|&factor| {
        let [a, b] = [first, second].map(|support| support.take(x, factor, Kinematics::Corotated)[axis]);
        (a - b).abs() <= SAME * (size + a.abs())
    })
}
