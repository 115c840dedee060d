//! What a stored depth means: the distance it stands for, and how finely.
//!
//! Depth is reversed everywhere: 1 at the near plane, 0 where nothing was drawn. The camera's is
//! `near / distance`; a shadow map's follows from the matrix that drew it.

use super::palette;
use crate::capture::{Capture, CapturedMap, Image};
use egui::Color32;
use glam::DMat4;

/// How a stored depth is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DepthMeasure {
    /// As stored.
    Raw,
    /// Metres along the view axis: `scale / (depth − offset)`; infinite at the clear value.
    Perspective {
        /// The near plane's distance, where `offset` is 0.
        scale: f64,
        /// What infinity is stored as.
        offset: f64,
    },
    /// Metres behind the near plane of a parallel view: `(1 − depth) · length`.
    Parallel {
        /// From the near to the far plane, metres.
        length: f64,
    },
}

/// A measure with the range that the grey ramp covers, near (or small) first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthScale {
    /// What is shown.
    pub measure: DepthMeasure,
    /// Both ends in the measure's unit, `low ≤ high`.
    pub range: [f64; 2],
}

impl DepthMeasure {
    /// Of the camera's depth buffer; `None` for a depth mapping that is not known.
    #[must_use]
    pub fn of_camera(capture: &Capture) -> Option<DepthMeasure> {
        let mapping = capture.settings.get("depth").map_or("reversed-infinite", String::as_str);
        (mapping == "reversed-infinite")
            .then_some(DepthMeasure::Perspective { scale: capture.camera.near, offset: 0.0 })
    }

    /// Of a face of a shadow map; `None` where its matrix tells no distance.
    #[must_use]
    pub fn of_map(map: &CapturedMap, face: usize) -> Option<DepthMeasure> {
        DepthMeasure::of_matrix(*map.clip_from_light.get(face)?)
    }

    fn of_matrix(clip_from_light: DMat4) -> Option<DepthMeasure> {
        let depth_row = clip_from_light.row(2);
        let distance_row = clip_from_light.row(3);
        let axis = distance_row.truncate();
        let measure = if axis.length_squared() > 0.0 {
            // depth = (k·w + t) / w for a row that is k times the distance's row plus t.
            let along = depth_row.truncate().dot(axis) / axis.length_squared();
            DepthMeasure::Perspective { scale: depth_row.w / axis.length(), offset: along }
        } else {
            DepthMeasure::Parallel { length: 1.0 / depth_row.truncate().length() }
        };
        measure.is_usable().then_some(measure)
    }

    fn is_usable(self) -> bool {
        match self {
            DepthMeasure::Raw => true,
            DepthMeasure::Perspective { scale, offset } => scale.is_finite() && offset.is_finite(),
            DepthMeasure::Parallel { length } => length.is_finite(),
        }
    }

    /// What `depth` stands for; `None` where nothing was drawn and the measure is a distance.
    #[must_use]
    pub fn value(self, depth: f32) -> Option<f64> {
        let stored = f64::from(depth);
        match self {
            DepthMeasure::Raw => Some(stored),
            _ if depth == 0.0 => None,
            DepthMeasure::Perspective { scale, offset } => Some(scale / (stored - offset)),
            DepthMeasure::Parallel { length } => Some((1.0 - stored) * length),
        }
    }

    /// How much one step of the stored `f32` is worth at `depth`, in metres.
    #[must_use]
    pub fn step_at(self, depth: f32) -> Option<f64> {
        let here = self.value(depth)?;
        // The next larger stored value is the next nearer distance.
        let next = self.value(depth.next_up())?;
        Some((next - here).abs())
    }

    /// The smallest and largest value in `image`; `None` where there is none.
    #[must_use]
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
    /// The grey of a stored depth: near is light.
    #[must_use]
    pub fn color(self, depth: f32) -> Color32 {
        let Some(value) = self.measure.value(depth) else { return palette::NO_SURFACE };
        let [low, high] = self.range;
        let place = if high > low { ((value - low) / (high - low)) as f32 } else { 0.0 };
        // A large stored depth is near, a large distance is far.
        palette::near_far(if self.measure == DepthMeasure::Raw { 1.0 - place } else { place })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::projection::{reversed_infinite, reversed_orthographic};

    #[test]
    fn a_perspective_maps_measure_follows_from_its_matrix() {
        let measure = DepthMeasure::of_matrix(reversed_infinite(60.0, 1.0, 0.5)).unwrap();
        assert_eq!(measure.value(1.0), Some(0.5));
        assert_eq!(measure.value(0.25), Some(2.0));
        assert_eq!(measure.value(0.0), None);
    }

    #[test]
    fn a_parallel_maps_measure_starts_at_its_near_plane() {
        let measure = DepthMeasure::of_matrix(reversed_orthographic([1.0, 1.0], 2.0, 10.0)).unwrap();
        assert_eq!(measure, DepthMeasure::Parallel { length: 8.0 });
        assert_eq!(measure.value(1.0), Some(0.0));
        assert_eq!(measure.value(0.5), Some(4.0));
    }

    #[test]
    fn a_step_is_the_distance_to_the_next_stored_value() {
        let measure = DepthMeasure::Perspective { scale: 0.1, offset: 0.0 };
        let depth = 0.01_f32;
        let expected = 0.1 / f64::from(depth) - 0.1 / f64::from(depth.next_up());
        assert_eq!(measure.step_at(depth), Some(expected));
        assert_eq!(measure.step_at(0.0), None);
    }

    #[test]
    fn the_range_leaves_out_what_was_not_drawn() {
        let texels: Vec<u8> = [0.0_f32, 0.5, 0.25, 1.0].iter().flat_map(|d| d.to_le_bytes()).collect();
        let image = Image::packed(crate::capture::PixelFormat::Depth32F, [2, 2], texels);
        let measure = DepthMeasure::Perspective { scale: 1.0, offset: 0.0 };
        assert_eq!(measure.range_of(&image), Some([1.0, 4.0]));
        assert_eq!(DepthMeasure::Raw.range_of(&image), Some([0.0, 1.0]));
    }
}
