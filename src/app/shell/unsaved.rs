//! Edits that no file has: the question that is asked before they are lost, and the offer of those that a crashed window
//! has left.

use egui::{Context, Event, Id, Key, Modal, RichText};

use crate::app::language::{fill, tr};
use crate::app::session::Edit;
use crate::app::session::document::Document;
use crate::app::session::recovery::Unsaved;
use crate::app::shell::file_dialog::{FileDialog, Purpose};
use crate::app::shell::lab::{Departure, Lab, Question, Request};
use crate::app::shell::messages::banner;
use crate::app::view_options::Mode;
use crate::scene::Scene;

impl Lab {
    /// The scene with edits that no file has, and where it comes from; `None` where there are none.
    pub(crate) fn unsaved(&self) -> Option<(&Document, &Scene)> {
        let desk = self.lesson.as_ref().map_or(&self.desk, |lesson| &lesson.aside);
        desk.session.is_edited().then(|| (desk.session.document(), desk.session.scene()))
    }

    /// Offers edits that a crashed window has left.
    pub fn offer(&mut self, left: Unsaved) {
        self.left = Some(left);
    }

    /// Returns `true` if the window may close now. Else the user is asked about unsaved edits, and [`Request::Close`] follows
    /// if the answer is not "Cancel".
    pub fn request_close(&mut self, ctx: &Context) -> bool {
        if self.unsaved().is_some() && self.lesson.is_some() {
            self.desk.view.mode = Mode::Explore;
            self.enter_or_leave();
        }
        self.depart(ctx, Departure::Close);
        std::mem::take(&mut self.closes)
    }

    /// `true` while a dialog has the keyboard.
    pub(crate) fn has_dialog(&self) -> bool {
        self.dialog.is_some() || matches!(self.question, Question::Asked(_))
    }

    /// Opens or closes something, after a question if edits would be lost. Learn keeps the scene from before.
    pub(super) fn depart(&mut self, ctx: &Context, departure: Departure) {
        let loses = self.lesson.is_none() && self.unsaved().is_some();
        if !loses {
            return self.go(ctx, departure);
        }
        // Keys belong to the question.
        if let Some(focused) = ctx.memory(egui::Memory::focused) {
            ctx.memory_mut(|memory| memory.surrender_focus(focused));
        }
        // The key that has led here is no answer.
        ctx.input_mut(|i| i.events.retain(|event| !pressed(event, Key::Enter) && !pressed(event, Key::D)));
        self.question = Question::Asked(departure);
        ctx.request_repaint();
    }

    fn go(&mut self, ctx: &Context, departure: Departure) {
        match departure {
            Departure::Close => self.closes = true,
            Departure::Open(source) => self.open(ctx, source),
            Departure::AskForFile => {
                self.dialog = Some(FileDialog::new(Purpose::Open, self.desk.session.document().path(), ""))
            }
        }
        ctx.request_repaint();
    }

    /// Goes on after the scene has been saved where "Save" was the answer.
    pub(crate) fn after_save(&mut self, ctx: &Context) {
        if let Question::Saving(departure) = std::mem::take(&mut self.question) {
            self.go(ctx, departure);
        }
    }

    /// Asks whether to save, where that is to be asked.
    pub(crate) fn ask_to_save(&mut self, ctx: &Context) {
        let Question::Asked(departure) = &self.question else { return };
        let departure = departure.clone();
        let title = fill!("Save the changes to “%{scene}”?", scene = tr(&self.scene().name));
        let (mut save, mut discard, mut cancel) = (false, false, false);
        let modal = Modal::new(Id::unique("unsaved")).show(ctx, |ui| {
            ui.set_width(ui.available_width().min(360.0));
            ui.heading(title);
            ui.add_space(6.0);
            ui.label(tr("They are lost if you discard them."));
            ui.add_space(10.0);
            ui.horizontal(|ui| {
                save = ui.button(RichText::new(tr("Save")).strong()).on_hover_text("Enter").clicked();
                discard = ui.button(tr("Discard")).on_hover_text("D").clicked();
                cancel = ui.button(tr("Cancel")).on_hover_text("Esc").clicked();
            });
        });
        ctx.input(|i| {
            save |= i.events.iter().any(|event| pressed(event, Key::Enter));
            discard |= i.events.iter().any(|event| pressed(event, Key::D));
        });
        if cancel || modal.should_close() {
            self.question = Question::None;
        } else if discard {
            self.question = Question::None;
            // Undo brings them back after another scene has been opened.
            self.go(ctx, departure);
        } else if save {
            self.question = Question::Saving(departure);
            self.save_here(ctx);
        }
    }

    /// Shows the offer of edits that a crashed window has left; the answer ends it.
    pub(crate) fn offer_unsaved(&mut self, ctx: &Context, requests: &mut Vec<Request>) {
        let Some(left) = &self.left else { return };
        let words = fill!(
            "Unsaved changes to “%{scene}” were found: warpbeam ended unexpectedly.",
            scene = tr(&left.scene.name)
        );
        let (mut restore, mut discard) = (false, false);
        banner(ctx, "unsaved-changes", |ui| {
            ui.label(words);
            restore = ui.button(tr("Restore")).clicked();
            discard = ui.button(tr("Discard")).clicked();
        });
        if !(restore || discard) {
            return;
        }
        let Some(Unsaved { document, scene }) = self.left.clone() else { return };
        if restore && !self.apply(ctx, Edit::Restore(Box::new((document, scene)))) {
            return;
        }
        self.left = None;
        requests.push(Request::ForgetCopy);
        ctx.request_repaint();
    }
}

/// `true` if an event is the first press of a key.
fn pressed(event: &Event, wanted: Key) -> bool {
    matches!(event, Event::Key { key, pressed: true, repeat: false, .. } if *key == wanted)
}
