//! Walking through the scene: whether one does, how fast, and what is not shown yet of it. What keys and mouse do then is in
//! `shell/walk.rs`.

use super::Model;
use crate::inspector::action::Panel;
use egui::{Context, CursorGrab, Vec2, ViewportCommand};

/// Metres a second at first.
const SPEED: f64 = 2.0;

/// How one walks.
#[derive(Debug)]
pub struct Walk {
    is_on: bool,
    /// Walls stop.
    pub collides: bool,
    /// Metres a second.
    pub speed: f64,
    /// Why the last key did nothing.
    pub nothing_because: Option<String>,
    /// egui's time of the last step, seconds.
    pub last: Option<f64>,
    /// Mouse movement that no frame shows yet, points.
    pub turned: Vec2,
}

impl Default for Walk {
    fn default() -> Walk {
        Walk { is_on: false, collides: true, speed: SPEED, nothing_because: None, last: None, turned: Vec2::ZERO }
    }
}

impl Walk {
    /// Does one walk?
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.is_on
    }
}

impl Model {
    /// Begins to walk, where there is something to walk in.
    pub fn start_walking(&mut self, ctx: &Context) {
        if self.scene.is_none() || self.frame.capture.is_none() || self.walk.is_on {
            return;
        }
        self.walk = Walk { is_on: true, collides: self.walk.collides, speed: self.walk.speed, ..Walk::default() };
        self.requests.panels.push(Panel::Picture);
        if let Some(id) = ctx.memory(egui::Memory::focused) {
            ctx.memory_mut(|memory| memory.surrender_focus(id));
        }
        hold_pointer(ctx, true);
    }

    /// Stops to walk.
    pub fn stop_walking(&mut self, ctx: &Context) {
        if std::mem::take(&mut self.walk.is_on) {
            hold_pointer(ctx, false);
        }
    }
}

fn hold_pointer(ctx: &Context, is_held: bool) {
    let grab = if is_held { CursorGrab::Locked } else { CursorGrab::None };
    ctx.send_viewport_cmd(ViewportCommand::CursorGrab(grab));
    ctx.send_viewport_cmd(ViewportCommand::CursorVisible(!is_held));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pointer_is_held_and_hidden_and_let_go() {
        let ctx = Context::default();
        let sent = |is_held: bool| {
            let mut output = ctx.run_ui(egui::RawInput::default(), |ui| hold_pointer(ui.ctx(), is_held));
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
