//! Pictures as egui textures, and statistics of whole pictures.
//!
//! A texture is made once for an image and a colouring and cached, so that stepping back and forth shows in the next
//! frame. Images are distinguished by their `Arc`, which the cache keeps alive, so that a new image can't be taken for
//! an old one at the same address.

use crate::capture::{Image, PixelFormat};
use crate::inspector::look::coloring::{self, Coloring};
use crate::inspector::look::findings;
use crate::inspector::look::palette;
use crate::picture::{Picture, colors::Rgb};
use crate::reading::counts::{self, Tally};
use crate::reading::depth::DepthMeasure;
use egui::{Color32, ColorImage, Context, TextureFilter, TextureHandle, TextureOptions};
use std::ops::Range;
use std::sync::Arc;

/// Bytes of textures that are cached, beyond those of the current frame.
const CACHED_BYTES: usize = 384 << 20;
/// Largest side of a thumbnail in texels: twice the points, for sharp screens.
const THUMBNAIL_SIDE: u32 = 112;

/// The textures and statistics of images, computed on first use and found again by the image's address, not its
/// content.
#[derive(Default)]
pub struct PictureCache {
    textures: Vec<CachedTexture>,
    histograms: Vec<(Arc<Image>, Box<[u64; 256]>)>,
    tallies: Vec<(Arc<Image>, Arc<Tally>)>,
    shares: Vec<(Arc<Image>, LightShares)>,
    ranges: Vec<(Arc<Image>, DepthMeasure, Option<[f64; 2]>)>,
    depth_histogram: Option<(Arc<Image>, DepthMeasure, [f64; 2], DepthHistogram)>,
    clock: u64,
}

/// How many texels of a picture let all of the light through, none of it, or a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LightShares {
    /// All: white.
    pub all: u64,
    /// None: black.
    pub none: u64,
    /// A part: any other colour.
    pub part: u64,
}

/// The number of bars in a histogram of depths.
pub const DEPTH_BARS: usize = 48;
/// How many texels lie in each of [`DEPTH_BARS`] equal parts of a range of depths, the smallest first.
pub type DepthHistogram = [u64; DEPTH_BARS];

/// The resolution that is needed of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureSize {
    /// One texel for each of the image's, unless the GPU allows no texture of that size.
    Full,
    /// At least so many texels each way become one; only pictures of findings are reduced so, and the worst is shown.
    Blocks(u32),
    /// At most [`THUMBNAIL_SIDE`].
    Thumbnail,
}

struct CachedTexture {
    image: Arc<Image>,
    coloring: Coloring,
    size: TextureSize,
    handle: TextureHandle,
    last_used: u64,
}

impl PictureCache {
    /// Counts a frame, and drops the textures unused for longest while all of them take more than 384 MiB; those used
    /// in this frame or the last stay. Call it once a frame.
    pub fn tick(&mut self) {
        self.clock += 1;
        let mut bytes: usize = self.textures.iter().map(|texture| texture.handle.byte_size()).sum();
        while bytes > CACHED_BYTES {
            let oldest = self.textures.iter().enumerate().min_by_key(|(_, texture)| texture.last_used);
            let Some((index, oldest)) = oldest.filter(|(_, texture)| texture.last_used + 1 < self.clock) else { break };
            bytes -= oldest.handle.byte_size();
            self.textures.swap_remove(index);
        }
    }

    /// Drops textures and statistics of images that nothing outside this cache refers to any longer.
    pub fn forget_unused(&mut self) {
        let own_uses = |image: &Arc<Image>| {
            let textures = self.textures.iter().filter(|texture| Arc::ptr_eq(&texture.image, image)).count();
            let histograms = self.histograms.iter().filter(|(of, _)| Arc::ptr_eq(of, image)).count();
            let tallies = self.tallies.iter().filter(|(of, _)| Arc::ptr_eq(of, image)).count();
            let shares = self.shares.iter().filter(|(of, _)| Arc::ptr_eq(of, image)).count();
            let ranges = self.ranges.iter().filter(|(of, _, _)| Arc::ptr_eq(of, image)).count();
            let bars = self.depth_histogram.iter().filter(|(of, ..)| Arc::ptr_eq(of, image)).count();
            textures + histograms + tallies + shares + ranges + bars
        };
        let is_used = |image: &Arc<Image>| Arc::strong_count(image) > own_uses(image);
        let textures: Vec<bool> = self.textures.iter().map(|texture| is_used(&texture.image)).collect();
        let histograms: Vec<bool> = self.histograms.iter().map(|(image, _)| is_used(image)).collect();
        let tallies: Vec<bool> = self.tallies.iter().map(|(image, _)| is_used(image)).collect();
        let shares: Vec<bool> = self.shares.iter().map(|(image, _)| is_used(image)).collect();
        let ranges: Vec<bool> = self.ranges.iter().map(|(image, _, _)| is_used(image)).collect();
        if self.depth_histogram.as_ref().is_some_and(|(image, ..)| !is_used(image)) {
            self.depth_histogram = None;
        }
        keep_where(&mut self.textures, &textures);
        keep_where(&mut self.histograms, &histograms);
        keep_where(&mut self.tallies, &tallies);
        keep_where(&mut self.shares, &shares);
        keep_where(&mut self.ranges, &ranges);
    }

