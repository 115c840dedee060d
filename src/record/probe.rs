//! A pipeline of the program's with one of its shaders rewritten to write a log, and its target.

use super::states::PassState;
use crate::wrap::command::PassCommand;
use crate::wrap::{PipelineLayoutSource, PipelineSource, ProgrammableStage, VertexBufferSource, real_group};
use std::collections::BTreeSet;

/// A pipeline that writes a log while it does what the program's own does.
#[derive(Debug)]
pub(super) struct Probe {
    pub pipeline: wgpu::RenderPipeline,
    /// Group and binding of the resources that its stages read.
    bindings: BTreeSet<(u32, u32)>,
    /// Index of the group that the log is bound as.
    group: u32,
    /// True where wgpu derived the layouts from the shaders.
    is_automatic: bool,
}

/// Returns the first bind group index after those that the pipeline uses, where a probe's log can be bound.
///
/// # Errors
/// No group is free; or the pipeline draws in a way that is not followed.
pub(super) fn free_group(
    device: &wgpu::Device,
    described: &PipelineSource,
    modules: &[&naga::Module],
) -> Result<u32, &'static str> {
    if described.multiview_mask.is_some() {
        return Err("draws into several views at once are not followed");
    }
    // A pipeline whose layouts wgpu derives has as many groups as its shaders use.
    let variables = modules.iter().flat_map(|module| module.global_variables.iter());
    let automatic = || variables.filter_map(|(_, of)| of.binding).map(|of| of.group + 1).max();
    let group = match &described.layout {
        Some(layout) => layout.groups.len() as u32,
        None => automatic().unwrap_or(0),
    };
    let is_free = group < device.limits().max_bind_groups;
    is_free.then_some(group).ok_or("it binds as many groups as this GPU has")
}

/// A stage of the pipeline, rewritten or unchanged.
pub(super) struct ProbeStage {
    pub module: wgpu::ShaderModule,
    pub entry_point: Option<String>,
    pub constants: Vec<(String, f64)>,
}

impl ProbeStage {
    /// Returns a shader stage with the program's constants but another module and entry point (`None`: the module's
    /// only one).
    pub fn of(
        device: &wgpu::Device,
        stage: &ProgrammableStage,
        module: naga::Module,
        entry_point: Option<String>,
    ) -> ProbeStage {
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
    /// The bindings of that group, all of them storage: the stages that use each, and whether it is only read.
    pub log: Vec<(wgpu::ShaderStages, bool)>,
    pub bindings: BTreeSet<(u32, u32)>,
}

impl Probe {
    /// Creates the probe of a pipeline that the program created from `described`.
    pub fn new(device: &wgpu::Device, described: &PipelineSource, parts: ProbeParts) -> Probe {
        let layout = described.layout.as_ref().map(|PipelineLayoutSource { groups, immediate_size, .. }| {
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

    /// Sets the probe's pipeline and the states that it needs of the program's pass: index and vertex buffers,
    /// immediates and the bind groups below its own; of other states those for which `is_wanted` is true.
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

    /// Binds the log buffers as the probe's own bind group, from binding 0 on.
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

fn layout_of(buffer: &VertexBufferSource) -> wgpu::VertexBufferLayout<'_> {
    let VertexBufferSource { stride, step, attributes } = buffer;
    wgpu::VertexBufferLayout { array_stride: *stride, step_mode: *step, attributes }
}

/// Format of the target, whose content is discarded.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Creates a colour target of this size for passes that only write a log; its content is never used.
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

/// The real device and queue, which all probes need.
#[derive(Debug, Clone, Copy)]
pub struct ProbeGpu<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}

impl ProbeGpu<'_> {
    /// Finishes an encoder and submits its commands; `None` where wgpu reports an error. Does not wait for the GPU.
    pub fn does(self, encoder: wgpu::CommandEncoder) -> Option<()> {
        accepted(self.device, || {
            self.queue.submit([encoder.finish()]);
        })
    }
}

/// All kinds of errors.
const FILTERS: [wgpu::ErrorFilter; 3] =
    [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation];

/// Runs some work and returns its result; `None` where wgpu reported an error meanwhile, which is dropped.
pub(super) fn accepted<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Option<T> {
    let scopes = FILTERS.map(|filter| device.push_error_scope(filter));
    let made = work();
    let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop())).count();
    (errors == 0).then_some(made)
}
