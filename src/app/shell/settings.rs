//! Settings of the window, saved between runs.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::app::ThemeChoice;
use crate::app::language::Language;
use crate::app::platform;
use crate::app::view_options::Drawer;
use crate::simulation::Field;

/// Largest number of recent files.
const MOST_RECENT: usize = 10;
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
    /// `true` if the panel is shown.
    pub panel: bool,
    /// Drawer that is open under the body.
    #[serde(skip_serializing_if = "Option::is_none")]
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

    /// Reads the settings from a file; returns the defaults if there is none, or if it cannot be read.
    #[must_use]
    pub fn load(file: &Path) -> Self {
        let text = match platform::settings::read(file) {
            Ok(text) => text,
            Err(error) => {
                if error.kind() != std::io::ErrorKind::NotFound {
                    log::warn!("{}: {error}", file.display());
                }
                return Self::default();
            }
        };
        toml::from_str(&text).unwrap_or_else(|error| {
            log::warn!("{}: {}", file.display(), error.message());
            Self::default()
        })
    }

    /// Writes the settings to a file, and creates its folder if necessary.
    ///
    /// # Errors
    /// Error of the operating system.
    pub fn save(&self, file: &Path) -> std::io::Result<()> {
        let toml = toml::to_string(self).map_err(std::io::Error::other)?;
        platform::settings::write(file, &toml)
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
        self.recent.truncate(MOST_RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("new/settings.toml");
        assert_eq!(Settings::load(&file), Settings::default());
        let mut settings = Settings { theme: Some(ThemeChoice::Light), panel: false, ..Settings::default() };
        settings.drawer = Some(Drawer::Motion);
        settings.language = Language::Chinese;
        settings.set_color(Field::RotationAngle);
        settings.set_size([900.0, 700.0]);
        (0..30).for_each(|i| settings.add_recent(Path::new(&format!("scene-{i}.toml"))));
        settings.add_recent(Path::new("scene-25.toml"));
        assert_eq!(settings.recent().len(), MOST_RECENT);
        assert!(settings.recent()[0].ends_with("scene-25.toml") && settings.recent()[1].ends_with("scene-29.toml"));
        settings.save(&file).unwrap();
        assert_eq!(Settings::load(&file), settings);
    }

    #[test]
    fn invalid_settings_are_replaced_by_defaults() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        for text in ["theme = 3", "not toml at all [", "size = [0.0, nan]", "color = \"smell\"\nsize = [1e9, 2.0]"] {
            std::fs::write(&file, text).unwrap();
            let settings = Settings::load(&file);
            assert_eq!((settings.size(), settings.color()), ([1280.0, 800.0], Field::VonMises), "{text}");
        }
        std::fs::write(&file, "theme = \"light\"\nfrom_another_version = 1").unwrap();
        assert_eq!(Settings::load(&file).theme, Some(ThemeChoice::Light));
    }
}
