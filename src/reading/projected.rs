//! World positions in the picture, clipped before they are projected.
//!
//! A face of a shadow volume reaches behind the eye and to infinity. So it is clipped at the near plane, and a little
//! outside of the picture's four edges, where what is left has a place on the screen (Sutherland and Hodgman 1974, in
//! homogeneous coordinates).

use crate::capture::Capture;
use crate::history::PixelEvent;
use crate::math::clip::{clip_planes, near_plane, visible};
use crate::plan::FramePlan;
use glam::{DMat4, DVec2, DVec4};

/// Lines are clipped where |x| or |y| reaches this times w; the picture ends at 1.
const GUARD: f64 = 1.2;
/// The same limit for outlined triangles, so far outside that the edges which clipping adds are not seen.
const OUTLINE_GUARD: f64 = 1.5;

/// How the nearness of a clip-space point is computed; it is linear in the picture.
#[derive(Debug, Clone, Copy)]
enum Nearness {
    /// 1 / w.
    InverseDistance,
    /// The dot product with this row, over w: for a parallel projection, where w is constant.
    Linear(DVec4),
}

/// Projects world positions to pixels of a capture's picture, with clipping.
#[derive(Debug, Clone)]
pub struct Projector {
    clip_from_world: DMat4,
    planes: [DVec4; 5],
    half: DVec2,
    nearness: Nearness,
}

impl Projector {
    /// Returns the projector of a capture's camera.
    pub fn new(capture: &Capture) -> Projector {
        let [width, height] = capture.size.map(f64::from);
        let camera = &capture.camera;
        let view_from_relative = DMat4::from_mat3(camera.world_from_view().transpose());
        let clip_from_view = camera.picture_from_view(capture.size, &capture.depth);
        let clip_from_world = clip_from_view * view_from_relative * DMat4::from_translation(-camera.eye);
        Projector {
            clip_from_world,
            planes: clip_planes(near_plane(&capture.depth), GUARD),
            half: DVec2::new(width, height) / 2.0,
            nearness: match (capture.depth.is_linear, capture.depth.mapping.is_reversed()) {
                (false, _) => Nearness::InverseDistance,
                (true, true) => Nearness::Linear(DVec4::Z + DVec4::W),
                (true, false) => Nearness::Linear(DVec4::W * 2.0 - DVec4::Z),
            },
        }
    }

    /// Returns the visible part of the segment between two homogeneous world positions, in pixels, clipped at the near
    /// plane and a margin around the picture; `None` where none is visible.
    pub fn segment(&self, ends: [DVec4; 2]) -> Option<[DVec2; 2]> {
        let [mut from, mut to] = ends.map(|end| self.clip_from_world * end);
        for plane in self.planes {
            let [a, b] = [plane.dot(from), plane.dot(to)];
            if a < 0.0 && b < 0.0 {
                return None;
            }
            if a < 0.0 {
                from = from.lerp(to, a / (a - b));
            } else if b < 0.0 {
                to = from.lerp(to, a / (a - b));
            }
        }
        let is_before = from.w > 0.0 && to.w > 0.0;
        is_before.then(|| [from, to].map(|end| place(end, self.half)))
    }

    /// Returns the visible part of a triangle of homogeneous world positions as a convex polygon: corners in pixels,
    /// each with its nearness, 1 / w (in a parallel projection, from 2 at the near plane to 1 where depth ends). Empty
    /// where nothing is visible.
    pub fn polygon(&self, corners: [DVec4; 3]) -> Vec<(DVec2, f64)> {
        let seen = visible(&self.planes, corners.map(|corner| self.clip_from_world * corner));
        seen.into_iter().map(|corner| (place(corner, self.half), self.near(corner))).collect()
    }

    fn near(&self, clip: DVec4) -> f64 {
        match self.nearness {
            Nearness::InverseDistance => 1.0 / clip.w,
            Nearness::Linear(row) => row.dot(clip) / clip.w,
        }
    }
}

/// Returns the corners of the visible part of the triangle of a pixel's event, in pixels; `plan` is the plan of the frame.
/// Empty where no part is in front of the eye, and for an event without a triangle.
pub fn outline(plan: &FramePlan, event: &PixelEvent) -> Vec<DVec2> {
    let Some((one, pass)) = event.triangle().zip(plan.passes.get(event.pass)) else { return Vec::new() };
    // Another program's corners are in clip space already.
    let clip_from_corner = match pass.recorded.is_some() {
        true => DMat4::IDENTITY,
        false => plan.views.get(pass.view.0).map_or(DMat4::IDENTITY, |view| view.clip_from_relative.as_dmat4()),
    };
    let corners = one.corners.map(|corner| clip_from_corner * DVec4::from_array(corner.map(f64::from)));
    outline_in(pass.viewport(plan.size).area, near_plane(&plan.depth), corners)
}

