//! The system's clipboard, for text, on every system but Wayland, whose clipboard egui-winit reaches itself.
//!
//! egui-winit has a feature for the others, too, with pictures: it would add a dozen crates that decode pictures, and
//! nothing here copies one. So it keeps copied text within the program, and this file passes that text on: before a
//! key or button that pastes, and after a frame that copied.

use egui::{Event, OutputCommand, PointerButton};
use winit::event::{ElementState, MouseButton, WindowEvent};
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::{Key, KeyCode, ModifiersState, NamedKey, PhysicalKey};

/// The clipboard, and the modifier keys that are down, as a paste is known by its keys.
pub struct SystemClipboard {
    /// `None` on Wayland, and where no clipboard can be reached.
    text: Option<arboard::Clipboard>,
    modifiers: ModifiersState,
}

impl SystemClipboard {
    /// Connects to the clipboard of the system on which `event_loop` runs.
    pub fn new(event_loop: &ActiveEventLoop) -> SystemClipboard {
        let text = if is_wayland(event_loop) { None } else { arboard::Clipboard::new().ok() };
        SystemClipboard { text, modifiers: ModifiersState::empty() }
    }

    /// Hands the clipboard's text to egui before it sees `event`, where that is a key that pastes. Without text on the
    /// clipboard nothing is pasted.
    pub fn before_event(&mut self, event: &WindowEvent, input: &mut egui_winit::State) {
        if let WindowEvent::ModifiersChanged(modifiers) = event {
            self.modifiers = modifiers.state();
        }
        let Some(clipboard) = &mut self.text else { return };
        if pastes(event, self.modifiers) {
            // An error here is a clipboard that has a picture or nothing.
            input.set_clipboard_text(clipboard.get_text().unwrap_or_default());
        }
    }

    /// Pastes the selected text of X11 where `event`, which egui has seen, is a press of the middle button.
    pub fn after_event(&mut self, event: &WindowEvent, input: &mut egui_winit::State) {
        let is_middle =
            matches!(event, WindowEvent::MouseInput { state: ElementState::Pressed, button: MouseButton::Middle, .. });
        let (true, Some(clipboard)) = (is_middle, &mut self.text) else { return };
        let events = &mut input.egui_input_mut().events;
        let pressed = events.iter().rev().find_map(|event| match event {
            Event::PointerButton { pos, button: PointerButton::Middle, pressed: true, .. } => Some(*pos),
            _ => None,
        });
        let text = selected(clipboard).filter(|text| !text.is_empty());
        events.extend(pressed.zip(text).map(|(pos, text)| Event::MiddleClickPaste { pos, text }));
    }

    /// Copies what a frame of egui asked to copy. Returns why the system did not take a text, in a sentence for the user;
    /// `None` where it took all. That it does not take a selection is no failure: nobody asked to copy that.
    pub fn after_frame(&mut self, commands: &[OutputCommand]) -> Option<String> {
        let clipboard = self.text.as_mut()?;
        let mut failure = None;
        for command in commands {
            match command {
                OutputCommand::CopyText(text) => failure = clipboard.set_text(text).err().or(failure),
                OutputCommand::TextSelectionSettled(text) => select(clipboard, text),
                OutputCommand::CopyImage(_) | OutputCommand::OpenUrl(_) => {}
            }
        }
        failure.map(|error| format!("the text could not be copied: {error}"))
    }
}

/// Returns whether `event` is a key press on which egui-winit pastes: Ctrl+V (Command+V on macOS), by letter or by place
/// on the keyboard, Shift+Insert (on Windows), or a key that is named so.
fn pastes(event: &WindowEvent, modifiers: ModifiersState) -> bool {
    let WindowEvent::KeyboardInput { event, .. } = event else { return false };
    if event.state != ElementState::Pressed {
        return false;
    }
    let is_command = modifiers.control_key() || modifiers.super_key();
    match &event.logical_key {
        Key::Named(NamedKey::Paste) => true,
        Key::Named(NamedKey::Insert) => modifiers.shift_key(),
        Key::Character(letter) if letter.eq_ignore_ascii_case("v") => is_command,
        _ => is_command && event.physical_key == PhysicalKey::Code(KeyCode::KeyV),
    }
}

#[cfg(target_os = "linux")]
fn is_wayland(event_loop: &ActiveEventLoop) -> bool {
    winit::platform::wayland::ActiveEventLoopExtWayland::is_wayland(event_loop)
}

#[cfg(not(target_os = "linux"))]
fn is_wayland(_: &ActiveEventLoop) -> bool {
    false
}

/// Returns the text that is selected in any window, which X11's middle button pastes.
#[cfg(target_os = "linux")]
fn selected(clipboard: &mut arboard::Clipboard) -> Option<String> {
    arboard::GetExtLinux::clipboard(clipboard.get(), arboard::LinuxClipboardKind::Primary).text().ok()
}

/// Returns `None`: only X11 pastes selected text.
#[cfg(not(target_os = "linux"))]
fn selected(_: &mut arboard::Clipboard) -> Option<String> {
    None
}

/// Makes `text` the selected text of X11.
#[cfg(target_os = "linux")]
fn select(clipboard: &mut arboard::Clipboard, text: &str) {
    // Without a selection the middle button pastes what was selected before.
    let _ = arboard::SetExtLinux::clipboard(clipboard.set(), arboard::LinuxClipboardKind::Primary).text(text);
}

/// Does nothing: only X11 has selected text that other windows paste.
#[cfg(not(target_os = "linux"))]
fn select(_: &mut arboard::Clipboard, _: &str) {}
