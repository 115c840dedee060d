//! Pictures for files: pixels that commands draw on the CPU, as PNG.
//!
//! A [`Picture`] is opaque sRGB, 8 bits a channel, row 0 at the top. The window draws with a GPU and shares only the
//! [`colors`], which mean the same everywhere. Several make an animation ([`apng`]), drawings become pixels ([`svg`]),
//! and words stand below a picture ([`caption`]).

pub mod apng;
#[cfg(feature = "formats")]
pub mod caption;
pub mod colors;
#[cfg(feature = "formats")]
pub mod svg;

use colors::Rgb;

/// Digits as rows of three dots, the left one the highest bit.
const DIGITS: [[u8; 5]; 10] = [
    [0b111, 0b101, 0b101, 0b101, 0b111],
    [0b010, 0b110, 0b010, 0b010, 0b111],
    [0b111, 0b001, 0b111, 0b100, 0b111],
    [0b111, 0b001, 0b111, 0b001, 0b111],
    [0b101, 0b101, 0b111, 0b001, 0b001],
    [0b111, 0b100, 0b111, 0b001, 0b111],
    [0b111, 0b100, 0b111, 0b101, 0b111],
    [0b111, 0b001, 0b010, 0b010, 0b010],
    [0b111, 0b101, 0b111, 0b101, 0b111],
    [0b111, 0b101, 0b111, 0b001, 0b111],
];
/// Dots of a digit with the gap after it; dots of a number's height; a dot of paper is all round.
const DIGIT_WIDTH: u32 = 4;
const DIGIT_HEIGHT: u32 = 5;

/// A picture of opaque sRGB pixels, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    size: [u32; 2],
    pixels: Vec<Rgb>,
}

impl Picture {
    /// Returns a picture of one colour.
    pub fn filled(size: [u32; 2], color: Rgb) -> Picture {
        Picture { size, pixels: vec![color; size[0] as usize * size[1] as usize] }
    }

    /// Returns the width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the pixels in row-major order, from the top left.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// Returns the pixel at a column and row; `None` outside the picture.
    pub fn at(&self, [x, y]: [u32; 2]) -> Option<Rgb> {
        (x < self.size[0]).then(|| self.pixels.get(self.index([x, y])).copied()).flatten()
    }

    /// Sets the pixel at a column and row; does nothing outside the picture.
    pub fn set(&mut self, at: [u32; 2], color: Rgb) {
        let index = self.index(at);
        if at[0] < self.size[0]
            && let Some(pixel) = self.pixels.get_mut(index)
        {
            *pixel = color;
        }
    }

    /// Copies another picture into this one with its top left corner at a column and row; pixels that would lie outside
    /// are left out.
    pub fn paste(&mut self, other: &Picture, [left, top]: [u32; 2]) {
        for (row, y) in other.pixels.chunks_exact(other.size[0].max(1) as usize).zip(top..) {
            row.iter().zip(left..).for_each(|(color, x)| self.set([x, y], *color));
        }
    }

    /// Returns pictures in a row from left to right, their tops aligned, `gap` pixels of `paper` between them and `paper`
    /// below those that are less high.
    pub fn in_a_row(pictures: &[Picture], gap: u32, paper: Rgb) -> Picture {
        let widths: u32 = pictures.iter().map(|picture| picture.size[0]).sum();
        let width = widths + gap * (pictures.len() as u32).saturating_sub(1);
        let height = pictures.iter().map(|picture| picture.size[1]).max().unwrap_or(0);
        let mut all = Picture::filled([width, height], paper);
        let mut left = 0;
        for picture in pictures {
            all.paste(picture, [left, 0]);
            left += picture.size[0] + gap;
        }
        all
    }

    /// Returns the picture as large as it fits into `most` with its proportions: enlarged by the largest whole number
    /// of times, each pixel a square, or, where it is larger, made smaller by averaging, at least one pixel each way.
    pub fn fitted(&self, most: [u32; 2]) -> Picture {
        let [width, height] = self.size.map(|side| side.max(1));
        let times = (most[0] / width).min(most[1] / height);
        if times >= 1 {
            let size = [width * times, height * times];
            return Picture::drawn(size, |[x, y]| self.at([x / times, y / times]).unwrap_or_default());
        }
        let by = (f64::from(most[0]) / f64::from(width)).min(f64::from(most[1]) / f64::from(height));
        let size = [width, height].map(|side| ((f64::from(side) * by).round() as u32).max(1));
        // A part of a pixel counts as much as it covers.
        let covered = |place: u32, side: usize| {
            let [from, to] =
                [place, place + 1].map(|edge| f64::from(edge) * f64::from(self.size[side]) / f64::from(size[side]));
            let pixels = from as u32..(to.ceil() as u32).min(self.size[side]);
            pixels.map(move |at| (at, f64::from(at + 1).min(to) - f64::from(at).max(from)))
        };
        Picture::drawn(size, |[x, y]| {
            let (mut sum, mut weight) = ([0.0; 3], 0.0);
            for (row, high) in covered(y, 1) {
                for (column, wide) in covered(x, 0) {
                    let color = self.at([column, row]).unwrap_or_default().map(f64::from);
                    sum = std::array::from_fn(|channel| sum[channel] + color[channel] * high * wide);
                    weight += high * wide;
                }
            }
            sum.map(|sum| (sum / weight).round() as u8)
        })
    }

    /// Returns a picture whose pixel at each column and row has the colour that `color` returns for it.
    pub fn drawn(size: [u32; 2], color: impl Fn([u32; 2]) -> Rgb) -> Picture {
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        Picture { size, pixels: places.map(color).collect() }
    }

