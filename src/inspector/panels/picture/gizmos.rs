//! Lights as handles over the picture: dragged in the plane parallel to it. One that is out of view has an arrow at the
//! border as its handle: where it would come in, or, if it is behind the eye, on its side. Dragged into the picture, it
//! comes to the pointer.

use crate::inspector::action::Action;
use crate::inspector::canvas::handles::{
    BORDER, HandleAnchor, HandleKind, arrows, at_border, grabbed, moved_light, place_of_light, pulled_in, way_sign,
};
use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::pick_ray;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::scene::Camera;
use egui::{Color32, Pos2, Rect, Stroke, Ui, Vec2, vec2};
use glam::DVec3;

/// Side of the area that can be grabbed, points.
const GRAB: f32 = 20.0;
/// Distance from the eye to the handle of a directional light, metres: any distance shows its direction.
const SUN: f64 = 10.0;
/// A light out of view that is nearer along the view than this share of the target's distance is dragged at the target's.
const LEAST_DEPTH: f64 = 0.25;

/// Draws the switch that shows and hides the lights' handles; nothing where no scene is open.
pub fn button(ui: &mut Ui, is_off: &mut bool, model: &Model) {
    if model.scene.is_some() {
        let word = theme::switch_word(ui, "Gizmos", !*is_off);
        let button = ui.add(egui::Button::selectable(!*is_off, word));
        if button.on_hover_text("Handles of the lights: drag them, or use the arrow keys").clicked() {
            *is_off ^= true;
        }
    }
}

/// Draws a handle for each light of the draft, at the picture's border with an arrow where the light is out of view,
/// moves lights by drags and arrow keys in the plane parallel to the picture, and runs the scene then. A light out of
/// view whose handle is dragged into the picture comes to the pointer. Returns where the handles lie; draws none over a
/// map, while walking, or without a scene.
pub fn ui(
    ui: &Ui,
    model: &mut Model,
    rect: Rect,
    shown: &ShownPicture,
    placement: Placement,
    actions: &mut Vec<Action>,
) -> Vec<Rect> {
    let mut handles = Vec::new();
    let (Some(capture), Some(scene)) = (&model.frame.capture, &mut model.scene) else { return handles };
    if shown.kind == PictureKind::Map || model.walk.is_on() {
        return handles;
    }
    let draft = &mut scene.draft;
    let camera = capture.camera;
    let anchor = HandleAnchor { middle: camera.eye, reach: SUN };
    let whole = placement.rect().intersect(rect);
    let mut changed = false;
    for index in 0..draft.lights.len() {
        let point = place_of_light(&draft.lights[index], draft.time, anchor);
        if whole.width().min(whole.height()) < 4.0 * BORDER {
            continue;
        }
        let before_eye = pick_ray::texel_of(capture, point.extend(1.0));
        let at = match before_eye {
            Some(texel) => placement.origin + vec2(texel[0] as f32, texel[1] as f32) * placement.scale,
            None => beyond(whole, pick_ray::way_to(capture, point.extend(1.0))),
        };
        let (at, outwards) = at_border(whole, at);
        let id = ui.scope_id().with(("light in the picture", index));
        let name = format!("{} in the picture", HandleKind::Light(index).name());
        let handle = Rect::from_center_size(at, Vec2::splat(GRAB));
        handles.push(handle);
        let response = grabbed(ui, id, handle, &name);
        let pulled_to = pulled_in(ui, &response, whole, at).filter(|_| outwards.is_some());
        let is_active = response.hovered() || response.dragged() || response.has_focus();
        let away = match (before_eye, outwards) {
            (None, _) => ", behind the eye: drag it into the picture",
            (Some(_), Some(_)) => ", out of view this way: drag it into the picture",
            (Some(_), None) => ": drag it",
        };
        let name = HandleKind::Light(index).name();
        let response = response.on_hover_text(format!("{name}{away}, or use the arrow keys"));
        sign(ui, whole, at, is_active, outwards);
        let mut by = response.drag_delta() / placement.scale;
        if let Some([right, up]) = arrows(ui, &response) {
            by += Vec2::new(right as f32, -up as f32) * placement.size[1] as f32;
        }
        if by == Vec2::ZERO {
            continue;
        }
        let depth = plane_of(point, &camera, draft.lights[index].is_directional(), outwards.is_some());
        let place = |at: Vec2| pick_ray::ray_at(capture, [f64::from(at.x), f64::from(at.y)]).at(depth);
        let moved: DVec3 = match pulled_to {
            Some(to) => camera.eye + place(placement.texel_position(to)) - point,
            None => place(by) - place(Vec2::ZERO),
        };
        draft.lights[index].position = moved_light(&draft.lights[index], draft.time, moved, anchor);
        changed = true;
    }
    if changed {
        model.run_draft(actions);
    }
    handles
}

/// Returns the distance along the view of the plane, parallel to the picture, in which a light is dragged: the light's
/// own. One that is out of view (`is_out`), and behind the eye or so near its side that a drag would hardly move it, is
/// dragged in the plane of the camera's target.
fn plane_of(light: DVec3, camera: &Camera, is_directional: bool, is_out: bool) -> f64 {
    let ahead = (camera.target - camera.eye).normalize_or_zero();
    let depth = (light - camera.eye).dot(ahead);
    let reach = if is_directional { SUN } else { (camera.target - camera.eye).length() };
    if is_out && depth < LEAST_DEPTH * reach { reach } else { depth.max(camera.near) }
}

/// Returns a position outside a rectangle, just beyond its border, in the direction `way` from its middle.
fn beyond(whole: Rect, way: [f64; 2]) -> Pos2 {
    let way = vec2(way[0] as f32, way[1] as f32);
    let sides = (whole.width() / 2.0 / way.x.abs()).min(whole.height() / 2.0 / way.y.abs());
    whole.center() + way * (sides + BORDER)
}

/// Draws a light's sun at `at`, light on dark so that it shows on any picture; with an arrow in the direction
/// `outwards` for a light out of view, and a ring while it is active.
fn sign(ui: &Ui, whole: Rect, at: Pos2, is_active: bool, outwards: Option<Vec2>) {
    let painter = ui.painter_at(whole);
    let colors = theme::of(ui);
    let ink = theme::DARK.lit;
    for (width, color) in [(4.0, Color32::from_black_alpha(150)), (1.8, ink)] {
        for turn in 0..8 {
            let ray = Vec2::angled(turn as f32 * std::f32::consts::FRAC_PI_4);
            painter.line_segment([at + ray * 8.0, at + ray * 11.0], Stroke::new(width, color));
        }
        painter.circle_stroke(at, 5.0, Stroke::new(width, color));
        if let Some(way) = outwards {
            way_sign(&painter, at, way, Stroke::new(width, color));
        }
    }
    painter.circle_filled(at, 4.5, ink);
    if is_active {
        painter.circle_stroke(at, 15.0, Stroke::new(1.5, colors.selected));
    }
}
