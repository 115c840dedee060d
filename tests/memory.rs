//! Frames leave nothing behind.

use crate::common::apart;
use stencilscope::scene::{OpenSpec, open};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};

/// Captures before it is measured: caches fill, and the driver compiles.
const WARM_UP: usize = 10;
/// Captures while it is measured.
const FRAMES: usize = 40;
/// What may be kept of all of them, bytes. Lavapipe (Mesa 22.3) kept 8 MB of each while it compiled draws by their
/// uniform values.
const MOST_KEPT: u64 = 40 << 20;

/// Memory of this process that is not shared, bytes.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find(|line| line.starts_with("RssAnon")).expect("a line");
    line.split_whitespace().nth(1).expect("a number").parse::<u64>().expect("a number") << 10
}

#[test]
fn captures_keep_no_memory() {
    apart("memory::captures_keep_no_memory", &["z-fail", "shadow-map", "planar-texture", "auto"], |part| {
        let technique = Technique::ALL.into_iter().find(|technique| technique.name() == part).expect("a technique");
        let scene = open(&OpenSpec::new("tori")).expect("a built-in scene");
        let mut session = Session::new(None).expect("an adapter");
        let request = CaptureRequest::new(Choice::new(technique), [64, 48]);
        let mut run = |frames: usize| {
            for frame in 0..frames {
                let moment = scene.at(frame as f64 * 0.1);
                session.capture(&moment, &request).expect("a capture");
            }
        };
        run(WARM_UP);
        let before = resident();
        run(FRAMES);
        let kept = resident().saturating_sub(before);
        assert!(kept < MOST_KEPT, "{part}: {} MB of {FRAMES} frames", kept >> 20);
    });
}
