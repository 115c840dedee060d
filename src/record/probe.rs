//! Where a draw's vertices land: the draw is done once more into a target of one pixel that nobody looks at, by a shader
//! that writes it down.

use super::rewrite::{self, HEAD, Logging, RECORD};
use super::states::{PassState, topology};
use super::{fragments, readback};
use crate::import::unroll;
use crate::wrap::command::{DrawCommand, PassCommand};
use crate::wrap::{Described, Layout, Stage, VertexBuffer, real_group};
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

/// More corners than a draw is followed with.
const MOST_CORNERS: u64 = 1 << 22;
/// More instances than are followed fragment by fragment: each is a draw.
const MOST_INSTANCES: usize = 1 << 14;

/// How many corners and kept fragments of a frame there is still memory for.
#[derive(Debug)]
pub struct Room {
    pub corners: u64,
    pub fragments: u64,
}

impl Default for Room {
    /// Half a gigabyte each.
    fn default() -> Room {
        Room { corners: 1 << 25, fragments: 1 << 26 }
    }
}

/// What a draw's vertices are and how they make triangles, as `RawDraw` has them.
#[derive(Debug, Default)]
pub struct Landed {
    pub positions: Vec<[f32; 4]>,
    pub triangles: Vec<[u32; 3]>,
    pub instances: Vec<Range<usize>>,
}

/// The pipelines that write logs.
#[derive(Debug, Default)]
pub struct Probes {
    of_vertices: Made,
    of_fragments: Made,
}

/// Pipelines of one kind: those of the program that differ in nothing that counts here share one.
#[derive(Debug, Default)]
struct Made(Vec<(Arc<Described>, MadeProbe)>);

/// Why there is none, in words, is kept as well.
type MadeProbe = Result<Arc<Probe>, &'static str>;

impl Made {
    fn get(
        &mut self,
        described: &Arc<Described>,
        is_alike: impl Fn(&Described, &Described) -> bool,
        make: impl FnOnce() -> Result<Probe, &'static str>,
    ) -> MadeProbe {
        if let Some((_, made)) = self.0.iter().find(|(of, _)| Arc::ptr_eq(of, described) || is_alike(of, described)) {
            return made.clone();
        }
        let made = make().map(Arc::new);
        self.0.push((described.clone(), made.clone()));
        made
    }
}

/// Have two pipelines the same vertices?
fn have_same_vertices(one: &Described, other: &Described) -> bool {
    let of = |of: &Described| (of.primitive.topology, of.primitive.strip_index_format, of.multiview_mask);
    let layout = |of: &Described| of.layout.as_ref().map(|layout| (layout.groups.clone(), layout.immediate_size));
    of(one) == of(other) && one.vertex == other.vertex && one.buffers == other.buffers && layout(one) == layout(other)
}

/// And the same fragments, before any test?
fn have_same_fragments(one: &Described, other: &Described) -> bool {
    let bias = |of: &Described| of.depth_stencil.as_ref().map(|state| state.bias);
    let of = |of: &Described| (of.primitive, of.multisample, bias(of));
    have_same_vertices(one, other) && of(one) == of(other) && one.fragment == other.fragment
}

/// A pipeline that writes a log while it does what the program's own does.
#[derive(Debug)]
pub(super) struct Probe {
    pub pipeline: wgpu::RenderPipeline,
    /// Group and binding of what its stages read.
    bindings: BTreeSet<(u32, u32)>,
    /// Which group the log is bound as.
    group: u32,
    /// The layouts are the pipeline's own.
    is_automatic: bool,
}

/// Which group of a pipeline's is free for a log.
///
/// # Errors
/// None is; or it draws in a way that is not followed.
pub(super) fn free_group(
    device: &wgpu::Device,
    described: &Described,
    modules: &[&naga::Module],
) -> Result<u32, &'static str> {
    if described.multiview_mask.is_some() {
        return Err("draws into several views at once are not followed");
    }
    // A pipeline with layouts of its own has as many groups as its shaders use.
    let variables = modules.iter().flat_map(|module| module.global_variables.iter());
    let automatic = || variables.filter_map(|(_, of)| of.binding).map(|of| of.group + 1).max();
    let group = match &described.layout {
        Some(layout) => layout.groups.len() as u32,
        None => automatic().unwrap_or(0),
    };
    let is_free = group < device.limits().max_bind_groups;
    is_free.then_some(group).ok_or("it binds as many groups as this GPU has")
}

