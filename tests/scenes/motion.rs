//! Things that move, and things that are mirrored, stretched and rotated.

use crate::common::{adapter, from_above, judged, judged_by, opened, request, session, square};
use glam::{DMat4, DVec3};
use std::sync::Arc;
use stencilscope::accuracy::compare;
use stencilscope::progress::Progress;
use stencilscope::scene::shapes;
use stencilscope::scene::{Light, Material, Mesh, MeshBuilder, Motion, Object, Orbit, Pose, Scene, Swing};
use stencilscope::technique::Technique;
use stencilscope::truth::Tracer;

const SIZE: [u32; 2] = [96, 72];

const SWING: Swing =
    Swing { pivot: DVec3::new(1.0, 5.0, 2.0), axis: DVec3::new(0.0, 0.0, 3.0), degrees: 30.0, period_seconds: 4.0 };

/// A metre of cord: half a metre to the side at a quarter of the period, and back after a half.
#[test]
fn a_swing_is_a_pendulum() {
    let motion = Motion { swing: Some(SWING), ..Motion::default() };
    let rest = Pose { translate: SWING.pivot - DVec3::Y, ..Pose::default() };
    assert_eq!(motion.apply(&rest, 0.0), rest);
    let at_end = motion.apply(&rest, 1.0);
    // Counter-clockwise about z: what hangs moves to the right first.
    let side = SWING.pivot + DVec3::new(0.5, -(3f64.sqrt() / 2.0), 0.0);
    assert!(at_end.translate.distance(side) < 1e-12, "{at_end:?}");
    assert!(at_end.rotate_degrees.distance(DVec3::new(0.0, 0.0, 30.0)) < 1e-9, "{at_end:?}");
    let other_end = motion.apply(&rest, 3.0).translate;
    assert!(other_end.distance(side - DVec3::X) < 1e-12, "{other_end}");
    assert!(motion.apply(&rest, 2.0).translate.distance(rest.translate) < 1e-12);
    let light = rest.translate.extend(1.0);
    assert!(motion.apply_to_light(light, 1.0).distance(side.extend(1.0)) < 1e-12);
    let down = DVec3::NEG_Y.extend(0.0);
    assert!(motion.apply_to_light(down, 1.0).distance((side - SWING.pivot).extend(0.0)) < 1e-12);
    assert!(!motion.is_still());
    assert!(Motion { swing: Some(Swing { degrees: 0.0, ..SWING }), ..Motion::default() }.is_still());
}

/// Whatever its pose and spin, a swinging object is its unswung self rotated about the pivot.
#[test]
fn a_swing_turns_the_whole_object() {
    let spin = DVec3::new(11.0, -40.0, 25.0);
    let pose = Pose {
        translate: DVec3::new(0.3, 3.1, 2.5),
        rotate_degrees: DVec3::new(20.0, 130.0, -70.0),
        scale: DVec3::new(1.0, -2.0, 0.5),
    };
    let swing = Swing { axis: DVec3::new(0.4, 1.0, -0.8), ..SWING };
    for seconds in [0.3, 1.0, 2.9, 7.7] {
        let unswung = Motion { spin_degrees_per_second: spin, ..Motion::default() }.apply(&pose, seconds);
        let swung = Motion { spin_degrees_per_second: spin, swing: Some(swing), ..Motion::default() };
        let angle = 30f64.to_radians() * (std::f64::consts::FRAC_PI_2 * seconds).sin();
        let turn = DMat4::from_translation(swing.pivot)
            * DMat4::from_axis_angle(swing.axis.normalize(), angle)
            * DMat4::from_translation(-swing.pivot);
        let expected = turn * unswung.world_from_object();
        let found = swung.apply(&pose, seconds).world_from_object();
        assert!(found.abs_diff_eq(expected, 1e-12), "{seconds} s: {found} is not {expected}");
    }
}

/// The lamp of the tiger cage: the bulb stays where it is in the shade.
#[test]
fn a_lamp_and_its_light_swing_together() {
    let start = opened("tiger-cage");
    let bulb_in_lamp = |scene: &Scene| {
        let lamp = scene.objects.iter().find(|object| object.name == "lamp").expect("a lamp");
        lamp.pose.world_from_object().inverse().transform_point3(scene.lights[0].position.truncate())
    };
    let at_rest = bulb_in_lamp(&start);
    let mut farthest = 0f64;
    for step in 0..20 {
        let moved = start.at(f64::from(step) * 0.23);
        assert!(bulb_in_lamp(&moved).distance(at_rest) < 1e-12);
        farthest = farthest.max(moved.lights[0].position.distance(start.lights[0].position));
    }
    assert!(farthest > 0.25, "{farthest}");
}

fn with_pose(name: &str, mesh: &Arc<Mesh>, pose: Pose) -> Object {
    Object { pose, ..Object::new(name, Arc::clone(mesh), Material::default()) }
}