    /// Returns the texture of `image` in `coloring`, cached by image, colouring and size. An image too large for the
    /// size is drawn with every n-th texel, or, for findings, the worst of each block. A new range of depths replaces
    /// the textures of earlier ranges.
    pub fn texture(
        &mut self,
        ctx: &Context,
        image: &Arc<Image>,
        coloring: Coloring,
        size: TextureSize,
    ) -> TextureHandle {
        let clock = self.clock;
        let is_it = |cached: &CachedTexture| {
            Arc::ptr_eq(&cached.image, image) && cached.size == size && cached.coloring == coloring
        };
        if let Some(cached) = self.textures.iter_mut().find(|cached| is_it(cached)) {
            cached.last_used = clock;
            return cached.handle.clone();
        }
        let side = match size {
            TextureSize::Full | TextureSize::Blocks(_) => ctx.input(|input| input.max_texture_side) as u32,
            TextureSize::Thumbnail => THUMBNAIL_SIDE,
        };
        let picture = match (coloring, size) {
            (Coloring::Findings, TextureSize::Blocks(block)) => {
                findings::colored(image, thinning(image, side).max(block as usize))
            }
            _ => colored(image, coloring, side),
        };
        let handle = ctx.load_texture("picture", picture, options(coloring));
        // While a range is dragged only its latest texture is worth caching.
        if let Coloring::Depth(_) = coloring {
            let is_older = |cached: &CachedTexture| {
                Arc::ptr_eq(&cached.image, image) && cached.size == size && cached.last_used < clock
            };
            self.textures.retain(|cached| !is_older(cached));
        }
        let image = Arc::clone(image);
        self.textures.push(CachedTexture { image, coloring, size, handle: handle.clone(), last_used: clock });
        handle
    }

    /// Returns how many texels of a picture of bytes have each value; cached.
    pub fn histogram(&mut self, image: &Arc<Image>) -> [u64; 256] {
        if let Some((_, histogram)) = self.histograms.iter().find(|(of, _)| Arc::ptr_eq(of, image)) {
            return **histogram;
        }
        let histogram = image.histogram();
        self.histograms.push((Arc::clone(image), Box::new(histogram)));
        histogram
    }

    /// Returns how many texels of a picture of float counts have each count, rounded to whole numbers; cached.
    pub fn tally(&mut self, image: &Arc<Image>) -> Arc<Tally> {
        if let Some((_, tally)) = self.tallies.iter().find(|(of, _)| Arc::ptr_eq(of, image)) {
            return tally.clone();
        }
        let tally = Arc::new(counts::tally(image));
        self.tallies.push((Arc::clone(image), tally.clone()));
        tally
    }

    /// Returns how many texels of a colour picture let all light through (white), none (black), or a part (any other
    /// colour), alpha ignored; of a picture of floats, how many are 1, 0 and between; cached.
    pub fn shares(&mut self, image: &Arc<Image>) -> LightShares {
        if let Some((_, shares)) = self.shares.iter().find(|(of, _)| Arc::ptr_eq(of, image)) {
            return *shares;
        }
        let shares = shares_of(image);
        self.shares.push((Arc::clone(image), shares));
        shares
    }

    /// Returns how many texels of a depth picture lie in each of [`DEPTH_BARS`] equal parts of `range`, which includes
    /// both ends and is in the unit of `measure`. Texels outside it or without a depth are not counted. Only the last
    /// result is cached.
    pub fn depth_histogram(&mut self, image: &Arc<Image>, measure: DepthMeasure, range: [f64; 2]) -> DepthHistogram {
        if let Some((of, by, over, bars)) = &self.depth_histogram
            && Arc::ptr_eq(of, image)
            && (*by, *over) == (measure, range)
        {
            return *bars;
        }
        let bars = depth_bars(image, measure, range);
        self.depth_histogram = Some((Arc::clone(image), measure, range, bars));
        bars
    }

