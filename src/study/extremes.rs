//! The stability atlas: every method at the extremes of load, stiffness, Poisson ratio, slenderness, element shape, and
//! from states no solver should be started in. Each case is classified; nothing in it is ever non-finite or a panic.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use nalgebra::Vector2;

use super::Extent;
use crate::method::METHODS;
use crate::rotation::Rotation;
use crate::scene::{
    Axis, Beam, Diagonals, ElementKind, Load, Material, MethodKind, Place, Plane, Probe, Scene, SolverSettings, Support,
};
use crate::simulation::{Reason, Simulation, Status};

/// The state a solve starts from; what supports hold stays at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Start {
    /// As meshed.
    Rest,
    /// Every node on the axis: all triangles without area.
    Flat,
    /// Turned over about the axis: all triangles inverted.
    Mirrored,
    /// Every node somewhere within a height of its place.
    Random,
    /// Turned by 179° about the clamp.
    Turned,
}

impl Start {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Rest, Self::Flat, Self::Mirrored, Self::Random, Self::Turned];

    /// The word in tables.
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

    /// Where a node at rest at `x` starts, for a beam of this height.
    fn place(self, node: usize, x: Vector2<f64>, height: f64) -> Vector2<f64> {
        match self {
            Self::Rest => x,
            Self::Flat => Vector2::new(x.x, 0.0),
            Self::Mirrored => Vector2::new(x.x, -x.y),
            Self::Random => {
                // Low-discrepancy: the same numbers on every machine.
                let share = |k: f64| (k * (node as f64 + 1.0)).fract() - 0.5;
                x + Vector2::new(share(0.754_877_666), share(0.569_840_291)) * (2.0 * height)
            }
            Self::Turned => Rotation::from_angle(179f64.to_radians()).apply(x),
        }
    }
}

/// One case of the atlas: a cantilever of height 1 m in plane strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Element.
    pub element: ElementKind,
    /// Method.
    pub method: MethodKind,
    /// Where it starts.
    pub start: Start,
    /// Load α = P L²/EI, at the tip, across.
    pub alpha: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson ratio.
    pub poisson: f64,
    /// Length over height.
    pub slenderness: f64,
    /// Length over height of a cell, as far as the beam allows.
    pub aspect: f64,
}

/// How a case ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// Converged to an equilibrium whose exact tangent is positive definite, no element inverted.
    Certified,
    /// Converged; linear theory has no certificate, and other equilibria may be unstable.
    Converged,
    /// Converged, with elements turned inside out.
    Inverted,
    /// Going round without an end.
    LimitCycle,
    /// Stopped before the end.
    NotConverged,
}

impl Outcome {
    /// All of them, best first.
    pub const ALL: [Self; 5] = [Self::Certified, Self::Converged, Self::Inverted, Self::LimitCycle, Self::NotConverged];

    /// The word in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Certified => "certified",
            Self::Converged => "converged",
            Self::Inverted => "inverted",
            Self::LimitCycle => "limit_cycle",
            Self::NotConverged => "not_converged",
        }
    }
}

/// A case with its outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// What was solved.
    pub case: Case,
    /// How it ended.
    pub outcome: Outcome,
    /// Solves taken.
    pub iterations: u32,
    /// Relative residual at the end.
    pub residual: f64,
    /// The tip's displacement over the length: of the last finite state.
    pub tip: Vector2<f64>,
}

/// Iterations a case may take.
const MAX_ITERATIONS: u32 = 300;

/// All cases, a few hundred or a few thousand: a grid of loads and shapes from rest, and every start under some loads.
#[must_use]
pub fn cases(extent: Extent) -> Vec<Case> {
    let full = extent == Extent::Full;
    let pick = |quick: &[f64], all: &[f64]| if full { all.to_vec() } else { quick.to_vec() };
    let alphas = pick(&[0.1, 10.0, 1e3], &[1e-6, 1e-2, 0.1, 1.0, 2.0, 5.0, 10.0, 30.0, 100.0, 1e3, 1e6]);
    let youngs = pick(&[1e6], &[1e-3, 1e6, 1e10]);
    let poissons = pick(&[0.0, 0.4999], &[0.0, 0.3, 0.49, 0.4999]);
    let slendernesses = pick(&[1.0, 20.0, 1e3], &[1.0, 5.0, 20.0, 100.0, 1e3]);
    let aspects = pick(&[2.0], &[1.0, 5.0, 50.0]);
    let mut cases = Vec::new();
    for (element, method) in ElementKind::ALL.into_iter().flat_map(|e| METHODS.iter().map(move |m| (e, m.kind))) {
        let ordinary = Case {
            element,
            method,
            start: Start::Rest,
            alpha: 1.0,
            young: 1e6,
            poisson: 0.3,
            slenderness: 20.0,
            aspect: 2.0,
        };
        for &alpha in &alphas {
            for &slenderness in &slendernesses {
                for &poisson in &poissons {
                    for &aspect in &aspects {
                        cases.push(Case { alpha, slenderness, poisson, aspect, ..ordinary });
                    }
                }
                for &young in youngs.iter().filter(|&&young| young != ordinary.young) {
                    cases.push(Case { alpha, slenderness, young, ..ordinary });
                }
            }
            for start in Start::ALL {
                if start != Start::Rest {
                    cases.push(Case { alpha, start, ..ordinary });
                }
            }
        }
    }
    cases
}

