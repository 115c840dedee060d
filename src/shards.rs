//! Runs in parts: each row of a run is computed by one of them, and merging puts the rows in their order again.
//!
//! ```text
//! --shard 1/3 ─► rows 0, 3, 6, … ─► JSON, with its ShardPart ─┐
//! --shard 2/3 ─► rows 1, 4, 7, … ─► JSON, with its ShardPart ─┼─► merged ─► all rows, as of one run
//! --shard 3/3 ─► rows 2, 5, 8, … ─► JSON, with its ShardPart ─┘
//! ```
//!
//! Which part has which rows depends on nothing but their order, so that a part that was killed can be run again alone.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The `part`-th of `of` parts, counted from 1: `2/3`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    part: u32,
    of: u32,
}

impl Shard {
    /// Returns whether this part has the given piece of the run, counted from 0.
    pub fn has(self, piece: usize) -> bool {
        piece % self.of.max(1) as usize + 1 == self.part as usize
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.part, self.of)
    }
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Shard, &'static str> {
        let parted = text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
        let (part, of) = parted.ok_or("give a part and how many there are, as `2/8`")?;
        if of > MOST {
            return Err("give at most 65 536 parts");
        }
        if (1..=of).contains(&part) { Ok(Shard { part, of }) } else { Err("parts are counted from 1 to their number") }
    }
}

/// The most parts of a run.
const MOST: u32 = 1 << 16;

/// What a file of results states about the run that it is a part of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardPart {
    /// Which part it is.
    #[serde(flatten)]
    pub shard: Shard,
    /// For each of its rows, the position among those of the whole run, from 0.
    pub places: Vec<usize>,
    /// The whole run: how it is measured, then the name of each row. The same in all of its parts.
    pub run: Vec<String>,
}

impl ShardPart {
    /// Returns the part of a run that a shard computes.
    pub fn new(shard: Shard, places: Vec<usize>, how: String, rows: impl IntoIterator<Item = String>) -> ShardPart {
        ShardPart { shard, places, run: std::iter::once(how).chain(rows).collect() }
    }
}

/// Why parts can't be merged.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// There is no file.
    #[error("there is nothing to merge: give the JSON file of each part")]
    Nothing,
    /// A file was not made with `--shard`.
    #[error("`{name}` is no part of a run: make it with `--shard K/N`")]
    Whole {
        /// Name of the file.
        name: String,
    },
    /// Two files are parts of different runs.
    #[error("`{name}` is of another run than `{first}`: make all parts with the same version, scenes and options")]
    OtherRun {
        /// Name of the file.
        name: String,
        /// Name of the first file.
        first: String,
    },
    /// Two files were measured on different machines, whose times can't be compared.
    #[error("`{name}` was measured on {of_name}, and `{first}` on {of_first}: make all parts on equal machines")]
    OtherAdapter {
        /// Name of the file.
        name: String,
        /// Adapter of the file.
        of_name: String,
        /// Name of the first file.
        first: String,
        /// Adapter of the first file.
        of_first: String,
    },
    /// Two files are the same part.
    #[error("part {shard} is there twice, in `{first}` and in `{name}`: leave one of them out")]
    Twice {
        /// The part.
        shard: Shard,
        /// Name of the file.
        name: String,
        /// Name of the file before it.
        first: String,
    },
    /// Parts are missing.
    #[error("{}: make {} with `--shard {}`", missing(shards), if shards.len() == 1 { "it" } else { "each" }, shards[0])]
    Missing {
        /// All missing parts.
        shards: Vec<Shard>,
    },
    /// The rows of a file are not those that it should have.
    #[error("`{name}` has not the rows of its part: make it again with `--shard {shard}`")]
    Damaged {
        /// Name of the file.
        name: String,
        /// Its part.
        shard: Shard,
    },
}

fn missing(shards: &[Shard]) -> String {
    let all: Vec<String> = shards.iter().map(ToString::to_string).collect();
    let (are, parts) = if shards.len() == 1 { ("is", "part") } else { ("are", "parts") };
    format!("{parts} {} {are} missing", all.join(", "))
}

/// The content of a file of results.
#[derive(Debug, Clone)]
pub struct ResultsFile<R> {
    /// Name of the file, for messages.
    pub name: String,
    /// The adapter that it was measured on.
    pub adapter: String,
    /// Which part it is; `None` for a whole run.
    pub part: Option<ShardPart>,
    /// Its rows.
    pub rows: Vec<R>,
}

