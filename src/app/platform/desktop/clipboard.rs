//! System clipboard. It replaces that of egui-winit, whose dependencies include image formats: only text is copied
//! here.

use egui::{OutputCommand, PlatformOutput};
use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::keyboard::{Key, KeyCode, ModifiersState, NamedKey, PhysicalKey};

/// Connection to the system clipboard.
pub(crate) struct Clipboard {
    /// `None` if there is no system clipboard: copies then stay in the window.
    system: Option<arboard::Clipboard>,
    modifiers: ModifiersState,
}

impl Clipboard {
    /// Connects to the clipboard.
    pub(crate) fn open() -> Self {
        let system = arboard::Clipboard::new().inspect_err(|error| log::warn!("no clipboard: {error}")).ok();
        Self { system, modifiers: ModifiersState::empty() }
    }

    /// Passes text copied by another program to egui-winit before it processes the key that pastes.
    pub(crate) fn before(&mut self, event: &WindowEvent, input: &mut egui_winit::State) {
        match event {
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            // The clipboard may contain an image, or nothing.
            WindowEvent::KeyboardInput { event: key, .. } if !self.modifiers.is_empty() && may_paste(key) => {
                if let Some(Ok(text)) = self.system.as_mut().map(arboard::Clipboard::get_text) {
                    input.set_clipboard_text(text);
                }
            }
            _ => {}
        }
    }

    /// Adds text that arrives later than its key to the events of a frame: here it arrives with the key.
    pub(crate) fn paste(&mut self, _: &mut Vec<egui::Event>) {}

    /// Passes text copied in a frame to the system clipboard.
    pub(crate) fn after(&mut self, output: &PlatformOutput) {
        let Some(system) = &mut self.system else { return };
        for command in &output.commands {
            if let OutputCommand::CopyText(text) = command
                && let Err(error) = system.set_text(text.clone())
            {
                log::warn!("not copied: {error}");
            }
        }
    }
}

/// Returns `true` if a key pastes when a modifier is held: V of any layout, Insert, or a dedicated key.
fn may_paste(key: &KeyEvent) -> bool {
    let named = matches!(key.logical_key, Key::Named(NamedKey::Insert | NamedKey::Paste));
    let letter = matches!(&key.logical_key, Key::Character(text) if text.eq_ignore_ascii_case("v"));
    key.state == ElementState::Pressed && (named || letter || key.physical_key == PhysicalKey::Code(KeyCode::KeyV))
}
