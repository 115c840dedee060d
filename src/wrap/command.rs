//! The calls of a recorded frame, stored so that it can be run draw by draw.

use super::binding::{BindGroup, BoundResource};
use super::pipeline::{PipelineSource, RenderPipeline};
use super::texture::ViewSubresource;
use super::{WrappedObject, slice, view_of};
use std::fmt;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// The calls of an encoder, in order. Its passes write into it too.
#[derive(Debug, Clone, Default)]
pub struct CommandList(Arc<Mutex<Vec<EncoderCommand>>>);

impl CommandList {
    pub fn push(&self, command: EncoderCommand) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(command);
    }

    /// Removes and returns all recorded commands.
    pub fn take(&self) -> Vec<EncoderCommand> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The result of an encoder: the real commands, and the list of a recorded frame.
#[derive(Debug)]
pub struct FinishedCommands {
    pub inner: wgpu::CommandBuffer,
    pub list: Option<CommandList>,
    /// True where it has render passes.
    pub has_passes: bool,
}

/// One call of an encoder, or a pass.
pub enum EncoderCommand {
    RenderPass(PassTargets, Vec<PassCommand>),
    ComputePass {
        label: Option<String>,
        timestamps: Option<TimestampWrites>,
        commands: Vec<ComputeCommand>,
    },
    PushGroup(String),
    PopGroup,
    /// A copy, a clear, a query: encoded again as it was.
    Encode(Box<dyn Fn(&mut wgpu::CommandEncoder) + Send + Sync>),
}

impl EncoderCommand {
    /// Encodes the command, a pass whole, on a real encoder with the arguments of the original call.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        match self {
            EncoderCommand::RenderPass(targets, commands) => {
                let mut pass = targets.begin(encoder, true, true);
                commands.iter().for_each(|command| command.encode(&mut pass));
            }
            EncoderCommand::ComputePass { label, timestamps, commands } => {
                let timestamp_writes = timestamps.as_ref().map(TimestampWrites::of_compute);
                let descriptor = wgpu::ComputePassDescriptor { label: label.as_deref(), timestamp_writes };
                let mut pass = encoder.begin_compute_pass(&descriptor);
                commands.iter().for_each(|ComputeCommand(command)| command(&mut pass));
            }
            EncoderCommand::PushGroup(name) => encoder.push_debug_group(name),
            EncoderCommand::PopGroup => encoder.pop_debug_group(),
            EncoderCommand::Encode(command) => command(encoder),
        }
    }
}

impl fmt::Debug for EncoderCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            EncoderCommand::RenderPass(..) => "RenderPass",
            EncoderCommand::ComputePass { .. } => "ComputePass",
            EncoderCommand::PushGroup(_) => "PushGroup",
            EncoderCommand::PopGroup => "PopGroup",
            EncoderCommand::Encode(_) => "Encode",
        })
    }
}

/// A recorded call of a compute pass, as a closure that makes the call again on a real pass.
pub struct ComputeCommand(pub Box<dyn Fn(&mut wgpu::ComputePass<'_>) + Send + Sync>);

impl fmt::Debug for ComputeCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ComputeCommand")
    }
}

/// The timestamps that a pass writes.
#[derive(Debug, Clone)]
pub struct TimestampWrites {
    pub queries: wgpu::QuerySet,
    pub begin: Option<u32>,
    pub end: Option<u32>,
}

impl TimestampWrites {
    /// Returns these timestamps in the form of wgpu's descriptor of compute passes.
    pub fn of_compute(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: self.begin,
            end_of_pass_write_index: self.end,
        }
    }
}

/// The targets and other arguments with which a render pass is begun, as real wgpu objects.
#[derive(Debug, Clone)]
pub struct PassTargets {
    pub label: Option<String>,
    pub colors: Vec<Option<ColorAttachment>>,
    pub depth_stencil: Option<DepthStencilAttachment>,
    timestamps: Option<TimestampWrites>,
    pub occlusion: Option<wgpu::QuerySet>,
    multiview: Option<std::num::NonZeroU32>,
}

