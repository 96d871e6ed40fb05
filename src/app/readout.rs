//! State of the model and of its results, as shown by bars, panel and cards.

use crate::app::language::Language;
use crate::app::session::live::Live;
use crate::app::session::playback::Playback;
use crate::app::task::quality::Quality;
use crate::app::widgets::load_scale::OpeningLoads;
use crate::scene::Scene;
use crate::sentence::Sentence;
use crate::simulation::Simulation;
use crate::study::{PathSummary, Reference, SolveFromRest};
use crate::timings::Timings;

/// State of the model and of its results that the toolbar, the panel and the status bar show.
#[derive(Clone, Copy)]
pub(crate) struct Readout<'a> {
    pub scene: &'a Scene,
    /// Scene as last opened or saved.
    pub original: &'a Scene,
    /// Loads that the scene was opened with.
    pub opening: OpeningLoads,
    pub scene_name: &'a str,
    pub simulation: &'a Simulation,
    /// Drawn body: the last equilibrium, or the body at rest, in place of a search that has found no equilibrium.
    pub shown: &'a Simulation,
    /// Solution of the same scene with linear theory.
    pub linear: Option<&'a Simulation>,
    pub running: bool,
    /// `true` if the calculation or the motion that is shown has ended.
    pub ended: bool,
    pub playback: &'a Playback,
    /// Lowest natural frequency of a body in motion, Hz; `None` until it has been computed.
    pub frequency: Option<f64>,
    /// Time of the iterations made for the last displayed frame.
    pub timings: &'a Timings,
    /// Time and result of a solve from rest; `None` until it has been measured.
    pub from_rest: Option<&'a SolveFromRest>,
    /// Time and result at the load at which the hand rested last, during a press.
    pub last_from_rest: Option<&'a SolveFromRest>,
    /// Residual after every iteration since the last change.
    pub residuals: &'a [f64],
    pub can_undo: bool,
    pub can_redo: bool,
    /// Reference solution that errors are measured against, or the one that follows the load; `None` until it has been
    /// computed.
    pub reference: Option<&'a Reference>,
    /// Reference solution that follows the load, if errors are measured against it.
    pub live: Option<&'a Live>,
    /// Reason why it could not be computed.
    pub reference_failure: Option<&'a Sentence>,
    /// Load path from rest, compared with the state; `None` until it has been computed.
    pub path: Option<PathSummary>,
    /// Spectral radius ρ of the warped iteration at the equilibrium; `None` if it has not been computed. It does not
    /// depend on the current state of the body.
    pub equilibrium_rho: Option<f64>,
    /// `true` while it is being computed.
    pub is_computing_rho: bool,
    /// Fraction of the reference solution's computation that is done; `None` if none is in progress.
    pub reference_progress: Option<f64>,
    /// Range of the displayed field's values in the drawn state.
    pub value_range: [f64; 2],
    /// `true` if another body than the simulation's is drawn.
    pub is_fallback: bool,
    /// Measures of the reliability of the result.
    pub quality: &'a Quality,
    /// Language of the user interface.
    pub language: Language,
}

impl Readout<'_> {
    /// Returns `true` if a search has ended without an equilibrium.
    pub(crate) fn has_failed(&self) -> bool {
        self.simulation.motion().is_none() && self.simulation.status().failure().is_some()
    }
}
