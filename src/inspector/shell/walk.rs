//! Walking: the mouse looks, W S A D move, and other keys change what is seen, until Escape.
//!
//! These keys act only while the user walks, and no others do then. The pointer is hidden and confined to the window. A
//! new frame is asked for when the last one is shown, so nothing queues up: a slow technique moves in larger steps, not
//! later. Walls are asked for whenever objects are switched off, move or are loaded again; until they come the previous
//! walls are used. With gravity (G) the walker falls also while no key is pressed, until they stand.

use crate::ask::{RunRequest, WallsOf};
use crate::inspector::action::{Action, Overlay};
use crate::inspector::canvas;
use crate::inspector::model::Model;
use crate::inspector::model::walk::WalkGravity;
use crate::reading::picture_view::PictureKind;
use crate::scene::{Camera, Footing, WalkerBody, Walls};
use crate::technique::Technique;
use egui::{Context, Event, FocusDirection, Key, Vec2};
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// Degrees of rotation for each point of mouse movement.
const TURN: f64 = 0.12;
/// The largest pitch up and down, degrees.
const MOST_PITCH: f64 = 88.0;
/// The factor by which a press of < or > changes the speed, and the speed's limits, metres a second.
const FASTER: f64 = 1.5;
const SPEED_LIMITS: [f64; 2] = [0.02, 500.0];
/// A step lasts at most so long, seconds, so that a pause in drawing is no jump.
const LONGEST: f64 = 0.25;
/// Half the walker's width, metres, and its least multiple of the near plane's distance.
const RADIUS: f64 = 0.25;
const RADIUS_OF_NEAR: f64 = 1.5;
/// An eye farther than this from where the walker left it was set by something else, metres.
const SAME_PLACE: f64 = 1e-6;
/// The sizes of shadow maps that a key goes through.
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
/// The techniques that P goes through.
const TECHNIQUES: [Technique; 6] = [
    Technique::None,
    Technique::Planar,
    Technique::Projective,
    Technique::ZPass,
    Technique::ZFail,
    Technique::ShadowMap,
];

/// A command that a key carries out while the user walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalkCommand {
    /// Walks in this direction while it is pressed: ahead, and to the right.
    Go(i8, i8),
    /// Chooses the next technique.
    Technique,
    /// Switches collision with walls on or off.
    Collision,
    /// Switches gravity on or off: with it the walker falls, and stands on what is below; else they float.
    Gravity,
    /// Walks slower.
    Slower,
    /// Walks faster.
    Faster,
    /// Shows the next overlay of shadow geometry over the picture.
    Overlay,
    /// Chooses the next size of the map or the textures.
    MapSize,
    /// Makes the lamp swing, or stops it.
    Swing,
    /// Ends walking.
    Leave,
}

/// A key, and what it does while the user walks.
#[derive(Debug, Clone, Copy)]
pub struct WalkKey {
    /// The key.
    pub key: Key,
    /// The key in words.
    pub keys: &'static str,
    /// Its command.
    pub command: WalkCommand,
    /// What it does, in words.
    pub does: &'static str,
}

const fn key(key: Key, keys: &'static str, command: WalkCommand, does: &'static str) -> WalkKey {
    WalkKey { key, keys, command, does }
}

/// All keys that act while the user walks; both handling and help read them here.
pub const KEYS: [WalkKey; 13] = [
    key(Key::W, "W", WalkCommand::Go(1, 0), "walk ahead"),
    key(Key::S, "S", WalkCommand::Go(-1, 0), "walk back"),
    key(Key::A, "A", WalkCommand::Go(0, -1), "walk to the left"),
    key(Key::D, "D", WalkCommand::Go(0, 1), "walk to the right"),
    key(Key::P, "P", WalkCommand::Technique, "no shadow, planar, projective, z-pass, z-fail, shadow map"),
    key(Key::C, "C", WalkCommand::Collision, "walls stop, or do not"),
    key(Key::G, "G", WalkCommand::Gravity, "gravity: fall, land, climb steps up to 0.4 m; or float"),
    key(Key::Comma, "<", WalkCommand::Slower, "slower"),
    key(Key::Period, ">", WalkCommand::Faster, "faster"),
    key(Key::V, "V", WalkCommand::Overlay, "silhouettes, volumes, shadow, or nothing over the picture"),
    key(Key::I, "I", WalkCommand::MapSize, "the size of the shadow map or the silhouettes"),
    key(Key::L, "L", WalkCommand::Swing, "the lamp swings, or stops"),
    key(Key::Escape, "Esc", WalkCommand::Leave, "stop walking, free the pointer"),
];

