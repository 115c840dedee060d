//! Snapshots: which aspects a pass changes, and how they come back.
//!
//! What a pass can't have changed is known from its state, and a cleared aspect that nothing drew
//! into is known from its clear value: neither is copied. The rest is copied to a mappable buffer
//! between passes, in the command buffer that draws them. A mapped buffer becomes the picture's memory, unless
//! that is to be [shared](super::Memory).

use super::{GpuContext, GpuError};
use crate::capture::{Image, PixelFormat};
use crate::plan::{AttachmentRole, ColorWrite, FramePlan, Pass, StartContent};
use bytes::Bytes;
use std::sync::Arc;
use wgpu::{Buffer, BufferUsages, BufferView, CommandEncoder, Device, MapMode, Texture, TextureAspect};

const ROW_ALIGNMENT: usize = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize;

/// How a pass changes one aspect of its targets: not at all, to one value everywhere, or by drawing.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum TargetChange {
    Unchanged,
    /// Every texel has these bytes.
    Uniform(Vec<u8>),
    Drawn,
}

/// Returns whether a pass leaves its colour target unchanged, uniform (cleared and not drawn to; with the texel as
/// stored) or drawn to. Unchanged without a colour target.
pub(super) fn color_change(plan: &FramePlan, pass: &Pass) -> TargetChange {
    let Some(target) = &pass.color else { return TargetChange::Unchanged };
    let is_drawn = pass.image.is_some() || pass.draws.iter().any(|draw| draw.raster.color != ColorWrite::None);
    let texel = |value: [f64; 4]| match plan.attachment(target.attachment).role {
        AttachmentRole::Labels(_) => vec![value[0] as u8],
        AttachmentRole::Count(_) | AttachmentRole::Visibility(_) => (value[0] as f32).to_le_bytes().to_vec(),
        AttachmentRole::Map(_) => value.map(|channel| (channel * 255.0).round() as u8).to_vec(),
        _ => vec![srgb_byte(value[0]), srgb_byte(value[1]), srgb_byte(value[2]), (value[3] * 255.0).round() as u8],
    };
    change(is_drawn, target.clear.map(texel))
}

/// Returns whether a pass leaves its depth unchanged, uniform (a clear alone) or drawn to: by a draw that writes depth,
/// or recorded content.
pub(super) fn depth_change(pass: &Pass) -> TargetChange {
    let clear = pass.depth_stencil.as_ref().and_then(|target| target.clear_depth);
    let is_drawn = pass.draws.iter().any(|draw| draw.raster.depth_write);
    let is_drawn = is_drawn || start(pass).is_some_and(|start| start.depth.is_some());
    change(is_drawn, clear.map(|depth| depth.to_le_bytes().to_vec()))
}

/// Returns whether a pass leaves its stencil unchanged, uniform (a clear alone) or drawn to: by a draw that may write
/// it, or recorded content.
pub(super) fn stencil_change(pass: &Pass) -> TargetChange {
    let clear = pass.depth_stencil.as_ref().and_then(|target| target.clear_stencil);
    let is_drawn = pass.draws.iter().any(|draw| draw.raster.writes_stencil());
    let is_drawn = is_drawn || start(pass).is_some_and(|start| start.stencil.is_some());
    change(is_drawn, clear.map(|stencil| vec![stencil]))
}

fn start(pass: &Pass) -> Option<&StartContent> {
    pass.recorded.as_ref()?.start.as_ref()
}

fn change(is_drawn: bool, clear: Option<Vec<u8>>) -> TargetChange {
    match (is_drawn, clear) {
        (true, _) => TargetChange::Drawn,
        (false, Some(texel)) => TargetChange::Uniform(texel),
        (false, None) => TargetChange::Unchanged,
    }
}

