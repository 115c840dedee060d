//! Files that are there whole or not at all.

use std::io;
use std::path::Path;

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
