//! What is known of the state: status, iterations, errors, certificate, times.

use egui::{Grid, RichText, Ui};

use super::PanelInput;
use crate::app::format;
use crate::method::rho_words;
use crate::simulation::{Motion, Simulation, Status, probe_results};
use crate::words::count;

/// The status as a sentence, and whether it is a bad one.
pub(in crate::app) fn status_words(simulation: &Simulation, running: bool) -> (String, bool) {
    let moves = simulation.motion().is_some();
    match simulation.status() {
        Status::Running | Status::Finished if !running => ("Paused".to_owned(), false),
        // The duration is for runs without a window: here a motion goes on.
        Status::Running | Status::Finished if moves && simulation.is_at_rest() => ("At rest".to_owned(), false),
        Status::Running | Status::Finished if moves => ("Running".to_owned(), false),
        Status::Running | Status::Finished => ("Iterating".to_owned(), false),
        Status::Converged => ("Converged".to_owned(), false),
        Status::NotConverged(reason) => (format!("Not converged: {reason}."), true),
        Status::Diverged(reason) => (format!("Diverged: {reason}. Shown is the last finite state."), true),
        Status::Stopped(reason) => (format!("Stopped: {reason}. Shown is the last finite state."), true),
    }
}

/// Room for three lines of status, points.
const STATUS_HEIGHT: f32 = 50.0;
/// In place of a number that is not known.
const UNKNOWN: &str = "\u{2013}";

/// The error of the first probe, and what it is measured against.
fn error_words(input: &PanelInput<'_>) -> Option<(String, String)> {
    let (reference, simulation) = (input.truth?, input.simulation);
    // The truth knows of no hand.
    if simulation.hand().is_some() {
        return None;
    }
    let truth = reference.first();
    let probe = probe_results(simulation.problem(), simulation.state()).into_iter().next()?;
    let percent = truth.error_percent(&probe)?;
    let length = truth.displacement.norm();
    Some((format!("{} % of {} m", format::short(percent), format::short(length)), reference.to_string()))
}

/// With a capital and a full stop.
fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}

pub(super) fn show(ui: &mut Ui, input: &PanelInput<'_>) {
    let simulation = input.simulation;
    let (words, bad) = status_words(simulation, input.running);
    let color = if bad { ui.visuals().error_fg_color } else { ui.visuals().strong_text_color() };
    // Nothing here may change its height: a slider further down would move away under the pointer that drags it.
    ui.allocate_ui(egui::vec2(ui.available_width(), STATUS_HEIGHT), |ui| {
        ui.set_min_height(STATUS_HEIGHT);
        ui.add(egui::Label::new(RichText::new(words).color(color)).wrap());
    });
    Grid::new("result").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String, tip: &str| {
            ui.label(name).on_hover_text(tip);
            ui.monospace(value).on_hover_text(tip);
            ui.end_row();
        };
        if let Some(motion) = simulation.motion() {
            motion_rows(&mut row, input, motion);
            probe_row(&mut row, simulation);
            frame_row(&mut row, input, "a time step");
            return;
        }
        row(
            "Iterations",
            format!("{}, residual {:.2e}", simulation.iterations(), simulation.residual()),
            "Solves since the last change; out-of-balance force over the sum of the elements' absolute forces",
        );
        probe_row(&mut row, simulation);
        let (error, truth) = error_words(input).unwrap_or_else(|| (UNKNOWN.to_owned(), "a truth".to_owned()));
        row("Error", error, &format!("Distance of the first probe from {truth}, over its displacement"));
        quality_rows(&mut row, input);
        let (factor, steps) = simulation.load_stepping();
        let percent = format::short(100.0 * factor);
        row("Load steps", format!("{steps}, at {percent} % of the load"), "Parts in which the load is put on");
        let certificate = simulation.certificate().unwrap_or_default();
        let certified = certificate.stable.filter(|_| *simulation.status() == Status::Converged);
        let word = certified.map_or(UNKNOWN, |stable| if stable { "stable" } else { "unstable" });
        row("Equilibrium", word.to_owned(), "Certified: whether the exact tangent A + G is positive definite");
        let auto = simulation.auto_report();
        let words = auto.map_or_else(|| UNKNOWN.to_owned(), |t| sentence(&t.decision.to_string()));
        let tip = auto.filter(|t| t.estimated_error.is_finite()).map_or_else(
            || "What method auto skips".to_owned(),
            |t| {
                let error = format::short(100.0 * t.estimated_error);
                let [solves, factors] =
                    [count(t.solves, "back substitution"), count(t.factorizations, "factorization")];
                format!("Estimated error {error} %, {solves}, {factors}")
            },
        );
        row("Auto", words, &tip);
        frame_row(&mut row, input, "the iterations of one displayed frame");
    });
    if simulation.motion().is_none() {
        rho_line(ui, simulation);
    }
    stages(ui, input);
}

/// A row of the result: what it is, its value, and more about it.
type Row<'a> = dyn FnMut(&str, String, &str) + 'a;

fn us(duration: std::time::Duration) -> String {
    format!("{:.0} µs", duration.as_secs_f64() * 1e6)
}

