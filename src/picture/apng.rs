//! Animated PNG: pictures of one size, one after the other, over and over.
//!
//! Each picture is written when it is added, and only the rectangle around what changed since the one before. Every
//! browser shows such a file, and a program that does not support it shows the first picture.

use super::Picture;
use super::colors::Rgb;
use std::io::Write;

/// The most that a channel of a rounded picture differs from the original.
pub const ROUNDED_BY: u8 = 1;

/// How exactly the colours of an animation are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorDepth {
    /// To the bit.
    Exact,
    /// Each channel to within [`ROUNDED_BY`] of 255: gently shaded surfaces take some two thirds of the bytes.
    Rounded,
}

impl ColorDepth {
    /// Returns the colour that is stored for `color`: the same, or each channel rounded to the nearest multiple of a
    /// step, which 0 and 255 are.
    pub fn reduced(self, color: Rgb) -> Rgb {
        let step = u16::from(2 * ROUNDED_BY + 1);
        match self {
            ColorDepth::Exact => color,
            // 255 is a multiple of the step: white and black stay.
            ColorDepth::Rounded => {
                color.map(|channel| ((u16::from(channel) + u16::from(ROUNDED_BY)) / step * step).min(255) as u8)
            }
        }
    }

    /// Returns the PNG filter that compresses pictures of this colour depth best: none for rounded ones, as their
    /// surfaces are runs of one colour already.
    fn filter(self) -> png::Filter {
        match self {
            ColorDepth::Exact => png::Filter::Adaptive,
            ColorDepth::Rounded => png::Filter::NoFilter,
        }
    }
}

/// Size, number, duration and colours of an animation's pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AnimationFormat {
    /// Width and height of every picture.
    pub size: [u32; 2],
    /// The number of pictures.
    pub pictures: u32,
    /// How long each is shown, milliseconds.
    pub milliseconds: u16,
    /// How exactly their colours are stored.
    pub colors: ColorDepth,
}

/// Why a picture can't be added to an animation, or it can't be begun or ended.
#[derive(Debug, thiserror::Error)]
pub enum AnimationError {
    /// It has another size than the animation.
    #[error("a picture of {found:?} pixels can't follow one of {expected:?}")]
    Size {
        /// Size of the animation.
        expected: [u32; 2],
        /// Size of the picture.
        found: [u32; 2],
    },
    /// It can't be written, or there are too few or too many.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
}

/// An animated PNG that is being written; each picture after the first stores only the rectangle that changed.
pub struct AnimatedPng<W: Write> {
    writer: png::Writer<W>,
    format: AnimationFormat,
    /// The last picture, as it is stored.
    shown: Option<Picture>,
}

impl<W: Write> AnimatedPng<W> {
    /// Begins an animation that is repeated for ever. An error where the format has no pictures or no pixels, or `out`
    /// fails.
    pub fn new(out: W, format: AnimationFormat) -> Result<AnimatedPng<W>, AnimationError> {
        let mut encoder = png::Encoder::new(out, format.size[0], format.size[1]);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(format.colors.filter());
        encoder.validate_sequence(true);
        encoder.set_animated(format.pictures, 0)?;
        encoder.set_frame_delay(format.milliseconds, 1000)?;
        Ok(AnimatedPng { writer: encoder.write_header()?, format, shown: None })
    }

    /// Adds the next picture, of which only the rectangle that differs from the one before is written (one pixel where
    /// nothing does). An error where its size is not the format's, or there are more pictures than the format says.
    pub fn add(&mut self, picture: &Picture) -> Result<(), AnimationError> {
        let (expected, found) = (self.format.size, picture.size());
        if expected != found {
            return Err(AnimationError::Size { expected, found });
        }
        let pixels = picture.pixels.iter().map(|color| self.format.colors.reduced(*color)).collect();
        let picture = Picture { size: found, pixels };
        if let Some(shown) = &self.shown {
            // A picture can't be empty: where nothing changed, one pixel is written again.
            let [left, top, right, bottom] = changed(shown, &picture).unwrap_or([0; 4]);
            self.writer.reset_frame_position()?;
            self.writer.set_frame_dimension(right - left + 1, bottom - top + 1)?;
            self.writer.set_frame_position(left, top)?;
            self.writer.write_image_data(part(&picture, [left, top, right, bottom]).as_flattened())?;
        } else {
            self.writer.write_image_data(picture.pixels.as_flattened())?;
        }
        self.shown = Some(picture);
        Ok(())
    }

    /// Ends the animation.
    pub fn finish(self) -> Result<(), AnimationError> {
        Ok(self.writer.finish()?)
    }
}

impl<W: Write> std::fmt::Debug for AnimatedPng<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "AnimatedPng({:?})", self.format)
    }
}

/// Returns the columns and rows `[left, top, right, bottom]`, ends included, around what differs; `None` where nothing
/// does.
fn changed(one: &Picture, other: &Picture) -> Option<[u32; 4]> {
    let width = one.size[0] as usize;
    let mut bounds: Option<[u32; 4]> = None;
    for (y, (a, b)) in (0..).zip(one.pixels.chunks_exact(width).zip(other.pixels.chunks_exact(width))) {
        let differs = |x: &usize| a[*x] != b[*x];
        let Some(left) = (0..width).find(differs) else { continue };
        let right = (0..width).rfind(differs).unwrap_or(left);
        let [left, right] = [left as u32, right as u32];
        let [known_left, top, known_right, _] = bounds.unwrap_or([left, y, right, y]);
        bounds = Some([left.min(known_left), top, right.max(known_right), y]);
    }
    bounds
}

