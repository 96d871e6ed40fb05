//! Stability atlas: every method at extremes of load, stiffness, Poisson ratio, slenderness and element shape, on mesh
//! files, and from extreme initial states. Each case is classified; no case may panic or give values that are not
//! finite.

mod body;
pub mod motion;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use nalgebra::Vector2;

use self::body::distorted;
pub use self::body::{CaseBody, FILES};
use super::Extent;
use crate::format::number;
use crate::method::{METHODS, Reason};
use crate::rotation::Rotation;
use crate::scene::{Axis, ElementKind, Material, MethodKind, Plane, Scene};
use crate::simulation::{Simulation, SimulationError, Status};

/// Initial state of a solve; fixed nodes stay at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CaseStart {
    /// Rest mesh.
    Rest,
    /// Every node on the axis: all elements without area.
    Flat,
    /// Mirrored at the axis: all elements inverted.
    Mirrored,
    /// Every node at a random place within one height of its rest position.
    Random,
    /// Rotated by 179° about the clamp.
    Turned,
}

impl CaseStart {
    /// All initial states.
    pub const ALL: [Self; 5] = [Self::Rest, Self::Flat, Self::Mirrored, Self::Random, Self::Turned];

    /// Returns the identifier in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Flat => "flat",
            Self::Mirrored => "mirrored",
            Self::Random => "random",
            Self::Turned => "turned",
        }
    }

    /// Returns the initial position of a node with rest position `x`, for a beam of this height.
    fn place(self, node: usize, x: Vector2<f64>, height: f64) -> Vector2<f64> {
        match self {
            Self::Rest => x,
            Self::Flat => Vector2::new(x.x, 0.0),
            Self::Mirrored => Vector2::new(x.x, -x.y),
            Self::Random => {
                // Low-discrepancy sequence: the same numbers on every machine.
                let offset = |k: f64| (k * (node as f64 + 1.0)).fract() - 0.5;
                x + Vector2::new(offset(0.754_877_666), offset(0.569_840_291)) * (2.0 * height)
            }
            Self::Turned => Rotation::from_angle(179f64.to_radians()).apply(x),
        }
    }
}

/// Case of the atlas: a cantilever of height 1 m in plane strain, or a built-in scene with a mesh file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Body.
    pub body: CaseBody,
    /// Element.
    pub element: ElementKind,
    /// Method.
    pub method: MethodKind,
    /// Initial state.
    pub start: CaseStart,
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
    /// Displacement of nodes along the beam, with alternating sign, as a fraction of the cell length.
    pub distortion: f64,
    /// `true` if the tip is moved transversely instead of loaded: by the deflection of linear beam theory under the
    /// load, α/3 of the length, but at most [`FARTHEST_TIP`] of it.
    pub moved: bool,
}

/// Largest prescribed tip displacement, relative to the length.
pub const FARTHEST_TIP: f64 = 0.8;

/// Outcome of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// Converged to an equilibrium with positive definite exact tangent and no inverted element.
    Certified,
    /// Converged without certificate: linear theory, or an equilibrium that may be unstable.
    Converged,
    /// Converged, with inverted elements.
    Inverted,
    /// The iteration makes no progress.
    Stalled,
    /// Stopped before the end.
    NotConverged,
}

impl Outcome {
    /// Number of outcomes.
    pub const COUNT: usize = 5;

    /// All outcomes, best first.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Certified, Self::Converged, Self::Inverted, Self::Stalled, Self::NotConverged];

    /// Returns the identifier in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Certified => "certified",
            Self::Converged => "converged",
            Self::Inverted => "inverted",
            Self::Stalled => "stalled",
            Self::NotConverged => "not_converged",
        }
    }
}

/// Case with its outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Case.
    pub case: Case,
    /// Outcome.
    pub outcome: Outcome,
    /// Number of solves.
    pub iterations: u32,
    /// Relative residual at the end.
    pub residual: f64,
    /// Bound of the residual's rounding error, if the solve has ended at it; see
    /// [`crate::Equilibrium::residual_floor`].
    pub residual_floor: Option<f64>,
    /// Displacement of the tip over the length, or of the first probe over the size, in the last finite state.
    pub tip: Vector2<f64>,
}

