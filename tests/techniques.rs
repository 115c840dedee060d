//! Techniques on scenes whose answers are known in closed form.

use crate::common::{
    adapter, cuboid, from_above, label_counts, labels, opened, pixels, remeshed, request, request_with, session,
    square, stencil, under,
};
use glam::DVec3;
use stencilscope::capture::{Capture, Snapshot};
use stencilscope::plan::Decision;
use stencilscope::scene::{Light, Object, Pose, Projection, Scene};
use stencilscope::session::{CaptureRequest, Session, SnapshotInterval};
use stencilscope::technique::Technique;

const SHADOWING: [Technique; 4] = [Technique::Planar, Technique::ZPass, Technique::ZFail, Technique::ShadowMap];
const VOLUMES: [Technique; 2] = [Technique::ZPass, Technique::ZFail];
/// The eye 10 above the floor sees 20 × 20 units: ten pixels a unit.
const SIZE: [u32; 2] = [200, 200];

fn capture(session: &mut Session, scene: &Scene, technique: Technique) -> Capture {
    session.capture(scene, &request(technique, SIZE)).expect("a capture")
}

fn label_at(capture: &Capture, x: f64, z: f64) -> u8 {
    let pixel = |world: f64| (100.0 + world * 10.0) as u32;
    capture.lights[0].shadow.as_ref().and_then(|image| image.byte_at([pixel(x), pixel(z)])).expect("a label")
}

fn stencil_after(capture: &Capture, name: &str) -> Vec<u8> {
    let step = capture.steps.iter().find(|step| step.name == name).expect("the pass");
    let Snapshot::Frame(frame) = &step.snapshot else { panic!("a frame") };
    stencil(frame)
}

/// Of half-width 1 at height 2, halfway to the light, it throws a square of half-width 2: 40 × 40
/// pixels, of which the caster itself, 8 below the eye, hides 25 × 25.
#[test]
fn a_square_halfway_to_the_light_throws_a_square_twice_its_size() {
    let mut session = session();
    let scene = from_above(vec![square("caster", 2.0, 1.0)]);
    for technique in SHADOWING {
        let counts = label_counts(&capture(&mut session, &scene, technique));
        assert_eq!(counts, [200 * 200 - 975, 40 * 40 - 25 * 25, 0, 0], "{technique:?}");
    }
}

#[test]
fn without_shadows_everything_that_faces_the_light_is_lit() {
    let scene = from_above(vec![square("caster", 2.0, 1.0)]);
    assert_eq!(label_counts(&capture(&mut session(), &scene, Technique::None)), [200 * 200, 0, 0, 0]);
}

/// The light stands at 45°, so the square's shadow of its own size moves by its height.
#[test]
fn a_directional_light_throws_a_shadow_of_the_same_size() {
    let mut session = session();
    let scene = under(Light::directional(DVec3::new(-1.0, 1.0, 0.0)), vec![square("caster", 5.0, 1.0)]);
    for technique in SHADOWING {
        let capture = capture(&mut session, &scene, technique);
        assert_eq!(label_counts(&capture), [200 * 200 - 400, 400, 0, 0], "{technique:?}");
        assert_eq!(label_at(&capture, 5.0, 0.0), 1, "{technique:?}");
    }
}

/// Flipped triangles, mirrored objects and open meshes cast like the closed, outward box.
#[test]
fn winding_and_holes_do_not_change_a_shadow() {
    let mut session = session();
    let reference = cuboid("caster", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0]);
    let flipped = |keep: fn(usize) -> bool, flip: fn(usize) -> bool| {
        let triangles = reference.mesh.triangles().iter().enumerate().filter(|(index, _)| keep(*index));
        let triangles: Vec<[u32; 3]> =
            triangles.map(|(index, &[a, b, c])| if flip(index) { [a, c, b] } else { [a, b, c] }).collect();
        remeshed(&reference, &triangles)
    };
    let mirrored = Pose { scale: DVec3::new(-1.0, 1.0, 1.0), ..Pose::default() };
    let variants = [
        reference.clone(),
        flipped(|_| true, |_| true),
        flipped(|_| true, |index| index % 3 == 0),
        Object { pose: mirrored, ..reference.clone() },
        // Without its bottom, triangles 4 and 5.
        flipped(|index| index != 4 && index != 5, |index| index % 2 == 0),
    ];
    let expected = label_counts(&capture(&mut session, &from_above(vec![reference.clone()]), Technique::ZFail));
    assert!(expected[1] > 500, "{expected:?}");
    for (index, variant) in variants.into_iter().enumerate() {
        let scene = from_above(vec![variant]);
        for technique in VOLUMES {
            assert_eq!(label_counts(&capture(&mut session, &scene, technique)), expected, "{index} {technique:?}");
        }
    }
}

