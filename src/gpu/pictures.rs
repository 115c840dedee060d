//! Pictures on surfaces, with their pyramids, by the hash of their content.
//!
//! Equal pictures are uploaded once, and stay as long as the newest plan uses them. Levels are made on the CPU
//! ([`TextureImage::levels`]), so that a lookup can be computed again.

use super::GpuContext;
use crate::last_used::LastUsed;
use crate::scene::TextureImage;
use wgpu::{Extent3d, TextureUsages, TextureView, TextureViewDescriptor};

/// The hash of a picture's content, and its width and height in texels.
type Key = (u64, [u32; 2]);

#[derive(Debug, Default)]
pub(super) struct Pictures {
    cached: LastUsed<Key, TextureView>,
}

impl Pictures {
    /// Drops the textures that [`get`](Self::get) has not returned since the last call.
    pub fn next_plan(&mut self) {
        self.cached.next_plan();
    }

    /// Returns the texture of a picture with all its mip levels, uploaded on first use.
    pub fn get(&mut self, context: &GpuContext, picture: &TextureImage) -> TextureView {
        self.cached.get_or_make((picture.hash(), picture.size()), || upload(context, picture))
    }
}

fn upload(context: &GpuContext, picture: &TextureImage) -> TextureView {
    let extent = |[width, height]: [u32; 2]| Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(picture.name()),
        size: extent(picture.size()),
        mip_level_count: picture.level_count(),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let first = (picture.size(), picture.texels());
    let others = picture.levels().iter().map(|level| (level.size, level.texels.as_slice()));
    for (mip_level, (size, texels)) in (0..).zip(std::iter::once(first).chain(others)) {
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size[0] * 4), rows_per_image: None };
        let target = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        context.queue.write_texture(target, texels.as_flattened(), layout, extent(size));
    }
    texture.create_view(&TextureViewDescriptor::default())
}