/// Carries out this frame's keys and mouse movement while the user walks, and returns true, so that no other keys act;
/// also lets a key begin to walk. Where a dialog opens, help is asked for or the window loses the focus, it ends
/// walking and returns false.
pub fn handle(ctx: &Context, model: &mut Model, actions: &mut Vec<Action>) -> bool {
    if !model.walk.is_on() {
        return begins(ctx, model);
    }
    let asks_for_help = ctx.input(|input| input.key_pressed(Key::F1) || input.key_pressed(Key::H));
    let is_elsewhere =
        asks_for_help || model.scene.is_none() || model.dialog.is_some() || !ctx.input(|input| input.focused);
    if is_elsewhere {
        model.stop_walking(ctx);
        return false;
    }
    let typed = |text: &str| ctx.input(|input| input.events.contains(&Event::Text(text.to_owned())));
    for walk_key in &KEYS {
        let presses = ctx.input_mut(|input| input.count_and_consume_key(egui::Modifiers::NONE, walk_key.key));
        // Keyboards have a key for < and > each, or type them with other keys.
        let is_typed = match walk_key.command {
            WalkCommand::Slower | WalkCommand::Faster => typed(walk_key.keys),
            _ => false,
        };
        for _ in 0..presses.max(usize::from(is_typed)) {
            act(ctx, model, walk_key.command, actions);
        }
    }
    if !model.walk.is_on() {
        return true;
    }
    // Nor does Tab go from widget to widget.
    if ctx.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Tab)) {
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
    step(ctx, model, actions);
    true
}

/// Does Tab begin walking? It does while the pointer is over the picture; else it goes from widget to widget, on from
/// the picture too, so that a user without a pointer does not get stuck there.
fn begins(ctx: &Context, model: &mut Model) -> bool {
    let is_free = model.dialog.is_none() && !ctx.text_edit_focused() && !egui::Popup::is_any_open(ctx);
    let focus = ctx.memory(egui::Memory::focused);
    let is_picture = model.selection.hover.is_some() && (focus.is_none() || focus == Some(canvas::picture_id()));
    let is_shifted = ctx.input(|input| input.modifiers.any());
    if !(is_free && is_picture && !is_shifted && model.scene.is_some()) {
        return false;
    }
    let is_pressed = ctx.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Tab));
    if is_pressed {
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        model.start_walking(ctx);
    }
    is_pressed
}

fn act(ctx: &Context, model: &mut Model, command: WalkCommand, actions: &mut Vec<Action>) {
    let [slowest, fastest] = SPEED_LIMITS;
    // While the keys of walking are pressed, the last message stays, so that it can be read.
    if !matches!(command, WalkCommand::Go(..)) {
        model.walk.nothing_because = None;
    }
    match command {
        // It acts as long as it is pressed: see `step`.
        WalkCommand::Go(..) => {}
        WalkCommand::Technique => {
            let now = model.scene.as_ref().map(|scene| scene.draft.choice.technique());
            let place = TECHNIQUES.iter().position(|one| Some(*one) == now);
            let next = TECHNIQUES[place.map_or(0, |place| (place + 1) % TECHNIQUES.len())];
            model.choose_technique(next, actions);
        }
        WalkCommand::Collision => model.walk.collides = !model.walk.collides,
        WalkCommand::Gravity => {
            model.walk.weight = if model.walk.weight.is_some() { None } else { Some(WalkGravity::default()) }
        }
        WalkCommand::Slower => model.walk.speed = (model.walk.speed / FASTER).max(slowest),
        WalkCommand::Faster => model.walk.speed = (model.walk.speed * FASTER).min(fastest),
        WalkCommand::Overlay => next_overlay(model),
        WalkCommand::MapSize => next_size(model, actions),
        WalkCommand::Swing if model.scene.as_ref().is_some_and(|scene| scene.animated) => model.animation.toggle(),
        WalkCommand::Swing => {
            model.walk.nothing_because = Some("L does nothing: nothing moves in this scene".to_owned())
        }
        WalkCommand::Leave => model.stop_walking(ctx),
    }
}

