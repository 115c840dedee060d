//! States of passes that a frame sets, overwrites and leaves to others: done draw by draw, they come to the same.

use super::{draws, folder, gpu, record};
use std::num::NonZeroU64;
use stencilscope::capture::RecomputeDifference;
use stencilscope::record::{RecordError, RecordedFrame};
use stencilscope::wgpu::{self, BufferUsages, TextureFormat, TextureUsages};

const SHADER: &str = "
struct Place { offset: vec4<f32>, scale: vec4<f32> }
var<immediate> place: Place;
@group(0) @binding(0) var<uniform> shift: vec4<f32>;
@vertex fn vs(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32(vertex % 2), f32(vertex / 2 % 2)) * place.scale.xy;
    return vec4(corner, 0.0, 0.0) + place.offset + shift + vec4(0.0, 0.0, place.scale.z * f32(vertex), 1.0);
}
@fragment fn fs() -> @location(0) vec4<f32> { return vec4(place.scale.x, 0.5, 1.0, 1.0); }
";
const SIZE: [u32; 2] = [64, 48];
const DEPTH: TextureFormat = TextureFormat::Depth32Float;
const COLOR: TextureFormat = TextureFormat::Rgba8Unorm;

struct Stage {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Two equal pipelines, each with a pipeline layout of its own.
    pipelines: [wgpu::RenderPipeline; 2],
    color_pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    arguments: wgpu::Buffer,
    queries: wgpu::QuerySet,
    depth: wgpu::Texture,
    /// Four samples, transient: no memory holds them between passes.
    samples: wgpu::Texture,
    color: wgpu::Texture,
}

fn view(of: &wgpu::Texture) -> wgpu::TextureView {
    of.create_view(&wgpu::TextureViewDescriptor::default())
}

