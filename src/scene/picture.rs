//! Textures: files decoded to texels, their mip chain, and how they are looked up.
//!
//! A picture is sRGB with eight bits a channel, row 0 at the top; its alpha is not used. Level k of its mip chain has
//! half the texels of level k − 1 along each side: averages of two by two, of linear light. A lookup mixes the four
//! nearest texels on each of the two mip levels whose texels are about as large as a pixel is there along its longer
//! side (Williams 1983): a surface at a grazing angle far away blurs, and does not flicker. The GPU does the same with
//! the same mip levels, and [`TextureImage::linear_at`] computes its result.

use crate::files::{ReadError, read_plain};
use foldhash::quality::FixedState;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::fmt;
use std::hash::{BuildHasher, Hasher};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// Bytes of the largest file.
pub(super) const MOST_FILE: u64 = 64 << 20;
/// Texels along a side of the largest picture: what every GPU supports.
const MOST_SIDE: u32 = 8192;
/// The most texels of all pictures of a model or a scene file.
const MOST_TEXELS: u64 = 1 << 27;

/// A picture for textures of surfaces, with its mip levels, computed on first use.
pub struct TextureImage {
    name: String,
    size: [u32; 2],
    texels: Vec<[u8; 4]>,
    hash: u64,
    levels: OnceLock<Vec<MipLevel>>,
}

/// A mip level of a picture, above level 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MipLevel {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// sRGB and alpha, row by row from the top.
    pub texels: Vec<[u8; 4]>,
}

/// A texture on a surface: its picture, how it is mapped, and whether it repeats without end or is clamped.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialTexture {
    /// Its texels.
    pub picture: Arc<TextureImage>,
    /// Width in metres of world X and Z that the picture covers; `None` uses the mesh's texture coordinates.
    pub side: Option<f32>,
    /// True clamps lookups outside of the picture to its edge.
    pub clamps: bool,
}

/// Why a file can't be read as a picture.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file can't be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It is neither a PNG nor a JPEG.
    #[error("is neither PNG nor JPEG: convert it")]
    Kind,
    /// It is a JPEG, and this build of the library has no JPEG decoder.
    #[cfg(not(feature = "formats"))]
    #[error("is a JPEG, which is read with the feature `formats`: convert it to PNG, or switch that on")]
    Jpeg,
    /// It is not valid in its format; the decoder's message.
    #[error("is broken ({0}): write it again")]
    Broken(String),
    /// Its header states a size that no GPU supports.
    #[error("is {0}x{1} texels, and at most {MOST_SIDE} are taken along a side: scale it down")]
    Size(u64, u64),
    /// It has too many texels together with the pictures before it.
    #[error("is one picture too many: together they may have {} million texels", MOST_TEXELS >> 20)]
    TooMany,
}

impl fmt::Debug for TextureImage {
    /// Without its texels.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TextureImage { name, size, hash, .. } = self;
        f.debug_struct("Picture").field("name", name).field("size", size).field("hash", hash).finish_non_exhaustive()
    }
}

impl PartialEq for TextureImage {
    fn eq(&self, other: &TextureImage) -> bool {
        self.hash == other.hash && self.size == other.size
    }
}

impl TextureImage {
    /// Returns a picture of these sRGB texels, row by row from the top, with alpha; `None` where their number does not
    /// match the size, or a side is 0 or more than 8192.
    pub fn new(name: impl Into<String>, size: [u32; 2], texels: Vec<[u8; 4]>) -> Option<TextureImage> {
        let is_sized = size.iter().all(|side| (1..=MOST_SIDE).contains(side))
            && texels.len() as u64 == u64::from(size[0]) * u64::from(size[1]);
        let mut hasher = FixedState::default().build_hasher();
        hasher.write(texels.as_flattened());
        let (name, hash) = (name.into(), hasher.finish());
        is_sized.then(|| TextureImage { name, size, texels, hash, levels: OnceLock::new() })
    }

    /// Reads a PNG or a JPEG.
    pub fn load(path: &Path) -> Result<TextureImage, ImageError> {
        TextureImage::load_within(path, MOST_TEXELS)
    }

    /// Reads a PNG or a JPEG of at most `most` texels; its name is the file's.
    pub fn load_within(path: &Path, most: u64) -> Result<TextureImage, ImageError> {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        TextureImage::decode(name, &read_plain(path, MOST_FILE)?, most)
    }

