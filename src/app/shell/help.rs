//! Help overlay with the list of keys and mouse actions.

use egui::{Align2, Context};

use crate::app::language::tr;
use crate::app::shell::shortcuts::SHORTCUTS;

/// Keys that belong to a mode or to the control with the focus.
const HERE: &[(&str, &str)] = &[
    ("Left, Right", "On a slider: a little less or more; on the cards of Learn: the card before or after"),
    ("Delete", "On a slider: the scene's own value"),
];

const MOUSE: &[(&str, &str)] = &[
    ("Drag an arrow's tip", "Set a force or a moment; Shift: in steps of 15°, or to a round moment"),
    ("Drag the body", "Pull it with a spring; let go and it springs back"),
    ("Drag beside it, two fingers", "Move the view"),
    ("Rest over the body", "Its values under the pointer; a click keeps them"),
    ("Scroll, pinch", "Zoom to the pointer"),
    ("Double click", "Fit the view; on an arrow's tip, a slider or a number: the scene's own"),
    ("Drop a file", "Open it"),
];

/// Shows the list over everything; sets `open` to `false` when it is closed.
pub(crate) fn show(ctx: &Context, open: &mut bool) {
    if !*open {
        return;
    }
    egui::Window::new(tr("Keys and mouse"))
        .id(egui::Id::unique("help"))
        .open(open)
        .collapsible(false)
        .resizable(false)
        // The list is higher than a small window.
        .vscroll(true)
        .max_height(ctx.content_rect().height() - 80.0)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .show(ctx, |ui| {
            egui::Grid::new("shortcuts").num_columns(2).spacing([24.0, 4.0]).striped(true).show(ui, |ui| {
                for shortcut in SHORTCUTS {
                    ui.strong(shortcut.text());
                    ui.label(tr(shortcut.does));
                    ui.end_row();
                }
                for (gesture, does) in HERE.iter().chain(MOUSE) {
                    ui.strong(tr(gesture));
                    ui.label(tr(does));
                    ui.end_row();
                }
            });
        });
}