/// Returns all cases, a few hundred or many thousand: a grid of loads and shapes from rest, all initial states,
/// distorted cells, and scenes with mesh files.
#[must_use]
pub fn cases(extent: Extent) -> Vec<Case> {
    let full = extent == Extent::Full;
    let pick = |quick: &[f64], all: &[f64]| if full { all.to_vec() } else { quick.to_vec() };
    let alphas = pick(&[0.1, 10.0, 1e3], &[1e-6, 1e-2, 0.1, 1.0, 2.0, 5.0, 10.0, 30.0, 100.0, 1e3, 1e6]);
    let youngs = pick(&[1e6], &[1e-3, 1e6, 1e10]);
    let poissons = pick(&[0.0, 0.4999], &[0.0, 0.3, 0.49, 0.4999]);
    let slendernesses = pick(&[1.0, 20.0, 1e3], &[1.0, 5.0, 20.0, 100.0, 1e3]);
    let aspects = pick(&[2.0], &[1.0, 5.0, 50.0]);
    let distortions = pick(&[0.45], &[0.3, 0.45]);
    let distorted_slendernesses = pick(&[20.0], &[5.0, 20.0, 100.0]);
    let mut cases = Vec::new();
    for (element, method) in ElementKind::all().flat_map(|e| METHODS.iter().map(move |m| (e, m.kind))) {
        let ordinary = Case {
            body: CaseBody::Beam,
            element,
            method,
            start: CaseStart::Rest,
            alpha: 1.0,
            young: 1e6,
            poisson: 0.3,
            slenderness: 20.0,
            aspect: 2.0,
            distortion: 0.0,
            moved: false,
        };
        for &alpha in &alphas {
            for &slenderness in &slendernesses {
                for &poisson in &poissons {
                    for &aspect in &aspects {
                        cases.push(Case { alpha, slenderness, poisson, aspect, ..ordinary });
                    }
                }
                cases.push(Case { alpha, slenderness, moved: true, ..ordinary });
                for &young in youngs.iter().filter(|&&young| young != ordinary.young) {
                    cases.push(Case { alpha, slenderness, young, ..ordinary });
                }
            }
            for start in CaseStart::ALL {
                if start != CaseStart::Rest {
                    cases.push(Case { alpha, start, ..ordinary });
                }
            }
            for &distortion in &distortions {
                let shapes = distorted_slendernesses.iter();
                cases.extend(shapes.map(|&slenderness| Case { alpha, slenderness, distortion, ..ordinary }));
            }
            cases.extend(FILES.iter().filter_map(|&id| ordinary.on_file(id, alpha)));
        }
    }
    cases
}

impl Case {
    /// Returns the case with the same element and method on a mesh file; `None` if the file has no such elements.
    fn on_file(self, id: &'static str, alpha: f64) -> Option<Self> {
        let scene = body::scene(id)?;
        let Material { young, poisson, .. } = scene.material;
        let case = Self { body: CaseBody::File(id), alpha, young, poisson, slenderness: 1.0, aspect: 1.0, ..self };
        scene.elements().any(|e| e == self.element).then_some(case)
    }

    /// Returns `true` for a beam with rectangular cells that starts at rest.
    fn is_plain(&self) -> bool {
        (self.body, self.start) == (CaseBody::Beam, CaseStart::Rest) && self.distortion == 0.0
    }

    /// Returns the scene of the case.
    #[must_use]
    pub fn scene(&self) -> Scene {
        if let CaseBody::File(id) = self.body
            && let Some(mut scene) = body::scene(id)
        {
            scene.set_element(self.element);
            scene.scale_loads(self.alpha);
            scene.solver.method = self.method;
            scene.solver.accept_after = 0;
            return scene;
        }
        /// Upper limit of the number of cells along the beam.
        const MAX_CELLS: f64 = 200.0;
        let height = 1.0;
        let across = 2;
        let cell = height / f64::from(across);
        let along = (self.slenderness * height / (self.aspect * cell)).round().clamp(1.0, MAX_CELLS);
        let length = self.slenderness * height;
        let force = self.alpha * self.young * height.powi(3) / 12.0 / (length * length);
        let material = Material { density: 0.0, plane: Plane::Strain, ..Material::new(self.young, self.poisson) };
        let scene = Scene::beam(length, height)
            .with_cells(along as u32, across)
            .with_element(self.element)
            .with_material(material)
            .with_method(self.method)
            .clamp("left")
            .probe("tip", "right");
        if self.moved {
            let displacement = length * (self.alpha / 3.0).min(FARTHEST_TIP);
            scene.support([length, 0.0], &[Axis::Y]).moved([0.0, -displacement], 0.0)
        } else {
            scene.force("right", [0.0, -force])
        }
    }

    /// Solves the case and classifies its outcome.
    ///
    /// # Errors
    /// [`SimulationError`] if the scene is invalid, which would be a mistake in the atlas.
    pub fn solve(self) -> Result<Entry, SimulationError> {
        let scene = self.scene();
        let mut simulation = match distorted(&scene, self.distortion) {
            Some(mesh) => Simulation::with_mesh(&scene, mesh)?,
            None => Simulation::new(&scene)?,
        };
        if self.start != CaseStart::Rest {
            let nodes = simulation.system().mesh().nodes().iter().enumerate();
            let u = nodes.map(|(n, x)| self.start.place(n, *x, 1.0) - x).collect::<Vec<_>>();
            // Cannot fail: one vector per node, all finite.
            let _ = simulation.start_from(&u);
        }
        simulation.solve();
        let stable = simulation.certify().stable;
        let solution = simulation.solution();
        let outcome = match (&solution.status, stable) {
            (Status::Converged, _) if solution.deformation.inverted_elements > 0 => Outcome::Inverted,
            (Status::Converged, Some(true)) => Outcome::Certified,
            (Status::Converged, _) => Outcome::Converged,
            (Status::Diverged(Reason::Stalled(_)), _) => Outcome::Stalled,
            _ => Outcome::NotConverged,
        };
        let length = match self.body {
            CaseBody::Beam => self.slenderness,
            CaseBody::File(_) => simulation.system().size(),
        };
        let tip = solution.probes.first().map_or(Vector2::zeros(), |p| p.u) / length;
        Ok(Entry {
            case: self,
            outcome,
            iterations: solution.iterations,
            residual: solution.residual,
            residual_floor: solution.residual_floor,
            tip,
        })
    }
}

