//! What is drawn of a body in a state: where its points are, and the colours of its field. Kept between frames.

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

/// What is drawn of a body at present.
#[derive(Debug, Default)]
pub(crate) struct BodyMesh {
    /// Where the nodes are, m.
    pub nodes: Vec<Vector2<f64>>,
    /// Where the drawn points are, m.
    points: Vec<Vector2<f64>>,
    /// The number of the last change of points and values.
    stamp: u64,
    /// Of fields that are recovered at the nodes.
    pub nodal: Option<NodalStress>,
    scratch: RecoveryScratch,
    /// At quadrature points or nodes.
    pub known: Vec<Option<f64>>,
    /// At the corners of what is drawn.
    pub values: Vec<[Option<f64>; 3]>,
    /// The field's values at the two ends of the colour map.
    pub range: [f64; 2],
    /// What the range is of.
    field: Option<Field>,
    /// Extremes of the field in the last seconds of a motion.
    recent: Recent,
    /// What the values are of, beside the places of the nodes.
    of: Option<Values>,
    line_color: [u8; 4],
    background: [u8; 3],
    surround: [u8; 3],
    absent_color: [u8; 3],
    map: ColorMap,
}

/// The extremes of a field that is shown in motion, over the last seconds of play: in two windows, one after the other.
#[derive(Clone, Copy, Debug, Default)]
struct Recent {
    /// When the window began, s.
    since: f64,
    /// When it was last extended, s.
    now: f64,
    /// Extremes in it, and in the window before.
    window: [f64; 2],
    before: [f64; 2],
}

impl Recent {
    /// Length of a window, s: longer than a period of what is watched.
    const WINDOW: f64 = 2.5;
    /// Time constant, s, with which a range becomes narrower.
    const EASE: f64 = 0.7;

    fn new(now: f64, range: [f64; 2]) -> Self {
        Self { since: now, now, window: range, before: range }
    }

    /// Adds the field's extremes at `now`, s of play. Returns the range to show after the range `shown`: it widens at once,
    /// and narrows slowly to the extremes of both windows.
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

/// What decides the values of a body's field, but for where its nodes are.
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

/// A number that no shape has had.
fn stamp() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl BodyMesh {
    /// Takes the state of a body on. In motion, after so many seconds of play, the range of colours is that of the last
    /// seconds.
    pub(crate) fn update(
        &mut self,
        simulation: &Simulation,
        drawing: &DisplayGeometry,
        view: &ViewOptions,
        played: Option<f64>,
    ) {
        let places = simulation.system().mesh().nodes().iter().zip(simulation.displacement()).map(|(x, u)| x + u);
        let of = Values::of(simulation, view);
        // The values of a large body are dear, and most pictures are of the state before.
        let is_known =
            self.of.as_ref().is_some_and(|known| known.are(&of)) && self.nodes.iter().copied().eq(places.clone());
        self.of = Some(of);
        if !is_known {
            self.nodes.clear();
            self.nodes.extend(places);
            let nodes = &self.nodes;
            drawing.points(&|n| nodes[n as usize], &mut self.points);
            if view.is_smooth() {
                simulation.smooth_field(view.field, (&mut self.nodal, &mut self.scratch), &mut self.known);
                drawing.nodal_values(&self.known, view.field.period(), &mut self.values);
            } else {
                simulation.field(view.field, &mut self.known);
                drawing.values(&self.known, &mut self.values);
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

    /// Where the drawn points are, m.
    pub(crate) fn points(&self) -> &[Vector2<f64>] {
        &self.points
    }

    /// Number of the last change of points and values.
    pub(crate) fn stamp(&self) -> u64 {
        self.stamp
    }

    /// Draws the points elsewhere, until the next [`Self::update`].
    pub(crate) fn displace(&mut self, place: impl FnOnce(&mut [Vector2<f64>])) {
        place(&mut self.points);
        self.stamp = stamp();
        self.of = None;
    }

    /// Takes the colours of a theme on.
    pub(crate) fn color(&mut self, visuals: &Visuals, field: Field) {
        let palette = Palette::new(visuals);
        let opaque = |color: Color32| [color.r(), color.g(), color.b()];
        self.background = opaque(palette.canvas);
        // What is behind panels: these fill nothing themselves, which is dear where a processor draws.
        self.surround = opaque(palette.panel);
        self.absent_color = opaque(palette.absent);
        self.line_color = palette.wire;
        self.map = palette.map(field);
    }

    /// The value of the field at a material point.
    pub(crate) fn value_at(&self, view: &ViewOptions, mesh: &Mesh, point: MaterialPoint) -> Option<f64> {
        match &self.nodal {
            Some(nodal) if view.is_smooth() => view.field.smooth_at(mesh, nodal, point),
            _ => Field::raw_at(mesh, &self.known, point),
        }
    }

    /// What the body's pass draws.
    pub(crate) fn frame<'a>(&'a self, drawing: &'a DisplayGeometry, wireframe: bool) -> Frame<'a> {
        Frame {
            stamp: self.stamp,
            positions: &self.points,
            triangles: &drawing.triangles,
            values: &self.values,
            range: self.range,
            lines: if wireframe { &drawing.lines } else { &[] },
            beside: &drawing.beside,
            pieces: drawing.pieces,
            map: self.map,
            line_color: self.line_color,
            background: self.background,
            surround: self.surround,
            absent_color: self.absent_color,
        }
    }
}
