//! "Did you mean": the name that a misspelt word is most like.

/// Below this two names have little in common (Jaro–Winkler likeness, 0 to 1).
const LIKE: f64 = 0.75;

/// Returns the lower-case name that is most like `word` in any case, if one is much like it.
pub fn nearest<'a>(word: &str, names: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let rated = names.iter().map(|name| (strsim::jaro_winkler(&word, name), *name));
    rated.filter(|(likeness, _)| *likeness > LIKE).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

/// Suggests how to fix a name that is not known: the nearest one, else all of them.
pub fn suggestion(word: &str, names: &[&str]) -> String {
    match nearest(word, names) {
        Some(near) => format!("did you mean `{near}`?"),
        None if names.is_empty() => "delete it".to_owned(),
        None => format!("choose one of {}", names.join(", ")),
    }
}