/// Formats the atlas as CSV.
#[must_use]
pub fn table(entries: &[Entry]) -> String {
    let mut text = String::from(
        "element,method,start,alpha,young,poisson,length_over_height,cell_aspect,outcome,iterations,residual,tip_x_over_l,tip_y_over_l,moved,distortion,mesh,residual_floor\n",
    );
    for e in entries {
        let c = &e.case;
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{:e},{},{},{},{},{},{}",
            c.element.id(),
            c.method.id(),
            c.start.id(),
            c.alpha,
            c.young,
            c.poisson,
            c.slenderness,
            c.aspect,
            e.outcome.id(),
            e.iterations,
            e.residual,
            e.tip.x,
            e.tip.y,
            c.moved,
            c.distortion,
            c.body.id(),
            e.residual_floor.map_or_else(String::new, |floor| format!("{floor:e}"))
        );
    }
    text
}

/// Counts the outcomes of each element and method.
#[must_use]
pub fn counts(entries: &[Entry]) -> BTreeMap<(&'static str, &'static str), [usize; Outcome::COUNT]> {
    let mut counts = BTreeMap::new();
    for e in entries {
        let row: &mut [usize; Outcome::COUNT] = counts.entry((e.case.element.id(), e.case.method.id())).or_default();
        row[e.outcome as usize] += 1;
    }
    counts
}

/// The loads of the atlas, small to large.
pub(crate) fn alphas(entries: &[Entry]) -> Vec<f64> {
    let mut alphas: Vec<f64> = entries.iter().map(|e| e.case.alpha).collect();
    alphas.sort_by(f64::total_cmp);
    alphas.dedup();
    alphas
}

/// Predicate that selects cases.
type CaseFilter = fn(&Case) -> bool;

/// Returns the percentage of successful cases of a kind under a load; `None` if there are no such cases.
fn percent_well(
    entries: &[Entry],
    (element, method): (ElementKind, MethodKind),
    alpha: f64,
    is_of: CaseFilter,
) -> Option<f64> {
    let here = entries.iter().filter(|e| {
        let c = &e.case;
        (c.element, c.method) == (element, method) && c.alpha == alpha && is_of(c)
    });
    let well = |e: &&Entry| matches!(e.outcome, Outcome::Certified | Outcome::Converged);
    let all = here.clone().count();
    (all > 0).then(|| 100.0 * here.filter(well).count() as f64 / all as f64)
}

/// Formats the counts for display, and where each method stops converging.
#[must_use]
pub fn summary(entries: &[Entry]) -> String {
    let mut text = format!("{} cases, beams in plane strain\n\nelement method ", entries.len());
    for outcome in Outcome::ALL {
        let _ = write!(text, " {:>14}", outcome.id());
    }
    text.push('\n');
    for ((element, method), row) in counts(entries) {
        let _ = write!(text, "{element:<7} {method:<7}");
        for count in row {
            let _ = write!(text, " {count:>14}");
        }
        text.push('\n');
    }
    let at_rounding = entries.iter().filter(|e| e.residual_floor.is_some()).count();
    let _ = writeln!(
        text,
        "\n{at_rounding} of the converged cases stopped at working precision: residual above the tolerance, within \
         the bound of rounding"
    );
    let kinds: [(CaseFilter, &str); 4] = [
        (|c| c.is_plain() && !c.moved, "of the cases from rest, by load α = P L²/EI"),
        (
            |c| c.is_plain() && c.moved,
            "of the cases from rest, by the displacement of the moved tip, α/3 of the length, at most 0.8",
        ),
        (|c| c.distortion > 0.0, "of the cases with distorted cells, by load α = P L²/EI"),
        (|c| c.body != CaseBody::Beam, "of the mesh files, by their scenes' load times"),
    ];
    for (is_of, by) in kinds {
        let _ = write!(text, "\ncertified or converged, percent {by}\nelement method ");
        let alphas = alphas(entries);
        for alpha in &alphas {
            let _ = write!(text, " {:>6}", number(*alpha));
        }
        text.push('\n');
        for (element, method) in ElementKind::all().flat_map(|e| METHODS.iter().map(move |m| (e, m.kind))) {
            let row = alphas.iter().map(|&alpha| percent_well(entries, (element, method), alpha, is_of));
            let row: Vec<Option<f64>> = row.collect();
            if row.iter().all(Option::is_none) {
                continue;
            }
            let _ = write!(text, "{:<7} {:<7}", element.id(), method.id());
            for percent in row {
                let _ =
                    write!(text, " {:>6}", percent.map_or_else(|| "–".to_owned(), |percent| format!("{percent:.0}")));
            }
            text.push('\n');
        }
    }
    text
}
