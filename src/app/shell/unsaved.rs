//! Question before unsaved edits are lost, and the offer to restore the edits left by a crashed window.

use std::path::Path;

use crate::app::platform::{IS_PAGE, files};
use crate::app::prelude::*;
use crate::app::session::Edit;
use crate::app::session::document::Document;
use crate::app::session::recovery::Unsaved;
use crate::app::shell::file_dialog::{FileDialog, Purpose};
use crate::app::shell::lab::{Lab, Question, Request, UnsavedDeparture};

impl Lab {
    /// Returns the edited scene and its document; `None` if there are no unsaved edits.
    pub(crate) fn unsaved(&self) -> Option<(&Document, &Scene)> {
        let desk = self.own_desk()?;
        desk.session.is_edited().then(|| (desk.session.document(), desk.session.scene()))
    }

    /// Offers to restore the edits left by a crashed window.
    pub fn offer(&mut self, left: Unsaved) {
        self.left = Some(left);
    }

    /// Returns `true` while edits of an earlier window wait for an answer.
    pub(crate) fn offers_unsaved(&self) -> bool {
        self.left.is_some()
    }

    /// Returns `true` if the window may close now. Otherwise the user is asked about unsaved edits,
    /// and [`Request::Close`] follows unless the answer is "Cancel".
    pub fn request_close(&mut self, ctx: &Context) -> bool {
        self.end_story();
        if self.unsaved().is_some() && self.lesson.is_some() {
            self.desk.view.mode = Mode::Explore;
            self.enter_or_leave();
        }
        self.depart(ctx, UnsavedDeparture::Close);
        self.requests.pop_if(|request| *request == Request::Close).is_some()
    }

    /// Returns `true` while a dialog has the keyboard focus.
    pub(crate) fn has_dialog(&self) -> bool {
        self.dialog.is_some() || matches!(self.question, Question::Unsaved(_))
    }

    /// Opens a scene or closes the window, after a question if edits would be lost. Undo restores those of a scene that has
    /// no file when another one is opened, and in Learn the user's scene is kept.
    pub(super) fn depart(&mut self, ctx: &Context, departure: UnsavedDeparture) {
        let closes = matches!(departure, UnsavedDeparture::Close);
        let is_lost = |(document, _): (&Document, _)| closes || document.path().is_some();
        let loses = self.lesson.is_none() && self.unsaved().is_some_and(is_lost);
        if loses { self.ask(ctx, Question::Unsaved(departure)) } else { self.go(ctx, departure) }
    }

    pub(super) fn ask(&mut self, ctx: &Context, question: Question) {
        // The question gets the keys.
        if let Some(focused) = ctx.memory(egui::Memory::focused) {
            ctx.memory_mut(|memory| memory.surrender_focus(focused));
        }
        // The key that opened the question must not answer it.
        ctx.input_mut(|i| i.events.retain(|event| !matches!(event, Event::Key { pressed: true, .. })));
        self.question = question;
        ctx.request_repaint();
    }

    fn go(&mut self, ctx: &Context, departure: UnsavedDeparture) {
        match departure {
            UnsavedDeparture::Close => self.requests.push(Request::Close),
            UnsavedDeparture::Open(source) => self.open(ctx, source),
            UnsavedDeparture::New(scene) => {
                _ = self.apply(
                    ctx,
                    Edit::Restore(Box::new(Unsaved { document: Document::unnamed(&scene), scene: *scene })),
                );
            }
            UnsavedDeparture::AskForFile if IS_PAGE => files::choose(),
            UnsavedDeparture::AskForFile => {
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

    /// Shows the question, if there is one, and processes its answer.
    pub(crate) fn show_question(&mut self, ctx: &Context) {
        let departure = match std::mem::take(&mut self.question) {
            Question::Unsaved(departure) => departure,
            other => return self.question = other,
        };
        let file = self.desk.session.document().path().and_then(Path::file_name);
        let name = file.map_or_else(|| tr(&self.scene().name).to_owned(), |file| file.to_string_lossy().into_owned());
        let title = fill!("Save the changes to “%{scene}”?", scene = name);
        let text = match departure {
            UnsavedDeparture::Close => "Discarded changes are lost.",
            UnsavedDeparture::Open(_) | UnsavedDeparture::New(_) | UnsavedDeparture::AskForFile => {
                "Undo restores discarded changes."
            }
        };
        match dialog(ctx, &title, tr(text)) {
            None => self.question = Question::Unsaved(departure),
            Some("Save") => {
                self.question = Question::Saving(departure);
                self.save_here(ctx);
            }
            Some("Discard") => self.go(ctx, departure),
            Some(_) => {}
        }
    }

    /// Returns the edits that are offered now: they are restored to the user's own scene, which Learn puts aside.
    pub(super) fn offered(&self) -> Option<&Unsaved> {
        self.left.as_ref().filter(|_| self.lesson.is_none())
    }

    /// Offers the edits left by a crashed window, until the user answers.
    pub(super) fn offer_unsaved(&mut self, ui: &mut Ui) {
        let Some(left) = self.offered() else { return };
        let text = fill!("Unsaved changes to “%{scene}” were found.", scene = tr(&left.scene.name));
        let (mut restore, mut discard) = (false, false);
        ui.horizontal_wrapped(|ui| {
            ui.label(text);
            restore = ui.button(tr("Restore")).clicked();
            discard = ui.button(tr("Discard")).clicked();
        });
        if !(restore || discard) {
            return;
        }
        let Some(left) = self.left.clone() else { return };
        if restore && !self.apply(ui.ctx(), Edit::Restore(Box::new(left))) {
            return;
        }
        self.left = None;
        self.requests.push(Request::DiscardCopy);
        ui.ctx().request_repaint();
    }
}

/// Shows a question; returns the answer.
fn dialog(ctx: &Context, title: &str, text: &str) -> Option<&'static str> {
    const ANSWERS: [(&str, Key); 3] = [("Save", Key::Enter), ("Discard", Key::D), ("Cancel", Key::Escape)];
    let mut answer = None;
    let modal = Modal::new(Id::unique("question")).show(ctx, |ui| {
        ui.set_width(ui.available_width().min(360.0));
        ui.heading(title);
        ui.add_space(6.0);
        ui.label(text);
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            for (i, (label, key)) in ANSWERS.into_iter().enumerate() {
                let text = RichText::new(tr(label));
                let button = ui.button(if i == 0 { text.strong() } else { text }).on_hover_text(key.name());
                let is_pressed = |event: &Event| {
                    matches!(event, Event::Key { key: own, pressed: true, repeat: false, .. } if *own == key)
                };
                if button.clicked() || ui.input(|i| i.events.iter().any(is_pressed)) {
                    answer = Some(label);
                }
            }
        });
    });
    answer.or_else(|| modal.should_close().then_some("Cancel"))
}
