//! What panel, keys and drawers ask of the lab, and how the body is looked at.

use super::motion_plot::MotionPlot;
use crate::scene::{IntegratorKind, Scene};
use crate::simulation::Field;
use crate::study::Setting;

/// Most iterations that a displayed frame may be asked for.
pub(super) const MOST_ITERATIONS: u32 = 100;

/// What a click, a drag or a key asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Action {
    /// Open a built-in scene.
    Open(&'static str),
    /// Change the scene; a refusal is shown next to the field of this label.
    Edit(&'static str, Box<Scene>),
    /// Iterate, or stop.
    ToggleRun,
    /// One iteration.
    Step,
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
    /// Save a picture.
    Screenshot,
    /// Record the scene, or end the recording.
    Record,
    /// Copy the scene.
    Copy,
    /// Start the study, or call it off.
    Measure(bool),
    /// Use a measured setting.
    Apply(Setting),
}

/// What can be shown or hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Toggle {
    Wireframe,
    RestOutline,
    Ghost,
    Trail,
    Panel,
    Help,
    Drawer(Drawer),
}

/// What is shown under the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawer {
    /// Load against deflection.
    Curve,
    /// Energy, tip, phase and spectrum of a motion.
    Motion,
    /// Error against time, and the settings within limits.
    Budget,
}

/// How to look at the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ViewOptions {
    pub field: Field,
    /// Fixed ends of the colour map, or `None` for those of the current values.
    pub fixed_range: Option<[f64; 2]>,
    /// Values as the elements have them, not recovered at the nodes.
    pub raw: bool,
    pub wireframe: bool,
    pub rest_outline: bool,
    pub ghost: bool,
    pub trail: bool,
    pub drawer: Option<Drawer>,
    pub motion_plot: MotionPlot,
    pub panel: bool,
    pub help: bool,
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
            trail: true,
            drawer: None,
            motion_plot: MotionPlot::default(),
            panel: true,
            help: false,
        }
    }
}

impl ViewOptions {
    /// Shows what was hidden and hides what was shown; a drawer opens in the place of another.
    pub(super) fn toggle(&mut self, what: Toggle) {
        match what {
            Toggle::Wireframe => self.wireframe ^= true,
            Toggle::RestOutline => self.rest_outline ^= true,
            Toggle::Ghost => self.ghost ^= true,
            Toggle::Trail => self.trail ^= true,
            Toggle::Panel => self.panel ^= true,
            Toggle::Help => self.help ^= true,
            Toggle::Drawer(drawer) => self.drawer = if self.drawer == Some(drawer) { None } else { Some(drawer) },
        }
    }

    /// Colours with another field; a fixed range was for the one before.
    pub(super) fn color_with(&mut self, field: Field) {
        if self.field != field {
            self.field = field;
            self.fixed_range = None;
        }
    }
}
