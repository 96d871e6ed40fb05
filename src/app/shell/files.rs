//! Files: opening, saving, dropping, changes on disk, and copies of the scene to the clipboard.

use std::path::Path;

use crate::app::platform::{IS_PAGE, files, page};
use crate::app::prelude::*;
use crate::app::session::Edit;
use crate::app::shell::file_dialog::{Answer, FileDialog, Purpose};
use crate::app::shell::lab::{Lab, Question};
use crate::sentence::Sentence;

impl Lab {
    /// Opens a scene in place of the current one, and shows a message if that fails.
    pub(super) fn open(&mut self, ctx: &egui::Context, source: Source) {
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

    /// Saves the scene to a file, and shows a message of success.
    ///
    /// # Errors
    /// Reason for which it was not saved; no message is shown.
    fn save(&mut self, ctx: &egui::Context, path: &Path) -> Result<(), Sentence> {
        self.desk.session.save(path)?;
        self.settings.add_recent(path);
        self.say(ctx, fill!("Saved %{file}", file = path.display()));
        Ok(())
    }

    /// Saves the scene to its file. If it has none, or another program has changed it, shows the file dialog.
    pub(super) fn save_here(&mut self, ctx: &egui::Context) {
        let document = self.desk.session.document();
        let has_changed = document.has_changed();
        match document.path().map(Path::to_owned) {
            Some(path) if !has_changed => self.save_there(ctx, &path),
            path => {
                self.ask_where_to_save(ctx);
                if let (Some(path), Some(dialog)) = (path, &mut self.dialog) {
                    dialog.refuse(fill!("%{file} has changed on disk.", file = path.display()));
                    self.desk.session.check_file();
                }
            }
        }
    }

    /// Saves the scene to a file, and shows a message.
    fn save_there(&mut self, ctx: &egui::Context, path: &Path) {
        match self.save(ctx, path) {
            Ok(()) => self.after_save(ctx),
            Err(reason) => {
                self.question = Question::None;
                self.say(ctx, fill!("Not saved: %{reason}", reason = said(&reason)));
            }
        }
    }

    /// Shows the dialog for the name of the file. A web page downloads the scene instead.
    pub(super) fn ask_where_to_save(&mut self, ctx: &egui::Context) {
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
            return self.save_there(ctx, Path::new(&name));
        }
        self.dialog = Some(FileDialog::new(Purpose::Save, document.path(), &name));
    }

    /// Shows the file dialog, and processes its answer.
    pub(super) fn ask_for_file(&mut self, ctx: &egui::Context) {
        let Some(mut dialog) = self.dialog.take() else { return };
        let Some(answer) = dialog.show(ctx, self.settings.recent()) else {
            self.dialog = Some(dialog);
            return;
        };
        let refusal = match answer {
            Answer::Cancel => {
                self.question = Question::None;
                None
            }
            Answer::File(path) if dialog.purpose == Purpose::Open => {
                let source = Source { name: path, assignments: Vec::new() };
                self.try_open(source).err().map(|error| said(&error))
            }
            Answer::File(path) => match self.save(ctx, &path) {
                Ok(()) => {
                    self.after_save(ctx);
                    None
                }
                Err(reason) => Some(said(&reason)),
            },
        };
        if let Some(refusal) = refusal {
            dialog.refuse(refusal);
            self.dialog = Some(dialog);
        }
        if self.dialog.is_none() {
            ctx.request_repaint();
        }
    }

    /// Opens a file that is dropped on the window. When the window gets the focus, checks whether the scene's file has
    /// changed on disk.
    pub(super) fn check_files(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let (dropped, is_back) = ctx.input(|i| {
            let dropped = i.raw.dropped_files.last().map(|file| file.path().to_owned());
            (dropped.or_else(files::arrived), i.events.contains(&egui::Event::WindowFocused(true)))
        });
        actions.extend(dropped.map(Action::Open));
        if is_back {
            self.desk.session.check_file();
        }
    }

    /// Offers to read the scene's file again if it has changed on disk.
    pub(super) fn offer_changed_file(&mut self, ui: &mut egui::Ui, actions: &mut Vec<Action>) {
        let session = &mut self.desk.session;
        if !session.is_outdated() {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            let file = session.document().source.name.display();
            ui.label(fill!("%{file} has changed on disk.", file));
            if ui.button(tr("Reload")).clicked() {
                actions.push(Action::Reload);
            }
            if ui.button(tr("Keep this one")).clicked() {
                session.ignore_file_change();
            }
        });
    }

    /// Copies the scene as TOML, or the address of the web page with the scene in it.
    pub(super) fn copy(&mut self, ctx: &egui::Context, as_link: bool) {
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
}
