//! What a rasteriser does with triangles, as far as specifications leave it open: measured by drawing, since no API says
//! it.

use crate::plan::ExactRange;
use serde::{Deserialize, Serialize};

/// How exactly an adapter draws, measured by drawing a few triangles (`gpu::probe`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AdapterProfile {
    /// Corners are moved to the nearest multiple of `2^-subpixel_bits` of a pixel; at most 9, as finer steps look the
    /// same. Vulkan's `subPixelPrecisionBits`.
    pub subpixel_bits: u32,
    /// How far the depths of ordinary triangles are off, in pixels of their slope.
    pub depth_error: f64,
    /// How far edges are off, in pixels, whose ends lie so many pixels outside of the picture, as in
    /// [`AdapterProfile::FAR`].
    pub far_edge_error: [f64; 4],
    /// How far depths are off, as a part of themselves, on a floor with corners behind the eye.
    pub behind_eye_error: f64,
    /// Whether a triangle with a corner at infinity (`w = 0` in clip space) covers what it should.
    pub draws_infinity: bool,
    /// Whether triangles have the same depths, to the bit, in two passes that draw them in different orders.
    pub repeats_depth: bool,
    /// The most pixels along a side of a picture.
    pub largest_picture: u32,
}

impl AdapterProfile {
    /// The distances from the picture, pixels, at which edges with far ends are measured.
    pub const FAR: [f64; 4] = [1e3, 1e5, 1e6, 1e7];
    /// What an edge with far ends may be off, pixels, beyond the grid's own half step.
    const EDGE_TOLERANCE: f64 = 1.0 / 64.0;
    /// What depths of ordinary triangles may be off, in pixels of their slope.
    const TILT_TOLERANCE: f64 = 1e-3;
    /// What depths with corners behind the eye may be off, as a part of themselves.
    const DEPTH_TOLERANCE: f64 = 1e-4;

    /// Returns the distance between the places that corners are moved to, pixels.
    pub fn subpixel(&self) -> f64 {
        0.5_f64.powi(self.subpixel_bits as i32)
    }

    /// Returns how far outside of the picture corners may lie, pixels, before edges are off by more than the grid
    /// explains.
    pub fn far_limit(&self) -> f64 {
        let most = self.subpixel() / 2.0 + AdapterProfile::EDGE_TOLERANCE;
        let measured = self.far_edge_error.iter().zip(AdapterProfile::FAR);
        measured.take_while(|(error, _)| **error <= most).map(|(_, far)| far).last().unwrap_or(0.0)
    }

    /// Returns which corners triangles may have to be drawn as exactly as within the picture.
    pub fn exact_range(&self) -> ExactRange {
        ExactRange {
            far: self.far_limit(),
            behind_eye: self.behind_eye_error <= AdapterProfile::DEPTH_TOLERANCE,
            infinity: self.draws_infinity,
            coarse_step: (self.depth_error > AdapterProfile::TILT_TOLERANCE).then(|| self.subpixel()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXACT: AdapterProfile = AdapterProfile {
        subpixel_bits: 8,
        depth_error: 1e-5,
        far_edge_error: [0.0, 0.004, 0.037, 0.39],
        behind_eye_error: 6e-6,
        draws_infinity: true,
        repeats_depth: true,
        largest_picture: 16384,
    };

    #[test]
    fn far_corners_are_drawn_as_long_as_edges_hold() {
        assert_eq!((EXACT.subpixel(), EXACT.far_limit()), (1.0 / 256.0, 1e5));
        let coarse = AdapterProfile { subpixel_bits: 4, far_edge_error: [0.018, 0.017, 0.042, 0.26], ..EXACT };
        assert_eq!((coarse.subpixel(), coarse.far_limit()), (1.0 / 16.0, 1e6));
        assert_eq!(AdapterProfile { far_edge_error: [1.0; 4], ..EXACT }.far_limit(), 0.0);
    }
}
