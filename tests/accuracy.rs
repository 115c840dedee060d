//! Techniques against the ground truth: the robust one has no wrong pixel anywhere, the others
//! are wrong where they must be, and a wrong answer can't pass.

use crate::common::random::Random;
use crate::common::{
    adapter, choice, cuboid, from_above, judged_by, last_frame, opened, pixels, request, session, square, under,
};
use glam::DVec3;
use std::sync::Arc;
use stencilscope::accuracy::{COLOR_TOLERANCE, ErrorCounts, Finding, USUAL_STEP, WrongRegion, compare, wrong_colors};
use stencilscope::capture::Capture;
use stencilscope::progress::Progress;
use stencilscope::scene::{Light, MeshBuilder, Scene};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};
use stencilscope::truth::Tracer;

const SIZE: [u32; 2] = [96, 72];

/// The knot, torn: triangles are missing, some are flipped and some are there twice.
fn torn_knot() -> Scene {
    let mut scene = opened("assets/models/knot.obj");
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
    let scenes = [opened("assets/models/knot.obj"), torn_knot(), opened("tori"), opened("table")];
    for scene in &scenes {
        let mut random = Random::new(5);
        let mut labels = [0; 4];
        let (mut views, mut tries) = (0, 0);
        while views < 10 {
            tries += 1;
            assert!(tries <= 60, "{}: {views} of {tries} views show light and shadow", scene.name);
            let scene = seen_from_anywhere(scene, &mut random);
            let request = request(Technique::ZFail, SIZE);
            let capture = judged_by(&mut session, &scene, &request);
            let error = capture.error().expect("judged");
            adapter::assert_right(&mut session, &scene, &request, &capture, &format!("view {views}"));
            // Excuses stay few: edges are lines, and the wider the coarser the adapter's step.
            let most = if adapter::draws_as_given() { error.compared / 500 } else { error.compared / 100 };
            assert!(error.edge_band <= most, "{}, view {views}: {error:?}", scene.name);
            let seen = capture.lights[0].truth.as_ref().expect("judged").labels.histogram();
            (0..4).for_each(|label| labels[label] += seen[label]);
            // From outside a room all is dark, which says little.
            views += u32::from(seen[0] >= 100 && seen[1] >= 50);
        }
        assert!(labels[0] >= 500 && labels[1] >= 500, "{}: {labels:?}", scene.name);
    }
}

fn error_of(session: &mut Session, scene: &Scene, choice: Choice) -> ErrorCounts {
    let request = CaptureRequest { choice, ..request(Technique::None, SIZE) };
    judged_by(session, scene, &request).error().expect("judged")
}

/// A board over a floor, and the eye outside the board's shadow volume or inside it.
#[test]
fn z_pass_is_right_from_outside_a_volume_and_wrong_from_inside() {
    let mut session = session();
    let mut scene =
        under(Light::point(DVec3::new(0.3, 6.0, 0.2)), vec![cuboid("board", [-1.0, 2.0, -1.0], [1.0, 2.1, 1.0])]);
    scene.camera.eye = DVec3::new(7.0, 4.0, 5.0);
    let [z_pass, z_fail] = [Technique::ZPass, Technique::ZFail].map(Choice::new);
    let outside = error_of(&mut session, &scene, z_pass.clone());
    assert_eq!(outside.wrong(), 0, "{outside:?}");
    assert!(outside.compared > 4000, "{outside:?}");
    scene.camera.eye = DVec3::new(0.0, 1.0, 0.0); // under the board
    scene.camera.target = DVec3::new(6.0, 0.0, 0.0);
    scene.camera.up = DVec3::Y;
    let inside = error_of(&mut session, &scene, z_pass);
    // One volume too few is counted: the lit floor beyond the shadow reads −1, its shadow 0.
    assert!(inside.false_shadow > 1000 && inside.missing_shadow > 100, "{inside:?}");
    assert_eq!(error_of(&mut session, &scene, z_fail).wrong(), 0);
}

#[test]
fn a_shadow_map_errs_less_the_larger_it_is() {
    let mut session = session();
    let scene = opened("assets/models/knot.obj");
    let errors = ["16", "48", "144"]
        .map(|size| error_of(&mut session, &scene, choice(Technique::ShadowMap, &[("size", size)])).wrong());
    assert!(errors[0] > 2 * errors[1] && errors[1] > 2 * errors[2], "{errors:?}");
}

/// Its labels are the truth: not even an edge is excused. Its picture is the one that z-fail makes.
#[test]
fn the_ray_traced_technique_is_the_truth_and_looks_like_z_fail() {
    let mut session = session();
    for scene in [opened("assets/models/knot.obj"), opened("table")] {
        let traced = judged_by(&mut session, &scene, &request(Technique::RayTraced, SIZE));
        let error = traced.error().expect("judged");
        assert_eq!((error.wrong(), error.edge_band), (0, 0));
        let z_fail = judged_by(&mut session, &scene, &request(Technique::ZFail, SIZE));
        let [a, b] = [&traced, &z_fail].map(|capture| last_frame(capture).color.image.clone());
        // Pictures differ only where labels do.
        let labels = |capture: &Capture| capture.lights[0].shadow.clone().expect("labels");
        let (by_rays, by_counts) = (labels(&traced), labels(&z_fail));
        for at in pixels(SIZE) {
            let is_same = a.rgba_at(at) == b.rgba_at(at);
            assert!(is_same || by_rays.byte_at(at) != by_counts.byte_at(at), "{}: pixel {at:?}", scene.name);
        }
    }
}

