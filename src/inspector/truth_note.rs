//! What stands over the picture while truth or error is wished for and not there: how far the
//! tracing is, or why there is none.

use super::action::Action;
use super::legend;
use super::state::State;
use super::theme;
use super::view::{Shown, has_truth};
use egui::{Rect, RichText, Sense, Ui, UiBuilder, pos2, vec2};

/// Width of the note, points.
const WIDTH: f32 = 264.0;

/// How far the truth of the shown frame is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum TruthState {
    /// Nobody has asked for it.
    #[default]
    NotAsked,
    /// It is being traced.
    Running {
        /// Steps that are done.
        done: usize,
        /// Steps in all; 0 while they are not known.
        of: usize,
    },
    /// It was being traced, and was stopped.
    Cancelled,
    /// Why there is none, with the mend.
    Failed(String),
}

/// Draws the note into the upper left corner of `rect`; `shown` is what is shown meanwhile.
pub fn ui(ui: &mut Ui, state: &mut State, rect: Rect, shown: &Shown, actions: &mut Vec<Action>) {
    let is_known = state.capture.as_ref().is_some_and(|capture| has_truth(capture));
    if !state.view.kind.needs_truth() || is_known {
        return;
    }
    let width = WIDTH.min(rect.width() - 24.0 - legend::room(rect, shown)).max(96.0);
    let place = Rect::from_min_size(pos2(rect.left() + 12.0, rect.top() + 12.0), vec2(width, rect.height()));
    // Senses clicks, so that they do not reach the picture underneath.
    let builder = UiBuilder::new().max_rect(place).sense(Sense::CLICK | Sense::DRAG).id_salt("truth note");
    ui.scope_builder(builder, |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.set_width(width - 16.0);
            contents(ui, state, shown, actions);
        });
    });
}

fn contents(ui: &mut Ui, state: &mut State, shown: &Shown, actions: &mut Vec<Action>) {
    if state.scene.is_none() {
        ui.add(egui::Label::new("This folder has no truth: capture it with --truth.").wrap());
        return;
    }
    match state.truth.clone() {
        // It is asked for before this frame ends.
        TruthState::NotAsked => tracing(ui, state, shown, 0.0, actions),
        TruthState::Running { done, of } => tracing(ui, state, shown, done as f32 / of.max(1) as f32, actions),
        TruthState::Cancelled => {
            theme::heading(ui, "The truth was not traced.");
            ask_again(ui, state, "Trace it");
        }
        TruthState::Failed(reason) => {
            let text = format!("× There is no truth: {reason}");
            ui.add(egui::Label::new(RichText::new(text).color(theme::of(ui).error)).wrap());
            ask_again(ui, state, "Try again");
        }
    }
}

fn tracing(ui: &mut Ui, state: &mut State, shown: &Shown, share: f32, actions: &mut Vec<Action>) {
    theme::heading(ui, &format!("The truth is being traced … {:.0} %", share * 100.0));
    ui.horizontal(|ui| {
        if ui.button("Cancel").on_hover_text("Stop tracing the truth").clicked() {
            state.set_truth(TruthState::Cancelled);
            actions.push(Action::CancelJudge);
        }
        let bar = egui::ProgressBar::new(share).desired_width(ui.available_width()).desired_height(8.0);
        ui.add(bar).accessible_name("Tracing");
    });
    let meanwhile = if shown.is_older {
        "Shown is that of the frame before.".to_owned()
    } else {
        format!("Shown until then: {}.", shown.title)
    };
    ui.add(egui::Label::new(theme::note(meanwhile)).wrap());
}

fn ask_again(ui: &mut Ui, state: &mut State, words: &str) {
    if ui.button(words).on_hover_text("Trace the truth of this frame").clicked() {
        state.truth = TruthState::NotAsked;
    }
}
