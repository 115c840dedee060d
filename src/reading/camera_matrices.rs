//! The matrices of a camera, from world to window, with depth from 0 to 1 and as OpenGL has them, from −1 to 1.
//!
//! OpenGL's clip space begins at z = −w: with depth d = z / w of ours, its is 2 d − 1, so its row of z is twice ours less that
//! of w. Its window counts rows from below, and halves z again. Segal and Akeley, "The OpenGL Graphics System".

use super::matrices::{TransformStep, vector};
use crate::capture::Capture;
use crate::scene::Projection;
use glam::{DMat4, DVec4};

/// The three matrices of a camera.
pub(super) struct CameraMatrices {
    pub eye_from_world: DMat4,
    pub clip_from_eye: DMat4,
    pub window_from_ndc: DMat4,
    /// Whether depth is reversed: 1 at the near plane.
    pub is_reversed: bool,
    /// How many rows the picture has.
    height: f64,
}

/// OpenGL's clip space from ours: z from −w to w, from 0 to w.
pub(super) const OPENGL_FROM_CLIP: DMat4 =
    DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(0.0, 0.0, 2.0, 0.0), DVec4::new(0.0, 0.0, -1.0, 1.0));

impl CameraMatrices {
    pub fn of(capture: &Capture) -> CameraMatrices {
        let camera = &capture.camera;
        let [left, top, width, height] = camera.viewport_in(capture.size).map(f64::from);
        let [near, far] = capture.depth.range.map_or([0.0, 1.0], |range| range.stored);
        let rotation = camera.world_from_view().transpose();
        CameraMatrices {
            is_reversed: capture.depth.mapping.is_reversed(),
            eye_from_world: DMat4::from_mat3(rotation) * DMat4::from_translation(-camera.eye),
            clip_from_eye: camera.clip_from_view(width / height, &capture.depth),
            // Rows run down, y runs up.
            window_from_ndc: DMat4::from_cols(
                DVec4::new(width / 2.0, 0.0, 0.0, 0.0),
                DVec4::new(0.0, -height / 2.0, 0.0, 0.0),
                DVec4::Z * (far - near),
                DVec4::new(left + width / 2.0, top + height / 2.0, near, 1.0),
            ),
            height: f64::from(capture.size[1]),
        }
    }

    pub fn chain(&self) -> Vec<TransformStep> {
        vec![
            TransformStep::new("eye from world", self.eye_from_world),
            TransformStep::new("clip from eye", self.clip_from_eye),
            TransformStep::new("window from NDC", self.window_from_ndc),
        ]
    }

    /// Returns the last two as OpenGL has them; the window's depth is the same as ours.
    pub fn opengl(&self) -> Vec<TransformStep> {
        let from_below = DMat4::from_cols(DVec4::X, DVec4::NEG_Y, DVec4::Z, DVec4::new(0.0, self.height, 0.0, 1.0));
        let window = from_below * self.window_from_ndc * OPENGL_FROM_CLIP.inverse();
        vec![
            TransformStep::new("OpenGL's clip from eye, z from −w to w", OPENGL_FROM_CLIP * self.clip_from_eye),
            TransformStep::new("OpenGL's window from NDC, rows from below", window),
        ]
    }
}

/// Returns the kind of a capture's camera in words, with its depth as a formula of the distance.
pub(super) fn projection_words(capture: &Capture, digits: u32) -> String {
    let curve = &capture.depth;
    let kind = match capture.camera.projection {
        Projection::Perspective => "perspective".to_owned(),
        Projection::Frustum { left, right, bottom, top } => {
            let edges = [left, right, bottom, top].map(|edge| vector(&[edge], digits).trim().to_owned());
            let [left, right, bottom, top] = edges;
            format!("frustum on the near plane from {left} to {right} m across, {bottom} to {top} m up,")
        }
        Projection::Orthographic { .. } => "orthographic".to_owned(),
        Projection::Oblique { .. } => "oblique".to_owned(),
    };
    let far = match (curve.far, curve.is_linear) {
        (Some(far), _) => format!("with a far plane at {} m", vector(&[far], digits)),
        (None, true) => "without a far plane".to_owned(),
        (None, false) => "to infinity".to_owned(),
    };
    let reversed = if curve.mapping.is_reversed() { ", reversed" } else { "" };
    let times = if curve.is_linear { "*" } else { "/" };
    let [offset, scale] = curve.device();
    let sign = if scale < 0.0 { "−" } else { "+" };
    let [offset, scale] = [offset, scale.abs()].map(|value| vector(&[value], digits));
    let stored = curve.range.map_or_else(String::new, |range| {
        let [near, far] = range.stored.map(|depth| vector(&[depth], digits).trim().to_owned());
        format!(", stored from {near} to {far}")
    });
    format!(
        "{kind} {far}{reversed}: depth = {offset} {sign} {scale} {times} distance{stored}; OpenGL's z, from −1 to 1, is twice that less 1"
    )
}
