//! Copy of unsaved edits in the settings folder, on a page in the storage of the browser. It survives a crash, and the
//! next window offers to restore it.
//!
//! Every window locks a numbered file of its own, so that several open windows do not overwrite each other's copies. A
//! copy that is not locked belongs to a window that has crashed. A page has an item for each visit.

use std::io;

use serde::{Deserialize, Serialize};

use super::*;
use crate::app::platform::settings::{self, CopyPlace};
pub use crate::app::session::edit::Version as Unsaved;

/// Largest number of windows that are open or have crashed.
const PLACES: usize = 100;
/// Shortest time between two writes.
const PAUSE: Duration = Duration::from_secs(1);
/// Time after a failure before another attempt.
const AFTER_FAILURE: Duration = Duration::from_secs(30);

/// Content of a copy's file.
#[derive(Deserialize, Serialize)]
struct Copy {
    /// Built-in name or absolute path of the scene.
    name: String,
    assignments: Vec<String>,
    /// Scene as last opened or saved, TOML.
    original: String,
    /// Scene with its edits, TOML.
    scene: String,
    /// Content of the scene's file when it was last read or written.
    file: Option<String>,
}

/// Writes an edited scene and its document to a copy, whose previous content an error leaves unchanged.
fn write(Unsaved { document, scene }: &Unsaved, file: &Path) -> io::Result<()> {
    let Source { name, assignments } = &document.source;
    // On a page there are no absolute paths.
    let absolute = document.path().and_then(|_| std::path::absolute(name).ok());
    let name = absolute.unwrap_or_else(|| name.clone());
    let copy = Copy {
        name: name.to_string_lossy().into_owned(),
        assignments: assignments.clone(),
        original: document.relocated(&document.original, &name).to_toml().map_err(io::Error::other)?,
        scene: document.relocated(scene, &name).to_toml().map_err(io::Error::other)?,
        file: document.text.as_deref().map(str::to_owned),
    };
    settings::write(file, &toml::to_string(&copy).map_err(io::Error::other)?)
}

impl Unsaved {
    /// Reads edits from a copy.
    fn read(file: &Path) -> io::Result<Self> {
        let copy: Copy = toml::from_str(&settings::read(file)?).map_err(io::Error::other)?;
        let name = PathBuf::from(copy.name);
        let folder = name.parent().unwrap_or(Path::new("")).to_owned();
        let original = Scene::from_toml_in(&copy.original, &folder).map_err(io::Error::other)?;
        let scene = Scene::from_toml_in(&copy.scene, &folder).map_err(io::Error::other)?;
        let source = Source { name, assignments: copy.assignments };
        let document = Document::with_text(source, original, copy.file.map(Into::into));
        Ok(Self { document, scene })
    }
}

/// File for this window's copy, and the copies left by crashed windows.
pub struct RecoveryCopies {
    place: CopyPlace,
    /// Edits that the file contains.
    written: Option<Unsaved>,
    /// Time of the last write, or of the last attempt.
    last: Option<Instant>,
    /// Copies left by crashed windows, the newest last.
    left: Vec<(CopyPlace, Unsaved)>,
    /// Messages about copies that cannot be read. They are kept: the user may repair them by hand.
    pub(crate) unreadable: Vec<String>,
}