/// A stage that is rewritten, or goes on as it is.
pub(super) struct ProbeStage {
    pub module: wgpu::ShaderModule,
    pub entry_point: Option<String>,
    pub constants: Vec<(String, f64)>,
}

impl ProbeStage {
    /// Of a stage of the program's, with another module.
    pub fn of(device: &wgpu::Device, stage: &Stage, module: naga::Module, entry_point: Option<String>) -> ProbeStage {
        let source = wgpu::ShaderSource::Naga(std::borrow::Cow::Owned(module));
        let label = Some("stencilscope probe");
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
        ProbeStage { module, entry_point, constants: stage.constants.clone() }
    }

    fn constants(&self) -> Vec<(&str, f64)> {
        self.constants.iter().map(|(name, value)| (&**name, *value)).collect()
    }
}

/// How a pipeline of a probe differs from the program's.
pub(super) struct ProbeParts {
    pub vertex: ProbeStage,
    pub fragment: Option<ProbeStage>,
    pub primitive: wgpu::PrimitiveState,
    pub bias: wgpu::DepthBiasState,
    pub compare: wgpu::CompareFunction,
    pub group: u32,
    /// What is bound in that group, all of it storage: who sees it, and whether it is only read.
    pub log: Vec<(wgpu::ShaderStages, bool)>,
    pub bindings: BTreeSet<(u32, u32)>,
}

impl Probe {
    /// `described` is the program's.
    pub fn new(device: &wgpu::Device, described: &Described, parts: ProbeParts) -> Probe {
        let layout = described.layout.as_ref().map(|Layout { groups, immediate_size, .. }| {
            let entry = |(binding, (visibility, read_only)): (u32, &(wgpu::ShaderStages, bool))| {
                let ty = wgpu::BufferBindingType::Storage { read_only: *read_only };
                let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
                wgpu::BindGroupLayoutEntry { binding, visibility: *visibility, ty, count: None }
            };
            let entries: Vec<_> = (0..).zip(&parts.log).map(entry).collect();
            let log = wgpu::BindGroupLayoutDescriptor { label: Some("stencilscope log"), entries: &entries };
            let log = device.create_bind_group_layout(&log);
            let groups: Vec<Option<&wgpu::BindGroupLayout>> =
                groups.iter().map(Option::as_ref).chain([Some(&log)]).collect();
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("stencilscope probe"),
                bind_group_layouts: &groups,
                immediate_size: *immediate_size,
            })
        });
        let buffers: Vec<_> = described.buffers.iter().map(|buffer| buffer.as_ref().map(layout_of)).collect();
        let of_vertex = parts.vertex.constants();
        let of_fragment = parts.fragment.as_ref().map(ProbeStage::constants).unwrap_or_default();
        let options = |constants| wgpu::PipelineCompilationOptions { constants, ..Default::default() };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("stencilscope probe"),
            layout: layout.as_ref(),
            vertex: wgpu::VertexState {
                module: &parts.vertex.module,
                entry_point: parts.vertex.entry_point.as_deref(),
                compilation_options: options(&of_vertex),
                buffers: &buffers,
            },
            primitive: parts.primitive,
            depth_stencil: Some(wgpu::DepthStencilState {
                format: FORMAT,
                depth_write_enabled: Some(false),
                depth_compare: Some(parts.compare),
                stencil: wgpu::StencilState::default(),
                bias: parts.bias,
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: parts.fragment.as_ref().map(|stage| wgpu::FragmentState {
                module: &stage.module,
                entry_point: stage.entry_point.as_deref(),
                compilation_options: options(&of_fragment),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        });
        let is_automatic = described.layout.is_none();
        Probe { pipeline, bindings: parts.bindings, group: parts.group, is_automatic }
    }

    /// Sets the pipeline, and of the program's states those that `is_wanted`.
    pub fn set(
        &self,
        device: &wgpu::Device,
        pass: &mut wgpu::RenderPass<'_>,
        state: &PassState,
        is_wanted: impl Fn(&PassCommand) -> bool,
    ) {
        pass.set_pipeline(&self.pipeline);
        for command in state.commands() {
            match command {
                PassCommand::IndexBuffer { .. } | PassCommand::VertexBuffer { .. } | PassCommand::Immediates { .. } => {
                    command.encode(pass);
                }
                PassCommand::BindGroup { index, group: Some(group), offsets } if *index < self.group => {
                    if self.is_automatic {
                        let is_read = |(binding, _): &&(u32, _)| self.bindings.contains(&(*index, *binding));
                        let entries: Vec<_> = group.entries.iter().filter(is_read).cloned().collect();
                        if !entries.is_empty() {
                            let layout = self.pipeline.get_bind_group_layout(*index);
                            pass.set_bind_group(*index, &real_group(device, None, &layout, &entries), offsets);
                        }
                    } else {
                        pass.set_bind_group(*index, &group.real, offsets);
                    }
                }
                other if is_wanted(other) => other.encode(pass),
                _ => {}
            }
        }
    }

    /// Binds its own group.
    pub fn bind(&self, device: &wgpu::Device, pass: &mut wgpu::RenderPass<'_>, log: &[wgpu::BindingResource<'_>]) {
        let log =
            (0..).zip(log).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("stencilscope log"),
            layout: &self.pipeline.get_bind_group_layout(self.group),
            entries: &log.collect::<Vec<_>>(),
        });
        pass.set_bind_group(self.group, &group, &[]);
    }
}

