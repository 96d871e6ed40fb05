//! Stability atlas of motions: every integrator at extremes of stiffness, time step and weight.

use super::{AtlasSeries, Case, Entry, Outcome, labels, outcome_table};
use crate::dynamics::Counts;
use crate::scene::Material;
use crate::study::prelude::*;

/// Case: a beam of 1 m × 0.1 m, clamped at one end, is released from horizontal and falls under its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionCase {
    /// Element.
    pub element: ElementKind,
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Solves per step, or per stage of one; 0 iterates to the tolerance.
    pub iterations: u32,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Time step, s.
    pub time_step: f64,
    /// Gravitational acceleration, m/s².
    pub gravity: f64,
}

/// Time steps per case.
const STEPS: u32 = 100;

/// Returns all cases, with the numbers of solves that make a difference for each integrator.
pub fn cases(extent: Extent) -> Vec<MotionCase> {
    let pick = |quick: &'static [f64], all: &'static [f64]| if extent == Extent::Full { all } else { quick };
    let youngs = pick(&[1e3, 1e6, 1e12], &[1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12]);
    let steps = pick(&[1.0 / 240.0, 0.1], &[1.0 / 240.0, 1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0, 0.1]);
    let weights = pick(&[9.81], &[0.1, 9.81, 1e3]);
    let mut cases = Vec::new();
    for (element, entry) in ElementKind::all().flat_map(|element| INTEGRATORS.iter().map(move |i| (element, i))) {
        let integrator = entry.kind;
        let solves: &[u32] = if entry.is_explicit() || entry.always_iterates { &[0] } else { &[1, 0] };
        for (&iterations, &young) in solves.iter().flat_map(|n| youngs.iter().map(move |young| (n, young))) {
            for (&time_step, &gravity) in steps.iter().flat_map(|step| weights.iter().map(move |g| (step, g))) {
                cases.push(MotionCase { element, integrator, iterations, young, time_step, gravity });
            }
        }
    }
    cases
}

impl Case for MotionCase {
    const OUTCOMES: [Outcome; Outcome::COUNT] =
        [Outcome::Finished, Outcome::Inverted, Outcome::GainedEnergy, Outcome::Exploded, Outcome::Stopped];
    const NAMES: &'static str = "integrator";
    const COLUMNS: &'static str = "E, Pa";
    const HEADER: &'static str = "element,integrator,solves,young,time_step_s,gravity,outcome,steps_taken,solves_taken,halvings,energy_drift,tip_x,tip_y";

    fn series(&self) -> AtlasSeries {
        let entry = self.integrator.entry();
        let name = match self.iterations {
            _ if entry.is_explicit() || entry.always_iterates => entry.id.to_owned(),
            0 => format!("{}, to tolerance", entry.id),
            1 if entry.stages > 1 => format!("{}, 1 solve a stage", entry.id),
            n => format!("{}, {}", entry.id, count(n, "solve")),
        };
        (self.element.id(), name)
    }

    fn cell(&self) -> Option<[String; 2]> {
        Some([format!("1/{:.0} s", 1.0 / self.time_step), format!("{:e}", self.young)])
    }

    fn simulation(&self) -> Result<Simulation, SimulationError> {
        // The number of nodes along the beam is the same for every element.
        let pieces = self.element.entry().degree() as u32;
        let mut scene = Scene::beam(1.0, 0.1)
            .with_cells(20 / pieces, 1)
            .with_element(self.element)
            .with_material(Material { density: 1000.0, ..Material::new(self.young, 0.3) })
            .clamp("left")
            .gravity([0.0, -self.gravity])
            .probe("tip", "right")
            .moving(self.integrator, self.time_step);
        scene.dynamics.iterations = self.iterations;
        scene.dynamics.duration = f64::from(STEPS) * self.time_step;
        Simulation::new(&scene)
    }

    fn record(Entry { case, outcome, motion, tip: [x, y], .. }: &Entry<Self>) -> String {
        let (element, integrator, outcome) = (case.element.id(), case.integrator.id(), outcome.entry().0);
        let (MotionCase { iterations, time_step, gravity, .. }, young) = (case, number(case.young));
        let (Counts { steps, solves, halvings, .. }, drift) = motion.unwrap_or_default();
        format!(
            "{element},{integrator},{iterations},{young},{time_step:e},{gravity},{outcome},{steps},{solves},{halvings},{drift:e},{x},{y}"
        )
    }
}

/// Formats the counts for display.
pub fn summary(entries: &[Entry<MotionCase>]) -> String {
    let series = labels(entries, |case| Some(case.series()));
    format!(
        "in motion: {} cases, a beam released under its own weight, {STEPS} steps\n\n{}",
        entries.len(),
        outcome_table(entries, &series)
    )
}
