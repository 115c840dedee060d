//! Two pictures of one kind, texel by texel: bits are compared, so that a NaN equals itself and
//! `−0` is not `0`.

use crate::accuracy::{place, take_connected};
use crate::capture::{Image, PixelFormat};

/// Where and how much two pictures of one size differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelDifference {
    /// Texels that differ.
    pub pixels: u64,
    /// The texel that differs most; the first in reading order of several.
    pub largest: TexelDifference,
    /// The largest region of differing texels that touch each other, corners included.
    pub region: DifferingRegion,
}

/// Differing texels that are connected, corners included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferingRegion {
    /// The number of texels.
    pub pixels: u64,
    /// First and last column and row: left, top, right, bottom.
    pub bounds: [u32; 4],
    /// The one of them that differs most.
    pub largest: TexelDifference,
}

/// One texel in both pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexelDifference {
    /// Column and row of the texel.
    pub at: [u32; 2],
    /// Its values in the first and in the second picture.
    pub values: [Texel; 2],
    /// The distance of the values: of colours in the channel that differs most, of bytes the shorter way round (255 is
    /// −1), of floats their difference; 0 where they differ in bits alone, infinite where one is NaN.
    pub by: f64,
}

/// The value of a texel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Texel {
    /// Red, green, blue and alpha.
    Color([u8; 4]),
    /// A depth or a count.
    Float(f32),
    /// A stencil count, a label or a finding.
    Byte(u8),
}

/// Compares two pictures bit by bit; `None` where all is the same. Regions are of differing texels that touch, corners
/// included; of equal ones the first is returned.
///
/// # Panics
/// If they are of other formats or sizes.
pub(super) fn compare(a: &Image, b: &Image) -> Option<PixelDifference> {
    assert_eq!((a.format(), a.size()), (b.format(), b.size()), "pictures of one kind");
    if a == b {
        return None;
    }
    let [width, height] = a.size();
    let texel_bytes = a.format().texel_bytes();
    let mut differs = Vec::with_capacity(width as usize * height as usize);
    for (row_a, row_b) in a.rows().zip(b.rows()) {
        differs.extend(row_a.chunks_exact(texel_bytes).zip(row_b.chunks_exact(texel_bytes)).map(|(a, b)| a != b));
    }
    let texel = |index: usize| texel_difference(a, b, place(index, a.size()));
    let mut found: Option<PixelDifference> = None;
    for start in 0..differs.len() {
        if !differs[start] {
            continue;
        }
        let mut members = Vec::new();
        take_connected(&mut differs, false, start, a.size(), 1, |index| members.push(index));
        members.sort_unstable();
        let region = describe(&members, &texel)?;
        found = Some(match found {
            None => PixelDifference { pixels: region.pixels, largest: region.largest, region },
            Some(so_far) => PixelDifference {
                pixels: so_far.pixels + region.pixels,
                largest: if region.largest.by > so_far.largest.by { region.largest } else { so_far.largest },
                region: if region.pixels > so_far.region.pixels { region } else { so_far.region },
            },
        });
    }
    found
}

fn describe(members: &[usize], texel: &impl Fn(usize) -> Option<TexelDifference>) -> Option<DifferingRegion> {
    let first = texel(*members.first()?)?;
    let [x, y] = first.at;
    let mut region = DifferingRegion { pixels: 0, bounds: [x, y, x, y], largest: first };
    for difference in members.iter().filter_map(|index| texel(*index)) {
        let ([x, y], [left, top, right, bottom]) = (difference.at, region.bounds);
        region.bounds = [left.min(x), top.min(y), right.max(x), bottom.max(y)];
        region.pixels += 1;
        if difference.by > region.largest.by {
            region.largest = difference;
        }
    }
    Some(region)
}

fn texel_difference(a: &Image, b: &Image, at: [u32; 2]) -> Option<TexelDifference> {
    let values = [texel(a, at)?, texel(b, at)?];
    Some(TexelDifference { at, values, by: apart(values) })
}

