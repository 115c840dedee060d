//! Parallel projection: every volume counted right, from anywhere.

use crate::common::random::Random;
use crate::common::{
    adapter, cuboid, from_above, judged, judged_by, labels, request, request_with, session, square, under, wrong,
};
use glam::DVec3;
use std::collections::BTreeSet;
use stencilscope::accuracy;
use stencilscope::math::depth::DepthMapping;
use stencilscope::plan::{Decision, DrawPart, FramePlan};
use stencilscope::progress::Progress;
use stencilscope::scene::{Camera, Light, Projection, Scene, builtin};
use stencilscope::session::{InjectedFault, Session};
use stencilscope::technique::Technique;
use stencilscope::truth::Tracer;

const SIZE: [u32; 2] = [48, 36];
const PLACES: u64 = 10;

/// An orthographic and a cabinet camera that show the target as large as a pinhole does.
fn parallel(camera: Camera) -> [Camera; 2] {
    let half_height = camera.half_height_at_target();
    let cabinet = Projection::Oblique { half_height, angle_degrees: 45.0, factor: Projection::CABINET };
    [Projection::Orthographic { half_height }, cabinet].map(|projection| Camera { projection, ..camera })
}

fn seen_by(scene: &Scene, camera: Camera) -> Scene {
    Scene { camera, ..scene.clone() }
}

