//! Maps and textures that stay from frame to frame.

use super::{labels, picture};
use crate::common::{cuboid, from_above, request_with, session};
use glam::DVec3;
use stencilscope::capture::{Capture, Snapshot};
use stencilscope::plan::Decision;
use stencilscope::scene::Scene;
use stencilscope::session::{CaptureRequest, Session, SnapshotInterval};
use stencilscope::technique::Technique;

fn scene() -> Scene {
    from_above(vec![cuboid("box", [-0.5, 1.0, -0.5], [0.5, 2.0, 0.5])])
}

fn asked(technique: Technique, redraw: &str) -> CaptureRequest {
    request_with(technique, &[("redraw", redraw)], [96, 72])
}

fn maps(capture: &Capture) -> Vec<Vec<u8>> {
    let faces = capture.lights.iter().filter_map(|light| light.map.as_ref()).flat_map(|map| &map.faces);
    faces.map(|face| face.rows().flatten().copied().collect()).collect()
}

/// Passes that were not run since their map is there.
fn cached_passes(capture: &Capture) -> usize {
    capture.left_out.iter().filter(|left| left.decision == Some(Decision::Cached)).count()
}

/// How many passes a frame after another skips by the cached map. It is compared with a frame that draws all.
fn cached_passes_after(session: &mut Session, before: &Scene, after: &Scene, technique: Technique) -> usize {
    session.capture(before, &asked(technique, "changed")).expect("a capture");
    let less = session.capture(after, &asked(technique, "changed")).expect("a capture");
    let whole = session.capture(after, &asked(technique, "always")).expect("a capture");
    assert_eq!(cached_passes(&whole), 0);
    assert_eq!(labels(&less), labels(&whole), "{technique:?}");
    assert!(maps(&less) == maps(&whole) && !maps(&whole).is_empty(), "{technique:?}: the map differs");
    assert!(picture(&less) == picture(&whole), "{technique:?}: the picture differs");
    cached_passes(&less)
}

#[test]
fn a_map_is_drawn_again_only_where_what_makes_it_has_changed() {
    let mut session = session();
    let moved = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene();
        change(&mut scene);
        scene
    };
    let caster = moved(&|scene| scene.objects[1].pose.translate.x += 1e-3);
    let light = moved(&|scene| scene.lights[0].position.x += 1e-3);
    let eye = moved(&|scene| {
        scene.camera.eye += DVec3::new(0.5, 0.0, 0.0);
        scene.camera.target += DVec3::new(0.5, 0.0, 0.0);
    });
    for technique in [Technique::ShadowMap, Technique::PlanarTexture, Technique::Projective] {
        let mut after = |scene: &Scene| cached_passes_after(&mut session, &self::scene(), scene, technique);
        assert!(after(&scene()) > 0, "{technique:?}");
        assert_eq!(after(&caster), 0, "{technique:?}: a caster that moved");
        assert_eq!(after(&light), 0, "{technique:?}: a light that moved");
        // A shadow map is made of places about the light, textures of places about the eye.
        assert_eq!(after(&eye) > 0, technique == Technique::ShadowMap, "{technique:?}: an eye that moved");
    }
}

/// Draw by draw, what each leaves in the map is seen, though the map is there already.
#[test]
fn draws_of_a_cached_map_are_distinguished() {
    let mut session = session();
    let mut scene = scene();
    scene.objects.push(cuboid("other", [1.0, 1.0, -0.5], [1.5, 1.5, 0.5]));
    let mut after_draws = |redraw| {
        let request = CaptureRequest { every: SnapshotInterval::Draw, ..asked(Technique::ShadowMap, redraw) };
        session.capture(&scene, &request).expect("a capture");
        let capture = session.capture(&scene, &request).expect("a capture");
        let step =
            capture.steps.iter().find(|step| matches!(step.snapshot, Snapshot::Map { .. }) && step.draws.len() > 1);
        format!("{:?}", step.expect("a map of two casters").draws)
    };
    assert!(after_draws("always") == after_draws("changed"));
}

/// A map that is there already is not drawn, so no sample of it passes: its casters are not left out for that.
#[test]
fn a_cached_map_keeps_its_casters_where_samples_are_counted() {
    let mut session = session();
    for technique in [Technique::ShadowMap, Technique::PlanarTexture, Technique::Projective] {
        let whole = session.capture(&scene(), &asked(technique, "always")).expect("a capture");
        let mut counted = asked(technique, "changed");
        counted.choice.set("occlusion", "queries").expect("a setting");
        for frame in 0..3 {
            let less = session.capture(&scene(), &counted).expect("a capture");
            // The frame that counts samples has drawn the map for the one after it.
            assert!(cached_passes(&less) > 0, "{technique:?}, frame {frame}: the map is drawn again");
            assert!(labels(&less) == labels(&whole), "{technique:?}, frame {frame}: the labels differ");
            assert!(maps(&less) == maps(&whole), "{technique:?}, frame {frame}: the map differs");
            assert!(picture(&less) == picture(&whole), "{technique:?}, frame {frame}: the picture differs");
        }
    }
}
