//! A renderer of somebody else's: a floor, a cube over it, and the cube's shadow volume counted as z-fail does.

use super::gpu;
use stencilscope::glam::{self, Vec3, Vec4};
use stencilscope::wgpu::{self, CompareFunction, StencilOperation};

const SIZE: [u32; 2] = [320, 200];
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32FloatStencil8;
const LIGHT: Vec3 = Vec3::new(1.5, 6.0, 2.0);

const SHADER: &str = "
struct Camera { clip_from_world: mat4x4<f32> }
@group(0) @binding(0) var<uniform> camera: Camera;
struct Out { @builtin(position) position: vec4<f32>, @location(0) color: vec3<f32> }

@vertex fn surface(@location(0) at: vec4<f32>, @location(1) color: vec3<f32>) -> Out {
    return Out(camera.clip_from_world * at, color);
}
@fragment fn shaded(in: Out) -> @location(0) vec4<f32> { return vec4(in.color, 1.0); }
@fragment fn dark() -> @location(0) vec4<f32> { return vec4(0.0, 0.0, 0.0, 0.6); }

// A triangle over all of the picture, by number alone.
@vertex fn cover(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32(vertex & 1u), f32(vertex >> 1u)) * 4.0 - 1.0;
    return vec4(corner, 0.0, 1.0);
}
";

/// What is wrong with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    None,
    /// Faces that look away are culled, so that nothing is added.
    CullsBack,
}

pub struct Renderer {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    color: wgpu::Texture,
    depth: wgpu::Texture,
    camera: wgpu::BindGroup,
    surface: wgpu::RenderPipeline,
    volume: wgpu::RenderPipeline,
    shadow: wgpu::RenderPipeline,
    meshes: [(wgpu::Buffer, wgpu::Buffer, u32); 3],
}

