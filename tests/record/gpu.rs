//! What programs that draw with wgpu begin with: a device, textures, buffers, and their bytes read back.

use stencilscope::wgpu::util::{BufferInitDescriptor, DeviceExt};
use stencilscope::wgpu::{self, CompareFunction};

/// The first adapter's device.
pub fn device(instance: &wgpu::Instance, asked: &wgpu::DeviceDescriptor) -> (wgpu::Device, wgpu::Queue) {
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    pollster::block_on(adapter.expect("an adapter").request_device(asked)).expect("a device")
}

pub fn module(device: &wgpu::Device, source: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(source.into());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source })
}

/// A texture that can be drawn into.
pub fn texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    sample_count: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
        view_formats: &[],
    })
}

pub fn buffer(device: &wgpu::Device, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
}

/// The layout of a group with one uniform, which vertex shaders read.
pub fn of_uniform(device: &wgpu::Device, has_dynamic_offset: bool) -> wgpu::BindGroupLayout {
    let ty =
        wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset, min_binding_size: None };
    let visibility = wgpu::ShaderStages::VERTEX;
    let entries = &[wgpu::BindGroupLayoutEntry { binding: 0, visibility, ty, count: None }];
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries })
}

pub fn depth_state(
    format: wgpu::TextureFormat,
    write: bool,
    compare: CompareFunction,
    stencil: wgpu::StencilState,
) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil,
        bias: wgpu::DepthBiasState::default(),
    }
}

pub fn submit(device: &wgpu::Device, queue: &wgpu::Queue, encode: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encode(&mut encoder);
    queue.submit([encoder.finish()]);
}

/// A texture's bytes, row by row: so many a texel.
pub fn bytes(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    texture: &wgpu::Texture,
    aspect: wgpu::TextureAspect,
    texel: u32,
) -> Vec<u8> {
    let size = texture.size();
    let stride = (size.width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(stride * size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let source = wgpu::TexelCopyTextureInfo { texture, mip_level: 0, origin: wgpu::Origin3d::ZERO, aspect };
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    submit(device, queue, |encoder| encoder.copy_texture_to_buffer(source, target, size));
    buffer.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("mapped"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("polled");
    let mapped = buffer.get_mapped_range(..).expect("mapped");
    mapped.chunks_exact(stride as usize).flat_map(|row| row[..(size.width * texel) as usize].to_vec()).collect()
}
