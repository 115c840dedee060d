//! The ground truth where the answer is known in closed form.

use crate::common::{cuboid, from_above, mesh, pixels, square, under};
use glam::{DVec3, DVec4};
use std::sync::Arc;
use stencilscope::progress::Progress;
use stencilscope::scene::shapes;
use stencilscope::scene::{Light, Material, Mesh, MeshBuilder, Object, Pose, Scene};
use stencilscope::truth::{BACKGROUND, FACES_AWAY, LIT, SHADOW, Tracer, Truth};

const SIZE: [u32; 2] = [96, 96];

fn truth(scene: &Scene) -> Truth {
    Tracer::new(scene, SIZE).expect("a tracer").trace(&Progress::default()).expect("not cancelled")
}

/// An object that casts without being seen: the floor under it stays in view.
fn unseen(mut object: Object) -> Object {
    object.visible = false;
    object
}

/// Where the middle of a pixel is on the floor of [`from_above`]: the eye is 10 above it and sees
/// 10 to each side.
fn on_floor(x: u32, y: u32) -> [f64; 2] {
    [x, y].map(|n| (f64::from(n) + 0.5) / f64::from(SIZE[0]) * 20.0 - 10.0)
}

/// Compares every pixel with `expected(x, z)` of its floor point; `None` where both will do.
fn assert_floor(scene: &Scene, expected: impl Fn(f64, f64) -> Option<u8>) -> [usize; 4] {
    assert_floor_in(scene, 0, expected)
}

/// As [`assert_floor`], in the light with this index.
fn assert_floor_in(scene: &Scene, light: usize, expected: impl Fn(f64, f64) -> Option<u8>) -> [usize; 4] {
    let truth = truth(scene);
    let mut counts = [0; 4];
    for [x, y] in pixels(SIZE) {
        let [floor_x, floor_z] = on_floor(x, y);
        let label = truth.label(light, [x, y]);
        counts[usize::from(label)] += 1;
        if let Some(expected) = expected(floor_x, floor_z) {
            assert_eq!(label, expected, "pixel {x},{y} at {floor_x},{floor_z}");
        }
    }
    counts
}

fn shadow_if(is_shadow: bool) -> Option<u8> {
    Some(if is_shadow { SHADOW } else { LIT })
}

#[test]
fn a_square_throws_a_square() {
    // The light is 4 above the floor: at 1 above it, everything is 4/3 as large on the floor.
    let scene = from_above(vec![unseen(square("square", 1.0, 1.5))]);
    let counts = assert_floor(&scene, |x, z| shadow_if(x.abs() < 2.0 && z.abs() < 2.0));
    assert_eq!(counts, [96 * 96 - 400, 400, 0, 0]); // 20 pixels of 0.2083 lie within ±2
}

#[test]
fn a_cube_throws_the_shadow_of_its_upper_face() {
    let scene = from_above(vec![unseen(cuboid("cube", [-1.0, 1.0, -1.0], [1.0, 2.0, 1.0]))]);
    assert_floor(&scene, |x, z| shadow_if(x.abs() < 2.0 && z.abs() < 2.0));
    // Towards a light at infinity along (1, 2, 0) it reaches from its lower left to its upper right edge.
    let mut scene = scene;
    scene.lights = vec![Light::directional(DVec3::new(1.0, 2.0, 0.0))];
    assert_floor(&scene, |x, z| shadow_if(x > -2.0 && x < 0.5 && z.abs() < 1.0));
}

#[test]
fn a_sphere_throws_a_disc() {
    let smooth = shapes::sphere(1.0, 200, 100).expect("a sphere");
    let mut ball = unseen(Object::new("ball", Arc::new(smooth), Material::default()));
    ball.pose.translate.y = 1.5;
    let mut scene = from_above(vec![ball]);
    // The cone that touches a sphere of radius 1 at 2.5 below the light opens by asin(1 / 2.5);
    // flat facets reach no nearer than cos(π/100) to the sphere.
    let on_floor = |radius: f64| 4.0 * (radius / 2.5).asin().tan();
    let (inner, outer) = (on_floor((std::f64::consts::PI / 100.0).cos()), on_floor(1.0));
    let by_radius = |inner: f64, outer: f64| {
        move |x: f64, z: f64| {
            let radius = x.hypot(z);
            if radius < inner { Some(SHADOW) } else { (radius > outer).then_some(LIT) }
        }
    };
    assert_floor(&scene, by_radius(inner, outer));
    scene.lights = vec![Light::directional(DVec3::Y)];
    let counts = assert_floor(&scene, by_radius((std::f64::consts::PI / 100.0).cos(), 1.0));
    let area = std::f64::consts::PI / (20.0f64 / 96.0).powi(2);
    assert!((counts[1] as f64 - area).abs() < 8.0, "{counts:?} against {area}");
}

