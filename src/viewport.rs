//! Faces and lines with a depth buffer, drawn by the GPU that draws the window: egui itself has no depth.
//!
//! A [`ViewportDrawing`] is a shape of egui's. Before egui's own pass it is drawn into a picture with a depth buffer of
//! its own, solids first, then translucent shells, which need no order as they write no depth, then lines; in egui's
//! pass that picture is drawn into the window. Geometry is uploaded when it changes, and a picture is drawn again when
//! anything in it changed. All wgpu objects are of the window's device and live in its renderer.

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};
use egui::{Color32, PaintCallback, PaintCallbackInfo, Rect, Shape};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use glam::{DVec3, DVec4, Mat4, Vec2, Vec3, Vec4};
use std::collections::HashMap;
use std::sync::Arc;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferUsages, TextureFormat, TextureUsages, VertexAttribute, vertex_attr_array};

/// Format of pictures, in egui's colours: gamma space.
const COLOR: TextureFormat = TextureFormat::Rgba8Unorm;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;
/// Format of the pass's target in a window without a surface.
const HEADLESS: TextureFormat = TextureFormat::Rgba8Unorm;
/// Samples a pixel: while a CPU draws a view that moves, and otherwise.
const SAMPLES: [u32; 2] = [1, 4];
/// Blending of premultiplied colours.
const OVER: Option<wgpu::BlendState> = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);

const CORNER: [VertexAttribute; 3] = vertex_attr_array![0 => Float32x4, 1 => Snorm16x4, 2 => Unorm8x4];
const LINE: [VertexAttribute; 4] = vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Unorm8x4];

/// A vertex of a shaded triangle, as it is uploaded to the GPU: position, normal and colour.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ViewportVertex {
    at: Vec4,
    normal: [i16; 4],
    color: Color32,
    unused: u32,
}

impl ViewportVertex {
    /// Returns a vertex at a homogeneous position; `w = 0`, at infinity, for shells only: its length says where they
    /// fade. `normal` is of unit length, or zero where nothing is shaded.
    pub fn new(at: DVec4, normal: Vec3, color: Color32) -> ViewportVertex {
        let whole = |value: f32| (value * f32::from(i16::MAX)) as i16;
        let normal = [whole(normal.x), whole(normal.y), whole(normal.z), 0];
        ViewportVertex { at: at.as_vec4(), normal, color, unused: 0 }
    }
}

/// A line segment of the 3D view, as it is uploaded to the GPU.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ViewportLine {
    /// One end, relative to the geometry's origin.
    pub from: Vec3,
    /// Width in points.
    pub width: f32,
    /// The other end.
    pub to: Vec3,
    /// Its colour.
    pub color: Color32,
}

/// The geometry of a drawing. Triangles are indices of vertices; fronts are counter-clockwise.
#[derive(Debug, Default)]
pub struct ViewportGeometry {
    /// World position that everything is relative to, so that single precision is enough.
    pub origin: DVec3,
    /// Corners of all triangles.
    pub vertices: Vec<ViewportVertex>,
    /// Opaque triangles: they hide what is behind them.
    pub solids: Vec<[u32; 3]>,
    /// Triangles that are opaque from their front, and translucent from behind.
    pub holders: Vec<[u32; 3]>,
    /// Translucent triangles: they hide nothing.
    pub shells: Vec<[u32; 3]>,
    /// Lines, drawn on solids.
    pub lines: Vec<ViewportLine>,
}

/// The camera of a 3D view in the window, as the shaders' uniforms have it.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ViewportCamera {
    /// Clip space, with reversed depth, from the geometry's space.
    pub clip_from_stage: Mat4,
    /// Position of the viewer; the direction towards it, with `w = 0`, in parallel views.
    pub viewer: Vec4,
    /// How much nearer shells are drawn than what they lie on: as a part of the depth, and in depth.
    pub step: Vec2,
    /// Width and height of the picture, pixels; known once it is drawn.
    pub size: Vec2,
    /// Pixels per point; known once it is drawn.
    pub pixels_per_point: f32,
    /// Padding of the uniform buffer.
    pub unused: [f32; 3],
}

