//! Displayed mesh of a body: positions of its points, and colours of its field. Kept between frames.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::app::interface::*;
use crate::render::Frame;
use crate::render::interpolated_field::{Components, InterpolatedField};
use crate::study::ProbeReference;

#[derive(Debug, Default)]
pub(crate) struct BodyMesh {
    /// Positions of the nodes, m.
    pub nodes: Vec<Vector2<f64>>,
    /// Positions of the drawn points, m.
    pub points: Vec<Vector2<f64>>,
    /// Factor of the displacement of nodes and points.
    pub magnification: f64,
    /// Revision number of points and values.
    pub stamp: u64,
    pub field: InterpolatedField,
    /// Reference of the first probe in the solution that the field is the distance from; `None` for other fields.
    reference: Option<ProbeReference>,
    /// Components of the field at the drawn points.
    components: Vec<Option<Components>>,
    /// Largest magnitude of the field in the current state.
    largest: f64,
    /// Values of the field at both ends of the colour map.
    pub range: [f64; 2],
    /// Largest magnitude of the field in the last seconds of a motion; `None` before the first update.
    recent: Option<Recent>,
    /// Equations of the body; `None` before the first update.
    pub system: Option<Arc<System>>,
    pub geometry: Arc<DisplayGeometry>,
    /// `true` if points and values have been moved since they were computed.
    is_displaced: bool,
    pub palette: Palette,
}

/// Largest magnitude of a field in the last seconds of a motion, collected in two consecutive time windows.
#[derive(Clone, Copy, Debug)]
struct Recent {
    field: Field,
    /// Start of the current window, playing time in s.
    since: f64,
    /// Time of the last update, playing time in s.
    now: f64,
    /// Largest magnitude in the current window, in the previous one, and as shown.
    window: f64,
    before: f64,
    shown: f64,
}

impl Recent {
    /// Length of a window, s: longer than a period of the motion at a watchable speed.
    const WINDOW: f64 = 2.5;
    /// Time constant of the narrowing of the range, s.
    const EASE: f64 = 0.7;

    /// Adds the field's largest magnitude at `now`, playing time in s. Returns the magnitude to show: it grows at once,
    /// and falls slowly to the largest of both windows.
    fn extend(&mut self, now: f64, largest: f64) -> f64 {
        if now - self.since >= Self::WINDOW {
            (self.since, self.before, self.window) = (now, self.window, largest);
        }
        self.window = self.window.max(largest);
        let recent = self.window.max(self.before);
        let left = (-(now - self.now).max(0.0) / Self::EASE).exp();
        self.now = now;
        self.shown = recent.max(recent + (self.shown - recent) * left);
        self.shown
    }
}

/// Returns a revision number that no mesh has had before.
fn stamp() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl BodyMesh {
    /// Updates points and values to the state of a body, drawn with `magnification` times its displacement, whose
    /// reference solution is `reference`. For a motion, `played` is the playing time, s, and the colour range covers the
    /// last seconds.
    pub(crate) fn update(
        &mut self,
        simulation: &Simulation,
        geometry: &Arc<DisplayGeometry>,
        (view, reference): (&ViewOptions, Option<&Reference>),
        magnification: f64,
        played: Option<f64>,
    ) {
        let (mesh, values) = (simulation.system().mesh(), view.point_values());
        let places = mesh.nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u * magnification);
        // Computing the values of a large body is expensive, and the state has usually not changed since the last
        // frame.
        let reference = reference.filter(|_| view.field == Field::ReferenceDistance);
        let probe = reference.and_then(Reference::first);
        if self.system.as_ref().is_none_or(|system| !Arc::ptr_eq(system, simulation.system())) {
            *self = Self { system: Some(simulation.system().clone()), geometry: geometry.clone(), ..Self::default() };
        }
        let is_known = !self.is_displaced
            && self.field.has_settings(simulation, view.field, values)
            && self.magnification == magnification
            && self.reference == probe
            && self.nodes.iter().copied().eq(places.clone());
        if !is_known {
            (self.is_displaced, self.magnification, self.reference) = (false, magnification, probe);
            self.nodes.clear();
            self.nodes.extend(places);
            let nodes = &self.nodes;
            geometry.points(&|n| nodes[n as usize], &mut self.points);
            let reference = reference.map_or_else(Vec::new, |reference| reference.displacements_at(mesh.nodes()));
            self.field.update(simulation, view.field, values, &reference);
            geometry.components(&self.field, &mut self.components);
            self.largest = self.field.largest(mesh);
            self.stamp = stamp();
        }
        let now = played.unwrap_or_default();
        let goes_on = |recent: &Recent| played.is_some() && recent.field == view.field && view.fixed_range.is_none();
        let (field, largest) = (view.field, self.largest);
        let new = Recent { field, since: now, now, window: largest, before: largest, shown: largest };
        let recent = self.recent.insert(self.recent.filter(goes_on).unwrap_or(new));
        self.range = view.fixed_range.unwrap_or_else(|| view.field.range(recent.extend(now, self.largest)));
    }

    /// Moves the drawn points until the next [`Self::update`].
    pub(crate) fn displace(&mut self, place: impl FnOnce(&mut [Vector2<f64>])) {
        place(&mut self.points);
        (self.stamp, self.is_displaced) = (stamp(), true);
    }

    /// Returns the range of the field's values in the current state.
    pub(crate) fn value_range(&self) -> [f64; 2] {
        self.field.field.range(self.largest)
    }

    /// Returns `true` if the field has a value at a drawn point.
    pub(crate) fn has_values(&self) -> bool {
        self.components.iter().flatten().any(|components| self.field.value(*components).is_some())
    }

    pub(crate) fn frame(&self, wireframe: bool) -> Frame<'_> {
        let geometry = &self.geometry;
        let opaque = |color: Color32| [color.r(), color.g(), color.b()];
        Frame {
            stamp: self.stamp,
            positions: &self.points,
            triangles: &geometry.triangles,
            field: self.field.field,
            components: &self.components,
            largest_component: self.field.largest_component,
            material: self.field.material,
            kinematics: self.field.kinematics,
            range: self.range,
            lines: if wireframe { &geometry.lines } else { &[] },
            triangles_of_lines: &geometry.triangles_of_lines,
            pieces: geometry.pieces,
            map: self.palette.map(self.field.field),
            line_color: self.palette.wire,
            background: opaque(self.palette.canvas),
            // The panels do not fill their own areas, because filling is slow without a GPU.
            surround: opaque(self.palette.panel),
            absent_color: opaque(self.palette.absent),
        }
    }
}