#[test]
fn a_light_in_a_closed_box_lights_nothing_outside_and_everything_inside() {
    let closed = cuboid("box", [-1.0, 3.0, -1.0], [1.0, 5.0, 1.0]);
    let mut scene = from_above(vec![closed]);
    let truth = truth(&scene);
    let inside_box = |x: f64, z: f64| x.abs() < 2.0 && z.abs() < 2.0; // its top, 5 below the eye
    for [x, y] in pixels(SIZE) {
        let [floor_x, floor_z] = on_floor(x, y);
        let expected = if inside_box(floor_x, floor_z) { FACES_AWAY } else { SHADOW };
        assert_eq!(truth.label(0, [x, y]), expected, "pixel {x},{y}");
    }
    scene.camera.eye = DVec3::new(0.0, 4.9, 0.0);
    assert_floor(&scene, |_, _| Some(LIT));
}

#[test]
fn nothing_is_seen_beyond_the_surfaces_or_before_the_near_plane() {
    let mut scene = from_above(vec![square("lid", 9.5, 20.0)]);
    scene.objects[0] = square("floor", 0.0, 5.0);
    // The lid is 0.5 from the eye, the near plane 1: it is not seen, but it darkens everything.
    scene.camera.near = 1.0;
    scene.lights = vec![Light::directional(DVec3::Y)];
    assert_floor(&scene, |x, z| Some(if x.abs() < 5.0 && z.abs() < 5.0 { SHADOW } else { BACKGROUND }));
    scene.camera.near = 0.1;
    assert_floor(&scene, |_, _| Some(LIT));
}

#[test]
fn what_does_not_cast_or_receive_is_left_out() {
    let caster = || square("square", 1.0, 1.5);
    let mut scene = from_above(vec![unseen(caster())]);
    scene.objects[0].receives = false;
    assert_floor(&scene, |_, _| Some(LIT));
    scene.objects[0].receives = true;
    scene.objects[1].casts = false;
    assert_floor(&scene, |_, _| Some(LIT));
    scene.lights = vec![Light::point(DVec3::new(0.0, -1.0, 0.0))];
    assert_floor(&scene, |_, _| Some(FACES_AWAY));
}

/// Programs that give each model a light of its own darken by no angle: what faces away from one of them is lit, or not asked.
#[test]
fn a_light_is_where_each_caster_has_it() {
    let with_light = |object: Object, light: [f64; 4]| Object { light_positions: [(0, light.into())].into(), ..object };
    let square_at =
        |name: &str, x: f64, light: [f64; 4]| with_light(unseen(square(name, 1.0, 1.5)).at([x, 0.0, 0.0]), light);
    // One shadow is straight below, the other 1 towards +x.
    let mut scene =
        from_above(vec![square_at("left", -4.0, [0.0, 1.0, 0.0, 0.0]), square_at("right", 4.0, [-1.0, 1.0, 0.0, 0.0])]);
    let is_dark = |x: f64, z: f64| z.abs() < 1.5 && ((x + 4.0).abs() < 1.5 || (x - 5.0).abs() < 1.5);
    assert_floor(&scene, |x, z| shadow_if(is_dark(x, z)));
    // The scene's own light has no caster left, wherever it is.
    scene.lights[0].position = DVec4::new(0.0, 0.5, 0.0, 1.0);
    assert_floor(&scene, |x, z| shadow_if(is_dark(x, z)));
    for object in &mut scene.objects[1..=2] {
        *object = with_light(object.clone(), [0.0, -1.0, 0.0, 0.0]);
    }
    // From below the floor faces away from the light, and what is above it is not between.
    assert_floor(&scene, |_, _| Some(LIT));
    let below = from_above(vec![unseen(square("below", -1.5, 1.0))]);
    let below = below.objects.iter().find(|object| object.name == "below").expect("it");
    scene.objects.push(with_light(below.clone(), [0.0, -1.0, 0.0, 0.0]));
    assert_floor(&scene, |x, z| Some(if x.abs() < 1.0 && z.abs() < 1.0 { FACES_AWAY } else { LIT }));
}

