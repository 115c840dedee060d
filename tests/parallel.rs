//! Cameras whose lines of sight are parallel: every volume counted right, from anywhere.

use crate::common::{judged, session};
use stencilscope::capture::Capture;
use stencilscope::scene::{Camera, Projection, Scene, builtin};
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

/// Wrong pixels of techniques at every place.
fn faults(session: &mut Session, scene: &Scene, techniques: &[Technique]) -> Vec<String> {
    let mut faults = Vec::new();
    for seed in 0..PLACES {
        for camera in parallel(scene.camera.anywhere(seed)) {
            let scene = seen_by(scene, camera);
            for technique in techniques {
                let capture = judged(session, &scene, *technique, SIZE);
                if wrong(&capture) > 0 {
                    faults.push(format!(
                        "{} from {seed}, {}: {} has {} wrong",
                        scene.name,
                        camera.projection.name(),
                        technique.name(),
                        wrong(&capture)
                    ));
                }
            }
        }
    }
    faults
}

#[test]
fn auto_and_z_fail_have_no_wrong_pixel_on_any_scene_from_anywhere() {
    let mut session = session();
    let mut all = Vec::new();
    for builtin in builtin::ALL {
        let scene = builtin.scene().expect("a scene");
        all.extend(faults(&mut session, &scene, &[Technique::Auto, Technique::ZFail]));
    }
    assert!(all.is_empty(), "{all:#?}");
}
