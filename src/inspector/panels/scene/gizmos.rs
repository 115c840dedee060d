//! Lights, camera and, where they are switched on, objects as handles: dragged in the plane parallel to the view, or
//! along an axis.
//!
//! Handles are where the draft has things, so that they follow the pointer before the next frame is there. What moves
//! in the scene is shown at the draft's time, and its position at the scene's start is changed.

use super::lens::Lens;
use super::stage::SceneStage;
use super::view::{Pane, SceneView};
use crate::anatomy::Anatomy;
use crate::ask::RunRequest;
use crate::inspector::action::Action;
use crate::inspector::canvas::handles::{
    HandleAnchor, HandleKind, arrows, at_border, grabbed, moved_light, place_of_light, pulled_in, way_sign,
};
use crate::inspector::canvas::map_handles::{MapHandles, MapPart};
use crate::inspector::look::{theme, widgets};
use crate::inspector::model::Model;
use crate::inspector::model::scene::OpenScene;
use crate::scene::{Light, Object, Pose};
use egui::{Align2, Painter, Pos2, Rect, Shape, Stroke, Ui, Vec2, vec2};
use glam::{DMat3, DVec3};

/// Side of the area that can be grabbed, points.
const GRAB: f32 = 18.0;
/// Length of an axis, points.
const AXIS: f64 = 44.0;
/// A view smaller than this, points, has no space for handles of what is out of it.
const LEAST_VIEW: f32 = 96.0;
const AXES: [(&str, DVec3); 3] = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];

/// Draws lights, eye and target into a view, objects only where they can be moved, with handles where those are
/// switched on; what the user moves is run. Another program's frame gets signs without handles.
pub fn ui(
    ui: &Ui,
    model: &mut Model,
    view: &mut SceneView,
    anatomy: &Anatomy,
    here: &GizmoView,
    actions: &mut Vec<Action>,
) {
    let GizmoView { lens, rect, .. } = *here;
    let Some(scene) = model.scene.as_mut() else {
        return signs(ui, anatomy, view.shown.names, here);
    };
    let painter = ui.painter_at(rect);
    let mut changed = false;
    let lights = (0..scene.draft.lights.len()).map(HandleKind::Light);
    let movable = 0..if view.gizmos && view.moves_objects { scene.object_count() } else { 0 };
    let objects = movable.filter(|index| !scene.draft.off.contains(index)).map(HandleKind::Object);
    let objects: Vec<HandleKind> = objects.collect();
    let spot = |scene: &OpenScene, grip| place(scene, grip, here).and_then(|at| lens.place(at));
    let has_handles = view.gizmos && rect.size().min_elem() > LEAST_VIEW;
    // A light or a camera out of view has its handle at the border, so that it can always be had.
    let border = |scene: &OpenScene, grip| match grip {
        HandleKind::Light(_) | HandleKind::Eye if has_handles => {
            place(scene, grip, here).map(|at| at_border(rect, lens.towards(at)))
        }
        _ => spot(scene, grip).filter(|at| rect.contains(*at)).map(|at| (at, None)),
    };
    let taken: Vec<Pos2> = objects.iter().filter_map(|grip| spot(scene, *grip)).collect();
    let is_shown = |map: &&MapHandles| has_handles && view.choice.light.is_none_or(|one| one == map.light);
    let maps: Vec<MapHandles> = here.maps.iter().filter(is_shown).copied().collect();
    let parts = maps.iter().flat_map(|map| MapPart::ALL.map(|part| HandleKind::Map(map.light, part)));
    // The last one is on top.
    let grips: Vec<HandleKind> =
        [HandleKind::Target, HandleKind::Eye].into_iter().chain(parts).chain(objects).chain(lights).collect();
    let camera = scene.draft.camera;
    if let (Some(eye), Some(target)) = (lens.place(camera.eye), lens.place(camera.target)) {
        painter.extend(Shape::dashed_line(&[eye, target], Stroke::new(1.0, theme::of(ui).dim), 2.0, 4.0));
    }
    maps.iter().for_each(|map| outline(ui, &painter, map, lens));
    for grip in grips {
        let Some((at, outwards)) = border(scene, grip) else { continue };
        sign(ui, &painter, grip, is_directional(&scene.draft, grip) && outwards.is_none(), at, here);
        if let Some(way) = outwards {
            way_sign(&painter, at, way, Stroke::new(1.8, ink_of(ui, grip)));
        }
        // The camera looks at the middle of a model: a user who wants to move the model must not move the target
        // instead.
        let is_hidden = grip == HandleKind::Target && taken.iter().any(|other| other.distance(at) < GRAB / 2.0);
        let is_object = matches!(grip, HandleKind::Object(_));
        let is_named = view.shown.names && !matches!(grip, HandleKind::Map(..));
        let plate = (is_named || is_object).then(|| name(ui, &painter, &name_of(scene, grip), at));
        let sign = Rect::from_center_size(at, Vec2::splat(GRAB));
        // An object's sign is small and may lie on another: its name is a handle too.
        let grab = plate.filter(|_| is_object).map_or(sign, |plate| sign.union(plate));
        if view.gizmos && !is_hidden {
            changed |= handle(ui, view, scene, grip, HandleSpot { at, grab, is_out: outwards.is_some() }, here);
        }
    }
    if changed {
        model.run_draft(actions);
    }
}

