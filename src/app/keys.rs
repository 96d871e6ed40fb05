//! Keys and what they do.

use egui::{Context, Key};

use super::action::{Action, Drawer, Toggle};
use crate::simulation::Field;

/// A key and what it does.
pub(super) struct Shortcut {
    pub key: Key,
    pub does: &'static str,
    act: fn() -> Action,
}

const fn key(key: Key, does: &'static str, act: fn() -> Action) -> Shortcut {
    Shortcut { key, does, act }
}

/// Every key, in the order of the help.
pub(super) const SHORTCUTS: &[Shortcut] = &[
    key(Key::Space, "Run or pause", || Action::ToggleRun),
    key(Key::N, "One iteration, or one time step", || Action::Step),
    key(Key::R, "Reset to rest, or to the start of the motion", || Action::Reset),
    key(Key::H, "In motion: reset to here from now on; again: to the start", || Action::Mark),
    key(Key::F, "Fit the view", || Action::Fit),
    key(Key::W, "Wireframe on or off", || Action::Toggle(Toggle::Wireframe)),
    key(Key::O, "Rest outline on or off", || Action::Toggle(Toggle::RestOutline)),
    key(Key::G, "Ghost of the linear solution on or off", || Action::Toggle(Toggle::Ghost)),
    key(Key::Num1, "Colour: von Mises (Cauchy)", || Action::Color(Field::VonMises)),
    key(Key::Num2, "Colour: strain energy density", || Action::Color(Field::EnergyDensity)),
    key(Key::Num3, "Colour: largest strain", || Action::Color(Field::LargestStrain)),
    key(Key::Num4, "Colour: rotation angle", || Action::Color(Field::RotationAngle)),
    key(Key::Num5, "Colour: mesh error", || Action::Color(Field::MeshError)),
    key(Key::L, "Load curve on or off", || Action::Toggle(Toggle::Drawer(Drawer::Curve))),
    key(Key::E, "Energy, tip and spectrum of a motion on or off", || Action::Toggle(Toggle::Drawer(Drawer::Motion))),
    key(Key::Y, "Trail of the tip on or off", || Action::Toggle(Toggle::Trail)),
    key(Key::B, "Budget: error against time, on or off", || Action::Toggle(Toggle::Drawer(Drawer::Budget))),
    key(Key::P, "Panel on or off", || Action::Toggle(Toggle::Panel)),
    key(Key::T, "Light or dark", || Action::ToggleTheme),
    key(Key::S, "Save a screenshot (PNG) here", || Action::Screenshot),
    key(Key::V, "Record the scene as a GIF here; again: stop", || Action::Record),
    key(Key::C, "Copy the scene as TOML, with its command", || Action::Copy),
    key(Key::F1, "This list", || Action::Toggle(Toggle::Help)),
];

/// What the keys of this frame ask for; none while text is edited.
pub(super) fn actions(ctx: &Context, help_is_open: bool) -> Vec<Action> {
    if ctx.text_edit_focused() {
        return Vec::new();
    }
    ctx.input(|i| {
        let plain = i.modifiers.is_none();
        let mut actions: Vec<Action> =
            SHORTCUTS.iter().filter(|s| plain && i.key_pressed(s.key)).map(|s| (s.act)()).collect();
        if help_is_open && i.key_pressed(Key::Escape) {
            actions.push(Action::Toggle(Toggle::Help));
        }
        actions
    })
}