/// Pixels that z-fail or `auto` has wrong.
fn faults(session: &mut Session, scene: &Scene) -> Vec<String> {
    // Counts of 256 read as none in eight bits, which is no matter here.
    let z_fail = request_with(Technique::ZFail, &[("counter", "float")], SIZE);
    let step = session.profile().expect("a profile").subpixel();
    let tracer = Tracer::new(scene, SIZE).expect("rays");
    let truth = tracer.trace(&Progress::default()).expect("a truth");
    let requests = [("z-fail", z_fail), ("auto", request(Technique::Auto, SIZE))];
    let judged = requests.into_iter().filter_map(|(name, request)| {
        let capture = session.capture(scene, &request).expect("a capture");
        let of_light = |(light, labels): (usize, Vec<u8>)| {
            let rows: Vec<&[u8]> = labels.chunks_exact(SIZE[0] as usize).collect();
            accuracy::compare(&tracer, &truth, light, &rows, step).counts.wrong()
        };
        let mut wrong: u64 = labels(&capture).into_iter().enumerate().map(of_light).sum();
        let projection = scene.camera.projection.name();
        if wrong > 0 && !adapter::draws_as_given() {
            let found = session.diagnose(scene, &request, InjectedFault::None, &Progress::default());
            wrong = adapter::beyond_precision(&found.expect("a diagnosis"));
        }
        (wrong > 0).then(|| format!("{}, {projection}: {name} has {wrong} wrong", scene.name))
    });
    judged.collect()
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

/// Over a large floor, straight down, with a box under the lamp: the lamp's own ray hits the whole lit side of the box.
fn over_a_box() -> Scene {
    let scene = from_above(vec![cuboid("box", [-0.9, 1.0, -0.7], [0.8, 2.0, 1.0])]);
    let projection = Projection::Orthographic { half_height: 5.0 };
    let camera = Camera { projection, ..scene.camera };
    seen_by(&scene, camera)
}

fn clears(plan: &FramePlan) -> Vec<u8> {
    let volumes = plan.passes.iter().filter(|pass| pass.name == "volumes");
    volumes.filter_map(|pass| pass.depth_stencil.as_ref()?.clear_stencil).collect()
}

/// No shadow ends on the floor: only what the ray hits is counted, once for each casting triangle.
#[test]
fn the_count_begins_at_what_the_lamps_ray_along_the_view_meets() {
    let mut session = session();
    let scene = over_a_box();
    let mut began = |casters: &str, scene: &Scene| {
        let request = request_with(Technique::ZFail, &[("casters", casters)], SIZE);
        let (capture, plan) = session.capture_with_plan(scene, &request).expect("a capture");
        let judged = session.judged(scene, &capture, &Progress::default()).expect("a truth");
        assert_eq!(wrong(&judged), 0, "{casters}");
        let drawn = plan.passes.iter().flat_map(|pass| &pass.draws);
        assert!(drawn.filter(|draw| draw.part == DrawPart::DarkCap).count() == 0, "a line at infinity");
        let left_out = plan.left_out.iter().filter(|left| left.decision == Some(Decision::DarkCap)).count();
        assert_eq!(left_out, 2, "the floor's and the box's");
        clears(&plan)
    };
    // The floor casts too: the ray hits one of its two triangles, and the box's lit side, or both sides.
    assert_eq!(began("light-facing", &scene), [2]);
    assert_eq!(began("all", &scene), [3]);
    let mut aside = scene.clone();
    aside.objects[0].casts = true;
    aside.objects[1].pose.translate.x = 3.0;
    assert_eq!(began("light-facing", &aside), [1], "the floor alone");
}

/// From within a shadow, and with the near plane across the scene: z-pass is wrong, as of a pinhole, and
/// z-pass-plus counts what the near plane begins with.
#[test]
fn z_pass_plus_counts_what_parallel_rays_begin_in() {
    let mut session = session();
    let scene = builtin::ALL.iter().find(|builtin| builtin.name == "inside").expect("a scene");
    let scene = scene.scene().expect("a scene");
    let mut z_pass_is_wrong = 0;
    for camera in parallel(scene.camera) {
        let scene = seen_by(&scene, camera);
        for technique in [Technique::ZPassPlus, Technique::ZFail] {
            let capture = judged(&mut session, &scene, technique, SIZE);
            adapter::assert_right(&mut session, &scene, &request(technique, SIZE), &capture, &technique.name());
        }
        let z_pass = wrong(&judged(&mut session, &scene, Technique::ZPass, SIZE));
        z_pass_is_wrong += usize::from(z_pass > if adapter::draws_as_given() { 0 } else { 2 });
    }
    assert_eq!(z_pass_is_wrong, 2);
}

/// Every event of a pixel is what the GPU stored, clamped depth and a count that begins elsewhere too.
#[test]
fn histories_agree_with_the_gpu() {
    let mut session = session();
    let tori = builtin::ALL[0].scene().expect("a scene");
    let scenes = parallel(tori.camera).map(|camera| seen_by(&tori, camera)).into_iter().chain([over_a_box()]);
    for scene in scenes {
        for technique in [Technique::ZFail, Technique::Auto, Technique::ZPassPlus] {
            let (capture, plan) = session.capture_with_plan(&scene, &request(technique, SIZE)).expect("a capture");
            let mut random = Random::new(3);
            for _ in 0..40 {
                let at = SIZE.map(|pixels| random.below(pixels));
                let history = session.history(&plan, &capture, at).expect("a history");
                assert!(
                    history.agrees(),
                    "{} {technique:?}: {:?}\n{}",
                    scene.name,
                    history.disagreements(),
                    history.story(&capture.depth)
                );
            }
        }
    }
}

/// No far plane, one that cuts, one that clamps; reversed or not: volumes go on wherever nothing clips them.
#[test]
fn every_mapping_that_clips_nothing_counts_right() {
    let mut session = session();
    let tori = builtin::ALL[0].scene().expect("a scene");
    for camera in parallel(tori.camera) {
        let scene = seen_by(&tori, camera);
        for mapping in DepthMapping::ALL {
            for technique in [Technique::Auto, Technique::ZFail, Technique::ZPass] {
                let request = request_with(technique, &[("depth", mapping.name())], SIZE);
                let capture = judged_by(&mut session, &scene, &request);
                let clips = mapping == DepthMapping::StandardFinite && technique != Technique::ZPass;
                let wrong = wrong(&capture);
                assert!(capture.depth.is_linear);
                assert!(wrong == 0 || clips, "{mapping:?} {technique:?}: {wrong} wrong");
            }
        }
    }
}

/// On a flat floor under a sun, neither the light's way nor the eye's changes: the highlight is one colour.
#[test]
fn a_highlight_is_seen_from_one_direction() {
    let mut session = session();
    let mut scene = under(Light::directional([0.4, 1.0, 0.3]), Vec::new());
    scene.objects[0].material.specular = 0.8;
    scene.objects[0].material.shininess = 20.0;
    let mut colors = |scene: &Scene| {
        let capture = session.capture(scene, &request(Technique::None, SIZE)).expect("a capture");
        let last = (0..capture.steps.len()).rev().find(|step| capture.steps[*step].name == "light").expect("a pass");
        let picture = &capture.frame_at(last).expect("a frame").color.image;
        let all: BTreeSet<Vec<u8>> = picture.rows().flat_map(|row| row.chunks(4)).map(<[u8]>::to_vec).collect();
        all.len()
    };
    assert!(colors(&scene) > 20, "a pinhole sees it from many");
    for camera in parallel(scene.camera) {
        assert_eq!(colors(&seen_by(&scene, camera)), 1, "{:?}", camera.projection);
    }
}

#[test]
fn a_field_of_view_is_refused_where_there_is_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "[camera]\neye = [0, 2, 6]\ntarget = [0, 0, 0]\nprojection = \"orthographic\"\n\
                 [[objects]]\nmesh = { shape = \"box\", size = [1, 1, 1] }\n";
    std::fs::write(folder.path().join("box.toml"), scene).expect("written");
    let run = |options: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_stencilscope"));
        command
            .args(["pixel", "box.toml", "--at", "24,18", "--size", "48x36"])
            .args(options)
            .current_dir(folder.path());
        let output = command.output().expect("the program runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, line) = run(&["--fov", "30"]);
    assert_eq!((code, line.trim_end().lines().count()), (Some(2), 1), "{line}");
    assert!(line.contains("orthographic and has no field of view"), "{line}");
    let (code, line) = run(&["--coordinates"]);
    assert_eq!(code, Some(0), "{line}");
}

/// The eye is over a board and the near plane under it: which volumes the view rays begin in is asked there.
#[test]
fn z_pass_begins_with_the_volumes_around_the_middle_of_the_near_plane() {
    let mut session = session();
    let board = square("board", 3.0, 4.0);
    let mut scene = from_above(vec![board]);
    let half_height = 1.0;
    scene.camera = Camera {
        projection: Projection::Orthographic { half_height },
        eye: DVec3::new(0.3, 5.0, 0.4),
        target: DVec3::new(0.0, 0.0, 0.1),
        near: 2.5,
        ..scene.camera
    };
    scene.lights = vec![Light::point([0.2, 9.0, 0.1])];
    let mut wrong_from = |start: &str| {
        let request = request_with(Technique::ZPass, &[("start", start)], SIZE);
        let capture = judged_by(&mut session, &scene, &request);
        let is_reported =
            capture.steps.iter().any(|step| step.purpose.contains("1, for the volumes around the middle of the near"));
        assert_eq!(is_reported, start == "eye-count");
        wrong(&capture)
    };
    assert_eq!(wrong_from("eye-count"), 0);
    assert!(wrong_from("zero") > 1000);
}
