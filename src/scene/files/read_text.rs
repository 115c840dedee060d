//! Reading a text file whole, with a separate error for each way in which that fails.

use crate::files::{ReadError, read_plain};
use crate::scene::SceneError;
use std::path::Path;

/// The largest text file that is read, bytes.
pub const MOST_TEXT: u64 = 2 << 30;

/// Returns the text of `file`, a byte order mark removed.
///
/// # Errors
/// A missing or unreadable file, a folder, a device, a text that is too long, bytes that are no UTF-8 text, an empty
/// file. `kind` is what was expected, for the message: `OBJ model`.
pub fn read_text(file: &Path, kind: &str) -> Result<String, SceneError> {
    read(file, kind, |bytes| String::from_utf8(bytes).ok())
}

/// Returns the text of a file in any encoding that extends ASCII, as files of old programs are: what is not UTF-8 is
/// read as Latin-1, in which different names stay different.
pub fn read_old_text(file: &Path, kind: &str) -> Result<String, SceneError> {
    read(file, kind, |bytes| Some(decoded(bytes)))
}

/// Decodes UTF-8, or else Latin-1.
pub fn decoded(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap_or_else(|error| error.into_bytes().into_iter().map(char::from).collect())
}

fn read(file: &Path, kind: &str, decode: impl FnOnce(Vec<u8>) -> Option<String>) -> Result<String, SceneError> {
    let fail = |reason: String| SceneError::Read { file: file.to_owned(), reason };
    let bytes = read_plain(file, MOST_TEXT).map_err(|error| match error {
        ReadError::Folder => fail(format!("is a folder: name an {kind} in it")),
        other => fail(other.to_string()),
    })?;
    if matches!(bytes[..], [0xff, 0xfe, ..] | [0xfe, 0xff, ..]) {
        return Err(fail(format!("is in UTF-16: save the {kind} in UTF-8")));
    }
    let text = decode(bytes).filter(|text| !text.contains('\0'));
    let Some(text) = text else {
        return Err(fail(format!("is not a text file: give an {kind} in UTF-8")));
    };
    if text.trim().is_empty() {
        return Err(fail(format!("is empty: give an {kind} with content")));
    }
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Returns a word of a file as it may be in an error line: in backticks, at most 40 characters with an ellipsis after
/// them, control characters escaped.
pub fn quoted(word: &str) -> String {
    const MOST: usize = 40;
    let shown: String = word.chars().take(MOST).flat_map(char::escape_debug).collect();
    let rest = if word.chars().nth(MOST).is_some() { "…" } else { "" };
    format!("`{shown}{rest}`")
}

/// Returns a file's name without folder and ending.
pub(in crate::scene) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
