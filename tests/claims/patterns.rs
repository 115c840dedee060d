//! Patterns of sentences: text with gaps.

use super::SeenPatterns;

/// What stands in the gaps `{}` of a pattern; `None` where the text is another one.
pub fn gaps<'a>(pattern: &str, text: &'a str) -> Option<Vec<&'a str>> {
    let mut pieces = pattern.split("{}");
    let mut rest = text.strip_prefix(pieces.next()?)?;
    let pieces: Vec<&str> = pieces.collect();
    let mut found = Vec::new();
    for (index, piece) in pieces.iter().enumerate() {
        let is_last = index + 1 == pieces.len();
        let at = if is_last { rest.strip_suffix(piece).map(str::len) } else { rest.find(piece) }?;
        found.push(&rest[..at]);
        rest = &rest[at + piece.len()..];
    }
    rest.is_empty().then_some(found)
}

/// The patterns that a text has, each with its check and its gaps.
pub fn matching<'t, C>(
    all: &'static [(&'static str, C)],
    text: &'t str,
) -> impl Iterator<Item = (&'static str, &'static C, Vec<&'t str>)> {
    all.iter().filter_map(move |(pattern, check)| Some((*pattern, check, gaps(pattern, text)?)))
}

/// What is wrong with a text: no pattern knows it, or it is so by the check of none that does.
pub fn find<'t, C: 'static>(
    known: impl Iterator<Item = (&'static str, &'static C, Vec<&'t str>)>,
    text: &str,
    seen: &mut SeenPatterns,
    is_so: impl Fn(&C, &[&str]) -> bool,
) -> Option<String> {
    let known: Vec<_> = known.collect();
    if let Some((pattern, ..)) = known.iter().find(|(_, check, parts)| is_so(check, parts)) {
        seen.insert(pattern);
        return None;
    }
    Some(match known.first() {
        Some((pattern, ..)) => format!("is not so ({pattern}): {text}"),
        None => format!("is known to no check: {text}"),
    })
}

/// All patterns but those with rare words, which the frames here may lack.
pub fn all_but<C>(rare: &[&str], all: &[&[(&'static str, C)]]) -> Vec<&'static str> {
    let patterns = all.iter().flat_map(|some| some.iter()).map(|(pattern, _)| *pattern);
    patterns.filter(|pattern| !rare.iter().any(|words| pattern.contains(words))).collect()
}

/// A number as it is written for people.
pub fn number(text: &str) -> f64 {
    let plain: String = text.chars().filter(|c| *c != '\u{a0}').map(|c| if c == '−' { '-' } else { c }).collect();
    let plain = plain.split(' ').next().unwrap_or_default();
    if plain == "∞" { f64::INFINITY } else { plain.parse().unwrap_or(f64::NAN) }
}

/// Is it this whole number?
pub fn is_number(text: &str, count: usize) -> bool {
    number(text) == count as f64
}

/// The lowest bits of a stencil, by name.
pub fn mask_of(bits: &str) -> u8 {
    match bits {
        "one bit" => 1,
        "two bits" => 3,
        "four bits" => 15,
        _ => panic!("no mask has {bits}"),
    }
}

/// Is this the text of a number? Four digits are written.
pub fn is_near(text: &str, value: f64) -> bool {
    let text = number(text);
    text == value
        || (text - value).abs() <= 6e-2_f64.min(1e-3 * value.abs().max(1e-3))
        || (value.abs() < 1e-3 && (text / value - 1.0).abs() < 0.06)
        || (value.abs() >= 1e5 && (text / value - 1.0).abs() < 0.06)
}

#[test]
fn gaps_are_what_stands_between() {
    assert_eq!(gaps("{} of {} pixels", "3 of 4 pixels"), Some(vec!["3", "4"]));
    assert_eq!(gaps("none", "none"), Some(vec![]));
    assert_eq!(gaps("none", "none at all"), None);
    assert_eq!(gaps("a {} c", "a b d"), None);
    assert_eq!((number("1\u{a0}234"), number("−2"), number("0.5 m")), (1234.0, -2.0, 0.5));
    assert!(is_near("13.482 m", 13.48231) && !is_near("13.482 m", 13.52));
}
