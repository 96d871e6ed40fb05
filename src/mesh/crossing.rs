//! Self-intersections of a body's outline: the model has no contact, so a body can pass through itself.

use nalgebra::Vector2;

use super::{Mesh, Segment};

/// Fraction of the distance to the centres of its elements by which a node is moved inwards, so that overlaps that are
/// smaller count as contact.
const INWARDS: f64 = 0.1;

/// Straight segment of the outline.
struct OutlinePiece {
    nodes: [u32; 2],
    ends: [Vector2<f64>; 2],
    /// Smallest and largest coordinate along the axis of the sweep.
    from: f64,
    to: f64,
}

impl Mesh {
    /// Returns `true` if a body with its nodes at `positions` passes through itself: two segments of a slightly smaller
    /// outline without a common node cross; `outline` is [`Self::outline`]. Sweep along the longer side of the body: the
    /// segments are sorted, and only those that overlap along this axis are compared.
    pub(crate) fn passes_through_itself(&self, outline: &[Segment], positions: &[Vector2<f64>]) -> bool {
        let positions = moved_inwards(self, positions);
        let start = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
        let (low, high) = positions.iter().fold(start, |(low, high), x| (low.inf(x), high.sup(x)));
        let size = high - low;
        if !(size.x.is_finite() && size.y.is_finite()) {
            return false;
        }
        let axis = usize::from(size.y > size.x);
        let mut pieces: Vec<OutlinePiece> = outline
            .iter()
            .flat_map(|side| side.nodes().windows(2))
            .filter_map(|nodes| {
                let nodes = [*nodes.first()?, *nodes.last()?];
                let ends = [*positions.get(nodes[0] as usize)?, *positions.get(nodes[1] as usize)?];
                let (a, b) = (ends[0][axis], ends[1][axis]);
                Some(OutlinePiece { nodes, ends, from: a.min(b), to: a.max(b) })
            })
            .collect();
        pieces.sort_by(|a, b| a.from.total_cmp(&b.from));
        let mut open: Vec<&OutlinePiece> = Vec::new();
        for piece in &pieces {
            open.retain(|other| other.to >= piece.from);
            if open.iter().any(|other| other.crosses(piece)) {
                return true;
            }
            open.push(piece);
        }
        false
    }
}

/// Returns the positions of the nodes of a slightly smaller body.
fn moved_inwards(mesh: &Mesh, positions: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut middles = vec![(Vector2::zeros(), 0.0); positions.len()];
    for nodes in mesh.elements() {
        let middle = nodes.iter().map(|&n| positions[n as usize]).sum::<Vector2<f64>>() / nodes.len() as f64;
        for &n in nodes {
            middles[n as usize].0 += middle;
            middles[n as usize].1 += 1.0;
        }
    }
    let own = positions.iter().zip(middles);
    own.map(|(x, (sum, count))| if count > 0.0 { x + (sum / count - x) * INWARDS } else { *x }).collect()
}

impl OutlinePiece {
    fn crosses(&self, other: &Self) -> bool {
        !self.nodes.iter().any(|node| other.nodes.contains(node)) && self.separates(other) && other.separates(self)
    }

    /// Returns `true` if the ends of `other` are on different sides of this segment's line.
    fn separates(&self, other: &Self) -> bool {
        let vector = self.ends[1] - self.ends[0];
        let [a, b] = other.ends.map(|end| vector.perp(&(end - self.ends[0])));
        a * b < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ElementKind, Scene, Simulation};

    /// Bends a beam of 10 m × 0.1 m with 60 × 1 cells into an arc of `angle`, rad, and returns `true` if it passes
    /// through itself.
    fn bent(element: ElementKind, angle: f64) -> bool {
        let scene = Scene::beam(10.0, 0.1).with_cells(60, 1).with_element(element).clamp("left");
        let simulation = Simulation::new(&scene).unwrap();
        let mesh = simulation.system().mesh();
        let radius = 10.0 / angle;
        let place = |x: &Vector2<f64>| {
            let (sin, cos) = (x.x / radius).sin_cos();
            Vector2::new((radius - x.y) * sin, radius - (radius - x.y) * cos)
        };
        let positions: Vec<_> = mesh.nodes().iter().map(place).collect();
        mesh.passes_through_itself(&mesh.outline(), &positions)
    }

    #[test]
    fn a_beam_that_is_rolled_beyond_a_circle_crosses_itself() {
        for element in ElementKind::all() {
            for (turns, crosses) in
                [(1e-9, false), (0.5, false), (0.95, false), (1.001, false), (1.05, true), (1.7, true)]
            {
                assert_eq!(bent(element, turns * std::f64::consts::TAU), crosses, "{element:?} {turns} of a circle");
            }
        }
    }

    /// A body whose sides lie on each other touches itself, and does not pass through itself.
    #[test]
    fn touching_is_not_crossing() {
        let scene = Scene::beam(4.0, 1.0).with_cells(8, 2).clamp("left");
        let simulation = Simulation::new(&scene).unwrap();
        let mesh = simulation.system().mesh();
        let outline = mesh.outline();
        // The body is folded about its middle, and the two halves overlap by a fraction of an element's height.
        let folded = |pressed: f64| -> Vec<_> {
            let fold = |x: &Vector2<f64>| {
                let angle = (std::f64::consts::PI * (x.x - 1.5)).clamp(0.0, std::f64::consts::PI);
                let (sin, cos) = angle.sin_cos();
                let beyond = (x.x - 2.5).max(0.0);
                let down = if x.x > 2.5 { pressed * beyond.min(1.0) } else { 0.0 };
                let radius = 0.5 - x.y;
                Vector2::new(x.x.min(1.5) + radius * sin - beyond, 0.5 - radius * cos - down)
            };
            mesh.nodes().iter().map(fold).collect()
        };
        assert!(!mesh.passes_through_itself(&outline, &folded(0.0)));
        assert!(!mesh.passes_through_itself(&outline, &folded(0.01)));
        assert!(mesh.passes_through_itself(&outline, &folded(0.3)));
        assert!(!mesh.passes_through_itself(&outline, &vec![Vector2::repeat(f64::NAN); mesh.nodes().len()]));
    }
}
