//! The readback tests that others write with `testing`: what they find, and how they fail.

use crate::common::{cuboid, session, square};
use glam::DVec3;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::Once;
use stencilscope::glam;
use stencilscope::scene::{Light, Scene, SceneBuilder};
use stencilscope::session::CaptureRequest;
use stencilscope::technique::{Choice, Technique};
use stencilscope::testing::{PixelLabel, Rendered};

const SIZE: [u32; 2] = [96, 72];

/// A box a metre above a floor, under two suns: one from above, one from the side.
fn scene() -> Scene {
    SceneBuilder::new("two suns")
        .objects([square("floor", 0.0, 6.0), cuboid("box", [-0.5, 1.0, -0.5], [0.5, 2.0, 0.5])])
        .lights([Light::directional([0.0, 1.0, 0.0]), Light::directional([1.0, 1.0, 0.0])])
        .seen_from([0.0, 6.0, 6.0], [0.0, 0.5, 0.0])
        .build()
}

fn rendered(technique: Technique) -> Rendered {
    let request = CaptureRequest::new(Choice::new(technique), SIZE);
    Rendered::on(session(), &scene(), &request).expect("a frame")
}

thread_local! {
    /// Where the last panic was, and what it said, while that is looked at.
    static PANIC: RefCell<Option<(String, u32, String)>> = const { RefCell::new(None) };
    static IS_WATCHED: RefCell<bool> = const { RefCell::new(false) };
}

/// What a failing assertion says; it must fail in this file, at `line`.
#[track_caller]
fn failure(line: u32, body: impl FnOnce()) -> String {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info: &PanicHookInfo| {
            if IS_WATCHED.with_borrow(|is_watched| *is_watched) {
                let place = info.location().map(|at| (at.file().to_owned(), at.line()));
                let (file, line) = place.unwrap_or_default();
                let said = info.payload_as_str().unwrap_or_default().to_owned();
                PANIC.set(Some((file, line, said)));
            } else {
                before(info);
            }
        }));
    });
    IS_WATCHED.set(true);
    let result = catch_unwind(AssertUnwindSafe(body));
    IS_WATCHED.set(false);
    assert!(result.is_err(), "it must fail");
    let (file, at, said) = PANIC.take().expect("a panic");
    assert!(file.ends_with("readback.rs"), "{file}:{at}: {said}");
    assert_eq!(at, line, "{said}");
    said
}

#[test]
fn a_point_is_found_in_the_picture_and_its_shadow_is_that_of_geometry() {
    let mut frame = rendered(Technique::ZFail);
    // The box stands over x and z from −0.5 to 0.5; the second sun moves its shadow by its height, to −1 … −2.5.
    for (point, first, second) in [
        ([0.0, 0.0, 0.45], PixelLabel::Shadow, PixelLabel::Lit),
        ([0.7, 0.0, 0.0], PixelLabel::Lit, PixelLabel::Lit),
        ([-1.5, 0.0, 0.0], PixelLabel::Lit, PixelLabel::Shadow),
        ([-2.7, 0.0, 0.0], PixelLabel::Lit, PixelLabel::Lit),
        ([0.0, 2.0, 0.0], PixelLabel::Lit, PixelLabel::Lit),
    ] {
        frame.at_point(point).agrees().label(0, first).label(1, second);
    }
    assert_eq!(frame.pixel_of([0.0, 0.5, 0.0]), Some([48, 36]), "what the eye is turned to is in the middle");
    assert_eq!(frame.pixel_of([0.0, 20.0, 20.0]), None, "behind the eye");
    assert_eq!(frame.pixel_of([9.0, 0.0, 0.0]), None, "beside the picture");
}

/// The plane of the floor is seen at a small angle: a pixel of it is as long as a metre.
#[test]
fn a_point_of_a_surface_that_is_seen_at_a_small_angle_is_not_taken_for_hidden() {
    let mut low = scene();
    low.camera.eye = DVec3::new(0.0, 0.3, 9.0);
    low.camera.target = DVec3::new(0.0, 0.0, -30.0);
    low.objects[0] = square("floor", 0.0, 60.0);
    let request = CaptureRequest::new(Choice::new(Technique::ZFail), SIZE);
    let mut frame = Rendered::on(session(), &low, &request).expect("a frame");
    for step in 0..40 {
        frame.at_point([1.0, 0.0, 4.0 - f64::from(step)]);
    }
}

