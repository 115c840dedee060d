//! What `auto` leaves out: taken where it changes nothing, not taken in the scene beside it, and without a pixel of
//! difference, but where a volume's other far corners draw the very edge of a shadow.

mod cached;
mod clamped;
mod holes;
mod range;
mod unseen;

use crate::common::{
    adapter, apart, cuboid, from_above, judged, labels, mesh, request, request_with, session, square, under,
};
use glam::DVec3;
use std::sync::Arc;
use stencilscope::capture::{Capture, FrameTarget, Snapshot, Step};
use stencilscope::plan::Decision;
use stencilscope::progress::Progress;
use stencilscope::scene::{Camera, Light, Material, Mesh, Object, Scene};
use stencilscope::scene::{builtin, shapes};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [96, 72];

fn auto(leave_out: &str) -> CaptureRequest {
    request_with(Technique::Auto, &[("leave-out", leave_out)], SIZE)
}

/// The finished picture.
fn picture(capture: &Capture) -> Vec<u8> {
    let color = |snapshot: &Snapshot| match snapshot {
        Snapshot::Frame(frame) => Some(frame.color.image.rows().flatten().copied().collect()),
        Snapshot::Map { .. } => None,
    };
    let steps = capture.steps.iter().filter(|step| step.name != "mask");
    steps.filter_map(|step| color(&step.snapshot)).next_back().expect("a picture")
}

/// All decisions but one.
fn all_but(decision: Decision) -> String {
    let others: Vec<&str> = Decision::NAMES.into_iter().filter(|name| *name != decision.name()).collect();
    others.join(",")
}

/// What a frame leaves out, all that it may, must change nothing of it: to the last bit, but that far corners of
/// volumes that end are rounded otherwise. Then pixels may differ at edges of shadows, few, and neither is wrong there.
/// Gives the frame of which nothing is left out, and how many pixels were judged in the other.
fn assert_nothing_changes(session: &mut Session, scene: &Scene, all: &Capture) -> (Capture, u64) {
    let mut capture = |leave_out: &str| session.capture(scene, &auto(leave_out)).expect("a capture");
    let (unended, none) = (capture(&all_but(Decision::BeyondReceivers)), capture("none"));
    let changed = assert_differs_by_labels(scene, &unended, &none);
    assert!(changed == 0 || !adapter::draws_as_given(), "{}: {changed} labels differ", scene.name);
    let mut assert_right = |capture: &Capture, leave_out: &str| {
        let judged = session.judged(scene, capture, &Progress::default()).expect("a truth");
        adapter::assert_right(session, scene, &auto(leave_out), &judged, &leave_out);
        judged.error().expect("judged").compared
    };
    let compared = assert_right(all, "all");
    if assert_differs_by_labels(scene, all, &none) > 0 {
        assert_right(&none, "none");
    }
    (none, compared)
}

/// Frames that show the same wherever all labels are the same, which is almost everywhere: how many pixels differ.
fn assert_differs_by_labels(scene: &Scene, one: &Capture, other: &Capture) -> usize {
    let (of_one, of_other) = (labels(one), labels(other));
    let differs = |at: &usize| of_one.iter().zip(&of_other).any(|(one, other)| one[*at] != other[*at]);
    let (one, other) = (picture(one), picture(other));
    let pixels = (SIZE[0] * SIZE[1]) as usize;
    let texels = one.len() / pixels;
    let colors = |at: usize| [&one, &other].map(|picture| &picture[at * texels..(at + 1) * texels]);
    let differing = (0..pixels).filter(differs).count();
    let is_same = |at: &usize| differs(at) || colors(*at)[0] == colors(*at)[1];
    let recolored = (0..pixels).filter(|at| !is_same(at)).count();
    // A face that is seen edge-on may show on a coarse grid, and not where it is left out.
    let most = if adapter::draws_as_given() { 0 } else { 3 };
    assert!(recolored <= most, "{}: the picture differs in {recolored} pixels", scene.name);
    assert!(differing * 500 <= pixels, "{}: {differing} labels differ", scene.name);
    differing
}

