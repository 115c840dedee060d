//! What is asked of every frame that a stranger's program was recorded in.

use std::path::{Path, PathBuf};
use std::time::Instant;
use stencilscope::capture::disk::{self, WholeFrame};
use stencilscope::record;
use stencilscope::session::Session;
use stencilscope::wgpu;

/// A device of an instance that `make` makes.
pub fn device(
    make: fn(wgpu::InstanceDescriptor) -> wgpu::Instance,
    limits: fn(&wgpu::Adapter) -> wgpu::Limits,
) -> (wgpu::Instance, wgpu::Adapter, wgpu::Device, wgpu::Queue) {
    let instance = make(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.expect("an adapter");
    let asked = wgpu::DeviceDescriptor { required_limits: limits(&adapter), ..wgpu::DeviceDescriptor::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&asked)).expect("a device");
    (instance, adapter, device, queue)
}

/// What a program draws, all of which must be found.
#[derive(Debug, PartialEq)]
pub struct Expected {
    pub draws: usize,
    /// Draws of the picture: those that are computed anew.
    pub of_picture: usize,
    /// Draws whose shader may discard, and of which the fragments that it did not discard are known.
    pub discarding: usize,
    /// What is said of the frame as not known.
    pub limits: &'static [&'static str],
}

/// Records what `draw` draws, and compares the recording with itself: each draw leaves the stored bytes when it is
/// computed anew, and so do the histories of 200 pixels.
pub fn record(name: &str, device: &wgpu::Device, draw: impl FnOnce(), expected: &Expected) {
    let folder = PathBuf::from(std::env::temp_dir()).join(format!("stencilscope-{name}-{}", std::process::id()));
    let begin = Instant::now();
    record::next_frame(device, &folder).expect("a device that records");
    draw();
    let seconds = begin.elapsed().as_secs_f64();
    check(name, &folder, seconds, expected);
    std::fs::remove_dir_all(folder).expect("removed");
}

fn check(name: &str, folder: &Path, seconds: f64, expected: &Expected) {
    let WholeFrame { capture, plan, .. } = disk::read_whole(folder).expect("a capture folder");
    let plan = plan.expect("a plan");
    let draws: Vec<_> = capture.steps.iter().flat_map(|step| &step.draws).collect();
    let compared: Vec<_> = draws.iter().filter_map(|draw| Some((&draw.name, draw.differs?))).collect();
    for (draw, differs) in &compared {
        assert!(differs.is_nowhere() && differs.rounded == 0, "{name}, {draw}: {differs:?}");
    }
    let discarding = plan.meshes.iter().filter(|mesh| mesh.retained.is_some()).count();
    let limits = capture.origin.as_ref().map(|origin| origin.limits.clone()).unwrap_or_default();
    let found = (draws.len(), compared.len(), discarding);
    assert_eq!(found, (expected.draws, expected.of_picture, expected.discarding), "{name}");
    assert_eq!(limits, expected.limits, "{name}");
    let mut session = Session::new(None).expect("an adapter");
    let [width, height] = capture.size;
    let mut fragments = 0;
    for index in 0..200_u32 {
        // Spread by the golden ratio.
        let row = (f64::from(index) * 0.618_033_988_75).fract() * f64::from(height);
        let pixel = [index * 7919 % width, row as u32];
        let history = session.history(&plan, &capture, pixel).expect("a history");
        assert!(history.agrees(), "{name}, {pixel:?}: {:?}", history.disagreements());
        fragments += history.triangles().count();
    }
    println!(
        "{name}: {} draws recorded in {seconds:.2} s, {} of the picture computed anew to the last bit, {discarding} with \
         shaders that discard; 200 histories with {fragments} fragments agree",
        draws.len(),
        compared.len()
    );
}
