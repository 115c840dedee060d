//! Files of pictures and of libraries that name them: what is shown of them, what is said of the rest, and what lies.

use super::asset;
use crate::commands::{assert_fails, done, folder, printed_json, read_json, run, text};
use glam::Vec2;
use stencilscope::capture::disk::read_whole;
use stencilscope::scene::{Mesh, OpenSpec, files_of, obj};

const BOX: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

/// The model of a library's text, and what was not taken of it.
fn model(library: &str, faces: &str) -> (Mesh, Vec<String>) {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    let tiles = std::fs::read(asset("textures/tiles.png")).expect("a picture");
    put("tiles.png", &tiles);
    put("two words.png", &tiles);
    put("cut.png", &tiles[..90]);
    put("m.mtl", library.as_bytes());
    put("m.obj", format!("mtllib m.mtl\n{BOX}usemtl a\n{faces}").as_bytes());
    let mesh = obj::load(&folder.path().join("m.obj")).expect("a mesh");
    let not_taken = mesh.not_taken().iter().map(|one| format!("{}: {}", one.what, one.because)).collect();
    (mesh, not_taken)
}

#[test]
fn a_library_s_pictures_are_shown_or_it_is_said_why_not() {
    let face = "f 1/1 2/2 3/3\n";
    let (mesh, not_taken) = model("newmtl a\nmap_Kd -s 2 4 -o 0.5 0 -clamp on two words.png\n", face);
    let texture = mesh.groups()[0].texture.as_ref().expect("a picture");
    assert!(not_taken.is_empty() && texture.clamps && texture.picture.name() == "two words.png", "{not_taken:?}");
    assert_eq!(mesh.groups()[0].material.expect("a material").color, [1.0; 3], "no Kd: as it is");
    let uvs = mesh.corner_uvs().expect("places")[0].expect("three");
    assert_eq!(uvs, [[0.5, 0.0], [2.5, 0.0], [0.5, 4.0]].map(Vec2::from_array));
    let cases = [
        ("map_Kd none.png", face, "map_Kd of `a`: `none.png` there is no such file"),
        ("map_Kd /dev/zero", face, "map_Kd of `a`: `/dev/zero` is a device: only plain files are read"),
        ("map_Kd cut.png", face, "map_Kd of `a`: `cut.png` is broken ("),
        ("map_Kd m.obj", face, "map_Kd of `a`: `m.obj` is neither PNG nor JPEG: convert it"),
        ("map_Kd .", face, "map_Kd of `a`: `.` is a folder"),
        ("map_Kd -mm 0 2 tiles.png", face, "-mm of map_Kd of `a`: nothing here does it"),
        ("map_Ks tiles.png", face, "map_Ks of `a`: of pictures, only"),
        ("map_Kd", face, "map_Kd of `a`: it names no file"),
        ("map_Kd tiles.png", "f 1/1 2/2 3/3\nf 2 3 4\n", "map_Kd of `a`: faces have no texture coordinates"),
        ("map_Kd tiles.png", "f 1/1 2/2 3/9\n", "map_Kd of `a`: faces have no texture coordinates"),
    ];
    for (line, faces, words) in cases {
        let (mesh, not_taken) = model(&format!("newmtl a\nKd 0.2 0.4 0.6\n{line}\n"), faces);
        assert!(
            not_taken.len() == 1 && not_taken[0].starts_with(words) && !not_taken[0].contains('\n'),
            "{line}: {not_taken:?}"
        );
        let group = &mesh.groups()[0];
        assert_eq!(group.material.expect("a material").color, [0.2, 0.4, 0.6], "{line}");
        assert_eq!(group.texture.is_some(), line.contains("-mm"), "{line}");
    }
    let many: String = (0..99).map(|index| format!("newmtl m{index}\nmap_Ks none.png\n")).collect();
    let (_, not_taken) = model(&many, face);
    assert_eq!(
        (not_taken.len(), not_taken[32].as_str()),
        (33, "what else the file asks for: 32 things of it are named")
    );
    // What is not taken is in the plan, by name.
    let folder = folder();
    std::fs::write(folder.path().join("m.obj"), format!("mtllib /dev/zero\n{BOX}{face}")).expect("written");
    done(folder.path(), &["capture", "m.obj", "-t", "none", "--size", "32x24", "-o", "out"]);
    let manifest = read_json(&folder.path().join("out/manifest.json"));
    let left_out = manifest["left_out"].as_array().expect("a list");
    let named = left_out.iter().find(|one| one["decision"] == "material").expect("it is named");
    assert_eq!(named["what"], "the materials of `/dev/zero`");
    assert_eq!(named["because"], "is a device: only plain files are read");
}

