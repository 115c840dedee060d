//! A target's content, from RenderDoc's bytes: row 0 at the top, with depth, stencil and colour separated.

use super::raw::{RawContents, RawFormat};
use crate::capture::{Image, PixelFormat};
use std::ops::Range;
use std::sync::Arc;

/// How an API's bytes are laid out by RenderDoc.
#[derive(Debug, Clone, Copy)]
pub struct TexelLayout {
    /// True where row 0 of the bytes is at the bottom (OpenGL).
    pub bottom_row_first: bool,
    /// True where depth of 24 bits is above the stencil in a word, not below it (OpenGL).
    pub depth_above_stencil: bool,
}

/// Returns the texel format of RenderDoc's name for it; [`RawFormat::Other`] with the name where pictures of it are not
/// read.
pub fn format(name: &str) -> RawFormat {
    match name {
        "D16" | "D16_UNORM" => RawFormat::D16,
        "D24" => RawFormat::D24,
        "D24S8" => RawFormat::D24S8,
        "D32" | "D32_FLOAT" => RawFormat::D32F,
        "D32S8" => RawFormat::D32FS8,
        "S8" => RawFormat::S8,
        "R8G8B8_UNORM" => RawFormat::Rgb8,
        "R8G8B8A8_UNORM" => RawFormat::Rgba8,
        "R8G8B8A8_SRGB" => RawFormat::Rgba8Srgb,
        "B8G8R8A8_UNORM" => RawFormat::Bgra8,
        "B8G8R8A8_SRGB" => RawFormat::Bgra8Srgb,
        "R16G16B16A16_FLOAT" => RawFormat::Rgba16F,
        "R11G11B10_FLOAT" => RawFormat::R11G11B10F,
        "R10G10B10A2_UNORM" => RawFormat::Rgb10A2,
        other => RawFormat::Other(other.to_owned()),
    }
}

/// Returns whether a picture that RenderDoc calls `D32` holds integers: as floats some of it would be more than 1, or no
/// number. OpenGL has both under this name.
pub fn is_normalised(bytes: &[u8]) -> bool {
    bytes.as_chunks::<4>().0.iter().any(|word| u32::from_le_bytes(*word) > 1.0_f32.to_bits())
}

/// Returns the bytes of a texel as RenderDoc hands it out; `None` where pictures of the format are not read.
pub fn texel_bytes(format: &RawFormat) -> Option<usize> {
    match format {
        RawFormat::S8 => Some(1),
        RawFormat::D16 => Some(2),
        RawFormat::Rgb8 => Some(3),
        RawFormat::D32FS8 | RawFormat::Rgba16F => Some(8),
        RawFormat::Other(_) => None,
        _ => Some(4),
    }
}

/// Decodes the bytes of a target of this size, top row first: depth as floats, stencil as bytes, colour as RGBA bytes
/// (floats encoded as sRGB). Aspects that the format lacks are absent, all of them where the format is not read.
pub fn read(format: &RawFormat, bytes: &[u8], size: [u32; 2], layout: TexelLayout) -> RawContents {
    let Some(texel) = texel_bytes(format) else { return RawContents::default() };
    let rows = bytes.chunks_exact((size[0] as usize * texel).max(1));
    let bytes = match layout.bottom_row_first {
        true => rows.rev().collect::<Vec<_>>().concat(),
        false => rows.collect::<Vec<_>>().concat(),
    };
    let words = || bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word));
    let picture = |format, texels: Vec<u8>| Some(Arc::new(Image::packed(format, size, texels)));
    let stencil = |texels: Vec<u8>| picture(PixelFormat::U8, texels);
    let none = RawContents::default;
    match format {
        RawFormat::D16 => {
            let shorts = bytes.as_chunks::<2>().0.iter().map(|short| u32::from(u16::from_le_bytes(*short)));
            RawContents { depth: picture(PixelFormat::Depth32F, depths(format, shorts)), ..none() }
        }
        RawFormat::D24 => {
            let depth = |word: u32| if layout.depth_above_stencil { word >> 8 } else { word & 0xff_ffff };
            RawContents { depth: picture(PixelFormat::Depth32F, depths(format, words().map(depth))), ..none() }
        }
        RawFormat::D24S8 => {
            let parts = |word: u32| match layout.depth_above_stencil {
                true => (word >> 8, word as u8),
                false => (word & 0xff_ffff, (word >> 24) as u8),
            };
            let depth = picture(PixelFormat::Depth32F, depths(format, words().map(|word| parts(word).0)));
            RawContents { depth, stencil: stencil(words().map(|word| parts(word).1).collect()), ..none() }
        }
        RawFormat::D32 => RawContents { depth: picture(PixelFormat::Depth32F, depths(format, words())), ..none() },
        RawFormat::D32F => RawContents { depth: picture(PixelFormat::Depth32F, bytes), ..none() },
        RawFormat::D32FS8 => {
            let texels = bytes.as_chunks::<8>().0;
            let depth = quads(texels.iter().map(|t| [t[0], t[1], t[2], t[3]]));
            let depth = picture(PixelFormat::Depth32F, depth);
            RawContents { depth, stencil: stencil(texels.iter().map(|t| t[4]).collect()), ..none() }
        }
        RawFormat::S8 => RawContents { stencil: stencil(bytes), ..none() },
        RawFormat::Other(_) => none(),
        color => {
            let color: Vec<u8> = match color {
                RawFormat::Rgb8 => bytes.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect(),
                RawFormat::Bgra8 | RawFormat::Bgra8Srgb => {
                    quads(bytes.as_chunks::<4>().0.iter().map(|[b, g, r, a]| [*r, *g, *b, *a]))
                }
                RawFormat::Rgba16F => {
                    let halves = bytes.as_chunks::<2>().0.iter().map(|half| float(u16::from_le_bytes(*half), 10));
                    let halves: Vec<f32> = halves.collect();
                    halves.as_chunks::<4>().0.iter().flat_map(|[r, g, b, a]| shown([*r, *g, *b], *a)).collect()
                }
                // No sign bit: a half's exponent, and mantissas of 6, 6 and 5 bits.
                RawFormat::R11G11B10F => words()
                    .flat_map(|word| {
                        let part = |shift: u32, bits: u32| (word >> shift & ((1 << bits) - 1)) as u16;
                        shown([float(part(0, 11), 6), float(part(11, 11), 6), float(part(22, 10), 5)], 1.0)
                    })
                    .collect(),
                RawFormat::Rgb10A2 => words()
                    .flat_map(|word| {
                        let part = |shift: u32| (word >> shift & 0x3ff) * 255 / 1023;
                        [part(0), part(10), part(20), (word >> 30) * 85].map(|value| value as u8)
                    })
                    .collect(),
                _ => bytes,
            };
            RawContents { color: picture(PixelFormat::Rgba8Srgb, color), ..none() }
        }
    }
}

