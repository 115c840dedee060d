//! The pipelines, the layout and the target of fragment logs, cached between logs.

use super::shaders;
use bytemuck::{Pod, Zeroable};
use std::collections::HashMap;
use wgpu::{BindGroupLayout, Device, RenderPipeline, ShaderStages, Texture, TextureFormat};

/// The largest number of pipelines that are cached at once.
const MOST_PIPELINES: usize = 64;

const CORNER_ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x4, 1 => Uint32];

/// The state that a pipeline of the fragment log is made from; pipelines are cached by it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct LogKey {
    pub unclipped_depth: bool,
    pub bias: wgpu::DepthBiasState,
    pub cull: Option<wgpu::Face>,
    pub front_face: wgpu::FrontFace,
    /// True where the corners are in clip space, as those of another program's frame are.
    pub is_recorded: bool,
    pub depth_format: TextureFormat,
}

/// Pipelines, buffers and targets that are cached between fragment logs.
#[derive(Debug, Default)]
pub struct LogCache {
    module: Option<wgpu::ShaderModule>,
    layout: Option<BindGroupLayout>,
    pipelines: HashMap<LogKey, RenderPipeline>,
    /// A depth buffer whose content is not used: depth bias only has an effect where there is one. `None` until the
    /// first log.
    pub target: Option<Texture>,
}

/// A corner of a triangle: the struct `LogCorner` of `fragment_log.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct LogCorner {
    pub relative: [f32; 4],
    pub triangle: u32,
}

impl LogCache {
    /// Returns the bind group layout of the buffer that a fragment log is written to, made by the first call.
    pub fn layout(&mut self, device: &Device) -> &BindGroupLayout {
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

    /// Returns a depth texture of this format and size whose content is not used; a new one replaces the cached one
    /// where format or size differ.
    pub fn target(&mut self, device: &Device, format: TextureFormat, size: [u32; 2]) -> &Texture {
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

    /// Returns the pipeline that logs the fragments of draws with this key, made on first use. `view` is the layout of
    /// bind group 0; it is only used then.
    pub fn pipeline(&mut self, device: &Device, view: &BindGroupLayout, key: &LogKey) -> RenderPipeline {
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
                // With neither a test nor writes Vulkan's depth test is off, and SwiftShader then adds no bias.
                depth_write_enabled: Some(true),
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
