use super::binding::{BindGroupLayout, PipelineLayout};
use super::shader::ShaderSource;
use super::{FOREIGN, WrappedObject, module_of};
use std::sync::Arc;
use wgpu::custom::{
    ComputePipelineInterface, DispatchBindGroupLayout, PipelineCacheInterface, RenderPipelineInterface,
};

/// A wrapped render pipeline: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct RenderPipeline {
    pub inner: wgpu::RenderPipeline,
    pub described: Arc<PipelineSource>,
}

/// The descriptor that a render pipeline was created from.
#[derive(Debug)]
pub struct PipelineSource {
    pub label: String,
    /// `None` where wgpu derives it from the shaders.
    pub layout: Option<PipelineLayoutSource>,
    pub vertex: ProgrammableStage,
    pub buffers: Vec<Option<VertexBufferSource>>,
    pub primitive: wgpu::PrimitiveState,
    pub depth_stencil: Option<wgpu::DepthStencilState>,
    pub multisample: wgpu::MultisampleState,
    pub fragment: Option<ProgrammableStage>,
    pub targets: Vec<Option<wgpu::ColorTargetState>>,
    pub multiview_mask: Option<std::num::NonZeroU32>,
}

/// A pipeline layout that the program created.
#[derive(Debug, Clone, PartialEq)]
pub struct PipelineLayoutSource {
    pub real: wgpu::PipelineLayout,
    pub groups: Vec<Option<wgpu::BindGroupLayout>>,
    /// Bytes of immediates.
    pub immediate_size: u32,
}

/// The shader, entry point and constants of a pipeline's vertex or fragment stage.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgrammableStage {
    pub source: ShaderSource,
    pub entry_point: Option<String>,
    pub constants: Vec<(String, f64)>,
}

impl ProgrammableStage {
    fn of(
        module: &wgpu::ShaderModule,
        entry_point: Option<&str>,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> ProgrammableStage {
        let constants = options.constants.iter().map(|(name, value)| ((*name).to_owned(), *value));
        ProgrammableStage {
            source: module_of(module).source.clone(),
            entry_point: entry_point.map(str::to_owned),
            constants: constants.collect(),
        }
    }
}

/// The layout of a vertex buffer.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexBufferSource {
    pub stride: u64,
    pub step: wgpu::VertexStepMode,
    pub attributes: Vec<wgpu::VertexAttribute>,
}

impl PipelineSource {
    fn of(descriptor: &wgpu::RenderPipelineDescriptor<'_>) -> PipelineSource {
        let wgpu::RenderPipelineDescriptor { vertex, fragment, .. } = descriptor;
        let layout = descriptor.layout.map(|layout| layout.as_custom::<PipelineLayout>().expect(FOREIGN));
        let buffer = |buffer: &wgpu::VertexBufferLayout<'_>| VertexBufferSource {
            stride: buffer.array_stride,
            step: buffer.step_mode,
            attributes: buffer.attributes.to_vec(),
        };
        PipelineSource {
            label: descriptor.label.unwrap_or_default().to_owned(),
            layout: layout.map(|layout| PipelineLayoutSource {
                real: layout.inner.clone(),
                groups: layout.groups.clone(),
                immediate_size: layout.immediate_size,
            }),
            vertex: ProgrammableStage::of(vertex.module, vertex.entry_point, &vertex.compilation_options),
            buffers: vertex.buffers.iter().map(|one| one.as_ref().map(buffer)).collect(),
            primitive: descriptor.primitive,
            depth_stencil: descriptor.depth_stencil.clone(),
            multisample: descriptor.multisample,
            fragment: fragment
                .as_ref()
                .map(|of| ProgrammableStage::of(of.module, of.entry_point, &of.compilation_options)),
            targets: fragment.as_ref().map_or_else(Vec::new, |fragment| fragment.targets.to_vec()),
            multiview_mask: descriptor.multiview_mask,
        }
    }
}

impl RenderPipeline {
    /// Creates the real render pipeline from a descriptor with wrapped objects, and stores what it was created from.
    pub fn new(device: &wgpu::Device, asked: &wgpu::RenderPipelineDescriptor<'_>) -> RenderPipeline {
        let fragment = asked.fragment.clone();
        let inner = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            layout: asked.layout.map(WrappedObject::real),
            vertex: wgpu::VertexState { module: asked.vertex.module.real(), ..asked.vertex.clone() },
            fragment: fragment.map(|of| wgpu::FragmentState { module: of.module.real(), ..of }),
            cache: asked.cache.map(WrappedObject::real),
            ..asked.clone()
        });
        RenderPipeline { inner, described: Arc::new(PipelineSource::of(asked)) }
    }

    /// Creates a pipeline of mesh shaders, which wgpu refuses, as no device has their feature; its description has no
    /// shader that can be read.
    pub fn of_meshlets(device: &wgpu::Device, asked: &wgpu::MeshPipelineDescriptor<'_>) -> RenderPipeline {
        let fragment = asked.fragment.clone();
        let inner = device.create_mesh_pipeline(&wgpu::MeshPipelineDescriptor {
            layout: asked.layout.map(WrappedObject::real),
            task: asked.task.clone().map(|of| wgpu::TaskState { module: of.module.real(), ..of }),
            mesh: wgpu::MeshState { module: asked.mesh.module.real(), ..asked.mesh.clone() },
            fragment: fragment.map(|of| wgpu::FragmentState { module: of.module.real(), ..of }),
            cache: asked.cache.map(WrappedObject::real),
            ..asked.clone()
        });
        let vertex = ProgrammableStage { source: ShaderSource::Unread, entry_point: None, constants: Vec::new() };
        let described = PipelineSource {
            label: asked.label.unwrap_or_default().to_owned(),
            layout: None,
            vertex,
            buffers: Vec::new(),
            primitive: asked.primitive,
            depth_stencil: asked.depth_stencil.clone(),
            multisample: asked.multisample,
            fragment: None,
            targets: Vec::new(),
            multiview_mask: asked.multiview,
        };
        RenderPipeline { inner, described: Arc::new(described) }
    }
}

impl RenderPipelineInterface for RenderPipeline {
    fn get_bind_group_layout(&self, index: u32) -> DispatchBindGroupLayout {
        DispatchBindGroupLayout::custom(BindGroupLayout { inner: self.inner.get_bind_group_layout(index) })
    }
}

/// A wrapped compute pipeline: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct ComputePipeline {
    pub inner: wgpu::ComputePipeline,
}

impl ComputePipeline {
    /// Creates the real compute pipeline from a descriptor with wrapped objects.
    pub fn new(device: &wgpu::Device, asked: &wgpu::ComputePipelineDescriptor<'_>) -> ComputePipeline {
        let inner = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            layout: asked.layout.map(WrappedObject::real),
            module: asked.module.real(),
            cache: asked.cache.map(WrappedObject::real),
            ..asked.clone()
        });
        ComputePipeline { inner }
    }
}

impl ComputePipelineInterface for ComputePipeline {
    fn get_bind_group_layout(&self, index: u32) -> DispatchBindGroupLayout {
        DispatchBindGroupLayout::custom(BindGroupLayout { inner: self.inner.get_bind_group_layout(index) })
    }
}

/// A wrapped pipeline cache: hands each call to the real one.
#[derive(Debug)]
pub struct PipelineCache {
    pub inner: wgpu::PipelineCache,
}

impl PipelineCacheInterface for PipelineCache {
    fn get_data(&self) -> Option<Vec<u8>> {
        self.inner.get_data()
    }
}
