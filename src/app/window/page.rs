//! Window on a web page: its scene and its language are in the page's address.

use std::error::Error;

use egui::os::OperatingSystem;

use crate::app::language::{self, Language, tr};
use crate::app::platform::page::{self, Address};
use crate::app::platform::{self, files};
use crate::app::shell::settings::Settings;
use crate::app::task::solve::check_size;
use crate::app::window::{App, Display, worker};
use crate::scene::{Source, registry};
use crate::simulation::Simulation;

/// Name of a scene that came with the page's address.
const SHARED: &str = "shared.toml";

/// Opens the window on the page's canvas. An error is shown in place of the window.
pub fn open_page() {
    console_error_panic_hook::set_once();
    // It fails if a logger has been set, which then goes on.
    let _ = console_log::init_with_level(log::Level::Warn);
    // A worker has no window.
    if web_sys::window().is_none() {
        return worker::listen();
    }
    if let Err(error) = open(Address::read()) {
        page::fail(&error.to_string());
    }
}

fn open(address: Address) -> Result<(), Box<dyn Error>> {
    let stored = Settings::file().filter(|file| platform::settings::read(file).is_ok());
    let (mut settings, unreadable) = stored.as_deref().map(Settings::load).unwrap_or_default();
    if let Some(language) = address.language.or_else(|| page::language().filter(|_| stored.is_none())) {
        settings.language = if language.starts_with("zh") { Language::Chinese } else { Language::English };
    }
    language::speak(settings.language);
    let is_default = address.scene.is_none() && address.toml.is_none();
    let name = match address.toml {
        Some(Ok(toml)) => files::add(SHARED, toml),
        Some(Err(error)) => {
            let message = tr("The scene in the link cannot be read. Copy the whole link again.");
            return Err(format!("{message} ({error})").into());
        }
        None => address.scene.as_deref().unwrap_or(registry::DEFAULT).into(),
    };
    let source = Source { name, assignments: Vec::new() };
    let scene = files::open(&source)?;
    check_size(&scene)?;
    let simulation = Simulation::new(&scene)?;
    let app = App::new((source, scene, Some(simulation)), (settings, unreadable), address.card, is_default)?;
    // Shortcuts have the Cmd key on systems of Apple.
    app.ctx.set_os(OperatingSystem::from_user_agent(&page::user_agent()));
    Ok(app.run(Display::open()?)?)
}
