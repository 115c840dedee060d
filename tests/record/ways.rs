//! Every way in which wgpu draws is followed: where vertices land, which triangles they make, what they leave.

use super::{draws, folder, gpu, record};
use crate::common::adapter;
use stencilscope::capture::disk::{self, WholeFrame};
use stencilscope::history::FragmentOutcome;
use stencilscope::import::ConvertedFrame;
use stencilscope::record::RecordedFrame;
use stencilscope::session::Session;
use stencilscope::wgpu::{self, BufferUsages, IndexFormat, PrimitiveTopology};

const SHADER: &str = "
override shift: f32 = 0.0;
@group(0) @binding(0) var<storage, read> places: array<vec4<f32>>;

fn moved(at: vec4<f32>, instance: u32) -> vec4<f32> {
    return at + vec4(0.25 * f32(instance) + shift, 0.0, 0.125 * f32(instance), 0.0);
}
@vertex fn pulled(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    return moved(places[vertex], instance);
}
struct In { @location(0) at: vec4<f32>, @builtin(instance_index) instance: u32 }
struct Out { @location(0) unused: f32, @builtin(position) position: vec4<f32> }
@vertex fn fed(in: In) -> Out {
    if in.at.x > 100.0 { return Out(1.0, vec4(0.0)); }
    return Out(0.0, moved(in.at, in.instance));
}
@fragment fn none() {}
@fragment fn sieve(@builtin(position) at: vec4<f32>) {
    if (u32(at.x) + u32(at.y)) % 3 == 0 { discard; }
}
struct Seen { @builtin(front_facing) front: bool, @builtin(position) at: vec4<f32> }
fn drop_left_of(x: f32, at: vec4<f32>) { if at.x < x { discard; } }
@fragment fn half(seen: Seen) -> @location(0) vec4<f32> {
    drop_left_of(20.0 + places[0].w * 4.0, seen.at);
    return vec4(1.0);
}
@fragment fn nothing() { discard; }
";

struct Stage {
    device: wgpu::Device,
    queue: wgpu::Queue,
    module: wgpu::ShaderModule,
    places: wgpu::Buffer,
    indices: wgpu::Buffer,
    arguments: wgpu::Buffer,
    depth: wgpu::TextureView,
}

/// How the pipeline of a way is unlike the others.
#[derive(Clone, Copy)]
struct Look {
    vertex: &'static str,
    topology: PrimitiveTopology,
    shift: f64,
    fragment: Option<&'static str>,
}

const PULLED: Look = Look { vertex: "pulled", topology: PrimitiveTopology::TriangleList, shift: 0.0, fragment: None };
const FED: Look = Look { vertex: "fed", ..PULLED };
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

impl Stage {
    fn new() -> Stage {
        let instance = record::instance(wgpu::InstanceDescriptor::new_without_display_handle());
        let (device, queue) = gpu::device(&instance, &wgpu::DeviceDescriptor::default());
        let module = gpu::module(&device, SHADER);
        let buffer = |contents: &[u8], usage| gpu::buffer(&device, contents, usage);
        let places: [[f32; 4]; 4] =
            [[-0.75, -0.75, 0.5, 1.0], [0.25, -0.75, 0.5, 1.0], [-0.75, 0.75, 0.25, 1.0], [0.25, 0.75, 0.25, 1.0]];
        let indices: [u16; 8] = [0, 1, 2, 3, 0xffff, 2, 1, 3];
        // A plain draw of two instances, then an indexed one of one, from index 1 on.
        let arguments: [u32; 9] = [3, 2, 0, 0, 3, 1, 1, 0, 0];
        let texture = gpu::texture(&device, [64, 48], FORMAT, 1, wgpu::TextureUsages::empty());
        Stage {
            places: buffer(bytemuck::cast_slice(&places), BufferUsages::STORAGE | BufferUsages::VERTEX),
            indices: buffer(bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            arguments: buffer(bytemuck::cast_slice(&arguments), BufferUsages::INDIRECT),
            depth: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            device,
            queue,
            module,
        }
    }

    /// A pipeline whose bind group layouts are derived from its shader.
    fn pipeline(&self, look: Look) -> wgpu::RenderPipeline {
        let attributes = wgpu::vertex_attr_array![0 => Float32x4];
        let step_mode = wgpu::VertexStepMode::Vertex;
        let buffers = [Some(wgpu::VertexBufferLayout { array_stride: 16, step_mode, attributes: &attributes })];
        let is_strip = look.topology == PrimitiveTopology::TriangleStrip;
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(look.vertex),
            layout: None,
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some(look.vertex),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &[("shift", look.shift)],
                    ..wgpu::PipelineCompilationOptions::default()
                },
                buffers: if look.vertex == "fed" { &buffers } else { &[] },
            },
            primitive: wgpu::PrimitiveState {
                topology: look.topology,
                strip_index_format: is_strip.then_some(IndexFormat::Uint16),
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: Some(gpu::depth_state(
                FORMAT,
                true,
                wgpu::CompareFunction::Less,
                wgpu::StencilState::default(),
            )),
            multisample: wgpu::MultisampleState::default(),
            fragment: look.fragment.map(|name| wgpu::FragmentState {
                module: &self.module,
                entry_point: Some(name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn group(&self, pipeline: &wgpu::RenderPipeline) -> wgpu::BindGroup {
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: self.places.as_entire_binding() }],
        })
    }

