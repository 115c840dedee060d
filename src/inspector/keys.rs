//! Keys that work whatever the pointer is over.
//!
//! Arrows, Home, End and Space step while no text is edited and the picture has not the focus
//! (there, arrows nudge the pick). Ctrl-G goes to a number, Ctrl-F finds a pass.

use super::{PictureKind, State, picture};
use egui::{Key, Modifiers, Ui};

pub(super) fn handle(ui: &Ui, state: &mut State) {
    let context = ui.ctx();
    let pressed = |modifiers, key| context.input_mut(|input| input.consume_key(modifiers, key));
    if pressed(Modifiers::COMMAND, Key::G) {
        state.go_to = Some(String::new());
    }
    if pressed(Modifiers::COMMAND, Key::F) {
        state.find = Some(String::new());
    }
    if pressed(Modifiers::COMMAND, Key::O) {
        state.open = Some(String::new());
    }
    if context.text_edit_focused() || state.open.is_some() {
        return;
    }
    let plain = |key| pressed(Modifiers::NONE, key);
    if context.memory(|memory| memory.focused()) == Some(picture::focus_id()) {
        nudge(state, plain);
    } else if plain(Key::ArrowRight) {
        state.go_to_step(state.step + 1);
    } else if plain(Key::ArrowLeft) {
        state.go_to_step(state.step.saturating_sub(1));
    }
    if plain(Key::Home) {
        state.go_to_step(0);
    }
    if plain(Key::End) {
        state.go_to_step(usize::MAX);
    }
    if context.memory(|memory| memory.focused()).is_none_or(|id| id == picture::focus_id()) && plain(Key::Space) {
        state.toggle_playing();
    }
    for (key, kind) in [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5].into_iter().zip(PictureKind::ALL) {
        if plain(key) && state.available().contains(&kind) {
            state.picture = kind;
        }
    }
}

fn nudge(state: &mut State, pressed: impl Fn(Key) -> bool) {
    let Some([x, y]) = state.pick else { return };
    let Some([width, height]) = state.capture.as_ref().map(|capture| capture.size) else { return };
    let step = |at: u32, back: Key, on: Key, length: u32| {
        let moved = at + u32::from(pressed(on));
        moved.saturating_sub(u32::from(pressed(back))).min(length.saturating_sub(1))
    };
    state.pick = Some([step(x, Key::ArrowLeft, Key::ArrowRight, width), step(y, Key::ArrowUp, Key::ArrowDown, height)]);
}
