//! A walker with weight: an upright body that goes over the ground, climbs steps, is stopped by what is higher, falls
//! where nothing is under it, and lands.
//!
//! Its feet stand on the first hits of vertical rays under it, from the height of a step down. What is higher stops it:
//! a capsule from there to its head is pushed aside, sideways only, out of the triangles that it is in (the nearest
//! point of its axis is found by a search for the least of a convex function). A move is made in short steps of equal
//! length, each with the distance that gravity adds to it, `v t + g t² / 2`, so that equal moves end alike.

use super::collision::{MOST_STEPS, PUSHES, SLACK, closest};
use super::wall_tree::Wall;
use crate::math::AxisBox;
use crate::scene::Walls;
use glam::{DVec2, DVec3};

/// Acceleration by gravity, metres per second squared.
const GRAVITY: f64 = 9.81;
/// The highest step that is climbed, metres.
const STEP: f64 = 0.4;
/// Height of the eye above the feet, metres, of a body that is not wider than that.
const EYE: f64 = 1.7;
/// Longest time of one step of a move, seconds.
const TIME_STEP: f64 = 1.0 / 120.0;
/// A body this far below all walls falls for ever, metres.
const BEYOND: f64 = 5.0;
/// Heights that differ by less are equal: rounding, metres.
const LEVEL: f64 = 1e-9;
/// Halvings of the search along the axis: a metre is halved down to rounding.
const SEARCHES: usize = 48;
/// Offsets where ground is searched for under the feet: under the middle, and round it at half the radius.
const FOOTPRINT: [[f64; 2]; 9] =
    [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [0.7, 0.7], [0.7, -0.7], [-0.7, 0.7], [-0.7, -0.7]];

/// Measures of a walker, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WalkerBody {
    radius: f64,
    eye: f64,
}

/// Where a walker's body stands, or how it falls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footing {
    /// Position of its feet, world space.
    pub feet: DVec3,
    /// Falling speed, metres per second.
    pub falls_by: f64,
    /// True where something is under its feet.
    pub is_on_ground: bool,
    /// True where it is below all walls, with nothing to land on.
    pub is_beyond: bool,
}

impl WalkerBody {
    /// Returns a body of this radius, metres, with its eye at a person's height, or higher for a large radius.
    pub fn new(radius: f64) -> WalkerBody {
        WalkerBody { radius, eye: EYE.max(STEP + radius * 1.5) }
    }

    /// Returns the position of the body's eye.
    pub fn eye_of(&self, feet: DVec3) -> DVec3 {
        feet + DVec3::Y * self.eye
    }

    /// Returns the state of a body whose eye is at `eye`: on the highest ground between its eye and where its feet
    /// would be, even if that lifts them; else in the air, not yet falling.
    pub fn under(&self, eye: DVec3, walls: &Walls) -> Footing {
        let feet = eye - DVec3::Y * self.eye;
        let ground = self.ground(walls, feet, [feet.y, eye.y]);
        Footing {
            feet: ground.map_or(feet, |height| feet.with_y(height)),
            falls_by: 0.0,
            is_on_ground: ground.is_some(),
            is_beyond: false,
        }
    }

    /// Returns the state of a body that should move by `by` over the ground, some seconds later; with `collides` off,
    /// walls do not stop it, and only the ground supports it. A move that is not finite moves nothing.
    pub fn walk(&self, from: Footing, by: DVec3, seconds: f64, walls: &Walls, collides: bool) -> Footing {
        let by = by.with_y(0.0);
        if !(by.is_finite() && from.feet.is_finite() && seconds.is_finite() && seconds > 0.0) {
            return from;
        }
        let lengths = by.length() / (self.radius / 2.0);
        let steps = (seconds / TIME_STEP).max(lengths).ceil().clamp(1.0, MOST_STEPS as f64);
        // The rest of a move that is longer than all steps is dropped.
        let way = by / steps.max(lengths);
        let time = seconds / steps;
        let mut now = from;
        for _ in 0..steps as usize {
            now = self.step(now, way, time, walls, collides);
        }
        now.is_beyond = walls.lowest().is_none_or(|lowest| now.feet.y < lowest - BEYOND);
        now
    }

    fn step(&self, from: Footing, by: DVec3, step: f64, walls: &Walls, collides: bool) -> Footing {
        let aside = self.gone(walls, from.feet, by, collides);
        let gone = self.settled(walls, from, aside, step);
        let head_meets = gone.feet.y > from.feet.y + LEVEL && collides && self.is_blocked(walls, gone.feet);
        // A step up that leaves no space for the head is not made, and the ground under the feet stops their fall.
        if head_meets { self.settled(walls, from, from.feet, step) } else { gone }
    }