/// Returns the pixels of the columns and rows `[left, top, right, bottom]`, ends included, row by row.
fn part(picture: &Picture, [left, top, right, bottom]: [u32; 4]) -> Vec<Rgb> {
    let rows = picture.pixels.chunks_exact(picture.size[0] as usize);
    let rows = rows.skip(top as usize).take((bottom - top + 1) as usize);
    rows.flat_map(|row| row[left as usize..=right as usize].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Rgb = [0; 3];
    const RED: Rgb = [255, 0, 0];

    fn format(size: [u32; 2], pictures: usize) -> AnimationFormat {
        AnimationFormat { size, pictures: pictures as u32, milliseconds: 500, colors: ColorDepth::Exact }
    }

    /// Returns the file of some pictures.
    fn animation(pictures: &[Picture]) -> Result<Vec<u8>, AnimationError> {
        let mut file = Vec::new();
        let size = pictures.first().map_or([1, 1], Picture::size);
        let mut film = AnimatedPng::new(&mut file, format(size, pictures.len()))?;
        pictures.iter().try_for_each(|picture| film.add(picture))?;
        film.finish()?;
        Ok(file)
    }

    /// Returns the pictures that a program shows of it, one after the other.
    fn shown(file: Vec<u8>) -> Vec<Picture> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a header");
        let count = reader.info().animation_control().expect("an animation").num_frames;
        let mut canvas = Picture::filled([reader.info().width, reader.info().height], BLACK);
        let mut all = Vec::new();
        for _ in 0..count {
            let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
            reader.next_frame(&mut bytes).expect("a picture");
            let place = *reader.info().frame_control().expect("its place");
            let pixels = bytes.as_chunks().0[..(place.width * place.height) as usize].to_vec();
            canvas.paste(&Picture { size: [place.width, place.height], pixels }, [place.x_offset, place.y_offset]);
            all.push(canvas.clone());
        }
        all
    }

    #[test]
    fn pictures_come_back_whatever_changes_between_them() {
        let first = Picture::filled([6, 5], BLACK);
        let mut dot = first.clone();
        dot.set([5, 4], RED);
        let mut two = dot.clone();
        two.set([1, 2], RED);
        let pictures = [first.clone(), dot.clone(), two, dot.clone(), dot, first, Picture::filled([6, 5], RED)];
        assert_eq!(shown(animation(&pictures).expect("an animation")), pictures);
    }

    #[test]
    fn only_what_changed_is_written() {
        // Noise, which no filter makes small.
        let mut noise = Picture::filled([64, 64], BLACK);
        let mut state = 1_u32;
        for at in (0..64).flat_map(|y| (0..64).map(move |x| [x, y])) {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            noise.set(at, [(state >> 24) as u8, (state >> 16) as u8, (state >> 8) as u8]);
        }
        let mut dot = noise.clone();
        dot.set([30, 30], RED);
        let [one, two] = [vec![noise.clone()], vec![noise, dot]].map(|all| animation(&all).expect("one").len());
        assert!(two < one + 200, "{one} and {two} bytes");
    }

    #[test]
    fn it_loops_for_ever_and_shows_each_picture_as_long() {
        let pictures = [Picture::filled([2, 2], BLACK), Picture::filled([2, 2], RED)];
        let file = animation(&pictures).expect("an animation");
        let reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a header");
        let control = reader.info().animation_control().expect("an animation");
        assert_eq!((control.num_frames, control.num_plays), (2, 0));
        let frame = reader.info().frame_control().expect("a picture");
        assert_eq!((frame.delay_num, frame.delay_den), (500, 1000));
    }

    #[test]
    fn a_picture_of_another_size_one_too_many_and_too_few_are_refused() {
        let [small, large] = [Picture::filled([1, 1], RED), Picture::filled([2, 2], RED)];
        let of_another_size = animation(&[large.clone(), small]);
        assert!(matches!(of_another_size, Err(AnimationError::Size { expected: [2, 2], found: [1, 1] })));
        let mut film = AnimatedPng::new(Vec::new(), format([2, 2], 1)).expect("a header");
        film.add(&large).expect("the only one");
        assert!(film.add(&large).is_err());
        let film = AnimatedPng::new(Vec::new(), format([2, 2], 2)).expect("a header");
        assert!(film.finish().is_err());
        assert!(animation(&[]).is_err());
    }

    #[test]
    fn a_rounded_colour_is_near_and_black_and_white_stay() {
        for value in 0..=255 {
            let [reduced, ..] = ColorDepth::Rounded.reduced([value; 3]);
            assert!(reduced.abs_diff(value) <= ROUNDED_BY, "{value} became {reduced}");
        }
        assert_eq!([BLACK, [255; 3]].map(|color| ColorDepth::Rounded.reduced(color)), [BLACK, [255; 3]]);
    }
}
