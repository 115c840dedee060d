//! What a stored depth means: the distance it stands for, and how finely.
//!
//! The camera's is in the capture; a shadow map's follows from the matrix that drew it.

use crate::capture::{Capture, Image};
use crate::math::DepthBits;
use crate::math::depth::DepthCurve;
use glam::DMat4;

/// How a stored depth is converted for display: as it is, or to metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DepthMeasure {
    /// The stored value.
    Raw,
    /// Metres along the view axis: `scale / (depth − offset)`.
    Perspective {
        /// Scale, metres; 0 where depths stand for no distance.
        scale: f64,
        /// The depth that infinity is stored as.
        offset: f64,
        /// The depth that is stored where nothing was drawn.
        clear: f32,
    },
    /// Metres of a parallel projection: `(depth − near) · length`, from a map's near plane or along the camera's axis.
    Parallel {
        /// The stored depth of a map's near plane; for a camera, the depth that the eye would have.
        near: f64,
        /// From depth 0 to depth 1, metres; negative where depth is reversed.
        length: f64,
        /// The depth that is stored where nothing was drawn.
        clear: f32,
    },
}

/// Bits of the fixed-point depth buffer that is compared with `f32`.
pub const FIXED_BITS: DepthBits = DepthBits::TWENTY_FOUR;

/// A depth measure with the range that the grey ramp covers, low end first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthScale {
    /// The measure.
    pub measure: DepthMeasure,
    /// Both ends in the measure's unit, `low ≤ high`.
    pub range: [f64; 2],
}

impl DepthMeasure {
    /// Returns the measure that converts the camera's stored depths to metres along the view axis (or to the capture's
    /// own unit), for a perspective or a parallel camera; a scale of 0 where all depths are stored as one.
    pub fn of_camera(capture: &Capture) -> DepthMeasure {
        let DepthCurve { mapping, offset, scale, is_linear, .. } = capture.depth;
        let clear = mapping.clear_depth();
        match is_linear {
            true if capture.depth.tells_distances() => {
                DepthMeasure::Parallel { near: offset, length: 1.0 / scale, clear }
            }
            // With a scale of 0 no value is a distance.
            _ => DepthMeasure::Perspective { scale, offset, clear },
        }
    }

    /// Returns the measure of a face of a light's shadow map; `None` where there is no map, or its matrix gives no
    /// distance. Of another program's map the unit is not known: there are depths alone.
    pub fn of_map(capture: &Capture, light: usize, face: usize) -> Option<DepthMeasure> {
        let map = capture.lights.get(light)?.map.as_ref().filter(|_| capture.origin.is_none())?;
        DepthMeasure::of_matrix(*map.clip_from_light.get(face)?, capture.depth.mapping.clear_depth())
    }

    fn of_matrix(clip_from_light: DMat4, clear: f32) -> Option<DepthMeasure> {
        let depth_row = clip_from_light.row(2);
        let distance_row = clip_from_light.row(3);
        let axis = distance_row.truncate();
        let measure = if axis.length_squared() > 0.0 {
            // depth = (k·w + t) / w for a row that is k times the distance's row plus t.
            let along = depth_row.truncate().dot(axis) / axis.length_squared();
            DepthMeasure::Perspective { scale: depth_row.w / axis.length(), offset: along, clear }
        } else {
            let size = 1.0 / depth_row.truncate().length();
            let near = 1.0 - f64::from(clear);
            DepthMeasure::Parallel { near, length: if near > 0.5 { -size } else { size }, clear }
        };
        measure.is_usable().then_some(measure)
    }

    fn is_usable(self) -> bool {
        match self {
            DepthMeasure::Raw => true,
            DepthMeasure::Perspective { scale, offset, .. } => scale.is_finite() && offset.is_finite(),
            DepthMeasure::Parallel { length, .. } => length.is_finite(),
        }
    }

    /// Returns the value of a stored depth in the measure's unit; `None` where the measure is in metres, and the depth is the
    /// clear value or stands for no distance.
    pub fn value(self, depth: f32) -> Option<f64> {
        let stored = f64::from(depth);
        match self {
            DepthMeasure::Raw => Some(stored),
            DepthMeasure::Perspective { clear, .. } | DepthMeasure::Parallel { clear, .. } if depth == clear => None,
            DepthMeasure::Perspective { scale: 0.0, .. } => None,
            DepthMeasure::Perspective { scale, offset, .. } => Some(scale / (stored - offset)),
            DepthMeasure::Parallel { near, length, .. } => Some((stored - near) * length),
        }
    }

    /// Returns the distance from a stored `f32` depth to the next larger one that can be stored, in metres (raw depth:
    /// in depth), as a positive number; `None` where nothing was drawn.
    pub fn step_at(self, depth: f32) -> Option<f64> {
        // Towards 0 floats are finer, so the coarser neighbour is the one above.
        self.between(f64::from(depth), f64::from(depth.next_up()), depth)
    }

    /// Returns the distance from a stored depth to the next one of a fixed-point buffer of so many bits,
    /// which stores `floor((2^bits − 1) · depth)`, in metres (raw depth: in depth); from the last step, to the one
    /// before. `None` where nothing was drawn.
    pub fn fixed_step_at(self, depth: f32, bits: DepthBits) -> Option<f64> {
        let [stored, next] = bits.step_at(f64::from(depth));
        self.between(stored, next, depth)
    }