/// A recorded colour attachment of a render pass.
#[derive(Debug, Clone)]
pub struct ColorAttachment {
    pub view: wgpu::TextureView,
    pub part: ViewSubresource,
    depth_slice: Option<u32>,
    resolve: Option<wgpu::TextureView>,
    pub ops: wgpu::Operations<wgpu::Color>,
}

/// The recorded depth-stencil attachment of a render pass.
#[derive(Debug, Clone)]
pub struct DepthStencilAttachment {
    pub view: wgpu::TextureView,
    pub part: ViewSubresource,
    pub depth_ops: Option<wgpu::Operations<f32>>,
    pub stencil_ops: Option<wgpu::Operations<u32>>,
}

impl PassTargets {
    /// Returns the real targets, queries and label that the program's descriptor of a render pass names.
    pub fn of(descriptor: &wgpu::RenderPassDescriptor<'_>) -> PassTargets {
        let color = |color: &wgpu::RenderPassColorAttachment<'_>| {
            let (view, part) = view_of(color.view);
            let resolve = color.resolve_target.map(|target| view_of(target).0);
            ColorAttachment { view, part, depth_slice: color.depth_slice, resolve, ops: color.ops }
        };
        let depth = |depth: &wgpu::RenderPassDepthStencilAttachment<'_>| {
            let (view, part) = view_of(depth.view);
            DepthStencilAttachment { view, part, depth_ops: depth.depth_ops, stencil_ops: depth.stencil_ops }
        };
        let timestamps = |writes: &wgpu::RenderPassTimestampWrites<'_>| TimestampWrites {
            queries: WrappedObject::real(writes.query_set).clone(),
            begin: writes.beginning_of_pass_write_index,
            end: writes.end_of_pass_write_index,
        };
        PassTargets {
            label: descriptor.label.map(str::to_owned),
            colors: descriptor.color_attachments.iter().map(|one| one.as_ref().map(color)).collect(),
            depth_stencil: descriptor.depth_stencil_attachment.as_ref().map(depth),
            timestamps: descriptor.timestamp_writes.as_ref().map(timestamps),
            occlusion: descriptor.occlusion_query_set.map(|queries| WrappedObject::real(queries).clone()),
            multiview: descriptor.multiview_mask,
        }
    }

    /// Returns whether any target of the pass is transient: its content is lost between passes.
    pub fn are_transient(&self) -> bool {
        let colors = self.colors.iter().flatten().map(|color| &color.view);
        let mut all = colors.chain(self.depth_stencil.as_ref().map(|depth| &depth.view));
        all.any(|view| view.texture().usage().contains(wgpu::TextureUsages::TRANSIENT_ATTACHMENT))
    }

    /// Begins the pass, or a part of it: only the first part loads or clears as the program asked, later ones load; all
    /// but the last store what they leave, and only the last resolves.
    pub fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        is_first: bool,
        is_last: bool,
    ) -> wgpu::RenderPass<'e> {
        let colors: Vec<Option<wgpu::RenderPassColorAttachment<'_>>> = self
            .colors
            .iter()
            .map(|color| {
                color.as_ref().map(|color| wgpu::RenderPassColorAttachment {
                    view: &color.view,
                    depth_slice: color.depth_slice,
                    resolve_target: color.resolve.as_ref().filter(|_| is_last),
                    ops: part_of(color.ops, is_first, is_last),
                })
            })
            .collect();
        let depth_stencil = self.depth_stencil.as_ref().map(|target| wgpu::RenderPassDepthStencilAttachment {
            view: &target.view,
            depth_ops: target.depth_ops.map(|ops| part_of(ops, is_first, is_last)),
            stencil_ops: target.stencil_ops.map(|ops| part_of(ops, is_first, is_last)),
        });
        let timestamps = self.timestamps.as_ref().map(|writes| wgpu::RenderPassTimestampWrites {
            query_set: &writes.queries,
            beginning_of_pass_write_index: writes.begin.filter(|_| is_first),
            end_of_pass_write_index: writes.end.filter(|_| is_last),
        });
        // A pass that writes no timestamps must not have an entry that says it does.
        let writes_some = |writes: &wgpu::RenderPassTimestampWrites<'_>| {
            (is_first && is_last)
                || writes.beginning_of_pass_write_index.is_some()
                || writes.end_of_pass_write_index.is_some()
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: self.label.as_deref(),
            color_attachments: &colors,
            depth_stencil_attachment: depth_stencil,
            timestamp_writes: timestamps.filter(writes_some),
            occlusion_query_set: self.occlusion.as_ref(),
            multiview_mask: self.multiview,
        })
    }
}