#[test]
fn a_scene_file_s_texture_that_can_t_be_shown_is_a_line() {
    let tiles = asset("textures/tiles.png");
    let with = |mesh: &str, material: &str| {
        let folder = folder();
        let text = format!("[[objects]]\nmesh = {mesh}\nmaterial = {{ {material} }}\n");
        std::fs::write(folder.path().join("a.toml"), text).expect("written");
        run(folder.path(), &["capture", "a.toml", "-t", "none", "--size", "32x24", "-o", "out"])
    };
    let quad = "{ shape = \"quad\" }";
    let crate_obj = format!("{:?}", asset("models/crate.obj"));
    let cases = [
        (quad, format!("texture = {tiles:?}"), 3, "does not say where it lies in a picture"),
        (quad, "texture_side = 2".to_owned(), 3, "`texture_side` is of a `texture`"),
        (quad, "texture_clamps = true".to_owned(), 3, "`texture_clamps` is of a `texture`"),
        (quad, format!("texture = {tiles:?}, texture_side = 0"), 3, "must be from 0.001"),
        (quad, "texture = \"/dev/zero\", texture_side = 1".to_owned(), 3, "`/dev/zero` is a device"),
        (quad, "texture = \"none.png\", texture_side = 1".to_owned(), 3, "there is no such file"),
        (&crate_obj, format!("texture = {tiles:?}"), 3, "every part of the model has a material of its own"),
        ("\"/dev/zero\"", "specular = 0".to_owned(), 2, "is a device: only plain files are read"),
    ];
    for (mesh, material, line, words) in cases {
        let output = with(mesh, &material);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{material}: {message}");
        assert!(message.contains(&format!("a.toml:{line}: ")) && message.contains(words), "{material}: {message}");
        assert_eq!(message.trim_end().lines().filter(|line| line.contains("a.toml")).count(), 1, "{message}");
    }
    assert!(with(quad, &format!("texture = {tiles:?}, texture_side = 0.25")).status.success());
    assert_fails(&["capture", "/dev/zero", "-o", "out"], 2, &["/dev/zero"]);
}

/// What changes on disk is offered to be read again.
#[test]
fn a_scene_is_made_of_its_pictures_and_libraries_too() {
    let files = files_of(&OpenSpec::new(asset("scenes/pattern.toml")));
    let ends = ["pattern.toml", "crate.obj", "tiles.png", "crate.mtl", "crate.png"];
    for end in ends {
        assert!(files.iter().any(|file| file.ends_with(end) && file.is_file()), "{end} is none of {files:?}");
    }
    assert_eq!(files.len(), ends.len(), "{files:?}");
    assert_eq!(files_of(&OpenSpec::new(asset("models/crate.obj"))).len(), 3);
}

#[cfg(unix)]
#[test]
fn a_folder_with_a_pipe_in_it_is_refused_and_not_waited_for() {
    let folder = folder();
    let made = run(folder.path(), &["capture", "tetrahedron", "-t", "none", "--size", "32x24", "-o", "out"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    for file in
        ["manifest.json", "frame.json", "mesh000.vertices.npy", "000-ambient.color.png", "plan.txt", "scene.toml"]
    {
        let place = folder.path().join("out").join(file);
        let bytes = std::fs::read(&place).expect("bytes");
        std::fs::remove_file(&place).expect("removed");
        let made = std::process::Command::new("mkfifo").arg(&place).status().expect("mkfifo");
        assert!(made.success());
        let error = read_whole(&folder.path().join("out")).expect_err("a pipe").to_string();
        assert!(error.contains(file) && error.contains("is a pipe: only plain files are read"), "{file}: {error}");
        std::fs::remove_file(&place).expect("removed");
        std::fs::write(&place, bytes).expect("mended");
    }
    assert!(read_whole(&folder.path().join("out")).is_ok());
}

#[test]
fn pixel_reports_the_texel_and_explains_each_key() {
    let folder = folder();
    let scene = asset("scenes/pattern.toml");
    let arguments = ["pixel", &scene, "--size", "96x72", "--at", "60,60"];
    let printed = text(&run(folder.path(), &arguments).stdout);
    assert!(printed.contains("its colour is times (") && printed.contains(") of tiles.png, at u "), "{printed}");
    let document = printed_json(folder.path(), &[&arguments[..], &["--json"]].concat());
    assert_eq!(document["shading"]["texture"]["name"], "tiles.png");
    crate::help::assert_json_is_explained("pixel", &document);
}

/// A folder that names one picture thousands of times, and one whose places lie beyond all integers.
#[test]
fn a_folder_that_lies_about_pictures_takes_no_memory_and_is_no_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    let pixel = |name: &str| run(folder.path(), &["pixel", name, "--at", "32,40"]);
    let scene = asset("scenes/pattern.toml");
    let capture = ["capture", &scene, "-t", "z-fail", "--size", "64x48", "-o", "frame"];
    assert!(run(folder.path(), &capture).status.success());
    let plan = folder.path().join("frame/frame.json");
    let mut entry: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&plan).expect("a plan")).expect("an object");
    let textures = entry["textures"].as_array_mut().expect("textures");
    let one = textures[0].clone();
    textures.resize(5000, one);
    std::fs::write(&plan, entry.to_string()).expect("written");
    let output = pixel("frame");
    assert!(output.status.success() && text(&output.stdout).contains("texel"), "{}", text(&output.stderr));
    for file in std::fs::read_dir(folder.path().join("frame")).expect("a folder") {
        let file = file.expect("an entry").path();
        if file.to_string_lossy().ends_with("uvs.npy") {
            let mut bytes = std::fs::read(&file).expect("places");
            let head = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
            bytes[head..].chunks_exact_mut(4).for_each(|place| place.copy_from_slice(&3e38_f32.to_le_bytes()));
            std::fs::write(&file, bytes).expect("written");
        }
    }
    let output = pixel("frame");
    assert!(output.status.success() && text(&output.stdout).contains("texel"), "{}", text(&output.stderr));
}
