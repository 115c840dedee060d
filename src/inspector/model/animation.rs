//! The scene's animation: it runs in real time, one capture after the other.
//!
//! The next time is asked for when the last one is shown, so nothing queues up: a slow technique shows fewer frames,
//! not later ones.

use super::Model;
use crate::inspector::action::Action;

/// Length of a single step by hand, seconds.
const STEP: f64 = 1.0 / 30.0;
/// The scene's time advances by at most this much a frame, seconds, so that a pause in drawing is no jump in the scene.
const LONGEST: f64 = 0.25;

/// Whether the animation is running, and when its last frame was asked for.
#[derive(Debug, Default)]
pub struct Animation {
    /// It runs.
    pub is_running: bool,
    /// egui's time when the last frame was asked for, seconds.
    last: Option<f64>,
}

impl Animation {
    /// Starts the animation, or stops it if it is running.
    pub fn toggle(&mut self) {
        self.is_running = !self.is_running;
        self.last = None;
    }
}

impl Model {
    /// Does anything move in the open scene?
    pub fn is_animated(&self) -> bool {
        self.scene.as_ref().is_some_and(|scene| scene.animated)
    }

    /// Advances the scene's time by what has passed since the last frame (at most 0.25 s) and runs it, unless a run or the
    /// frame that it is compared with is still awaited. Stops the animation where nothing in the scene moves. `now` is egui's time, seconds.
    pub fn animate(&mut self, now: f64, actions: &mut Vec<Action>) {
        if !self.animation.is_running || !self.is_animated() {
            self.animation.is_running = false;
            return;
        }
        // Both sides of a comparison show each moment.
        if self.activity.is_waiting || self.is_comparison_behind() {
            return;
        }
        let passed = self.animation.last.map_or(STEP, |last| (now - last).clamp(0.0, LONGEST));
        self.animation.last = Some(now);
        self.advance(passed, actions);
    }

    /// Advances the scene's time by 1/30 s and runs it; does nothing where nothing moves. Stops a running animation in
    /// any case.
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
