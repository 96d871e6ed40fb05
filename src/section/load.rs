//! Loads and reactions between a line and the nodes in front of it.
//!
//! Weight, inertia, edge loads, and forces and reactions at points act on nodes in the discrete problem. The nodes in front of a line carry other loads than the
//! part of the body in front of it; the difference is that of the elements which the line crosses.

use std::borrow::Cow;
use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::cut::{Cut, Side};
use crate::assembly::{NodeWeights, Problem, weighted_sum};
use crate::element::{Lame, integrate_side, side_weights};
use crate::mesh::{MaterialPoint, Mesh};
use crate::scene::{Load, Place, Pulse};

/// Force and moment about a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Wrench {
    /// Force, N.
    pub force: Vector2<f64>,
    /// Moment about the point, N m, counter-clockwise.
    pub moment: f64,
}

impl Wrench {
    /// Adds a force at the end of an arm from the point.
    pub(crate) fn add(&mut self, arm: Vector2<f64>, force: Vector2<f64>) {
        self.force += force;
        self.moment += arm.perp(&force);
    }
}

/// Forces and accelerations of a state that sections balance.
#[derive(Debug)]
pub(crate) struct NodalBalance<'a> {
    /// Factor of the loads.
    pub load_factor: f64,
    /// Forces minus inertia of every node, N: on fixed unknowns minus the reaction.
    pub residual: Cow<'a, [Vector2<f64>]>,
    /// Force of the mouse spring, N.
    pub mouse_spring: Vector2<f64>,
    /// Inertia and viscous stress; `None` at rest.
    pub motion: Option<MotionBalance>,
}

/// Part of the balance that a body at rest lacks.
#[derive(Debug)]
pub(crate) struct MotionBalance {
    /// Acceleration of every node plus that of mass-proportional damping, m/s².
    pub acceleration: Vec<Vector2<f64>>,
    /// Moduli of the viscous stress, N s/m.
    pub viscosity: Lame,
    /// Displacement at which the viscous stress acts, m.
    pub damped: Vec<Vector2<f64>>,
}

/// Returns the loads, the reactions and the inertia of the part of a body in front of a cut, minus those of the nodes in
/// front: force, N, and moment about `middle`, N m, with the nodes at `positions`: those of rest in linear theory.
pub(super) fn beyond_nodes(
    problem: &Problem,
    positions: &[Vector2<f64>],
    cut: &Cut,
    (balance, time): (&NodalBalance<'_>, f64),
    middle: Vector2<f64>,
) -> Wrench {
    let mesh = problem.system().mesh();
    let mut beyond = BeyondNodes { mesh, positions, cut, middle, sum: Wrench::default() };
    for (support, force) in problem.supports().point_forces(&balance.residual) {
        let Place::At(at) = support.place else { continue };
        beyond.add_point_load((at, support.width), force);
    }
    if let Some(spring) = problem.mouse_spring() {
        beyond.add_material_load(spring.point(), balance.mouse_spring);
    }
    let factor = |pulse: &Option<Pulse>| balance.load_factor * pulse.as_ref().map_or(1.0, |pulse| pulse.factor(time));
    let mut gravity = Vector2::zeros();
    for load in &problem.scene_loads {
        match load {
            Load::Gravity { acceleration, pulse } => gravity += Vector2::from(*acceleration) * factor(pulse),
            Load::Force { place: Place::Edge(name), force, pulse, .. } => {
                beyond.add_edge_load(name, Vector2::from(*force) * factor(pulse));
            }
            Load::Force { place: Place::At(at), at_point: true, width, force, pulse } => {
                beyond.add_point_load((*at, *width), Vector2::from(*force) * factor(pulse));
            }
            _ => {}
        }
    }
    let acceleration = balance.motion.as_ref().map(|motion| motion.acceleration.as_slice());
    if gravity != Vector2::zeros() || acceleration.is_some() {
        let density = problem.material().area_density();
        for &element in &cut.elements {
            beyond.add_body_force(element, |weights| {
                let inertia =
                    acceleration.map_or_else(Vector2::zeros, |acceleration| weighted_sum(acceleration, weights));
                (gravity - inertia) * density
            });
        }
    }
    beyond.sum
}

/// Sum of the forces on the part of a body in front of a cut, minus those on the nodes in front.
struct BeyondNodes<'a> {
    mesh: &'a Mesh,
    /// Current positions of the nodes, m.
    positions: &'a [Vector2<f64>],
    cut: &'a Cut,
    /// Point that moments refer to, m.
    middle: Vector2<f64>,
    sum: Wrench,
}

