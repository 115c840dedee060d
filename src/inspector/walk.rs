//! Walking: the mouse looks, W S A D move, and other keys change what is seen, until Escape.
//!
//! Only while one walks these keys act, and no others do. The pointer is hidden and held in the window.
//! A new frame is asked for when the last one is shown, so nothing queues up: a slow technique moves in
//! larger steps, not later. Walls are asked for whenever objects are switched off, move or are loaded anew;
//! until they come the walls before count.

use super::action::{Action, RunRequest};
use super::dock::Panel;
use super::overlays::Overlay;
use super::state::State;
use super::theme;
use super::view::PictureKind;
use crate::scene::{Camera, Walls};
use crate::technique::Technique;
use egui::{Context, CursorGrab, Event, FocusDirection, Key, Rect, Ui, UiBuilder, Vec2, ViewportCommand, vec2};
use glam::{DQuat, DVec3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Degrees that a point of mouse movement turns.
const TURN: f64 = 0.12;
/// One looks up and down so far at most, degrees.
const MOST_PITCH: f64 = 88.0;
/// Metres a second at first, and what a press of < or > makes of it.
const SPEED: f64 = 2.0;
const FASTER: f64 = 1.5;
const SPEED_LIMITS: [f64; 2] = [0.02, 500.0];
/// A pause in drawing is no jump: a step lasts so long at most, seconds.
const LONGEST: f64 = 0.25;
/// Half the width of who walks, metres, and what of the near plane's distance it is at least.
const RADIUS: f64 = 0.25;
const RADIUS_OF_NEAR: f64 = 1.5;
/// Sizes of shadow maps.
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
/// Height of the banner over the picture, points.
const BANNER_HEIGHT: f32 = 56.0;
/// What P goes through.
const TECHNIQUES: [Technique; 5] =
    [Technique::None, Technique::Planar, Technique::Projective, Technique::ZFail, Technique::ShadowMap];

/// What a key does while one walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalkCommand {
    /// While it is held, one walks this way: ahead, and to the right.
    Go(i8, i8),
    /// The next technique.
    Technique,
    /// Walls stop, or do not.
    Collision,
    /// Slower.
    Slower,
    /// Faster.
    Faster,
    /// The next thing over the picture that makes shadows.
    Overlay,
    /// The next size of the shadow map.
    MapSize,
    /// The lamp swings, or stops.
    Swing,
    /// Ends it.
    Leave,
}

/// A key, and what it does while one walks.
#[derive(Debug, Clone, Copy)]
pub struct WalkKey {
    /// The key.
    pub key: Key,
    /// In words.
    pub keys: &'static str,
    /// What it does.
    pub command: WalkCommand,
    /// In words.
    pub does: &'static str,
}

const fn key(key: Key, keys: &'static str, command: WalkCommand, does: &'static str) -> WalkKey {
    WalkKey { key, keys, command, does }
}

/// All of them: handling and help both read this.
pub const KEYS: [WalkKey; 12] = [
    key(Key::W, "W", WalkCommand::Go(1, 0), "walk ahead"),
    key(Key::S, "S", WalkCommand::Go(-1, 0), "walk back"),
    key(Key::A, "A", WalkCommand::Go(0, -1), "walk to the left"),
    key(Key::D, "D", WalkCommand::Go(0, 1), "walk to the right"),
    key(Key::P, "P", WalkCommand::Technique, "no shadow, planar, projective, volume, shadow map"),
    key(Key::C, "C", WalkCommand::Collision, "walls stop, or do not"),
    key(Key::Comma, "<", WalkCommand::Slower, "slower"),
    key(Key::Period, ">", WalkCommand::Faster, "faster"),
    key(Key::V, "V", WalkCommand::Overlay, "silhouettes, volumes, shadow, or nothing over the picture"),
    key(Key::I, "I", WalkCommand::MapSize, "the shadow map's size"),
    key(Key::L, "L", WalkCommand::Swing, "the lamp swings, or stops"),
    key(Key::Escape, "Esc", WalkCommand::Leave, "stop walking, free the pointer"),
];

/// How one walks.
#[derive(Debug)]
pub struct Walk {
    is_on: bool,
    collides: bool,
    /// Metres a second.
    speed: f64,
    /// egui's time of the last step, seconds.
    last: Option<f64>,
    /// Mouse movement that no frame shows yet, points.
    turned: Vec2,
    walls: Option<Arc<Walls>>,
    /// Which walls were asked for last.
    asked: Option<WallsOf>,
}

