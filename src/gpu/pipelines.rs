//! Pipelines and bind-group layouts, made once for each description.
//!
//! Groups: 0 the pass's view, 1 the draw's constants, 2 a surface's data or which fragments are retained, 3 the light
//! and, for programs that read them, its map or labels. A program has only the groups it uses.

use super::shaders::{ShaderInputs, ShaderKey, source_of};
use super::specialization::Specialization;
use crate::plan::{ColorWrite, RasterState, Visibility};
use std::collections::HashMap;
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BlendComponent, BlendFactor,
    BlendOperation, BlendState, BufferBindingType, ColorTargetState, ColorWrites, DepthStencilState, Device,
    FragmentState, RenderPipeline, RenderPipelineDescriptor, ShaderModule, ShaderStages, TextureFormat,
    VertexBufferLayout, VertexState,
};

/// The shader, state and formats that a render pipeline is made from; pipelines are cached by it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct PipelineKey {
    pub shader: ShaderKey,
    pub specialization: Specialization,
    /// The raster state; its stencil reference is 0 here, as the pass sets that.
    pub raster: RasterState,
    pub color_format: Option<TextureFormat>,
    pub depth_format: Option<TextureFormat>,
    /// The integer that depth 1 is stored as, where depths are stored as integers; else `None`.
    pub depth_steps: Option<u32>,
    /// The bits of the constant bias that the shader adds to depths before it floors them.
    pub shader_bias: u32,
}

/// The layouts of all bind groups that shaders use.
#[derive(Debug)]
pub(super) struct BindGroupLayouts {
    pub view: BindGroupLayout,
    pub draw: BindGroupLayout,
    pub surface: BindGroupLayout,
    pub textured_surface: BindGroupLayout,
    pub retained: BindGroupLayout,
    pub light: BindGroupLayout,
    pub light_with_map: BindGroupLayout,
    pub light_with_labels: BindGroupLayout,
    pub light_with_count: BindGroupLayout,
    pub light_with_textures: BindGroupLayout,
}

/// The cache of render pipelines, with the bind group layouts and samplers that they share.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub layouts: BindGroupLayouts,
    /// A sampler with linear filtering, clamped to the edge.
    pub smooth_sampler: wgpu::Sampler,
    /// Samplers of surfaces' textures, which mix texels and mip levels: one repeats, one clamps to the edge.
    pub picture_samplers: [wgpu::Sampler; 2],
    modules: HashMap<ShaderKey, ShaderModule>,
    pipelines: HashMap<PipelineKey, RenderPipeline>,
    starts: HashMap<TextureFormat, RenderPipeline>,
}

/// The largest number of pipelines that are cached at once: a driver may store a hundred kilobytes of code for each. A
/// plan of more makes some anew.
const MOST_CACHED: usize = 512;

const POSITION_ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x4];
/// The vertex attributes of `ExtrudedCorner` of the plan.
const EXTRUDED_ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4];

