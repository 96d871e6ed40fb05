//! Projection from the plane of the body to the window, and the drawn body.

use crate::app::interface::*;
use crate::app::viewport::probe;

/// Projection from metres to window positions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    pub camera: Camera,
    pub rect: Rect,
}

impl Projection {
    /// Returns the window position of a point; positions far outside the view are clamped.
    pub(crate) fn point(&self, p: Vector2<f64>) -> Pos2 {
        let [x, y] = self.camera.to_view(p).map(|v| v.clamp(-1e5, 1e5) as f32);
        self.rect.center() + vec2(x, y)
    }

    /// Returns the point at a window position, m.
    pub(crate) fn place(&self, at: Pos2) -> Vector2<f64> {
        let at = at - self.rect.center();
        self.camera.to_world([f64::from(at.x), f64::from(at.y)])
    }

    /// Returns the part of a segment that is in or near the view. Coordinates far outside would lose their precision as
    /// `f32`.
    pub(crate) fn segment(&self, a: Vector2<f64>, b: Vector2<f64>) -> Option<[Pos2; 2]> {
        let half = [f64::from(self.rect.width()) * 0.5 + 16.0, f64::from(self.rect.height()) * 0.5 + 16.0];
        let [from, to] = clip(self.camera.to_view(a), self.camera.to_view(b), half)?;
        let place = |p: [f64; 2]| self.rect.center() + vec2(p[0] as f32, p[1] as f32);
        Some([place(from), place(to)])
    }
}

/// Drawn body, and the scene whose loads and other objects are drawn on it.
#[derive(Clone, Copy)]
pub(crate) struct DrawnBody<'a> {
    pub scene: &'a Scene,
    pub system: &'a System,
    pub geometry: &'a DisplayGeometry,
    /// Drawn positions of the nodes, m.
    pub positions: &'a [Vector2<f64>],
    pub projection: Projection,
    /// Simulated time, s.
    pub time: f64,
    /// Direction of the arrow of a zero force, degrees.
    pub direction: f64,
    /// Loads that the scene opens with.
    pub opening: OpeningLoads,
}

impl DrawnBody<'_> {
    pub(super) fn mesh(&self) -> &Mesh {
        self.system.mesh()
    }

    /// Returns the drawn position of a point of the body, m.
    pub(super) fn place(&self, rest: Vector2<f64>) -> Option<Vector2<f64>> {
        probe::place(self.mesh(), self.positions, self.mesh().locate(rest)?)
    }

    /// Returns the drawn point of application of a load or a support, m: the middle of its edge, its node, or its point of
    /// the body; `None` if the edge does not exist.
    pub(super) fn applied(&self, place: &Place, at_point: bool) -> Option<Vector2<f64>> {
        if let (Place::At(at), true) = (place, at_point)
            && let Some(point) = self.mesh().locate((*at).into())
        {
            return probe::place(self.mesh(), self.positions, point);
        }
        let nodes = match place {
            Place::Edge(name) => self.mesh().edge_nodes(name)?,
            Place::At(at) => vec![self.mesh().nearest_node((*at).into())],
        };
        let sum = nodes.iter().map(|&n| self.positions.get(n as usize)).sum::<Option<Vector2<f64>>>()?;
        (!nodes.is_empty()).then(|| sum / nodes.len() as f64)
    }
}

/// Returns the part of a segment inside the box |x| ≤ half₀, |y| ≤ half₁; Liang and Barsky 1984.
fn clip(a: [f64; 2], b: [f64; 2], half: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        for (p, q) in [(-d[axis], a[axis] + half[axis]), (d[axis], half[axis] - a[axis])] {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                enter = enter.max(q / p);
            } else {
                leave = leave.min(q / p);
            }
        }
    }
    let at = |t: f64| [a[0] + t * d[0], a[1] + t * d[1]];
    (enter <= leave).then(|| [at(enter), at(leave)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_clipped_to_the_box() {
        assert_eq!(clip([-20.0, 0.0], [20.0, 0.0], [10.0, 5.0]), Some([[-10.0, 0.0], [10.0, 0.0]]));
        assert_eq!(clip([0.0, 0.0], [1.0, 1.0], [10.0, 5.0]), Some([[0.0, 0.0], [1.0, 1.0]]));
        assert_eq!(clip([-20.0, 6.0], [20.0, 6.0], [10.0, 5.0]), None);
        let [a, b] = clip([0.0, 0.0], [1e12, 1e12], [10.0, 5.0]).unwrap();
        assert_eq!((a, b[0].round(), b[1].round()), ([0.0, 0.0], 5.0, 5.0));
    }
}
