//! Thumbnail of a scene: the body at rest as an outline, and its equilibrium or a state of its motion, coloured as in
//! the view.

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Painter, Pos2, Rect, Shape as Painted, Stroke, vec2};
use nalgebra::Vector2;

use crate::app::task::sent_scene::SentScene;
use crate::app::view_options::ViewOptions;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::widgets::palette::Palette;
use crate::method::is_useful_start;
use crate::render::display_geometry::DisplayGeometry;
use crate::render::{Camera, Margins};
use crate::scene::Scene;
use crate::simulation::{Field, Simulation, Status};

/// Time at which a motion is shown, s.
const MOMENT: f64 = 0.4;
/// Largest number of iterations or time steps; large bodies have fewer.
const MAX_STEPS: usize = 200;
/// Largest product of unknowns and steps, unless that gives fewer steps than `MIN_STEPS`.
const WORK: usize = 400_000;
const MIN_STEPS: usize = 8;

/// Drawing of a scene.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Thumbnail {
    scene: SentScene,
    field: Field,
    /// Values of the field at both ends of the colour map.
    range: [f64; 2],
    /// Positions of the drawn points, m: at rest, and displaced.
    rest: Vec<Vector2<f64>>,
    moved: Vec<Vector2<f64>>,
    /// Lines of the outline, as indices of points.
    outline: Vec<Vec<u32>>,
    triangles: Vec<[u32; 3]>,
    /// Values of the field at the drawn points.
    values: Vec<Option<f64>>,
}

impl Thumbnail {
    /// Computes the state that the thumbnail shows, or an earlier one if `is_cancelled` returns `true`; `None` if the
    /// scene cannot be set up.
    pub(super) fn of(scene: &Scene, is_cancelled: impl Fn() -> bool) -> Option<Self> {
        let mut simulation = Simulation::new(scene).ok()?;
        simulation.keep_ledger(false);
        let most = (WORK / simulation.system().dofs().max(1)).clamp(MIN_STEPS, MAX_STEPS);
        for _ in 0..most {
            let goes_on = *simulation.status() == Status::Running && simulation.state().time() < MOMENT;
            if !goes_on || is_cancelled() {
                break;
            }
            simulation.step();
        }
        if !is_useful_start(simulation.system(), simulation.state()) {
            simulation.reset();
        }
        let mesh = simulation.system().mesh();
        let (geometry, view) = (DisplayGeometry::new(mesh), ViewOptions::default());
        let (mut rest, mut body_mesh) = (Vec::new(), BodyMesh::default());
        geometry.points(&|n| mesh.nodes()[n as usize], &mut rest);
        body_mesh.update(&simulation, &geometry, (&view, None), 1.0, None);
        let moved = body_mesh.points().to_vec();
        let (values, range) = (body_mesh.values(), body_mesh.range);
        let DisplayGeometry { outline, triangles, .. } = geometry;
        Some(Self {
            scene: SentScene(scene.clone()),
            field: view.field,
            range,
            rest,
            moved,
            outline,
            triangles,
            values,
        })
    }

    /// Paints the thumbnail in the middle of `place`, as large as possible.
    pub(super) fn paint(&self, painter: &Painter, place: Rect, palette: &Palette) {
        const MARGIN: f64 = 7.0;
        let infinity = Vector2::repeat(f64::INFINITY);
        let points = || self.rest.iter().chain(&self.moved);
        let (low, high) = points().fold((infinity, -infinity), |(low, high), p| (low.inf(p), high.sup(p)));
        let size = [place.width(), place.height()].map(f64::from);
        let camera = Camera::fit(low, high, size, Margins { sides: MARGIN, top: MARGIN, bottom: MARGIN });
        let to_window = |p: &Vector2<f64>| {
            let [x, y] = camera.to_view(*p).map(|v| v as f32);
            place.center() + vec2(x, y)
        };
        let moved: Vec<Pos2> = self.moved.iter().map(to_window).collect();
        let rest: Vec<Pos2> = self.rest.iter().map(to_window).collect();
        painter.extend(self.lines(&rest, Stroke::new(1.0, palette.rest)));
        painter.add(self.body(&moved, palette));
        painter.extend(self.lines(&moved, Stroke::new(1.0, palette.solution(&self.scene.0))));
    }

    fn lines(&self, points: &[Pos2], stroke: Stroke) -> Vec<Painted> {
        /// Points closer together than this, in points of the window, are merged.
        const NEAR: f32 = 0.7;
        let line = |numbers: &Vec<u32>| {
            let mut line: Vec<Pos2> = Vec::new();
            for &at in numbers.iter().filter_map(|&p| points.get(p as usize)) {
                if line.last().is_none_or(|last| last.distance(at) > NEAR) {
                    line.push(at);
                }
            }
            Painted::closed_line(line, stroke)
        };
        self.outline.iter().map(line).collect()
    }

    fn body(&self, points: &[Pos2], palette: &Palette) -> Mesh {
        let (map, [low, high]) = (palette.map(self.field), self.range);
        let color = |value: Option<f64>| {
            value.map_or(palette.absent, |value| {
                let [r, g, b] = map.color(((value - low) / (high - low)).clamp(0.0, 1.0));
                Color32::from_rgb(r, g, b)
            })
        };
        let mut mesh = Mesh::default();
        let vertices = points.iter().zip(&self.values);
        mesh.vertices.extend(vertices.map(|(&pos, &value)| Vertex { pos, uv: WHITE_UV, color: color(value) }));
        self.triangles.iter().for_each(|&[a, b, c]| mesh.add_triangle(a, b, c));
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Analysis, Source, open, registry};

    fn of(id: &str) -> Thumbnail {
        let scene = open(&Source { name: id.into(), assignments: Vec::new() }).unwrap();
        Thumbnail::of(&scene, || false).unwrap()
    }

    /// Every scene has a thumbnail, whose body is displaced: at the equilibrium, or away from the start.
    #[test]
    fn a_thumbnail_shows_the_deformed_body() {
        for built_in in registry::BUILT_IN {
            let thumbnail = of(built_in.id);
            let size = {
                let (low, high) = thumbnail
                    .rest
                    .iter()
                    .fold((thumbnail.rest[0], thumbnail.rest[0]), |(l, h), p| (l.inf(p), h.sup(p)));
                (high - low).norm()
            };
            let distance = thumbnail.rest.iter().zip(&thumbnail.moved).map(|(a, b)| (b - a).norm()).fold(0.0, f64::max);
            assert!(
                distance > 0.01 * size && distance < 3.0 * size,
                "{}: moved by {distance} of {size} m",
                built_in.id
            );
            assert!(thumbnail.range[0] < thumbnail.range[1] && !thumbnail.outline.is_empty(), "{}", built_in.id);
            assert_eq!(thumbnail.moved.len(), thumbnail.values.len());
            if thumbnail.scene.0.analysis == Analysis::Static {
                let mut solved = Simulation::new(&thumbnail.scene.0).unwrap();
                solved.solve();
                let furthest = solved.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
                assert!((distance / furthest - 1.0).abs() < 1e-3, "{}: {distance} is not {furthest}", built_in.id);
            }
        }
    }

    /// A cancelled thumbnail shows the body at rest.
    #[test]
    fn a_thumbnail_can_be_cancelled() {
        let scene = open(&Source { name: "article".into(), assignments: Vec::new() }).unwrap();
        let thumbnail = Thumbnail::of(&scene, || true).unwrap();
        assert_eq!(thumbnail.rest, thumbnail.moved);
    }
}
