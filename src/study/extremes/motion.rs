//! Stability atlas of motions: every integrator at extremes of stiffness, time step and weight.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::super::Extent;
use crate::dynamics::{INTEGRATORS, StopReason};
use crate::format::number;
use crate::scene::{ElementKind, IntegratorKind, Material, Scene};
use crate::simulation::{Simulation, SimulationError, Status};

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

/// Outcome of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotionOutcome {
    /// All steps were computed without spurious energy.
    Finished,
    /// All steps were computed without spurious energy, with inverted elements at the end.
    Inverted,
    /// All steps were computed, but the integrator added more than a hundredth of the largest kinetic energy.
    GainedEnergy,
    /// A value was not finite, or the body moved away too far.
    Exploded,
    /// A step failed even at the smallest length.
    Stopped,
}

impl MotionOutcome {
    /// Number of outcomes.
    pub const COUNT: usize = 5;

    /// All outcomes, best first.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Finished, Self::Inverted, Self::GainedEnergy, Self::Exploded, Self::Stopped];

    /// Returns the identifier in tables.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Inverted => "inverted",
            Self::GainedEnergy => "gained_energy",
            Self::Exploded => "exploded",
            Self::Stopped => "stopped",
        }
    }
}

/// Case with its outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionEntry {
    /// Case.
    pub case: MotionCase,
    /// Outcome.
    pub outcome: MotionOutcome,
    /// Number of time steps.
    pub steps: u64,
    /// Number of solves.
    pub solves: u64,
    /// Number of failed steps that were halved.
    pub halvings: u64,
    /// Energy added by the integrator, relative to the largest kinetic energy.
    pub drift: f64,
    /// Displacement of the tip at the end, m, in the last finite state.
    pub tip: [f64; 2],
}

/// Time steps per case.
const STEPS: u32 = 100;
/// Largest energy added, relative to the largest kinetic energy, that does not count as gained.
const GAINED: f64 = 0.01;

/// Iterates over integrators and the numbers of solves that make a difference for them.
pub(crate) fn variants() -> impl Iterator<Item = (IntegratorKind, u32)> {
    INTEGRATORS.iter().flat_map(|i| {
        let solves: &[u32] = if i.is_explicit() || i.always_iterates { &[0] } else { &[1, 0] };
        solves.iter().map(|&n| (i.kind, n))
    })
}

/// Describes an integrator, with its number of solves if that makes a difference.
pub(crate) fn variant_text(integrator: IntegratorKind, iterations: u32) -> String {
    let entry = integrator.entry();
    match iterations {
        _ if entry.is_explicit() || entry.always_iterates => entry.id.to_owned(),
        0 => format!("{}, to tolerance", entry.id),
        1 if entry.stages > 1 => format!("{}, 1 solve a stage", entry.id),
        n => format!("{}, {}", entry.id, crate::format::count(n, "solve")),
    }
}

/// Returns all cases.
#[must_use]
pub fn cases(extent: Extent) -> Vec<MotionCase> {
    let full = extent == Extent::Full;
    let pick = |quick: &[f64], all: &[f64]| if full { all.to_vec() } else { quick.to_vec() };
    let youngs = pick(&[1e3, 1e6, 1e12], &[1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12]);
    let steps = pick(&[1.0 / 240.0, 0.1], &[1.0 / 240.0, 1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0, 0.1]);
    let weights = pick(&[9.81], &[0.1, 9.81, 1e3]);
    let mut cases = Vec::new();
    for element in ElementKind::all() {
        for (integrator, iterations) in variants() {
            for &young in &youngs {
                for &time_step in &steps {
                    for &gravity in &weights {
                        cases.push(MotionCase { element, integrator, iterations, young, time_step, gravity });
                    }
                }
            }
        }
    }
    cases
}

impl MotionCase {
    /// Returns the scene of the case.
    #[must_use]
    pub fn scene(&self) -> Scene {
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
        scene
    }

    /// Runs the case and classifies its outcome.
    ///
    /// # Errors
    /// [`SimulationError`] if the scene is invalid, which would be a mistake in the atlas.
    pub fn run(self) -> Result<MotionEntry, SimulationError> {
        let mut simulation = Simulation::new(&self.scene())?;
        simulation.solve();
        let solution = simulation.solution();
        let (counts, drift) = solution.motion.map(|m| (m.counts, m.ledger.drift())).unwrap_or_default();
        let outcome = match solution.status {
            Status::Stopped(StopReason::Step { .. }) => MotionOutcome::Stopped,
            Status::Stopped(_) => MotionOutcome::Exploded,
            _ if drift > GAINED => MotionOutcome::GainedEnergy,
            _ if solution.deformation.inverted_elements > 0 => MotionOutcome::Inverted,
            _ => MotionOutcome::Finished,
        };
        let tip = solution.probes.first().map_or([0.0; 2], |p| [p.u.x, p.u.y]);
        let (steps, solves, halvings) = (counts.steps, counts.solves, counts.halvings);
        Ok(MotionEntry { case: self, outcome, steps, solves, halvings, drift, tip })
    }
}

/// Formats the atlas of motions as CSV.
#[must_use]
pub fn table(entries: &[MotionEntry]) -> String {
    let mut text = String::from(
        "element,integrator,solves,young,time_step_s,gravity,outcome,steps_taken,solves_taken,halvings,energy_drift,tip_x,tip_y\n",
    );
    for e in entries {
        let c = &e.case;
        let _ = writeln!(
            text,
            "{},{},{},{},{:e},{},{},{},{},{},{:e},{},{}",
            c.element.id(),
            c.integrator.id(),
            c.iterations,
            number(c.young),
            c.time_step,
            c.gravity,
            e.outcome.id(),
            e.steps,
            e.solves,
            e.halvings,
            e.drift,
            e.tip[0],
            e.tip[1]
        );
    }
    text
}

/// Counts the outcomes of each element, integrator and number of solves per step.
#[must_use]
pub fn counts(entries: &[MotionEntry]) -> BTreeMap<(&'static str, &'static str, u32), [usize; MotionOutcome::COUNT]> {
    let mut counts = BTreeMap::new();
    for e in entries {
        let key = (e.case.element.id(), e.case.integrator.id(), e.case.iterations);
        let row: &mut [usize; MotionOutcome::COUNT] = counts.entry(key).or_default();
        row[e.outcome as usize] += 1;
    }
    counts
}

/// Formats the counts for display.
#[must_use]
pub fn summary(entries: &[MotionEntry]) -> String {
    let mut text = format!(
        "in motion: {} cases, a beam released under its own weight, {STEPS} steps\n\nelement {:<28}",
        entries.len(),
        "integrator"
    );
    for outcome in MotionOutcome::ALL {
        let _ = write!(text, " {:>14}", outcome.id());
    }
    text.push('\n');
    let counts = counts(entries);
    for (element, (integrator, iterations)) in ElementKind::all().flat_map(|e| variants().map(move |v| (e, v))) {
        let Some(row) = counts.get(&(element.id(), integrator.id(), iterations)) else { continue };
        let _ = write!(text, "{:<7} {:<28}", element.id(), variant_text(integrator, iterations));
        for count in row {
            let _ = write!(text, " {count:>14}");
        }
        text.push('\n');
    }
    text
}
