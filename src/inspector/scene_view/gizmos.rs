//! Lights and camera as handles: dragged in the plane parallel to the view, or along an axis.
//!
//! Handles stand where the draft has things, so that they follow the hand before the next frame is
//! there. What moves in the scene is shown at the draft's moment, and moved at its start.

use super::lens::Lens;
use super::stage::Stage;
use super::{Pane, SceneView};
use crate::inspector::action::{Action, RunRequest};
use crate::inspector::format;
use crate::inspector::state::State;
use crate::inspector::theme;
use crate::scene::Light;
use egui::{
    Align2, EventFilter, Id, Key, Painter, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use glam::{DMat3, DVec3, DVec4};

/// Side of what can be grabbed, points.
const GRAB: f32 = 18.0;
/// Length of an axis, points.
const AXIS: f64 = 44.0;
/// How far an arrow key moves, in parts of the view's height, and with Shift.
const STEPS: [f64; 2] = [0.01, 0.1];
const AXES: [(&str, DVec3); 3] = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];

/// What can be moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Grip {
    /// A light, or the direction towards it.
    Light(usize),
    /// The camera's eye.
    Eye,
    /// What the camera looks at.
    Target,
}

impl Grip {
    /// For people: `Light 1`.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Grip::Light(index) => format::light_title(index),
            Grip::Eye => "Camera".to_owned(),
            Grip::Target => "Camera target".to_owned(),
        }
    }
}

/// Where the handle of a directional light stands: so far from a point towards the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// World space.
    pub middle: DVec3,
    /// Metres.
    pub reach: f64,
}

/// Where a light's handle is at a moment, world space.
#[must_use]
pub fn place_of_light(light: &Light, time: f64, anchor: Anchor) -> DVec3 {
    let position = light.motion.apply_to_light(light.position, time);
    match position.w == 0.0 {
        true => anchor.middle + position.truncate().normalize_or_zero() * anchor.reach,
        false => position.truncate() / position.w,
    }
}

/// The light's homogeneous position at the scene's start once its handle was moved at a moment.
#[must_use]
pub fn moved_light(light: &Light, time: f64, by: DVec3, anchor: Anchor) -> DVec4 {
    let turned = |axis: DVec3| light.motion.apply_to_light(axis.extend(0.0), time).truncate();
    let back = DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z)).transpose();
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

/// Draws lights and camera into a view, with handles where they are wanted.
pub fn ui(
    ui: &Ui,
    state: &mut State,
    view: &mut SceneView,
    stage: &Stage,
    (pane, lens, rect): (Pane, &Lens, Rect),
    actions: &mut Vec<Action>,
) {
    let Some(draft) = state.scene.as_mut().map(|scene| &mut scene.draft) else { return };
    let anchor = Anchor { middle: stage.middle, reach: 0.85 * stage.radius };
    let painter = ui.painter_at(rect);
    let mut changed = false;
    let lights = (0..draft.lights.len()).map(Grip::Light);
    let grips: Vec<Grip> = [Grip::Target, Grip::Eye].into_iter().chain(lights).collect();
    let here = Here { pane, lens, rect, anchor };
    if let (Some(eye), Some(target)) = (lens.place(draft.camera.eye), lens.place(draft.camera.target)) {
        painter.extend(egui::Shape::dashed_line(&[eye, target], Stroke::new(1.0, theme::of(ui).dim), 2.0, 4.0));
    }
    for grip in grips {
        let Some(at) = lens.place(place(draft, grip, anchor)).filter(|at| rect.contains(*at)) else { continue };
        sign(ui, &painter, draft, grip, at, &here);
        if view.gizmos {
            changed |= handle(ui, view, draft, (grip, at), &here);
        }
        if view.shown.names {
            let below = at + vec2(0.0, 10.0);
            super::pane::plate(&painter, below, Align2::CENTER_TOP, &grip.name(), false, theme::of(ui));
        }
    }
    if changed {
        state.run_draft(actions);
    }
}

/// Of the view that is drawn.
struct Here<'a> {
    pane: Pane,
    lens: &'a Lens,
    rect: Rect,
    anchor: Anchor,
}

fn place(draft: &RunRequest, grip: Grip, anchor: Anchor) -> DVec3 {
    match grip {
        Grip::Light(index) => place_of_light(&draft.lights[index], draft.time, anchor),
        Grip::Eye => draft.camera.eye,
        Grip::Target => draft.camera.target,
    }
}

fn move_by(draft: &mut RunRequest, grip: Grip, by: DVec3, anchor: Anchor) {
    match grip {
        Grip::Light(index) => {
            draft.lights[index].position = moved_light(&draft.lights[index], draft.time, by, anchor);
        }
        Grip::Eye => draft.camera.eye += by,
        Grip::Target => draft.camera.target += by,
    }
}

/// What a thing looks like, whether it can be moved or not.
fn sign(ui: &Ui, painter: &Painter, draft: &RunRequest, grip: Grip, at: Pos2, here: &Here) {
    let colors = theme::of(ui);
    match grip {
        Grip::Light(index) => {
            if draft.lights[index].is_directional()
                && let Some(middle) = here.lens.place(here.anchor.middle)
            {
                let along = (middle - at) * 0.35;
                painter.arrow(at, along, Stroke::new(1.5, colors.lit));
            }
            for turn in 0..8 {
                let ray = Vec2::angled(turn as f32 * std::f32::consts::FRAC_PI_4);
                painter.line_segment([at + ray * 7.0, at + ray * 10.0], Stroke::new(1.5, colors.lit));
            }
            painter.circle(at, 5.0, colors.lit, Stroke::new(1.0, colors.background));
        }
        Grip::Eye => {
            let body = Rect::from_center_size(at, vec2(11.0, 8.0));
            painter.rect(body, 2, colors.text, Stroke::new(1.0, colors.background), egui::StrokeKind::Outside);
            painter.circle_filled(at, 2.2, colors.background);
        }
        Grip::Target => {
            painter.circle_stroke(at, 4.0, Stroke::new(1.5, colors.dim));
            painter.circle_filled(at, 1.2, colors.dim);
        }
    }
}

