//! What no sample of the last frame showed, and what a device is not asked for.

use super::{labels, picture};
use crate::common::{cuboid, from_above, request_with, session};
use glam::DVec3;
use stencilscope::capture::Capture;
use stencilscope::plan::Decision;
use stencilscope::scene::{Light, Scene};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [96, 72];

/// A wall before the eye, which looks along −z, and a box behind it, moved aside by `x`; the sun is behind
/// the eye, so that the box's shadow is behind the box.
fn behind_a_wall(x: f64) -> Scene {
    let wall = cuboid("wall", [-1.0, 0.5, 2.0], [1.0, 2.5, 2.2]);
    let hidden = cuboid("hidden", [x - 0.3, 1.2, 0.0], [x + 0.3, 1.8, 0.5]);
    let mut scene = from_above(vec![wall, hidden]);
    scene.camera.eye = DVec3::new(0.0, 1.5, 4.0);
    (scene.camera.target, scene.camera.up) = (DVec3::new(0.0, 1.5, 0.0), DVec3::Y);
    scene.lights = vec![Light::directional(DVec3::new(0.2, 0.3, 1.0))];
    scene
}

fn asked(technique: Technique, settings: &[(&str, &str)]) -> CaptureRequest {
    request_with(technique, settings, SIZE)
}

/// The frame with what the queries left out, compared with the frame without queries.
fn with_queries(session: &mut Session, scene: &Scene, technique: Technique) -> Vec<String> {
    let mut run = |occlusion| {
        let request = asked(technique, &[("leave-out", "none"), ("occlusion", occlusion)]);
        session.capture(scene, &request).expect("a capture")
    };
    let (whole, less): (Capture, Capture) = (run("off"), run("queries"));
    assert_eq!(labels(&whole), labels(&less), "{technique:?}");
    assert!(picture(&whole) == picture(&less), "{technique:?}: the picture differs");
    let count = |capture: &Capture| capture.left_out.len();
    assert!(count(&less) >= count(&whole), "{technique:?}");
    let unseen = less.left_out.iter().filter(|left| left.decision == Some(Decision::Unseen));
    unseen.map(|left| left.to_string()).collect()
}

#[test]
fn what_no_sample_showed_is_left_out_and_nothing_changes() {
    let mut session = session();
    for technique in [Technique::ZPass, Technique::ZFail, Technique::ShadowMap] {
        let unseen = with_queries(&mut session, &behind_a_wall(0.0), technique);
        for of in ["hidden of the pass `ambient`", "hidden of the pass `light`"] {
            assert!(unseen.iter().any(|left| left == of), "{technique:?}: no `{of}` among {unseen:?}");
        }
        // Beside it: a part of the box peeps out.
        let unseen = with_queries(&mut session, &behind_a_wall(1.9), technique);
        assert!(!unseen.iter().any(|left| left.starts_with("hidden of")), "{technique:?}: {unseen:?}");
    }
    // A volume that counts where it passes shows nothing behind a wall; one that counts where it fails is
    // not asked about: it may count all the same.
    let sides = |unseen: &[String]| unseen.iter().any(|left| left == "sides of hidden of the pass `volumes`");
    assert!(sides(&with_queries(&mut session, &behind_a_wall(0.0), Technique::ZPass)));
    assert!(!sides(&with_queries(&mut session, &behind_a_wall(0.0), Technique::ZFail)));
}

/// A device is opened with what every frame uses. What a plan needs beside that is asked for with that plan,
/// and goes on working beside it.
#[test]
fn features_are_asked_for_by_the_plans_that_need_them() {
    let mut session = session();
    let scene = behind_a_wall(0.5);
    let plain = asked(Technique::ZFail, &[]);
    let before = session.capture(&scene, &plain).expect("a capture");
    assert!(session.features().is_empty(), "{:?}", session.features());
    session.capture(&scene, &asked(Technique::ZFail, &[("depth", "standard-finite-clamp")])).expect("a capture");
    assert_eq!(session.features(), ["depth clamping"]);
    session.capture(&scene, &asked(Technique::ZFail, &[("counter", "float")])).expect("a capture");
    assert_eq!(session.features(), ["depth clamping", "blending of 32-bit floats"]);
    let after = session.capture(&scene, &plain).expect("a capture");
    assert!(picture(&before) == picture(&after) && labels(&before) == labels(&after));
}
