//! Frames of a wgpu program that knows nothing of us but its instance.

mod errors;
mod gpu;
mod renderer;
mod states;
mod ways;

use renderer::{Fault, Renderer};
use std::path::PathBuf;
use stencilscope::capture::{Capture, DrawSummary, disk};
use stencilscope::history::{FragmentOutcome, PixelHistory, TriangleEvent};
use stencilscope::import::ConvertedFrame;
use stencilscope::record::{self, RecordError, RecordedFrame, SeriesFrame};
use stencilscope::session::Session;
use stencilscope::testing::Rendered;
use stencilscope::wgpu;

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("stencilscope-record-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn recorded(name: &str, renderer: &Renderer) -> RecordedFrame {
    let folder = folder(name);
    record::frame(&renderer.device, &renderer.queue, &folder, |encoder| renderer.encode(encoder)).expect("a frame")
}

fn draws(capture: &Capture) -> Vec<&DrawSummary> {
    capture.steps.iter().flat_map(|step| &step.draws).collect()
}

/// The stencil after the last step that has one.
fn last_stencil(capture: &Capture) -> Vec<u8> {
    let frames = (0..capture.steps.len()).rev().filter_map(|step| capture.frame_at(step));
    let stencil = frames.filter_map(|frame| frame.stencil.as_ref()).next().expect("a stencil");
    stencil.image.rows().flatten().copied().collect()
}

/// Every draw is followed, computed anew to the last bit, and what was stored is what the program itself reads back.
#[test]
fn a_frame_is_recorded_draw_by_draw() {
    let renderer = Renderer::new(record::instance, Fault::None);
    let RecordedFrame { frame: ConvertedFrame { capture, plan, lights, .. }, folder, .. } =
        recorded("whole", &renderer);
    assert_eq!(draws(&capture).len(), 4, "{}", capture.plan_text);
    for draw in draws(&capture) {
        let differs = draw.differs.unwrap_or_else(|| panic!("{} is not computed anew", draw.name));
        assert!(differs.is_nowhere() && differs.rounded == 0, "{}: {differs:?}", draw.name);
    }
    assert_eq!(capture.origin.as_ref().map(|origin| origin.limits.clone()), Some(Vec::new()));
    assert_eq!(last_stencil(&capture), renderer.stencil());
    assert_eq!(plan.passes.iter().map(|pass| pass.draws.len()).sum::<usize>(), 4);
    // The volume's sides run away from the light.
    assert!(lights.iter().any(Option::is_some), "{lights:?}");
    assert!(folder.join("manifest.json").is_file());
    std::fs::remove_dir_all(folder).expect("removed");
}

/// The picture, the depth and the stencil are the same with and without a wrapper, recorded or not.
#[test]
fn a_frame_is_drawn_as_without_us() {
    let plain = Renderer::new(wgpu::Instance::new, Fault::None);
    let wrapped = Renderer::new(record::instance, Fault::None);
    plain.draw();
    wrapped.draw();
    let expected = plain.picture();
    assert!(expected == wrapped.picture());
    let RecordedFrame { folder, .. } = recorded("same", &wrapped);
    assert!(expected == wrapped.picture() && plain.stencil() == wrapped.stencil());
    std::fs::remove_dir_all(folder).expect("removed");
}

/// A program that draws as it does anyway: of three frames the one after the call is recorded, with what it stored.
#[test]
fn the_next_frame_is_recorded_without_a_closure() {
    let renderer = Renderer::new(record::instance, Fault::None);
    let target = folder("next");
    renderer.draw();
    // What reads a frame back is no frame.
    renderer.stencil();
    record::next_frame(&renderer.device, &target).expect("a wrapped device");
    assert!(!target.exists());
    renderer.draw();
    let opened = disk::read_whole(&target).expect("a folder");
    assert_eq!(last_stencil(&opened.capture), renderer.stencil());
    std::fs::remove_dir_all(&target).expect("removed");
    renderer.draw();
    assert!(!target.exists(), "one frame and no more");
}

