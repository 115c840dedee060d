//! The part of a picture that a camera draws into (glViewport), and the rest of the picture beside it, where its projection
//! goes on.

use super::{Camera, CameraRays};
use crate::math::depth::DepthCurve;
use glam::{DMat4, DVec2, DVec4};

/// Returns whether a viewport's shares are a part of the picture, but for rounding.
pub(super) fn is_in_picture([left, top, width, height]: [f64; 4]) -> bool {
    let is_span = |start: f64, share: f64| start >= 0.0 && share > 0.0 && start + share <= 1.0 + 1e-9;
    is_span(left, width) && is_span(top, height)
}

impl Camera {
    /// Returns the pixels of a picture of `size` pixels that the camera draws into: left, top, columns and rows. A
    /// viewport's edges are rounded to whole pixels; it has at least one.
    pub fn viewport_in(&self, size: [u32; 2]) -> [u32; 4] {
        let [left, top, width, height] = self.viewport.unwrap_or(Camera::WHOLE_PICTURE);
        let span = |start: f64, share: f64, pixels: u32| {
            let edge = |at: f64| (at * f64::from(pixels)).round() as u32;
            let first = edge(start).min(pixels.saturating_sub(1));
            [first, edge(start + share).clamp(first + 1, pixels.max(first + 1)) - first]
        };
        let ([left, columns], [top, rows]) = (span(left, width, size[0]), span(top, height, size[1]));
        [left, top, columns, rows]
    }

    /// Returns the width of what the camera draws into over its height, in a picture of `size` pixels.
    pub fn aspect_in(&self, size: [u32; 2]) -> f64 {
        let [_, _, columns, rows] = self.viewport_in(size).map(f64::from);
        columns / rows
    }

    /// Returns the view rays of all of a picture of `size` pixels, also of what lies outside of the viewport, where nothing
    /// is drawn: the projection continues there.
    pub fn picture_rays(&self, size: [u32; 2]) -> CameraRays {
        let rays = self.rays(self.aspect_in(size));
        let (middle, half) = self.picture_in_viewport(size);
        CameraRays { center: rays.center + middle * rays.half, half: rays.half * half, ..rays }
    }

    /// Returns clip space of a whole picture of `size` pixels, also of what lies outside of the viewport, from view space.
    /// Where there is a viewport, it is not what is drawn with: that is [`Camera::clip_from_view`].
    pub fn picture_from_view(&self, size: [u32; 2], depth: &DepthCurve) -> DMat4 {
        let (middle, half) = self.picture_in_viewport(size);
        let [across, up] = [1.0 / half.x, 1.0 / half.y];
        let picture_from_viewport = DMat4::from_cols(
            DVec4::X * across,
            DVec4::Y * up,
            DVec4::Z,
            DVec4::new(-middle.x * across, -middle.y * up, 0.0, 1.0),
        );
        picture_from_viewport * self.clip_from_view(self.aspect_in(size), depth)
    }

    /// Returns where the middle of a picture of `size` pixels is and half of its size, in the viewport's normalized device
    /// coordinates: zero and one where the viewport is the picture.
    fn picture_in_viewport(&self, size: [u32; 2]) -> (DVec2, DVec2) {
        let [left, top, columns, rows] = self.viewport_in(size).map(f64::from);
        let [width, height] = size.map(f64::from);
        let middle = DVec2::new((width - 2.0 * left) / columns - 1.0, 1.0 - (height - 2.0 * top) / rows);
        (middle, DVec2::new(width / columns, height / rows))
    }
}