impl BeyondNodes<'_> {
    /// Adds a force, N, at an interpolated point.
    fn add(&mut self, weights: &[(u32, f64)], force: Vector2<f64>) {
        self.sum.add(weighted_sum(self.positions, weights) - self.middle, force);
    }

    /// Subtracts the parts of a force, N, on these nodes, as far as they are in front.
    fn subtract(&mut self, weights: &[(u32, f64)], force: Vector2<f64>) {
        let side = self.cut.side;
        for &(node, weight) in weights.iter().filter(|(node, _)| side.is_in_front(self.mesh.node(*node))) {
            self.sum.add(self.positions[node as usize] - self.middle, force * -weight);
        }
    }

    /// Adds a force per area, N/m², on the part of an element in front, minus that on its nodes in front.
    fn add_body_force(&mut self, element: usize, per_area: impl Fn(&[(u32, f64)]) -> Vector2<f64>) {
        let (mesh, entry) = (self.mesh, self.mesh.entry());
        let Some(nodes) = mesh.elements().nth(element) else { return };
        let rest: Vec<Vector2<f64>> = nodes.iter().map(|&node| mesh.node(node)).collect();
        let at_place = |place: [f64; 2], area: f64| -> (NodeWeights, Vector2<f64>) {
            let weights: NodeWeights = nodes.iter().copied().zip((entry.shape)(place)).collect();
            let force = per_area(&weights) * (area * entry.jacobian(&rest, place).determinant());
            (weights, force)
        };
        for point in entry.mass_points {
            let (weights, force) = at_place(point.at, point.weight);
            self.subtract(&weights, force);
        }
        for line in outline_in_front(mesh, element, &rest, self.cut.side) {
            visit_fan(&line, &mut |place, area| {
                let (weights, force) = at_place(place.into(), area);
                self.add(&weights, force);
            });
        }
    }

    /// Adds the force, N, around a place, over a width, m, as [`Self::add_material_load`] does.
    fn add_point_load(&mut self, (at, width): ([f64; 2], f64), force: Vector2<f64>) {
        let is_near = self.cut.elements.iter().any(|&element| self.mesh.is_near(element, at.into(), width));
        for (point, share) in is_near.then(|| self.mesh.points_over(at.into(), width)).flatten().into_iter().flatten() {
            self.add_material_load(point, force * share);
        }
    }

    /// Adds the force, N, at a point inside an element of the cut if the point is in front, minus its parts on the nodes
    /// in front.
    fn add_material_load(&mut self, point: MaterialPoint, force: Vector2<f64>) {
        if !self.cut.elements.contains(&point.element) {
            return;
        }
        let Some(weights) = self.mesh.weights(point) else { return };
        self.subtract(&weights, force);
        if self.cut.side.is_in_front(weighted_sum(self.mesh.nodes(), &weights)) {
            self.add(&weights, force);
        }
    }

    /// Adds the part of an edge's total load, N, in front, minus that of its nodes in front, on the sides of the cut's
    /// elements.
    fn add_edge_load(&mut self, name: &str, total: Vector2<f64>) {
        let (mesh, cut) = (self.mesh, self.cut);
        let Some(segments) = mesh.edges().get(name) else { return };
        let rest = |nodes: &[u32]| -> Vec<Vector2<f64>> { nodes.iter().map(|&node| mesh.node(node)).collect() };
        let length: f64 = segments.iter().flat_map(|segment| side_weights(&rest(segment.nodes()))).sum();
        let per_length = total / length;
        let elements = cut.elements.iter().filter_map(|&element| mesh.elements().nth(element));
        let crossed: BTreeSet<[u32; 2]> = elements.flat_map(|nodes| mesh.sides(nodes)).map(|side| side.key()).collect();
        let side = cut.side;
        for segment in segments.iter().filter(|segment| crossed.contains(&segment.key())) {
            let nodes = rest(segment.nodes());
            let shares: NodeWeights = segment.nodes().iter().copied().zip(side_weights(&nodes)).collect();
            self.subtract(&shares, per_length);
            let mut ends = vec![-1.0];
            ends.extend(side.crossings(&nodes));
            ends.push(1.0);
            let mut is_in_front = nodes.first().is_some_and(|&at| side.is_in_front(at));
            for part in ends.windows(2) {
                if is_in_front {
                    integrate_side(&nodes, [part[0], part[1]], |shape, length| {
                        let weights: NodeWeights = segment.nodes().iter().copied().zip(shape.iter().copied()).collect();
                        self.add(&weights, per_length * length);
                    });
                }
                is_in_front = !is_in_front;
            }
        }
    }
}

