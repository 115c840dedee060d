//! The keys: one table, which both handling and help read.
//!
//! The stepping keys always step, whatever has the focus, except a text field and widgets that arrows move themselves,
//! as a handle or a slider. Keys are consumed before widgets see them. What the mouse does on the picture and the keys
//! of walking are handled where they act; their descriptions are here, so that the help window lists all.

use crate::inspector::action::{Action, DialogKind, ExportKind};
use crate::inspector::canvas;
use crate::inspector::look::widgets;
use crate::inspector::model::looking::StepPhase;
use crate::inspector::model::{Model, StepSearch};
use egui::{Context, EventFilter, Id, Key, Modifiers};

/// A command that a key carries out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyCommand {
    /// Goes one pass back.
    PreviousPass,
    /// Goes one pass forward.
    NextPass,
    /// Goes one draw back.
    PreviousDraw,
    /// Goes one draw forward.
    NextDraw,
    /// Goes to the first pass.
    FirstPass,
    /// Goes to the last pass.
    LastPass,
    /// Steps through the frame, or stops.
    Play,
    /// Asks for a step's number.
    GoTo,
    /// Looks for a pass.
    Find,
    /// Opens the dialog that opens scenes.
    Open,
    /// Undoes the last change.
    Undo,
    /// Redoes the change that was undone last.
    Redo,
    /// Opens the dialog that saves the shown picture.
    Export,
    /// Opens the list of keys.
    Help,
    /// Runs the scene's animation, or stops it.
    Animate,
    /// Advances the animation by one step.
    AnimateStep,
    /// Switches between the dark and the light theme.
    Theme,
    /// Switches between the state before the step and the state after it.
    Before,
    /// Switches between what the step changed and what it left.
    Diff,
    /// Opens the menu of overlays.
    Overlays,
    /// Swaps the sides of a comparison.
    Flip,
    /// Picks a pixel of the next region in which the sides of a comparison differ.
    NextDifference,
    /// Picks a pixel of the region before.
    PreviousDifference,
    /// Moves the pick by so many pixels right and down.
    MovePick(i32, i32),
    /// Removes the pick.
    Unpick,
}

/// Where the keyboard focus has to be for a key to act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyScope {
    /// Any focus but a text field.
    Anywhere,
    /// Any focus but a text field and a widget that arrows move itself.
    Steps,
    /// Any focus but a text field and an open menu.
    Picture,
    /// The picture has the focus, or nothing: a focused button reacts to the key itself.
    Free,
}

/// A key with its modifiers, where it acts, its command, and words for the help.
#[derive(Debug, Clone, Copy)]
pub struct KeyBinding {
    /// The modifier keys that have to be pressed with it.
    pub modifiers: Modifiers,
    /// The key.
    pub key: Key,
    /// The focus in which it acts.
    pub scope: KeyScope,
    /// Its command.
    pub command: KeyCommand,
    /// The key in words.
    pub keys: &'static str,
    /// What it does, in words.
    pub does: &'static str,
}

const fn binding(
    modifiers: Modifiers,
    key: Key,
    scope: KeyScope,
    command: KeyCommand,
    keys: &'static str,
    does: &'static str,
) -> KeyBinding {
    KeyBinding { modifiers, key, scope, command, keys, does }
}

const REDO: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
const FAR: Modifiers = REDO;

/// Returns the binding of a key that moves the pick right and down by so many texels. It has no words: help describes
/// all of them in one line.
const fn move_pick(modifiers: Modifiers, key: Key, [right, down]: [i32; 2]) -> KeyBinding {
    binding(modifiers, key, KeyScope::Steps, KeyCommand::MovePick(right, down), "", "")
}