impl Case {
    /// The scene of the case.
    #[must_use]
    pub fn scene(&self) -> Scene {
        /// Cells along are as many as the aspect asks for, up to these.
        const MOST_CELLS: f64 = 200.0;
        let height = 1.0;
        let across = 2;
        let cell = height / f64::from(across);
        let along = (self.slenderness * height / (self.aspect * cell)).round().clamp(1.0, MOST_CELLS);
        let length = self.slenderness * height;
        let force = self.alpha * self.young * height.powi(3) / 12.0 / (length * length);
        Scene {
            name: "Extreme".to_owned(),
            about: String::new(),
            analysis: crate::scene::Analysis::Static,
            beam: Some(Beam {
                length,
                height,
                cells: [along as u32, across],
                element: self.element,
                diagonals: Diagonals::Alternating,
            }),
            mesh: None,
            material: Material {
                young: self.young,
                poisson: self.poisson,
                density: 0.0,
                thickness: 1.0,
                plane: Plane::Strain,
            },
            supports: vec![Support { edge: Some("left".to_owned()), at: None, fix: vec![Axis::X, Axis::Y] }],
            loads: vec![Load::Force { place: Place::edge("right"), force: [0.0, -force] }],
            probes: vec![Probe { name: "tip".to_owned(), edge: Some("right".to_owned()), at: None }],
            solver: SolverSettings { method: self.method, max_iterations: MAX_ITERATIONS, ..SolverSettings::default() },
        }
    }

    /// Solves the case and classifies how it ends.
    ///
    /// # Errors
    /// What is wrong with its scene, which is a mistake in the atlas.
    pub fn solve(self) -> Result<Entry, crate::simulation::SimulationError> {
        let scene = self.scene();
        let mut simulation = Simulation::new(&scene)?;
        if self.start != Start::Rest {
            let nodes = simulation.system().mesh.nodes.iter().enumerate();
            let u = nodes.map(|(n, x)| self.start.place(n, *x, 1.0) - x).collect::<Vec<_>>();
            simulation.start_from(&u);
        }
        simulation.solve();
        let solution = simulation.solution(None);
        let outcome = match (&solution.status, solution.certificate.stable) {
            (Status::Converged, _) if solution.inverted_elements > 0 => Outcome::Inverted,
            (Status::Converged, Some(true)) => Outcome::Certified,
            (Status::Converged, _) => Outcome::Converged,
            (Status::Diverged(Reason::Wanders(_)), _) => Outcome::LimitCycle,
            _ => Outcome::NotConverged,
        };
        let tip = solution.probes.first().map_or(Vector2::zeros(), |p| p.u) / self.slenderness;
        Ok(Entry { case: self, outcome, iterations: solution.iterations, residual: solution.residual, tip })
    }
}

/// The atlas as CSV.
#[must_use]
pub fn table(entries: &[Entry]) -> String {
    let mut text = String::from(
        "element,method,start,alpha,young,poisson,length_over_height,cell_aspect,outcome,iterations,residual,tip_x_over_l,tip_y_over_l\n",
    );
    for e in entries {
        let c = &e.case;
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{:e},{},{}",
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
            e.tip.y
        );
    }
    text
}

/// How many cases of each element and method ended how.
#[must_use]
pub fn counts(entries: &[Entry]) -> BTreeMap<(&'static str, &'static str), [usize; 5]> {
    let mut counts = BTreeMap::new();
    for e in entries {
        let row: &mut [usize; 5] = counts.entry((e.case.element.id(), e.case.method.id())).or_default();
        row[e.outcome as usize] += 1;
    }
    counts
}

/// The loads of the atlas, small to large.
fn alphas(entries: &[Entry]) -> Vec<f64> {
    let mut alphas: Vec<f64> = entries.iter().map(|e| e.case.alpha).collect();
    alphas.sort_by(f64::total_cmp);
    alphas.dedup();
    alphas
}

/// Percent of the cases from rest under a load that end well, as the method counts it.
fn percent_well(entries: &[Entry], element: ElementKind, method: MethodKind, alpha: f64) -> f64 {
    let here = entries.iter().filter(|e| {
        let c = &e.case;
        (c.element, c.method, c.start) == (element, method, Start::Rest) && c.alpha == alpha
    });
    let well = |e: &&Entry| matches!(e.outcome, Outcome::Certified | Outcome::Converged);
    100.0 * here.clone().filter(well).count() as f64 / here.count().max(1) as f64
}

