use super::command::{DrawCommand, PassCommand};
use super::{WrappedObject, bind_group_of, pipeline_of};
use std::ops::Range;
use std::sync::Arc;
use wgpu::custom::{
    DispatchBindGroup, DispatchBuffer, DispatchRenderBundle, DispatchRenderPipeline, RenderBundleEncoderInterface,
    RenderBundleInterface,
};

/// A wrapped render bundle: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct RenderBundle {
    pub inner: wgpu::RenderBundle,
    pub commands: Arc<[PassCommand]>,
}

impl RenderBundleInterface for RenderBundle {}

/// Stores its calls: a real encoder stays on its thread, and this one need not, so the real one is created at the end.
#[derive(Debug)]
pub struct RenderBundleEncoder {
    device: wgpu::Device,
    label: Option<String>,
    color_formats: Vec<Option<wgpu::TextureFormat>>,
    depth_stencil: Option<wgpu::RenderBundleDepthStencil>,
    sample_count: u32,
    multiview: Option<std::num::NonZeroU32>,
    commands: Vec<PassCommand>,
}

impl RenderBundleEncoder {
    /// Returns an encoder that collects the commands of a render bundle; the real bundle is not begun yet.
    pub fn new(device: &wgpu::Device, asked: &wgpu::RenderBundleEncoderDescriptor<'_>) -> RenderBundleEncoder {
        RenderBundleEncoder {
            device: device.clone(),
            label: asked.label.map(str::to_owned),
            color_formats: asked.color_formats.to_vec(),
            depth_stencil: asked.depth_stencil,
            sample_count: asked.sample_count,
            multiview: asked.multiview,
            commands: Vec::new(),
        }
    }
}

impl RenderBundleEncoderInterface for RenderBundleEncoder {
    fn set_pipeline(&mut self, pipeline: &DispatchRenderPipeline) {
        self.commands.push(PassCommand::pipeline(pipeline_of(pipeline)));
    }

    fn set_bind_group(&mut self, index: u32, group: Option<&DispatchBindGroup>, offsets: &[u32]) {
        self.commands.push(PassCommand::bind_group(index, group.map(bind_group_of), offsets));
    }

    fn set_index_buffer(
        &mut self,
        buffer: &DispatchBuffer,
        format: wgpu::IndexFormat,
        offset: u64,
        size: Option<wgpu::BufferSize>,
    ) {
        self.commands.push(PassCommand::IndexBuffer { buffer: buffer.real().clone(), format, offset, size });
    }

    fn set_vertex_buffer(
        &mut self,
        slot: u32,
        buffer: Option<&DispatchBuffer>,
        offset: u64,
        size: Option<wgpu::BufferSize>,
    ) {
        let buffer = buffer.map(|buffer| buffer.real().clone());
        self.commands.push(PassCommand::VertexBuffer { slot, buffer, offset, size });
    }

    fn set_immediates(&mut self, offset: u32, data: &[u8]) {
        self.commands.push(PassCommand::Immediates { offset, data: data.to_vec() });
    }

    fn draw(&mut self, vertices: Range<u32>, instances: Range<u32>) {
        self.commands.push(PassCommand::Draw(DrawCommand::Vertices { vertices, instances }));
    }

    fn draw_indexed(&mut self, indices: Range<u32>, base_vertex: i32, instances: Range<u32>) {
        self.commands.push(PassCommand::Draw(DrawCommand::Indexed { indices, base_vertex, instances }));
    }

    fn draw_indirect(&mut self, buffer: &DispatchBuffer, offset: u64) {
        let buffer = buffer.real().clone();
        self.commands.push(PassCommand::Draw(DrawCommand::Indirect { buffer, offset, is_indexed: false }));
    }

    fn draw_indexed_indirect(&mut self, buffer: &DispatchBuffer, offset: u64) {
        let buffer = buffer.real().clone();
        self.commands.push(PassCommand::Draw(DrawCommand::Indirect { buffer, offset, is_indexed: true }));
    }

    fn finish(self, descriptor: &wgpu::RenderBundleDescriptor<'_>) -> DispatchRenderBundle {
        let mut encoder = self.device.create_render_bundle_encoder(&wgpu::RenderBundleEncoderDescriptor {
            label: self.label.as_deref(),
            color_formats: &self.color_formats,
            depth_stencil: self.depth_stencil,
            sample_count: self.sample_count,
            multiview: self.multiview,
        });
        for command in &self.commands {
            command.encode_bundle(&mut encoder);
        }
        let inner = encoder.finish(descriptor);
        DispatchRenderBundle::custom(RenderBundle { inner, commands: self.commands.into() })
    }

    fn finish_boxed(self: Box<Self>, descriptor: &wgpu::RenderBundleDescriptor<'_>) -> DispatchRenderBundle {
        (*self).finish(descriptor)
    }
}