/// Every frame between the start and the end of a series is recorded in a folder of its own, with what it took; an
/// upload is no frame.
#[test]
fn a_series_has_each_frame_and_what_it_cost() {
    let renderer = Renderer::new(record::instance, Fault::None);
    let target = folder("series");
    renderer.draw();
    record::start(&renderer.device, &target).expect("a wrapped device");
    assert!(matches!(record::start(&renderer.device, &target), Err(RecordError::Busy)));
    for _ in 0..2 {
        let upload = renderer.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        renderer.queue.submit([upload.finish()]);
        renderer.draw();
    }
    let series = record::stop(&renderer.device).expect("a wrapped device");
    renderer.draw();
    let folders = ["frame-0000", "frame-0001"].map(|name| target.join(name));
    assert_eq!(series.iter().map(|frame| &frame.folder).collect::<Vec<_>>(), folders.iter().collect::<Vec<_>>());
    for SeriesFrame { folder, outcome } in &series {
        let cost = outcome.as_ref().expect("a frame");
        let opened = disk::read_whole(folder).expect("a folder");
        assert_eq!((cost.draws, draws(&opened.capture).len()), (4, 4));
        assert_eq!(last_stencil(&opened.capture), renderer.stencil());
        let files = std::fs::read_dir(folder).expect("a folder").map(|file| file.and_then(|file| file.metadata()));
        assert_eq!(cost.bytes, files.map(|file| file.expect("a file").len()).sum::<u64>());
        assert!(!cost.time.is_zero());
    }
    assert_eq!(std::fs::read_dir(&target).expect("a folder").count(), 2, "none after the end");
    assert!(record::stop(&renderer.device).expect("a wrapped device").is_empty());
    std::fs::remove_dir_all(target).expect("removed");
}

/// Where one frame of a series can't be written, the next is not tried.
#[test]
fn a_series_ends_where_nothing_can_be_written() {
    let renderer = Renderer::new(record::instance, Fault::None);
    let target = folder("series-file");
    std::fs::write(&target, "a file").expect("written");
    record::start(&renderer.device, &target).expect("a wrapped device");
    (0..2).for_each(|_| renderer.draw());
    let series = record::stop(&renderer.device).expect("a wrapped device");
    assert!(matches!(series[..], [SeriesFrame { outcome: Err(RecordError::Disk(_)), .. }]), "{series:?}");
    std::fs::remove_file(target).expect("removed");
}

/// The history of a pixel ends in what the program has stored there.
#[test]
fn histories_end_in_what_was_stored() {
    let renderer = Renderer::new(record::instance, Fault::None);
    let RecordedFrame { frame: ConvertedFrame { capture, plan, .. }, folder, .. } = recorded("history", &renderer);
    let mut session = Session::new(None).expect("an adapter");
    let [width, height] = capture.size;
    let mut fragments = 0;
    for index in 0..200 {
        // Spread by the golden ratio.
        let pixel = [index * 7919 % width, ((f64::from(index) * 0.618_033_988_75).fract() * f64::from(height)) as u32];
        let history: PixelHistory = session.history(&plan, &capture, pixel).expect("a history");
        assert!(history.agrees(), "{pixel:?}: {history:#?}");
        fragments += history.triangles().count();
    }
    assert!(fragments > 200, "{fragments} fragments over 200 pixels");
    std::fs::remove_dir_all(folder).expect("removed");
}

/// As a test author would: assert on a pixel, and read in its history why it is wrong.
#[test]
fn a_culled_face_shows_in_the_history_of_a_pixel_that_lacks_its_shadow() {
    let of = |fault, name| {
        let renderer = Renderer::new(record::instance, fault);
        let RecordedFrame { frame: ConvertedFrame { capture, plan, .. }, folder, .. } = recorded(name, &renderer);
        std::fs::remove_dir_all(folder).expect("removed");
        (renderer.stencil(), Rendered::recorded(plan, capture).expect("an adapter"))
    };
    let (counts, mut right) = of(Fault::None, "right");
    let (_, mut wrong) = of(Fault::CullsBack, "culls-back");
    let width = right.capture().size[0] as usize;
    let shadowed = counts.iter().position(|count| *count == 1).expect("a shadow");
    let pixel = [shadowed % width, shadowed / width].map(|at| at as u32);
    right.at(pixel).stencil(1).agrees();
    wrong.at(pixel).stencil(0).agrees();
    let is_culled_back = |triangle: &TriangleEvent| triangle.outcome == FragmentOutcome::Culled && !triangle.is_front;
    let of_volume = |frame: &mut Rendered| {
        let history = frame.at(pixel).history().clone();
        history.triangles().filter(|(event, triangle)| event.pass_name == "volumes" && is_culled_back(triangle)).count()
    };
    assert_eq!([of_volume(&mut right), of_volume(&mut wrong)], [0, 1]);
}

/// A device of an instance that is not ours can't be recorded, and says how it can.
#[test]
fn a_device_that_is_not_wrapped_is_named() {
    let renderer = Renderer::new(wgpu::Instance::new, Fault::None);
    let refused =
        record::frame(&renderer.device, &renderer.queue, &folder("plain"), |encoder| renderer.encode(encoder));
    let error = refused.expect_err("no recording");
    assert!(matches!(error, RecordError::NotWrapped));
    assert!(error.to_string().contains("record::instance"), "{error}");
}
