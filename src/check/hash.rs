//! A hash of labels that is the same on every system and in every version: results of other machines are compared by it.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A hash (FNV-1a, 64 bits) of the labels of all lights of a frame; written as 16 hexadecimal digits.
///
/// It is for equality alone: two masks with different hashes differ, and two with equal ones are taken as equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct LabelsHash(u64);

/// Why a text is no [`LabelsHash`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no hash: it has not 16 hexadecimal digits")]
pub struct LabelsHashError(String);

impl LabelsHash {
    const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;

    /// Returns the hash of the label masks of lights, each given as rows of bytes; `None` stands for a light without a
    /// mask. How a mask is divided into rows makes no difference.
    pub fn of<'a, Rows>(lights: impl IntoIterator<Item = Option<Rows>>) -> LabelsHash
    where
        Rows: IntoIterator<Item = &'a [u8]>,
    {
        let mut hash = LabelsHash(LabelsHash::OFFSET_BASIS);
        for light in lights {
            // Labels are never 255: without this byte a light without a mask would go unnoticed.
            match light {
                None => hash.write(&[u8::MAX]),
                Some(rows) => rows.into_iter().for_each(|row| hash.write(row)),
            }
        }
        hash
    }

    fn write(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(LabelsHash::PRIME));
    }
}

impl fmt::Display for LabelsHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl FromStr for LabelsHash {
    type Err = LabelsHashError;

    fn from_str(text: &str) -> Result<LabelsHash, LabelsHashError> {
        let is_hex = text.len() == 16 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        let number = u64::from_str_radix(text, 16).ok().filter(|_| is_hex);
        number.map(LabelsHash).ok_or_else(|| LabelsHashError(text.to_owned()))
    }
}

impl From<LabelsHash> for String {
    fn from(hash: LabelsHash) -> String {
        hash.to_string()
    }
}

impl TryFrom<String> for LabelsHash {
    type Error = LabelsHashError;

    fn try_from(text: String) -> Result<LabelsHash, LabelsHashError> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lights: &[Option<&[u8]>]) -> String {
        LabelsHash::of(lights.iter().map(|light| light.map(|bytes| bytes.chunks(2)))).to_string()
    }

    #[test]
    fn it_is_fnv_1a() {
        // Values of the reference implementation (Fowler, Noll and Vo).
        assert_eq!(of(&[]), "cbf29ce484222325");
        assert_eq!(of(&[Some(b"a")]), "af63dc4c8601ec8c");
        assert_eq!(of(&[Some(b"foobar")]), "85944171f73967e8");
    }

    #[test]
    fn one_label_or_one_mask_makes_another_hash() {
        assert_ne!(of(&[Some(&[0, 1, 2])]), of(&[Some(&[0, 1, 1])]));
        assert_ne!(of(&[Some(&[0, 1]), None]), of(&[Some(&[0, 1])]));
        assert_ne!(of(&[Some(&[0, 1]), None]), of(&[None, Some(&[0, 1])]));
    }

    #[test]
    fn it_reads_back_and_nothing_else_does() {
        let text = of(&[Some(&[1, 2, 3])]);
        assert_eq!(text.parse::<LabelsHash>().map(|hash| hash.to_string()), Ok(text));
        for wrong in ["", "12", "+f63dc4c8601ec8c", "af63dc4c8601ec8g", "af63dc4c8601ec8c0"] {
            assert!(wrong.parse::<LabelsHash>().is_err(), "{wrong}");
        }
    }
}
