//! Textures, their views, samplers, and pictures from outside.

use wgpu::custom::{
    DispatchTextureView, ExternalTextureInterface, SamplerInterface, TextureInterface, TextureViewInterface,
};

/// A wrapped texture: hands each call to the real one.
#[derive(Debug)]
pub struct Texture {
    pub inner: wgpu::Texture,
}

/// Returns the usage that a texture is created with: as asked, and for a render target also as the source of copies,
/// unless it is transient or multisampled.
pub fn usage(asked: &wgpu::TextureDescriptor<'_>) -> wgpu::TextureUsages {
    use wgpu::TextureUsages as Usages;
    let is_target = asked.usage.contains(Usages::RENDER_ATTACHMENT);
    if !is_target || asked.usage.contains(Usages::TRANSIENT_ATTACHMENT) || asked.sample_count > 1 {
        return asked.usage;
    }
    asked.usage | Usages::COPY_SRC
}

impl TextureInterface for Texture {
    fn create_view(&self, descriptor: &wgpu::TextureViewDescriptor<'_>) -> DispatchTextureView {
        let part = ViewSubresource { mip: descriptor.base_mip_level, layer: descriptor.base_array_layer };
        DispatchTextureView::custom(TextureView { inner: self.inner.create_view(descriptor), part })
    }

    fn destroy(&self) {
        self.inner.destroy();
    }
}

/// The mip level and layer where a view begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewSubresource {
    pub mip: u32,
    pub layer: u32,
}

/// A wrapped texture view: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct TextureView {
    pub inner: wgpu::TextureView,
    pub part: ViewSubresource,
}

impl TextureViewInterface for TextureView {}

/// A wrapped sampler: hands each call to the real one.
#[derive(Debug)]
pub struct Sampler {
    pub inner: wgpu::Sampler,
}

impl SamplerInterface for Sampler {}

/// A wrapped external texture: hands each call to the real one.
#[derive(Debug)]
pub struct ExternalTexture {
    pub inner: wgpu::ExternalTexture,
}

impl ExternalTextureInterface for ExternalTexture {
    fn destroy(&self) {
        self.inner.destroy();
    }
}
