//! What panel, keys and drawers ask of the lab, and how the body is looked at.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::app::mode::Mode;
use crate::app::modes::budget::measured::Choice;
use crate::app::modes::explore::figure::{CurvePlot, FigureFile};
use crate::app::modes::explore::motion_plot::MotionPlot;
use crate::scene::{Analysis, IntegratorKind, Scene};
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
    /// Use a setting as it was measured.
    Apply(Choice),
    /// Stop what is meshed and solved beside the window, and go back to how it was before.
    Cancel,
}

/// What can be shown or hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Toggle {
    Wireframe,
    RestOutline,
    Ghost,
    Exact,
    Trail,
    Panel,
    Help,
    /// Why the status is what it is.
    Why,
    /// A mode, or back to exploring.
    Mode(Mode),
    Drawer(Drawer),
}

/// What is shown under the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Drawer {
    /// Load against deflection.
    Curve,
    /// Energy, tip, phase and spectrum of a motion.
    Motion,
}

impl Drawer {
    /// That of a scene.
    pub(crate) fn of(scene: &Scene) -> Self {
        match scene.analysis {
            Analysis::Static => Self::Curve,
            Analysis::Dynamic => Self::Motion,
        }
    }

    /// Its name and what is in it.
    pub(crate) fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Curve => ("Load curve", "Load against deflection (L)"),
            Self::Motion => ("Energy and tip", "Energy, tip, phase and spectrum of the motion (E)"),
        }
    }
}

/// How to look at the body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ViewOptions {
    pub field: Field,
    /// Fixed ends of the colour map, or `None` for those of the current values.
    pub fixed_range: Option<[f64; 2]>,
    /// Values as the elements have them, not recovered at the nodes.
    pub raw: bool,
    pub wireframe: bool,
    pub rest_outline: bool,
    pub ghost: bool,
    pub exact: bool,
    pub trail: bool,
    pub mode: Mode,
    pub drawer: Option<Drawer>,
    pub motion_plot: MotionPlot,
    /// Quantities of the load curve; `None` for those that show most.
    pub curve_plot: Option<CurvePlot>,
    /// Whether bars and panel are there at all: a picture may do without.
    pub bars: bool,
    /// Whether the panel is there where it has its own place.
    pub panel: bool,
    /// Whether it lies over the body where it has none.
    pub sheet: bool,
    /// Whether the window is so narrow that it has none.
    pub narrow: bool,
    /// Whether the status is explained.
    pub why: bool,
    pub help: bool,
    /// An edge that is shown: the pointer is on its name.
    pub edge: Option<String>,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            field: Field::default(),
            fixed_range: None,
            raw: false,
            wireframe: true,
            rest_outline: true,
            ghost: true,
            exact: true,
            trail: true,
            mode: Mode::default(),
            drawer: None,
            motion_plot: MotionPlot::default(),
            curve_plot: None,
            bars: true,
            panel: true,
            sheet: false,
            narrow: false,
            why: false,
            help: false,
            edge: None,
        }
    }
}

impl ViewOptions {
    /// Whether the field is drawn from what has been recovered at the nodes.
    pub(crate) fn is_smooth(&self) -> bool {
        !self.raw && !self.field.is_of_elements()
    }

    /// Shows what was hidden and hides what was shown; a drawer opens in the place of another.
    pub(crate) fn toggle(&mut self, what: Toggle) {
        match what {
            Toggle::Wireframe => self.wireframe ^= true,
            Toggle::RestOutline => self.rest_outline ^= true,
            Toggle::Ghost => self.ghost ^= true,
            Toggle::Trail => self.trail ^= true,
            Toggle::Exact => self.exact ^= true,
            Toggle::Panel if self.narrow => self.sheet ^= true,
            Toggle::Panel => self.panel ^= true,
            Toggle::Help => self.help ^= true,
            Toggle::Why => self.why ^= true,
            Toggle::Mode(mode) => {
                self.mode = if self.mode == mode { Mode::Explore } else { mode };
                self.why = false;
            }
            // Plots are for exploring: asked for in another mode they are shown there.
            Toggle::Drawer(drawer) => {
                let open = self.plots() == Some(drawer);
                (self.mode, self.drawer) = (Mode::Explore, (!open).then_some(drawer));
            }
        }
    }

    /// The plots that are seen.
    pub(crate) fn plots(&self) -> Option<Drawer> {
        self.drawer.filter(|_| self.mode == Mode::Explore)
    }

    /// Whether the panel is seen.
    pub(crate) fn shows_panel(&self) -> bool {
        if self.narrow { self.sheet } else { self.panel }
    }

    /// Colours with another field; a fixed range was for the one before.
    pub(crate) fn color_with(&mut self, field: Field) {
        if self.field != field {
            self.field = field;
            self.fixed_range = None;
        }
    }
}