fn part_of<V: Copy>(ops: wgpu::Operations<V>, is_first: bool, is_last: bool) -> wgpu::Operations<V> {
    wgpu::Operations {
        load: if is_first { ops.load } else { wgpu::LoadOp::Load },
        store: if is_last { ops.store } else { wgpu::StoreOp::Store },
    }
}

/// A real bind group with the resources that it binds.
#[derive(Debug, Clone)]
pub struct BoundGroup {
    pub real: wgpu::BindGroup,
    pub entries: Arc<[(u32, BoundResource)]>,
}

/// A recorded call of a render pass.
#[derive(Debug, Clone)]
pub enum PassCommand {
    Pipeline {
        real: wgpu::RenderPipeline,
        described: Arc<PipelineSource>,
    },
    BindGroup {
        index: u32,
        group: Option<BoundGroup>,
        offsets: Vec<u32>,
    },
    IndexBuffer {
        buffer: wgpu::Buffer,
        format: wgpu::IndexFormat,
        offset: u64,
        size: Option<wgpu::BufferSize>,
    },
    VertexBuffer {
        slot: u32,
        buffer: Option<wgpu::Buffer>,
        offset: u64,
        size: Option<wgpu::BufferSize>,
    },
    Immediates {
        offset: u32,
        data: Vec<u8>,
    },
    BlendConstant(wgpu::Color),
    Scissor([u32; 4]),
    Viewport {
        area: [f32; 4],
        depth: [f32; 2],
    },
    StencilReference(u32),
    Draw(DrawCommand),
    Bundle {
        real: wgpu::RenderBundle,
        commands: Arc<[PassCommand]>,
    },
    /// The state before and after a bundle: no pipeline, nothing bound. Never encoded.
    Unbound,
    Marker(String),
    PushGroup(String),
    PopGroup,
    Timestamp(wgpu::QuerySet, u32),
    BeginOcclusion(u32),
    EndOcclusion,
    BeginStatistics(wgpu::QuerySet, u32),
    EndStatistics,
}

impl PassCommand {
    pub fn pipeline(pipeline: &RenderPipeline) -> PassCommand {
        PassCommand::Pipeline { real: pipeline.inner.clone(), described: pipeline.described.clone() }
    }

    /// Returns the recorded call that sets, or with `None` unsets, the bind group `index`.
    pub fn bind_group(index: u32, group: Option<&BindGroup>, offsets: &[u32]) -> PassCommand {
        let bound = |group: &BindGroup| BoundGroup { real: group.inner.clone(), entries: group.entries.clone() };
        PassCommand::BindGroup { index, group: group.map(bound), offsets: offsets.to_vec() }
    }

    /// Returns the command itself; for a bundle the commands in it, with [`PassCommand::Unbound`] before and after
    /// them, so that there is a state after each draw.
    pub fn one_by_one(&self) -> impl Iterator<Item = &PassCommand> {
        let (around, within) = match self {
            PassCommand::Bundle { commands, .. } => (Some(&PassCommand::Unbound), &**commands),
            one => (None, std::slice::from_ref(one)),
        };
        around.into_iter().chain(within).chain(around)
    }