/// What is left out of a scene, as `what of whom`; all of it, then nothing, must show the same, and be right.
fn left_out(session: &mut Session, scene: &Scene) -> Vec<String> {
    let all = session.capture(scene, &auto("all")).expect("a capture");
    assert_nothing_changes(session, scene, &all);
    all.left_out.iter().map(ToString::to_string).collect()
}

/// Asserts that `what` is left out in `taken` but not in `other`, a similar scene, and never where `decision` is
/// forbidden.
fn assert_decides(decision: Decision, what: &str, taken: &Scene, other: &Scene) {
    let mut session = session();
    let found = left_out(&mut session, taken);
    assert!(found.iter().any(|left| left == what), "{decision:?}: no `{what}` among {found:?}");
    let beside = left_out(&mut session, other);
    assert!(!beside.iter().any(|left| left == what), "{decision:?}: `{what}` is in {beside:?}");
    let without = session.capture(taken, &auto(&all_but(decision))).expect("a capture");
    assert!(!without.left_out.iter().any(|left| left.to_string() == what), "{decision:?}");
}

fn closed_box(name: &str, low: [f64; 3], high: [f64; 3]) -> Object {
    cuboid(name, low, high)
}

fn looking(scene: Scene, eye: [f64; 3], target: [f64; 3]) -> Scene {
    Scene { camera: Camera { fov_y_degrees: 50.0, near: 0.1, ..Camera::looking(eye, target) }, ..scene }
}

fn carried(mut scene: Scene, by: DVec3) -> Scene {
    scene.camera.eye += by;
    scene.camera.target += by;
    scene.objects.iter_mut().for_each(|object| object.pose.translate += by);
    scene.lights.iter_mut().filter(|light| !light.is_directional()).for_each(|light| light.position += by.extend(0.0));
    scene
}

#[test]
fn a_floor_with_nothing_behind_it_has_no_volume() {
    for by in [DVec3::ZERO, DVec3::new(1e6, -2e6, 5e5)] {
        let standing = carried(from_above(vec![closed_box("box", [-0.5, 0.0, -0.5], [0.5, 1.0, 0.5])]), by);
        for depth in [1e-9_f64, 0.3] {
            let depth = if by == DVec3::ZERO { depth } else { depth.max(1e-6) };
            let sunk = carried(from_above(vec![closed_box("box", [-0.5, -depth, -0.5], [0.5, 1.0, 0.5])]), by);
            assert_decides(Decision::Caster, "volume of floor", &standing, &sunk);
        }
    }
}

#[test]
fn a_volume_that_misses_the_view_is_not_drawn() {
    let aside = |towards: f64| {
        let far = closed_box("box", [20.0, 1.0, -0.5], [21.0, 2.0, 0.5]);
        under(Light::directional(DVec3::new(towards, 1.0, 0.0)), vec![far])
    };
    // Away from the view, and into it.
    assert_decides(Decision::View, "volume of box", &aside(-2.0), &aside(9.0));
}

#[test]
fn what_stands_in_anothers_umbra_casts_nothing_more() {
    let beneath =
        |x: f64| from_above(vec![square("board", 2.0, 1.0), closed_box("box", [x, 0.2, -0.2], [x + 0.4, 0.8, 0.2])]);
    assert_decides(Decision::Umbra, "volume of box", &beneath(-0.2), &beneath(1.4));
    // Exactly at the border, and within 1e-9 of it: the board's shadow ends at 1 at the sun's height.
    for off in [-1e-9, 0.0, 1e-9] {
        let under_sun = |x: f64| {
            let mut scene = beneath(x);
            scene.lights = vec![Light::directional(DVec3::Y)];
            scene
        };
        assert_decides(Decision::Umbra, "volume of box", &under_sun(0.5), &under_sun(0.6 + off));
    }
}

