//! Pictures as textures: each image is converted once for each way of showing it.
//!
//! An image is known by its shared pointer, which the cache keeps alive, so that stepping back and
//! forth finds every picture ready in the next frame. The least recently shown go first.

use super::palette::{label_color, stencil_color};
use crate::capture::Image;
use egui::{Color32, ColorImage, Context, TextureHandle, TextureOptions};
use std::sync::Arc;

/// Texels kept on the GPU before the oldest pictures go.
const MOST_TEXELS: usize = 64 << 20;
/// Depth pictures whose range is kept.
const MOST_ENDS: usize = 64;
/// Longest side of a thumbnail in texels.
pub(super) const THUMBNAIL: u32 = 96;

/// How texels become colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Look {
    Color,
    Stencil,
    Labels,
    /// Grey from the first end (black) to the second (white) of a stored value's distance
    /// `near / depth`, or, with no near plane, of the stored value itself.
    Depth {
        near: Option<f32>,
        ends: [f32; 2],
    },
}

struct Entry {
    image: Arc<Image>,
    look: Look,
    longest: u32,
    texture: TextureHandle,
    used_at: u64,
}

/// Converted pictures.
#[derive(Default)]
pub(super) struct Textures {
    entries: Vec<Entry>,
    clock: u64,
    ends: Vec<Ends>,
}

/// The range of a depth picture, kept because finding it reads every texel.
struct Ends {
    image: Arc<Image>,
    near: Option<f32>,
    ends: [f32; 2],
}

impl Textures {
    /// The texture of a picture, no side longer than `longest` or what the GPU allows.
    pub fn get(&mut self, context: &Context, image: &Arc<Image>, look: Look, longest: u32) -> TextureHandle {
        self.clock += 1;
        let longest = longest.min(context.input(|input| input.max_texture_side) as u32);
        let is_it = |entry: &Entry| Arc::ptr_eq(&entry.image, image) && entry.look == look && entry.longest == longest;
        if let Some(entry) = self.entries.iter_mut().find(|entry| is_it(entry)) {
            entry.used_at = self.clock;
            return entry.texture.clone();
        }
        // Exact values must not blend when many texels fall on one point; colours may.
        let options = if look == Look::Color {
            TextureOptions { minification: egui::TextureFilter::Linear, ..TextureOptions::NEAREST }
        } else {
            TextureOptions::NEAREST
        };
        let texture = context.load_texture("picture", convert(image, look, longest), options);
        self.make_room(texture.size()[0] * texture.size()[1]);
        let entry = Entry { image: image.clone(), look, longest, texture: texture.clone(), used_at: self.clock };
        self.entries.push(entry);
        texture
    }

    /// How to show a depth picture; without given `ends`, from its least to its greatest value.
    pub fn depth_look(&mut self, image: &Arc<Image>, near: Option<f32>, ends: Option<[f32; 2]>) -> Look {
        Look::Depth { near, ends: ends.unwrap_or_else(|| self.fitted_ends(image, near)) }
    }

    /// The least and greatest shown value of a depth picture.
    pub fn fitted_ends(&mut self, image: &Arc<Image>, near: Option<f32>) -> [f32; 2] {
        let is_it = |kept: &&Ends| Arc::ptr_eq(&kept.image, image) && kept.near == near;
        if let Some(kept) = self.ends.iter().find(is_it) {
            return kept.ends;
        }
        let ends = depth_ends(image, near);
        if self.ends.len() >= MOST_ENDS {
            self.ends.remove(0);
        }
        self.ends.push(Ends { image: image.clone(), near, ends });
        ends
    }

    fn make_room(&mut self, texels: usize) {
        let size = |entry: &Entry| entry.texture.size()[0] * entry.texture.size()[1];
        while !self.entries.is_empty() && self.entries.iter().map(size).sum::<usize>() + texels > MOST_TEXELS {
            let oldest = (0..self.entries.len()).min_by_key(|index| self.entries[*index].used_at).unwrap_or(0);
            self.entries.swap_remove(oldest);
        }
    }
}

/// Every `stride`th texel of every `stride`th row.
fn convert(image: &Image, look: Look, longest: u32) -> ColorImage {
    let [width, height] = image.size();
    let stride = width.max(height).div_ceil(longest.max(1)).max(1);
    let size = [width.div_ceil(stride), height.div_ceil(stride)];
    let texel_bytes = image.format().texel_bytes();
    let mut pixels = Vec::with_capacity(size[0] as usize * size[1] as usize);
    let table: Vec<Color32> = match look {
        Look::Stencil => (0..=255).map(stencil_color).collect(),
        _ => (0..=255).map(label_color).collect(),
    };
    for y in (0..height).step_by(stride as usize) {
        let texels = image.row(y).chunks_exact(texel_bytes).step_by(stride as usize);
        match look {
            Look::Color => pixels.extend(texels.map(|texel| Color32::from_rgb(texel[0], texel[1], texel[2]))),
            Look::Stencil | Look::Labels => pixels.extend(texels.map(|texel| table[usize::from(texel[0])])),
            Look::Depth { near, ends } => pixels.extend(texels.map(|texel| {
                let stored: f32 = bytemuck::pod_read_unaligned(texel);
                Color32::from_gray(grey(near.map_or(stored, |near| near / stored), ends))
            })),
        }
    }
    ColorImage::new(size.map(|n| n as usize), pixels)
}

fn grey(value: f32, [black, white]: [f32; 2]) -> u8 {
    let t = (value - black) / (white - black);
    // Infinity over infinity and equal ends give NaN, which casts to 0.
    (t.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// The least and greatest shown value of a depth picture; texels at infinity do not count.
fn depth_ends(image: &Image, near: Option<f32>) -> [f32; 2] {
    let mut ends = [f32::INFINITY, f32::NEG_INFINITY];
    for row in image.rows() {
        for texel in row.chunks_exact(4) {
            let stored: f32 = bytemuck::pod_read_unaligned(texel);
            if stored > 0.0 {
                let value = near.map_or(stored, |near| near / stored);
                ends = [ends[0].min(value), ends[1].max(value)];
            }
        }
    }
    if ends[0] <= ends[1] { ends } else { [0.0, 1.0] }
}
