//! Spherical coordinates of an eye about its target: the distance r, the azimuth θ and the elevation φ.
//!
//! θ is in the level plane, from +z towards +x, and φ from that plane towards +y: in a world whose z is up, from +x towards
//! +y and towards +z, the same after a cyclic exchange of the axes, which keeps the world right-handed.

use super::Camera;
use crate::math::angle;
use glam::DVec3;
use serde::Serialize;

/// The eye's place about its target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spherical {
    /// Distance from the target, metres, > 0.
    pub r: f64,
    /// Azimuth around Y, from +Z towards +X, degrees.
    pub theta_degrees: f64,
    /// Elevation over the level plane, degrees: 90 is right above the target.
    pub phi_degrees: f64,
}

impl Spherical {
    /// Returns a camera's eye about its target, the azimuth from -180 to 180 degrees: 0 right above or below.
    pub fn of(camera: &Camera) -> Spherical {
        let away = camera.eye - camera.target;
        let level = angle::hypot(away.x, away.z);
        Spherical {
            r: away.length(),
            theta_degrees: angle::atan2(away.x, away.z).to_degrees(),
            phi_degrees: angle::atan2(away.y, level).to_degrees(),
        }
    }

    /// Returns the eye's position about a target, world space: target + r (cos φ sin θ, sin φ, cos φ cos θ).
    pub fn eye_about(&self, target: DVec3) -> DVec3 {
        let ([sin_theta, cos_theta], [sin_phi, cos_phi]) = self.sines();
        target + DVec3::new(cos_phi * sin_theta, sin_phi, cos_phi * cos_theta) * self.r
    }

    /// Returns the unit direction in which the eye moves as the elevation grows: up in the picture of a camera that is
    /// not rolled, right above and below the target too.
    pub fn up(&self) -> DVec3 {
        let ([sin_theta, cos_theta], [sin_phi, cos_phi]) = self.sines();
        DVec3::new(-sin_phi * sin_theta, cos_phi, -sin_phi * cos_theta)
    }

    /// Checks the coordinates.
    ///
    /// # Errors
    /// What must be: r from 1e-30 to 1e30, θ within ±360 degrees, φ within ±90.
    pub fn check(&self) -> Result<(), &'static str> {
        if !(1e-30..=1e30).contains(&self.r) {
            Err("the eye's distance r from its target must be from 1e-30 to 1e30 metres")
        } else if !(-360.0..=360.0).contains(&self.theta_degrees) {
            Err("the eye's azimuth θ must be from -360 to 360 degrees")
        } else if !(-90.0..=90.0).contains(&self.phi_degrees) {
            Err("the eye's elevation φ must be from -90 to 90 degrees")
        } else {
            Ok(())
        }
    }

    fn sines(&self) -> ([f64; 2], [f64; 2]) {
        let of = |degrees: f64| <[f64; 2]>::from(angle::sin_cos(degrees.to_radians()));
        (of(self.theta_degrees), of(self.phi_degrees))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::CameraChange;
    use glam::{DMat3, DMat4, DVec4};

    #[test]
    fn a_camera_above_and_to_the_right_has_its_angles() {
        let camera = Camera::looking([2.0, 2.0 * 2f64.sqrt() + 1.0, 2.0], [0.0, 1.0, 0.0]);
        let found = Spherical::of(&camera);
        assert!((found.r - 4.0).abs() < 1e-12);
        assert!((found.theta_degrees - 45.0).abs() < 1e-12 && (found.phi_degrees - 45.0).abs() < 1e-12);
    }

    /// The lecture's matrix, of a world whose z is up and whose eye space looks along +z and is left-handed, carries points
    /// to where ours does, which looks along −z: the first two coordinates are equal, and the third is turned.
    #[test]
    fn the_view_is_the_lectures_matrix() {
        for (r, theta, phi) in [(4.0, 30.0, 25.0), (2.5, -160.0, -70.0), (1.0, 40.0, 0.0)] {
            let place = Spherical { r, theta_degrees: theta, phi_degrees: phi };
            let mut camera = Camera::looking([9.0, 9.0, 9.0], [0.0; 3]);
            CameraChange { eye_spherical: Some(place), ..CameraChange::default() }
                .apply_to(&mut camera)
                .expect("a camera");
            let ([s, c], [sp, cp]) = (
                [theta.to_radians().sin(), theta.to_radians().cos()],
                [phi.to_radians().sin(), phi.to_radians().cos()],
            );
            // Of row vectors, as the lecture writes it.
            let rows =
                [[-s, -c * sp, -c * cp, 0.0], [c, -s * sp, -s * cp, 0.0], [0.0, cp, -sp, 0.0], [0.0, 0.0, r, 1.0]];
            let lecture = DMat4::from_cols_array_2d(&rows);
            // Our y is its z, our z its x and our x its y.
            let z_up_from_world = DMat4::from_mat3(DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X));
            let ours = DMat4::from_mat3(camera.world_from_view().transpose()) * DMat4::from_translation(-camera.eye);
            let wanted = DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)) * lecture * z_up_from_world;
            assert!(ours.abs_diff_eq(wanted, 1e-12), "{ours}\n{wanted}");
            assert!((ours * DVec4::W - DVec4::new(0.0, 0.0, -r, 1.0)).length() < 1e-12, "the target is r ahead");
            let back = Spherical::of(&camera);
            let off = [back.r - r, back.theta_degrees - theta, back.phi_degrees - phi];
            assert!(off.iter().all(|off| off.abs() < 1e-9), "{back:?}");
        }
    }

    #[test]
    fn right_above_the_target_up_is_the_way_of_growing_elevation() {
        let mut camera = Camera::looking([1.0, 2.0, 3.0], [1.0, 0.0, 0.0]);
        let place = Spherical { r: 5.0, theta_degrees: 90.0, phi_degrees: 90.0 };
        CameraChange { eye_spherical: Some(place), ..CameraChange::default() }.apply_to(&mut camera).expect("a camera");
        assert!((camera.eye - DVec3::new(1.0, 5.0, 0.0)).length() < 1e-12);
        assert!((camera.up - DVec3::NEG_X).length() < 1e-12, "{}", camera.up);
    }

    #[test]
    fn an_eye_given_twice_or_by_impossible_coordinates_is_refused() {
        let place = Spherical { r: 5.0, theta_degrees: 0.0, phi_degrees: 0.0 };
        let changed = |change: CameraChange| change.apply_to(&mut Camera::looking([1.0, 2.0, 3.0], [0.0; 3]));
        let twice = CameraChange { eye: Some(DVec3::X), eye_spherical: Some(place), ..CameraChange::default() };
        assert!(changed(twice).expect_err("twice").contains("twice"));
        for (wrong, of) in [
            (Spherical { r: 0.0, ..place }, "distance r"),
            (Spherical { theta_degrees: f64::NAN, ..place }, "azimuth"),
            (Spherical { phi_degrees: 90.1, ..place }, "elevation"),
        ] {
            let change = CameraChange { eye_spherical: Some(wrong), ..CameraChange::default() };
            assert!(changed(change).expect_err(of).contains(of));
        }
    }
}
