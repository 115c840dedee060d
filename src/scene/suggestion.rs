//! "Did you mean": the name that a misspelt word is most like.

/// Below this two names have little in common (Jaro–Winkler likeness, 0 to 1).
const LIKE: f64 = 0.75;

/// Returns the name that is most like `word`, which is compared in lower case, so that names must be; `None` where none
/// is much like it.
pub fn nearest<'a>(word: &str, names: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let rated = names.iter().map(|name| (strsim::jaro_winkler(&word, name), *name));
    rated.filter(|(likeness, _)| *likeness > LIKE).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

/// Suggests how to fix a name that is not known: the nearest of `names`, else all of them; or to delete it where there
/// are none.
pub fn suggestion(word: &str, names: &[&str]) -> String {
    match nearest(word, names) {
        Some(near) => format!("did you mean `{near}`?"),
        None if names.is_empty() => "delete it".to_owned(),
        None => format!("choose one of {}", names.join(", ")),
    }
}
