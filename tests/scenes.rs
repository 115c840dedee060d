//! Shapes and built-in scenes: what techniques rely on.

mod builtin;
mod cues;
mod motion;

use crate::common::opened;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;
use stencilscope::scene::shapes;
use stencilscope::scene::{Camera, Light, Mesh, MeshBuilder, Object, Scene, UpAxis, model_scene};

/// How often each directed edge is used, less how often its reverse is: all zero when closed.
fn open_edges(mesh: &Mesh) -> usize {
    let mut uses: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for &[a, b, c] in mesh.triangles() {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            *uses.entry((p.min(q), p.max(q))).or_default() += if p < q { 1 } else { -1 };
        }
    }
    uses.values().filter(|count| **count != 0).count()
}

/// Signed: positive when faces look outward.
fn volume(mesh: &Mesh) -> f64 {
    let corner = |index: u32| mesh.positions()[index as usize];
    mesh.triangles().iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
}

#[test]
fn closed_shapes_are_watertight_and_face_outward() {
    use std::f64::consts::PI;
    let opening = |column, row| [(1, 0), (2, 1)].contains(&(column, row));
    let shapes = [
        ("box", shapes::cuboid([1.0, 2.0, 3.0]), 6.0, 1e-12),
        ("room", shapes::room([1.0, 2.0, 3.0]), -6.0, 1e-12),
        ("tetrahedron", shapes::tetrahedron(1.0), 8.0 / (9.0 * 3f64.sqrt()), 1e-12),
        // Inscribed, so a little smaller than the round shape.
        ("sphere", shapes::sphere(2.0, 96, 48), 4.0 / 3.0 * PI * 8.0, 0.1),
        ("torus", shapes::torus(1.0, 0.25, 96, 48), 2.0 * PI * PI * 0.0625, 0.01),
        ("cylinder", shapes::cylinder(1.0, 3.0, 96), 3.0 * PI, 0.01),
        // 4 + 3 + 2 + 1 blocks of 0.5 × 0.2 × 3.
        ("stairs", shapes::stairs(4, 0.2, 0.5, 3.0), 3.0, 1e-12),
        // Four by three, less a window of 2 × 1 and a door of 1 × 1.
        ("plate", shapes::plate(&[0.0, 1.0, 2.0, 4.0], &[0.0, 1.0, 2.0, 3.0], 0.5, opening), 4.5, 1e-12),
    ];
    for (name, mesh, expected, tolerance) in shapes {
        let mesh = mesh.expect(name);
        assert_eq!(open_edges(&mesh), 0, "{name}");
        assert!((volume(&mesh) - expected).abs() <= tolerance, "{name}: {}", volume(&mesh));
        assert_eq!(mesh.dropped_triangles(), 0, "{name}");
    }
}

#[test]
fn open_shapes_face_where_they_say() {
    let normal = |mesh: &Mesh, triangle: usize| {
        let [a, b, c] = mesh.triangles()[triangle].map(|vertex| mesh.positions()[vertex as usize]);
        (b - a).cross(c - a).normalize()
    };
    let corner = DVec3::new(1.0, 2.0, 3.0);
    let wall = shapes::parallelogram(corner, [DVec3::X * 2.0, DVec3::Y * 3.0]).expect("a parallelogram");
    assert_eq!((normal(&wall, 0), normal(&wall, 1)), (DVec3::Z, DVec3::Z));
    assert_eq!(wall.bounds(), Some((corner, corner + DVec3::new(2.0, 3.0, 0.0))));
    // A quarter of a ring, thinner towards its end.
    let bend = |step: u32| DVec2::from_angle(f64::from(step) * 0.2).extend(0.0);
    let path: Vec<(DVec3, f64)> = (0..8).map(|step| (bend(step), 0.2 - 0.01 * f64::from(step))).collect();
    let tube = shapes::tube(&path, 12).expect("a tube");
    assert_eq!((tube.triangles().len(), open_edges(&tube)), (7 * 12 * 2, 2 * 12));
    for (index, corners) in tube.triangles().iter().enumerate() {
        let middle = corners.map(|vertex| tube.positions()[vertex as usize]).into_iter().sum::<DVec3>() / 3.0;
        let on_path = path.iter().map(|(point, _)| middle - *point);
        let outward = on_path.min_by(|a, b| a.length().total_cmp(&b.length())).expect("a point");
        assert!(normal(&tube, index).dot(outward) > 0.0, "triangle {index}");
    }
}

/// Two boxes side by side share their corners, two apart share none.
#[test]
fn joined_meshes_are_welded_where_they_touch() {
    let one = shapes::cuboid([1.0; 3]).expect("a box");
    for (offset, corners) in [(1.0, 12), (1.5, 16)] {
        let both = shapes::joined([(&one, DVec3::ZERO), (&one, DVec3::X * offset)]).expect("two boxes");
        assert_eq!((both.positions().len(), both.triangles().len(), open_edges(&both)), (corners, 24, 0));
    }
}

#[test]
fn poles_and_seams_are_shared() {
    assert_eq!(shapes::sphere(1.0, 8, 4).expect("a sphere").positions().len(), 8 * 3 + 2);
    assert_eq!(shapes::torus(1.0, 0.2, 8, 6).expect("a torus").positions().len(), 48);
    let cone = shapes::revolve(&[DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0)], false, 8).expect("a cone");
    assert_eq!((cone.positions().len(), cone.triangles().len(), open_edges(&cone)), (9, 8, 8));
}