    /// Returns the state after `step` seconds over the place `at`: on the highest ground between a step above it and
    /// where it falls to (a step below where it stood on ground), else as much farther down and faster.
    fn settled(&self, walls: &Walls, from: Footing, at: DVec3, step: f64) -> Footing {
        let fallen = at.y - from.falls_by * step - GRAVITY * step * step / 2.0;
        // A body on the ground goes down steps on its feet.
        let lowest = if from.is_on_ground { at.y - STEP } else { fallen };
        match self.ground(walls, at, [lowest, at.y + STEP]) {
            Some(height) => Footing { feet: at.with_y(height), falls_by: 0.0, is_on_ground: true, ..from },
            None => Footing {
                feet: at.with_y(fallen),
                falls_by: from.falls_by + GRAVITY * step,
                is_on_ground: false,
                ..from
            },
        }
    }

    /// Returns where feet get that should go by a short distance, height unchanged: beside walls that are in the way,
    /// or where they are if they can't. Without `collides`, or inside a wall that it can't leave, it goes freely.
    fn gone(&self, walls: &Walls, feet: DVec3, by: DVec3, collides: bool) -> DVec3 {
        let far = feet + by;
        // A body that can't be pushed out of a wall walks out of it.
        if !collides || self.is_blocked(walls, feet) && self.pushed_aside(walls, feet).is_none() {
            return far;
        }
        let Some(next) = self.pushed_aside(walls, far) else { return feet };
        let [before, after] = [feet, next].map(|at| self.axis(at));
        let is_through = before.into_iter().zip(after).any(|(from, to)| walls.is_between(from, to));
        if is_through { feet } else { next }
    }

    /// Returns the ends of the capsule's axis: from above the height of a step to below the eye.
    fn axis(&self, feet: DVec3) -> [DVec3; 2] {
        [STEP + self.radius, self.eye - self.radius / 2.0].map(|height| feet + DVec3::Y * height)
    }

    fn is_blocked(&self, walls: &Walls, feet: DVec3) -> bool {
        self.deepest(walls, feet).is_some()
    }

    /// Returns the place, moved only sideways, at which the body is in no wall; the same where it is in none. `None`
    /// where none is found, or it could only be pushed up or down.
    fn pushed_aside(&self, walls: &Walls, feet: DVec3) -> Option<DVec3> {
        let mut at = feet;
        for _ in 0..PUSHES {
            let Some((own, nearest)) = self.deepest(walls, at) else { return Some(at) };
            let away = own - nearest;
            let aside = away.with_y(0.0);
            let needed = (self.radius * self.radius - away.y * away.y).max(0.0).sqrt();
            at += aside.try_normalize()? * (needed - aside.length());
        }
        self.deepest(walls, at).is_none().then_some(at)
    }

    /// Returns the point of the body's axis that is nearest to a wall, and the wall's nearest point, where they are
    /// nearer than the radius by more than a slack; `None` where none is.
    fn deepest(&self, walls: &Walls, feet: DVec3) -> Option<(DVec3, DVec3)> {
        let axis = self.axis(feet);
        let reach = DVec3::splat(self.radius);
        let mut least = (self.radius * (1.0 - SLACK)).powi(2);
        let mut found = None;
        walls.any_near(axis[0] - reach, axis[1] + reach, |wall| {
            // A box is no farther than its content: most of a fine mesh is not examined more closely.
            let box_of = AxisBox::around(*wall);
            let [low, high] = [axis[0].min(axis[1]), axis[0].max(axis[1])];
            let apart = (box_of.low - high).max(low - box_of.high).max(DVec3::ZERO);
            if apart.length_squared() >= least {
                return false;
            }
            let (own, nearest) = nearest_points(axis, *wall);
            let distance = own.distance_squared(nearest);
            if distance < least {
                least = distance;
                found = Some((own, nearest));
            }
            false
        });
        found
    }

    /// Returns the height of the highest ground under the footprint between two heights; `None` where there is none.
    /// Upright triangles are no ground.
    fn ground(&self, walls: &Walls, feet: DVec3, [low, high]: [f64; 2]) -> Option<f64> {
        let half = self.radius / 2.0;
        let places = FOOTPRINT.map(|[x, z]| DVec2::new(feet.x + x * half, feet.z + z * half));
        let reach = DVec3::new(half, 0.0, half);
        let mut highest = None;
        let slack = LEVEL * (1.0 + high.abs().max(low.abs()));
        walls.any_near(feet.with_y(low - slack) - reach, feet.with_y(high + slack) + reach, |wall| {
            let heights = places.iter().filter_map(|place| height_at(wall, *place));
            let within = heights.filter(|height| *height >= low - slack && *height <= high + slack);
            highest = within.fold(highest, |highest: Option<f64>, height| {
                Some(highest.map_or(height, |highest| highest.max(height)))
            });
            false
        });
        highest
    }
}