/// All keys. Of two entries with the same key the one with more modifiers comes first.
pub const BINDINGS: [KeyBinding; 35] = [
    move_pick(FAR, Key::ArrowLeft, [-10, 0]),
    move_pick(FAR, Key::ArrowRight, [10, 0]),
    move_pick(FAR, Key::ArrowUp, [0, -10]),
    move_pick(FAR, Key::ArrowDown, [0, 10]),
    move_pick(Modifiers::SHIFT, Key::ArrowLeft, [-1, 0]),
    move_pick(Modifiers::SHIFT, Key::ArrowRight, [1, 0]),
    move_pick(Modifiers::SHIFT, Key::ArrowUp, [0, -1]),
    move_pick(Modifiers::SHIFT, Key::ArrowDown, [0, 1]),
    binding(Modifiers::NONE, Key::Escape, KeyScope::Free, KeyCommand::Unpick, "Esc", "no pixel is picked"),
    binding(
        Modifiers::NONE,
        Key::ArrowLeft,
        KeyScope::Steps,
        KeyCommand::PreviousPass,
        "Left arrow",
        "the pass before",
    ),
    binding(Modifiers::NONE, Key::ArrowRight, KeyScope::Steps, KeyCommand::NextPass, "Right arrow", "the next pass"),
    binding(Modifiers::NONE, Key::ArrowUp, KeyScope::Steps, KeyCommand::PreviousDraw, "Up arrow", "the draw before"),
    binding(Modifiers::NONE, Key::ArrowDown, KeyScope::Steps, KeyCommand::NextDraw, "Down arrow", "the next draw"),
    binding(Modifiers::NONE, Key::Home, KeyScope::Steps, KeyCommand::FirstPass, "Home", "the first pass"),
    binding(Modifiers::NONE, Key::End, KeyScope::Steps, KeyCommand::LastPass, "End", "the last pass"),
    binding(Modifiers::NONE, Key::Space, KeyScope::Free, KeyCommand::Play, "Space", "play through the frame, or stop"),
    binding(Modifiers::COMMAND, Key::G, KeyScope::Anywhere, KeyCommand::GoTo, "Ctrl-G", "go to a step by its number"),
    binding(Modifiers::COMMAND, Key::F, KeyScope::Anywhere, KeyCommand::Find, "Ctrl-F", "find a pass"),
    binding(
        Modifiers::COMMAND,
        Key::O,
        KeyScope::Anywhere,
        KeyCommand::Open,
        "Ctrl-O",
        "open a scene, a model or a capture",
    ),
    binding(REDO, Key::Z, KeyScope::Anywhere, KeyCommand::Redo, "Ctrl-Shift-Z, Ctrl-Y", "redo"),
    binding(Modifiers::COMMAND, Key::Y, KeyScope::Anywhere, KeyCommand::Redo, "", ""),
    binding(
        Modifiers::COMMAND,
        Key::Z,
        KeyScope::Anywhere,
        KeyCommand::Undo,
        "Ctrl-Z",
        "undo a change of scene or technique",
    ),
    binding(Modifiers::COMMAND, Key::S, KeyScope::Anywhere, KeyCommand::Export, "Ctrl-S", "export the shown picture"),
    binding(
        Modifiers::NONE,
        Key::T,
        KeyScope::Picture,
        KeyCommand::Animate,
        "T",
        "run the scene's animation, or stop it",
    ),
    binding(Modifiers::NONE, Key::Period, KeyScope::Picture, KeyCommand::AnimateStep, ".", "the animation, a frame on"),
    binding(Modifiers::COMMAND, Key::L, KeyScope::Anywhere, KeyCommand::Theme, "Ctrl-L", "light or dark theme"),
    binding(
        Modifiers::NONE,
        Key::B,
        KeyScope::Picture,
        KeyCommand::Before,
        "B",
        "the picture before the step, or after it",
    ),
    binding(
        Modifiers::NONE,
        Key::D,
        KeyScope::Picture,
        KeyCommand::Diff,
        "D",
        "what the step changed; comparing: where the sides differ",
    ),
    binding(Modifiers::NONE, Key::O, KeyScope::Picture, KeyCommand::Overlays, "O", "the menu of overlays"),
    binding(Modifiers::NONE, Key::X, KeyScope::Picture, KeyCommand::Flip, "X", "swap the sides of a comparison"),
    binding(Modifiers::SHIFT, Key::N, KeyScope::Picture, KeyCommand::PreviousDifference, "", ""),
    binding(
        Modifiers::NONE,
        Key::N,
        KeyScope::Picture,
        KeyCommand::NextDifference,
        "N, Shift-N",
        "to the next region in which the sides differ, or back",
    ),
    binding(Modifiers::NONE, Key::F1, KeyScope::Anywhere, KeyCommand::Help, "F1, H, ?", "this help"),
    binding(Modifiers::NONE, Key::H, KeyScope::Picture, KeyCommand::Help, "", ""),
    binding(Modifiers::NONE, Key::Questionmark, KeyScope::Picture, KeyCommand::Help, "", ""),
];

/// The actions of the mouse on the picture, and of keys on the pick: key, description.
pub const PICTURE: [(&str, &str); 7] = [
    ("Click, right drag", "pick a pixel: its history is shown beside"),
    ("Wheel", "zoom at the pointer"),
    ("Left drag", "move the picture"),
    ("Shift-arrow keys", "move the pick by a pixel; with Ctrl too, by ten"),
    ("Double click on an event", "go to the step that made it"),
    ("Page Down, Page Up", "during a tour: the next stop, the stop before"),
    ("Tab, Shift-Tab", "from widget to widget; Enter or Space presses it"),
];

/// The keys that change how large everything is, which egui handles itself: keys, description.
pub const ZOOM: (&str, &str) = ("Ctrl-+, Ctrl-−, Ctrl-0", "everything larger, smaller, of its usual size");

/// What had the focus in the previous frame. Escape takes the focus away before any key is looked at.
#[derive(Debug, Default)]
pub struct FocusBefore {
    widget: Option<Id>,
    is_typing: bool,
}

