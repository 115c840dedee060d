//! Clip-space positions of a draw's vertices: the draw is run once more into a target of one pixel whose content is
//! discarded, by a shader that logs them.

use super::probe::{Probe, ProbeGpu, ProbeParts, ProbeStage, begin, free_group, target};
use super::readback;
use super::rewrite::{self, HEAD, LoggingModule, RECORD};
use super::states::{PassState, topology};
use crate::import::unroll;
use crate::wrap::PipelineSource;
use crate::wrap::command::DrawCommand;
use std::collections::HashMap;
use std::ops::Range;

/// The most corners, over all instances, that a draw may have to be followed.
pub const MOST_CORNERS: u64 = 1 << 22;
/// How often a vertex shader may run for each corner, on average, where the GPU has space for that.
const RUNS: u64 = 4;

/// A draw's vertices and triangles, as `RawDraw` has them.
#[derive(Debug, Default)]
pub struct ResolvedVertices {
    pub positions: Vec<[f32; 4]>,
    pub triangles: Vec<[u32; 3]>,
    pub instances: Vec<Range<usize>>,
}

/// Returns the probe of a pipeline: a copy that logs the clip-space positions of its vertices and draws nothing. Fails
/// with the reason in words.
pub fn probe(device: &wgpu::Device, described: &PipelineSource) -> Result<Probe, &'static str> {
    if !device.features().contains(wgpu::Features::VERTEX_WRITABLE_STORAGE) {
        return Err("vertex shaders can't write to storage on this GPU");
    }
    let module = described.vertex.source.module().ok_or("its vertex shader is in no language that is read")?;
    let group = free_group(device, described, &[&module])?;
    let LoggingModule { module, entry_point, bindings } =
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

/// Runs a direct draw with the probe and returns the position of each vertex of each instance. `corners` is the number
/// of corners of one instance. Fails with the reason in words.
pub fn log(
    probe: &Probe,
    gpu: ProbeGpu<'_>,
    state: &PassState,
    draw: &DrawCommand,
    corners: u64,
) -> Result<PositionLog, &'static str> {
    let ProbeGpu { device, queue } = gpu;
    let instances = instances(draw).len() as u64;
    // A GPU may run a shader for a vertex as often as it likes.
    let least = corners * instances;
    let most = device.limits().max_storage_buffer_binding_size.saturating_sub(HEAD) / RECORD;
    if least > most {
        return Err("it has more corners than are followed");
    }
    let size = HEAD + RECORD * (RUNS * least).min(most).max(1);
    let log = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("stencilscope log"),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let view = target(device, [1, 1]);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = begin(&mut encoder, &view);
    probe.set(device, &mut pass, state, |_| false);
    probe.bind(device, &mut pass, &[log.as_entire_binding()]);
    draw.encode(&mut pass);
    drop(pass);
    queue.submit([encoder.finish()]);
    let bytes = readback::buffer(device, queue, &log, 0, size).ok_or("the GPU did not say where its vertices land")?;
    PositionLog::read(&bytes)
}

/// The clip-space positions that a vertex shader returned, by instance and vertex index.
pub struct PositionLog(HashMap<(u32, u32), [f32; 4]>);

impl PositionLog {
    fn read(bytes: &[u8]) -> Result<PositionLog, &'static str> {
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
        Ok(PositionLog(records.take(count).map(read).collect()))
    }
}

impl ResolvedVertices {
    /// Appends the vertices and triangles of each instance of a direct draw, positions taken from the log; vertices are
    /// shared within an instance only. Fails where the log lacks one, and leaves then what was appended.
    pub fn add(
        &mut self,
        described: &PipelineSource,
        draw: &DrawCommand,
        corners: &[Option<u32>],
        PositionLog(log): &PositionLog,
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

/// Returns the range of instances of a direct draw; an empty range for another.
pub fn instances(draw: &DrawCommand) -> Range<u32> {
    match draw {
        DrawCommand::Vertices { instances, .. } | DrawCommand::Indexed { instances, .. } => instances.clone(),
        _ => 0..0,
    }
}

/// Returns a draw as direct draws, none of them empty: indirect parameters and counts are read back from the GPU, which
/// is waited for. Fails for mesh shaders and buffers that can't be read.
pub fn direct(gpu: ProbeGpu<'_>, draw: &DrawCommand) -> Result<Vec<DrawCommand>, &'static str> {
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

/// Returns the vertex indices of one instance of a direct draw in the order drawn, base vertex added; `None` where a
/// strip restarts. Index buffers are read back from the GPU. Empty for a draw that is not direct.
pub fn corners(
    gpu: ProbeGpu<'_>,
    state: &PassState,
    described: &PipelineSource,
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
