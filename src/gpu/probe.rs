//! Measures what the rasteriser does with triangles: each probe draws a few into a picture of depths, and compares them
//! with what exact arithmetic says.

use super::readback::StagingCopy;
use super::{GpuContext, GpuError, shaders};
use crate::capture::AdapterProfile;
use glam::{DMat3, DVec2, DVec3, DVec4};
use std::collections::VecDeque;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferUsages, RenderPipeline, Texture, TextureFormat, TextureUsages};

/// Pixels along each side of the probes' picture.
const SIDE: u32 = 512;
/// Depth where nothing is drawn: no probe has it.
const CLEAR: f32 = 1.0;
/// Lean edges of the grid's probe.
const LEAN: u32 = 64;
/// Ordinary triangles, each in a cell of so many pixels, along which depth grows by `1 / CELLS`.
const CELLS: u32 = 64;
const CELL: f64 = 8.0;

/// A triangle's corners in clip space.
type Triangle = [DVec4; 3];

/// Measures an adapter's profile.
///
/// # Errors
/// A lost GPU.
pub(super) async fn measure(context: &GpuContext) -> Result<AdapterProfile, GpuError> {
    let measured = context.guarded(async || {
        let cells = cells();
        let reversed = cells.iter().rev().copied().collect();
        let (floor, unbounded) = (floor(), unbounded());
        let far_edges = AdapterProfile::FAR.map(far_edges);
        let one = |triangle: &Triangle| vec![*triangle];
        let pictures = [leaning_edges(), cells.clone(), reversed].into_iter();
        let pictures = pictures.chain(floor.iter().chain(&unbounded).chain(far_edges.iter().flatten()).map(one));
        let target = ProbeTarget::new(context);
        let mut drawn = target.draw(pictures.collect());
        let subpixel_bits = subpixel_bits(&drawn.next().await?);
        let (ordinary, again) = (drawn.next().await?, drawn.next().await?);
        let (depth_error, repeats_depth) = ordinary_depth(&cells, &ordinary, &again);
        drop([ordinary, again]);
        let mut behind_eye_error = 0.0_f64;
        for triangle in &floor {
            behind_eye_error = behind_eye_error.max(behind_eye(triangle, &drawn.next().await?));
        }
        let mut draws_infinity = true;
        for triangle in &unbounded {
            draws_infinity &= is_covered(triangle, &drawn.next().await?);
        }
        let mut far_edge_error = [0.0_f64; AdapterProfile::FAR.len()];
        for (error, edges) in far_edge_error.iter_mut().zip(&far_edges) {
            for triangle in edges {
                *error = error.max(far_edge(triangle, &drawn.next().await?));
            }
        }
        Ok(AdapterProfile {
            subpixel_bits,
            depth_error,
            far_edge_error,
            behind_eye_error,
            draws_infinity,
            repeats_depth,
            largest_picture: context.device.limits().max_texture_dimension_2d,
        })
    });
    measured.await
}

/// What draws: a pipeline that writes depth, and its picture.
struct ProbeTarget<'a> {
    context: &'a GpuContext,
    pipeline: RenderPipeline,
    depths: Texture,
}

/// The depths of a picture, row by row.
struct Depths(std::sync::Arc<crate::capture::Image>);

impl Depths {
    /// Returns the depth at a pixel; `None` where nothing was drawn.
    fn at(&self, x: u32, y: u32) -> Option<f64> {
        self.0.depth_at([x, y]).filter(|depth| *depth != CLEAR).map(f64::from)
    }
}

/// Returns the corner in clip space, in single precision as the GPU gets it, of a place in pixels.
fn corner(place: DVec2, depth: f64) -> DVec4 {
    let half = f64::from(SIDE) / 2.0;
    single(DVec4::new(place.x / half - 1.0, 1.0 - place.y / half, depth, 1.0))
}

fn single(corner: DVec4) -> DVec4 {
    corner.as_vec4().as_dvec4()
}

/// Returns normalized device coordinates of a pixel's middle, with 1 as the third.
fn middle(x: u32, y: u32) -> DVec3 {
    let half = f64::from(SIDE) / 2.0;
    DVec3::new((f64::from(x) + 0.5) / half - 1.0, 1.0 - (f64::from(y) + 0.5) / half, 1.0)
}

/// A triangle's exact cover and depth.
struct Exact {
    /// Three numbers of a place, which are all positive inside of what lies before the eye.
    cover: DMat3,
    /// Depth over the picture, for its x, y and 1.
    depth: DVec3,
}

impl Exact {
    fn new(corners: &Triangle) -> Exact {
        let places = corners.map(|corner| DVec3::new(corner.x, corner.y, corner.w));
        let cover = DMat3::from_cols(places[0], places[1], places[2]).inverse();
        Exact { cover, depth: cover.transpose() * DVec3::from_array(corners.map(|corner| corner.z)) }
    }

