//! How the body is looked at: mode, drawer, plots, and everything that can be shown or hidden.

use serde::{Deserialize, Serialize};

use crate::scene::{Analysis, Scene};
use crate::simulation::Field;

/// What the window is used for at present.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mode {
    /// The body, its load and its numbers.
    #[default]
    Explore,
    /// The article on a row of cards.
    Learn,
    /// Two to four settings beside each other under one load.
    Compare,
    /// Error against time, and the settings within limits.
    Budget,
}

/// A mode in the toolbar.
pub(crate) struct ModeEntry {
    pub mode: Mode,
    pub name: &'static str,
    pub about: &'static str,
}

/// Every mode, in the order of the toolbar.
pub(crate) const MODES: &[ModeEntry] = &[
    ModeEntry { mode: Mode::Explore, name: "Explore", about: "The body, its load, and how far from the truth it is" },
    ModeEntry {
        mode: Mode::Learn,
        name: "Learn",
        about: "The article's method, walked through on cards; your own scene comes back at the end",
    },
    ModeEntry {
        mode: Mode::Compare,
        name: "Compare",
        about: "Methods, integrators, elements and meshes beside each other under one load (K)",
    },
    ModeEntry {
        mode: Mode::Budget,
        name: "Budget",
        about: "Error against time on this machine, and the fastest setting within limits (B)",
    },
];

/// What is plotted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum MotionPlot {
    /// Energy by kind.
    #[default]
    Energy,
    /// Displacement of the first probe.
    Tip,
    /// Its velocity against its displacement.
    Phase,
    /// The amplitudes of the frequencies in it.
    Spectrum,
}

/// Quantities that a load curve shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CurvePlot {
    /// The reaction of a support that moves, over its way.
    Reaction,
    /// The components of the displacement against each other.
    Path,
    /// The horizontal component over the load.
    X,
    /// The vertical component over the load.
    Y,
}

impl CurvePlot {
    /// The component along an axis: 0 is x.
    pub(crate) fn component(axis: usize) -> Self {
        if axis == 0 { Self::X } else { Self::Y }
    }

    pub(crate) fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Reaction => ("Reaction", "The reaction of the support over its way"),
            Self::Path => ("Path", "The path of the point where errors are measured: u_y against u_x, in one scale"),
            Self::X => ("u_x", "u_x against load, where errors are measured"),
            Self::Y => ("u_y", "u_y against load, where errors are measured"),
        }
    }
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
