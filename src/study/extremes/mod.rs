//! Stability atlases: every method and every integrator under extreme conditions. Each case is classified; no case may
//! panic or give values that are not finite.

pub mod motion;
pub mod rest;

use crate::dynamics::StopReason;
use crate::method::Reason;
use crate::scene::ElementKind;
use crate::simulation::{Simulation, Solution, Status};

/// Outcome of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Converged to an equilibrium with positive definite exact tangent and no inverted element.
    Certified,
    /// Converged without certificate: linear theory, or an equilibrium that may be unstable.
    Converged,
    /// All time steps were computed without spurious energy.
    Finished,
    /// Converged, or finished without spurious energy, with inverted elements at the end.
    Inverted,
    /// The iteration makes no progress.
    Stalled,
    /// The iteration stopped before the end.
    NotConverged,
    /// All time steps were computed, but the integrator added more than a hundredth of the largest kinetic energy.
    GainedEnergy,
    /// A value was not finite, or the body moved away too far.
    Exploded,
    /// A time step failed even at the smallest length.
    Stopped,
}

/// Largest energy added, relative to the largest kinetic energy, that does not count as gained.
const GAINED: f64 = 0.01;

impl Outcome {
    /// Returns the identifier in tables, and the colour. Colours of one atlas differ in brightness (Okabe and Ito 2008).
    pub(crate) fn entry(self) -> (&'static str, [u8; 3]) {
        match self {
            Self::Certified => ("certified", [0x00, 0x72, 0xb2]),
            Self::Converged => ("converged", [0x56, 0xb4, 0xe9]),
            Self::Finished => ("finished", [0x00, 0x72, 0xb2]),
            Self::Inverted => ("inverted", [0xf0, 0xe4, 0x42]),
            Self::Stalled => ("stalled", [0xe6, 0x9f, 0x00]),
            Self::NotConverged => ("not_converged", [0xb0, 0x3a, 0x2e]),
            Self::GainedEnergy => ("gained_energy", [0xe6, 0x9f, 0x00]),
            Self::Exploded => ("exploded", [0xb0, 0x3a, 0x2e]),
            Self::Stopped => ("stopped", [0x56, 0xb4, 0xe9]),
        }
    }

    /// Classifies the solution of a search or motion that has ended.
    fn of(solution: &Solution, drift: Option<f64>) -> Self {
        let is_certified = solution.certificate.is_some_and(|certificate| certificate.stable == Some(true));
        match solution.status {
            Status::Converged | Status::Finished if drift > Some(GAINED) => Self::GainedEnergy,
            Status::Converged | Status::Finished if solution.deformation.inverted_elements > 0 => Self::Inverted,
            Status::Converged if is_certified => Self::Certified,
            Status::Converged => Self::Converged,
            Status::Finished => Self::Finished,
            Status::Diverged(Reason::Stalled(_)) => Self::Stalled,
            Status::Stopped(StopReason::Step { .. }) => Self::Stopped,
            Status::Stopped(_) => Self::Exploded,
            _ => Self::NotConverged,
        }
    }
}

/// Case with its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub(crate) element: ElementKind,
    /// Name of the method or integrator.
    pub(crate) name: String,
    /// Label of the case's row in the picture; `None` if the picture does not show the case.
    pub(crate) row: Option<String>,
    /// Label of the case's column.
    pub(crate) column: String,
    /// Table of the summary that counts the case, if any.
    group: Option<&'static str>,
    /// Line of the CSV file, without line break.
    record: String,
    /// Outcome.
    pub outcome: Outcome,
    /// Results of the last finite state.
    pub solution: Solution,
}

/// Cases with their outcomes, at rest or in motion.
#[derive(Debug)]
pub struct Atlas {
    /// All outcomes, best first.
    pub(crate) outcomes: &'static [Outcome],
    /// Heading of the names of methods or integrators.
    names: &'static str,
    /// Quantity that the columns of the picture differ in.
    pub columns: &'static str,
    /// Header of the CSV file, without line break.
    header: &'static str,
    /// Cases.
    pub entries: Vec<Entry>,
}

impl Atlas {
    /// Formats the atlas as CSV.
    pub fn table(&self) -> String {
        let records = self.entries.iter().map(|entry| entry.record.as_str());
        std::iter::once(self.header).chain(records).map(|line| format!("{line}\n")).collect()
    }

    /// Returns the cases of an element and a method or integrator.
    pub(crate) fn of(&self, element: ElementKind, name: &str) -> Vec<&Entry> {
        self.entries.iter().filter(|entry| entry.element == element && entry.name == name).collect()
    }

    /// Formats the counts of outcomes as text.
    fn outcome_table(&self) -> String {
        let columns: Vec<_> = self.outcomes.iter().map(|outcome| outcome.entry().0.to_owned()).collect();
        self.text_table(&columns, 14, |entries, id| {
            entries.iter().filter(|entry| entry.outcome.entry().0 == id).count() as f64
        })
    }

    /// Formats a table as text, with columns of this width, and a row for the cases of every element and method or integrator
    /// that have a value, which is not NaN.
    fn text_table(&self, columns: &[String], width: usize, value: impl Fn(&[&Entry], &str) -> f64) -> String {
        let series = distinct(self.entries.iter().map(|entry| (entry.element, &entry.name)));
        let name_width = series.iter().map(|(_, name)| name.len()).max().unwrap_or(0).max(7);
        let heading: String = columns.iter().map(|column| format!(" {column:>width$}")).collect();
        let mut text = format!("{:<7} {:<name_width$}{heading}\n", "element", self.names);
        for (element, name) in series {
            let own = self.of(element, name);
            let values: Vec<f64> = columns.iter().map(|column| value(&own, column)).collect();
            if !values.iter().all(|value| value.is_nan()) {
                let texts = values.iter().map(|v| if v.is_nan() { "–".to_owned() } else { format!("{v:.0}") });
                let cells: String = texts.map(|text| format!(" {text:>width$}")).collect();
                text += &format!("{:<7} {name:<name_width$}{cells}\n", element.id());
            }
        }
        text
    }
}

/// Returns the distinct values, in the order in which they first appear.
pub(crate) fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    values.fold(Vec::new(), |mut distinct, value| {
        if !distinct.contains(&value) {
            distinct.push(value);
        }
        distinct
    })
}

/// Solves a case; returns its outcome, its result, and the displacement of a beam's tip over the length, or of a mesh file's
/// first probe over the size.
fn solve(simulation: &mut Simulation) -> (Outcome, Solution, [f64; 2]) {
    simulation.solve();
    simulation.certify();
    let solution = simulation.solution();
    let length = simulation.scene().beam.as_ref().map_or(simulation.system().size(), |beam| beam.length);
    let tip = solution.probes.first().map_or([0.0; 2], |probe| [probe.u.x / length, probe.u.y / length]);
    let drift = simulation.motion().map(|motion| motion.ledger().drift());
    (Outcome::of(&solution, drift), solution, tip)
}
