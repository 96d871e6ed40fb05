//! The state of the model and of its results that bars, panel and cards show.

use crate::app::language::Language;
use crate::app::session::playback::Playback;
use crate::app::task::quality::Quality;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::study::{PathSummary, Reference};
use crate::timings::Timings;

/// What toolbar, panel and headlines show.
#[derive(Clone, Copy)]
pub(crate) struct Readout<'a> {
    pub scene: &'a Scene,
    /// The scene as it was opened or saved last.
    pub original: &'a Scene,
    pub scene_name: &'a str,
    pub simulation: &'a Simulation,
    /// The same scene under linear theory.
    pub linear: Option<&'a Simulation>,
    pub running: bool,
    /// Whether what is shown has come to its end.
    pub ended: bool,
    pub playback: &'a Playback,
    /// The lowest natural frequency of a body in motion, Hz, once it is known.
    pub frequency: Option<f64>,
    /// Iterations a displayed frame.
    pub iterations: u32,
    /// Time of the last iterations made for one displayed frame.
    pub timings: &'a Timings,
    /// The residual after every iteration since the last change.
    pub residuals: &'a [f64],
    pub can_undo: bool,
    pub can_redo: bool,
    /// What errors are measured against, once it is known.
    pub reference: Option<&'a Reference>,
    /// Where the body jumps on its way from rest, once it is known.
    pub jump: Option<&'a PathSummary>,
    /// ρ of the warped iteration at the equilibrium, where it has been looked for, whatever the body's state.
    pub equilibrium_rho: Option<f64>,
    /// Fraction of the reference solution's search that is done, while it is being computed.
    pub reference_progress: Option<f64>,
    /// `true` where the last equilibrium is drawn instead of a state that diverges.
    pub shows_converged: bool,
    /// How far the result is to be trusted.
    pub quality: &'a Quality,
    pub adapter: &'a str,
    /// What the window speaks.
    pub language: Language,
}
