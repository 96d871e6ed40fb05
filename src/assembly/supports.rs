//! The unknowns that supports fix, and where they take them.

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::hold::{axes, nodes_of};
use super::{Kinematics, Matrix, NodeWeights, System};
use crate::displacement::Displacement;
use crate::element::{MatrixSum, Rotations, Tangent};
use crate::mesh::Mesh;
use crate::rotation::Rotation;
use crate::scene::{Invalid, Material, Place, Support};
use crate::state::State;
use crate::words::number;

/// A support on the nodes of a mesh: what it holds, and where it takes it.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalSupport {
    /// Where the scene puts it.
    pub place: Place,
    /// The nodes it holds, and whether it holds them along x and y. What several supports fix is the first one's.
    pub nodes: Vec<(u32, [bool; 2])>,
    /// Nodes with their part of the place: the middle of an edge is their weighted mean.
    pub weights: NodeWeights,
    /// Where it takes the place at full load, m.
    pub displacement: Vector2<f64>,
    /// How far it turns it about its middle, rad.
    pub turn: f64,
    /// The middle at rest, m.
    pub middle: Vector2<f64>,
}

impl NodalSupport {
    fn moves(&self) -> bool {
        self.turn != 0.0 || self.displacement != Vector2::zeros()
    }

    /// Where it takes a point that is at `x` at rest, as a displacement, m: u = (R(λφ) − I)(X − M) + λd, the angle and
    /// the way growing with the load factor λ. Linear theory knows no finite turn: there u = λ(φ × (X − M) + d), so that a turn
    /// of all supports makes no strain of it.
    fn take(&self, x: Vector2<f64>, factor: f64, kinematics: Kinematics) -> Vector2<f64> {
        if !self.moves() {
            return Vector2::zeros();
        }
        let arm = x - self.middle;
        let angle = factor * self.turn;
        let turned = match kinematics {
            Kinematics::Linear => Vector2::new(-arm.y, arm.x) * angle,
            Kinematics::Corotated => {
                // cos − 1 = −2 sin² of half the angle keeps the digits of small turns.
                let (s, versine) = (angle.sin(), -2.0 * (0.5 * angle).sin().powi(2));
                Vector2::new(versine * arm.x - s * arm.y, s * arm.x + versine * arm.y)
            }
        };
        turned + self.displacement * factor
    }
}

/// The supports of a scene on the nodes of its mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Supports {
    all: Vec<NodalSupport>,
    moves: bool,
    largest_load_step: f64,
    /// Diagonal of the stiffness at rest over the free unknowns, N/m, of supports that move.
    diagonal: Vec<f64>,
}

/// A motion of the body as a whole: a turn about a point, and a way.
#[derive(Clone, Copy, Debug)]
struct RigidMotion {
    from: Vector2<f64>,
    to: Vector2<f64>,
    angle: f64,
}

/// The largest angle by which a support may turn against the others in a load step, rad: elements beside it are turned by
/// it in one go, and fold over where it is a right angle or more.
pub(crate) const LARGEST_TURN: f64 = 0.5;