/// Returns the height of a triangle above a place (x and z); `None` where the place is not under or over it, or it
/// stands upright.
fn height_at([a, b, c]: &Wall, place: DVec2) -> Option<f64> {
    let flat = [a, b, c].map(|corner| DVec2::new(corner.x, corner.z) - place);
    let cross = |from: usize, to: usize| flat[from].perp_dot(flat[to]);
    let parts = [cross(1, 2), cross(2, 0), cross(0, 1)];
    let area: f64 = parts.iter().sum();
    let is_over = parts.iter().all(|part| part * area >= 0.0) && area != 0.0;
    let height = (parts[0] * a.y + parts[1] * b.y + parts[2] * c.y) / area;
    (is_over && height.is_finite()).then_some(height)
}

/// Returns the points of a segment and a triangle that are nearest to each other: the distance is convex along the
/// segment.
fn nearest_points([from, to]: [DVec3; 2], wall: Wall) -> (DVec3, DVec3) {
    let away = |part: f64| from.lerp(to, part).distance_squared(closest(wall, from.lerp(to, part)));
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..SEARCHES {
        let third = (high - low) / 3.0;
        if away(low + third) <= away(high - third) { high -= third } else { low += third }
    }
    let own = from.lerp(to, (low + high) / 2.0);
    (own, closest(wall, own))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: WalkerBody = WalkerBody { radius: 0.25, eye: EYE };

    fn quad(corner: DVec3, u: DVec3, v: DVec3) -> [Wall; 2] {
        [[corner, corner + u, corner + u + v], [corner, corner + u + v, corner + v]]
    }

    fn block(low: [f64; 3], high: [f64; 3]) -> Vec<Wall> {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        let (x, y, z) = (DVec3::X * (high - low).x, DVec3::Y * (high - low).y, DVec3::Z * (high - low).z);
        let sheets = [
            quad(low, x, y),
            quad(low + z, x, y),
            quad(low, y, z),
            quad(low + x, y, z),
            quad(low, x, z),
            quad(low + y, x, z),
        ];
        sheets.into_iter().flatten().collect()
    }

    /// A floor of 40 metres each way at height 0, and what is on it.
    fn world(things: &[Vec<Wall>]) -> Walls {
        let floor = quad(DVec3::new(-20.0, 0.0, -20.0), DVec3::X * 40.0, DVec3::Z * 40.0);
        Walls::new(floor.into_iter().chain(things.iter().flatten().copied()))
    }

    fn at(feet: [f64; 3]) -> Footing {
        Footing { feet: feet.into(), falls_by: 0.0, is_on_ground: false, is_beyond: false }
    }

    /// Walks for some seconds at 2 metres a second, 60 frames a second.
    fn walked(walls: &Walls, from: Footing, way: DVec3, seconds: f64) -> Footing {
        let frames = (seconds * 60.0).round() as usize;
        (0..frames).fold(from, |now, _| BODY.walk(now, way * (2.0 / 60.0), 1.0 / 60.0, walls, true))
    }

    #[test]
    fn who_falls_gains_speed_as_gravity_says_and_lands_on_the_floor() {
        let walls = world(&[]);
        let start = at([0.3, 10.0, 0.2]);
        let later = walked(&walls, start, DVec3::ZERO, 1.0);
        assert!((later.feet.y - (10.0 - GRAVITY / 2.0)).abs() < 1e-9, "{later:?}");
        assert!((later.falls_by - GRAVITY).abs() < 1e-9 && !later.is_on_ground, "{later:?}");
        // √(2 · 10 / g) is 1.428 s.
        assert!(!walked(&walls, start, DVec3::ZERO, 1.4).is_on_ground);
        let landed = walked(&walls, start, DVec3::ZERO, 1.45);
        assert_eq!(landed, Footing { feet: DVec3::new(0.3, 0.0, 0.2), is_on_ground: true, ..start });
        assert_eq!(walked(&walls, landed, DVec3::ZERO, 5.0), landed, "and stays there");
    }

    #[test]
    fn nobody_falls_through_a_floor_at_any_speed_and_equal_steps_end_alike() {
        let walls = world(&[]);
        let fast = Footing { falls_by: 5_000.0, ..at([0.0, 900.0, 0.0]) };
        let landed = BODY.walk(fast, DVec3::ZERO, 0.25, &walls, true);
        assert!(landed.is_on_ground && landed.feet.y == 0.0, "{landed:?}");
        let twice = [0, 1].map(|_| walked(&walls, at([0.1, 3.0, 0.0]), DVec3::X, 2.0));
        assert_eq!(twice[0], twice[1]);
    }

    #[test]
    fn a_step_is_climbed_up_to_its_limit_and_gone_down_on_the_feet() {
        for (height, climbs) in [(0.1, true), (0.4, true), (0.42, false), (1.0, false)] {
            let walls = world(&[block([1.0, 0.0, -3.0], [3.0, height, 3.0])]);
            let up = walked(&walls, at([0.0, 0.0, 0.0]), DVec3::X, 1.0);
            assert!(up.is_on_ground);
            if climbs {
                assert!((up.feet.y - height).abs() < 1e-9 && (up.feet.x - 2.0).abs() < 1e-9, "{height}: {up:?}");
                let down = walked(&walls, up, DVec3::X, 2.0);
                assert!(down.feet.y == 0.0 && down.is_on_ground && (down.feet.x - 6.0).abs() < 1e-9, "{down:?}");
            } else {
                // Before it by the radius, and less where only the capsule's round end touches the edge.
                assert!(up.feet.y == 0.0 && up.feet.x < 1.0 && up.feet.x > 0.7, "{height}: {up:?}");
            }
        }
    }

    #[test]
    fn stairs_are_walked_up_and_down() {
        let stairs: Vec<Vec<Wall>> = (0..8)
            .map(|step| {
                let x = 1.0 + 0.3 * f64::from(step);
                block([x, 0.0, -1.0], [x + 0.3, 0.2 * f64::from(step + 1), 1.0])
            })
            .collect();
        let walls = world(&stairs);
        let up = walked(&walls, at([0.0, 0.0, 0.0]), DVec3::X, 1.6);
        assert!((up.feet.y - 1.6).abs() < 1e-9 && up.is_on_ground, "{up:?}");
        let down = walked(&walls, up, DVec3::NEG_X, 1.6);
        assert!(down.feet.y == 0.0 && down.is_on_ground && down.feet.x.abs() < 1e-9, "{down:?}");
    }

    #[test]
    fn a_wall_stops_and_is_slid_along() {
        let walls = world(&[block([1.0, 0.0, -20.0], [1.2, 3.0, 20.0])]);
        let slid = walked(&walls, at([0.0, 0.0, 0.0]), DVec3::new(1.0, 0.0, 1.0).normalize(), 3.0);
        assert!((slid.feet.x - 0.75).abs() < 1e-6, "{slid:?}");
        assert!((slid.feet.z - 6.0 / 2.0_f64.sqrt()).abs() < 1e-6 && slid.feet.y == 0.0, "{slid:?}");
        let through = BODY.walk(at([0.0, 0.0, 0.0]), DVec3::X * 3.0, 1.0, &walls, false);
        assert!((through.feet - DVec3::X * 3.0).length() < 1e-9, "walls switched off stop nobody: {through:?}");
    }

    /// A bed is a block, a table is a board on nothing.
    #[test]
    fn a_bed_and_a_table_stop_who_walks_and_hold_who_lands_on_them() {
        for (thing, top) in [([0.0, 0.5], 0.5), ([0.7, 0.75], 0.75)] {
            let walls = world(&[block([1.0, thing[0], -1.0], [3.0, thing[1], 1.0])]);
            let stopped = walked(&walls, at([0.0, 0.0, 0.0]), DVec3::X, 3.0);
            assert!(stopped.feet.y == 0.0 && stopped.feet.x < 1.0, "{top}: {stopped:?}");
            let landed = walked(&walls, at([2.0, 2.0, 0.0]), DVec3::ZERO, 2.0);
            assert!((landed.feet.y - top).abs() < 1e-9 && landed.is_on_ground, "{landed:?}");
            let down = walked(&walls, landed, DVec3::X, 2.0);
            assert!(down.feet.y == 0.0 && down.is_on_ground && down.feet.x > 5.0, "and walks off it: {down:?}");
        }
    }

    #[test]
    fn a_ceiling_that_is_too_low_keeps_one_from_a_step() {
        let step = block([1.0, 0.0, -3.0], [9.0, 0.3, 3.0]);
        let walls = world(&[step, block([0.0, 1.9, -3.0], [9.0, 2.0, 3.0])]);
        let below = walked(&walls, at([0.0, 0.0, 0.0]), DVec3::X, 3.0);
        assert!(below.feet.y == 0.0 && below.feet.x < 1.0 && below.is_on_ground, "{below:?}");
    }

    #[test]
    fn beyond_the_edge_of_the_world_one_falls_and_it_is_reported() {
        let walls = world(&[]);
        let off = walked(&walls, at([19.0, 0.0, 0.0]), DVec3::X, 1.5);
        assert!(!off.is_on_ground && !off.is_beyond && off.feet.y < 0.0, "{off:?}");
        let gone = walked(&walls, off, DVec3::ZERO, 1.0);
        assert!(gone.is_beyond && gone.feet.y < -BEYOND, "{gone:?}");
        let nothing = BODY.walk(at([0.0; 3]), DVec3::ZERO, 0.1, &Walls::default(), true);
        assert!(nothing.is_beyond, "where nothing is there is nothing to land on");
    }

    #[test]
    fn who_is_under_the_ground_by_less_than_a_body_is_set_on_it() {
        let walls = world(&[]);
        let low = BODY.under(DVec3::new(0.0, 0.6, 0.0), &walls);
        assert!(low.is_on_ground && low.feet == DVec3::ZERO && BODY.eye_of(low.feet).y == EYE, "{low:?}");
        let high = BODY.under(DVec3::new(0.0, 4.0, 0.0), &walls);
        assert!(!high.is_on_ground && (high.feet.y - (4.0 - EYE)).abs() < 1e-12, "{high:?}");
    }

    #[test]
    fn nobody_leaves_a_room_by_walking_as_the_dice_say() {
        let walls = world(&[
            block([-2.2, 0.0, -2.2], [-2.0, 3.0, 2.2]),
            block([2.0, 0.0, -2.2], [2.2, 3.0, 2.2]),
            block([-2.2, 0.0, -2.2], [2.2, 3.0, -2.0]),
            block([-2.2, 0.0, 2.0], [2.2, 3.0, 2.2]),
            block([-0.5, 0.0, -0.5], [0.5, 0.7, 0.5]),
            block([-2.0, 0.0, 1.0], [-1.0, 0.3, 2.0]),
        ]);
        let mut state = 11_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut now = at([1.5, 1.0, 0.0]);
        for round in 0..600 {
            let by = DVec3::new(unit(), unit(), unit()) * 10_f64.powf(1.5 * unit());
            now = BODY.walk(now, by, 0.05, &walls, true);
            assert!(now.feet.x.abs() <= 1.75 + 1e-5 && now.feet.z.abs() <= 1.75 + 1e-5, "{round}: {now:?}");
            assert!((-1e-9..1.0).contains(&now.feet.y), "{round}: {now:?}");
        }
    }

    #[test]
    fn the_stairs_of_the_prison_block_lead_to_its_walkway_and_a_bed_stops() {
        let scene = crate::scene::builtin::Builtin::named("tiger-cage").expect("a name").scene().expect("a scene");
        let walls = crate::scene::WallCache::default().walls(&scene);
        let landed = walked(&walls, BODY.under(scene.camera.eye, &walls), DVec3::ZERO, 1.0);
        assert!(landed.is_on_ground && landed.feet.y.abs() < 1e-9, "{landed:?}");
        let up = walked(&walls, at([0.0, 1.0, 8.2]), DVec3::NEG_Z, 3.0);
        assert!(up.is_on_ground && (up.feet.y - 2.6).abs() < 1e-9 && up.feet.z < 3.0, "{up:?}");
        // In the first cell on the right, towards the bed at its outer wall, 0.45 m high.
        let stopped = walked(&walls, at([2.0, 0.0, 4.5]), DVec3::X, 2.0);
        assert!(stopped.is_on_ground && stopped.feet.y.abs() < 1e-9, "{stopped:?}");
        assert!(stopped.feet.x < 3.6 - 0.7, "the bed stops: {stopped:?}");
    }

    #[test]
    fn what_is_no_number_moves_nobody() {
        let walls = world(&[]);
        let now = at([0.0, 1.0, 0.0]);
        for (by, seconds) in [(DVec3::NAN, 0.1), (DVec3::X, f64::NAN), (DVec3::INFINITY, 0.1), (DVec3::X, -1.0)] {
            assert_eq!(BODY.walk(now, by, seconds, &walls, true), now);
        }
    }
}
