//! State of the model and of its results, as shown by bars, panel and cards.

use crate::app::language::Language;
use crate::app::prelude::*;
use crate::app::session::Session;
use crate::study::PathSummary;

/// State of the model and of its results that the toolbar, the panel and the status bar show.
#[derive(Clone, Copy)]
pub(crate) struct Readout<'a> {
    pub session: &'a Session,
    pub scene: &'a Scene,
    pub simulation: &'a Simulation,
    /// Drawn body: the last equilibrium, or the body at rest, in place of a search that has found no equilibrium.
    pub shown: &'a Simulation,
    /// `true` if the calculation or the motion that is shown has ended.
    pub ended: bool,
    /// Reference solution that errors are measured against, or the one that follows the load; `None` until it has been
    /// computed.
    pub reference: Option<&'a Reference>,
    /// Reason why it could not be computed.
    pub reference_failure: Option<&'a Sentence>,
    /// Load path from rest, compared with the state; `None` until it has been computed.
    pub path: Option<PathSummary>,
    /// Range of the displayed field's values in the drawn state.
    pub value_range: [f64; 2],
    /// Language of the user interface.
    pub language: Language,
}

impl Readout<'_> {
    /// Returns `true` if a search has ended without an equilibrium.
    pub(crate) fn has_failed(&self) -> bool {
        self.simulation.motion().is_none() && self.simulation.status().failure().is_some()
    }
}
