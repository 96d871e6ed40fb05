//! Cuts of a mesh along a straight line at rest.

use nalgebra::Vector2;

use crate::assembly::{NodeWeights, weighted_sum};
use crate::element::lagrange;
use crate::mesh::{MaterialPoint, Mesh};
use crate::model::SectionLine;

/// Distance from the line that counts as rounding error, relative to the size of the body.
const ON_THE_LINE: f64 = 1e-9;
/// Number of pieces in which the cut of an element is divided whose stress is not linear.
const PIECES: u32 = 4;

/// Point of a cut.
#[derive(Clone, Debug)]
pub(super) struct CutPoint {
    /// Distance from [`SectionLine::at`] along the tangent, at rest, m.
    pub along: f64,
    /// Nodes and weights that interpolate to the point.
    pub weights: NodeWeights,
}

/// Connected part of a line inside a body.
#[derive(Debug)]
pub(super) struct Cut {
    /// Elements with nodes on both sides of the line.
    pub elements: Vec<usize>,
    /// Points along the tangent, from one side of the outline to the other.
    pub points: Vec<CutPoint>,
    /// Side of the cut on which nodes lie.
    pub side: Side,
}

/// Side of a line on which nodes lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    line: SectionLine,
    /// Distance beyond which a node is in front, m.
    least: f64,
}

impl Side {
    /// Returns the distance of a rest position from the line, m, positive in front.
    fn distance(&self, at: Vector2<f64>) -> f64 {
        self.line.normal().dot(&(at - self.line.at))
    }

    /// Returns the distance of a rest position from [`SectionLine::at`] along the tangent, m.
    pub fn along(&self, at: Vector2<f64>) -> f64 {
        self.line.tangent().dot(&(at - self.line.at))
    }

    /// Returns `true` if a rest position is in front.
    pub fn is_in_front(&self, at: Vector2<f64>) -> bool {
        self.distance(at) > self.least
    }

    /// Returns the parameters from −1 to 1 at which a side of an element, with nodes at these rest positions, crosses
    /// the line.
    pub fn crossings(&self, nodes: &[Vector2<f64>]) -> Vec<f64> {
        /// Bisections, to the last digit.
        const STEPS: u32 = 60;
        let parameter = |i: usize| 2.0 * i as f64 / (nodes.len() - 1) as f64 - 1.0;
        let distance = |xi: f64| -> f64 {
            lagrange(nodes.len(), xi).iter().zip(nodes).map(|((n, _), x)| n * self.distance(*x)).sum()
        };
        let mut crossings = Vec::new();
        for (i, ends) in nodes.windows(2).enumerate() {
            if self.is_in_front(ends[0]) == self.is_in_front(ends[1]) {
                continue;
            }
            let [mut behind, mut front] = [parameter(i), parameter(i + 1)];
            if self.is_in_front(ends[0]) {
                std::mem::swap(&mut behind, &mut front);
            }
            for _ in 0..STEPS {
                let middle = 0.5 * (behind + front);
                *(if distance(middle) > 0.0 { &mut front } else { &mut behind }) = middle;
            }
            crossings.push(behind);
        }
        crossings
    }
}

impl Cut {
    /// Returns all cuts along a line. A node on the line belongs to the part behind it; if no node is in front, to the
    /// part in front.
    pub fn all(mesh: &Mesh, size: f64, line: SectionLine) -> Vec<Self> {
        let rounding = ON_THE_LINE * size;
        let along = |least| Self::along(mesh, Side { line, least }, rounding);
        let cuts = along(rounding);
        if cuts.is_empty() { along(-rounding) } else { cuts }
    }

    fn along(mesh: &Mesh, side: Side, rounding: f64) -> Vec<Self> {
        let mut parts: Vec<(usize, [CutPoint; 2])> = (mesh.elements().enumerate())
            .filter_map(|(element, nodes)| Some((element, crossing(mesh, nodes, side)?)))
            .collect();
        parts.sort_by(|(_, a), (_, b)| a[0].along.total_cmp(&b[0].along));
        let mut cuts: Vec<Self> = Vec::new();
        let mut end = f64::NEG_INFINITY;
        for (element, [from, to]) in parts {
            if from.along > end + 2.0 * rounding {
                cuts.push(Self { elements: Vec::new(), points: vec![from.clone()], side });
                end = from.along;
            }
            let Some(cut) = cuts.last_mut() else { continue };
            cut.elements.push(element);
            // A part may touch the line in one point.
            if to.along > end + 2.0 * rounding {
                cut.points.extend(inside(mesh, element, [&from, &to], side.line));
                end = to.along;
                cut.points.push(to);
            }
        }
        cuts.retain(|cut| cut.points.len() > 1);
        cuts
    }

    /// Returns `true` if the cut contains a point of the line at this distance from [`SectionLine::at`], m.
    pub fn contains(&self, along: f64, size: f64) -> bool {
        let rounding = 2.0 * ON_THE_LINE * size;
        let [from, to] = [self.points.first(), self.points.last()].map(|point| point.map_or(f64::NAN, |p| p.along));
        (from - rounding..=to + rounding).contains(&along)
    }
}

/// Returns the two points in which a line crosses the outline of an element, in the order of the tangent; `None` if the
/// element's nodes are on one side.
fn crossing(mesh: &Mesh, nodes: &[u32], side: Side) -> Option<[CutPoint; 2]> {
    let is_in_front = |&node: &u32| side.is_in_front(mesh.node(node));
    if nodes.iter().all(is_in_front) || !nodes.iter().any(is_in_front) {
        return None;
    }
    let points = mesh.sides(nodes).flat_map(|segment| {
        let rest: Vec<Vector2<f64>> = segment.nodes().iter().map(|&node| mesh.node(node)).collect();
        let point = |xi: f64| {
            let weights: NodeWeights = segment
                .nodes()
                .iter()
                .zip(lagrange(rest.len(), xi))
                .map(|(&node, (weight, _))| (node, weight))
                .collect();
            CutPoint { along: side.along(weighted_sum(mesh.nodes(), &weights)), weights }
        };
        side.crossings(&rest).into_iter().map(point).collect::<Vec<_>>()
    });
    let mut points: Vec<CutPoint> = points.collect();
    points.sort_by(|a, b| a.along.total_cmp(&b.along));
    let last = points.pop()?;
    Some([points.into_iter().next()?, last])
}

/// Returns points of an element between two points of a cut; none if stresses are linear between them.
fn inside(mesh: &Mesh, element: usize, [from, to]: [&CutPoint; 2], line: SectionLine) -> Vec<CutPoint> {
    if mesh.entry().nodes.len() == 3 {
        return Vec::new();
    }
    (1..PIECES)
        .filter_map(|i| {
            let along = from.along + (to.along - from.along) * f64::from(i) / f64::from(PIECES);
            let at = mesh.place_in(element, line.at + line.tangent() * along)?;
            Some(CutPoint { along, weights: mesh.weights(MaterialPoint { element, at })? })
        })
        .collect()
}