/// A truth with a triangle of the caster missing disagrees with a technique that drew it.
#[test]
fn a_truth_without_one_triangle_is_caught() {
    let mut session = session();
    let scene = from_above(vec![square("caster", 2.0, 1.5)]);
    let capture = session.capture(&scene, &request(Technique::ZFail, SIZE)).expect("a capture");
    let mut without = scene.clone();
    let mesh = &scene.objects[1].mesh;
    let triangles = mesh.triangles()[1..].to_vec();
    let builder = MeshBuilder { positions: mesh.positions().to_vec(), triangles, ..MeshBuilder::default() };
    without.objects[1].mesh = Arc::new(builder.build().expect("a mesh"));
    let judged = session.judged(&without, &capture, &Progress::default()).expect("a truth");
    let truth = judged.lights[0].truth.as_ref().expect("judged");
    assert!(truth.error.false_shadow > 50, "{:?}", truth.error);
    let worst = truth.worst.expect("a region");
    assert!(worst.pixels > 50 && worst.kind == Finding::FalseShadow, "{worst:?}");
}

#[test]
fn one_flipped_pixel_of_a_mask_is_caught_and_found() {
    let mut session = session();
    let scene = from_above(vec![square("caster", 2.0, 1.5)]);
    let capture = session.capture(&scene, &request(Technique::ZFail, SIZE)).expect("a capture");
    let tracer = Tracer::new(&scene, SIZE).expect("a tracer");
    let truth = tracer.trace(&Progress::default()).expect("a truth");
    let mask = capture.lights[0].shadow.as_ref().expect("labels");
    let mut rows: Vec<Vec<u8>> = mask.rows().map(<[u8]>::to_vec).collect();
    let compare_rows =
        |rows: &[Vec<u8>]| compare(&tracer, &truth, 0, &rows.iter().map(Vec::as_slice).collect::<Vec<_>>(), USUAL_STEP);
    assert_eq!(compare_rows(&rows).counts.wrong(), 0);
    for (value, kind) in [(1, Finding::FalseShadow), (2, Finding::WrongSurface), (3, Finding::WrongSurface)] {
        rows[70][2] = value; // a corner of the floor, far from any edge
        let found = compare_rows(&rows);
        assert_eq!(found.worst, Some(WrongRegion { pixels: 1, kind, bounds: [2, 70, 2, 70], at: [2, 70] }));
        assert_eq!((found.counts.wrong(), found.findings[70 * 96 + 2]), (1, kind as u8));
    }
}

#[test]
fn a_cancelled_judgement_leaves_the_capture_as_it_was() {
    let mut session = session();
    let scene = from_above(vec![]);
    let before = session.capture(&scene, &request(Technique::ZFail, SIZE)).expect("a capture");
    let capture = before.clone();
    let progress = Progress::default();
    progress.cancel();
    assert!(session.truth(&scene, &capture, &progress).is_err());
    assert_eq!(capture, before);
}

/// Every pixel counts, the background too, but for those at an edge of the truth whose labels are not wrong; the fourth
/// channel is no light.
#[test]
fn colours_are_wrong_beyond_a_step_and_not_at_an_edge() {
    let size = [64, 64];
    let scene = from_above(vec![square("roof", 2.0, 1.0)]);
    let tracer = Tracer::new(&scene, size).expect("a tracer");
    let truth = tracer.trace(&Progress::default()).expect("a truth");
    let agrees = vec![Finding::Agrees as u8; 64 * 64];
    let counted = |changed: &[([usize; 2], usize, u8)], findings: &[Vec<u8>]| {
        let right = vec![100; 64 * 64 * 4];
        let mut shown = right.clone();
        changed.iter().for_each(|([x, y], channel, by)| shown[(y * 64 + x) * 4 + channel] += by);
        let [shown, right] = [&shown, &right].map(|bytes: &Vec<u8>| bytes.chunks(64 * 4).collect::<Vec<&[u8]>>());
        wrong_colors(&tracer, &truth, findings, [&shown, &right], USUAL_STEP)
    };
    let clear = [5, 9];
    assert_eq!(counted(&[], std::slice::from_ref(&agrees)), 0);
    assert_eq!(counted(&[(clear, 0, COLOR_TOLERANCE)], std::slice::from_ref(&agrees)), 0);
    assert_eq!(counted(&[(clear, 0, COLOR_TOLERANCE + 1)], std::slice::from_ref(&agrees)), 1);
    assert_eq!(counted(&[(clear, 2, 90), (clear, 1, 90), ([0, 1], 1, 2)], std::slice::from_ref(&agrees)), 2);
    assert_eq!(counted(&[(clear, 3, 90)], std::slice::from_ref(&agrees)), 0);
    // Along a row through the shadow: its ends, 6.4 pixels from the middle, and where the roof's two triangles meet.
    let row = 32;
    let label = |x: f64| tracer.labels_at(0, [[x, row as f64 + 0.5]]);
    let visible = |x: f64| tracer.visible_at([[x, row as f64 + 0.5]]);
    let both_sides = |reach: f64| [-reach, reach];
    let edges: Vec<usize> = (0..64)
        .filter(|x| {
            let center = *x as f64 + 0.5;
            both_sides(1.0 / 8.0).iter().any(|by| label(center + by) != label(center))
                || both_sides(1.0 / 256.0).iter().any(|by| visible(center + by) != visible(center))
        })
        .collect();
    assert_eq!(edges.len(), 3, "{edges:?}");
    let all: Vec<_> = (0..64).map(|x| ([x, row], 1, 9)).collect();
    assert_eq!(counted(&all, std::slice::from_ref(&agrees)), 64 - edges.len() as u64);
    // A label that is wrong, and not excused, excuses no colour.
    let wrong = vec![Finding::FalseShadow as u8; 64 * 64];
    assert_eq!(counted(&all, &[agrees, wrong]), 64);
}
