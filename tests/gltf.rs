//! glTF scenes: samples that the Khronos validator accepts (`assets/gltf`); files that tests write are in `written`.

mod written;

use crate::common::{is_closed, judged, session, volume};
use glam::{DQuat, DVec3};
use std::fs;
use std::path::{Path, PathBuf};
use stencilscope::scene::{OpenSpec, Projection, Scene, SceneError, Unsupported, files_of, open};
use stencilscope::technique::Technique;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/gltf").join(name)
}

fn scene(name: &str) -> Scene {
    opened(&sample(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn opened(file: &Path) -> Result<Scene, SceneError> {
    open(&OpenSpec::new(file.to_string_lossy()))
}

/// Samples: objects, lights, whether the file has a camera, and words that what is not shown begins with.
const SAMPLES: [(&str, usize, usize, bool, &[&str]); 15] = [
    ("bare.glb", 2, 1, false, &[]),
    ("beside.gltf", 4, 1, true, &[]),
    ("blender.glb", 6, 3, true, &["the cone of `Spot`"]),
    ("blocks.glb", 26, 1, true, &[]),
    ("embedded.gltf", 2, 1, false, &[]),
    ("halves.glb", 2, 1, false, &[]),
    ("lights.glb", 2, 2, true, &[]),
    ("mirrors.glb", 5, 1, true, &[]),
    (
        "not-done.glb",
        5,
        1,
        true,
        &["`line`", "the cone of `spot`", "the alpha mask", "vertex colours", "KHR_materials_unlit"],
    ),
    ("quantized.glb", 2, 1, false, &[]),
    ("skin.glb", 2, 1, true, &["the bones of `arm`"]),
    ("sparse.glb", 2, 1, false, &[]),
    ("strips-and-fans.glb", 2, 1, true, &[]),
    ("textures.gltf", 2, 1, true, &[]),
    ("turntable.glb", 3, 1, true, &[]),
];

fn not_taken(scene: &Scene) -> Vec<&Unsupported> {
    scene.not_taken.iter().chain(scene.objects.iter().flat_map(|object| object.mesh.not_taken())).collect()
}

#[test]
fn samples_open_with_their_objects_lights_and_cameras_and_what_is_not_shown_is_named() {
    for (name, objects, lights, has_camera, words) in SAMPLES {
        let scene = scene(name);
        assert_eq!((scene.objects.len(), scene.lights.len()), (objects, lights), "{name}");
        // Where the file has none, all of it is in view from the front, a quarter round.
        let ahead = (scene.camera.target - scene.camera.eye).normalize();
        let is_ours = ahead.distance(-DVec3::new(0.42, 0.44, 0.8).normalize()) < 1e-9;
        assert_eq!(is_ours, !has_camera, "{name}");
        let not_taken = not_taken(&scene);
        for one in &not_taken {
            let is_expected = words.iter().any(|words| one.what.starts_with(words));
            assert!(is_expected && !one.because.contains('\n'), "{name}: {one:?}");
        }
        let is_reported = |words: &&str| not_taken.iter().any(|one| one.what.starts_with(words));
        assert!(words.iter().all(is_reported), "{name}: {not_taken:?}");
    }
    let names = fs::read_dir(sample("")).expect("samples").map(|entry| entry.expect("a file").file_name());
    let scenes = names.filter(|name| Path::new(name).extension().is_some_and(|kind| kind == "glb" || kind == "gltf"));
    assert_eq!(scenes.count(), SAMPLES.len());
}

#[test]
fn auto_is_right_on_every_sample() {
    let mut session = session();
    for (name, ..) in SAMPLES {
        let scene = scene(name);
        let capture = judged(&mut session, &scene, Technique::Auto, [320, 200]);
        for light in &capture.lights {
            let accuracy = &light.truth.as_ref().expect("a comparison").error;
            assert_eq!(accuracy.wrong(), 0, "{name}");
            assert!(accuracy.compared > 2000, "{name}: {}", accuracy.compared);
        }
    }
}

#[test]
fn what_is_closed_stays_closed_and_right_side_out() {
    let closed = [
        ("strips-and-fans.glb", "drum"),
        ("halves.glb", "two halves"),
        ("quantized.glb", "ring"),
        ("skin.glb", "arm"),
        ("sparse.glb", "spire"),
        ("textures.gltf", "crate"),
        ("embedded.gltf", "ball"),
        ("mirrors.glb", "plain"),
        ("mirrors.glb", "mirrored"),
        ("mirrors.glb", "sheared"),
        ("mirrors.glb", "by matrix"),
    ];
    for (file, name) in closed {
        let scene = scene(file);
        let object = scene.objects.iter().find(|object| object.name == name).expect("an object");
        assert!(is_closed(&object.mesh), "{file}: {name}");
        assert!(volume(&scene, name) > 0.1, "{file}: {name} encloses {}", volume(&scene, name));
    }
    // The mirror's and the plain capsule's are the same, and the mirror image stands where it should.
    let mirrors = scene("mirrors.glb");
    assert!((volume(&mirrors, "plain") - volume(&mirrors, "mirrored")).abs() < 1e-6);
    let reach = |name: &str| {
        let object = mirrors.objects.iter().find(|object| object.name == name).expect("an object");
        object.world_positions().iter().map(|point| point.x).fold(f64::NEG_INFINITY, f64::max)
    };
    assert!(reach("plain") < 0.0 && reach("mirrored") > 1.5);
}

#[test]
fn nodes_are_placed_in_double_precision_along_the_tree() {
    let scene = scene("beside.gltf");
    let small = scene.objects.iter().find(|object| object.name == "small").expect("an object");
    let turn = |degrees: f64| DQuat::from_rotation_y(degrees.to_radians());
    // Three nodes above each other, each rotated and scaled in the one below.
    let corner = DVec3::splat(0.5);
    let expected = DVec3::new(0.0, 0.5, 0.0)
        + turn(15.0)
            * (DVec3::new(0.0, 1.2, 0.0)
                + 0.7 * (turn(25.0) * (DVec3::new(0.0, 1.1, 0.0) + 0.5 * (turn(30.0) * corner))));
    let nearest = small.world_positions().iter().map(|point| point.distance(expected)).fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-6, "{nearest}");
    // Three towers of one mesh are one mesh.
    assert!(std::sync::Arc::ptr_eq(&scene.objects[1].mesh, &scene.objects[2].mesh));
    let blocks = self::scene("blocks.glb");
    assert_eq!(blocks.camera.projection, Projection::Orthographic { half_height: 5.0 });
    assert_eq!(blocks.objects[3].name, "block 3");
}

#[test]
fn lights_keep_their_places_colours_and_shares() {
    let scene = scene("lights.glb");
    let [lamp, sun] = &scene.lights[..] else { panic!("two lights") };
    assert_eq!((lamp.position.truncate(), lamp.range), (DVec3::new(1.5, 4.0, 1.0), Some(20.0)));
    // Rotated by −60° about x, what shines along −z shines down and forwards.
    let towards = DVec3::new(0.0, 60_f64.to_radians().sin(), 60_f64.to_radians().cos());
    assert!(sun.position.truncate().distance(towards) < 1e-6 && sun.is_directional());
    assert_eq!(sun.color, [0.6, 0.7, 1.0]);
    // 120 cd at some 3.7 m are more than 3 lx.
    assert!((0.2..0.5).contains(&(sun.intensity / lamp.intensity)), "{} {}", sun.intensity, lamp.intensity);
    assert!((sun.intensity + lamp.intensity - 1.0).abs() < 1e-6, "{} {}", sun.intensity, lamp.intensity);
}

#[test]
fn a_turning_node_carries_what_hangs_on_it() {
    let scene = scene("turntable.glb");
    let at = scene.at(1.0);
    let place = |scene: &Scene, name: &str| {
        let object = scene.objects.iter().find(|object| object.name == name).expect("an object");
        (object.pose.translate, object.world_positions()[0])
    };
    let quarter = DQuat::from_rotation_y(90_f64.to_radians());
    let pivot = DVec3::new(0.0, 0.8, 0.0);
    for name in ["turntable", "moon"] {
        let ((origin, corner), (moved, moved_corner)) = (place(&scene, name), place(&at, name));
        assert!(moved.distance(pivot + quarter * (origin - pivot)) < 1e-6, "{name}: {moved}");
        assert!(moved_corner.distance(pivot + quarter * (corner - pivot)) < 1e-6, "{name}: {moved_corner}");
    }
    let [before, after] = [&scene, &at].map(|scene| scene.lights[0].position.truncate());
    assert!(after.distance(pivot + quarter * (before - pivot)) < 1e-6, "{after}");
}

#[test]
fn a_skin_stands_as_its_bones_do() {
    let scene = scene("skin.glb");
    let arm = scene.objects.iter().find(|object| object.name == "arm").expect("an arm");
    // Two bends of 40° to the right: the hand points down to the right, and the armature is 0.8 times as large.
    let world = arm.world_positions();
    let farthest = world.iter().copied().max_by(|a, b| a.x.total_cmp(&b.x)).expect("a corner");
    let turn = |degrees: f64| DQuat::from_rotation_z(f64::to_radians(degrees));
    let tip = DVec3::Y * 0.5 + DVec3::Y + turn(-40.0) * DVec3::Y + turn(-80.0) * DVec3::new(0.0, 0.5, 0.0);
    assert!(farthest.distance(0.8 * tip) < 0.8 * 0.35, "{farthest} and {}", 0.8 * tip);
}

#[test]
fn pictures_lie_as_the_file_says() {
    let scene = scene("textures.gltf");
    let mesh = &scene.objects[1].mesh;
    let texture = mesh.groups()[0].texture.as_ref().expect("a picture");
    assert!(texture.clamps && texture.picture.name() == "checks.png");
    // The red corner of the picture, its upper left, is at the upper left of each side.
    let (corners, uvs) = (mesh.triangles()[0], mesh.corner_uvs().expect("places")[0].expect("three"));
    let low = corners.iter().zip(uvs).find(|(corner, _)| {
        let point = mesh.positions()[**corner as usize];
        (point.y, point.z) == (-0.5, 0.5)
    });
    assert_eq!(low.expect("the lower left of the side +x").1.to_array(), [0.0, 0.0]);
    assert_eq!(
        texture.picture.linear_at([0.05, 0.95], 0.0, true).map(|channel| (channel * 100.0).round()),
        [72.0, 1.0, 1.0]
    );
    // Three times as often, and rotated: as KHR_texture_transform's matrices have it.
    let floor = &scene.objects[0].mesh;
    let uvs = floor.corner_uvs().expect("places")[0].expect("three");
    let (sin, cos) = 0.5_f32.sin_cos();
    let far = uvs[1].to_array();
    let [u, v] = [0.1 + 3.0 * sin, 1.0 - (0.2 + 3.0 * cos)];
    assert!((far[0] - u).abs() < 1e-5 && (far[1] - v).abs() < 1e-5, "{far:?}, not {u} {v}");
}

/// A scene file names the meshes, and shows the same.
#[test]
fn a_saved_scene_names_the_file_and_shows_the_same() {
    for name in ["mirrors.glb", "skin.glb", "textures.gltf", "turntable.glb"] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("saved.toml");
        let original = scene(name);
        stencilscope::scene::file::store(&original, Some(&sample(name)), &file).expect("stored");
        let written = fs::read_to_string(&file).expect("a scene file");
        assert!(written.contains(&format!("{name}#/")), "{written}");
        assert!(!crate::common::names(folder.path()).iter().any(|name| name.ends_with(".obj")), "{name}");
        let again = opened(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((&again.camera, &again.lights), (&original.camera, &original.lights), "{name}");
        assert_eq!(again.objects, original.objects, "{name}");
        assert!(files_of(&OpenSpec::new(file.to_string_lossy())).iter().any(|file| file.ends_with(name)));
    }
    let named: Vec<PathBuf> = files_of(&OpenSpec::new(sample("textures.gltf").to_string_lossy()));
    let is_named = |name: &str| named.iter().any(|file| file.ends_with(name));
    assert!(is_named("textures.gltf") && is_named("textures.bin") && is_named("checks.png"), "{named:?}");
    assert!(
        files_of(&OpenSpec::new(sample("beside.gltf").to_string_lossy()))
            .iter()
            .any(|file| file.ends_with("tower of boxes.bin"))
    );
}
