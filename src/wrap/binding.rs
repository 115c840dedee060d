//! Bind groups and the layouts they are for.

use super::Real;
use std::sync::Arc;
use wgpu::BindingResource as Resource;
use wgpu::custom::{BindGroupInterface, BindGroupLayoutInterface, PipelineLayoutInterface};

#[derive(Debug)]
pub struct BindGroupLayout {
    pub inner: wgpu::BindGroupLayout,
}

impl BindGroupLayoutInterface for BindGroupLayout {}

#[derive(Debug)]
pub struct PipelineLayout {
    pub inner: wgpu::PipelineLayout,
    /// Layouts of its groups.
    pub groups: Vec<Option<wgpu::BindGroupLayout>>,
    /// Bytes of immediates.
    pub immediate_size: u32,
}

impl PipelineLayoutInterface for PipelineLayout {}

impl PipelineLayout {
    pub fn new(device: &wgpu::Device, descriptor: &wgpu::PipelineLayoutDescriptor<'_>) -> PipelineLayout {
        let groups: Vec<Option<&wgpu::BindGroupLayout>> =
            descriptor.bind_group_layouts.iter().map(|layout| layout.map(Real::real)).collect();
        let inner = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            bind_group_layouts: &groups,
            ..descriptor.clone()
        });
        let groups = groups.into_iter().map(|layout| layout.cloned()).collect();
        PipelineLayout { inner, groups, immediate_size: descriptor.immediate_size }
    }
}

#[derive(Debug)]
pub struct BindGroup {
    pub inner: wgpu::BindGroup,
    /// What it binds, so that the same can be bound for a pipeline whose layout is its own.
    pub entries: Arc<[(u32, Bound)]>,
}

impl BindGroupInterface for BindGroup {}

/// A part of a real buffer.
#[derive(Debug, Clone)]
pub struct BufferPart {
    buffer: wgpu::Buffer,
    offset: u64,
    size: Option<wgpu::BufferSize>,
}

impl BufferPart {
    fn of(part: &wgpu::BufferBinding<'_>) -> BufferPart {
        BufferPart { buffer: part.buffer.real().clone(), offset: part.offset, size: part.size }
    }

    fn binding(&self) -> wgpu::BufferBinding<'_> {
        wgpu::BufferBinding { buffer: &self.buffer, offset: self.offset, size: self.size }
    }
}

/// A real resource that is bound.
#[derive(Debug, Clone)]
pub enum Bound {
    Buffers(Vec<BufferPart>, IsArray),
    Samplers(Vec<wgpu::Sampler>, IsArray),
    Views(Vec<wgpu::TextureView>, IsArray),
    Structures(Vec<wgpu::Tlas>, IsArray),
    External(wgpu::ExternalTexture),
}

/// Is it an array, were it of one?
type IsArray = bool;

impl Bound {
    /// Of what the program binds; `None` of a kind that wgpu has gained since.
    fn of(resource: &Resource<'_>) -> Option<Bound> {
        fn real<T: Real>(all: &[&T]) -> Vec<T::Object>
        where
            T::Object: Clone,
        {
            all.iter().map(|one| one.real().clone()).collect()
        }
        Some(match resource {
            Resource::Buffer(part) => Bound::Buffers(vec![BufferPart::of(part)], false),
            Resource::BufferArray(parts) => Bound::Buffers(parts.iter().map(BufferPart::of).collect(), true),
            Resource::Sampler(sampler) => Bound::Samplers(real(&[*sampler]), false),
            Resource::SamplerArray(samplers) => Bound::Samplers(real(samplers), true),
            Resource::TextureView(view) => Bound::Views(real(&[*view]), false),
            Resource::TextureViewArray(views) => Bound::Views(real(views), true),
            Resource::AccelerationStructure(structure) => Bound::Structures(real(&[*structure]), false),
            Resource::AccelerationStructureArray(structures) => Bound::Structures(real(structures), true),
            Resource::ExternalTexture(texture) => Bound::External(texture.real().clone()),
            _ => return None,
        })
    }
}

/// What arrays of bindings borrow while a group is made.
enum Borrowed<'a> {
    Buffers(Vec<wgpu::BufferBinding<'a>>),
    Samplers(Vec<&'a wgpu::Sampler>),
    Views(Vec<&'a wgpu::TextureView>),
    Structures(Vec<&'a wgpu::Tlas>),
    External(&'a wgpu::ExternalTexture),
}

impl<'a> Borrowed<'a> {
    fn of(bound: &'a Bound) -> Borrowed<'a> {
        match bound {
            Bound::Buffers(parts, _) => Borrowed::Buffers(parts.iter().map(BufferPart::binding).collect()),
            Bound::Samplers(samplers, _) => Borrowed::Samplers(samplers.iter().collect()),
            Bound::Views(views, _) => Borrowed::Views(views.iter().collect()),
            Bound::Structures(structures, _) => Borrowed::Structures(structures.iter().collect()),
            Bound::External(texture) => Borrowed::External(texture),
        }
    }

    fn resource<'b>(&'b self, bound: &Bound) -> Resource<'b> {
        let is_array = match bound {
            Bound::Buffers(_, array) | Bound::Samplers(_, array) => *array,
            Bound::Views(_, array) | Bound::Structures(_, array) => *array,
            Bound::External(_) => false,
        };
        match (self, is_array) {
            (Borrowed::Buffers(parts), true) => Resource::BufferArray(parts),
            (Borrowed::Buffers(parts), false) => Resource::Buffer(parts[0].clone()),
            (Borrowed::Samplers(samplers), true) => Resource::SamplerArray(samplers),
            (Borrowed::Samplers(samplers), false) => Resource::Sampler(samplers[0]),
            (Borrowed::Views(views), true) => Resource::TextureViewArray(views),
            (Borrowed::Views(views), false) => Resource::TextureView(views[0]),
            (Borrowed::Structures(all), true) => Resource::AccelerationStructureArray(all),
            (Borrowed::Structures(all), false) => Resource::AccelerationStructure(all[0]),
            (Borrowed::External(texture), _) => Resource::ExternalTexture(texture),
        }
    }
}

/// A real group that binds `entries`.
pub fn real_group(
    device: &wgpu::Device,
    label: Option<&str>,
    layout: &wgpu::BindGroupLayout,
    bound: &[(u32, Bound)],
) -> wgpu::BindGroup {
    let borrowed: Vec<Borrowed<'_>> = bound.iter().map(|(_, bound)| Borrowed::of(bound)).collect();
    let entries: Vec<wgpu::BindGroupEntry<'_>> = bound
        .iter()
        .zip(&borrowed)
        .map(|((binding, bound), borrowed)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: borrowed.resource(bound),
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
}

impl BindGroup {
    pub fn new(device: &wgpu::Device, descriptor: &wgpu::BindGroupDescriptor<'_>) -> BindGroup {
        let entry = |entry: &wgpu::BindGroupEntry<'_>| Some((entry.binding, Bound::of(&entry.resource)?));
        let entries: Vec<(u32, Bound)> = descriptor.entries.iter().filter_map(entry).collect();
        let inner = real_group(device, descriptor.label, descriptor.layout.real(), &entries);
        BindGroup { inner, entries: entries.into() }
    }
}
