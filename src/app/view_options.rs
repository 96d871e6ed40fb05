//! Display options: mode, drawer, plots, and everything that can be shown or hidden.

use serde::{Deserialize, Serialize};

use crate::format::round_down;
use crate::scene::limits::Limit;
use crate::scene::{Analysis, Scene};
use crate::simulation::{Field, PointValues};
use crate::study::path_chart::Ordinate;

/// Mode of the user interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Body, load and results.
    #[default]
    Explore,
    /// Article on a row of cards.
    Learn,
    /// Two to four settings side by side under one load.
    Compare,
    /// Range and cost of methods and elements, and the load curve.
    Measure,
}

/// Tab of the mode Measure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeasureTab {
    /// Loads up to which each method and element holds; of a motion, time steps.
    #[default]
    HowFar,
    /// Error of measured settings against their time, and the settings within limits of both.
    HowFast,
    /// Load curve of a scene at rest.
    LoadCurve,
}

impl MeasureTab {
    /// Returns the tabs of a scene: a motion has no load curve.
    pub(crate) fn of(scene: &Scene) -> &'static [Self] {
        match scene.analysis {
            Analysis::Static => &[Self::HowFar, Self::HowFast, Self::LoadCurve],
            Analysis::Dynamic => &[Self::HowFar, Self::HowFast],
        }
    }

    /// Returns the name of the tab and a description of its content.
    pub(crate) fn text(self) -> (&'static str, &'static str) {
        match self {
            Self::HowFar => {
                ("How far", "The loads up to which each method and element is within 1 % and 5 %, and converges (M)")
            }
            Self::HowFast => {
                ("How fast", "Error against time on this machine, and the fastest setting within limits (B)")
            }
            Self::LoadCurve => ("Load curve", "The displacement while the load grows (L)"),
        }
    }
}

/// All modes with their names and descriptions, in the order of the toolbar.
pub(crate) const MODES: [(Mode, &str, &str); 4] = [
    (Mode::Explore, "Explore", "The body, its load, and the error of the solution"),
    (Mode::Learn, "Learn", "The article's method, walked through on cards; your own scene comes back at the end"),
    (Mode::Compare, "Compare", "Methods, integrators, elements and meshes side by side under one load (K)"),
    (
        Mode::Measure,
        "Measure",
        "How far each method holds and how fast it is, measured on this machine, and the load curve",
    ),
];

/// Plot of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotionPlot {
    /// Energy by kind.
    #[default]
    Energy,
    /// Displacement of the first probe against time.
    Tip,
}

/// Part of the display that can be shown or hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Toggle {
    Wireframe,
    RestOutline,
    Ghost,
    Exact,
    Trail,
    Panel,
    Help,
    /// Explanation of the status.
    Why,
    /// A mode; toggling the current mode returns to [`Mode::Explore`].
    Mode(Mode),
    /// A tab of [`Mode::Measure`]; toggling the visible one returns to [`Mode::Explore`].
    Tab(MeasureTab),
    Drawer(Drawer),
}

/// Plot area under the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Drawer {
    /// Energy and tip of a motion.
    Motion,
    /// Stress along the sections of the scene, and N, V and M along its beam.
    Section,
}

impl Drawer {
    /// Returns the drawer whose content a scene has.
    pub(crate) fn of(scene: &Scene) -> Self {
        match scene.analysis {
            Analysis::Static => Self::Section,
            Analysis::Dynamic => Self::Motion,
        }
    }

    /// Returns the drawer's name and a description of its content.
    pub(crate) fn text(self) -> (&'static str, &'static str) {
        match self {
            Self::Section => ("Sections", "Stress along the sections, and N, V and M along the beam (Q)"),
            Self::Motion => ("Energy and tip", "Energy and tip of the motion (E)"),
        }
    }
}

/// Factor of the drawn displacement of a body at its true scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Magnification {
    /// 1.
    #[default]
    None,
    /// The largest displacement is drawn as about a twentieth of the body's size, and never smaller than it is.
    Automatic,
    /// Chosen factor.
    Factor(f64),
}

impl Magnification {
    /// Limits of the factor.
    pub const LIMIT: Limit = Limit { unit: "", min: 1e-3, max: 1e12 };

    /// Returns the factor for a body of this size whose largest displacement is `largest`, both in m.
    pub(crate) fn factor(self, size: f64, largest: f64) -> f64 {
        /// Largest drawn displacement relative to the size of the body.
        const SHARE: f64 = 0.05;
        match self {
            Self::None => 1.0,
            Self::Factor(factor) => factor,
            Self::Automatic if largest > 0.0 => round_down((SHARE * size / largest).clamp(1.0, Self::LIMIT.max)),
            Self::Automatic => 1.0,
        }
    }
}