/// The side of a sheet that faces away from its own light has nothing between but itself.
#[test]
fn the_other_side_of_a_caster_is_not_asked_for_in_its_own_light() {
    let own = |light: [f64; 4]| {
        let square = square("square", 2.5, 1.5);
        from_above(vec![Object { light_positions: [(0, light.into())].into(), ..square }])
    };
    // It is 7.5 below the eye, and so shows 2 to each side where the floor would be.
    let is_on_square = |x: f64, z: f64| x.abs() < 2.0 && z.abs() < 2.0;
    assert_floor(&own([0.0, -1.0, 0.0, 0.0]), |x, z| Some(if is_on_square(x, z) { FACES_AWAY } else { LIT }));
    // From above it is lit, and hides its shadow.
    assert_floor(&own([0.0, 1.0, 0.0, 0.0]), |_, _| Some(LIT));
    // So it is for one that has the light where the scene has it, if another has it elsewhere.
    let mut scene = own([0.0, -1.0, 0.0, 0.0]);
    scene.lights = vec![Light::directional(-DVec3::Y)];
    let other = unseen(square("other", 1.0, 0.1)).at([8.0, 0.0, 0.0]);
    scene.objects.push(Object {
        light_positions: scene.objects.iter().flat_map(|one| one.light_positions.clone()).collect(),
        ..other
    });
    scene.objects.iter_mut().filter(|one| one.name == "square").for_each(|one| one.light_positions.clear());
    // The floor is no caster, as in a frame that draws no volume of it.
    scene.objects.iter_mut().filter(|one| one.name == "floor").for_each(|one| one.casts = false);
    assert_floor(&scene, |x, z| Some(if is_on_square(x, z) { FACES_AWAY } else { LIT }));
}

/// Where one light is for a caster says nothing of where the others are for it.
#[test]
fn a_caster_that_has_one_light_elsewhere_has_the_others_where_they_are() {
    let square = unseen(square("square", 1.0, 1.5));
    let mut scene =
        from_above(vec![Object { light_positions: [(1, DVec4::new(-1.0, 1.0, 0.0, 0.0))].into(), ..square }]);
    scene.lights = vec![Light::directional(DVec3::new(2.0, 1.0, 0.0)), Light::directional(DVec3::Y)];
    assert_floor_in(&scene, 0, |x, z| shadow_if((x + 2.0).abs() < 1.5 && z.abs() < 1.5));
    assert_floor_in(&scene, 1, |x, z| shadow_if((x - 1.0).abs() < 1.5 && z.abs() < 1.5));
}

/// A fin one millionth high, seen by a light that stands one millionth above the horizon, darkens
/// one metre: any offset along the normal would lose it.
#[test]
fn a_grazing_light_finds_the_smallest_occluder() {
    let fin =
        mesh(&[[0.0, 0.0, -30.0], [0.0, 0.0, 30.0], [0.0, 1e-6, 30.0], [0.0, 1e-6, -30.0]], &[[0, 1, 2], [0, 2, 3]]);
    let fin = unseen(Object::new("fin", fin, Material::default()));
    let mut scene = under(Light::directional(DVec3::new(-1.0, 1e-6, 0.0)), vec![fin]);
    assert_floor(&scene, |x, _| shadow_if(x > 0.0 && x < 1.0));
    // The same from a point light at the end of that line.
    scene.lights = vec![Light::point(DVec3::new(-1000.0, 1e-3 + 1e-6, 0.0))];
    assert_floor(&scene, |x, _| if (x - 1.0).abs() < 0.01 { None } else { shadow_if(x > 0.0 && x < 1.0) });
}