/// Geometry to be drawn into a rectangle of the window, seen by a camera. Drawings are equal that draw the same geometry, not one
/// like it, in the same way.
#[derive(Debug, Clone)]
pub struct ViewportDrawing {
    /// The geometry.
    pub geometry: Arc<ViewportGeometry>,
    /// The camera.
    pub view: ViewportCamera,
    /// Rectangle in the window, points.
    pub rect: Rect,
    /// Index of the cached picture that it is drawn into.
    pub slot: usize,
    /// True while it is dragged: on a CPU it is drawn without smooth borders until it rests.
    pub moves: bool,
}

impl PartialEq for ViewportDrawing {
    fn eq(&self, other: &ViewportDrawing) -> bool {
        let ViewportDrawing { geometry, view, rect, slot, moves } = other;
        let is_same = Arc::ptr_eq(&self.geometry, geometry) && self.view == *view && self.rect == *rect;
        is_same && self.slot == *slot && self.moves == *moves
    }
}

/// The shape of the drawing that was drawn last: the same object while the drawing is the same, by which what draws the
/// window knows that nothing changed.
#[derive(Debug, Default)]
pub struct ViewportShape(Option<(ViewportDrawing, PaintCallback)>);

impl ViewportShape {
    /// Returns a drawing as a shape for egui's painter, which draws it when the window is painted.
    pub fn of(&mut self, drawing: ViewportDrawing) -> Shape {
        let known = self.0.take().filter(|(known, _)| *known == drawing);
        let new = |drawing: ViewportDrawing| {
            let callback = Callback::new_paint_callback(drawing.rect, drawing.clone());
            (drawing, callback)
        };
        let (_, callback) = self.0.insert(known.unwrap_or_else(|| new(drawing)));
        Shape::Callback(callback.clone())
    }
}

/// The pipelines, uploaded geometry and pictures of 3D views, cached in the window's renderer.
pub struct Viewports {
    pipelines: [[wgpu::RenderPipeline; 5]; 2],
    window: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    is_cpu: bool,
    uploaded: Option<Uploaded>,
    pictures: HashMap<usize, DrawnPicture>,
}

/// Geometry on the GPU.
struct Uploaded {
    geometry: Arc<ViewportGeometry>,
    vertices: wgpu::Buffer,
    triangles: wgpu::Buffer,
    lines: wgpu::Buffer,
}

/// A cached picture, and what it shows.
pub struct DrawnPicture {
    /// The geometry that it shows.
    pub geometry: Arc<ViewportGeometry>,
    /// The camera that it is seen from.
    pub view: ViewportCamera,
    /// Its reversed depth, of `samples` a pixel.
    pub depth: wgpu::Texture,
    /// Samples a pixel.
    pub samples: u32,
    /// Multisampled target that it is drawn into; `None` where it has one sample a pixel.
    sampled: Option<wgpu::TextureView>,
    resolved: wgpu::TextureView,
    /// The picture as the window's pass reads it.
    shown: wgpu::BindGroup,
}

/// Registers the format that a window's pass writes to with its renderer. Not needed where there is no surface.
pub fn install(gpu: &RenderState) {
    gpu.renderer.write().callback_resources.insert(Viewports::new(&gpu.device, gpu.target_format));
}