#[test]
fn z_pass_and_z_fail_leave_the_same_count_where_the_eye_is_outside() {
    let mut session = session();
    let scene = from_above(vec![cuboid("box", [-1.0, 1.0, -1.0], [1.0, 2.0, 0.5]), square("sheet", 2.5, 0.7)]);
    let [z_pass, z_fail] = VOLUMES.map(|technique| stencil_after(&capture(&mut session, &scene, technique), "volumes"));
    assert_eq!(z_pass, z_fail);
    // A closed box counts one, and so does the sheet over it.
    assert!([0, 1, 2].iter().all(|count| z_fail.contains(count)) && z_fail.iter().all(|count| *count <= 2));
}

/// A roof over the eye but not under it: the eye is inside its shadow volume.
#[test]
fn z_fail_holds_with_the_eye_inside_a_volume_and_z_pass_does_not() {
    let mut session = session();
    let scene = under(Light::point(DVec3::new(0.0, 14.0, 0.0)), vec![square("roof", 12.0, 1.0)]);
    // The roof's shadow on the floor: half-width 1 · 14 / 2 = 7.
    let right = [200 * 200 - 140 * 140, 140 * 140, 0, 0];
    for technique in [Technique::ZFail, Technique::Planar, Technique::ShadowMap] {
        assert_eq!(label_counts(&capture(&mut session, &scene, technique)), right, "{technique:?}");
    }
    let [_, shadow, _, _] = label_counts(&capture(&mut session, &scene, Technique::ZPass));
    assert_ne!(shadow, right[1], "z-pass miscounts by the volume that the eye is in");
}

#[test]
fn an_undrawn_caster_casts_and_one_that_does_not_cast_does_not() {
    let mut session = session();
    let hidden = Object { visible: false, ..square("caster", 2.0, 1.0) };
    let ghost = Object { casts: false, ..square("caster", 2.0, 1.0) };
    for technique in SHADOWING {
        let shadow = label_counts(&capture(&mut session, &from_above(vec![hidden.clone()]), technique))[1];
        assert_eq!(shadow, 40 * 40, "{technique:?}");
        let shadow = label_counts(&capture(&mut session, &from_above(vec![ghost.clone()]), technique))[1];
        assert_eq!(shadow, 0, "{technique:?}");
    }
}

#[test]
fn what_does_not_receive_is_lit_as_if_nothing_stood_between() {
    let mut session = session();
    let mut scene = from_above(vec![square("caster", 2.0, 1.0)]);
    scene.objects[0].receives = false;
    for technique in SHADOWING {
        let capture = capture(&mut session, &scene, technique);
        assert_eq!(label_counts(&capture), [200 * 200, 0, 0, 0], "{technique:?}");
        let unshadowed = self::capture(&mut session, &scene, Technique::None);
        assert_eq!(color_after_all(&capture), color_after_all(&unshadowed), "{technique:?}");
    }
}

/// Labels of a light do not depend on the lights before it: the stencil starts clean for each.
#[test]
fn lights_do_not_disturb_each_other() {
    let mut session = session();
    let mut scene = from_above(vec![square("caster", 2.0, 1.0)]);
    let lights = [Light::point(DVec3::new(3.0, 4.0, 0.0)), Light::directional(DVec3::new(0.0, 1.0, 1.0))];
    for technique in SHADOWING {
        let alone = lights.clone().map(|light| {
            scene.lights = vec![light];
            capture(&mut session, &scene, technique).lights[0].shadow.clone()
        });
        scene.lights = lights.to_vec();
        let together = capture(&mut session, &scene, technique);
        for (index, alone) in alone.iter().enumerate() {
            assert_eq!(together.lights[index].shadow, *alone, "{technique:?} light {index}");
        }
    }
}

