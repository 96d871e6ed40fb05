//! Stability atlas of bodies at rest: every method at extremes of load, stiffness, Poisson ratio, slenderness and
//! element shape, on mesh files, and from extreme initial states.

use super::{Atlas, Entry, Outcome, distinct, solve};
use crate::rotation::Rotation;
use crate::scene::{Axis, Material, Plane, Source, open};
use crate::study::prelude::*;

/// Returns the initial position of a node with this index and rest position, for a beam of height 1 m.
type StartPosition = fn(usize, Vector2<f64>) -> Vector2<f64>;

/// Initial states other than rest, with their identifiers in tables.
const STARTS: [(&str, StartPosition); 4] = [
    // Every node on the axis: all elements without area.
    ("flat", |_, x| Vector2::new(x.x, 0.0)),
    // Mirrored at the axis: all elements inverted.
    ("mirrored", |_, x| Vector2::new(x.x, -x.y)),
    // Every node within one height of its rest position, by a low-discrepancy sequence: the same on every machine.
    ("random", |node, x| {
        let offset = |k: f64| (k * (node as f64 + 1.0)).fract() - 0.5;
        x + Vector2::new(offset(0.754_877_666), offset(0.569_840_291)) * 2.0
    }),
    // Rotated by 179° about the clamp.
    ("turned", |_, x| Rotation::from_angle(179f64.to_radians()).apply(x)),
];

/// Case: a cantilever of height 1 m in plane strain, or a built-in scene with a mesh file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestCase {
    /// Element.
    pub element: ElementKind,
    /// Method.
    pub method: MethodKind,
    /// Initial state; fixed nodes always start at rest.
    pub start: &'static str,
    /// Transverse tip load α = P L²/EI; for a mesh file, the factor of the scene's loads.
    pub alpha: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson ratio.
    pub poisson: f64,
    /// Length over height.
    pub slenderness: f64,
    /// Requested length over height of a cell.
    pub aspect: f64,
    /// `true` if the tip is moved transversely instead of loaded: by the deflection of linear beam theory under the load,
    /// α/3 of the length, but at most 0.8 of it.
    pub moved: bool,
    /// Fraction of the cell length by which nodes are displaced along the beam, with alternating sign.
    pub distortion: f64,
    /// Built-in scene with a mesh file instead of the cantilever, by its name.
    pub mesh: Option<&'static str>,
}

