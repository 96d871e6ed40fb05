//! Text output of commands.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::{ErrorKind, Write as _};

use nalgebra::Vector2;

use super::CliError;
use super::solved::{Contexts, SolvedScene};
use crate::dynamics::Counts;
use crate::export::{columns, csv_field};
use crate::format::{count, engineering, engineering_pair, prefix, three_digits};
#[cfg(feature = "app")]
use crate::render::AdapterReport;
use crate::scene::{Analysis, Place, Scene, Support, registry};
use crate::simulation::{Deformation, Motion, Solution, Status};
use crate::study::{
    Claim, LoadCurve, LoadPath, PathState, Reference, driven_texts, section_chart, support_name, support_text,
};

/// Prints to standard output. A closed pipe, as after `head`, is not an error.
pub(super) fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(format!("standard output: {error}").into()),
        _ => Ok(()),
    }
}

/// Formats the list of built-in scenes.
pub(super) fn scenes() -> String {
    let mut text = String::new();
    for built_in in registry::BUILT_IN {
        // A test checks the built-in files; an invalid one would still be listed.
        let (name, about) = Scene::from_toml(built_in.toml)
            .map_or_else(|error| (error.to_string(), String::new()), |scene| (scene.name, scene.about));
        let _ = writeln!(text, "{:<12} {name}\n{:12} {about}", built_in.id, "");
    }
    text
}

/// Formats the list of graphics adapters.
#[cfg(feature = "app")]
pub(super) fn adapters(adapters: &[AdapterReport]) -> String {
    let mut text = String::new();
    for adapter in adapters {
        let AdapterReport { name, backend, driver, is_software, failure, is_used, .. } = adapter;
        let kind = if *is_software { ", software" } else { "" };
        let driver = if driver.is_empty() { "not stated" } else { driver };
        let usable = match failure {
            None if *is_used => "yes, and used".to_owned(),
            None => "yes".to_owned(),
            Some(reason) => format!("no: {}", reason.split_whitespace().collect::<Vec<_>>().join(" ")),
        };
        let _ = writeln!(text, "{name}\n  backend {backend}{kind}\n  driver  {driver}\n  usable  {usable}");
    }
    text
}

