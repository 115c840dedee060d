//! Files that are there whole or not at all, and the way from one to another.

use std::io;
use std::path::{Component, Path, PathBuf};

/// Writes a file beside its place and renames it.
///
/// # Errors
/// The file can't be written; what was there before is still there then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // A link to a file stays a link: what it points to is replaced.
    let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.into());
    let mut beside = target.clone().into_os_string();
    beside.push(format!(".new-{}", std::process::id()));
    if target.exists() && !target.is_file() {
        // A device or a pipe has no place to be renamed into.
        return std::fs::write(path, bytes);
    }
    let written = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, &target));
    written.inspect_err(|_| {
        // What failed is the error already.
        let _ = std::fs::remove_file(&beside);
    })
}

/// The path of a file as another file beside it would name it: relative, where there is a way.
pub fn from_beside(file: &Path, other: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let both = folder.canonicalize().ok().zip(other.canonicalize().ok());
    let way = both.and_then(|(folder, other)| relative(&folder, &other));
    way.unwrap_or_else(|| other.to_owned()).to_string_lossy().into_owned()
}

/// The way from a folder to a file, both from the root; `None` where there is none, as between two drives.
fn relative(folder: &Path, file: &Path) -> Option<PathBuf> {
    let (folder, file): (Vec<Component>, Vec<Component>) = (folder.components().collect(), file.components().collect());
    let common = folder.iter().zip(&file).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return None;
    }
    let up = folder[common..].iter().map(|_| Component::ParentDir);
    Some(up.chain(file[common..].iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_goes_up_and_down() {
        let way = |folder: &str, file: &str| relative(Path::new(folder), Path::new(file));
        assert_eq!(way("/a/b", "/a/b/m.obj"), Some("m.obj".into()));
        assert_eq!(way("/a/b/c", "/a/d/m.obj"), Some("../../d/m.obj".into()));
        assert_eq!(way("a", "b/m.obj"), None);
    }
}
