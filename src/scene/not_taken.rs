//! Content of a file that is not supported, listed and in one line.

use super::Scene;
use std::collections::HashSet;
use std::sync::Arc;

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
    #[cfg(feature = "formats")]
    pub fn add(&mut self, other: &UnsupportedList) {
        other.named.iter().for_each(|one| self.refuse(one.what.clone(), one.because.clone()));
    }

    /// Returns all entries.
    pub fn into_list(self) -> Vec<Unsupported> {
        self.named
    }
}

/// The most characters of a line that says what is left out, without a count of the rest at its end; one thing may be
/// longer.
const MOST_CHARACTERS: usize = 200;

impl Scene {
    /// Returns what the scene's files ask for and is not supported: the scene's own, then each mesh's; of a mesh that
    /// several objects have, once.
    pub fn unsupported(&self) -> Vec<&Unsupported> {
        let mut known = HashSet::new();
        let meshes = self.objects.iter().map(|object| &object.mesh);
        let meshes = meshes.filter(|mesh| known.insert(Arc::as_ptr(mesh)));
        self.not_taken.iter().chain(meshes.flat_map(|mesh| mesh.not_taken())).collect()
    }

    /// Returns what [`Scene::unsupported`] lists in one line, things with the same reason as the first of them and the
    /// number of the others; `None` where there is nothing. What no longer fits into the line is counted.
    pub fn unsupported_in_a_line(&self) -> Option<String> {
        in_a_line(&self.unsupported())
    }
}

fn in_a_line(all: &[&Unsupported]) -> Option<String> {
    let mut kinds: Vec<UnsupportedKind> = Vec::new();
    for one in all {
        match kinds.iter_mut().find(|kind| kind.first.because == one.because) {
            Some(kind) => kind.others += 1,
            None => kinds.push(UnsupportedKind { first: one, others: 0 }),
        }
    }
    let (mut line, mut left) = ("left out: ".to_owned(), all.len());
    for (at, UnsupportedKind { first, others }) in kinds.iter().enumerate() {
        let more = if *others > 0 { format!(" and {others} more") } else { String::new() };
        let separator = if at > 0 { ", " } else { "" };
        let next = format!("{separator}{}{more}", first.what);
        if at > 0 && line.chars().count() + next.chars().count() > MOST_CHARACTERS {
            return Some(format!("{line}, and {left} more"));
        }
        line += &next;
        left -= 1 + others;
    }
    (!all.is_empty()).then_some(line)
}

/// Things that are left out for one reason.
struct UnsupportedKind<'a> {
    first: &'a Unsupported,
    others: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unsupported(what: impl Into<String>, because: &str) -> Unsupported {
        Unsupported { what: what.into(), because: because.to_owned() }
    }

    #[test]
    fn a_line_groups_by_reason_and_counts_what_does_not_fit() {
        assert_eq!(in_a_line(&[]), None);
        let few = [
            unsupported("the alpha mask of `leaf`", "holes"),
            unsupported("the cone of `spot`", "a point"),
            unsupported("the alpha mask of `fence`", "holes"),
            unsupported("9 more lights", "31 fit"),
        ];
        let line = in_a_line(&few.iter().collect::<Vec<_>>());
        let expected = "left out: the alpha mask of `leaf` and 1 more, the cone of `spot`, 9 more lights";
        assert_eq!(line.as_deref(), Some(expected));
        let many: Vec<Unsupported> = (0..30).map(|at| unsupported(format!("thing {at}"), &at.to_string())).collect();
        let line = in_a_line(&many.iter().collect::<Vec<_>>()).expect("a line");
        let named = line.matches("thing").count();
        assert!(line.len() < 220 && line.ends_with(&format!(", and {} more", 30 - named)), "{line}");
        let long = [unsupported("x".repeat(300), "a"), unsupported("y", "b")];
        let line = in_a_line(&long.iter().collect::<Vec<_>>()).expect("a line");
        assert!(line.ends_with("x, and 1 more"), "{line}");
    }
}
