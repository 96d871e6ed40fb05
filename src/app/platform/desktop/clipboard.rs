//! System clipboard. It replaces that of egui-winit, whose dependencies include image formats: only text is copied
//! here.

use egui::{OutputCommand, PlatformOutput};
use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::keyboard::{Key, KeyCode, ModifiersState, NamedKey, PhysicalKey};

/// Connection to the system clipboard.
pub(crate) struct Clipboard {
    /// Reason for its absence if there is no system clipboard: copies then stay in the window.
    system: Result<arboard::Clipboard, String>,
    modifiers: ModifiersState,
}

impl Clipboard {
    pub(crate) fn open() -> Self {
        let system = arboard::Clipboard::new().map_err(|error| error.to_string());
        Self { system, modifiers: ModifiersState::empty() }
    }

    /// Passes text copied by another program to egui-winit before it processes the key that pastes.
    pub(crate) fn before(&mut self, event: &WindowEvent, input: &mut egui_winit::State) {
        match event {
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            // The clipboard may contain an image, or nothing.
            WindowEvent::KeyboardInput { event: key, .. } if !self.modifiers.is_empty() && may_paste(key) => {
                if let Ok(Ok(text)) = self.system.as_mut().map(arboard::Clipboard::get_text) {
                    input.set_clipboard_text(text);
                }
            }
            _ => {}
        }
    }

    /// Adds text that arrives later than its key to the events of a frame: here it arrives with the key.
    pub(crate) fn paste(&mut self, _: &mut Vec<egui::Event>) {}

    /// Passes text copied in a frame to the system clipboard. Returns the reason if that failed.
    pub(crate) fn after(&mut self, output: &PlatformOutput) -> Option<String> {
        let mut copied = output.commands.iter().filter_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text),
            _ => None,
        });
        copied.find_map(|text| match &mut self.system {
            Ok(system) => system.set_text(text.clone()).err().map(|error| error.to_string()),
            Err(reason) => Some(reason.clone()),
        })
    }
}

/// Returns `true` if a key pastes when a modifier is held: V of any layout, Insert, or a dedicated key.
fn may_paste(key: &KeyEvent) -> bool {
    let named = matches!(key.logical_key, Key::Named(NamedKey::Insert | NamedKey::Paste));
    let letter = matches!(&key.logical_key, Key::Character(text) if text.eq_ignore_ascii_case("v"));
    key.state == ElementState::Pressed && (named || letter || key.physical_key == PhysicalKey::Code(KeyCode::KeyV))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A copy without a system clipboard fails, with the reason; a frame without a copy does not.
    #[test]
    fn a_copy_that_fails_says_why() {
        let reason = "no display";
        let mut clipboard = Clipboard { system: Err(reason.to_owned()), modifiers: ModifiersState::empty() };
        let mut output = PlatformOutput::default();
        assert_eq!(clipboard.after(&output), None);
        output.commands.push(OutputCommand::CopyText("text".to_owned()));
        assert_eq!(clipboard.after(&output).as_deref(), Some(reason));
    }
}