/// Encodes a linear value as an sRGB byte (IEC 61966-2-1), rounded, as the GPU does when it clears; clamps to 0 and
/// 255.
fn srgb_byte(linear: f64) -> u8 {
    let encoded = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// One aspect of one layer of a texture, and the buffer that it is copied to for reading on the CPU.
#[derive(Debug)]
pub(super) struct StagingCopy {
    texture: Texture,
    layer: u32,
    aspect: TextureAspect,
    format: PixelFormat,
    row_stride: usize,
    buffer: Buffer,
}

impl StagingCopy {
    /// Makes a buffer for copies of one layer and aspect of a texture. Fails where the device allows no buffer of that
    /// size. Nothing is copied yet.
    pub fn new(device: &Device, texture: &Texture, layer: u32, aspect: TextureAspect) -> Result<StagingCopy, GpuError> {
        let format = format_of(texture, aspect);
        let (row_stride, size) = (row_stride(texture, format), StagingCopy::bytes_of(texture, aspect));
        let most = device.limits().max_buffer_size;
        if size > most {
            let [needed, most] = [size, most].map(|bytes| format!("{bytes} bytes"));
            return Err(GpuError::TooLarge { what: "the picture's copy".to_owned(), needed, most });
        }
        let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        let descriptor = wgpu::BufferDescriptor { label: Some("snapshot"), size, usage, mapped_at_creation: false };
        let buffer = device.create_buffer(&descriptor);
        Ok(StagingCopy { texture: texture.clone(), layer, aspect, format, row_stride, buffer })
    }

    /// Returns the bytes of a copy of one layer of a texture's aspect, row padding included.
    pub fn bytes_of(texture: &Texture, aspect: TextureAspect) -> u64 {
        (row_stride(texture, format_of(texture, aspect)) * texture.height() as usize) as u64
    }

    /// Returns the bytes of the copy, row padding included.
    pub fn byte_len(&self) -> u64 {
        self.buffer.size()
    }

    /// Records the copy of the whole layer from the texture to the buffer; it happens when the encoder's commands are
    /// submitted.
    pub fn record(&self, encoder: &mut CommandEncoder) {
        let source = wgpu::TexelCopyTextureInfo {
            texture: &self.texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: self.layer },
            aspect: self.aspect,
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.row_stride as u32),
            rows_per_image: None,
        };
        let target = wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout };
        let size =
            wgpu::Extent3d { width: self.texture.width(), height: self.texture.height(), depth_or_array_layers: 1 };
        encoder.copy_texture_to_buffer(source, target, size);
    }

    /// Asks for the buffer to be mapped once the GPU is done; [`GpuContext::wait`] makes it so.
    pub fn request_map(&self) {
        // A failure shows when the mapped range is asked for.
        self.buffer.map_async(MapMode::Read, .., |_| {});
    }

    /// Unmaps the buffer, so that the GPU can write it again.
    pub fn unmap(&self) {
        self.buffer.unmap();
    }

    /// Returns the copied image, which stays in the mapped buffer's own memory.
    pub fn image(&self) -> Result<Arc<Image>, GpuError> {
        let size = [self.texture.width(), self.texture.height()];
        Ok(Arc::new(Image::from_rows(self.format, size, self.row_stride, mapped_bytes(&self.buffer)?)))
    }
}

/// Returns the format of a copied aspect of a texture; depth (`Depth32F`) for every texture format that is not one of
/// the program's colours, counts, visibilities or labels.
fn format_of(texture: &Texture, aspect: TextureAspect) -> PixelFormat {
    match (texture.format(), aspect) {
        (wgpu::TextureFormat::Rgba8UnormSrgb, _) => PixelFormat::Rgba8Srgb,
        (wgpu::TextureFormat::Rgba8Unorm, _) => PixelFormat::Rgba8,
        (wgpu::TextureFormat::R32Float, _) => PixelFormat::Value32F,
        (wgpu::TextureFormat::R8Uint, _) | (_, TextureAspect::StencilOnly) => PixelFormat::U8,
        _ => PixelFormat::Depth32F,
    }
}

/// Returns the bytes from one row of a copy to the next, padded to wgpu's row alignment.
fn row_stride(texture: &Texture, format: PixelFormat) -> usize {
    (texture.width() as usize * format.texel_bytes()).next_multiple_of(ROW_ALIGNMENT)
}

/// Returns the memory of a mapped buffer, which stays mapped as long as the returned bytes live.
pub(super) fn mapped_bytes(buffer: &Buffer) -> Result<Bytes, GpuError> {
    let view = buffer.get_mapped_range(..).map_err(|error| GpuError::Driver(error.to_string()))?;
    Ok(Bytes::from_owner(MappedBytes(view)))
}

struct MappedBytes(BufferView);

impl AsRef<[u8]> for MappedBytes {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

/// The copies made after one pass, by aspect.
#[derive(Debug, Default)]
pub(super) struct StagedPass {
    pub color: Option<StagingCopy>,
    pub depth: Option<StagingCopy>,
    pub stencil: Option<StagingCopy>,
}

impl StagedPass {
    pub fn iter(&self) -> impl Iterator<Item = &StagingCopy> {
        [&self.color, &self.depth, &self.stencil].into_iter().flatten()
    }
}

/// Returns the milliseconds between the two timestamps of each pair in `ticks`; `None` where they can't be used.
pub(super) fn milliseconds(context: &GpuContext, ticks: &[u64]) -> Vec<Option<f64>> {
    let per_tick = context.timestamp_period.map(|nanoseconds| f64::from(nanoseconds) * 1e-6);
    ticks.chunks_exact(2).map(|pair| per_tick.map(|ms| pair[1].saturating_sub(pair[0]) as f64 * ms)).collect()
}
