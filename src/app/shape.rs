//! What is drawn of a body in a state: where its points are, and the colours of its field. Kept between frames.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use egui::{Color32, Visuals};
use nalgebra::Vector2;

use super::action::ViewOptions;
use super::drawing::Drawing;
use super::palette::{self, Palette};
use super::panel;
use crate::assembly::System;
use crate::mesh::{MaterialPoint, Mesh};
use crate::render::Frame;
use crate::render::colormap::ColorMap;
use crate::scene::Material;
use crate::simulation::{Field, Simulation};
use crate::stress::{NodalStress, RecoveryScratch};

/// What is drawn of a body at present.
#[derive(Debug, Default)]
pub(super) struct Shape {
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
    /// What the values are of, beside the places of the nodes.
    of: Option<Values>,
    line_color: [u8; 4],
    background: [u8; 3],
    surround: [u8; 3],
    absent_color: [u8; 3],
    map: ColorMap,
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

impl Shape {
    /// Takes the state of a body on. A range that `grows` keeps what it has spanned of the field.
    pub(super) fn update(&mut self, simulation: &Simulation, drawing: &Drawing, view: &ViewOptions, grows: bool) {
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
        let [mut low, mut high] = panel::range_of(&self.known);
        if palette::has_sign(view.field) {
            let reach = high.abs().max(low.abs());
            (low, high) = (-reach, reach);
        }
        let before = Some(self.range).filter(|_| grows && self.field == Some(view.field));
        let grown = before.map_or([low, high], |range| [low.min(range[0]), high.max(range[1])]);
        self.field = Some(view.field);
        self.range = view.fixed_range.unwrap_or(grown);
    }

    /// Where the drawn points are, m.
    pub(super) fn points(&self) -> &[Vector2<f64>] {
        &self.points
    }

    /// Draws the points elsewhere, until the next [`Self::update`].
    pub(super) fn displace(&mut self, place: impl FnOnce(&mut [Vector2<f64>])) {
        place(&mut self.points);
        self.stamp = stamp();
        self.of = None;
    }

    /// Takes the colours of a theme on.
    pub(super) fn color(&mut self, visuals: &Visuals, field: Field) {
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
    pub(super) fn value_at(&self, view: &ViewOptions, mesh: &Mesh, point: MaterialPoint) -> Option<f64> {
        match &self.nodal {
            Some(nodal) if view.is_smooth() => view.field.smooth_at(mesh, nodal, point),
            _ => Field::raw_at(mesh, &self.known, point),
        }
    }

    /// What the body's pass draws.
    pub(super) fn frame<'a>(&'a self, drawing: &'a Drawing, wireframe: bool) -> Frame<'a> {
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
