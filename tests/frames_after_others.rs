//! A frame is the same whatever was drawn before it, and whatever of it is left out.

use crate::common::{adapter, cuboid, from_above, request_with, session, square};
use glam::DVec3;
use stencilscope::capture::{Capture, Snapshot};
use stencilscope::scene::{Light, Object, Projection, Scene, shapes};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [96, 72];

fn boxes(height: f64) -> Scene {
    let boxes = [-1.5, 1.0].map(|x| cuboid(&format!("box {x}"), [x, height, -0.5], [x + 1.0, height + 0.7, 0.5]));
    let mut scene = from_above(boxes.to_vec());
    scene.lights = vec![Light::point([1.0, 5.0, 0.5]), Light::point([-2.0, 4.0, 1.0])];
    scene
}

fn asked(technique: Technique, settings: &[(&str, &str)]) -> CaptureRequest {
    request_with(technique, settings, SIZE)
}

/// Colour, depth and stencil after every pass, and the labels of each light.
fn left(capture: &Capture) -> Vec<Vec<u8>> {
    let of_step = |snapshot: &Snapshot| match snapshot {
        Snapshot::Frame(frame) => {
            let stencil = frame.stencil.iter().flat_map(|stencil| stencil.image.rows());
            frame.color.image.rows().chain(frame.depth.image.rows()).chain(stencil).flatten().copied().collect()
        }
        Snapshot::Map { .. } => Vec::new(),
    };
    let labels = capture.lights.iter().filter_map(|light| light.shadow.as_ref());
    let labels = labels.map(|labels| labels.rows().flatten().copied().collect());
    capture.steps.iter().map(|step| of_step(&step.snapshot)).chain(labels).collect()
}

/// Textures are handed on from frame to frame, with all that was drawn to them.
#[test]
fn a_frame_shows_nothing_of_the_frame_before() {
    let mut used = session();
    for technique in Technique::ALL {
        let settings: &[&[(&str, &str)]] = match technique {
            Technique::ZFail => &[&[], &[("counter", "float")], &[("leave-out", "none")], &[("stencil-bits", "4")]],
            Technique::Auto => &[&[], &[("leave-out", "none")]],
            _ => &[&[]],
        };
        for settings in settings {
            let request = asked(technique, settings);
            used.capture(&boxes(2.5), &request).expect("the frame before");
            let after = used.capture(&boxes(1.0), &request).expect("a frame");
            let alone = session().capture(&boxes(1.0), &request).expect("a frame");
            assert!(left(&after) == left(&alone), "{technique:?} {settings:?}");
        }
    }
}

/// A picture that is replaced soon is drawn without the triangles that cover no pixel's middle: of these rings, most.
#[test]
fn a_preview_is_the_frame_to_the_last_bit() {
    let ring = |name: &str, minor: f64, at: [f64; 3]| {
        Object::of(name, shapes::torus(0.8, minor, 200, 80).expect("a ring")).at(at)
    };
    let mut scene = boxes(0.5);
    scene.objects.extend([ring("ring", 0.3, [0.2, 0.6, 0.9]), ring("other ring", 0.1, [0.2, 1.4, -0.2])]);
    // Cut off by the side of the picture, and by the near plane.
    scene.objects.push(ring("half a ring", 0.2, [3.4, 0.5, 1.0]));
    scene.objects.push(ring("near ring", 0.05, (scene.camera.eye - DVec3::new(0.3, 0.0, 0.2)).to_array()));
    // Each with maps of its own.
    let [mut of_previews, mut of_frames] = [session(), session()];
    for technique in Technique::ALL {
        let settings: &[&[(&str, &str)]] = match technique {
            Technique::ZFail => {
                &[&[], &[("counter", "float")], &[("casters", "light-facing"), ("extruded-by", "vertex-shader")]]
            }
            Technique::RayTraced => continue,
            _ => &[&[]],
        };
        for (settings, size) in settings.iter().flat_map(|settings| [(settings, SIZE), (settings, [33, 57])]) {
            let request = CaptureRequest { size, ..asked(technique, settings) };
            for turn in 0..2 {
                scene.lights[0].position.x += f64::from(turn) * 0.1;
                let [preview, frame] = [
                    of_previews.preview(scene.clone(), request.clone()).expect("a preview"),
                    of_frames.render(scene.clone(), request.clone()).expect("a frame"),
                ];
                let (preview, frame) = (&*preview.capture, &*frame.capture);
                assert!(left(preview) == left(frame), "{technique:?} {settings:?} {size:?}");
                assert!(preview.lights == frame.lights, "{technique:?} {settings:?} {size:?}: maps and counts");
                assert_eq!(preview.plan_text, frame.plan_text);
                let draws = |capture: &Capture| capture.steps.iter().map(|step| step.draws.clone()).collect::<Vec<_>>();
                assert_eq!(draws(preview), draws(frame));
            }
        }
    }
}

