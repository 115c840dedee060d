//! The bounding box of points, with sides along the axes.

use glam::DVec3;

/// A box whose sides lie along the axes. Around no point it is empty: `low` is above `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisBox {
    /// The lowest corner.
    pub low: DVec3,
    /// The highest corner.
    pub high: DVec3,
}

impl AxisBox {
    /// Returns the smallest box that contains all points; without points the empty box, with `low` +∞ and `high` −∞.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> AxisBox {
        let none = AxisBox { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.into_iter().fold(none, |all, point| AxisBox { low: all.low.min(point), high: all.high.max(point) })
    }

    /// Returns whether a point is in the box or on its border.
    pub fn holds(&self, point: DVec3) -> bool {
        self.low.cmple(point).all() && self.high.cmpge(point).all()
    }

    /// Returns the intersection of two boxes; empty where they don't intersect.
    #[must_use]
    pub fn common(self, other: AxisBox) -> AxisBox {
        AxisBox { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// Returns the smallest box that contains both; an empty box adds nothing.
    #[must_use]
    pub fn joined(self, other: AxisBox) -> AxisBox {
        let [this, other] = [self, other].map(|one| if one.is_empty() { AxisBox::around([]) } else { one });
        AxisBox { low: this.low.min(other.low), high: this.high.max(other.high) }
    }

    /// Returns whether the box contains no point: `low` exceeds `high` on some axis, or one is NaN.
    pub fn is_empty(&self) -> bool {
        !self.low.cmple(self.high).all()
    }

    /// Returns the length of the box's diagonal; infinite for the box around no points.
    pub fn diagonal(&self) -> f64 {
        (self.high - self.low).length()
    }

    /// Returns the eight corners; bits 0, 1 and 2 of an index say whether x, y and z are the high ones.
    pub fn corners(&self) -> [DVec3; 8] {
        [0, 1, 2, 3, 4, 5, 6, 7].map(|corner| {
            let of = |axis: usize| if corner >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] };
            DVec3::new(of(0), of(1), of(2))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_corners_are_the_box_around_its_points() {
        let points = [DVec3::new(1.0, -2.0, 3.0), DVec3::new(-1.0, 5.0, 3.0)];
        let found = AxisBox::around(points);
        assert!(found.holds(points[0]) && found.holds(DVec3::new(0.0, 0.0, 3.0)) && !found.holds(DVec3::ZERO));
        assert_eq!((found.low, found.high), (DVec3::new(-1.0, -2.0, 3.0), DVec3::new(1.0, 5.0, 3.0)));
        assert_eq!(AxisBox::around(found.corners()), found);
        assert_eq!(found.diagonal(), 53.0_f64.sqrt());
        assert_eq!(AxisBox::around([]).diagonal(), f64::INFINITY);
    }

    #[test]
    fn boxes_that_do_not_meet_have_nothing_in_common_and_that_joins_nothing() {
        let [one, other] = [0.0, 2.0].map(|at| AxisBox::around([DVec3::splat(at), DVec3::splat(at + 1.0)]));
        let nothing = one.common(other);
        assert!(nothing.is_empty() && !one.is_empty() && AxisBox::around([]).is_empty());
        assert_eq!((one.joined(nothing), nothing.joined(one)), (one, one));
        assert_eq!(one.joined(other), AxisBox::around([DVec3::ZERO, DVec3::splat(3.0)]));
    }
}
