//! The plan's small values as the shaders' structs, packed into one buffer each.
//!
//! Shaders must not branch on those that are uniform: lavapipe (Mesa 22.3) would compile their values into the shader
//! anew for every draw whose values differ, and keep what it compiled until the process ends: 5 MB and tens of
//! milliseconds a frame of `tori`. What distinguishes draws is therefore a part of their pipeline
//! (`specialization.rs`), or chosen with `select`. Programs that look up maps branch on their light: for them it is
//! storage, which lavapipe does not look into, but whose values it fetches pixel by pixel.

use crate::plan::{Carry, Draw, DrawMesh, FramePlan, NormalsPer, Pass, PlanLight, PlanMap};
use bytemuck::{Pod, Zeroable};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, Buffer, BufferBinding, BufferUsages, Device,
};

const NOT_REVERSED: u32 = u32::MAX;
const NO_LAYER: u32 = u32::MAX;

/// The uniform block `View` of `shared.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ViewUniform {
    clip_from_relative: [f32; 16],
    eye: [f32; 4],
    ambient: [f32; 4],
}

/// The uniform block `DrawConstants` of `draw.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct DrawUniform {
    color: [f32; 3],
    specular: f32,
    shininess: f32,
    normals_per: u32,
    label: u32,
    reversed_sum: u32,
    flat: [f32; 4],
    count: f32,
    layer: u32,
    checks_from: [f32; 2],
    emission: [f32; 3],
    checks: f32,
    extrude_from: [f32; 4],
    extrude_to: [f32; 4],
    extruded_w: f32,
    padding: [f32; 3],
}

/// The uniform block `Light` of `surface.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LightUniform {
    position: [f32; 4],
    color: [f32; 3],
    range: f32,
    index: u32,
    unused: u32,
    face_count: u32,
    map_clear: f32,
    bias_normal: f32,
    bias_receiver_plane: u32,
    filter_width: u32,
    projects_backwards: u32,
    repeats_edge: u32,
    padding: [u32; 3],
    clip_from_relative: [[f32; 16]; PlanMap::MOST_FACES],
}

/// A uniform buffer of equal structs, each at an offset that a dynamic binding may have.
#[derive(Debug)]
pub(super) struct UniformArray {
    pub buffer: Buffer,
    stride: u32,
    size: u64,
}

impl UniformArray {
    fn new<T: Pod>(device: &Device, label: &str, elements: &[T], usage: BufferUsages) -> UniformArray {
        let size = size_of::<T>();
        let limits = device.limits();
        let alignment =
            limits.min_uniform_buffer_offset_alignment.max(limits.min_storage_buffer_offset_alignment) as usize;
        let stride = size.next_multiple_of(alignment);
        let mut contents = vec![0; stride * elements.len().max(1)];
        for (slot, element) in contents.chunks_exact_mut(stride).zip(elements) {
            slot[..size].copy_from_slice(bytemuck::bytes_of(element));
        }
        let buffer =
            device.create_buffer_init(&BufferInitDescriptor { label: Some(label), contents: &contents, usage });
        UniformArray { buffer, stride: stride as u32, size: size as u64 }
    }

    /// Returns the resource to bind: a window of one struct's size at the buffer's start, which a dynamic offset moves
    /// to another struct.
    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        let size = std::num::NonZeroU64::new(self.size);
        wgpu::BindingResource::Buffer(BufferBinding { buffer: &self.buffer, offset: 0, size })
    }

    /// Makes a bind group that contains this buffer alone.
    pub fn bind_group(&self, device: &Device, layout: &BindGroupLayout) -> BindGroup {
        let entries = &[BindGroupEntry { binding: 0, resource: self.binding() }];
        device.create_bind_group(&BindGroupDescriptor { label: None, layout, entries })
    }

    /// Returns the dynamic offset in bytes of the element `index`.
    pub fn offset(&self, index: usize) -> u32 {
        index as u32 * self.stride
    }
}

pub(super) fn views(device: &Device, plan: &FramePlan) -> UniformArray {
    let [r, g, b] = plan.ambient;
    let view = |view: &crate::plan::PlanView| ViewUniform {
        clip_from_relative: view.clip_from_relative.to_cols_array(),
        eye: view.eye.to_array(),
        ambient: [r, g, b, 0.0],
    };
    UniformArray::new(device, "views", &plan.views.iter().map(view).collect::<Vec<_>>(), BufferUsages::UNIFORM)
}

