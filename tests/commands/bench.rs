//! `stencilscope bench`: the figures that it prints.

use super::*;

#[test]
fn bench_capture_prints_ratios() {
    let folder = folder();
    let lines = done(folder.path(), &["bench", "capture", "--scene", "triangle.obj", "--size", "64x64"]);
    for word in ["frame_ms", "captured_ms", "captured/frame", "bytes moved", "plain copy"] {
        assert!(lines.contains(word), "{word} is not in {lines}");
    }
}

#[test]
fn bench_moving_holds_auto_beside_the_fastest_that_is_right() {
    let folder = folder();
    let lines = done(folder.path(), &["bench", "moving", "--scene", "triangle.obj", "--size", "64x48"]);
    assert!(lines.starts_with("triangle: auto/fastest that is right "), "{lines}");
    assert!(lines.contains("; 0 wrong pixels\n  auto ") && lines.contains(" + set-up "), "{lines}");
    let random = done(folder.path(), &["bench", "moving", "--scene", "tumbling 7", "--size", "16x12"]);
    assert!(random.starts_with("tumbling 7: auto/fastest that is right "), "{random}");
}

#[test]
fn bench_panels_steps_in_the_next_frame_and_rests_when_idle() {
    let folder = folder();
    let printed = done(folder.path(), &["bench", "panels", "--scene", "triangle.obj", "--size", "64x64"]);
    for part in ["picture ", "scene ", "explain ", "idle: 0 of 60", "stepping: 60 of 60", "light moved"] {
        assert!(printed.contains(part), "`{part}` is not in {printed}");
    }
}

#[test]
fn bench_truth_prints_rays_a_second() {
    let folder = folder();
    let lines = done(folder.path(), &["bench", "truth", "--scene", "triangle.obj", "--size", "64x64"]);
    for word in ["3 triangles, 64x64", "sorting_ms", "following_ms", "million rays a second", "sorting/following"] {
        assert!(lines.contains(word), "{word} is not in {lines}");
    }
}
