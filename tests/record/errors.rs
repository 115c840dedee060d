//! What wgpu answers with an error reaches the program unchanged through the wrapper.

use super::renderer::{Fault, Renderer};
use super::{folder, gpu, record};
use std::sync::mpsc;
use stencilscope::wgpu;

type Wrong = fn(&Renderer);

fn buffer(device: &wgpu::Device, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor { label: Some("wrong"), size, usage, mapped_at_creation: false })
}

/// Each of these is refused by wgpu with an error of its own.
const WRONG: [(&str, Wrong); 8] = [
    ("usages that exclude each other", |of| {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE;
        drop(buffer(&of.device, 16, usage));
    }),
    ("a buffer larger than may be", |of| {
        drop(buffer(&of.device, 1 << 60, wgpu::BufferUsages::COPY_DST));
    }),
    ("a shader that is none", |of| {
        let source = wgpu::ShaderSource::Wgsl("@vertex fn broken() -> { }".into());
        drop(of.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("wrong"), source }));
    }),
    ("a copy past the end", |of| {
        let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let [from, to] = [16, 16].map(|size| buffer(&of.device, size, usage));
        gpu::submit(&of.device, &of.queue, |encoder| encoder.copy_buffer_to_buffer(&from, 0, &to, 8, 16));
    }),
    ("a write past the end", |of| {
        let target = buffer(&of.device, 16, wgpu::BufferUsages::COPY_DST);
        of.queue.write_buffer(&target, 8, &[0; 16]);
    }),
    ("a write with a view past the end", |of| {
        let target = buffer(&of.device, 16, wgpu::BufferUsages::COPY_DST);
        let size = wgpu::BufferSize::new(32).expect("a size");
        assert!(of.queue.write_buffer_with(&target, 0, size).is_none());
    }),
    ("a write with a view of five bytes", |of| {
        let target = buffer(&of.device, 16, wgpu::BufferUsages::COPY_DST);
        let size = wgpu::BufferSize::new(5).expect("a size");
        assert!(of.queue.write_buffer_with(&target, 0, size).is_none());
    }),
    ("a group that finishes what was never begun", |of| {
        gpu::submit(&of.device, &of.queue, wgpu::CommandEncoder::pop_debug_group);
    }),
];

/// The words of the first error, as a scope has them.
fn error_of(renderer: &Renderer, wrong: Wrong) -> Option<String> {
    let scope = renderer.device.push_error_scope(wgpu::ErrorFilter::Validation);
    wrong(renderer);
    pollster::block_on(scope.pop()).map(|error| error.to_string())
}

#[test]
fn validation_errors_are_wgpus_own_words() {
    let plain = Renderer::new(wgpu::Instance::new, Fault::None);
    let wrapped = Renderer::new(record::instance, Fault::None);
    for (what, wrong) in WRONG {
        let expected = error_of(&plain, wrong);
        assert!(expected.is_some(), "{what} is no error");
        assert_eq!(error_of(&wrapped, wrong), expected, "{what}");
    }
    // And it still draws.
    plain.draw();
    wrapped.draw();
    assert!(plain.picture() == wrapped.picture());
}

/// A texture of 256 GiB, within all limits: no machine that runs this has it.
#[test]
fn out_of_memory_is_said_in_wgpus_own_words() {
    let error = |renderer: &Renderer| {
        let scope = renderer.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let texture = renderer.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("vast"),
            size: wgpu::Extent3d { width: 8192, height: 8192, depth_or_array_layers: 256 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        drop(texture);
        pollster::block_on(scope.pop())
    };
    let plain = Renderer::new(wgpu::Instance::new, Fault::None);
    let wrapped = Renderer::new(record::instance, Fault::None);
    let expected = error(&plain).expect("no memory");
    assert!(matches!(expected, wgpu::Error::OutOfMemory { .. }), "{expected}");
    let found = error(&wrapped).expect("no memory");
    assert!(matches!(found, wgpu::Error::OutOfMemory { .. }) && found.to_string() == expected.to_string(), "{found}");
    wrapped.draw();
    plain.draw();
    assert!(plain.picture() == wrapped.picture());
}

/// An error within a recorded frame is the program's to handle, as any; and no folder is left.
#[test]
fn an_error_in_a_recorded_frame_is_the_programs() {
    let renderer = Renderer::new(record::instance, Fault::None);
    let target = folder("error");
    let scope = renderer.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let refused = record::frame(&renderer.device, &renderer.queue, &target, |encoder| encoder.pop_debug_group());
    let error = pollster::block_on(scope.pop());
    assert!(error.is_some(), "the program is told");
    assert!(refused.is_err(), "{refused:?}");
    assert!(!target.exists());
    renderer.draw();
    assert!(renderer.stencil().iter().any(|count| *count != 0));
}

/// A device that is lost says so once; what is drawn on it afterwards is the same error, or none, as without us.
#[test]
fn a_lost_device_says_so_and_what_follows_is_no_panic() {
    let lose = |instance: fn(wgpu::InstanceDescriptor) -> wgpu::Instance| {
        let renderer = Renderer::new(instance, Fault::None);
        let (sender, heard) = mpsc::channel();
        let sender = std::sync::Mutex::new(sender);
        renderer.device.set_device_lost_callback(move |reason, _| {
            sender.lock().expect("a sender").send(reason).expect("heard");
        });
        let scope = renderer.device.push_error_scope(wgpu::ErrorFilter::Validation);
        renderer.device.destroy();
        let polled = renderer.device.poll(wgpu::PollType::Poll).is_ok();
        renderer.draw();
        let error = pollster::block_on(scope.pop()).map(|error| error.to_string());
        (heard.try_iter().collect::<Vec<_>>(), polled, error)
    };
    let wrapped = lose(record::instance);
    assert_eq!(wrapped.0, [wgpu::DeviceLostReason::Destroyed]);
    assert_eq!(wrapped, lose(wgpu::Instance::new));
}

#[test]
fn an_encoder_may_be_dropped_at_any_time() {
    let renderer = Renderer::new(record::instance, Fault::None);
    let encoder = || renderer.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    drop(encoder());
    let mut begun = encoder();
    renderer.encode(&mut begun);
    drop(begun);
    let finished = encoder().finish();
    drop(finished);
    renderer.draw();
    assert!(renderer.stencil().iter().any(|count| *count != 0));
}
