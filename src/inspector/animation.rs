//! The scene's animation: it runs in the time of the wall, one capture after the other.
//!
//! The next moment is asked for when the last is shown, so nothing queues up: a slow technique shows
//! fewer moments, not later ones.

use super::action::Action;
use super::state::State;
use super::theme;
use egui::{Context, Ui};

/// Seconds of a step by hand.
const STEP: f64 = 1.0 / 30.0;
/// A pause in drawing is no jump in the scene: a moment lasts this long at most, seconds.
const LONGEST: f64 = 0.25;

/// Is it running, and since when is the shown moment on?
#[derive(Debug, Default)]
pub struct Animation {
    /// It runs.
    pub is_running: bool,
    /// egui's time when the last moment was asked for, seconds.
    last: Option<f64>,
}

impl Animation {
    /// Runs, or stops.
    pub fn toggle(&mut self) {
        self.is_running = !self.is_running;
        self.last = None;
    }
}

impl State {
    /// Does anything move in the open scene?
    #[must_use]
    pub fn is_animated(&self) -> bool {
        self.scene.as_ref().is_some_and(|scene| scene.animated)
    }

    /// Asks for the next moment, when the last one is shown.
    pub fn animate(&mut self, ctx: &Context, actions: &mut Vec<Action>) {
        if !self.animation.is_running || !self.is_animated() {
            self.animation.is_running = false;
            return;
        }
        if self.is_waiting {
            return;
        }
        let now = ctx.input(|input| input.time);
        let passed = self.animation.last.map_or(STEP, |last| (now - last).clamp(0.0, LONGEST));
        self.animation.last = Some(now);
        self.advance(passed, actions);
    }

    /// A step by hand; it stops a running animation.
    pub fn step_animation(&mut self, actions: &mut Vec<Action>) {
        self.animation.is_running = false;
        if self.is_animated() {
            self.advance(STEP, actions);
        }
    }

    fn advance(&mut self, seconds: f64, actions: &mut Vec<Action>) {
        if let Some(scene) = &mut self.scene {
            scene.draft.time += seconds;
            self.run_draft(actions);
        }
    }
}

/// The controls: run or stop, a frame on, back to the start.
pub fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    if !state.is_animated() {
        return;
    }
    theme::heading(ui, "Animation");
    ui.horizontal_wrapped(|ui| {
        let (word, hint) = if state.animation.is_running {
            ("Stop animation", "Stay at this moment (T)")
        } else {
            ("Run animation", "Objects and lights move; each shown moment is captured (T)")
        };
        if ui.button(word).on_hover_text(hint).clicked() {
            state.animation.toggle();
        }
        if ui.button("Step").on_hover_text("A thirtieth of a second on (.)").clicked() {
            state.step_animation(actions);
        }
        let is_started = state.scene.as_ref().is_some_and(|scene| scene.draft.time != 0.0);
        let back = ui.add_enabled(is_started, egui::Button::new("To the start"));
        if back.on_hover_text("The moment at which the scene was loaded").clicked()
            && let Some(scene) = &mut state.scene
        {
            scene.draft.time = 0.0;
            state.animation.is_running = false;
            state.run_draft(actions);
        }
    });
    ui.add_space(12.0);
}
