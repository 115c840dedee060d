//! Which techniques are right for a scene, as measured on it.

use super::{Diagnosis, Fix};
use crate::technique::{Choice, Technique};

/// The measured result of one technique on a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct TechniqueFit {
    /// Technique and settings.
    pub choice: Choice,
    /// Number of wrong pixels, summed over the lights.
    pub wrong: u64,
    /// Median time of a frame, milliseconds.
    pub frame_ms: f64,
}

impl TechniqueFit {
    /// Returns the choices that are worth trying on any scene: every GPU technique with its defaults, and z-fail
    /// counting in floats.
    pub fn candidates() -> Vec<Choice> {
        let plain = Technique::rivals().into_iter().map(Choice::new);
        plain.chain(Choice::new(Technique::ZFail).counting_in_floats()).collect()
    }

    /// Returns the technique's name with the settings that differ from the defaults, in the technique's order: `z-fail
    /// counter=float`.
    pub fn name(&self) -> String {
        let technique = self.choice.technique();
        let changed = technique.settings().iter().filter_map(|spec| {
            let value = self.choice.settings().get(spec.key)?;
            (value != spec.default).then(|| format!(" {}={value}", spec.key))
        });
        changed.fold(technique.name().to_owned(), |name, setting| name + &setting)
    }

    /// Returns the fastest result without a wrong pixel, preferring default settings; `None` where all have some.
    pub fn best(suited: &[TechniqueFit]) -> Option<&TechniqueFit> {
        let is_plain = |one: &TechniqueFit| one.choice == Choice::new(one.choice.technique());
        let right = suited.iter().filter(|one| one.wrong == 0);
        right.min_by(|a, b| is_plain(b).cmp(&is_plain(a)).then(a.frame_ms.total_cmp(&b.frame_ms)))
    }
}

impl Diagnosis {
    /// Returns the fix that `diagnose` writes into a scene file: the advice if it leaves no pixel wrong, else the
    /// fastest technique without a wrong pixel, else the advice. `None` where there is neither.
    pub fn fix_to_write(&self, suited: &[TechniqueFit]) -> Option<Fix> {
        let best = || {
            let choice = &TechniqueFit::best(suited)?.choice;
            // Write all of them: none of the settings of another technique may stay.
            let settings = choice.settings().clone();
            Some(Fix { technique: Some(choice.technique()), settings, ..Fix::default() })
        };
        let advised = self.advice.as_ref().map(|advice| advice.fix.clone());
        if self.is_fixed() { advised } else { best().or(advised) }
    }

    /// Returns whether the advice leaves no pixel wrong.
    pub fn is_fixed(&self) -> bool {
        self.advice.as_ref().is_some_and(|advice| advice.wrong_left + advice.swimming_left == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_is_right_then_plain_then_fast() {
        let choices = TechniqueFit::candidates();
        assert!(choices.len() > 7, "{}", choices.len());
        let one = |choice: &Choice, wrong, frame_ms| TechniqueFit { choice: choice.clone(), wrong, frame_ms };
        let in_float = choices.last().expect("a candidate");
        let all = [one(&choices[0], 3, 1.0), one(in_float, 0, 2.0), one(&choices[1], 0, 4.0), one(&choices[2], 0, 3.0)];
        assert_eq!(TechniqueFit::best(&all), Some(&all[3]));
        assert_eq!(TechniqueFit::best(&all[..2]).map(TechniqueFit::name).as_deref(), Some("z-fail counter=float"));
        assert_eq!(TechniqueFit::best(&all[..1]), None);
    }
}
