//! On which side of a triangle's plane a homogeneous point lies, decided exactly.
//!
//! Facing, caps, silhouettes and labels all depend on this one sign. A rounding error that two users of a triangle see
//! differently opens a shadow volume; an exact sign can't. For points it is Shewchuk's adaptive `orient3d` (crate
//! `robust`); for directions the determinant `D · (a×b + b×c + c×a)` is first bounded in floating point, and only where
//! the bound does not decide it is summed exactly, as an expansion (Shewchuk 1997, "Adaptive Precision Floating-Point
//! Arithmetic and Fast Robust Geometric Predicates").

use glam::{DVec2, DVec3, DVec4};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// The exact sign of a quantity, such as on which side of a plane a point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sign {
    /// Less than zero: behind.
    Negative,
    /// Zero: on the plane.
    Zero,
    /// More than zero: in front.
    Positive,
}

impl Sign {
    /// Returns −1, 0 or 1.
    pub fn value(self) -> i32 {
        match self {
            Sign::Negative => -1,
            Sign::Zero => 0,
            Sign::Positive => 1,
        }
    }

    /// Returns this sign; if it is zero, the one that `other` returns, which is only called then.
    #[must_use]
    pub fn or_else(self, other: impl FnOnce() -> Sign) -> Sign {
        if self == Sign::Zero { other() } else { self }
    }

    /// Returns the exact sign of `to − from`: positive where `to` is greater. Zero where one is NaN.
    pub fn between(from: f64, to: f64) -> Sign {
        if to > from {
            Sign::Positive
        } else if to < from {
            Sign::Negative
        } else {
            Sign::Zero
        }
    }

    fn of(value: f64) -> Sign {
        Sign::between(0.0, value)
    }
}

/// Returns positive where `point` is in front of the triangle `a b c`: seen from it, the corners run counter-clockwise.
/// `point` has `w = 1`, or `w = 0` for a direction. Exact, except for overflow and underflow of products of three
/// coordinates.
pub fn side_of_triangle([a, b, c]: [DVec3; 3], point: DVec4) -> Sign {
    if point.w == 0.0 {
        return side_of_direction([a, b, c], point.truncate());
    }
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    // Shewchuk's sign is positive for a point below, from where the corners run clockwise.
    Sign::of(-orient3d(coord(a), coord(b), coord(c), coord(point.truncate())))
}

/// Returns positive where `point` is to the left of the line from `a` to `b`. Exact, except for overflow and underflow
/// of products of two coordinates.
pub fn side_of_line([a, b]: [DVec2; 2], point: DVec2) -> Sign {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    Sign::of(orient2d(coord(a), coord(b), coord(point)))
}

/// Returns the exact sign of a sum of products of two numbers each, except for overflow and underflow.
pub fn sign_of_sum(products: &[(f64, f64)]) -> Sign {
    let mut sum = Expansion::default();
    products.iter().for_each(|(a, b)| sum.add_product(*a, *b, 1.0));
    sum.sign()
}

fn side_of_direction([a, b, c]: [DVec3; 3], direction: DVec3) -> Sign {
    let (u, v) = (b - a, c - a);
    let determinant = direction.dot(u.cross(v));
    // Each of the six products carries the roundings of two differences, two products and three
    // sums: under 9 units in the last place of the sum of their absolute values.
    let (d, u, v) = (direction.abs(), u.abs(), v.abs());
    let permanent = d.x * (u.y * v.z + u.z * v.y) + d.y * (u.z * v.x + u.x * v.z) + d.z * (u.x * v.y + u.y * v.x);
    if determinant.abs() > 9.0 * f64::EPSILON * permanent {
        return Sign::of(determinant);
    }
    exact_side_of_direction([a, b, c], direction)
}

fn exact_side_of_direction([a, b, c]: [DVec3; 3], direction: DVec3) -> Sign {
    let mut sum = Expansion::default();
    for (p, q) in [(a, b), (b, c), (c, a)] {
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            sum.add_product(direction[i], p[j], q[k]);
            sum.add_product(-direction[i], p[k], q[j]);
        }
    }
    sum.sign()
}

/// An exact sum: components that do not overlap, smallest first.
#[derive(Default)]
struct Expansion(Vec<f64>);

