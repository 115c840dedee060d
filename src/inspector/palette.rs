//! The colours of exact values: stencil counts, labels and depth.
//!
//! Hues are Okabe and Ito's, safe for the common kinds of colour blindness. Counts cycle through
//! seven of them, darker by a step each turn; 255, 254, … are shown as −1, −2, … in reds.

use egui::Color32;

const COUNTS: [[u8; 3]; 8] = [
    [0x14, 0x17, 0x1d],
    [0x56, 0xb4, 0xe9],
    [0x00, 0x9e, 0x73],
    [0xf0, 0xe4, 0x42],
    [0xe6, 0x9f, 0x00],
    [0xd5, 0x5e, 0x00],
    [0xcc, 0x79, 0xa7],
    [0x96, 0x78, 0xdc],
];
const MINUS_ONE: [u8; 3] = [0xff, 0x59, 0x64];

/// The colour of a stencil value.
#[must_use]
pub fn stencil_color(value: u8) -> Color32 {
    let blend = |from: [u8; 3], to: [u8; 3], t: f32| {
        let mix = |a: u8, b: u8| (f32::from(a) + (f32::from(b) - f32::from(a)) * t).round() as u8;
        Color32::from_rgb(mix(from[0], to[0]), mix(from[1], to[1]), mix(from[2], to[2]))
    };
    match value {
        0 => blend(COUNTS[0], COUNTS[0], 0.0),
        1..=127 => {
            let turn = f32::from((value - 1) / 7);
            blend(COUNTS[usize::from((value - 1) % 7) + 1], COUNTS[0], 0.75 * turn / 18.0)
        }
        128..=255 => blend(MINUS_ONE, [0xff; 3], 0.8 * f32::from(255 - value) / 127.0),
    }
}

/// A stencil value as people read it: `3`, or `-1 (255)`.
#[must_use]
pub fn signed_stencil(value: u8) -> String {
    if value < 128 { value.to_string() } else { format!("{} ({value})", value as i8) }
}

/// The colour of a label of `techniques.md` section 2.
#[must_use]
pub fn label_color(label: u8) -> Color32 {
    match label {
        0 => Color32::from_rgb(0xf2, 0xd1, 0x6b),
        1 => Color32::from_rgb(0x46, 0x55, 0x7d),
        2 => Color32::from_rgb(0x14, 0x16, 0x1b),
        _ => Color32::from_rgb(0x2d, 0x32, 0x3d),
    }
}

/// What a label means.
#[must_use]
pub fn label_name(label: u8) -> &'static str {
    match label {
        0 => "lit",
        1 => "shadow",
        2 => "background",
        _ => "faces away",
    }
}

/// Black or white, whichever reads better on `color`.
pub(super) fn readable_on(color: Color32) -> Color32 {
    let [r, g, b, _] = color.to_array().map(f32::from);
    if 0.299 * r + 0.587 * g + 0.114 * b > 130.0 { Color32::BLACK } else { Color32::WHITE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_counts_differ_and_wrapped_ones_are_negative() {
        let colors: Vec<Color32> = (0..=20).map(stencil_color).collect();
        for pair in colors.windows(2) {
            assert_ne!(pair[0], pair[1]);
        }
        assert_ne!(stencil_color(1), stencil_color(8), "each turn is darker");
        assert_eq!(signed_stencil(255), "-1 (255)");
        assert_eq!(signed_stencil(127), "127");
        assert_eq!(stencil_color(255), Color32::from_rgb(0xff, 0x59, 0x64));
    }
}
