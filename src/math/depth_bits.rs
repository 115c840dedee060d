//! Depths of fixed-point depth buffers: integers of a few bits.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How many bits a depth is floored to: 1 to 24. Floats, with which it is floored, hold no integer of more bits exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct DepthBits(u32);

/// A number of bits that depths can't be floored to.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("depths of {0} bits: they can be floored to 1 to 24")]
pub struct DepthBitsError(u32);

impl DepthBits {
    /// The bits of the smallest depth buffers that GPUs have.
    pub const SIXTEEN: DepthBits = DepthBits(16);
    /// The bits of the largest fixed-point depth buffers that GPUs have.
    pub const TWENTY_FOUR: DepthBits = DepthBits(24);
    /// So few bits that the steps between depths are easily seen.
    pub const EIGHT: DepthBits = DepthBits(8);

    /// Returns the largest integer of so many bits, 2^bits − 1: depth 1 is stored as it.
    pub const fn steps(self) -> u32 {
        (1 << self.0) - 1
    }

    /// Returns a depth as fixed-point depth buffers are defined, ⌊s z⌋ / s with s = 2^bits − 1, z clamped to 0 to 1.
    /// `floored` in `depth_steps.wgsl` does the same steps.
    pub fn floored(self, depth: f32) -> f32 {
        let depth = depth.clamp(0.0, 1.0);
        // steps * depth would round: the same is 2^bits * depth, which is exact, less depth.
        let scaled = depth * (self.steps() + 1) as f32;
        let below = scaled.floor();
        let whole = below - if scaled - below < depth { 1.0 } else { 0.0 };
        self.quotient(whole as u32)
    }

    /// Returns whole / s, rounded to the nearest float by integers alone: GPUs round divisions otherwise, and may reorder
    /// sums. In binary it repeats the bits of `whole` for ever, so its mantissa is 24 of them from the first 1 on, and one more
    /// rounds: it is no tie, as a 1 follows somewhere.
    fn quotient(self, whole: u32) -> f32 {
        if whole == 0 {
            return 0.0;
        }
        let (mut width, mut period) = (self.0, whole);
        // Two short periods are one of twice as many bits.
        while width < 16 {
            period |= period << width;
            width *= 2;
        }
        let zeros = period.leading_zeros() + width - 32;
        let all = (1 << width) - 1;
        let from_first = (period << zeros | period >> (width - zeros)) & all;
        let bits = from_first << (32 - width) | from_first >> (2 * width - 32);
        let mantissa = (bits >> 8) + (bits >> 7 & 1);
        mantissa as f32 * f32::from_bits((103 - zeros) << 23)
    }

    /// Returns the depth that is stored for `depth` and the next larger one, as fractions of depth 1; for the largest, which
    /// has none above it, the one before.
    pub fn step_at(self, depth: f64) -> [f64; 2] {
        let steps = f64::from(self.steps());
        // A depth that is stored already is that one, though rounded to a float it may lie just below.
        let nearest = (depth * steps).round();
        let is_stored = (nearest / steps) as f32 == depth as f32;
        let stored = if is_stored { nearest } else { (depth * steps).floor() }.clamp(0.0, steps);
        let next = if stored < steps { stored + 1.0 } else { stored - 1.0 };
        [stored / steps, next / steps]
    }
}

impl TryFrom<u32> for DepthBits {
    type Error = DepthBitsError;

    fn try_from(bits: u32) -> Result<DepthBits, DepthBitsError> {
        if (1..=24).contains(&bits) { Ok(DepthBits(bits)) } else { Err(DepthBitsError(bits)) }
    }
}

impl From<DepthBits> for u32 {
    fn from(bits: DepthBits) -> u32 {
        bits.0
    }
}

impl fmt::Display for DepthBits {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_stored_is_its_own_step() {
        for bits in [DepthBits::EIGHT, DepthBits::SIXTEEN, DepthBits(23), DepthBits::TWENTY_FOUR] {
            let last = bits.steps();
            for whole in (0..=last).step_by((last as usize / 70_000).max(1)).chain([last]) {
                let stored = bits.quotient(whole);
                let [own, next] = bits.step_at(f64::from(stored));
                assert_eq!(own as f32, stored, "{whole} of {bits} bits");
                assert!((next - own).abs() * f64::from(last) > 0.999, "{whole} of {bits} bits: {own}, {next}");
            }
        }
        assert_eq!(DepthBits::EIGHT.step_at(0.999_999), [254.0 / 255.0, 1.0]);
    }

    #[test]
    fn a_step_is_measured_downwards_at_the_end_of_the_range() {
        for bits in (1..=24).map(|bits| DepthBits::try_from(bits).expect("bits")) {
            let steps = f64::from(bits.steps());
            assert_eq!(bits.step_at(1.0), [1.0, (steps - 1.0) / steps]);
            assert_eq!(bits.step_at(0.0), [0.0, 1.0 / steps]);
            for depth in [0.0, 0.1, 0.5, 0.999, 1.0, 1.5] {
                let [stored, next] = bits.step_at(depth);
                assert!((stored - depth.min(1.0)).abs() <= 1.0 / steps, "{bits} bits, {depth}");
                assert!(((next - stored).abs() * steps - 1.0).abs() < 1e-6 && (0.0..=1.0).contains(&next));
            }
        }
    }

    /// In `f64` a quotient has 53 bits, so that its rounding to 24 is that of the exact one.
    #[test]
    fn a_floored_depth_is_the_nearest_float_to_its_integer_s_share() {
        for bits in (1..=24).map(|bits| DepthBits::try_from(bits).expect("bits")) {
            let steps = bits.steps();
            for whole in (0..=steps).step_by((steps / 5000).max(1) as usize).chain([steps - 1, steps]) {
                let expected = (f64::from(whole) / f64::from(steps)) as f32;
                assert_eq!(bits.quotient(whole), expected, "{whole} of {bits} bits");
            }
        }
    }

    #[test]
    fn no_other_number_of_bits_is_read() {
        for wrong in [0, 25, 31, 32, 64, u32::MAX] {
            let error = serde_json::from_str::<DepthBits>(&wrong.to_string()).expect_err("refused");
            assert!(error.to_string().contains(&format!("depths of {wrong} bits")), "{error}");
        }
        assert_eq!(serde_json::from_str::<DepthBits>("16").ok(), Some(DepthBits::SIXTEEN));
    }
}