/// Formats a result.
pub(super) fn solution(solved: &SolvedScene<'_>) -> String {
    let SolvedScene { simulation, solution, stress, sections, path, reference, claims, warnings, .. } = solved;
    let (scene, motion) = (simulation.scene(), simulation.motion());
    let within = Contexts::of(solved);
    let (element, unknowns, word) =
        (scene.element().id(), count(solution.dofs as u64, "unknown"), solution.status.word());
    let mut text = format!("{}: element {element}, {}, {unknowns}\n", scene.name, solver_text(scene));
    let precision = if solution.residual_floor.is_some() { " to working precision" } else { "" };
    text += &match motion {
        Some(motion) => {
            let (counts, time) = (motion.counts(), simulation.state().time());
            let (solves, steps) = (count(counts.solves, "back substitution"), steps_text(scene, counts.steps, time));
            let at = engineering(time, "s");
            format!("{word} at {at} after {steps} and {solves}; the numbers below are those of this instant\n")
        }
        None => {
            let iterations = count(solution.iterations, "iteration");
            format!("{word}{precision} after {iterations}, relative residual {:.2e}\n", solution.residual)
        }
    };
    if let (Some(_), Some(reason)) = (motion, solution.status.failure()) {
        let _ = writeln!(text, "  {reason}");
    }
    for claim in claims {
        // The line above says that the forces balance, those below have the errors.
        let is_said = claim.id == "converged" && solution.residual_floor.is_none();
        if !is_said && !matches!(claim.id, "error" | "beam_theory") {
            let _ = writeln!(text, "  {claim}");
        }
    }
    if matches!(solution.status, Status::Diverged(_)) {
        return text;
    }
    if let Some(auto) = &solution.auto {
        let error = match auto.estimated_error.is_finite() {
            true => format!("estimated error of the method {:.4} %", 100.0 * auto.estimated_error),
            false => "no estimate of the method's error".to_owned(),
        };
        let (solves, made) = (count(auto.solves, "back substitution"), count(auto.factorizations, "factorization"));
        let _ = writeln!(text, "{}: {error}, {solves}, {made}", auto.decision);
    }
    if let Some(counts) = motion.filter(|motion| motion.decision().is_some()).map(Motion::counts) {
        let Counts { old_factor_steps: old, new_factor_steps: new, .. } = counts;
        let (linear, made) = (count(counts.linear_steps, "step"), count(counts.factorizations, "factorization"));
        let _ = writeln!(
            text,
            "auto: {linear} under linear theory, {old} with an old factor, {new} with a new one; {made}"
        );
    }
    let references = reference.as_ref().map_or(&[][..], Reference::probes);
    for (i, probe) in solution.probes.iter().enumerate() {
        let _ = writeln!(text, "{}: at {}, moved by {}", probe.name, pair(probe.x, "m"), within.pair(probe.u, "m"));
        if let Some(at_probe) = stress.probes.get(i) {
            let [x, y, _, xy] = at_probe.strain.components();
            let [x, y, shear] = [x, y, 2.0 * xy].map(|strain| within.percent(strain));
            let rotation = within.engineering(at_probe.rotation_deg, "°");
            let _ = writeln!(text, "  rotation {rotation}, strain {x}, {y}, shear γ {shear}");
            if let Some(cauchy) = &at_probe.cauchy {
                let [x, y, _, xy] = cauchy.components().map(|v| within.engineering(v, "Pa"));
                let von_mises = within.engineering(cauchy.von_mises(), "Pa");
                let _ = writeln!(text, "  stress (Cauchy) {x}, {y}, shear {xy}; von Mises {von_mises}");
            }
        }
        if let Some(reference) = references.get(i).and_then(Option::as_ref) {
            let (u, own) = (within.pair(reference.displacement, "m"), reference.own_error());
            let distance = engineering((probe.u - reference.displacement).norm(), "m");
            let _ = match reference.error_percent(probe) {
                Some(error) => writeln!(text, "  {}: {u}, error {error:.3} %, {own}", reference.source),
                None => writeln!(text, "  {}: {u}, {distance} from the result", reference.source),
            };
        }
    }
    for claim in claims.iter().filter(|claim| claim.id == "beam_theory") {
        let _ = writeln!(text, "  {claim}");
    }
    let Deformation { max_rotation_deg, max_strain, area_change, inverted_elements } = solution.deformation;
    let rotation = within.engineering(max_rotation_deg, "°");
    let [strain, area] = [max_strain, area_change].map(|strain| within.percent(strain));
    let _ = write!(text, "largest rotation {rotation}, largest strain {strain}, change of the area {area}, ");
    let _ = writeln!(text, "inverted elements {inverted_elements}");
    if let Some((node, von_mises)) = stress.largest {
        let (value, at) = (within.engineering(von_mises, "Pa"), pair(simulation.mesh().node(node), "m"));
        let name = simulation.mesh().node_name(node).map_or_else(String::new, |name| format!(", node {name}"));
        let _ = writeln!(text, "largest von Mises (Cauchy) {value}, at {at} of the rest body{name}");
    }
    let _ = match stress.mesh_error_percent {
        Some(percent) => writeln!(text, "mesh error {percent:.2} % (estimate: energy norm)"),
        None => writeln!(text, "mesh error: no estimate (nothing is strained, or q4 has a single row of cells)"),
    };
    // If supports move, the sum of their reactions may be only rounding error.
    if !moved(scene) {
        let force = within.pair(solution.reaction.force, "N");
        let moment = within.engineering(solution.reaction.moment, "N m");
        let _ = writeln!(text, "reaction {force}, moment about the origin {moment}");
    }
    text.push_str(&reactions(scene, solution, &within));
    for section in sections {
        let at = pair(section.line.at, "m");
        let angle = engineering(three_digits(section.line.angle.to_degrees()), "°");
        let forces = section_chart::text(section, &["N", "N", "N m"].map(|unit| within.get(unit)));
        let _ = writeln!(text, "section at {at}, normal at {angle}: {forces}");
    }
    let joules = |energy: f64| within.engineering(energy, "J");
    let [elastic, external] = [solution.energy.elastic, solution.energy.external].map(joules);
    let of_supports = match solution.energy.supports {
        _ if !moved(scene) => String::new(),
        Some(work) => format!(", of the moved supports {}", joules(work)),
        None if path.is_none() => ", of the moved supports not known: the result is not certified".to_owned(),
        None => ", of the moved supports not known: the load path was not followed to its end".to_owned(),
    };
    let _ = writeln!(text, "elastic energy {elastic}, work of the loads {external}{of_supports}");
    if let Some(motion) = motion {
        text.push_str(&energy_text(motion, &within));
    }
    text.push_str(&notes(warnings));
    let seconds = |time: std::time::Duration| engineering(time.as_secs_f64(), "s");
    let shown = solved.parts.iter().filter(|(_, time)| !time.is_zero());
    let shown: Vec<String> =
        shown.map(|(name, time)| format!("{} {}", name.replace('_', " "), seconds(*time))).collect();
    let _ = writeln!(text, "time {}: {}", seconds(solved.wall), shown.join(", "));
    text
}