/// The eight corners of a cube and its twelve triangles, counter-clockwise from outside.
fn cube() -> (Vec<Vec3>, Vec<[u16; 3]>) {
    let corner = |index: u16| {
        let side = |bit: u16| if index >> bit & 1 == 1 { 0.5 } else { -0.5 };
        Vec3::new(side(0), side(1) + 1.2, side(2))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// The closed volume of a cube: its corners, and the same carried to infinity; sides over the edges between faces that
/// the light sees and faces that it doesn't, and both caps.
fn shadow_volume() -> (Vec<Vec4>, Vec<u16>) {
    let (corners, triangles) = cube();
    let near = corners.iter().map(|corner| corner.extend(1.0));
    let far = corners.iter().map(|corner| (corner - LIGHT).extend(0.0));
    let vertices = near.chain(far).collect();
    let faces_light = |[a, b, c]: &[u16; 3]| {
        let [a, b, c] = [a, b, c].map(|corner| corners[usize::from(*corner)]);
        (b - a).cross(c - a).dot(LIGHT - a) > 0.0
    };
    let count = corners.len() as u16;
    let mut indices = Vec::new();
    let lit: Vec<&[u16; 3]> = triangles.iter().filter(|triangle| faces_light(triangle)).collect();
    let edges = |[a, b, c]: &[u16; 3]| [[*a, *b], [*b, *c], [*c, *a]];
    let all: Vec<[u16; 2]> = lit.iter().flat_map(|triangle| edges(triangle)).collect();
    for [a, b, c] in &lit {
        indices.extend([*a, *b, *c, *c + count, *b + count, *a + count]);
    }
    for [a, b] in all.iter().filter(|[a, b]| !all.contains(&[*b, *a])) {
        indices.extend([*b, *a, *a + count, *b, *a + count, *b + count]);
    }
    (vertices, indices)
}

impl Renderer {
    pub fn new(instance: impl Fn(wgpu::InstanceDescriptor) -> wgpu::Instance, fault: Fault) -> Renderer {
        let instance = instance(wgpu::InstanceDescriptor::new_without_display_handle());
        let required_features = wgpu::Features::DEPTH32FLOAT_STENCIL8;
        let asked = wgpu::DeviceDescriptor { required_features, ..wgpu::DeviceDescriptor::default() };
        let (device, queue) = gpu::device(&instance, &asked);
        let texture = |format| gpu::texture(&device, SIZE, format, 1, wgpu::TextureUsages::COPY_SRC);
        let (color, depth) = (texture(wgpu::TextureFormat::Rgba8Unorm), texture(DEPTH));
        let view = glam::camera::rh::view::look_at_mat4(Vec3::new(-3.0, 3.0, 5.0), Vec3::new(0.0, 0.5, 0.0), Vec3::Y);
        let clip_from_world =
            glam::camera::rh::proj::directx::perspective_infinite(0.9, SIZE[0] as f32 / SIZE[1] as f32, 0.1) * view;
        let buffer = |contents: &[u8], usage| gpu::buffer(&device, contents, usage);
        let uniform = buffer(bytemuck::bytes_of(&clip_from_world.to_cols_array()), wgpu::BufferUsages::UNIFORM);
        let layout = gpu::of_uniform(&device, false);
        let camera = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let module = gpu::module(&device, SHADER);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let attributes = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x3];
        let pipeline = |look: Look| {
            let buffers = [Some(wgpu::VertexBufferLayout {
                array_stride: 28,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })];
            let options = wgpu::PipelineCompilationOptions::default();
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(look.label),
                // The last has layouts of its own.
                layout: look.has_buffers.then_some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(look.vertex),
                    compilation_options: options.clone(),
                    buffers: if look.has_buffers { &buffers } else { &[] },
                },
                primitive: wgpu::PrimitiveState { cull_mode: look.cull, ..wgpu::PrimitiveState::default() },
                depth_stencil: Some(look.depth_stencil),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(look.fragment),
                    compilation_options: options,
                    targets: &[Some(wgpu::ColorTargetState {
                        format: wgpu::TextureFormat::Rgba8Unorm,
                        blend: look.blend,
                        write_mask: look.write,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let surface = pipeline(Look {
            label: "surfaces",
            vertex: "surface",
            fragment: "shaded",
            has_buffers: true,
            cull: Some(wgpu::Face::Back),
            depth_stencil: gpu::depth_state(DEPTH, true, CompareFunction::Less, wgpu::StencilState::default()),
            blend: None,
            write: wgpu::ColorWrites::ALL,
        });
        let counts = |operation| wgpu::StencilFaceState { depth_fail_op: operation, ..wgpu::StencilFaceState::IGNORE };
        let volume = pipeline(Look {
            label: "volume",
            vertex: "surface",
            fragment: "shaded",
            has_buffers: true,
            cull: (fault == Fault::CullsBack).then_some(wgpu::Face::Back),
            depth_stencil: gpu::depth_state(
                DEPTH,
                false,
                CompareFunction::Less,
                wgpu::StencilState {
                    front: counts(StencilOperation::DecrementWrap),
                    back: counts(StencilOperation::IncrementWrap),
                    read_mask: 0xff,
                    write_mask: 0xff,
                },
            ),
            blend: None,
            write: wgpu::ColorWrites::empty(),
        });
        let counted = wgpu::StencilFaceState { compare: CompareFunction::NotEqual, ..wgpu::StencilFaceState::IGNORE };
        let shadow = pipeline(Look {
            label: "shadow",
            vertex: "cover",
            fragment: "dark",
            has_buffers: false,
            cull: None,
            depth_stencil: gpu::depth_state(
                DEPTH,
                false,
                CompareFunction::Always,
                wgpu::StencilState { front: counted, back: counted, read_mask: 0xff, write_mask: 0 },
            ),
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            write: wgpu::ColorWrites::ALL,
        });
        let mesh = |vertices: &[Vec4], color: Vec3, indices: &[u16]| {
            let floats: Vec<f32> =
                vertices.iter().flat_map(|at| [&at.to_array()[..], &color.to_array()[..]].concat()).collect();
            let vertices = buffer(bytemuck::cast_slice(&floats), wgpu::BufferUsages::VERTEX);
            (vertices, buffer(bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX), indices.len() as u32)
        };
        let floor = [[-9.0, -9.0], [-9.0, 9.0], [9.0, 9.0], [9.0, -9.0]].map(|[x, z]| Vec4::new(x, 0.0, z, 1.0));
        let (corners, triangles) = cube();
        let corners: Vec<Vec4> = corners.iter().map(|corner| corner.extend(1.0)).collect();
        let (shell, shell_indices) = shadow_volume();
        let meshes = [
            mesh(&floor, Vec3::new(0.7, 0.7, 0.6), &[0, 1, 2, 0, 2, 3]),
            mesh(&corners, Vec3::new(0.8, 0.3, 0.2), &triangles.concat()),
            mesh(&shell, Vec3::ONE, &shell_indices),
        ];
        Renderer { device, queue, color, depth, camera, surface, volume, shadow, meshes }
    }

    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let [color, depth] =
            [&self.color, &self.depth].map(|of| of.create_view(&wgpu::TextureViewDescriptor::default()));
        let store = wgpu::StoreOp::Store;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store }),
                stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store }),
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.camera, &[]);
        for (pipeline, meshes) in [(&self.surface, &self.meshes[..2]), (&self.volume, &self.meshes[2..])] {
            pass.set_pipeline(pipeline);
            for (vertices, indices, count) in meshes {
                pass.set_vertex_buffer(0, vertices.slice(..));
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..*count, 0, 0..1);
            }
        }
        pass.set_pipeline(&self.shadow);
        pass.draw(0..3, 0..1);
    }

    pub fn draw(&self) {
        gpu::submit(&self.device, &self.queue, |encoder| self.encode(encoder));
    }

    /// Four bytes a pixel.
    pub fn picture(&self) -> Vec<u8> {
        gpu::bytes((&self.device, &self.queue), &self.color, wgpu::TextureAspect::All, 4)
    }

    /// One byte a pixel.
    pub fn stencil(&self) -> Vec<u8> {
        gpu::bytes((&self.device, &self.queue), &self.depth, wgpu::TextureAspect::StencilOnly, 1)
    }
}

/// How a pipeline of the renderer is unlike the others.
struct Look {
    label: &'static str,
    vertex: &'static str,
    fragment: &'static str,
    has_buffers: bool,
    cull: Option<wgpu::Face>,
    depth_stencil: wgpu::DepthStencilState,
    blend: Option<wgpu::BlendState>,
    write: wgpu::ColorWrites,
}
