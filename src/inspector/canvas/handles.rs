//! Handles of lights, camera and objects: what can be moved, where its handle is, and how it is dragged.

use crate::inspector::canvas::map_handles::MapPart;
use crate::inspector::look::widgets::keep_arrows;
use crate::reading::format;
use crate::scene::Light;
use egui::{Id, Key, Painter, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo};
use glam::{DMat3, DVec3, DVec4};

/// How far an arrow key moves a handle, as a share of the view's height: without and with Shift.
const STEPS: [f64; 2] = [0.01, 0.1];

/// How far the handle of a thing out of view is from the border of the view, points.
pub const BORDER: f32 = 18.0;

/// How far a handle is pulled from there until its thing comes into the view, points: less is a drag along the border.
const PULL: f32 = 6.0;

/// A thing of the scene that a handle in the view moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HandleKind {
    /// A light, or the direction towards it.
    Light(usize),
    /// The camera's eye.
    Eye,
    /// What the camera looks at.
    Target,
    /// An object, by index.
    Object(usize),
    /// A part of the frustum of a light's map, by the light's index.
    Map(usize, MapPart),
}

impl HandleKind {
    /// Returns the handle's name for the user, with indices counted from 1: `Light 1`, `Object 1`, `Camera`, `Camera
    /// target`, `Light 1 map near plane`.
    pub fn name(self) -> String {
        match self {
            HandleKind::Light(index) => format::light_title(index),
            HandleKind::Eye => "Camera".to_owned(),
            HandleKind::Target => "Camera target".to_owned(),
            HandleKind::Object(index) => format!("Object {}", index + 1),
            HandleKind::Map(light, part) => format!("{} map {}", format::light_title(light), part.name()),
        }
    }
}

/// Where the handle of a directional light is: `reach` from the point `middle`, towards the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandleAnchor {
    /// World space.
    pub middle: DVec3,
    /// Distance from `middle`, metres.
    pub reach: f64,
}

/// Returns where a light's handle is at a time in seconds, world space: at the moved light itself, or, for a
/// directional light, at the anchor's `reach` from its `middle` towards the light.
pub fn place_of_light(light: &Light, time: f64, anchor: HandleAnchor) -> DVec3 {
    let position = light.motion.apply_to_light(light.position, time);
    match position.w == 0.0 {
        true => anchor.middle + position.truncate().normalize_or_zero() * anchor.reach,
        false => position.truncate() / position.w,
    }
}

/// Returns the light's homogeneous position at the scene's start after its handle was moved by `by` (world space) at a
/// time in seconds, so that its motion leads there. A directional light only turns, and keeps its length; it stays as
/// it is where the handle would be on the anchor.
pub fn moved_light(light: &Light, time: f64, by: DVec3, anchor: HandleAnchor) -> DVec4 {
    let rotated = |axis: DVec3| light.motion.apply_to_light(axis.extend(0.0), time).truncate();
    let back = DMat3::from_cols(rotated(DVec3::X), rotated(DVec3::Y), rotated(DVec3::Z)).transpose();
    if !light.is_directional() {
        return light.position + (back * by * light.position.w).extend(0.0);
    }
    let towards = place_of_light(light, time, anchor) + by - anchor.middle;
    let length = light.position.truncate().length();
    match towards.try_normalize() {
        Some(towards) => (back * towards * length).extend(0.0),
        None => light.position,
    }
}

/// Returns where the handle of a thing at `at` is in a view: there, or, where that is outside, near the border, with the
/// direction outwards to the thing.
pub fn at_border(view: Rect, at: Pos2) -> (Pos2, Option<Vec2>) {
    if view.contains(at) {
        return (at, None);
    }
    let inside = view.shrink(BORDER).clamp(at);
    (inside, Some((at - inside).normalized()))
}

