//! What the window is used for: one list, in the order of the toolbar.

use egui::Ui;

use crate::app::action::Action;
use crate::app::shell::lab::{Lab, Request};
use crate::scene::Scene;

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
    /// Whether it has something to show of a scene, and why not of others.
    pub serves: fn(&Scene) -> bool,
    pub unless: &'static str,
    /// Shows what it has beside body and panel.
    pub show: fn(&mut Lab, &mut Ui, &mut Vec<Action>),
    /// Shows what is in the place of the body.
    pub view: fn(&mut Lab, &mut Ui, &mut Vec<Action>, &mut Vec<Request>),
}

/// Every mode there is.
pub(crate) const MODES: &[ModeEntry] = &[
    ModeEntry {
        mode: Mode::Explore,
        name: "Explore",
        about: "The body, its load, and how far from the truth it is",
        serves: |_| true,
        unless: "",
        show: Lab::plots,
        view: Lab::body_view,
    },
    ModeEntry {
        mode: Mode::Learn,
        name: "Learn",
        about: "The article's method, walked through on nine cards; your own scene comes back at the end",
        serves: |_| true,
        unless: "",
        show: Lab::learn,
        view: Lab::body_view,
    },
    ModeEntry {
        mode: Mode::Compare,
        name: "Compare",
        about: "Methods, integrators, elements and meshes beside each other under one load (K)",
        serves: |_| true,
        unless: "",
        show: Lab::comparison_bars,
        view: Lab::comparison,
    },
    ModeEntry {
        mode: Mode::Budget,
        name: "Budget",
        about: "Error against time on this machine, and the fastest setting within limits (B)",
        serves: |_| true,
        unless: "",
        show: Lab::budget,
        view: Lab::body_view,
    },
];

impl Mode {
    /// Its entry in the list.
    pub(crate) fn entry(self) -> &'static ModeEntry {
        MODES.iter().find(|entry| entry.mode == self).unwrap_or(&MODES[0])
    }
}