/// Formats warnings, each on a line.
pub(super) fn notes(warnings: &[String]) -> String {
    warnings.iter().map(|warning| format!("note: {warning}\n")).collect()
}

fn moved(scene: &Scene) -> bool {
    scene.supports.iter().any(Support::moves)
}

/// Formats the reaction of each support, if there are several or one moves.
fn reactions(scene: &Scene, solution: &Solution, within: &Contexts) -> String {
    let mut text = String::new();
    let has_edge = scene.supports.iter().any(|support| matches!(support.place, Place::Edge(_)));
    if solution.supports.len() < 2 && !moved(scene) && !has_edge {
        return text;
    }
    for (i, (support, reaction)) in scene.supports.iter().zip(&solution.supports).enumerate() {
        let _ = write!(text, "  {}", support_text(scene, i));
        let part = solution.load_factor;
        if support.displacement != [0.0; 2] {
            let _ = write!(text, ", moved by {}", engineering_pair(support.displacement.map(|u| part * u), "m"));
        }
        if support.turn != 0.0 {
            let _ = write!(text, ", rotated by {}", engineering(part * support.turn.to_degrees(), "°"));
        }
        let _ = write!(text, ": reaction {}", within.pair(reaction.force, "N"));
        if matches!(support.place, Place::Edge(_)) {
            let _ = write!(text, ", moment about its middle {}", within.engineering(reaction.moment, "N m"));
        }
        text.push('\n');
    }
    text
}

fn pair(v: Vector2<f64>, unit: &str) -> String {
    engineering_pair(v.into(), unit)
}

/// Describes the steps of a motion until `time`: the last one ends with the motion, and may be shorter than the others.
fn steps_text(scene: &Scene, steps: u64, time: f64) -> String {
    let usual = scene.dynamics.time_step.min(scene.dynamics.duration);
    let before = steps.saturating_sub(1) as f64 * usual;
    let [usual, last] = [usual, time - before].map(|length| engineering(length, "s"));
    let text = format!("{} of {usual}", count(steps, "step"));
    if steps < 2 || last == usual { text } else { format!("{text}, the last of {last},") }
}