impl Stage {
    fn new(instance: impl FnOnce(wgpu::InstanceDescriptor) -> wgpu::Instance) -> Stage {
        let instance = instance(wgpu::InstanceDescriptor::new_without_display_handle());
        let required_limits = wgpu::Limits { max_immediate_size: 32, ..wgpu::Limits::default() };
        let required_features = wgpu::Features::IMMEDIATES;
        let asked = wgpu::DeviceDescriptor { required_features, required_limits, ..Default::default() };
        let (device, queue) = gpu::device(&instance, &asked);
        let module = gpu::module(&device, SHADER);
        let groups = gpu::of_uniform(&device, true);
        let pipeline = |color: Option<TextureFormat>| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&groups)],
                immediate_size: 32,
            });
            let stage = wgpu::PipelineCompilationOptions::default;
            let targets = color.map(|format| Some(format.into()));
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: None,
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vs"),
                    compilation_options: stage(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState {
                    topology: wgpu::PrimitiveTopology::TriangleStrip,
                    ..wgpu::PrimitiveState::default()
                },
                depth_stencil: color.is_none().then(|| {
                    gpu::depth_state(DEPTH, true, wgpu::CompareFunction::LessEqual, wgpu::StencilState::default())
                }),
                multisample: wgpu::MultisampleState {
                    count: if color.is_some() { 4 } else { 1 },
                    ..wgpu::MultisampleState::default()
                },
                fragment: color.map(|_| wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fs"),
                    compilation_options: stage(),
                    targets: targets.as_slice(),
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let texture = |format, samples, usage| gpu::texture(&device, SIZE, format, samples, usage);
        let buffer = |contents: &[u8], usage| gpu::buffer(&device, contents, usage);
        // Two shifts, as far apart as dynamic offsets must be.
        let mut shifts = [[0.0_f32; 4]; 17];
        shifts[16] = [0.3, 0.25, 0.1, 0.0];
        let shifts = buffer(bytemuck::cast_slice(&shifts), BufferUsages::UNIFORM);
        let binding = wgpu::BufferBinding { buffer: &shifts, offset: 0, size: NonZeroU64::new(16) };
        let entries = [wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(binding) }];
        let arguments: [u32; 8] = [4, 1, 0, 0, 3, 1, 1, 0];
        Stage {
            group: device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &groups,
                entries: &entries,
            }),
            pipelines: [pipeline(None), pipeline(None)],
            color_pipeline: pipeline(Some(COLOR)),
            arguments: buffer(bytemuck::cast_slice(&arguments), BufferUsages::INDIRECT),
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Occlusion,
                count: 1,
            }),
            depth: texture(DEPTH, 1, TextureUsages::COPY_SRC),
            samples: texture(COLOR, 4, TextureUsages::TRANSIENT_ATTACHMENT),
            color: texture(COLOR, 1, TextureUsages::COPY_SRC),
            device,
            queue,
        }
    }

    fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        load: wgpu::LoadOp<f32>,
        asks: bool,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(if asks { "asked" } else { "plain" }),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view(&self.depth),
                depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            occlusion_query_set: asks.then_some(&self.queries),
            ..wgpu::RenderPassDescriptor::default()
        })
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let floats = |floats: &[f32]| bytemuck::cast_slice::<f32, u8>(floats).to_vec();
        let [one, other] = &self.pipelines;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view(&self.samples),
                depth_slice: None,
                resolve_target: Some(&view(&self.color)),
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLUE), store: wgpu::StoreOp::Discard },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.color_pipeline);
        pass.set_bind_group(0, &self.group, &[256]);
        pass.set_immediates(0, &floats(&[-0.8, -0.9, 0.0, 0.0, 0.7, 0.9, 0.0, 0.0]));
        pass.draw(0..4, 0..1);
        pass.set_bind_group(0, &self.group, &[0]);
        pass.draw(0..3, 0..1);
        drop(pass);

        let mut pass = self.pass(encoder, wgpu::LoadOp::Clear(1.0), false);
        pass.set_pipeline(one);
        pass.set_bind_group(0, &self.group, &[0]);
        // Parts over one another: the last word on each counts.
        pass.set_immediates(16, &floats(&[0.5, 0.5, 0.1, 0.0]));
        pass.set_immediates(0, &floats(&[-0.9, -0.9, 0.4, 0.0, 0.7]));
        pass.draw(0..4, 0..1);
        pass.set_immediates(4, &floats(&[0.1]));
        pass.set_bind_group(0, &self.group, &[256]);
        pass.draw(0..4, 0..1);
        // Another layout finds zeros where it sets nothing.
        pass.set_pipeline(other);
        pass.set_bind_group(0, &self.group, &[0]);
        pass.set_immediates(16, &floats(&[0.6]));
        pass.set_immediates(20, &floats(&[0.8, 0.05]));
        pass.set_viewport(10.0, 4.0, 40.0, 30.0, 0.2, 0.9);
        pass.draw(0..4, 0..1);
        pass.set_scissor_rect(12, 20, 25, 9);
        pass.set_immediates(0, &floats(&[0.0, -0.5, 0.2]));
        pass.draw(0..4, 0..1);
        drop(pass);

        let mut pass = self.pass(encoder, wgpu::LoadOp::Load, true);
        pass.set_pipeline(one);
        pass.set_bind_group(0, &self.group, &[0]);
        pass.set_immediates(0, &floats(&[-1.0, 0.2, 0.05, 0.0, 0.6, 0.4, 0.01, 0.0]));
        pass.begin_occlusion_query(0);
        pass.draw(0..4, 0..1);
        pass.end_occlusion_query();
        drop(pass);

        let mut pass = self.pass(encoder, wgpu::LoadOp::Load, false);
        pass.set_pipeline(one);
        pass.set_bind_group(0, &self.group, &[256]);
        pass.set_immediates(0, &floats(&[-1.0, -0.6, 0.0, 0.0, 0.5, 0.5, 0.15, 0.0]));
        pass.multi_draw_indirect(&self.arguments, 0, 2);
    }

    fn draw(&self) {
        gpu::submit(&self.device, &self.queue, |encoder| self.encode(encoder));
    }

    /// The bytes of depth and of colour.
    fn pictures(&self) -> [Vec<u8>; 2] {
        let read = |texture| gpu::bytes((&self.device, &self.queue), texture, wgpu::TextureAspect::All, 4);
        [&self.depth, &self.color].map(read)
    }

    fn recorded(&self, name: &str) -> RecordedFrame {
        record::frame(&self.device, &self.queue, &folder(name), |encoder| self.encode(encoder)).expect(name)
    }
}

