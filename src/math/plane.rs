//! A plane n·x + d = 0.

use glam::{DMat4, DVec3, DVec4};

/// A plane by its unit normal and offset: `normal · x + offset = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Of unit length.
    pub normal: DVec3,
    /// Minus the plane's distance from the origin along `normal`.
    pub offset: f64,
}

impl Plane {
    /// The plane through a point with a normal of any length but 0.
    #[must_use]
    pub fn through(point: DVec3, normal: DVec3) -> Plane {
        let normal = normal.normalize();
        Plane { normal, offset: -normal.dot(point) }
    }

    /// Signed distance of a point with `w = 1`; `normal · D` of a direction with `w = 0`.
    #[must_use]
    pub fn at(&self, point: DVec4) -> f64 {
        self.normal.dot(point.truncate()) + self.offset * point.w
    }

    /// The same plane with its normal turned round.
    #[must_use]
    pub fn turned(&self) -> Plane {
        Plane { normal: -self.normal, offset: -self.offset }
    }

    /// Carries a point to its shadow on this plane, thrown by a homogeneous `light`:
    /// `(P·L) I − L Pᵀ` (Blinn 1988). With the light in front, points between plane and light get
    /// a positive `w`, and points level with a point light go to infinity.
    #[must_use]
    pub fn shadow_from_world(&self, light: DVec4) -> DMat4 {
        let plane = self.normal.extend(self.offset);
        let scaled = |component: f64| light * component;
        let outer = DMat4::from_cols(scaled(plane.x), scaled(plane.y), scaled(plane.z), scaled(plane.w));
        DMat4::from_diagonal(DVec4::splat(self.at(light))) - outer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shadow lies on the plane, and on the line through light and point: the definition.
    #[test]
    fn a_shadow_is_where_the_ray_from_the_light_meets_the_plane() {
        let plane = Plane::through(DVec3::new(0.3, -1.0, 2.0), DVec3::new(0.2, 1.0, -0.1));
        for light in [DVec4::new(3.0, 7.0, -2.0, 1.0), DVec4::new(0.4, 1.0, 0.3, 0.0)] {
            let matrix = plane.shadow_from_world(light);
            for point in [DVec3::new(0.0, 1.0, 0.0), DVec3::new(-4.0, 2.0, 5.0), DVec3::new(1.0, 0.5, 1.0)] {
                let shadow = matrix * point.extend(1.0);
                assert!(shadow.w > 0.0);
                let shadow = shadow.truncate() / shadow.w;
                assert!(plane.at(shadow.extend(1.0)).abs() < 1e-9);
                let ray = if light.w == 0.0 { light.truncate() } else { light.truncate() - point };
                assert!((shadow - point).cross(ray).length() < 1e-9 * ray.length());
                assert!((shadow - point).dot(ray) < 0.0, "the shadow is beyond the point, away from the light");
            }
        }
    }
}
