//! Every fragment that reaches one pixel, including those that a test discards.
//!
//! Depth and stencil buffers store sums, and no API says which triangles made them. So the triangles that geometry
//! finds over the pixel ([`FramePlan::covering`]) are drawn once more, with each draw's state as far as it says where
//! fragments are and how deep (view, culling, clipping, bias), behind a scissor of one pixel and with tests that let
//! everything pass. A fragment shader appends triangle, side and depth to a buffer; what the tests would have done is
//! left to the stencil machine.
//!
//! The vertex shader is the frame's, so depths have the same bits. The buffer has a capacity of one fragment for each
//! triangle at first, the shader counts on when it is full, and a replay with more capacity follows: nothing is lost
//! silently. No buffer of the picture's size is cleared or read, so the cost is that of the triangles over one pixel.

use super::prepared::layer_view;
use super::readback::mapped_bytes;
use super::{Executor, GpuError, shaders, uniforms};
use crate::plan::{Covering, Draw, FragmentLog, FramePlan, LoggedFragment, Pass, Viewport};
use bytemuck::{Pod, Zeroable};
use std::collections::HashMap;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroupDescriptor, BindGroupEntry, BindGroupLayout, Buffer, BufferUsages, Device, LoadOp, Operations,
    RenderPipeline, ShaderStages, StoreOp, Texture, TextureFormat,
};

/// What a pipeline of the log is made from.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct LogKey {
    unclipped_depth: bool,
    bias: wgpu::DepthBiasState,
    cull: Option<wgpu::Face>,
    front_face: wgpu::FrontFace,
    /// Corners are in clip space.
    is_recorded: bool,
    depth_format: TextureFormat,
}

/// What is cached between logs.
#[derive(Debug, Default)]
pub(super) struct LogCache {
    module: Option<wgpu::ShaderModule>,
    layout: Option<BindGroupLayout>,
    pipelines: HashMap<LogKey, RenderPipeline>,
    /// A depth buffer whose content is not used: depth bias only has an effect where there is one.
    target: Option<Texture>,
}

/// A corner of a triangle, as `LogCorner` of `fragment_log.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LogCorner {
    relative: [f32; 4],
    triangle: u32,
}

/// `Fragment` of `fragment_log.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LogRecord {
    triangle: u32,
    is_front: u32,
    depth: f32,
}

/// Before the records: their count.
const HEAD_BYTES: u64 = 4;

const CORNER_ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x4, 1 => Uint32];

impl Executor {
    /// Draws the triangles of `covering` again, behind a scissor of `pixel`, and writes down their
    /// fragments there. There is `capacity` for so many at first, and more where they are more.
    pub fn log_fragments(
        &mut self,
        plan: &FramePlan,
        pixel: [u32; 2],
        covering: &[Covering],
        capacity: u32,
    ) -> Result<FragmentLog, GpuError> {
        if covering.is_empty() {
            return Ok(FragmentLog::default());
        }
        let mut capacity = capacity.max(1);
        loop {
            let log = self.replay(plan, pixel, covering, u64::from(capacity))?;
            if log.counted <= capacity {
                return Ok(log);
            }
            capacity = log.counted;
        }
    }

    fn replay(
        &mut self,
        plan: &FramePlan,
        pixel: [u32; 2],
        covering: &[Covering],
        capacity: u64,
    ) -> Result<FragmentLog, GpuError> {
        self.provide(plan)?;
        let Executor { context, pipelines, log, .. } = self;
        let device = &context.device;
        let readable = context.guarded(|| {
            let corners: Vec<LogCorner> = (0..)
                .zip(covering)
                .flat_map(|(triangle, one)| one.corners.map(|relative| LogCorner { relative, triangle }))
                .collect();
            let vertices = device.create_buffer_init(&BufferInitDescriptor {
                label: Some("triangles over a pixel"),
                contents: bytemuck::cast_slice(&corners),
                usage: BufferUsages::VERTEX,
            });
            let size = HEAD_BYTES + capacity * size_of::<LogRecord>() as u64;
            let buffer = |usage| {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("fragment log"),
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            };
            let written = buffer(BufferUsages::STORAGE | BufferUsages::COPY_SRC);
            let readable = buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ);
            let views = uniforms::views(device, plan);
            let view_group = views.bind_group(device, &pipelines.layouts.view);
            let log_group = device.create_bind_group(&BindGroupDescriptor {
                label: Some("fragment log"),
                layout: log.layout(device),
                entries: &[BindGroupEntry { binding: 0, resource: written.as_entire_binding() }],
            });
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let runs = runs(plan, covering);
            for of_format in runs.chunk_by(|a, b| a.key.depth_format == b.key.depth_format) {
                let format = of_format[0].key.depth_format;
                let target = layer_view(log.target(device, format, plan.size), 0);
                let mut pass = encoder.begin_render_pass(&log_pass(&target, format));
                pass.set_scissor_rect(pixel[0], pixel[1], 1, 1);
                pass.set_bind_group(1, &log_group, &[]);
                pass.set_vertex_buffer(0, vertices.slice(..));
                for run in of_format {
                    pass.set_pipeline(&log.pipeline(device, &pipelines.layouts.view, &run.key));
                    pass.set_bind_group(0, &view_group, &[views.offset(run.view)]);
                    let Viewport { area: [left, top, width, height], depth: [near, far] } = run.viewport;
                    pass.set_viewport(left, top, width, height, near, far);
                    pass.draw(run.triangles.start as u32 * 3..run.triangles.end as u32 * 3, 0..1);
                }
            }
            encoder.copy_buffer_to_buffer(&written, 0, &readable, 0, size);
            context.queue.submit([encoder.finish()]);
            // A failure shows when the mapped range is asked for.
            readable.map_async(wgpu::MapMode::Read, .., |_| {});
            context.wait()?;
            Ok(readable)
        })?;
        log.target.take_if(|target| u64::from(target.width()) * u64::from(target.height()) > MOST_CACHED_TEXELS);
        read(&readable)
    }
}

