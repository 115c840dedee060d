//! Files in memory are read as those on disk are, by the same readers.

use super::file::store;
use super::{OpenSpec, files_of, open};
use crate::files::brought::{InMemory, main_file, take_written};
use crate::scene::Scene;
use std::path::Path;

/// Folders of the repository that have scenes, and what these name.
const FOLDERS: [&str; 5] = ["assets/scenes", "assets/models", "assets/textures", "assets/gltf", "assets/ply"];

/// Returns the files of [`FOLDERS`] with their paths, which are relative to the repository and so to where tests run.
fn files() -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for folder in FOLDERS {
        for file in std::fs::read_dir(folder).expect("a folder") {
            let path = file.expect("a file").path();
            let name = format!("{folder}/{}", path.file_name().expect("a name").to_string_lossy());
            files.push((name, std::fs::read(path).expect("its content")));
        }
    }
    files
}

fn in_memory(files: &[(String, Vec<u8>)]) -> InMemory {
    InMemory::with(&files.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect::<Vec<_>>())
}

fn opened(name: &str) -> Scene {
    open(&OpenSpec::new(name)).expect(name)
}

#[test]
fn scenes_and_models_in_memory_are_those_on_disk() {
    let files = files();
    let names: Vec<&str> =
        files.iter().map(|(name, _)| name.as_str()).filter(|name| main_file([*name]).is_ok()).collect();
    for ending in ["toml", "obj", "ply", "gltf", "glb"] {
        assert!(names.iter().any(|name| name.ends_with(ending)), "none of {ending}");
    }
    for name in names {
        let (on_disk, files_on_disk) = (opened(name), files_of(&OpenSpec::new(name)));
        let _files = in_memory(&files);
        assert!(on_disk == opened(name), "{name}");
        assert_eq!(files_of(&OpenSpec::new(name)), files_on_disk, "{name}");
    }
}

/// A model whose library, buffer or picture was not dropped says which one is missing, or is shown without it.
#[test]
fn what_was_not_brought_is_missing() {
    let all = files();
    let without = |missing: &str| all.iter().filter(|(name, _)| !name.ends_with(missing)).cloned().collect::<Vec<_>>();
    let textured = opened("assets/models/crate.obj");
    for missing in ["crate.mtl", "crate.png"] {
        let _files = in_memory(&without(missing));
        let plain = opened("assets/models/crate.obj");
        assert_eq!(plain.objects[0].mesh.positions(), textured.objects[0].mesh.positions());
        let named = plain.objects.iter().flat_map(|object| object.mesh.not_taken());
        assert!(plain != textured && named.count() > 0, "{missing}");
    }
    for (missing, name) in [("boxes.bin", "assets/gltf/beside.gltf"), ("knot.obj", "assets/scenes/knot.toml")] {
        let _files = in_memory(&without(missing));
        let error = open(&OpenSpec::new(name)).expect_err(missing).to_string();
        assert!(error.contains("there is no such file"), "{error}");
    }
    let _files = in_memory(&all);
    assert!(open(&OpenSpec::new("assets/scenes")).is_err_and(|error| error.to_string().contains("is a folder")));
    assert!(
        open(&OpenSpec::new("assets/models/crate.mtl")).is_err_and(|error| error.to_string().contains("of no kind"))
    );
}

#[test]
fn a_scene_that_is_saved_in_memory_names_what_was_brought_and_is_handed_on() {
    let name = "assets/scenes/pattern.toml";
    let all = files();
    let _files = in_memory(&all);
    let scene = opened(name);
    store(&scene, Some(Path::new(name)), Path::new("assets/scenes/saved.toml")).expect("saved");
    let written = take_written();
    let (last, text) = written.last().expect("the scene file");
    assert_eq!(last, "assets/scenes/saved.toml");
    let again: Vec<(String, Vec<u8>)> =
        all.iter().cloned().chain(written.iter().map(|(name, bytes)| (name.clone(), bytes.to_vec()))).collect();
    let _files = in_memory(&again);
    assert_eq!(Scene { name: scene.name.clone(), ..opened(last) }, scene, "{}", String::from_utf8_lossy(text));
    // Another model of that name stays as it is.
    let names: Vec<(&str, &[u8])> =
        written.iter().map(|(name, bytes)| (name.as_str(), if name == last { &bytes[..] } else { b"v" })).collect();
    let _files = InMemory::with(&names);
    let stored = store(&scene, None, Path::new(last));
    assert!(stored.is_err_and(|error| error.to_string().contains("choose another name")) && take_written().is_empty());
}
