//! The error picture: colours, hatching and words of findings, and the picture made small without
//! losing a wrong pixel.
//!
//! Hatching is part of the texels, so that it is as fine as they are at any zoom. Only what lies
//! inside a region is hatched: its rim, and so every pixel on its own, has its full colour.

use crate::accuracy::{ErrorCounts, Finding, WrongRegion};
use crate::capture::Image;
use crate::inspector::look::palette;
use crate::picture::colors;
use crate::reading::format::count;
use egui::{Color32, ColorImage};

/// A finding's colour, hatching and words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FindingStyle {
    /// Its name in legends.
    pub name: &'static str,
    /// Its meaning at a pixel, in a sentence.
    pub meaning: &'static str,
    /// Its colour.
    pub color: Color32,
    /// The hatching, which distinguishes it besides the colour.
    pub pattern: FindingPattern,
}

/// The hatching over a finding's colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FindingPattern {
    /// No hatching.
    Plain,
    /// ╱
    Rising,
    /// ╲
    Falling,
    /// ╳
    Crossed,
    /// ·
    Dotted,
}

/// Returns a finding's colour, hatching and words.
pub fn style(finding: Finding) -> FindingStyle {
    let (name, meaning, color, pattern) = match finding {
        Finding::Agrees => ("agrees", "Truth and technique agree.", colors::AGREES, FindingPattern::Plain),
        Finding::FalseShadow => (
            "false shadow",
            "False shadow: dark here, but the light reaches it.",
            colors::FALSE_SHADOW,
            FindingPattern::Rising,
        ),
        Finding::MissingShadow => (
            "missing shadow",
            "Missing shadow: lit here, but something lies between.",
            colors::MISSING_SHADOW,
            FindingPattern::Falling,
        ),
        Finding::WrongSurface => (
            "wrong surface",
            "Another surface than the truth's is seen here, or none.",
            colors::WRONG_SURFACE,
            FindingPattern::Crossed,
        ),
        Finding::EdgeBand => (
            "edge, excused",
            "They differ, but the truth changes within this pixel: excused.",
            colors::EDGE_BAND,
            FindingPattern::Dotted,
        ),
        Finding::NotCompared => (
            "not compared",
            "Not compared: here the truth is background, or faces away from the light.",
            colors::NOTHING,
            FindingPattern::Plain,
        ),
    };
    FindingStyle { name, meaning, color: palette::opaque(color), pattern }
}

/// How much darker a line of the hatching is than the colour: 1 is black.
const LINE_DARKNESS: f32 = 0.5;
/// Texels from one line of the hatching to the next.
const LINE_SPACING: usize = 5;

impl FindingPattern {
    /// Returns whether a line or dot of the hatching goes through the texel at `x`, `y`.
    fn has_line(self, x: usize, y: usize) -> bool {
        let rising = (x + y).is_multiple_of(LINE_SPACING);
        // x − y, with x raised by a multiple of the spacing so that it stays positive.
        let falling = (x + y * (LINE_SPACING - 1)).is_multiple_of(LINE_SPACING);
        match self {
            FindingPattern::Plain => false,
            FindingPattern::Rising => rising,
            FindingPattern::Falling => falling,
            FindingPattern::Crossed => rising || falling,
            FindingPattern::Dotted => (x + y) % 2 == 1,
        }
    }
}

/// Returns the colour of a finding's number, without hatching; a number that is not a finding's is drawn as its stencil
/// colour would be.
pub fn color(byte: u8) -> Color32 {
    Finding::from_byte(byte).map_or_else(|| palette::stencil(byte), |finding| style(finding).color)
}

/// Returns the rank of a finding's byte among several in one block, the highest is shown: false shadow, missing shadow,
/// wrong surface, edge band, agreement; 0 for what is not compared or is no finding.
fn weight(byte: u8) -> u8 {
    match Finding::from_byte(byte) {
        Some(Finding::FalseShadow) => 5,
        Some(Finding::MissingShadow) => 4,
        Some(Finding::WrongSurface) => 3,
        Some(Finding::EdgeBand) => 2,
        Some(Finding::Agrees) => 1,
        Some(Finding::NotCompared) | None => 0,
    }
}

/// Returns the picture of findings, hatched, in which each block of `block` × `block` texels is one texel: its worst
/// finding. Size is rounded up; a block of 0 counts as 1. Lines are not drawn at the border of an area, except dots of
/// the edge band.
pub fn colored(image: &Image, block: usize) -> ColorImage {
    let block = block.max(1);
    let [width, height] = image.size().map(|side| (side as usize).div_ceil(block));
    let mut worst = vec![Finding::NotCompared as u8; width * height];
    for (y, row) in image.rows().enumerate() {
        let line = &mut worst[y / block * width..][..width];
        for (x, byte) in row.iter().enumerate() {
            let cell = &mut line[x / block];
            if weight(*byte) > weight(*cell) {
                *cell = *byte;
            }
        }
    }
    let at = |x: usize, y: usize| worst[y * width + x];
    let is_inside = |x: usize, y: usize| {
        let near = |v: usize, side: usize| v.saturating_sub(1)..=(v + 1).min(side - 1);
        near(y, height).all(|row| near(x, width).all(|column| at(column, row) == at(x, y)))
    };
    let texel = |x: usize, y: usize| {
        let Some(finding) = Finding::from_byte(at(x, y)) else { return color(at(x, y)) };
        let style = style(finding);
        // An edge band is a line of pixels: it has no inside, and is dotted all along.
        let is_line = style.pattern.has_line(x, y) && (style.pattern == FindingPattern::Dotted || is_inside(x, y));
        if is_line { style.color.lerp_to_gamma(Color32::BLACK, LINE_DARKNESS) } else { style.color }
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y));
    ColorImage::new([width, height], pixels.collect())
}