/// The box's top faces the light, its sides do not face light and eye alike from straight above; a ramp that is rotated
/// away from the light does.
#[test]
fn a_surface_rotated_from_the_light_faces_away() {
    let mut session = session();
    let mut ramp = square("ramp", 0.0, 1.0);
    ramp.pose.rotate_degrees.z = 80.0;
    ramp.pose.translate = DVec3::new(5.0, 1.0, 0.0);
    let scene = from_above(vec![ramp]);
    for technique in SHADOWING {
        let capture = capture(&mut session, &scene, technique);
        let [_, _, background, away] = label_counts(&capture);
        assert!(away == 0 && background == 0, "its front faces both");
    }
    let mut scene = scene;
    scene.lights = vec![Light::point(DVec3::new(9.0, 1.0, 0.0))];
    for technique in SHADOWING {
        let away = label_counts(&capture(&mut session, &scene, technique))[3];
        assert!(away > 50, "its back faces the light, its front the eye: {away}, {technique:?}");
    }
}

/// Pushed the right way, the map leaves a tilted surface lit; pushed towards the light, it darkens it.
#[test]
fn the_shadow_map_bias_pushes_away_from_the_light() {
    let mut session = session();
    let mut plate = square("plate", 0.0, 3.0);
    plate.pose.rotate_degrees.z = 40.0;
    plate.pose.translate.y = 3.0;
    let scene = under(Light::point(DVec3::new(-2.0, 9.0, 0.0)), vec![plate]);
    let mut shadow_with = |bias: &str| {
        let request = request_with(Technique::ShadowMap, &[("bias-slope", bias), ("size", "128")], SIZE);
        let capture = session.capture(&scene, &request).expect("a capture");
        // Pixels of the plate around its middle, where nothing is above it.
        (-10..10)
            .flat_map(|x| (-10..10).map(move |z| (x, z)))
            .filter(|(x, z)| label_at(&capture, f64::from(*x) / 10.0, f64::from(*z) / 10.0) == 1)
            .count()
    };
    assert_eq!(shadow_with("2.0"), 0);
    assert!(shadow_with("-2.0") > 300, "{}", shadow_with("-2.0"));
}

/// Rows of a picture are padded on the GPU: no width may show it.
#[test]
fn pictures_of_any_width_are_symmetric_like_their_scene() {
    let mut session = session();
    let scene = from_above(vec![square("caster", 2.0, 1.0)]);
    for size in [[1, 1], [63, 65], [64, 64], [65, 63], [257, 131], [31, 257]] {
        let capture = session.capture(&scene, &request(Technique::ZFail, size)).expect("a capture");
        let frame = capture.frame_at(capture.steps.len() - 1).expect("a frame");
        let labels = capture.lights[0].shadow.as_ref().expect("labels");
        let depth = &capture.frame_at(0).expect("a frame").depth.image;
        let mut shadow = 0;
        for [x, y] in pixels(size) {
            let mirrored = [size[0] - 1 - x, y];
            assert_eq!(labels.byte_at([x, y]), labels.byte_at(mirrored), "{size:?} {x} {y}");
            assert!(depth.depth_at([x, y]).is_some_and(|d| d > 0.0), "{size:?} {x} {y}");
            assert_eq!(frame.color.image.rgba_at([x, y]).map(|c| c[3]), Some(255), "{size:?} {x} {y}");
            shadow += u64::from(labels.byte_at([x, y]) == Some(1));
        }
        assert!(size == [1, 1] || shadow > 0, "{size:?}");
    }
}

