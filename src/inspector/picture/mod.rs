//! The picture: the largest thing, everything else serves it.
//!
//! Wheel zooms at the pointer, left-drag pans, right-click or right-drag picks. Texels are never
//! blended when magnified, and from 24 points a texel on each shows its number.

mod canvas;
mod overlay;
mod toolbar;

use super::texture::{Look, Textures};
use super::{PictureKind, State, theme};
use crate::capture::Image;
use egui::{Color32, Id, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use std::sync::Arc;

/// Points a texel from which numbers are drawn on texels.
const NUMBERS_FROM: f32 = 24.0;

/// The focus of the picture: while it has it, arrows nudge the pick.
pub(super) fn focus_id() -> Id {
    Id::unique("picture")
}

pub(super) fn ui(ui: &mut Ui, state: &mut State, textures: &mut Textures) {
    if state.capture.is_none() {
        ui.centered_and_justified(|ui| {
            let hint = if state.job.is_some() { "Working…" } else { "Open a scene, or drop a model here." };
            ui.label(theme::dim(hint));
        });
        return;
    }
    if !state.available().contains(&state.picture) {
        state.picture = PictureKind::Color;
    }
    toolbar::ui(ui, state, textures);
    let canvas = ui.available_rect_before_wrap();
    if canvas.width() < 8.0 || canvas.height() < 8.0 {
        return;
    }
    if shows_all_faces(state) {
        all_faces(ui, state, textures, canvas);
        return;
    }
    let Some(image) = state.image().cloned() else {
        ui.label(theme::dim("This pass comes before any picture: choose “Shadow map”."));
        return;
    };
    let view = canvas::interact(ui, state, canvas, image.size());
    ui.painter().rect_filled(canvas, 0.0, theme::BACKGROUND);
    let painter = ui.painter().with_clip_rect(canvas);
    let look = look_of(state, textures, &image);
    let texture = textures.get(ui.ctx(), &image, look, u32::MAX);
    painter.image(texture.id(), view.rect_of_picture(image.size()), whole(), Color32::WHITE);
    if view.zoom >= NUMBERS_FROM {
        overlay::numbers(&painter, state, &image, &view);
    }
    if state.picture != PictureKind::Map
        && let Some(pick) = state.pick
    {
        overlay::crosshair(&painter, &view, pick);
        if view.zoom < NUMBERS_FROM {
            overlay::magnifier(&painter, state, &image, canvas, pick);
        }
    }
    if matches!(state.picture, PictureKind::Stencil | PictureKind::Mask) {
        overlay::legend(ui, state, &image, canvas);
    }
}

fn whole() -> Rect {
    Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0))
}

/// The near plane by which distances are shown; `None` where stored values are.
fn near_of(state: &State) -> Option<f32> {
    let capture = state.capture.as_ref()?;
    (state.picture == PictureKind::Depth && !state.depth.raw).then_some(capture.camera.near as f32)
}

fn look_of(state: &State, textures: &mut Textures, image: &Arc<Image>) -> Look {
    match state.picture {
        PictureKind::Color => Look::Color,
        PictureKind::Stencil => Look::Stencil,
        PictureKind::Mask => Look::Labels,
        PictureKind::Depth => textures.depth_look(image, near_of(state), state.depth.ends),
        PictureKind::Map => textures.depth_look(image, None, None),
    }
}

fn faces(state: &State) -> &[Arc<Image>] {
    let light = state.capture.as_ref().and_then(|capture| capture.lights.get(state.light));
    light.and_then(|light| light.map.as_ref()).map_or(&[], |map| &map.faces)
}

fn shows_all_faces(state: &State) -> bool {
    state.picture == PictureKind::Map && state.face.is_none() && faces(state).len() > 1
}

/// Names of a cube's faces in wgpu's order.
const FACES: [&str; 6] = ["+x", "-x", "+y", "-y", "+z", "-z"];

/// Six faces side by side; a click opens one.
fn all_faces(ui: &mut Ui, state: &mut State, textures: &mut Textures, canvas: Rect) {
    let faces = faces(state).to_vec();
    let cell = vec2(canvas.width() / 3.0, canvas.height() / 2.0);
    let mut chosen = None;
    for (index, (face, name)) in faces.iter().zip(FACES).enumerate() {
        let corner = canvas.min + vec2((index % 3) as f32 * cell.x, (index / 3) as f32 * cell.y);
        let side = (cell.x - theme::SPACE * 2.0).min(cell.y - theme::ROW - theme::SPACE);
        let place = Rect::from_min_size(corner + vec2(0.0, theme::ROW), vec2(side, side));
        let look = textures.depth_look(face, None, None);
        let texture = textures.get(ui.ctx(), face, look, 1024);
        ui.painter().image(texture.id(), place, whole(), Color32::WHITE);
        ui.painter().rect_stroke(place, 0.0, Stroke::new(1.0, theme::LINE), StrokeKind::Outside);
        let empty = if face.rows().flatten().all(|byte| *byte == 0) { " · left out" } else { "" };
        label(ui, corner, &format!("face {name}{empty}"));
        let response = ui.interact(place, Id::unique(("face", index)), Sense::click());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Show face {name}")));
        if response.clicked() {
            chosen = Some(index);
        }
    }
    state.face = chosen;
}

fn label(ui: &Ui, at: Pos2, text: &str) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    ui.painter().text(at + vec2(0.0, theme::SPACE), egui::Align2::LEFT_TOP, text, font, theme::DIM);
}