/// Describes in a sentence how many compared pixels are wrong for one light, by kind, or that none is and how many are
/// excused. The largest region, `worst`, is named only where more than one pixel is wrong.
pub fn sentence(error: &ErrorCounts, worst: Option<&WrongRegion>) -> String {
    let compared = count(error.compared);
    if error.compared == 0 {
        return "Nothing was compared: in truth no surface faces the light.".to_owned();
    }
    let wrong = error.wrong();
    if wrong == 0 {
        let excused = match error.edge_band {
            0 => String::new(),
            1 => "; 1 at an edge is excused".to_owned(),
            edges => format!("; {} at edges are excused", count(edges)),
        };
        return format!("No pixel of {compared} is wrong{excused}.");
    }
    let kinds = [
        (error.false_shadow, "false shadow"),
        (error.missing_shadow, "missing"),
        (error.wrong_surface, "of another surface"),
    ];
    let kinds = kinds.into_iter().filter(|(pixels, _)| *pixels > 0);
    let kinds: Vec<String> = kinds.map(|(pixels, words)| format!("{} {words}", count(pixels))).collect();
    let verb = if wrong == 1 { "is" } else { "are" };
    let patch = worst.filter(|_| wrong > 1).map_or_else(String::new, |region| {
        let [x, y] = region.at;
        format!("; the largest patch has {} at {x}, {y}", count(region.pixels))
    });
    format!("{} of {compared} pixels {verb} wrong: {}{patch}.", count(wrong), kinds.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::PixelFormat;

    fn picture(rows: &[&[u8]]) -> Image {
        let size = [rows[0].len() as u32, rows.len() as u32];
        Image::packed(PixelFormat::U8, size, rows.concat())
    }

    #[test]
    fn a_wrong_pixel_on_its_own_has_its_full_colour_wherever_it_lies() {
        for finding in [Finding::FalseShadow, Finding::MissingShadow, Finding::WrongSurface] {
            for place in 0..25 {
                let mut bytes = [0_u8; 25];
                bytes[place] = finding as u8;
                let drawn = colored(&Image::packed(PixelFormat::U8, [5, 5], bytes.to_vec()), 1);
                assert_eq!(drawn.pixels[place], style(finding).color);
            }
        }
    }

    #[test]
    fn each_kind_is_hatched_its_own_way() {
        let lines = |finding: Finding| -> Vec<bool> {
            let drawn = colored(&Image::uniform(PixelFormat::U8, [20, 20], &[finding as u8]), 1);
            drawn.pixels.iter().map(|color| *color != style(finding).color).collect()
        };
        let rising = lines(Finding::FalseShadow);
        let falling = lines(Finding::MissingShadow);
        // A uniform picture has no rim but its own border, where there is nothing else to see.
        for (x, y) in (0..19).flat_map(|y| (0..19).map(move |x| (x, y))) {
            assert_eq!(rising[y * 20 + x + 1], rising[(y + 1) * 20 + x], "up to the right");
            assert_eq!(falling[y * 20 + x], falling[(y + 1) * 20 + x + 1], "down to the right");
        }
        let both: Vec<bool> = rising.iter().zip(&falling).map(|(a, b)| *a || *b).collect();
        assert_eq!(lines(Finding::WrongSurface), both);
        assert!(!lines(Finding::Agrees).contains(&true));
        assert_eq!(lines(Finding::EdgeBand).iter().filter(|line| **line).count(), 200, "every second pixel");
    }

    #[test]
    fn a_picture_made_small_keeps_every_wrong_pixel() {
        let small = colored(&picture(&[&[0, 0, 0, 4, 5], &[0, 1, 0, 0, 5], &[5, 0, 0, 2, 4]]), 2);
        assert_eq!(small.size, [3, 2]);
        let colors = |findings: [u8; 6]| findings.map(color);
        let expected = colors([1, 4, 5, 0, 2, 4]);
        assert_eq!([0, 2, 3, 4].map(|place| small.pixels[place]), [0, 2, 3, 4].map(|place| expected[place]));
    }

    #[test]
    fn the_sentence_counts_what_is_wrong_and_says_where() {
        let none = ErrorCounts { compared: 876_871, edge_band: 412, ..ErrorCounts::default() };
        assert_eq!(
            sentence(&none, None).replace('\u{a0}', " "),
            "No pixel of 876 871 is wrong; 412 at edges are excused."
        );
        let counts = ErrorCounts { false_shadow: 1100, missing_shadow: 104, ..none };
        let worst = WrongRegion { pixels: 800, kind: Finding::FalseShadow, bounds: [3, 4, 50, 60], at: [7, 4] };
        assert_eq!(
            sentence(&counts, Some(&worst)).replace('\u{a0}', " "),
            "1 204 of 876 871 pixels are wrong: 1 100 false shadow, 104 missing; the largest patch has 800 at 7, 4."
        );
        let one = ErrorCounts { compared: 5, missing_shadow: 1, ..ErrorCounts::default() };
        assert_eq!(sentence(&one, Some(&worst)), "1 of 5 pixels is wrong: 1 missing.");
        assert_eq!(
            sentence(&ErrorCounts::default(), None),
            "Nothing was compared: in truth no surface faces the light."
        );
    }
}