/// Returns the visible part of a triangle in clip space within a viewport, in pixels.
fn outline_in([left, top, width, height]: [f32; 4], near: DVec4, corners: [DVec4; 3]) -> Vec<DVec2> {
    let [origin, half] = [DVec2::new(left.into(), top.into()), DVec2::new(width.into(), height.into()) / 2.0];
    let planes = clip_planes(near, OUTLINE_GUARD);
    visible(&planes, corners).into_iter().map(|corner| origin + place(corner, half)).collect()
}

/// Returns where a point in clip space is in a viewport of twice `half`, in pixels from its upper left corner.
fn place(clip: DVec4, half: DVec2) -> DVec2 {
    DVec2::new(clip.x / clip.w + 1.0, 1.0 - clip.y / clip.w) * half
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::depth::DepthMapping;
    use crate::scene::Camera;
    use glam::DVec3;

    /// What is seen of a triangle by an eye that looks down −z, a quarter turn wide each way, in a picture of 200 × 200.
    fn outline(mapping: DepthMapping, corners: [[f64; 4]; 3]) -> Vec<DVec2> {
        let camera = Camera {
            eye: DVec3::ONE,
            target: DVec3::new(1.0, 1.0, 0.0),
            up: DVec3::Y,
            projection: crate::scene::Projection::Perspective,
            fov_y_degrees: 90.0,
            near: 0.5,
            far: None,
            viewport: None,
        };
        let depth = mapping.curve(0.5, 100.0, 0.0);
        let clip_from_view = camera.clip_from_view(1.0, &depth);
        let corners = corners.map(|corner| clip_from_view * DVec4::from_array(corner));
        outline_in([0.0, 0.0, 200.0, 200.0], near_plane(&depth), corners)
    }

    fn is_near(found: &[DVec2], expected: &[[f64; 2]]) -> bool {
        let is_one = |at: &&[f64; 2]| found.iter().any(|one| one.distance(DVec2::from_array(**at)) < 1e-6);
        found.len() == expected.len() && expected.iter().filter(is_one).count() == expected.len()
    }

    #[test]
    fn a_triangle_before_the_eye_keeps_its_corners() {
        for mapping in DepthMapping::ALL {
            let corners = [[0.0, 0.0, -2.0, 1.0], [1.0, 0.0, -2.0, 1.0], [0.0, 1.0, -2.0, 1.0]];
            let found = outline(mapping, corners);
            assert!(is_near(&found, &[[100.0, 100.0], [150.0, 100.0], [100.0, 50.0]]), "{mapping:?}: {found:?}");
        }
    }

    #[test]
    fn a_corner_at_infinity_is_where_its_direction_points() {
        let corners = [[0.0, 0.0, -2.0, 1.0], [0.5, 0.0, -1.0, 0.0], [0.0, 1.0, -2.0, 1.0]];
        let found = outline(DepthMapping::ReversedInfinite, corners);
        assert!(is_near(&found, &[[100.0, 100.0], [150.0, 100.0], [100.0, 50.0]]), "{found:?}");
    }

    #[test]
    fn what_reaches_behind_the_eye_is_cut_at_the_near_plane_and_outside_the_picture() {
        // In the plane y = 0.1, from 1 ahead to 1 behind: 0.1 above the middle at distance 1, and
        // 0.2 at the near plane.
        let corners = [[-0.5, 0.1, -1.0, 1.0], [0.5, 0.1, -1.0, 1.0], [0.0, 0.1, 1.0, 1.0]];
        let found = outline(DepthMapping::ReversedInfinite, corners);
        assert_eq!(found.len(), 4, "{found:?}");
        let lowest = found.iter().map(|at| at.y).fold(f64::INFINITY, f64::min);
        assert!((lowest - 80.0).abs() < 1e-6, "{found:?}");
        let limit = 100.0 * OUTLINE_GUARD + 1e-6;
        assert!(found.iter().all(|at| (*at - 100.0).abs().max_element() <= limit), "{found:?}");
    }

    #[test]
    fn nothing_is_left_of_what_lies_behind_the_eye_or_far_beside_the_picture() {
        for mapping in DepthMapping::ALL {
            let behind = [[0.0, 0.0, 2.0, 1.0], [1.0, 0.0, 2.0, 1.0], [0.0, 1.0, 2.0, 1.0]];
            assert!(outline(mapping, behind).is_empty(), "{mapping:?}");
            let beside = [[9.0, 0.0, -2.0, 1.0], [8.0, 0.0, -2.0, 1.0], [9.0, 1.0, -2.0, 1.0]];
            assert!(outline(mapping, beside).is_empty(), "{mapping:?}");
        }
    }

    #[test]
    fn a_direction_across_the_view_is_cut_at_the_guard() {
        let corners = [[0.0, 0.0, -2.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, -2.0, 1.0]];
        let found = outline(DepthMapping::ReversedInfinite, corners);
        assert!(!found.is_empty() && found.iter().all(|at| at.is_finite()), "{found:?}");
    }
}
