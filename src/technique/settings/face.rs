//! The interface of a setting: its key, its possible values, and what each value becomes.
//!
//! A setting is a constant of the technique that has it: [`WordSetting`], [`NumberSetting`] or [`NumberOrWordSetting`].
//! Its values are written once, each word beside what it stands for, so that nothing else compares words.

use super::super::lesson::Lesson;
use std::collections::BTreeMap;

/// The values of settings by their keys, as written on the command line, in scene files and in captures.
pub type SettingMap = BTreeMap<String, String>;

/// The description of one setting of a technique: key, allowed values, default and help texts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingSpec {
    /// The key, as in `--set KEY=VALUE`.
    pub key: &'static str,
    /// The values that it accepts.
    pub values: SettingValues,
    /// The value where none is set.
    pub default: &'static str,
    /// What it changes, in a few words.
    pub meaning: &'static str,
    /// The help text: explanation, formula and sources.
    pub lesson: Lesson,
}

/// The values that a setting accepts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingValues {
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A whole number in this range, ends included.
    Integer(i64, i64),
    /// A finite number in this range, ends included.
    Number(f64, f64),
    /// `all`, `none`, or some of these words separated by commas.
    SomeOf(&'static [&'static str]),
    /// One of these words, or a prefix and a number in this range, as in `pcf:3`.
    WordOr {
        /// The words.
        words: &'static [&'static str],
        /// The text before the number, its colon included: `pcf:`.
        prefix: &'static str,
        /// The smallest number.
        low: f64,
        /// The largest.
        high: f64,
        /// Whether the number must be an integer.
        whole: bool,
    },
    /// One of these words, or the numbers of a frustum, `FOV:NEAR:FAR`: a field of view and two distances, the nearer one
    /// first, each from 1e-6 to 1e9.
    WordOrFrustum(&'static [&'static str]),
    /// Two numbers from 0 to 1 with a comma between, the first not the greater: a range of depths.
    DepthRange,
    /// Which flat pieces receive planar shadows, as [`ReceiverChoice`] reads it: one of these words, or one of them, a colon
    /// and what belongs to it.
    Receivers(&'static [&'static str]),
}

/// Which flat pieces of a scene's surfaces receive planar shadows.
#[derive(Debug, Clone, PartialEq)]
pub enum ReceiverChoice {
    /// `all`: every one.
    All,
    /// `share:P`: those that cover P per cent of the picture or more, 0 to 100.
    Share(f64),
    /// `largest:N`: the N largest by area, at least 1.
    Largest(usize),
    /// `named:NAME,NAME`: those of the objects with these names.
    Named(Vec<String>),
}

impl ReceiverChoice {
    /// The first word of each way to choose.
    pub(in crate::technique) const WORDS: [&str; 4] = ["share", "largest", "named", "all"];

    /// Reads a value of the setting; `None` for any other text.
    pub(in crate::technique) fn parse(value: &str) -> Option<ReceiverChoice> {
        if value == "all" {
            return Some(ReceiverChoice::All);
        }
        let (word, rest) = value.split_once(':')?;
        match word {
            "share" => Some(ReceiverChoice::Share(rest.parse().ok().filter(|share| (0.0..=100.0).contains(share))?)),
            "largest" => Some(ReceiverChoice::Largest(rest.parse().ok().filter(|count| *count > 0)?)),
            "named" => {
                let names: Vec<String> = rest.split(',').map(|name| name.trim().to_owned()).collect();
                names.iter().all(|name| !name.is_empty()).then_some(ReceiverChoice::Named(names))
            }
            _ => None,
        }
    }
}

/// Returns the two ends of a range of depths that a setting's value consists of, as [`SettingValues::DepthRange`]
/// describes them; `None` for any other text.
pub(in crate::technique) fn depth_range(value: &str) -> Option<[f64; 2]> {
    let ends: Vec<f64> = value.split(',').map(|end| end.trim().parse().ok()).collect::<Option<_>>()?;
    let [near, far] = ends.try_into().ok()?;
    ((0.0..=1.0).contains(&near) && (near..=1.0).contains(&far)).then_some([near, far])
}

/// Returns the three numbers of a frustum that a setting's value consists of, as [`SettingValues::WordOrFrustum`]
/// describes them; `None` for any other text.
pub(in crate::technique) fn frustum_numbers(value: &str) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = value.split(':').map(|number| number.parse().ok()).collect::<Option<_>>()?;
    let [fov, near, far] = numbers.try_into().ok()?;
    let is_usable = [fov, near, far].iter().all(|number| (1e-6..=1e9).contains(number)) && near < far;
    is_usable.then_some([fov, near, far])
}

impl SettingSpec {
    /// Returns this setting's value in `values`; the default where none is set, or where it is not allowed (a capture
    /// folder may contain anything).
    pub(in crate::technique) fn of(self, values: &SettingMap) -> &str {
        let set = values.get(self.key).map(String::as_str);
        set.filter(|value| self.values.check(value).is_ok()).unwrap_or(self.default)
    }
}

/// A setting whose value is one of some words, each of which stands for a `T`; the first is the default.
pub(in crate::technique) struct WordSetting<T: 'static> {
    pub spec: SettingSpec,
    values: &'static [T],
}

/// Makes a setting of `words`, which stand for `values` in the same order.
pub(in crate::technique) const fn words<T>(
    key: &'static str,
    words: &'static [&'static str],
    values: &'static [T],
    meaning: &'static str,
    lesson: Lesson,
) -> WordSetting<T> {
    assert!(words.len() == values.len(), "each word stands for something");
    WordSetting {
        spec: SettingSpec { key, values: SettingValues::OneOf(words), default: words[0], meaning, lesson },
        values,
    }
}