impl Pipelines {
    /// Makes the bind group layouts and samplers; no pipeline is made yet.
    pub fn new(device: &Device) -> Pipelines {
        let smooth_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("smooth"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        let picture_samplers = [wgpu::AddressMode::Repeat, wgpu::AddressMode::ClampToEdge].map(|mode| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("picture"),
                address_mode_u: mode,
                address_mode_v: mode,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            })
        });
        Pipelines {
            layouts: BindGroupLayouts::new(device),
            smooth_sampler,
            picture_samplers,
            modules: HashMap::new(),
            pipelines: HashMap::new(),
            starts: HashMap::new(),
        }
    }

    /// Returns the pipeline that writes the depths a target of this format starts with, made on first use.
    pub fn start(&mut self, device: &Device, format: TextureFormat) -> RenderPipeline {
        self.starts.entry(format).or_insert_with(|| super::start::pipeline(device, format)).clone()
    }

    /// Returns the pipeline of a key, made on first use. Where too many are cached, all are dropped first.
    pub fn get(&mut self, device: &Device, key: &PipelineKey) -> RenderPipeline {
        if let Some(pipeline) = self.pipelines.get(key) {
            return pipeline.clone();
        }
        if self.pipelines.len() >= MOST_CACHED {
            // A slider moved over many biases has made one each.
            self.pipelines.clear();
        }
        let pipeline = self.create(device, key);
        self.pipelines.insert(key.clone(), pipeline.clone());
        pipeline
    }

    fn create(&mut self, device: &Device, key: &PipelineKey) -> RenderPipeline {
        let (source, program) = (source_of(key.shader), key.shader.program);
        let module = self.modules.entry(key.shader).or_insert_with(|| {
            let text = wgpu::ShaderSource::Wgsl(source.source.clone().into());
            device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(source.vertex), source: text })
        });
        let groups = self.layouts.of(key.shader);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(source.vertex),
            bind_group_layouts: &groups.map(Some)[..key.shader.group_count()],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let (array_stride, attributes) = if key.shader.form == ShaderInputs::Extruded {
            (32, &EXTRUDED_ATTRIBUTES[..])
        } else {
            (16, &POSITION_ATTRIBUTES[..])
        };
        let positions = Some(VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes });
        let color_target = key.color_format.map(|format| color_target(format, key.raster.color));
        let specialized = key.specialization.constants(program);
        let stepped = key.depth_steps.map(|steps| {
            let bias = f64::from(f32::from_bits(key.shader_bias));
            [("steps", f64::from(steps)), ("constant_bias", bias)]
        });
        let with_steps = [&specialized[..], stepped.as_ref().map_or(&[], |stepped| &stepped[..])].concat();
        let options = |constants| wgpu::PipelineCompilationOptions { constants, ..Default::default() };
        let fragment = source.fragment_for(key.depth_steps.is_some());
        device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some(source.vertex),
            layout: Some(&layout),
            vertex: VertexState {
                module,
                entry_point: Some(source.vertex),
                compilation_options: options(&specialized),
                buffers: if key.shader.pulls_vertices() { &[] } else { std::slice::from_ref(&positions) },
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: key.raster.cull,
                front_face: key.raster.front_face,
                unclipped_depth: key.raster.unclipped_depth,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: key.depth_format.map(|format| depth_stencil(format, &key.raster)),
            multisample: wgpu::MultisampleState::default(),
            fragment: fragment.as_deref().map(|entry_point| FragmentState {
                module,
                entry_point: Some(entry_point),
                compilation_options: options(&with_steps),
                targets: if source.writes_color { std::slice::from_ref(&color_target) } else { &[] },
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn color_target(format: TextureFormat, write: ColorWrite) -> ColorTargetState {
    let blend = |src_factor, dst_factor, operation| {
        let component = BlendComponent { src_factor, dst_factor, operation };
        Some(BlendState { color: component, alpha: component })
    };
    ColorTargetState {
        format,
        blend: match write {
            ColorWrite::None | ColorWrite::Replace | ColorWrite::Blend => None,
            ColorWrite::Add => blend(BlendFactor::One, BlendFactor::One, BlendOperation::Add),
            ColorWrite::Multiply => blend(BlendFactor::Dst, BlendFactor::Zero, BlendOperation::Add),
            ColorWrite::Minimum => blend(BlendFactor::One, BlendFactor::One, BlendOperation::Min),
        },
        write_mask: ColorWrites::ALL,
    }
}

fn depth_stencil(format: TextureFormat, raster: &RasterState) -> DepthStencilState {
    DepthStencilState {
        format,
        depth_write_enabled: Some(raster.depth_write),
        depth_compare: Some(raster.depth_compare),
        stencil: raster.stencil.clone(),
        bias: raster.depth_bias,
    }
}

impl BindGroupLayouts {
    fn new(device: &Device) -> BindGroupLayouts {
        let both = ShaderStages::VERTEX_FRAGMENT;
        let uniform = |binding| entry(binding, both, BufferBindingType::Uniform, true);
        // For programs that branch on the light's values: see `uniforms.rs`.
        let branched_on = |binding| entry(binding, both, BufferBindingType::Storage { read_only: true }, true);
        let storage =
            |binding| entry(binding, ShaderStages::VERTEX, BufferBindingType::Storage { read_only: true }, false);
        let texture = |sample_type, view_dimension| BindGroupLayoutEntry {
            binding: 1,
            visibility: ShaderStages::FRAGMENT,
            ty: BindingType::Texture { sample_type, view_dimension, multisampled: false },
            count: None,
        };
        let map = texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array);
        let float = |filterable| wgpu::TextureSampleType::Float { filterable };
        let count = texture(float(false), wgpu::TextureViewDimension::D2);
        let textures = texture(float(true), wgpu::TextureViewDimension::D2Array);
        let sampler = BindGroupLayoutEntry {
            binding: 2,
            visibility: ShaderStages::FRAGMENT,
            ty: BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            count: None,
        };
        let labels = texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);
        let picture = BindGroupLayoutEntry { binding: 5, ..texture(float(true), wgpu::TextureViewDimension::D2) };
        let picture_sampler = BindGroupLayoutEntry { binding: 6, ..sampler };
        let layout = |label, entries: &[BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        BindGroupLayouts {
            view: layout("view", &[uniform(0)]),
            draw: layout("draw", &[uniform(0)]),
            surface: layout("surface", &[storage(0), storage(1), storage(2), storage(3)]),
            textured_surface: layout(
                "textured surface",
                &[storage(0), storage(1), storage(2), storage(3), storage(4), picture, picture_sampler],
            ),
            retained: layout(
                "kept fragments",
                &[entry(0, ShaderStages::FRAGMENT, BufferBindingType::Storage { read_only: true }, false)],
            ),
            light: layout("light", &[uniform(0)]),
            light_with_map: layout("light with map", &[branched_on(0), map]),
            light_with_labels: layout("light with labels", &[uniform(0), labels]),
            light_with_count: layout("light with count", &[uniform(0), count]),
            light_with_textures: layout("light with textures", &[branched_on(0), textures, sampler]),
        }
    }

    fn of(&self, shader: ShaderKey) -> [&BindGroupLayout; 4] {
        let light = match shader.program.visibility() {
            Some(Visibility::Map) => &self.light_with_map,
            Some(Visibility::Labels) => &self.light_with_labels,
            Some(Visibility::Count) => &self.light_with_count,
            Some(Visibility::ReceiverTexture | Visibility::Projected) => &self.light_with_textures,
            Some(Visibility::Everywhere) | None => &self.light,
        };
        let surface = match shader.form {
            ShaderInputs::Textured => &self.textured_surface,
            ShaderInputs::Retained => &self.retained,
            ShaderInputs::Plain | ShaderInputs::Extruded => &self.surface,
        };
        [&self.view, &self.draw, surface, light]
    }
}

fn entry(binding: u32, visibility: ShaderStages, ty: BufferBindingType, dynamic: bool) -> BindGroupLayoutEntry {
    let ty = BindingType::Buffer { ty, has_dynamic_offset: dynamic, min_binding_size: None };
    BindGroupLayoutEntry { binding, visibility, ty, count: None }
}
