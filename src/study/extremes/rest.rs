//! Stability atlas of bodies at rest: every method at extremes of load, stiffness, Poisson ratio, slenderness and
//! element shape, on mesh files, and from extreme initial states.

use super::{AtlasSeries, Case, Entry, Outcome, counts, labels, outcome_table, text_table};
use crate::rotation::Rotation;
use crate::scene::{Axis, Material, Plane, Source, open};
use crate::simulation::Solution;
use crate::study::prelude::*;

/// Difference from a cantilever with rectangular cells that starts at rest and is loaded at its tip. Fixed nodes always
/// start at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variant {
    /// No difference.
    Plain,
    /// The tip is moved transversely instead of loaded: by the deflection of linear beam theory under the load, α/3 of
    /// the length, but at most 0.8 of it.
    MovedTip,
    /// The initial state is the one with this index in [`STARTS`].
    Start(usize),
    /// Nodes are displaced along the beam, with alternating sign, by this fraction of the cell length.
    Distorted(f64),
    /// Built-in scene with a mesh file instead of the cantilever, by its name.
    File(&'static str),
}

/// Returns the initial position of a node with this index and rest position, for a beam of height 1 m.
type StartPosition = fn(usize, Vector2<f64>) -> Vector2<f64>;

/// Initial states other than rest, with their identifiers in tables.
pub const STARTS: [(&str, StartPosition); 4] = [
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
    /// Difference from a cantilever with rectangular cells that starts at rest.
    pub variant: Variant,
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
}

/// Returns all cases, a few hundred or many thousand: a grid of loads and shapes from rest, all initial states,
/// distorted cells, and scenes with mesh files.
pub fn cases(extent: Extent) -> Vec<RestCase> {
    let pick = |quick: &'static [f64], all: &'static [f64]| if extent == Extent::Full { all } else { quick };
    let alphas = pick(&[0.1, 10.0, 1e3], &[1e-6, 1e-2, 0.1, 1.0, 2.0, 5.0, 10.0, 30.0, 100.0, 1e3, 1e6]);
    let youngs = pick(&[1e6], &[1e-3, 1e6, 1e10]);
    let poissons = pick(&[0.0, 0.4999], &[0.0, 0.3, 0.49, 0.4999]);
    let slendernesses = pick(&[1.0, 20.0, 1e3], &[1.0, 5.0, 20.0, 100.0, 1e3]);
    let aspects = pick(&[2.0], &[1.0, 5.0, 50.0]);
    let distortions = pick(&[0.45], &[0.3, 0.45]);
    let distorted_slendernesses = pick(&[20.0], &[5.0, 20.0, 100.0]);
    let mut cases = Vec::new();
    for (element, method) in ElementKind::all().flat_map(|e| METHODS.iter().map(move |m| (e, m.kind))) {
        for &alpha in alphas {
            let ordinary = RestCase {
                element,
                method,
                variant: Variant::Plain,
                alpha,
                young: 1e6,
                poisson: 0.3,
                slenderness: 20.0,
                aspect: 2.0,
            };
            for &slenderness in slendernesses {
                for &poisson in poissons {
                    cases.extend(aspects.iter().map(|&aspect| RestCase { slenderness, poisson, aspect, ..ordinary }));
                }
                cases.push(RestCase { slenderness, variant: Variant::MovedTip, ..ordinary });
                let others = youngs.iter().filter(|&&young| young != ordinary.young);
                cases.extend(others.map(|&young| RestCase { slenderness, young, ..ordinary }));
            }
            cases.extend((0..STARTS.len()).map(|start| RestCase { variant: Variant::Start(start), ..ordinary }));
            for variant in distortions.iter().map(|&distortion| Variant::Distorted(distortion)) {
                let shapes = distorted_slendernesses.iter();
                cases.extend(shapes.map(|&slenderness| RestCase { slenderness, variant, ..ordinary }));
            }
            cases.extend(["bracket", "clip", "cook"].into_iter().filter_map(|id| ordinary.on_file(id)));
        }
    }
    cases
}

fn built_in(id: &str) -> Option<Scene> {
    open(&Source { name: id.into(), assignments: Vec::new() }).ok()
}

impl RestCase {
    /// Returns the case on a mesh file; `None` if the file has no such elements.
    fn on_file(self, id: &'static str) -> Option<Self> {
        let scene = built_in(id)?;
        let Material { young, poisson, .. } = scene.material;
        let case = Self { variant: Variant::File(id), young, poisson, slenderness: 1.0, aspect: 1.0, ..self };
        scene.elements().any(|e| e == self.element).then_some(case)
    }

