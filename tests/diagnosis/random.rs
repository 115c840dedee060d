//! A hundred things made wrong at random: the first named cause is the true one.

use super::occasions::causes;
use super::provoke::{Provocation, provoke};
use super::{diagnose, first, session, summary};
use crate::common::apart;
use stencilscope::session::Session;

/// How many provocations are tried.
const COUNT: usize = 100;
/// How many of their causes must be named first.
const LEAST: usize = 95;
/// Seeds that the scenes of single causes do not use.
const FIRST_SEED: u64 = 1000;

/// Wrong pixels that are there without the fault too.
fn wrong_without(session: &mut Session, provoked: &Provocation) -> u64 {
    if provoked.fault.is_none() {
        return 0;
    }
    let Provocation { cause, scene, choice, .. } = provoked;
    let right = Provocation { cause: *cause, scene: scene.clone(), choice: choice.clone(), fault: None };
    diagnose(session, &right).error.wrong()
}

#[test]
fn of_a_hundred_random_provocations_the_first_named_cause_is_the_true_one() {
    apart(
        "diagnosis::random::of_a_hundred_random_provocations_the_first_named_cause_is_the_true_one",
        &["all"],
        |_| name_a_hundred_provocations(),
    );
}

fn name_a_hundred_provocations() {
    let mut session = session();
    let (mut missed, mut drawn_again) = (Vec::new(), 0);
    let causes = causes();
    for index in 0..COUNT {
        let cause = causes[index % causes.len()];
        let mut seed = FIRST_SEED + 100 * (index / causes.len()) as u64;
        let diagnosis = loop {
            let provoked = provoke(cause, seed);
            assert_eq!(provoked.cause, cause);
            let diagnosis = diagnose(&mut session, &provoked);
            if diagnosis.is_bad() && 2 * wrong_without(&mut session, &provoked) <= diagnosis.error.wrong() {
                break diagnosis;
            }
            (drawn_again, seed) = (drawn_again + 1, seed + 1);
            assert!(seed % 100 < 99, "{cause} can't be provoked");
        };
        if first(&diagnosis) != Some(cause) {
            missed.push(format!("{cause}, seed {seed}: {}", summary(&diagnosis)));
        }
    }
    println!("{drawn_again} drawn again, {} missed:\n{}", missed.len(), missed.join("\n"));
    assert!(COUNT - missed.len() >= LEAST, "{}", missed.join("\n"));
}
