//! Dialog for a scene file: a path to type, the files of its folder to click, and recent files.

use crate::app::interface::*;

/// Largest number of recent files that are offered.
const RECENT: usize = 4;

#[derive(Default)]
pub(crate) struct FileDialog {
    /// `true` if the scene is saved to the chosen file, which is opened otherwise.
    pub saves: bool,
    /// Action that waits until the scene has been saved.
    pub then: Option<Action>,
    folder: PathBuf,
    text: String,
    /// Folders and scene files in the folder, each with `true` for a file.
    entries: Vec<(bool, String)>,
    message: Option<String>,
    /// Existing file that is replaced if the user confirms.
    replaced: Option<PathBuf>,
    is_new: bool,
}

impl FileDialog {
    /// Creates a dialog that starts in the folder of `near`; the action `then` waits for it.
    pub(crate) fn new(saves: bool, then: Option<Action>, near: Option<&Path>, name: &str) -> Self {
        let folder = near.and_then(Path::parent).filter(|folder| folder.is_dir());
        let folder = std::path::absolute(folder.unwrap_or(Path::new("."))).unwrap_or_default();
        let mut dialog = Self { saves, then, text: name.to_owned(), is_new: true, ..Self::default() };
        dialog.enter(folder);
        dialog
    }

    /// Lists the files of a folder.
    fn enter(&mut self, folder: PathBuf) {
        self.entries.clear();
        match std::fs::read_dir(&folder) {
            Ok(entries) => {
                self.entries.extend(entries.flatten().filter_map(|entry| {
                    let name = entry.file_name().into_string().ok().filter(|name| !name.starts_with('.'))?;
                    let is_file = !entry.path().is_dir();
                    let is_listed = !is_file || entry.path().extension().is_some_and(|e| e == "toml");
                    is_listed.then_some((is_file, name))
                }));
                self.entries.sort();
                (self.message, self.folder) = (None, folder);
            }
            Err(error) => self.message = Some(format!("{}: {error}", folder.display())),
        }
    }

    /// Shows an error message; the dialog stays open, with the cursor in its text.
    pub(crate) fn refuse(&mut self, message: String) {
        (self.message, self.is_new) = (Some(message), true);
    }

    /// Accepts the typed path: enters a folder, or returns a file as the answer.
    fn accept(&mut self) -> Option<PathBuf> {
        let typed = self.text.trim();
        if typed.is_empty() {
            self.refuse(tr("expected the name of a scene file").to_owned());
            return None;
        }
        let mut path = self.folder.join(typed);
        if path.is_dir() {
            self.text.clear();
            self.enter(path);
            return None;
        }
        if path.extension().is_none() && !path.exists() {
            path.set_extension("toml");
        }
        if !self.saves && !path.exists() {
            self.refuse(fill!("There is no file %{file}", file = path.display()));
            return None;
        }
        if self.saves && path.exists() && self.replaced.as_ref() != Some(&path) {
            self.message = Some(fill!("%{file} exists: Replace overwrites it", file = path.display()));
            self.replaced = Some(path);
            return None;
        }
        Some(path)
    }

    /// Shows the dialog; returns the answer when there is one: the chosen file, or `None` if the user cancels.
    pub(crate) fn show(&mut self, ctx: &Context, recent: &[PathBuf]) -> Option<Option<PathBuf>> {
        let (title, verb) = match (self.saves, self.replaced.is_some()) {
            (false, _) => ("Open a scene", "Open"),
            (true, is_replaced) => ("Save the scene", if is_replaced { "Replace" } else { "Save" }),
        };
        let mut answer = None;
        let mut chosen: Option<PathBuf> = None;
        let modal = Modal::new(Id::unique("file dialog")).show(ctx, |ui| {
            ui.set_width(ui.available_width().min(460.0));
            ui.heading(tr(title));
            ui.add_space(6.0);
            ui.add(Label::new(RichText::new(self.folder.display().to_string()).weak()).truncate());
            let label = ui.label(tr("File"));
            let edit = TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY).hint_text("scene.toml");
            let edit = ui.add(edit).labelled_by(label.id);
            if std::mem::take(&mut self.is_new) {
                edit.request_focus();
            }
            if edit.changed() {
                (self.replaced, self.message) = (None, None);
            }
            let entered_key = edit.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            ui.add_space(4.0);
            ScrollArea::vertical().max_height(280.0).auto_shrink([false, true]).show(ui, |ui| {
                if !self.saves && !recent.is_empty() {
                    ui.label(RichText::new(tr("Recent files")).weak());
                    for path in recent.iter().take(RECENT) {
                        if ui.selectable_label(false, path.display().to_string()).clicked() {
                            chosen = Some(path.clone());
                        }
                    }
                    ui.separator();
                }
                if let Some(above) = self.folder.parent()
                    && ui.selectable_label(false, "../").clicked()
                {
                    chosen = Some(above.to_owned());
                }
                for (is_file, name) in &self.entries {
                    let label = if *is_file { name.clone() } else { format!("{name}/") };
                    let row = ui.selectable_label(*is_file && *name == self.text, label);
                    if row.clicked() && *is_file {
                        self.text.clone_from(name);
                        (self.replaced, self.message) = (None, None);
                    }
                    if row.double_clicked() || row.clicked() && !is_file {
                        chosen = Some(self.folder.join(name));
                    }
                }
            });
            if let Some(message) = &self.message {
                ui.add_space(4.0);
                let color = ui.visuals().error_fg_color;
                ui.add(Label::new(RichText::new(message).color(color)).wrap());
            }
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                if ui.button(tr(verb)).clicked() || entered_key {
                    answer = self.accept().map(Some);
                }
                if ui.button(tr("Cancel")).clicked() {
                    answer = Some(None);
                }
            });
        });
        match chosen {
            Some(folder) if folder.is_dir() => self.enter(folder),
            Some(path) if !self.saves => answer = Some(Some(path)),
            _ => {}
        }
        if modal.should_close() && answer.is_none() {
            answer = Some(None);
        }
        answer
    }
}
