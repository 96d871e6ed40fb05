//! Toolbar along the top: scene, run, modes, theme, help.

use super::*;
use crate::app::language::Language;
use crate::app::view_options::MODES;
use crate::app::widgets::buttons::{Icon, at_right, icon, icon_button};

/// Height of the toolbar in one row, and in the two rows of a narrow window, points.
pub(crate) const HEIGHTS: [f32; 2] = [36.0, 68.0];

impl Lab {
    /// Shows the bar. In a narrow window the modes and the tools of the window have a row of their own, and buttons no words.
    pub(super) fn toolbar(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let Self { desk, gallery, settings, .. } = self;
        let view = &desk.view;
        let mut of_scene = |ui: &mut Ui, actions: &mut Vec<Action>| {
            ui.spacing_mut().item_spacing.x = 6.0;
            gallery.show(ui, &desk.session, actions);
            tools(ui, desk, actions);
        };
        let of_window = |ui: &mut Ui, actions: &mut Vec<Action>| {
            modes(ui, view, actions);
            window_tools(ui, view, settings.language, actions);
        };
        if view.layout.narrow {
            ui.add_space(6.0);
            ui.horizontal(|ui| of_scene(ui, actions));
            ui.horizontal(|ui| of_window(ui, actions));
        } else {
            ui.horizontal_centered(|ui| {
                of_scene(ui, actions);
                ui.add(egui::Separator::default().vertical().spacing(10.0));
                of_window(ui, actions);
            });
        }
    }
}

fn modes(ui: &mut Ui, view: &ViewOptions, actions: &mut Vec<Action>) {
    for (mode, name, about) in MODES {
        let chosen = view.mode == mode;
        let button = ui.add(Button::selectable(chosen, tr(name))).on_hover_text(tr(about));
        if button.clicked() && !chosen {
            actions.push(Action::Toggle(Toggle::Mode(mode)));
        }
    }
}

fn window_tools(ui: &mut Ui, view: &ViewOptions, language: Language, actions: &mut Vec<Action>) {
    at_right(ui, "tools", |ui| {
        let mut button = |icon: Icon, name: &str, chosen: bool, tip: &str, action: Action| {
            let response = ui.add(|ui: &mut Ui| icon_button(ui, icon, tr(name), None, chosen));
            if response.on_hover_text(tr(tip)).clicked() {
                actions.push(action);
            }
        };
        let (tip, is_open) =
            ("Show or hide the controls (P)", if view.layout.narrow { view.layout.sheet } else { view.layout.panel });
        button(icon::PANEL, "Panel", is_open, tip, Action::Toggle(Toggle::Panel));
        // The other language is named in that language, for users who do not read the current one.
        button(icon::LANGUAGE, "Language", false, language.other().name(), Action::ToggleLanguage);
        button(icon::THEME, "Theme", false, "Light or dark (T)", Action::ToggleTheme);
        button(icon::HELP, "Help", view.help, "Keys and mouse (F1)", Action::Toggle(Toggle::Help));
    });
}

/// Shows the buttons that run the solution, and those that undo and redo edits; with words where there is room.
fn tools(ui: &mut Ui, desk: &Desk, actions: &mut Vec<Action>) {
    let (session, wide, ended) = (&desk.session, !desk.view.layout.narrow, desk.has_ended());
    let moves = session.is_motion();
    let run = match (session.is_running(), ended) {
        (true, false) => (icon::PAUSE, "Pause", "Pause here (Space)", true, Action::ToggleRun),
        (false, _) => (icon::RUN, "Run", "Continue (Space)", true, Action::ToggleRun),
        (true, true) => (icon::RUN, "Run", "Nothing to run: already at the end", false, Action::ToggleRun),
    };
    let step = match (moves, ended) {
        (true, _) => "One time step (N)",
        (false, true) => "Start again from rest, one iteration at a time (N)",
        (false, false) => "One iteration (N)",
    };
    let reset = "Solve again from rest, or return to the start of the motion (R)";
    for (icon, name, tip, enabled, action) in [
        run,
        (icon::STEP, "Step", step, !(moves && ended), Action::Step),
        (icon::RESET, "Reset", reset, true, Action::Reset),
        (icon::UNDO, "Undo", "Undo the last edit (Ctrl+Z)", session.undo.can_undo(), Action::Undo),
        (icon::REDO, "Redo", "Redo the last undone edit (Ctrl+Shift+Z)", session.undo.can_redo(), Action::Redo),
    ] {
        let word = (wide && matches!(action, Action::ToggleRun | Action::Step)).then_some(tr(name));
        let response = ui.add_enabled(enabled, |ui: &mut Ui| icon_button(ui, icon, tr(name), word, false));
        let tip = with_keys(ui.ctx(), tr(tip));
        if response.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
            actions.push(action);
        }
    }
}
