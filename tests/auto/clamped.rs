//! Volumes that end beyond all that receives.

use super::{SIZE, all_but, assert_decides, assert_differs_by_labels, auto, left_out, looking};
use crate::common::random::Random;
use crate::common::{adapter, cuboid, from_above, judged, mesh, request, session, square, under};
use glam::{DVec3, DVec4};
use stencilscope::plan::Decision;
use stencilscope::scene::{Camera, Light, Object, Projection, Scene, shapes};
use stencilscope::session::Session;
use stencilscope::technique::Technique;

const WHAT: &str = "far part of the volume of box";

fn box_under(light: Light, others: Vec<Object>) -> Scene {
    let caster = cuboid("box", [-0.5, 1.0, -0.5], [0.5, 2.0, 0.5]);
    let scene = under(light, [vec![caster], others].concat());
    looking(scene, [4.0, 5.0, 6.0], [0.0, 0.5, 0.0])
}

fn lamp() -> Light {
    Light::point([1.0, 5.0, 0.0])
}

/// Where the volume's vertices are, world space, homogeneous.
fn vertices(session: &mut Session, scene: &Scene) -> Vec<DVec4> {
    let plan = session.plan(scene, &auto("all")).expect("a plan");
    let volume = plan.meshes.iter().find(|mesh| mesh.name == "volume of box").expect("a volume");
    let place = |vertex: &[f32; 4]| {
        let relative = DVec4::from_array(vertex.map(f64::from));
        relative + (scene.camera.eye * relative.w).extend(0.0)
    };
    volume.vertices.data().iter().map(place).collect()
}

/// The lowest of them; none lies at infinity.
fn lowest(session: &mut Session, scene: &Scene) -> f64 {
    let vertices = vertices(session, scene);
    assert!(vertices.iter().all(|vertex| vertex.w == 1.0), "{vertices:?}");
    vertices.iter().map(|vertex| vertex.y).fold(f64::INFINITY, f64::min)
}

/// Where volumes end, as it is said.
fn ends(session: &mut Session, scene: &Scene) -> Vec<String> {
    let plan = session.plan(scene, &auto("all")).expect("a plan");
    let ended = plan.left_out.iter().filter(|left| left.decision == Some(Decision::BeyondReceivers));
    ended.map(|left| left.because.clone()).collect()
}

/// How many pixels were judged, of which none is wrong.
fn assert_right(session: &mut Session, scene: &Scene) -> u64 {
    let judged = judged(session, scene, Technique::Auto, SIZE);
    adapter::assert_right(session, scene, &request(Technique::Auto, SIZE), &judged, &"auto");
    judged.error().expect("judged").compared
}

/// What is counted behind surfaces goes on to infinity.
#[test]
fn a_volume_that_is_counted_in_front_ends_below_the_floor() {
    for light in [lamp(), Light::directional([1.0, 5.0, 0.0])] {
        let in_front = box_under(light.clone(), vec![]);
        let (eye, target) = ([0.1, 0.5, 0.0], [-3.0, 0.4, 1.0]);
        assert_decides(Decision::BeyondReceivers, WHAT, &in_front, &looking(in_front.clone(), eye, target));
        let lowest = lowest(&mut session(), &in_front);
        assert!((-0.1..0.0).contains(&lowest), "{lowest}");
    }
}