    /// Decodes the bytes of a PNG or a JPEG of at most `most` texels.
    pub fn decode(name: String, bytes: &[u8], most: u64) -> Result<TextureImage, ImageError> {
        let (size, texels) = match bytes {
            [0x89, b'P', b'N', b'G', ..] => png(bytes, most)?,
            [0xff, 0xd8, 0xff, ..] => jpeg(bytes, most)?,
            _ => return Err(ImageError::Kind),
        };
        TextureImage::new(name, size, texels).ok_or_else(|| ImageError::Broken("texels are missing".to_owned()))
    }

    /// The most bytes that a picture's file may have.
    pub const MOST_BYTES: u64 = MOST_FILE;
    /// The most texels that the pictures of one frame may have together.
    pub const MOST_TOGETHER: u64 = MOST_TEXELS;

    /// Returns the same picture under another name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> TextureImage {
        TextureImage { name: name.into(), ..self }
    }

    /// Returns the picture's name: that of its file, or the one that it was given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the texels, sRGB and alpha, row by row from the top.
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }

    /// Returns the hash of the texels. Stable within a process only.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Returns whether any texel has an alpha other than 1; alpha is not used.
    pub fn has_alpha(&self) -> bool {
        self.texels.iter().any(|texel| texel[3] != u8::MAX)
    }

    /// Returns the number of the picture's mip levels, level 0 included, down to one texel.
    pub fn level_count(&self) -> u32 {
        self.size[0].max(self.size[1]).ilog2() + 1
    }

    /// Returns the picture's mip levels from level 1 on (index 0), each half the size of the one before, down to one
    /// texel; empty for a picture of one texel. Computed on first use.
    pub fn levels(&self) -> &[MipLevel] {
        self.levels.get_or_init(|| {
            let mut levels: Vec<MipLevel> = Vec::new();
            while levels.len() + 1 < self.level_count() as usize {
                let level = levels
                    .last()
                    .map_or_else(|| halved(self.size, &self.texels), |last| halved(last.size, &last.texels));
                levels.push(level);
            }
            levels
        })
    }

    /// Returns the size and texels of a mip level, 0 is the picture itself; of the last level for a larger index.
    fn level(&self, index: u32) -> ([u32; 2], &[[u8; 4]]) {
        match index.min(self.level_count() - 1).checked_sub(1).map(|above| &self.levels()[above as usize]) {
            None => (self.size, &self.texels),
            Some(level) => (level.size, &level.texels),
        }
    }

    /// Samples the texture trilinearly: returns linear RGB at `uv` (0, 0 at the picture's lower left, 1, 1 at its upper
    /// right) and mip level `level`, which may lie between two. `clamps` clamps to the edge; otherwise the texture
    /// repeats.
    pub fn linear_at(&self, uv: [f64; 2], level: f64, clamps: bool) -> [f64; 3] {
        let level = level.clamp(0.0, f64::from(self.level_count() - 1));
        let [near, far] = [level.floor(), level.floor() + 1.0].map(|index| self.smooth_at(uv, index as u32, clamps));
        let share = level.fract();
        [0, 1, 2].map(|channel| near[channel] * (1.0 - share) + far[channel] * share)
    }

    /// Returns column and row, from the upper left, of the texel of level 0 in which texture coordinates lie (0, 0 is
    /// the lower left); beyond the picture it repeats, or is clamped to the edge.
    pub fn texel_at(&self, [u, v]: [f64; 2], clamps: bool) -> [u32; 2] {
        let [width, height] = self.size.map(i64::from);
        let inside = |at: f64, count: i64| wrapped((at * count as f64).floor() as i64, count, clamps) as u32;
        [inside(u, width), inside(1.0 - v, height)]
    }

    /// Returns the average of all texels, linear.
    pub fn mean(&self) -> [f64; 3] {
        self.linear_at([0.5; 2], f64::from(self.level_count()), false)
    }

    /// Returns linear RGB of the four nearest texels of a mip level, mixed bilinearly, at texture coordinates whose
    /// origin is the lower left; beyond the picture it repeats, or is clamped.
    fn smooth_at(&self, [u, v]: [f64; 2], level: u32, clamps: bool) -> [f64; 3] {
        let ([width, height], texels) = self.level(level);
        let [x, y] = [u * f64::from(width) - 0.5, (1.0 - v) * f64::from(height) - 0.5];
        // Beyond the range of an integer, any texel is as right as another.
        let [column, row] = [x, y].map(|at| at.floor().clamp(-1e15, 1e15) as i64);
        let [right, down] = [x - x.floor(), y - y.floor()];
        let texel = |column: i64, row: i64| {
            let [column, row] = [wrapped(column, width.into(), clamps), wrapped(row, height.into(), clamps)];
            texels[(row * i64::from(width) + column) as usize]
        };
        let four = [
            (texel(column, row), (1.0 - right) * (1.0 - down)),
            (texel(column + 1, row), right * (1.0 - down)),
            (texel(column, row + 1), (1.0 - right) * down),
            (texel(column + 1, row + 1), right * down),
        ];
        [0, 1, 2].map(|channel| four.iter().map(|(texel, share)| linear(texel[channel]) * share).sum())
    }
}

