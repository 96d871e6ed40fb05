//! Measurements of a study as the mode Measure shows them: the time of a motion is that of a frame.

use crate::app::diagnosis::drift_text;
use crate::app::language::{count, fill, percent, tr};
use crate::app::session::clock::FRAMES;
use crate::format::{engineering, three_digits};
use crate::study::{Demand, ErrorSplit, Measurement, Study, StudyReference};

/// Returns every setting whose error was measured.
pub(crate) fn choices(study: &Study) -> Vec<Measurement> {
    study.measurements.iter().filter(|m| m.error.is_some()).copied().collect()
}

/// Returns the time of a solve, or of one frame at 60 Hz of a motion, ms.
pub(crate) fn frame_ms(m: &Measurement) -> f64 {
    if m.motion.is_some() { m.milliseconds / FRAMES } else { m.milliseconds }
}

/// Returns the settings that meet a demand, fastest first. For a motion, the time is that of a frame.
pub(crate) fn meeting(study: &Study, demand: Demand) -> Vec<Measurement> {
    let frames = if matches!(study.reference, StudyReference::Motion(_)) { FRAMES } else { 1.0 };
    let demand = Demand { max_time_ms: demand.max_time_ms.map(|most| most * frames), ..demand };
    study.meeting(demand).into_iter().copied().collect()
}

/// Returns the settings nearest to a demand that none meets: the most accurate one within the time, and the fastest one
/// within the error. None if the reference's own error is too large to tell.
pub(crate) fn nearest(study: &Study, demand: Demand) -> Vec<Measurement> {
    if !study.can_decide(demand) {
        return Vec::new();
    }
    let in_time = meeting(study, Demand { max_error_percent: None, ..demand });
    let accurate = in_time.into_iter().min_by(|a, b| a.error_percent().total_cmp(&b.error_percent()));
    let fast = meeting(study, Demand { max_time_ms: None, ..demand }).first().copied();
    accurate.filter(|m| m.error.is_some()).into_iter().chain(fast).collect()
}

/// Returns the fastest of these settings whose iteration converges when it runs on.
pub(crate) fn fastest(study: &Study, choices: &[Measurement]) -> Option<Measurement> {
    choices.iter().find(|m| study.converges(m)).copied()
}

/// Describes the unknowns and the parts of the error of a setting.
pub(crate) fn parts(study: &Study, m: &Measurement) -> String {
    let unknowns = count(m.dofs as u64, "unknown");
    let of = |part: fn(&ErrorSplit) -> f64| part_text(m.error.as_ref().map_or(0.0, part));
    let (mesh, iteration, theory) = (of(|e| e.discretization), of(|e| e.iteration), of(|e| e.model));
    let (StudyReference::Motion(reference), Some(motion)) = (&study.reference, m.motion) else {
        let parts = fill!(
            "Click to apply. %{unknowns}. Error: mesh %{mesh}, stopped early %{iteration}, linear theory %{theory}.",
            unknowns,
            mesh,
            iteration,
            theory
        );
        return [Some(parts), runs_away(study, m)].into_iter().flatten().collect::<Vec<_>>().join(" ");
    };
    fill!(
        "Click to apply. %{unknowns}. Error: mesh %{mesh}, time steps %{steps}, linear theory %{theory}. Drift in %{duration}: %{drift} of the energy put in.",
        unknowns,
        mesh,
        steps = iteration,
        theory,
        duration = engineering(three_digits(reference.duration()), "s"),
        drift = drift_text(0.01 * motion.drift_of_input_percent)
    )
}

/// Formats a part of an error; one that a setting does not have is 0.
fn part_text(part: f64) -> String {
    if part == 0.0 { "0 %".to_owned() } else { percent(part) }
}

/// Returns the warning that a setting stops an iteration that does not converge when it runs on.
pub(crate) fn runs_away(study: &Study, m: &Measurement) -> Option<String> {
    (!study.converges(m)).then(|| {
        fill!(
            "%{method} does not converge here in %{n} iterations: other loads need another number of them.",
            method = tr(m.setting.method.id()),
            n = Study::MAX_ITERATIONS
        )
    })
}
