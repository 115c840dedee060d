//! Cameras whose lines of sight are parallel: every volume counted right, from anywhere.

use crate::common::{cuboid, from_above, request, session};
use stencilscope::capture::{Capture, CapturedLight};
use stencilscope::progress::Progress;
use stencilscope::scene::{Camera, Light, Projection, Scene, builtin};
use stencilscope::session::Session;
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [64, 48];
const PLACES: u64 = 10;

/// An orthographic and a cabinet camera that show the target as large as a pinhole does.
fn parallel(camera: Camera) -> [Camera; 2] {
    let half_height = camera.half_height_at_target();
    let cabinet = Projection::Oblique { half_height, angle_degrees: 45.0, factor: Projection::CABINET };
    [Projection::Orthographic { half_height }, cabinet].map(|projection| Camera { projection, ..camera })
}

fn wrong(judged: &Capture) -> u64 {
    judged.lights.iter().filter_map(|light| light.truth.as_ref()).map(|truth| truth.error.wrong()).sum()
}

fn seen_by(scene: &Scene, camera: Camera) -> Scene {
    Scene { camera, ..scene.clone() }
}

/// Pixels that z-fail or `auto` has wrong. The truth is asked once: where both say the same, it is of both.
fn faults(session: &mut Session, scene: &Scene) -> Vec<String> {
    // Counts of 256 read as none in eight bits, which is no matter here.
    let mut z_fail = request(Technique::ZFail, SIZE);
    z_fail.choice.set("counter", "float").expect("a setting");
    let counted = session.capture(scene, &z_fail).expect("a capture");
    let auto = session.capture(scene, &request(Technique::Auto, SIZE)).expect("a capture");
    let is_same = labels(&counted) == labels(&auto);
    let both = [("z-fail", counted), ("auto", auto)];
    let judged = both.into_iter().take(if is_same { 1 } else { 2 }).filter_map(|(name, capture)| {
        let wrong = wrong(&session.judged(scene, &capture, &Progress::default()).expect("a truth"));
        let projection = scene.camera.projection.name();
        (wrong > 0).then(|| format!("{}, {projection}: {name} has {wrong} wrong", scene.name))
    });
    judged.collect()
}

fn labels(capture: &Capture) -> Vec<Vec<u8>> {
    let of = |light: &CapturedLight| light.shadow.as_ref().expect("labels").rows().flatten().copied().collect();
    capture.lights.iter().map(of).collect()
}

#[test]
fn auto_and_z_fail_have_no_wrong_pixel_on_any_scene_from_anywhere() {
    let mut session = session();
    let mut all = Vec::new();
    for builtin in builtin::ALL {
        let scene = builtin.scene().expect("a scene");
        for seed in 0..PLACES {
            for camera in parallel(scene.camera.anywhere(seed)) {
                let found = faults(&mut session, &seen_by(&scene, camera));
                all.extend(found.into_iter().map(|fault| format!("from {seed}, {fault}")));
            }
        }
    }
    assert!(all.is_empty(), "{all:#?}");
}

/// Straight down on edges, corners and diagonals that lie right under the light, or under the sun that the view
/// follows: nobody can tell in single precision on which side the light's own ray passes them.
#[test]
fn edges_seen_end_on_under_the_light_are_no_matter() {
    let mut session = session();
    let boxes = [
        ("its diagonal", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0]),
        ("an edge", [0.0, 1.0, -1.0], [1.0, 2.0, 1.0]),
        ("a corner", [0.0, 1.0, 0.0], [1.0, 2.0, 1.0]),
        ("an edge, all but a hair", [1e-9, 1.0, -1.0], [1.0, 2.0, 1.0]),
        ("a corner, all but a hair", [-1e-7, 1.0, 1e-8], [1.0, 2.0, 1.0]),
        ("beside it", [0.3, 1.0, 0.2], [1.0, 2.0, 1.0]),
        ("over it", [-1.0, 5.0, 0.0], [0.0, 6.0, 1.0]),
        ("around it", [-1.0, 3.0, -1.0], [1.0, 5.0, 1.0]),
        ("into the floor", [0.0, -1.0, 0.0], [1.0, 1.0, 1.0]),
    ];
    for (what, low, high) in boxes {
        for light in [Light::point([0.0, 4.0, 0.0]), Light::directional([0.0, 1.0, 0.0])] {
            let scene = Scene { lights: vec![light.clone()], ..from_above(vec![cuboid("box", low, high)]) };
            let pinhole = Camera { projection: Projection::Perspective, ..scene.camera };
            let projections = [
                Projection::Orthographic { half_height: 2.5 },
                Projection::Oblique { half_height: 2.5, angle_degrees: 45.0, factor: 0.5 },
                Projection::Oblique { half_height: 2.5, angle_degrees: 90.0, factor: 1.0 },
            ];
            for projection in projections {
                let found = faults(&mut session, &seen_by(&scene, Camera { projection, ..pinhole }));
                assert!(found.is_empty(), "{what}, {light:?}: {found:?}");
            }
        }
    }
}