/// A light in a room with boxes all round needs a cube, and a face that sees no caster is left out.
#[test]
fn casters_all_round_make_a_cube_map_without_its_empty_faces() {
    let mut session = session();
    let boxes = [[4.0, 0.0], [-4.0, 0.0], [0.0, 4.0], [0.0, -4.0]];
    let boxes = boxes.map(|[x, z]| cuboid("box", [x - 0.5, 0.0, z - 0.5], [x + 0.5, 3.5, z + 0.5]));
    let scene = from_above(boxes.to_vec());
    let request = request(Technique::ShadowMap, SIZE);
    let plan = session.plan(&scene, &request).expect("a plan");
    let faces = &plan.lights[0].map.as_ref().expect("a map").faces;
    assert_eq!(faces.iter().map(Option::is_some).collect::<Vec<_>>(), [true, true, false, true, true, true]);
    assert!(plan.left_out.iter().any(|left| left.names(Decision::MapFaces, "map +y")));
    let map = session.capture(&scene, &request).expect("a capture");
    let volumes = capture(&mut session, &scene, Technique::ZFail);
    let labels = |capture: &Capture| capture.lights[0].shadow.clone().expect("labels");
    let (by_map, by_volumes) = (labels(&map), labels(&volumes));
    // The face takes no memory, and says as much as one that was drawn.
    let mut whole = request.clone();
    whole.choice.set("leave-out", "none").expect("a setting");
    let six = session.plan(&scene, &whole).expect("a plan");
    let attachment = plan.lights[0].map.as_ref().expect("a map").attachment;
    assert_eq!([&plan, &six].map(|plan| plan.stored_layers(attachment)), [5, 6]);
    let face = u64::from(plan.attachment(attachment).size[0]).pow(2) * 4;
    assert!(six.bytes() >= plan.bytes() + face, "{} and {}", six.bytes(), plan.bytes());
    let six = session.capture(&scene, &whole).expect("a capture");
    assert_eq!(by_map, labels(&six));
    let faces = |capture: &Capture| capture.lights[0].map.as_ref().expect("a map").faces.clone();
    assert_eq!(faces(&map), faces(&six));
    let differing = by_map.rows().flatten().zip(by_volumes.rows().flatten()).filter(|(a, b)| a != b).count();
    assert!(differing < 50, "only texels at shadow edges differ: {differing}");
    assert!(label_counts(&volumes)[1] > 2000);
}

/// A frame split at its draws ends in the same pictures, and its counts grow draw by draw.
#[test]
fn a_snapshot_after_each_draw_ends_like_one_after_each_pass() {
    let mut session = session();
    let scene = from_above(vec![cuboid("box", [-1.0, 1.0, -1.0], [1.0, 2.0, 0.5]), square("sheet", 0.5, 2.0)]);
    for technique in Technique::ALL {
        let plan = session.plan(&scene, &request(technique, SIZE)).expect("a plan");
        let by_pass = session.capture_plan(&scene, &plan).expect("a capture");
        let by_draw = session.capture_plan(&scene, &plan.split_at_draws()).expect("a capture");
        assert_ends_alike(&by_draw, &by_pass);
    }
}

/// A frame whose copies are large runs in parts, and leaves what it leaves in one. Of its draws, only what they change
/// is stored.
#[test]
fn a_frame_that_copies_much_is_the_same_in_parts() {
    let mut session = session();
    let scene = opened("tori");
    let plan = session.plan(&scene, &request(Technique::ZFail, [1600, 1000])).expect("a plan");
    let by_pass = session.capture_plan(&scene, &plan).expect("a capture");
    let split = plan.split_at_draws();
    // 9 bytes a pixel where a draw changes all of it: well over what one part copies.
    assert!(split.passes.len() > 30, "{} draws", split.passes.len());
    let by_draw = session.capture_plan(&scene, &split).expect("a capture");
    assert_ends_alike(&by_draw, &by_pass);
    assert!(by_draw.steps.iter().all(|step| step.gpu_ms.is_some_and(|ms| ms > 0.0)), "every part is timed");
    let request = CaptureRequest { every: SnapshotInterval::Draw, ..request(Technique::ZFail, [1600, 1000]) };
    let joined = session.capture(&scene, &request).expect("a capture");
    assert_eq!((&joined.lights, joined.steps.len()), (&by_pass.lights, by_pass.steps.len()));
    for (index, (joined, whole)) in joined.steps.iter().zip(&by_pass.steps).enumerate() {
        assert_eq!(joined.snapshot, whole.snapshot, "{index}");
    }
    let [draws, passes] = [&joined, &by_pass].map(Capture::bytes);
    let copies = by_draw.bytes();
    assert!(draws < copies / 2 && draws < passes * 4, "{draws} of {copies} bytes, {passes} without draws");
}

