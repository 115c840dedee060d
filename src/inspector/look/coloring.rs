//! What the texels of a picture mean: their colour, and their number where they are large.

use crate::capture::Image;
use crate::inspector::look::findings;
use crate::inspector::look::palette;
use crate::numbers;
use crate::picture::colors;
use crate::reading::change::{self, ChangeKind};
use crate::reading::depth::DepthScale;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use egui::Color32;

/// Opacity with which the test results' colours lie over the picture.
pub const OVER: f32 = 0.62;

/// What the texels of a shown picture mean, with the ends of its grey ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorMapping {
    /// What they mean.
    pub coloring: Coloring,
    /// The depths that are drawn black and white.
    pub range: [f64; 2],
}

/// The least stencil value that is written as a count below 0: −16.
const LEAST_BELOW_ZERO: u8 = 240;

/// What the texels of a picture mean, and so which colours and numbers they are drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coloring {
    /// sRGB bytes.
    Srgb,
    /// Shares of light in linear bytes.
    Linear,
    /// Stencil counts.
    Stencil,
    /// Signed counts in floats.
    Count,
    /// Which share of a light arrives, as floats from 0 to 1.
    Visibility,
    /// Labels of a light.
    Labels,
    /// Findings of an error picture.
    Findings,
    /// Stored depths.
    Depth(DepthScale),
    /// One bit of a stencil count.
    Bit(u8),
    /// The change of a count, as a signed byte.
    CountChange,
    /// How much farther surfaces are, as floats.
    DepthChange,
    /// The results of the tests on a pixel's fragments.
    Outcomes,
    /// Where objects receive shadows.
    Receivers,
    /// How many fragments reached a pixel.
    Overdraw,
    /// sRGB bytes where they changed; alpha 0 where they did not.
    ColorChange,
}

impl Coloring {
    /// Returns the colouring for the kind of a shown picture; depths are drawn over `range`, from near to far, and a
    /// light's map of what is let through as colours.
    pub fn of_shown(shown: &ShownPicture, range: [f64; 2]) -> Coloring {
        match shown.kind {
            PictureKind::Color => Coloring::Srgb,
            PictureKind::Stencil => Coloring::Stencil,
            PictureKind::Count => Coloring::Count,
            PictureKind::Mask | PictureKind::Truth => Coloring::Labels,
            PictureKind::Visibility => Coloring::Visibility,
            PictureKind::Error => Coloring::Findings,
            PictureKind::Overdraw => Coloring::Overdraw,
            PictureKind::Map if shown.is_let_through() => Coloring::Linear,
            PictureKind::Depth | PictureKind::Map => Coloring::Depth(DepthScale { measure: shown.measure, range }),
        }
    }

    /// Returns the colouring of a picture of what changed.
    pub fn of_change(kind: ChangeKind) -> Coloring {
        match kind {
            ChangeKind::Count => Coloring::CountChange,
            ChangeKind::Depth => Coloring::DepthChange,
            ChangeKind::Color => Coloring::ColorChange,
        }
    }

    /// Returns the colour that the texel at a column and row is drawn in, see-through where an overlay leaves the
    /// picture visible; `None` outside the picture.
    pub fn color_at(self, image: &Image, at: [u32; 2]) -> Option<Color32> {
        match self {
            Coloring::Srgb => image.rgba_at(at).map(|[r, g, b, _]| Color32::from_rgb(r, g, b)),
            Coloring::Linear => image.rgba_at(at).map(linear),
            Coloring::Stencil => image.byte_at(at).map(palette::stencil),
            Coloring::Count => image.value_at(at).map(palette::count),
            Coloring::Visibility => image.value_at(at).map(visibility),
            Coloring::Labels => image.byte_at(at).map(palette::label),
            Coloring::Findings => image.byte_at(at).map(findings::color),
            Coloring::Depth(scale) => image.depth_at(at).map(|depth| self::depth(scale, depth)),
            Coloring::Bit(bit) => image.byte_at(at).map(|value| bit_color(value, bit)),
            Coloring::Outcomes => image.byte_at(at).map(|value| palette::outcome(value).gamma_multiply(OVER)),
            Coloring::Receivers => image.byte_at(at).map(palette::receiver),
            Coloring::Overdraw => image.byte_at(at).map(palette::overdraw),
            Coloring::CountChange => image.byte_at(at).map(|by| count_color(by as i8)),
            Coloring::DepthChange => image.value_at(at).map(depth_color),
            Coloring::ColorChange => image.rgba_at(at).map(changed),
        }
    }