#[test]
fn a_part_in_the_umbra_of_another_part_casts_nothing_more() {
    // Under a sun straight above, so that the umbra ends where the outer box does.
    let nested = |offset: f64| {
        let [outer, inner] = [0.8, 0.4].map(|size| shapes::cuboid([size; 3]).expect("a box"));
        let both = shapes::joined([(&outer, DVec3::ZERO), (&inner, DVec3::new(offset, 0.0, 0.0))]).expect("two boxes");
        let mut boxes = Object::new("boxes", Arc::new(both), Material::default());
        boxes.pose.translate = DVec3::new(0.0, 1.5, 0.0);
        under(Light::directional(DVec3::Y), vec![boxes])
    };
    // The inner one's; where its side is in the outer one's, it casts.
    let what = "volume of parts (12 triangles) of boxes";
    assert_decides(Decision::Umbra, what, &nested(0.1), &nested(0.9));
    for off in [-1e-9, 0.0, 1e-9] {
        assert_decides(Decision::Umbra, what, &nested(0.1), &nested(0.2 + off));
        let far = |scene| carried(scene, DVec3::new(1e5, 0.0, -1e5));
        assert_decides(Decision::Umbra, what, &far(nested(0.1)), &far(nested(0.2 + off)));
    }
    let mut session = session();
    let judged = judged(&mut session, &nested(0.1), Technique::Auto, SIZE);
    assert_eq!(judged.lights[0].truth.as_ref().map(|truth| truth.error.wrong()), Some(0));
}

#[test]
fn two_boards_at_one_place_do_not_drop_each_other() {
    let scene = from_above(vec![square("one", 2.0, 1.0), square("other", 2.0, 1.0)]);
    let found = left_out(&mut session(), &scene);
    assert!(!found.iter().any(|left| left == "volume of one" || left == "volume of other"), "{found:?}");
}

#[test]
fn a_closed_mesh_casts_with_what_faces_the_light_alone() {
    let torus = |is_torn: bool| {
        let whole = shapes::torus(1.0, 0.3, 12, 8).expect("a torus");
        let triangles = &whole.triangles()[usize::from(is_torn)..];
        let positions: Vec<[f64; 3]> = whole.positions().iter().map(|p| [p.x, p.y + 1.5, p.z]).collect();
        from_above(vec![Object::new("torus", mesh(&positions, triangles), Material::default())])
    };
    let what = "triangles of torus that face away";
    assert_decides(Decision::AwayTriangles, what, &torus(false), &torus(true));
}

/// A rotated room whose walls face the sun overhead by a rounding of their places: what faces the light alone lost the
/// whole shadow.
#[test]
fn a_wall_that_is_edge_on_keeps_all_triangles() {
    let mut room = cuboid("room", [-3.0, -3.0, -3.0], [3.0, 3.0, 3.0]);
    room.pose.rotate_degrees = DVec3::new(90.0, 0.0, 0.0);
    let scene = under(Light::directional(DVec3::Y), vec![room]);
    let scene = looking(scene, [0.5, 1.0, 2.0], [0.0, 0.5, -2.0]);
    let found = left_out(&mut session(), &scene);
    assert!(!found.iter().any(|left| left == "triangles of room that face away"), "{found:?}");
}

/// Depth with few bits ties what is apart, and a far plane cuts volumes: there nothing is left out that a
/// depth might miss.
#[test]
fn other_depths_leave_out_nothing_that_asks_for_depth() {
    let mut session = session();
    let scene = from_above(vec![ball(10, 1.0, [2.0, 2.0, 0.0])]);
    for depth in ["standard-infinite", "standard-finite", "standard-finite-clamp"] {
        let with = |leave_out: &str| request_with(Technique::Auto, &[("leave-out", leave_out), ("depth", depth)], SIZE);
        let [all, none] = ["all", "none"].map(|what| session.capture(&scene, &with(what)).expect("a capture"));
        assert_eq!(labels(&all), labels(&none), "{depth}");
        assert!(picture(&all) == picture(&none), "{depth}");
        assert!(!all.left_out.iter().any(|left| left.decision == Some(Decision::Caps)), "{depth}");
    }
}

/// The eye stands beside a shadow, and in it.
#[test]
fn who_cannot_hold_the_eye_needs_no_caps() {
    let seen_from = |x: f64| {
        let scene = from_above(vec![closed_box("box", [-0.5, 2.0, -0.5], [0.5, 2.5, 0.5])]);
        looking(scene, [x, 0.5, 2.0], [0.0, 0.3, -1.0])
    };
    let above = |x: f64| Scene { lights: vec![Light::point(DVec3::new(0.0, 4.0, -1.0))], ..seen_from(x) };
    assert_decides(Decision::Caps, "caps of box", &above(3.0), &above(0.2));
}