/// A frame that was split at its draws leaves after each pass what it leaves in one piece.
fn assert_ends_alike(by_draw: &Capture, by_pass: &Capture) {
    let technique = &by_pass.technique;
    assert_eq!(by_draw.lights, by_pass.lights, "{technique:?}");
    let (mut last, mut compared) = (0, 0);
    for (index, step) in by_pass.steps.iter().enumerate() {
        last += step.draws.len().max(1);
        let frames = (by_draw.frame_at(last - 1), by_pass.frame_at(index));
        let (split, whole) = match frames {
            (Some(split), Some(whole)) => (split, whole),
            // Maps come before the picture.
            (None, None) => continue,
            one => panic!("{technique:?} {}: only one has a picture: {one:?}", step.name),
        };
        compared += 1;
        assert_eq!(split.color.image, whole.color.image, "{technique:?} {}", step.name);
        assert_eq!(split.depth.image, whole.depth.image, "{technique:?} {}", step.name);
        let stencils = [split, whole].map(|frame| frame.stencil.as_ref().map(|aspect| aspect.image.clone()));
        assert_eq!(stencils[0], stencils[1], "{technique:?} {}", step.name);
    }
    assert_eq!(by_draw.steps.len(), last);
    assert!(compared >= 3, "{technique:?}: ambient, light and mask at least");
}

fn color_after_all(capture: &Capture) -> std::sync::Arc<stencilscope::capture::Image> {
    capture.frame_at(capture.steps.len() - 1).expect("a frame").color.image.clone()
}

/// Eight triangles around a point: its shadow does not fill its map's rectangle.
fn octahedron(name: &str, center: [f64; 3], radius: f64) -> Object {
    let at = |axis: usize, sign: f64| {
        let mut point = center;
        point[axis] += sign * radius;
        point
    };
    let points = [at(0, 1.0), at(0, -1.0), at(1, 1.0), at(1, -1.0), at(2, 1.0), at(2, -1.0)];
    let upper = [[2, 4, 0], [2, 0, 5], [2, 5, 1], [2, 1, 4]];
    let lower = [[3, 0, 4], [3, 5, 0], [3, 1, 5], [3, 4, 1]];
    Object::new(name, crate::common::mesh(&points, &[upper, lower].concat()), Default::default())
}

/// Counts of labels by volumes and by map, which differ only along the shadow's edge.
#[test]
fn maps_of_points_and_suns_agree_with_volumes_but_for_edges() {
    let mut session = session();
    let lights = [Light::point(DVec3::new(1.0, 5.0, 0.5)), Light::directional(DVec3::new(0.4, 1.0, -0.3))];
    for light in lights {
        let scene = under(light, vec![octahedron("caster", [0.0, 2.0, 0.0], 1.0)]);
        let by_map = capture(&mut session, &scene, Technique::ShadowMap);
        let by_volumes = capture(&mut session, &scene, Technique::ZFail);
        let labels = |capture: &Capture| capture.lights[0].shadow.clone().expect("labels");
        let (map, volumes) = (labels(&by_map), labels(&by_volumes));
        let differing = map.rows().flatten().zip(volumes.rows().flatten()).filter(|(a, b)| a != b).count();
        assert!(label_counts(&by_volumes)[1] > 100, "{:?}", label_counts(&by_volumes));
        assert!(differing <= 12, "{differing} pixels differ");
    }
}

/// Nothing has a size of its own: the same scene a billion times larger or smaller looks the same.
#[test]
fn a_scene_of_any_size_has_the_same_labels() {
    let mut session = session();
    let scaled = |scale: f64| {
        let mut scene = from_above(vec![octahedron("caster", [0.0, 2.0, 0.0], 1.0)]);
        for object in &mut scene.objects {
            object.pose.scale *= scale;
        }
        scene.camera.eye *= scale;
        scene.camera.near *= scale;
        scene.lights[0].position = (scene.lights[0].position.truncate() * scale).extend(1.0);
        scene
    };
    for technique in SHADOWING {
        let expected = label_counts(&capture(&mut session, &scaled(1.0), technique));
        // Powers of two, so that no coordinate is rounded anew.
        let most = if adapter::draws_as_given() { 40 } else { 20 };
        for scale in [2f64.powi(most), 2f64.powi(-most)] {
            let counts = label_counts(&capture(&mut session, &scaled(scale), technique));
            assert_eq!(counts, expected, "{technique:?} at {scale:e}");
        }
    }
}

#[test]
fn a_direction_of_any_length_is_one_direction() {
    let mut session = session();
    let mut counts_under = |length: f64| {
        let sun = Light::directional(DVec3::new(0.25, 1.0, -0.5) * length);
        let scene = under(sun, vec![octahedron("caster", [0.0, 2.0, 0.0], 1.0)]);
        SHADOWING.map(|technique| label_counts(&capture(&mut session, &scene, technique)))
    };
    let expected = counts_under(1.0);
    for length in [2f64.powi(-1060), 2f64.powi(-600), 2f64.powi(600), 2f64.powi(1000)] {
        assert_eq!(counts_under(length), expected, "{length:e}");
    }
}