/// The counts for people, and where each method stops working.
#[must_use]
pub fn summary(entries: &[Entry]) -> String {
    let mut text = format!("{} cases, plane strain\n\nelement method ", entries.len());
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
    text.push_str("\ncertified or converged, percent of the cases from rest, by load α = P L²/EI\nelement method ");
    let alphas = alphas(entries);
    for alpha in &alphas {
        let _ = write!(text, " {:>6}", crate::scene::limits::number(*alpha));
    }
    text.push('\n');
    for (element, method) in ElementKind::ALL.into_iter().flat_map(|e| METHODS.iter().map(move |m| (e, m.kind))) {
        let _ = write!(text, "{:<7} {:<7}", element.id(), method.id());
        for &alpha in &alphas {
            let _ = write!(text, " {:>6.0}", percent_well(entries, element, method, alpha));
        }
        text.push('\n');
    }
    text
}

/// The atlas as a picture (SVG): for every element and method, load against slenderness; from rest, and from the other
/// starts. A cell's bar is divided by how its cases ended.
#[must_use]
pub fn heat_map(entries: &[Entry]) -> String {
    const CELL: [f64; 2] = [52.0, 20.0];
    const MARGIN: [f64; 2] = [96.0, 64.0];
    const GAP: f64 = 56.0;
    const LEGEND: f64 = 128.0;
    let columns = alphas(entries);
    // Rows: slenderness from rest, then the other starts.
    let mut rows: Vec<(String, Start, f64)> = entries
        .iter()
        .map(|e| match e.case.start {
            Start::Rest => (format!("L/H {}", e.case.slenderness), Start::Rest, e.case.slenderness),
            start => (start.id().to_owned(), start, e.case.slenderness),
        })
        .collect();
    rows.sort_by(|a, b| (a.1, a.2).partial_cmp(&(b.1, b.2)).unwrap_or(std::cmp::Ordering::Equal));
    rows.dedup_by(|a, b| a.0 == b.0);
    let panel = [MARGIN[0] + CELL[0] * columns.len() as f64, GAP + CELL[1] * rows.len() as f64];
    let size = [(20.0 + panel[0] * 2.0).max(LEGEND * 5.0 + 40.0), MARGIN[1] + panel[1] * METHODS.len() as f64];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"Ubuntu, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        size[0], size[1]
    );
    let mut x = 20.0;
    for outcome in Outcome::ALL {
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"14\" width=\"14\" height=\"14\" fill=\"{}\"/><text x=\"{}\" y=\"26\">{}</text>",
            color(outcome),
            x + 20.0,
            outcome.id().replace('_', " ")
        );
        x += LEGEND;
    }
    for (i, element) in ElementKind::ALL.into_iter().enumerate() {
        for (j, method) in METHODS.iter().enumerate() {
            let corner = [MARGIN[0] + panel[0] * i as f64, MARGIN[1] + panel[1] * j as f64];
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{}\" font-size=\"14\">{} {}: load α = P L²/EI</text>",
                corner[0],
                corner[1] - 8.0,
                element.id(),
                method.kind.id()
            );
            for (row, (label, start, slenderness)) in rows.iter().enumerate() {
                let y = corner[1] + CELL[1] * row as f64;
                let _ = writeln!(
                    svg,
                    "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text>",
                    corner[0] - 6.0,
                    y + 14.0
                );
                for (column, &alpha) in columns.iter().enumerate() {
                    let here = entries.iter().filter(|e| {
                        let c = &e.case;
                        (c.element, c.method, c.start) == (element, method.kind, *start)
                            && c.alpha == alpha
                            && c.slenderness == *slenderness
                    });
                    let mut count = [0usize; 5];
                    here.for_each(|e| count[e.outcome as usize] += 1);
                    let total: usize = count.iter().sum();
                    let mut left = corner[0] + CELL[0] * column as f64;
                    for (outcome, count) in Outcome::ALL.into_iter().zip(count) {
                        let width = (CELL[0] - 2.0) * count as f64 / total.max(1) as f64;
                        if count > 0 {
                            let _ = writeln!(
                                svg,
                                "<rect x=\"{left}\" y=\"{y}\" width=\"{width}\" height=\"{}\" fill=\"{}\"/>",
                                CELL[1] - 2.0,
                                color(outcome)
                            );
                        }
                        left += width;
                    }
                }
            }
            for (column, alpha) in columns.iter().enumerate() {
                let _ = writeln!(
                    svg,
                    "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                    corner[0] + CELL[0] * (column as f64 + 0.5),
                    corner[1] + CELL[1] * rows.len() as f64 + 14.0,
                    crate::scene::limits::number(*alpha)
                );
            }
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Colours that differ in brightness (Okabe and Ito 2008).
fn color(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Certified => "#0072b2",
        Outcome::Converged => "#56b4e9",
        Outcome::Inverted => "#f0e442",
        Outcome::LimitCycle => "#e69f00",
        Outcome::NotConverged => "#b03a2e",
    }
}
