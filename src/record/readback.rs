//! Textures and buffers of the real device as bytes.

use crate::import::{RawContents, RawFormat, pictures};
use wgpu::TextureFormat as Format;

/// Bytes of a part of a buffer that can be copied from; `None` if it can't, or the device fails.
pub fn buffer(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    of: &wgpu::Buffer,
    offset: u64,
    size: u64,
) -> Option<Vec<u8>> {
    if !of.usage().contains(wgpu::BufferUsages::COPY_SRC) || offset.checked_add(size)? > of.size() {
        return None;
    }
    // Copies count in words.
    let from = offset / 4 * 4;
    let to = (offset + size).next_multiple_of(4).min(of.size() / 4 * 4);
    let readable = readable(device, to.checked_sub(from)?);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(of, from, &readable, 0, to - from);
    queue.submit([encoder.finish()]);
    let bytes = mapped(device, &readable)?;
    bytes.get((offset - from) as usize..(offset - from + size) as usize).map(<[u8]>::to_vec)
}

fn readable(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("stencilscope readback"),
        size: size.max(4),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

fn mapped(device: &wgpu::Device, buffer: &wgpu::Buffer) -> Option<Vec<u8>> {
    // A failure shows when the range is asked for.
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::wait_indefinitely()).ok()?;
    Some(buffer.get_mapped_range(..).ok()?.to_vec())
}

/// A texture's format in the words of a raw frame.
pub fn format(format: Format) -> RawFormat {
    match format {
        Format::Depth16Unorm => RawFormat::D16,
        Format::Depth24Plus => RawFormat::D24,
        Format::Depth24PlusStencil8 => RawFormat::D24S8,
        Format::Depth32Float => RawFormat::D32F,
        Format::Depth32FloatStencil8 => RawFormat::D32FS8,
        Format::Stencil8 => RawFormat::S8,
        Format::Rgba8Unorm => RawFormat::Rgba8,
        Format::Rgba8UnormSrgb => RawFormat::Rgba8Srgb,
        Format::Bgra8Unorm => RawFormat::Bgra8,
        Format::Bgra8UnormSrgb => RawFormat::Bgra8Srgb,
        Format::Rgba16Float => RawFormat::Rgba16F,
        Format::Rg11b10Ufloat => RawFormat::R11G11B10F,
        Format::Rgb10a2Unorm => RawFormat::Rgb10A2,
        other => RawFormat::Other(format!("{other:?}")),
    }
}

/// The pictures of a level of a layer.
pub fn contents(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    mip: u32,
    layer: u32,
) -> RawContents {
    let of = texture.format();
    let aspect = |aspect, format: RawFormat| {
        let bytes = texels(device, queue, texture, [mip, layer], aspect, pictures::texel_bytes(&format)?)?;
        let size = [0, 1].map(|axis| ([texture.width(), texture.height()][axis] >> mip).max(1));
        let layout = pictures::Layout { bottom_row_first: false, depth_above_stencil: false };
        Some(pictures::read(&format, &bytes, size, layout))
    };
    let depth_format = match of {
        Format::Depth16Unorm => Some(RawFormat::D16),
        Format::Depth32Float | Format::Depth32FloatStencil8 => Some(RawFormat::D32F),
        // Nothing copies depths of 24 bits.
        _ => None,
    };
    let depth = depth_format.and_then(|format| aspect(wgpu::TextureAspect::DepthOnly, format)?.depth);
    let has_stencil = of.has_stencil_aspect();
    let stencil = has_stencil.then(|| aspect(wgpu::TextureAspect::StencilOnly, RawFormat::S8)?.stencil).flatten();
    let is_color = !of.is_depth_stencil_format();
    let color = is_color.then(|| aspect(wgpu::TextureAspect::All, format(of))?.color).flatten();
    RawContents { depth, stencil, color }
}

/// The texels of an aspect without padding.
fn texels(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    [mip_level, layer]: [u32; 2],
    aspect: wgpu::TextureAspect,
    texel: usize,
) -> Option<Vec<u8>> {
    let can_be_copied = texture.usage().contains(wgpu::TextureUsages::COPY_SRC) && texture.sample_count() == 1;
    if !can_be_copied || texture.dimension() != wgpu::TextureDimension::D2 {
        return None;
    }
    let [width, height] = [texture.width(), texture.height()].map(|side| (side >> mip_level).max(1));
    let row = width as usize * texel;
    let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
    let readable = readable(device, (stride * height as usize) as u64);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { texture, mip_level, origin: wgpu::Origin3d { x: 0, y: 0, z: layer }, aspect },
        wgpu::TexelCopyBufferInfo {
            buffer: &readable,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride as u32), rows_per_image: None },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
    let bytes = mapped(device, &readable)?;
    Some(bytes.chunks_exact(stride).flat_map(|padded| &padded[..row]).copied().collect())
}
