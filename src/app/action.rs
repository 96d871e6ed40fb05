//! What panel, keys and drawers ask of the lab, and how the body is looked at.

use crate::app::view_options::{CurvePlot, Toggle};
use std::path::PathBuf;

use crate::scene::{IntegratorKind, Scene};
use crate::simulation::Field;
use crate::study::figure::Figure;

/// Most iterations that a displayed frame may be asked for.
pub(crate) const MOST_ITERATIONS: u32 = 100;

/// What a click, a drag or a key asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Open a built-in scene.
    Open(&'static str),
    /// Ask for a scene file and open it.
    OpenFile,
    /// Open a file that was dropped on the window.
    Drop(PathBuf),
    /// Open the scene's file again.
    Reload,
    /// Save the scene to its file, or ask for one.
    Save,
    /// Ask for a file and save the scene to it.
    SaveAs,
    /// Take the last edit back.
    Undo,
    /// Do the edit that was taken back last again.
    Redo,
    /// Close what is open over the body.
    Escape,
    /// Change the scene; a refusal is shown next to the field of this label.
    Edit(&'static str, Box<Scene>),
    /// Iterate, or stop.
    ToggleRun,
    /// One iteration.
    Step,
    /// Show the moment of a motion next to a time, s, and pause there.
    Scrub(f64),
    /// Show the moment before, and pause there.
    Back,
    /// Show the moment after, or take a step from the last one.
    Forward,
    /// Back to rest, or to where the motion starts.
    Reset,
    /// A reset goes to where the body is now; or to the start again.
    Mark,
    /// Simulated seconds a second.
    Speed(f64),
    /// Show the same motion under another integrator, or no longer.
    Compare(IntegratorKind),
    /// So many iterations a displayed frame.
    Iterations(u32),
    /// Show the whole body.
    Fit,
    /// Show or hide something.
    Toggle(Toggle),
    /// Colour the body with a field.
    Color(Field),
    /// Light or dark.
    ToggleTheme,
    /// The other language.
    ToggleLanguage,
    /// Show these quantities of the load curve.
    Plot(CurvePlot),
    /// Save a figure to a file.
    Export(Box<Figure>, FigureFile),
    /// Save a picture.
    Screenshot,
    /// Record the window from now on, or end the recording.
    Record,
    /// Record the scene from its start, or end the recording.
    RecordScene,
    /// Copy the scene as TOML.
    Copy,
    /// Copy the scene as a Rust program.
    CopyRust,
    /// Start the study, or call it off.
    Measure(bool),
    /// Show the card of this number, from 0, and set its scene up.
    Card(usize),
    /// Use a setting as it was measured: its scene, and its iterations a displayed frame.
    Apply(Box<Scene>, u32),
    /// Stop what is meshed and solved beside the window, and go back to how it was before.
    Cancel,
}

/// Kind of a file that a figure is saved to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FigureFile {
    Csv,
    Png,
    Svg,
}

impl FigureFile {
    pub(crate) const ALL: [(Self, &'static str); 3] = [
        (Self::Csv, "Every point as a table, with units"),
        (Self::Png, "The plot and its table as a picture"),
        (Self::Svg, "The plot and its table as a drawing that scales"),
    ];

    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }
}
