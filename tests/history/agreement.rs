//! What the events make against what the GPU stored, and tampered histories.

use super::{SIZE, frame, nested_boxes};
use crate::common::random::Random;
use crate::common::{opened, session};
use stencilscope::history::{PixelHistory, TriangleEvent};
use stencilscope::plan::DrawPart;
use stencilscope::scene::Scene;
use stencilscope::session::Session;
use stencilscope::technique::Technique;
use stencilscope::truth::Tracer;

/// Histories of random pixels, every one of which must agree with the GPU; how many of them have
/// two or more events of volumes or of flattened casters.
fn agreeing(
    session: &mut Session,
    scene: &Scene,
    technique: Technique,
    settings: &[(&str, &str)],
    pixels: usize,
) -> usize {
    const PICTURE: [u32; 2] = [320, 240];
    let (capture, plan) = frame(session, scene, technique, settings, PICTURE);
    let mut random = Random::new(7);
    let mut with_volumes = 0;
    for _ in 0..pixels {
        let at = PICTURE.map(|pixels| (random.unit() * f64::from(pixels)) as u32);
        let history = session.history(&plan, &capture, at).expect("a history");
        let what = format!("{} {technique:?} {settings:?}", scene.name);
        assert!(history.agrees(), "{what}: {:?}\n{}", history.disagreements(), history.story(&capture.depth));
        assert_eq!(history.computed.stored(), history.captured.expect("a picture"), "{what}");
        let is_flattened = |one: &TriangleEvent| one.part == DrawPart::PlanarShadow;
        let shadows = history.triangles().filter(|(event, one)| event.is_of_volume() || is_flattened(one));
        with_volumes += usize::from(shadows.count() >= 2);
    }
    with_volumes
}

#[test]
fn two_hundred_pixels_of_each_scene_agree_by_volumes_and_by_flattening() {
    let mut session = session();
    for name in ["tori", "inside", "gate"] {
        let scene = opened(name);
        for technique in [Technique::ZPass, Technique::ZFail, Technique::ZPassPlus, Technique::Planar] {
            // Both sides of each caster on every facet that can be marked: pixels have more to agree about.
            let all: &[(&str, &str)] = &[("receivers", "all"), ("leave-out", "none")];
            let settings = if technique == Technique::Planar { all } else { &[] };
            let with_volumes = agreeing(&mut session, &scene, technique, settings, 200);
            assert!(with_volumes >= 50, "{name} {technique:?}: {with_volumes}");
        }
    }
}

/// Whichever triangles a pass leaves out, those that it draws are called as in the object's mesh: as rays find them.
#[test]
fn triangles_of_surfaces_have_their_numbers_in_the_objects_mesh() {
    const PICTURE: [u32; 2] = [160, 120];
    let mut session = session();
    let mut renumbered = 0;
    for (name, technique) in [("tori", Technique::Auto), ("tori", Technique::ZFail), ("two-lights", Technique::Auto)] {
        let scene = opened(name);
        let tracer = Tracer::new(&scene, PICTURE).expect("a tracer");
        let (capture, plan) = frame(&mut session, &scene, technique, &[], PICTURE);
        let mut random = Random::new(11);
        for _ in 0..80 {
            let at = PICTURE.map(|pixels| (random.unit() * f64::from(pixels)) as u32);
            let [seen] = tracer.visible_at([at.map(|pixel| f64::from(pixel) + 0.5)]);
            let Some(seen) = seen else { continue };
            let history = session.history(&plan, &capture, at).expect("a history");
            for (event, one) in history.triangles().filter(|(_, one)| one.part == DrawPart::Surface) {
                // What was drawn first may have been hidden after it.
                let is_shown = one.outcome.passed() && event.light.is_some();
                if is_shown && one.caster.as_deref() == Some(scene.objects[seen.object].name.as_str()) {
                    assert_eq!(one.source_triangle, seen.triangle as u32, "{name} {technique:?} {at:?}: {event:?}");
                    renumbered += usize::from(one.triangle != one.source_triangle);
                }
            }
        }
    }
    assert!(renumbered > 30, "{renumbered}");
}

/// A scene, a technique and its settings.
type Form = (&'static str, Technique, &'static [(&'static str, &'static str)]);

