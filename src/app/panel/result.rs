//! What is known of the state: status, iterations, errors, certificate, times.

use egui::{Grid, RichText, Ui};

use super::{PanelInput, supports};
use crate::app::headline::UNKNOWN;
use crate::app::palette::Palette;
use crate::app::verdict::{Errors, rho, sentence, stability};
use crate::method::rho_words;
use crate::simulation::{Motion, Simulation, Status, energy};
use crate::words::{count, engineering, engineering_pair, percent, three_digits};

/// Room for what a row is, points.
const NAME_WIDTH: f32 = 84.0;

/// What is behind the fold, in a few words.
pub(super) fn summary(input: &PanelInput<'_>) -> String {
    if input.simulation.motion().is_some() { "energy, steps, times" } else { "certificate, reactions, times" }
        .to_owned()
}

pub(super) fn show(ui: &mut Ui, input: &PanelInput<'_>, errors: &Errors) {
    let simulation = input.simulation;
    let secondary = Palette::new(ui.visuals()).secondary;
    ui.spacing_mut().item_spacing.y = 3.0;
    let mut row = |name: &str, value: String, tip: &str| {
        ui.horizontal_top(|ui| {
            let left = ui.cursor().left();
            let label = ui.label(RichText::new(name).small().color(secondary)).on_hover_text(tip);
            ui.add_space((left + NAME_WIDTH - label.rect.right() - ui.spacing().item_spacing.x).max(0.0));
            ui.add(egui::Label::new(RichText::new(value).size(13.0)).wrap()).on_hover_text(tip);
        });
    };
    if let Some(motion) = simulation.motion() {
        motion_rows(&mut row, input, motion);
        probe_row(&mut row, simulation);
        frame_row(&mut row, input, "a time step");
    } else {
        search_rows(&mut row, input, errors);
    }
    stages(ui, input);
    ui.add(egui::Label::new(RichText::new(input.adapter).small().color(secondary)).wrap());
}

fn search_rows(row: &mut Row<'_>, input: &PanelInput<'_>, errors: &Errors) {
    let simulation = input.simulation;
    row(
        "Iterations",
        format!("{}, residual {:.2e}", simulation.iterations(), simulation.residual()),
        "Solves since the last change; out-of-balance force over the sum of the elements' absolute forces",
    );
    probe_row(row, simulation);
    let truth = input.truth.map_or_else(|| "a truth".to_owned(), ToString::to_string);
    let words = errors.own.zip(input.truth).map_or_else(
        || UNKNOWN.to_owned(),
        |(error, truth)| format!("{} of {}", percent(error), engineering(truth.first().displacement.norm(), "m")),
    );
    row("Error", words, &format!("Distance of the first probe from {truth}, over its displacement"));
    quality_rows(row, input);
    let (factor, steps) = simulation.load_stepping();
    row("Load steps", format!("{steps}, at {:.3} % of the load", 100.0 * factor), "Parts in which the load is put on");
    let word = stability(simulation).map_or(UNKNOWN, |stable| if stable { "stable" } else { "unstable" });
    row("Equilibrium", word.to_owned(), "Certified: whether the exact tangent A + G is positive definite");
    let words = rho(simulation).map_or_else(|| UNKNOWN.to_owned(), |rho| sentence(&rho_words(rho)));
    let tip =
        "ρ: the largest |λ| with G v = λ A v, the error factor of the warped iteration where an iteration has ended";
    row("ρ", words, tip);
    // Sums over all elements: not while something moves.
    if simulation.is_at_rest() {
        let (problem, state) = (simulation.problem(), simulation.state());
        row("Energy", engineering(energy(problem, state, factor).elastic, "J"), "Stored in the body");
        supports::reaction_rows(row, simulation);
    }
    if let Some(auto) = simulation.auto_report() {
        let [solves, factors] = [count(auto.solves, "back substitution"), count(auto.factorizations, "factorization")];
        let error = match auto.estimated_error {
            error if error.is_finite() => format!("Estimated error {}, ", percent(100.0 * error)),
            _ => String::new(),
        };
        row("Auto", sentence(&auto.decision.to_string()), &format!("{error}{solves}, {factors}"));
    }
    frame_row(row, input, "the iterations of one displayed frame");
}

/// A row of the result: what it is, its value, and more about it.
type Row<'a> = dyn FnMut(&str, String, &str) + 'a;

fn time(duration: std::time::Duration) -> String {
    engineering(three_digits(duration.as_secs_f64()), "s")
}

fn probe_row(row: &mut Row<'_>, simulation: &Simulation) {
    for probe in simulation.problem().probes().iter().take(1) {
        let u = probe.mean(simulation.displacement());
        row(&format!("{} x, y", probe.name), engineering_pair(u.into(), "m"), "Displacement of the probe");
    }
}

/// What the mesh does wrong, and how far the material is strained.
fn quality_rows(row: &mut Row<'_>, input: &PanelInput<'_>) {
    let known = *input.simulation.status() == Status::Converged;
    let quality = input.quality;
    let error = quality.mesh_error_percent.filter(|_| known);
    let words = error.map_or_else(|| UNKNOWN.to_owned(), |error| format!("{} (estimate)", percent(error)));
    let tip = "Of the mesh alone, in the energy norm: the elements' stresses against those recovered at the nodes";
    row("Mesh error", words, tip);
    let strain = engineering(three_digits(100.0 * quality.max_strain), "%");
    let warning = quality.warning().filter(|_| known);
    let words = match (known, &warning) {
        (false, _) => UNKNOWN.to_owned(),
        (true, None) => strain,
        (true, Some(_)) => format!("{strain}: too large"),
    };
    let tip =
        "The largest principal strain".to_owned() + &warning.map_or_else(String::new, |words| format!("; {words}"));
    row("Strain", words, &tip);
}

fn frame_row(row: &mut Row<'_>, input: &PanelInput<'_>, what: &str) {
    let unknowns = count(input.simulation.system().dofs() as u64, "unknown");
    row("Frame", format!("{}, {unknowns}", time(input.timings.total())), &format!("Time of {what}"));
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
    let joules = |value: f64| engineering(value, "J");
    row("Kinetic", joules(ledger.kinetic), "Kinetic energy");
    row("Elastic", joules(ledger.elastic), "Energy stored in the body");
    row(
        "Drift",
        percent(100.0 * ledger.drift()),
        "Energy that the integrator has added, over the largest kinetic energy",
    );
    if let Some((_, force)) = input.simulation.hand() {
        row("Hand", engineering(force.norm(), "N"), "Force of the hand that pulls the body");
    }
}

/// Where the time of a frame went.
fn stages(ui: &mut Ui, input: &PanelInput<'_>) {
    let times = input.timings;
    let secondary = Palette::new(ui.visuals()).secondary;
    let stages = [
        ("rotate", times.rotate, "Rotations found apart, at the end of time steps"),
        ("assemble", times.assemble, "One sweep: rotations, stiffness of the turned elements, forces and the residual"),
        ("factorize", times.factorize, "Sparse Cholesky"),
        ("solve", times.solve, "Forward and back substitution"),
    ];
    Grid::new("stages").num_columns(stages.len()).min_col_width(58.0).spacing([10.0, 0.0]).show(ui, |ui| {
        for (name, _, tip) in stages {
            ui.label(RichText::new(name).small().color(secondary)).on_hover_text(tip);
        }
        ui.end_row();
        for (_, duration, tip) in stages {
            ui.label(RichText::new(time(duration)).small()).on_hover_text(tip);
        }
    });
}