/// Replaces in `contents` pictures, or rows of them, that are equal in `last` by those, and returns how many bytes of
/// memory the pictures then have of their own.
pub fn share(contents: &mut RawContents, last: &RawContents) -> u64 {
    let one = |new: &mut Option<Arc<Image>>, last: &Option<Arc<Image>>| {
        let Some(image) = new else { return 0 };
        if let Some(last) = last {
            if image == last {
                new.clone_from(&Some(last.clone()));
                return 0;
            }
            if let Some(shared) = image.sharing(last) {
                let is_own =
                    |rows: &Range<usize>| !last.memory().any(|of| of.start <= rows.start && rows.end <= of.end);
                let own: usize = shared.memory().filter(is_own).map(|rows| rows.len()).sum();
                *new = Some(Arc::new(shared));
                return own as u64;
            }
        }
        image.memory().map(|rows| rows.len() as u64).sum()
    };
    one(&mut contents.depth, &last.depth)
        + one(&mut contents.stencil, &last.stencil)
        + one(&mut contents.color, &last.color)
}

/// Converts integer depths to the bytes of floats from 0 to 1, correctly rounded as a GPU reads them; `format` decides
/// which integer is 1.
fn depths(format: &RawFormat, bits: impl Iterator<Item = u32>) -> Vec<u8> {
    let largest = format.largest_depth().unwrap_or(u32::MAX) as f32;
    quads(bits.map(|depth| (depth as f32 / largest).to_le_bytes()))
}

fn quads(texels: impl Iterator<Item = [u8; 4]>) -> Vec<u8> {
    texels.collect::<Vec<_>>().into_flattened()
}

/// Converts a small float: five bits of exponent above `mantissa` bits, and the sign above these, if there is one.
/// Infinity and NaN are kept.
fn float(bits: u16, mantissa: u32) -> f32 {
    let fraction = f32::from(bits & ((1 << mantissa) - 1)) / (1 << mantissa) as f32;
    let exponent = i32::from(bits >> mantissa & 0x1f);
    let value = match exponent {
        0 => fraction * 2_f32.powi(-14),
        0x1f if fraction > 0.0 => f32::NAN,
        0x1f => f32::INFINITY,
        _ => (1.0 + fraction) * 2_f32.powi(exponent - 15),
    };
    if bits >> mantissa & 0x20 == 0 { value } else { -value }
}

