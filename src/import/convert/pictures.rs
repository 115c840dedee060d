//! What RenderDoc read back as pictures of a capture: each array once.

use crate::capture::{Image, PixelFormat};
use crate::import::raw::{RawContents, RawFormat};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a target holds; absent where it is not known.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Held {
    pub color: Option<Arc<Image>>,
    pub depth: Option<Arc<Image>>,
    pub stencil: Option<Arc<Image>>,
}

/// Pictures by the place of their array in memory, which the frame keeps.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    made: BTreeMap<(usize, [u32; 2]), Arc<Image>>,
}

impl Pictures {
    /// What an event left in targets of that size, of which the depth target has that format.
    pub fn held(&mut self, after: &RawContents, format: &RawFormat, size: [u32; 2]) -> Held {
        let steps = format.largest_depth().filter(|_| after.depth_bits.is_some());
        let depth = match (steps, &after.depth_bits, &after.depth) {
            // As the GPU divides, so that a frame that is run again may leave the same bits.
            (Some(steps), Some(bits), _) => self.made(bits, PixelFormat::Depth32F, size, |bits| {
                bits.iter().flat_map(|depth| (*depth as f32 / steps as f32).to_le_bytes()).collect()
            }),
            (_, _, Some(depth)) => self.made(depth, PixelFormat::Depth32F, size, |depth| {
                depth.iter().flat_map(|depth| depth.to_le_bytes()).collect()
            }),
            _ => None,
        };
        let stencil = after.stencil.as_ref();
        let stencil = stencil.and_then(|stencil| self.made(stencil, PixelFormat::U8, size, <[u8]>::to_vec));
        let color = after.color.as_ref();
        let color = color.and_then(|color| self.made(color, PixelFormat::Rgba8Srgb, size, <[u8]>::to_vec));
        Held { color, depth, stencil }
    }

    /// `None` where the array has another size.
    fn made<T>(
        &mut self,
        array: &Arc<[T]>,
        format: PixelFormat,
        size: [u32; 2],
        bytes: impl FnOnce(&[T]) -> Vec<u8>,
    ) -> Option<Arc<Image>> {
        let key = (array.as_ptr() as usize, size);
        if let Some(known) = self.made.get(&key) {
            return Some(known.clone());
        }
        let bytes = bytes(array);
        let is_whole = bytes.len() == size[0] as usize * size[1] as usize * format.texel_bytes();
        let image = is_whole.then(|| Arc::new(Image::packed(format, size, bytes)))?;
        self.made.insert(key, image.clone());
        Some(image)
    }
}

/// The one texel that is everywhere, if it is.
pub(super) fn uniform(image: &Image) -> Option<Vec<u8>> {
    let texel = image.format().texel_bytes();
    let first = image.rows().next()?.get(..texel)?.to_vec();
    image.rows().all(|row| row.chunks_exact(texel).all(|one| one == first)).then_some(first)
}
