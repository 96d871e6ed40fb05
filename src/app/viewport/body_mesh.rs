//! Displayed mesh of a body: positions of its points, and colours of its field. Kept between frames.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use egui::{Color32, Visuals};
use nalgebra::Vector2;

use crate::app::view_options::ViewOptions;
use crate::app::viewport::color_range::range_of;
use crate::app::widgets::palette::{self, Palette};
use crate::assembly::System;
use crate::mesh::{MaterialPoint, Mesh};
use crate::render::Frame;
use crate::render::colormap::ColorMap;
use crate::render::display_geometry::DisplayGeometry;
use crate::scene::Material;
use crate::simulation::{Field, Simulation};
use crate::stress::{NodalStress, RecoveryScratch};

/// Displayed mesh of a body in its current state.
#[derive(Debug, Default)]
pub(crate) struct BodyMesh {
    /// Positions of the nodes, m.
    pub nodes: Vec<Vector2<f64>>,
    /// Positions of the drawn points, m.
    points: Vec<Vector2<f64>>,
    /// Revision number of points and values.
    stamp: u64,
    /// Nodal stresses, for fields that are recovered at the nodes.
    pub nodal: Option<NodalStress>,
    scratch: RecoveryScratch,
    /// Values of the field at quadrature points or nodes.
    pub known: Vec<Option<f64>>,
    /// Values of the field at the corners of the drawn triangles.
    pub values: Vec<[Option<f64>; 3]>,
    /// Values of the field at both ends of the colour map.
    pub range: [f64; 2],
    /// Field that the range belongs to.
    field: Option<Field>,
    /// Extreme values of the field in the last seconds of a motion.
    recent: Recent,
    /// Inputs that the current values were computed from, except for the positions of the nodes.
    of: Option<Values>,
    line_color: [u8; 4],
    background: [u8; 3],
    surround: [u8; 3],
    absent_color: [u8; 3],
    map: ColorMap,
}

/// Extreme values of a field in the last seconds of a motion, collected in two consecutive time windows.
#[derive(Clone, Copy, Debug, Default)]
struct Recent {
    /// Start of the current window, playing time in s.
    since: f64,
    /// Time of the last update, playing time in s.
    now: f64,
    /// Extreme values in the current window, and in the previous one.
    window: [f64; 2],
    before: [f64; 2],
}

impl Recent {
    /// Length of a window, s: longer than a period of the motion at a watchable speed.
    const WINDOW: f64 = 2.5;
    /// Time constant of the narrowing of the range, s.
    const EASE: f64 = 0.7;

    fn new(now: f64, range: [f64; 2]) -> Self {
        Self { since: now, now, window: range, before: range }
    }

    /// Adds the field's extreme values at `now`, playing time in s. Returns the range that follows the range `shown`:
    /// it widens at once, and narrows slowly to the extremes of both windows.
    fn extend(&mut self, now: f64, range: [f64; 2], shown: [f64; 2]) -> [f64; 2] {
        if now - self.since >= Self::WINDOW {
            *self = Self { since: now, now: self.now, window: range, before: self.window };
        }
        self.window = union(self.window, range);
        let recent = union(self.window, self.before);
        let left = (-(now - self.now).max(0.0) / Self::EASE).exp();
        self.now = now;
        let eased = [0, 1].map(|end| recent[end] + (shown[end] - recent[end]) * left);
        union(eased, recent)
    }
}

fn union(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Inputs of the values of a body's field, except for the positions of the nodes.
#[derive(Debug)]
struct Values {
    system: Arc<System>,
    material: Material,
    field: Field,
    is_smooth: bool,
    is_linear: bool,
}

impl Values {
    fn of(simulation: &Simulation, view: &ViewOptions) -> Self {
        Self {
            system: simulation.system().clone(),
            material: *simulation.problem().material(),
            field: view.field,
            is_smooth: view.is_smooth(),
            is_linear: simulation.is_linear(),
        }
    }

    fn are(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.system, &other.system)
            && (self.material, self.field) == (other.material, other.field)
            && (self.is_smooth, self.is_linear) == (other.is_smooth, other.is_linear)
    }
}