/// Lines of the body that are drawn: its mesh, its shape at rest, in linear theory and in the reference, and the trail of its
/// tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineOptions {
    pub wireframe: bool,
    pub rest_outline: bool,
    pub ghost: bool,
    pub exact: bool,
    pub trail: bool,
}

impl Default for LineOptions {
    fn default() -> Self {
        Self { wireframe: true, rest_outline: true, ghost: true, exact: true, trail: true }
    }
}

/// Bars and panel around the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutOptions {
    /// `true` if bars and panel are drawn; images may omit them.
    pub bars: bool,
    /// `true` if the panel is open in a window that is wide enough for it.
    pub panel: bool,
    /// `true` if the panel is open over the body in a narrow window.
    pub sheet: bool,
    /// `true` if the window is too narrow for a panel next to the body.
    pub narrow: bool,
}

impl Default for LayoutOptions {
    fn default() -> Self {
        Self { bars: true, panel: true, sheet: false, narrow: false }
    }
}

/// Display options of the body, the plots and the bars.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewOptions {
    pub field: Field,
    /// Fixed limits of the colour map; `None` means the limits of the current values.
    pub fixed_range: Option<[f64; 2]>,
    /// `true` if the values of the elements are drawn instead of values recovered at the nodes.
    pub raw: bool,
    /// Factor of the displacement drawn in the mode Explore.
    pub magnification: Magnification,
    pub lines: LineOptions,
    pub mode: Mode,
    pub drawer: Option<Drawer>,
    pub motion_plot: MotionPlot,
    /// Tab of Measure.
    pub tab: MeasureTab,
    /// Quantities of the load curve; `None` means the default ones.
    pub curve_plot: Option<Ordinate>,
    pub layout: LayoutOptions,
    /// `true` if the explanation of the status is shown.
    pub why: bool,
    pub help: bool,
    /// Name of the highlighted edge: the one whose name is under the pointer.
    pub edge: Option<String>,
}

impl ViewOptions {
    /// Returns the source of the displayed values.
    pub(crate) fn point_values(&self) -> PointValues {
        if self.raw { PointValues::Raw } else { PointValues::Recovered }
    }

    /// Shows what is hidden and hides what is shown; opening a drawer closes the other one.
    pub(crate) fn toggle(&mut self, what: Toggle) {
        match what {
            Toggle::Wireframe => self.lines.wireframe ^= true,
            Toggle::RestOutline => self.lines.rest_outline ^= true,
            Toggle::Ghost => self.lines.ghost ^= true,
            Toggle::Trail => self.lines.trail ^= true,
            Toggle::Exact => self.lines.exact ^= true,
            Toggle::Panel if self.layout.narrow => self.layout.sheet ^= true,
            Toggle::Panel => self.layout.panel ^= true,
            Toggle::Help => self.help ^= true,
            Toggle::Why => self.why ^= true,
            Toggle::Mode(mode) => {
                self.mode = if self.mode == mode { Mode::Explore } else { mode };
                self.why = false;
            }
            Toggle::Tab(tab) => {
                let open = self.mode == Mode::Measure && self.tab == tab;
                (self.mode, self.tab) = (if open { Mode::Explore } else { Mode::Measure }, tab);
                self.why = false;
            }
            // Plots are shown in Explore only: opening one from another mode switches to it.
            Toggle::Drawer(drawer) => {
                let open = self.plots() == Some(drawer);
                (self.mode, self.drawer) = (Mode::Explore, (!open).then_some(drawer));
            }
        }
    }

    /// Returns the drawer that is visible.
    pub(crate) fn plots(&self) -> Option<Drawer> {
        self.drawer.filter(|_| self.mode == Mode::Explore)
    }

    /// Returns the tab of Measure that is visible.
    pub(crate) fn measured(&self, scene: &Scene) -> Option<MeasureTab> {
        let tab = if MeasureTab::of(scene).contains(&self.tab) { self.tab } else { MeasureTab::HowFar };
        (self.mode == Mode::Measure).then_some(tab)
    }

    /// Colours the body with `field`; a fixed colour range is dropped if the field changes.
    pub fn color_with(&mut self, field: Field) {
        if self.field != field {
            // A range of stresses holds for another stress, not for a strain, and not for one with a sign.
            if self.field.unit() != field.unit() || self.field.has_sign() != field.has_sign() {
                self.fixed_range = None;
            }
            self.field = field;
        }
    }
}
