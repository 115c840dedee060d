//! The scene's animation: it runs in the time of the wall, one capture after the other.
//!
//! The next moment is asked for when the last is shown, so nothing queues up: a slow technique shows
//! fewer moments, not later ones.

use super::Model;
use crate::inspector::action::Action;

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

impl Model {
    /// Does anything move in the open scene?
    pub fn is_animated(&self) -> bool {
        self.scene.as_ref().is_some_and(|scene| scene.animated)
    }

    /// Asks for the next moment, when the last one is shown. `now`: egui's time, seconds.
    pub fn animate(&mut self, now: f64, actions: &mut Vec<Action>) {
        if !self.animation.is_running || !self.is_animated() {
            self.animation.is_running = false;
            return;
        }
        if self.activity.is_waiting {
            return;
        }
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
