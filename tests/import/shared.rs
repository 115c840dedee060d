//! What tests of recordings in the repository and of programs that are recorded anew share.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stencilscope::import::{RawDraw, RawFrame, RawKind};

/// A folder below `assets/recordings`.
pub fn recording(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/recordings").join(name)
}

pub fn draws<'a>(frame: &'a RawFrame) -> Vec<&'a RawDraw> {
    let draw = |kind: &'a RawKind| match kind {
        RawKind::Draw(draw) => Some(draw.as_ref()),
        _ => None,
    };
    frame.events.iter().map(|event| &event.kind).filter_map(draw).collect()
}

/// Asserts that the positions and states of all draws make what was stored.
#[track_caller]
pub fn assert_makes_what_was_stored(frame: &RawFrame) {
    /// Pixels a draw whose centre is nearly on an edge: either rasteriser may be right.
    const EDGES: usize = 8;
    let compared = super::machine::compare(frame);
    assert!(compared.iter().any(|draw| draw.changed > 0), "nothing was compared");
    for draw in &compared {
        println!("{draw:?}");
        assert!(draw.untied <= draw.stencil, "{draw:?}");
        let wrong = [draw.depth, draw.untied, draw.changed.saturating_sub(draw.touched)];
        assert!(wrong.iter().all(|pixels| *pixels <= EDGES), "event {}: {draw:?}", draw.event);
        assert_eq!(draw.unexplained_depth, 0, "event {}: {draw:?}", draw.event);
    }
}

/// Is there no such process, or only what is left of one?
pub fn has_ended(process: &str) -> bool {
    let end = Instant::now() + Duration::from_secs(10);
    let runs = || {
        let status = fs::read_to_string(Path::new("/proc").join(process).join("status")).unwrap_or_default();
        status.lines().any(|line| line.starts_with("State:") && !line.contains('Z'))
    };
    while runs() && Instant::now() < end {
        std::thread::sleep(Duration::from_millis(20));
    }
    !runs()
}
