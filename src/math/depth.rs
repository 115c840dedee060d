//! Depth mappings: how the distance along the view axis becomes the depth that is stored.
//!
//! Every perspective mapping here is `depth = offset + scale / distance`, so two numbers define how a stored depth is
//! read back and how fine it is. Those of a parallel camera are linear, `depth = offset + scale · distance`: no number
//! there stands for infinity, so depth ends at a distance, and what must not be clipped behind it is clamped.
//! Techniques are written for reversed depth, where greater is nearer; the frame reverses tests and biases for the
//! others.

use super::DepthBits;
use glam::DVec2;
use serde::{Deserialize, Serialize};

named_enum! {
    /// How distance becomes depth.
    #[derive(Default)]
    pub enum DepthMapping {
        /// 1 at the near plane, 0 at infinity: nothing is clipped at far, and `f32` is finest where it
        /// is needed (Reed 2015, "Depth Precision Visualized").
        #[default]
        ReversedInfinite = "reversed-infinite",
        /// 0 at the near plane, 1 at infinity (Everitt and Kilgard 2002).
        StandardInfinite = "standard-infinite",
        /// 0 at the near plane, and infinity moved below 1 by epsilon, so that rounding can't clip what is there
        /// (Lengyel 2002).
        StandardInfiniteEpsilon = "standard-infinite-epsilon",
        /// 0 at the near plane, 1 at the far plane: what reaches beyond is clipped.
        StandardFinite = "standard-finite",
        /// 0 at the near plane, 1 at the far plane, without clipping: what lies beyond is stored as 1.
        StandardFiniteClamp = "standard-finite-clamp",
    }
}

named_enum! {
    /// The unit of a distance.
    #[derive(Default)]
    pub enum LengthUnit(
        /// Its symbol, where there is only space for a letter.
        letter
    ) {
        /// Scenes are in metres.
        #[default]
        Metre = "m" ("m"),
        /// Another program's unit, which no capture states.
        Unknown = "units" ("u"),
    }
}

/// The depth range of a viewport (glDepthRange), with the curve before it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DepthRange {
    /// What depth 0 and depth 1 of normalized device coordinates are stored as, each from 0 to 1, the first not greater.
    pub stored: [f64; 2],
    /// [`DepthCurve::offset`] of depth in normalized device coordinates.
    pub device_offset: f64,
    /// [`DepthCurve::scale`] of depth in normalized device coordinates.
    pub device_scale: f64,
}

/// A mapping with its numbers: the stored `depth = offset + scale / distance`, or `offset + scale · distance` where it is
/// linear.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DepthCurve {
    /// The mapping.
    pub mapping: DepthMapping,
    /// The depth of an infinite distance; of a linear mapping, the depth of distance 0.
    pub offset: f64,
    /// Factor in the unit of distances; of a linear mapping, in depth per unit.
    pub scale: f64,
    /// True for a parallel camera.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_linear: bool,
    /// Distance of the far plane; `None` where there is none.
    pub far: Option<f64>,
    /// Unit of all distances.
    #[serde(default)]
    pub unit: LengthUnit,
    /// The range that depths are stored in; `None` where it is 0 to 1, so that depth is stored as normalized device
    /// coordinates have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<DepthRange>,
    /// To how many bits depths are floored before they are tested and stored; `None` where they are 32-bit floats, or not
    /// this program's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bits: Option<DepthBits>,
}

impl DepthMapping {
    /// Returns whether greater depth is nearer.
    pub fn is_reversed(self) -> bool {
        self == DepthMapping::ReversedInfinite
    }

    /// Returns whether the mapping has a far plane (clipped at or clamped to).
    pub fn is_finite(self) -> bool {
        matches!(self, DepthMapping::StandardFinite | DepthMapping::StandardFiniteClamp)
    }

    /// Returns whether depths beyond near and far are clamped instead of clipped.
    pub fn clamps(self) -> bool {
        self == DepthMapping::StandardFiniteClamp
    }

