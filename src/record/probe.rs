//! Where a draw's vertices land: the draw is done once more into a target of one pixel that nobody looks at, by a shader
//! that writes it down.

use super::readback;
use super::rewrite::{self, HEAD, Logging, RECORD};
use super::states::{PassState, topology};
use crate::import::unroll;
use crate::wrap::command::{DrawCommand, PassCommand};
use crate::wrap::{Described, real_group};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// More corners than a draw is followed with.
const MOST_CORNERS: u64 = 1 << 22;

/// What a draw's vertices are and how they make triangles, as `RawDraw` has them.
#[derive(Debug, Default)]
pub struct Landed {
    pub positions: Vec<[f32; 4]>,
    pub triangles: Vec<[u32; 3]>,
    pub instances: Vec<Range<usize>>,
}

/// Pipelines by the address of what the program's own were made from.
#[derive(Debug, Default)]
pub struct Probes {
    made: HashMap<usize, Result<Arc<Probe>, &'static str>>,
    /// So that no other pipeline gets the address of one.
    held: Vec<Arc<Described>>,
}

#[derive(Debug)]
struct Probe {
    pipeline: wgpu::RenderPipeline,
    logging: Logging,
    /// Which group the log is bound as.
    group: u32,
    /// The layouts are the pipeline's own.
    is_automatic: bool,
}

fn probe(device: &wgpu::Device, described: &Described) -> Result<Probe, &'static str> {
    if described.multiview_mask.is_some() {
        return Err("draws into several views at once are not followed");
    }
    let module = described.vertex.source.module().ok_or("its vertex shader is in no language that is read")?;
    let entry_point = described.vertex.entry_point.as_deref();
    let limits = device.limits();
    let features = device.features();
    if !features.contains(wgpu::Features::VERTEX_WRITABLE_STORAGE) {
        return Err("vertex shaders can't write to storage on this GPU");
    }
    // A pipeline with layouts of its own has as many groups as its shaders use.
    let automatic = || module.global_variables.iter().filter_map(|(_, of)| of.binding).map(|of| of.group + 1).max();
    let group = match &described.layout {
        Some((groups, _)) => groups.len() as u32,
        None => automatic().unwrap_or(0),
    };
    if group >= limits.max_bind_groups {
        return Err("it binds as many groups as this GPU has");
    }
    let logging = rewrite::vertex_log(&module, entry_point, group)?;
    let source = wgpu::ShaderSource::Naga(std::borrow::Cow::Owned(logging.module.clone()));
    let module =
        device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("stencilscope probe"), source });
    let layout = described.layout.as_ref().map(|(groups, immediate_size)| {
        let log = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("stencilscope log"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage { read_only: false },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let groups: Vec<Option<&wgpu::BindGroupLayout>> =
            groups.iter().map(Option::as_ref).chain([Some(&log)]).collect();
        device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("stencilscope probe"),
            bind_group_layouts: &groups,
            immediate_size: *immediate_size,
        })
    });
    let constants: Vec<(&str, f64)> =
        described.vertex.constants.iter().map(|(name, value)| (&**name, *value)).collect();
    let buffers: Vec<Option<wgpu::VertexBufferLayout<'_>>> = described
        .buffers
        .iter()
        .map(|buffer| {
            buffer.as_ref().map(|buffer| wgpu::VertexBufferLayout {
                array_stride: buffer.stride,
                step_mode: buffer.step,
                attributes: &buffer.attributes,
            })
        })
        .collect();
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("stencilscope probe"),
        layout: layout.as_ref(),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(&logging.entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..wgpu::PipelineCompilationOptions::default()
            },
            buffers: &buffers,
        },
        primitive: wgpu::PrimitiveState {
            topology: described.primitive.topology,
            strip_index_format: described.primitive.strip_index_format,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: FORMAT,
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::Never),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    });
    Ok(Probe { pipeline, logging, group, is_automatic: described.layout.is_none() })
}

/// Of the target of one pixel.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The two devices' ends that everything here needs.
#[derive(Debug, Clone, Copy)]
pub struct Gpu<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}

