//! Frames leave nothing behind, and need little memory while they run.

use crate::common::{apart, opened};
use stencilscope::reading::steps;
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};

/// Captures before it is measured: caches fill, and the driver compiles.
const WARM_UP: usize = 10;
/// How often it is measured. What a frame retains grows each time; what an allocator takes for its own ends, up to 20
/// MB on two cores and once more than 40 on a busy machine, does not.
const ROUNDS: usize = 3;
/// Captures of a round.
const FRAMES: usize = 30;
/// What a round's frames may retain together, bytes. Lavapipe (Mesa 22.3) retained 8 MB of each while it compiled draws
/// by their uniform values.
const MOST_CACHED: u64 = 30 << 20;

/// What stepping draw by draw through every pass may take, bytes. It takes 222 MiB; 352 where pictures share no rows,
/// 639 where all copies of a frame are in memory before any is looked at.
const MOST_RESIDENT: u64 = 300 << 20;

/// A line of this process's memory, bytes: `RssAnon` is what is not shared, `VmHWM` the most that was ever there.
fn memory(line: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find(|found| found.starts_with(line)).expect("a line");
    line.split_whitespace().nth(1).expect("a number").parse::<u64>().expect("a number") << 10
}

#[test]
fn captures_keep_no_memory() {
    apart("memory::captures_keep_no_memory", &["z-fail", "shadow-map", "planar-texture", "auto"], |part| {
        let technique = Technique::ALL.into_iter().find(|technique| technique.name() == part).expect("a technique");
        let scene = opened("tori");
        let mut session = Session::new(None).expect("an adapter");
        let request = CaptureRequest::new(Choice::new(technique), [64, 48]);
        let mut run = |frames: usize| {
            for frame in 0..frames {
                let posed = scene.at(frame as f64 * 0.1);
                session.capture(&posed, &request).expect("a capture");
            }
        };
        run(WARM_UP);
        let cached = [(); ROUNDS].map(|()| {
            let before = memory("RssAnon");
            run(FRAMES);
            memory("RssAnon").saturating_sub(before)
        });
        let least = cached.into_iter().min().expect("a round");
        assert!(least < MOST_CACHED, "{part}: {cached:?} bytes of {FRAMES} frames each");
    });
}

#[test]
fn draws_hold_few_pictures_at_once() {
    apart("memory::draws_hold_few_pictures_at_once", &["planar-texture"], |_| {
        let scene = opened("rings");
        let mut session = Session::new(None).expect("an adapter");
        let request = CaptureRequest::new(Choice::new(Technique::PlanarTexture), [1280, 800]);
        let (mut capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
        let before = memory("VmHWM");
        // As the window steps: what only compares techniques is passed over.
        let stepped: Vec<usize> = steps::numbered(&capture).collect();
        for step in stepped {
            capture = capture.with_draws(&session.step_draws(&plan, &capture, step).expect("draws"));
        }
        let peak = memory("VmHWM").saturating_sub(before);
        assert!(peak < MOST_RESIDENT, "{} MiB", peak >> 20);
    });
}