fn layout_of(buffer: &VertexBuffer) -> wgpu::VertexBufferLayout<'_> {
    let VertexBuffer { stride, step, attributes } = buffer;
    wgpu::VertexBufferLayout { array_stride: *stride, step_mode: *step, attributes }
}

fn of_vertices(device: &wgpu::Device, described: &Described) -> Result<Probe, &'static str> {
    if !device.features().contains(wgpu::Features::VERTEX_WRITABLE_STORAGE) {
        return Err("vertex shaders can't write to storage on this GPU");
    }
    let module = described.vertex.source.module().ok_or("its vertex shader is in no language that is read")?;
    let group = free_group(device, described, &[&module])?;
    let Logging { module, entry_point, bindings } =
        rewrite::vertex_log(&module, described.vertex.entry_point.as_deref(), group)?;
    let primitive = wgpu::PrimitiveState {
        topology: described.primitive.topology,
        strip_index_format: described.primitive.strip_index_format,
        ..wgpu::PrimitiveState::default()
    };
    let parts = ProbeParts {
        vertex: ProbeStage::of(device, &described.vertex, module, Some(entry_point)),
        fragment: None,
        primitive,
        bias: wgpu::DepthBiasState::default(),
        compare: wgpu::CompareFunction::Never,
        group,
        log: vec![(wgpu::ShaderStages::VERTEX, false)],
        bindings,
    };
    Ok(Probe::new(device, described, parts))
}

/// Of the target, of which nothing is kept.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A target of which nothing is kept.
pub(super) fn target(device: &wgpu::Device, [width, height]: [u32; 2]) -> wgpu::TextureView {
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("stencilscope probe"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    target.create_view(&wgpu::TextureViewDescriptor::default())
}

pub(super) fn begin<'a>(encoder: &'a mut wgpu::CommandEncoder, target: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("stencilscope probe"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: target,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// The two devices' ends that everything here needs.
#[derive(Debug, Clone, Copy)]
pub struct Gpu<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}

impl Gpu<'_> {
    /// Does what was encoded; `None` where wgpu refuses it.
    pub fn does(self, encoder: wgpu::CommandEncoder) -> Option<()> {
        accepted(self.device, || {
            self.queue.submit([encoder.finish()]);
        })
    }
}

/// Every kind of error.
const FILTERS: [wgpu::ErrorFilter; 3] =
    [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation];

/// Does what is not the program's: an error of it is not the program's either.
fn guarded<T>(device: &wgpu::Device, work: impl FnOnce() -> Result<T, &'static str>) -> Result<T, &'static str> {
    accepted(device, work).unwrap_or(Err("wgpu refuses to draw it once more"))
}

/// What comes of something, unless wgpu refuses it.
pub(super) fn accepted<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Option<T> {
    let scopes = FILTERS.map(|filter| device.push_error_scope(filter));
    let made = work();
    let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop())).count();
    (errors == 0).then_some(made)
}

