//! The pick's rays and the history's selected triangle, over a view.

use super::label_places::{LabelPlace, spread};
use super::lens::Lens;
use super::stage::SceneStage;
use super::toggles::VolumeFilter;
use crate::anatomy::{Anatomy, recorded_places};
use crate::capture::Capture;
use crate::history::PixelEvent;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::numbers;
use crate::reading::pick_ray;
use crate::reading::ray_crossings::{RayCrossing, RayCrossings};
use egui::{Color32, CornerRadius, Galley, Pos2, Rect, Shape, Stroke, Ui, Vec2, vec2};
use glam::{DVec3, DVec4};
use std::sync::Arc;

/// How far behind the last face that counts those at infinity are marked, by the scene's radius.
const BEYOND: f64 = 0.4;
/// Side of the square that the sign of a light or of the camera takes, points.
const SIGN: f32 = 24.0;
/// How many faces on the ray have a label at most.
const MOST_LABELS: usize = 60;
/// The label of pixels that the light reaches.
const LIT: u8 = 0;

/// Draws the picked pixel's view ray with the volume faces that count on it, its rays to the chosen lights (by the label at
/// the pixel), the selected triangle, and the one whose row in history or ladder is under the pointer; nothing where no pixel
/// is picked, and no light rays where it shows no surface.
pub fn ui(
    ui: &Ui,
    model: &Model,
    choice: VolumeFilter,
    stage: &SceneStage,
    anatomy: &Anatomy,
    lens: &Lens,
    rect: Rect,
) {
    let (Some(capture), Some(at)) = (&model.frame.capture, model.selection.pick) else { return };
    let colors = theme::of(ui);
    let selection = &model.selection;
    let of_selected = outlined(model, capture, stage, anatomy, |event| selection.has_event(event));
    let of_pointed = outlined(model, capture, stage, anatomy, |event| selection.points_at(event));
    for (corners, color) in [(of_selected, colors.selected), (of_pointed, colors.text)] {
        corners.iter().for_each(|corners| outline(ui, corners, color, lens, rect));
    }
    let painter = ui.painter_at(rect);
    let reach = 4.0 * stage.radius;
    let surface = pick_ray::surface(capture, at);
    let ray = pick_ray::ray(capture, at);
    let start = capture.camera.eye + ray.from;
    let end = surface.unwrap_or_else(|| start + ray.along.normalize() * reach);
    if let Some(ends) = lens.line([start, end]) {
        painter.line_segment(ends, Stroke::new(1.5, colors.text));
    }
    let light = choice.light.unwrap_or_else(|| model.light_in_question(capture, at));
    let history = model.history_of_frame().filter(|history| history.pixel == at);
    if let Some(ladder) = history.and_then(|history| history.ladder(light, &capture.depth)) {
        let crossings = RayCrossings::of(&ladder, capture, at, BEYOND * stage.radius);
        let lights = anatomy.lights.iter().filter(|light| light.position.w != 0.0);
        let lights = lights.map(|light| light.position.truncate() / light.position.w);
        let signs = lights.chain([anatomy.camera.eye, anatomy.camera.target]).filter_map(|place| lens.place(place));
        let signs: Vec<Rect> = signs.map(|at| Rect::from_center_size(at, Vec2::splat(SIGN))).collect();
        paint_crossings(ui, &crossings, surface, &signs, lens, rect);
    }
    let Some(surface) = surface else { return };
    for (index, light) in anatomy.lights.iter().enumerate() {
        if choice.light.is_some_and(|one| one != index) {
            continue;
        }
        let towards = light.position.truncate();
        let end = match light.position.w == 0.0 {
            true => surface + towards.normalize_or_zero() * reach,
            false => towards / light.position.w,
        };
        let Some(ends) = lens.line([surface, end]) else { continue };
        let label = capture.lights.get(index).and_then(|light| light.shadow.as_ref()?.byte_at(at));
        match label {
            Some(LIT) => {
                painter.line_segment(ends, Stroke::new(1.5, colors.lit));
            }
            _ => {
                painter.extend(Shape::dashed_line(&ends, Stroke::new(1.5, colors.dim), 5.0, 4.0));
            }
        }
    }
    if let Some(at) = lens.place(surface) {
        painter.circle(at, 3.5, colors.text, Stroke::new(1.0, colors.background));
    }
}

