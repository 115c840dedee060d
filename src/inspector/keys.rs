//! The keys: one table, that handling and help both read.
//!
//! Commands act anywhere, or only while nothing or a widget of the pass tree has the focus; a text
//! field or the picture keeps its keys. Keys are consumed before widgets see them. The keys of the
//! picture and of walking are handled where they act; their words are here, so that the help window
//! lists all.

use super::action::Action;
use super::export::ExportDialog;
use super::state::{OpenDialog, State, StepSearch};
use egui::{Context, Key, Modifiers};

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// One pass back.
    PreviousPass,
    /// One pass on.
    NextPass,
    /// One draw back.
    PreviousDraw,
    /// One draw on.
    NextDraw,
    /// To the first pass.
    FirstPass,
    /// To the last pass.
    LastPass,
    /// Steps through the frame, or stops.
    Play,
    /// Asks for a step's number.
    GoTo,
    /// Looks for a pass.
    Find,
    /// Opens the dialog that opens scenes.
    Open,
    /// Takes the last change back.
    Undo,
    /// Makes it again.
    Redo,
    /// Opens the dialog that saves the shown picture.
    Export,
    /// The list of keys.
    Help,
    /// Runs the scene's animation, or stops it.
    Animate,
    /// The animation, one step on.
    AnimateStep,
    /// Dark or light.
    Theme,
}

/// Where a key acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// Wherever the focus is, but for a text field.
    Anywhere,
    /// While nothing or the tree of passes has the focus.
    Passes,
}

/// A key and what it does.
#[derive(Debug, Clone, Copy)]
pub struct Binding {
    /// Held with it.
    pub modifiers: Modifiers,
    /// The key.
    pub key: Key,
    /// Where it acts.
    pub scope: Scope,
    /// What it does.
    pub command: Command,
    /// The key in words.
    pub keys: &'static str,
    /// What it does, in words.
    pub does: &'static str,
}

const fn binding(
    modifiers: Modifiers,
    key: Key,
    scope: Scope,
    command: Command,
    keys: &'static str,
    does: &'static str,
) -> Binding {
    Binding { modifiers, key, scope, command, keys, does }
}

const REDO: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// All of them. Of two with the same key the one with more modifiers stands first.
pub const BINDINGS: [Binding; 20] = [
    binding(Modifiers::NONE, Key::ArrowLeft, Scope::Passes, Command::PreviousPass, "Left", "the pass before"),
    binding(Modifiers::NONE, Key::ArrowRight, Scope::Passes, Command::NextPass, "Right", "the next pass"),
    binding(Modifiers::NONE, Key::ArrowUp, Scope::Passes, Command::PreviousDraw, "Up", "the draw before"),
    binding(Modifiers::NONE, Key::ArrowDown, Scope::Passes, Command::NextDraw, "Down", "the next draw"),
    binding(Modifiers::NONE, Key::Home, Scope::Passes, Command::FirstPass, "Home", "the first pass"),
    binding(Modifiers::NONE, Key::End, Scope::Passes, Command::LastPass, "End", "the last pass"),
    binding(Modifiers::NONE, Key::Space, Scope::Passes, Command::Play, "Space", "play through the frame, or stop"),
    binding(Modifiers::COMMAND, Key::G, Scope::Anywhere, Command::GoTo, "Ctrl-G", "go to a step by its number"),
    binding(Modifiers::COMMAND, Key::F, Scope::Anywhere, Command::Find, "Ctrl-F", "find a pass"),
    binding(Modifiers::COMMAND, Key::O, Scope::Anywhere, Command::Open, "Ctrl-O", "open a scene, a model or a capture"),
    binding(REDO, Key::Z, Scope::Anywhere, Command::Redo, "Ctrl-Shift-Z", "redo"),
    binding(Modifiers::COMMAND, Key::Y, Scope::Anywhere, Command::Redo, "Ctrl-Y", "redo"),
    binding(
        Modifiers::COMMAND,
        Key::Z,
        Scope::Anywhere,
        Command::Undo,
        "Ctrl-Z",
        "undo a change of scene or technique",
    ),
    binding(Modifiers::COMMAND, Key::S, Scope::Anywhere, Command::Export, "Ctrl-S", "export the shown picture"),
    binding(Modifiers::NONE, Key::T, Scope::Passes, Command::Animate, "T", "run the scene's animation, or stop it"),
    binding(Modifiers::NONE, Key::Period, Scope::Passes, Command::AnimateStep, ".", "the animation, a frame on"),
    binding(Modifiers::COMMAND, Key::L, Scope::Anywhere, Command::Theme, "Ctrl-L", "light or dark theme"),
    binding(Modifiers::NONE, Key::F1, Scope::Anywhere, Command::Help, "F1", "this help"),
    binding(Modifiers::NONE, Key::H, Scope::Passes, Command::Help, "H", "this help"),
    binding(Modifiers::NONE, Key::Questionmark, Scope::Passes, Command::Help, "?", "this help"),
];

