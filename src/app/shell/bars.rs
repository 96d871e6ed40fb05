//! Toolbar along the top: scene, run, modes, theme, help; and status bar along the bottom: the main numbers of the result,
//! and the button of the drawer.

use super::*;
use crate::app::diagnosis::{
    DRIFT_TIP, doubt, drift, drift_text, error_color, error_text, error_tip, errors, is_large, is_without_reference,
    load_text, rho, rho_number,
};
use crate::app::language::{Language, filled};
use crate::app::session::clock::fraction;
use crate::app::task::solve::Phase;
use crate::app::view_options::MODES;
use crate::app::widgets::buttons::{Icon, at_right, icon, icon_button};
use crate::format::grouped;

/// Name of the error, and the least width of the slot of its remark, points: what follows stays in place when the remark
/// changes.
const ERROR: &str = "ERROR";
const ERROR_REMARK: f32 = 178.0;

/// Space between the parts of an entry, points, and size of its bar.
const GAP: f32 = 6.0;
const BAR: Vec2 = vec2(56.0, 6.0);

struct BarNumber {
    name: &'static str,
    /// Name, number, and the remark after it, which is empty if there is none.
    texts: [Arc<egui::Galley>; 3],
    tip: String,
    color: Color32,
    /// Ratio of the number to its limit, drawn as a bar with the limit in its middle.
    ratio: Option<f64>,
}

impl BarNumber {
    /// Returns a number with a remark, without bar. The remark has the colour of a number that needs attention, or needs
    /// it itself if it `is_doubtful`.
    fn new(
        ui: &Ui,
        (name, value): (&'static str, &str),
        (remark, is_doubtful): (&str, bool),
        tip: impl Into<String>,
        color: Color32,
    ) -> Self {
        let palette = Palette::new(ui.visuals());
        let text =
            |text: &str, size, color| ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(size), color);
        let remark_color = match [palette.warning, palette.large, palette.error].contains(&color) {
            true => color,
            false if is_doubtful => palette.warning,
            false => palette.secondary,
        };
        let [title, remark] =
            [(tr(name), palette.secondary), (remark, remark_color)].map(|(own, color)| text(own, SMALL, color));
        Self { name, texts: [title, text(value, HEADLINE, color), remark], tip: tip.into(), color, ratio: None }
    }

    /// Returns the width of the number, points: a minimum keeps what follows in place when the number of digits changes.
    fn number_width(&self, wide: bool) -> f32 {
        self.texts[1].size().x.max(if wide { 62.0 } else { 0.0 })
    }

    /// Returns the width without the remark, points.
    fn width(&self, wide: bool) -> f32 {
        let bar = if wide && self.ratio.is_some() { BAR.x + GAP } else { 0.0 };
        self.texts[0].size().x + GAP + self.number_width(wide) + bar
    }

    /// Shows the name, the number, its bar if the window is `wide` and, in its slot if there is one, its remark. The width of a
    /// slot is in points.
    fn show(self, ui: &mut Ui, wide: bool, slot: Option<f32>) {
        let palette = Palette::new(ui.visuals());
        let widths = [self.texts[0].size().x, self.number_width(wide), self.texts[2].size().x];
        let size = vec2(self.width(wide) + slot.unwrap_or(0.0), ui.spacing().interact_size.y);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let (middle, mut x) = (rect.center().y, rect.left());
        let shown = if slot.is_some() && !self.texts[2].text().is_empty() { 3 } else { 2 };
        for (i, (galley, width)) in self.texts.iter().zip(widths).enumerate().take(shown) {
            let at = pos2(x, middle - 0.5 * galley.size().y);
            match i {
                1 => semibold(ui.painter(), at, galley, self.color),
                _ => ui.painter().galley(at, galley.clone(), self.color),
            }
            x += width + GAP;
        }
        if let Some(ratio) = self.ratio.filter(|_| wide) {
            let bar = Rect::from_min_size(pos2(x, middle - 0.5 * BAR.y), BAR);
            ui.painter().rect_filled(bar, 2.0, palette.line);
            let end = bar.left() + bar.width() * (0.5 * ratio).clamp(0.0, 1.0) as f32;
            ui.painter().rect_filled(Rect::from_min_max(bar.min, pos2(end, bar.bottom())), 2.0, self.color);
            ui.painter().vline(bar.center().x, bar.y_range().expand(4.0), Stroke::new(1.5, palette.secondary));
        }
        let spoken = self.texts.iter().take(shown).map(|galley| galley.text()).collect::<Vec<_>>().join(" ");
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &spoken));
        response.on_hover_text(self.tip);
    }
}