impl Probes {
    /// Where the vertices of a draw land.
    ///
    /// # Errors
    /// Why that can't be found, in words.
    pub fn landed(&mut self, gpu: Gpu<'_>, state: &PassState, draw: &DrawCommand) -> Result<Landed, &'static str> {
        let described = state.pipeline().ok_or("it has no pipeline")?;
        let probe = self.probe(gpu.device, described)?;
        let parts = direct(gpu, draw)?;
        let mut all = Landed::default();
        for part in &parts {
            let corners = corners(gpu, state, described, part)?;
            let log = probe.log(gpu, state, part, corners.len() as u64)?;
            all.add(described, part, &corners, &log)?;
        }
        Ok(all)
    }

    fn probe(&mut self, device: &wgpu::Device, described: &Arc<Described>) -> Result<Arc<Probe>, &'static str> {
        let key = Arc::as_ptr(described) as usize;
        if !self.made.contains_key(&key) {
            self.held.push(described.clone());
            self.made.insert(key, probe(device, described).map(Arc::new));
        }
        self.made[&key].clone()
    }
}

impl Probe {
    /// Each vertex of each instance, and where it lands.
    fn log(&self, gpu: Gpu<'_>, state: &PassState, draw: &DrawCommand, corners: u64) -> Result<Log, &'static str> {
        let Gpu { device, queue } = gpu;
        let instances = instances(draw).len() as u64;
        let room = corners * instances;
        let size = HEAD + RECORD * room.max(1);
        if room > MOST_CORNERS || size > device.limits().max_storage_buffer_binding_size {
            return Err("it has more corners than are followed");
        }
        let log = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("stencilscope log"),
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("stencilscope probe"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("stencilscope probe"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        for command in state.commands() {
            match command {
                PassCommand::IndexBuffer { .. } | PassCommand::VertexBuffer { .. } | PassCommand::Immediates { .. } => {
                    command.encode(&mut pass);
                }
                PassCommand::BindGroup { index, group: Some(group), offsets } if *index < self.group => {
                    if self.is_automatic {
                        let of_vertex = |(binding, _): &&(u32, _)| self.logging.bindings.contains(&(*index, *binding));
                        let entries: Vec<_> = group.entries.iter().filter(of_vertex).cloned().collect();
                        if !entries.is_empty() {
                            let layout = self.pipeline.get_bind_group_layout(*index);
                            pass.set_bind_group(*index, &real_group(device, None, &layout, &entries), offsets);
                        }
                    } else {
                        pass.set_bind_group(*index, &group.real, offsets);
                    }
                }
                _ => {}
            }
        }
        let layout = self.pipeline.get_bind_group_layout(self.group);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("stencilscope log"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: log.as_entire_binding() }],
        });
        pass.set_bind_group(self.group, &group, &[]);
        draw.encode(&mut pass);
        drop(pass);
        queue.submit([encoder.finish()]);
        let bytes =
            readback::buffer(device, queue, &log, 0, size).ok_or("the GPU did not say where its vertices land")?;
        Log::read(&bytes)
    }
}

/// Positions by instance and vertex.
struct Log(HashMap<(u32, u32), [f32; 4]>);

impl Log {
    fn read(bytes: &[u8]) -> Result<Log, &'static str> {
        let (head, records) = bytes.split_at(HEAD as usize);
        let word = |bytes: &[u8], at: usize| bytemuck::pod_read_unaligned::<u32>(&bytes[4 * at..4 * at + 4]);
        let count = word(head, 0) as usize;
        let records = records.chunks_exact(RECORD as usize);
        if count > records.len() {
            return Err("its vertex shader ran more often than it has corners");
        }
        let read = |record: &[u8]| {
            ((word(record, 5), word(record, 4)), [0, 1, 2, 3].map(|at| f32::from_bits(word(record, at))))
        };
        Ok(Log(records.take(count).map(read).collect()))
    }
}

impl Landed {
    fn add(
        &mut self,
        described: &Described,
        draw: &DrawCommand,
        corners: &[Option<u32>],
        Log(log): &Log,
    ) -> Result<(), &'static str> {
        for instance in instances(draw) {
            let mut places: HashMap<u32, u32> = HashMap::new();
            let mut place = |vertex: u32| -> Result<u32, &'static str> {
                if let Some(place) = places.get(&vertex) {
                    return Ok(*place);
                }
                let position = log.get(&(instance, vertex)).ok_or("the GPU did not run its shader for all vertices")?;
                let place = self.positions.len() as u32;
                self.positions.push(*position);
                places.insert(vertex, place);
                Ok(place)
            };
            let begin = self.triangles.len();
            for triangle in unroll::triangles(topology(described), corners) {
                let [a, b, c] = triangle.map(&mut place);
                self.triangles.push([a?, b?, c?]);
            }
            self.instances.push(begin..self.triangles.len());
        }
        Ok(())
    }
}

