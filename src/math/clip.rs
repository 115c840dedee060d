//! Triangles clipped in homogeneous coordinates (Sutherland and Hodgman 1974), before they are divided by w.

use super::depth::DepthCurve;
use glam::DVec4;

/// Returns the planes at which a projection is clipped, positive inside: `near`, and where |x| or |y| reaches `guard` times
/// w; the picture ends at 1.
pub fn clip_planes(near: DVec4, guard: f64) -> [DVec4; 5] {
    let [right, left, above, below] = [DVec4::X, -DVec4::X, DVec4::Y, -DVec4::Y].map(|side| side + DVec4::W * guard);
    [near, right, left, above, below]
}

/// Returns the part of a triangle in clip space that is inside of all planes, as corners in order.
pub fn visible(planes: &[DVec4; 5], corners: [DVec4; 3]) -> Vec<DVec4> {
    let is_beyond = |plane: &DVec4, corner: &DVec4| plane.dot(*corner) < 0.0;
    // Most triangles are visible as a whole or not at all.
    if planes.iter().any(|plane| corners.iter().all(|corner| is_beyond(plane, corner))) {
        return Vec::new();
    }
    let crossed = planes.iter().filter(|plane| corners.iter().any(|corner| is_beyond(plane, corner)));
    let clipped = crossed.fold(corners.to_vec(), |polygon, plane| clip(&polygon, *plane));
    clipped.into_iter().filter(|corner| corner.w > 0.0).collect()
}

/// Returns the near plane in clip space, positive inside, for a depth mapping. Where depth is clamped, it is w = 0,
/// except in a parallel projection.
pub fn near_plane(depth: &DepthCurve) -> DVec4 {
    match (depth.mapping.clamps() && !depth.is_linear, depth.mapping.is_reversed()) {
        (true, _) => DVec4::W,
        (false, true) => DVec4::W - DVec4::Z,
        (false, false) => DVec4::Z,
    }
}

/// Clips a convex polygon in clip space to the positive side of a plane through the origin; corners on the plane stay.
/// Empty where nothing is left.
pub fn clip(polygon: &[DVec4], plane: DVec4) -> Vec<DVec4> {
    let mut clipped = Vec::with_capacity(polygon.len() + 1);
    for (index, &corner) in polygon.iter().enumerate() {
        let next = polygon[(index + 1) % polygon.len()];
        let [here, there] = [plane.dot(corner), plane.dot(next)];
        if here >= 0.0 {
            clipped.push(corner);
        }
        if (here < 0.0) != (there < 0.0) {
            clipped.push(corner.lerp(next, here / (here - there)));
        }
    }
    clipped
}
