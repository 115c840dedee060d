//! The colours of integers and labels in pictures: exact, so that a number can be read off.
//!
//! Hues are Okabe and Ito's (2008), safe for the common kinds of colour blindness; the number
//! itself is always shown too, in the legend and on large texels.

pub use crate::numbers::signed;
use crate::picture::colors::{self, Rgb};
use egui::Color32;

/// Labels of `techniques.md` section 2, by value.
pub const LABELS: [Label; 4] = [
    Label { name: "lit", meaning: "the light reaches the surface", color: opaque(colors::LABELS[0]) },
    Label { name: "shadow", meaning: "something lies between", color: opaque(colors::LABELS[1]) },
    Label { name: "background", meaning: "no surface is here", color: opaque(colors::LABELS[2]) },
    Label { name: "faces away", meaning: "the light is on the surface's other side", color: opaque(colors::LABELS[3]) },
];

/// What a byte of a shadow mask means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Label {
    /// In words.
    pub name: &'static str,
    /// In more words.
    pub meaning: &'static str,
    /// In pictures and legends.
    pub color: Color32,
}

/// The same colour for the window.
pub(super) const fn opaque([red, green, blue]: Rgb) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// The colour of a stencil value: 0 dark, 1 to 7 distinct, then the same cycle darker by a step
/// each turn; 255 (−1) downwards in reds, lighter further away.
#[must_use]
pub fn stencil(value: u8) -> Color32 {
    opaque(colors::stencil(value))
}

/// The colour of a label; a value that is none is drawn as its stencil colour would be.
#[must_use]
pub fn label(value: u8) -> Color32 {
    opaque(colors::label(value))
}

/// Grey for a place between near (0) and far (1): near is light.
#[must_use]
pub fn near_far(place: f32) -> Color32 {
    opaque(colors::near_far(place))
}

/// A count that is not zero, but a multiple of 256: eight bits would take it for zero.
pub const READS_ZERO: Color32 = Color32::from_rgb(0xff, 0x2b, 0xf2);

/// Nothing was drawn here: the depth buffer's clear value.
pub const NO_SURFACE: Color32 = opaque(colors::NOTHING);

/// A count that went up, or a surface that came nearer.
pub const UP: Color32 = Color32::from_rgb(0xe0, 0x70, 0x3a);

/// A count that went down, or a surface that went farther away.
pub const DOWN: Color32 = Color32::from_rgb(0x56, 0xb4, 0xe9);

/// A surface where there was none.
pub const APPEARED: Color32 = Color32::from_rgb(0x2f, 0xb5, 0x8a);

/// No surface where there was one.
pub const WENT: Color32 = Color32::from_rgb(0xcc, 0x79, 0xa7);

/// The two inks of a bit: not set, set.
pub const BITS: [Color32; 2] = [Color32::from_rgb(0x1b, 0x2a, 0x3d), Color32::from_rgb(0xf0, 0xe4, 0x42)];

/// What becomes of a pixel's fragments, as bits of [`crate::capture::TestCounts`]; see-through where there are none.
#[must_use]
pub fn outcome(outcomes: u8) -> Color32 {
    use crate::capture::TestCounts as Counts;
    match outcomes {
        0 => Color32::TRANSPARENT,
        Counts::PASSED => Color32::from_rgb(0x2f, 0xb5, 0x8a),
        Counts::DEPTH_FAILED => Color32::from_rgb(0xe0, 0x70, 0x3a),
        Counts::STENCIL_FAILED => Color32::from_rgb(0x96, 0x78, 0xdc),
        Counts::UNKNOWN => Color32::from_rgb(0x7b, 0x82, 0x90),
        _ => Color32::from_rgb(0xf0, 0xe4, 0x42),
    }
}

/// The ink of a receiver: 1 on it, 2 at its outline; see-through elsewhere.
#[must_use]
pub fn receiver(ink: u8) -> Color32 {
    let color = Color32::from_rgb(0x56, 0xb4, 0xe9);
    match ink {
        0 => Color32::TRANSPARENT,
        1 => color.gamma_multiply(0.22),
        _ => color,
    }
}

/// How many fragments reached a pixel: dark for none, then lighter, twice as many a step.
#[must_use]
pub fn overdraw(fragments: u8) -> Color32 {
    const RAMP: [(u8, u8, u8); 6] = [
        (0x14, 0x17, 0x1d),
        (0x1f, 0x3a, 0x5f),
        (0x2a, 0x72, 0x9c),
        (0x1f, 0xae, 0x84),
        (0xf0, 0xe4, 0x42),
        (0xff, 0xff, 0xff),
    ];
    let place = (f32::from(fragments) + 1.0).log2() / 8.0 * (RAMP.len() - 1) as f32;
    let index = (place as usize).min(RAMP.len() - 2);
    let [from, to] = [RAMP[index], RAMP[index + 1]].map(|(r, g, b)| Color32::from_rgb(r, g, b));
    from.lerp_to_gamma(to, place - index as f32)
}

/// Black or white, whichever is read more easily on `background`.
#[must_use]
pub fn ink_on(background: Color32) -> Color32 {
    let [red, green, blue, _] = background.to_array().map(f32::from);
    let light = 0.299 * red + 0.587 * green + 0.114 * blue;
    if light > 128.0 { Color32::from_gray(16) } else { Color32::from_gray(225) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn small_counts_and_minus_one_have_the_colours_of_the_design() {
        assert_eq!(stencil(0), Color32::from_rgb(0x14, 0x17, 0x1d));
        assert_eq!(stencil(1), Color32::from_rgb(0x56, 0xb4, 0xe9));
        assert_eq!(stencil(7), Color32::from_rgb(0x96, 0x78, 0xdc));
        assert_eq!(stencil(255), Color32::from_rgb(0xff, 0x59, 0x64));
    }

    #[test]
    fn every_turn_of_the_cycle_is_darker_than_the_one_before() {
        let light = |value: u8| stencil(value).to_array()[..3].iter().map(|c| u32::from(*c)).sum::<u32>();
        assert!((1..=120).all(|value| light(value + 7) < light(value)));
    }

    #[test]
    fn neighbouring_values_differ() {
        let distinct: BTreeSet<[u8; 4]> = (0..=20).map(|value| stencil(value).to_array()).collect();
        assert_eq!(distinct.len(), 21);
        assert!((0..=126).all(|value| stencil(value) != stencil(value + 1)));
        assert_ne!(stencil(255), stencil(254));
    }

    #[test]
    fn values_from_128_on_read_as_negative() {
        assert_eq!(signed(127), "127");
        assert_eq!(signed(255), "−1 (255)");
        assert_eq!(signed(128), "−128 (128)");
    }
}
