//! Each cause in scenes of its own.

use super::provoke::{CAUSES, provoke};
use super::{diagnose, first, session, told};
use stencilscope::diagnosis::{Cause, Proof};

/// Scenes that are looked at until one has wrong pixels.
const SEEDS: u64 = 12;

#[test]
fn every_cause_is_named_first_and_proven() {
    let mut session = session();
    let mut missed = Vec::new();
    for cause in CAUSES {
        let found = (0..SEEDS).map(|seed| diagnose(&mut session, &provoke(cause, seed)));
        let Some(diagnosis) = found.into_iter().find(|diagnosis| diagnosis.is_bad()) else {
            missed.push(format!("{cause}: nothing is wrong"));
            continue;
        };
        let expected = if cause == Cause::F32Limit { Proof::NotRun } else { Proof::Proven };
        let proof = diagnosis.regions[0].causes.first().map(|cause| cause.proof);
        if first(&diagnosis) != Some(cause) || proof != Some(expected) {
            missed.push(format!("{cause}: {}", told(&diagnosis)));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
