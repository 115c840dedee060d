//! What z-fail begins with for a parallel projection: the number of volumes in which view rays end.
//!
//! Z-fail counts from infinity back, and begins at zero because caps close volumes there. Parallel view rays all end in
//! one point at infinity, their direction, so every pixel ends in the same volumes: those of the casting triangles that
//! the light's own ray in that direction hits. A dark cap at infinity is a line in such a picture, as its corners have
//! w = 0, and is not drawn; the count begins at the number of those triangles instead. A directional light's volumes go
//! to another point at infinity, and contain none but that.
//!
//! A silhouette edge that the light's ray hits is seen end on: pixels on one side of its line end in its volume, and
//! those on the other do not. Where single precision can't decide on which side of such an edge the ray goes, far
//! vertices are carried from a little beside the light, by millionths of the distance to the edge, and the ray is
//! followed from there: sides and count then agree. The shadow's border moves by some millionths of the scene; where
//! many edges are in doubt, by more, at most by a fiftieth of the distance to an edge.

use crate::math::{Sign, angle, side_of_triangle};
use crate::scene::Camera;
use glam::{DVec2, DVec3, DVec4};

/// An upper bound for the relative error of a direction that is computed in single precision.
const MARGIN: f64 = 1e-6;
/// The distance beside the light that is tried first, in multiples of the possible error.
const FIRST_STEP: f64 = 4.0;
/// The factor by which each try is farther from the light than the one before; each is turned by [`GOLDEN_ANGLE`].
const GROWTH: f64 = 1.25;
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// After this many tries, far vertices are carried from the light itself.
const MOST_TRIES: u32 = 40;

/// The point at infinity where parallel view rays end.
#[derive(Debug, Clone, Copy)]
pub struct FarPoint {
    /// World direction of all view rays.
    along: DVec3,
    /// World axes of the picture, to the right and up.
    across: [DVec3; 2],
    shear: DVec2,
}

impl FarPoint {
    /// Returns the far point of a camera whose view rays are parallel; `None` for a perspective one.
    pub fn of(camera: &Camera) -> Option<FarPoint> {
        let world_from_view = camera.world_from_view();
        let shear = camera.projection.shear();
        camera.is_parallel().then(|| FarPoint {
            along: -camera.relative_eye().truncate(),
            across: [world_from_view.x_axis, world_from_view.y_axis],
            shear,
        })
    }

    /// Returns where a world direction leads in the picture (right and up, metres), and how far ahead.
    fn seen(&self, direction: DVec3) -> (DVec2, f64) {
        let ahead = direction.dot(self.across[1].cross(self.across[0]));
        let [right, up] = self.across.map(|axis| axis.dot(direction));
        (DVec2::new(right, up) + self.shear * ahead, ahead)
    }

    /// Returns the light, or a homogeneous place beside it, from which none of these edges (world space) is seen end on
    /// as far as single precision can decide. Returns the light where no such place is found.
    pub fn settled(&self, light: DVec4, edges: &[[DVec3; 2]]) -> DVec4 {
        // The edge that takes the widest step, of those that the ray may hit.
        let widest = |light: DVec4| edges.iter().filter_map(|edge| self.doubt(light, *edge)).max_by(f64::total_cmp);
        let Some(doubt) = widest(light) else { return light };
        let beside = |index: u32| {
            let way = angle::direction(f64::from(index) * GOLDEN_ANGLE) * FIRST_STEP * GROWTH.powi(index as i32);
            light + ((self.across[0] * way.x + self.across[1] * way.y) * doubt).extend(0.0)
        };
        (0..MOST_TRIES).map(beside).find(|place| widest(*place).is_none()).unwrap_or(light)
    }

    /// Returns the error that single precision may make in the directions from the light to an edge, where that may
    /// move the edge onto the view direction's ray; `None` where it can't.
    fn doubt(&self, light: DVec4, edge: [DVec3; 2]) -> Option<f64> {
        let [a, b] = edge.map(|corner| corner * light.w - light.truncate());
        let doubt = MARGIN * a.length().max(b.length()) * (1.0 + self.shear.length());
        let ((from, from_ahead), (to, to_ahead)) = (self.seen(a), self.seen(b));
        let run = to - from;
        let share = (-from.dot(run) / run.length_squared()).clamp(0.0, 1.0);
        let share = if share.is_finite() { share } else { 0.0 };
        let (nearest, ahead) = (from.lerp(to, share), from_ahead + (to_ahead - from_ahead) * share);
        (nearest.length() <= doubt && ahead >= -doubt).then_some(doubt)
    }