/// Returns a revision number that no mesh has had before.
fn stamp() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl BodyMesh {
    /// Updates points and values to the state of a body. For a motion, `played` is the playing time, s, and the colour
    /// range covers the last seconds.
    pub(crate) fn update(
        &mut self,
        simulation: &Simulation,
        geometry: &DisplayGeometry,
        view: &ViewOptions,
        played: Option<f64>,
    ) {
        let places = simulation.system().mesh().nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u);
        let of = Values::of(simulation, view);
        // Computing the values of a large body is expensive, and the state has usually not changed since the last
        // frame.
        let is_known =
            self.of.as_ref().is_some_and(|known| known.are(&of)) && self.nodes.iter().copied().eq(places.clone());
        self.of = Some(of);
        if !is_known {
            self.nodes.clear();
            self.nodes.extend(places);
            let nodes = &self.nodes;
            geometry.points(&|n| nodes[n as usize], &mut self.points);
            if view.is_smooth() {
                simulation.smooth_field(view.field, &mut self.nodal, &mut self.scratch, &mut self.known);
                geometry.nodal_values(&self.known, view.field.period(), &mut self.values);
            } else {
                simulation.field(view.field, &mut self.known);
                geometry.values(&self.known, &mut self.values);
            }
            self.stamp = stamp();
        }
        let [mut low, mut high] = range_of(&self.known);
        if palette::has_sign(view.field) {
            let reach = high.abs().max(low.abs());
            (low, high) = (-reach, reach);
        }
        let now = played.unwrap_or_default();
        let goes_on = played.is_some() && self.field == Some(view.field) && view.fixed_range.is_none();
        if !goes_on {
            (self.recent, self.range) = (Recent::new(now, [low, high]), [low, high]);
        }
        self.field = Some(view.field);
        self.range = view.fixed_range.unwrap_or_else(|| self.recent.extend(now, [low, high], self.range));
    }

    /// Returns the positions of the drawn points, m.
    pub(crate) fn points(&self) -> &[Vector2<f64>] {
        &self.points
    }

    /// Returns the revision number of points and values.
    pub(crate) fn stamp(&self) -> u64 {
        self.stamp
    }

    /// Moves the drawn points until the next [`Self::update`].
    pub(crate) fn displace(&mut self, place: impl FnOnce(&mut [Vector2<f64>])) {
        place(&mut self.points);
        self.stamp = stamp();
        self.of = None;
    }

    /// Sets the colours of the theme and the colour map of the field.
    pub(crate) fn color(&mut self, visuals: &Visuals, field: Field) {
        let palette = Palette::new(visuals);
        let opaque = |color: Color32| [color.r(), color.g(), color.b()];
        self.background = opaque(palette.canvas);
        // Background colour of the panels. They do not fill their own areas, because filling is slow without a GPU.
        self.surround = opaque(palette.panel);
        self.absent_color = opaque(palette.absent);
        self.line_color = palette.wire;
        self.map = palette.map(field);
    }

    /// Returns the value of the field at a material point.
    pub(crate) fn value_at(&self, view: &ViewOptions, mesh: &Mesh, point: MaterialPoint) -> Option<f64> {
        match &self.nodal {
            Some(nodal) if view.is_smooth() => view.field.smooth_at(mesh, nodal, point),
            _ => Field::raw_at(mesh, &self.known, point),
        }
    }

    /// Returns the input of the body's render pass.
    pub(crate) fn frame<'a>(&'a self, geometry: &'a DisplayGeometry, wireframe: bool) -> Frame<'a> {
        Frame {
            stamp: self.stamp,
            positions: &self.points,
            triangles: &geometry.triangles,
            values: &self.values,
            range: self.range,
            lines: if wireframe { &geometry.lines } else { &[] },
            triangles_of_lines: &geometry.triangles_of_lines,
            pieces: geometry.pieces,
            map: self.map,
            line_color: self.line_color,
            background: self.background,
            surround: self.surround,
            absent_color: self.absent_color,
        }
    }
}
