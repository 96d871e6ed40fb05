//! Settings of the window, saved between runs.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use serde::de::IntoDeserializer;
use serde::{Deserialize, Deserializer, Serialize};
use toml::Table;

use crate::app::ThemeChoice;
use crate::app::language::{Language, fill};
use crate::app::platform;
use crate::app::view_options::Drawer;
use crate::simulation::Field;

/// Largest number of recent files.
const MAX_RECENT: usize = 10;
/// Accepted width and height of the window, points.
const SIDES: std::ops::RangeInclusive<f32> = 200.0..=8192.0;

/// Settings of the window. Values that are missing in the file or invalid get their defaults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Theme; `None` follows the system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theme: Option<ThemeChoice>,
    /// Language of the user interface.
    pub language: Language,
    /// `true` if animations are replaced by stills.
    pub reduced_motion: bool,
    /// `true` if the panel is shown.
    pub panel: bool,
    /// Drawer that is open under the body.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "known_drawer")]
    pub(crate) drawer: Option<Drawer>,
    /// Name of the field that colours the body.
    color: String,
    /// Size of the window, points.
    size: [f32; 2],
    /// Recent scene files, the last one first.
    recent: Vec<PathBuf>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: None,
            language: Language::default(),
            reduced_motion: false,
            panel: true,
            drawer: None,
            color: Field::default().name().to_owned(),
            size: [1280.0, 800.0],
            recent: Vec::new(),
        }
    }
}

impl Settings {
    /// Returns the path of this user's settings; `None` if the system has no folder for them.
    #[must_use]
    pub fn file() -> Option<PathBuf> {
        platform::settings::file()
    }

    /// Returns `true` if there is no file of settings yet.
    pub(crate) fn is_missing(file: &Path) -> bool {
        platform::settings::read(file).is_err_and(|error| error.kind() == ErrorKind::NotFound)
    }

    /// Reads the settings from a file; returns the defaults if there is none. If the file cannot be read, it is renamed
    /// and the message of the second value says so.
    #[must_use]
    pub fn load(file: &Path) -> (Self, Option<String>) {
        let read = match platform::settings::read(file) {
            Ok(text) => toml::from_str(&text).map_err(|error| error.message().to_owned()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Self::default()),
            Err(error) => Err(error.to_string()),
        };
        match read {
            Ok(settings) => (settings, None),
            Err(reason) => {
                let name = file.display();
                let message = match platform::settings::set_aside(file) {
                    Ok(kept) => fill!(
                        "The settings could not be read and are now in %{kept}: %{reason}",
                        kept = kept.display(),
                        reason = reason
                    ),
                    Err(_) => fill!("%{file} could not be read: %{reason}", file = name, reason = reason),
                };
                (Self::default(), Some(message))
            }
        }
    }

    /// Writes the settings that differ from `before` to a file, whose other settings stay: another window may have
    /// changed them in the meantime. Creates the folder of the file if necessary.
    ///
    /// # Errors
    /// Error of the operating system, or the file cannot be read any more. The file is unchanged.
    pub fn save(&self, before: &Self, file: &Path) -> std::io::Result<()> {
        let table = |settings: &Self| Table::try_from(settings).map_err(Error::other);
        let _lock = platform::settings::lock(file)?;
        let mut stored: Table = match platform::settings::read(file) {
            Ok(text) => toml::from_str(&text).map_err(Error::other)?,
            Err(error) if error.kind() == ErrorKind::NotFound => Table::new(),
            Err(error) => return Err(error),
        };
        let mut own = self.clone();
        let theirs = stored.clone().try_into().map(|theirs: Self| theirs.recent).unwrap_or_default();
        own.recent.extend(theirs.into_iter().filter(|path| !self.recent.contains(path)));
        own.recent.truncate(MAX_RECENT);
        let (own, before) = (table(&own)?, table(before)?);
        for key in own.keys().chain(before.keys()).filter(|key| own.get(*key) != before.get(*key)) {
            match own.get(key) {
                Some(value) => stored.insert(key.clone(), value.clone()),
                None => stored.remove(key),
            };
        }
        platform::settings::write(file, &toml::to_string(&stored).map_err(Error::other)?)
    }

    /// Returns the size of the window, points.
    #[must_use]
    pub fn size(&self) -> [f32; 2] {
        let [width, height] = self.size;
        if SIDES.contains(&width) && SIDES.contains(&height) { self.size } else { Self::default().size }
    }

