//! What a file holds and nothing here shows.

/// What a model's file asks for and nothing here does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsupported {
    /// In the file's words: `map_Kd of brick`.
    pub what: String,
    /// Why not.
    pub because: String,
}

/// Things that are named, of a file that asks for more than anybody reads.
const MOST_NAMED: usize = 32;

/// A list of such things, each named once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct UnsupportedList {
    named: Vec<Unsupported>,
}

impl UnsupportedList {
    /// Names something that is not done.
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

    /// Names what another list does.
    #[cfg(feature = "program")]
    pub fn add(&mut self, other: &UnsupportedList) {
        other.named.iter().for_each(|one| self.refuse(one.what.clone(), one.because.clone()));
    }

    /// All that was named.
    pub fn into_list(self) -> Vec<Unsupported> {
        self.named
    }
}
