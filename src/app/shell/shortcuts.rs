//! Keyboard shortcuts, and the list of them and of the mouse actions over the window.

use crate::app::interface::*;

/// Key with its modifiers, description and action.
pub(crate) struct Shortcut {
    modifiers: Modifiers,
    key: Key,
    pub does: &'static str,
    act: fn() -> Action,
}

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

const fn key(key: Key, does: &'static str, act: fn() -> Action) -> Shortcut {
    with(Modifiers::NONE, key, does, act)
}

const fn with(modifiers: Modifiers, key: Key, does: &'static str, act: fn() -> Action) -> Shortcut {
    Shortcut { modifiers, key, does, act }
}

impl Shortcut {
    /// Returns the name of the key with its modifiers, except on systems of Apple.
    pub(crate) fn text(&self) -> String {
        let command = if self.modifiers.command { "Ctrl+" } else { "" };
        let shift = if self.modifiers.shift { "Shift+" } else { "" };
        format!("{command}{shift}{}", self.key.name())
    }
}

/// Returns the shortcuts that exist here, in the order of the help.
pub(crate) fn shortcuts() -> impl Iterator<Item = &'static Shortcut> {
    SHORTCUTS.iter().filter(|shortcut| (shortcut.act)().is_available())
}

const SHORTCUTS: &[Shortcut] = &[
    key(Key::Space, "Run or pause", || Action::ToggleRun),
    key(Key::N, "One iteration, or one time step", || Action::Step),
    key(Key::Comma, "In motion: pause, and go back by a frame", || Action::Back),
    key(Key::Period, "In motion: pause, and go forward by a frame or a time step", || Action::Forward),
    key(Key::R, "Solve again from rest, or return to the start of the motion", || Action::Reset),
    key(Key::F, "Fit the view", || Action::Fit),
    key(Key::W, "Wireframe on or off", || Action::Toggle(Toggle::Wireframe)),
    key(Key::O, "Outline of the body at rest on or off", || Action::Toggle(Toggle::RestOutline)),
    key(Key::G, "Outline of the linear solution on or off", || Action::Toggle(Toggle::Ghost)),
    key(Key::X, "Outline of the reference solution on or off", || Action::Toggle(Toggle::Exact)),
    key(Key::L, "Measure, load curve, on or off", || Action::Toggle(Toggle::Tab(MeasureTab::LoadCurve))),
    key(Key::Q, "Stress along the sections, and N, V and M along the beam, on or off", || {
        Action::Toggle(Toggle::Drawer(Drawer::Section))
    }),
    key(Key::E, "Energy and tip of a motion on or off", || Action::Toggle(Toggle::Drawer(Drawer::Motion))),
    key(Key::Y, "Trail of the tip on or off", || Action::Toggle(Toggle::Trail)),
    key(Key::B, "Measure, how fast: error against time, on or off", || {
        Action::Toggle(Toggle::Tab(MeasureTab::HowFast))
    }),
    key(Key::M, "Measure, how far: up to which load each method and element holds, on or off", || {
        Action::Toggle(Toggle::Tab(MeasureTab::HowFar))
    }),
    key(Key::K, "Compare: methods, elements and meshes side by side, on or off", || {
        Action::Toggle(Toggle::Mode(Mode::Compare))
    }),
    key(Key::P, "Panel on or off", || Action::Toggle(Toggle::Panel)),
    key(Key::T, "Light or dark", || Action::ToggleTheme),
    key(Key::S, "Save a screenshot (PNG) in the current folder", || Action::Screenshot),
    key(Key::C, "Copy the scene as TOML, with the command that solves it", || Action::Copy),
    key(Key::U, "Copy the address of this page with the whole scene in it", || Action::CopyLink),
    with(Modifiers::COMMAND, Key::O, "Open a scene file", || Action::OpenFile),
    with(Modifiers::COMMAND, Key::S, "Save the scene", || Action::Save),
    with(COMMAND_SHIFT, Key::S, "Save the scene to another file", || Action::SaveAs),
    with(Modifiers::COMMAND, Key::Z, "Undo the last edit", || Action::Undo),
    with(COMMAND_SHIFT, Key::Z, "Redo the last undone edit", || Action::Redo),
    with(Modifiers::COMMAND, Key::Y, "Redo the last undone edit", || Action::Redo),
    key(Key::Escape, "Close this list, cancel the solve, close the values of a point", || Action::Escape),
    key(Key::F1, "This list", || Action::Toggle(Toggle::Help)),
];

/// Returns the actions of the keys pressed in this frame; none while text is edited or a list is open. Space belongs to
/// the control with the focus, if there is one.
pub(crate) fn actions(ctx: &Context) -> Vec<Action> {
    if ctx.text_edit_focused() || ctx.any_popup_open() {
        return Vec::new();
    }
    let focused = ctx.memory(|memory| memory.focused().is_some());
    ctx.input(|i| {
        // The modifiers at the time of the press; they may be released before the frame that processes it.
        let is_pressed = |s: &&Shortcut| {
            i.events.iter().any(|event| {
                matches!(event, Event::Key { key, pressed: true, modifiers, .. }
                    if *key == s.key && modifiers.matches_exact(s.modifiers))
            })
        };
        let is_free = |s: &&Shortcut| !(focused && s.key == Key::Space);
        shortcuts().filter(is_pressed).filter(is_free).map(|s| (s.act)()).collect()
    })
}

/// Keys that belong to a mode or to the control with the focus, and their descriptions.
pub const FOCUS_KEYS: &[(&str, &str)] = &[
    ("Left, Right", "On a slider: decrease or increase; in Learn: the previous or next card"),
    ("Delete", "On a slider: reset to the scene's value"),
];

/// Actions of the pointer, and their descriptions.
pub const MOUSE: &[(&str, &str)] = &[
    ("Drag an arrow", "Set a force or a moment; Shift: snap to 15°, or to a round moment"),
    (
        "Drag the base of an object",
        "Move a force, a support, a probe or a section along the body; the ends of a section turn it",
    ),
    ("Click the body with the secondary button", "Add or remove an object there"),
    ("Drag the body", "Pull it with a mouse spring; release it and it springs back"),
    ("Drag the background, two fingers", "Move the view"),
    ("Hover over the body", "Values under the pointer; click to pin them"),
    ("Scroll, pinch", "Zoom at the pointer"),
    ("Double click", "Fit the view; on an arrow, a slider or a number: reset its value"),
    ("Drop a file", "Open it"),
];

/// Headings of the groups of rows, each with the first row of its group.
const GROUPS: [(&str, &str); 6] = [
    ("Drag an arrow", "Mouse, and the control with the focus"),
    ("Space", "Run"),
    ("F", "View"),
    ("L", "Drawers and modes"),
    ("S", "Files"),
    ("Ctrl+Z", "Edits"),
];

/// Scrolls by the keys of the list.
fn scroll_by_keys(ui: &Ui) {
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
            ui.scroll_with_delta(vec2(0.0, distance));
        }
    }
}

/// Shows the list over everything; sets `open` to `false` when it is closed.
pub(crate) fn show_help(ctx: &Context, open: &mut bool) {
    if !*open {
        return;
    }
    let size = ctx.content_rect().size() - vec2(40.0, 80.0);
    egui::Window::new(tr("Keys and mouse"))
        .id(Id::unique("help"))
        .open(open)
        .collapsible(false)
        .resizable(false)
        // The list is higher than a small window.
        .vscroll(true)
        .default_size(size.min(vec2(640.0, 640.0)))
        .max_height(size.y)
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO)
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
