//! Bases of the objects of a scene: the points of the body at which forces, supports, probes and sections are. A drag
//! moves them along the body.

use crate::app::interface::*;
use crate::app::viewport::objects::{Object, ObjectChange, rounded, snapped};
use crate::app::viewport::probe;
use crate::app::viewport::projection::DrawnBody;
use crate::section::cut_ends;

/// Distance from a base within which a press grabs it, and from a named edge or a corner within which the base moves to
/// it, points.
pub(super) const NEAR: f32 = 9.0;
/// Distance from the body within which the pointer moves a base, points.
const REACH: f64 = 80.0;

/// Distance within which an object moves to the outline or to the axis of a beam, points.
pub(crate) const CLOSE: f64 = 4.0;

/// Distance from the point of a section within which its end does not turn it, points.
const CLOSE_TO_POINT: f64 = 6.0;

/// Base of an object in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Base {
    pub object: Object,
    pub at: Pos2,
}

/// Base that is pressed, or under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PressedBase {
    pub base: Base,
    /// Position of the press.
    pub pressed: Pos2,
    /// Material point under the press.
    pub point: Option<MaterialPoint>,
    /// Position of the pointer once it has left the position of the press.
    pub dragged: Option<Pos2>,
}

impl DrawnBody<'_> {
    /// Returns the bases of all objects.
    pub(crate) fn bases(&self) -> Vec<Base> {
        let Scene { loads, supports, probes, sections: lines, .. } = self.scene;
        let forces = (0..).zip(loads).filter_map(|(i, load)| match load {
            Load::Force { place, at_point, .. } => Some((Object::Load(i), self.applied(place, *at_point)?)),
            _ => None,
        });
        let supports =
            (0..).zip(supports).filter_map(|(i, s)| Some((Object::Support(i), self.applied(&s.place, s.at_point)?)));
        let probes = (0..).zip(probes).filter_map(|(i, probe)| match probe.place {
            Place::At(at) => Some((Object::Probe(i), self.place(at.into())?)),
            // A probe on an edge usually lies at the arrow of a load, so it has no base.
            Place::Edge(_) => None,
        });
        let sections = (0..).zip(lines).filter_map(|(i, line)| Some((Object::Section(i), self.place(line.at)?)));
        let ends = (0..).zip(lines).flat_map(|(i, line)| self.ends_of_section(i, line));
        // A probe or a section that lies on a force or a support is in front.
        let all = probes.chain(sections).chain(forces).chain(supports).chain(ends);
        all.map(|(object, at)| Base { object, at: self.projection.point(at) }).collect()
    }

    /// Returns the ends of the cut of a section, with their drawn positions, m; without one at the point of the section.
    fn ends_of_section(&self, section: usize, line: &SectionLine) -> Vec<(Object, Vector2<f64>)> {
        /// Part of the cut between an end and its base, which rounding keeps inside the body.
        const INSIDE: f64 = 1e-6;
        let Some([from, to]) = cut_ends(self.system, *line) else { return Vec::new() };
        let far = |along: f64| f64::from(NEAR) < along.abs() * self.projection.camera.scale;
        let ends = [from + INSIDE * (to - from), to - INSIDE * (to - from)].into_iter().enumerate();
        let ends = ends.filter(|(_, along)| far(*along)).filter_map(|(end, along)| {
            Some((Object::SectionEnd(section, end), self.place(line.at + line.tangent() * along)?))
        });
        ends.collect()
    }

    /// Returns the line of a section whose end is dragged to a rest position, m, turned to a multiple of 15° if it is
    /// close to one.
    fn turned(&self, section: usize, end: usize, to: Vector2<f64>) -> Option<SectionLine> {
        /// Angle within which a section turns to a multiple of 15°, degrees.
        const CLOSE: f64 = 1.5;
        const STEP: f64 = 15.0;
        let line = *self.scene.sections.get(section)?;
        let tangent = if end == 0 { line.at - to } else { to - line.at };
        if tangent.norm() * self.projection.camera.scale < CLOSE_TO_POINT {
            return None;
        }
        let angle = (-tangent.x).atan2(tangent.y).to_degrees();
        let whole = STEP * (angle / STEP).round();
        let angle = if (angle - whole).abs() <= CLOSE { whole } else { angle.round() };
        Some(SectionLine { angle: (angle + 0.0).to_radians(), ..line })
    }

    /// Returns the place to which the pointer moves an object, and its drawn position, m: a named edge or a corner near
    /// the pointer, else the point of the body there; `None` far from the body.
    fn target(&self, object: Object, pointer: Pos2) -> Option<(Place, Vector2<f64>)> {
        let mesh = self.mesh();
        let distance = |at: Vector2<f64>| self.projection.point(at).distance(pointer);
        let can_be_on_edge = matches!(object, Object::Load(_) | Object::Support(_));
        let edges = mesh.edges().keys().filter(|_| can_be_on_edge);
        let edges = edges.filter_map(|name| {
            let edge = Place::from(name.as_str());
            let at = self.applied(&edge, false)?;
            // On a whole edge, a support of a point would also hold rotation: a pin would become a clamp. A force of a
            // point would be distributed.
            if !matches!(object.place(self.scene), Some(Place::At(_))) {
                return Some((edge, at));
            }
            let middle = DrawnBody { positions: mesh.nodes(), ..*self }.applied(&edge, false)?;
            Some((Place::At(rounded(self.system, middle).into()), at))
        });
        let at_node = |n: u32| Some((Place::At(mesh.node(n).into()), *self.positions.get(n as usize)?));
        let corners = mesh.edges().values().flat_map(|edge| ends(edge));
        let near = edges.chain(corners.filter_map(at_node)).filter(|(_, at)| distance(*at) <= NEAR);
        if let Some(nearest) = near.min_by(|(_, a), (_, b)| distance(*a).total_cmp(&distance(*b))) {
            return Some(nearest);
        }
        let world = self.projection.place(pointer);
        let point = mesh.pick(self.positions, &self.geometry.boundary, world, REACH / self.projection.camera.scale)?;
        let rest = probe::place(mesh, mesh.nodes(), point)?;
        let rest = snapped(self.system, &self.geometry.boundary, rest, CLOSE / self.projection.camera.scale);
        Some((Place::At(rest.into()), self.place(rest)?))
    }

    /// Returns the scene after an object has been dragged to `pointer`; `None` far from the body.
    pub(crate) fn moved(&self, object: Object, pointer: Pos2) -> Option<Scene> {
        let (place, _) = self.target(object, pointer)?;
        let mut scene = self.scene.clone();
        match (object, place) {
            (Object::SectionEnd(section, end), Place::At(at)) => {
                *scene.sections.get_mut(section)? = self.turned(section, end, at.into())?;
            }
            (_, place) => object.change(&mut scene, self.system, ObjectChange::Move(place)),
        }
        Some(scene)
    }

    /// Paints a ring at the base under the pointer, and at the place to which it is dragged, with the name of that
    /// place.
    pub(crate) fn paint_base(&self, painter: &Painter, hot: PressedBase, visuals: &egui::Visuals, color: Color32) {
        painter.circle_stroke(hot.base.at, NEAR, Stroke::new(1.5, color));
        let Some(pointer) = hot.dragged else { return };
        let Some((place, at)) = self.target(hot.base.object, pointer) else {
            let text = tr("not on the body: stays where it was");
            Labels::new(painter, visuals).add(pointer, Align2::CENTER_BOTTOM, text, color, 240.0);
            return;
        };
        let at = self.projection.point(at);
        let from = match hot.base.object {
            Object::SectionEnd(section, _) => self.scene.sections.get(section).and_then(|line| self.place(line.at)),
            _ => None,
        };
        let from = from.map_or(hot.base.at, |pivot| self.projection.point(pivot));
        painter.line_segment([from, at], Stroke::new(1.0, color));
        painter.circle_filled(at, 4.0, color);
        let text = match (place, hot.base.object) {
            (Place::At(to), Object::SectionEnd(section, end)) => {
                let turned = self.turned(section, end, to.into());
                turned.map_or_else(String::new, |line| {
                    fill!("normal %{angle}", angle = editable(line.angle.to_degrees(), "°"))
                })
            }
            (Place::Edge(name), _) => match hot.base.object {
                Object::Support(i) => match self.scene.supports.get(i).map(|support| support.fix.len()) {
                    Some(2) => fill!("clamp %{edge}", edge = tr(&name)),
                    _ => fill!("roller on %{edge}", edge = tr(&name)),
                },
                _ => tr(&name).to_owned(),
            },
            (Place::At(at), _) => engineering_pair(at.map(three_digits), "m"),
        };
        let above = at - vec2(0.0, 12.0);
        Labels::new(painter, visuals).add(above, Align2::CENTER_BOTTOM, &text, color, 240.0);
    }
}

/// Returns the nodes at the ends of an edge; none if it is closed.
fn ends(edge: &[Segment]) -> Vec<u32> {
    let all: Vec<u32> = edge.iter().flat_map(Segment::ends).collect();
    all.iter().copied().filter(|end| all.iter().filter(|other| *other == end).count() == 1).collect()
}
