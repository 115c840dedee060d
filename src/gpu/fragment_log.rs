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

use super::log_pipelines::{LogCorner, LogKey};
use super::prepared::layer_view;
use super::readback::mapped_bytes;
use super::{Executor, GpuError, uniforms};
use crate::plan::{Attachment, Covering, Draw, FragmentLog, FramePlan, LoggedFragment, Pass, Viewport};
use bytemuck::{Pod, Zeroable};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroupDescriptor, BindGroupEntry, Buffer, BufferUsages, LoadOp, Operations, StoreOp, TextureFormat};

/// One fragment as the shader writes it: the struct `Fragment` of `fragment_log.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LogRecord {
    triangle: u32,
    is_front: u32,
    depth: f32,
}

/// Bytes before the records: the number of records.
const HEAD_BYTES: u64 = 4;

impl Executor {
    /// Draws the triangles of `covering` again with a scissor rectangle of one `pixel`, and returns their fragments
    /// there. The buffer holds `capacity` fragments at first, and is made larger where there are more.
    pub async fn log_fragments(
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
            let log = self.replay(plan, pixel, covering, u64::from(capacity)).await?;
            if log.counted <= capacity {
                return Ok(log);
            }
            capacity = log.counted;
        }
    }

    async fn replay(
        &mut self,
        plan: &FramePlan,
        pixel: [u32; 2],
        covering: &[Covering],
        capacity: u64,
    ) -> Result<FragmentLog, GpuError> {
        self.provide(plan).await?;
        let Executor { context, pipelines, log, .. } = self;
        let device = &context.device;
        let logged = context.guarded(async || {
            let corners: Vec<LogCorner> = (0..)
                .zip(covering)
                .flat_map(|(triangle, one)| {
                    // What the rasteriser is not given keeps its place here, as a triangle without area.
                    let [a, b, c] = one.rasterised;
                    let corners = if one.piece.is_some() { [a, b, c] } else { [a; 3] };
                    corners.map(|relative| LogCorner { relative, triangle })
                })
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
            context.wait().await?;
            Ok(readable)
        });
        let readable = logged.await?;
        log.target.take_if(|target| u64::from(target.width()) * u64::from(target.height()) > MOST_CACHED_TEXELS);
        read(&readable)
    }
}

/// A range of neighbouring triangles of a mesh that one draw call can draw.
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
    let raster = &draw.raster;
    let target = pass.depth_stencil.as_ref().map(|target| plan.attachment(target.attachment));
    LogKey {
        unclipped_depth: raster.unclipped_depth,
        bias: target.map_or(raster.depth_bias, |target| target.rasteriser_bias(raster.depth_bias)),
        cull: raster.cull,
        front_face: raster.front_face,
        is_recorded: draw.program.is_recorded(),
        depth_format: target.map_or(TextureFormat::Depth32Float, Attachment::stored_format),
    }
}

/// Returns the descriptor of the render pass that logs fragments. Nothing that the target holds is read, so nothing is
/// cleared: that would take as long as the picture is large.
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

/// The most texels of a target that is cached between logs; a larger one is made anew for each log, one of a picture of
/// 8K is cached.
const MOST_CACHED_TEXELS: u64 = 1 << 25;