impl Probes {
    /// Where the vertices of a draw land.
    ///
    /// # Errors
    /// Why that can't be found, in words.
    pub fn landed(
        &mut self,
        gpu: Gpu<'_>,
        state: &PassState,
        draw: &DrawCommand,
        room: &mut Room,
    ) -> Result<Landed, &'static str> {
        let described = state.pipeline().ok_or("it has no pipeline")?;
        let make = || guarded(gpu.device, || of_vertices(gpu.device, described));
        let probe = self.of_vertices.get(described, have_same_vertices, make)?;
        let parts = direct(gpu, draw)?;
        let mut all = Landed::default();
        for part in &parts {
            let corners = corners(gpu, state, described, part)?;
            let all_corners = corners.len() as u64 * instances(part).len() as u64;
            if all_corners > MOST_CORNERS || all_corners > room.corners {
                return Err("it has more corners than are followed");
            }
            room.corners -= all_corners;
            let log = guarded(gpu.device, || probe.log(gpu, state, part, corners.len() as u64))?;
            all.add(described, part, &corners, &log)?;
        }
        Ok(all)
    }

    /// Which fragments of a draw, whose triangles `landed`, its shader keeps, of a target of that size.
    ///
    /// # Errors
    /// Why that can't be found, in words.
    pub fn kept(
        &mut self,
        gpu: Gpu<'_>,
        state: &PassState,
        draw: &DrawCommand,
        landed: &Landed,
        size: [u32; 2],
        room: &mut Room,
    ) -> Result<Vec<([u16; 2], u32)>, &'static str> {
        let described = state.pipeline().ok_or("it has no pipeline")?;
        let make = || guarded(gpu.device, || fragments::probe(gpu.device, described));
        let probe = self.of_fragments.get(described, have_same_fragments, make)?;
        let one_by_one = direct(gpu, draw)?.iter().flat_map(single).collect::<Vec<_>>();
        let first: Vec<u32> = landed.instances.iter().map(|triangles| triangles.start as u32).collect();
        let draws: Vec<_> = one_by_one.into_iter().zip(first).collect();
        if draws.len() > MOST_INSTANCES {
            return Err("it has more instances than are followed fragment by fragment");
        }
        let kept = guarded(gpu.device, || fragments::kept(&probe, gpu, state, &draws, size, room.fragments))?;
        room.fragments -= kept.len() as u64;
        Ok(kept)
    }
}

/// A draw of each instance.
fn single(draw: &DrawCommand) -> Vec<DrawCommand> {
    let one = |instance: u32| match draw.clone() {
        DrawCommand::Vertices { vertices, .. } => DrawCommand::Vertices { vertices, instances: instance..instance + 1 },
        DrawCommand::Indexed { indices, base_vertex, .. } => {
            DrawCommand::Indexed { indices, base_vertex, instances: instance..instance + 1 }
        }
        other => other,
    };
    instances(draw).map(one).collect()
}

impl Probe {
    /// Each vertex of each instance, and where it lands.
    fn log(&self, gpu: Gpu<'_>, state: &PassState, draw: &DrawCommand, corners: u64) -> Result<Log, &'static str> {
        let Gpu { device, queue } = gpu;
        let instances = instances(draw).len() as u64;
        let room = corners * instances;
        let size = HEAD + RECORD * room.max(1);
        if size > device.limits().max_storage_buffer_binding_size {
            return Err("it has more corners than are followed");
        }
        let log = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("stencilscope log"),
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let view = target(device, [1, 1]);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = begin(&mut encoder, &view);
        self.set(device, &mut pass, state, |_| false);
        self.bind(device, &mut pass, &[log.as_entire_binding()]);
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

/// A draw whose numbers may be on the GPU as draws whose numbers are known, and of which none is empty.
fn direct(gpu: Gpu<'_>, draw: &DrawCommand) -> Result<Vec<DrawCommand>, &'static str> {
    let words = |buffer: &wgpu::Buffer, offset: u64, count: u64| {
        let bytes = readback::buffer(gpu.device, gpu.queue, buffer, offset, 4 * count);
        let bytes = bytes.ok_or("its indirect buffer can't be read")?;
        Ok::<Vec<u32>, &'static str>(bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect())
    };
    let (buffer, offset, count, is_indexed) = match draw {
        DrawCommand::Vertices { .. } | DrawCommand::Indexed { .. } => {
            return Ok(Some(draw.clone()).into_iter().filter(draws_some).collect());
        }
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
    Ok(words.chunks_exact(size as usize).map(part).filter(draws_some).collect())
}

fn draws_some(draw: &DrawCommand) -> bool {
    match draw {
        DrawCommand::Vertices { vertices: corners, instances }
        | DrawCommand::Indexed { indices: corners, instances, .. } => !corners.is_empty() && !instances.is_empty(),
        _ => false,
    }
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