    /// Returns whether the command begins a query (occlusion or pipeline statistics), which has to end in the same
    /// pass, so that the pass can't be split into its draws.
    pub fn spans(&self) -> bool {
        matches!(self, PassCommand::BeginOcclusion(_) | PassCommand::BeginStatistics(..))
    }

    /// Encodes the call on a real render pass with the arguments of the original; a bundle as a whole, `Unbound` as
    /// nothing.
    pub fn encode(&self, pass: &mut wgpu::RenderPass<'_>) {
        match self {
            PassCommand::Pipeline { real, .. } => pass.set_pipeline(real),
            PassCommand::BindGroup { index, group, offsets } => {
                pass.set_bind_group(*index, group.as_ref().map(|group| &group.real), offsets);
            }
            PassCommand::IndexBuffer { buffer, format, offset, size } => {
                pass.set_index_buffer(slice(buffer, *offset, *size), *format);
            }
            PassCommand::VertexBuffer { slot, buffer, offset, size } => {
                pass.set_vertex_buffer(*slot, buffer.as_ref().map(|buffer| slice(buffer, *offset, *size)));
            }
            PassCommand::Immediates { offset, data } => pass.set_immediates(*offset, data),
            PassCommand::BlendConstant(color) => pass.set_blend_constant(*color),
            PassCommand::Scissor([x, y, width, height]) => pass.set_scissor_rect(*x, *y, *width, *height),
            PassCommand::Viewport { area: [x, y, width, height], depth: [near, far] } => {
                pass.set_viewport(*x, *y, *width, *height, *near, *far);
            }
            PassCommand::StencilReference(reference) => pass.set_stencil_reference(*reference),
            PassCommand::Draw(draw) => draw.encode(pass),
            PassCommand::Bundle { real, .. } => pass.execute_bundles([real]),
            PassCommand::Unbound => {}
            PassCommand::Marker(label) => pass.insert_debug_marker(label),
            PassCommand::PushGroup(label) => pass.push_debug_group(label),
            PassCommand::PopGroup => pass.pop_debug_group(),
            PassCommand::Timestamp(queries, index) => pass.write_timestamp(queries, *index),
            PassCommand::BeginOcclusion(index) => pass.begin_occlusion_query(*index),
            PassCommand::EndOcclusion => pass.end_occlusion_query(),
            PassCommand::BeginStatistics(queries, index) => pass.begin_pipeline_statistics_query(queries, *index),
            PassCommand::EndStatistics => pass.end_pipeline_statistics_query(),
        }
    }

    /// Encodes the call into a real bundle; does nothing for commands that bundles don't have, which never come here.
    pub fn encode_bundle<'a>(&'a self, bundle: &mut wgpu::RenderBundleEncoder<'a>) {
        match self {
            PassCommand::Pipeline { real, .. } => bundle.set_pipeline(real),
            PassCommand::BindGroup { index, group, offsets } => {
                bundle.set_bind_group(*index, group.as_ref().map(|group| &group.real), offsets);
            }
            PassCommand::IndexBuffer { buffer, format, offset, size } => {
                bundle.set_index_buffer(slice(buffer, *offset, *size), *format);
            }
            PassCommand::VertexBuffer { slot, buffer, offset, size } => {
                bundle.set_vertex_buffer(*slot, buffer.as_ref().map(|buffer| slice(buffer, *offset, *size)));
            }
            PassCommand::Immediates { offset, data } => bundle.set_immediates(*offset, data),
            PassCommand::Draw(draw) => draw.encode_bundle(bundle),
            _ => {}
        }
    }
}