    /// Returns the smallest and largest finite depth of a picture in the unit of `measure`; `None` where no texel has
    /// one; cached.
    pub fn depth_range(&mut self, image: &Arc<Image>, measure: DepthMeasure) -> Option<[f64; 2]> {
        let known = self.ranges.iter().find(|(of, by, _)| Arc::ptr_eq(of, image) && *by == measure);
        if let Some((_, _, range)) = known {
            return *range;
        }
        let range = measure.range_of(image);
        self.ranges.push((Arc::clone(image), measure, range));
        range
    }
}

impl std::fmt::Debug for PictureCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "PictureCache({} textures)", self.textures.len())
    }
}

fn keep_where<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut flags = keep.iter();
    items.retain(|_| flags.next().copied().unwrap_or(false));
}

/// Exact texels when magnified; counts and labels stay exact when made smaller, too.
fn options(coloring: Coloring) -> TextureOptions {
    let minification = match coloring {
        Coloring::Srgb | Coloring::Linear | Coloring::Depth(_) => TextureFilter::Linear,
        _ => TextureFilter::Nearest,
    };
    TextureOptions { magnification: TextureFilter::Nearest, minification, ..TextureOptions::NEAREST }
}

/// Returns how many texels become one, each way, so that a texture of the image has at most `most` texels a side; at
/// least 1.
fn thinning(image: &Image, most: u32) -> usize {
    let [width, height] = image.size();
    width.max(height).div_ceil(most.max(1)).max(1) as usize
}

/// Returns the picture in its colours. Where it has more than `most` texels a side, only every n-th texel each way, or,
/// for findings, the worst of each block.
fn colored(image: &Image, coloring: Coloring, most: u32) -> ColorImage {
    let [width, height] = image.size();
    let step = thinning(image, most);
    if coloring == Coloring::Findings {
        return findings::colored(image, step);
    }
    let size = [(width as usize).div_ceil(step), (height as usize).div_ceil(step)];
    let mut pixels: Vec<Color32> = Vec::with_capacity(size[0] * size[1]);
    for row in image.rows().step_by(step) {
        match coloring {
            Coloring::Srgb => pixels.extend(texels(row, 4, step).map(|t| Color32::from_rgb(t[0], t[1], t[2]))),
            Coloring::Linear => {
                pixels.extend(texels(row, 4, step).map(|t| coloring::linear([t[0], t[1], t[2], t[3]])));
            }
            Coloring::Count => {
                pixels.extend(texels(row, 4, step).map(|t| palette::count(bytemuck::pod_read_unaligned(t))));
            }
            Coloring::Visibility => {
                pixels.extend(texels(row, 4, step).map(|t| coloring::visibility(bytemuck::pod_read_unaligned(t))));
            }
            Coloring::Stencil => pixels.extend(row.iter().step_by(step).map(|value| palette::stencil(*value))),
            Coloring::Labels => pixels.extend(row.iter().step_by(step).map(|value| palette::label(*value))),
            Coloring::Findings => pixels.extend(row.iter().step_by(step).map(|value| findings::color(*value))),
            Coloring::Bit(bit) => {
                pixels.extend(row.iter().step_by(step).map(|value| coloring::bit_color(*value, bit)));
            }
            Coloring::Outcomes => pixels
                .extend(row.iter().step_by(step).map(|value| palette::outcome(*value).gamma_multiply(coloring::OVER))),
            Coloring::Receivers => pixels.extend(row.iter().step_by(step).map(|value| palette::receiver(*value))),
            Coloring::Overdraw => pixels.extend(row.iter().step_by(step).map(|value| palette::overdraw(*value))),
            Coloring::CountChange => {
                pixels.extend(row.iter().step_by(step).map(|by| coloring::count_color(*by as i8)));
            }
            Coloring::DepthChange => {
                pixels.extend(texels(row, 4, step).map(|t| coloring::depth_color(bytemuck::pod_read_unaligned(t))));
            }
            Coloring::ColorChange => {
                pixels.extend(texels(row, 4, step).map(|t| coloring::changed([t[0], t[1], t[2], t[3]])));
            }
            Coloring::Depth(scale) => {
                pixels.extend(texels(row, 4, step).map(|t| coloring::depth(scale, bytemuck::pod_read_unaligned(t))));
            }
        }
    }
    ColorImage::new(size, pixels)
}

