//! Settings of the window, saved between runs.

use std::io::{Error, ErrorKind};

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::app::interface::*;
use crate::app::language::Language;
use crate::app::{ThemeChoice, platform};

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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) drawer: Option<Drawer>,
    /// Name of the field that colours the body.
    color: String,
    /// Size of the window, points.
    pub(crate) size: [f32; 2],
    /// Recent scene files, the last one first.
    pub(super) recent: Vec<PathBuf>,
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
    pub fn file() -> Option<PathBuf> {
        platform::settings::file()
    }

    /// Reads the settings from a file; returns the defaults if there is none, and with a message if it cannot be read.
    pub fn load(file: &Path) -> (Self, Option<String>) {
        let read = match platform::settings::read(file) {
            Ok(text) => toml::from_str(&text).map_err(|error| error.message().to_owned()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Table::new()),
            Err(error) => Err(error.to_string()),
        };
        match read {
            Ok(mut table) => {
                let alone = |key: &str, value: &Value| Table::from_iter([(key.to_owned(), value.clone())]);
                table.retain(|key, value| alone(key, value).try_into::<Self>().is_ok());
                (Self::deserialize(table).unwrap_or_default(), None)
            }
            Err(reason) => {
                let message = fill!("%{file} could not be read: %{reason}", file = file.display(), reason);
                (Self::default(), Some(message))
            }
        }
    }

    /// Writes the settings that differ from `before` to a file, whose other settings stay: another window may have
    /// changed them in the meantime.
    ///
    /// # Errors
    /// Error of the operating system, or the file cannot be read. The file is unchanged.
    pub fn save(&self, before: &Self, file: &Path) -> std::io::Result<()> {
        let table = |settings: &Self| Table::try_from(settings).map_err(Error::other);
        let mut stored: Table = match platform::settings::read(file) {
            Ok(text) => toml::from_str(&text).map_err(Error::other)?,
            Err(error) if error.kind() == ErrorKind::NotFound => Table::new(),
            Err(error) => return Err(error),
        };
        let (own, before) = (table(self)?, table(before)?);
        for key in own.keys().chain(before.keys()).filter(|key| own.get(*key) != before.get(*key)) {
            match own.get(key) {
                Some(value) => stored.insert(key.clone(), value.clone()),
                None => stored.remove(key),
            };
        }
        platform::settings::write(file, &toml::to_string(&stored).map_err(Error::other)?)
    }

    /// Returns the size of the window, points.
    pub fn size(&self) -> [f32; 2] {
        let [width, height] = self.size;
        if SIDES.contains(&width) && SIDES.contains(&height) { self.size } else { Self::default().size }
    }

    /// Returns the field that colours the body.
    pub fn color(&self) -> Field {
        Field::ALL.into_iter().find(|field| field.name() == self.color).unwrap_or_default()
    }

    /// Stores the field that colours the body.
    pub fn set_color(&mut self, field: Field) {
        field.name().clone_into(&mut self.color);
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
        settings.size = [900.0, 700.0];
        (0..30).for_each(|i| settings.add_recent(Path::new(&format!("scene-{i}.toml"))));
        settings.add_recent(Path::new("scene-25.toml"));
        assert_eq!(settings.recent.len(), MAX_RECENT);
        assert!(settings.recent[0].ends_with("scene-25.toml") && settings.recent[1].ends_with("scene-29.toml"));
        settings.save(&Settings::default(), &file).unwrap();
        assert_eq!(Settings::load(&file), (settings.clone(), None));
        // An earlier version had the load curve in a drawer.
        let text = std::fs::read_to_string(&file).unwrap().replace("\"motion\"", "\"curve\"");
        std::fs::write(&file, text).unwrap();
        assert_eq!(Settings::load(&file), (Settings { drawer: None, ..settings }, None));
    }

    #[test]
    fn invalid_settings_get_their_defaults_and_a_file_that_cannot_be_read_stays() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        for text in ["theme = 3\npanel = false", "size = [0.0, nan]\npanel = false", "color = \"smell\"\npanel = false"]
        {
            std::fs::write(&file, text).unwrap();
            let (settings, message) = Settings::load(&file);
            assert_eq!((settings.size(), settings.color()), ([1280.0, 800.0], Field::VonMises), "{text}");
            assert_eq!((settings.theme, settings.panel, message), (None, false, None), "{text}");
        }
        std::fs::write(&file, "panel = ").unwrap();
        let (settings, message) = Settings::load(&file);
        assert!(settings == Settings::default() && message.unwrap().contains(file.to_str().unwrap()));
        let changed = Settings { panel: false, ..Settings::default() };
        assert!(changed.save(&settings, &file).is_err());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "panel = ");
    }

    /// Two windows change different settings. Settings of another version of the program stay.
    #[test]
    fn two_windows_change_different_settings() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        std::fs::write(&file, "theme = \"light\"\nfrom_another_version = 1").unwrap();
        let (before, _) = Settings::load(&file);
        let [mut first, mut second] = [before.clone(), before.clone()];
        (first.theme, first.language) = (None, Language::Chinese);
        second.panel = false;
        first.save(&before, &file).unwrap();
        second.save(&before, &file).unwrap();
        let (merged, _) = Settings::load(&file);
        assert_eq!((merged.theme, merged.language, merged.panel), (None, Language::Chinese, false));
        assert!(std::fs::read_to_string(&file).unwrap().contains("from_another_version = 1"));
    }
}