    /// Returns the depth at a pixel's middle; `None` where the triangle does not cover it, or by less than a part of the
    /// way to its border.
    fn at(&self, x: u32, y: u32, margin: f64) -> Option<f64> {
        let weights = self.cover * middle(x, y);
        let depth = self.depth.dot(middle(x, y));
        let is_in =
            weights.min_element() > margin * weights.abs().max_element() && (0.0..CLEAR.into()).contains(&depth);
        is_in.then_some(depth)
    }
}

impl<'a> ProbeTarget<'a> {
    fn new(context: &'a GpuContext) -> ProbeTarget<'a> {
        let device = &context.device;
        let source = wgpu::ShaderSource::Wgsl(shaders::PROBE.into());
        let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("probe"), source });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("probe"),
            layout: None,
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vs_probe"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: 16,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x4],
                })],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        let depths = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("probe"),
            size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::Depth32Float,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        ProbeTarget { context, pipeline, depths }
    }

    /// Returns pictures of triangles, which are drawn one after the other.
    fn draw(&self, pictures: Vec<Vec<Triangle>>) -> DrawnPictures<'_> {
        DrawnPictures { target: self, pictures: pictures.into_iter(), copies: VecDeque::new() }
    }

    /// Draws triangles, and returns the copy of their picture, which is there once the GPU was waited for.
    fn submit(&self, triangles: &[Triangle]) -> Result<StagingCopy, GpuError> {
        let device = &self.context.device;
        let corners: Vec<[f32; 4]> = triangles.iter().flatten().map(|corner| corner.as_vec4().to_array()).collect();
        let contents = bytemuck::cast_slice(&corners);
        let buffer = device.create_buffer_init(&BufferInitDescriptor {
            label: Some("probe"),
            contents,
            usage: BufferUsages::VERTEX,
        });
        let copy = StagingCopy::new(device, &self.depths, 0, wgpu::TextureAspect::DepthOnly)?;
        let view = self.depths.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("probe"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(CLEAR), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..corners.len() as u32, 0..1);
        drop(pass);
        copy.record(&mut encoder);
        self.context.queue.submit([encoder.finish()]);
        copy.request_map();
        Ok(copy)
    }
}

/// Pictures that are being drawn, in order.
struct DrawnPictures<'a> {
    target: &'a ProbeTarget<'a>,
    /// Those that are not drawn yet.
    pictures: std::vec::IntoIter<Vec<Triangle>>,
    /// Copies of those that were drawn.
    copies: VecDeque<StagingCopy>,
}

impl DrawnPictures<'_> {
    /// Natively one is drawn after the other, in the same memory; in a browser, where each wait for the GPU is a turn, all
    /// are drawn before the first is waited for.
    const AT_ONCE: usize = if cfg!(target_family = "wasm") { usize::MAX } else { 1 };

    /// Returns the next picture.
    async fn next(&mut self) -> Result<Depths, GpuError> {
        if self.copies.is_empty() {
            for picture in self.pictures.by_ref().take(DrawnPictures::AT_ONCE) {
                self.copies.push_back(self.target.submit(&picture)?);
            }
            self.target.context.wait().await?;
        }
        let copy = self.copies.pop_front().ok_or_else(|| GpuError::Driver("a probe was not drawn".to_owned()))?;
        Ok(Depths(copy.image()?))
    }
}

/// Returns where an edge that leans begins: its column, and the part of a pixel by which it is moved.
fn leaning_edge(index: u32) -> (u32, f64) {
    (4 + 7 * index, f64::from(index) / 512.0)
}

/// Returns edges that lean by a pixel from top to bottom, each moved by 1/512 of a pixel against the one before.
fn leaning_edges() -> Vec<Triangle> {
    let height = f64::from(SIDE);
    let quad = |index: u32| {
        let (x, moved) = leaning_edge(index);
        let x = f64::from(x) + moved;
        let [a, b, c, d] = [[x, 0.0], [x + 1.0, height], [x + 4.0, height], [x + 4.0, 0.0]]
            .map(|[x, y]| corner(DVec2::new(x, y), 0.5));
        [[a, b, c], [a, c, d]]
    };
    (0..LEAN).flat_map(quad).collect()
}

/// Returns the step to which corners snap, from a picture of leaning edges: several have the same number of rows in their
/// column, and the number of different ones gives the step.
fn subpixel_bits(depths: &Depths) -> u32 {
    let rows = |index: u32| (0..SIDE).filter(|y| depths.at(leaning_edge(index).0, *y).is_some()).count();
    let different: std::collections::BTreeSet<usize> = (0..LEAN).map(rows).collect();
    // An eighth of a pixel is moved through in all, whichever way ties are rounded. Finer steps than these look like
    // 1/512.
    (8 * different.len() as u32).ilog2()
}

