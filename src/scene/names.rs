//! Unique names.

use std::collections::HashMap;

/// The names of a scene's objects that are taken, each once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ObjectNames {
    /// For each name, the number to try next where it is wanted again.
    taken: HashMap<String, usize>,
}

impl ObjectNames {
    /// Takes a name and returns true; `false`, and nothing changes, where it is taken already.
    pub fn take(&mut self, name: &str) -> bool {
        let is_free = !self.taken.contains_key(name);
        if is_free {
            self.taken.insert(name.to_owned(), 2);
        }
        is_free
    }

    /// Takes and returns the name; where it is taken, with the first free number appended, from 2: `box 2`.
    pub fn take_like(&mut self, wanted: &str) -> String {
        if self.take(wanted) {
            return wanted.to_owned();
        }
        loop {
            let number = self.taken.entry(wanted.to_owned()).or_insert(2);
            let name = format!("{wanted} {number}");
            *number += 1;
            if self.take(&name) {
                return name;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_tell_names_apart_and_pass_over_those_that_are_taken() {
        let mut names = ObjectNames::default();
        assert!(names.take("a 2") && !names.take("a 2"));
        let made: Vec<String> = ["a", "a", "a", "a 2"].iter().map(|name| names.take_like(name)).collect();
        assert_eq!(made, ["a", "a 3", "a 4", "a 2 2"]);
    }
}
