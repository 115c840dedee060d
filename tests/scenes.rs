//! Shapes and built-in scenes: what techniques rely on.

use glam::{DVec2, DVec3};
use std::collections::BTreeMap;
use stencilscope::scene::builtin::{self, shapes};
use stencilscope::scene::{Mesh, MeshBuilder, OpenSpec, Scene, model_scene, open};

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
    let shapes = [
        ("box", shapes::cuboid([1.0, 2.0, 3.0]), 6.0, 1e-12),
        ("room", shapes::room([1.0, 2.0, 3.0]), -6.0, 1e-12),
        ("tetrahedron", shapes::tetrahedron(1.0), 8.0 / (9.0 * 3f64.sqrt()), 1e-12),
        // Inscribed, so a little smaller than the round shape.
        ("sphere", shapes::sphere(2.0, 96, 48), 4.0 / 3.0 * PI * 8.0, 0.1),
        ("torus", shapes::torus(1.0, 0.25, 96, 48), 2.0 * PI * PI * 0.0625, 0.01),
        ("cylinder", shapes::cylinder(1.0, 3.0, 96), 3.0 * PI, 0.01),
    ];
    for (name, mesh, expected, tolerance) in shapes {
        let mesh = mesh.expect(name);
        assert_eq!(open_edges(&mesh), 0, "{name}");
        assert!((volume(&mesh) - expected).abs() <= tolerance, "{name}: {}", volume(&mesh));
        assert_eq!(mesh.dropped_triangles(), 0, "{name}");
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

/// Nothing that casts stands between the light and the eye or the near plane, and nothing is cut
/// by the near plane.
fn assert_eye_is_clear(scene: &Scene) {
    let camera = &scene.camera;
    assert_eq!(camera.check(), Ok(()), "{}", scene.name);
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let half = camera.near * (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let on_near_plane = |x: f64, y: f64| camera.eye + forward * camera.near + (right * x * 16.0 / 9.0 + up * y) * half;
    let mut points = vec![camera.eye];
    points.extend(steps.iter().flat_map(|x| steps.iter().map(move |y| on_near_plane(*x, *y))));
    for object in &scene.objects {
        let world = object.world_positions();
        for corners in object.mesh.triangles() {
            let triangle = corners.map(|vertex| world[vertex as usize]);
            for point in &points {
                let light = scene.lights[0].position.truncate();
                assert!(
                    !object.casts || !crosses(light, *point, triangle),
                    "{}: {} shadows the eye",
                    scene.name,
                    object.name
                );
                assert!(!crosses(camera.eye, *point, triangle), "{}: {} is cut", scene.name, object.name);
            }
        }
    }
}

#[test]
fn builtin_scenes_start_with_a_clear_eye() {
    for builtin in builtin::ALL {
        let scene = builtin.scene().expect(builtin.name);
        assert_eq!(scene.name, builtin.name);
        assert_eye_is_clear(&scene);
        let mut names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), scene.objects.len(), "names are unique");
    }
    assert!(open(&OpenSpec::new("tori")).expect("tori").is_animated());
}

#[test]
fn a_model_gets_a_floor_a_light_and_a_camera_from_its_bounds() {
    let mesh = shapes::cuboid([1.0, 2.0, 3.0]).expect("a box");
    let scene = model_scene("box", mesh.clone(), true).expect("a scene");
    assert_eye_is_clear(&scene);
    let (low, high) = scene.objects[1].mesh.bounds().expect("a floor");
    // The extents' sum is 6.
    assert_eq!(low, DVec3::new(-30.0, -1.06, -30.0));
    assert_eq!(high, DVec3::new(30.0, -1.06, 30.0));
    assert!(scene.lights[0].position.y > 1.0);
    assert_eq!(model_scene("box", mesh, false).expect("a scene").objects.len(), 1);
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
            let scene = model_scene("thin", triangle(scale, offset, points), true).expect("a scene");
            assert_eq!(scene.camera.check(), Ok(()), "scale {scale}, offset {offset}");
            assert_eq!(scene.lights[0].check(), Ok(()));
        }
    }
    for scale in [1e-200, 1e300] {
        let error = model_scene("odd", triangle(scale, 0.0, flat), true).expect_err("no size to look at").to_string();
        assert!(error.contains("scale it"), "{error}");
    }
}

/// The model and the scene file that the README names.
#[test]
fn what_ships_can_be_opened() {
    let asset = |path: &str| format!("{}/assets/{path}", env!("CARGO_MANIFEST_DIR"));
    let model = open(&OpenSpec::new(asset("models/knot.obj"))).expect("the model");
    assert_eq!(open_edges(&model.objects[0].mesh), 0, "closed");
    assert!(volume(&model.objects[0].mesh) > 0.0, "faces look outward");
    let scene = open(&OpenSpec::new(asset("scenes/knot.toml"))).expect("the scene");
    assert_eq!(scene.lights.len(), 2);
    assert!(scene.is_animated());
}
