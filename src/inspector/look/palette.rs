//! The colours of integers and labels in pictures: exact, so that a number can be read off.
//!
//! Hues are Okabe and Ito's (2008), safe for the common kinds of colour blindness; the number
//! itself is always shown too, in the legend and on large texels.

use crate::picture::colors::{self, Rgb};
use egui::Color32;

/// Name, meaning and colour of a light's labels, by value: lit, shadow, background, faces away.
pub const LABELS: [LabelMeaning; 4] = [
    LabelMeaning { name: "lit", meaning: "the light reaches the surface", color: opaque(colors::LABELS[0]) },
    LabelMeaning { name: "shadow", meaning: "something lies between", color: opaque(colors::LABELS[1]) },
    LabelMeaning { name: "background", meaning: "no surface is here", color: opaque(colors::LABELS[2]) },
    LabelMeaning {
        name: "faces away",
        meaning: "the light is on the surface's other side",
        color: opaque(colors::LABELS[3]),
    },
];

/// Name, meaning and colour of a label in a light's mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelMeaning {
    /// A short name.
    pub name: &'static str,
    /// A sentence that explains it.
    pub meaning: &'static str,
    /// Its colour in pictures and legends.
    pub color: Color32,
}

/// Returns a colour of the palette for the window, opaque.
pub(super) const fn opaque([red, green, blue]: Rgb) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// Returns the colour of a stencil value: 0 dark, 1 to 7 distinct, then the same cycle again and again, each time
/// darker by a step; 255 (−1) downwards in reds, lighter further away.
pub fn stencil(value: u8) -> Color32 {
    opaque(colors::stencil(value))
}

/// Returns the colour of a label; a value that is not a label's is drawn as its stencil colour would be.
pub fn label(value: u8) -> Color32 {
    opaque(colors::label(value))
}

/// Returns the grey for a place between near (0) and far (1): near is light.
pub fn near_far(place: f32) -> Color32 {
    opaque(colors::near_far(place))
}

/// The colour where nothing was drawn: the depth buffer's clear value.
pub const NO_SURFACE: Color32 = opaque(colors::NOTHING);

/// The colour of a count that went up, or a surface that came nearer.
pub const UP: Color32 = Color32::from_rgb(0xe0, 0x70, 0x3a);

/// The colour of a count that went down, or a surface that went farther away.
pub const DOWN: Color32 = Color32::from_rgb(0x56, 0xb4, 0xe9);

/// Marks a pixel where a step drew a surface and nothing was drawn before.
pub const APPEARED: Color32 = Color32::from_rgb(0x2f, 0xb5, 0x8a);

/// The colour of a pixel without a surface where there was one before.
pub const WENT: Color32 = Color32::from_rgb(0xcc, 0x79, 0xa7);

/// The two colours of a bit: not set, set.
pub const BITS: [Color32; 2] = [Color32::from_rgb(0x1b, 0x2a, 0x3d), Color32::from_rgb(0xf0, 0xe4, 0x42)];

/// Returns the colour of the test results on a pixel's fragments, bits of [`crate::capture::TestCounts`]; see-through
/// without fragments.
pub fn outcome(outcomes: u8) -> Color32 {
    use crate::capture::TestCounts as Counts;
    match outcomes {
        0 => Color32::TRANSPARENT,
        Counts::PASSED => Color32::from_rgb(0x2f, 0xb5, 0x8a),
        Counts::DEPTH_FAILED => Color32::from_rgb(0xe0, 0x70, 0x3a),
        Counts::STENCIL_FAILED => Color32::from_rgb(0x96, 0x78, 0xdc),
        Counts::UNKNOWN => Color32::from_rgb(0x7b, 0x82, 0x90),
        // Distinguishable from the caps' yellow and the light's for every eye: see the test below.
        _ => Color32::from_rgb(0x8f, 0xf2, 0xff),
    }
}

/// Returns the colour for a byte of a picture of receivers: see-through for 0, a see-through blue on a receiver (1),
/// opaque blue on its outline (any other).
pub fn receiver(ink: u8) -> Color32 {
    let color = Color32::from_rgb(0x56, 0xb4, 0xe9);
    match ink {
        0 => Color32::TRANSPARENT,
        1 => color.gamma_multiply(0.22),
        _ => color,
    }
}

/// Returns the colour for the number of fragments at a pixel: dark for none, clearly lighter for one, then lighter with
/// the number's logarithm, up to white for 64 and more.
pub fn overdraw(fragments: u8) -> Color32 {
    const RAMP: [(u8, u8, u8); 6] = [
        (0x35, 0x55, 0x9c),
        (0x2a, 0x8c, 0xb0),
        (0x2f, 0xb5, 0x8a),
        (0xa4, 0xcf, 0x4a),
        (0xf5, 0xe9, 0x52),
        (0xff, 0xff, 0xff),
    ];
    if fragments == 0 {
        return stencil(0);
    }
    // From one to 64.
    let place = (f32::from(fragments).log2() / 6.0).min(1.0) * (RAMP.len() - 1) as f32;
    let index = (place as usize).min(RAMP.len() - 2);
    let [from, to] = [RAMP[index], RAMP[index + 1]].map(|(r, g, b)| Color32::from_rgb(r, g, b));
    from.lerp_to_gamma(to, place - index as f32)
}

