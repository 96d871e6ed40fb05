//! Files: opening, saving, dropping, changes on disk, copies of the scene to the clipboard, the question before unsaved
//! edits are lost, and the offer to restore the edits left by a crashed window.

use super::*;
use crate::app::platform::{IS_PAGE, files, page};
use crate::app::session::document::Document;
use crate::app::session::recovery::Unsaved;
use crate::app::session::{Edit, UndoHistory};
use crate::app::shell::file_dialog::FileDialog;
use crate::scene::STANDARD_INPUT;

impl Lab {
    /// Opens a scene in place of the current one, and shows a message if that fails.
    pub(super) fn open(&mut self, ctx: &Context, source: Source) {
        if let Err(error) = self.try_open(source) {
            self.say(ctx, said(&error));
        }
    }

    fn try_open(&mut self, source: Source) -> Result<(), Sentence> {
        let opened = self.desk.session.apply(Edit::Open(source));
        self.apply_session_changes();
        opened?;
        if let Some(path) = self.desk.session.document().path() {
            self.settings.add_recent(path);
        }
        Ok(())
    }

    /// Saves the scene to a file, shows a message of success, and goes on with the action `then`. Returns the reason for
    /// which it was not saved, without a message.
    fn save(&mut self, ctx: &Context, path: &Path, then: Option<Action>) -> Result<(), Sentence> {
        self.desk.session.save(path)?;
        self.settings.add_recent(path);
        self.say(ctx, fill!("Saved %{file}", file = path.display()));
        then.into_iter().for_each(|departure| self.go(ctx, departure));
        Ok(())
    }

    /// Saves the scene to its file, and goes on with the action `then`. If it has none, or another program has changed it,
    /// shows the file dialog.
    pub(super) fn save_here(&mut self, ctx: &Context, then: Option<Action>) {
        let document = self.desk.session.document();
        let has_changed = document.has_changed();
        match document.path().map(Path::to_owned) {
            Some(path) if !has_changed => self.save_there(ctx, &path, then),
            path => {
                self.ask_where_to_save(ctx, then);
                if let (Some(path), Some(dialog)) = (path, &mut self.dialog) {
                    dialog.refuse(fill!("%{file} has changed on disk.", file = path.display()));
                    self.desk.session.check_file();
                }
            }
        }
    }

    /// Saves the scene to a file, and shows a message.
    fn save_there(&mut self, ctx: &Context, path: &Path, then: Option<Action>) {
        if let Err(reason) = self.save(ctx, path, then) {
            self.say(ctx, fill!("Not saved: %{reason}", reason = said(&reason)));
        }
    }

    /// Shows the dialog for the name of the file, and goes on with the action `then`. A web page downloads the scene instead.
    pub(super) fn ask_where_to_save(&mut self, ctx: &Context, then: Option<Action>) {
        let document = self.desk.session.document();
        let name = document.path().and_then(Path::file_name).and_then(|name| name.to_str());
        let name = name.map_or_else(|| format!("{}.toml", document.source.name.display()), str::to_owned);
        let own = self.scene().name.to_lowercase();
        let words: Vec<&str> = own.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
        let name = match name == "-.toml" {
            true if words.is_empty() => "scene.toml".to_owned(),
            true => format!("{}.toml", words.join("-")),
            false => name,
        };
        if IS_PAGE {
            return self.save_there(ctx, Path::new(&name), then);
        }
        self.dialog = Some(FileDialog::new(true, then, document.path(), &name));
    }

    /// Shows the file dialog, and processes its answer.
    pub(super) fn ask_for_file(&mut self, ctx: &Context) {
        let Some(mut dialog) = self.dialog.take() else { return };
        let Some(answer) = dialog.show(ctx, &self.settings.recent) else {
            self.dialog = Some(dialog);
            return;
        };
        let done = match answer {
            None => Ok(()),
            Some(path) if !dialog.saves => self.try_open(Source { name: path, assignments: Vec::new() }),
            Some(path) => self.save(ctx, &path, dialog.then.clone()),
        };
        match done {
            Ok(()) => ctx.request_repaint(),
            Err(reason) => {
                dialog.refuse(said(&reason));
                self.dialog = Some(dialog);
            }
        }
    }

    /// Opens a file that is dropped on the window. When the window gets the focus, checks whether the scene's file has
    /// changed on disk.
    pub(super) fn check_files(&mut self, ctx: &Context, actions: &mut Vec<Action>) {
        let (dropped, is_back) = ctx.input(|i| {
            let dropped = i.raw.dropped_files.last().map(|file| file.path().to_owned());
            (dropped.or_else(files::arrived), i.events.contains(&Event::WindowFocused(true)))
        });
        actions.extend(dropped.map(Action::Open));
        if is_back {
            self.desk.session.check_file();
        }
    }

    /// Offers to read the scene's file again if it has changed on disk.
    pub(super) fn offer_changed_file(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let session = &mut self.desk.session;
        if !session.is_outdated {
            return;
        }
        let text = fill!("%{file} has changed on disk.", file = session.document().source.name.display());
        match banner(ui, text.into(), &["Reload", "Keep this one"]) {
            Some("Reload") => actions.push(Action::Reload),
            Some(_) => session.ignore_file_change(),
            None => {}
        }
    }