fn probe_row(row: &mut Row<'_>, simulation: &Simulation) {
    for probe in simulation.problem().probes().iter().take(1) {
        let u = probe.mean(simulation.displacement());
        // Beside a component of ordinary size, rounding is no number to show.
        let [x, y] = [u.x, u.y].map(|v| if v.abs() < 1e-12 * u.norm() { 0.0 } else { v });
        row(
            &format!("{} x, y", probe.name),
            format!("{}, {} m", format::short(x), format::short(y)),
            "Displacement of the probe",
        );
    }
}

/// What the mesh does wrong, and how far the material is strained.
fn quality_rows(row: &mut Row<'_>, input: &PanelInput<'_>) {
    let known = *input.simulation.status() == Status::Converged;
    let quality = input.quality;
    let error = quality.mesh_error_percent.filter(|_| known);
    let words = error.map_or_else(|| UNKNOWN.to_owned(), |error| format!("{} % (estimate)", format::short(error)));
    let tip = "Of the mesh alone, in the energy norm: the elements' stresses against those recovered at the nodes";
    row("Mesh error", words, tip);
    let percent = format!("{} %", format::short(100.0 * quality.max_strain));
    let warning = quality.warning().filter(|_| known);
    let words = match (known, &warning) {
        (false, _) => UNKNOWN.to_owned(),
        (true, None) => percent,
        (true, Some(_)) => format!("{percent}: too large"),
    };
    let tip =
        "The largest principal strain".to_owned() + &warning.map_or_else(String::new, |words| format!("; {words}"));
    row("Strain", words, &tip);
}

fn frame_row(row: &mut Row<'_>, input: &PanelInput<'_>, what: &str) {
    let unknowns = input.simulation.system().dofs();
    row("Frame", format!("{}, {unknowns} unknowns", us(input.timings.total())), &format!("Time of {what}"));
}

/// Time, pace, steps and energy of a motion.
fn motion_rows(row: &mut Row<'_>, input: &PanelInput<'_>, motion: &Motion) {
    row("Time", format!("{:.2} s", input.simulation.state().time()), "Simulated time");
    let pace = &input.playback.pace;
    let factor = match pace.factor() {
        Some(factor) if pace.lags() => format!("{factor:.2} of real time: too slow"),
        Some(factor) => format!("{factor:.2} of real time"),
        None => UNKNOWN.to_owned(),
    };
    let tip = "Simulated seconds a second; a machine that cannot keep up slows the motion down";
    row("Pace", factor, tip);
    let counts = motion.counts();
    let halvings = if counts.halvings > 0 { format!(", {}", count(counts.halvings, "halving")) } else { String::new() };
    row(
        "Steps",
        format!("{}, {}{halvings}", counts.steps, count(counts.solves, "solve")),
        "Time steps since the start; a step that does not converge is halved",
    );
    if let Some(auto) = motion.auto_report(input.scene) {
        let factors = count(auto.factorizations, "factorization");
        let linear = count(auto.linear_steps, "step");
        let tip = format!("{factors} for {}; {linear} under linear theory", count(auto.solves, "back substitution"));
        row("Auto", sentence(&auto.decision.to_string()), &tip);
    }
    let ledger = motion.ledger();
    let joules = |value: f64| format!("{} J", format::short(value));
    row("Kinetic", joules(ledger.kinetic), "Kinetic energy");
    row("Elastic", joules(ledger.elastic), "Energy stored in the body");
    row(
        "Drift",
        format!("{} %", format::short(100.0 * ledger.drift())),
        "Energy that the integrator has added, over the largest kinetic energy",
    );
    let force =
        input.simulation.hand().map_or_else(|| UNKNOWN.to_owned(), |(_, f)| format!("{} N", format::short(f.norm())));
    row("Hand", force, "Force of the hand that pulls the body");
}

fn rho_line(ui: &mut Ui, simulation: &Simulation) {
    let rho = simulation.certificate().and_then(|c| c.fixed_point_rho);
    let words = rho.map_or_else(|| format!("ρ {UNKNOWN}"), |rho| sentence(&rho_words(rho)));
    ui.add(egui::Label::new(RichText::new(words).small()).truncate()).on_hover_text(
        "ρ: the largest |λ| with G v = λ A v, the error factor of the warped iteration where an iteration has ended",
    );
}

/// Where the time of a frame went.
fn stages(ui: &mut Ui, input: &PanelInput<'_>) {
    let time = input.timings;
    let stages = [
        ("rotate", time.rotate, "Element maps and polar decompositions"),
        ("assemble", time.assemble, "Stiffness of the turned elements, forces, residual"),
        ("factorize", time.factorize, "Sparse Cholesky"),
        ("solve", time.solve, "Forward and back substitution"),
    ];
    Grid::new("stages").num_columns(stages.len()).min_col_width(62.0).spacing([14.0, 0.0]).show(ui, |ui| {
        for (name, _, tip) in stages {
            ui.label(RichText::new(name).small()).on_hover_text(tip);
        }
        ui.end_row();
        for (_, duration, tip) in stages {
            ui.label(RichText::new(us(duration)).monospace().small()).on_hover_text(tip);
        }
    });
}
