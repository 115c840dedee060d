use super::bundle::RenderBundle;
use super::command::{CommandList, DrawCommand, EncoderCommand, PassCommand, PassTargets};
use super::{WrappedObject, bind_group_of, bundle_of, pipeline_of};
use std::ops::Range;
use wgpu::custom::{
    DispatchBindGroup, DispatchBuffer, DispatchQuerySet, DispatchRenderBundle, DispatchRenderPipeline,
    RenderPassInterface,
};

/// A wrapped render pass: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct RenderPass {
    /// `None` where the encoder was finished before.
    inner: Option<wgpu::RenderPass<'static>>,
    recorded: Option<(CommandList, PassTargets, Vec<PassCommand>)>,
}

impl RenderPass {
    /// Begins a render pass on the real encoder, if there is one, and begins to record its calls for `list`, if there
    /// is one.
    pub fn begin(
        encoder: &mut Option<wgpu::CommandEncoder>,
        list: Option<&CommandList>,
        targets: PassTargets,
    ) -> RenderPass {
        let inner = encoder.as_mut().map(|encoder| targets.begin(encoder, true, true).forget_lifetime());
        RenderPass { inner, recorded: list.map(|list| (list.clone(), targets, Vec::new())) }
    }

    /// Makes a call on the real pass with `on`, if it is not ended, and appends the one that `command` returns where
    /// calls are recorded.
    fn call(&mut self, command: impl FnOnce() -> PassCommand, on: impl FnOnce(&mut wgpu::RenderPass<'_>)) {
        if let Some(pass) = &mut self.inner {
            on(pass);
        }
        if let Some((.., commands)) = &mut self.recorded {
            commands.push(command());
        }
    }

    fn draws(&mut self, draw: DrawCommand) {
        if let Some(pass) = &mut self.inner {
            draw.encode(pass);
        }
        if let Some((.., commands)) = &mut self.recorded {
            commands.push(PassCommand::Draw(draw));
        }
    }
}

impl Drop for RenderPass {
    fn drop(&mut self) {
        // Dropping the real pass ends it.
        self.inner = None;
        if let Some((list, targets, commands)) = self.recorded.take() {
            list.push(EncoderCommand::RenderPass(targets, commands));
        }
    }
}

impl RenderPassInterface for RenderPass {
    fn set_pipeline(&mut self, pipeline: &DispatchRenderPipeline) {
        let pipeline = pipeline_of(pipeline);
        self.call(|| PassCommand::pipeline(pipeline), |pass| pass.set_pipeline(&pipeline.inner));
    }

    fn set_bind_group(&mut self, index: u32, group: Option<&DispatchBindGroup>, offsets: &[u32]) {
        let group = group.map(bind_group_of);
        let real = group.map(|group| &group.inner);
        self.call(|| PassCommand::bind_group(index, group, offsets), |pass| pass.set_bind_group(index, real, offsets));
    }

    fn set_index_buffer(
        &mut self,
        buffer: &DispatchBuffer,
        format: wgpu::IndexFormat,
        offset: u64,
        size: Option<wgpu::BufferSize>,
    ) {
        let buffer = buffer.real();
        self.call(
            || PassCommand::IndexBuffer { buffer: buffer.clone(), format, offset, size },
            |pass| pass.set_index_buffer(super::slice(buffer, offset, size), format),
        );
    }

    fn set_vertex_buffer(
        &mut self,
        slot: u32,
        buffer: Option<&DispatchBuffer>,
        offset: u64,
        size: Option<wgpu::BufferSize>,
    ) {
        let buffer = buffer.map(WrappedObject::real);
        self.call(
            || PassCommand::VertexBuffer { slot, buffer: buffer.cloned(), offset, size },
            |pass| pass.set_vertex_buffer(slot, buffer.map(|buffer| super::slice(buffer, offset, size))),
        );
    }

    fn set_immediates(&mut self, offset: u32, data: &[u8]) {
        self.call(|| PassCommand::Immediates { offset, data: data.to_vec() }, |pass| pass.set_immediates(offset, data));
    }

    fn set_blend_constant(&mut self, color: wgpu::Color) {
        self.call(|| PassCommand::BlendConstant(color), |pass| pass.set_blend_constant(color));
    }

    fn set_scissor_rect(&mut self, x: u32, y: u32, width: u32, height: u32) {
        let area = [x, y, width, height];
        self.call(|| PassCommand::Scissor(area), |pass| pass.set_scissor_rect(x, y, width, height));
    }

    fn set_viewport(&mut self, x: f32, y: f32, width: f32, height: f32, near: f32, far: f32) {
        self.call(
            || PassCommand::Viewport { area: [x, y, width, height], depth: [near, far] },
            |pass| pass.set_viewport(x, y, width, height, near, far),
        );
    }

    fn set_stencil_reference(&mut self, reference: u32) {
        self.call(|| PassCommand::StencilReference(reference), |pass| pass.set_stencil_reference(reference));
    }

    fn draw(&mut self, vertices: Range<u32>, instances: Range<u32>) {
        self.draws(DrawCommand::Vertices { vertices, instances });
    }