/// Draws the far rectangle between a map's corners and the axis between its planes, dashed: what the handles stand for, which
/// of a fitted map is another frustum than the drawn one.
fn outline(ui: &Ui, painter: &Painter, map: &MapHandles, lens: &Lens) {
    let ink = Stroke::new(1.0, theme::of(ui).lit);
    let corners = [0, 1, 2, 3].map(|corner| map.place(MapPart::Corner(corner)));
    let sides = [0, 1, 2, 3].map(|corner| [corners[corner], corners[(corner + 1) % 4]]);
    let axis = [map.place(MapPart::Near), map.place(MapPart::Far)];
    for ends in sides.into_iter().chain([axis]).filter_map(|ends| lens.line(ends)) {
        painter.extend(Shape::dashed_line(&ends, ink, 4.0, 4.0));
    }
}

/// Draws the found lights and the eye of another program's frame, which can't be moved, in the view `here`; their names
/// where `has_names`.
fn signs(ui: &Ui, anatomy: &Anatomy, has_names: bool, here: &GizmoView) {
    let painter = ui.painter_at(here.rect);
    let lights = anatomy.lights.iter().enumerate().map(|(index, light)| {
        let light = Light { position: light.position, ..Light::point(DVec3::ZERO) };
        (HandleKind::Light(index), place_of_light(&light, 0.0, here.anchor), light.is_directional())
    });
    for (grip, place, is_directional) in std::iter::once((HandleKind::Eye, anatomy.camera.eye, false)).chain(lights) {
        let Some(at) = here.lens.place(place).filter(|at| here.rect.contains(*at)) else { continue };
        sign(ui, &painter, grip, is_directional, at, here);
        if has_names {
            name(ui, &painter, &grip.name(), at);
        }
    }
}

/// Returns the colour of the sign of a light or an eye.
fn ink_of(ui: &Ui, grip: HandleKind) -> egui::Color32 {
    if matches!(grip, HandleKind::Light(_)) { theme::of(ui).lit } else { theme::of(ui).text }
}

/// Draws the name of a thing under its sign, and returns the rectangle that it takes.
fn name(ui: &Ui, painter: &Painter, name: &str, at: Pos2) -> Rect {
    widgets::plate(painter, at + vec2(0.0, 10.0), Align2::CENTER_TOP, name, false, theme::of(ui))
}

/// Returns the name of a handle for the user: an object's own name, where there is such an object, otherwise that of
/// [`HandleKind::name`].
fn name_of(scene: &OpenScene, grip: HandleKind) -> String {
    let object = if let HandleKind::Object(index) = grip { scene.placed(index) } else { None };
    object.map_or_else(|| grip.name(), |(object, _)| object.name.clone())
}

fn is_directional(draft: &RunRequest, grip: HandleKind) -> bool {
    matches!(grip, HandleKind::Light(index) if draft.lights[index].is_directional())
}

/// The view of one pane that gizmos are drawn into: its lens (world to screen), its rectangle, and the anchor that
/// directional lights are placed around.
pub struct GizmoView<'a> {
    pane: Pane,
    lens: &'a Lens,
    rect: Rect,
    anchor: HandleAnchor,
    /// The frusta of maps that have handles.
    maps: Vec<MapHandles>,
}