#[test]
fn pixels_agree_by_every_technique_and_setting_that_draws_otherwise() {
    let mut session = session();
    let forms: &[Form] = &[
        ("rings", Technique::Planar, &[]),
        ("table", Technique::Planar, &[("blend", "opaque")]),
        ("table", Technique::Planar, &[("z-fighting", "polygon-offset")]),
        ("table", Technique::Planar, &[("z-fighting", "none"), ("blend", "twice"), ("stencil", "off")]),
        ("table", Technique::PlanarTexture, &[]),
        ("tori", Technique::ShadowMap, &[]),
        ("tori", Technique::Projective, &[("passes", "multi")]),
        ("tori", Technique::RayTraced, &[]),
        ("glass", Technique::None, &[]),
        ("two-lights", Technique::ZFail, &[]),
        ("two-lights", Technique::ZPassPlus, &[("counter", "float")]),
        ("gate", Technique::ZFail, &[("counter", "float")]),
        ("inside", Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass")]),
        ("steps", Technique::ZFail, &[("depth", "standard-infinite")]),
        ("steps", Technique::ZFail, &[("depth", "standard-finite")]),
        ("steps", Technique::ZFail, &[("depth", "standard-finite-clamp")]),
        ("steps", Technique::ZPassPlus, &[("depth", "standard-infinite-epsilon"), ("extrusion", "finite:20")]),
        ("tiger-cage", Technique::ZFail, &[("light-caps", "never")]),
        ("inside", Technique::ZFail, &[("extruded-by", "vertex-shader")]),
        ("teapot-like", Technique::ZPass, &[("extruded-by", "vertex-shader")]),
        ("gate", Technique::ZFail, &[("extruded-by", "vertex-shader"), ("counter", "float")]),
        ("steps", Technique::ZFail, &[("extruded-by", "vertex-shader"), ("extrusion", "finite:20")]),
    ];
    for (name, technique, settings) in forms {
        agreeing(&mut session, &opened(name), *technique, settings, 30);
    }
}

/// Depths of fewer bits are floored before every test, those of volumes and of the pass that writes labels too: what a
/// history floors on the CPU is what the GPU stored, of a log's fragments and of those that the CPU rasterises.
#[test]
fn pixels_agree_where_depths_have_fewer_bits() {
    let mut session = session();
    let mut random = Random::new(53);
    let forms: [(Technique, &[(&str, &str)]); 5] = [
        (Technique::Auto, &[]),
        (Technique::ZPass, &[]),
        (Technique::ZFail, &[("counter", "float")]),
        (Technique::Planar, &[("z-fighting", "polygon-offset")]),
        (Technique::ShadowMap, &[]),
    ];
    let mut with_volumes = 0;
    for builtin in stencilscope::scene::builtin::ALL {
        let scene = builtin.scene().expect("a scene");
        for (index, (technique, settings)) in forms.into_iter().enumerate() {
            let bits = if (index + with_volumes) % 2 == 0 { "16" } else { "24" };
            let settings = [settings, &[("depth-bits", bits)]].concat();
            with_volumes += agreeing(&mut session, &scene, technique, &settings, 8);
            let (capture, plan) = frame(&mut session, &scene, technique, &settings, [80, 60]);
            for _ in 0..8 {
                let at = [80, 60].map(|pixels| (random.unit() * f64::from(pixels)) as u32);
                let history = PixelHistory::without_gpu(&plan, &capture, at);
                let what = format!("{} {technique:?} {settings:?} at {at:?}", scene.name);
                assert!(history.agrees(), "{what}: {:?}", history.disagreements());
            }
        }
    }
    assert!(with_volumes > 100, "{with_volumes}");
}

/// Not a sample: edges, corners and the background too.
#[test]
fn every_pixel_of_a_small_picture_agrees() {
    let mut session = session();
    let size = [32, 24];
    let (capture, plan) = frame(&mut session, &opened("tetrahedron"), Technique::ZFail, &[], size);
    for at in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y])) {
        let history = session.history(&plan, &capture, at).expect("a history");
        assert!(history.agrees(), "{:?}\n{}", history.disagreements(), history.story(&capture.depth));
    }
}

fn history_of_nested_boxes() -> PixelHistory {
    let mut session = session();
    let (capture, plan) = frame(&mut session, &nested_boxes(), Technique::ZFail, &[("casters", "all")], SIZE);
    session.history(&plan, &capture, [103, 95]).expect("a history")
}

#[test]
fn a_history_with_an_event_dropped_doubled_or_swapped_does_not_agree() {
    let whole = history_of_nested_boxes();
    assert!(whole.agrees() && whole.events.len() == 18);
    for index in 0..whole.events.len() {
        let mut dropped = whole.clone();
        dropped.events.remove(index);
        assert!(!dropped.agrees(), "without event {index}");
        let mut doubled = whole.clone();
        doubled.events.insert(index, whole.events[index].clone());
        assert!(!doubled.agrees(), "event {index} twice");
        let other = (index + 1) % whole.events.len();
        let mut swapped = whole.clone();
        swapped.events.swap(index, other);
        assert!(!swapped.agrees(), "events {index} and {other} swapped");
    }
}

#[test]
fn a_value_that_the_gpu_did_not_store_is_found_out() {
    let whole = history_of_nested_boxes();
    let mut depth = whole.clone();
    let last = depth.captured_after.last_mut().expect("a pass");
    last.stored.depth = f32::from_bits(last.stored.depth.to_bits() + 1);
    assert!(!depth.agrees(), "one bit of depth");
    let mut stencil = whole.clone();
    stencil.captured_after[1].stored.stencil ^= 1;
    assert!(!stencil.agrees(), "a stencil in the middle of the frame");
}