    /// Copies the scene as TOML, or the address of the web page with the scene in it.
    pub(super) fn copy(&mut self, ctx: &Context, as_link: bool) {
        let scene = self.scene();
        let has_file = scene.mesh.as_ref().is_some_and(|mesh| registry::mesh(&mesh.file).is_none());
        let message = match scene.to_toml() {
            _ if as_link && has_file => tr("A link has no room for a mesh file; save the scene instead").to_owned(),
            Err(error) => fill!("The scene could not be written as TOML: %{error}", error),
            Ok(toml) if as_link => {
                ctx.copy_text(page::link(&toml));
                tr("Link copied").to_owned()
            }
            Ok(toml) => {
                ctx.copy_text(format!("# Save as scene.toml, then: warpbeam solve scene.toml\n{toml}"));
                tr("Scene copied as TOML").to_owned()
            }
        };
        self.say(ctx, message);
    }

    /// Returns the edited scene and its document; `None` if there are no unsaved edits.
    pub(crate) fn unsaved(&self) -> Option<&Unsaved> {
        self.own_desk()?.session.unsaved()
    }

    /// Returns `true` if the window may close now. Otherwise the user is asked about unsaved edits,
    /// and [`Request::Close`] follows unless the answer is "Cancel".
    pub fn request_close(&mut self, ctx: &Context) -> bool {
        self.end_story();
        if self.unsaved().is_some() && self.aside.is_some() {
            self.desk.view.mode = Mode::Explore;
            self.enter_or_leave();
        }
        self.depart(ctx, Action::Close);
        self.requests.pop_if(|request| *request == Request::Close).is_some()
    }

    /// Returns `true` while a dialog has the keyboard focus.
    pub(crate) fn has_dialog(&self) -> bool {
        self.dialog.is_some() || self.question.is_some()
    }

    /// Opens a scene or closes the window, after a question if edits would be lost. Those of a built-in scene are kept when
    /// another one is opened, and in Learn the user's scene is kept.
    pub(super) fn depart(&mut self, ctx: &Context, departure: Action) {
        let closes = departure == Action::Close;
        let is_lost = |edits: &Unsaved| closes || edits.document.source.built_in().is_none();
        let loses = self.aside.is_none() && self.unsaved().is_some_and(is_lost);
        if !loses {
            return self.go(ctx, departure);
        }
        // The question gets the keys.
        if let Some(focused) = ctx.memory(egui::Memory::focused) {
            ctx.memory_mut(|memory| memory.surrender_focus(focused));
        }
        // The key that opened the question must not answer it.
        ctx.input_mut(|i| i.events.retain(|event| !matches!(event, Event::Key { pressed: true, .. })));
        self.question = Some(departure);
        ctx.request_repaint();
    }

    fn go(&mut self, ctx: &Context, departure: Action) {
        match departure {
            Action::Open(name) => self.open(ctx, Source { name, assignments: Vec::new() }),
            Action::New(scene) => {
                // The scene is not in a file yet.
                let source = Source { name: STANDARD_INPUT.into(), assignments: Vec::new() };
                let document = Document::with_text(source, (*scene).clone(), Some("".into()));
                _ = self.apply(ctx, Edit::Restore(Box::new(Unsaved { document, scene: *scene })));
            }
            Action::OpenFile if IS_PAGE => files::choose(),
            Action::OpenFile => {
                self.dialog = Some(FileDialog::new(false, None, self.desk.session.document().path(), ""))
            }
            _ => self.requests.push(Request::Close),
        }
        ctx.request_repaint();
    }

    /// Shows the question, if there is one, and processes its answer.
    pub(crate) fn show_question(&mut self, ctx: &Context) {
        let Some(departure) = self.question.take() else { return };
        let file = self.desk.session.document().path().and_then(Path::file_name);
        let name = file.map_or_else(|| tr(&self.scene().name).to_owned(), |file| file.to_string_lossy().into_owned());
        let title = fill!("Save the changes to “%{scene}”?", scene = name);
        let text = match departure {
            Action::Close => "Discarded changes are lost.",
            _ => "Undo restores discarded changes.",
        };
        match dialog(ctx, &title, tr(text)) {
            None => self.question = Some(departure),
            Some("Save") => self.save_here(ctx, Some(departure)),
            Some("Discard") => self.go(ctx, departure),
            Some(_) => {}
        }
    }

    /// Returns the edits that are offered now: they are restored to the user's own scene, which Learn puts aside.
    pub(super) fn offered(&self) -> Option<&Unsaved> {
        self.left.as_ref().filter(|_| self.aside.is_none())
    }

    /// Offers the edits left by a crashed window, until the user answers.
    pub(super) fn offer_unsaved(&mut self, ui: &mut Ui) {
        let Some(left) = self.offered() else { return };
        let text = fill!("Unsaved changes to “%{scene}” were found.", scene = tr(&left.scene.name));
        let Some(answer) = banner(ui, text.into(), &["Restore", "Discard"]) else { return };
        if answer == "Restore" {
            let (loses, edit) = (self.desk.session.is_edited(), Edit::Restore(Box::new(left.clone())));
            if !self.apply(ui.ctx(), edit) {
                return;
            }
            if !loses {
                // An undo would go from the restored work, whose copy is removed, to a scene without edits.
                self.desk.session.undo = UndoHistory::default();
            }
        }
        self.left = None;
        self.requests.push(Request::DiscardCopy);
        ui.ctx().request_repaint();
    }
}

/// Shows a text in a row, with answers; returns the one that was clicked.
pub(super) fn banner(ui: &mut Ui, text: RichText, answers: &[&'static str]) -> Option<&'static str> {
    let mut clicked = None;
    ui.horizontal_wrapped(|ui| {
        ui.label(text);
        for answer in answers {
            if ui.button(tr(answer)).clicked() {
                clicked = Some(*answer);
            }
        }
    });
    clicked
}

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