impl Supports {
    /// The supports of a scene on its system.
    pub(super) fn new(supports: &[Support], material: &Material, system: &System) -> Result<Self, Invalid> {
        let mesh = system.mesh();
        let mut owner: HashMap<(u32, usize), usize> = HashMap::new();
        let mut all: Vec<NodalSupport> = Vec::with_capacity(supports.len());
        for (i, support) in supports.iter().enumerate() {
            let key = format!("support.{i}");
            let nodes = nodes_of(support, mesh, &key)?;
            let weights = match &support.place {
                Place::Edge(name) => system.edge(name, &key)?.1.weights().to_vec(),
                Place::At(_) => nodes.iter().map(|&node| (node, 1.0)).collect(),
            };
            let middle = weights.iter().map(|&(node, weight)| mesh.node(node) * weight).sum();
            let place = support.place.clone();
            let (displacement, turn) = (support.displacement.into(), support.turn);
            let mut new = NodalSupport { place, nodes: Vec::new(), weights, displacement, turn, middle };
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
                        let message =
                            format!("expected what support.{first} does to the node at {there}, which both fix");
                        return Err(Invalid::new(&key, message));
                    }
                }
                new.nodes.push((node, own));
            }
            all.push(new);
        }
        let moves = all.iter().any(NodalSupport::moves);
        let mut result = Self { all, moves, largest_load_step: 1.0, diagonal: Vec::new() };
        if moves {
            result.largest_load_step = result.load_step_within(mesh, LARGEST_TURN);
            result.set_stiffness(material, system);
        }
        Ok(result)
    }

    /// Takes another material on.
    pub(super) fn set_stiffness(&mut self, material: &Material, system: &System) {
        if !self.moves {
            return;
        }
        let (rest, mut matrix) = (system.at_rest(), Matrix::new(system.pattern()));
        let mut scratch = [rest.displacement.to_vec(), rest.displacement.to_vec()];
        let [force, magnitude] = &mut scratch;
        let sum = MatrixSum { tangent: Tangent::WARPED, slots: system.slots(), values: matrix.slots() };
        let (elements, moduli) = (system.elements(), material.membrane());
        let rotations = Rotations::Given(&rest.rotations);
        elements.linearize(moduli, rest.compensated(), rotations, force, magnitude, Some(sum));
        self.diagonal = matrix.diagonal(system.pattern()).collect();
    }

    /// One for every support of the scene.
    #[must_use]
    pub fn all(&self) -> &[NodalSupport] {
        &self.all
    }

    /// Whether any is taken somewhere else than it is at rest.
    #[must_use]
    pub fn move_the_body(&self) -> bool {
        self.moves
    }

    /// The largest part of the way that may be made in one load step from rest.
    pub(crate) fn largest_load_step(&self) -> f64 {
        self.largest_load_step
    }

    /// What rounding leaves of forces that balance, N, for this displacement of supports that move: a body that is only
    /// carried elsewhere has no forces to compare a residual with.
    pub(super) fn rounding(&self, system: &System, u: &[Vector2<f64>]) -> f64 {
        /// A few roundings.
        const ROUNDING: f64 = 2e-15;
        let free = self.diagonal.iter().zip(system.pattern().free());
        let squares = free.map(|(k, &unknown)| (k * u[unknown as usize / 2][unknown as usize % 2]).powi(2));
        ROUNDING * squares.sum::<f64>().sqrt()
    }

    /// Every component that is fixed, as a node and an axis, with its displacement at this load factor, m.
    fn targets(&self, mesh: &Mesh, factor: f64, kinematics: Kinematics) -> impl Iterator<Item = (u32, usize, f64)> {
        self.all.iter().flat_map(move |support| {
            support.nodes.iter().flat_map(move |&(node, own)| {
                let u = support.take(mesh.node(node), factor, kinematics);
                (0..2).filter(move |&axis| own[axis]).map(move |axis| (node, axis, u[axis]))
            })
        })
    }

    /// Puts the fixed components of a displacement where the supports take them at this load factor.
    pub(crate) fn put(&self, mesh: &Mesh, factor: f64, kinematics: Kinematics, u: &mut Displacement) {
        for (node, axis, target) in self.targets(mesh, factor, kinematics) {
            u.put(node, axis, target);
        }
    }

    /// Whether the fixed components of a displacement are exactly where [`Self::put`] puts them. Exactly: after a full
    /// turn they are at rest again but for rounding, and the body is not.
    pub(crate) fn are_at(&self, mesh: &Mesh, factor: f64, kinematics: Kinematics, u: &[Vector2<f64>]) -> bool {
        self.targets(mesh, factor, kinematics).all(|(node, axis, target)| u[node as usize][axis] == target)
    }

    /// Whether the fixed components of a displacement are those at rest.
    pub(crate) fn are_at_rest(&self, u: &[Vector2<f64>]) -> bool {
        self.fixed().all(|(node, axis)| u[node as usize][axis] == 0.0)
    }

    fn fixed(&self) -> impl Iterator<Item = (u32, usize)> {
        let nodes = self.all.iter().flat_map(|support| &support.nodes);
        nodes.flat_map(|&(node, own)| (0..2).filter(move |&axis| own[axis]).map(move |axis| (node, axis)))
    }

    /// The rigid motion that comes nearest to what takes the fixed components from this displacement to where they are at
    /// a load factor (least squares; the angle in closed form, as that of a polar factor).
    fn rigid_motion(&self, mesh: &Mesh, factor: f64, u: &[Vector2<f64>]) -> RigidMotion {
        let mut ways: BTreeMap<u32, [Vector2<f64>; 2]> = BTreeMap::new();
        for (node, axis, target) in self.targets(mesh, factor, Kinematics::Corotated) {
            let now = mesh.node(node) + u[node as usize];
            ways.entry(node).or_insert([now; 2])[1][axis] = mesh.node(node)[axis] + target;
        }
        let count = ways.len().max(1) as f64;
        let [from, to] = [0, 1].map(|end| ways.values().map(|way| way[end]).sum::<Vector2<f64>>() / count);
        let (c, s) = ways.values().fold((0.0, 0.0), |(c, s), way| {
            let (a, b) = (way[0] - from, way[1] - to);
            (c + a.dot(&b), s + a.perp(&b))
        });
        let angle = f64::atan2(s, c);
        RigidMotion { from, to, angle: if angle.is_finite() { angle } else { 0.0 } }
    }

    /// The turns of the edges that are held in both directions, rad.
    fn turns(&self) -> impl Iterator<Item = f64> {
        let is_held = |s: &&NodalSupport| s.nodes.len() > 1 && s.nodes.iter().any(|(_, own)| *own == [true; 2]);
        self.all.iter().filter(is_held).map(|s| s.turn)
    }

    fn mean_turn(&self) -> f64 {
        self.turns().sum::<f64>() / self.turns().count().max(1) as f64
    }

    /// The largest part of the way from rest in which no support turns by more than `angle` against the body as a whole.
    fn load_step_within(&self, mesh: &Mesh, angle: f64) -> f64 {
        let rest = vec![Vector2::zeros(); mesh.nodes().len()];
        let whole = self.rigid_motion(mesh, 1.0, &rest).angle;
        let whole = whole + TAU * ((self.mean_turn() - whole) / TAU).round();
        let largest = self.turns().map(|turn| (turn - whole).abs()).fold(0.0, f64::max);
        if largest > angle { angle / largest } else { 1.0 }
    }

    /// Carries the body along as a whole, as near as a rigid motion comes to the way of the supports from where they are
    /// to a load factor; supports are left where that takes them. Returns whether it turned.
    pub(crate) fn carry(&self, mesh: &Mesh, factor: f64, state: &mut State) -> bool {
        /// A turn by less is made good by linear theory of the small.
        const SMALL: f64 = 1e-2;
        let at_rest = self.are_at_rest(&state.displacement);
        let RigidMotion { from, to, mut angle } = self.rigid_motion(mesh, factor, &state.displacement);
        if at_rest {
            // From rest they may go round several times; afterwards their steps are small.
            angle += TAU * ((factor * self.mean_turn() - angle) / TAU).round();
        }
        if angle.abs() < SMALL {
            return false;
        }
        let turn = Rotation::from_angle(angle);
        for (u, x) in state.displacement.overwrite().iter_mut().zip(mesh.nodes()) {
            *u = turn.apply(x + *u - from) + to - x;
        }
        for r in &mut state.rotations {
            *r = Rotation { c: turn.c * r.c - turn.s * r.s, s: turn.s * r.c + turn.c * r.s };
        }
        state.turns.iter_mut().for_each(|t| *t += angle);
        true
    }
}

/// `true` if two supports take a component of a node that both fix to the same place on all of their path.
fn agree(first: &NodalSupport, second: &NodalSupport, x: Vector2<f64>, axis: usize, size: f64) -> bool {
    /// Rounding, over the size of the body.
    const SAME: f64 = 1e-12;
    [0.5, 1.0].iter().all(|&factor| {
        let [a, b] = [first, second].map(|support| support.take(x, factor, Kinematics::Corotated)[axis]);
        (a - b).abs() <= SAME * (size + a.abs())
    })
}
