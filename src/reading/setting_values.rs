//! What a value of a setting does, read off the setting's lesson, which explains each word that can be chosen.

use crate::technique::SettingSpec;

/// The most sentences that are taken of a lesson for one word.
const MOST_SENTENCES: usize = 2;

/// Returns what choosing a word does: its row of the lesson's table, or the sentences that name it; what the setting is
/// for where there are none.
pub fn meaning(spec: &SettingSpec, word: &str) -> String {
    let text = spec.lesson.text;
    // A row may explain several words.
    let named = format!("`{word}`");
    let mut rows = text.lines().filter_map(|line| line.strip_prefix('|')?.split_once('|'));
    if let Some((_, row)) = rows.find(|(words, _)| words.contains(&named)) {
        let cells: Vec<&str> = row.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect();
        return plain(&cells.join(": "));
    }
    let sentences = text.lines().filter(|line| !line.starts_with('|')).flat_map(|line| line.split_inclusive(". "));
    let names_it = |sentence: &&str| ["`", ":", " "].iter().any(|end| sentence.contains(&format!("`{word}{end}")));
    let found: Vec<&str> = sentences.filter(names_it).take(MOST_SENTENCES).map(str::trim).collect();
    if found.is_empty() { plain(spec.meaning) } else { plain(&found.join(" ")) }
}

/// Returns a text of a lesson without its marks.
fn plain(text: &str) -> String {
    text.replace('`', "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::{SettingValues, Technique};

    fn said(technique: Technique, key: &str, word: &str) -> String {
        let spec = technique.settings().iter().find(|spec| spec.key == key).expect("a setting");
        meaning(spec, word)
    }

    #[test]
    fn a_word_has_the_sentence_that_names_it() {
        assert!(said(Technique::ZFail, "operations", "invert").starts_with("With invert each face turns one bit over"));
        assert!(said(Technique::ZFail, "extrusion", "finite").starts_with("finite:K ends volumes at K times"));
        assert!(said(Technique::ZFail, "casters", "light-facing").contains("suffices for a closed mesh"));
        assert!(said(Technique::ZFail, "leave-out", "scissor").starts_with("pixels of a light's passes"));
    }

    /// Each word of a setting tells more than the setting's own line, so that none is hovered for nothing.
    #[test]
    fn every_word_that_can_be_chosen_is_explained() {
        let mut lacking = Vec::new();
        for technique in Technique::ALL {
            for spec in technique.settings() {
                let words: &[&str] = match &spec.values {
                    SettingValues::OneOf(words) if words.len() > 1 => words,
                    SettingValues::SomeOf(words) | SettingValues::WordOrFrustum(words) => words,
                    SettingValues::WordOr { words, .. } => words,
                    _ => &[],
                };
                let is_lacking = |word: &&&str| meaning(spec, word) == plain(spec.meaning);
                lacking.extend(words.iter().filter(is_lacking).map(|word| format!("{} {word}", spec.key)));
            }
        }
        lacking.dedup();
        assert!(lacking.is_empty(), "{lacking:?}");
    }
}
