use super::*;
use crate::scene::{Light, Motion, Projection, Shading, Swing};
use glam::DVec3;

const SCENE: &str = r#"name = "two shapes"
ambient = [0.1, 0.2, 0.3]
[camera]
eye = [0.0, 1.0, 3.0]
target = [0.0, 0.3, 0.0]
near = 0.05
[[lights]]
kind = "point"
position = [3, 4, 2]
intensity = 2
[[lights]]
kind = "directional"
towards = [0.0, 1.0, 0.0]
orbit = { center = [0, 0, 0], axis = [1, 0, 0], degrees_per_second = 30 }
[[objects]]
mesh = { shape = "torus", major = 0.5, minor = 0.2, segments = [8, 6] }
scale = [1.0, -1.0, 1.0]
swing = { pivot = [0, 2, 0], axis = [0, 0, 2], degrees = 15, period_seconds = 2.5 }
material = { color = [0.8, 0.3, 0.2], shading = "phong" }
[[objects]]
mesh = { shape = "torus" }
casts = false
[technique]
name = "shadow-map"
[technique.settings]
size = 512
cull = "none"
"#;

fn parsed(text: &str) -> Result<Scene, (usize, String)> {
    parse(text, "unnamed", Path::new("")).map_err(|problem| (problem.line_in(text), problem.reason))
}

/// Returns line and reason of the error that results from replacing `from` by `to`.
fn broken(from: &str, to: &str) -> (usize, String) {
    assert!(SCENE.contains(from), "{from} is not in the scene");
    parsed(&SCENE.replacen(from, to, 1)).expect_err(to)
}

#[test]
fn every_table_reaches_the_scene() {
    let scene = parsed(SCENE).expect("a scene");
    assert_eq!(scene.name, "two shapes");
    assert_eq!(scene.ambient, [0.1, 0.2, 0.3]);
    assert_eq!(scene.camera.eye, DVec3::new(0.0, 1.0, 3.0));
    assert_eq!(scene.camera.fov_y_degrees, 45.0);
    assert_eq!(scene.lights[0], Light { intensity: 2.0, ..Light::point(DVec3::new(3.0, 4.0, 2.0)) });
    assert!(scene.lights[1].is_directional() && scene.lights[1].motion.orbit.is_some());
    let [first, second] = &scene.objects[..] else { panic!("two objects") };
    assert_eq!((first.name.as_str(), second.name.as_str()), ("torus", "torus 2"));
    assert_eq!(first.mesh.triangles().len(), 2 * 8 * 6);
    assert_eq!(first.pose.scale, DVec3::new(1.0, -1.0, 1.0));
    let swing = Swing { pivot: DVec3::Y * 2.0, axis: DVec3::Z * 2.0, degrees: 15.0, period_seconds: 2.5 };
    assert_eq!(first.motion, Motion { swing: Some(swing), ..Motion::default() });
    assert_eq!(first.material.shading, Shading::Phong);
    assert!(first.casts && !second.casts);
    let request = scene.technique.expect("a technique");
    assert_eq!(request.name, "shadow-map");
    assert_eq!(request.settings["size"], "512");
}

#[test]
fn light_and_camera_are_placed_where_the_file_has_none() {
    let scene = parsed("[[objects]]\nmesh = { shape = \"box\" }\n").expect("a scene");
    assert_eq!(scene.name, "unnamed");
    assert_eq!(scene.lights.len(), 1);
    assert_eq!(scene.camera.check(), Ok(()));
}

#[test]
fn every_shape_makes_a_mesh() {
    let shapes = [
        ("{ shape = \"quad\", size = [2, 3] }", 2),
        ("{ shape = \"box\", size = [1, 2, 3] }", 12),
        ("{ shape = \"sphere\", radius = 2, segments = [5, 4] }", 5 * 2 * 3),
        ("{ shape = \"torus\", segments = [5, 4] }", 5 * 4 * 2),
        ("{ shape = \"tetrahedron\" }", 4),
        ("{ shape = \"cylinder\", segments = 6 }", 6 * 4),
        ("{ shape = \"revolve\", profile = [[1, 0], [2, 1]], segments = 6 }", 12),
        ("{ shape = \"triangles\", points = [[0,0,0],[1,0,0],[0,1,0]], indices = [[0,1,2]] }", 1),
    ];
    for (shape, triangles) in shapes {
        let scene = parsed(&format!("[[objects]]\nmesh = {shape}\n")).expect(shape);
        assert_eq!(scene.objects[0].mesh.triangles().len(), triangles, "{shape}");
    }
}