    fn draw_indexed(&mut self, indices: Range<u32>, base_vertex: i32, instances: Range<u32>) {
        self.draws(DrawCommand::Indexed { indices, base_vertex, instances });
    }

    fn draw_indirect(&mut self, buffer: &DispatchBuffer, offset: u64) {
        self.draws(DrawCommand::Indirect { buffer: buffer.real().clone(), offset, is_indexed: false });
    }

    fn draw_indexed_indirect(&mut self, buffer: &DispatchBuffer, offset: u64) {
        self.draws(DrawCommand::Indirect { buffer: buffer.real().clone(), offset, is_indexed: true });
    }

    fn multi_draw_indirect(&mut self, buffer: &DispatchBuffer, offset: u64, count: u32) {
        self.draws(DrawCommand::Multi { buffer: buffer.real().clone(), offset, count, is_indexed: false });
    }

    fn multi_draw_indexed_indirect(&mut self, buffer: &DispatchBuffer, offset: u64, count: u32) {
        self.draws(DrawCommand::Multi { buffer: buffer.real().clone(), offset, count, is_indexed: true });
    }

    fn multi_draw_indirect_count(
        &mut self,
        buffer: &DispatchBuffer,
        offset: u64,
        count: &DispatchBuffer,
        count_offset: u64,
        most: u32,
    ) {
        let (buffer, count) = (buffer.real().clone(), count.real().clone());
        self.draws(DrawCommand::Counted { buffer, offset, count, count_offset, most, is_indexed: false });
    }

    fn multi_draw_indexed_indirect_count(
        &mut self,
        buffer: &DispatchBuffer,
        offset: u64,
        count: &DispatchBuffer,
        count_offset: u64,
        most: u32,
    ) {
        let (buffer, count) = (buffer.real().clone(), count.real().clone());
        self.draws(DrawCommand::Counted { buffer, offset, count, count_offset, most, is_indexed: true });
    }

    fn draw_mesh_tasks(&mut self, x: u32, y: u32, z: u32) {
        self.draws(DrawCommand::MeshTasks([x, y, z]));
    }

    fn draw_mesh_tasks_indirect(&mut self, buffer: &DispatchBuffer, offset: u64) {
        self.draws(DrawCommand::MeshTasksIndirect { buffer: buffer.real().clone(), offset, count: 1 });
    }

    fn multi_draw_mesh_tasks_indirect(&mut self, buffer: &DispatchBuffer, offset: u64, count: u32) {
        self.draws(DrawCommand::MeshTasksIndirect { buffer: buffer.real().clone(), offset, count });
    }

    fn multi_draw_mesh_tasks_indirect_count(
        &mut self,
        buffer: &DispatchBuffer,
        offset: u64,
        _: &DispatchBuffer,
        _: u64,
        most: u32,
    ) {
        // No device has mesh shaders: which of the calls is refused makes no difference.
        self.draws(DrawCommand::MeshTasksIndirect { buffer: buffer.real().clone(), offset, count: most });
    }

    fn insert_debug_marker(&mut self, label: &str) {
        self.call(|| PassCommand::Marker(label.to_owned()), |pass| pass.insert_debug_marker(label));
    }

    fn push_debug_group(&mut self, label: &str) {
        self.call(|| PassCommand::PushGroup(label.to_owned()), |pass| pass.push_debug_group(label));
    }

    fn pop_debug_group(&mut self) {
        self.call(|| PassCommand::PopGroup, |pass| pass.pop_debug_group());
    }

    fn write_timestamp(&mut self, queries: &DispatchQuerySet, index: u32) {
        let queries = queries.real();
        self.call(|| PassCommand::Timestamp(queries.clone(), index), |pass| pass.write_timestamp(queries, index));
    }

    fn begin_occlusion_query(&mut self, index: u32) {
        self.call(|| PassCommand::BeginOcclusion(index), |pass| pass.begin_occlusion_query(index));
    }

    fn end_occlusion_query(&mut self) {
        self.call(|| PassCommand::EndOcclusion, |pass| pass.end_occlusion_query());
    }

    fn begin_pipeline_statistics_query(&mut self, queries: &DispatchQuerySet, index: u32) {
        let queries = queries.real();
        self.call(
            || PassCommand::BeginStatistics(queries.clone(), index),
            |pass| pass.begin_pipeline_statistics_query(queries, index),
        );
    }

    fn end_pipeline_statistics_query(&mut self) {
        self.call(|| PassCommand::EndStatistics, |pass| pass.end_pipeline_statistics_query());
    }

    fn execute_bundles(&mut self, bundles: &mut dyn Iterator<Item = &DispatchRenderBundle>) {
        let bundles: Vec<_> = bundles.map(bundle_of).collect();
        if let Some(pass) = &mut self.inner {
            pass.execute_bundles(bundles.iter().map(|bundle| &bundle.inner));
        }
        if let Some((.., commands)) = &mut self.recorded {
            let commands_of = |bundle: &&RenderBundle| PassCommand::Bundle {
                real: bundle.inner.clone(),
                commands: bundle.commands.clone(),
            };
            commands.extend(bundles.iter().map(commands_of));
        }
    }
}
