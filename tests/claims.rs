//! What a learner reads, compared with plan and GPU: every number and claim of every Explain card, verdict, purpose and
//! stop of a tour. Frames are of all techniques, each value of each setting, all built-in scenes.
//!
//! A sentence is known by a pattern, whose gaps are parts with a check of their own; a sentence that no pattern knows
//! fails, and so does a pattern that no sentence had.

mod cards;
mod frames;
#[cfg(feature = "inspector")]
mod guided;
mod patterns;
mod purposes;
#[cfg(feature = "inspector")]
mod tour_ends;
#[cfg(feature = "inspector")]
mod tours;
mod verdicts;

use crate::common::session;
use frames::Frame;
use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The patterns that some sentence had and whose check passed.
pub type SeenPatterns = BTreeSet<&'static str>;

#[test]
fn every_card_verdict_and_purpose_is_true() {
    let jobs = frames::jobs();
    let (next, seen) = (AtomicUsize::new(0), Mutex::new(SeenPatterns::new()));
    let wrong = Mutex::new(Vec::new());
    // As many threads as the reference machine has cores.
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let mut session = session();
                let mut own = SeenPatterns::new();
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let frame = Frame::of(&mut session, job);
                    let found = [cards::check, purposes::check, verdicts::check].map(|check| check(&frame, &mut own));
                    let found = found.into_iter().flatten().map(|wrong| format!("{job}: {wrong}"));
                    wrong.lock().expect("not poisoned").extend(found);
                }
                seen.lock().expect("not poisoned").extend(own);
            });
        }
    });
    let wrong = wrong.into_inner().expect("not poisoned");
    // One of each kind.
    let kind = |wrong: &String| {
        let known = wrong.split("is not so (").nth(1).map(|known| known.split("): ").next().unwrap_or(known));
        known.unwrap_or_else(|| wrong.rsplit(": ").next().unwrap_or(wrong)).to_owned()
    };
    let kinds: std::collections::BTreeMap<_, _> = wrong.iter().map(|wrong| (kind(wrong), wrong)).collect();
    let some: Vec<&String> = kinds.into_values().take(40).collect();
    assert!(wrong.is_empty(), "{} sentences are wrong, such as {some:#?}", wrong.len());
    let seen = seen.into_inner().expect("not poisoned");
    let all = [cards::patterns(), purposes::patterns(), verdicts::patterns()].concat();
    let idle: Vec<&&str> = all.iter().filter(|pattern| !seen.contains(**pattern)).collect();
    assert!(idle.is_empty(), "no sentence had these patterns: {idle:#?}");
}