/// A floor of many coplanar triangles in several objects, rotated and far from the origin, must not darken itself,
/// however low the light.
#[test]
fn coplanar_triangles_do_not_darken_each_other() {
    let corners: Vec<[f64; 3]> =
        (0..121).map(|i| [f64::from(i % 11) * 4.0 - 20.0, 0.0, f64::from(i / 11) * 4.0 - 20.0]).collect();
    let quads = (0..100u32).map(|i| i / 10 * 11 + i % 10);
    let triangles: Vec<[u32; 3]> = quads.flat_map(|i| [[i, i + 11, i + 12], [i, i + 12, i + 1]]).collect();
    for offset in [0.0, 1e3, 1e7] {
        let mut floor = Object::new("floor", mesh(&corners, &triangles), Material::default());
        let mut scene = from_above(vec![]);
        floor.pose =
            Pose { translate: DVec3::splat(offset), rotate_degrees: DVec3::new(0.0, 33.0, 0.0), ..Pose::default() };
        let mut beside = square("coplanar", 0.0, 3.0);
        beside.pose = floor.pose;
        scene.objects = vec![floor, beside];
        scene.camera.eye += DVec3::splat(offset);
        scene.camera.target += DVec3::splat(offset);
        for elevation in [1.0, 1e-3, 1e-6] {
            scene.lights = vec![
                Light::directional(DVec3::new(-1.0, elevation, 0.3)),
                Light::point(DVec3::new(-50.0, 50.0 * elevation, 20.0) + offset),
            ];
            let truth = truth(&scene);
            let all_lit = vec![LIT; (SIZE[0] * SIZE[1]) as usize];
            assert!(truth.labels == [all_lit.clone(), all_lit], "offset {offset}, elevation {elevation}");
        }
    }
}

/// Small triangles in the plane of a large one, tilted and far off: their rounded corners stand out
/// of it, but they are known to be in it.
#[test]
fn what_was_in_one_plane_before_it_was_placed_does_not_darken_it() {
    let mut points = vec![[-30.0, 0.0, -30.0], [-30.0, 0.0, 30.0], [30.0, 0.0, 30.0], [30.0, 0.0, -30.0]];
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    for index in 0..400u32 {
        let [x, z] = [index % 20, index / 20].map(|n| (f64::from(n) - 9.7) * 1e-3);
        let first = points.len() as u32;
        points.extend([[x, 0.0, z], [x, 0.0, z + 1e-4], [x + 1e-4, 0.0, z]]);
        triangles.push([first, first + 1, first + 2]);
    }
    let mut floor = Object::new("floor", mesh(&points, &triangles), Material::default());
    floor.pose =
        Pose { translate: DVec3::new(1e7, -2e7, 3e7), rotate_degrees: DVec3::new(17.0, 33.0, 9.0), ..Pose::default() };
    let world_from_object = floor.pose.world_from_object();
    let mut scene = from_above(vec![]);
    scene.camera.eye = world_from_object.transform_point3(scene.camera.eye);
    scene.camera.target = world_from_object.transform_point3(scene.camera.target);
    scene.camera.fov_y_degrees = 0.1;
    scene.camera.up = world_from_object.transform_vector3(scene.camera.up);
    let elevations = [1e-4, 1e-5, 1e-6, 3e-7, 1e-7];
    let light = |elevation| Light::directional(world_from_object.transform_vector3(DVec3::new(-1.0, elevation, 0.3)));
    scene.lights = elevations.map(light).to_vec();
    scene.objects = vec![floor];
    for (labels, elevation) in truth(&scene).labels.iter().zip(elevations) {
        let dark = labels.iter().filter(|label| **label == SHADOW).count();
        assert_eq!(dark, 0, "light {elevation} above the plane");
    }
}

