//! Clipboard of the browser.

use std::cell::RefCell;

use egui::{OutputCommand, PlatformOutput};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use winit::event::{ElementState, WindowEvent};
use winit::keyboard::{Key, ModifiersState};

use crate::app::platform::web;

thread_local! {
    /// Text that the browser has handed over, to be pasted.
    static PASTED: RefCell<Option<String>> = RefCell::default();
    /// Reason for which the browser has refused a copy.
    static REFUSED: RefCell<Option<String>> = RefCell::default();
}

/// Connection to the browser's clipboard.
pub(crate) struct Clipboard {
    modifiers: ModifiersState,
}

impl Clipboard {
    pub(crate) fn open() -> Self {
        Self { modifiers: ModifiersState::empty() }
    }

    /// Asks the browser for its text when a key pastes. The text is pasted when it arrives.
    pub(crate) fn before(&mut self, event: &WindowEvent, input: &mut egui_winit::State) {
        match event {
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput { event: key, .. } if key.state == ElementState::Pressed => {
                let command = self.modifiers.control_key() || self.modifiers.super_key();
                if command && matches!(&key.logical_key, Key::Character(text) if text.eq_ignore_ascii_case("v")) {
                    // The text of the last copy must not be pasted in its place.
                    input.set_clipboard_text(String::new());
                    read();
                }
            }
            _ => {}
        }
    }

    /// Adds the text that has arrived to the events of a frame.
    pub(crate) fn paste(&mut self, events: &mut Vec<egui::Event>) {
        events.extend(PASTED.take().map(egui::Event::Paste));
    }

    /// Passes text copied in a frame to the browser's clipboard. Returns the reason if the copy of an earlier frame
    /// failed: the browser answers later.
    pub(crate) fn after(&mut self, output: &PlatformOutput) -> Option<String> {
        let clipboard = web_sys::window()?.navigator().clipboard();
        for command in &output.commands {
            if let OutputCommand::CopyText(text) = command {
                let written = clipboard.write_text(text);
                spawn_local(async move {
                    if let Err(error) = JsFuture::from(written).await {
                        REFUSED.set(Some(web::message(&error)));
                        web::wake();
                    }
                });
            }
        }
        REFUSED.take()
    }
}

/// Reads the browser's clipboard; the user may be asked for permission.
fn read() {
    let Some(clipboard) = web_sys::window().map(|window| window.navigator().clipboard()) else { return };
    spawn_local(async move {
        if let Some(text) = JsFuture::from(clipboard.read_text()).await.ok().and_then(|text| text.as_string()) {
            PASTED.set(Some(text));
            web::wake();
        }
    });
}
