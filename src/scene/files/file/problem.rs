//! What is wrong with a scene file, and where.

use crate::scene::suggestion;
use std::ops::Range;

/// An error at a position of a scene file's text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneFileProblem {
    /// Byte offset of the value.
    pub at: usize,
    /// What is wrong and how to fix it, in one line.
    pub reason: String,
}

impl SceneFileProblem {
    /// Returns an error about the value at `span`.
    pub fn new(span: Range<usize>, reason: impl Into<String>) -> SceneFileProblem {
        SceneFileProblem { at: span.start, reason: reason.into() }
    }

    /// Returns the error that the TOML reader found.
    pub fn of_toml(error: &toml::de::Error) -> SceneFileProblem {
        SceneFileProblem { at: error.span().map_or(0, |span| span.start), reason: in_words(error.message()) }
    }

    /// Returns the problem's line in the text, counted from 1.
    pub fn line_in(&self, text: &str) -> usize {
        let before = text.as_bytes().get(..self.at).unwrap_or(text.as_bytes());
        before.iter().filter(|byte| **byte == b'\n').count() + 1
    }
}

/// Returns the TOML reader's message in one line and in plain words, with how to fix it.
fn in_words(message: &str) -> String {
    let message = message.replace(['\n', '\r'], " ");
    // serde: unknown field `colour`, expected one of `color`, `range`
    if let Some(rest) = message.strip_prefix("unknown field ") {
        let names: Vec<&str> = rest.split('`').skip(1).step_by(2).collect();
        if let [unknown, known @ ..] = names.as_slice() {
            return format!("unknown key `{unknown}`: {}", suggestion(unknown, known));
        }
    }
    if let Some(missing) = message.strip_prefix("missing field ") {
        return format!("the key {missing} is missing: add it");
    }
    let plain = [
        ("f64", "a number"),
        ("u32", "a whole number, not negative"),
        ("a boolean", "true or false"),
        ("a string", "a text in quotes"),
    ];
    let type_words = plain.iter().fold(message, |text, (type_name, words)| {
        text.replace(&format!("expected {type_name}"), &format!("expected {words}"))
    });
    format!("{type_words}; correct it")
}