/// Keys of the picture while it has the focus, and what the mouse does on it: key, what it does.
pub const PICTURE: [(&str, &str); 6] = [
    ("Right click, right drag", "pick a pixel: its history is told beside"),
    ("Wheel", "zoom at the pointer"),
    ("Left drag", "move the picture"),
    ("Arrow keys", "move the pick by a pixel"),
    ("Double click on an event", "go to the step that made it"),
    ("Tab, Shift-Tab", "from widget to widget; Enter or Space presses it"),
];

/// Acts on the keys of this frame.
pub fn handle(ctx: &Context, state: &mut State, actions: &mut Vec<Action>) {
    if state.dialog.is_some() || state.export.dialog.is_some() {
        return;
    }
    let focus = ctx.memory(egui::Memory::focused);
    let is_elsewhere = focus.is_some_and(|id| !state.tree_widgets.contains(&id)) || egui::Popup::is_any_open(ctx);
    let is_typing = ctx.text_edit_focused();
    for binding in &BINDINGS {
        let acts = match binding.scope {
            Scope::Anywhere => !is_typing || binding.modifiers == Modifiers::NONE || !edits_text(binding.command),
            Scope::Passes => !is_elsewhere,
        };
        if !acts {
            continue;
        }
        // Several presses may come in one frame.
        let presses = ctx.input_mut(|input| input.count_and_consume_key(binding.modifiers, binding.key));
        if presses > 0 {
            act(ctx, state, binding.command, presses, actions);
        }
    }
}

/// A text field has these keys for its own text.
fn edits_text(command: Command) -> bool {
    matches!(command, Command::Undo | Command::Redo)
}

/// Does what a key says.
pub fn act(ctx: &Context, state: &mut State, command: Command, presses: usize, actions: &mut Vec<Action>) {
    let by = presses as isize;
    match command {
        Command::PreviousPass => state.step_by(-by),
        Command::NextPass => state.step_by(by),
        Command::PreviousDraw => state.draw_by(-by),
        Command::NextDraw => state.draw_by(by),
        Command::FirstPass => state.select_step(0),
        Command::LastPass => state.select_step(usize::MAX),
        Command::Play => state.toggle_play(ctx.input(|input| input.time)),
        Command::GoTo => open_search(state, StepSearch::GoTo(String::new())),
        Command::Find => open_search(state, StepSearch::Find(String::new())),
        Command::Open => state.dialog = Some(OpenDialog::default()),
        Command::Undo => state.undo(actions),
        Command::Redo => state.redo(actions),
        Command::Export => state.export.dialog = ExportDialog::first(state),
        Command::Help => state.help_is_open = !state.help_is_open,
        Command::Animate => state.animation.toggle(),
        Command::AnimateStep => state.step_animation(actions),
        Command::Theme => state.theme = state.theme.other(),
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
