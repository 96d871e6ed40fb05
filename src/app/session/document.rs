//! Origin of the scene: a built-in scene, or a file that can be read, written, and changed by other programs.

use crate::app::platform::{IS_PAGE, files};
use crate::app::prelude::*;
use crate::scene::{self, MeshFile, SceneError, built_in_mesh};

/// Name of a scene's file or built-in scene, and the scene as it is stored there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Document {
    pub source: Source,
    /// Scene as last opened or saved.
    pub original: Scene,
    /// Loads of the scene as last opened: saving does not change the scales of arrows and sliders, which follow from them.
    pub opened: OpeningLoads,
    /// Folder that the path of the scene's mesh file is relative to: that of the file which was opened. Saving elsewhere
    /// does not change the path in the scene.
    mesh_folder: Option<PathBuf>,
    /// Content of the file when it was last read or written; `None` if there was none.
    pub text: Option<Arc<str>>,
}

/// Largest loads of a scene as it was opened. The arrows of these loads have the opening length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OpeningLoads {
    /// Largest force, N; `None` if the scene has none.
    pub force: Option<f64>,
    /// Largest moment, N m; `None` if the scene has none.
    pub moment: Option<f64>,
}

impl OpeningLoads {
    pub(crate) fn of(scene: &Scene) -> Self {
        let largest = |sizes: &mut dyn Iterator<Item = f64>| {
            let largest = sizes.fold(0.0, f64::max);
            (largest > 0.0 && largest.is_finite()).then_some(largest)
        };
        Self {
            force: largest(&mut scene.loads.iter().filter_map(|load| match load {
                Load::Force { force: [x, y], .. } => Some(x.hypot(*y)),
                _ => None,
            })),
            moment: largest(&mut scene.loads.iter().filter_map(|load| match load {
                Load::Moment { moment, .. } => Some(moment.abs()),
                _ => None,
            })),
        }
    }
}

/// Opens the built-in scene with this name.
pub(crate) fn built_in(id: &str) -> Option<(Source, Scene)> {
    let source = Source { name: id.into(), assignments: Vec::new() };
    let scene = scene::open(&source).ok()?;
    Some((source, scene))
}

/// Returns the reason for which a file was not written.
fn not_written(path: &Path, reason: &std::io::Error) -> Sentence {
    Sentence::located(path.display().to_string(), reason.to_string())
}

impl Document {
    pub(crate) fn new(source: Source, original: Scene) -> Self {
        let mut document = Self::with_text(source, original, None);
        document.text = document.read();
        document
    }

    /// Creates the document of a file that had this content when it was last read or written.
    pub(crate) fn with_text(source: Source, original: Scene, text: Option<Arc<str>>) -> Self {
        let mut document = Self { source, opened: OpeningLoads::of(&original), original, mesh_folder: None, text };
        document.mesh_folder = document.path().and_then(folder);
        document
    }

    /// Returns the current content of the file; `None` if it cannot be read.
    pub(crate) fn read(&self) -> Option<Arc<str>> {
        let bytes = std::fs::read(self.path()?).ok()?;
        Some(String::from_utf8_lossy(&bytes).into())
    }

    /// Opens a scene, or returns the reason for which there is none.
    pub(crate) fn open(source: Source) -> Result<Self, Sentence> {
        let original = files::open(&source).map_err(|error| match &error {
            error @ SceneError::Syntax { .. } => sentence!("not a scene: %{error}", error),
            error => error.into(),
        })?;
        Ok(Self::new(source, original))
    }

    /// Returns the path of the scene's file; `None` for a built-in scene, and for one read from a stream.
    pub(crate) fn path(&self) -> Option<&Path> {
        let has_file = self.source.built_in().is_none() && !self.source.is_stream();
        has_file.then_some(self.source.name.as_path())
    }

    /// Returns `true` if the file has been changed on disk since it was read or saved here.
    pub(crate) fn has_changed(&self) -> bool {
        self.read().is_some_and(|now| Some(now) != self.text)
    }

