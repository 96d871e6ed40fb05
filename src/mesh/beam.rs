//! Structured mesh of a scene's `[beam]`.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::{Mesh, MeshError, Segment};
use crate::model::{Beam, Diagonals};

impl Mesh {
    /// Returns the number of nodes of [`Self::beam`].
    pub fn beam_nodes(beam: &Beam) -> u64 {
        let pieces = beam.element.entry().degree() as u64;
        let [columns, rows] = beam.cells.map(|cells| u64::from(cells) * pieces + 1);
        columns.saturating_mul(rows)
    }

    /// Meshes the rectangle [0, length] × [−height/2, height/2], or the arch it is bent to, with two triangles or one
    /// quadrilateral per cell and the edges `left`, `right`, `bottom` and `top`. Nodes are numbered column by column,
    /// from the left and from below.
    ///
    /// # Errors
    /// [`MeshError::Degenerate`] if cells are too thin for their length.
    pub fn beam(beam: &Beam) -> Result<Self, MeshError> {
        let entry = beam.element.entry();
        // Every cell is a lattice of nodes with as many pieces per side as an element side.
        let pieces = entry.degree();
        let [nx, ny] = beam.cells.map(|n| n as usize);
        let [columns, rows] = [nx, ny].map(|n| n * pieces);
        let node = |[i, j]: [usize; 2]| (i * (rows + 1) + j) as u32;
        let nodes = (0..=columns)
            .flat_map(|i| (0..=rows).map(move |j| (i, j)))
            .map(|(i, j)| {
                let along = i as f64 / columns as f64;
                let across = j as f64 / rows as f64 - 0.5;
                bent(beam, along, beam.height * across)
            })
            .collect();
        // Weights of the corners for every node of an element.
        let weights: Vec<Vec<f64>> = entry.nodes.iter().map(|&at| (entry.cell.corner_weights)(at)).collect();
        let mut connectivity = Vec::with_capacity(2 * nx * ny * weights.len());
        for (i, j) in (0..nx).flat_map(|i| (0..ny).map(move |j| (i, j))) {
            let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[p, q]| [(i + p) * pieces, (j + q) * pieces]);
            let rising = beam.diagonals == Diagonals::Same || (i + j) % 2 == 0;
            let parts: &[&[[usize; 2]]] = match (entry.cell.corners.len(), rising) {
                (4, _) => &[&[a, b, c, d]],
                (_, true) => &[&[a, b, c], &[a, c, d]],
                (_, false) => &[&[a, b, d], &[b, c, d]],
            };
            for corners in parts {
                connectivity.extend(weights.iter().map(|weights| {
                    let place = |axis: usize| -> f64 {
                        corners.iter().zip(weights).map(|(corner, weight)| corner[axis] as f64 * weight).sum()
                    };
                    node([0, 1].map(|axis| place(axis).round() as usize))
                }));
            }
        }
        let edge = |points: Vec<u32>| -> Vec<Segment> {
            points.windows(pieces + 1).step_by(pieces).filter_map(Segment::new).collect()
        };
        let edges = BTreeMap::from([
            ("left".to_owned(), edge((0..=rows).map(|j| node([0, j])).collect())),
            ("right".to_owned(), edge((0..=rows).map(|j| node([columns, j])).collect())),
            ("bottom".to_owned(), edge((0..=columns).map(|i| node([i, 0])).collect())),
            ("top".to_owned(), edge((0..=columns).map(|i| node([i, rows])).collect())),
        ]);
        Self::new(nodes, beam.element, connectivity, edges)
    }
}

/// Returns the position, m, of a point of the beam: `along` runs from 0 to 1, `across` is the distance from the axis,
/// m. The axis of an arch is a parabola, and its sections are normal to the axis.
pub(crate) fn bent(beam: &Beam, along: f64, across: f64) -> Vector2<f64> {
    let x = beam.length * along;
    if beam.rise == 0.0 {
        return Vector2::new(x, across);
    }
    let slope = axis_slope(beam, along);
    let axis = Vector2::new(x, beam.axis(along));
    axis + Vector2::new(-slope, 1.0) * (across / slope.hypot(1.0))
}

/// Returns the direction of the axis at `along`, rad, counter-clockwise from the x axis: the normal of a section.
pub(crate) fn axis_angle(beam: &Beam, along: f64) -> f64 {
    axis_slope(beam, along).atan()
}

fn axis_slope(beam: &Beam, along: f64) -> f64 {
    4.0 * beam.rise * (1.0 - 2.0 * along) / beam.length
}

/// Inverts [`bent`]: returns `along` and `across`, m, of the point of the beam nearest to a position, m, to first
/// order.
pub(crate) fn straightened(beam: &Beam, at: Vector2<f64>) -> [f64; 2] {
    /// Upper limit; Newton's method on a parabola needs only a few steps.
    const STEPS: u32 = 50;
    let mut along = at.x / beam.length;
    if beam.rise != 0.0 {
        // The foot of the perpendicular on the axis: (at − axis(t)) · axis′(t) = 0.
        for _ in 0..STEPS {
            let slope = 4.0 * beam.rise * (1.0 - 2.0 * along);
            let (tangent, bend) = (Vector2::new(beam.length, slope), -8.0 * beam.rise);
            let arm = at - bent(beam, along, 0.0);
            // Gauss–Newton if the second derivative would reverse the step.
            let curvature = (tangent.norm_squared() - arm.y * bend).max(0.1 * tangent.norm_squared());
            let step = arm.dot(&tangent) / curvature;
            along += step;
            if step.abs() < 1e-15 {
                break;
            }
        }
    }
    let along = along.clamp(0.0, 1.0);
    let (foot, up) = (bent(beam, along, 0.0), bent(beam, along, 1.0));
    let half = 0.5 * beam.height;
    [along, (at - foot).dot(&(up - foot)).clamp(-half, half)]
}
