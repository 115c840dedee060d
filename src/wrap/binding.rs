//! Bind groups and the layouts they are for.

use super::WrappedObject;
use std::sync::Arc;
use wgpu::BindingResource as Resource;
use wgpu::custom::{BindGroupInterface, BindGroupLayoutInterface, PipelineLayoutInterface};

/// A wrapped bind group layout: only the real one; a recording needs to know nothing more of it.
#[derive(Debug)]
pub struct BindGroupLayout {
    pub inner: wgpu::BindGroupLayout,
}

impl BindGroupLayoutInterface for BindGroupLayout {}

/// A wrapped pipeline layout: the real one, and what a recording needs to know of it.
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
    /// Creates the real pipeline layout from a descriptor with wrapped ones, and stores its real bind group layouts and
    /// immediate size.
    pub fn new(device: &wgpu::Device, descriptor: &wgpu::PipelineLayoutDescriptor<'_>) -> PipelineLayout {
        let groups: Vec<Option<&wgpu::BindGroupLayout>> =
            descriptor.bind_group_layouts.iter().map(|layout| layout.map(WrappedObject::real)).collect();
        let inner = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            bind_group_layouts: &groups,
            ..descriptor.clone()
        });
        let groups = groups.into_iter().map(|layout| layout.cloned()).collect();
        PipelineLayout { inner, groups, immediate_size: descriptor.immediate_size }
    }
}

/// A wrapped bind group: the real one, and what a recording needs to know of it.
#[derive(Debug)]
pub struct BindGroup {
    pub inner: wgpu::BindGroup,
    /// The resources that it binds, so that the same can be bound for a pipeline whose layout wgpu derives.
    pub entries: Arc<[(u32, BoundResource)]>,
}

impl BindGroupInterface for BindGroup {}

/// A range of bytes of an unwrapped wgpu buffer.
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

/// An unwrapped wgpu resource of a bind group.
#[derive(Debug, Clone)]
pub enum BoundResource {
    Buffers(Vec<BufferPart>, ArrayCheck),
    Samplers(Vec<wgpu::Sampler>, ArrayCheck),
    Views(Vec<wgpu::TextureView>, ArrayCheck),
    Structures(Vec<wgpu::Tlas>, ArrayCheck),
    External(wgpu::ExternalTexture),
}

/// Whether a binding is an array of resources.
type ArrayCheck = bool;

impl BoundResource {
    /// Returns the real resources that an entry of the program's binds; `None` for a kind that wgpu has gained since.
    fn of(resource: &Resource<'_>) -> Option<BoundResource> {
        fn real<T: WrappedObject>(all: &[&T]) -> Vec<T::Object>
        where
            T::Object: Clone,
        {
            all.iter().map(|one| one.real().clone()).collect()
        }
        Some(match resource {
            Resource::Buffer(part) => BoundResource::Buffers(vec![BufferPart::of(part)], false),
            Resource::BufferArray(parts) => BoundResource::Buffers(parts.iter().map(BufferPart::of).collect(), true),
            Resource::Sampler(sampler) => BoundResource::Samplers(real(&[*sampler]), false),
            Resource::SamplerArray(samplers) => BoundResource::Samplers(real(samplers), true),
            Resource::TextureView(view) => BoundResource::Views(real(&[*view]), false),
            Resource::TextureViewArray(views) => BoundResource::Views(real(views), true),
            Resource::AccelerationStructure(structure) => BoundResource::Structures(real(&[*structure]), false),
            Resource::AccelerationStructureArray(structures) => BoundResource::Structures(real(structures), true),
            Resource::ExternalTexture(texture) => BoundResource::External(texture.real().clone()),
            _ => return None,
        })
    }
}

/// What arrays of bindings borrow while a group is created.
enum Borrowed<'a> {
    Buffers(Vec<wgpu::BufferBinding<'a>>),
    Samplers(Vec<&'a wgpu::Sampler>),
    Views(Vec<&'a wgpu::TextureView>),
    Structures(Vec<&'a wgpu::Tlas>),
    External(&'a wgpu::ExternalTexture),
}

impl<'a> Borrowed<'a> {
    fn of(bound: &'a BoundResource) -> Borrowed<'a> {
        match bound {
            BoundResource::Buffers(parts, _) => Borrowed::Buffers(parts.iter().map(BufferPart::binding).collect()),
            BoundResource::Samplers(samplers, _) => Borrowed::Samplers(samplers.iter().collect()),
            BoundResource::Views(views, _) => Borrowed::Views(views.iter().collect()),
            BoundResource::Structures(structures, _) => Borrowed::Structures(structures.iter().collect()),
            BoundResource::External(texture) => Borrowed::External(texture),
        }
    }

    fn resource<'b>(&'b self, bound: &BoundResource) -> Resource<'b> {
        let is_array = match bound {
            BoundResource::Buffers(_, array) | BoundResource::Samplers(_, array) => *array,
            BoundResource::Views(_, array) | BoundResource::Structures(_, array) => *array,
            BoundResource::External(_) => false,
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

/// Creates a real bind group of these resources, each with its binding's number.
pub fn real_group(
    device: &wgpu::Device,
    label: Option<&str>,
    layout: &wgpu::BindGroupLayout,
    bound: &[(u32, BoundResource)],
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
    /// Creates the real bind group from a descriptor with wrapped objects, and stores its entries. Resources of unknown
    /// kinds are left out, so that wgpu reports an error.
    pub fn new(device: &wgpu::Device, descriptor: &wgpu::BindGroupDescriptor<'_>) -> BindGroup {
        let entry = |entry: &wgpu::BindGroupEntry<'_>| Some((entry.binding, BoundResource::of(&entry.resource)?));
        let entries: Vec<(u32, BoundResource)> = descriptor.entries.iter().filter_map(entry).collect();
        let inner = real_group(device, descriptor.label, descriptor.layout.real(), &entries);
        BindGroup { inner, entries: entries.into() }
    }
}
