//! Unsaved edits: the question before they are lost, and the offer to restore those left by a crashed window.

use egui::{Context, Event, Id, Key, Modal, RichText};

use crate::app::language::{fill, tr};
use crate::app::platform::{IS_PAGE, files};
use crate::app::session::Edit;
use crate::app::session::document::Document;
use crate::app::session::recovery::Unsaved;
use crate::app::shell::file_dialog::{FileDialog, Purpose};
use crate::app::shell::lab::{Departure, Lab, Question, Request};
use crate::app::shell::messages::banner;
use crate::app::view_options::Mode;
use crate::scene::Scene;

impl Lab {
    /// Returns the edited scene and its document; `None` if there are no unsaved edits.
    pub(crate) fn unsaved(&self) -> Option<(&Document, &Scene)> {
        let desk = self.lesson.as_ref().map_or(&self.desk, |lesson| &lesson.aside);
        desk.session.is_edited().then(|| (desk.session.document(), desk.session.scene()))
    }

    /// Offers to restore the edits left by a crashed window.
    pub fn offer(&mut self, left: Unsaved) {
        self.left = Some(left);
    }

    /// Returns `true` if the window may close now. Otherwise the user is asked about unsaved edits, and
    /// [`Request::Close`] follows unless the answer is "Cancel".
    pub fn request_close(&mut self, ctx: &Context) -> bool {
        if self.unsaved().is_some() && self.lesson.is_some() {
            self.desk.view.mode = Mode::Explore;
            self.enter_or_leave();
        }
        self.depart(ctx, Departure::Close);
        std::mem::take(&mut self.closes)
    }

    /// Returns `true` while a dialog has the keyboard focus.
    pub(crate) fn has_dialog(&self) -> bool {
        self.dialog.is_some() || matches!(self.question, Question::Asked(_))
    }

    /// Opens a scene or closes the window, after a question if edits would be lost. In Learn nothing is lost, because
    /// the user's scene is kept.
    pub(super) fn depart(&mut self, ctx: &Context, departure: Departure) {
        let loses = self.lesson.is_none() && self.unsaved().is_some();
        if !loses {
            return self.go(ctx, departure);
        }
        // The question gets the keys.
        if let Some(focused) = ctx.memory(egui::Memory::focused) {
            ctx.memory_mut(|memory| memory.surrender_focus(focused));
        }
        // The key that opened the question must not answer it.
        ctx.input_mut(|i| i.events.retain(|event| !pressed(event, Key::Enter) && !pressed(event, Key::D)));
        self.question = Question::Asked(departure);
        ctx.request_repaint();
    }

    fn go(&mut self, ctx: &Context, departure: Departure) {
        match departure {
            Departure::Close => self.closes = true,
            Departure::Open(source) => self.open(ctx, source),
            Departure::AskForFile if IS_PAGE => files::choose(),
            Departure::AskForFile => {
                self.dialog = Some(FileDialog::new(Purpose::Open, self.desk.session.document().path(), ""))
            }
        }
        ctx.request_repaint();
    }

    /// Continues with the departure after the scene has been saved, if "Save" was the answer to the question.
    pub(crate) fn after_save(&mut self, ctx: &Context) {
        if let Question::Saving(departure) = std::mem::take(&mut self.question) {
            self.go(ctx, departure);
        }
    }

    /// Shows the question about unsaved edits, if it is due.
    pub(crate) fn ask_to_save(&mut self, ctx: &Context) {
        let Question::Asked(departure) = &self.question else { return };
        let departure = departure.clone();
        let title = fill!("Save the changes to “%{scene}”?", scene = tr(&self.scene().name));
        let (mut save, mut discard, mut cancel) = (false, false, false);
        let modal = Modal::new(Id::unique("unsaved")).show(ctx, |ui| {
            ui.set_width(ui.available_width().min(360.0));
            ui.heading(title);
            ui.add_space(6.0);
            ui.label(tr("Discarded changes are lost."));
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
            // After another scene has been opened, undo restores the discarded edits.
            self.go(ctx, departure);
        } else if save {
            self.question = Question::Saving(departure);
            self.save_here(ctx);
        }
    }

    /// Offers the edits left by a crashed window, until the user answers.
    pub(crate) fn offer_unsaved(&mut self, ctx: &Context, requests: &mut Vec<Request>) {
        // The edits are restored to the user's own scene, which Learn puts aside.
        let Some(left) = self.left.as_ref().filter(|_| self.lesson.is_none()) else { return };
        let text = fill!(
            "Unsaved changes to “%{scene}” were found: warpbeam ended unexpectedly.",
            scene = tr(&left.scene.name)
        );
        let (mut restore, mut discard) = (false, false);
        banner(ctx, "unsaved-changes", |ui| {
            ui.label(text);
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
        requests.push(Request::DiscardCopy);
        ctx.request_repaint();
    }
}

/// Returns `true` if an event is the first press of a key.
fn pressed(event: &Event, wanted: Key) -> bool {
    matches!(event, Event::Key { key, pressed: true, repeat: false, .. } if *key == wanted)
}