/// Returns the rows of all parts in the order of the whole run. Fails where a part is missing, twice there or damaged,
/// where one is a whole run, or where parts are of different runs or adapters.
pub fn merged<R>(parts: Vec<ResultsFile<R>>) -> Result<Vec<R>, MergeError> {
    let mut first: Option<(String, String, ShardPart)> = None;
    let mut names: Vec<Option<String>> = Vec::new();
    let mut rows: Vec<Option<R>> = Vec::new();
    for ResultsFile { name, adapter, part, rows: of_part } in parts {
        let Some(part) = part else { return Err(MergeError::Whole { name }) };
        let shard = part.shard;
        let (first, of_first, whole) = first.get_or_insert_with(|| (name.clone(), adapter.clone(), part.clone()));
        if part.run != whole.run || shard.of != whole.shard.of {
            return Err(MergeError::OtherRun { name, first: first.clone() });
        }
        if adapter != *of_first {
            return Err(MergeError::OtherAdapter {
                name,
                of_name: adapter,
                first: first.clone(),
                of_first: of_first.clone(),
            });
        }
        let damaged = || MergeError::Damaged { name: name.clone(), shard };
        if shard.of > MOST || part.places.len() != of_part.len() {
            return Err(damaged());
        }
        names.resize(shard.of as usize, None);
        rows.resize_with(whole.run.len().saturating_sub(1), || None);
        let of_shard = (shard.part as usize).checked_sub(1).and_then(|part| names.get_mut(part)).ok_or_else(damaged)?;
        if let Some(first) = of_shard.replace(name.clone()) {
            return Err(MergeError::Twice { shard, name, first });
        }
        for (place, row) in part.places.iter().zip(of_part) {
            let is_free = rows.get_mut(*place).filter(|row| row.is_none());
            *is_free.ok_or_else(damaged)? = Some(row);
        }
    }
    let (name, _, ShardPart { shard, .. }) = first.ok_or(MergeError::Nothing)?;
    let is_missing = names.iter().zip(1..).filter(|(name, _)| name.is_none());
    let shards: Vec<Shard> = is_missing.map(|(_, part)| Shard { part, of: shard.of }).collect();
    if !shards.is_empty() {
        return Err(MergeError::Missing { shards });
    }
    let all: Option<Vec<R>> = rows.into_iter().collect();
    all.ok_or(MergeError::Damaged { name, shard })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(text: &str) -> Shard {
        text.parse().expect("a part")
    }

    fn part(text: &str, rows: usize) -> ResultsFile<usize> {
        let places: Vec<usize> = (0..rows).filter(|row| shard(text).has(*row)).collect();
        let names = (0..rows).map(|row| format!("row {row}"));
        let part = ShardPart::new(shard(text), places.clone(), "twice".to_owned(), names);
        ResultsFile { name: format!("{text}.json"), adapter: "one".to_owned(), part: Some(part), rows: places }
    }

    #[test]
    fn parts_are_disjoint_complete_and_come_together_in_any_order() {
        for (of, rows) in [(1, 5), (3, 10), (4, 4), (7, 3), (2, 0)] {
            let parts = (1..=of).rev().map(|k| part(&format!("{k}/{of}"), rows)).collect();
            assert_eq!(merged(parts), Ok((0..rows).collect()), "{of} parts of {rows} rows");
        }
    }

    #[test]
    fn words_that_are_no_part_are_refused() {
        for wrong in ["", "1", "0/2", "3/2", "a/2", "1/0", "-1/2", "1/2/3", "1/70000"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        assert_eq!(shard("2/3").to_string(), "2/3");
    }

    #[test]
    fn what_does_not_go_together_is_named() {
        let error = |parts| merged(parts).expect_err("an error").to_string();
        assert_eq!(
            error(vec![part("2/4", 9), part("4/4", 9)]),
            "parts 1/4, 3/4 are missing: make each with `--shard 1/4`"
        );
        assert_eq!(error(vec![part("1/2", 9)]), "part 2/2 is missing: make it with `--shard 2/2`");
        let twice = error(vec![part("1/2", 9), ResultsFile { name: "again".into(), ..part("1/2", 9) }]);
        assert!(twice.contains("part 1/2 is there twice, in `1/2.json` and in `again`"), "{twice}");
        assert!(error(vec![part("1/2", 9), part("2/2", 8)]).contains("`2/2.json` is of another run than `1/2.json`"));
        assert!(error(vec![part("1/2", 9), part("2/3", 9)]).contains("of another run"));
        let elsewhere = error(vec![part("1/2", 9), ResultsFile { adapter: "two".into(), ..part("2/2", 9) }]);
        assert!(elsewhere.contains("measured on two, and `1/2.json` on one"), "{elsewhere}");
        assert!(error(vec![ResultsFile { part: None, ..part("1/2", 9) }]).contains("`1/2.json` is no part"));
        assert!(error(Vec::new()).contains("nothing to merge"));
        let mut damaged = part("1/2", 9);
        damaged.rows.pop();
        assert!(error(vec![damaged, part("2/2", 9)]).contains("`1/2.json` has not the rows"));
        let mut astray = part("1/2", 9);
        astray.part.iter_mut().for_each(|part| part.places[0] = 1);
        assert!(error(vec![part("2/2", 9), astray]).contains("has not the rows"));
    }
}
