//! Functions of angles whose results are the same bits on every system.
//!
//! The `sin` and `cos` of glibc, musl, macOS, Windows and browsers differ in the last bits, and a scene whose corners
//! differ is another scene. These are the functions of the crate `libm` (musl's algorithms, in Rust), for everything that
//! places a corner, an eye or a light. Square roots need none: IEEE 754 rounds them the same everywhere.

use glam::{DMat3, DQuat, DVec2, DVec3};

pub use libm::{asin, atan2, cos, hypot, log2, pow, sin, sincos as sin_cos, tan};

/// Returns the unit vector at an angle in radians, counter-clockwise from +x.
pub fn direction(radians: f64) -> DVec2 {
    let (sin, cos) = sin_cos(radians);
    DVec2::new(cos, sin)
}

/// Returns the rotation by an angle in radians about an axis of unit length, counter-clockwise seen from where the axis
/// points to.
pub fn rotation(axis: DVec3, radians: f64) -> DQuat {
    let (sin, cos) = sin_cos(radians / 2.0);
    DQuat::from_vec4((axis * sin).extend(cos))
}

/// Returns the angles in radians of a rotation about the fixed x, then y, then z axis. Where the rotation about y is a
/// right angle, the other two are about one axis, and z's is 0.
pub fn fixed_angles(rotation: DQuat) -> DVec3 {
    let DMat3 { x_axis, y_axis, z_axis } = DMat3::from_quat(rotation);
    let level = hypot(x_axis.x, x_axis.y);
    let y = atan2(-x_axis.z, level);
    if level > 16.0 * f64::EPSILON {
        DVec3::new(atan2(y_axis.z, z_axis.z), y, atan2(x_axis.y, x_axis.x))
    } else {
        DVec3::new(atan2(-z_axis.y, y_axis.y), y, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Bits of `libm`, by which a system is noticed whose results differ.
    #[test]
    fn results_are_the_same_bits_everywhere() {
        assert_eq!(sin(0.7).to_bits(), 0x3fe4_9d6e_6946_19b8, "{:x}", sin(0.7).to_bits());
        assert_eq!(cos(2.3).to_bits(), 0xbfe5_5222_1730_2fe0, "{:x}", cos(2.3).to_bits());
    }

    #[test]
    fn a_rotation_is_the_one_about_its_axis() {
        let turned = rotation(DVec3::Y, FRAC_PI_2) * DVec3::X;
        assert!((turned - DVec3::NEG_Z).length() < 1e-15, "{turned}");
        assert!((direction(PI / 6.0) - DVec2::new(0.75_f64.sqrt(), 0.5)).length() < 1e-15);
    }

    #[test]
    fn angles_give_the_rotation_back() {
        for [x, y, z] in [[0.3, -1.2, 2.9], [-3.0, 0.0, 0.1], [1.0, FRAC_PI_2, 0.4], [-0.2, -FRAC_PI_2, 2.0]] {
            let of = |angles: DVec3| {
                rotation(DVec3::Z, angles.z) * rotation(DVec3::Y, angles.y) * rotation(DVec3::X, angles.x)
            };
            let wanted = of(DVec3::new(x, y, z));
            let found = of(fixed_angles(wanted));
            assert!(wanted.dot(found).abs() > 1.0 - 1e-14, "{x}, {y}, {z}: {found}");
        }
    }
}
