//! The interface of a setting: its key, its possible values, and what each value becomes.
//!
//! A setting is a constant of the technique that has it: [`WordSetting`], [`NumberSetting`] or [`NumberOrWordSetting`].
//! Its values are written once, each word beside what it stands for, so that nothing else compares words.

use super::super::lesson::Lesson;
use std::collections::BTreeMap;

/// Key and value of settings, as on the command line, in files and in a capture.
pub type SettingMap = BTreeMap<String, String>;

/// The description of one setting of a technique.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingSpec {
    /// The key, as in `--set KEY=VALUE`.
    pub key: &'static str,
    /// The values that are allowed.
    pub values: SettingValues,
    /// The value unless another is set.
    pub default: &'static str,
    /// What it does, in a few words.
    pub meaning: &'static str,
    /// What it teaches a learner.
    pub lesson: Lesson,
}

/// The kinds of values that a setting may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingValues {
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A whole number in this range, ends included.
    Integer(i64, i64),
    /// A finite number in this range, ends included.
    Number(f64, f64),
    /// `all`, `none`, or some of these words between commas.
    SomeOf(&'static [&'static str]),
    /// One of these words, or a number in this range behind a prefix, as in `pcf:3`.
    WordOr {
        /// The words.
        words: &'static [&'static str],
        /// What the number follows, its colon included.
        prefix: &'static str,
        /// The smallest number.
        low: f64,
        /// The largest.
        high: f64,
        /// Without a fraction.
        whole: bool,
    },
}

impl SettingSpec {
    /// Returns the value that is set, or the default; also the default where the value is not one of those allowed, as
    /// a folder may contain anything.
    pub(in crate::technique) fn of(self, values: &SettingMap) -> &str {
        let set = values.get(self.key).map(String::as_str);
        set.filter(|value| self.values.check(value).is_ok()).unwrap_or(self.default)
    }
}

/// A setting that is one of some words, the first unless set.
pub(in crate::technique) struct WordSetting<T: 'static> {
    pub spec: SettingSpec,
    values: &'static [T],
}

/// Makes a setting of words, each with what it stands for.
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
    /// Returns the word for a value.
    pub fn word(&self, value: T) -> &'static str {
        let SettingValues::OneOf(words) = self.spec.values else { return self.spec.default };
        words[self.values.iter().position(|one| *one == value).unwrap_or(0)]
    }

    /// Returns what the value that is set stands for.
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

/// Makes a setting that is a whole number.
pub(in crate::technique) const fn whole(
    key: &'static str,
    [low, high]: [i64; 2],
    default: &'static str,
    meaning: &'static str,
    lesson: Lesson,
) -> NumberSetting {
    NumberSetting { spec: SettingSpec { key, values: SettingValues::Integer(low, high), default, meaning, lesson } }
}

/// Makes a setting that is a number with or without a fraction.
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
    pub fn read(&self, values: &SettingMap) -> f64 {
        self.spec.of(values).parse().unwrap_or(0.0)
    }
}

/// A setting that is one word, or a number behind a prefix.
pub(in crate::technique) struct NumberOrWordSetting {
    pub spec: SettingSpec,
}

/// Makes such a setting, whose word is the default.
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
    /// Returns the number; `None` where the word is set.
    pub fn read(&self, values: &SettingMap) -> Option<f64> {
        let SettingValues::WordOr { prefix, .. } = self.spec.values else { return None };
        self.spec.of(values).strip_prefix(prefix)?.parse().ok()
    }
}

impl SettingValues {
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
        }
    }
}