/// Returns all cases, a few hundred or many thousand: a grid of loads and shapes from rest, all initial states,
/// distorted cells, and scenes with mesh files.
pub fn cases(extent: Extent) -> Vec<RestCase> {
    let pick = |values: [&'static [f64]; 2]| extent.pick(values);
    let alphas = pick([&[0.1, 10.0, 1e3], &[1e-6, 1e-2, 0.1, 1.0, 2.0, 5.0, 10.0, 30.0, 100.0, 1e3, 1e6]]);
    let youngs = pick([&[], &[1e-3, 1e10]]);
    let poissons = pick([&[0.0, 0.4999], &[0.0, 0.3, 0.49, 0.4999]]);
    let slendernesses = pick([&[1.0, 20.0, 1e3], &[1.0, 5.0, 20.0, 100.0, 1e3]]);
    let aspects = pick([&[2.0], &[1.0, 5.0, 50.0]]);
    let distortions = pick([&[0.45], &[0.3, 0.45]]);
    let distorted_slendernesses = pick([&[20.0], &[5.0, 20.0, 100.0]]);
    let files = ["bracket", "clip", "cook"].into_iter().filter_map(|id| Some((id, built_in(id)?)));
    let mut cases = Vec::new();
    for (element, method) in ElementKind::all().flat_map(|e| METHODS.iter().map(move |m| (e, m.kind))) {
        let is_possible = |(_, scene): &(&str, Scene)| scene.elements().any(|own| own == element);
        for &alpha in alphas {
            let ordinary = RestCase { element, method, alpha, ..RestCase::ORDINARY };
            for &slenderness in slendernesses {
                for &poisson in poissons {
                    cases.extend(aspects.iter().map(|&aspect| RestCase { slenderness, poisson, aspect, ..ordinary }));
                }
                cases.push(RestCase { slenderness, moved: true, ..ordinary });
                cases.extend(youngs.iter().map(|&young| RestCase { slenderness, young, ..ordinary }));
            }
            cases.extend(STARTS.map(|(start, _)| RestCase { start, ..ordinary }));
            for &distortion in distortions {
                let shapes = distorted_slendernesses.iter();
                cases.extend(shapes.map(|&slenderness| RestCase { slenderness, distortion, ..ordinary }));
            }
            for (mesh, Scene { material: Material { young, poisson, .. }, .. }) in files.clone().filter(is_possible) {
                let mesh = Some(mesh);
                cases.push(RestCase { mesh, young, poisson, slenderness: 1.0, aspect: 1.0, ..ordinary });
            }
        }
    }
    cases
}

fn built_in(id: &str) -> Option<Scene> {
    open(&Source { name: id.into(), assignments: Vec::new() }).ok()
}

impl RestCase {
    /// Cantilever with rectangular cells that starts at rest and is loaded at its tip.
    pub const ORDINARY: Self = Self {
        element: ElementKind::T3,
        method: MethodKind::Newton,
        start: "rest",
        alpha: 1.0,
        young: 1e6,
        poisson: 0.3,
        slenderness: 20.0,
        aspect: 2.0,
        moved: false,
        distortion: 0.0,
        mesh: None,
    };

    /// Returns the scene of the case.
    pub fn scene(&self) -> Scene {
        if let Some(mut scene) = self.mesh.and_then(built_in) {
            scene.set_element(self.element);
            scene.scale_loads(self.alpha);
            scene.solver.method = self.method;
            scene.solver.accept_after = 0;
            return scene;
        }
        let (length, across) = (self.slenderness, 2);
        let along = (length * f64::from(across) / self.aspect).round().clamp(1.0, 200.0);
        let material = Material { density: 0.0, plane: Plane::Strain, ..Material::new(self.young, self.poisson) };
        let scene = Scene::beam(length, 1.0)
            .with_cells(along as u32, across)
            .with_element(self.element)
            .with_material(material)
            .with_method(self.method)
            .clamp("left")
            .probe("tip", "right");
        if self.moved {
            scene.support([length, 0.0], &[Axis::Y]).moved([0.0, -length * (self.alpha / 3.0).min(0.8)], 0.0)
        } else {
            scene.force("right", [0.0, -self.alpha * self.young / 12.0 / (length * length)])
        }
    }

    /// Returns the simulation of the case in its initial state.
    fn simulation(&self) -> Result<Simulation, SimulationError> {
        let scene = self.scene();
        if self.distortion > 0.0
            && let Some(mesh) = distorted(&scene, self.distortion)
        {
            return Simulation::with_mesh(&scene, mesh);
        }
        let mut simulation = Simulation::new(&scene)?;
        if let Some((_, place)) = STARTS.iter().find(|(id, _)| *id == self.start) {
            let nodes = simulation.system().mesh().nodes().iter().enumerate();
            let u: Vec<_> = nodes.map(|(node, x)| place(node, *x) - x).collect();
            // Cannot fail: one vector per node, all finite.
            let _ = simulation.start_from(&u);
        }
        Ok(simulation)
    }

    /// Solves the case and classifies its outcome.
    pub fn solve(&self) -> Result<Entry, SimulationError> {
        let (outcome, solution, [x, y]) = solve(&mut self.simulation()?);
        let Self { start, alpha, young, poisson, slenderness, aspect, moved, distortion, mesh, .. } = *self;
        let (row, group) = match mesh {
            Some(id) => (Some(id.to_owned()), Some("mesh files, by their scenes' load times")),
            None if moved => {
                (None, Some("cases from rest, by the displacement of the moved tip, α/3 of the length, at most 0.8"))
            }
            None if start != Self::ORDINARY.start => (Some(start.to_owned()), None),
            None if distortion > 0.0 => {
                (Some(format!("distorted {distortion}")), Some("cases with distorted cells, by load α = P L²/EI"))
            }
            None => (Some(format!("L/H {slenderness}")), Some("cases from rest, by load α = P L²/EI")),
        };
        let (element, method, mesh) = (self.element, self.method.id(), mesh.unwrap_or("beam"));
        let floor = solution.residual_floor.map_or_else(String::new, |floor| format!("{floor:e}"));
        let record = format!(
            "{},{method},{start},{alpha},{young},{poisson},{slenderness},{aspect},{},{},{:e},{x},{y},{moved},{distortion},{mesh},{floor}",
            element.id(),
            outcome.entry().0,
            solution.iterations,
            solution.residual
        );
        Ok(Entry { element, name: method.to_owned(), row, column: number(alpha), group, record, outcome, solution })
    }
}

/// Returns the mesh of a scene's beam with nodes moved along the beam by this fraction of a cell, with alternating
/// sign: rectangles become trapezoids that point up and down in turn. Below one half no cell is inverted.
fn distorted(scene: &Scene, distortion: f64) -> Option<Mesh> {
    let beam = scene.beam.as_ref()?;
    let mesh = Mesh::beam(beam).ok()?;
    let [along, across] = beam.cells.map(f64::from);
    let cell = Vector2::new(beam.length / along, beam.height / across);
    let place = |x: Vector2<f64>| {
        let (i, j) = ((x.x / cell.x).round(), ((x.y + 0.5 * beam.height) / cell.y).round());
        let displacement = if (i + j) % 2.0 == 0.0 { distortion } else { -distortion };
        let stays = i == 0.0 || i == along;
        x + Vector2::new(if stays { 0.0 } else { displacement * cell.x }, 0.0)
    };
    let (entry, mut nodes) = (mesh.element().entry(), mesh.nodes().to_vec());
    for element in mesh.elements() {
        for (&node, &at) in element.iter().zip(entry.nodes) {
            // Nodes between corners stay half way, so that sides stay straight.
            let corners = element.iter().zip((entry.cell.corner_weights)(at));
            nodes[node as usize] = corners.map(|(&corner, weight)| place(mesh.node(corner)) * weight).sum();
        }
    }
    Mesh::new(nodes, mesh.element(), mesh.connectivity().to_vec(), mesh.edges().clone()).ok()
}

/// Returns the atlas of the entries.
pub fn atlas(entries: Vec<Entry>) -> Atlas {
    Atlas {
        outcomes: &[Outcome::Certified, Outcome::Converged, Outcome::Inverted, Outcome::Stalled, Outcome::NotConverged],
        names: "method",
        columns: "load α = P L²/EI",
        header: "element,method,start,alpha,young,poisson,length_over_height,cell_aspect,outcome,iterations,residual,tip_x_over_l,tip_y_over_l,moved,distortion,mesh,residual_floor",
        entries,
    }
}

/// Formats the counts for display, and where each method stops converging.
pub fn summary(atlas: &Atlas) -> String {
    let at_rounding = atlas.entries.iter().filter(|entry| entry.solution.residual_floor.is_some()).count();
    let mut text = format!(
        "{} cases, beams in plane strain\n\n{}\n{at_rounding} of the converged cases stopped at working precision: \
         residual above the tolerance, within the bound of rounding\n",
        atlas.entries.len(),
        atlas.outcome_table()
    );
    let alphas = distinct(atlas.entries.iter().map(|entry| entry.column.clone()));
    for group in distinct(atlas.entries.iter().filter_map(|entry| entry.group)) {
        text += &format!("\ncertified or converged, percent of the {group}\n");
        text += &atlas.text_table(&alphas, 6, |entries, alpha| {
            let own = entries.iter().filter(|e| e.group == Some(group) && e.column == alpha);
            let good = own.clone().filter(|e| matches!(e.outcome, Outcome::Certified | Outcome::Converged)).count();
            100.0 * good as f64 / own.count() as f64
        });
    }
    text
}
