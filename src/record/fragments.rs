//! Which fragments of a draw its shader does not discard: the draw is run once more, each instance by itself, into a
//! target of the same size with no test, by a fragment shader that logs the fragments that the program's own does not
//! discard.
//!
//! What a shader discards depends on what it reads, as it was when the draw began: this runs before the draw does.

use super::probe::{Probe, ProbeGpu, ProbeParts, ProbeStage, begin, free_group, target};
use super::readback;
use super::rewrite::{self, FRAGMENT_RECORD, HEAD, LoggingModule};
use super::states::PassState;
use crate::wrap::PipelineSource;
use crate::wrap::command::{DrawCommand, PassCommand};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Returns the probe of a pipeline: a copy that logs the fragments that its shader retains, whatever the depth test
/// says.
///
/// # Errors
/// Why there is none, in words.
pub fn probe(device: &wgpu::Device, described: &PipelineSource) -> Result<Probe, &'static str> {
    if !device.features().contains(wgpu::Features::PRIMITIVE_INDEX) {
        return Err("fragment shaders can't tell triangles on this GPU");
    }
    if described.multisample.count > 1 || described.multisample.alpha_to_coverage_enabled {
        return Err("its fragments have samples");
    }
    let stage = described.fragment.as_ref().ok_or("it has no fragment shader")?;
    let fragment = stage.source.module().ok_or("its fragment shader is in no language that is read")?;
    let vertex = described.vertex.source.module().ok_or("its vertex shader is in no language that is read")?;
    let group = free_group(device, described, &[&vertex, &fragment])?;
    let LoggingModule { module, entry_point, mut bindings } =
        rewrite::fragment_log(&fragment, stage.entry_point.as_deref(), group)?;
    bindings.extend(rewrite::vertex_bindings(&vertex, described.vertex.entry_point.as_deref())?);
    let vertex = (*vertex).clone();
    let parts = ProbeParts {
        vertex: ProbeStage::of(device, &described.vertex, vertex, described.vertex.entry_point.clone()),
        fragment: Some(ProbeStage::of(device, stage, module, Some(entry_point))),
        primitive: described.primitive,
        bias: described.depth_stencil.as_ref().map(|state| state.bias).unwrap_or_default(),
        compare: wgpu::CompareFunction::Always,
        group,
        log: vec![(wgpu::ShaderStages::FRAGMENT, false), (wgpu::ShaderStages::FRAGMENT, true)],
        bindings,
    };
    Ok(Probe::new(device, described, parts))
}

/// Returns the retained fragments of some draws of one instance, each with the number of its first triangle.
///
/// # Errors
/// There are more than `most`, or the GPU fails.
pub fn retained(
    probe: &Probe,
    gpu: ProbeGpu<'_>,
    state: &PassState,
    draws: &[(DrawCommand, u32)],
    size: [u32; 2],
    most: u64,
) -> Result<Vec<([u16; 2], u32)>, &'static str> {
    // Enough for one layer of fragments; grown where there are more.
    let mut capacity = most.min(u64::from(size[0]) * u64::from(size[1]));
    loop {
        let log = log(probe, gpu, state, draws, size, capacity)?;
        let read = |offset: u64, bytes: u64| {
            let read = readback::buffer(gpu.device, gpu.queue, &log, offset, bytes);
            read.ok_or("the GPU did not say which fragments it keeps")
        };
        let count = u64::from(word(&read(0, HEAD)?, 0));
        if count <= capacity {
            let record = |record: &[u8]| {
                let pixel = word(record, 0);
                ([pixel as u16, (pixel >> 16) as u16], word(record, 1))
            };
            let records = read(HEAD, FRAGMENT_RECORD * count)?;
            return Ok(records.chunks_exact(FRAGMENT_RECORD as usize).map(record).collect());
        }
        if count > most {
            return Err(TOO_MANY);
        }
        capacity = count;
    }
}

const TOO_MANY: &str = "it has more fragments than are followed";

fn word(bytes: &[u8], at: usize) -> u32 {
    bytemuck::pod_read_unaligned(&bytes[4 * at..4 * at + 4])
}

fn log(
    probe: &Probe,
    ProbeGpu { device, queue }: ProbeGpu<'_>,
    state: &PassState,
    draws: &[(DrawCommand, u32)],
    size: [u32; 2],
    capacity: u64,
) -> Result<wgpu::Buffer, &'static str> {
    let bytes = HEAD + FRAGMENT_RECORD * capacity.max(1);
    if bytes > device.limits().max_storage_buffer_binding_size {
        return Err(TOO_MANY);
    }
    let log = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("stencilscope log"),
        size: bytes,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let view = target(device, size);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = begin(&mut encoder, &view);
    probe.set(device, &mut pass, state, |command| {
        matches!(command, PassCommand::Scissor(_) | PassCommand::Viewport { .. })
    });
    for (draw, first) in draws {
        let contents = bytemuck::bytes_of(first);
        let (label, usage) = (Some("stencilscope first triangle"), wgpu::BufferUsages::STORAGE);
        let first = device.create_buffer_init(&BufferInitDescriptor { label, contents, usage });
        probe.bind(device, &mut pass, &[log.as_entire_binding(), first.as_entire_binding()]);
        draw.encode(&mut pass);
    }
    drop(pass);
    queue.submit([encoder.finish()]);
    Ok(log)
}