impl<T: Copy + PartialEq> WordSetting<T> {
    /// Returns the setting's word that stands for a value; its first word for a value that no word stands for.
    pub fn word(&self, value: T) -> &'static str {
        let SettingValues::OneOf(words) = self.spec.values else { return self.spec.default };
        words[self.values.iter().position(|one| *one == value).unwrap_or(0)]
    }

    /// Returns the value for which this setting's word in `values` stands; that of its default where the key is
    /// missing, or the word is none of its words.
    pub fn read(&self, values: &SettingMap) -> T {
        let SettingValues::OneOf(words) = self.spec.values else { return self.values[0] };
        let set = self.spec.of(values);
        self.values[words.iter().position(|word| *word == set).unwrap_or(0)]
    }
}

/// A setting that is a number.
pub(in crate::technique) struct NumberSetting {
    pub spec: SettingSpec,
}

/// Makes a setting that is an integer from `low` to `high`.
pub(in crate::technique) const fn whole(
    key: &'static str,
    [low, high]: [i64; 2],
    default: &'static str,
    meaning: &'static str,
    lesson: Lesson,
) -> NumberSetting {
    NumberSetting { spec: SettingSpec { key, values: SettingValues::Integer(low, high), default, meaning, lesson } }
}

/// Makes a setting that is a number from `low` to `high`, with or without a fraction.
pub(in crate::technique) const fn number(
    key: &'static str,
    [low, high]: [f64; 2],
    default: &'static str,
    meaning: &'static str,
    lesson: Lesson,
) -> NumberSetting {
    NumberSetting { spec: SettingSpec { key, values: SettingValues::Number(low, high), default, meaning, lesson } }
}

impl NumberSetting {
    /// Returns this setting's number in `values`; its default where the key is missing, or the text is no number of its
    /// range.
    pub fn read(&self, values: &SettingMap) -> f64 {
        self.spec.of(values).parse().unwrap_or(0.0)
    }
}

/// A setting whose value is one word, or a prefix and a number, as in `pcf:3`.
pub(in crate::technique) struct NumberOrWordSetting {
    pub spec: SettingSpec,
}

/// Makes a setting whose value is the one word of `words`, its default, or a prefix and a number from `low` to `high`.
pub(in crate::technique) const fn number_or(
    key: &'static str,
    words: &'static [&'static str; 1],
    prefix: &'static str,
    [low, high]: [f64; 2],
    whole: bool,
    meaning: &'static str,
    lesson: Lesson,
) -> NumberOrWordSetting {
    let values = SettingValues::WordOr { words, prefix, low, high, whole };
    NumberOrWordSetting { spec: SettingSpec { key, values, default: words[0], meaning, lesson } }
}

impl NumberOrWordSetting {
    /// Returns the number after the setting's prefix in `values`; `None` where the value is a word. A missing or
    /// invalid value counts as the default.
    pub fn read(&self, values: &SettingMap) -> Option<f64> {
        let SettingValues::WordOr { prefix, .. } = self.spec.values else { return None };
        self.spec.of(values).strip_prefix(prefix)?.parse().ok()
    }
}

impl SettingValues {
    /// Checks a value.
    pub(in crate::technique) fn check(self, value: &str) -> Result<(), String> {
        let in_range = match self {
            SettingValues::OneOf(words) => words.contains(&value),
            SettingValues::SomeOf(words) => {
                let mut some = value.split(',').map(str::trim);
                ["all", "none"].contains(&value) || some.all(|one| words.contains(&one))
            }
            SettingValues::Integer(low, high) => value.parse().is_ok_and(|n: i64| (low..=high).contains(&n)),
            SettingValues::Number(low, high) => value.parse().is_ok_and(|n: f64| (low..=high).contains(&n)),
            SettingValues::WordOr { words, prefix, low, high, whole } => {
                let number = value.strip_prefix(prefix).and_then(|number| number.parse::<f64>().ok());
                let fits = |n: f64| (low..=high).contains(&n) && (!whole || n.fract() == 0.0);
                words.contains(&value) || number.is_some_and(fits)
            }
            SettingValues::WordOrFrustum(words) => words.contains(&value) || frustum_numbers(value).is_some(),
            SettingValues::DepthRange => depth_range(value).is_some(),
            SettingValues::Receivers(_) => ReceiverChoice::parse(value).is_some(),
        };
        if in_range { Ok(()) } else { Err(self.to_string()) }
    }
}

impl std::fmt::Display for SettingValues {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SettingValues::OneOf(words) => write!(f, "choose one of {}", words.join(", ")),
            SettingValues::SomeOf(words) => {
                write!(f, "choose all, none, or some of {}, between commas", words.join(", "))
            }
            SettingValues::Integer(low, high) => write!(f, "choose a whole number from {low} to {high}"),
            SettingValues::Number(low, high) => write!(f, "choose a number from {low} to {high}"),
            SettingValues::WordOr { words, prefix, low, high, whole } => {
                let number = if *whole { "a whole number" } else { "a number" };
                write!(f, "choose {}, or {prefix} and {number} from {low} to {high}", words.join(", "))
            }
            SettingValues::WordOrFrustum(words) => write!(
                f,
                "choose {}, or FOV:NEAR:FAR, a field of view in degrees (of a sun, a width in metres) and two distances in \
                 metres, the nearer one first",
                words.join(", ")
            ),
            SettingValues::DepthRange => f.write_str(
                "choose N,F, two depths from 0 to 1, N not above F: WebGPU refuses a range that is turned, as glDepthRange \
                 takes it (`depth` has reversed depth)",
            ),
            SettingValues::Receivers(_) => f.write_str(
                "choose share:P, those that cover P per cent of the picture or more, largest:N, named:NAME,NAME with names \
                 of objects, or all",
            ),
        }
    }
}
