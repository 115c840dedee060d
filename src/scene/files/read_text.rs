//! Reading a text file whole, with a separate error for each way in which that fails, and numbers in the words of models
//! that are text.

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

/// Returns the text of a file in any encoding that [`decoded`] knows, as files of old programs are.
pub fn read_old_text(file: &Path, kind: &str) -> Result<String, SceneError> {
    read(file, kind, |bytes| Some(decoded(bytes)))
}

/// Decodes UTF-16 after its byte order mark, UTF-8, or else Latin-1, in which different names stay different. Lines that
/// end with a carriage return alone, as on old Macs, end with a line feed in the result.
pub fn decoded(bytes: Vec<u8>) -> String {
    let text = match &bytes[..] {
        [0xff, 0xfe, units @ ..] => wide(units, u16::from_le_bytes),
        [0xfe, 0xff, units @ ..] => wide(units, u16::from_be_bytes),
        _ => String::from_utf8(bytes).unwrap_or_else(|error| error.into_bytes().into_iter().map(char::from).collect()),
    };
    if !text.contains('\n') && text.contains('\r') { text.replace('\r', "\n") } else { text }
}

/// Decodes UTF-16, the bytes of whose units `of` puts in order; what is no character becomes U+FFFD.
fn wide(units: &[u8], of: impl Fn([u8; 2]) -> u16) -> String {
    char::decode_utf16(units.as_chunks().0.iter().map(|unit| of(*unit)))
        .map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}

fn read(file: &Path, kind: &str, decode: impl FnOnce(Vec<u8>) -> Option<String>) -> Result<String, SceneError> {
    let fail = |reason: String| SceneError::Read { file: file.to_owned(), reason };
    let bytes = read_plain(file, MOST_TEXT).map_err(|error| match error {
        ReadError::Folder => fail(format!("is a folder: name an {kind} in it")),
        other => fail(other.to_string()),
    })?;
    let is_wide = matches!(bytes[..], [0xff, 0xfe, ..] | [0xfe, 0xff, ..]);
    let text = decode(bytes).filter(|text| !text.contains('\0'));
    let Some(text) = text else {
        let reason = if is_wide { "is in UTF-16: save the" } else { "is not a text file: give an" };
        return Err(fail(format!("{reason} {kind} in UTF-8")));
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

/// Returns the number that a word of a model's text stands for, NaN and infinity among them; `None` where it is no number.
/// Besides plain numbers it reads those of other languages and runtimes: `1.5D5`, `1.5+2` (Fortran, whose exponent may
/// have no letter) and `1.5+e2`; `1.#INF`, `-1.#IND`, `1.#QNAN` and `-nan(ind)` (Microsoft's).
pub fn number(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| foreign_number(word))
}

/// Returns what [`number`] does in single precision, rounded once.
pub fn single_number(word: &str) -> Option<f32> {
    word.parse().ok().or_else(|| foreign_number(word).map(|number| number as f32))
}

fn foreign_number(word: &str) -> Option<f64> {
    let lower = word.to_ascii_lowercase();
    let unsigned = lower.strip_prefix(['-', '+']).unwrap_or(&lower);
    if let Some(name) = unsigned.strip_prefix("1.#") {
        // Rounded to few digits, the names are cut and their last letter counts on: `1.#R`, `1.#QO`.
        let is_name = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric());
        return is_name.then_some(if name.starts_with("inf") { f64::INFINITY } else { f64::NAN });
    }
    if unsigned.strip_prefix("nan(").is_some_and(|rest| rest.ends_with(')')) {
        return Some(f64::NAN);
    }
    let (digits, exponent) = unsigned.split_at(unsigned.find(['+', '-', 'd'])?);
    let power = exponent.trim_start_matches(['+', '-', 'd', 'e']);
    let power_sign = match &exponent[..exponent.len() - power.len()] {
        "d" | "d+" | "+d" | "+e" => "",
        "d-" | "-d" | "-e" => "-",
        // Without a letter only after a point: `1-2` may be two numbers.
        "+" if digits.contains('.') => "",
        "-" if digits.contains('.') => "-",
        _ => return None,
    };
    let sign = if lower.starts_with('-') { "-" } else { "" };
    format!("{sign}{digits}e{power_sign}{power}").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_other_languages_are_read_and_words_are_not() {
        let read = [
            ("1.5", 1.5),
            (".5", 0.5),
            ("+2.", 2.0),
            ("3.1+e2", 310.0),
            ("-3.1-e2", -0.031),
            ("3.1+2", 310.0),
            ("3.1-102", 3.1e-102),
            ("1d5", 1e5),
            ("1.5D-05", 1.5e-5),
            ("1.5D+05", 1.5e5),
            ("1e999", f64::INFINITY),
            ("inf", f64::INFINITY),
            ("1.#INF", f64::INFINITY),
            ("1.#INF00", f64::INFINITY),
        ];
        for (word, expected) in read {
            assert_eq!(number(word), Some(expected), "{word}");
        }
        for word in ["nan", "-NaN", "1.#IND", "-1.#IND", "1.#QNAN0", "-1.#J", "-nan(ind)", "nan(snan)"] {
            assert!(number(word).is_some_and(f64::is_nan), "{word}");
            assert!(single_number(word).is_some_and(f32::is_nan), "{word}");
        }
        let words = [
            "", "abc", "-", "+", "1-2", "0.1-0.2", "1.0+", "1.0+2+3", "1.5e", "d5", "1,5", "1.#", "1.#a b", "nan(",
            "0x10", "1.5++2", "e5", "+-1",
        ];
        for word in words {
            assert_eq!(number(word), None, "{word}");
        }
        assert_eq!(single_number("0.1"), Some(0.1));
    }
}
