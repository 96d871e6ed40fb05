//! A button that is chosen or not: of several one, or on and off.

use egui::{Button, IntoAtoms, Response, Ui};

/// Looks like a button also where it is not chosen.
pub(super) fn choice<'a>(ui: &mut Ui, chosen: bool, words: impl IntoAtoms<'a>) -> Response {
    ui.add(Button::selectable(chosen, words).frame_when_inactive(true))
}
