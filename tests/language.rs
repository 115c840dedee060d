//! The language of the code: one name for one type, and the field's words (`assets/glossary.md`).

use crate::layering::rust_files;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Words that stand for something the field has another word for, with that word. As parts of identifiers, and in
/// comments.
const NOT_OUR_WORDS: [(&str, &str); 12] = [
    ("sight", "ray"),
    ("sights", "rays"),
    ("pencil", "hierarchy of a ray origin"),
    ("hugging", "grazing, or coplanar"),
    ("hugs", "grazes"),
    ("mend", "fix"),
    ("mends", "fixes"),
    ("mended", "fixed"),
    ("room", "budget, limit or space"),
    ("told", "reported, explained or shown"),
    ("pyramid", "mip chain"),
    ("fate", "outcome"),
];

/// Folders whose scenes have rooms with walls.
const SCENES_WITH_ROOMS: [&str; 3] = ["src/scene/builtin/", "src/scene/shapes.rs", "src/stress/cases/"];

/// A file of the library and the program, without its own tests.
struct Source {
    path: String,
    text: String,
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = rust_files(&root.join("src")).into_iter().filter(|file| !file.ends_with("tests.rs"));
    let source = |file: std::path::PathBuf| {
        let text = fs::read_to_string(&file).expect("a source file");
        let end = text.find("#[cfg(test)]\nmod ").unwrap_or(text.len());
        let path = file.strip_prefix(root).expect("in the crate").display().to_string();
        Source { path, text: text[..end].to_owned() }
    };
    files.map(source).collect()
}

/// The types that a text defines, each with whether others may name it. A `type` that is indented belongs to a trait.
fn types(text: &str) -> Vec<(String, bool)> {
    let mut found = Vec::new();
    for line in text.lines() {
        let code = line.trim_start();
        let is_indented = code.len() < line.len();
        let is_public = code.starts_with("pub ") || code.starts_with("pub(");
        let code = match (is_public, code.find(' ')) {
            (true, Some(after)) => &code[after + 1..],
            _ => code,
        };
        let Some((keyword, rest)) = code.split_once(' ') else { continue };
        let is_type = ["struct", "enum", "trait", "union"].contains(&keyword) || (keyword == "type" && !is_indented);
        let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        if is_type && name.starts_with(char::is_uppercase) {
            found.push((name, is_public));
        }
    }
    found
}

/// Names that are given twice where one of them is public, or more than twice.
fn given_twice<'a>(all: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<String> {
    let mut places: BTreeMap<String, Vec<(&str, bool)>> = BTreeMap::new();
    for (path, text) in all {
        for (name, is_public) in types(text) {
            places.entry(name).or_default().push((path, is_public));
        }
    }
    let is_wrong = |places: &[(&str, bool)]| match places.iter().any(|(_, is_public)| *is_public) {
        true => places.len() > 1,
        false => places.len() > 2,
    };
    let wrong = places.into_iter().filter(|(_, places)| is_wrong(places));
    wrong
        .map(|(name, places)| {
            format!("{name}: {}", places.iter().map(|(path, _)| *path).collect::<Vec<_>>().join(", "))
        })
        .collect()
}

/// Words of a text as a reader sees them: parts of identifiers are words of their own.
fn words(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    for run in text.split(|c: char| !c.is_alphanumeric()) {
        let mut word = String::new();
        for c in run.chars() {
            if c.is_uppercase() && !word.is_empty() && !word.ends_with(char::is_uppercase) {
                words.push(std::mem::take(&mut word).to_lowercase());
            }
            word.push(c);
        }
        words.push(word.to_lowercase());
    }
    words
}

/// A text without what stands between quotes: what the program says to people.
fn without_strings(text: &str) -> String {
    let mut out = String::new();
    let mut letters = text.chars().peekable();
    let mut is_string = false;
    while let Some(c) = letters.next() {
        match c {
            '\\' if is_string => drop(letters.next()),
            '"' if !out.ends_with('\'') => is_string = !is_string,
            '\n' => out.push('\n'),
            c if !is_string => out.push(c),
            _ => {}
        }
    }
    out
}

#[test]
fn each_name_is_given_to_one_type() {
    let sources = sources();
    let wrong = given_twice(sources.iter().map(|source| (source.path.as_str(), source.text.as_str())));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn code_and_comments_speak_the_fields_words() {
    let mut wrong = Vec::new();
    for Source { path, text } in sources() {
        for (number, line) in without_strings(&text).lines().enumerate() {
            let mut words = words(line);
            words.retain(|word| word != "room" || !SCENES_WITH_ROOMS.iter().any(|folder| path.starts_with(folder)));
            let found = NOT_OUR_WORDS.iter().filter(|(word, _)| words.iter().any(|one| one == word));
            wrong.extend(found.map(|(word, better)| format!("{path}:{}: `{word}` is {better}", number + 1)));
        }
    }
    assert!(wrong.is_empty(), "{} places:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_name_given_twice_and_a_word_of_ours_are_found() {
    let one = "pub struct Key;\nstruct Row;\n    type Err = String;";
    let two = "enum Key {}\nstruct Row;\n    type Err = String;";
    assert_eq!(given_twice([("one", one), ("two", two)].into_iter()), ["Key: one, two"]);
    assert_eq!(given_twice([("a", "struct Row;"), ("b", two), ("c", one)].into_iter()).len(), 2);
    assert_eq!(
        words("let LightPencil = mend_of(RGBImage);"),
        ["let", "light", "pencil", "", "", "mend", "of", "rgbimage", "", ""]
    );
    assert_eq!(without_strings("a \"mend \\\" it\" b"), "a  b");
}
