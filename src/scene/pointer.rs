//! Names of glTF files, and of one mesh within.

use std::path::Path;

/// Does a path name a glTF file?
pub fn is_gltf(path: &Path) -> bool {
    path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("gltf") || kind.eq_ignore_ascii_case("glb"))
}

/// The file and the pointer of `model.glb#/meshes/2`; no pointer of anything else.
pub fn split(name: &str) -> (&str, Option<&str>) {
    match name.rsplit_once('#') {
        Some((file, pointer)) if is_gltf(Path::new(file)) => (file, Some(pointer)),
        _ => (name, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_gltf_file_has_a_pointer() {
        assert_eq!(split("a#b.glb#/meshes/2"), ("a#b.glb", Some("/meshes/2")));
        assert_eq!(split("a.GLTF#/nodes/0"), ("a.GLTF", Some("/nodes/0")));
        assert_eq!(split("a#b.obj"), ("a#b.obj", None));
        assert_eq!(split("a.glb"), ("a.glb", None));
    }
}
