//! A plane n·x + d = 0.

use glam::{DVec3, DVec4};

/// A plane by its unit normal and offset: `normal · x + offset = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Normal of unit length.
    pub normal: DVec3,
    /// Minus the plane's distance from the origin along `normal`.
    pub offset: f64,
}

impl Plane {
    /// Returns the plane through a point with this normal, which is normalised here and must not be zero.
    pub fn through(point: DVec3, normal: DVec3) -> Plane {
        let normal = normal.normalize();
        Plane { normal, offset: -normal.dot(point) }
    }

    /// Returns the plane through homogeneous corners (w = 0: a point at infinity) relative to `origin`; `None` where they span
    /// none.
    pub fn through_homogeneous(corners: [[f32; 4]; 3], origin: DVec3) -> Option<Plane> {
        let normal = Plane::normal_of_homogeneous(corners);
        let [a, b, c] = corners.map(|[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into()));
        let offset = -a.dot(b.cross(c));
        let length = normal.length();
        let is_usable = normal.is_finite() && length > 0.0 && offset.is_finite();
        is_usable.then(|| {
            let normal = normal / length;
            Plane { normal, offset: offset / length - normal.dot(origin) }
        })
    }

    /// Returns the normal of homogeneous corners, not of unit length: as long as twice their area where each w is 1. The longer
    /// it is, the less the corners' rounding turns it.
    pub fn normal_of_homogeneous(corners: [[f32; 4]; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|[x, y, z, w]| (DVec3::new(x.into(), y.into(), z.into()), f64::from(w)));
        b.0.cross(c.0) * a.1 + c.0.cross(a.0) * b.1 + a.0.cross(b.0) * c.1
    }

    /// Returns the signed distance of a point with `w = 1`; `normal · D` of a direction with `w = 0`.
    pub fn at(&self, point: DVec4) -> f64 {
        self.normal.dot(point.truncate()) + self.offset * point.w
    }

    /// Returns the signed distance of a point, and 0 where rounding can't distinguish it from the plane: points in one
    /// plane with others must not be above them by a unit in the last place.
    pub fn height(&self, point: DVec3) -> f64 {
        let height = self.at(point.extend(1.0));
        let products = (self.normal * point).abs().element_sum() + self.offset.abs();
        if height.abs() > 16.0 * f64::EPSILON * products { height } else { 0.0 }
    }

    /// Returns the same plane with its normal reversed.
    pub fn flipped(&self) -> Plane {
        Plane { normal: -self.normal, offset: -self.offset }
    }
}