/// Reads each picture once, broken ones too, within a budget of texels.
#[derive(Debug)]
pub(super) struct ImageLoader {
    known: BTreeMap<PathBuf, Arc<TextureImage>>,
    /// Error messages of the files that can't be read.
    broken: BTreeMap<PathBuf, String>,
    left: u64,
}

impl Default for ImageLoader {
    fn default() -> ImageLoader {
        ImageLoader { known: BTreeMap::new(), broken: BTreeMap::new(), left: MOST_TEXELS }
    }
}

impl ImageLoader {
    /// Returns the picture in a file, which is read and counted against the budget of texels once; one that was found
    /// broken is not read again.
    pub fn load(&mut self, path: &Path) -> Result<Arc<TextureImage>, ImageError> {
        if let Some(known) = self.known.get(path) {
            return Ok(Arc::clone(known));
        }
        if let Some(why) = self.broken.get(path) {
            return Err(ImageError::Broken(why.clone()));
        }
        let picture = TextureImage::load_within(path, self.left).inspect_err(|error| {
            if let ImageError::Broken(why) = error {
                self.broken.insert(path.to_owned(), why.clone());
            }
        })?;
        Ok(self.add(path, picture))
    }

    /// Returns the picture in these bytes, which are read once; `path` identifies it, and `described` names it in an
    /// error.
    ///
    /// # Errors
    /// As [`ImageLoader::load`], or why there are no bytes; in a few words.
    #[cfg(feature = "formats")]
    pub fn load_bytes(
        &mut self,
        path: &Path,
        name: &str,
        described: &str,
        bytes: impl FnOnce() -> Result<Vec<u8>, String>,
    ) -> Result<Arc<TextureImage>, String> {
        if let Some(known) = self.known.get(path) {
            return Ok(Arc::clone(known));
        }
        if let Some(why) = self.broken.get(path) {
            return Err(why.clone());
        }
        let described = |error: ImageError| format!("{} {error}", described);
        let picture =
            bytes().and_then(|bytes| TextureImage::decode(name.to_owned(), &bytes, self.left).map_err(described));
        let picture = picture.inspect_err(|why| {
            self.broken.insert(path.to_owned(), why.clone());
        })?;
        Ok(self.add(path, picture))
    }

    fn add(&mut self, path: &Path, picture: TextureImage) -> Arc<TextureImage> {
        let picture = Arc::new(picture);
        self.left -= picture.texels.len() as u64;
        self.known.insert(path.to_owned(), Arc::clone(&picture));
        picture
    }
}

/// Returns the column or row inside the picture, of `count`, for one that may be beyond it: the nearest where it
/// clamps, otherwise as if the picture repeated.
fn wrapped(at: i64, count: i64, clamps: bool) -> i64 {
    if clamps { at.clamp(0, count - 1) } else { at.rem_euclid(count) }
}