    /// Returns the scene as a file at `path` has it: the relative path of a mesh file becomes absolute if that file is in
    /// another folder than the one that was opened.
    pub(crate) fn relocated(&self, scene: &Scene, path: &Path) -> Scene {
        let mut scene = scene.clone();
        let before = self.mesh_folder.as_ref().filter(|before| folder(path).as_ref() != Some(*before));
        if let (Some(mesh), Some(before)) = (&mut scene.mesh, before)
            && before.join(&mesh.file).is_file()
            && let Some(whole) = before.join(&mesh.file).to_str()
        {
            mesh.file = whole.to_owned();
        }
        scene
    }

    /// Writes a scene to a file, as an edit of the text that was read, and returns the document of that file, or the reason
    /// for which the file is unchanged. A built-in mesh is written beside it.
    pub(crate) fn save(&self, scene: &Scene, path: &Path) -> Result<Self, Sentence> {
        let mut written = self.relocated(scene, path);
        if let Some(mesh) = written.mesh.as_mut().filter(|_| !IS_PAGE) {
            save_built_in_mesh(mesh, path)?;
        }
        let read = self.text.as_deref().map(str::to_owned).or_else(|| files::text(&self.source));
        let toml = scene::edited(&read.unwrap_or_default(), &written).map_err(|error| {
            sentence!("the scene could not be written as TOML: %{error}", error = error.to_string())
        })?;
        files::save(path, toml.as_bytes()).map_err(|reason| not_written(path, &reason))?;
        let source = Source { name: path.to_owned(), assignments: Vec::new() };
        let saved = Self::with_text(source, scene.clone(), Some(toml.into()));
        Ok(Self { opened: self.opened, mesh_folder: self.mesh_folder.clone(), ..saved })
    }
}

/// Writes a built-in mesh beside the scene file at `path`, and names it there; a different file with its name stays, and
/// the scene keeps the built-in mesh.
fn save_built_in_mesh(mesh: &mut MeshFile, path: &Path) -> Result<(), Sentence> {
    let Some(folder) = path.parent() else { return Ok(()) };
    let name = Path::new(&mesh.file).file_name().and_then(|name| name.to_str()).map(str::to_owned);
    let (Some(text), Some(name)) = (built_in_mesh(&mesh.file, folder), name) else { return Ok(()) };
    let beside = path.with_file_name(&name);
    match std::fs::read_to_string(&beside) {
        Ok(present) if present == text => {}
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            files::save(&beside, text.as_bytes()).map_err(|reason| not_written(&beside, &reason))?;
        }
        _ => return Ok(()),
    }
    mesh.file = name;
    Ok(())
}

/// Returns the absolute path of a file's folder; `None` on a page, which has none.
fn folder(path: &Path) -> Option<PathBuf> {
    path.parent().and_then(|folder| std::path::absolute(folder.join(".")).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Saving changes only what was edited, also in another file and a second time. A file that may not be written stays.
    #[test]
    fn a_saved_scene_keeps_its_text() {
        let folder = tempfile::tempdir().unwrap();
        let [path, copy] = ["mine.toml", "copy.toml"].map(|name| folder.path().join(name));
        let own = include_str!("../../../tests/data/files/commented.toml");
        std::fs::write(&path, own).unwrap();
        let opened = Document::open(Source { name: path.clone(), assignments: Vec::new() }).unwrap();
        let unedited = opened.save(&opened.original, &path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), own);
        let mut scene = opened.original.clone();
        scene.material.young = 3e6;
        let saved = unedited.save(&scene, &copy).unwrap();
        let edited = own.replace("1 N/mm²", "3 N/mm²");
        assert_eq!(std::fs::read_to_string(&copy).unwrap(), edited);
        scene.material.young = 4e6;
        saved.save(&scene, &copy).unwrap();
        assert_eq!(std::fs::read_to_string(&copy).unwrap(), own.replace("1 N/mm²", "4 N/mm²"));
        let mut permissions = std::fs::metadata(&copy).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&copy, permissions).unwrap();
        let refused = saved.save(&opened.original, &copy).unwrap_err().to_string();
        assert!(refused.contains("copy.toml: the file is read-only"), "{refused}");
        // The text of a built-in scene is kept, too.
        let built_in = Document::open(Source { name: "article".into(), assignments: Vec::new() }).unwrap();
        built_in.save(&built_in.original, &path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), crate::scene::registry::find("article").unwrap().toml);
    }
}
