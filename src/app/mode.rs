//! What the window is used for: one list, in the order of the toolbar.

use egui::Ui;

use super::action::Action;
use super::lab::Lab;
use crate::scene::{Analysis, Scene};

/// What the window is used for at present.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mode {
    /// The body, its load and its numbers.
    #[default]
    Explore,
    /// The article on a row of cards.
    Learn,
    /// Error against time, and the settings within limits.
    Budget,
}

/// A mode in the toolbar.
pub(super) struct ModeEntry {
    pub mode: Mode,
    pub name: &'static str,
    pub about: &'static str,
    /// Whether it has something to show of a scene.
    pub serves: fn(&Scene) -> bool,
    /// Shows what it has beside body and panel.
    pub show: fn(&mut Lab, &mut Ui, &mut Vec<Action>),
}

/// Every mode there is.
pub(super) const MODES: &[ModeEntry] = &[
    ModeEntry {
        mode: Mode::Explore,
        name: "Explore",
        about: "The body, its load, and how far from the truth it is",
        serves: |_| true,
        show: Lab::plots,
    },
    ModeEntry {
        mode: Mode::Learn,
        name: "Learn",
        about: "The article's method, walked through on eight cards; your own scene comes back at the end",
        serves: |_| true,
        show: Lab::learn,
    },
    ModeEntry {
        mode: Mode::Budget,
        name: "Budget",
        about: "Error against time on this machine, and the fastest setting within limits (B)",
        serves: |scene| scene.analysis == Analysis::Static,
        show: Lab::budget,
    },
];

impl Mode {
    /// Its entry in the list.
    pub(super) fn entry(self) -> &'static ModeEntry {
        MODES.iter().find(|entry| entry.mode == self).unwrap_or(&MODES[0])
    }
}