    /// Returns the scene of the case.
    pub fn scene(&self) -> Scene {
        if let Variant::File(id) = self.variant
            && let Some(mut scene) = built_in(id)
        {
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
        if self.variant == Variant::MovedTip {
            scene.support([length, 0.0], &[Axis::Y]).moved([0.0, -length * (self.alpha / 3.0).min(0.8)], 0.0)
        } else {
            scene.force("right", [0.0, -self.alpha * self.young / 12.0 / (length * length)])
        }
    }
}

impl Case for RestCase {
    const OUTCOMES: [Outcome; Outcome::COUNT] =
        [Outcome::Certified, Outcome::Converged, Outcome::Inverted, Outcome::Stalled, Outcome::NotConverged];
    const NAMES: &'static str = "method";
    const COLUMNS: &'static str = "load α = P L²/EI";
    const HEADER: &'static str = "element,method,start,alpha,young,poisson,length_over_height,cell_aspect,outcome,iterations,residual,tip_x_over_l,tip_y_over_l,moved,distortion,mesh,residual_floor";

    fn series(&self) -> AtlasSeries {
        (self.element.id(), self.method.id().to_owned())
    }

    fn cell(&self) -> Option<[String; 2]> {
        let row = match self.variant {
            Variant::Plain => format!("L/H {}", self.slenderness),
            Variant::MovedTip => return None,
            Variant::Start(start) => STARTS[start].0.to_owned(),
            Variant::Distorted(distortion) => format!("distorted {distortion}"),
            Variant::File(id) => id.to_owned(),
        };
        Some([row, number(self.alpha)])
    }

    fn simulation(&self) -> Result<Simulation, SimulationError> {
        let scene = self.scene();
        if let Variant::Distorted(distortion) = self.variant
            && let Some(mesh) = distorted(&scene, distortion)
        {
            return Simulation::with_mesh(&scene, mesh);
        }
        let mut simulation = Simulation::new(&scene)?;
        if let Variant::Start(start) = self.variant {
            let nodes = simulation.system().mesh().nodes().iter().enumerate();
            let u: Vec<_> = nodes.map(|(node, x)| STARTS[start].1(node, *x) - x).collect();
            // Cannot fail: one vector per node, all finite.
            let _ = simulation.start_from(&u);
        }
        Ok(simulation)
    }

    fn record(Entry { case, outcome, solution, tip: [x, y], .. }: &Entry<Self>) -> String {
        let RestCase { variant, alpha, young, poisson, slenderness, aspect, .. } = *case;
        let (element, method, outcome) = (case.element.id(), case.method.id(), outcome.entry().0);
        let Solution { iterations, residual, residual_floor, .. } = *solution;
        let start = if let Variant::Start(start) = variant { STARTS[start].0 } else { "rest" };
        let moved = variant == Variant::MovedTip;
        let distortion = if let Variant::Distorted(distortion) = variant { distortion } else { 0.0 };
        let mesh = if let Variant::File(id) = variant { id } else { "beam" };
        let floor = residual_floor.map_or_else(String::new, |floor| format!("{floor:e}"));
        format!(
            "{element},{method},{start},{alpha},{young},{poisson},{slenderness},{aspect},{outcome},{iterations},{residual:e},{x},{y},{moved},{distortion},{mesh},{floor}"
        )
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

/// Formats the counts for display, and where each method stops converging.
pub fn summary(entries: &[Entry<RestCase>]) -> String {
    let series = labels(entries, |case| Some(case.series()));
    let alphas = labels(entries, |case| Some(number(case.alpha)));
    let mut by_name = series.clone();
    by_name.sort();
    let at_rounding = entries.iter().filter(|entry| entry.solution.residual_floor.is_some()).count();
    let mut text = format!(
        "{} cases, beams in plane strain\n\n{}\n{at_rounding} of the converged cases stopped at working precision: \
         residual above the tolerance, within the bound of rounding\n",
        entries.len(),
        outcome_table(entries, &by_name)
    );
    let group = |case: &RestCase| match case.variant {
        Variant::Plain => Some("cases from rest, by load α = P L²/EI"),
        Variant::MovedTip => {
            Some("cases from rest, by the displacement of the moved tip, α/3 of the length, at most 0.8")
        }
        Variant::Start(_) => None,
        Variant::Distorted(_) => Some("cases with distorted cells, by load α = P L²/EI"),
        Variant::File(_) => Some("mesh files, by their scenes' load times"),
    };
    let counts = counts(entries, |case| Some((group(case)?, case.series(), number(case.alpha))));
    for cases in labels(entries, group) {
        let percent = |series: &AtlasSeries, column: usize| {
            let row = counts.get(&(cases, series.clone(), alphas[column].clone()))?;
            let [certified, converged, ..] = *row;
            Some(format!("{:.0}", 100.0 * (certified + converged) as f64 / row.iter().sum::<usize>() as f64))
        };
        text += &format!("\ncertified or converged, percent of the {cases}\n");
        text += &text_table::<RestCase>(&series, &alphas, 6, percent);
    }
    text
}