impl CallbackTrait for ViewportDrawing {
    fn prepare(
        &self,
        device: &wgpu::Device,
        _: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let own = resources.entry().or_insert_with(|| Viewports::new(device, HEADLESS));
        let pixels_per_point = screen.pixels_per_point;
        let most = device.limits().max_texture_dimension_2d as f32;
        let corner = |at: egui::Pos2| Vec2::new(at.x, at.y) * pixels_per_point;
        let size = (corner(self.rect.max).round() - corner(self.rect.min).round()).clamp(Vec2::ONE, Vec2::splat(most));
        own.draw(self, ViewportCamera { size, pixels_per_point, ..self.view }, device, encoder);
        Vec::new()
    }

    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, resources: &CallbackResources) {
        let Some(own) = resources.get::<Viewports>() else { return };
        if let Some(picture) = own.pictures.get(&self.slot) {
            pass.set_pipeline(&own.window);
            pass.set_bind_group(0, &picture.shown, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

impl Viewports {
    /// Returns the picture that was drawn last for [`ViewportDrawing::slot`]; `None` where none was.
    pub fn picture(&self, slot: usize) -> Option<&DrawnPicture> {
        self.pictures.get(&slot)
    }

    fn new(device: &wgpu::Device, target: TextureFormat) -> Viewports {
        let source = wgpu::ShaderSource::Wgsl(include_str!("../shaders/viewport.wgsl").into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("viewport"), source });
        let corners = wgpu::VertexBufferLayout {
            array_stride: size_of::<ViewportVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &CORNER,
        };
        let lines = wgpu::VertexBufferLayout {
            array_stride: size_of::<ViewportLine>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &LINE,
        };
        // The format that a pass writes to, and the samples a pixel.
        let pipeline = |[vertex, fragment]: [&str; 2], buffer, cull_mode, samples: u32, format: TextureFormat| {
            let is_solid = fragment == "fs_solid";
            let topology = match vertex {
                "vs_line" => wgpu::PrimitiveTopology::TriangleStrip,
                _ => wgpu::PrimitiveTopology::TriangleList,
            };
            let has_depth = Option::is_some(&buffer);
            let blend = if is_solid { None } else { OVER };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(fragment),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: Default::default(),
                    buffers: if has_depth { std::slice::from_ref(&buffer) } else { &[] },
                },
                primitive: wgpu::PrimitiveState { topology, cull_mode, ..Default::default() },
                depth_stencil: has_depth.then(|| wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(is_solid),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Viewports {
            pipelines: SAMPLES.map(|samples| {
                let of = |names, buffer: &wgpu::VertexBufferLayout<'static>, cull| {
                    pipeline(names, Some(buffer.clone()), cull, samples, COLOR)
                };
                [
                    of(["vs_solid", "fs_solid"], &corners, None),
                    of(["vs_solid", "fs_solid"], &corners, Some(wgpu::Face::Back)),
                    of(["vs_solid", "fs_glass"], &corners, Some(wgpu::Face::Front)),
                    of(["vs_shell", "fs_shell"], &corners, None),
                    of(["vs_line", "fs_line"], &lines, None),
                ]
            }),
            window: pipeline(["vs_window", "fs_window"], None, None, 1, target),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            is_cpu: device.adapter_info().device_type == wgpu::DeviceType::Cpu,
            uploaded: None,
            pictures: HashMap::new(),
        }
    }

    /// Draws the picture of a drawing into its slot, unless geometry, camera, size and samples are those of the cached
    /// one. While a view moves on a CPU, it is drawn with fewer samples.
    fn draw(
        &mut self,
        what: &ViewportDrawing,
        view: ViewportCamera,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let detail = usize::from(!(what.moves && self.is_cpu));
        let samples = SAMPLES[detail];
        let before = self.pictures.remove(&what.slot);
        let fits = |picture: &DrawnPicture| picture.view.size == view.size && picture.samples == samples;
        let mut picture = before.filter(fits).unwrap_or_else(|| self.empty_picture(device, view, samples));
        if !(Arc::ptr_eq(&picture.geometry, &what.geometry) && picture.view == view) {
            if !self.uploaded.as_ref().is_some_and(|uploaded| Arc::ptr_eq(&uploaded.geometry, &what.geometry)) {
                self.uploaded = Some(Uploaded::new(device, what.geometry.clone()));
            }
            (picture.geometry, picture.view) = (what.geometry.clone(), view);
            if let Some(uploaded) = &self.uploaded {
                picture.draw(&self.pipelines[detail], uploaded, device, encoder);
            }
        }
        self.pictures.insert(what.slot, picture);
    }

    fn empty_picture(&self, device: &wgpu::Device, view: ViewportCamera, samples: u32) -> DrawnPicture {
        let size = view.size.as_uvec2();
        let texture = |format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("viewport"),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let color = |samples, usage| texture(COLOR, samples, usage).create_view(&Default::default());
        let resolved = color(1, TextureUsages::TEXTURE_BINDING);
        let shown = [
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&resolved) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
        ];
        DrawnPicture {
            geometry: Arc::default(),
            view: ViewportCamera { size: view.size, ..ViewportCamera::zeroed() },
            depth: texture(DEPTH, samples, if samples > 1 { TextureUsages::empty() } else { TextureUsages::COPY_SRC }),
            samples,
            shown: bind(device, &self.window, &shown),
            sampled: (samples > 1).then(|| color(samples, TextureUsages::empty())),
            resolved,
        }
    }
}

impl DrawnPicture {
    fn draw(
        &self,
        pipelines: &[wgpu::RenderPipeline],
        uploaded: &Uploaded,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let (contents, usage) = (bytes_of(&self.view), BufferUsages::UNIFORM);
        let view = device.create_buffer_init(&BufferInitDescriptor { label: Some("view"), contents, usage });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("viewport"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.sampled.as_ref().unwrap_or(&self.resolved),
                depth_slice: None,
                resolve_target: self.sampled.as_ref().map(|_| &self.resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth.create_view(&Default::default()),
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let part = |triangles: &[[u32; 3]]| 3 * triangles.len() as u32;
        let ViewportGeometry { solids, holders, shells, lines, .. } = &*self.geometry;
        let (solids, holders) = (part(solids), part(solids) + part(holders));
        let (shells, lines) = (holders + part(shells), lines.len() as u32);
        let ranges = [0..solids, solids..holders, solids..holders, holders..shells, 0..lines];
        for (pipeline, range) in pipelines.iter().zip(ranges) {
            if range.is_empty() {
                continue;
            }
            let entries = [wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() }];
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &bind(device, pipeline, &entries), &[]);
            if pipeline == &pipelines[4] {
                pass.set_vertex_buffer(0, uploaded.lines.slice(..));
                pass.draw(0..4, range);
            } else {
                pass.set_vertex_buffer(0, uploaded.vertices.slice(..));
                pass.set_index_buffer(uploaded.triangles.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(range, 0, 0..1);
            }
        }
    }
}

impl Uploaded {
    fn new(device: &wgpu::Device, geometry: Arc<ViewportGeometry>) -> Uploaded {
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor { label: Some("geometry"), contents, usage })
        };
        let triangles = [&*geometry.solids, &geometry.holders, &geometry.shells].concat();
        Uploaded {
            vertices: buffer(cast_slice(&geometry.vertices), BufferUsages::VERTEX),
            triangles: buffer(cast_slice(&triangles), BufferUsages::INDEX),
            lines: buffer(cast_slice(&geometry.lines), BufferUsages::VERTEX),
            geometry,
        }
    }
}

fn bind(device: &wgpu::Device, pipeline: &wgpu::RenderPipeline, entries: &[wgpu::BindGroupEntry]) -> wgpu::BindGroup {
    let layout = &pipeline.get_bind_group_layout(0);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("viewport"), layout, entries })
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_shader_is_valid_and_its_view_is_as_large_as_this_one() {
        let module = naga::front::wgsl::parse_str(include_str!("../shaders/viewport.wgsl")).expect("a module");
        let flags = naga::valid::ValidationFlags::all();
        let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty());
        validator.validate(&module).expect("valid");
        let is_view = |ty: &&naga::Type| ty.name.as_deref() == Some("View");
        let view = module.types.iter().map(|(_, ty)| ty).find(is_view).expect("a view");
        let naga::TypeInner::Struct { span, .. } = view.inner else { panic!("a struct") };
        assert_eq!(span as usize, size_of::<super::ViewportCamera>());
    }
}
