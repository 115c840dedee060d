//! A walker that does not go through walls: a sphere that slides along triangles.
//!
//! A move is made in steps of half the sphere's radius, so that however fast one walks the middle never
//! reaches the far side of a triangle: after each step the sphere is pushed out of the triangle that it
//! is deepest in, to where it touches it (closest points after Ericson 2005, "Real-Time Collision
//! Detection", 5.1.5), until it is in none. What is left of the step along the wall is the slide. A
//! step that can't be mended, as in a corner too narrow, is not made.

use glam::DVec3;

/// Pushes that mend one step, at most.
const PUSHES: usize = 12;
/// Steps of one move, at most: what is left of it is not made.
const MOST_STEPS: usize = 2_000;
/// A sphere may be so much inside of a wall, in parts of its radius: rounding.
const SLACK: f64 = 1e-6;

/// Triangles that can't be walked through, world space.
#[derive(Debug, Clone, Default)]
pub struct Walls {
    triangles: Vec<Wall>,
}

#[derive(Debug, Clone, Copy)]
struct Wall {
    low: DVec3,
    high: DVec3,
    corners: [DVec3; 3],
}

impl Walls {
    /// Of these triangles; one with a corner that is no number is none.
    #[must_use]
    pub fn new(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Walls {
        let finite = |corners: &[DVec3; 3]| corners.iter().all(|corner| corner.is_finite());
        let wall = |corners: [DVec3; 3]| {
            let [a, b, c] = corners;
            Wall { low: a.min(b).min(c), high: a.max(b).max(c), corners }
        };
        Walls { triangles: triangles.into_iter().filter(finite).map(wall).collect() }
    }

    /// How far a point is from the nearest wall; infinite where there is none.
    #[must_use]
    pub fn clearance(&self, at: DVec3) -> f64 {
        let distance = |wall: &Wall| (closest(wall.corners, at) - at).length();
        self.triangles.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    /// Where a sphere gets that starts at `from` and would go by `by`. One that starts in a wall and can't be
    /// pushed out of it goes freely until it is out.
    #[must_use]
    pub fn walk(&self, from: DVec3, by: DVec3, radius: f64) -> DVec3 {
        if !(by.is_finite() && from.is_finite() && radius > 0.0) {
            return from;
        }
        if self.triangles.is_empty() {
            return from + by;
        }
        let Some(mut at) = self.pushed_out(from, radius) else { return from + by };
        let steps = (by.length() / (radius / 2.0)).ceil().max(1.0);
        let step = by / steps;
        for _ in 0..(steps as usize).min(MOST_STEPS) {
            match self.pushed_out(at + step, radius).filter(|next| !self.is_between(at, *next)) {
                Some(next) => at = next,
                None => break,
            }
        }
        at
    }

    /// The nearest place found at which the sphere is in no wall.
    fn pushed_out(&self, at: DVec3, radius: f64) -> Option<DVec3> {
        let mut at = at;
        for _ in 0..PUSHES {
            let Some((nearest, wall)) = self.deepest(at, radius * (1.0 - SLACK)) else { return Some(at) };
            let away = at - nearest;
            let [a, b, c] = wall.corners;
            // Exactly on a triangle neither side is nearer: its front is as good as any.
            let out = away.try_normalize().unwrap_or_else(|| (b - a).cross(c - a).normalize_or(DVec3::Y));
            at = nearest + out * radius;
        }
        self.deepest(at, radius * (1.0 - SLACK)).is_none().then_some(at)
    }

    /// The nearest point of the walls that is nearer than `radius`, with its wall.
    fn deepest(&self, at: DVec3, radius: f64) -> Option<(DVec3, &Wall)> {
        let mut found = None;
        let mut least = radius * radius;
        let reach = DVec3::splat(radius);
        let (low, high) = (at - reach, at + reach);
        for wall in self.triangles.iter().filter(|wall| wall.low.cmple(high).all() && wall.high.cmpge(low).all()) {
            let nearest = closest(wall.corners, at);
            let distance = nearest.distance_squared(at);
            if distance < least {
                least = distance;
                found = Some((nearest, wall));
            }
        }
        found
    }

    /// Does a wall stand between two points?
    fn is_between(&self, from: DVec3, to: DVec3) -> bool {
        let (low, high) = (from.min(to), from.max(to));
        let near = self.triangles.iter().filter(|wall| wall.low.cmple(high).all() && wall.high.cmpge(low).all());
        near.into_iter().any(|wall| is_crossed(wall.corners, from, to))
    }
}

/// The point of a triangle that is nearest to `at`: by the region of its plane that `at` lies over.
fn closest([a, b, c]: [DVec3; 3], at: DVec3) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, at - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = at - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = at - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let whole = va + vb + vc;
    // Without an area there is no inside; one of its corners is near enough.
    if whole == 0.0 { a } else { a + ab * (vb / whole) + ac * (vc / whole) }
}

/// Does a segment cross a triangle?
fn is_crossed([a, b, c]: [DVec3; 3], from: DVec3, to: DVec3) -> bool {
    let normal = (b - a).cross(c - a);
    let (before, after) = (normal.dot(from - a), normal.dot(to - a));
    if (before > 0.0) == (after > 0.0) {
        return false;
    }
    let at = from.lerp(to, before / (before - after));
    [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).cross(at - *p).dot(normal) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS: f64 = 0.25;

    /// Four triangles a quad would do; two are enough.
    fn quad(corner: DVec3, u: DVec3, v: DVec3) -> [[DVec3; 3]; 2] {
        [[corner, corner + u, corner + u + v], [corner, corner + u + v, corner + v]]
    }

    /// A room of sheets, 4 × 3 × 5 metres from the origin on.
    fn room() -> Walls {
        let (x, y, z) = (DVec3::X * 4.0, DVec3::Y * 3.0, DVec3::Z * 5.0);
        let zero = DVec3::ZERO;
        let sheets =
            [quad(zero, x, y), quad(z, x, y), quad(zero, y, z), quad(x, y, z), quad(zero, x, z), quad(y, x, z)];
        Walls::new(sheets.into_iter().flatten())
    }

    fn is_inside(at: DVec3) -> bool {
        let slack = DVec3::splat(RADIUS * (1.0 - 2.0 * SLACK));
        at.cmpge(slack).all() && at.cmple(DVec3::new(4.0, 3.0, 5.0) - slack).all()
    }

    #[test]
    fn nobody_leaves_a_closed_room_at_any_speed() {
        let walls = room();
        let mut state = 7_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut at = DVec3::new(2.0, 1.5, 2.5);
        for round in 0..3_000 {
            let speed = 10_f64.powf(3.0 * unit());
            let by = DVec3::new(unit(), unit(), unit()) * speed;
            at = walls.walk(at, by, RADIUS);
            assert!(is_inside(at), "{round}: by {by} to {at}");
        }
    }

    #[test]
    fn a_wall_is_slid_along() {
        let walls = room();
        let at = walls.walk(DVec3::new(2.0, 1.5, 2.5), DVec3::new(10.0, 0.0, 1.0), RADIUS);
        assert!((at.x - (4.0 - RADIUS)).abs() < 1e-6, "{at}");
        assert!((at.z - 3.5).abs() < 1e-6 && (at.y - 1.5).abs() < 1e-6, "all of the way along the wall is gone: {at}");
    }

    #[test]
    fn a_way_without_walls_is_gone_as_it_is() {
        let walls = room();
        let by = DVec3::new(0.5, 0.25, -1.0);
        assert!((walls.walk(DVec3::new(2.0, 1.5, 2.5), by, RADIUS) - DVec3::new(2.5, 1.75, 1.5)).length() < 1e-12);
        assert_eq!(Walls::default().walk(DVec3::ZERO, DVec3::X * 1e3, RADIUS), DVec3::X * 1e3);
    }

    #[test]
    fn a_start_near_a_wall_is_put_beside_it_and_one_within_a_thick_wall_walks_out() {
        let walls = room();
        let at = walls.walk(DVec3::new(3.9, 1.5, 2.5), DVec3::ZERO, RADIUS);
        assert!((at.x - 3.75).abs() < 1e-6, "{at}");
        // Between two sheets that are nearer than the sphere is wide.
        let y = DVec3::Y * 9.0;
        let z = DVec3::Z * 9.0;
        let corner = DVec3::new(0.0, -4.0, -4.0);
        let thick = Walls::new([quad(corner, y, z), quad(corner + DVec3::X * 0.2, y, z)].into_iter().flatten());
        let start = DVec3::X * 0.1;
        let mut at = start;
        for _ in 0..10 {
            at = thick.walk(at, DVec3::X * 0.1, RADIUS);
            assert!(at.is_finite());
        }
        assert!(at.x >= 0.2 + RADIUS * (1.0 - SLACK), "it is out: {at}");
        let back = thick.walk(at, DVec3::X * -5.0, RADIUS);
        assert!(back.x >= 0.2 + RADIUS * (1.0 - 2.0 * SLACK), "and does not get in again: {back}");
    }

    #[test]
    fn numbers_that_are_none_move_nobody() {
        let walls = room();
        let at = DVec3::new(2.0, 1.5, 2.5);
        assert_eq!(walls.walk(at, DVec3::new(f64::NAN, 0.0, 0.0), RADIUS), at);
        assert_eq!(walls.walk(at, DVec3::INFINITY, RADIUS), at);
        assert!(Walls::new([[DVec3::NAN; 3]]).triangles.is_empty());
    }
}
