//! Why a folder that the user opens is no capture folder.

use crate::capture::disk;
use std::collections::BTreeSet;
use std::path::Path;

/// Files of scenes and models that can be opened, by their extensions.
const OPENED: [&str; 5] = ["toml", "obj", "ply", "gltf", "glb"];

/// Returns a sentence on why a folder is no capture folder, with what can be opened instead; `None` where it is one, as far
/// as is seen without reading it.
pub fn why(folder: &Path) -> Option<String> {
    if disk::is_capture(folder) {
        return None;
    }
    let name = folder.display();
    let names = match std::fs::read_dir(folder).and_then(|entries| entries.collect::<Result<Vec<_>, _>>()) {
        Ok(entries) => entries.into_iter().map(|entry| entry.path()).collect::<BTreeSet<_>>(),
        Err(error) => {
            let what =
                format!("{name} is no capture folder, as it has no manifest.json, and can't be listed ({error})");
            return Some(format!("{what}: open another one"));
        }
    };
    let ending = |path: &Path| path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let mut scenes = names.iter().filter(|path| ending(path).is_some_and(|ending| OPENED.contains(&&*ending)));
    let instead = match (names.is_empty(), scenes.next()) {
        (true, _) => return Some(format!("{name} is empty: open a capture folder, a scene file or a model")),
        (false, Some(scene)) => format!("open a file in it, such as {}", scene.display()),
        (false, None) => "open a folder that `capture`, `record` or `import` made, a scene file or a model".to_owned(),
    };
    Some(format!("{name} is no capture folder, as it has no manifest.json: {instead}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_folder_is_called_so_and_a_model_in_another_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let said = || why(folder.path()).expect("it is none");
        assert!(said().ends_with(" is empty: open a capture folder, a scene file or a model"), "{}", said());
        std::fs::write(folder.path().join("notes.txt"), "").expect("written");
        assert!(said().contains("no capture folder, as it has no manifest.json"), "{}", said());
        std::fs::write(folder.path().join("knot.OBJ"), "").expect("written");
        assert!(said().ends_with("knot.OBJ"), "{}", said());
        // Of several, always the same one.
        for name in ["zebra.ply", "arch.glb", "mug.obj"] {
            std::fs::write(folder.path().join(name), "").expect("written");
        }
        assert!(said().ends_with("arch.glb"), "{}", said());
        std::fs::write(folder.path().join("manifest.json"), "").expect("written");
        assert_eq!(why(folder.path()), None);
    }
}