/// The caster is behind the eye, and its shadow falls over it.
#[test]
fn a_caster_that_is_not_in_view_needs_no_light_cap() {
    let seen_to = |z: f64| {
        let wall = closed_box("wall", [-6.0, 0.0, -6.0], [6.0, 6.0, -5.0]);
        let board =
            mesh(&[[-0.5, 0.8, 4.0], [0.5, 0.8, 4.0], [0.5, 2.0, 4.0], [-0.5, 2.0, 4.0]], &[[0, 1, 2], [0, 2, 3]]);
        let scene = from_above(vec![wall, Object::new("board", board, Material::default())]);
        let scene = looking(scene, [0.0, 1.4, 3.0], [0.0, 1.4, z]);
        Scene { lights: vec![Light::point(DVec3::new(0.0, 1.5, if z < 3.0 { 8.0 } else { 1.0 }))], ..scene }
    };
    assert_decides(Decision::LightCap, "light cap of board", &seen_to(-5.0), &seen_to(9.0));
}

/// The light is overhead, so the far end is below the floor.
#[test]
fn a_far_end_out_of_view_is_not_closed() {
    let looks_to = |target: [f64; 3]| {
        let scene = from_above(vec![closed_box("box", [-0.5, 2.0, -0.5], [0.5, 2.5, 0.5])]);
        let scene = looking(scene, [0.1, 1.0, 0.1], target);
        Scene { lights: vec![Light::point(DVec3::new(0.0, 6.0, 0.0))], ..scene }
    };
    assert_decides(Decision::DarkCap, "dark cap of box", &looks_to([4.0, 1.2, 4.0]), &looks_to([0.3, 0.0, 0.2]));
}

#[test]
fn a_surface_out_of_view_is_not_drawn() {
    let beside = |x: f64| from_above(vec![closed_box("box", [x, 0.0, -0.5], [x + 1.0, 1.0, 0.5])]);
    assert_decides(Decision::Surfaces, "surface of box", &beside(20.0), &beside(2.0));
}

fn ball(rings: u32, radius: f64, at: [f64; 3]) -> Object {
    let shape = shapes::sphere(radius, 2 * rings, rings).expect("a sphere");
    let mut ball = Object::new("ball", Arc::new(shape), Material::default());
    ball.pose.translate = DVec3::from_array(at);
    ball
}

#[test]
fn the_far_side_of_a_closed_surface_is_not_drawn() {
    // In view as a whole; the second is cut by the near plane.
    let whole = from_above(vec![ball(10, 1.0, [0.0, 2.0, 0.0])]);
    let cut = from_above(vec![ball(10, 1.0, [0.0, 9.05, 0.0])]);
    let mut session = session();
    let hidden =
        |found: &[String]| found.iter().any(|left| left.ends_with("triangles of ball that face away from the eye"));
    assert!(hidden(&left_out(&mut session, &whole)));
    assert!(!hidden(&left_out(&mut session, &cut)));
}

#[test]
fn a_light_is_not_added_to_what_faces_away_from_it() {
    let scene = from_above(vec![ball(10, 1.0, [2.0, 2.0, 0.0])]);
    let mut session = session();
    let unlit = |left: &String| left.ends_with("triangles that face away, in the pass of light 1");
    assert!(left_out(&mut session, &scene).iter().any(unlit));
    let wrapped = request_with(Technique::Auto, &[("leave-out", "all"), ("diffuse", "wrapped")], SIZE);
    let capture = session.capture(&scene, &wrapped).expect("a capture");
    assert!(!capture.left_out.iter().any(|left| unlit(&left.to_string())));
}

#[test]
fn a_light_that_all_in_view_faces_away_from_has_no_passes() {
    let sun = |y: f64| under(Light::directional(DVec3::new(0.3, y, 0.1)), vec![]);
    assert_decides(Decision::Light, "all passes of light 1", &sun(-1.0), &sun(1.0));
}