/// Shows the status bar.
pub(crate) fn show(ui: &mut Ui, session: &Session, view: &ViewOptions, actions: &mut Vec<Action>) {
    // In a narrow window the numbers have no bars.
    let wide = !view.layout.narrow;
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = if wide { 28.0 } else { 14.0 };
        let entries = match session.simulation().motion() {
            Some(_) => of_motion(ui, session).into(),
            None => of_solve(ui, session),
        };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let drawer = Drawer::of(session.scene());
            let open = view.plots() == Some(drawer);
            let is_offered = view.mode == Mode::Explore || !session.scene().sections.is_empty() || open;
            if is_offered || drawer == Drawer::Motion {
                let (word, tip) = drawer.text();
                let (word, tip) = (tr(word), tr(tip));
                let icon = if open { icon::CLOSE } else { icon::OPEN };
                if icon_button(ui, icon, word, Some(word), open).on_hover_text(tip).clicked() {
                    actions.push(Action::Toggle(Toggle::Drawer(drawer)));
                }
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                // Remarks have the room that the numbers leave.
                let gaps = ui.spacing().item_spacing.x * entries.len().saturating_sub(1) as f32;
                let mut room = ui.available_width() - gaps - entries.iter().map(|entry| entry.width(wide)).sum::<f32>();
                for entry in entries {
                    let is_error = entry.name == ERROR;
                    let remark = if entry.texts[2].text().is_empty() { 0.0 } else { entry.texts[2].size().x + GAP };
                    let has_remark = remark <= room;
                    let slot = if is_error && wide { ERROR_REMARK.max(remark) } else { remark };
                    let slot = if slot <= room { slot } else { remark };
                    room -= if has_remark { slot } else { 0.0 };
                    entry.show(ui, wide, has_remark.then_some(slot));
                }
            });
        });
    });
}

fn of_solve(ui: &Ui, session: &Session) -> Vec<BarNumber> {
    let palette = &Palette::new(ui.visuals());
    let errors = errors(session);
    let simulation = session.simulation();
    let solve = session.timed_from_rest().filter(|_| simulation.status().is_success());
    // While a load is dragged, a longer solve is not repeated.
    let is_last = solve.is_none() && simulation.status().is_success();
    let shown = if is_last { session.last_from_rest() } else { solve };
    let time = shown.filter(|solve| solve.is_solved);
    let seconds = time.map_or(0.0, |time| time.timings.total().as_secs_f64());
    let rho = rho(session);
    let sought = session.facts.reference.progress().filter(|_| errors.own.is_none());
    let doubt = doubt(session, &errors);
    let is_without_reference = is_without_reference(session);
    let is_doubtful = doubt.is_some();
    let is_late = session.live().is_some_and(|live| live.is_late(session.drawn()));
    let color = if is_late { palette.secondary } else { error_color(palette, errors.bound) };
    let of_reference = error_tip(session.known_reference(), session.reference_failure());
    let beside = tr("Beside it: a reason to doubt the result, or else the main source of the error");
    let remark: Cow<'_, str> = match (doubt, errors.source) {
        // A large error has a source, whatever else is to be doubted.
        (Some(doubt), Some(source)) if errors.own.is_some_and(is_large) => {
            format!("{} · {doubt}", tr(source.word())).into()
        }
        (Some(doubt), _) if is_without_reference => format!("{} · {doubt}", tr("no reference")).into(),
        (Some(doubt), _) if sought.is_none() => doubt.into(),
        (_, Some(source)) => tr(source.word()).into(),
        (None, None) if is_without_reference => tr("no reference").into(),
        (_, None) => sought.map_or(Cow::default(), |(done, _)| {
            let percent = format!("{:.0}", 100.0 * done);
            fill!("computing the reference: %{percent} %", percent).into()
        }),
    };
    let value = error_text(errors.own, errors.bound, session.live().is_some());
    let tip = format!("{of_reference}\n{beside}");
    let error = BarNumber::new(ui, (ERROR, &value), (&remark, is_doubtful), tip, color);
    let tip = "Computing time of a solve from rest, the median of repeated solves, without the check of stability. Linear \
               theory factors its matrix once for all loads: that time is not in it.";
    let value = if seconds > 0.0 { engineering(two_digits(seconds), "s") } else { UNKNOWN.to_owned() };
    let color = if is_last { palette.secondary } else { palette.text };
    let is_unsolved = solve.is_some_and(|solve| !solve.is_solved);
    let remark = if is_unsolved { tr("not reached from rest") } else { "" };
    let mut entries = vec![error, BarNumber::new(ui, ("TIME", &value), (remark, false), tr(tip), color)];
    if session.scene().solver.method == MethodKind::Warped {
        let tip = "Spectral radius of the warped iteration: each iteration multiplies the error by about ρ; above 1 it \
                   diverges";
        let color = match rho {
            Some(rho) if rho > 1.0 => palette.warning,
            Some(_) => palette.text,
            None => palette.secondary,
        };
        let remark: Cow<'_, str> = match load_text(session.scene()) {
            _ if rho.is_none() => Cow::default(),
            _ if simulation.status().is_success() => tr("per iteration").into(),
            // The equilibrium that is sought is not drawn.
            Some(load) => fill!("at %{load}", load).into(),
            None => tr("at the full load").into(),
        };
        let value = rho.map_or_else(|| UNKNOWN.to_owned(), rho_number);
        entries.push(BarNumber { ratio: rho, ..BarNumber::new(ui, ("ρ", &value), (&remark, false), tr(tip), color) });
    }
    entries
}