/// A recorded draw call of a render pass.
#[derive(Debug, Clone, PartialEq)]
pub enum DrawCommand {
    Vertices { vertices: Range<u32>, instances: Range<u32> },
    Indexed { indices: Range<u32>, base_vertex: i32, instances: Range<u32> },
    Indirect { buffer: wgpu::Buffer, offset: u64, is_indexed: bool },
    Multi { buffer: wgpu::Buffer, offset: u64, count: u32, is_indexed: bool },
    Counted { buffer: wgpu::Buffer, offset: u64, count: wgpu::Buffer, count_offset: u64, most: u32, is_indexed: bool },
    MeshTasks([u32; 3]),
    MeshTasksIndirect { buffer: wgpu::Buffer, offset: u64, count: u32 },
}

impl DrawCommand {
    /// Returns the name of the wgpu method that was called, such as `draw_indexed`; for indirect mesh draws always
    /// `draw_mesh_tasks_indirect`.
    pub fn name(&self) -> &'static str {
        match self {
            DrawCommand::Vertices { .. } => "draw",
            DrawCommand::Indexed { .. } => "draw_indexed",
            DrawCommand::Indirect { is_indexed: false, .. } => "draw_indirect",
            DrawCommand::Indirect { is_indexed: true, .. } => "draw_indexed_indirect",
            DrawCommand::Multi { is_indexed: false, .. } => "multi_draw_indirect",
            DrawCommand::Multi { is_indexed: true, .. } => "multi_draw_indexed_indirect",
            DrawCommand::Counted { is_indexed: false, .. } => "multi_draw_indirect_count",
            DrawCommand::Counted { is_indexed: true, .. } => "multi_draw_indexed_indirect_count",
            DrawCommand::MeshTasks(_) => "draw_mesh_tasks",
            DrawCommand::MeshTasksIndirect { .. } => "draw_mesh_tasks_indirect",
        }
    }

    /// Encodes the draw on a real render pass with the arguments of the original call.
    pub fn encode(&self, pass: &mut wgpu::RenderPass<'_>) {
        match self {
            DrawCommand::Vertices { vertices, instances } => pass.draw(vertices.clone(), instances.clone()),
            DrawCommand::Indexed { indices, base_vertex, instances } => {
                pass.draw_indexed(indices.clone(), *base_vertex, instances.clone());
            }
            DrawCommand::Indirect { buffer, offset, is_indexed: false } => pass.draw_indirect(buffer, *offset),
            DrawCommand::Indirect { buffer, offset, is_indexed: true } => pass.draw_indexed_indirect(buffer, *offset),
            DrawCommand::Multi { buffer, offset, count, is_indexed: false } => {
                pass.multi_draw_indirect(buffer, *offset, *count);
            }
            DrawCommand::Multi { buffer, offset, count, is_indexed: true } => {
                pass.multi_draw_indexed_indirect(buffer, *offset, *count);
            }
            DrawCommand::Counted { buffer, offset, count, count_offset, most, is_indexed: false } => {
                pass.multi_draw_indirect_count(buffer, *offset, count, *count_offset, *most);
            }
            DrawCommand::Counted { buffer, offset, count, count_offset, most, is_indexed: true } => {
                pass.multi_draw_indexed_indirect_count(buffer, *offset, count, *count_offset, *most);
            }
            DrawCommand::MeshTasks([x, y, z]) => pass.draw_mesh_tasks(*x, *y, *z),
            DrawCommand::MeshTasksIndirect { buffer, offset, count } => {
                pass.multi_draw_mesh_tasks_indirect(buffer, *offset, *count);
            }
        }
    }

    fn encode_bundle<'a>(&'a self, bundle: &mut wgpu::RenderBundleEncoder<'a>) {
        match self {
            DrawCommand::Vertices { vertices, instances } => bundle.draw(vertices.clone(), instances.clone()),
            DrawCommand::Indexed { indices, base_vertex, instances } => {
                bundle.draw_indexed(indices.clone(), *base_vertex, instances.clone());
            }
            DrawCommand::Indirect { buffer, offset, is_indexed: false } => bundle.draw_indirect(buffer, *offset),
            DrawCommand::Indirect { buffer, offset, is_indexed: true } => bundle.draw_indexed_indirect(buffer, *offset),
            _ => {}
        }
    }
}
