//! The overlay that lists keys and mouse.

use egui::{Align2, Context, Key};

/// A key and what it does.
pub(super) struct Shortcut {
    pub key: Key,
    pub does: &'static str,
}

const fn key(key: Key, does: &'static str) -> Shortcut {
    Shortcut { key, does }
}

/// Every key, in the order of the list.
pub(super) const SHORTCUTS: &[Shortcut] = &[
    key(Key::Space, "Run or pause the iteration"),
    key(Key::N, "One iteration"),
    key(Key::R, "Reset to rest"),
    key(Key::F, "Fit the view"),
    key(Key::W, "Wireframe on or off"),
    key(Key::O, "Rest outline on or off"),
    key(Key::G, "Ghost of the linear solution on or off"),
    key(Key::Num1, "Colour: von Mises stress"),
    key(Key::Num2, "Colour: strain energy density"),
    key(Key::Num3, "Colour: largest strain"),
    key(Key::Num4, "Colour: rotation angle"),
    key(Key::L, "Load curve on or off"),
    key(Key::B, "Budget: error against time, on or off"),
    key(Key::P, "Panel on or off"),
    key(Key::T, "Light or dark"),
    key(Key::S, "Save a screenshot (PNG) here"),
    key(Key::C, "Copy the scene as TOML, with its command"),
    key(Key::F1, "This list"),
];

const MOUSE: &[(&str, &str)] =
    &[("Drag", "Move the view"), ("Scroll, pinch", "Zoom to the pointer"), ("Double click", "Fit the view")];

/// Shows the list over everything; `open` goes off when it is closed.
pub(super) fn show(ctx: &Context, open: &mut bool) {
    if !*open {
        return;
    }
    egui::Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .show(ctx, |ui| {
            egui::Grid::new("shortcuts").num_columns(2).spacing([24.0, 4.0]).striped(true).show(ui, |ui| {
                for shortcut in SHORTCUTS {
                    ui.strong(shortcut.key.name());
                    ui.label(shortcut.does);
                    ui.end_row();
                }
                for (gesture, does) in MOUSE {
                    ui.strong(*gesture);
                    ui.label(*does);
                    ui.end_row();
                }
            });
            ui.small("Escape closes this list.");
        });
}