/// Roofs whose ridges run exactly under the centres of pixels: a surface point there is rounded to
/// either side of the other slope, which must not darken it.
#[test]
fn a_ridge_under_the_centres_of_pixels_does_not_darken_itself() {
    for offset in [0.0, 1e4, 1e7] {
        let mut scene = from_above(vec![]);
        scene.objects.clear();
        for column in 1..94u32 {
            let [x, _] = on_floor(column, 0);
            let slope = 1e-3 + f64::from(column % 9) * 0.01;
            let points = [[x, 0.0, -9.0], [x, 0.0, 9.0], [x - 0.05, -slope, 0.0], [x + 0.05, -slope * 0.7, 0.0]];
            let points = points.map(|point| point.map(|n| n + offset));
            let roof = mesh(&points, &[[0, 2, 1], [0, 1, 3]]);
            scene.objects.push(Object::new(format!("roof {column}"), roof, Material::default()));
        }
        scene.camera.eye += DVec3::splat(offset);
        scene.camera.target += DVec3::splat(offset);
        scene.lights = vec![
            Light::point(DVec3::new(0.3, 8.0, 0.2) + offset),
            Light::point(DVec3::new(2e6, 3e7, -1e6)),
            Light::directional(DVec3::new(0.01, 1.0, 0.02)),
        ];
        let truth = truth(&scene);
        for (light, labels) in truth.labels.iter().enumerate() {
            let dark = labels.iter().filter(|label| **label == SHADOW).count();
            let lit = labels.iter().filter(|label| **label == LIT).count();
            assert!(dark == 0 && lit > 3000, "offset {offset}, light {light}: {dark} dark, {lit} lit");
        }
    }
}

/// A light so far off that it might as well be a direction: as exact, and as quick.
#[test]
fn a_point_light_at_any_distance_agrees_with_a_directional_one() {
    let mut scene =
        stencilscope::scene::open(&stencilscope::scene::OpenSpec::new("assets/models/knot.obj")).expect("knot");
    let towards = DVec3::new(0.5, 1.0, 0.3);
    scene.lights = vec![Light::directional(towards)];
    scene.lights.extend([1e4, 1e6, 1e9, 1e13, 1e17].map(|distance| Light::point(towards * distance)));
    let truth = truth(&scene);
    let shadow = truth.labels[0].iter().filter(|label| **label == SHADOW).count();
    assert!(shadow > 300, "{shadow}");
    for labels in &truth.labels[1..] {
        let differing = labels.iter().zip(&truth.labels[0]).filter(|(a, b)| a != b).count();
        assert!(differing <= 2, "{differing} pixels differ");
    }
}

/// The knot, which has edges and vertices everywhere, with its triangles in another order and the corners of each
/// rotated.
#[test]
fn labels_do_not_depend_on_the_order_of_triangles_or_threads() {
    let knot = stencilscope::scene::open(&stencilscope::scene::OpenSpec::new("assets/models/knot.obj")).expect("knot");
    let labels = truth(&knot);
    let mut shuffled = knot.clone();
    for object in &mut shuffled.objects {
        object.mesh = Arc::new(reordered(&object.mesh));
    }
    shuffled.objects.reverse();
    assert_eq!(truth(&shuffled).labels, labels.labels);
    assert!(labels.labels[0].iter().filter(|label| **label == SHADOW).count() > 200);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        assert_eq!(pool.install(|| truth(&knot)), labels);
    }
}

/// The same triangles: last first, and each from another corner.
fn reordered(mesh: &Mesh) -> Mesh {
    let triangles = mesh.triangles().iter().rev().map(|[a, b, c]| [*b, *c, *a]).collect();
    let positions = mesh.positions().to_vec();
    MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().expect("a mesh")
}

#[test]
fn a_cancelled_truth_is_none() {
    let scene = from_above(vec![]);
    let progress = Progress::default();
    progress.cancel();
    assert_eq!(Tracer::new(&scene, SIZE).expect("a tracer").trace(&progress), None);
    let finished = Progress::default();
    assert!(Tracer::new(&scene, SIZE).expect("a tracer").trace(&finished).is_some());
    // Bands of 16 rows.
    assert_eq!(finished.steps(), (6, 6));
}

#[test]
fn what_no_ray_can_be_followed_for_is_refused() {
    let mut scene = from_above(vec![square("far", 1e31, 1.0)]);
    let error = Tracer::new(&scene, SIZE).expect_err("too far").to_string();
    assert!(error.contains("far is too large or too far"), "{error}");
    scene.objects.truncate(1);
    scene.camera.near = f64::NAN;
    assert!(Tracer::new(&scene, SIZE).is_err());
}
