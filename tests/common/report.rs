//! A report with invented numbers, for pictures and panels.

use std::collections::BTreeMap;
use stencilscope::accuracy::ErrorCounts;
use stencilscope::capture::AdapterInfo;
use stencilscope::report::{FrameTimes, Report, ReportRow};

fn row(scene: &str, technique: &str, label: &str, settings: &[(&str, &str)], wrong: u64, ms: f64) -> ReportRow {
    let settings = settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
    // No two frames take equally long: a few per cent around the median.
    let spread = 0.03 + 0.05 * (ms * 7.3).fract();
    ReportRow {
        scene: scene.to_owned(),
        technique: technique.to_owned(),
        settings: settings.collect::<BTreeMap<_, _>>(),
        label: label.to_owned(),
        size: [1280, 720],
        sweep: None,
        error: ErrorCounts {
            compared: 901_234,
            false_shadow: wrong / 3,
            missing_shadow: wrong - wrong / 3,
            wrong_surface: 0,
            edge_band: 20_366,
        },
        wrong_fraction: 0.0,
        wrong_color: Some(wrong + wrong / 8),
        visibility_error: None,
        frame_ms: FrameTimes { median: ms, min: ms * (1.0 - spread), max: ms * (1.0 + 2.5 * spread), runs: 15 },
        gpu_ms: Some(ms * 0.93),
        moving: None,
        setup_ms: 4.0 + ms,
        triangles: (ms * 1900.0) as u64,
        bytes: (ms * 1.1e6) as u64,
        pareto: false,
    }
}

/// A scene as techniques do on it: `light` of it is in shadow, frames take `pace` milliseconds.
fn scene(name: &str, pace: f64, shadow: u64, z_pass_wrong: u64, planar_wrong: u64) -> Vec<ReportRow> {
    let mut rows = vec![
        row(name, "none", "", &[], shadow, pace),
        row(name, "planar", "", &[], planar_wrong, pace * 1.5),
        row(name, "z-pass", "", &[], z_pass_wrong, pace * 2.6),
        row(name, "z-fail", "", &[], 0, pace * 3.1),
    ];
    for (slope, worse) in [("2", 1), ("0", 5)] {
        for (size, cost) in [(256, 1.45), (512, 1.6), (1024, 2.0), (2048, 3.4), (4096, 8.6)] {
            let label = if slope == "2" { size.to_string() } else { format!("{size}, slope {slope}") };
            let settings = [("size", size.to_string()), ("bias-slope", slope.to_owned())];
            let settings: Vec<(&str, &str)> = settings.iter().map(|(key, value)| (*key, value.as_str())).collect();
            // Twice the texels along a side, half the stairs; acne does not go away.
            let stairs = shadow / 5 * 256 / size;
            let wrong = if worse > 1 { stairs + shadow / 9 * worse } else { stairs };
            rows.push(row(
                name,
                "shadow-map",
                &label,
                &settings,
                wrong,
                pace * cost * if worse > 1 { 1.02 } else { 1.0 },
            ));
        }
    }
    rows.push(row(name, "ray-traced", "", &[], 0, 150.0 * pace / 7.0));
    rows
}

/// One scene, 15 rows.
pub fn one_scene() -> Report {
    Report::new(adapter(), scene("tori", 7.0, 274_404, 0, 81_000))
}

/// Three scenes, 15 rows each.
pub fn three_scenes() -> Report {
    let rows = [
        scene("tori", 7.0, 274_404, 0, 81_000),
        scene("table", 4.0, 61_000, 0, 0),
        scene("inside a volume", 11.0, 190_000, 402_000, 150_000),
    ];
    Report::new(adapter(), rows.concat())
}

fn adapter() -> AdapterInfo {
    AdapterInfo {
        name: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
        driver: "Mesa 22.3.6".to_owned(),
        kind: "cpu".to_owned(),
    }
}
