//! Keys that act on the whole window: stepping by pass and by draw, playing, the search fields.
//!
//! They act while nothing, or a widget of the pass tree, has the focus; a text field or the
//! picture keeps its keys. Keys are consumed before widgets see them.

use super::modes::Phase;
use super::state::{State, StepSearch};
use egui::{Context, Key, Modifiers};

/// Acts on the keys of this frame.
pub fn handle(ctx: &Context, state: &mut State) {
    if state.dialog.is_some() {
        return;
    }
    let pressed = |modifiers, key| ctx.input_mut(|input| input.consume_key(modifiers, key));
    if pressed(Modifiers::COMMAND, Key::G) {
        open_search(state, StepSearch::GoTo(String::new()));
    } else if pressed(Modifiers::COMMAND, Key::F) {
        open_search(state, StepSearch::Find(String::new()));
    } else if pressed(Modifiers::COMMAND, Key::O) {
        state.dialog = Some(super::state::OpenDialog::default());
    }
    let focus = ctx.memory(egui::Memory::focused);
    if focus.is_some_and(|id| !state.tree_widgets.contains(&id)) || egui::Popup::is_any_open(ctx) {
        return;
    }
    // Several presses may come in one frame.
    let presses = |key| ctx.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as isize;
    let by = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
    if by != 0 {
        state.step_by(by);
    }
    let by = presses(Key::ArrowDown) - presses(Key::ArrowUp);
    if by != 0 {
        state.draw_by(by);
    } else if pressed(Modifiers::NONE, Key::Home) {
        state.select_step(0);
    } else if pressed(Modifiers::NONE, Key::End) {
        state.select_step(usize::MAX);
    } else if pressed(Modifiers::NONE, Key::Space) {
        state.toggle_play(ctx.input(|input| input.time));
    }
    picture_keys(ctx, state);
}

/// How the picture is looked at.
fn picture_keys(ctx: &Context, state: &mut State) {
    let pressed = |key| ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let phase = state.modes.phase;
    if pressed(Key::B) {
        state.modes.phase = if phase == Phase::Before { Phase::After } else { Phase::Before };
    } else if pressed(Key::D) {
        state.modes.phase = if phase == Phase::Diff { Phase::After } else { Phase::Diff };
    } else if pressed(Key::O) {
        state.modes.overlays.open_menu = true;
    } else if let Some(compare) = &mut state.modes.compare
        && pressed(Key::X)
    {
        compare.flipped = !compare.flipped;
    }
}

/// A widget of the pass tree keeps the arrows: they step, and do not move the focus.
pub fn keep_arrows(ui: &egui::Ui, response: &egui::Response) {
    if response.has_focus() {
        let arrows =
            egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..egui::EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    }
}

fn open_search(state: &mut State, search: StepSearch) {
    if state.steps() > 0 {
        state.search = Some(search);
        state.search_wants_focus = true;
    }
}