/// Returns a dark or a light grey, whichever is read more easily on `background`; near the middle of the greys black or
/// white, as nothing else has enough contrast there.
pub fn ink_on(background: Color32) -> Color32 {
    let ground = luminance(background) + 0.05;
    // The grounds on which black and white are read alike.
    let [soft, full] = match ground * ground > 0.05 * 1.05 {
        true => [16, 0].map(Color32::from_gray),
        false => [225, 255].map(Color32::from_gray),
    };
    let ink = luminance(soft) + 0.05;
    if ink.max(ground) / ink.min(ground) >= LEAST_CONTRAST { soft } else { full }
}

/// Contrast from which on words can be read (WCAG 2.1, success criterion 1.4.3).
const LEAST_CONTRAST: f32 = 4.5;

/// Returns the relative luminance of a colour, from 0 for black to 1 for white (WCAG 2.1).
fn luminance(color: Color32) -> f32 {
    let [red, green, blue, _] = egui::Rgba::from(color).to_array();
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// Returns the colour of a count.
pub fn count(count: f32) -> Color32 {
    opaque(colors::count(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::TestCounts;
    use crate::inspector::look::theme;
    use crate::numbers::signed;
    use std::collections::BTreeSet;

    /// Linear sRGB as the common kinds of colour blindness see it (Machado, Oliveira and Fernandes 2009, severity
    /// 1): none, protanopia, deuteranopia, tritanopia.
    const EYES: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    fn times(matrix: [[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
    }

    /// How far apart two colours are for these eyes, in Oklab (Ottosson 2020); black and white are 1 apart.
    fn apart(eyes: [[f64; 3]; 3], a: Color32, b: Color32) -> f64 {
        let seen = |color: Color32| {
            let [red, green, blue, _] = color.to_array().map(|byte| {
                let share = f64::from(byte) / 255.0;
                if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
            });
            let cones = times(
                [
                    [0.412_221_47, 0.536_332_54, 0.051_445_99],
                    [0.211_903_5, 0.680_699_55, 0.107_396_96],
                    [0.088_302_46, 0.281_718_84, 0.629_978_7],
                ],
                times(eyes, [red, green, blue]).map(|share| share.clamp(0.0, 1.0)),
            );
            times(
                [
                    [0.210_454_26, 0.793_617_79, -0.004_072_05],
                    [1.977_998_5, -2.428_592_21, 0.450_593_71],
                    [0.025_904_04, 0.782_771_77, -0.808_675_77],
                ],
                cones.map(f64::cbrt),
            )
        };
        seen(a).iter().zip(seen(b)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn pixels_with_both_outcomes_are_reported_from_all_others_and_from_what_volumes_are_made_of_by_every_eye() {
        let both = outcome(TestCounts::PASSED | TestCounts::DEPTH_FAILED);
        let outcomes = [TestCounts::PASSED, TestCounts::DEPTH_FAILED, TestCounts::STENCIL_FAILED, TestCounts::UNKNOWN]
            .map(outcome);
        let of_theme = |theme: &theme::Theme| [theme.side, theme.light_cap, theme.dark_cap, theme.lit];
        let volumes = [&theme::DARK, &theme::LIGHT].map(of_theme);
        for other in outcomes.into_iter().chain(volumes.into_iter().flatten()).chain([receiver(2)]) {
            for (kind, eyes) in EYES.into_iter().enumerate() {
                // A difference that is seen at a glance, five times the smallest that can be seen.
                let found = apart(eyes, both, other);
                assert!(found >= 0.1, "{other:?}, eyes {kind}: {found:.3}");
            }
        }
        let black_and_white = apart(EYES[0], Color32::BLACK, Color32::WHITE);
        assert!((black_and_white - 1.0).abs() < 1e-3, "{black_and_white}");
    }

    #[test]
    fn how_often_a_pixel_was_drawn_is_seen_from_the_first_fragment_on() {
        for [few, more] in [[0, 1], [1, 2], [2, 4], [4, 8], [8, 16], [16, 64]] {
            let found = apart(EYES[0], overdraw(few), overdraw(more));
            assert!(found >= 0.1, "{few} and {more}: {found:.3}");
        }
    }

    #[test]
    fn one_up_and_two_up_are_distinguished_and_so_are_one_down_and_two_down() {
        use crate::inspector::look::coloring::count_color;
        for eyes in EYES {
            for [one, two] in [[1, 2], [-1, -2], [2, 3], [-2, -3]] {
                let found = apart(eyes, count_color(one), count_color(two));
                assert!(found >= 0.08, "{one} and {two}: {found:.3}");
            }
        }
    }

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

    #[test]
    fn small_counts_are_coloured_as_in_the_stencil() {
        for (number, value) in [(0.0, 0), (1.0, 1), (127.0, 127), (-1.0, 255), (-128.0, 128), (-999.0, 128)] {
            assert_eq!(count(number), stencil(value), "{number}");
        }
    }

    #[test]
    fn large_counts_go_on_in_the_cycle() {
        assert_eq!(count(128.0), stencil(121));
        assert!((1..1000_u16).all(|number| count(f32::from(number)) != count(f32::from(number) + 1.0)));
        assert!((128..1000_u16).all(|number| count(f32::from(number)) != stencil(0)));
    }

    #[test]
    fn what_eight_bits_take_for_zero_has_a_colour_of_its_own() {
        assert!([256.0, 512.0, -256.0, 25_600.0].into_iter().all(|number| count(number) == opaque(colors::READS_ZERO)));
        assert!((0..=255).all(|value| stencil(value) != opaque(colors::READS_ZERO)));
    }
}