#[test]
fn what_single_precision_can_not_hold_is_refused() {
    let mut session = session();
    let mut refused = |change: fn(&mut Scene)| {
        let mut scene = from_above(vec![square("caster", 2.0, 1.0)]);
        change(&mut scene);
        session.capture(&scene, &request(Technique::ZFail, [8, 8])).is_err()
    };
    assert!(!refused(|_| {}));
    assert!(refused(|scene| scene.lights[0].position.x = 1e300));
    assert!(refused(|scene| scene.objects[1].pose.translate.x = 1e30));
    assert!(refused(|scene| scene.camera.near = 1e-60));
    assert!(refused(|scene| scene.camera.fov_y_degrees = 1e-30));
    assert!(refused(|scene| scene.lights[0].range = Some(1e-50)));
    assert!(refused(|scene| scene.lights[0].intensity = f32::NAN));
}

/// A triangle given twice is lit once, whatever the technique.
#[test]
fn coinciding_surfaces_are_lit_once() {
    let mut session = session();
    let single = octahedron("caster", [0.0, 2.0, 0.0], 1.0);
    let twice = [single.mesh.triangles(), single.mesh.triangles()].concat();
    let doubled = remeshed(&single, &twice);
    for technique in Technique::ALL {
        let [one, two] = [&single, &doubled].map(|object| {
            let mut scene = from_above(vec![object.clone()]);
            scene.lights.push(Light::directional(DVec3::Y));
            color_after_all(&capture(&mut session, &scene, technique))
        });
        assert!(one == two, "{technique:?}");
    }
}

/// Surfaces that overlap in one plane are at one depth, though they share no corner: what colours are measured against
/// lights them once, as volumes do.
#[test]
fn surfaces_that_overlap_in_one_plane_are_lit_once_by_the_truth() {
    let mut session = session();
    let sheet = |name: &str, x: f64| square(name, 1.0, 1.0).at([x, 0.0, x]);
    let mut scene = from_above(vec![sheet("one", -0.25), sheet("other", 0.25)]);
    scene.lights.push(Light::directional(DVec3::Y));
    let [truth, counted] = [Technique::RayTraced, Technique::Auto]
        .map(|technique| color_after_all(&capture(&mut session, &scene, technique)));
    assert!(truth == counted);
}

/// No receiver is inside the floor's volume: z-fail does without it, where what is drawn of volumes counts right. With
/// it, each pixel has the same label.
#[test]
fn z_fail_draws_no_volume_of_what_darkens_nothing() {
    let mut session = session();
    let changed = |change: fn(&mut Scene)| {
        let mut scene = from_above(vec![square("caster", 2.0, 1.0)]);
        change(&mut scene);
        scene
    };
    let scenes = [
        changed(|_| ()),
        changed(|scene| scene.lights = vec![Light::directional(DVec3::new(-1.0, 1.0, 0.0))]),
        changed(|scene| scene.camera.projection = Projection::Orthographic { half_height: 8.0 }),
        changed(|scene| scene.objects[0].visible = false),
        changed(|scene| scene.objects[0].receives = false),
    ];
    for (index, scene) in scenes.iter().enumerate() {
        let mut with = |settings: &[(&str, &str)]| {
            let capture = session.capture(scene, &request_with(Technique::ZFail, settings, SIZE)).expect("a capture");
            (capture.left_out.iter().any(|one| one.is(Decision::Caster, "floor")), labels(&capture).remove(0))
        };
        let (is_left_out, labels): (bool, Vec<u8>) = with(&[]);
        assert!(is_left_out, "{index}");
        for setting in [("leave-out", "none"), ("casters", "all")] {
            let (is_left_out, other) = with(&[setting]);
            assert!(!is_left_out && labels == other, "{index}: {setting:?}");
        }
        for wrong in [("caps", "light"), ("operations", "clamp"), ("light-caps", "never"), ("diffuse", "wrapped")] {
            assert!(!with(&[wrong]).0, "{index}: {wrong:?}");
        }
    }
    // An eye in it is an error of z-pass.
    let z_pass = capture(&mut session, &scenes[0], Technique::ZPass);
    assert!(!z_pass.left_out.iter().any(|one| one.is(Decision::Caster, "floor")));
}