/// Neighbouring triangles that one draw can show.
struct TriangleRun {
    key: LogKey,
    view: usize,
    viewport: Viewport,
    triangles: std::ops::Range<usize>,
}

fn runs(plan: &FramePlan, covering: &[Covering]) -> Vec<TriangleRun> {
    let mut runs: Vec<TriangleRun> = Vec::new();
    for (index, one) in covering.iter().enumerate() {
        let pass = &plan.passes[one.pass];
        let (key, view) = (key_of(plan, pass, &pass.draws[one.draw]), pass.view.0);
        let viewport = pass.viewport(plan.size);
        match runs.last_mut().filter(|run| run.key == key && run.view == view && run.viewport == viewport) {
            Some(run) => run.triangles.end = index + 1,
            None => runs.push(TriangleRun { key, view, viewport, triangles: index..index + 1 }),
        }
    }
    runs
}

fn key_of(plan: &FramePlan, pass: &Pass, draw: &Draw) -> LogKey {
    let (raster, target) = (&draw.raster, pass.depth_stencil.as_ref());
    LogKey {
        unclipped_depth: raster.unclipped_depth,
        bias: raster.depth_bias,
        cull: raster.cull,
        front_face: raster.front_face,
        is_recorded: draw.program.is_recorded(),
        depth_format: target
            .map_or(TextureFormat::Depth32Float, |target| plan.attachment(target.attachment).stored_format()),
    }
}

/// Nothing is read from the target or written to it, so nothing is cleared: that would take as long as
/// the picture is large.
fn log_pass(target: &wgpu::TextureView, format: TextureFormat) -> wgpu::RenderPassDescriptor<'_> {
    let store = StoreOp::Store;
    wgpu::RenderPassDescriptor {
        label: Some("fragment log"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: target,
            depth_ops: Some(Operations { load: LoadOp::Load, store }),
            stencil_ops: format.has_stencil_aspect().then_some(Operations { load: LoadOp::Load, store }),
        }),
        ..wgpu::RenderPassDescriptor::default()
    }
}

fn read(buffer: &Buffer) -> Result<FragmentLog, GpuError> {
    let bytes = mapped_bytes(buffer)?;
    let (head, records) = bytes.split_at(HEAD_BYTES as usize);
    let counted: u32 = bytemuck::pod_read_unaligned(head);
    let records = records.chunks_exact(size_of::<LogRecord>()).map(bytemuck::pod_read_unaligned::<LogRecord>);
    let fragment = |record: LogRecord| LoggedFragment {
        covering: record.triangle as usize,
        is_front: record.is_front != 0,
        depth: record.depth,
    };
    let mut fragments: Vec<LoggedFragment> = records.take(counted as usize).map(fragment).collect();
    // Fragments run side by side: the order in the buffer says nothing.
    fragments.sort_by_key(|fragment| fragment.covering);
    Ok(FragmentLog { fragments, counted })
}

impl LogCache {
    fn layout(&mut self, device: &Device) -> &BindGroupLayout {
        self.layout.get_or_insert_with(|| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("fragment log"),
                entries: &[wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Storage { read_only: false },
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                }],
            })
        })
    }

    fn target(&mut self, device: &Device, format: TextureFormat, size: [u32; 2]) -> &Texture {
        let cached =
            self.target.take().filter(|cached| cached.format() == format && [cached.width(), cached.height()] == size);
        self.target.insert(cached.unwrap_or_else(|| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("fragment log"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        }))
    }

    fn pipeline(&mut self, device: &Device, view: &BindGroupLayout, key: &LogKey) -> RenderPipeline {
        if let Some(pipeline) = self.pipelines.get(key) {
            return pipeline.clone();
        }
        let groups = [Some(view), Some(&self.layout(device).clone())].map(|group| group.cloned());
        let module = self.module.get_or_insert_with(|| {
            let source = wgpu::ShaderSource::Wgsl(shaders::fragment_log().into());
            device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("fragment log"), source })
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("fragment log"),
            bind_group_layouts: &[groups[0].as_ref(), groups[1].as_ref()],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("fragment log"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(if key.is_recorded { "vs_log_clip" } else { "vs_log" }),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<LogCorner>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &CORNER_ATTRIBUTES,
                })],
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: key.cull,
                front_face: key.front_face,
                unclipped_depth: key.unclipped_depth,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: key.depth_format,
                depth_write_enabled: Some(false),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: key.bias,
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some("fs_log"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        });
        if self.pipelines.len() >= MOST_PIPELINES {
            // A slider moved over many biases has made one each.
            self.pipelines.clear();
        }
        self.pipelines.insert(key.clone(), pipeline.clone());
        pipeline
    }
}

/// A larger target is made anew for each log; one of a picture of 8K is cached.
const MOST_CACHED_TEXELS: u64 = 1 << 25;
/// Most pipelines that are cached at once.
const MOST_PIPELINES: usize = 64;
