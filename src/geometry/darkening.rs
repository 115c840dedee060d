//! What can darken what: a triangle no point on the light's side of its plane.

use crate::math::{AxisBox, Sign, side_of_triangle};
use glam::{DVec3, DVec4};

/// Objects of more triangles are assumed to darken something: the test takes triangles times vertices, and pays for
/// small objects such as floors and walls.
const MOST_TRIANGLES_TO_LOOK_AT: usize = 256;

/// How many points are looked at before the box around all of them.
const FIRST_LOOK: usize = 64;

/// Returns whether some triangle of an object can darken any of the points `receivers` (world space) under a
/// homogeneous light. Always true for an object of many triangles, which are not tested.
pub fn object_can_darken<R: Iterator<Item = DVec3>>(
    world: &[DVec3],
    triangles: &[[u32; 3]],
    light: DVec4,
    receivers: impl Fn() -> R,
) -> bool {
    fn any<R: Iterator<Item = DVec3>>(
        world: &[DVec3],
        triangles: &[[u32; 3]],
        light: DVec4,
        points: impl Fn() -> R,
    ) -> bool {
        let on_any = |corners: &[u32; 3]| can_darken(corners.map(|corner| world[corner as usize]), light, points());
        triangles.iter().any(on_any)
    }
    if triangles.len() > MOST_TRIANGLES_TO_LOOK_AT || any(world, triangles, light, || receivers().take(FIRST_LOOK)) {
        return true;
    }
    // Where the box around all points lies on the light's side, so does each of them.
    let around = AxisBox::around(receivers());
    !around.is_empty()
        && any(world, triangles, light, || around.corners().into_iter())
        && any(world, triangles, light, receivers)
}

/// Returns whether a triangle can darken any of the points `receivers`. It can't where all of them lie on the light's
/// side of its plane or in it (exact signs), or where the light lies in the plane.
fn can_darken(corners: [DVec3; 3], light: DVec4, mut receivers: impl Iterator<Item = DVec3>) -> bool {
    let light_side = side_of_triangle(corners, light);
    let behind = |point: DVec3| {
        let side = side_of_triangle(corners, point.extend(1.0));
        side != Sign::Zero && side != light_side
    };
    light_side != Sign::Zero && receivers.any(behind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_floor_under_everything_can_darken_nothing() {
        let light = DVec4::new(0.0, 5.0, 0.0, 1.0);
        let floor = [[-4.0, -4.0], [-4.0, 4.0], [4.0, 4.0]].map(|[x, z]| DVec3::new(x, 0.0, z));
        let above = [DVec3::new(0.0, 1.0, 0.0), DVec3::ZERO];
        let below = [DVec3::new(0.0, -1e-9, 0.0)];
        assert!(!can_darken(floor, light, above.into_iter()));
        assert!(can_darken(floor, light, below.into_iter()));
    }

    /// More points than are looked at first: the box around them is not below what none of them is below.
    #[test]
    fn of_many_points_the_one_behind_is_found_and_where_none_is_there_is_none() {
        let light = DVec4::new(0.3, 5.0, 0.1, 1.0);
        let slope = [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 0.5, 1.0)];
        let on_slope = |x: f64, above: f64| DVec3::new(x, 0.5 + x / 2.0 + above, 0.3);
        let points = |last: f64| {
            let along = (0..3 * FIRST_LOOK).map(|at| on_slope(at as f64 / 64.0, 0.5));
            along.chain([on_slope(0.5, last)]).collect::<Vec<DVec3>>()
        };
        let darkens = |points: &[DVec3]| {
            [light, DVec4::new(0.2, 1.0, 0.0, 0.0)]
                .map(|light| object_can_darken(&slope, &[[0, 1, 2]], light, || points.iter().copied()))
        };
        assert_eq!(darkens(&points(0.5)), [false; 2], "the box reaches below the slope, and no point does");
        assert_eq!(darkens(&points(-0.1)), [true; 2]);
        assert_eq!(darkens(&[]), [false; 2]);
        let level: Vec<DVec3> = (0..3 * FIRST_LOOK).map(|at| DVec3::new(at as f64, 9.0, 0.0)).collect();
        assert_eq!(darkens(&level[..2]), [false; 2]);
    }
}