    /// Returns the depth where nothing was drawn.
    pub fn clear_depth(self) -> f32 {
        if self.is_reversed() { 0.0 } else { 1.0 }
    }

    /// Returns the depth curve of a perspective camera, near plane at `near` metres. `far` (metres) is used by the
    /// finite mappings alone, `epsilon` by the one of that name alone.
    pub fn curve(self, near: f64, far: f64, epsilon: f64) -> DepthCurve {
        let offset = match self {
            DepthMapping::ReversedInfinite => 0.0,
            DepthMapping::StandardInfinite => 1.0,
            DepthMapping::StandardInfiniteEpsilon => 1.0 - epsilon,
            DepthMapping::StandardFinite | DepthMapping::StandardFiniteClamp => far / (far - near),
        };
        let scale = if self.is_reversed() { near } else { -near * offset };
        let far = self.is_finite().then_some(far);
        DepthCurve { far, ..DepthCurve::new(self, offset, scale) }
    }

    /// Returns the linear curve of a parallel camera: from 0 to 1 between `near` and `end`, or from 1 to 0 where the
    /// mapping is reversed. Only a finite mapping has a far plane there.
    pub fn linear_curve(self, near: f64, end: f64) -> DepthCurve {
        let scale = if self.is_reversed() { -1.0 / (end - near) } else { 1.0 / (end - near) };
        let offset = if self.is_reversed() { -end * scale } else { -near * scale };
        let far = self.is_finite().then_some(end);
        DepthCurve { is_linear: true, far, ..DepthCurve::new(self, offset, scale) }
    }
}

impl DepthCurve {
    /// Returns the curve `offset + scale / distance`, distances in metres, without a far plane, stored from 0 to 1 in 32 bits.
    pub fn new(mapping: DepthMapping, offset: f64, scale: f64) -> DepthCurve {
        let unit = LengthUnit::Metre;
        DepthCurve { mapping, offset, scale, is_linear: false, far: None, unit, range: None, bits: None }
    }

    /// Returns the curve of a perspective that ends at `near` and at `far`, metres, whichever mapping it is: where the
    /// mapping is reversed, from 1 to 0 between them, else from 0 to 1.
    pub fn between(mapping: DepthMapping, near: f64, far: f64) -> DepthCurve {
        let depth = far - near;
        let (offset, scale) = if mapping.is_reversed() {
            (-near / depth, near * far / depth)
        } else {
            (far / depth, -near * far / depth)
        };
        DepthCurve { far: Some(far), ..DepthCurve::new(mapping, offset, scale) }
    }

    /// Returns the same curve stored in a range of depths: its depth 0 as the first, its depth 1 as the second, both rounded
    /// to single precision, in which a viewport has them. 0 to 1 changes nothing. Where both are one number, all depths are
    /// stored as it.
    #[must_use]
    pub fn stored_in(self, ends: [f64; 2]) -> DepthCurve {
        let [near, far] = ends.map(|end| f64::from(end as f32));
        let [device_offset, device_scale] = self.device();
        if [near, far] == [0.0, 1.0] {
            return DepthCurve { offset: device_offset, scale: device_scale, range: None, ..self };
        }
        let range = Some(DepthRange { stored: [near, far], device_offset, device_scale });
        DepthCurve { offset: near + (far - near) * device_offset, scale: (far - near) * device_scale, range, ..self }
    }

    /// Returns offset and scale of depth in normalized device coordinates, before it is stored in a range.
    pub fn device(&self) -> [f64; 2] {
        self.range.map_or([self.offset, self.scale], |range| [range.device_offset, range.device_scale])
    }

    /// Returns the row of z in the clip matrix: factors of view z (negative ahead) and of w.
    pub fn z_row(&self) -> DVec2 {
        let [offset, scale] = self.device();
        if self.is_linear { DVec2::new(-scale, offset) } else { DVec2::new(-offset, scale) }
    }

    /// Returns whether depth ends where nothing must be clipped: volumes that continue are clamped there.
    pub fn keeps_volumes(&self) -> bool {
        self.is_linear && !self.mapping.is_finite()
    }

