//! Walking through the scene: whether the user walks, how fast, and which input no frame shows yet. What keys and mouse
//! do then is in `shell/walk.rs`.

use super::Model;
use crate::inspector::action::PanelKind;
use crate::scene::{Footing, Walls};
use egui::{Context, CursorGrab, Vec2, ViewportCommand};
use glam::DVec3;
use std::sync::Arc;

/// Initial speed, metres a second.
const SPEED: f64 = 2.0;

/// The state of walking.
#[derive(Debug)]
pub struct WalkState {
    is_on: bool,
    /// Walls stop the walker.
    pub collides: bool,
    /// Speed, metres a second.
    pub speed: f64,
    /// Why the last key did nothing.
    pub nothing_because: Option<String>,
    /// Gravity's state; `None`: the walker floats at the height of the eye.
    pub weight: Option<WalkGravity>,
    /// egui's time of the last step, seconds.
    pub last: Option<f64>,
    /// Mouse movement that no frame shows yet, points.
    pub rotation: Vec2,
}

/// The state of a walker with gravity.
#[derive(Debug, Default)]
pub struct WalkGravity {
    /// Where the walker stands or falls; `None` until the walls are known.
    pub standing: Option<Footing>,
    /// The walls for which that was computed: with others there may be no ground under the feet.
    pub within: Option<Arc<Walls>>,
    /// Where the feet stood last.
    pub stood_at: Option<DVec3>,
    /// Where the eye was when gravity was switched on.
    pub began_at: Option<DVec3>,
}

impl Default for WalkState {
    fn default() -> WalkState {
        WalkState {
            is_on: false,
            collides: true,
            speed: SPEED,
            nothing_because: None,
            weight: None,
            last: None,
            rotation: Vec2::ZERO,
        }
    }
}

impl WalkGravity {
    /// Returns whether the walker stands on the ground, and that was computed with the very same walls.
    pub fn is_at_rest(&self, walls: &Arc<Walls>) -> bool {
        let is_same = self.within.as_ref().is_some_and(|within| Arc::ptr_eq(within, walls));
        is_same && self.standing.is_some_and(|standing| standing.is_on_ground)
    }
}

impl WalkState {
    /// Returns whether the user is walking.
    pub fn is_on(&self) -> bool {
        self.is_on
    }
}

impl Model {
    /// Begins to walk: shows the Picture tab, takes the focus from other widgets and grabs the pointer. Does nothing
    /// where no scene is open, no capture is shown, or the user walks already; gravity, collisions and speed stay as
    /// set before.
    pub fn start_walking(&mut self, ctx: &Context) {
        if self.scene.is_none() || self.frame.capture.is_none() || self.walk.is_on {
            return;
        }
        let weight = self.walk.weight.as_ref().map(|_| WalkGravity::default());
        let WalkState { collides, speed, .. } = self.walk;
        self.walk = WalkState { is_on: true, collides, speed, weight, ..WalkState::default() };
        self.requests.panels.push(PanelKind::Picture);
        if let Some(id) = ctx.memory(egui::Memory::focused) {
            ctx.memory_mut(|memory| memory.surrender_focus(id));
        }
        hold_pointer(ctx, true);
    }

    /// Stops walking and releases the pointer; does nothing where the user does not walk.
    pub fn stop_walking(&mut self, ctx: &Context) {
        if std::mem::take(&mut self.walk.is_on) {
            hold_pointer(ctx, false);
        }
    }
}

fn hold_pointer(ctx: &Context, is_grabbed: bool) {
    let grab = if is_grabbed { CursorGrab::Locked } else { CursorGrab::None };
    ctx.send_viewport_cmd(ViewportCommand::CursorGrab(grab));
    ctx.send_viewport_cmd(ViewportCommand::CursorVisible(!is_grabbed));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pointer_is_held_and_hidden_and_let_go() {
        let ctx = Context::default();
        let sent = |is_grabbed: bool| {
            let mut output = ctx.run_ui(egui::RawInput::default(), |ui| hold_pointer(ui.ctx(), is_grabbed));
            output.textures_delta.clear();
            let is_of_pointer = |command: &ViewportCommand| {
                matches!(command, ViewportCommand::CursorGrab(_) | ViewportCommand::CursorVisible(_))
            };
            let all = output.viewport_output.values().flat_map(|output| output.commands.clone());
            all.filter(is_of_pointer).collect::<Vec<_>>()
        };
        let locked = [ViewportCommand::CursorGrab(CursorGrab::Locked), ViewportCommand::CursorVisible(false)];
        assert_eq!(sent(true), locked);
        assert_eq!(sent(false), [ViewportCommand::CursorGrab(CursorGrab::None), ViewportCommand::CursorVisible(true)]);
    }
}