/// Returns small triangles at parts of pixels, one a cell.
fn cells() -> Vec<Triangle> {
    let part = |number: u32| f64::from(number.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
    let triangle = |index: u32| -> Triangle {
        let cell = DVec2::new(f64::from(index % 8), f64::from(index / 8)) * CELL;
        [DVec2::ZERO, DVec2::Y, DVec2::X].map(|along| {
            let place = along * CELL
                + DVec2::from_array(
                    [0, 1].map(|axis| part(index * 6 + along.x as u32 * 2 + along.y as u32 * 4 + axis)),
                );
            corner(cell + place, 0.25 + place.x / f64::from(CELLS) + place.y / f64::from(2 * CELLS))
        })
    };
    (0..CELLS).map(triangle).collect()
}

/// Returns by how many pixels of their slope the cells' depth is off at most, and whether it is the same where they were
/// drawn in another order.
fn ordinary_depth(cells: &[Triangle], depths: &Depths, again: &Depths) -> (f64, bool) {
    let (mut error, mut repeats) = (0.0_f64, true);
    for (index, triangle) in cells.iter().enumerate() {
        let exact = Exact::new(triangle);
        let first = [index as u32 % 8, index as u32 / 8].map(|cell| cell * CELL as u32);
        for (x, y) in (0..10).flat_map(|y| (0..10).map(move |x| (first[0] + x, first[1] + y))) {
            let (Some(drawn), Some(expected)) = (depths.at(x, y), exact.at(x, y, 0.02)) else { continue };
            repeats &= again.at(x, y) == Some(drawn);
            error = error.max((drawn - expected).abs());
        }
    }
    (error * f64::from(CELLS), repeats)
}

/// Returns triangles with a steep edge each, whose ends lie so many pixels above and below the picture.
fn far_edges(far: f64) -> [Triangle; 3] {
    let middle = f64::from(SIDE) / 2.0;
    let reach = middle + far;
    [0.0, 1.0, 2.0].map(|step| {
        let (through, lean) = (middle + 0.3 + 0.37 * step, 0.31 + 0.13 * step);
        let ends = [-reach, reach].map(|along| DVec2::new(through + lean * along, middle - 0.3 + along));
        let far = DVec2::new(through + 4.0 * reach + 4000.0, middle);
        [ends[0], ends[1], far].map(|place| corner(place, 0.5))
    })
}

/// Returns by how many pixels a triangle's steep edge is off at least in some row.
fn far_edge(triangle: &Triangle, depths: &Depths) -> f64 {
    let (side, middle) = (f64::from(SIDE), f64::from(SIDE) / 2.0);
    let mut error = 0.0_f64;
    // Where the edge runs, from the corners as they are in single precision.
    let [top, bottom] =
        [triangle[0], triangle[1]].map(|corner| DVec2::new((corner.x + 1.0) * middle, (1.0 - corner.y) * middle));
    for y in (8..SIDE - 8).step_by(4) {
        let at = (f64::from(y) + 0.5 - top.y) / (bottom.y - top.y);
        let edge = top.x + (bottom.x - top.x) * at;
        let first = (0..SIDE).find(|x| depths.at(*x, y).is_some()).map_or(side, f64::from);
        if (2.0..side - 2.0).contains(&edge) {
            let [low, high] = [first - 0.5, first + 0.5];
            error = error.max(low - edge).max(edge - high);
        }
    }
    error
}

/// Returns both triangles of a floor of 600 metres, three metres below an eye that looks down at it, of which two corners
/// are behind that eye.
fn floor() -> [Triangle; 2] {
    let (cos, sin) = (0.896_f64, 0.444_f64);
    let floor = [[-600.0, -600.0], [600.0, -600.0], [600.0, 600.0], [-600.0, 600.0]].map(|[x, z]: [f64; 2]| {
        let turned = DVec3::new(x, -3.0 * cos - z * sin, -3.0 * sin + z * cos);
        single(DVec4::new(1.7 * turned.x, 1.7 * turned.y, 0.1, -turned.z))
    });
    [[floor[0], floor[1], floor[2]], [floor[0], floor[2], floor[3]]]
}

/// Returns some pixels of the picture.
fn samples() -> impl Iterator<Item = (u32, u32)> {
    (0..SIDE).step_by(5).flat_map(|y| (0..SIDE).step_by(5).map(move |x| (x, y)))
}

/// Returns how far a triangle's depth is off, as a part of itself.
fn behind_eye(triangle: &Triangle, depths: &Depths) -> f64 {
    let exact = Exact::new(triangle);
    let mut error = 0.0_f64;
    for (x, y) in samples() {
        if let Some(expected) = exact.at(x, y, 1e-3) {
            // Where nothing is drawn, all of the depth is off.
            error = error.max((depths.at(x, y).unwrap_or(0.0) - expected).abs() / expected);
        }
    }
    error
}

/// Returns two triangles with a corner at infinity.
fn unbounded() -> [Triangle; 2] {
    let base = [DVec4::new(-0.8, -0.7, 0.3, 1.0), DVec4::new(0.7, -0.6, 0.35, 1.0)].map(single);
    [DVec4::new(0.3, 0.5, -0.05, 0.0), DVec4::new(-0.3, 0.5, -0.05, 0.0)].map(|far| [base[0], base[1], single(far)])
}

/// Returns whether a triangle covers all but the border of what it should.
fn is_covered(triangle: &Triangle, depths: &Depths) -> bool {
    let exact = Exact::new(triangle);
    samples().all(|(x, y)| exact.at(x, y, 0.01).is_none() || depths.at(x, y).is_some())
}
