//! glTF files that tests write: files that lie or lack something, what many share, and what is said of it.

use super::{not_taken, opened, sample, scene};
use crate::commands::{assert_fails, done, folder, read_json};
use crate::common::volume;
use glam::DQuat;
use std::fs;
use std::path::{Path, PathBuf};
use stencilscope::scene::{OpenSpec, Scene, files_of};

/// A triangle; `parts` are more members of the file.
fn triangle(parts: &str, uri: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36,"uri":"{uri}"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]{parts}}}"#
    )
}

/// Three corners as a data URI.
const CORNERS: &str = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";

#[test]
fn files_that_lie_are_refused_in_one_line() {
    let nodes = r#","nodes":[{"mesh":0}]"#;
    let whole = triangle(nodes, CORNERS);
    let folder = folder();
    let put = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).expect("written");
    put("short.bin", &[0; 8]);
    put("whole.gltf", whole.as_bytes());
    assert_eq!(opened(&folder.path().join("whole.gltf")).expect("a triangle").objects.len(), 2);
    let cases: Vec<(String, &str)> = vec![
        (String::new(), "is empty: give a glTF file with content"),
        ("{".to_owned(), ":1: is no glTF 2.0 ("),
        ("glTF".to_owned(), "is a broken .glb (its head is too short)"),
        ("glTF\u{2}\0\0\0\u{1}\0\0\0".to_owned(), "is a broken .glb (its head is too short)"),
        (whole.replace("2.0", "1.0"), "is of glTF version `1.0`, and 2.0 is read: convert it"),
        (triangle(nodes, "short.bin"), "buffer 0 has 8 bytes where 36 are declared"),
        (triangle(nodes, "none.bin"), "`none.bin` there is no such file"),
        (triangle(nodes, "/dev/zero"), "`/dev/zero` is a device: only plain files are read"),
        (triangle(nodes, "https://example.com/a.bin"), "is no file beside this one: put it there"),
        (triangle(nodes, "data:;base64,A"), "a data URI can't be read"),
        (triangle("", CORNERS), "has no triangles to show"),
        (triangle(r#","nodes":[{"mesh":7}]"#, CORNERS), "breaks a rule of glTF 2.0 at `nodes[0].mesh` ("),
        (triangle(r#","nodes":[{"children":[1]},{"children":[0],"mesh":0}]"#, CORNERS), "its nodes form a circle"),
        (
            triangle(r#","nodes":[{"children":[2]},{"children":[2]},{"mesh":0}]"#, CORNERS),
            "node 2 is a child of two nodes",
        ),
        (triangle(r#","nodes":[{"mesh":0,"scale":[0,1,1]}]"#, CORNERS), "has no triangles to show"),
        (triangle(r#","nodes":[{"mesh":0,"translation":[1e38,0,0],"scale":[1e30,1,1]}]"#, CORNERS), "is too large"),
        (whole.replace("\"count\":3", "\"count\":4"), "an accessor reaches beyond buffer view 0"),
        (
            whole.replace("\"count\":3", "\"count\":4000000000"),
            "more vertices and triangles than its buffers have bytes",
        ),
        (whole.replace("VEC3", "VEC2"), "accessor 0 has 2 numbers an item, not 3"),
        (
            triangle(r#","nodes":[{"mesh":0}],"extensionsRequired":["KHR_draco_mesh_compression"]"#, CORNERS),
            "needs the extension `KHR_draco_mesh_compression`, which compresses its surfaces: export it uncompressed",
        ),
        (
            triangle(r#","nodes":[{"mesh":0}],"extensionsRequired":["EXT_mesh_gpu_instancing"]"#, CORNERS),
            "needs the extension `EXT_mesh_gpu_instancing`, which is not done here: export it without",
        ),
        // Some exporters only say that they use it.
        (
            triangle(r#","nodes":[{"mesh":0}],"extensionsUsed":["KHR_draco_mesh_compression"]"#, CORNERS)
                .replace(r#"{"bufferView":0,"#, "{"),
            "needs the extension `KHR_draco_mesh_compression`, which compresses its surfaces",
        ),
        // glTF 1.0 has names where 2.0 has numbers, and need not say its version.
        (
            r#"{"meshes":{"a":{}},"asset":{"version":"1.0"}}"#.to_owned(),
            "is of glTF version `1.0`, and 2.0 is read: convert",
        ),
        (r#"{"meshes":{"a":{}},"asset":{"version":1.1}}"#.to_owned(), "is of glTF version `1.1`, and 2.0 is read"),
        (r#"{"meshes":{"a":{}},"accessors":{}}"#.to_owned(), "is of glTF version `1.0`, and 2.0 is read"),
        ("glTF\u{1}\0\0\0\u{14}\0\0\0\0\0\0\0\0\0\0\0".to_owned(), "is of glTF version `1.0`, and 2.0 is read"),
    ];
    for (json, words) in cases {
        put("a.gltf", json.as_bytes());
        let error = opened(&folder.path().join("a.gltf")).expect_err(words).to_string();
        assert!(error.contains(words) && !error.contains('\n') && error.contains("a.gltf"), "{error}, not {words}");
    }
    // A vertex that is no number, and one that is not there.
    let nan = CORNERS.replace("AACAPw", "AADAfw");
    put("a.gltf", triangle(nodes, &nan).as_bytes());
    assert!(opened(&folder.path().join("a.gltf")).expect_err("a NaN").to_string().contains("is not finite"));
}

/// A shadow needs the surface alone: a picture that can't be read, in whatever format, is left out and named.
#[test]
fn pictures_that_cannot_be_read_keep_no_file_from_opening() {
    let folder = folder();
    fs::write(folder.path().join("broken.png"), b"\x89PNG\r\n\x1a\nno more").expect("written");
    let texture = |texture: &str, more: &str| {
        let parts = format!(
            r#","nodes":[{{"mesh":0}}],"textures":[{texture}],"images":[{{"uri":"x.webp","mimeType":"image/webp"}},
{{"uri":"broken.png"}},{{"uri":"data:image/ktx2;base64,q0tUWA=="}}],
"materials":[{{"name":"leaf","pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}]{more}"#
        );
        triangle(&parts, CORNERS).replace("\"POSITION\":0}", "\"POSITION\":0},\"material\":0")
    };
    let needs = |name: &str| format!(r#","extensionsUsed":["{name}"],"extensionsRequired":["{name}"]"#);
    let neither = "its picture is neither PNG nor JPEG: convert it";
    let cases = [
        (r#"{"extensions":{"EXT_texture_webp":{"source":0}}}"#, "EXT_texture_webp", neither),
        (r#"{"extensions":{"KHR_texture_basisu":{"source":2}}}"#, "KHR_texture_basisu", neither),
        (r#"{"extensions":{"MSFT_texture_dds":{"source":0}}}"#, "MSFT_texture_dds", neither),
        (r#"{"source":0}"#, "EXT_texture_webp", "`x.webp` there is no such file"),
        (r#"{"source":1}"#, "EXT_texture_webp", "`broken.png` is"),
        (r#"{"source":2}"#, "EXT_texture_webp", "`image-3` is"),
    ];
    for (given, extension, because) in cases {
        let file = folder.path().join("a.gltf");
        fs::write(&file, texture(given, &needs(extension))).expect("written");
        let scene = opened(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.objects[0].mesh.triangles().len(), 1, "{given}");
        let not_taken = not_taken(&scene);
        let is_named = |what: &str, because: &str| {
            not_taken.iter().any(|one| one.what == what && one.because.starts_with(because))
        };
        assert!(is_named("baseColorTexture of `leaf`", because), "{given}: {not_taken:?}");
        assert!(is_named(&format!("`{extension}`"), "this extension is not done"), "{not_taken:?}");
    }
}

/// Attributes whose names begin with an underscore are an exporter's own, and any file may have them.
#[test]
fn attributes_of_an_exporter_s_own_are_passed_over() {
    let folder = folder();
    let own = triangle(r#","nodes":[{"mesh":0}]"#, CORNERS)
        .replace("\"POSITION\":0", "\"POSITION\":0,\"_FEATURE_ID_0\":0,\"_BATCHID\":0,\"FOO\":0");
    fs::write(folder.path().join("a.gltf"), &own).expect("written");
    let scene = opened(&folder.path().join("a.gltf")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.objects[0].mesh.triangles().len(), 1);
    fs::write(folder.path().join("a.gltf"), own.replace("\"FOO\":0", "\"FOO\":9")).expect("written");
    assert!(opened(&folder.path().join("a.gltf")).expect_err("no accessor").to_string().contains("accessor 9"));
}

/// As an OBJ's pictures do: models of one game share a folder of textures beside theirs.
#[test]
fn files_may_be_in_another_folder() {
    let folder = folder();
    fs::create_dir(folder.path().join("scenes")).expect("made");
    fs::create_dir(folder.path().join("my buffers")).expect("made");
    let buffer = folder.path().join("my buffers/a.bin");
    let bytes: Vec<u8> =
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32].iter().flat_map(|n| n.to_le_bytes()).collect();
    fs::write(&buffer, bytes).expect("written");
    let file = folder.path().join("scenes/a.gltf");
    let absolute = buffer.display().to_string();
    for uri in ["../my%20buffers/a.bin", "../my buffers/a.bin", r"..\\my buffers\\a.bin", &absolute] {
        fs::write(&file, triangle(r#","nodes":[{"mesh":0}]"#, uri)).expect("written");
        let scene = opened(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.objects[0].mesh.triangles().len(), 1, "{uri}");
        let named = files_of(&OpenSpec::new(file.to_string_lossy()));
        assert!(named.iter().any(|file| file.ends_with("my buffers/a.bin")), "{named:?}");
    }
}

#[test]
fn normals_that_are_not_finite_are_replaced_and_counted() {
    let folder = folder();
    let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, f32::NAN, 0.0, 1.0, 0.0, 0.0, 1.0];
    fs::write(folder.path().join("a.bin"), numbers.map(f32::to_le_bytes).concat()).expect("written");
    // The second is moved where no pose can, so that its normals are transformed, too.
    let nodes = r#","nodes":[{"mesh":0},{"mesh":0,"matrix":[1,0,0,0,1,1,0,0,0,0,1,0,2,0,0,1]}]"#;
    let text = triangle(nodes, "a.bin")
        .replace("\"byteLength\":36", "\"byteLength\":72")
        .replace(
            "\"accessors\":[",
            r#""accessors":[{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"},"#,
        )
        .replace("\"POSITION\":0", "\"POSITION\":1,\"NORMAL\":0");
    fs::write(folder.path().join("a.gltf"), text).expect("written");
    let scene = opened(&folder.path().join("a.gltf")).unwrap_or_else(|error| panic!("{error}"));
    for object in &scene.objects[..2] {
        let not_taken: Vec<&str> = object.mesh.not_taken().iter().map(|one| one.what.as_str()).collect();
        assert_eq!(not_taken, ["1 normal that is not finite"]);
        assert_eq!(object.mesh.corner_normals().expect("normals")[0][1].to_array(), [0.0; 3]);
    }
}

#[test]
fn a_scene_file_s_pointer_names_a_mesh_or_is_a_line() {
    let folder = folder();
    let text = |mesh: &str| format!("[[objects]]\nmesh = {mesh:?}\n");
    let file = sample("beside.gltf").display().to_string();
    let cases = [
        (format!("{file}#/meshes/9"), "has 2 meshes and 6 nodes, and `/meshes/9` names none"),
        (format!("{file}#/cameras/0"), "and `/cameras/0` names none"),
        (file.clone(), "and a bare name names none"),
        (format!("{file}#/nodes/4"), "has no mesh at node 4: name another"),
    ];
    for (mesh, words) in cases {
        fs::write(folder.path().join("a.toml"), text(&mesh)).expect("written");
        let error = opened(&folder.path().join("a.toml")).expect_err(words).to_string();
        assert!(error.contains(words) && error.contains("a.toml:2: "), "{error}, not {words}");
    }
}

#[test]
fn commands_take_gltf_and_say_what_is_not_shown() {
    let folder = folder();
    let file = sample("not-done.glb").display().to_string();
    done(folder.path(), &["capture", &file, "-t", "none", "--size", "32x24", "-o", "out"]);
    let manifest = read_json(&folder.path().join("out/manifest.json"));
    let left_out = manifest["left_out"].as_array().expect("a list");
    let named = left_out.iter().find(|one| one["decision"] == "scene-file" && one["what"] == "the cone of `spot`");
    assert_eq!(named.expect("it is named")["of"], "not-done");
    // A glTF file's up is y, and no result is written over one.
    assert_fails(&["capture", &file, "--z-up", "-o", "b"], 2, &["turns a bare model"]);
    assert_fails(&["report", "tori", "--json", "a.glb"], 2, &["names a scene"]);
}

/// A file of one triangle whose corners are shared by `count` primitives, under nodes; `more` are further members.
fn shared(nodes: &str, count: usize, more: &str) -> String {
    let primitives = vec![r#"{"attributes":{"POSITION":0,"NORMAL":0}}"#; count].join(",");
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36,"uri":"{CORNERS}"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
"meshes":[{{"primitives":[{primitives}]}}],"nodes":[{nodes}]{more}}}"#
    )
}

fn put(folder: &Path, name: &str, text: &str) -> PathBuf {
    fs::write(folder.join(name), text).expect("written");
    folder.join(name)
}

#[test]
fn what_primitives_share_is_read_once_and_what_many_nodes_show_is_limited() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = put(folder.path(), "shared.gltf", &shared(r#"{"mesh":0}"#, 5000, ""));
    let scene = opened(&file).expect("a scene");
    assert_eq!((scene.objects[0].mesh.triangles().len(), scene.objects[0].mesh.positions().len()), (5000, 3));
    // Mirrored, each node has vertices of its own.
    let mirrored = vec![r#"{"mesh":0,"scale":[-1,1,1]}"#; 400].join(",");
    let file = put(folder.path(), "mirrored.gltf", &shared(&mirrored, 100, ""));
    assert_eq!(opened(&file).expect("a scene").objects.len(), 401);
    let corners = 9_000;
    let zeros = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{0},"uri":"many.bin"}}],
"bufferViews":[{{"buffer":0,"byteLength":{0}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{corners},"type":"VEC3"}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{1}]}}"#,
        12 * corners,
        vec![r#"{"mesh":0}"#; 1000].join(",")
    );
    let bytes: Vec<u8> = (0..3 * corners).flat_map(|index| (index as f32).to_le_bytes()).collect();
    fs::write(folder.path().join("many.bin"), bytes).expect("written");
    let error = opened(&put(folder.path(), "many.gltf", &zeros)).expect_err("nine million").to_string();
    assert!(error.contains("has more than 8388608 vertices, those of all its instances"), "{error}");
}

/// Pictures within files are distinguished by file.
#[test]
fn two_files_in_one_scene_show_their_own_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let textures = sample("").with_file_name("textures");
    for name in ["crate", "tiles"] {
        let png = fs::read(textures.join(format!("{name}.png"))).expect("a picture");
        let uri: String = png.iter().map(|byte| format!("%{byte:02x}")).collect();
        let more = format!(
            r#","images":[{{"uri":"data:image/png,{uri}"}}],"textures":[{{"source":0}}],
"materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}]"#
        );
        let text = shared(r#"{"mesh":0}"#, 1, &more);
        let text = text.replace(r#""NORMAL":0}"#, r#""TEXCOORD_0":1},"material":0"#);
        let uvs = r#"},{"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"}],"#;
        put(
            folder.path(),
            &format!("{name}.gltf"),
            &text.replacen("}],\n\"meshes\"", &format!("{uvs}\n\"meshes\""), 1),
        );
    }
    let text = "[[objects]]\nmesh = \"crate.gltf#/meshes/0\"\n[[objects]]\nmesh = \"tiles.gltf\"\n";
    let scene = opened(&put(folder.path(), "two.toml", text)).expect("a scene");
    let sizes = [0, 1].map(|index: usize| {
        let texture = scene.objects[index].mesh.groups()[0].texture.as_ref().expect("a picture");
        texture.picture.texels().to_vec()
    });
    assert_ne!(sizes[0], sizes[1]);
}

#[test]
fn what_turns_and_can_t_is_named_and_a_sun_on_its_own_node_turns() {
    let folder = tempfile::tempdir().expect("a folder");
    // Times 0, 1 to 4 and quarter turns about y.
    let numbers: Vec<f32> = (0..5).map(|step| step as f32).collect();
    let turns = (0..5).flat_map(|step| {
        let (sin, cos) = (step as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
        [0.0, sin, 0.0, cos]
    });
    let bytes: Vec<u8> = numbers.into_iter().chain(turns).flat_map(f32::to_le_bytes).collect();
    fs::write(folder.path().join("turns.bin"), bytes).expect("written");
    let turning = |nodes: &str, targets: &[usize]| {
        let channels =
            targets.iter().map(|node| format!(r#"{{"sampler":0,"target":{{"node":{node},"path":"rotation"}}}}"#));
        let more = format!(
            r#","animations":[{{"channels":[{}],"samplers":[{{"input":1,"output":2}}]}}],
"cameras":[{{"type":"perspective","perspective":{{"yfov":0.7,"znear":0.1}}}}],
"extensionsUsed":["KHR_lights_punctual"],"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"directional"}}]}}}}"#,
            channels.collect::<Vec<_>>().join(",")
        );
        let text = shared(nodes, 1, &more);
        let text = text.replacen("}],\n\"bufferViews\":[", "},{\"byteLength\":100,\"uri\":\"turns.bin\"}],\n\"bufferViews\":[{\"buffer\":1,\"byteLength\":20},{\"buffer\":1,\"byteOffset\":20,\"byteLength\":80},", 1);
        let text = text.replacen("[{\"bufferView\":0,", "[{\"bufferView\":2,", 1);
        text.replacen(
            "}],\n\"meshes\"",
            "},{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"SCALAR\"},{\"bufferView\":1,\"componentType\":5126,\"count\":5,\"type\":\"VEC4\"}],\n\"meshes\"",
            1,
        )
    };
    let sun = r#"{"mesh":0},{"children":[2]},{"rotation":[-0.5,0,0,0.866025],"extensions":{"KHR_lights_punctual":{"light":0}}}"#;
    let scene = opened(&put(folder.path(), "sun.gltf", &turning(sun, &[1]))).expect("a scene");
    let [before, after] = [&scene, &scene.at(1.0)].map(|scene| scene.lights[0].position.truncate());
    let quarter = DQuat::from_rotation_y(90_f64.to_radians());
    assert!(after.distance(quarter * before) < 1e-6 && after.distance(before) > 0.5, "{before} {after}");
    let cases = [
        (r#"{"mesh":0,"scale":[-1,1,1]}"#, 0, "the turn of `node 0`: it is skinned, sheared or mirrored"),
        (
            r#"{"mesh":0},{"children":[2]},{"camera":0,"translation":[0,0,9]}"#,
            1,
            "the turn of the camera on node 2: the eye",
        ),
        (
            r#"{"children":[1]},{"mesh":0,"rotation":[0.182574,0.365148,0.547723,0.730297]}"#,
            0,
            "the turn of `node 1`: no spin about x, y or z turns a thing that leans so",
        ),
        (
            r#"{"children":[1],"scale":[1,2,1]},{"mesh":0}"#,
            1,
            "the turn of `node 1` over time: what it hangs on is mirrored",
        ),
    ];
    for (nodes, target, words) in cases {
        let scene = opened(&put(folder.path(), "turn.gltf", &turning(nodes, &[target]))).expect("a scene");
        let not_taken: Vec<String> =
            scene.not_taken.iter().map(|one| format!("{}: {}", one.what, one.because)).collect();
        assert!(not_taken.iter().any(|line| line.starts_with(words)) && !scene.is_animated(), "{words}: {not_taken:?}");
    }
}

/// Names and normals that an OBJ file can't have don't keep a scene from being saved and read again.
#[test]
fn odd_names_and_normals_survive_being_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let nan = CORNERS.replace("AACAPw", "AADAfw");
    let text = shared(r#"{"mesh":0}"#, 2, r#","materials":[{"name":"wood\\","emissiveFactor":[0.5,0,0]}]"#);
    let text = text.replacen(r#""NORMAL":0}"#, r#""NORMAL":1},"material":0"#, 1);
    let text = text.replacen(
        "}],\n\"bufferViews\":[",
        &format!("}},{{\"byteLength\":36,\"uri\":\"{nan}\"}}],\n\"bufferViews\":[{{\"buffer\":1,\"byteLength\":36}},"),
        1,
    );
    let text = text.replacen("[{\"bufferView\":0,", "[{\"bufferView\":1,", 1);
    let text = text.replacen(
        "}],\n\"meshes\"",
        "},{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\n\"meshes\"",
        1,
    );
    let scene = opened(&put(folder.path(), "odd.gltf", &text)).expect("a scene");
    let file = folder.path().join("saved.toml");
    // Without its source, every mesh becomes a model of its own.
    stencilscope::scene::file::store(&scene, None, &file).expect("stored");
    let again = opened(&file).unwrap_or_else(|error| panic!("{error}"));
    let looks = |scene: &Scene| {
        let groups = scene.objects[0].mesh.groups().iter();
        groups.map(|group| group.material.map(|material| material.emission)).collect::<Vec<_>>()
    };
    assert_eq!(looks(&scene), [Some([0.5, 0.0, 0.0]), None]);
    assert_eq!(looks(&again), looks(&scene));
}

/// An armature that mirrors turns the triangles round, and nothing is inside out.
#[test]
fn a_skin_below_a_mirror_is_right_side_out() {
    let bytes = fs::read(sample("skin.glb")).expect("a sample");
    let plain = scene("skin.glb");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let json = String::from_utf8(bytes[20..20 + length].to_vec()).expect("JSON");
    let (from, to) = ("\"scale\":[0.8,0.8,0.8]", "\"scale\":[-.8,0.8,0.8]");
    let json = json.replace(": ", ":").replace(", ", ",");
    assert!(json.contains(from), "{json}");
    let json = json.replace(from, &to.replace("-.8", "-0.8"));
    let json = format!("{json}{}", " ".repeat((4 - json.len() % 4) % 4));
    let rest = &bytes[20 + length..];
    let mut mirrored = b"glTF\x02\0\0\0".to_vec();
    mirrored.extend((20 + json.len() as u32 + rest.len() as u32).to_le_bytes());
    mirrored.extend((json.len() as u32).to_le_bytes());
    mirrored.extend(b"JSON");
    mirrored.extend(json.as_bytes());
    mirrored.extend(rest);
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mirrored.glb"), mirrored).expect("written");
    let mirrored = opened(&folder.path().join("mirrored.glb")).unwrap_or_else(|error| panic!("{error}"));
    let [one, other] = [&plain, &mirrored].map(|scene| volume(scene, "arm"));
    assert!(one > 0.1 && (one - other).abs() < 1e-6 * one, "{one} {other}");
}
