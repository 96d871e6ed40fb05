//! The bar along the top: scene, run, modes, theme, help.

use egui::text::LayoutJob;
use egui::{
    Align, Align2, Button, FontId, IntoAtoms, Layout, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke,
    StrokeKind, TextFormat, Ui, WidgetInfo, pos2, vec2,
};

use crate::app::action::{Action, Toggle, ViewOptions};
use crate::app::language::{Language, tr};
use crate::app::mode::MODES;
use crate::app::panel::PanelInput;
use crate::app::shell::gallery::Gallery;
use crate::app::widgets::palette::{BODY, Palette, SMALL};

/// Below this width, points, buttons show no words.
const WORDS: f32 = 1050.0;

/// Below this width, points, modes have a row of their own.
const ONE_ROW: f32 = 890.0;

/// The height of the bar in a window of this width, points.
pub(crate) fn height(width: f32) -> f32 {
    if width >= ONE_ROW { 36.0 } else { 68.0 }
}

/// Shows the bar.
pub(crate) fn show(
    ui: &mut Ui,
    input: &PanelInput<'_>,
    gallery: &mut Gallery,
    view: &ViewOptions,
    actions: &mut Vec<Action>,
) {
    let wide = ui.available_width() >= WORDS;
    let one_row = height(ui.ctx().content_rect().width()) < 40.0;
    let mut first = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        gallery.show(ui, input, wide, actions);
        divide(ui);
        run(ui, input, wide, actions);
        divide(ui);
        history(ui, input, actions);
        if one_row {
            divide(ui);
            modes(ui, input, view, actions);
            window_tools(ui, view, input.language, actions);
        }
    };
    if one_row {
        ui.horizontal_centered(first);
        return;
    }
    ui.add_space(6.0);
    ui.horizontal(&mut first);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        modes(ui, input, view, actions);
        window_tools(ui, view, input.language, actions);
    });
}

fn modes(ui: &mut Ui, input: &PanelInput<'_>, view: &ViewOptions, actions: &mut Vec<Action>) {
    for entry in MODES {
        let chosen = view.mode == entry.mode;
        let button = ui.add_enabled((entry.serves)(input.scene), Button::selectable(chosen, tr(entry.name)));
        let button = button.on_hover_text(tr(entry.about)).on_disabled_hover_text(tr(entry.unless));
        if button.clicked() && !chosen {
            actions.push(Action::Toggle(Toggle::Mode(entry.mode)));
        }
    }
}

fn window_tools(ui: &mut Ui, view: &ViewOptions, language: Language, actions: &mut Vec<Action>) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let mut button = |icon: Icon, name: &str, chosen: bool, tip: &str, action: Action| {
            let response = ui.add(|ui: &mut Ui| icon_button(ui, icon, tr(name), None, chosen));
            if response.on_hover_text(tr(tip)).clicked() {
                actions.push(action);
            }
        };
        button(Icon::Help, "Help", view.help, "Keys and mouse (F1)", Action::Toggle(Toggle::Help));
        button(Icon::Theme, "Theme", false, "Light or dark (T)", Action::ToggleTheme);
        // Who does not read the present language finds the other one by its own name.
        button(Icon::Language, "Language", false, language.other().name(), Action::ToggleLanguage);
        let tip = "Show or hide the controls (P)";
        button(Icon::Panel, "Panel", view.shows_panel(), tip, Action::Toggle(Toggle::Panel));
    });
}

fn divide(ui: &mut Ui) {
    ui.add(egui::Separator::default().vertical().spacing(10.0));
}

/// What is drawn on a button: the fonts have no such letters.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Icon {
    Play,
    Pause,
    Step,
    Reset,
    Undo,
    Redo,
    Theme,
    Language,
    Help,
    Panel,
    Open,
    Close,
}

/// A button with an icon, before a word where there is room for one; its name is for who cannot see it.
pub(crate) fn icon_button(ui: &mut Ui, icon: Icon, name: &str, word: Option<&str>, chosen: bool) -> Response {
    const SIDE: f32 = 28.0;
    const WIDE: f32 = 52.0;
    const GAP: f32 = 5.0;
    const PADDING: f32 = 8.0;
    let font = FontId::proportional(BODY);
    let side = if icon == Icon::Language { WIDE } else { SIDE };
    let galley = word.map(|word| ui.painter().layout_no_wrap(word.to_owned(), font, egui::Color32::PLACEHOLDER));
    let width = galley.as_ref().map_or(side, |galley| 2.0 * PADDING + 14.0 + GAP + galley.size().x);
    let (rect, response) = ui.allocate_exact_size(vec2(width, ui.spacing().interact_size.y), Sense::click());
    let style = ui.style().interact_selectable(&response, chosen);
    ui.painter().rect(rect, style.corner_radius, style.weak_bg_fill, style.bg_stroke, StrokeKind::Inside);
    let color = style.fg_stroke.color;
    let center = match &galley {
        Some(_) => rect.left_center() + vec2(PADDING + 7.0, 0.0),
        None => rect.center(),
    };
    paint(ui.painter(), icon, center, color);
    if let Some(galley) = galley {
        let at = pos2(rect.right() - PADDING - galley.size().x, rect.center().y - 0.5 * galley.size().y);
        ui.painter().galley(at, galley, color);
    }
    response.widget_info(|| WidgetInfo::selected(Role::Button, response.enabled(), chosen, name));
    response
}

