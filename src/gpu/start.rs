//! What a pass's depth and stencil store as it begins, written from the CPU: depths by a draw, as nothing copies them
//! into a depth buffer of floats, the stencil by a copy.

use super::shaders;
use crate::plan::{Blob, StartContent};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferUsages, CommandEncoder, Device, LoadOp, Operations, RenderPipeline, StoreOp, TextureFormat};

const ROW_ALIGNMENT: usize = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize;

/// A layer of a depth-stencil texture that a pass starts with given content in.
pub(super) struct StartTarget<'a> {
    pub device: &'a Device,
    pub texture: &'a wgpu::Texture,
    pub layer: u32,
    pub view: &'a wgpu::TextureView,
    /// The pipeline made by [`pipeline`]; `None` where no depths are written.
    pub pipeline: Option<&'a RenderPipeline>,
}

/// Records the commands that write recorded content to a pass's target: stencil where both have it, depth where the
/// content has it and there is a pipeline.
pub(super) fn record(encoder: &mut CommandEncoder, target: &StartTarget, content: &StartContent) {
    let StartTarget { device, texture, layer, view, pipeline } = *target;
    if let Some(stencil) = content.stencil.as_ref().filter(|_| texture.format().has_stencil_aspect()) {
        let origin = wgpu::Origin3d { z: layer, ..wgpu::Origin3d::ZERO };
        let aspect = wgpu::TextureAspect::StencilOnly;
        copy_stencil(encoder, device, stencil, wgpu::TexelCopyTextureInfo { texture, mip_level: 0, origin, aspect });
    }
    if let (Some(depth), Some(pipeline)) = (&content.depth, pipeline) {
        draw_depth(encoder, device, depth, pipeline, view, texture);
    }
}

fn copy_stencil(encoder: &mut CommandEncoder, device: &Device, stencil: &Blob<u8>, target: wgpu::TexelCopyTextureInfo) {
    let size = wgpu::Extent3d { depth_or_array_layers: 1, ..target.texture.size() };
    let stride = (size.width as usize).next_multiple_of(ROW_ALIGNMENT);
    let mut padded = vec![0; stride * size.height as usize];
    for (row, padded) in stencil.data().chunks_exact(size.width as usize).zip(padded.chunks_exact_mut(stride)) {
        padded[..row.len()].copy_from_slice(row);
    }
    let contents = &padded;
    let buffer = device.create_buffer_init(&BufferInitDescriptor {
        label: Some("start"),
        contents,
        usage: BufferUsages::COPY_SRC,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride as u32), rows_per_image: None };
    encoder.copy_buffer_to_texture(wgpu::TexelCopyBufferInfo { buffer: &buffer, layout }, target, size);
}

/// Makes the pipeline that replaces the depths of a target of this format by those of a texture; the stencil stays.
pub(super) fn pipeline(device: &Device, format: TextureFormat) -> RenderPipeline {
    let source = wgpu::ShaderSource::Wgsl(shaders::START.into());
    let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("start"), source });
    let compilation_options = wgpu::PipelineCompilationOptions::default();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("start"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vs_start"),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("fs_start"),
            compilation_options,
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn draw_depth(
    encoder: &mut CommandEncoder,
    device: &Device,
    depth: &Blob<f32>,
    pipeline: &RenderPipeline,
    view: &wgpu::TextureView,
    texture: &wgpu::Texture,
) {
    let contents = &[&texture.width().to_le_bytes(), depth.bytes()].concat();
    let usage = BufferUsages::STORAGE;
    let buffer = device.create_buffer_init(&BufferInitDescriptor { label: Some("start"), contents, usage });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("start"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    });
    let stored = || Operations { load: LoadOp::Load, store: StoreOp::Store };
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("start"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(Operations { load: LoadOp::Load, store: StoreOp::Store }),
            stencil_ops: texture.format().has_stencil_aspect().then(stored),
        }),
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..3, 0..1);
}
