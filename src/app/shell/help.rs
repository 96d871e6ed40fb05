//! Help overlay with the list of keys and mouse actions.

use egui::{Align2, Context};

use crate::app::language::tr;
use crate::app::shell::shortcuts::shortcuts;
use crate::app::widgets::text::with_keys;

/// Keys that belong to a mode or to the control with the focus, and their descriptions.
pub const FOCUS_KEYS: &[(&str, &str)] = &[
    ("Left, Right", "On a slider: decrease or increase; in Learn: the previous or next card"),
    ("Delete", "On a slider: reset to the scene's value"),
];

/// Actions of the pointer, and their descriptions.
pub const MOUSE: &[(&str, &str)] = &[
    ("Drag an arrow's tip", "Set a force or a moment; Shift: snap to 15°, or to a round moment"),
    ("Drag the base of an object", "Move a force, a support, a probe or a section along the body"),
    ("Click the body with the secondary button", "Add or remove an object there"),
    ("Drag the body", "Pull it with a mouse spring; release it and it springs back"),
    ("Drag the background, two fingers", "Move the view"),
    ("Hover over the body", "Values under the pointer; click to pin them"),
    ("Scroll, pinch", "Zoom at the pointer"),
    ("Double click", "Fit the view; on an arrow's tip, a slider or a number: reset its value"),
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
                for shortcut in shortcuts() {
                    ui.strong(with_keys(ctx, &shortcut.text()));
                    ui.label(tr(shortcut.does));
                    ui.end_row();
                }
                for (gesture, does) in FOCUS_KEYS.iter().chain(MOUSE) {
                    ui.strong(tr(gesture));
                    ui.label(tr(does));
                    ui.end_row();
                }
            });
        });
}
