//! Whose shadow a pixel lies in, as its history tells.

use crate::accuracy::Finding;
use crate::history::{LightDecision, PixelHistory};
use crate::math::depth::DepthCurve;

/// Returns the names of the casters in whose shadow of a light a pixel lies, each once, in the order in which the history
/// meets them. Of volumes they are those whose faces add more than they take away. Empty where the history does not tell:
/// nothing was counted or flattened, or the count began with volumes of which no face is known.
pub fn casters(history: &PixelHistory, light: usize, curve: &DepthCurve) -> Vec<String> {
    let mut sums: Vec<(String, i32)> = Vec::new();
    let mut add = |name: &str, by: i32| match sums.iter_mut().find(|(known, _)| known == name) {
        Some((_, sum)) => *sum += by,
        None => sums.push((name.to_owned(), by)),
    };
    match history.why(light) {
        Some(LightDecision::Flattened(shadow, _)) => shadow.casters.iter().for_each(|name| add(name, 1)),
        Some(LightDecision::Counted(..)) => {
            let Some(ladder) = history.ladder(light, curve).filter(|ladder| ladder.start == 0) else {
                return Vec::new();
            };
            for rung in &ladder.rungs {
                let event = history.events.get(rung.event).and_then(|event| event.triangle());
                if let Some(caster) = event.and_then(|one| one.caster.as_deref()) {
                    add(caster, rung.added);
                }
            }
        }
        _ => {}
    }
    sums.into_iter().filter(|(_, sum)| *sum > 0).map(|(name, _)| name).collect()
}

/// Returns a sentence that names the casters in whose shadow a pixel lies, of which the truth says `finding`; `None` without
/// names.
pub fn sentence(names: &[String], finding: Option<Finding>) -> Option<String> {
    let whose = in_words(names);
    match (names, finding) {
        ([], _) => None,
        (_, Some(Finding::FalseShadow)) => Some(format!("Darkened by {whose}, though the light reaches it.")),
        _ => Some(format!("In the shadow of {whose}.")),
    }
}

/// Returns names in a sentence: `a`, `a and b`, `a, b and c`.
pub fn in_words(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::in_words;

    #[test]
    fn names_are_listed_as_in_a_sentence() {
        let words = |names: &[&str]| in_words(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!([words(&["a"]), words(&["a", "b"]), words(&["a", "b", "c"])], ["a", "a and b", "a, b and c"]);
    }
}