/// Goes on to the next view of shadow geometry: silhouettes, then volumes, then the mask alone, then the plain picture.
/// Other overlays stay.
fn next_overlay(model: &mut Model) {
    let kind_now = model.kind();
    let on = &mut model.modes.overlays;
    let has = |overlay| on.contains(&overlay);
    let (lines, kind) = match (has(Overlay::Silhouettes), has(Overlay::Volumes), kind_now) {
        (true, _, _) => (Some(Overlay::Volumes), PictureKind::Color),
        (_, true, _) => (None, PictureKind::Mask),
        (_, _, Some(PictureKind::Mask)) => (None, PictureKind::Color),
        _ => (Some(Overlay::Silhouettes), PictureKind::Color),
    };
    on.remove(&Overlay::Silhouettes);
    on.remove(&Overlay::Volumes);
    on.extend(lines);
    model.choose_picture(kind);
}

fn next_size(model: &mut Model, actions: &mut Vec<Action>) {
    let Some(scene) = &mut model.scene else { return };
    let Some(now) = scene.draft.choice.texels() else {
        let technique = scene.draft.choice.technique().name();
        let because = format!("I does nothing: {technique} has neither map nor texture. P goes to one that has");
        model.walk.nothing_because = Some(because);
        return;
    };
    let next = SIZES.into_iter().find(|size| *size > now).unwrap_or(SIZES[0]);
    match scene.draft.choice.set("size", &next.to_string()) {
        Ok(()) => model.run_draft(actions),
        Err(error) => scene.problem = Some(error.to_string()),
    }
}

/// Rotates and moves the camera by the input since the last step, and runs the scene; waits while a frame is awaited,
/// or walls that are needed are not known. Does nothing where nothing moves.
fn step(ctx: &Context, model: &mut Model, actions: &mut Vec<Action>) {
    let is_down = |key| ctx.input(|input| input.key_down(key));
    let goes: DVec3 = KEYS.iter().filter(|key| is_down(key.key)).map(|key| way(key.command)).sum();
    model.walk.rotation += ctx.input(|input| input.pointer.motion()).unwrap_or(Vec2::ZERO);
    let now = ctx.input(|input| input.time);
    let needs_walls = model.walk.collides || model.walk.weight.is_some();
    let walls = walls(model);
    let falls = match (&model.walk.weight, &walls) {
        (Some(weight), Some(walls)) => !weight.is_at_rest(walls),
        _ => false,
    };
    let moves = goes != DVec3::ZERO || falls;
    if moves {
        ctx.request_repaint();
    } else {
        model.walk.last = None;
    }
    let is_known = !needs_walls || walls.is_some();
    if model.activity.is_waiting || !is_known || (!moves && model.walk.rotation == Vec2::ZERO) {
        return;
    }
    let passed = model.walk.last.map_or(1.0 / 60.0, |last| (now - last).clamp(0.0, LONGEST));
    model.walk.last = Some(now).filter(|_| moves);
    let rotation = std::mem::take(&mut model.walk.rotation);
    let Some(scene) = &mut model.scene else { return };
    let before = scene.draft.camera;
    turn(&mut scene.draft.camera, rotation);
    let floats = model.walk.weight.is_none();
    let by = direction(&scene.draft.camera, goes, floats && !model.walk.collides) * (model.walk.speed * passed);
    let radius = RADIUS.max(before.near * RADIUS_OF_NEAR);
    let eye = match (&walls, floats) {
        (Some(walls), false) if moves => fallen(model, before.eye, by, passed, walls, &WalkerBody::new(radius)),
        (Some(walls), true) if model.walk.collides => walls.walk(before.eye, by, radius),
        (_, true) => before.eye + by,
        (_, false) => before.eye,
    };
    let Some(scene) = &mut model.scene else { return };
    scene.draft.camera.target += eye - before.eye;
    scene.draft.camera.eye = eye;
    // A running animation asks for the frame, at its own time.
    if scene.draft.camera != before && !model.animation.is_running {
        model.run_draft(actions);
    }
}