/// Carries out the commands of the keys that were pressed in this frame where their scope allows it, and consumes those
/// keys; nothing while the open or export dialog is open. `before` is the focus at the end of the last frame.
pub fn handle(ctx: &Context, before: &FocusBefore, model: &mut Model, actions: &mut Vec<Action>) {
    if matches!(model.dialog, Some(DialogKind::Open | DialogKind::Export(_))) {
        return;
    }
    let focus = ctx.memory(egui::Memory::focused);
    let is_in_menu = egui::Popup::is_any_open(ctx);
    let is_typing = ctx.text_edit_focused();
    let is_free = |focus: Option<Id>| focus.is_none_or(|id| id == canvas::picture_id());
    for binding in &BINDINGS {
        let acts = match binding.scope {
            KeyScope::Anywhere => !is_typing || binding.modifiers == Modifiers::NONE || !edits_text(binding.command),
            KeyScope::Steps => !is_typing && !is_in_menu && !widgets::has_own_arrows(ctx, focus),
            KeyScope::Picture => !is_typing && !is_in_menu,
            KeyScope::Free => {
                is_free(focus) && is_free(before.widget) && !before.is_typing && !is_in_menu && model.dialog.is_none()
            }
        };
        if !acts {
            continue;
        }
        // A key may be pressed several times in one frame.
        let presses = ctx.input_mut(|input| input.count_and_consume_key(binding.modifiers, binding.key));
        if presses > 0 {
            act(ctx, model, binding.command, presses, actions);
        }
    }
}

/// Returns what has the focus at the end of a frame, and prevents arrow keys from moving the focus to another widget,
/// as they step through the frame; not while text is edited or a menu is open.
pub fn remember(ctx: &Context) -> FocusBefore {
    let widget = ctx.memory(egui::Memory::focused);
    let is_typing = ctx.text_edit_focused();
    if let Some(id) = widget.filter(|_| !is_typing && !egui::Popup::is_any_open(ctx)) {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ctx.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
    }
    FocusBefore { widget, is_typing }
}

/// Returns whether a text field uses the command's key to edit its text: undo and redo.
fn edits_text(command: KeyCommand) -> bool {
    matches!(command, KeyCommand::Undo | KeyCommand::Redo)
}

/// Carries out a command as often as its key was pressed in the frame, where repeating it has a meaning.
pub fn act(ctx: &Context, model: &mut Model, command: KeyCommand, presses: usize, actions: &mut Vec<Action>) {
    let by = presses as isize;
    match command {
        KeyCommand::PreviousPass => model.step_by(-by),
        KeyCommand::NextPass => model.step_by(by),
        KeyCommand::PreviousDraw => model.draw_by(-by),
        KeyCommand::NextDraw => model.draw_by(by),
        KeyCommand::FirstPass => model.select_step(0),
        KeyCommand::LastPass => model.select_step(usize::MAX),
        KeyCommand::Play => model.toggle_play(ctx.input(|input| input.time)),
        KeyCommand::GoTo => open_search(model, StepSearch::GoTo(String::new())),
        KeyCommand::Find => open_search(model, StepSearch::Find(String::new())),
        KeyCommand::Open => model.dialog = Some(DialogKind::Open),
        KeyCommand::Undo => model.take_back(actions),
        KeyCommand::Redo => model.make_again(actions),
        KeyCommand::Export => model.dialog = Some(DialogKind::Export(ExportKind::Picture)),
        KeyCommand::Help => {
            let is_open = model.dialog == Some(DialogKind::Help);
            model.dialog = (!is_open).then_some(DialogKind::Help);
        }
        KeyCommand::Animate => model.animation.toggle(),
        KeyCommand::AnimateStep => model.step_animation(actions),
        KeyCommand::Theme => model.theme = model.theme.other(),
        KeyCommand::Before => toggle_phase(model, StepPhase::Before),
        KeyCommand::Diff => toggle_phase(model, StepPhase::Diff),
        KeyCommand::Overlays => model.requests.overlay_menu = true,
        KeyCommand::MovePick(right, down) => model.move_pick([right * presses as i32, down * presses as i32]),
        KeyCommand::Unpick => model.selection.pick = None,
        KeyCommand::NextDifference => model.requests.differing_regions += presses as isize,
        KeyCommand::PreviousDifference => model.requests.differing_regions -= presses as isize,
        KeyCommand::Flip => {
            if let Some(compare) = &mut model.modes.compare {
                compare.flipped = !compare.flipped;
            }
        }
    }
}

/// Switches between a phase and [`StepPhase::After`].
fn toggle_phase(model: &mut Model, phase: StepPhase) {
    model.modes.phase = if model.modes.phase == phase { StepPhase::After } else { phase };
}

fn open_search(model: &mut Model, search: StepSearch) {
    if model.steps() > 0 {
        model.requests.search = Some(search);
    }
}