impl<'a> GizmoView<'a> {
    /// Returns a pane's view of the stage in `rect`, with the handles of directional lights at 0.85 of the scene's
    /// radius from its middle, and those of the given maps.
    pub fn new(pane: Pane, lens: &'a Lens, rect: Rect, stage: &SceneStage, maps: Vec<MapHandles>) -> GizmoView<'a> {
        let anchor = HandleAnchor { middle: stage.middle, reach: 0.85 * stage.radius };
        GizmoView { pane, lens, rect, anchor, maps }
    }

    fn map(&self, light: usize) -> Option<&MapHandles> {
        self.maps.iter().find(|map| map.light == light)
    }
}

/// Returns where a handle's thing is at the draft's time, world space: a light, eye or target, or the middle of an
/// object's box; `None` where there is no such light or object.
fn place(scene: &OpenScene, grip: HandleKind, here: &GizmoView) -> Option<DVec3> {
    let (draft, anchor) = (&scene.draft, here.anchor);
    match grip {
        HandleKind::Light(index) => draft.lights.get(index).map(|light| place_of_light(light, draft.time, anchor)),
        HandleKind::Eye => Some(draft.camera.eye),
        HandleKind::Target => Some(draft.camera.target),
        HandleKind::Map(light, part) => here.map(light).map(|map| map.place(part)),
        HandleKind::Object(index) => {
            let (object, pose) = scene.placed(index)?;
            let pose = object.motion.apply(&pose, draft.time);
            Some(pose.world_from_object().transform_point3(scene.middle_of(index, object)))
        }
    }
}

fn move_by(scene: &mut OpenScene, grip: HandleKind, by: DVec3, here: &GizmoView) {
    let (draft, anchor) = (&mut scene.draft, here.anchor);
    match grip {
        HandleKind::Light(index) => {
            draft.lights[index].position = moved_light(&draft.lights[index], draft.time, by, anchor);
        }
        HandleKind::Eye => draft.camera.eye += by,
        HandleKind::Target => draft.camera.target += by,
        HandleKind::Map(light, part) => {
            let value = here.map(light).map(|map| map.moved(part, by));
            if let Some(value) = value {
                draft.choice.set_light_frustum(&value);
            }
        }
        HandleKind::Object(index) => {
            let time = draft.time;
            if let Some(object) = scene.object(index) {
                scene.place(index, moved_object(&object, time, by));
            }
        }
    }
}

/// Returns an object's pose at the scene's start after it was moved by `by`, metres in world space, at a time in
/// seconds, so that its motion leads there.
fn moved_object(object: &Object, time: f64, by: DVec3) -> Pose {
    let pose = object.pose;
    let moved = |by: DVec3| Pose { translate: pose.translate + by, ..pose };
    if object.motion.is_still() {
        return moved(by);
    }
    // Motions are rigid: a translation at the start is a rotated translation at that time.
    let at = |by: DVec3| object.motion.apply(&moved(by), time).translate;
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| at(axis) - at(DVec3::ZERO));
    moved(DMat3::from_cols(x, y, z).transpose() * by)
}

/// Draws the sign of a light (with an arrow towards the scene's middle where it is directional), an eye, a target or an
/// object at a position on the screen, whether it can be moved or not.
fn sign(ui: &Ui, painter: &Painter, grip: HandleKind, is_directional: bool, at: Pos2, here: &GizmoView) {
    let colors = theme::of(ui);
    match grip {
        HandleKind::Light(_) => {
            if is_directional && let Some(middle) = here.lens.place(here.anchor.middle) {
                let along = (middle - at) * 0.35;
                painter.arrow(at, along, Stroke::new(1.5, colors.lit));
            }
            for turn in 0..8 {
                let ray = Vec2::angled(turn as f32 * std::f32::consts::FRAC_PI_4);
                painter.line_segment([at + ray * 7.0, at + ray * 10.0], Stroke::new(1.5, colors.lit));
            }
            painter.circle(at, 5.0, colors.lit, Stroke::new(1.0, colors.background));
        }
        HandleKind::Eye => {
            let body = Rect::from_center_size(at, vec2(11.0, 8.0));
            painter.rect(body, 2, colors.text, Stroke::new(1.0, colors.background), egui::StrokeKind::Outside);
            painter.circle_filled(at, 2.2, colors.background);
        }
        HandleKind::Target => {
            painter.circle_stroke(at, 4.0, Stroke::new(1.5, colors.dim));
            painter.circle_filled(at, 1.2, colors.dim);
        }
        HandleKind::Map(_, part) => {
            let side = if matches!(part, MapPart::Corner(_)) { 6.0 } else { 8.0 };
            let turned = [vec2(0.0, -side), vec2(side, 0.0), vec2(0.0, side), vec2(-side, 0.0)].map(|by| at + by * 0.7);
            painter.add(Shape::convex_polygon(turned.to_vec(), colors.background, Stroke::new(1.5, colors.lit)));
        }
        HandleKind::Object(_) => {
            let body = Rect::from_center_size(at, Vec2::splat(8.0));
            painter.rect(body, 1, colors.raised, Stroke::new(1.5, colors.text), egui::StrokeKind::Middle);
        }
    }
}

/// Where a handle is on the screen.
struct HandleSpot {
    /// Its middle.
    at: Pos2,
    /// What can be grabbed.
    grab: Rect,
    /// Its thing is out of view, and it stands at the border.
    is_out: bool,
}