#[test]
fn assertions_on_passes_distinguish_lights() {
    let mut frame = rendered(Technique::ZFail);
    let below = frame.at_point([0.0, 0.0, 0.45]);
    below.stencil_of(0, "volumes", 2).stencil_of(1, "volumes", 0).stencil_after("ambient", 0);
    let all = below.history();
    let of = |light: usize| -> Vec<String> {
        let is_of = |pass: usize| frame_light(&scene(), pass) == Some(light);
        all.events
            .iter()
            .filter(|one| one.pass_name == "volumes" && is_of(one.pass))
            .map(|one| all.brief(one))
            .collect()
    };
    let [first, second] = [of(0), of(1)];
    assert!(!first.is_empty() && first != second, "{first:?}, {second:?}");
    for (light, events) in [(0, &first), (1, &second)] {
        let expected: Vec<&str> = events.iter().map(String::as_str).collect();
        below.events_of_light(light, "volumes", &expected);
    }
}

/// The light of a pass of z-fail: ambient, then volumes, mask and light of each.
fn frame_light(scene: &Scene, pass: usize) -> Option<usize> {
    let light = pass.checked_sub(1)? / 3;
    (light < scene.lights.len()).then_some(light)
}

#[test]
fn a_shadow_map_is_asserted_on_in_metres() {
    let mut frame = rendered(Technique::ShadowMap);
    // The top of the box is two metres nearer to the sun above than the floor.
    frame.at_point([0.0, 0.0, 0.45]).map_gap(0, 2.0, 0.01);
    frame.at_point([0.3, 2.0, 0.3]).map_gap(0, 0.0, 0.01);
    let texel = frame.map_texel_of(0, [0.0, 0.0, 0.45]).expect("the map shows it");
    assert!((texel.gap.expect("metres") - 2.0).abs() < 0.01, "{texel:?}");
    let top = frame.map_texel_of(0, [0.0, 2.0, 0.45]).expect("the map shows it");
    assert_eq!((top.face, top.texel), (texel.face, texel.texel), "one is above the other");
    assert!(top.gap.expect("metres").abs() < 0.01, "{top:?}");
    assert_eq!(frame.map_texel_of(0, [500.0, 0.0, 0.0]), None);
    assert_eq!(frame.map_texel_of(2, [0.0; 3]), None);
}

#[test]
fn whatever_fails_says_why_at_the_line_of_the_test() {
    let mut frame = rendered(Technique::ZFail);
    let said = failure(line!(), || _ = frame.at_point([0.0, 0.0, 0.45]).stencil_of(0, "volums", 1));
    assert!(said.contains("no pass of light 1 is called `volums`: there are volumes, light"), "{said}");
    let said = failure(line!(), || _ = frame.at([1, 1]).stencil_after("volums", 1));
    let there = "there are ambient, volumes of light 1, light of light 1, volumes of light 2, light of light 2";
    assert!(said.contains(there), "{said}");
    let said = failure(line!(), || _ = frame.at([1, 1]).stencil_of(2, "volumes", 1));
    assert!(said.contains("no pass of light 3 is called `volumes`: there are none"), "{said}");
    let said = failure(line!(), || _ = frame.at([1, 1]).stencil_after("volumes", 0));
    assert!(said.contains("several lights have a pass `volumes`") && said.contains("`stencil_of`"), "{said}");
    let said = failure(line!(), || _ = frame.at([1, 1]).events_of("volumes", &[]));
    assert!(said.contains("`events_of_light`"), "{said}");
    let said = failure(line!(), || _ = frame.at([1, 1]).events_of_light(0, "volums", &[]));
    assert!(said.contains("no pass of light 1"), "{said}");
    let said = failure(line!(), || _ = frame.at_point([0.0, 1.5, 0.0]));
    assert!(said.contains("the point [0, 1.5, 0] is") && said.contains("behind a surface"), "{said}");
    let said = failure(line!(), || _ = frame.at_point([90.0, 0.0, 0.0]));
    assert!(said.contains("the point [90, 0, 0] is outside of the picture"), "{said}");
    let said = failure(line!(), || _ = frame.at([1, 1]).map_gap(0, 0.0, 0.1));
    assert!(said.contains("no shadow map of light 1 shows the surface"), "{said}");
    let said = failure(line!(), || _ = frame.at([96, 0]));
    assert!(said.contains("outside the picture of 96x72"), "{said}");
    let mut mapped = rendered(Technique::ShadowMap);
    let said = failure(line!(), || _ = mapped.at_point([0.3, 2.0, 0.3]).map_gap(0, 2.0, 0.1));
    assert!(said.contains("nearer to the light than the surface, not 2 m (give or take 0.1)"), "{said}");
}
