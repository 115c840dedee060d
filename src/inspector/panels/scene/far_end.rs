//! Where what runs to infinity is ended, so that it can be drawn.
//!
//! Corners at infinity are put on a sphere about a point light, which every ray from it meets once, so
//! that volumes stay closed; what runs to a directional light's point at infinity is cut by a plane
//! across the light.

use crate::anatomy::PlacedLight;
use glam::{DVec3, DVec4};

/// How far volumes go beyond what there is to see, in parts of its radius.
const BEYOND: f64 = 1.2;

/// Where volumes that have no end are ended.
pub enum FarEnd {
    /// On a sphere about a point light.
    Sphere {
        /// The light, world space.
        light: DVec3,
        /// Radius, metres.
        reach: f64,
    },
    /// At a plane across a directional light: inside is where it is positive.
    Plane(DVec4),
}

impl FarEnd {
    /// For volumes of `light`, where there is a sphere to see.
    #[must_use]
    pub fn new(light: &PlacedLight, middle: DVec3, radius: f64) -> FarEnd {
        let towards = light.position.truncate();
        if light.position.w == 0.0 {
            let towards = towards.normalize();
            return FarEnd::Plane(towards.extend(BEYOND * radius - towards.dot(middle)));
        }
        let light = towards / light.position.w;
        FarEnd::Sphere { light, reach: (light - middle).length() + BEYOND * radius }
    }

    /// Is the finite part of a triangle the triangle itself, each corner moved on its own?
    #[must_use]
    pub fn is_whole(&self, corners: &[DVec4; 3]) -> bool {
        matches!(self, FarEnd::Sphere { .. }) || corners.iter().all(|corner| corner.w != 0.0)
    }

    /// The finite part of a triangle: none, or up to two.
    #[must_use]
    pub fn finite(&self, corners: [DVec4; 3]) -> [Option<[DVec3; 3]>; 2] {
        match self {
            FarEnd::Sphere { light, reach } => {
                let at = |corner: DVec4| match corner.w == 0.0 {
                    true => *light + corner.truncate().normalize_or_zero() * *reach,
                    false => corner.truncate() / corner.w,
                };
                [Some(corners.map(at)), None]
            }
            FarEnd::Plane(_) if corners.iter().all(|corner| corner.w != 0.0) => {
                [Some(corners.map(|corner| corner.truncate() / corner.w)), None]
            }
            FarEnd::Plane(plane) => {
                let polygon = clip(corners, *plane);
                let at = |index: usize| polygon.get(index).map(|corner| corner.truncate() / corner.w);
                let triangle = |a, b, c| Some([at(a)?, at(b)?, at(c)?]);
                [triangle(0, 1, 2), triangle(0, 2, 3)]
            }
        }
    }
}

/// The part of a triangle where a plane is positive: up to four corners (Sutherland and Hodgman 1974).
fn clip(corners: [DVec4; 3], plane: DVec4) -> Vec<DVec4> {
    let mut kept = Vec::with_capacity(4);
    for (index, &corner) in corners.iter().enumerate() {
        let next = corners[(index + 1) % 3];
        let [here, there] = [plane.dot(corner), plane.dot(next)];
        if here >= 0.0 {
            kept.push(corner);
        }
        if (here < 0.0) != (there < 0.0) {
            kept.push(corner.lerp(next, here / (here - there)));
        }
    }
    // A point that is left at infinity all the same has no place.
    kept.retain(|corner| corner.w > 0.0);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_that_runs_to_a_suns_point_at_infinity_ends_at_a_plane() {
        let light = PlacedLight { position: DVec4::new(0.0, 2.0, 0.0, 0.0), color: [1.0; 3], range: None };
        let far = FarEnd::new(&light, DVec3::ZERO, 5.0);
        let corners =
            [DVec4::new(1.0, 2.0, 0.0, 1.0), DVec4::new(-1.0, 2.0, 0.0, 1.0), DVec4::new(0.0, -2.0, 0.0, 0.0)];
        let pieces: Vec<_> = far.finite(corners).into_iter().flatten().collect();
        assert_eq!(pieces.len(), 2, "a triangle without its tip has four corners");
        let lowest = pieces.iter().flatten().map(|corner| corner.y).fold(f64::INFINITY, f64::min);
        assert!((lowest + BEYOND * 5.0).abs() < 1e-9, "{lowest}");
        assert!(pieces.iter().flatten().all(|corner| corner.x.abs() <= 1.0 + 1e-9), "the sides are parallel");
    }

    #[test]
    fn corners_at_infinity_lie_on_the_rays_of_a_lamp() {
        let light = PlacedLight { position: DVec4::new(0.0, 4.0, 0.0, 1.0), color: [1.0; 3], range: None };
        let far = FarEnd::new(&light, DVec3::ZERO, 5.0);
        let near = DVec3::new(1.0, 1.0, 2.0);
        let away = (near - DVec3::new(0.0, 4.0, 0.0)).extend(0.0);
        let [Some([a, _, c]), None] = far.finite([near.extend(1.0), DVec4::W, away]) else { panic!("one triangle") };
        assert_eq!(a, near);
        assert!((c - a).normalize().dot(away.truncate().normalize()) > 1.0 - 1e-12);
        assert!(((c - DVec3::new(0.0, 4.0, 0.0)).length() - 4.0 - BEYOND * 5.0).abs() < 1e-9);
    }
}
