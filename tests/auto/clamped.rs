//! Volumes that end beyond all that receives.

use super::{SIZE, assert_decides, auto, left_out, looking};
use crate::common::random::Random;
use crate::common::{cuboid, from_above, judged, session, square};
use glam::{DVec3, DVec4};
use stencilscope::plan::Decision;
use stencilscope::scene::{Camera, Light, Object, Projection, Scene, shapes};
use stencilscope::session::Session;
use stencilscope::technique::Technique;

const WHAT: &str = "far part of the volume of box";

fn box_under(light: Light, others: Vec<Object>) -> Scene {
    let caster = cuboid("box", [-0.5, 1.0, -0.5], [0.5, 2.0, 0.5]);
    let mut scene = from_above([vec![caster], others].concat());
    scene.lights = vec![light];
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

/// How many pixels were judged, of which none is wrong.
fn assert_right(session: &mut Session, scene: &Scene) -> u64 {
    let judged = judged(session, scene, Technique::Auto, SIZE);
    let error = judged.lights[0].truth.as_ref().expect("a truth").error;
    assert_eq!(error.wrong(), 0, "{error:?} from {:?}", scene.camera);
    error.compared
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
    let in_vain: [fn(&mut Object, &mut Light); 3] =
        [|floor, _| floor.receives = false, |floor, _| floor.visible = false, |_, light| light.range = Some(6.0)];
    for change in in_vain {
        let scene = with_lower(change);
        assert_right(&mut session, &scene);
        let reached = lowest(&mut session, &scene);
        assert!((-1.1..0.0).contains(&reached), "{reached}");
    }
}

/// Lines of sight from below the floor are looked along too.
#[test]
fn it_ends_no_nearer_than_the_eye() {
    let below = looking(box_under(lamp(), vec![]), [9.0, -2.0, 0.0], [0.0, 1.5, 0.0]);
    let mut session = session();
    left_out(&mut session, &below);
    let reached = lowest(&mut session, &below);
    assert!((-2.2..-2.0).contains(&reached), "{reached}");
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
        let boxes: Vec<Object> = boxes.collect();
        let place = anywhere(4.0);
        let light = if round % 3 == 0 { Light::directional(place) } else { Light::point(place) };
        let (eye, target) = (anywhere(4.5), anywhere(2.0));
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