    /// The triangles of the frame's draws, each computed anew to the last bit.
    fn triangles(&self, name: &str, look: Look, draw: impl Fn(&mut wgpu::RenderPass<'_>)) -> Vec<usize> {
        let ConvertedFrame { plan, .. } = self.recorded(name, look, draw);
        plan.passes.iter().flat_map(|pass| &pass.draws).map(|draw| draw.triangles.len()).collect()
    }

    /// A frame of one pass that is followed without a limit, and computed anew to the last bit.
    fn recorded(&self, name: &str, look: Look, draw: impl Fn(&mut wgpu::RenderPass<'_>)) -> ConvertedFrame {
        let RecordedFrame { frame, folder, .. } = self.frame(name, look, draw);
        for draw in draws(&frame.capture) {
            let differs = draw.differs.unwrap_or_else(|| panic!("{name}: not computed anew"));
            assert!(differs.is_nowhere() && differs.rounded == 0, "{name}: {differs:?}");
        }
        assert_eq!(limits(&frame), [""; 0], "{name}");
        let WholeFrame { capture, plan, .. } = disk::read_whole(&folder).expect("a capture folder");
        std::fs::remove_dir_all(folder).expect("removed");
        assert!(plan.as_ref() == Some(&frame.plan) && capture.steps == frame.capture.steps);
        frame
    }

    fn frame(&self, name: &str, look: Look, draw: impl Fn(&mut wgpu::RenderPass<'_>)) -> RecordedFrame {
        let pipeline = self.pipeline(look);
        let target = folder(name);
        let recorded = record::frame(&self.device, &self.queue, &target, |encoder| {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..wgpu::RenderPassDescriptor::default()
            });
            pass.set_pipeline(&pipeline);
            if look.vertex == "fed" {
                pass.set_vertex_buffer(0, self.places.slice(..));
            }
            if look.vertex == "pulled" || look.fragment == Some("half") {
                pass.set_bind_group(0, &self.group(&pipeline), &[]);
            }
            pass.set_index_buffer(self.indices.slice(..), IndexFormat::Uint16);
            draw(&mut pass);
        });
        recorded.expect(name)
    }
}

/// What could not be followed, but for lights, of which a frame of one pass has none.
fn limits(frame: &ConvertedFrame) -> Vec<&str> {
    let limits = frame.capture.origin.iter().flat_map(|origin| &origin.limits).map(String::as_str);
    limits.filter(|limit| !limit.contains("no light is looked for")).collect()
}

#[test]
fn every_way_of_drawing_is_followed() {
    let stage = Stage::new();
    let strip = Look { topology: PrimitiveTopology::TriangleStrip, ..FED };
    assert_eq!(stage.triangles("pulled", PULLED, |pass| pass.draw(0..3, 0..1)), [1]);
    assert_eq!(stage.triangles("instanced", PULLED, |pass| pass.draw(1..4, 1..4)), [3]);
    assert_eq!(stage.triangles("fed", FED, |pass| pass.draw(0..3, 0..2)), [2]);
    assert_eq!(stage.triangles("indexed", FED, |pass| pass.draw_indexed(5..8, 0, 0..1)), [1]);
    assert_eq!(stage.triangles("based", PULLED, |pass| pass.draw_indexed(0..3, 1, 0..1)), [1]);
    assert_eq!(stage.triangles("strip", strip, |pass| pass.draw_indexed(0..8, 0, 0..1)), [3]);
    assert_eq!(stage.triangles("indirect", FED, |pass| pass.draw_indirect(&stage.arguments, 0)), [2]);
    let indirect = stage.triangles("indexed-indirect", PULLED, |pass| {
        pass.draw_indexed_indirect(&stage.arguments, 16);
    });
    assert_eq!(indirect, [1]);
    let shifted = Look { shift: 0.5, ..FED };
    assert_eq!(stage.triangles("override", shifted, |pass| pass.draw(0..3, 0..1)), [1]);
}

/// A shader that discards is followed fragment by fragment: what it leaves is computed anew, to the last bit, and the history
/// of each pixel names those that it has discarded.
#[test]
fn what_a_shader_discards_is_known() {
    let stage = Stage::new();
    let of = |fragment, look| Look { fragment: Some(fragment), ..look };
    let strip = Look { topology: PrimitiveTopology::TriangleStrip, ..FED };
    if !adapter::tells_triangles() {
        let RecordedFrame { frame, folder, .. } =
            stage.frame("sieve", of("sieve", PULLED), |pass| pass.draw(0..3, 0..3));
        let limits = limits(&frame);
        assert!(limits.iter().any(|limit| limit.contains("fragment shaders can't tell triangles")), "{limits:?}");
        return std::fs::remove_dir_all(folder).expect("removed");
    }
    let mut session = Session::new(None).expect("a GPU");
    let mut found = |frame: &ConvertedFrame| {
        let [width, height] = frame.plan.size;
        let pixels = (0..width * height).step_by(7).map(|at| [at % width, at / width]);
        let mut outcomes = [0; 2];
        for pixel in pixels {
            let history = session.history(&frame.plan, &frame.capture, pixel).expect("a history");
            assert_eq!(history.disagreements(), [], "{pixel:?}");
            for (_, one) in history.triangles() {
                outcomes[usize::from(matches!(one.outcome, FragmentOutcome::Discarded(None)))] += 1;
            }
        }
        outcomes.map(|count| count > 0)
    };
    assert_eq!(found(&stage.recorded("sieve", of("sieve", PULLED), |pass| pass.draw(0..3, 0..3))), [true, true]);
    assert_eq!(found(&stage.recorded("half", of("half", FED), |pass| pass.draw(0..3, 0..2))), [true, true]);
    let both = stage.recorded("both", of("sieve", strip), |pass| {
        pass.draw_indexed(0..8, 0, 0..2);
        pass.draw_indexed_indirect(&stage.arguments, 16);
    });
    assert_eq!(found(&both), [true, true]);
    assert_eq!(found(&stage.recorded("nothing", of("nothing", FED), |pass| pass.draw(0..3, 0..1))), [false, true]);
    // For a shader that can't discard, nothing is noted.
    let plain = stage.recorded("plain", of("none", FED), |pass| pass.draw(0..3, 0..1));
    assert!(plain.plan.meshes.iter().all(|mesh| mesh.retained.is_none()) && found(&plain) == [true, false]);
}

/// A bundle's draws are draws like others.
#[test]
fn bundles_are_followed_draw_by_draw() {
    let stage = Stage::new();
    let pipeline = stage.pipeline(FED);
    let mut bundle = stage.device.create_render_bundle_encoder(&wgpu::RenderBundleEncoderDescriptor {
        label: None,
        color_formats: &[],
        depth_stencil: Some(wgpu::RenderBundleDepthStencil {
            format: FORMAT,
            depth_read_only: false,
            stencil_read_only: true,
        }),
        sample_count: 1,
        multiview: None,
    });
    bundle.set_pipeline(&pipeline);
    bundle.set_vertex_buffer(0, stage.places.slice(..));
    bundle.draw(0..3, 0..1);
    bundle.draw(1..4, 0..1);
    let bundle = bundle.finish(&wgpu::RenderBundleDescriptor::default());
    assert_eq!(stage.triangles("bundle", FED, |pass| pass.execute_bundles([&bundle])), [1, 1]);
}