/// Describes the method, or the integrator with its theory if that is linear.
fn solver_text(scene: &Scene) -> String {
    match scene.analysis {
        Analysis::Static => format!("method {}", scene.solver.method.id()),
        Analysis::Dynamic if scene.solver.method.moves_linearly() => {
            format!("integrator {}, linear theory", scene.dynamics.integrator.id())
        }
        Analysis::Dynamic => format!("integrator {}", scene.dynamics.integrator.id()),
    }
}

/// Formats energies and momentum of a motion.
fn energy_text(motion: Motion<'_>, within: &Contexts) -> String {
    let (counts, ledger, momentum) = (motion.counts(), motion.ledger(), motion.momentum());
    let joules = |energy: f64| within.engineering(energy, "J");
    let change = if within.get("J").rounded(ledger.integrator) < 0.0 { "gained" } else { "lost" };
    let [kinetic, potential, dissipated, pulses, changed] =
        [ledger.kinetic, ledger.potential, ledger.dissipated, ledger.pulses, ledger.integrator.abs()].map(joules);
    let (drift, of_input) = (ledger.drift(), ledger.drift_of_input());
    let linear = within.pair(momentum.linear, "kg m/s");
    let angular = within.engineering(momentum.angular, "kg m²/s");
    let mut text = format!(
        "kinetic energy {kinetic}, potential of the loads {potential}, dissipated {dissipated}, put in by pulses {pulses}\n\
         {change} by the integrator {changed}: energy drift {drift:.2e} of the largest kinetic energy, {of_input:.2e} of \
         the energy put in\n\
         momentum {linear}, angular momentum about the origin {angular}\n"
    );
    if counts.halvings > 0 {
        let _ = writeln!(text, "{} of a step that did not converge", count(counts.halvings, "halving"));
    }
    if let Some(critical) = motion.critical_step() {
        let _ = writeln!(text, "the critical time step near rest is {}", engineering(critical, "s"));
    }
    text
}

/// Formats a load–deflection curve for display, and the load path on the scene's own mesh; where nothing happens on the path,
/// its end alone.
pub(super) fn curve(scene: &Scene, curve: &LoadCurve, own: Option<&LoadPath>) -> String {
    // The whole table uses one prefix.
    let tips = curve.samples.iter().flat_map(|s| [s.linear.x, s.linear.y, s.exact.x, s.exact.y]);
    let (power, symbol) = prefix(&tips.collect::<Vec<_>>(), "m");
    let scale = 10f64.powi(-power);
    let mut text = format!("{}: tip displacement, {symbol}m\n\n", scene.name);
    let _ =
        writeln!(text, "  load   linear theory            exact beam               linear error   rotation   strain");
    for sample in curve.samples.iter().step_by(5).skip(1) {
        let [[x, y], [exact_x, exact_y]]: [[f64; 2]; 2] = [sample.linear, sample.exact].map(|u| (u * scale).into());
        let (part, error, angle) = (100.0 * sample.factor, sample.linear_error_percent(), sample.rotation.to_degrees());
        let _ = write!(text, "{part:5.1} %  ({x:9.4}, {y:9.4})   ({exact_x:9.4}, {exact_y:9.4})   {error:9.2} %   ");
        let _ = writeln!(text, "{angle:7.2}°   {:.5}", sample.strain);
    }
    text.push('\n');
    for claim in Claim::of_curve(curve) {
        let _ = writeln!(text, "{claim}");
    }
    text.push('\n');
    let end = own.filter(|path| path.is_plain()).and_then(|path| path.states.last()?.probes.first());
    match (own, end) {
        (Some(_), Some(u)) => {
            let [along, across] = scene.beam.as_ref().map_or([0; 2], |beam| beam.cells);
            let _ = writeln!(text, "{} {along}×{across} at full load: {}", scene.element().id(), pair(*u, "m"));
        }
        (Some(own), None) => text += &path(scene, own),
        (None, _) => {}
    }
    text
}