/// Unless given, the height at the target is that of a perspective camera; cabinet projection is usual. Saved, it is
/// read as it was.
#[test]
fn a_parallel_camera_has_a_half_height_and_may_be_aslant() {
    let folder = tempfile::tempdir().expect("a folder");
    let with = |keys: &str| {
        let scene = parsed(&SCENE.replace("near = 0.05", &format!("near = 0.05\n{keys}"))).expect(keys);
        let saved = save(&scene, "saved", Vec::new()).expect("saved");
        for (name, contents) in &saved.files {
            std::fs::write(folder.path().join(name), contents).expect("a file");
        }
        let again = parse(&saved.toml, "saved", folder.path()).expect("read again");
        assert_eq!(again.camera, scene.camera, "{keys}");
        scene.camera
    };
    assert_eq!(with("").projection, Projection::Perspective);
    let pinhole = with("");
    let usual = with("projection = \"orthographic\"");
    assert_eq!(usual.projection, Projection::Orthographic { half_height: pinhole.half_height_at_target() });
    assert_eq!(usual.half_height_at_target(), pinhole.half_height_at_target());
    let given = with("projection = \"oblique\"\nhalf_height = 3");
    let cabinet = Projection::Oblique { half_height: 3.0, angle_degrees: 45.0, factor: 0.5 };
    assert_eq!(given.projection, cabinet);
    let all = with("projection = \"oblique\"\nhalf_height = 3\noblique_angle_degrees = -30\noblique_factor = 1");
    let cavalier = Projection::Oblique { half_height: 3.0, angle_degrees: -30.0, factor: 1.0 };
    assert_eq!(all.projection, cavalier);
}

/// An off-centre frustum and an eye by spherical coordinates, saved, are read as they were: the eye as its place.
#[test]
fn a_frustum_a_viewport_and_an_eye_about_its_target_read_back_as_they_were() {
    let folder = tempfile::tempdir().expect("a folder");
    let with = |text: &str| {
        let scene = parsed(text).expect(text);
        let saved = save(&scene, "saved", Vec::new()).expect("saved");
        for (name, contents) in &saved.files {
            std::fs::write(folder.path().join(name), contents).expect("a file");
        }
        let again = parse(&saved.toml, "saved", folder.path()).expect("read again");
        assert_eq!(again.camera, scene.camera, "{text}");
        scene.camera
    };
    let edges = "near = 0.05\nprojection = \"frustum\"\nfrustum = [-0.01, 0.03, -0.02, 0.005]";
    let frustum = with(&SCENE.replace("near = 0.05", edges)).projection;
    let part = with(&SCENE.replace("near = 0.05", "near = 0.05\nviewport = [0.25, 0, 0.5, 0.1]")).viewport;
    assert_eq!(part, Some([0.25, 0.0, 0.5, 0.1]));
    assert_eq!(frustum, Projection::Frustum { left: -0.01, right: 0.03, bottom: -0.02, top: 0.005 });
    let about = with(&SCENE.replace("eye = [0.0, 1.0, 3.0]", "eye_spherical = [2, 90, 30]"));
    let wanted = about.target + DVec3::new(3.0_f64.sqrt(), 1.0, 0.0);
    assert!((about.eye - wanted).length() < 1e-12 && about.up == DVec3::Y, "{about:?}");
    let above = with(&SCENE.replace("eye = [0.0, 1.0, 3.0]", "eye_spherical = [2, 0, 90]"));
    assert!((above.up - DVec3::NEG_Z).length() < 1e-12, "{above:?}");
    let almost = with(&SCENE.replace("eye = [0.0, 1.0, 3.0]", "eye_spherical = [2, 0, 89.99999999]"));
    assert!((almost.up - DVec3::NEG_Z).length() < 1e-6, "{almost:?}");
}