    /// Returns the curve's formula as text: `0 + 0.05 / distance`, or with `*` where depth is linear in distance.
    pub fn formula(&self) -> String {
        let times = if self.is_linear { "*" } else { "/" };
        format!("{} + {} {times} distance", self.offset, self.scale)
    }

    /// Returns whether stored depths stand for distances: not where an empty range stores all as one.
    pub fn tells_distances(&self) -> bool {
        self.scale != 0.0
    }

    /// Returns the distance along the view axis; `None` for the depth where nothing was drawn, for that of infinity in a
    /// range of depths, where it is another, and where all depths are stored as one.
    pub fn distance(&self, depth: f32) -> Option<f64> {
        let above = f64::from(depth) - self.offset;
        // What a viewport adds is rounded once.
        let is_infinite =
            !self.is_linear && self.range.is_some() && above.abs() <= f64::from(f32::EPSILON) * self.offset.abs();
        (depth != self.mapping.clear_depth() && self.tells_distances() && !is_infinite)
            .then(|| if self.is_linear { above / self.scale } else { self.scale / above })
    }

    /// Returns the depth of a distance along the view's axis, in `f64`: neither rounded to the buffer's format nor
    /// clamped to 0 to 1.
    pub fn depth(&self, distance: f64) -> f64 {
        self.offset + if self.is_linear { self.scale * distance } else { self.scale / distance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEAR: f64 = 0.25;
    const FAR: f64 = 40.0;
    const EPSILON: f64 = 1.0 / 4_194_304.0;

    #[test]
    fn each_mapping_is_what_its_name_says_at_near_far_and_infinity() {
        let ends = |mapping: DepthMapping| {
            let curve = mapping.curve(NEAR, FAR, EPSILON);
            (curve.depth(NEAR), curve.depth(FAR), curve.depth(f64::INFINITY))
        };
        assert_eq!(ends(DepthMapping::ReversedInfinite), (1.0, NEAR / FAR, 0.0));
        assert_eq!(ends(DepthMapping::StandardInfinite), (0.0, 1.0 - NEAR / FAR, 1.0));
        let (near, far, infinity) = ends(DepthMapping::StandardInfiniteEpsilon);
        assert!(near == 0.0 && far < infinity && infinity == 1.0 - EPSILON);
        for mapping in [DepthMapping::StandardFinite, DepthMapping::StandardFiniteClamp] {
            let (near, far, infinity) = ends(mapping);
            assert!(near.abs() < 1e-15 && (far - 1.0).abs() < 1e-15 && infinity > 1.0);
        }
    }

    /// Ends that single precision rounds up or down.
    #[test]
    fn infinity_in_a_range_of_depths_is_no_distance() {
        for mapping in [DepthMapping::ReversedInfinite, DepthMapping::StandardInfinite] {
            for ends in [[0.2, 0.9], [0.1, 0.6], [0.7, 0.9], [0.25, 0.75], [0.3, 0.300_01]] {
                let curve = mapping.curve(NEAR, FAR, EPSILON).stored_in(ends);
                let [near, far] = ends.map(|end| end as f32);
                let infinite = if mapping.is_reversed() { near } else { near + 1.0 * (far - near) };
                assert_eq!(curve.distance(infinite), None, "{mapping:?} {ends:?}");
                let at = |share: f32| near + share * (far - near);
                let middle = if mapping.is_reversed() { at(0.25) } else { at(0.75) };
                let distance = curve.distance(middle).expect("a distance");
                let step = f64::from(f32::EPSILON) / (ends[1] - ends[0]);
                assert!((distance / (4.0 * NEAR) - 1.0).abs() < 8.0 * step, "{mapping:?} {ends:?}: {distance}");
            }
            let one = mapping.curve(NEAR, FAR, EPSILON).stored_in([0.5, 0.500_000_01]);
            assert!(!one.tells_distances() && one.distance(0.5).is_none());
        }
    }

    #[test]
    fn a_curve_between_two_planes_ends_at_both() {
        for mapping in DepthMapping::ALL {
            let curve = DepthCurve::between(mapping, NEAR, FAR);
            let [near, far] = if mapping.is_reversed() { [1.0, 0.0] } else { [0.0, 1.0] };
            assert!((curve.depth(NEAR) - near).abs() < 1e-15 && (curve.depth(FAR) - far).abs() < 1e-15, "{mapping:?}");
        }
    }

    /// The lecture's z_w of z_e with n_w and f_w, its z_e negative ahead, and back.
    #[test]
    fn a_depth_range_stores_between_its_ends_and_leaves_clip_space_as_it_is() {
        // As single precision has them.
        let [near, far] = [0.2_f32, 0.7].map(f64::from);
        for mapping in DepthMapping::ALL {
            for curve in [mapping.curve(NEAR, FAR, EPSILON), mapping.linear_curve(NEAR, FAR)] {
                let stored = curve.stored_in([near, far]);
                assert_eq!(stored.z_row(), curve.z_row(), "{mapping:?}");
                assert_eq!(stored.stored_in([0.0, 1.0]), curve);
                for distance in [NEAR, 1.0, 17.0, FAR] {
                    let depth = stored.depth(distance);
                    assert!((depth - (near + (far - near) * curve.depth(distance))).abs() < 1e-14, "{mapping:?}");
                    let back = stored.distance(depth as f32).expect("a distance");
                    assert!((back / distance - 1.0).abs() < 1e-3, "{mapping:?}: {back} of {distance}");
                }
                let one = curve.stored_in([near, near]);
                assert_eq!((one.depth(1.0), one.depth(FAR), one.distance(near as f32)), (near, near, None));
            }
        }
        let stored = DepthMapping::StandardFinite.curve(NEAR, FAR, 0.0).stored_in([near, far]);
        for away in [NEAR, 3.0, FAR] {
            let lecture =
                |z_e: f64| NEAR * FAR * (far - near) / (z_e * (FAR - NEAR)) + (FAR * far - NEAR * near) / (FAR - NEAR);
            assert!((stored.depth(away) - lecture(-away)).abs() < 1e-14, "{away}");
        }
    }

    /// z over w of the matrix row must equal the curve.
    #[test]
    fn the_row_makes_the_curve() {
        for mapping in DepthMapping::ALL {
            let curve = mapping.curve(NEAR, FAR, EPSILON);
            let row = curve.z_row();
            for distance in [NEAR, 1.0, 17.0, FAR, 1e4] {
                let z = row.x * -distance + row.y;
                assert!((z / distance - curve.depth(distance)).abs() < 1e-14, "{mapping:?} at {distance}");
            }
        }
    }

    #[test]
    fn linear_depth_goes_from_one_end_to_the_other() {
        for mapping in DepthMapping::ALL {
            let curve = mapping.linear_curve(NEAR, FAR);
            let [near, far] = if mapping.is_reversed() { [1.0, 0.0] } else { [0.0, 1.0] };
            assert!((curve.depth(NEAR) - near).abs() < 1e-15 && (curve.depth(FAR) - far).abs() < 1e-15, "{mapping:?}");
            let back = curve.distance(curve.depth(3.0) as f32).expect("a distance");
            assert!((back - 3.0).abs() < 1e-5 && curve.distance(mapping.clear_depth()).is_none());
            let row = curve.z_row();
            assert!((row.x * -7.0 + row.y - curve.depth(7.0)).abs() < 1e-15);
            assert_eq!(curve.far.is_some(), mapping.is_finite());
        }
    }

    #[test]
    fn a_stored_depth_is_read_back_and_the_clear_value_is_nowhere() {
        for mapping in DepthMapping::ALL {
            let curve = mapping.curve(NEAR, FAR, EPSILON);
            let back = curve.distance(curve.depth(3.0) as f32).expect("a distance");
            assert!((back - 3.0).abs() < 1e-5, "{mapping:?}: {back}");
            assert_eq!(curve.distance(mapping.clear_depth()), None);
            assert_eq!(DepthMapping::from_name(mapping.name()), Some(mapping));
        }
    }
}