fn of_motion(ui: &Ui, session: &Session) -> [BarNumber; 3] {
    let palette = &Palette::new(ui.visuals());
    let cost = session.frame.timings.total().as_secs_f64();
    let step = session.scene().dynamics.time_step;
    let tip = fill!("Computing time of a time step, which simulates %{step}", step = engineering(step, "s"));
    let value = if cost > 0.0 { engineering(two_digits(cost), "s") } else { UNKNOWN.to_owned() };
    let color = if cost > step { palette.error } else { palette.text };
    let cost = BarNumber { ratio: Some(cost / step), ..BarNumber::new(ui, ("STEP", &value), ("", false), tip, color) };
    let clock = &session.playback.clock;
    let (remark, color) = if clock.lags() { (tr("slower than asked"), palette.error) } else { ("", palette.text) };
    let value = match clock.factor {
        Some(factor) => format!("× {}", fraction(factor)),
        None if session.is_running() => UNKNOWN.to_owned(),
        None => tr("paused").to_owned(),
    };
    let tip = "Simulated seconds per second; fewer than requested if the machine cannot keep up";
    let speed = BarNumber::new(ui, ("SPEED", &value), (remark, false), tr(tip), color);
    let drift = drift(session.simulation());
    let color = if drift.is_some_and(|drift| drift.abs() > 0.05) { palette.warning } else { palette.text };
    let value = drift.map_or_else(|| UNKNOWN.to_owned(), drift_text);
    [cost, speed, BarNumber::new(ui, ("DRIFT", &value), ("", false), tr(DRIFT_TIP), color)]
}

/// Returns the text of the current phase of a background solve.
pub(crate) fn phase_text(scene: &Scene, phase: Phase) -> String {
    let body = body_text(scene);
    match phase {
        Phase::Meshing => fill!("Meshing %{body}", body),
        Phase::LinearSolve => fill!("Factorizing %{body}", body),
        Phase::Iterating(0) => fill!("Solving %{body}", body),
        Phase::Iterating(n) => fill!("Solving %{body}, iteration %{n}", body, n),
        Phase::Certifying => fill!("Checking stability of %{body}", body),
    }
}

/// Returns a text such as `500,000 triangles`, or the name of a mesh file.
fn body_text(scene: &Scene) -> String {
    let cell = scene.element().entry().cell;
    match (&scene.beam, &scene.mesh) {
        (Some(beam), _) => {
            let cells = beam.cells.iter().map(|&n| u64::from(n)).product::<u64>();
            // A triangle is half a cell of a beam.
            let pieces = if cell.corners.len() == 3 { 2 } else { 1 };
            filled(&format!("%{{n}} {}s", cell.name), &["n"], &[grouped(pieces * cells)])
        }
        (None, Some(mesh)) => mesh.file.clone(),
        (None, None) => tr("the body").to_owned(),
    }
}

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