/// Returns the eye of a walker with gravity after moving by `by` in `seconds`. One who falls beyond the whole scene is
/// set back to where they stood last; one who has stood nowhere floats again.
fn fallen(model: &mut Model, eye: DVec3, by: DVec3, seconds: f64, walls: &Arc<Walls>, body: &WalkerBody) -> DVec3 {
    let Some(weight) = &mut model.walk.weight else { return eye };
    // A camera that was set by something else starts again from the ground below it.
    let known = weight.standing.filter(|standing| body.eye_of(standing.feet).distance(eye) < SAME_PLACE);
    let began_at = *weight.began_at.get_or_insert(eye);
    let from = known.unwrap_or_else(|| body.under(eye, walls));
    let now = body.walk(from, by, seconds, walls, model.walk.collides);
    weight.within = Some(walls.clone());
    weight.standing = Some(now);
    if now.is_on_ground {
        weight.stood_at = Some(now.feet);
    }
    if !now.is_beyond {
        return body.eye_of(now.feet);
    }
    match weight.stood_at.take() {
        Some(feet) => {
            weight.standing = Some(Footing { feet, falls_by: 0.0, is_on_ground: false, is_beyond: false });
            model.walk.nothing_because = Some("Nothing is below: back where you stood last".to_owned());
            body.eye_of(feet)
        }
        None => {
            model.walk.weight = None;
            let because = "Nothing to land on is below: back where you began, and you float (G)";
            model.walk.nothing_because = Some(because.to_owned());
            began_at
        }
    }
}

/// Returns the walls of the scene as it will be run, which are asked for; until they are known, the last ones. `None`
/// without a scene, without any walls known yet, or where neither collision nor gravity needs them.
fn walls(model: &Model) -> Option<Arc<Walls>> {
    let scene = model.scene.as_ref().filter(|_| model.walk.collides || model.walk.weight.is_some())?;
    let time = if scene.animated { scene.draft.time } else { 0.0 };
    let RunRequest { off, objects, .. } = scene.draft.clone();
    model.answers.want(WallsOf { off, objects, time }).latest().cloned()
}

fn way(command: WalkCommand) -> DVec3 {
    match command {
        WalkCommand::Go(ahead, right) => DVec3::new(f64::from(right), 0.0, -f64::from(ahead)),
        _ => DVec3::ZERO,
    }
}

/// Rotates a camera about its eye by mouse movement in points: right about the world's vertical axis, down about the
/// horizontal one, up to a steepest pitch. The target's distance stays.
fn turn(camera: &mut Camera, by: Vec2) {
    let ahead = camera.target - camera.eye;
    let Some(direction) = ahead.try_normalize() else { return };
    let pitch = direction.y.clamp(-1.0, 1.0).asin();
    let most = MOST_PITCH.to_radians();
    let wished = (pitch - f64::from(by.y) * TURN.to_radians()).clamp(-most.max(pitch.abs()), most.max(pitch.abs()));
    let side = direction.cross(DVec3::Y).normalize_or(DVec3::X);
    let rotation = DQuat::from_rotation_y(-f64::from(by.x) * TURN.to_radians())
        * DQuat::from_axis_angle(side, wished - pitch)
        * ahead;
    camera.target = camera.eye + rotation;
}

/// Returns the direction of the pressed keys in the world, of length 1: over the ground, or along the view where the
/// walker flies.
fn direction(camera: &Camera, goes: DVec3, flies: bool) -> DVec3 {
    let ahead = (camera.target - camera.eye).normalize_or_zero();
    let flat = DVec3::new(ahead.x, 0.0, ahead.z).normalize_or(DVec3::NEG_Z);
    let right = flat.cross(DVec3::Y);
    let ahead = if flies { ahead } else { flat };
    (right * goes.x - ahead * goes.z).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::Y,
            target: DVec3::new(0.0, 1.0, -4.0),
            up: DVec3::Y,
            projection: crate::scene::Projection::Perspective,
            fov_y_degrees: 60.0,
            near: 0.1,
            far: None,
            viewport: None,
        }
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