/// Uploads the constants of all draws of the plan, a struct for each, in the order of passes and draws.
pub(super) fn draws(device: &Device, plan: &FramePlan) -> UniformArray {
    let of_pass = |pass: &Pass| {
        let map = pass.light.and_then(|light| plan.lights[light.0].map.as_ref());
        let uniform = |draw: &Draw| draw_uniform(draw, map, plan.meshes.get(draw.rasterised().mesh.0));
        pass.draws.iter().map(uniform).collect::<Vec<_>>()
    };
    UniformArray::new(device, "draws", &plan.passes.iter().flat_map(of_pass).collect::<Vec<_>>(), BufferUsages::UNIFORM)
}

fn draw_uniform(draw: &Draw, map: Option<&PlanMap>, mesh: Option<&DrawMesh>) -> DrawUniform {
    let carry = mesh.and_then(|mesh| mesh.extruded.as_ref()).map_or_else(Carry::default, |extruded| extruded.carry);
    let normals_per = mesh.and_then(|mesh| mesh.surface.as_ref()).map_or(NormalsPer::Corner, |of| of.normals.per);
    let [x, y, z] = carry.offset;
    let material = &draw.constants.material;
    let is_label = draw.program.runs_in_reverse();
    let triangles = draw.rasterised().triangles;
    DrawUniform {
        color: material.color,
        specular: material.specular,
        shininess: material.shininess,
        normals_per: normals_per as u32,
        label: draw.constants.label,
        flat: draw.constants.flat,
        count: draw.constants.count,
        // In a layer that is left out, all of the light arrives.
        layer: draw.constants.layer.and_then(|layer| map?.stored_layer(layer)).unwrap_or(NO_LAYER),
        checks_from: draw.constants.checks_from,
        emission: material.emission,
        checks: material.checks,
        extrude_from: carry.light,
        extrude_to: [x, y, z, carry.scale],
        extruded_w: carry.w,
        padding: [0.0; 3],
        reversed_sum: if is_label { (triangles.start + triangles.end).saturating_sub(1) } else { NOT_REVERSED },
    }
}

pub(super) fn lights(device: &Device, plan: &FramePlan) -> UniformArray {
    let lights = plan.lights.iter().enumerate();
    let uniforms = lights.map(|(index, light)| light_uniform(index, light));
    UniformArray::new(device, "lights", &uniforms.collect::<Vec<_>>(), BufferUsages::UNIFORM | BufferUsages::STORAGE)
}

fn light_uniform(index: usize, light: &PlanLight) -> LightUniform {
    let lookup = light.map.as_ref().and_then(|map| map.lookup);
    let mut clip_from_relative = [[0.0; 16]; PlanMap::MOST_FACES];
    // Matrices in the order of the texture's layers. What lies in a face that is left out lies in none.
    let faces = light.map.iter().flat_map(|map| map.clip_from_relative.iter().zip(&map.faces));
    let drawn = faces.filter_map(|(face, view)| view.map(|_| face));
    let mut face_count = 0;
    for (slot, face) in clip_from_relative.iter_mut().zip(drawn) {
        *slot = face.to_cols_array();
        face_count += 1;
    }
    LightUniform {
        position: light.relative_position,
        color: light.color,
        range: light.range.unwrap_or(0.0),
        index: index as u32,
        unused: 0,
        face_count,
        map_clear: lookup.map_or(0.0, |lookup| lookup.clear_depth),
        bias_normal: lookup.map_or(0.0, |lookup| lookup.bias_normal),
        bias_receiver_plane: lookup.map_or(0, |lookup| u32::from(lookup.bias_receiver_plane)),
        filter_width: lookup.map_or(1, |lookup| lookup.filter_width),
        projects_backwards: u32::from(light.map.as_ref().is_some_and(|map| map.projects_backwards)),
        repeats_edge: u32::from(light.map.as_ref().is_some_and(|map| map.repeats_edge)),
        padding: [0; 3],
        clip_from_relative,
    }
}