/// A mirrored, a stretched and a rotated caster, one that orbits and spins, and lights that orbit.
fn moving_scene() -> Scene {
    let torus = Arc::new(shapes::torus(0.6, 0.25, 24, 14).expect("a torus"));
    let flight = Arc::new(shapes::stairs(4, 0.2, 0.25, 0.7).expect("stairs"));
    let at = DVec3::new;
    let mut scene = from_above(vec![
        with_pose(
            "mirrored",
            &flight,
            Pose { scale: at(-1.3, 1.0, 1.0), translate: at(-1.5, 0.3, 0.4), ..Pose::default() },
        ),
        with_pose(
            "stretched",
            &torus,
            Pose { scale: at(0.4, 2.2, 1.1), rotate_degrees: at(30.0, 0.0, 70.0), translate: at(1.8, 1.0, -1.0) },
        ),
        with_pose(
            "turned inside out",
            &flight,
            Pose { scale: at(-1.0, -1.0, -1.0), rotate_degrees: at(0.0, 140.0, 15.0), translate: at(0.3, 1.9, 1.9) },
        ),
        with_pose("orbiting", &torus, Pose { translate: at(0.9, 2.0, 0.2), ..Pose::default() }),
    ]);
    let orbit = |axis, degrees_per_second| Some(Orbit { center: DVec3::Y, axis, degrees_per_second });
    scene.objects[4].motion = Motion {
        spin_degrees_per_second: at(50.0, 20.0, 0.0),
        orbit: orbit(at(0.2, 1.0, 0.0), 45.0),
        ..Motion::default()
    };
    scene.camera.eye = at(4.5, 4.0, 5.5);
    scene.camera.target = at(0.0, 0.8, 0.0);
    scene.camera.up = DVec3::Y;
    scene.camera.fov_y_degrees = 50.0;
    scene.lights = vec![
        Light {
            motion: Motion { orbit: orbit(DVec3::Y, -60.0), ..Motion::default() },
            ..Light::point(at(2.0, 4.5, 1.0))
        },
        Light {
            motion: Motion { orbit: orbit(at(1.0, 3.0, 0.0), 30.0), ..Motion::default() },
            ..Light::directional(at(-0.6, 1.0, 0.3))
        },
    ];
    scene
}

#[test]
fn z_fail_is_right_whatever_is_mirrored_stretched_rotated_and_moved() {
    let mut session = session();
    let scene = moving_scene();
    for seconds in [0.0, 0.9, 2.3, 4.1, 8.8] {
        let (scene, request) = (scene.at(seconds), request(Technique::ZFail, SIZE));
        let capture = judged_by(&mut session, &scene, &request);
        adapter::assert_right(&mut session, &scene, &request, &capture, &format!("{seconds} s"));
        for light in &capture.lights {
            let labels = light.truth.as_ref().expect("judged").labels.histogram();
            assert!(labels[0] >= 300 && labels[1] >= 100, "{seconds} s: {:?}", &labels[..4]);
        }
    }
}

/// A mesh of mirrored points in a mirrored object is the mesh itself, to the bit.
#[test]
fn mirrored_twice_is_not_mirrored() {
    let mut session = session();
    let scene = moving_scene();
    let mut twice = scene.clone();
    for object in &mut twice.objects {
        let positions = object.mesh.positions().iter().map(|p| *p * DVec3::new(-1.0, 1.0, 1.0)).collect();
        let builder = MeshBuilder { positions, triangles: object.mesh.triangles().to_vec(), ..MeshBuilder::default() };
        object.mesh = Arc::new(builder.build().expect("a mesh"));
        object.pose.scale.x *= -1.0;
    }
    for technique in [Technique::ZPass, Technique::ZFail] {
        let [once, twice] = [&scene, &twice].map(|scene| judged(&mut session, scene, technique, SIZE));
        for (once, twice) in once.lights.iter().zip(&twice.lights) {
            assert!(once.shadow == twice.shadow, "{technique:?}");
            assert!(once.truth.as_ref().map(|t| &t.labels) == twice.truth.as_ref().map(|t| &t.labels));
        }
    }
}

/// A directional light is where a point light that goes away ends up: at 1e9 times the scene's
/// size both say the same, but for pixels that the truth excuses.
#[test]
fn a_directional_light_is_a_point_light_far_away() {
    let mut session = session();
    let step = session.profile().expect("a profile").subpixel();
    let mut panel = from_above(vec![square("panel", 2.0, 1.5)]);
    panel.camera.eye = DVec3::new(6.0, 7.0, 3.0);
    panel.camera.up = DVec3::Y;
    let scenes = ["table", "steps", "teapot-like", "tetrahedron", "inside"].map(opened);
    for scene in scenes.into_iter().chain([panel, moving_scene()]) {
        for towards in [DVec3::new(0.7, 1.3, -0.4), DVec3::new(-0.9, 0.6, 0.8)] {
            let under = |light: Light| Scene { lights: vec![light], ..scene.clone() };
            let size = scene.camera.eye.distance(scene.camera.target);
            let sun = under(Light::directional(towards));
            let lamp = under(Light::point(scene.camera.target + towards * size * 1e9));
            let tracer = Tracer::new(&sun, SIZE).expect("a tracer");
            let truth = tracer.trace(&Progress::default()).expect("a truth");
            for scene in [&sun, &lamp] {
                let request = request(Technique::ZFail, SIZE);
                let capture = judged_by(&mut session, scene, &request);
                adapter::assert_right(&mut session, scene, &request, &capture, &"far away");
                let judgement = capture.lights[0].truth.as_ref().expect("judged");
                let labels = capture.lights[0].shadow.as_ref().expect("labels");
                for (what, image) in [("z-fail", labels), ("the truth", &judgement.labels)] {
                    let rows: Vec<&[u8]> = image.rows().collect();
                    let found = compare(&tracer, &truth, 0, &rows, step);
                    assert_eq!(found.counts.wrong(), 0, "{}, {what}: {:?}", scene.name, found.worst);
                    assert!(found.counts.compared > 500, "{}: {:?}", scene.name, found.counts);
                }
            }
        }
    }
}
