//! A cache of what the newest plan, or the newest question, needs.

use std::collections::HashMap;
use std::hash::Hash;

/// Values by key. A value that was not used between two calls of [`LastUsed::next_plan`] is dropped.
#[derive(Debug)]
pub(crate) struct LastUsed<K, V> {
    cached: HashMap<K, Cached<V>>,
    /// Sum of the weights of all values.
    weight: usize,
}

#[derive(Debug)]
struct Cached<V> {
    value: V,
    weight: usize,
    is_used: bool,
}

impl<K, V> Default for LastUsed<K, V> {
    fn default() -> Self {
        LastUsed { cached: HashMap::new(), weight: 0 }
    }
}

impl<K: Eq + Hash, V: Clone> LastUsed<K, V> {
    /// Drops values that were not used or added since the last call.
    pub fn next_plan(&mut self) {
        self.cached.retain(|_, cached| std::mem::take(&mut cached.is_used));
        self.weight = self.cached.values().map(|cached| cached.weight).sum();
    }

    /// As [`LastUsed::next_plan`] where the weights of all values sum to more than `most`; else all are kept.
    pub fn next_plan_beyond(&mut self, most: usize) {
        if self.weight > most {
            self.next_plan();
        } else {
            self.cached.values_mut().for_each(|cached| cached.is_used = false);
        }
    }

    /// Returns the value of a key and marks it as used; `None` where it is not cached.
    pub fn get(&mut self, key: &K) -> Option<V> {
        let cached = self.cached.get_mut(key)?;
        cached.is_used = true;
        Some(cached.value.clone())
    }

    /// Returns the value of a key, computed by `make` and cached, with weight 0, if it is not cached yet.
    pub fn get_or_make(&mut self, key: K, make: impl FnOnce() -> V) -> V {
        self.get_or_make_within(usize::MAX, key, || (make(), 0))
    }

    /// Returns the cached value of a key, else the one that `make` computes, with its weight. That is cached only if
    /// the weights of all values then sum to at most `most`; nothing is dropped for it.
    pub fn get_or_make_within(&mut self, most: usize, key: K, make: impl FnOnce() -> (V, usize)) -> V {
        if let Some(value) = self.get(&key) {
            return value;
        }
        let (value, weight) = make();
        if self.weight + weight <= most {
            self.weight += weight;
            self.cached.insert(key, Cached { value: value.clone(), weight, is_used: true });
        }
        value
    }
}