fn instances(draw: &DrawCommand) -> Range<u32> {
    match draw {
        DrawCommand::Vertices { instances, .. } | DrawCommand::Indexed { instances, .. } => instances.clone(),
        _ => 0..0,
    }
}

/// A draw whose numbers are on the GPU as draws whose numbers are known.
fn direct(gpu: Gpu<'_>, draw: &DrawCommand) -> Result<Vec<DrawCommand>, &'static str> {
    let words = |buffer: &wgpu::Buffer, offset: u64, count: u64| {
        let bytes = readback::buffer(gpu.device, gpu.queue, buffer, offset, 4 * count);
        let bytes = bytes.ok_or("its indirect buffer can't be read")?;
        Ok::<Vec<u32>, &'static str>(bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect())
    };
    let (buffer, offset, count, is_indexed) = match draw {
        DrawCommand::Vertices { .. } | DrawCommand::Indexed { .. } => return Ok(vec![draw.clone()]),
        DrawCommand::Indirect { buffer, offset, is_indexed } => (buffer, *offset, 1, *is_indexed),
        DrawCommand::Multi { buffer, offset, count, is_indexed } => (buffer, *offset, *count, *is_indexed),
        DrawCommand::Counted { buffer, offset, count, count_offset, most, is_indexed } => {
            let counted = words(count, *count_offset, 1)?[0];
            (buffer, *offset, counted.min(*most), *is_indexed)
        }
        DrawCommand::MeshTasks(_) | DrawCommand::MeshTasksIndirect { .. } => {
            return Err("mesh shaders are not followed");
        }
    };
    let size = if is_indexed { 5 } else { 4 };
    let words = words(buffer, offset, size * u64::from(count))?;
    let part = |words: &[u32]| {
        let range = |first: u32, count: u32| first..first.saturating_add(count);
        match *words {
            [indices, instances, first, base_vertex, first_instance] => DrawCommand::Indexed {
                indices: range(first, indices),
                base_vertex: base_vertex.cast_signed(),
                instances: range(first_instance, instances),
            },
            [vertices, instances, first, first_instance] => {
                DrawCommand::Vertices { vertices: range(first, vertices), instances: range(first_instance, instances) }
            }
            _ => DrawCommand::Vertices { vertices: 0..0, instances: 0..0 },
        }
    };
    Ok(words.chunks_exact(size as usize).map(part).collect())
}

/// The vertices of a direct draw in the order drawn, `None` where a strip starts again.
fn corners(
    gpu: Gpu<'_>,
    state: &PassState,
    described: &Described,
    draw: &DrawCommand,
) -> Result<Vec<Option<u32>>, &'static str> {
    let (indices, base_vertex) = match draw {
        DrawCommand::Indexed { indices, base_vertex, .. } => (indices, *base_vertex),
        DrawCommand::Vertices { vertices, .. } if vertices.len() as u64 > MOST_CORNERS => {
            return Err("it has more corners than are followed");
        }
        DrawCommand::Vertices { vertices, .. } => return Ok(vertices.clone().map(Some).collect()),
        _ => return Ok(Vec::new()),
    };
    let (buffer, format, offset) = state.index_buffer().ok_or("it has no index buffer")?;
    let size = format.byte_size() as u64;
    let (from, bytes) = (offset + size * u64::from(indices.start), size * indices.len() as u64);
    let bytes = readback::buffer(gpu.device, gpu.queue, buffer, from, bytes).ok_or("its index buffer can't be read")?;
    let read: Vec<u32> = match format {
        wgpu::IndexFormat::Uint16 => {
            bytes.as_chunks::<2>().0.iter().map(|two| u32::from(u16::from_le_bytes(*two))).collect()
        }
        wgpu::IndexFormat::Uint32 => bytes.as_chunks::<4>().0.iter().map(|four| u32::from_le_bytes(*four)).collect(),
    };
    let restarts = described.primitive.strip_index_format.map(|format| match format {
        wgpu::IndexFormat::Uint16 => u32::from(u16::MAX),
        wgpu::IndexFormat::Uint32 => u32::MAX,
    });
    let corner = |index: u32| (Some(index) != restarts).then(|| index.wrapping_add_signed(base_vertex));
    Ok(read.into_iter().map(corner).collect())
}
