//! Lamps whose light ends somewhere: what lies beyond is left out.

use super::{assert_decides, auto, labels, left_out, looking};
use crate::common::{cuboid, judged, request_with, session, under};
use glam::DVec3;
use stencilscope::capture::Capture;
use stencilscope::plan::{Decision, FramePlan};
use stencilscope::scene::{Light, Scene};
use stencilscope::technique::Technique;
use stencilscope::truth::{FACES_AWAY, LIT, SHADOW};

/// A lamp that reaches `range` metres, above a box on the floor, seen from above.
fn lamp(range: f64) -> Scene {
    let lamp = Light { range: Some(range), ..Light::point(DVec3::new(1.0, 3.0, 0.0)) };
    under(lamp, vec![cuboid("box", [-0.5, 0.0, -0.5], [0.5, 1.0, 0.5])])
}

fn scissors(plan: &FramePlan) -> Vec<(String, Option<[u32; 4]>)> {
    plan.passes.iter().map(|pass| (pass.name.clone(), pass.scissor)).collect()
}

fn count(capture: &Capture, label: u8) -> usize {
    labels(capture)[0].iter().filter(|other| **other == label).count()
}

#[test]
fn passes_of_a_lamp_are_cut_to_its_range() {
    let what = "pixels out of reach of light 1";
    // The whole view is within 40 m.
    assert_decides(Decision::Scissor, what, &lamp(4.0), &lamp(40.0));
    let mut session = session();
    let plan = session.plan(&lamp(4.0), &auto("all")).expect("a plan");
    for (name, scissor) in scissors(&plan) {
        assert_eq!(scissor.is_some(), ["volumes", "light"].contains(&name.as_str()), "{name}");
    }
    // Circles of radius √(4² − 3²) on the floor, 10 m below an eye that sees 10 m up and down.
    let capture = session.capture(&lamp(4.0), &auto("all")).expect("a capture");
    let reached = (count(&capture, LIT) + count(&capture, SHADOW)) as f64;
    let area = std::f64::consts::PI * 7.0 * (3.6_f64 * 3.6);
    assert!((reached / area - 1.0).abs() < 0.1, "{reached} of {area}");
    assert!(count(&capture, SHADOW) > 5 && count(&capture, FACES_AWAY) > 5000);
}

/// Every counting technique, with and without the cut, says the same, and the truth agrees.
#[test]
fn all_volumes_are_right_within_a_range() {
    let mut session = session();
    let mut with = |technique, leave_out: &str| {
        let request = request_with(technique, &[("leave-out", leave_out)], super::SIZE);
        labels(&session.capture(&lamp(4.0), &request).expect("a capture"))
    };
    for technique in [Technique::ZPass, Technique::ZFail, Technique::ZPassPlus, Technique::Auto] {
        assert!(with(technique, "all") == with(technique, "none"), "{technique:?}");
    }
    for technique in [Technique::ZPass, Technique::ZFail, Technique::ZPassPlus, Technique::ShadowMap] {
        let capture = judged(&mut session, &lamp(4.0), technique, super::SIZE);
        let error = capture.lights[0].truth.as_ref().expect("a truth").error;
        assert!(error.compared > 200 && error.compared < 400, "{technique:?}: {error:?}");
        assert_eq!(error.wrong(), 0, "{technique:?}: {error:?}");
    }
}

#[test]
fn a_caster_beyond_the_range_casts_nothing() {
    let beside = |x: f64| {
        let mut scene = lamp(4.0);
        scene.objects.push(cuboid("far box", [x, 0.0, -0.5], [x + 1.0, 2.5, 0.5]));
        scene
    };
    // Its nearest corner is 4 m away at x = 4.97, but for 0.5 m of height.
    assert_decides(Decision::Caster, "volume of far box", &beside(5.1), &beside(4.5));
}

#[test]
fn a_lamp_that_reaches_nothing_in_view_has_no_passes() {
    let behind = |z: f64| {
        let mut scene = looking(lamp(4.0), [0.0, 2.0, 8.0], [0.0, 1.0, 0.0]);
        scene.lights[0].position.z = z;
        scene
    };
    let mut session = session();
    let what = "all passes of light 1".to_owned();
    assert!(left_out(&mut session, &behind(14.0)).contains(&what));
    assert!(!left_out(&mut session, &behind(10.0)).contains(&what));
}

/// A pixel outside of the cut has no fragments of these passes, and its history agrees with the GPU.
#[test]
fn the_history_of_a_pixel_out_of_reach_agrees() {
    let mut session = session();
    let (capture, plan) = session.capture_with_plan(&lamp(4.0), &auto("all")).expect("a capture");
    for pixel in [[2, 2], [48, 36], [54, 36], [90, 40]] {
        let history = session.history(&plan, &capture, pixel).expect("a history");
        assert!(history.agrees(), "{pixel:?}");
    }
}