impl Expansion {
    fn add_product(&mut self, a: f64, b: f64, c: f64) {
        let (high, low) = two_product(a, b);
        for part in [low, high] {
            let (high, low) = two_product(part, c);
            self.add(low);
            self.add(high);
        }
    }

    fn add(&mut self, value: f64) {
        let mut carry = value;
        for component in &mut self.0 {
            (carry, *component) = two_sum(carry, *component);
        }
        self.0.push(carry);
        self.0.retain(|component| *component != 0.0);
    }

    fn sign(&self) -> Sign {
        self.0.last().map_or(Sign::Zero, |largest| Sign::of(*largest))
    }
}

/// Returns the rounded sum of two numbers and its rounding error (Knuth): both results together are the exact sum.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// Returns the rounded product of two numbers and its rounding error: both results together are the exact product.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn the_front_is_where_corners_run_counter_clockwise() {
        assert_eq!(side_of_triangle(TRIANGLE, DVec4::new(0.3, 0.3, 5.0, 1.0)), Sign::Positive);
        assert_eq!(side_of_triangle(TRIANGLE, DVec4::new(0.3, 0.3, -5.0, 1.0)), Sign::Negative);
        assert_eq!(side_of_triangle(TRIANGLE, DVec4::new(9.0, -9.0, 0.0, 1.0)), Sign::Zero);
        assert_eq!(side_of_triangle(TRIANGLE, DVec4::new(0.0, 0.0, 1.0, 0.0)), Sign::Positive);
        assert_eq!(side_of_triangle(TRIANGLE, DVec4::new(0.0, 0.0, -1.0, 0.0)), Sign::Negative);
        assert_eq!(side_of_triangle(TRIANGLE, DVec4::new(1.0, 1.0, 0.0, 0.0)), Sign::Zero);
    }

    /// A sheared plane far from the origin: naive arithmetic can't distinguish one unit in the last place, and
    /// reversing the corners must always reverse the sign.
    #[test]
    fn a_direction_one_ulp_off_the_plane_is_reported_from_one_on_it() {
        let [a, b, c] = [
            DVec3::new(1e7 + 0.1, -3e6 + 0.7, 12.3),
            DVec3::new(1e7 + 1.1, -3e6 + 0.9, 12.9),
            DVec3::new(1e7 + 0.4, -3e6 + 1.7, 11.8),
        ];
        let on_plane = b - a; // exact: the differences of near numbers
        assert_eq!(side_of_triangle([a, b, c], on_plane.extend(0.0)), Sign::Zero);
        for (nudged, expected) in [(on_plane.z.next_up(), 1), (on_plane.z.next_down(), -1)] {
            let nudged = DVec3::new(on_plane.x, on_plane.y, nudged);
            let sign = side_of_triangle([a, b, c], nudged.extend(0.0)).value();
            let normal_z = ((b - a).cross(c - a)).z.signum() as i32;
            assert_eq!(sign, expected * normal_z);
            assert_eq!(side_of_triangle([c, b, a], nudged.extend(0.0)).value(), -sign);
            assert_eq!(side_of_triangle([b, c, a], nudged.extend(0.0)).value(), sign);
        }
    }

    #[test]
    fn a_sum_of_products_keeps_what_rounding_would_lose() {
        let tiny = 1.0 + f64::EPSILON;
        assert_eq!(sign_of_sum(&[(tiny, tiny), (-1.0, 1.0), (-2.0, f64::EPSILON)]), Sign::Positive);
        assert_eq!(sign_of_sum(&[(1e9 + 1.0, 1e9 - 1.0), (-1e9, 1e9), (1.0, 1.0)]), Sign::Zero);
        assert_eq!(sign_of_sum(&[]), Sign::Zero);
    }

    #[test]
    fn the_filter_and_the_exact_sum_agree() {
        let mut seed = 1u64;
        let mut number = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / 4096.0 - 2048.0
        };
        for _ in 0..2000 {
            let mut point = || DVec3::new(number(), number(), number());
            let (triangle, direction) = ([point(), point(), point()], point());
            assert_eq!(side_of_direction(triangle, direction), exact_side_of_direction(triangle, direction));
        }
    }
}
