//! Counts of shadow volumes that are stored as floats: signed, and without the limits of eight bits.

use crate::capture::{Capture, FrameTarget, Image, Snapshot};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The number of texels for each count, which is rounded to an integer; counts without texels are not there.
pub type Tally = BTreeMap<i64, u64>;

/// Returns the value that an eight-bit stencil would store for a float count: the count modulo 256.
pub fn in_eight_bits(count: f32) -> u8 {
    (count.round() as i64).rem_euclid(256) as u8
}

/// Returns how many texels of a picture of float counts have each count, rounded to whole numbers; counts that no texel
/// has are not there.
pub fn tally(image: &Image) -> Tally {
    let mut tally = Tally::new();
    // Neighbouring texels mostly agree, so the map is looked up once for a run of them.
    let (mut run, mut length) = (0, 0);
    for texel in image.rows().flat_map(|row| row.chunks_exact(4)) {
        let count = bytemuck::pod_read_unaligned::<f32>(texel).round() as i64;
        if count != run {
            *tally.entry(run).or_default() += length;
            (run, length) = (count, 0);
        }
        length += 1;
    }
    *tally.entry(run).or_default() += length;
    tally.retain(|_, texels| *texels > 0);
    tally
}

/// Returns the index of the light whose float counts the step finishes (its last counting pass), and those counts;
/// `None` for other steps, as counts in between are not captured.
pub fn finished_by(capture: &Capture, index: usize) -> Option<(usize, &Arc<Image>)> {
    let light = capture.steps.get(index).filter(|step| counts(step))?.light?;
    let is_last = !capture.steps[index + 1..].iter().any(|step| counts(step) && step.light == Some(light));
    capture.lights.get(light)?.count.as_ref().filter(|_| is_last).map(|count| (light, count))
}

fn counts(step: &crate::capture::Step) -> bool {
    matches!(&step.snapshot, Snapshot::Frame(frame) if frame.target == FrameTarget::Count)
}

/// Returns the light, and its float counts, that a step up to this one finished last; `None` if there is none.
pub fn known_after(capture: &Capture, index: usize) -> Option<(usize, &Arc<Image>)> {
    (0..=index).rev().find_map(|earlier| finished_by(capture, earlier))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::reads_zero_in_eight_bits;

    #[test]
    fn what_eight_bits_take_for_zero_stands_out() {
        for count in [256.0, 512.0, -256.0, 25_600.0] {
            assert!(reads_zero_in_eight_bits(count));
        }
        assert!(![0.0, 1.0, 255.0, -128.0].into_iter().any(reads_zero_in_eight_bits));
        assert_eq!((in_eight_bits(257.0), in_eight_bits(-1.0)), (1, 255));
    }
}