impl RecoveryCopies {
    /// Locks the first free file in `folder`, which is created if it does not exist, and reads the edits that crashed
    /// windows have left there, also in files after it. Returns the newest.
    ///
    /// # Errors
    /// Error of the operating system, or all files are taken.
    pub fn open(folder: &Path) -> io::Result<(Self, Option<Unsaved>)> {
        let (mut own, mut left, mut unreadable) = (None, Vec::new(), Vec::new());
        for number in 0..PLACES {
            if own.is_some() && !settings::has_copy(folder, number) {
                continue;
            }
            let Some(place) = settings::lock(folder, number)? else { continue };
            match Unsaved::read(&place.file) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => own = own.or(Some(place)),
                Ok(edits) => left.push((place, edits)),
                Err(reason) => unreadable.push(fill!(
                    "%{file} has unsaved changes, but cannot be read: %{reason}",
                    file = place.file.display(),
                    reason = reason
                )),
            }
        }
        let is_full = || io::Error::other(format!("{} has {PLACES} copies of unsaved scenes", folder.display()));
        left.sort_by_key(|(place, _)| settings::modified(&place.file));
        let newest = left.last().map(|(_, edits)| edits.clone());
        Ok((Self { place: own.ok_or_else(is_full)?, written: None, last: None, left, unreadable }, newest))
    }

    /// Writes the edits if the file does not contain them, or removes the file if there are none. Returns the time of
    /// the next attempt if it is too early to write.
    pub(crate) fn keep(&mut self, edits: Option<&Unsaved>) -> io::Result<Option<Instant>> {
        if self.written.as_ref() != edits {
            let due = self.last.map(|last| last + PAUSE).filter(|due| *due > Instant::now());
            if due.is_some() && edits.is_some() {
                return Ok(due);
            }
            // After a failure the next attempt waits.
            self.last = Some(Instant::now() + AFTER_FAILURE);
            match edits {
                Some(edits) => write(edits, &self.place.file)?,
                None => settings::remove(&self.place.file)?,
            }
            self.last = Some(Instant::now());
            self.written = edits.cloned();
        }
        Ok(None)
    }

    /// Writes the edits, if there are any, without a pause since the last write.
    pub(crate) fn keep_at_once(&mut self, edits: Option<&Unsaved>) -> io::Result<()> {
        self.last = None;
        self.keep(edits).map(drop)
    }

    /// Removes the newest copy left by a crashed window, once this window's own edits are written. Returns the one before.
    /// After an error the copy is still there.
    pub(crate) fn discard_left(&mut self, edits: Option<&Unsaved>) -> io::Result<Option<Unsaved>> {
        self.keep_at_once(edits)?;
        self.left.pop().map_or(Ok(()), |(left, _)| settings::remove(&left.file))?;
        Ok(self.left.last().map(|(_, edits)| edits.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self};

    fn edits(name: &str, force: f64) -> Unsaved {
        let source = Source { name: name.into(), assignments: Vec::new() };
        let original = scene::open(&source).unwrap();
        let mut scene = original.clone();
        scene.set_force(0, [0.0, force]).unwrap();
        Unsaved { document: Document::new(source, original), scene }
    }

    #[test]
    fn a_crashed_windows_edits_are_offered_once_and_an_open_windows_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("unsaved");
        let (mut crashed, left) = RecoveryCopies::open(&folder).unwrap();
        assert_eq!(left, None);
        assert_eq!(crashed.keep(Some(&edits("article", -3.0))).unwrap(), None);
        let (mut other, left) = RecoveryCopies::open(&folder).unwrap();
        assert_eq!(left, None, "the first window is still open");
        other.keep(Some(&edits("cantilever", -2.0))).unwrap();
        other.keep(None).unwrap();
        drop((crashed, other));
        let (mut next, left) = RecoveryCopies::open(&folder).unwrap();
        assert_eq!(left, Some(edits("article", -3.0)));
        let (_, left) = RecoveryCopies::open(&folder).unwrap();
        assert_eq!(left, None, "another window offers it");
        next.discard_left(Some(&edits("article", -3.0))).unwrap();
        next.keep(None).unwrap();
        let (mut after, _) = RecoveryCopies::open(&folder).unwrap();
        after.keep(Some(&edits("cantilever", -4.0))).unwrap();
        drop((next, after));
        let (_, left) = RecoveryCopies::open(&folder).unwrap();
        assert_eq!(left, Some(edits("cantilever", -4.0)), "its file is after a free one");
    }

    #[test]
    fn copies_of_several_windows_are_offered_one_after_the_other_the_newest_first() {
        let folder = tempfile::tempdir().unwrap();
        let mut windows: Vec<_> = (0..2).map(|_| RecoveryCopies::open(folder.path()).unwrap().0).collect();
        windows[1].keep(Some(&edits("article", -1.0))).unwrap();
        std::thread::sleep(Duration::from_millis(20));
        windows[0].keep(Some(&edits("article", -2.0))).unwrap();
        drop(windows);
        let (mut next, left) = RecoveryCopies::open(folder.path()).unwrap();
        assert_eq!(left, Some(edits("article", -2.0)));
        assert_eq!(next.discard_left(None).unwrap(), Some(edits("article", -1.0)));
        assert_eq!(next.discard_left(None).unwrap(), None);
    }

    #[test]
    fn a_copy_is_not_written_at_every_frame_and_one_that_cannot_be_read_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (mut window, _) = RecoveryCopies::open(folder.path()).unwrap();
        window.keep(Some(&edits("article", -3.0))).unwrap();
        assert!(window.keep(Some(&edits("article", -4.0))).unwrap().is_some());
        let file = window.place.file.clone();
        assert_eq!(Unsaved::read(&file).unwrap(), edits("article", -3.0));
        drop(window);
        std::fs::write(&file, "name = 3").unwrap();
        let (window, left) = RecoveryCopies::open(folder.path()).unwrap();
        assert_eq!(left, None);
        assert!(file.exists() && window.place.file != file);
        let [message] = window.unreadable.as_slice() else { panic!("{:?}", window.unreadable) };
        assert!(message.contains(file.to_str().unwrap()) && message.contains("name"), "{message}");
    }
}