    /// Returns the distance between two stored depths in the measure's unit; `None` where `depth` says that nothing was
    /// drawn.
    fn between(self, one: f64, other: f64, depth: f32) -> Option<f64> {
        self.value(depth)?;
        Some(match self {
            DepthMeasure::Raw => (other - one).abs(),
            DepthMeasure::Perspective { scale, offset, .. } => {
                (scale / (other - offset) - scale / (one - offset)).abs()
            }
            DepthMeasure::Parallel { length, .. } => ((other - one) * length).abs(),
        })
    }

    /// Returns the smallest and the largest finite value of the depths in `image`, in the measure's unit; `None` where
    /// there is none.
    pub fn range_of(self, image: &Image) -> Option<[f64; 2]> {
        let mut range: Option<[f64; 2]> = None;
        for row in image.rows() {
            for texel in row.chunks_exact(4) {
                let value = self.value(bytemuck::pod_read_unaligned(texel)).filter(|value| value.is_finite());
                if let Some(value) = value {
                    let [low, high] = range.unwrap_or([value, value]);
                    range = Some([low.min(value), high.max(value)]);
                }
            }
        }
        range
    }
}

impl DepthScale {
    /// Returns where a stored depth lies in the range, from near (0) to far (1); `None` where nothing was drawn.
    pub fn place(self, depth: f32) -> Option<f32> {
        let value = self.measure.value(depth)?;
        let [low, high] = self.range;
        let place = if high > low { ((value - low) / (high - low)) as f32 } else { 0.0 };
        // A large stored depth is near, a large distance is far.
        Some(if self.measure == DepthMeasure::Raw { 1.0 - place } else { place })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::depth::DepthMapping;
    use crate::math::projection::{orthographic, perspective};

    #[test]
    fn a_perspective_maps_measure_follows_from_its_matrix() {
        let measure =
            DepthMeasure::of_matrix(perspective(60.0, 1.0, &DepthMapping::ReversedInfinite.curve(0.5, 0.0, 0.0)), 0.0)
                .unwrap();
        assert_eq!(measure.value(1.0), Some(0.5));
        assert_eq!(measure.value(0.25), Some(2.0));
        assert_eq!(measure.value(0.0), None);
    }

    #[test]
    fn a_parallel_maps_measure_starts_at_its_near_plane() {
        let measure = DepthMeasure::of_matrix(orthographic([1.0, 1.0], 2.0, 10.0, true), 0.0).unwrap();
        assert_eq!(measure, DepthMeasure::Parallel { near: 1.0, length: -8.0, clear: 0.0 });
        assert_eq!(measure.value(1.0), Some(0.0));
        assert_eq!(measure.value(0.5), Some(4.0));
        let standard = DepthMeasure::of_matrix(orthographic([1.0, 1.0], 2.0, 10.0, false), 1.0).unwrap();
        assert_eq!(standard.value(0.25), Some(2.0));
        assert_eq!(standard.value(1.0), None);
    }

    /// Standard depth is coarse far off; a fixed-point buffer is coarser than `f32` near 0 only.
    #[test]
    fn steps_of_standard_depth_grow_with_the_square_of_distance() {
        let curve = DepthMapping::StandardInfinite.curve(0.1, 0.0, 0.0);
        let measure = DepthMeasure::Perspective { scale: curve.scale, offset: curve.offset, clear: 1.0 };
        let step = |distance: f64| measure.fixed_step_at(curve.depth(distance) as f32, FIXED_BITS).unwrap();
        let expected = |distance: f64| distance * distance / 0.1 / f64::from(FIXED_BITS.steps());
        for distance in [1.0, 10.0, 100.0] {
            assert!((step(distance) / expected(distance) - 1.0).abs() < 0.01, "{distance}: {}", step(distance));
        }
        assert_eq!(measure.fixed_step_at(1.0, FIXED_BITS), None);
    }

    #[test]
    fn a_step_is_the_distance_to_the_next_stored_value() {
        let measure = DepthMeasure::Perspective { scale: 0.1, offset: 0.0, clear: 0.0 };
        let depth = 0.01_f32;
        let expected = 0.1 / f64::from(depth) - 0.1 / f64::from(depth.next_up());
        assert_eq!(measure.step_at(depth), Some(expected));
        assert_eq!(measure.step_at(0.0), None);
    }

    #[test]
    fn the_range_leaves_out_what_was_not_drawn() {
        let texels: Vec<u8> = [0.0_f32, 0.5, 0.25, 1.0].iter().flat_map(|d| d.to_le_bytes()).collect();
        let image = Image::packed(crate::capture::PixelFormat::Depth32F, [2, 2], texels);
        let measure = DepthMeasure::Perspective { scale: 1.0, offset: 0.0, clear: 0.0 };
        assert_eq!(measure.range_of(&image), Some([1.0, 4.0]));
        assert_eq!(DepthMeasure::Raw.range_of(&image), Some([0.0, 1.0]));
    }
}
