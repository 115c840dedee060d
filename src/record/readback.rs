//! Textures and buffers of the real device as bytes.

use crate::import::{RawContents, RawFormat, pictures};
use wgpu::TextureFormat as Format;

/// Reads `size` bytes at `offset` of a buffer and waits for them; `None` where the buffer can't be copied from, is too
/// short, or the device fails.
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
    // Copies have offsets of whole words.
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
    // A failure shows when the range is read.
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::wait_indefinitely()).ok()?;
    Some(buffer.get_mapped_range(..).ok()?.to_vec())
}

/// Returns the format of raw frames that corresponds to a texture's format; [`RawFormat::Other`] with its name where
/// pictures of it are not read.
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

/// A mip level of a layer of a texture.
#[derive(Debug, Clone, Copy)]
pub struct TextureSubresource<'a> {
    pub texture: &'a wgpu::Texture,
    pub mip: u32,
    pub layer: u32,
}

/// Reads the pictures of some subresources, in order: all are copied before any is waited for. Aspects that can't be
/// copied are absent.
pub fn contents(device: &wgpu::Device, queue: &wgpu::Queue, parts: &[TextureSubresource<'_>]) -> Vec<RawContents> {
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let copies: Vec<Vec<AspectReadback>> = parts
        .iter()
        .map(|part| aspects(part, |aspect, format| part.copy(device, &mut encoder, aspect, format)))
        .collect();
    queue.submit([encoder.finish()]);
    // A failure shows when a range is read.
    copies.iter().flatten().for_each(|copy| copy.buffer.map_async(wgpu::MapMode::Read, .., |_| {}));
    let is_done = device.poll(wgpu::PollType::wait_indefinitely()).is_ok();
    let read = |copies: Vec<AspectReadback>| {
        let read = copies.iter().filter(|_| is_done).filter_map(AspectReadback::read);
        read.fold(RawContents::default(), RawContents::or)
    };
    copies.into_iter().map(read).collect()
}

/// Calls `copy` for each aspect of a subresource that can be copied (depth other than of 24 bits, stencil, or colour)
/// with its raw format, and returns the copies that it started.
fn aspects(
    part: &TextureSubresource<'_>,
    mut copy: impl FnMut(wgpu::TextureAspect, RawFormat) -> Option<AspectReadback>,
) -> Vec<AspectReadback> {
    let of = part.texture.format();
    let depth = match of {
        Format::Depth16Unorm => Some(RawFormat::D16),
        Format::Depth32Float | Format::Depth32FloatStencil8 => Some(RawFormat::D32F),
        // Depths of 24 bits can't be copied.
        _ => None,
    };
    let depth = depth.map(|depth| (wgpu::TextureAspect::DepthOnly, depth));
    let stencil = of.has_stencil_aspect().then_some((wgpu::TextureAspect::StencilOnly, RawFormat::S8));
    let color = (!of.is_depth_stencil_format()).then(|| (wgpu::TextureAspect::All, format(of)));
    [depth, stencil, color].into_iter().flatten().filter_map(|(aspect, format)| copy(aspect, format)).collect()
}

/// A copy of an aspect that is under way.
struct AspectReadback {
    buffer: wgpu::Buffer,
    format: RawFormat,
    size: [u32; 2],
    /// Bytes of a row, and of one with its padding.
    row: usize,
    stride: usize,
}

impl TextureSubresource<'_> {
    fn copy(
        self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        aspect: wgpu::TextureAspect,
        format: RawFormat,
    ) -> Option<AspectReadback> {
        let TextureSubresource { texture, mip: mip_level, layer } = self;
        let can_be_copied = texture.usage().contains(wgpu::TextureUsages::COPY_SRC) && texture.sample_count() == 1;
        if !can_be_copied || texture.dimension() != wgpu::TextureDimension::D2 {
            return None;
        }
        let [width, height] = [texture.width(), texture.height()].map(|side| (side >> mip_level).max(1));
        let row = width as usize * pictures::texel_bytes(&format)?;
        let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let buffer = readable(device, (stride * height as usize) as u64);
        let origin = wgpu::Origin3d { x: 0, y: 0, z: layer };
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride as u32), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo { texture, mip_level, origin, aspect },
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        Some(AspectReadback { buffer, format, size: [width, height], row, stride })
    }
}

impl AspectReadback {
    fn read(&self) -> Option<RawContents> {
        let AspectReadback { buffer, format, size, row, stride } = self;
        let mapped = buffer.get_mapped_range(..).ok()?;
        let bytes: Vec<u8> = match row == stride {
            true => mapped.to_vec(),
            false => mapped.chunks_exact(*stride).map(|padded| &padded[..*row]).collect::<Vec<_>>().concat(),
        };
        let layout = pictures::TexelLayout { bottom_row_first: false, depth_above_stencil: false };
        Some(pictures::read(format, &bytes, *size, layout))
    }
}