/// Draws the ray on behind the surface, where faces count there, and marks those with what they add.
///
/// Labels keep off the `signs` of lights and camera, and only the first [`MOST_LABELS`] marks have one: more say no more.
fn paint_crossings(ui: &Ui, crossings: &RayCrossings, surface: Option<DVec3>, signs: &[Rect], lens: &Lens, rect: Rect) {
    let painter = ui.painter_at(rect);
    let colors = theme::of(ui);
    let behind = surface.zip(crossings.end).and_then(|(surface, end)| lens.line([surface, end]));
    if let Some(ends) = behind {
        painter.extend(Shape::dashed_line(&ends, Stroke::new(1.5, colors.text), 3.0, 4.0));
    }
    let mut labels: Vec<(Pos2, Arc<Galley>, Color32)> = Vec::new();
    for RayCrossing { place, added, is_at_infinity } in &crossings.faces {
        let Some(at) = lens.place(*place) else { continue };
        let color = if *added > 0 { colors.count_up } else { colors.count_down };
        painter.circle(at, 4.0, color, Stroke::new(1.0, colors.background));
        if labels.len() == MOST_LABELS {
            continue;
        }
        let sign = if *added > 0 { "+" } else { "" };
        let where_to = if *is_at_infinity { " at ∞" } else { "" };
        let words = format!("{sign}{}{where_to}", numbers::whole((*added).into()));
        labels.push((at, painter.layout_no_wrap(words, theme::number_font(theme::SMALL_SIZE), color), color));
    }
    // Faces are often close together on the ray: each label gets a place of its own.
    let sizes: Vec<(Pos2, Vec2)> = labels.iter().map(|(at, galley, _)| (*at, galley.size())).collect();
    for ((at, galley, color), LabelPlace { rect: place, is_led }) in labels.into_iter().zip(spread(&sizes, signs, rect))
    {
        if is_led {
            painter.line_segment([at, place.clamp(at)], Stroke::new(1.0, color.gamma_multiply(0.7)));
        }
        painter.rect_filled(
            place.expand2(vec2(2.0, 0.0)),
            CornerRadius::same(2),
            colors.background.gamma_multiply(0.8),
        );
        painter.galley(place.min, galley, color);
    }
}

/// Returns the middle of the drawn part of the selected triangle. `None` where none is selected.
pub fn middle_of_selected(model: &Model, stage: &SceneStage, anatomy: &Anatomy) -> Option<DVec3> {
    let selection = &model.selection;
    let corners = outlined(model, model.frame.capture.as_ref()?, stage, anatomy, |event| selection.has_event(event))?;
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    middle.is_finite().then_some(middle)
}

/// Returns the corners, world space, of the polygon that is drawn for the triangle of the first event in the pixel's history
/// that `is_it`; corners at infinity are cut off at a distance. `None` where there is none, it was not drawn from the eye,
/// or fewer than three corners remain.
fn outlined(
    model: &Model,
    capture: &Capture,
    stage: &SceneStage,
    anatomy: &Anatomy,
    is_it: impl Fn(&PixelEvent) -> bool,
) -> Option<Vec<DVec3>> {
    let history = model.history_of_frame()?;
    let event = history.events.iter().find(|event| is_it(event)).filter(|event| event.is_from_camera)?;
    // Corners are relative to the eye.
    let corners = event.triangle()?.corners;
    let plan = model.frame.plan.as_ref();
    let recorded = plan.and_then(|plan| recorded_places(plan, event.pass, corners));
    let world = recorded.unwrap_or_else(|| {
        corners.map(|corner| {
            let relative = DVec4::from_array(corner.map(f64::from));
            relative + (capture.camera.eye * relative.w).extend(0.0)
        })
    });
    let light = event.light.and_then(|light| anatomy.lights.get(light));
    Some(stage.polygon(world, light)).filter(|corners| corners.len() > 2)
}

/// Draws the outline of a polygon, world space, and its face faintly where all of it lies before the eye.
fn outline(ui: &Ui, corners: &[DVec3], color: Color32, lens: &Lens, rect: Rect) {
    let painter = ui.painter_at(rect);
    let points: Vec<_> = corners.iter().filter_map(|corner| lens.place(*corner)).collect();
    if points.len() == corners.len() {
        painter.add(Shape::convex_polygon(points, color.gamma_multiply(0.25), Stroke::NONE));
    }
    for (index, corner) in corners.iter().enumerate() {
        if let Some(edge) = lens.line([*corner, corners[(index + 1) % corners.len()]]) {
            painter.line_segment(edge, Stroke::new(1.5, color));
        }
    }
}