/// The handle and, where it is the chosen one, its axes. True where it was moved.
fn handle(ui: &Ui, view: &mut SceneView, draft: &mut RunRequest, (grip, at): (Grip, Pos2), here: &Here) -> bool {
    let in_view = format!("in the {} view", here.pane.name());
    let id = ui.scope_id().with(("gizmo", here.pane.name(), grip));
    let (grab, name) = (Rect::from_center_size(at, Vec2::splat(GRAB)), format!("{} {in_view}", grip.name()));
    let response = grabbed(ui, id, grab, &name);
    let response = response.on_hover_text(format!("{}: drag it, or use the arrow keys", grip.name()));
    if response.drag_started() || response.clicked() || response.gained_focus() {
        view.grip = Some(grip);
    }
    let painter = ui.painter_at(here.rect);
    if response.hovered() || response.has_focus() || view.grip == Some(grip) {
        let ink = if response.has_focus() { theme::of(ui).focus } else { theme::of(ui).selected };
        painter.circle_stroke(at, GRAB / 2.0 + 2.0, Stroke::new(1.5, ink));
    }
    let lens = here.lens;
    let point = place(draft, grip, here.anchor);
    let mut by = DVec3::ZERO;
    if response.dragged() && response.drag_delta() != Vec2::ZERO {
        by += lens.moved(point, response.drag_delta());
    }
    if let Some([right, up]) = arrows(ui, &response) {
        let step = f64::from(here.rect.height()) / lens.scale;
        by += (nearest_axis(lens.rotation.row(0)) * right + nearest_axis(lens.rotation.row(1)) * up) * step;
    }
    let is_direction = matches!(grip, Grip::Light(index) if draft.lights[index].is_directional());
    if view.grip == Some(grip) && !is_direction {
        for (letter, axis) in AXES {
            let length = lens.moved(point, vec2(AXIS as f32, 0.0)).length();
            let Some([from, tip]) = lens.line([point, point + axis * length]) else { continue };
            // Seen from its end it has no way to go.
            if (tip - from).length() < 8.0 {
                continue;
            }
            let grab = Rect::from_center_size(tip, Vec2::splat(GRAB));
            let name = format!("{} along {letter} {in_view}", grip.name());
            let response = grabbed(ui, id.with(letter), grab, &name);
            let ink = if response.hovered() || response.dragged() || response.has_focus() {
                theme::of(ui).selected
            } else {
                theme::of(ui).text
            };
            painter.arrow(from, tip - from, Stroke::new(1.5, ink));
            let beside = tip + (tip - from).normalized() * 8.0;
            painter.text(beside, Align2::CENTER_CENTER, letter, theme::number_font(theme::SMALL_SIZE), ink);
            if response.dragged() && response.drag_delta() != Vec2::ZERO {
                by += lens.moved_along(point, axis, response.drag_delta());
            }
            if let Some([right, up]) = arrows(ui, &response) {
                by += axis * (right + up) * f64::from(here.rect.height()) / lens.scale;
            }
        }
    }
    if by != DVec3::ZERO {
        move_by(draft, grip, by, here.anchor);
    }
    by != DVec3::ZERO
}

/// A named thing that can be dragged, and takes the focus when it is.
pub fn grabbed(ui: &Ui, id: Id, rect: Rect, name: &str) -> Response {
    let response = ui.interact(rect, id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    response
}

/// How far the arrow keys of what has the focus go right and up, in parts of the view's height.
pub fn arrows(ui: &Ui, response: &Response) -> Option<[f64; 2]> {
    if !response.has_focus() {
        return None;
    }
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let by = ui.input(|input| {
        let presses = |key| input.num_presses(key) as f64 * STEPS[usize::from(input.modifiers.shift)];
        [presses(Key::ArrowRight) - presses(Key::ArrowLeft), presses(Key::ArrowUp) - presses(Key::ArrowDown)]
    });
    (by != [0.0; 2]).then_some(by)
}

/// The axis of the world that is nearest to a direction.
fn nearest_axis(direction: DVec3) -> DVec3 {
    let along = |axis: &&(&str, DVec3)| direction.dot(axis.1).abs();
    let nearest = AXES.iter().max_by(|a, b| along(a).total_cmp(&along(b)));
    nearest.map_or(DVec3::ZERO, |(_, axis)| *axis * direction.dot(*axis).signum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Motion, Orbit, Swing};

    const ANCHOR: Anchor = Anchor { middle: DVec3::new(1.0, 0.0, 2.0), reach: 5.0 };

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

    #[test]
    fn arrow_keys_go_along_the_axis_that_is_nearest() {
        assert_eq!(nearest_axis(DVec3::new(0.3, 0.1, -0.9)), DVec3::NEG_Z);
        assert_eq!(nearest_axis(DVec3::new(0.8, 0.1, -0.3)), DVec3::X);
    }
}
