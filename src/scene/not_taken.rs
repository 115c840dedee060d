//! Content of a file that is not supported.

/// Something that a model's file asks for and is not supported.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsupported {
    /// Its name in the file's words: `map_Kd of brick`.
    pub what: String,
    /// The reason, in words.
    pub because: String,
}

/// The most entries of a list, for a file that asks for more than anybody reads.
const MOST_NAMED: usize = 32;

/// A list of what is not supported, each once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct UnsupportedList {
    named: Vec<Unsupported>,
}

impl UnsupportedList {
    /// Adds something that is not supported, once; beyond a number of different ones, only a last entry that says that
    /// there is more.
    pub fn refuse(&mut self, what: impl Into<String>, because: impl Into<String>) {
        let refused = Unsupported { what: what.into(), because: because.into() };
        let count = self.named.len();
        if count < MOST_NAMED && !self.named.contains(&refused) {
            self.named.push(refused);
        } else if count == MOST_NAMED && !self.named.contains(&refused) {
            let what = "what else the file asks for".to_owned();
            self.named.push(Unsupported { what, because: format!("{MOST_NAMED} things of it are named") });
        }
    }

    /// Adds what another list has.
    #[cfg(feature = "program")]
    pub fn add(&mut self, other: &UnsupportedList) {
        other.named.iter().for_each(|one| self.refuse(one.what.clone(), one.because.clone()));
    }

    /// Returns all entries.
    pub fn into_list(self) -> Vec<Unsupported> {
        self.named
    }
}
