//! Where in the picture a light of limited range reaches, and whom it does not reach at all.
//!
//! What is outside of the rectangle round a light's sphere is beyond the range. Like all of `reach`, that errs
//! to the safe side.

use crate::math::{AxisBox, angle};
use crate::scene::Camera;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// By how much the sphere of a light's range is enlarged, relative to it, for rounding on the GPU.
const MARGIN: f64 = 1e-4;
/// How far rounding to `f32` may move a point, relative to its distance from the eye.
const ROUNDING: f64 = 1e-6;

/// The pixels that a light of limited range can reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RangeInView {
    /// Possibly all pixels.
    All,
    /// Those in this rectangle: left, top, columns, rows.
    Pixels([u32; 4]),
    /// No pixel.
    Nothing,
}

/// Returns which pixels of a picture of `size` pixels may show points within `range` metres of `light` (world space):
/// more than needed rather than fewer; all stands for all of the viewport. Nothing only where none can be in view, as wholly before the near plane.
pub fn range_in_view(camera: &Camera, size: [u32; 2], light: DVec3, range: f64) -> RangeInView {
    let center = camera.world_from_view().transpose() * (light - camera.eye);
    let radius = range * (1.0 + MARGIN) + center.length() * MARGIN;
    let ahead = -center.z;
    if ahead + radius < camera.near {
        return RangeInView::Nothing;
    }
    let [first_column, first_row, columns, rows] = camera.viewport_in(size);
    let (half, middle) = (camera.half_size(camera.aspect_in(size)), camera.center());
    // Seen along an axis of the picture, the sphere is a circle between two lines from the eye.
    let from_eye = |at: f64, middle: f64, half: f64| {
        let away = angle::hypot(at, ahead);
        if away <= radius {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        let (center, spread) = (angle::atan2(at, ahead), angle::asin(radius / away));
        [center - spread, center + spread].map(|edge| match edge.abs() < FRAC_PI_2 {
            true => (angle::tan(edge) - middle) / half,
            false => f64::INFINITY.copysign(edge),
        })
    };
    // Or between parallel ones, and where those are aslant it is drawn out.
    let shear = camera.projection.shear();
    let behind = ahead - (camera.target - camera.eye).length();
    let parallel = |middle: f64, shear: f64, half: f64| {
        let (middle, reach) = (middle + shear * behind, radius * angle::hypot(shear, 1.0));
        [middle - reach, middle + reach].map(|end| end / half)
    };
    let [across, down] = match camera.is_parallel() {
        true => [parallel(center.x, shear.x, half.x), parallel(-center.y, -shear.y, half.y)],
        false => [from_eye(center.x, middle.x, half.x), from_eye(-center.y, -middle.y, half.y)],
    };
    let ends = |[low, high]: [f64; 2], pixels: u32| {
        let pixels = f64::from(pixels);
        let [low, high] = [low, high].map(|end| (0.5 + 0.5 * end) * pixels);
        // A pixel more on each side, as edges are rasterised in steps.
        [low.floor() - 1.0, high.ceil() + 1.0].map(|end| end.clamp(0.0, pixels) as u32)
    };
    let [left, end_x] = ends(across, columns);
    let [top, end_y] = ends(down, rows);
    match [end_x.saturating_sub(left), end_y.saturating_sub(top)] {
        [0, _] | [_, 0] => RangeInView::Nothing,
        reached if reached == [columns, rows] => RangeInView::All,
        [columns, rows] => RangeInView::Pixels([first_column + left, first_row + top, columns, rows]),
    }
}

/// Returns by how many metres the box around some points lies beyond a light's range; `None` where a point may be
/// within it. Allows for the GPU's rounding of positions relative to `eye`.
pub fn beyond_range(points: &[DVec3], light: DVec3, range: f64, eye: DVec3) -> Option<f64> {
    let AxisBox { low, high } = AxisBox::around(points.iter().copied());
    let nearest = light.clamp(low.min(high), high.max(low));
    let farthest = points.iter().fold(light.distance(eye), |most, point| most.max(point.distance(eye)));
    let distance = nearest.distance(light) - range - MARGIN * range - ROUNDING * farthest;
    (!points.is_empty() && distance > 0.0).then_some(distance)
}

/// Returns the world-space box that contains everything within a light's range, enlarged for rounding relative to
/// `eye`.
pub fn reached(light: DVec3, range: f64, eye: DVec3) -> AxisBox {
    let reach = range * (1.0 + MARGIN) + (range + light.distance(eye)) * ROUNDING;
    AxisBox::around([light - reach, light + reach])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::depth::DepthMapping;
    use crate::scene::Projection;

    fn camera() -> Camera {
        let (eye, target) = (DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO);
        let projection = Projection::Perspective;
        Camera { eye, target, up: DVec3::Y, projection, fov_y_degrees: 90.0, near: 0.1, far: None, viewport: None }
    }

    /// Returns by how many pixels the rectangle of a light of 2 m range is larger than what its sphere's points fill, on
    /// each side: left, top, right, bottom. A side of the sphere that is out of the picture has the picture's edge.
    fn spare(camera: &Camera, size: [u32; 2], light: DVec3) -> [f64; 4] {
        let RangeInView::Pixels([left, top, columns, rows]) = range_in_view(camera, size, light, 2.0) else {
            panic!("{light}: no rectangle");
        };
        let curve = match camera.is_parallel() {
            true => DepthMapping::ReversedInfinite.linear_curve(0.1, 30.0),
            false => DepthMapping::ReversedInfinite.curve(0.1, 0.0, 0.0),
        };
        let clip_from_view = camera.picture_from_view(size, &curve);
        let [width, height] = size.map(f64::from);
        let [first, above, across, down] = camera.viewport_in(size).map(f64::from);
        let mut seen = [f64::INFINITY, f64::INFINITY, 0.0, 0.0];
        for step in 0..40_000 {
            let (a, b) = (f64::from(step % 200) * 0.0315, f64::from(step / 200) * 0.0158);
            let point = light + DVec3::new(b.sin() * a.cos(), b.cos(), b.sin() * a.sin()) * 2.0;
            let clip = clip_from_view * (point - camera.eye).extend(1.0);
            let x = ((0.5 + 0.5 * clip.x / clip.w) * width).clamp(first, first + across);
            let y = ((0.5 - 0.5 * clip.y / clip.w) * height).clamp(above, above + down);
            seen = [seen[0].min(x), seen[1].min(y), seen[2].max(x), seen[3].max(y)];
        }
        let found = [left, top, left + columns, top + rows].map(f64::from);
        [seen[0] - found[0], seen[1] - found[1], found[2] - seen[2], found[3] - seen[3]]
    }

    /// Every point of the sphere shows inside the rectangle, and the rectangle is not much larger, whatever the projection
    /// and the part of the picture that is drawn into.
    #[test]
    fn the_rectangle_holds_the_sphere_and_little_more() {
        let oblique = Projection::Oblique { half_height: 8.0, angle_degrees: 30.0, factor: 0.5 };
        let off_center = Projection::Frustum { left: -0.02, right: 0.18, bottom: -0.15, top: 0.05 };
        let near_axis = [DVec3::ZERO, DVec3::new(4.0, -3.0, 2.0), DVec3::new(-9.5, 0.0, 0.0)];
        let beside = [DVec3::new(5.0, -4.0, 0.0), DVec3::new(8.0, -7.0, 2.0)];
        for (projection, size, lights) in [
            (Projection::Perspective, [200, 200], &near_axis[..]),
            (Projection::Orthographic { half_height: 8.0 }, [200, 200], &near_axis[..2]),
            (oblique, [200, 200], &near_axis[..2]),
            (off_center, [300, 200], &beside),
        ] {
            for viewport in [None, Some([0.1, 0.25, 0.8, 0.6])] {
                let camera = Camera { projection, viewport, ..camera() };
                for light in lights {
                    let spare = spare(&camera, size, *light);
                    // At an edge of what is drawn nothing is to spare.
                    assert!(spare.iter().all(|spare| (0.0..5.0).contains(spare)), "{projection} {light}: {spare:?}");
                    let inner = spare.iter().filter(|spare| **spare > 0.5).count();
                    assert!(inner >= 3, "{projection} {viewport:?} {light}: {spare:?}");
                }
            }
        }
    }

    #[test]
    fn behind_the_eye_it_reaches_nothing_and_round_the_eye_everything() {
        let at = |z: f64, range: f64| range_in_view(&camera(), [64, 48], DVec3::new(0.0, 0.0, z), range);
        assert_eq!(at(13.0, 3.05), RangeInView::Nothing);
        assert_eq!(at(13.0, 3.2), RangeInView::All);
        assert_eq!(at(10.0, 0.01), RangeInView::Nothing);
        assert_eq!(range_in_view(&camera(), [64, 48], DVec3::new(50.0, 0.0, 0.0), 3.0), RangeInView::Nothing);
    }

    /// At the exact border, and within rounding of it far from the origin, nothing counts as beyond.
    #[test]
    fn at_the_border_of_the_range_all_is_within() {
        for offset in [DVec3::ZERO, DVec3::new(1e6, -3e6, 2e6)] {
            let box_of = |x: f64| [DVec3::new(x, -1.0, -1.0) + offset, DVec3::new(x + 1.0, 1.0, 1.0) + offset];
            let eye = offset + DVec3::new(0.0, 5.0, 5.0);
            assert_eq!(beyond_range(&box_of(3.0), offset, 3.0, eye), None);
            assert_eq!(beyond_range(&box_of(3.0 + 1e-9), offset, 3.0, eye), None);
            let beyond = beyond_range(&box_of(3.2), offset, 3.0, eye).expect("beyond");
            // Seen from so far away, the GPU may have it within.
            assert_eq!(beyond_range(&box_of(3.2), offset, 3.0, offset + DVec3::X * 1e6), None);
            assert!((0.1..=0.2).contains(&beyond), "{beyond}");
            assert_eq!(beyond_range(&box_of(-0.5), offset, 3.0, eye), None);
        }
        assert_eq!(beyond_range(&[], DVec3::ZERO, 1.0, DVec3::X), None);
    }
}
