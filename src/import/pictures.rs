//! What a target holds, from RenderDoc's bytes: row 0 at the top, depth, stencil and colour apart.

use super::raw::{RawContents, RawFormat};
use std::sync::Arc;

/// How RenderDoc gives the bytes of an API.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// Row 0 of the bytes is at the bottom (OpenGL).
    pub bottom_row_first: bool,
    /// Depth of 24 bits is above the stencil, not below it (OpenGL).
    pub depth_above_stencil: bool,
}

/// A format by RenderDoc's name.
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

/// Bytes of a texel; `None` where the format is not read.
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

/// The pictures in the bytes of `width` × some rows; none where the format is not read.
pub fn read(format: &RawFormat, bytes: &[u8], width: usize, layout: Layout) -> RawContents {
    let Some(texel) = texel_bytes(format) else { return RawContents::default() };
    let rows = bytes.chunks_exact((width * texel).max(1));
    let bytes: Vec<u8> = if layout.bottom_row_first {
        rows.rev().flatten().copied().collect()
    } else {
        rows.flatten().copied().collect()
    };
    let words = || bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word));
    match format {
        RawFormat::D16 => {
            let shorts = bytes.as_chunks::<2>().0.iter();
            integers(format, shorts.map(|short| u32::from(u16::from_le_bytes(*short))))
        }
        RawFormat::D24 => integers(format, words().map(|word| word & 0xff_ffff)),
        RawFormat::D24S8 => {
            let parts = |word: u32| match layout.depth_above_stencil {
                true => (word >> 8, word as u8),
                false => (word & 0xff_ffff, (word >> 24) as u8),
            };
            let stencil = words().map(|word| parts(word).1).collect();
            RawContents { stencil: Some(stencil), ..integers(format, words().map(|word| parts(word).0)) }
        }
        RawFormat::D32F => RawContents { depth: Some(words().map(f32::from_bits).collect()), ..RawContents::default() },
        RawFormat::D32FS8 => {
            let texels = || bytes.as_chunks::<8>().0.iter();
            RawContents {
                depth: Some(texels().map(|t| f32::from_le_bytes([t[0], t[1], t[2], t[3]])).collect()),
                stencil: Some(texels().map(|t| t[4]).collect()),
                ..RawContents::default()
            }
        }
        RawFormat::S8 => RawContents { stencil: Some(bytes.into()), ..RawContents::default() },
        RawFormat::Other(_) => RawContents::default(),
        color => {
            let color: Arc<[u8]> = match color {
                RawFormat::Rgb8 => bytes.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect(),
                RawFormat::Bgra8 | RawFormat::Bgra8Srgb => {
                    bytes.as_chunks::<4>().0.iter().flat_map(|[b, g, r, a]| [*r, *g, *b, *a]).collect()
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
                _ => bytes.into(),
            };
            RawContents { color: Some(color), ..RawContents::default() }
        }
    }
}

/// Takes from `last` what is equal there, and returns the bytes of the rest.
pub fn share(contents: &mut RawContents, last: &RawContents) -> u64 {
    fn one<T: PartialEq>(new: &mut Option<Arc<[T]>>, last: &Option<Arc<[T]>>) -> u64 {
        if new.is_some() && new == last {
            new.clone_from(last);
            return 0;
        }
        new.as_ref().map_or(0, |new| size_of_val::<[T]>(new) as u64)
    }
    let depths = one(&mut contents.depth, &last.depth) + one(&mut contents.depth_bits, &last.depth_bits);
    depths + one(&mut contents.stencil, &last.stencil) + one(&mut contents.color, &last.color)
}

fn integers(format: &RawFormat, bits: impl Iterator<Item = u32>) -> RawContents {
    let bits: Arc<[u32]> = bits.collect();
    let largest = f64::from(format.largest_depth().unwrap_or(u32::MAX));
    let depth = bits.iter().map(|&depth| (f64::from(depth) / largest) as f32).collect();
    RawContents { depth: Some(depth), depth_bits: Some(bits), ..RawContents::default() }
}

/// A float with five bits of exponent and `mantissa` bits after it.
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

/// Linear colour as bytes of sRGB; NaN is black.
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

    const GL: Layout = Layout { bottom_row_first: true, depth_above_stencil: true };
    const VULKAN: Layout = Layout { bottom_row_first: false, depth_above_stencil: false };

    #[test]
    fn the_top_row_comes_first_on_every_api() {
        assert_eq!(read(&RawFormat::S8, &[1, 2, 3, 4], 2, GL).stencil.as_deref(), Some(&[3, 4, 1, 2][..]));
        assert_eq!(read(&RawFormat::S8, &[1, 2, 3, 4], 2, VULKAN).stencil.as_deref(), Some(&[1, 2, 3, 4][..]));
    }

    #[test]
    fn depth_of_24_bits_is_exact() {
        let word = 0xabcd_ef12_u32.to_le_bytes();
        let gl = read(&RawFormat::D24S8, &word, 1, GL);
        assert_eq!((gl.depth_bits.as_deref(), gl.stencil.as_deref()), (Some(&[0xab_cdef][..]), Some(&[0x12][..])));
        let vulkan = read(&RawFormat::D24S8, &word, 1, VULKAN);
        assert_eq!(
            (vulkan.depth_bits.as_deref(), vulkan.stencil.as_deref()),
            (Some(&[0xcd_ef12][..]), Some(&[0xab][..]))
        );
        assert_eq!(read(&RawFormat::D16, &[0xff, 0xff], 1, GL).depth.as_deref(), Some(&[1.0][..]));
    }

    #[test]
    fn colours_are_red_first_and_floats_are_cut() {
        let color = |format: &RawFormat, bytes: &[u8]| read(format, bytes, 1, VULKAN).color.expect("a colour").to_vec();
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
        assert_eq!(read(&format("R32_UINT"), &[0; 16], 2, GL), RawContents::default());
    }
}