#[test]
fn errors_name_the_line_and_the_fix() {
    let cases = [
        ("ambient =", "ambiant =", 2, "unknown key `ambiant`: did you mean `ambient`?"),
        ("near = 0.05", "neer = 0.05", 6, "did you mean `near`?"),
        ("near = 0.05", "near = 0", 6, "near plane"),
        ("near = 0.05", "near = 0.05\nfar = 0.01", 7, "far plane"),
        ("near = 0.05", "near = 0.05\nup = [0, 0, 0]", 7, "up"),
        ("near = 0.05", "near = 0.05\nfov_y_degrees = 180", 7, "field of view"),
        ("near = 0.05", "near = nan", 6, "finite"),
        ("near = 0.05", "near = 0.05\nprojection = \"oblong\"", 7, "no projection is called `oblong`"),
        ("near = 0.05", "near = 0.05\nprojection = \"obliqu\"", 7, "did you mean `oblique`?"),
        ("near = 0.05", "near = 0.05\nhalf_height = 2", 7, "of parallel projections"),
        ("near = 0.05", "near = 0.05\nprojection = \"orthographic\"\noblique_factor = 1", 8, "alone"),
        ("near = 0.05", "near = 0.05\nprojection = \"orthographic\"\nhalf_height = 0", 8, "half height"),
        ("near = 0.05", "near = 0.05\nprojection = \"orthographic\"\nhalf_height = inf", 8, "finite"),
        ("near = 0.05", "near = 0.05\nprojection = \"oblique\"\noblique_factor = -1", 8, "depth factor"),
        ("near = 0.05", "near = 0.05\nprojection = \"oblique\"\noblique_angle_degrees = 400", 8, "angle"),
        ("eye = [0.0, 1.0, 3.0]", "eye = [0.0, 0.3, 0.0]", 4, "eye equals its target"),
        ("eye = [0.0, 1.0, 3.0]", "eye = [0.0, nan, 0.0]", 4, "finite"),
        ("eye = [0.0, 1.0, 3.0]", "eye = [0.0, 1.0]", 4, "length 2"),
        ("eye = [0.0, 1.0, 3.0]", "eye = \"here\"", 4, "correct it"),
        ("eye = [0.0, 1.0, 3.0]", "", 3, "the key `eye` is missing"),
        ("eye = [0.0, 1.0, 3.0]", "eye = [0.0, 1.0, 3.0]\neye_spherical = [1, 0, 0]", 5, "leave one out"),
        ("eye = [0.0, 1.0, 3.0]", "eye_spherical = [0, 0, 0]", 4, "distance r"),
        ("eye = [0.0, 1.0, 3.0]", "eye_spherical = [1, 0, 91]", 4, "elevation"),
        ("near = 0.05", "near = 0.05\nfrustum = [-1, 1, -1, 1]", 7, "alone"),
        ("near = 0.05", "near = 0.05\nviewport = [0.5, 0, 0.6, 1]", 7, "within it"),
        ("near = 0.05", "near = 0.05\nviewport = [0, 0, 0, 1]", 7, "wider and higher than 0"),
        ("near = 0.05", "near = 0.05\nviewport = [nan, 0, 1, 1]", 7, "shares of the picture"),
        ("near = 0.05", "near = 0.05\nprojection = \"frustum\"", 7, "needs its edges"),
        ("near = 0.05", "near = 0.05\nprojection = \"frustum\"\nfrustum = [1, -1, -1, 1]", 8, "left less than right"),
        ("near = 0.05", "near = 0.05\nprojection = \"frustum\"\nfrustum = [-1, 1, -1]", 8, "correct it"),
        ("near = 0.05", "near = 0.05\nprojection = \"frustum\"\nfrustum = [-1, 1, -1, inf]", 8, "numbers"),
        ("kind = \"point\"", "kind = \"pont\"", 8, "did you mean `point`?"),
        ("position = [3, 4, 2]", "towards = [3, 4, 2]", 8, "needs `position`"),
        ("intensity = 2", "intensity = -2", 10, "not be below 0"),
        ("towards = [0.0, 1.0, 0.0]", "towards = [0, 0, 0]", 13, "direction"),
        ("axis = [1, 0, 0]", "axis = [0, 0, 0]", 14, "axis"),
        ("axis = [1, 0, 0]", "axes = [1, 0, 0]", 14, "did you mean `axis`?"),
        ("axis = [0, 0, 2]", "axis = [0, 0, 0]", 18, "the axis of a swing"),
        ("degrees = 15", "degrees = nan", 18, "finite"),
        ("degrees = 15", "angle = 15", 18, "unknown key `angle`"),
        ("period_seconds = 2.5", "period_seconds = 0", 18, "at least 0.001"),
        ("\"torus\", major", "\"tours\", major", 16, "did you mean `torus`?"),
        ("major = 0.5", "radius = 0.5", 16, "a torus has no `radius`"),
        ("major = 0.5", "mayor = 0.5", 16, "did you mean `major`?"),
        ("minor = 0.2", "minor = inf", 16, "greater than 0"),
        ("segments = [8, 6]", "segments = 8", 16, "two whole numbers"),
        ("segments = [8, 6]", "segments = [8, 2]", 16, "from 3 to"),
        ("{ shape = \"torus\" }", "\"missing.obj\"", 21, "missing.obj: there is no such file"),
        ("{ shape = \"torus\" }", "7", 21, "the path of a model or a table with a shape"),
        ("scale = [1.0, -1.0, 1.0]", "scale = [1.0, 0.0, 1.0]", 17, "other than 0"),
        ("scale = [1.0, -1.0, 1.0]", "translate = [1e308, 1e308, inf]", 17, "finite"),
        (
            "scale = [1.0, -1.0, 1.0]",
            "name = \"a\"\n[[objects]]\nname = \"a\"\nmesh = { shape = \"box\" }",
            19,
            "another name",
        ),
        ("color = [0.8, 0.3, 0.2]", "color = [1.8, 0.3, 0.2]", 19, "from 0 to 1"),
        ("\"phong\"", "\"fong\"", 19, "did you mean `phong`?"),
        ("casts = false", "casts = \"no\"", 22, "expected true or false"),
        ("size = 512", "size = [512]", 26, "a text or a number"),
        ("[camera]", "[camera", 3, "correct it"),
    ];
    for (from, to, line, words) in cases {
        let (found_line, reason) = broken(from, to);
        assert!(reason.contains(words), "{to}: `{reason}` has no `{words}`");
        assert!(!reason.contains('\n'), "{reason}");
        assert_eq!(found_line, line, "{to}: {reason}");
    }
}

#[test]
fn a_file_without_objects_says_so() {
    let (_, reason) = parsed("name = \"nothing\"\n").expect_err("no objects");
    assert!(reason.contains("[[objects]]"), "{reason}");
}