fn paint(painter: &Painter, icon: Icon, center: Pos2, color: egui::Color32) {
    let at = |x: f32, y: f32| center + vec2(x, y);
    let stroke = Stroke::new(1.6, color);
    let polygon = |points: Vec<Pos2>| _ = painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
    let bar = |x: f32| _ = painter.rect_filled(Rect::from_center_size(at(x, 0.0), vec2(3.0, 11.0)), 0.5, color);
    let arc = |from: f32, to: f32| -> Vec<Pos2> {
        let angles = (0..=20u8).map(|i| from + (to - from) * f32::from(i) / 20.0);
        angles.map(|a| at(5.5 * a.cos(), 5.5 * a.sin())).collect()
    };
    match icon {
        Icon::Play => polygon(vec![at(-4.0, -6.0), at(6.0, 0.0), at(-4.0, 6.0)]),
        Icon::Pause => [-3.0, 3.0].into_iter().for_each(bar),
        Icon::Step => {
            polygon(vec![at(-6.0, -5.5), at(2.0, 0.0), at(-6.0, 5.5)]);
            bar(4.5);
        }
        Icon::Reset => {
            painter.add(Shape::line(arc(-0.6, 4.6), stroke));
            polygon(vec![at(0.5, -9.0), at(0.5, -2.0), at(-4.5, -5.5)]);
        }
        Icon::Undo | Icon::Redo => {
            let side = if icon == Icon::Undo { 1.0 } else { -1.0 };
            let turn = arc(-2.9, 1.2).into_iter().map(|p| pos2(center.x + side * (p.x - center.x), p.y));
            painter.add(Shape::line(turn.collect(), stroke));
            polygon([(-9.0, -2.0), (-2.0, -2.0), (-6.0, 3.0)].map(|(x, y)| at(side * x, y)).to_vec());
        }
        Icon::Theme => {
            painter.circle_stroke(center, 5.5, stroke);
            polygon(arc(-std::f32::consts::FRAC_PI_2, std::f32::consts::FRAC_PI_2));
        }
        Icon::Language => {
            painter.text(center, Align2::CENTER_CENTER, "中/EN", FontId::proportional(BODY), color);
        }
        Icon::Help => {
            painter.text(center, Align2::CENTER_CENTER, "?", FontId::proportional(BODY), color);
        }
        Icon::Panel => {
            painter.rect_stroke(Rect::from_center_size(center, vec2(14.0, 11.0)), 1.5, stroke, StrokeKind::Middle);
            painter.line_segment([at(2.5, -5.0), at(2.5, 5.0)], stroke);
        }
        Icon::Open => polygon(vec![at(-4.5, 2.5), at(0.0, -3.0), at(4.5, 2.5)]),
        Icon::Close => polygon(vec![at(-4.5, -2.5), at(4.5, -2.5), at(0.0, 3.0)]),
    }
}

fn run(ui: &mut Ui, input: &PanelInput<'_>, wide: bool, actions: &mut Vec<Action>) {
    let simulation = input.simulation;
    let moves = simulation.motion().is_some();
    let ended = input.ended;
    let mut button = |icon: Icon, name: &str, tip: &str, enabled: bool, action: Action| {
        let (name, tip) = (tr(name), tr(tip));
        let word = wide.then_some(name);
        let response = ui.add_enabled(enabled, |ui: &mut Ui| icon_button(ui, icon, name, word, false));
        if response.on_hover_text(tip).on_disabled_hover_text(tip).clicked() {
            actions.push(action);
        }
    };
    match (input.running, ended) {
        (true, false) => button(Icon::Pause, "Pause", "Stop here (Space)", true, Action::ToggleRun),
        (false, _) => button(Icon::Play, "Run", "Go on (Space)", true, Action::ToggleRun),
        (true, true) => button(Icon::Play, "Run", "Nothing to run: it has come to its end", false, Action::ToggleRun),
    }
    let tip = match (moves, ended) {
        (true, _) => "One time step (N)",
        (false, true) => "Again from rest, one iteration at a time (N)",
        (false, false) => "One iteration (N)",
    };
    button(Icon::Step, "Step", tip, !(moves && ended), Action::Step);
    button(Icon::Reset, "Reset", "Back to rest, or to the start of the motion (R)", true, Action::Reset);
}

fn history(ui: &mut Ui, input: &PanelInput<'_>, actions: &mut Vec<Action>) {
    for (icon, name, tip, enabled, action) in [
        (Icon::Undo, "Undo", "Undo the last edit (Ctrl+Z)", input.can_undo, Action::Undo),
        (Icon::Redo, "Redo", "Redo it (Ctrl+Shift+Z)", input.can_redo, Action::Redo),
    ] {
        let response = ui.add_enabled(enabled, |ui: &mut Ui| icon_button(ui, icon, tr(name), None, false));
        let tip = tr(tip);
        if response.on_hover_text(tip).on_disabled_hover_text(tip).clicked() {
            actions.push(action);
        }
    }
}

/// An entry of a picker: its name, and what it is under it.
pub(crate) fn choice(ui: &mut Ui, palette: &Palette, selected: bool, id: &str, about: &str) -> Response {
    let (id, about) = (tr(id), tr(about));
    let format = |size: f32, color| TextFormat { font_id: FontId::proportional(size), color, ..Default::default() };
    let mut job = LayoutJob::default();
    job.append(id, 0.0, format(BODY, palette.text));
    job.append("\n", 0.0, format(BODY, palette.text));
    let secondary = if selected { palette.text } else { palette.secondary };
    job.append(about, 0.0, format(SMALL, secondary));
    let response = ui.add(Button::selectable(selected, job).wrap());
    response.widget_info(|| WidgetInfo::selected(Role::Button, response.enabled(), selected, id));
    response
}

/// A button that is chosen or not: of several one, or on and off. It looks like a button also where it is not chosen.
pub(crate) fn option_button<'a>(chosen: bool, words: impl IntoAtoms<'a>) -> Button<'a> {
    Button::selectable(chosen, words).frame_when_inactive(true)
}