/// What decides where walls are in an open scene.
#[derive(Debug, Clone, PartialEq)]
struct WallsOf {
    /// Objects that are switched off.
    off: BTreeSet<usize>,
    /// The moment, seconds; 0 where nothing moves.
    time: f64,
}

impl Default for Walk {
    fn default() -> Walk {
        Walk { is_on: false, collides: true, speed: SPEED, last: None, turned: Vec2::ZERO, walls: None, asked: None }
    }
}

impl Walk {
    /// Does one walk?
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Another scene has other walls.
    pub fn forget_walls(&mut self) {
        self.walls = None;
        self.asked = None;
    }

    /// The answer to what was asked for last.
    pub fn set_walls(&mut self, walls: Arc<Walls>) {
        self.walls = Some(walls);
    }

    /// Asks for the walls of what is to be run, where these are not the ones that were asked for last.
    fn ask_for_walls(&mut self, draft: &RunRequest, is_animated: bool, actions: &mut Vec<Action>) {
        let wanted = WallsOf { off: draft.off.clone(), time: if is_animated { draft.time } else { 0.0 } };
        if self.asked.as_ref() != Some(&wanted) {
            self.asked = Some(wanted);
            actions.push(Action::Walls(Box::new(draft.clone())));
        }
    }
}

impl State {
    /// Begins to walk, where there is something to walk in.
    pub fn start_walking(&mut self, ctx: &Context) {
        if self.scene.is_none() || self.capture.is_none() || self.walk.is_on {
            return;
        }
        self.walk = Walk { is_on: true, collides: self.walk.collides, speed: self.walk.speed, ..Walk::default() };
        self.wants_panel.push(Panel::Picture);
        if let Some(id) = ctx.memory(egui::Memory::focused) {
            ctx.memory_mut(|memory| memory.surrender_focus(id));
        }
        hold_pointer(ctx, true);
    }

    /// Stops to walk.
    pub fn stop_walking(&mut self, ctx: &Context) {
        if std::mem::take(&mut self.walk.is_on) {
            self.walk.forget_walls();
            hold_pointer(ctx, false);
        }
    }
}

fn hold_pointer(ctx: &Context, is_held: bool) {
    let grab = if is_held { CursorGrab::Locked } else { CursorGrab::None };
    ctx.send_viewport_cmd(ViewportCommand::CursorGrab(grab));
    ctx.send_viewport_cmd(ViewportCommand::CursorVisible(!is_held));
}

/// Acts on keys and mouse of this frame while one walks; true then, and no other keys are to act.
pub fn handle(ctx: &Context, state: &mut State, actions: &mut Vec<Action>) -> bool {
    if !state.walk.is_on {
        return begins(ctx, state);
    }
    let asks_for_help = ctx.input(|input| input.key_pressed(Key::F1) || input.key_pressed(Key::H));
    let is_elsewhere =
        asks_for_help || state.scene.is_none() || state.dialog.is_some() || !ctx.input(|input| input.focused);
    if is_elsewhere {
        state.stop_walking(ctx);
        return false;
    }
    let typed = |text: &str| ctx.input(|input| input.events.contains(&Event::Text(text.to_owned())));
    for walk_key in &KEYS {
        let presses = ctx.input_mut(|input| input.count_and_consume_key(egui::Modifiers::NONE, walk_key.key));
        // Where < and > have a key of their own, or are typed with other ones.
        let is_typed = match walk_key.command {
            WalkCommand::Slower | WalkCommand::Faster => typed(walk_key.keys),
            _ => false,
        };
        for _ in 0..presses.max(usize::from(is_typed)) {
            act(ctx, state, walk_key.command, actions);
        }
    }
    if !state.walk.is_on {
        return true;
    }
    if let Some(scene) = state.scene.as_ref().filter(|_| state.walk.collides) {
        state.walk.ask_for_walls(&scene.draft, scene.animated, actions);
    }
    step(ctx, state, actions);
    true
}

/// Tab while the pointer is over the picture; else it goes from widget to widget, on from the picture too,
/// so that who has no pointer does not get stuck there.
fn begins(ctx: &Context, state: &mut State) -> bool {
    let is_dialog = state.dialog.is_some() || state.export.dialog.is_some() || state.help_is_open;
    let is_free = !is_dialog && !ctx.text_edit_focused() && !egui::Popup::is_any_open(ctx);
    let focus = ctx.memory(egui::Memory::focused);
    let is_picture = state.hover.is_some() && (focus.is_none() || focus == state.picture_widget);
    let is_shifted = ctx.input(|input| input.modifiers.any());
    if !(is_free && is_picture && !is_shifted && state.scene.is_some()) {
        return false;
    }
    let is_pressed = ctx.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Tab));
    if is_pressed {
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        state.start_walking(ctx);
    }
    is_pressed
}

