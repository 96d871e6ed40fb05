//! Layout of the window: bars, panel, plots, the body or the compared panes, and everything over them.

use super::*;
use crate::app::diagnosis;
use crate::app::language;
use crate::app::modes::compare::{Compare, CompareInput};
use crate::app::modes::learn;
use crate::app::modes::plots;
use crate::app::panel::{self, PANEL_WIDTH};
use crate::app::shell::{bars, shortcuts};
use crate::app::viewport::time_line;
use crate::app::widgets::palette;

/// In a window narrower than this, points, the panel lies over the body and can be closed.
const NARROW: f32 = 960.0;

/// Time between two polls of the reference that follows a dragged load.
const SOON: Duration = Duration::from_millis(10);

/// Height of the status bar, points.
const STATUS_BAR_HEIGHT: f32 = 42.0;

/// Height of the plots under the body, points, and its largest fraction of the window's height.
const DRAWER_HEIGHT: f32 = 270.0;
/// Height of Measure, points.
const MEASURE_HEIGHT: f32 = 350.0;
const DRAWER_SHARE: f32 = 0.45;

/// Height of the line with the status under the body, points.
const STATUS_LINE: f32 = 34.0;

impl Lab {
    /// Shows the user interface and performs the user's actions. The body itself is drawn by another pass, under the
    /// interface.
    pub fn ui(&mut self, ui: &mut Ui) -> Vec<Request> {
        palette::install(ui.ctx());
        language::speak(self.settings.language);
        let mut actions = Vec::new();
        self.end_story_on_input(ui.ctx());
        let double_click = ui.ctx().options(|options| options.input_options.max_double_click_delay);
        let (now, is_pressed, goes_on) =
            ui.input(|i| (i.time, i.pointer.any_pressed(), i.pointer.any_down() || i.pointer.any_released()));
        self.desk.session.record_press(now, is_pressed, goes_on, double_click);
        self.desk.panel.fade_messages(ui.ctx());
        self.check_files(ui.ctx(), &mut actions);
        self.request_facts(ui.ctx());
        self.desk.measure.budget.poll(ui.ctx());
        self.show_notices(ui.ctx());
        self.desk.view.layout.narrow = ui.ctx().content_rect().width() < NARROW;
        // Enter ends text editing within its frame, and the other keys of that frame belong to the text.
        let was_typing = ui.ctx().text_edit_focused();
        if self.desk.view.layout.bars {
            self.bars(ui, &mut actions);
            self.show_banners(ui, &mut actions);
        }
        if !self.has_dialog() && !was_typing {
            actions.extend(shortcuts::actions(ui.ctx()));
        }
        match self.desk.view.mode {
            Mode::Explore => self.plots(ui, &mut actions),
            Mode::Learn => {
                // Escape closes the panel over the body and the explanation first.
                let view = &self.desk.view;
                let is_covered = view.help || view.why || view.layout.narrow && view.layout.sheet;
                let keys = !self.has_dialog() && !is_covered;
                self.learn.show(ui, &self.desk.session, keys, &mut actions);
            }
            Mode::Compare => {
                let (compare, input) = self.compared();
                compare.bars(ui, &input);
            }
            Mode::Measure => {
                let Desk { session, view, measure, .. } = &mut self.desk;
                drawer_panel(ui, MEASURE_HEIGHT).show(ui, |ui| measure.show(ui, session, view, &mut actions));
            }
        }
        for action in actions {
            self.act(ui.ctx(), action);
        }
        let mut actions = Vec::new();
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| match self.desk.view.mode {
            Mode::Compare => self.comparison(ui, &mut actions),
            _ => self.body_view(ui, &mut actions),
        });
        let view = &self.desk.view;
        if view.layout.bars && view.layout.narrow && view.layout.sheet {
            self.sheet(ui, &mut actions);
        }
        for action in actions {
            self.act(ui.ctx(), action);
        }
        if self.desk.session.follow_edit() {
            self.is_mixed = true;
            ui.ctx().request_repaint();
        }
        shortcuts::show_help(ui.ctx(), &mut self.desk.view.help);
        self.show_question(ui.ctx());
        self.ask_for_file(ui.ctx());
        if self.desk.session.is_working() {
            ui.ctx().request_repaint_after(POLL);
        } else if let Some(story) = &self.story {
            let seconds = if story.is_still { story.left } else { 0.0 };
            ui.ctx().request_repaint_after(Duration::try_from_secs_f64(seconds).unwrap_or_default());
        } else if self.iterates() {
            ui.ctx().request_repaint();
        }
        std::mem::take(&mut self.requests)
    }

    /// Requests the displayed results of the scene.
    fn request_facts(&mut self, ctx: &Context) {
        // Results of a load that changes with every frame would be late.
        if let Some(story) = &self.story {
            if story.compares && self.desk.session.obtain_reference(false) {
                ctx.request_repaint_after(POLL);
            }
            return;
        }
        let is_pressed = ctx.input(|i| i.pointer.any_down());
        let learns_rho = self.learns_rho();
        let Desk { session, view, measure, .. } = &mut self.desk;
        let is_busy = measure.obtain(session, view, is_pressed, false);
        if session.request_facts(learns_rho, is_busy, is_pressed) || is_busy {
            ctx.request_repaint_after(if session.is_following() { SOON } else { POLL });
        }
    }

    /// Shows the toolbar, the status bar, and the panel if the window is wide enough for it.
    fn bars(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let bar = |ui: &Ui| unfilled(ui).inner_margin(Margin::symmetric(12, 0));
        let top = Panel::top("toolbar")
            .exact_size(bars::HEIGHTS[usize::from(self.desk.view.layout.narrow)])
            .resizable(false)
            .frame(bar(ui));
        top.show(ui, |ui| self.toolbar(ui, actions));
        // Compared panes have a status each; a card of Learn in a narrow window leaves no room.
        if self.desk.view.mode != Mode::Compare && !(self.aside.is_some() && self.desk.view.layout.narrow) {
            let bottom = Panel::bottom("headline").exact_size(STATUS_BAR_HEIGHT).resizable(false).frame(bar(ui));
            bottom.show(ui, |ui| bars::show(ui, &self.desk.session, &self.desk.view, actions));
        }
        if self.desk.view.layout.panel && !self.desk.view.layout.narrow {
            let frame = unfilled(ui).inner_margin(Margin { left: 12, right: 8, top: 8, bottom: 4 });
            let panel = Panel::right("panel").exact_size(PANEL_WIDTH).resizable(false).frame(frame);
            panel.show(ui, |ui| self.panel(ui, actions));
        }
    }

    /// Shows the panel over the body in a narrow window.
    fn sheet(&mut self, ui: &Ui, actions: &mut Vec<Action>) {
        let rect = self.view_rect();
        let width = PANEL_WIDTH.min(rect.width());
        egui::Area::new(Id::unique("sheet"))
            .order(egui::Order::Foreground)
            .fixed_pos(rect.right_top() - vec2(width, 0.0))
            .constrain(false)
            .show(ui.ctx(), |ui| {
                let palette = Palette::new(ui.visuals());
                let margin = Margin { left: 12, right: 8, top: 8, bottom: 4 };
                let frame = Frame::new().fill(palette.panel).inner_margin(margin);
                frame.stroke(Stroke::new(1.0, palette.line)).show(ui, |ui| {
                    ui.set_width((width - 22.0).max(0.0));
                    ui.set_height((rect.height() - 14.0).max(0.0));
                    self.panel(ui, actions);
                });
            });
        if ui.input(|i| i.key_pressed(Key::Escape)) && !ui.ctx().text_edit_focused() {
            self.desk.view.layout.sheet = false;
        }
    }

    fn panel(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let Desk { session, viewport, view, panel: state, compare, .. } = &mut self.desk;
        let (scene, values) = (session.scene(), viewport.view.body.value_range());
        // The body that the panel describes may be in no pane.
        let is_in_pane = || compare.panes.iter().any(|pane| pane.setting.apply(scene) == *scene);
        let is_drawn = view.mode != Mode::Compare || !session.is_motion() && is_in_pane();
        panel::show(ui, &mut panel::Panel { session, scene, values, state, view, actions }, is_drawn);
    }

    /// Shows the plots under the body, if they are open.
    fn plots(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let Some(drawer) = self.desk.view.drawer else { return };
        let Desk { session, view, sections, .. } = &mut self.desk;
        drawer_panel(ui, DRAWER_HEIGHT).show(ui, |ui| match drawer {
            Drawer::Section => sections.show(ui, session, actions),
            Drawer::Motion => plots::show_motion(ui, &mut view.motion_plot, session),
        });
    }

    /// Shows the compared panes in place of the body.
    fn comparison(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let rect = ui.available_rect_before_wrap();
        self.desk.viewport.view.rect = rect;
        // The reference solution does not depend on the iteration of the panel's own setting.
        let is_wanted = !self.desk.session.is_motion() && !ui.input(|i| i.pointer.any_down());
        if is_wanted && !self.desk.compare.goes_on() && self.desk.session.obtain_reference(false) {
            ui.ctx().request_repaint_after(POLL);
        }
        let (compare, input) = self.compared();
        let interaction = compare.show(ui, &input);
        self.edit_loads(ui.ctx(), &interaction);
        if self.desk.compare.is_moved() {
            fit_button(ui, rect, actions);
        }
        let painter = ui.painter_at(rect);
        self.show_work(ui, rect, actions);
        self.paint_toast(ui, &painter, rect);
    }

    fn compared(&mut self) -> (&mut Compare, CompareInput<'_>) {
        let Desk { session, viewport, view, panel, measure, compare, .. } = &mut self.desk;
        let live = session.live().filter(|_| !session.is_motion());
        let input = CompareInput {
            session,
            scene: session.scene(),
            view,
            direction: panel.force_direction(),
            eases: viewport.eases,
            reference: session.facts.reference.get(session.scene()).or(live.map(|live| &live.reference)),
            live,
            chosen: measure.budget.chosen(session.scene()),
        };
        (compare, input)
    }

    fn body_view(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        if self.desk.view.layout.bars {
            self.status_line(ui, actions);
            if self.desk.view.why {
                self.explanation(ui);
            }
        }
        let (viewport, content) = self.viewport_and_content();
        let (response, interaction) = viewport.interact(ui, &content);
        let rect = viewport.view.rect;
        actions.extend(viewport.show_menu(&response, &content).or(viewport.drop_base(&interaction, &content)));
        self.desk.session.grab(interaction.grab);
        self.edit_loads(ui.ctx(), &interaction);
        let (viewport, content) = self.viewport_and_content();
        viewport.update(ui.visuals(), &content);
        if self.aside.is_some() && self.learn.is_apart() {
            let Desk { session, viewport, .. } = &mut self.desk;
            viewport.view.body.displace(|points| self.learn.place(session.drawn(), &session.model.geometry, points));
        }
        let (viewport, content) = self.viewport_and_content();
        viewport.take(&interaction, &response, &content);
        self.aim_story();
        let (viewport, content) = self.viewport_and_content();
        viewport.fit_camera(ui, &content);
        let painter = ui.painter_at(rect);
        let session = &self.desk.session;
        // Without bars, the note has the status of a motion that has stopped.
        let stopped =
            || Some(diagnosis::status_text(session)).filter(|(_, is_bad)| *is_bad && !self.desk.view.layout.bars);
        let label = diagnosis::state_text(session).or_else(|| Some(stopped()?.0));
        let visuals = ui.visuals();
        self.desk.viewport.paint(&painter, visuals, &self.content(), label.as_deref());
        if let Some(label) = label {
            response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &label));
        }
        if self.desk.view.layout.bars && self.desk.session.is_motion() && self.aside.is_none() {
            let Desk { session, viewport, .. } = &self.desk;
            let now = session.simulation().state().time();
            time_line::show(ui, rect, &viewport.camera.shown, (&session.playback, now), actions);
        }
        if self.aside.is_some() {
            let Desk { session, viewport, .. } = &self.desk;
            let view = learn::CardView {
                simulation: session.drawn(),
                body: &viewport.view.body,
                projection: viewport.projection(),
            };
            if let (true, Some(at)) = (response.clicked(), response.interact_pointer_pos()) {
                self.learn.pick(&view, at);
            }
            self.learn.paint(&painter, &view);
        }
        let (viewport, content) = self.viewport_and_content();
        actions.extend(viewport.show_values(ui, &painter, &content));
        self.paint_story(ui, &painter, rect);
        if self.desk.view.layout.bars {
            self.show_work(ui, rect, actions);
        }
        if self.desk.viewport.misses_body() {
            fit_button(ui, rect, actions);
        }
        self.report_crossing(ui);
        self.paint_toast(ui, &painter, rect);
    }

    /// Explains the status in lines under the body.
    fn explanation(&self, ui: &mut Ui) {
        let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(14, 6));
        let highest = DRAWER_SHARE * ui.available_height();
        Panel::bottom("explanation").resizable(false).frame(frame).show(ui, |ui| {
            ScrollArea::vertical().max_height(highest).auto_shrink([false, true]).show(ui, |ui| {
                for line in diagnosis::explanation(&self.desk.session) {
                    ui.add(Label::new(spaced(line.into(), palette::BODY)).wrap());
                }
            });
        });
    }

    /// Shows the status in a line under the body, with a remedy.
    fn status_line(&self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let session = &self.desk.session;
        let palette = Palette::new(ui.visuals());
        // The other modes have remedies of their own, and the story goes on by itself.
        let offers = matches!(self.desk.view.mode, Mode::Explore | Mode::Measure) && self.story.is_none();
        let remedy = diagnosis::remedy(session, &diagnosis::errors(session)).filter(|_| offers);
        let (status, bad) = diagnosis::summary(session, remedy.as_ref());
        let color = if bad { palette.error } else { palette.text };
        let frame = Frame::new().inner_margin(Margin::symmetric(14, 2));
        Panel::bottom("status line").exact_size(STATUS_LINE).resizable(false).frame(frame).show(ui, |ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.link(tr("explain")).clicked() {
                    actions.push(Action::Toggle(Toggle::Why));
                }
                if let Some(remedy) = &remedy
                    && ui.button(&remedy.offer).on_hover_text(&remedy.text).clicked()
                {
                    actions.push(remedy.action.clone());
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    // The remedy of a failure says what has failed.
                    let status = Some((status, color)).filter(|_| remedy.is_none() || !session.has_failed());
                    let reason = remedy
                        .map(|remedy| (remedy.text, if session.has_failed() { palette.error } else { palette.large }));
                    for (text, color) in reason.into_iter().chain(status) {
                        ui.add(Label::new(RichText::new(text).color(color)).truncate());
                    }
                });
            });
        });
    }

    /// Shows the progress of the background solve, with a button that cancels it.
    fn show_work(&self, ui: &Ui, rect: Rect, actions: &mut Vec<Action>) {
        let Some((scene, phase, seconds)) = self.desk.session.work() else { return };
        let palette = Palette::new(ui.visuals());
        let area = egui::Area::new(Id::unique("work"))
            .order(egui::Order::Middle)
            .fixed_pos(rect.left_top() + vec2(14.0, 52.0))
            .constrain_to(rect);
        area.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.horizontal(|ui| {
                    // The button comes first, so that it stays under the pointer while the text changes.
                    if ui.button(tr("Cancel")).on_hover_text(tr("Return to the previous state (Esc)")).clicked() {
                        actions.push(Action::Cancel);
                    }
                    let text = format!("{}\u{2026} {seconds} s", bars::phase_text(scene, phase));
                    ui.colored_label(palette.text, text);
                });
            });
        });
    }
}

/// Shows the button that fits the camera, at the lower end of a view.
fn fit_button(ui: &mut Ui, rect: Rect, actions: &mut Vec<Action>) {
    let place = Rect::from_center_size(rect.center_bottom() - vec2(0.0, 64.0), vec2(120.0, 24.0));
    if ui.put(place, Button::new(tr("Fit"))).on_hover_text(tr("Show the whole body (F)")).clicked() {
        actions.push(Action::Fit);
    }
}

/// Returns the panel for the plots under the body.
fn drawer_panel(ui: &Ui, height: f32) -> Panel {
    let height = height.min(DRAWER_SHARE * ui.ctx().content_rect().height());
    Panel::bottom("drawer").exact_size(height).resizable(false).frame(unfilled(ui))
}

/// Returns a panel's frame without background, which the body's render pass has filled.
fn unfilled(ui: &Ui) -> Frame {
    Frame::side_top_panel(ui.style()).fill(Color32::TRANSPARENT)
}