/// Returns the linear value of an sRGB value (IEC 61966-2-1).
fn decoded(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Returns the linear value of an sRGB byte.
fn linear(byte: u8) -> f64 {
    static TABLE: OnceLock<[f64; 256]> = OnceLock::new();
    TABLE.get_or_init(|| std::array::from_fn(|byte| decoded(byte as f64 / 255.0)))[usize::from(byte)]
}

/// Returns the nearest sRGB byte of a linear value.
fn encoded(value: f64) -> u8 {
    /// Linear values halfway from each byte to the next.
    static ENDS: OnceLock<[f64; 255]> = OnceLock::new();
    let ends = ENDS.get_or_init(|| std::array::from_fn(|byte| decoded((byte as f64 + 0.5) / 255.0)));
    ends.partition_point(|end| *end <= value) as u8
}

/// Returns the next mip level: half as many texels along each side, and at least one; of an odd number the last are
/// dropped, as GPUs do.
fn halved([width, height]: [u32; 2], texels: &[[u8; 4]]) -> MipLevel {
    let size = [width, height].map(|side| (side / 2).max(1));
    let at = |x: u32, y: u32| texels[(y.min(height - 1) * width + x.min(width - 1)) as usize];
    let texel = |x: u32, y: u32| {
        let four = [at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)];
        let mean = |channel: usize| encoded(four.iter().map(|texel| linear(texel[channel])).sum::<f64>() / 4.0);
        let alpha = four.iter().map(|texel| u32::from(texel[3])).sum::<u32>();
        [mean(0), mean(1), mean(2), ((alpha + 2) / 4) as u8]
    };
    let row = |y: u32| (0..size[0]).map(move |x| texel(x, y));
    MipLevel { size, texels: (0..size[1]).into_par_iter().flat_map_iter(row).collect() }
}

fn checked_size(width: u64, height: u64, most: u64) -> Result<[u32; 2], ImageError> {
    let side = |n: u64| u32::try_from(n).ok().filter(|n| (1..=MOST_SIDE).contains(n));
    match [side(width), side(height)] {
        [Some(_), Some(_)] if width * height > most => Err(ImageError::TooMany),
        [Some(width), Some(height)] => Ok([width, height]),
        _ => Err(ImageError::Size(width, height)),
    }
}

type DecodedImage = ([u32; 2], Vec<[u8; 4]>);

fn png(bytes: &[u8], most: u64) -> Result<DecodedImage, ImageError> {
    let broken = |error: png::DecodingError| ImageError::Broken(in_a_line(&error.to_string()));
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let info = decoder.read_header_info().map_err(broken)?;
    let size = checked_size(info.width.into(), info.height.into(), most)?;
    let mut reader = decoder.read_info().map_err(broken)?;
    let length = reader.output_buffer_size().ok_or(ImageError::Size(size[0].into(), size[1].into()))?;
    let mut data = vec![0; length];
    let frame = reader.next_frame(&mut data).map_err(broken)?;
    data.truncate(frame.buffer_size());
    let texels = with_alpha(&data, frame.color_type.samples());
    Ok((size, texels))
}

#[cfg(feature = "formats")]
fn jpeg(bytes: &[u8], most: u64) -> Result<DecodedImage, ImageError> {
    use zune_jpeg::zune_core::{colorspace::ColorSpace, options::DecoderOptions};
    let broken = |error: zune_jpeg::errors::DecodeErrors| ImageError::Broken(in_a_line(&error.to_string()));
    // The limit of sizes is checked here, not by the decoder.
    let options = DecoderOptions::default()
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .set_strict_mode(true)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(Cursor::new(bytes), options);
    decoder.decode_headers().map_err(broken)?;
    let info = decoder.info().ok_or_else(|| ImageError::Broken("it has no size".to_owned()))?;
    let size = checked_size(info.width.into(), info.height.into(), most)?;
    let data = decoder.decode().map_err(broken)?;
    Ok((size, with_alpha(&data, 3)))
}

#[cfg(not(feature = "formats"))]
fn jpeg(_: &[u8], _: u64) -> Result<DecodedImage, ImageError> {
    Err(ImageError::Jpeg)
}

/// Converts texels of `samples` bytes (grey, grey and alpha, RGB or RGBA) to RGBA, opaque where there is no alpha; an
/// incomplete last texel is dropped.
fn with_alpha(data: &[u8], samples: usize) -> Vec<[u8; 4]> {
    let texel = |of: &[u8]| match *of {
        [grey] => [grey, grey, grey, u8::MAX],
        [grey, alpha] => [grey, grey, grey, alpha],
        [red, green, blue] => [red, green, blue, u8::MAX],
        [red, green, blue, alpha, ..] => [red, green, blue, alpha],
        [] => [0; 4],
    };
    data.chunks_exact(samples.max(1)).map(texel).collect()
}

/// Returns a decoder's message in one line, at most 100 characters, without a full stop at the end.
fn in_a_line(text: &str) -> String {
    const MOST: usize = 100;
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    line.trim().trim_end_matches('.').chars().take(MOST).collect()
}

#[cfg(test)]
mod tests;
