//! The system's clipboard. egui-winit's own would bring the formats of images along; text is all that is copied here.

use egui::{OutputCommand, PlatformOutput};
use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::keyboard::{Key, KeyCode, NamedKey, PhysicalKey};

/// A connection to the system's clipboard, if there is one. Without it, copies stay in the window.
pub(super) struct Clipboard(Option<arboard::Clipboard>);

impl Clipboard {
    /// Connects to the clipboard.
    pub(super) fn open() -> Self {
        Self(arboard::Clipboard::new().inspect_err(|error| log::warn!("no clipboard: {error}")).ok())
    }

    /// Brings what another program has copied, before egui-winit meets the key that pastes.
    pub(super) fn before(&mut self, event: &WindowEvent, input: &mut egui_winit::State) {
        let WindowEvent::KeyboardInput { event: key, .. } = event else { return };
        let modifiers = input.egui_input().modifiers;
        // What it holds may be an image, or nothing.
        if (modifiers.command || modifiers.shift)
            && may_paste(key)
            && let Some(Ok(text)) = self.0.as_mut().map(arboard::Clipboard::get_text)
        {
            input.set_clipboard_text(text);
        }
    }

    /// Hands on to other programs what has been copied in a frame.
    pub(super) fn after(&mut self, output: &PlatformOutput) {
        let Some(system) = &mut self.0 else { return };
        for command in &output.commands {
            if let OutputCommand::CopyText(text) = command
                && let Err(error) = system.set_text(text.clone())
            {
                log::warn!("not copied: {error}");
            }
        }
    }
}

/// Whether a key pastes, if a modifier is held: V of any layout, Insert, or a key made for it.
fn may_paste(key: &KeyEvent) -> bool {
    let named = matches!(key.logical_key, Key::Named(NamedKey::Insert | NamedKey::Paste));
    let letter = matches!(&key.logical_key, Key::Character(text) if text.eq_ignore_ascii_case("v"));
    key.state == ElementState::Pressed && (named || letter || key.physical_key == PhysicalKey::Code(KeyCode::KeyV))
}
