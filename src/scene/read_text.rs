//! Reading a text file whole, with the ways in which that fails told apart.

use super::SceneError;
use crate::files::{ReadError, read_plain};
use std::path::Path;

/// Bytes of the largest text that is read.
pub const MOST_TEXT: u64 = 2 << 30;

/// The text of `file`, a byte order mark removed.
///
/// # Errors
/// A missing or unreadable file, a folder, a device, a text that is too long, bytes that are no UTF-8 text, an empty
/// file. `kind` says what was expected: `OBJ model`.
pub fn read_text(file: &Path, kind: &str) -> Result<String, SceneError> {
    let fail = |reason: String| SceneError::Read { file: file.to_owned(), reason };
    let bytes = read_plain(file, MOST_TEXT).map_err(|error| match error {
        ReadError::Folder => fail(format!("is a folder: name an {kind} in it")),
        other => fail(other.to_string()),
    })?;
    let text = String::from_utf8(bytes).ok().filter(|text| !text.contains('\0'));
    let Some(text) = text else {
        return Err(fail(format!("is not a text file: give an {kind} in UTF-8")));
    };
    if text.trim().is_empty() {
        return Err(fail(format!("is empty: give an {kind} with content")));
    }
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// A word of a file as it may stand in an error line: short, and no control characters.
pub fn quoted(word: &str) -> String {
    const MOST: usize = 40;
    let shown: String = word.chars().take(MOST).flat_map(char::escape_debug).collect();
    let rest = if word.chars().nth(MOST).is_some() { "…" } else { "" };
    format!("`{shown}{rest}`")
}

/// A file's name without folder and ending.
pub(in crate::scene) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