    /// Returns the texel's number, in at most `columns` characters a line where it is a decimal. Colours have a line
    /// for each channel, red first, without alpha. `None` outside the picture, for findings, test results and
    /// receivers, and where a picture of changes shows none.
    pub fn number_at(self, image: &Image, at: [u32; 2], columns: usize) -> Option<String> {
        match self {
            Coloring::Srgb | Coloring::Linear => image.rgba_at(at).map(|[r, g, b, _]| format!("{r}\n{g}\n{b}")),
            Coloring::Stencil => image.byte_at(at).map(|value| match value {
                // A count that fell below 0, as the ladder has it; what is lower is rather a mask of bits.
                LEAST_BELOW_ZERO.. => numbers::count_in_float(f32::from(value.cast_signed())),
                _ => value.to_string(),
            }),
            Coloring::Labels => image.byte_at(at).map(|value| value.to_string()),
            Coloring::Count => image.value_at(at).map(numbers::count_in_float),
            Coloring::Visibility => image.value_at(at).map(|share| fitted(share.into(), columns)),
            Coloring::Depth(scale) => image.depth_at(at).map(|depth| match scale.measure.value(depth) {
                Some(value) => fitted(value, columns),
                None => "∞".to_owned(),
            }),
            Coloring::Bit(bit) => image.byte_at(at).map(|value| (value >> bit & 1).to_string()),
            Coloring::Overdraw => image.byte_at(at).map(|value| value.to_string()),
            Coloring::Outcomes | Coloring::Receivers | Coloring::Findings => None,
            Coloring::CountChange => image.byte_at(at).and_then(|by| change::signed(by as i8)),
            Coloring::DepthChange => image.value_at(at).filter(|by| *by != 0.0).map(|by| {
                let sign = if by < 0.0 { '−' } else { '+' };
                let size = f64::from(by.abs());
                if size.is_finite() {
                    format!("{sign}{}", fitted(size, columns.saturating_sub(1)))
                } else {
                    format!("{sign}∞")
                }
            }),
            Coloring::ColorChange => {
                let texel = image.rgba_at(at).filter(|texel| texel[3] != 0);
                texel.map(|[r, g, b, _]| format!("{r}\n{g}\n{b}"))
            }
        }
    }

    /// Returns whether every colour hides what lies behind the picture.
    pub fn is_opaque(self) -> bool {
        use Coloring::{ColorChange, CountChange, DepthChange, Findings, Outcomes, Receivers};
        !matches!(self, ColorChange | CountChange | DepthChange | Findings | Outcomes | Receivers)
    }

    /// Returns how many lines a texel's number has.
    pub fn lines(self) -> usize {
        if matches!(self, Coloring::Srgb | Coloring::Linear | Coloring::ColorChange) { 3 } else { 1 }
    }
}

/// Returns the colour of one bit of a value, counted from 0, the least significant.
pub fn bit_color(value: u8, bit: u8) -> Color32 {
    palette::BITS[usize::from(value >> bit & 1)]
}

/// Returns the new colour of a texel, opaque, where it changed (alpha is not 0); see-through elsewhere.
pub fn changed([r, g, b, a]: [u8; 4]) -> Color32 {
    if a == 0 { Color32::TRANSPARENT } else { Color32::from_rgb(r, g, b) }
}

/// Returns the screen colour of a share of light in linear bytes.
pub fn linear([r, g, b, _]: [u8; 4]) -> Color32 {
    palette::opaque(colors::linear([r, g, b]))
}

/// Returns the grey of a share of light: 0 black, 1 white.
pub fn visibility(share: f32) -> Color32 {
    palette::opaque(colors::visibility(share))
}

/// Returns the colour of a count that went up (orange) or down (blue): deep for a change of one, lighter the larger it
/// is, up to three; see-through for 0.
pub fn count_color(by: i8) -> Color32 {
    let strength = match by.unsigned_abs() {
        0 => return Color32::TRANSPARENT,
        1 => 0.0,
        steps => (f32::from(steps - 1) * 0.45).min(0.9),
    };
    let base = if by > 0 { palette::UP } else { palette::DOWN };
    base.lerp_to_gamma(Color32::WHITE, strength)
}

/// Returns the colour for a change of depth: `palette::UP` where a surface came nearer (negative), `palette::DOWN`
/// where it went farther away; −∞ means that a surface appeared, +∞ that it went; see-through for 0.
pub fn depth_color(by: f32) -> Color32 {
    match by {
        0.0 => Color32::TRANSPARENT,
        f32::NEG_INFINITY => palette::APPEARED,
        f32::INFINITY => palette::WENT,
        by if by < 0.0 => palette::UP,
        _ => palette::DOWN,
    }
}

/// Returns the grey of a stored depth on a scale, near light and far dark; the background colour where the depth is
/// that of no surface.
pub fn depth(scale: DepthScale, depth: f32) -> Color32 {
    scale.place(depth).map_or(palette::NO_SURFACE, palette::near_far)
}

/// Returns `value` with as many decimals (at most six) as fit into `columns` characters, without the zero before the
/// point; where only zeros would be shown, as a power of ten; its whole digits are never cut off.
fn fitted(value: f64, columns: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let whole = format!("{value:.0}").len();
    let decimals = columns.saturating_sub(whole + 1).min(6);
    let text = format!("{value:.decimals$}");
    // Every digit shown would be a zero: a power of ten says more.
    if text.chars().all(|c| matches!(c, '0' | '.' | '-')) {
        return format!("{value:.0e}");
    }
    text.strip_prefix('0').filter(|rest| rest.starts_with('.')).map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_their_cell() {
        assert_eq!(fitted(13.4823, 4), "13.5");
        assert_eq!(fitted(0.0, 4), "0");
        assert_eq!(fitted(0.3712, 4), ".37");
        assert_eq!(fitted(1234.5, 4), "1234");
        assert_eq!(fitted(0.000_001, 4), "1e-6");
    }
}