fn act(ctx: &Context, state: &mut State, command: WalkCommand, actions: &mut Vec<Action>) {
    let [slowest, fastest] = SPEED_LIMITS;
    match command {
        // As long as it is held: see `step`.
        WalkCommand::Go(..) => {}
        WalkCommand::Technique => {
            let now = state.scene.as_ref().map(|scene| scene.draft.choice.technique());
            let place = TECHNIQUES.iter().position(|one| Some(*one) == now);
            let next = TECHNIQUES[place.map_or(0, |place| (place + 1) % TECHNIQUES.len())];
            state.choose_technique(next, actions);
        }
        WalkCommand::Collision => state.walk.collides = !state.walk.collides,
        WalkCommand::Slower => state.walk.speed = (state.walk.speed / FASTER).max(slowest),
        WalkCommand::Faster => state.walk.speed = (state.walk.speed * FASTER).min(fastest),
        WalkCommand::Overlay => next_overlay(state),
        WalkCommand::MapSize => next_size(state, actions),
        WalkCommand::Swing => state.animation.toggle(),
        WalkCommand::Leave => state.stop_walking(ctx),
    }
}

/// Over the picture: silhouettes, then volumes, then the shadow alone, then nothing.
fn next_overlay(state: &mut State) {
    let on = &mut state.modes.overlays.on;
    let has = |overlay| on.contains(&overlay);
    let (lines, kind) = match (has(Overlay::Silhouettes), has(Overlay::Volumes), state.view.kind) {
        (true, _, _) => (Some(Overlay::Volumes), PictureKind::Color),
        (_, true, _) => (None, PictureKind::Mask),
        (_, _, PictureKind::Mask) => (None, PictureKind::Color),
        _ => (Some(Overlay::Silhouettes), PictureKind::Color),
    };
    on.remove(&Overlay::Silhouettes);
    on.remove(&Overlay::Volumes);
    on.extend(lines);
    state.choose_picture(kind);
}

fn next_size(state: &mut State, actions: &mut Vec<Action>) {
    let Some(scene) = &mut state.scene else { return };
    let now = scene.draft.choice.texels();
    let Some(now) = now else { return };
    let next = SIZES.into_iter().find(|size| *size > now).unwrap_or(SIZES[0]);
    match scene.draft.choice.set("size", &next.to_string()) {
        Ok(()) => state.run_draft(actions),
        Err(error) => scene.problem = Some(error.to_string()),
    }
}

/// Turns and moves the camera by what was asked since the last step, once that one is shown.
fn step(ctx: &Context, state: &mut State, actions: &mut Vec<Action>) {
    let held = |key| ctx.input(|input| input.key_down(key));
    let goes: DVec3 = KEYS.iter().filter(|key| held(key.key)).map(|key| way(key.command)).sum();
    state.walk.turned += ctx.input(|input| input.pointer.motion()).unwrap_or(Vec2::ZERO);
    let now = ctx.input(|input| input.time);
    if goes == DVec3::ZERO {
        state.walk.last = None;
    } else {
        ctx.request_repaint();
    }
    let has_walls = !state.walk.collides || state.walk.walls.is_some();
    if state.is_waiting || !has_walls || (goes == DVec3::ZERO && state.walk.turned == Vec2::ZERO) {
        return;
    }
    let passed = state.walk.last.map_or(1.0 / 60.0, |last| (now - last).clamp(0.0, LONGEST));
    state.walk.last = Some(now).filter(|_| goes != DVec3::ZERO);
    let turned = std::mem::take(&mut state.walk.turned);
    let Some(scene) = &mut state.scene else { return };
    let before = scene.draft.camera;
    turn(&mut scene.draft.camera, turned);
    let by = direction(&scene.draft.camera, goes, !state.walk.collides) * (state.walk.speed * passed);
    let radius = RADIUS.max(before.near * RADIUS_OF_NEAR);
    let walls = state.walk.walls.as_ref().filter(|_| state.walk.collides);
    let eye = walls.map_or(before.eye + by, |walls| walls.walk(before.eye, by, radius));
    scene.draft.camera.target += eye - before.eye;
    scene.draft.camera.eye = eye;
    // A running animation asks for the frame with its own moment.
    if scene.draft.camera != before && !state.animation.is_running {
        state.run_draft(actions);
    }
}

fn way(command: WalkCommand) -> DVec3 {
    match command {
        WalkCommand::Go(ahead, right) => DVec3::new(f64::from(right), 0.0, -f64::from(ahead)),
        _ => DVec3::ZERO,
    }
}

