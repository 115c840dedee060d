//! Which pixels show a surface that the frame's own triangles have there: another picture's depth, or a draw that could
//! not be followed, may have put a nearer one in front of it.

use crate::capture::{Capture, Image, Origin, Snapshot, Step};
use crate::math::depth::DepthCurve;
use std::sync::Arc;

/// The depth that a picture stores once a light was drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredSurfaces {
    depth: Arc<Image>,
    curve: DepthCurve,
    /// The smallest difference of two depths of its format.
    step: f64,
}

impl StoredSurfaces {
    /// A distance may be off by this part of itself: vertices are in single precision, and so is the fitted curve.
    const SAME: f64 = 2e-3;
    /// How many steps of the format a depth may be off: rounding of the depth and of its slope.
    const STEPS: f64 = 4.0;

    /// Returns what another program's picture stores as the first draw asks for the count of the light with this index: it
    /// is what volumes were held against. For other lights what it stores after the last step of the light, else at the end;
    /// `None` for a frame of our own, of which all surfaces are known, or where no depth is.
    pub fn of(capture: &Capture, light: usize) -> Option<StoredSurfaces> {
        let Origin { depth_format, .. } = capture.origin.as_ref()?;
        let is_of_light = |step: &Step| step.light == Some(light) && matches!(step.snapshot, Snapshot::Frame(_));
        let counts = |step: &Step| is_of_light(step) && step.draws.iter().any(|draw| draw.part.is_of_volume());
        let first = capture.steps.iter().position(counts);
        let asks = |(index, step): (usize, &Step)| {
            first.is_some_and(|first| index > first) && is_of_light(step) && !counts(step)
        };
        let asking = capture.steps.iter().enumerate().position(asks);
        let counted = asking.and_then(|asking| asking.checked_sub(1));
        let last = counted.or_else(|| capture.steps.iter().rposition(is_of_light));
        let last = last.or(capture.steps.len().checked_sub(1))?;
        let depth = capture.frame_at(last)?.depth.image.clone();
        let bits = if depth_format == "D16" { 16 } else { 24 };
        Some(StoredSurfaces { depth, curve: capture.depth, step: f64::from(bits).exp2().recip() })
    }

    /// Returns for each pixel, row by row, whether its surface is one of those at `distances`: along the view's axis,
    /// one for each pixel, infinite where nothing is. At an edge a pixel may show what its neighbour does.
    ///
    /// # Panics
    /// If there are not as many distances as pixels.
    pub fn known(&self, distances: &[f64]) -> Vec<bool> {
        let [width, height] = self.depth.size().map(|side| side as usize);
        assert_eq!(distances.len(), width * height, "distances of a picture");
        let stored = self.depth.rows().flat_map(|row| row.chunks_exact(4)).map(bytemuck::pod_read_unaligned::<f32>);
        let is_known = |(index, stored): (usize, f32)| {
            let (x, y) = (index % width, index / width);
            let rows = y.saturating_sub(1)..height.min(y + 2);
            let around = rows.flat_map(|row| &distances[row * width..][x.saturating_sub(1)..width.min(x + 2)]);
            let (least, most) =
                around.fold((f64::INFINITY, 0.0_f64), |(least, most), one| (least.min(*one), most.max(*one)));
            let Some(distance) = self.curve.distance(stored) else { return most == f64::INFINITY };
            // What one step of depth is there.
            let off = StoredSurfaces::STEPS * self.step / self.slope(distance) + StoredSurfaces::SAME * distance;
            (least - off..=most + off).contains(&distance)
        };
        stored.enumerate().map(is_known).collect()
    }

    /// Returns by how much depth changes with distance, at a distance.
    fn slope(&self, distance: f64) -> f64 {
        let scale = self.curve.scale.abs();
        if self.curve.is_linear { scale } else { scale / (distance * distance) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::PixelFormat;
    use crate::math::depth::DepthMapping;

    #[test]
    fn a_nearer_surface_from_elsewhere_is_not_known_and_an_edge_is() {
        let curve = DepthMapping::StandardInfinite.curve(0.1, 0.0, 0.0);
        // In each row a wall at 5 metres, an edge at column 3, and the background.
        let distances: Vec<f64> = (0..8 * 3).map(|index| if index % 8 < 4 { 5.0 } else { f64::INFINITY }).collect();
        let known = |stored: &dyn Fn(usize) -> f32| {
            let bytes: Vec<u8> = (0..8 * 3).flat_map(|index| stored(index).to_le_bytes()).collect();
            let depth = Arc::new(Image::packed(PixelFormat::Depth32F, [8, 3], bytes));
            StoredSurfaces { depth, curve, step: 2_f64.powi(-24) }.known(&distances)
        };
        let depth = |distance: f64| curve.depth(distance) as f32;
        let own = |index: usize| if index % 8 < 4 { depth(5.0) } else { 1.0 };
        assert!(known(&own).iter().all(|known| *known));
        // The edge lies a pixel further on either side.
        assert!(known(&|index| if index % 8 < 5 { depth(5.0) } else { 1.0 }).iter().all(|known| *known));
        assert!(known(&|index| if index % 8 < 3 { depth(5.0) } else { 1.0 }).iter().all(|known| *known));
        // Something nearer stands before the wall, and something before the background.
        let found = known(&|index| match index {
            9 => depth(4.0),
            14 => depth(20.0),
            _ => own(index),
        });
        let unknown: Vec<usize> = (0..8 * 3).filter(|index| !found[*index]).collect();
        assert_eq!(unknown, [9, 14]);
    }
}