/// Immediates in parts, dynamic offsets, viewports, scissors, passes that load, resolve, ask, or draw several at once.
#[test]
fn states_come_to_the_same_draw_by_draw() {
    let [plain, wrapped] = [Stage::new(wgpu::Instance::new), Stage::new(record::instance)];
    plain.draw();
    wrapped.draw();
    let expected = plain.pictures();
    assert!(expected.iter().all(|picture| picture.chunks(4).any(|texel| texel != &picture[..4])), "nothing is drawn");
    assert!(expected == wrapped.pictures());
    let RecordedFrame { frame, folder, .. } = wrapped.recorded("states");
    assert!(expected == wrapped.pictures(), "drawn otherwise while it is recorded");
    std::fs::remove_dir_all(folder).expect("removed");
    let exact: Vec<Option<bool>> =
        draws(&frame.capture).iter().map(|draw| draw.differs.map(RecomputeDifference::is_nowhere)).collect();
    // What a draw of a pass with a query left by itself is not known.
    let [yes, unknown] = [Some(true), None];
    assert_eq!(exact, [yes, yes, yes, yes, unknown, yes], "{:?}", frame.capture.origin);
    let triangles: Vec<usize> =
        frame.plan.passes.iter().flat_map(|pass| &pass.draws).map(|draw| draw.triangles.len()).collect();
    assert_eq!(triangles, [2, 2, 2, 2, 2, 3]);
    let limits = frame.capture.origin.map(|origin| origin.limits).unwrap_or_default().join("\n");
    assert!(limits.contains("passes with queries") && limits.contains("transient targets"), "{limits}");
    assert!(!limits.contains("refused") && !limits.contains("states alone"), "{limits}");
}

/// A callback of wgpu's may submit, also while a frame is done draw by draw.
#[test]
fn a_callback_that_submits_goes_past() {
    let stage = Stage::new(record::instance);
    let (sender, receiver) = std::sync::mpsc::channel();
    for _ in 0..2 {
        let (queue, sender) = (stage.queue.clone(), sender.clone());
        stage.queue.on_submitted_work_done(move || {
            queue.submit([]);
            sender.send(()).expect("somebody listens");
        });
        let RecordedFrame { folder, .. } = stage.recorded("callback");
        receiver.try_recv().expect("called while the frame was recorded");
        std::fs::remove_dir_all(folder).expect("removed");
    }
}

/// A closure that panics leaves nothing behind: the next frame is recorded as if it had not been.
#[test]
fn a_closure_that_panics_is_forgotten() {
    let stage = Stage::new(record::instance);
    let given_up = folder("panic");
    let panics = std::panic::AssertUnwindSafe(|| {
        drop(record::frame(&stage.device, &stage.queue, &given_up, |_| std::panic::resume_unwind(Box::new(()))));
    });
    assert!(std::panic::catch_unwind(panics).is_err());
    stage.draw();
    assert!(!given_up.exists());
    let RecordedFrame { folder, .. } = stage.recorded("after-panic");
    std::fs::remove_dir_all(folder).expect("removed");
}

/// A frame that a closure draws is no frame of a series, nor does it end the wait for the next.
#[test]
fn a_closure_and_a_wish_go_side_by_side() {
    let stage = Stage::new(record::instance);
    let wished = folder("wished");
    record::next_frame(&stage.device, &wished).expect("a wish");
    assert!(matches!(record::next_frame(&stage.device, &wished), Err(RecordError::Busy)));
    assert!(matches!(record::start(&stage.device, &wished), Err(RecordError::Busy)));
    let RecordedFrame { folder, .. } = stage.recorded("side-by-side");
    assert!(!wished.exists());
    stage.draw();
    for folder in [folder, wished] {
        assert!(folder.join("manifest.json").is_file());
        std::fs::remove_dir_all(folder).expect("removed");
    }
}
