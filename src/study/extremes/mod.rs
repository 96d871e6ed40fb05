//! Stability atlases: every method and every integrator under extreme conditions. Each case is classified; no case may
//! panic or give values that are not finite.

pub mod motion;
pub mod rest;

use std::collections::BTreeMap;
use std::fmt::Debug;

use crate::dynamics::{Counts, StopReason};
use crate::method::Reason;
use crate::simulation::{Simulation, SimulationError, Solution, Status};

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
    /// Number of outcomes of a search for an equilibrium, and of a motion.
    pub const COUNT: usize = 5;

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

/// Element, and name of the method or integrator.
pub type AtlasSeries = (&'static str, String);

/// Case of an atlas.
pub trait Case: Copy + Debug + Send + Sync {
    /// All outcomes, best first.
    const OUTCOMES: [Outcome; Outcome::COUNT];
    /// Heading of the names of methods or integrators.
    const NAMES: &'static str;
    /// Quantity that the columns of the picture differ in.
    const COLUMNS: &'static str;
    /// Header of the CSV file, without line break.
    const HEADER: &'static str;

    /// Returns the element and the name of the method or integrator.
    fn series(&self) -> AtlasSeries;

    /// Returns the labels of the case's row and column in the picture; `None` if the picture does not show the case.
    fn cell(&self) -> Option<[String; 2]>;

    /// Returns the simulation of the case in its initial state.
    ///
    /// # Errors
    /// [`SimulationError`] if the scene is invalid, which would be a mistake in the atlas.
    fn simulation(&self) -> Result<Simulation, SimulationError>;

    /// Formats the line of a case in the CSV file, without line break.
    fn record(entry: &Entry<Self>) -> String;

    /// Solves the case and classifies its outcome.
    ///
    /// # Errors
    /// The errors of [`Self::simulation`].
    fn solve(self) -> Result<Entry<Self>, SimulationError> {
        let mut simulation = self.simulation()?;
        simulation.solve();
        simulation.certify();
        let solution = simulation.solution();
        let length = simulation.scene().beam.as_ref().map_or(simulation.system().size(), |beam| beam.length);
        let tip = solution.probes.first().map_or([0.0; 2], |probe| [probe.u.x / length, probe.u.y / length]);
        let motion = simulation.motion().map(|motion| (motion.counts(), motion.ledger().drift()));
        Ok(Entry { case: self, outcome: Outcome::of(&solution, motion.map(|(_, drift)| drift)), solution, motion, tip })
    }
}

/// Case with its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry<C> {
    /// Case.
    pub case: C,
    /// Outcome.
    pub outcome: Outcome,
    /// Results of the last finite state.
    pub solution: Solution,
    /// Counts and energy drift of a motion.
    pub motion: Option<(Counts, f64)>,
    /// Displacement of a beam's tip over the length, or of a mesh file's first probe over the size.
    pub tip: [f64; 2],
}

/// Formats an atlas as CSV.
pub fn table<C: Case>(entries: &[Entry<C>]) -> String {
    let lines = std::iter::once(C::HEADER.to_owned()).chain(entries.iter().map(C::record));
    lines.map(|line| line + "\n").collect()
}

/// Counts the outcomes of the cases with the same key, in the order of [`Case::OUTCOMES`]. Cases with key `None` are
/// not counted.
pub(crate) fn counts<C: Case, K: Ord>(
    entries: &[Entry<C>],
    key: impl Fn(&C) -> Option<K>,
) -> BTreeMap<K, [usize; Outcome::COUNT]> {
    let mut counts: BTreeMap<K, [usize; Outcome::COUNT]> = BTreeMap::new();
    for entry in entries {
        let Some(key) = key(&entry.case) else { continue };
        for (count, outcome) in counts.entry(key).or_default().iter_mut().zip(C::OUTCOMES) {
            *count += usize::from(outcome == entry.outcome);
        }
    }
    counts
}

/// Returns the distinct labels of cases, in the order in which they first appear. Labels `None` are left out.
pub(crate) fn labels<C, L: PartialEq>(entries: &[Entry<C>], label: impl Fn(&C) -> Option<L>) -> Vec<L> {
    let mut labels = Vec::new();
    for label in entries.iter().filter_map(|entry| label(&entry.case)) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels
}

/// Formats the counts of outcomes as text, with a row for each of these series.
fn outcome_table<C: Case>(entries: &[Entry<C>], series: &[AtlasSeries]) -> String {
    let counts = counts(entries, |case| Some(case.series()));
    let columns = C::OUTCOMES.map(|outcome| outcome.entry().0.to_owned());
    text_table::<C>(series, &columns, 14, |series, column| Some(counts.get(series)?[column].to_string()))
}

/// Formats a table as text, with a row for each series that has a cell, and columns of this width.
fn text_table<C: Case>(
    series: &[AtlasSeries],
    columns: &[String],
    width: usize,
    cell: impl Fn(&AtlasSeries, usize) -> Option<String>,
) -> String {
    let name_width = series.iter().map(|(_, name)| name.len()).max().unwrap_or(0).max(7);
    let line = |element: &str, name: &str, cells: Vec<String>| {
        let cells: String = cells.iter().map(|cell| format!(" {cell:>width$}")).collect();
        format!("{element:<7} {name:<name_width$}{cells}\n")
    };
    let rows = series.iter().filter_map(|series| {
        let cells: Vec<_> = (0..columns.len()).map(|column| cell(series, column)).collect();
        let texts = || cells.iter().map(|cell| cell.clone().unwrap_or_else(|| "–".to_owned())).collect();
        cells.iter().any(Option::is_some).then(|| line(series.0, &series.1, texts()))
    });
    line("element", C::NAMES, columns.to_vec()) + &rows.collect::<String>()
}
