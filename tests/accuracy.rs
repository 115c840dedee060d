//! Techniques against the ground truth: the robust one has no wrong pixel anywhere, the others
//! are wrong where they must be, and a wrong answer can't pass.

use crate::common::random::Random;
use crate::common::{cuboid, from_above, label_counts, request, session, square};
use glam::DVec3;
use std::sync::Arc;
use stencilscope::accuracy::{Accuracy, ErrorCounts, Finding, compare};
use stencilscope::capture::Capture;
use stencilscope::progress::Progress;
use stencilscope::scene::{Light, MeshBuilder, OpenSpec, Scene, open};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::Technique;
use stencilscope::truth::Tracer;

const SIZE: [u32; 2] = [96, 72];

fn named(name: &str) -> Scene {
    open(&OpenSpec::new(name)).expect("a scene")
}

fn judged(session: &mut Session, scene: &Scene, request: &CaptureRequest) -> Capture {
    let mut capture = session.capture(scene, request).expect("a capture");
    session.judge(scene, &mut capture, &Progress::default()).expect("a truth");
    capture
}

/// The knot, torn: triangles are missing, some are turned round and some are there twice.
fn torn_knot() -> Scene {
    let mut scene = named("assets/models/knot.obj");
    let mesh = &scene.objects[0].mesh;
    let mut triangles = Vec::new();
    for (index, [a, b, c]) in mesh.triangles().iter().enumerate() {
        match index % 13 {
            0 => {}
            1..=3 => triangles.push([*a, *c, *b]),
            4 => triangles.extend([[*a, *b, *c], [*b, *c, *a]]),
            _ => triangles.push([*a, *b, *c]),
        }
    }
    let builder = MeshBuilder { positions: mesh.positions().to_vec(), triangles, ..MeshBuilder::default() };
    scene.objects[0].mesh = Arc::new(builder.build().expect("a mesh"));
    scene
}

/// The same scene from somewhere else under another light: around what is looked at, near and
/// far, the light sometimes a direction, sometimes among the objects.
fn seen_from_anywhere(scene: &Scene, random: &mut Random) -> Scene {
    let mut scene = scene.clone();
    let camera = &mut scene.camera;
    let reach = (camera.eye - camera.target).length();
    let height = random.unit() * 0.9 + 0.1;
    let around = random.within(1.0).with_y(height).normalize();
    camera.eye = camera.target + around * reach * (0.3 + random.unit());
    camera.near = reach * (0.002 + 0.1 * random.unit());
    let height = random.unit() + 0.2;
    let towards = random.within(1.0).with_y(height);
    scene.lights = vec![if random.unit() < 0.3 {
        Light::directional(towards)
    } else {
        Light::point(camera.target + towards * reach * (0.2 + random.unit()))
    }];
    scene
}

#[test]
fn z_fail_has_no_wrong_pixel_on_any_scene_from_anywhere() {
    let mut session = session();
    let scenes = [named("assets/models/knot.obj"), torn_knot(), named("tori"), named("table")];
    for scene in &scenes {
        let mut random = Random::new(5);
        let mut labels = [0; 4];
        for view in 0..10 {
            let scene = seen_from_anywhere(scene, &mut random);
            let capture = judged(&mut session, &scene, &request(Technique::ZFail, SIZE));
            let error = capture.error().expect("judged");
            assert_eq!(error.wrong(), 0, "{}, view {view}: {error:?} {:?}", scene.name, scene.camera);
            let truth = &capture.lights[0].truth.as_ref().expect("judged").labels;
            (0..4).for_each(|label| labels[label] += truth.histogram()[label]);
        }
        assert!(labels[0] >= 500 && labels[1] >= 500, "{}: {labels:?}", scene.name);
    }
}
