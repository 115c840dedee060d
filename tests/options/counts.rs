//! Counts beyond eight bits, in a float target.

use super::{brightness, capture, request};
use crate::common::{
    adapter, from_above, judged, judged_by, label_counts, opened, session, square, stencil_before_mask,
};
use glam::DVec3;
use std::sync::Arc;
use stencilscope::capture::{Capture, Image, Snapshot};
use stencilscope::plan::Decision;
use stencilscope::scene::shapes;
use stencilscope::scene::{Light, Material, Object, Scene};
use stencilscope::technique::Technique;

const VOLUMES: [Technique; 3] = [Technique::ZPass, Technique::ZFail, Technique::ZPassPlus];
const FLOAT: [(&str, &str); 1] = [("counter", "float")];

fn counts(capture: &Capture) -> Vec<f32> {
    let count: &Arc<Image> = capture.lights[0].count.as_ref().expect("a count");
    count.rows().flat_map(bytemuck::pod_collect_to_vec::<u8, f32>).collect()
}

/// An open, twisted caster with the eye outside and inside its volume, drawn and undrawn, and a sun.
fn scenes() -> Vec<Scene> {
    let torus = shapes::torus(1.0, 0.4, 20, 10).expect("a torus");
    let mut scenes = Vec::new();
    for (eye, visible, light) in [
        (10.0, true, Light::point(DVec3::new(0.3, 4.0, 0.2))),
        (0.9, true, Light::point(DVec3::new(0.3, 4.0, 0.2))),
        (10.0, false, Light::point(DVec3::new(0.3, 4.0, 0.2))),
        (10.0, true, Light::directional(DVec3::new(0.3, 1.0, 0.1))),
    ] {
        let mut caster = Object::new("torus", Arc::new(torus.clone()), Material::default());
        caster.pose.translate.y = 2.0;
        caster.pose.rotate_degrees.x = 25.0;
        caster.visible = visible;
        let mut scene = from_above(vec![caster, square("plate", 1.5, 0.7)]);
        scene.camera.eye.y = eye;
        scene.lights = vec![light];
        scenes.push(scene);
    }
    scenes
}

/// A tile of 40 × 40 pixels in the floor's plane, where depths tie: the lamp's light is there twice, and no label differs.
#[test]
fn surfaces_in_one_plane_are_lit_each_where_nothing_guards_the_light() {
    let mut session = session();
    let mut scene = from_above(vec![square("tile", 0.0, 2.0)]);
    scene.lights[0].color = [0.3; 3];
    for technique in VOLUMES {
        let mut of = |relight| capture(&mut session, &scene, technique, &[("relight", relight)]);
        let [guarded, unguarded] = ["guarded", "unguarded"].map(&mut of);
        assert_eq!(guarded.lights[0].shadow, unguarded.lights[0].shadow, "{technique:?}");
        let pairs = brightness(&guarded).into_iter().zip(brightness(&unguarded));
        assert_eq!(pairs.filter(|(once, twice)| *twice > once * 1.3).count(), 1600, "{technique:?}");
    }
}

#[test]
fn a_float_counts_what_the_stencil_counts() {
    let mut session = session();
    for scene in scenes() {
        for technique in VOLUMES {
            for extra in [&[][..], &[("extrusion", "finite:3")], &[("light-caps", "never")]] {
                let in_stencil = capture(&mut session, &scene, technique, extra);
                let in_float = capture(&mut session, &scene, technique, &[&FLOAT[..], extra].concat());
                let counted: Vec<u8> = counts(&in_float).iter().map(|count| *count as i32 as u8).collect();
                assert!(counted == stencil_before_mask(&in_stencil), "{technique:?} {extra:?}");
                assert_eq!(in_float.lights[0].shadow, in_stencil.lights[0].shadow, "{technique:?} {extra:?}");
            }
        }
    }
}

#[test]
fn no_stencil_is_stored_where_a_float_counts() {
    let found = capture(&mut session(), &scenes()[0], Technique::ZFail, &FLOAT);
    let has_stencil = |snapshot: &Snapshot| matches!(snapshot, Snapshot::Frame(frame) if frame.stencil.is_some());
    assert!(found.steps.iter().any(|step| step.name == "volumes"), "volumes were counted");
    assert!(found.steps.iter().all(|step| !has_stencil(&step.snapshot)));
    assert!(found.left_out.iter().any(|left| left.decision == Some(Decision::Stencil)));
}

/// Behind 256 closed shells, each of which counts one: that reads 0 in eight bits.
#[test]
fn counts_of_256_are_right_in_a_float_and_noticed_where_the_stencil_wraps() {
    let mut session = session();
    let gate = opened("gate");
    let size = [160, 120];
    let wrapped = judged(&mut session, &gate, Technique::ZFail, size);
    let error = wrapped.error().expect("an error");
    assert!(error.missing_shadow > 500 && error.false_shadow == 0, "{error:?}");
    let noticed = wrapped.lights[0].wrapped_pixels().expect("counts");
    // Some of those at edges are excused, and wrap all the same.
    let excused = noticed - error.missing_shadow;
    assert!(excused <= error.edge_band && (excused == error.edge_band || !adapter::draws_as_given()), "{error:?}");
    assert!(counts(&wrapped).contains(&300.0), "the count goes on beyond 256");
    for technique in [Technique::ZFail, Technique::ZPass] {
        let request = request(technique, &FLOAT);
        let counted = judged_by(&mut session, &gate, &request);
        adapter::assert_right(&mut session, &gate, &request, &counted, &technique.name());
    }
}

#[test]
fn what_a_float_can_not_do_is_said() {
    let mut session = session();
    let scene = from_above(vec![square("caster", 2.0, 1.0)]);
    let settings = [("counter", "float"), ("faces", "two-pass"), ("operations", "clamp")];
    let found = capture(&mut session, &scene, Technique::ZFail, &settings);
    assert_eq!(label_counts(&found)[1], 975);
    assert!(found.left_out.iter().any(|left| left.decision == Some(Decision::TwoPasses)));
}
