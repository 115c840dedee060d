//! Which passes of two frames correspond: those of equal names, in an order that is valid in both.
//!
//! The k-th of a name in one frame is paired with the k-th in the other. Of pairs that cross, the largest set that does
//! not is taken (Schensted 1961, the longest increasing subsequence); the rest stay unpaired.

use std::collections::BTreeMap;

/// One place in the common order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AlignedPair {
    /// In both, with its index in each.
    Both(usize, usize),
    /// In the first alone.
    First(usize),
    /// In the second alone.
    Second(usize),
}

/// Merges two lists into one order that contains every element once, equal ones as pairs where that keeps both orders.
/// Elements of only one list come before the next pair, the first list's before the second's.
pub(super) fn align<K: Ord>(a: &[K], b: &[K]) -> Vec<AlignedPair> {
    let mut pairs = Vec::new();
    let (mut next_a, mut next_b) = (0, 0);
    let mut alone = |pairs: &mut Vec<AlignedPair>, to_a: usize, to_b: usize| {
        pairs.extend((next_a..to_a).map(AlignedPair::First));
        pairs.extend((next_b..to_b).map(AlignedPair::Second));
        (next_a, next_b) = (to_a + 1, to_b + 1);
    };
    for (in_a, in_b) in increasing(&paired(a, b)) {
        alone(&mut pairs, in_a, in_b);
        pairs.push(AlignedPair::Both(in_a, in_b));
    }
    alone(&mut pairs, a.len(), b.len());
    pairs
}

/// Pairs the k-th element of a key in one list with the k-th equal one in the other, as indices, in the first list's
/// order. Elements without a partner are left out.
fn paired<K: Ord>(a: &[K], b: &[K]) -> Vec<(usize, usize)> {
    let mut places: BTreeMap<&K, Vec<usize>> = BTreeMap::new();
    // Last first, so that the first is popped first.
    b.iter().enumerate().rev().for_each(|(index, key)| places.entry(key).or_default().push(index));
    let partner = |(index, key): (usize, &K)| Some((index, places.get_mut(key)?.pop()?));
    a.iter().enumerate().filter_map(partner).collect()
}

/// Returns the longest subsequence of the pairs in which the second numbers strictly increase; the pairs come sorted by
/// their first numbers.
fn increasing(pairs: &[(usize, usize)]) -> Vec<(usize, usize)> {
    // `ends[n]`: the pair that ends the best run of n + 1 pairs so far; `before`: the pair before it.
    let (mut ends, mut before): (Vec<usize>, Vec<Option<usize>>) = (Vec::new(), Vec::new());
    for (index, (_, second)) in pairs.iter().enumerate() {
        let length = ends.partition_point(|end| pairs[*end].1 < *second);
        before.push(length.checked_sub(1).map(|shorter| ends[shorter]));
        if length == ends.len() {
            ends.push(index);
        } else {
            ends[length] = index;
        }
    }
    let mut run: Vec<(usize, usize)> =
        std::iter::successors(ends.last().copied(), |index| before[*index]).map(|index| pairs[index]).collect();
    run.reverse();
    run
}

#[cfg(test)]
mod tests {
    use super::*;
    use AlignedPair::{Both, First, Second};

    fn aligned(a: &str, b: &str) -> Vec<AlignedPair> {
        align(a.as_bytes(), b.as_bytes())
    }

    #[test]
    fn equal_lists_are_pairs() {
        assert_eq!(aligned("aab", "aab"), [Both(0, 0), Both(1, 1), Both(2, 2)]);
        assert_eq!(aligned("", ""), []);
    }

    #[test]
    fn what_only_one_has_stands_where_it_was() {
        assert_eq!(aligned("axb", "ayzb"), [Both(0, 0), First(1), Second(1), Second(2), Both(2, 3)]);
        assert_eq!(aligned("aa", "a"), [Both(0, 0), First(1)]);
        assert_eq!(aligned("", "ab"), [Second(0), Second(1)]);
    }

    #[test]
    fn of_pairs_that_cross_the_most_that_do_not_are_kept() {
        let pairs = aligned("xabc", "abcx");
        assert_eq!(pairs, [First(0), Both(1, 0), Both(2, 1), Both(3, 2), Second(3)]);
    }
}
