//! Stability atlas of motions: every integrator at extremes of stiffness, time step and weight. A beam of 1 m × 0.1 m,
//! clamped at one end, is released from horizontal and falls under its weight.

use super::{Atlas, Entry, Outcome, solve};
use crate::dynamics::Counts;
use crate::scene::Material;
use crate::study::prelude::*;

/// Time steps per case.
const STEPS: u32 = 100;

/// Returns the scenes of all cases, with the numbers of solves that make a difference for each integrator, each with its
/// gravitational acceleration, m/s².
pub fn cases(extent: Extent) -> Vec<(Scene, f64)> {
    let pick = |values: [&'static [f64]; 2]| extent.pick(values);
    let youngs = pick([&[1e3, 1e6, 1e12], &[1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12]]);
    let steps = pick([&[1.0 / 240.0, 0.1], &[1.0 / 240.0, 1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0, 0.1]]);
    let weights = pick([&[9.81], &[0.1, 9.81, 1e3]]);
    let mut cases = Vec::new();
    for (element, entry) in ElementKind::all().flat_map(|element| INTEGRATORS.iter().map(move |i| (element, i))) {
        // The number of nodes along the beam is the same for every element.
        let along = 20 / element.entry().degree() as u32;
        let beam = Scene::beam(1.0, 0.1).with_cells(along, 1).with_element(element).clamp("left").probe("tip", "right");
        let solves: &[u32] = if entry.is_explicit() || entry.always_iterates { &[0] } else { &[1, 0] };
        for (&iterations, &young) in solves.iter().flat_map(|n| youngs.iter().map(move |young| (n, young))) {
            let material = Material { density: 1000.0, ..Material::new(young, 0.3) };
            for (&time_step, &gravity) in steps.iter().flat_map(|step| weights.iter().map(move |g| (step, g))) {
                let scene = beam.clone().with_material(material).gravity([0.0, -gravity]);
                let mut scene = scene.moving(entry.kind, time_step);
                scene.dynamics.iterations = iterations;
                scene.dynamics.duration = f64::from(STEPS) * time_step;
                cases.push((scene, gravity));
            }
        }
    }
    cases
}

/// Solves a case and classifies its outcome.
pub fn entry((scene, gravity): &(Scene, f64)) -> Result<Entry, SimulationError> {
    let mut simulation = Simulation::new(scene)?;
    let (outcome, solution, [x, y]) = solve(&mut simulation);
    let (element, integrator) = (scene.element(), scene.dynamics.integrator.entry());
    let (young, time_step, iterations) = (scene.material.young, scene.dynamics.time_step, scene.dynamics.iterations);
    let id = integrator.id;
    let name = match iterations {
        _ if integrator.is_explicit() || integrator.always_iterates => id.to_owned(),
        0 => format!("{id}, to tolerance"),
        1 if integrator.stages > 1 => format!("{id}, 1 solve a stage"),
        n => format!("{id}, {}", count(n, "solve")),
    };
    let motion = simulation.motion().map(|motion| (motion.counts(), motion.ledger().drift()));
    let (Counts { steps, solves, halvings, .. }, drift) = motion.unwrap_or_default();
    let record = format!(
        "{},{id},{iterations},{},{time_step:e},{gravity},{},{steps},{solves},{halvings},{drift:e},{x},{y}",
        element.id(),
        number(young),
        outcome.entry().0
    );
    let (row, column) = (Some(format!("1/{:.0} s", 1.0 / time_step)), format!("{young:e}"));
    Ok(Entry { element, name, row, column, group: None, record, outcome, solution })
}

/// Returns the atlas of the entries.
pub fn atlas(entries: Vec<Entry>) -> Atlas {
    Atlas {
        outcomes: &[Outcome::Finished, Outcome::Inverted, Outcome::GainedEnergy, Outcome::Exploded, Outcome::Stopped],
        names: "integrator",
        columns: "E, Pa",
        header: "element,integrator,solves,young,time_step_s,gravity,outcome,steps_taken,solves_taken,halvings,energy_drift,tip_x,tip_y",
        entries,
    }
}

/// Formats the counts for display.
pub fn summary(atlas: &Atlas) -> String {
    format!(
        "in motion: {} cases, a beam released under its own weight, {STEPS} steps\n\n{}",
        atlas.entries.len(),
        atlas.outcome_table()
    )
}