fn depth_bars(image: &Image, measure: DepthMeasure, [low, high]: [f64; 2]) -> DepthHistogram {
    let mut bars = [0; DEPTH_BARS];
    let scale = DEPTH_BARS as f64 / (high - low).max(f64::MIN_POSITIVE);
    for texel in image.rows().flat_map(|row| row.chunks_exact(4)) {
        let Some(value) = measure.value(bytemuck::pod_read_unaligned(texel)) else { continue };
        if (low..=high).contains(&value) {
            bars[(((value - low) * scale) as usize).min(DEPTH_BARS - 1)] += 1;
        }
    }
    bars
}

/// Returns the picture in its colours, one pixel for each texel, for a file; alpha is dropped, so that see-through
/// colours lie on black.
pub fn picture(image: &Image, coloring: Coloring) -> Picture {
    let colored = colored(image, coloring, u32::MAX);
    let [width, height] = image.size();
    let mut picture = Picture::filled([width, height], [0; 3]);
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    for (at, color) in places.zip(&colored.pixels) {
        let [red, green, blue, _] = color.to_array();
        picture.set(at, [red, green, blue]);
    }
    picture
}

/// Blends the columns `columns` of `image`, in its colours, over those of another picture; where a colour is
/// see-through, the other picture stays.
pub fn lay_over(picture: &mut Picture, image: &Image, coloring: Coloring, columns: Range<u32>) {
    let colored = colored(image, coloring, u32::MAX);
    let [width, height] = image.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    for (at, color) in places.zip(&colored.pixels).filter(|([x, _], _)| columns.contains(x)) {
        if let Some(under) = picture.at(at) {
            picture.set(at, over(*color, under));
        }
    }
}

/// Blends a colour, which is premultiplied by its alpha, over another.
pub fn over(color: Color32, under: Rgb) -> Rgb {
    let [red, green, blue, alpha] = color.to_array();
    let stays = |under: u8| (u16::from(under) * u16::from(255 - alpha) / 255) as u8;
    let over = [red, green, blue];
    std::array::from_fn(|channel| over[channel].saturating_add(stays(under[channel])))
}

fn shares_of(image: &Image) -> LightShares {
    let mut shares = LightShares::default();
    for row in image.rows() {
        for texel in row.chunks_exact(4) {
            let [least, most] = match image.format() {
                PixelFormat::Value32F => [bytemuck::pod_read_unaligned(texel); 2],
                _ => [texel[..3].iter().min(), texel[..3].iter().max()]
                    .map(|byte| f32::from(*byte.unwrap_or(&0)) / 255.0),
            };
            match [least >= 1.0, most <= 0.0] {
                [true, _] => shares.all += 1,
                [_, true] => shares.none += 1,
                _ => shares.part += 1,
            }
        }
    }
    shares
}

fn texels(row: &[u8], bytes: usize, step: usize) -> impl Iterator<Item = &[u8]> {
    row.chunks_exact(bytes).step_by(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stencil_values_take_their_palette_colours_row_by_row() {
        let image = Image::from_rows(PixelFormat::U8, [2, 2], 4, vec![0, 1, 9, 9, 255, 2, 9, 9]);
        let picture = colored(&image, Coloring::Stencil, 16);
        assert_eq!(picture.size, [2, 2]);
        assert_eq!(picture.pixels, [0, 1, 255, 2].map(palette::stencil));
    }

    #[test]
    fn a_picture_too_large_for_the_gpu_is_thinned() {
        let image = Image::uniform(PixelFormat::U8, [1000, 10], &[3]);
        let picture = colored(&image, Coloring::Stencil, 300);
        assert_eq!(picture.size, [250, 3]);
    }

    #[test]
    fn images_that_left_with_their_capture_are_forgotten() {
        let ctx = Context::default();
        let mut cache = PictureCache::default();
        let [cached, gone] = [1, 2].map(|value| Arc::new(Image::uniform(PixelFormat::U8, [2, 2], &[value])));
        for image in [&cached, &gone] {
            let _kept_by_the_cache = cache.texture(&ctx, image, Coloring::Stencil, TextureSize::Full);
            assert_eq!(cache.histogram(image).iter().sum::<u64>(), 4);
        }
        drop(gone);
        cache.forget_unused();
        assert_eq!(cache.textures.len(), 1);
        assert!(Arc::ptr_eq(&cache.textures[0].image, &cached));
        assert_eq!(cache.histograms.len(), 1);
    }
}