    /// Draws a frame around columns and rows `[left, top, right, bottom]` (ends included), `gap` pixels away and
    /// `width` wide; pixels outside the picture are left out.
    pub fn frame(&mut self, bounds: [u32; 4], gap: u32, width: u32, color: Rgb) {
        let [left, top, right, bottom] = bounds.map(i64::from);
        for step in i64::from(gap) + 1..=i64::from(gap) + i64::from(width) {
            let (left, top, right, bottom) = (left - step, top - step, right + step, bottom + step);
            for x in left..=right {
                [top, bottom].into_iter().for_each(|y| self.set_signed(x, y, color));
            }
            for y in top..=bottom {
                [left, right].into_iter().for_each(|x| self.set_signed(x, y, color));
            }
        }
    }

    /// Writes a number with the top left corner of its ground, in the colour `paper`, at a column and row; each dot of
    /// a digit is `dot` × `dot` pixels. What lies outside the picture is left out.
    pub fn number(&mut self, [left, top]: [u32; 2], number: usize, dot: u32, ink: Rgb, paper: Rgb) {
        self.paste(&Picture::filled(Picture::number_size(number, dot), paper), [left, top]);
        let square = Picture::filled([dot, dot], ink);
        let digits = number.to_string().into_bytes().into_iter().map(|digit| usize::from(digit - b'0'));
        for (place, digit) in (0..).zip(digits) {
            for (row, dots) in (0..).zip(DIGITS[digit]) {
                for column in (0..3).filter(|column| dots >> (2 - column) & 1 == 1) {
                    let x = 1 + place * DIGIT_WIDTH + column;
                    self.paste(&square, [left + x * dot, top + (1 + row) * dot]);
                }
            }
        }
    }

    /// Returns the width and height, in pixels, that a number takes with its border, which is one dot wide.
    pub fn number_size(number: usize, dot: u32) -> [u32; 2] {
        let digits = number.to_string().len() as u32;
        [(digits * DIGIT_WIDTH + 1) * dot, (DIGIT_HEIGHT + 2) * dot]
    }

    /// Encodes the picture as PNG (8-bit sRGB) and returns the bytes.
    pub fn to_png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.write_header()?.write_image_data(self.pixels.as_flattened())?;
        Ok(file)
    }

    fn set_signed(&mut self, x: i64, y: i64, color: Rgb) {
        if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) {
            self.set([x, y], color);
        }
    }

    fn index(&self, [x, y]: [u32; 2]) -> usize {
        y as usize * self.size[0] as usize + x as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Rgb = [0; 3];
    const RED: Rgb = [255, 0, 0];

    #[test]
    fn what_sticks_out_is_left_away() {
        let mut picture = Picture::filled([4, 3], BLACK);
        picture.paste(&Picture::filled([3, 3], RED), [2, 1]);
        picture.set([4, 0], RED);
        let red: Vec<[u32; 2]> = places(&picture, RED);
        assert_eq!(red, [[2, 1], [3, 1], [2, 2], [3, 2]]);
        assert_eq!((picture.at([4, 0]), picture.at([0, 3]), picture.at([3, 2])), (None, None, Some(RED)));
    }

    #[test]
    fn a_frame_goes_around_its_pixels_and_not_over_them() {
        let mut picture = Picture::filled([6, 5], BLACK);
        picture.frame([2, 2, 3, 2], 0, 1, RED);
        assert_eq!(places(&picture, RED).len(), 10);
        assert_eq!((picture.at([2, 2]), picture.at([3, 2]), picture.at([1, 1])), (Some(BLACK), Some(BLACK), Some(RED)));
        // Partly outside.
        picture.frame([0, 0, 5, 4], 0, 2, RED);
        assert_eq!(places(&picture, RED).len(), 10);
    }

    #[test]
    fn numbers_differ_and_stay_within_their_room() {
        let written = |number: usize| {
            let mut picture = Picture::filled([40, 20], BLACK);
            picture.number([2, 3], number, 2, RED, [1; 3]);
            places(&picture, RED)
        };
        let all: std::collections::BTreeSet<Vec<[u32; 2]>> = (0..=12).map(written).collect();
        assert_eq!(all.len(), 13);
        let [width, height] = Picture::number_size(12, 2);
        assert!(written(12).iter().all(|[x, y]| (4..2 + width).contains(x) && (5..1 + height).contains(y)));
        assert_eq!(written(1).len(), 8 * 4, "eight dots of four pixels");
    }

    #[test]
    fn a_picture_is_fitted_by_whole_squares_or_by_averages() {
        let checked = Picture::drawn([4, 2], |[x, y]| if (x + y) % 2 == 0 { [200, 100, 0] } else { BLACK });
        let large = checked.fitted([13, 7]);
        assert_eq!((large.size(), large.at([2, 2]), large.at([3, 2])), ([12, 6], Some([200, 100, 0]), Some(BLACK)));
        let small = checked.fitted([2, 9]);
        assert_eq!((small.size(), small.at([1, 0])), ([2, 1], Some([100, 50, 0])));
        assert_eq!(checked.fitted([3, 3]).size(), [3, 2], "neither side is lost");
        assert_eq!(checked.fitted([4, 2]), checked);
    }

    #[test]
    fn a_png_holds_its_pixels() {
        let mut picture = Picture::filled([3, 2], [1, 2, 3]);
        picture.set([2, 1], RED);
        let bytes = picture.to_png().expect("a PNG");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!((info.width, info.height, &pixels[15..], &pixels[..3]), (3, 2, &RED[..], &[1, 2, 3][..]));
        assert!(Picture::filled([0, 2], RED).to_png().is_err());
    }

    fn places(picture: &Picture, color: Rgb) -> Vec<[u32; 2]> {
        let [width, height] = picture.size();
        let all = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        all.filter(|at| picture.at(*at) == Some(color)).collect()
    }
}