/// A lower floor is reached where its shadow is looked at: where it shows, receives, and the lamp's light gets there.
#[test]
fn it_ends_where_nothing_is_looked_at() {
    let mut session = session();
    let with_lower = |change: fn(&mut Object, &mut Light)| {
        let (mut floor, mut light) = (square("lower floor", -3.0, 90.0), lamp());
        change(&mut floor, &mut light);
        let mut scene = box_under(light, vec![floor]);
        scene.objects.iter_mut().filter(|object| object.name == "floor").for_each(|floor| floor.pose.scale *= 0.01);
        scene
    };
    let seen = with_lower(|_, _| {});
    assert_right(&mut session, &seen);
    let reached = lowest(&mut session, &seen);
    assert!((-3.1..-3.0).contains(&reached), "{reached}");
    type Change = fn(&mut Object, &mut Light);
    let in_vain: [(Change, f64, &str); 3] = [
        (|floor, _| floor.receives = false, 0.0, "receives have"),
        (|floor, _| floor.visible = false, 0.0, "receives have"),
        (|_, light| light.range = Some(6.0), -1.0, "receives within the range of light 1 have"),
    ];
    for (change, end, because) in in_vain {
        let scene = with_lower(change);
        assert_right(&mut session, &scene);
        let reached = lowest(&mut session, &scene);
        assert!((end - 0.1..end).contains(&reached), "{reached}");
        assert!(ends(&mut session, &scene).iter().any(|reason| reason.contains(because)), "{because}");
        let [all, unended] = ["all".to_owned(), all_but(Decision::BeyondReceivers)]
            .map(|leave_out| session.capture(&scene, &auto(&leave_out)).expect("a capture"));
        assert_differs_by_labels(&scene, &all, &unended);
    }
}

/// View rays from below the floor are followed too.
#[test]
fn it_ends_no_nearer_than_the_eye() {
    let below = looking(box_under(lamp(), vec![]), [9.0, -2.0, 0.0], [0.0, 1.5, 0.0]);
    let mut session = session();
    left_out(&mut session, &below);
    let reached = lowest(&mut session, &below);
    assert!((-2.2..-2.0).contains(&reached), "{reached}");
}

/// Straight below what lies beside the view, the view is only under the floor.
#[test]
fn what_ends_before_it_is_in_view_is_not_drawn() {
    let aside = |lower: Vec<Object>| {
        let high = cuboid("box", [14.5, 1.0, -0.5], [15.5, 2.0, 0.5]);
        under(Light::directional([0.0, 1.0, 0.0]), [vec![high], lower].concat())
    };
    let beside = aside(vec![]);
    assert_decides(Decision::View, "volume of box", &beside, &aside(vec![square("lower floor", -3.0, 90.0)]));
    let plan = session().plan(&beside, &auto("all")).expect("a plan");
    let because = plan.left_out.iter().find(|left| left.to_string() == "volume of box").map(|left| &*left.because);
    let because = because.expect("a reason");
    assert!(because.starts_with("it needs to reach to y = −0.0") && because.ends_with("side"), "{because}");
}

/// Something receives behind it, but that is out of view.
#[test]
fn what_lies_beyond_all_that_is_looked_at_has_no_volume() {
    let mut scene = from_above(vec![cuboid("box", [-0.5, -2.5, -0.5], [0.5, -2.0, 0.5]), square("lower", -3.0, 1.0)]);
    scene.objects.iter_mut().filter(|object| object.name == "box").for_each(|object| object.receives = false);
    let lower = scene.objects.iter_mut().filter(|object| object.name == "lower");
    lower.for_each(|lower| lower.pose.translate.x += 40.0);
    scene.objects.iter_mut().for_each(|object| object.casts = object.name == "box");
    let mut session = session();
    left_out(&mut session, &scene);
    let plan = session.plan(&scene, &auto("all")).expect("a plan");
    let of_box = plan.left_out.iter().find(|left| left.to_string() == "volume of box").expect("no volume");
    assert_eq!(of_box.decision, Some(Decision::Caster));
    assert!(of_box.because.starts_with("it lies beyond y = −0.0"), "{}", of_box.because);
}

/// The mesh has more than 4096 vertices: then its bounding box is looked at in their place.
#[test]
fn a_large_mesh_that_is_half_below_the_floor_ends_there_too() {
    let torus = shapes::torus(1.5, 0.6, 96, 64).expect("a mesh");
    assert!(torus.positions().len() > 4096);
    let scene = |height: f64| {
        let mut torus = Object::of("box", torus.clone());
        torus.pose.translate.y = height;
        let mut scene = from_above(vec![torus]);
        scene.objects.iter_mut().for_each(|object| object.casts = object.name == "box");
        scene.lights = vec![lamp()];
        looking(scene, [4.0, 5.0, 6.0], [0.0, 0.5, 0.0])
    };
    let mut session = session();
    for height in [0.0, 0.5, 1.5] {
        let scene = scene(height);
        assert_right(&mut session, &scene);
        assert_eq!(ends(&mut session, &scene).len(), 1);
    }
}