    /// Returns how many of these triangles (world space) the ray from a point light along the view direction hits; 0
    /// for a directional light. Exact: a ray through an edge hits one of the two triangles there.
    pub fn count(&self, light: DVec4, casting: impl Iterator<Item = [DVec3; 3]>) -> u32 {
        // All rays of a directional light have its own direction.
        if light.w == 0.0 {
            return 0;
        }
        let light = light.truncate() / light.w;
        casting.filter(|corners| self.meets(light, *corners)).count() as u32
    }

    fn meets(&self, light: DVec3, corners: [DVec3; 3]) -> bool {
        let [a, b, c] = corners;
        let towards =
            |direction: DVec3, from: DVec3, to: DVec3| side_of_triangle([light, from, to], direction.extend(0.0));
        let passes = |from: DVec3, to: DVec3| {
            let beside = [DVec3::X, DVec3::Y, DVec3::Z].into_iter();
            beside.fold(towards(self.along, from, to), |side, axis| side.or_else(|| towards(axis, from, to)))
        };
        let first = passes(a, b);
        let is_within = first != Sign::Zero && passes(b, c) == first && passes(c, a) == first;
        // The cone around the ray's direction, not around its opposite.
        is_within && side_of_triangle([light, a, b], c.extend(1.0)) == first
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Projection;

    const LIGHT: DVec4 = DVec4::new(0.0, 4.0, 0.0, 1.0);

    /// Looking straight down.
    fn down() -> FarPoint {
        let projection = Projection::Orthographic { half_height: 2.0 };
        FarPoint::of(&Camera { projection, ..Camera::looking([0.0, 9.0, 0.0], [0.0; 3]) }).expect("parallel")
    }

    fn board(x: f64, height: f64) -> [[DVec3; 3]; 2] {
        let [a, b, c, d] =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[u, v]| DVec3::new(x + u, height, v));
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn the_ray_meets_what_lies_under_the_light_and_one_half_of_a_board_along_its_diagonal() {
        let count = |boards: &[[[DVec3; 3]; 2]]| down().count(LIGHT, boards.iter().flatten().copied());
        assert_eq!(count(&[board(0.0, 1.0)]), 1);
        assert_eq!(count(&[board(0.3, 1.0), board(-0.9, -7.0)]), 2);
        assert_eq!(count(&[board(1.5, 1.0)]), 0, "beside the ray");
        assert_eq!(count(&[board(0.0, 6.0)]), 0, "above the light");
        let sun = DVec4::new(0.0, 1.0, 0.0, 0.0);
        assert_eq!(down().count(sun, board(0.0, 1.0).into_iter()), 0);
    }

    #[test]
    fn an_edge_seen_end_on_is_looked_at_from_a_little_beside_the_light() {
        let [a, b] = [DVec3::new(0.0, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0)];
        let place = down().settled(LIGHT, &[[a, b]]);
        let moved = (place - LIGHT).truncate();
        assert!(moved.length() > MARGIN && moved.length() < 1e-4 && moved.y.abs() < 1e-12, "{moved}");
        assert_eq!(down().settled(place, &[[a, b]]), place);
        let aside = DVec3::X * 0.1;
        assert_eq!(down().settled(LIGHT, &[[a + aside, b + aside]]), LIGHT);
        let above = DVec3::Y * 9.0;
        assert_eq!(down().settled(LIGHT, &[[a + above, b + above]]), LIGHT, "behind the light");
    }

    #[test]
    fn a_sun_along_the_view_is_moved_off_it() {
        let sun = DVec4::new(0.0, 1.0, 0.0, 0.0);
        let edge = [DVec3::ZERO, DVec3::X];
        let place = down().settled(sun, &[edge]);
        assert!(place != sun && place.w == 0.0 && (place - sun).length() < 1e-4);
        let aslant = DVec4::new(0.3, 1.0, 0.0, 0.0);
        assert_eq!(down().settled(aslant, &[edge]), aslant);
    }
}