/// What can't show, and what faces away from a light, changes nothing of what counts shadow volumes.
#[test]
fn volumes_are_counted_alike_where_nothing_is_left_out() {
    let mut session: Session = session();
    let eye_in_a_box = {
        let mut scene = boxes(1.0);
        (scene.camera.eye, scene.camera.target) = (DVec3::new(1.5, 1.3, 0.0), DVec3::new(-3.0, 0.0, 0.2));
        scene
    };
    let changed = |change: fn(&mut Scene)| {
        let mut scene = boxes(1.0);
        change(&mut scene);
        scene
    };
    let scenes = [
        boxes(1.0),
        boxes(0.0),
        eye_in_a_box,
        changed(|scene| scene.objects[1].receives = false),
        changed(|scene| scene.objects[1].casts = false),
        changed(|scene| scene.objects[1].visible = false),
        changed(|scene| scene.objects.push(Object { name: "twin".to_owned(), ..scene.objects[1].clone() })),
        changed(|scene| scene.objects.push(square("lid", 2.0, 0.7))),
        changed(|scene| scene.lights[0].position.y = -3.0),
        changed(|scene| scene.camera.projection = Projection::Orthographic { half_height: 4.0 }),
        // Below the floor's plane, beside the floor.
        changed(|scene| {
            scene.objects[0].pose.scale *= 0.05;
            (scene.camera.eye, scene.camera.target) = (DVec3::new(5.0, -1.0, 4.0), DVec3::new(0.0, 1.0, 0.0));
        }),
    ];
    // With some of them volumes lie beside their place, are open or lose steps, and darken what they should not.
    let settings: [&[(&str, &str)]; 8] = [
        &[],
        &[("counter", "float")],
        &[("diffuse", "wrapped")],
        &[("casters", "light-facing")],
        &[("caps", "dark")],
        &[("operations", "clamp")],
        &[("extrusion", "finite:0.5"), ("far-vertices", "from-origin")],
        &[("light-caps", "never")],
    ];
    let mut less = 0;
    for technique in [Technique::ZFail, Technique::ZPass, Technique::ZPassPlus] {
        for (scene, settings) in scenes.iter().flat_map(|scene| settings.map(|settings| (scene, settings))) {
            let [all, none] = ["all", "none"].map(|leave_out| {
                let request = asked(technique, &[settings, &[("leave-out", leave_out)]].concat());
                session.capture(scene, &request).expect("a frame")
            });
            let labels = |capture: &Capture| -> Vec<Vec<u8>> {
                let labels = capture.lights.iter().filter_map(|light| light.shadow.as_ref());
                labels.map(|labels| labels.rows().flatten().copied().collect()).collect()
            };
            let picture = |capture: &Capture| {
                let last = capture.steps.iter().rfind(|step| step.name == "light").expect("a light");
                let Snapshot::Frame(frame) = &last.snapshot else { panic!("no frame") };
                frame.color.image.rows().flatten().copied().collect::<Vec<u8>>()
            };
            let of = format!("{technique:?} {settings:?} from {:?}", scene.camera);
            assert!(labels(&all) == labels(&none), "labels differ: {of}");
            let (one, other) = (picture(&all), picture(&none));
            assert_eq!(one.len(), other.len());
            let differing = one.chunks_exact(4).zip(other.chunks_exact(4)).filter(|(one, other)| one != other).count();
            // A face that is seen edge-on may show on a coarse grid, and not where it is left out.
            let most = if adapter::draws_as_given() { 0 } else { 12 };
            assert!(differing <= most, "the picture differs in {differing} pixels: {of}");
            let drawn = |capture: &Capture| {
                capture.steps.iter().flat_map(|step| &step.draws).map(|draw| draw.triangles).sum::<u64>()
            };
            less += usize::from(drawn(&all) < drawn(&none));
        }
    }
    assert!(less > 40, "{less} frames draw less");
}
