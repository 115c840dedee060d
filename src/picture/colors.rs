//! The colours of numbers, labels and findings: alike in the window and in the pictures of commands.
//!
//! Hues are Okabe and Ito's (2008), safe for the common kinds of colour blindness.

use crate::numbers;
use std::sync::LazyLock;

/// A colour in sRGB: red, green and blue bytes.
pub type Rgb = [u8; 3];

/// The colour of a stencil count of 0; also where nothing is drawn or compared.
pub const NOTHING: Rgb = [0x14, 0x17, 0x1d];
/// The colours of labels by value: lit, in shadow, background, faces away.
pub const LABELS: [Rgb; 4] = [[0xf2, 0xd1, 0x6b], [0x46, 0x55, 0x7d], NOTHING, [0x7b, 0x82, 0x90]];
/// The colour where truth and technique agree.
pub const AGREES: Rgb = [0x3c, 0x44, 0x54];
/// The colour of a pixel that is lit in truth and in shadow in the picture.
pub const FALSE_SHADOW: Rgb = [0xe6, 0x9f, 0x00];
/// The colour of a pixel that is in shadow in truth and lit in the picture.
pub const MISSING_SHADOW: Rgb = [0xcc, 0x79, 0xa7];
/// The colour of a pixel that shows another surface than the truth, or none.
pub const WRONG_SURFACE: Rgb = [0x56, 0xb4, 0xe9];
/// The colour of a difference at an edge, which is excused.
pub const EDGE_BAND: Rgb = [0x7b, 0x82, 0x90];
/// The colour of the background of pictures side by side.
pub const BACKGROUND: Rgb = [0x14, 0x16, 0x1b];

/// Colours of counts 1 to 7.
const STENCIL_CYCLE: [Rgb; 7] = [
    [0x56, 0xb4, 0xe9],
    [0x00, 0x9e, 0x73],
    [0xf0, 0xe4, 0x42],
    [0xe6, 0x9f, 0x00],
    [0xd5, 0x5e, 0x00],
    [0xcc, 0x79, 0xa7],
    [0x96, 0x78, 0xdc],
];
/// A count of −1, stored as 255.
const STENCIL_MINUS_ONE: Rgb = [0xff, 0x59, 0x64];
/// The colour that −128 ends at: counts further from 0 are lighter.
const STENCIL_MINUS_MOST: Rgb = [0xff, 0xe3, 0xe5];

/// Returns the colour of a stencil value: 0 dark, 1 to 7 distinct, then the same cycle darker by a step each time; 255
/// (−1) downwards in reds, lighter further away.
pub fn stencil(value: u8) -> Rgb {
    match value {
        0 => NOTHING,
        1..=127 => {
            let turn = f32::from((value - 1) / 7);
            // 18 cycles fit below 128; the last one has a third of the brightness.
            between(STENCIL_CYCLE[usize::from((value - 1) % 7)], [0; 3], turn * (2.0 / 3.0) / 18.0)
        }
        128..=255 => {
            // The first few, which are most often seen, are the farthest apart.
            let away = f32::from(255 - value);
            between(STENCIL_MINUS_ONE, STENCIL_MINUS_MOST, away / (away + 3.0) * (130.0 / 127.0))
        }
    }
}

/// Returns the colour of a label; any other value is drawn as its stencil colour would be.
pub fn label(value: u8) -> Rgb {
    LABELS.get(usize::from(value)).copied().unwrap_or_else(|| stencil(value))
}

/// Returns the colour of a finding's number, as in error pictures; any other value is drawn as its stencil colour would
/// be.
pub fn finding(value: u8) -> Rgb {
    [AGREES, FALSE_SHADOW, MISSING_SHADOW, WRONG_SURFACE, EDGE_BAND, NOTHING]
        .get(usize::from(value))
        .copied()
        .unwrap_or_else(|| stencil(value))
}

/// A count that is not zero, but a multiple of 256: eight bits would take it for zero.
pub const READS_ZERO: Rgb = [0xff, 0x2b, 0xf2];

/// Returns the grey of a share of light, 0 black to 1 white, encoded for the screen; shares beyond are clamped.
pub fn visibility(share: f32) -> Rgb {
    // A share is no light that a screen emits: half of it is drawn as half of the ramp's way.
    [(share.clamp(0.0, 1.0) * 255.0).round() as u8; 3]
}

/// Returns the colour of a count: that of the stencil's palette, whose last cycle is repeated beyond 127, except that a
/// count that eight bits would take for zero has a colour that nothing else has.
pub fn count(count: f32) -> Rgb {
    if numbers::reads_zero_in_eight_bits(count) {
        return READS_ZERO;
    }
    let whole = count.round() as i64;
    stencil(match whole {
        ..-128 => 128,
        // −1 is 255.
        -128..0 => (256 + whole) as u8,
        0..128 => whole as u8,
        // 121 is the first of the last cycle of seven.
        _ => (121 + (whole - 121) % 7) as u8,
    })
}

/// sRGB bytes of linear ones (IEC 61966-2-1).
static ENCODED: LazyLock<[u8; 256]> = LazyLock::new(|| {
    std::array::from_fn(|byte| {
        let linear = byte as f32 / 255.0;
        let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
});

/// Returns the screen colour of a share of light, given as linear bytes.
pub fn linear([red, green, blue]: Rgb) -> Rgb {
    [red, green, blue].map(|share| ENCODED[usize::from(share)])
}

/// Returns a grey for a place between near (0) and far (1): near is light.
pub fn near_far(place: f32) -> Rgb {
    [(238.0 - 196.0 * place.clamp(0.0, 1.0)) as u8; 3]
}

/// Returns a colour between `from` (share 0) and `to` (share 1), linear in the sRGB bytes and rounded.
pub fn between(from: Rgb, to: Rgb, share: f32) -> Rgb {
    std::array::from_fn(|channel| {
        let [from, to] = [from, to].map(|color| f32::from(color[channel]));
        (from + (to - from) * share + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_light_is_brighter_than_half_of_the_byte() {
        assert_eq!(linear([0, 255, 128]), [0, 255, 188]);
    }

    #[test]
    fn a_mixture_begins_and_ends_at_its_colours() {
        assert_eq!(between([0, 10, 255], [255, 20, 0], 0.0), [0, 10, 255]);
        assert_eq!(between([0, 10, 255], [255, 20, 0], 1.0), [255, 20, 0]);
        assert_eq!(between([0, 10, 255], [255, 20, 0], 0.5), [128, 15, 128]);
        assert_eq!(near_far(0.0), [238; 3]);
    }
}