/// Formats a load–deflection curve as CSV.
pub(super) fn curve_table(curve: &LoadCurve) -> String {
    let mut text =
        String::from("load_factor,linear_x,linear_y,truth_x,truth_y,linear_error_percent,tip_rotation_deg,strain\n");
    for s in &curve.samples {
        let [linear, exact] = [s.linear, s.exact].map(|u| format!("{},{}", u.x, u.y));
        let (error, rotation) = (s.linear_error_percent(), s.rotation.to_degrees());
        let _ = writeln!(text, "{},{linear},{exact},{error},{rotation},{}", s.factor, s.strain);
    }
    text
}

/// Formats a load path for display, with its changes of stability and jumps.
pub(super) fn path(scene: &Scene, path: &LoadPath) -> String {
    let states = count(path.states.len() as u64, "equilibrium state");
    let mut text = format!("{}: load path on the scene's own mesh, {states}\n\n", path.scene);
    let displacement = path.driven.map(|i| format!("displacement of {}", support_text(scene, i)));
    let width = displacement.as_ref().map_or(0, |displacement| displacement.chars().count());
    let probe = scene.probes.first().map(|p| p.name.as_str());
    let probe = probe.map_or_else(String::new, |probe| format!("displacement of {probe}"));
    let driven = displacement.map_or_else(String::new, |moved| format!("{moved}  {:<17}", "its reaction"));
    let _ = writeln!(text, "   load   {driven}{probe}");
    let shown: Vec<&PathState> = path.states.iter().step_by((path.states.len() / 12).max(1)).collect();
    // The smallest number of digits that tells the rows apart.
    let digits = (1..=8).find(|&digits| {
        let rows = shown.iter().map(|state| format!("{:.digits$}", 100.0 * state.factor));
        rows.collect::<BTreeSet<_>>().len() == shown.len()
    });
    let digits = digits.unwrap_or(1);
    for state in shown {
        let _ = write!(text, "{:5.digits$} %  ", 100.0 * state.factor);
        if let Some(pair) = path.driven_pair(scene, state) {
            let columns = driven_texts(pair, path.rotates(scene));
            let _ = write!(text, "{:<width$}  {:<15}  ", columns[0], columns[1]);
        }
        if let Some(u) = state.probes.first() {
            let _ = write!(text, "{:<24}  ", pair(*u, "m"));
        }
        let _ = writeln!(text, "{}", if state.unstable_modes == 0 { "" } else { "unstable" });
    }
    text.push('\n');
    for claim in Claim::of_path(scene, path) {
        let _ = writeln!(text, "{claim}");
    }
    text
}

/// Formats a load path as CSV.
pub(super) fn path_table(scene: &Scene, path: &LoadPath) -> String {
    let mut text = String::from("load_factor");
    let of_probe: &[&str] = &["u_x", "u_y"];
    let of_support: &[&str] = &["displacement_x", "displacement_y", "turn", "force_x", "force_y", "moment"];
    let probes = scene.probes.iter().enumerate().map(|(i, probe)| (probe.name.clone(), i, of_probe));
    let supports = (0..scene.supports.len()).map(|i| (support_name(scene, i), i, of_support));
    for column in columns(&probes.chain(supports).collect::<Vec<_>>()) {
        let _ = write!(text, ",{}", csv_field(&column));
    }
    text.push_str(",stable_under_force\n");
    for state in &path.states {
        let _ = write!(text, "{}", state.factor);
        for u in &state.probes {
            let _ = write!(text, ",{},{}", u.x, u.y);
        }
        for (support, reaction) in scene.supports.iter().zip(&state.reactions) {
            let [x, y] = support.displacement.map(|u| u * state.factor);
            let turn = support.turn * state.factor;
            let _ = write!(text, ",{x},{y},{turn},{},{},{}", reaction.force.x, reaction.force.y, reaction.moment);
        }
        let _ = writeln!(text, ",{}", state.stable.map_or_else(String::new, |stable| stable.to_string()));
    }
    text
}
