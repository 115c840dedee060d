//! A walker that does not go through walls: a sphere that slides along triangles.
//!
//! A move is made in steps of half the sphere's radius, so that however fast one walks the centre never reaches the far
//! side of a triangle: after each step the sphere is pushed out of the triangle that it is deepest in, to where it
//! touches it (closest points after Ericson 2005, "Real-Time Collision Detection", 5.1.5), until it is in none. The
//! rest of the step along the wall is the slide. A step from which it can't be pushed out, as in a corner too narrow,
//! is not made.

use super::wall_tree::{Wall, WallTree};
use crate::last_used::LastUsed;
use crate::scene::{Object, PoseBits, Scene};
use glam::DVec3;
use std::sync::Arc;

/// The most pushes after one step.
pub(super) const PUSHES: usize = 12;
/// The most steps of one move: the rest of it is dropped.
pub(super) const MOST_STEPS: usize = 2_000;
/// How far a sphere may be inside of a wall, as a part of its radius: rounding.
pub(super) const SLACK: f64 = 1e-6;

/// Triangles that can't be walked through, world space.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Walls {
    /// One tree for each object.
    trees: Vec<Arc<WallTree>>,
}

/// The walls of each object of the last scene, which are used again while it stays where it is.
#[derive(Debug, Default)]
pub struct WallCache {
    /// Trees by the mesh's content and the pose.
    trees: LastUsed<(u64, PoseBits), Arc<WallTree>>,
}

impl WallCache {
    /// Returns the walls of a scene at its poses: of all visible objects. Those of objects with the same mesh and pose
    /// as in the last call are not built again; all others are dropped.
    pub fn walls(&mut self, scene: &Scene) -> Walls {
        let tree = |object: &Object| {
            let key = (object.mesh.content_hash(), object.pose.bits());
            self.trees.get_or_make(key, || Arc::new(tree_of(object)))
        };
        let walls = Walls { trees: scene.objects.iter().filter(|object| object.visible).map(tree).collect() };
        // Walls of objects that are gone are dropped at once.
        self.trees.next_plan();
        walls
    }
}

fn tree_of(object: &Object) -> WallTree {
    let positions = object.world_positions();
    let corner = |index: u32| positions[index as usize];
    WallTree::new(object.mesh.triangles().iter().map(|triangle| triangle.map(corner)))
}