/// Möller and Trumbore (1997): does the segment cross the triangle?
fn crosses(from: DVec3, to: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (direction, e, f) = (to - from, b - a, c - a);
    let p = direction.cross(f);
    let determinant = e.dot(p);
    let s = from - a;
    let (u, q) = (s.dot(p) / determinant, s.cross(e));
    let (v, t) = (direction.dot(q) / determinant, f.dot(q) / determinant);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&t)
}

/// How many triangles of the object the segment crosses.
fn crossings(object: &Object, from: DVec3, to: DVec3) -> usize {
    let world = object.world_positions();
    let crossed = |corners: &&[u32; 3]| crosses(from, to, corners.map(|vertex| world[vertex as usize]));
    object.mesh.triangles().iter().filter(crossed).count()
}

/// The light, or a point far towards it.
fn place_of(light: &Light) -> DVec3 {
    if light.is_directional() { light.position.truncate().normalize() * 1e4 } else { light.position.truncate() }
}

/// 9 × 9 points of the near rectangle of a picture so much wider than high, and the eye.
fn near_points(camera: &Camera, aspect: f64) -> Vec<DVec3> {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let half = camera.near * (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let steps = || (-4..=4).map(|step| f64::from(step) / 4.0);
    let on_near_plane = |x: f64, y: f64| camera.eye + forward * camera.near + (right * x * aspect + up * y) * half;
    let mut points = vec![camera.eye];
    points.extend(steps().flat_map(|x| steps().map(move |y| (x, y))).map(|(x, y)| on_near_plane(x, y)));
    points
}

/// Nothing that casts stands between a light and the eye or the near plane.
fn is_eye_lit(scene: &Scene, aspect: f64) -> bool {
    let points = near_points(&scene.camera, aspect);
    scene.objects.iter().filter(|object| object.casts).all(|object| {
        let lit = |light: &Light| points.iter().all(|point| crossings(object, place_of(light), *point) == 0);
        scene.lights.iter().all(lit)
    })
}

/// Nothing is cut by the near plane, and the eye is in no solid.
fn assert_eye_is_free(scene: &Scene) {
    assert_eq!(scene.camera.check(), Ok(()), "{}", scene.name);
    let eye = scene.camera.eye;
    for object in &scene.objects {
        for point in near_points(&scene.camera, 16.0 / 9.0) {
            assert_eq!(crossings(object, eye, point), 0, "{}: {} is cut", scene.name, object.name);
        }
        // In no particular direction, so that it hits no edge.
        let away = eye + DVec3::new(0.317, 0.841, -0.439) * 1e4;
        let is_solid = open_edges(&object.mesh) == 0 && volume(&object.mesh) > 0.0;
        let is_outside = crossings(object, eye, away).is_multiple_of(2);
        assert!(!is_solid || is_outside, "{}: the eye is in {}", scene.name, object.name);
    }
}

#[test]
fn a_model_gets_a_floor_a_light_and_a_camera_from_its_bounds() {
    let mesh = shapes::cuboid([1.0, 2.0, 3.0]).expect("a box");
    let scene = model_scene("box", mesh.clone(), true, UpAxis::Y).expect("a scene");
    assert_eye_is_free(&scene);
    assert!(is_eye_lit(&scene, 16.0 / 9.0));
    let (low, high) = scene.objects[1].mesh.bounds().expect("a floor");
    // The extents' sum is 6.
    assert_eq!(low, DVec3::new(-30.0, -1.06, -30.0));
    assert_eq!(high, DVec3::new(30.0, -1.06, 30.0));
    assert!(scene.lights[0].position.y > 1.0);
    assert_eq!(model_scene("box", mesh, false, UpAxis::Y).expect("a scene").objects.len(), 1);
}

#[test]
fn flat_thin_far_and_tiny_models_can_be_looked_at() {
    let triangle = |scale: f64, offset: f64, points: [[f64; 3]; 3]| {
        let positions = points.map(|p| DVec3::from_array(p) * scale + DVec3::splat(offset)).to_vec();
        MeshBuilder { positions, triangles: vec![[0, 1, 2]], ..MeshBuilder::default() }.build().expect("a triangle")
    };
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let upright = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let needle = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]];
    for points in [flat, upright, needle] {
        for (scale, offset) in [(1.0, 0.0), (1e-9, 0.0), (1e9, 0.0), (1.0, 1e7)] {
            let scene = model_scene("thin", triangle(scale, offset, points), true, UpAxis::Y).expect("a scene");
            assert_eq!(scene.camera.check(), Ok(()), "scale {scale}, offset {offset}");
            assert_eq!(scene.lights[0].check(), Ok(()));
        }
    }
    for scale in [1e-200, 1e300] {
        let error = model_scene("odd", triangle(scale, 0.0, flat), true, UpAxis::Y)
            .expect_err("no size to look at")
            .to_string();
        assert!(error.contains("scale it"), "{error}");
    }
}

/// The model and the scene file that the README names.
#[test]
fn what_ships_can_be_opened() {
    let asset = |path: &str| format!("{}/assets/{path}", env!("CARGO_MANIFEST_DIR"));
    let model = opened(&asset("models/knot.obj"));
    assert_eq!(open_edges(&model.objects[0].mesh), 0, "closed");
    assert!(volume(&model.objects[0].mesh) > 0.0, "faces look outward");
    let scene = opened(&asset("scenes/knot.toml"));
    assert_eq!(scene.lights.len(), 2);
    assert!(scene.is_animated());
}
