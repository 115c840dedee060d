//! What z-pass begins with where the settings say so: the number of volumes around the eye, as the clear value.
//!
//! The eye is in the volume of every casting triangle that lies between it and the light (Everitt and Kilgard 2002,
//! "Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering", on what came before z-fail).
//! Exact for the eye, but pixels begin at the near plane: where that lies partly in a volume, no one number is right.

use super::drawn::VolumePlan;
use crate::math::{Sign, side_of_triangle};
use crate::plan::LightId;
use crate::technique::frame::FrameBuilder;
use glam::{DVec3, DVec4};

/// Returns the stencil value from which z-pass counts: the number of casting triangles in `volumes` whose own shadow
/// volume, extended to infinity, contains the eye, or, for a parallel projection, the middle of the near plane.
pub fn at(frame: &FrameBuilder, light: LightId, volumes: &[VolumePlan]) -> u32 {
    let (place, light) = (frame.job.scene.camera.counting_place(), frame.light_position(light));
    let of_volume = |volume: &VolumePlan| {
        let (world, triangles) = volume.casting_triangles(frame, light);
        triangles.into_iter().map(move |corners| corners.map(|vertex| world[vertex as usize]))
    };
    let casting = volumes.iter().flat_map(of_volume);
    casting.filter(|corners| holds(*corners, light, place)).count() as u32
}

/// Returns whether the volume of one triangle, extended to infinity away from a homogeneous light, strictly contains a
/// point: not if it is on a side plane or in the triangle's plane. Exact.
fn holds(corners: [DVec3; 3], light: DVec4, point: DVec3) -> bool {
    let [of_light, of_point] = [light, point.extend(1.0)].map(|place| side_of_triangle(corners, place));
    let [a, b, c] = corners;
    let [first, second, third] = [[a, b], [b, c], [c, a]].map(|[p, q]| side_of_triangle([point, p, q], light));
    of_light.value() * of_point.value() < 0 && first != Sign::Zero && first == second && second == third
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHEET: [DVec3; 3] = [DVec3::new(-1.0, 1.0, -1.0), DVec3::new(1.0, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0)];

    #[test]
    fn a_point_is_held_beyond_the_triangle_and_within_its_outline() {
        let flipped = [SHEET[0], SHEET[2], SHEET[1]];
        for light in [DVec4::new(0.0, 3.0, 0.0, 1.0), DVec4::new(0.0, 2.0, 0.0, 0.0)] {
            for triangle in [SHEET, flipped] {
                assert!(holds(triangle, light, DVec3::ZERO));
                assert!(!holds(triangle, light, DVec3::new(0.0, 2.0, 0.0)), "between light and triangle");
                assert!(!holds(triangle, light, DVec3::new(4.0, 0.0, 0.0)), "beside it");
            }
        }
        assert!(!holds(SHEET, DVec4::new(0.0, -3.0, 0.0, 1.0), DVec3::ZERO), "lit from below");
        assert!(!holds(SHEET, DVec4::new(0.0, -1.0, 0.0, 0.0), DVec3::ZERO), "lit from below by a sun");
    }
}