impl Walls {
    /// Returns walls of these triangles; one with a corner that is not finite is left out.
    pub fn new(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Walls {
        Walls { trees: vec![Arc::new(WallTree::new(triangles))] }
    }

    /// Returns where a sphere gets that starts at `from` and should go by `by`: it slides along walls and passes
    /// through none. One that starts in a wall and can't be pushed out of it goes freely; it stays where a number is
    /// not finite or the radius not positive.
    pub fn walk(&self, from: DVec3, by: DVec3, radius: f64) -> DVec3 {
        if !(by.is_finite() && from.is_finite() && radius > 0.0) {
            return from;
        }
        if self.is_empty() {
            return from + by;
        }
        let Some(mut at) = self.pushed_out(from, radius) else { return from + by };
        let steps = (by.length() / (radius / 2.0)).ceil().max(1.0);
        let step = by / steps;
        let mut left = (steps as usize).min(MOST_STEPS);
        // The number of steps that are tried at once: more where nothing is near, fewer where something is.
        let mut stride = left;
        while left > 0 {
            stride = stride.min(left);
            let far = at + step * stride as f64;
            if stride > 1 {
                if self.is_free(at, far, radius) {
                    (at, left) = (far, left - stride);
                    stride *= 2;
                } else {
                    stride /= 2;
                }
                continue;
            }
            let next = self.pushed_out(far, radius).filter(|next| !self.is_between(at, *next));
            // A sphere that does not move now does not move for the rest of the way.
            let Some(next) = next.filter(|next| next.distance(at) > SLACK * radius) else { break };
            (at, left) = (next, left - 1);
            stride = 2;
        }
        at
    }

    /// Returns whether no wall's box overlaps the box around the way between two points, enlarged by `radius`.
    fn is_free(&self, from: DVec3, to: DVec3, radius: f64) -> bool {
        let reach = DVec3::splat(radius);
        !self.any_near(from.min(to) - reach, from.max(to) + reach, |_| true)
    }

    /// Returns whether there is no wall.
    pub fn is_empty(&self) -> bool {
        self.trees.iter().all(|tree| tree.is_empty())
    }

    /// Returns the lowest height of the walls, world space; `None` where there are none.
    pub(super) fn lowest(&self) -> Option<f64> {
        self.trees.iter().filter_map(|tree| tree.lowest()).reduce(f64::min)
    }

    pub(super) fn any_near(&self, low: DVec3, high: DVec3, mut visit: impl FnMut(&Wall) -> bool) -> bool {
        self.trees.iter().any(|tree| tree.any_near(low, high, &mut visit))
    }

    /// Returns a place near `at` at which the sphere touches no wall, found by pushing it out of the deepest one again
    /// and again; the same where it is in none, `None` where none is found in a few pushes.
    fn pushed_out(&self, at: DVec3, radius: f64) -> Option<DVec3> {
        let mut at = at;
        for _ in 0..PUSHES {
            let Some((nearest, wall)) = self.deepest(at, radius * (1.0 - SLACK)) else { return Some(at) };
            let away = at - nearest;
            let [a, b, c] = wall;
            // Exactly on a triangle neither side is nearer: its front is as good as any.
            let out = away.try_normalize().unwrap_or_else(|| (b - a).cross(c - a).normalize_or(DVec3::Y));
            at = nearest + out * radius;
        }
        self.deepest(at, radius * (1.0 - SLACK)).is_none().then_some(at)
    }

    /// Returns the point of the walls that is nearest to `at`, with its wall; `None` where none is nearer than
    /// `radius`.
    fn deepest(&self, at: DVec3, radius: f64) -> Option<(DVec3, Wall)> {
        let mut found = None;
        let mut least = radius * radius;
        let reach = DVec3::splat(radius);
        self.any_near(at - reach, at + reach, |wall| {
            let nearest = closest(*wall, at);
            let distance = nearest.distance_squared(at);
            if distance < least {
                least = distance;
                found = Some((nearest, *wall));
            }
            false
        });
        found
    }

    /// Returns whether a wall stands between two points.
    pub(super) fn is_between(&self, from: DVec3, to: DVec3) -> bool {
        self.any_near(from.min(to), from.max(to), |wall| is_crossed(*wall, from, to))
    }
}

/// Returns the point of a triangle that is nearest to `at`: by the region of its plane that `at` lies over.
pub(super) fn closest([a, b, c]: [DVec3; 3], at: DVec3) -> DVec3 {
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

/// Returns whether a segment goes from one side of a triangle to the other through it, edges included; not where it
/// runs in the triangle's plane.
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

    /// A sphere of 69 600 triangles about the origin, of radius 2.
    fn ball() -> crate::scene::Mesh {
        let (around, down) = (240_u32, 146_u32);
        let place = |row: u32, column: u32| {
            let (a, b) = (f64::from(column) / f64::from(around), f64::from(row) / f64::from(down));
            let (a, b) = (a * std::f64::consts::TAU, b * std::f64::consts::PI);
            DVec3::new(b.sin() * a.cos(), b.cos(), b.sin() * a.sin()) * 2.0
        };
        let grid = |rows: std::ops::Range<u32>| rows.flat_map(|row| (0..around).map(move |column| (row, column)));
        let at = |row: u32, column: u32| row * around + column % around;
        let positions = grid(0..down + 1).map(|(row, column)| place(row, column)).collect();
        let upper = grid(1..down).map(|(row, column)| [at(row, column), at(row, column + 1), at(row + 1, column + 1)]);
        let lower =
            grid(0..down - 1).map(|(row, column)| [at(row, column), at(row + 1, column + 1), at(row + 1, column)]);
        let builder = crate::scene::MeshBuilder {
            positions,
            triangles: upper.chain(lower).collect(),
            ..crate::scene::MeshBuilder::default()
        };
        builder.build().expect("a mesh")
    }

    #[test]
    fn among_many_triangles_one_gets_as_far_as_if_each_were_looked_at() {
        let mesh = ball();
        let triangles =
            || mesh.triangles().iter().map(|corners| corners.map(|corner| mesh.positions()[corner as usize]));
        let walls = Walls::new(triangles());
        // One tree for each triangle is the same as no tree.
        let slow = Walls { trees: triangles().map(|wall| Arc::new(WallTree::new([wall]))).collect() };
        let (from, by) = (DVec3::new(-2.9, 0.3, 0.2), DVec3::new(1.2, 0.1, 0.0));
        assert!((walls.walk(from, by, RADIUS) - slow.walk(from, by, RADIUS)).length() < 1e-9);
        // As fast as possible, for a quarter of a second, into the ball and past it.
        let at = walls.walk(DVec3::new(-60.0, 0.3, 0.2), DVec3::X * 125.0, RADIUS);
        let past = walls.walk(DVec3::new(-60.0, 2.2, 0.2), DVec3::X * 125.0, RADIUS);
        assert!(at.length() > 2.0 + RADIUS * 0.99, "{at}");
        assert!(past.x > 60.0, "{past}");
    }

    #[test]
    fn the_walls_of_what_stays_are_kept_and_those_of_what_moves_are_made_anew() {
        let mesh = Arc::new(ball());
        let object = |name: &str, x: f64| {
            let mut object = Object::new(name, mesh.clone(), crate::scene::Material::default());
            object.pose.translate.x = x;
            object
        };
        let mut scene = crate::scene::open(&crate::scene::OpenSpec::new("tori")).expect("a scene");
        scene.objects = vec![object("stays", 0.0), object("moves", 9.0)];
        let mut cache = WallCache::default();
        let first = cache.walls(&scene);
        scene.objects[1].pose.translate.x = 12.0;
        let second = cache.walls(&scene);
        assert!(Arc::ptr_eq(&first.trees[0], &second.trees[0]));
        let ends_at = |walls: &Walls| walls.walk(DVec3::new(5.0, 0.0, 0.0), DVec3::X * 30.0, RADIUS).x;
        let [before, after] = [&first, &second].map(ends_at);
        assert!((before - 6.75).abs() < 0.01 && (after - 9.75).abs() < 0.01, "{before} {after}");
        scene.objects.pop();
        assert!((ends_at(&cache.walls(&scene)) - 35.0).abs() < 1e-9);
        let holders = [&first.trees[0], &first.trees[1], &second.trees[1]].map(Arc::strong_count);
        assert_eq!(holders, [3, 1, 1], "what is gone is forgotten");
    }

    #[test]
    fn numbers_that_are_none_move_nobody() {
        let walls = room();
        let at = DVec3::new(2.0, 1.5, 2.5);
        assert_eq!(walls.walk(at, DVec3::new(f64::NAN, 0.0, 0.0), RADIUS), at);
        assert_eq!(walls.walk(at, DVec3::INFINITY, RADIUS), at);
        assert!(Walls::new([[DVec3::NAN; 3]]).trees.iter().all(|tree| tree.is_empty()));
    }
}