/// Converts linear colour to RGBA bytes: sRGB for the colour, alpha linear; values are clamped to 0 to 1, NaN becomes
/// 0.
fn shown(color: [f32; 3], alpha: f32) -> [u8; 4] {
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let encoded = |value: f32| {
        let value = value.clamp(0.0, 1.0);
        byte(if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 })
    };
    let [r, g, b] = color.map(encoded);
    [r, g, b, byte(alpha)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const GL: TexelLayout = TexelLayout { bottom_row_first: true, depth_above_stencil: true };
    const VULKAN: TexelLayout = TexelLayout { bottom_row_first: false, depth_above_stencil: false };

    fn texels(image: &Option<Arc<Image>>) -> Vec<u8> {
        image.as_ref().expect("a picture").rows().flatten().copied().collect()
    }

    #[test]
    fn the_top_row_comes_first_on_every_api() {
        let stencil = |layout| texels(&read(&RawFormat::S8, &[1, 2, 3, 4], [2, 2], layout).stencil);
        assert_eq!([stencil(GL), stencil(VULKAN)], [vec![3, 4, 1, 2], vec![1, 2, 3, 4]]);
    }

    #[test]
    fn depth_of_24_bits_is_exact() {
        let word = 0xabcd_ef12_u32.to_le_bytes();
        let depth = |bits: u32| Some((f64::from(bits) / f64::from(0xff_ffff)) as f32);
        let read = |format: &RawFormat, bytes: &[u8], layout| {
            let RawContents { depth, stencil, .. } = read(format, bytes, [1, 1], layout);
            (depth.and_then(|depth| depth.depth_at([0, 0])), stencil.and_then(|stencil| stencil.byte_at([0, 0])))
        };
        assert_eq!(read(&RawFormat::D24S8, &word, GL), (depth(0xab_cdef), Some(0x12)));
        assert_eq!(read(&RawFormat::D24S8, &word, VULKAN), (depth(0xcd_ef12), Some(0xab)));
        assert_eq!(read(&RawFormat::D16, &[0xff, 0xff], GL), (Some(1.0), None));
        // OpenGL hands 32 bits out, of which the upper ones are stored.
        assert_eq!(
            [GL, VULKAN].map(|layout| read(&RawFormat::D24, &word, layout).0),
            [depth(0xab_cdef), depth(0xcd_ef12)]
        );
        // No two steps are the same float: the integer comes back.
        for bits in [1_u32, 2, 0x7f_ffff, 0x80_0000, 0xff_fffd, 0xff_fffe] {
            let (Some(float), _) = read(&RawFormat::D24, &bits.to_le_bytes(), VULKAN) else { panic!("a depth") };
            assert_eq!((f64::from(float) * f64::from(0xff_ffff)).round(), f64::from(bits));
        }
    }

    #[test]
    fn depth_of_32_bits_is_an_integer_where_it_is_no_float() {
        let bytes = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        let floats = bytes(&[0.25_f32, 1.0, 0.0].map(f32::to_bits));
        let integers = bytes(&[u32::MAX, 1 << 31, 0]);
        assert_eq!([&floats, &integers].map(|bytes| is_normalised(bytes)), [false, true]);
        let depth = read(&RawFormat::D32, &integers, [3, 1], VULKAN).depth.expect("a depth");
        assert_eq!([0, 1, 2].map(|x| depth.depth_at([x, 0])), [Some(1.0), Some(0.5), Some(0.0)]);
    }

    #[test]
    fn colours_are_red_first_and_floats_are_cut() {
        let color = |format: &RawFormat, bytes: &[u8]| texels(&read(format, bytes, [1, 1], VULKAN).color);
        assert_eq!(color(&RawFormat::Rgb8, &[1, 2, 3]), [1, 2, 3, 255]);
        assert_eq!(color(&RawFormat::Bgra8, &[1, 2, 3, 4]), [3, 2, 1, 4]);
        // 1, 2, NaN and −1 as halves.
        assert_eq!(color(&RawFormat::Rgba16F, &[0, 0x3c, 0, 0x40, 1, 0x7c, 0, 0xbc]), [255, 255, 0, 0]);
        // Red 1 (15 << 6), the others 0.
        assert_eq!(color(&RawFormat::R11G11B10F, &(15_u32 << 6).to_le_bytes()), [255, 0, 0, 255]);
        assert_eq!(color(&RawFormat::Rgb10A2, &u32::MAX.to_le_bytes()), [255; 4]);
    }

    #[test]
    fn an_unknown_format_has_no_picture() {
        assert_eq!(read(&format("R32_UINT"), &[0; 16], [2, 2], GL), RawContents::default());
    }

    /// Of 64 rows the last eight differ: they alone take memory.
    #[test]
    fn rows_that_stay_are_shared_with_the_last_picture() {
        let bytes = |last: u8| [vec![1; 56 * 4], vec![last; 8 * 4]].concat();
        let first = read(&RawFormat::S8, &bytes(2), [4, 64], VULKAN);
        let mut equal = read(&RawFormat::S8, &bytes(2), [4, 64], VULKAN);
        assert_eq!(share(&mut equal, &first), 0);
        let mut other = read(&RawFormat::S8, &bytes(3), [4, 64], VULKAN);
        assert_eq!(share(&mut other, &first), 32);
        assert_eq!(texels(&other.stencil), bytes(3));
        assert_eq!(share(&mut other, &RawContents::default()), 64 * 4);
    }
}