#[test]
fn rays_that_leave_by_no_side_go_on_to_infinity() {
    // The lamp is within the box around the caster, which is bent round it.
    let mut scene = box_under(Light::point([0.0, 1.5, 0.0]), vec![]);
    let [one, other] = [[[-0.5, 1.0, -0.5], [0.5, 1.1, 0.5]], [[-0.5, 1.1, -0.5], [-0.4, 2.0, 0.5]]]
        .map(|[low, high]| cuboid("part", low, high).mesh);
    let bent = shapes::joined([(&*one, DVec3::ZERO), (&*other, DVec3::ZERO)]).expect("a mesh");
    scene.objects.iter_mut().filter(|object| object.name == "box").for_each(|object| {
        *object = Object::of("box", bent.clone());
    });
    let mut session = session();
    let found = left_out(&mut session, &scene);
    assert!(!found.iter().any(|left| left == WHAT), "{found:?}");
    assert!(vertices(&mut session, &scene).iter().any(|vertex| vertex.w == 0.0));
}

/// What touches ends on one plane, or goes on to infinity: else the edges that two volumes share round apart.
#[test]
fn casters_that_touch_end_together_or_not_at_all() {
    let mut session = session();
    let room = || {
        let mut room = cuboid("room", [-4.0, 0.0, -4.0], [4.0; 3]);
        room.casts = false;
        room
    };
    let scene = |casters: Vec<Object>, lamp: [f64; 3]| {
        let mut scene = from_above([casters, vec![room()]].concat());
        scene.objects.retain(|object| object.name != "floor");
        scene.lights = vec![Light::point(lamp)];
        looking(scene, [3.5, 3.5, 3.5], [0.0, 1.0, 0.0])
    };
    let (low, high) = ([0.0, 1.0], [1.0, 2.0]);
    let cell = |name: &str, [from, to]: [f64; 2]| cuboid(name, [-0.5, from, -0.5], [0.5, to, 0.5]);
    // The higher one would leave by a nearer wall.
    let lamp = [-1.5, 2.1, 0.0];
    let alone = [low, high].map(|at| ends(&mut session, &scene(vec![cell("one", at)], lamp)));
    assert_ne!(alone[0], alone[1]);
    let stacked = scene(vec![cell("low", low), cell("high", high)], lamp);
    let together = ends(&mut session, &stacked);
    assert!(together.len() == 2 && together[0] == together[1], "{together:?}");
    assert_right(&mut session, &stacked);
    // Apart they are on their own again.
    let apart = ends(&mut session, &scene(vec![cell("low", [0.0, 0.9]), cell("high", high)], lamp));
    assert!(apart.len() == 2 && apart[0] != apart[1], "{apart:?}");
    // A volume that the eye is in is counted behind, to infinity, and what touches it goes there too.
    let shading = |low: f64| cuboid("shading", [low, 1.5, -0.5], [1.5, 2.0, 0.5]);
    let seen_from = |casters: Vec<Object>| {
        let mut scene = scene(casters, [0.0, 3.8, 0.0]);
        (scene.camera.eye, scene.camera.target) = (DVec3::new(1.5, 0.6, 0.6), DVec3::new(-1.5, 0.3, -0.5));
        scene
    };
    let beside = cuboid("beside", [-0.5, 1.5, -0.5], [0.5, 2.0, 0.5]);
    let touching = seen_from(vec![shading(0.5), beside.clone()]);
    assert_eq!(ends(&mut session, &touching), Vec::<String>::new());
    assert_right(&mut session, &touching);
    assert_eq!(ends(&mut session, &seen_from(vec![shading(0.6), beside])).len(), 1);
}

