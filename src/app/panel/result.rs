//! What is known of the state: status, iterations, errors, certificate, times.

use egui::{Grid, RichText, Ui};

use super::PanelInput;
use crate::app::format;
use crate::method::rho_words;
use crate::simulation::{Status, probe_results};
use crate::words::count;

/// The status as a sentence, and whether it is a bad one.
pub(in crate::app) fn status_words(status: &Status, running: bool) -> (String, bool) {
    match status {
        Status::Running if running => ("Iterating".to_owned(), false),
        Status::Running => ("Paused".to_owned(), false),
        Status::Converged => ("Converged".to_owned(), false),
        // The duration is for runs without a window: here a motion goes on.
        Status::Finished if running => ("Running".to_owned(), false),
        Status::Finished => ("Paused".to_owned(), false),
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
    let (words, bad) = status_words(simulation.status(), input.running);
    let color = if bad { ui.visuals().error_fg_color } else { ui.visuals().strong_text_color() };
    // Nothing here may change its height: a slider further down would move away under the pointer that drags it.
    ui.allocate_ui(egui::vec2(ui.available_width(), STATUS_HEIGHT), |ui| {
        ui.set_min_height(STATUS_HEIGHT);
        ui.add(egui::Label::new(RichText::new(words).color(color)).wrap());
    });
    let time = input.timings;
    let us = |d: std::time::Duration| format!("{:.0} µs", d.as_secs_f64() * 1e6);
    Grid::new("result").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String, tip: &str| {
            ui.label(name).on_hover_text(tip);
            ui.monospace(value).on_hover_text(tip);
            ui.end_row();
        };
        row(
            "Iterations",
            format!("{}, residual {:.2e}", simulation.iterations(), simulation.residual()),
            "Solves since the last change; out-of-balance force over the sum of the elements' absolute forces",
        );
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
        let (error, truth) = error_words(input).unwrap_or_else(|| (UNKNOWN.to_owned(), "a truth".to_owned()));
        row("Error", error, &format!("Distance of the first probe from {truth}, over its displacement"));
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
        let unknowns = simulation.system().dofs();
        row(
            "Frame",
            format!("{}, {unknowns} unknowns", us(time.total())),
            "Time of the iterations of one displayed frame",
        );
    });
    let rho = simulation.certificate().and_then(|c| c.fixed_point_rho);
    let words = rho.map_or_else(|| format!("ρ {UNKNOWN}"), |rho| sentence(&rho_words(rho)));
    ui.add(egui::Label::new(RichText::new(words).small()).truncate()).on_hover_text(
        "ρ: the largest |λ| with G v = λ A v, the error factor of the warped iteration where an iteration has ended",
    );
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