/// Points of a line on the outline of a part of an element, in reference coordinates, with their weights: the steps
/// along the line that they stand for.
type OutlinePoints = Vec<(Vector2<f64>, Vector2<f64>)>;

/// Gauss points and weights on [0, 1], exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_5, 0.239_314_335_249_683_2),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_2),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];

/// Returns the outline of the part of an element in front at rest, counter-clockwise: parts of its sides, curved or not,
/// and of the line of the cut.
fn outline_in_front(mesh: &Mesh, element: usize, rest: &[Vector2<f64>], side: Side) -> Vec<OutlinePoints> {
    let entry = mesh.entry();
    let (mut outline, mut crossings) = (Vec::new(), Vec::new());
    for own in entry.sides {
        let (Some(&first), Some(&last)) = (own.first(), own.last()) else { continue };
        let nodes: Vec<Vector2<f64>> = own.iter().map(|&node| rest[node]).collect();
        let [from, to] = [first, last].map(|node| Vector2::from(entry.nodes[node]));
        let place = |xi: f64| from + (to - from) * (0.5 * (xi + 1.0));
        let mut ends = vec![-1.0];
        ends.extend(side.crossings(&nodes));
        crossings.extend(ends[1..].iter().map(|&xi| place(xi)));
        ends.push(1.0);
        let mut is_in_front = side.is_in_front(nodes[0]);
        for part in ends.windows(2) {
            if is_in_front {
                let [from, to] = [place(part[0]), place(part[1])];
                outline.push(GAUSS.map(|(s, weight)| (from + (to - from) * s, (to - from) * weight)).to_vec());
            }
            is_in_front = !is_in_front;
        }
    }
    let position = |place: &Vector2<f64>| -> Vector2<f64> {
        rest.iter().zip((entry.shape)((*place).into())).map(|(x, n)| x * n).sum()
    };
    let mut crossings: Vec<Vector2<f64>> = crossings.iter().map(position).collect();
    crossings.sort_by(|a, b| side.along(*b).total_cmp(&side.along(*a)));
    // The part in front is on the left of the cut seen against its tangent.
    for pair in crossings.chunks_exact(2) {
        let step = pair[1] - pair[0];
        let point = |(s, weight): (f64, f64)| {
            let place = mesh.place_in(element, pair[0] + step * s)?;
            Some((place.into(), entry.jacobian(rest, place).try_inverse()? * step * weight))
        };
        outline.push(GAUSS.into_iter().filter_map(point).collect());
    }
    outline
}

/// Calls `visit` at points of the triangle between a line and the origin of the reference coordinates, with the area in
/// reference coordinates that each stands for, negative where the line runs clockwise. For the lines of a closed outline,
/// the integral of a polynomial is that over the area inside.
fn visit_fan(line: &[(Vector2<f64>, Vector2<f64>)], visit: &mut dyn FnMut(Vector2<f64>, f64)) {
    for (place, step) in line {
        for (radius, weight) in GAUSS {
            visit(place * radius, weight * radius * place.perp(step));
        }
    }
}