/// Returns where a handle that is dragged from the border of a view has been pulled to, if so far in that its thing comes
/// with it: where it was grabbed, so that it does not jump to the pointer. `None` while it is not pulled in or not dragged.
pub fn pulled_in(ui: &Ui, response: &Response, view: Rect, handle: Pos2) -> Option<Pos2> {
    let id = response.id.with("grabbed beside its middle");
    let pointer = response.interact_pointer_pos()?;
    if response.drag_started() {
        let from = ui.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
        ui.data_mut(|data| data.insert_temp(id, handle - from));
    }
    let beside: Vec2 = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    Some(pointer + beside).filter(|at| view.shrink(BORDER + PULL).contains(*at))
}

/// Draws the head of an arrow from a handle at the border towards what it moves, which is out of view.
pub fn way_sign(painter: &Painter, at: Pos2, way: Vec2, stroke: Stroke) {
    let tip = at + way * (BORDER - 3.0);
    for side in [way.rot90(), -way.rot90()] {
        painter.line_segment([tip, tip - way * 5.0 + side * 5.0], stroke);
    }
}

/// Makes an invisible widget named `name` that can be clicked and dragged, and takes the keyboard focus when it is.
pub fn grabbed(ui: &Ui, id: Id, rect: Rect, name: &str) -> Response {
    let response = ui.interact(rect, id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    response
}

/// Returns how far the arrow keys of this frame move the focused widget right and up, as a share of the view's height:
/// 0.01 a press, 0.1 with Shift. `None` where it has no focus, or no key was pressed.
pub fn arrows(ui: &Ui, response: &Response) -> Option<[f64; 2]> {
    if !response.has_focus() {
        return None;
    }
    keep_arrows(ui, response);
    let by = ui.input(|input| {
        let presses = |key| input.num_presses(key) as f64 * STEPS[usize::from(input.modifiers.shift)];
        [presses(Key::ArrowRight) - presses(Key::ArrowLeft), presses(Key::ArrowUp) - presses(Key::ArrowDown)]
    });
    (by != [0.0; 2]).then_some(by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Motion, Orbit, Swing};

    const ANCHOR: HandleAnchor = HandleAnchor { middle: DVec3::new(1.0, 0.0, 2.0), reach: 5.0 };

    #[test]
    fn a_light_that_moves_is_moved_where_it_is_seen() {
        let orbit =
            Orbit { center: DVec3::new(2.0, 0.0, 1.0), axis: DVec3::new(1.0, 2.0, 0.5), degrees_per_second: 30.0 };
        let swing = Swing { pivot: DVec3::Y * 4.0, axis: DVec3::Z, degrees: 25.0, period_seconds: 3.0 };
        let motion = Motion { orbit: Some(orbit), swing: Some(swing), ..Motion::default() };
        let light = Light { motion, ..Light::point(DVec3::new(1.0, 3.0, -2.0)) };
        let by = DVec3::new(0.3, -0.2, 0.7);
        for time in [0.0, 1.3, 7.7] {
            let moved = Light { position: moved_light(&light, time, by, ANCHOR), ..light.clone() };
            let found = place_of_light(&moved, time, ANCHOR) - place_of_light(&light, time, ANCHOR);
            assert!((found - by).length() < 1e-9, "{time}: {found}");
        }
    }

    #[test]
    fn a_direction_keeps_its_length_and_follows_its_handle() {
        let light = Light::directional(DVec3::new(0.0, 3.0, 0.0));
        assert_eq!(place_of_light(&light, 0.0, ANCHOR), DVec3::new(1.0, 5.0, 2.0));
        let moved = moved_light(&light, 0.0, DVec3::X * 5.0, ANCHOR);
        assert!((moved - DVec4::new(3.0, 3.0, 0.0, 0.0) / 2f64.sqrt()).length() < 1e-12, "{moved}");
        assert_eq!(moved_light(&light, 0.0, DVec3::Y * -5.0, ANCHOR), light.position, "it has no direction there");
    }
}