/// Draws a handle and, where it is the chosen one, its axes, and moves its thing by drags and arrow keys. A handle that
/// is used becomes the chosen one, and its object the edited one. One that is out of view (`is_out`) has no axes; dragged
/// into the view, its thing comes to the pointer. Returns true where it was moved.
fn handle(
    ui: &Ui,
    view: &mut SceneView,
    scene: &mut OpenScene,
    grip: HandleKind,
    HandleSpot { at, grab, is_out }: HandleSpot,
    here: &GizmoView,
) -> bool {
    let in_view = format!("in the {} view", here.pane.name());
    let id = ui.scope_id().with(("gizmo", here.pane.name(), grip));
    let called = name_of(scene, grip);
    let response = grabbed(ui, id, grab, &format!("{called} {in_view}"));
    let pulled_to = pulled_in(ui, &response, here.rect, at);
    let away = if is_out { ", out of view this way: drag it into the view" } else { ": drag it" };
    let response = response.on_hover_text(format!("{called}{away}, or use the arrow keys"));
    if response.drag_started() || response.clicked() || response.gained_focus() {
        view.grip = Some(grip);
        if let HandleKind::Object(index) = grip {
            scene.edited = index;
        }
    }
    let painter = ui.painter_at(here.rect);
    if response.hovered() || response.has_focus() || view.grip == Some(grip) {
        let ink = if response.has_focus() { theme::of(ui).focus } else { theme::of(ui).selected };
        painter.circle_stroke(at, GRAB / 2.0 + 2.0, Stroke::new(1.5, ink));
    }
    let lens = here.lens;
    let Some(point) = place(scene, grip, here) else { return false };
    let mut by = DVec3::ZERO;
    if response.dragged() && response.drag_delta() != Vec2::ZERO {
        by += match pulled_to.filter(|_| is_out) {
            Some(to) => lens.center + lens.moved(lens.center, to - lens.middle) - point,
            // Out of view it may be behind the eye, where a point of the screen is no length.
            None => lens.moved(if is_out { lens.center } else { point }, response.drag_delta()),
        };
    }
    if let Some([right, up]) = arrows(ui, &response) {
        let step = f64::from(here.rect.height()) / lens.scale;
        by += (nearest_axis(lens.rotation.row(0)) * right + nearest_axis(lens.rotation.row(1)) * up) * step;
    }
    let has_axes = !is_directional(&scene.draft, grip) && !matches!(grip, HandleKind::Map(..));
    if view.grip == Some(grip) && !is_out && has_axes {
        for (letter, axis) in AXES {
            let length = lens.moved(point, vec2(AXIS as f32, 0.0)).length();
            let Some([from, tip]) = lens.line([point, point + axis * length]) else { continue };
            // An axis seen from its end can't be dragged along.
            if (tip - from).length() < 8.0 {
                continue;
            }
            let grab = Rect::from_center_size(tip, Vec2::splat(GRAB));
            let name = format!("{called} along {letter} {in_view}");
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
        move_by(scene, grip, by, here);
    }
    by != DVec3::ZERO
}

/// Returns the world axis, with its sign, that is nearest to a direction.
fn nearest_axis(direction: DVec3) -> DVec3 {
    let along = |axis: &&(&str, DVec3)| direction.dot(axis.1).abs();
    let nearest = AXES.iter().max_by(|a, b| along(a).total_cmp(&along(b)));
    nearest.map_or(DVec3::ZERO, |(_, axis)| *axis * direction.dot(*axis).signum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Motion, Orbit, Swing, shapes};

    #[test]
    fn arrow_keys_go_along_the_axis_that_is_nearest() {
        assert_eq!(nearest_axis(DVec3::new(0.3, 0.1, -0.9)), DVec3::NEG_Z);
        assert_eq!(nearest_axis(DVec3::new(0.8, 0.1, -0.3)), DVec3::X);
    }

    #[test]
    fn an_object_that_moves_is_moved_where_it_is_seen() {
        let orbit =
            Orbit { center: DVec3::new(2.0, 0.0, 1.0), axis: DVec3::new(1.0, 2.0, 0.5), degrees_per_second: 30.0 };
        let swing = Swing { pivot: DVec3::Y * 4.0, axis: DVec3::Z, degrees: 25.0, period_seconds: 3.0 };
        let motion = Motion { orbit: Some(orbit), swing: Some(swing), ..Motion::default() };
        let object = Object::of("box", shapes::cuboid([1.0; 3]).expect("a box")).at([1.0, 2.0, 3.0]);
        let object = Object { motion, ..object };
        let by = DVec3::new(0.3, -0.2, 0.7);
        for time in [0.0, 1.3, 7.7] {
            let at = |pose: &Pose| object.motion.apply(pose, time).translate;
            let found = at(&moved_object(&object, time, by)) - at(&object.pose);
            assert!((found - by).length() < 1e-9, "{time}: {found}");
        }
    }
}