/// Turns a camera about its eye; up is the world's.
fn turn(camera: &mut Camera, by: Vec2) {
    let ahead = camera.target - camera.eye;
    let Some(direction) = ahead.try_normalize() else { return };
    let pitch = direction.y.clamp(-1.0, 1.0).asin();
    let most = MOST_PITCH.to_radians();
    let wished = (pitch - f64::from(by.y) * TURN.to_radians()).clamp(-most.max(pitch.abs()), most.max(pitch.abs()));
    let side = direction.cross(DVec3::Y).normalize_or(DVec3::X);
    let turned = DQuat::from_rotation_y(-f64::from(by.x) * TURN.to_radians())
        * DQuat::from_axis_angle(side, wished - pitch)
        * ahead;
    camera.target = camera.eye + turned;
}

/// A way of the keys in the world, of length 1: over the ground, or along the view where one flies.
fn direction(camera: &Camera, goes: DVec3, flies: bool) -> DVec3 {
    let ahead = (camera.target - camera.eye).normalize_or_zero();
    let flat = DVec3::new(ahead.x, 0.0, ahead.z).normalize_or(DVec3::NEG_Z);
    let right = flat.cross(DVec3::Y);
    let ahead = if flies { ahead } else { flat };
    (right * goes.x - ahead * goes.z).normalize_or_zero()
}

/// The button over the picture.
pub fn button(ui: &mut Ui, state: &mut State) {
    let can = state.scene.is_some() && state.capture.is_some();
    let word = theme::switch_word(ui, "Walk", state.walk.is_on);
    let button = ui.add_enabled(can, egui::Button::selectable(state.walk.is_on, word));
    let button = button.on_hover_text("Walk through the scene: the mouse looks, W S A D move (Tab over the picture)");
    if button.on_disabled_hover_text("Open a scene to walk in it").clicked() {
        if state.walk.is_on { state.stop_walking(ui.ctx()) } else { state.start_walking(ui.ctx()) }
    }
}

/// What of the picture is free for cards in its corners: while one walks, what is under the banner.
#[must_use]
pub fn under_banner(state: &State, rect: Rect) -> Rect {
    if state.walk.is_on { rect.with_min_y((rect.top() + BANNER_HEIGHT + 8.0).min(rect.bottom())) } else { rect }
}

/// Says over the picture that one walks, how, and how it ends.
pub fn banner(ui: &mut Ui, state: &State, rect: Rect) {
    if !state.walk.is_on {
        return;
    }
    let size = vec2(380.0_f32.min(rect.width() - 16.0), BANNER_HEIGHT);
    let place = Rect::from_min_size(rect.center_top() + vec2(-size.x / 2.0, 12.0), size);
    ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("walk banner"), |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.set_width((size.x - 16.0).max(1.0));
            theme::heading(ui, "Walking: Esc stops and frees the pointer");
            let walls = if state.walk.collides { "walls stop (C)" } else { "through walls (C)" };
            let words = format!("W S A D and the mouse · {walls} · {:.1} m/s (< >) · F1 lists all", state.walk.speed);
            ui.add(egui::Label::new(theme::note(words)).truncate());
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::Y,
            target: DVec3::new(0.0, 1.0, -4.0),
            up: DVec3::Y,
            fov_y_degrees: 60.0,
            near: 0.1,
            far: None,
        }
    }

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

    #[test]
    fn the_mouse_turns_to_the_right_and_down_and_never_over_the_head() {
        let mut right = camera();
        turn(&mut right, vec2((90.0 / TURN) as f32, 0.0));
        assert!((right.target - DVec3::new(4.0, 1.0, 0.0)).length() < 1e-3, "{}", right.target);
        let mut down = camera();
        turn(&mut down, vec2(0.0, 1e5));
        let ahead = (down.target - down.eye).normalize();
        assert!(ahead.y < -0.99 && ahead.z < 0.0, "{ahead}");
        assert!(down.check().is_ok());
    }

    #[test]
    fn one_walks_over_the_ground_and_flies_where_one_looks() {
        let mut camera = camera();
        turn(&mut camera, vec2(0.0, (45.0 / TURN) as f32));
        let ahead = way(WalkCommand::Go(1, 0));
        assert!((direction(&camera, ahead, false) - DVec3::NEG_Z).length() < 1e-6);
        assert!(direction(&camera, ahead, true).y < -0.7);
        let both = ahead + way(WalkCommand::Go(0, 1));
        assert!((direction(&camera, both, false).length() - 1.0).abs() < 1e-12, "not faster across");
        assert!(direction(&camera, both, false).x > 0.7);
    }
}
