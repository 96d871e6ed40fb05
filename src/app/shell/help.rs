//! Help overlay with the list of keys and mouse actions.

use crate::app::prelude::*;
use crate::app::shell::shortcuts::shortcuts;

/// Keys that belong to a mode or to the control with the focus, and their descriptions.
pub const FOCUS_KEYS: &[(&str, &str)] = &[
    ("Left, Right", "On a slider: decrease or increase; in Learn: the previous or next card"),
    ("Delete", "On a slider: reset to the scene's value"),
];

/// Actions of the pointer, and their descriptions.
pub const MOUSE: &[(&str, &str)] = &[
    ("Drag an arrow's tip", "Set a force or a moment; Shift: snap to 15°, or to a round moment"),
    (
        "Drag the base of an object",
        "Move a force, a support, a probe or a section along the body; the ends of a section turn it",
    ),
    ("Click the body with the secondary button", "Add or remove an object there"),
    ("Drag the body", "Pull it with a mouse spring; release it and it springs back"),
    ("Drag the background, two fingers", "Move the view"),
    ("Hover over the body", "Values under the pointer; click to pin them"),
    ("Scroll, pinch", "Zoom at the pointer"),
    ("Double click", "Fit the view; on an arrow's tip, a slider or a number: reset its value"),
    ("Drop a file", "Open it"),
];

/// Headings of the groups of rows, each with the first row of its group.
const GROUPS: [(&str, &str); 6] = [
    ("Drag an arrow's tip", "Mouse, and the control with the focus"),
    ("Space", "Run"),
    ("F", "View"),
    ("L", "Drawers and modes"),
    ("S", "Files"),
    ("Ctrl+Z", "Edits"),
];

/// Scrolls by the keys of the list.
fn scroll_by_keys(ui: &egui::Ui) {
    /// Distance of a line, points.
    const LINE: f32 = 40.0;
    let page = 0.8 * ui.ctx().content_rect().height();
    let end = 1e5;
    let keys = [
        (Key::ArrowDown, -LINE),
        (Key::ArrowUp, LINE),
        (Key::PageDown, -page),
        (Key::PageUp, page),
        (Key::End, -end),
        (Key::Home, end),
    ];
    for (key, distance) in keys {
        if ui.input_mut(|i| i.consume_key(Modifiers::NONE, key)) {
            ui.scroll_with_delta(egui::vec2(0.0, distance));
        }
    }
}

/// Shows the list over everything; sets `open` to `false` when it is closed.
pub(crate) fn show(ctx: &Context, open: &mut bool) {
    if !*open {
        return;
    }
    let size = ctx.content_rect().size() - egui::vec2(40.0, 80.0);
    egui::Window::new(tr("Keys and mouse"))
        .id(egui::Id::unique("help"))
        .open(open)
        .collapsible(false)
        .resizable(false)
        // The list is higher than a small window.
        .vscroll(true)
        .default_size(size.min(egui::vec2(640.0, 640.0)))
        .max_height(size.y)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .show(ctx, |ui| {
            scroll_by_keys(ui);
            let heading = |of: &str| GROUPS.iter().find(|(first, _)| *first == of).map(|(_, heading)| *heading);
            let of_shortcuts = shortcuts().map(|shortcut| (shortcut.text(), shortcut.does, heading(&shortcut.text())));
            let of_gestures = MOUSE.iter().chain(FOCUS_KEYS);
            let of_gestures = of_gestures.map(|(gesture, does)| (tr(gesture).to_owned(), *does, heading(gesture)));
            let rows = of_gestures.chain(of_shortcuts);
            let list = egui::Grid::new("shortcuts").num_columns(2).max_col_width(0.6 * size.x);
            list.spacing([16.0, 2.0]).striped(true).show(ui, |ui| {
                for (keys, does, heading) in rows {
                    if let Some(heading) = heading {
                        ui.label(RichText::new(tr(heading)).color(ui.visuals().hyperlink_color));
                        ui.end_row();
                    }
                    ui.strong(with_keys(ctx, &keys));
                    ui.label(tr(does));
                    ui.end_row();
                }
            });
        });
}