/// A bent sheet of patches, each an object of its own: not a speck of light along their seams.
#[test]
fn shadows_of_casters_that_touch_have_no_seams() {
    let mut session = session();
    let mut random = Random::new(40);
    let (mut ended, mut compared) = (0, 0);
    for round in 0..60 {
        let mut anywhere = |reach: f64| random.within(reach);
        let (middle, step) = (anywhere(2.0), anywhere(1.0).abs() + 0.2);
        let corners: Vec<[f64; 3]> = (0..9)
            .map(|index| DVec3::new(f64::from(index % 3) - 1.0, 0.0, f64::from(index / 3) - 1.0) * step)
            .map(|along| (middle + along + anywhere(0.3)).to_array())
            .collect();
        let patch = |index: usize| {
            let first = index / 2 * 3 + index % 2;
            let corners = [0, 3, 4, 1].map(|beside| corners[first + beside]);
            Object::of(format!("patch {index}"), mesh(&corners, &[[0, 1, 2], [0, 2, 3]]))
        };
        let place = anywhere(4.5);
        let (eye, target) = (anywhere(4.5), anywhere(1.0));
        let mut room = cuboid("room", [-5.0; 3], [5.0; 3]);
        room.casts = false;
        let mut scene = from_above((0..4).map(patch).chain([room]).collect());
        scene.objects.retain(|object| object.name != "floor");
        scene.lights = vec![if round % 3 == 0 { Light::directional(place) } else { Light::point(place) }];
        scene.camera = Camera { eye, target, ..scene.camera };
        ended += ends(&mut session, &scene).len();
        let judged = judged(&mut session, &scene, Technique::Auto, [4 * SIZE[0], 4 * SIZE[1]]);
        let error = judged.lights[0].truth.as_ref().expect("a truth").error;
        assert_eq!(error.wrong(), 0, "{round}: {error:?} from {:?}, lit from {place}", scene.camera);
        compared += error.compared;
    }
    assert!(ended > 60 && compared > 500_000, "{ended} volumes, {compared} pixels");
}

/// Boxes about a room, seen and lit from anywhere in it: no pixel is wrong, and most volumes end.
#[test]
fn shadows_stay_right_wherever_volumes_end() {
    let mut session = session();
    let mut random = Random::new(27);
    let (mut ended, mut drawn, mut compared) = (0, 0, 0);
    for round in 0..60 {
        let mut anywhere = |reach: f64| random.within(reach);
        let boxes = (0..3).map(|index| {
            let (middle, half) = (anywhere(3.0), anywhere(1.0).abs() + 0.01);
            cuboid(&format!("box {index}"), (middle - half).to_array(), (middle + half).to_array())
        });
        let mut boxes: Vec<Object> = boxes.collect();
        // Not all of them show and receive; some are seen from without the room, and some lamps fade.
        boxes[0].receives = round % 2 == 0;
        boxes[1].visible = round % 5 != 1;
        let place = anywhere(4.0);
        let mut light = if round % 3 == 0 { Light::directional(place) } else { Light::point(place) };
        light.range = (round % 3 == 1).then_some(anywhere(6.0).abs().x + 2.0);
        let (eye, target) = (anywhere(if round % 7 == 2 { 9.0 } else { 4.5 }), anywhere(2.0));
        let projection = match round % 4 {
            0 => Projection::Orthographic { half_height: 3.0 },
            _ => Projection::Perspective,
        };
        let mut scene = from_above(boxes);
        scene.objects.push(cuboid("room", [-5.0; 3], [5.0; 3]));
        scene.objects.iter_mut().filter(|object| object.name == "room").for_each(|room| room.casts = false);
        scene.lights = vec![light];
        scene.camera = Camera { eye, target, projection, ..scene.camera };
        let capture = session.capture(&scene, &auto("all")).expect("a capture");
        let of = |decision| capture.left_out.iter().filter(|left| left.decision == Some(decision)).count();
        ended += of(Decision::BeyondReceivers);
        drawn += of(Decision::Caps);
        compared += assert_right(&mut session, &scene);
    }
    assert!(ended > drawn / 2 && ended > 40 && compared > 60_000, "{ended} of {drawn} volumes, {compared} pixels");
}
