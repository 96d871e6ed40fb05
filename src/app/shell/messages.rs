//! Messages over the view: notices of the session, warnings and offers.

use super::*;
use crate::app::panel::edges;
use crate::app::session::Notice;
use crate::app::shell::files::banner;
use crate::app::viewport::objects;

/// Time for which a message is shown.
const TOAST: Duration = Duration::from_secs(4);

impl Lab {
    /// Shows a message for a while.
    pub fn say(&mut self, ctx: &Context, message: String) {
        self.toast = Some((message, ctx.input(|i| i.time) + TOAST.as_secs_f64()));
    }

    /// Shows the reason for which an edit was refused: beside the field with this label, or over the body.
    pub(super) fn refuse(&mut self, ctx: &Context, label: &'static str, reason: Sentence) {
        // The message of a long list may be out of view.
        if [objects::EDIT, edges::SECTION].contains(&label) {
            self.say(ctx, sentence(&said(&reason)));
        }
        if label != objects::EDIT {
            self.desk.panel.messages.insert(label, reason);
        }
    }

    /// Prints a message, and shows it until the user closes it. Returns `false` if it has been given
    /// before.
    pub fn warn(&mut self, message: String) -> bool {
        let is_new = !self.warnings.contains(&message);
        if is_new {
            eprintln!("warpbeam: {message}");
            self.warnings.push(message);
        }
        is_new
    }

    /// Shows warnings and offers in rows under the toolbar, if there are any.
    pub(super) fn show_banners(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let has_warning = self.warnings.len() > self.closed_warnings;
        if !(has_warning || self.offered().is_some() || self.desk.session.is_outdated) {
            return;
        }
        let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(12, 4));
        Panel::top("banners").resizable(false).frame(frame).show(ui, |ui| {
            if let Some(message) = self.warnings.get(self.closed_warnings) {
                let color = ui.visuals().warn_fg_color;
                let is_closed = banner(ui, RichText::new(message).color(color), &["Close"]).is_some();
                self.closed_warnings += usize::from(is_closed);
            }
            self.offer_changed_file(ui, actions);
            self.offer_unsaved(ui);
        });
    }

    pub(super) fn show_notices(&mut self, ctx: &Context) {
        self.apply_session_changes();
        for Notice { label, message } in std::mem::take(&mut self.desk.session.notices) {
            match label {
                Some(label) => self.refuse(ctx, label, message),
                None => self.say(ctx, said(&message)),
            }
        }
    }

    /// Reports the first self-intersection of the body's outline of a document.
    pub(super) fn report_crossing(&mut self, ui: &Ui) {
        let is_shown =
            self.desk.view.layout.bars && self.aside.is_none() && self.story.is_none() && self.toast.is_none();
        let now = ui.input(|i| i.time);
        let (viewport, content) = self.viewport_and_content();
        if is_shown && viewport.finds_crossing(&content, now) {
            self.say(ui.ctx(), tr("The body passes through itself: contact is not modelled").to_owned());
        }
    }

    /// Paints the message, while it is shown.
    pub(super) fn paint_toast(&mut self, ui: &Ui, painter: &Painter, rect: Rect) {
        let Some((message, until)) = &self.toast else { return };
        let left = until - ui.input(|i| i.time);
        if left <= 0.0 {
            self.toast = None;
            return;
        }
        let (visuals, color) = (ui.visuals(), ui.visuals().strong_text_color());
        let at = rect.center_bottom() - vec2(0.0, if self.desk.session.is_motion() { 48.0 } else { 24.0 });
        Labels::new(painter, visuals).add(at, Align2::CENTER_BOTTOM, message, color, rect.width() - 48.0);
        // For screen readers.
        let place = Rect::from_center_size(rect.center_bottom(), Vec2::ZERO);
        let said = ui.interact(place, Id::unique("toast"), Sense::empty());
        said.widget_info(|| WidgetInfo::labeled(Role::Label, true, message));
        ui.ctx().request_repaint_after(Duration::from_secs_f64(left.clamp(0.0, TOAST.as_secs_f64())));
    }
}