/// Where a count may pass what eight bits hold, and one below.
#[test]
fn a_count_beyond_eight_bits_is_stored_in_a_float() {
    let mut session = session();
    let mut stack = |count: u32| {
        let boards = (0..count).map(|i| square(&format!("board {i}"), 2.0 - f64::from(i) / 1000.0, 1.0)).collect();
        let mut scene = from_above(boards);
        // Two triangles a board, of which a ray hits one or, on their edge, both.
        scene.lights = vec![Light::point(DVec3::new(0.1, 4.0, 0.2))];
        let capture = session.capture(&scene, &auto("caster")).expect("a capture");
        let full = judged(&mut session, &scene, Technique::Auto, SIZE);
        assert_eq!(full.lights[0].truth.as_ref().map(|truth| truth.error.wrong()), Some(0), "{count}");
        counts_in_float(&capture)
    };
    assert!(!stack(100));
    assert!(stack(256));
}

fn counts_in_float(capture: &Capture) -> bool {
    let is_of_count =
        |step: &Step| matches!(&step.snapshot, Snapshot::Frame(frame) if frame.target == FrameTarget::Count);
    capture.steps.iter().any(is_of_count)
}

/// What faces away casts nothing where that is proven: 150 closed shells count 150, and fit.
#[test]
fn shells_whose_far_sides_cast_nothing_count_once_each() {
    let mut session = session();
    let boxes = (0..150).map(|index| shapes::cuboid([1.0 - f64::from(index) * 2e-3; 3]).expect("a box"));
    let boxes: Vec<Mesh> = boxes.collect();
    let joined = shapes::joined(boxes.iter().map(|one| (one, DVec3::Y * 1.5))).expect("boxes");
    let mut scene = from_above(vec![Object::new("boxes", Arc::new(joined), Material::default())]);
    // Beside them: under it, a ray could run down the diagonals of all tops.
    scene.lights = vec![Light::point([2.0, 4.0, 0.9])];
    let of = |capture: &Capture| capture.left_out.iter().any(|left| left.decision == Some(Decision::EightBits));
    for (leave_out, in_float) in [("all", false), ("away-triangles", false), ("caster", true), ("none", true)] {
        let capture = session.capture(&scene, &auto(leave_out)).expect("a capture");
        assert_eq!(
            (counts_in_float(&capture), of(&capture)),
            (in_float, in_float),
            "{leave_out}: {:?}",
            capture.left_out
        );
    }
}

/// Every built-in scene from random places: `auto` is right, says what z-fail says, and leaves out nothing
/// that shows.
#[test]
fn from_any_place_auto_shows_what_z_fail_shows() {
    let names: Vec<&str> = builtin::ALL.iter().map(|of| of.name).collect();
    apart("auto::from_any_place_auto_shows_what_z_fail_shows", &names, from_any_place);
}

fn from_any_place(name: &str) {
    const CAMERAS: u64 = 20;
    let index = builtin::ALL.iter().position(|of| of.name == name).expect("a scene");
    let start = builtin::ALL[index].scene().expect("a scene");
    let (mut session, mut compared) = (session(), 0);
    for camera in 0..20 * CAMERAS {
        let seen = start.camera.anywhere(1000 * index as u64 + camera);
        let scene = Scene { camera: seen, name: format!("{name}, camera {camera}"), ..start.clone() };
        let all = session.capture(&scene, &auto("all")).expect("a capture");
        let (none, judged) = assert_nothing_changes(&mut session, &scene, &all);
        if judged == 0 {
            // From behind a wall, nothing lit or dark is seen.
            continue;
        }
        let z_fail = session.capture(&scene, &request(Technique::ZFail, SIZE)).expect("a capture");
        // `gate` wraps.
        if name != "gate" {
            let differing = assert_differs_by_labels(&scene, &none, &z_fail);
            assert!(differing == 0 || !adapter::draws_as_given(), "{}: {differing} labels differ", scene.name);
        }
        compared += 1;
        if compared == CAMERAS {
            return;
        }
    }
    panic!("{name}: {compared} cameras see something");
}