fn texel(image: &Image, at: [u32; 2]) -> Option<Texel> {
    match image.format() {
        PixelFormat::Rgba8Srgb | PixelFormat::Rgba8 => image.rgba_at(at).map(Texel::Color),
        PixelFormat::Depth32F => image.depth_at(at).map(Texel::Float),
        PixelFormat::Value32F => image.value_at(at).map(Texel::Float),
        PixelFormat::U8 => image.byte_at(at).map(Texel::Byte),
    }
}

fn apart(values: [Texel; 2]) -> f64 {
    match values {
        [Texel::Color(a), Texel::Color(b)] => a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().map_or(0.0, f64::from),
        [Texel::Byte(a), Texel::Byte(b)] => f64::from(a.wrapping_sub(b).min(b.wrapping_sub(a))),
        [Texel::Float(a), Texel::Float(b)] if a.is_nan() && b.is_nan() => 0.0,
        [Texel::Float(a), Texel::Float(b)] => {
            let by = (f64::from(a) - f64::from(b)).abs();
            // Equal infinities are 0 apart, and NaN is infinitely far from every value.
            if a == b {
                0.0
            } else if by.is_nan() {
                f64::INFINITY
            } else {
                by
            }
        }
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(rows: &[&[u8]]) -> Image {
        let size = [rows[0].len() as u32, rows.len() as u32];
        Image::packed(PixelFormat::U8, size, rows.concat())
    }

    fn floats(values: &[f32]) -> Image {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Image::packed(PixelFormat::Depth32F, [values.len() as u32, 1], bytes)
    }

    #[test]
    fn the_largest_region_and_the_largest_difference_need_not_meet() {
        let a = bytes(&[&[0; 6], &[0; 6], &[0; 6]]);
        let b = bytes(&[&[1, 0, 0, 0, 0, 9], &[0, 2, 0, 0, 0, 0], &[0, 1, 0, 0, 255, 0]]);
        let found = compare(&a, &b).expect("a difference");
        assert_eq!((found.pixels, found.largest.at, found.largest.by), (5, [5, 0], 9.0));
        let DifferingRegion { pixels, bounds, largest } = found.region;
        assert_eq!((pixels, bounds, largest.at, largest.by), (3, [0, 0, 1, 2], [1, 1], 2.0));
        assert_eq!(compare(&a, &a), None);
    }

    #[test]
    fn a_count_of_minus_one_is_one_away_from_none() {
        let found = compare(&bytes(&[&[0]]), &bytes(&[&[255]])).expect("a difference");
        assert_eq!((found.largest.by, found.largest.values), (1.0, [Texel::Byte(0), Texel::Byte(255)]));
    }

    #[test]
    fn floats_are_compared_bit_by_bit() {
        let (quiet, other) = (f32::from_bits(0x7fc0_0000), f32::from_bits(0x7fc0_0001));
        assert_eq!(compare(&floats(&[quiet]), &floats(&[quiet])), None, "a NaN is itself");
        let by = |a: f32, b: f32| compare(&floats(&[a]), &floats(&[b])).map(|found| found.largest.by);
        assert_eq!(by(quiet, other), Some(0.0), "another payload is a difference in bits alone");
        assert_eq!(by(0.0, -0.0), Some(0.0));
        assert_eq!(by(1.0, quiet), Some(f64::INFINITY));
        assert_eq!(by(f32::INFINITY, 1.0), Some(f64::INFINITY));
        assert_eq!(by(0.5, f32::from_bits(0.5_f32.to_bits() + 1)), Some(2.0_f64.powi(-24)));
    }

    #[test]
    fn rows_may_be_padded_differently() {
        let packed = bytes(&[&[1, 2], &[3, 4]]);
        let padded = Image::from_rows(PixelFormat::U8, [2, 2], 4, vec![1, 2, 9, 9, 3, 4]);
        assert_eq!(compare(&packed, &padded), None);
        assert_eq!(compare(&packed, &Image::uniform(PixelFormat::U8, [2, 2], &[3])).map(|found| found.pixels), Some(3));
    }
}