    /// Stores the size of the window, points.
    pub fn set_size(&mut self, size: [f32; 2]) {
        self.size = size;
    }

    /// Returns the field that colours the body.
    #[must_use]
    pub fn color(&self) -> Field {
        Field::ALL.into_iter().find(|field| field.name() == self.color).unwrap_or_default()
    }

    /// Stores the field that colours the body.
    pub fn set_color(&mut self, field: Field) {
        field.name().clone_into(&mut self.color);
    }

    /// Returns the recent scene files, the last one first.
    #[must_use]
    pub fn recent(&self) -> &[PathBuf] {
        &self.recent
    }

    /// Adds a file to the recent scene files.
    pub fn add_recent(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        // TOML cannot represent a path that is not valid Unicode.
        if path.to_str().is_none() {
            return;
        }
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path);
        self.recent.truncate(MAX_RECENT);
    }
}

/// Reads the name of a drawer; `None` if another version of the program wrote it.
fn known_drawer<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Drawer>, D::Error> {
    let name = String::deserialize(deserializer)?;
    let drawer: Result<Drawer, serde::de::value::Error> = Drawer::deserialize(name.into_deserializer());
    Ok(drawer.ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("new/settings.toml");
        assert_eq!(Settings::load(&file), (Settings::default(), None));
        let mut settings = Settings { theme: Some(ThemeChoice::Light), panel: false, ..Settings::default() };
        settings.drawer = Some(Drawer::Motion);
        settings.language = Language::Chinese;
        settings.set_color(Field::RotationAngle);
        settings.set_size([900.0, 700.0]);
        (0..30).for_each(|i| settings.add_recent(Path::new(&format!("scene-{i}.toml"))));
        settings.add_recent(Path::new("scene-25.toml"));
        assert_eq!(settings.recent().len(), MAX_RECENT);
        assert!(settings.recent()[0].ends_with("scene-25.toml") && settings.recent()[1].ends_with("scene-29.toml"));
        settings.save(&Settings::default(), &file).unwrap();
        assert_eq!(Settings::load(&file), (settings.clone(), None));
        // An earlier version had the load curve in a drawer.
        let text = std::fs::read_to_string(&file).unwrap().replace("\"motion\"", "\"curve\"");
        std::fs::write(&file, text).unwrap();
        assert_eq!(Settings::load(&file), (Settings { drawer: None, ..settings }, None));
    }

    #[test]
    fn invalid_settings_are_replaced_by_defaults_and_kept_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        for text in ["theme = 3", "not toml at all [", "size = [0.0, nan]", "color = \"smell\"\nsize = [1e9, 2.0]"] {
            std::fs::write(&file, text).unwrap();
            let (settings, message) = Settings::load(&file);
            assert_eq!((settings.size(), settings.color()), ([1280.0, 800.0], Field::VonMises), "{text}");
            assert_eq!(message.is_none(), file.exists(), "{message:?}");
            if let Some(message) = message {
                let kept = folder.path().join("settings.unreadable.toml");
                assert!(message.contains(kept.to_str().unwrap()), "{message}");
                assert_eq!(std::fs::read_to_string(kept).unwrap(), text);
            }
        }
    }

    /// Two windows change different settings. Settings of another version of the program stay.
    #[test]
    fn settings_of_two_windows_are_merged() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        std::fs::write(&file, "theme = \"light\"\nfrom_another_version = 1").unwrap();
        let (before, _) = Settings::load(&file);
        let [mut first, mut second] = [before.clone(), before.clone()];
        (first.theme, first.language) = (None, Language::Chinese);
        first.add_recent(Path::new("/first.toml"));
        second.panel = false;
        second.add_recent(Path::new("/second.toml"));
        first.save(&before, &file).unwrap();
        second.save(&before, &file).unwrap();
        let (merged, _) = Settings::load(&file);
        assert_eq!((merged.theme, merged.language, merged.panel), (None, Language::Chinese, false));
        assert_eq!(merged.recent(), [Path::new("/second.toml"), Path::new("/first.toml")]);
        assert!(std::fs::read_to_string(&file).unwrap().contains("from_another_version = 1"));
        // A file that a user has broken in the meantime is not overwritten.
        std::fs::write(&file, "panel = ").unwrap();
        assert!(first.save(&before, &file).is_err());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "panel = ");
    }
}
