//! How the fragments of the selected step fared in its tests: asked for while something shows it.

use super::moment::Moment;
use crate::capture::{Image, StepTests, TestCounts};
use std::sync::Arc;

/// How far the tests of the selected step or draw are.
#[derive(Debug, Default)]
pub struct TestsState {
    /// Something that is shown needs those of this moment; set anew each frame.
    wanted: Option<Moment>,
    asked: Option<Moment>,
    known: Option<Known>,
    failed: Option<(Moment, String)>,
}

/// Tests with what follows from them.
#[derive(Debug, Clone)]
pub struct Known {
    /// As counted.
    pub tests: Arc<StepTests>,
    /// [`TestCounts::outcomes`] of every pixel.
    pub outcomes: Arc<Image>,
    /// How many pixels have each combination of outcomes.
    pub pixels: [u64; 16],
}

impl TestsState {
    /// Something that is drawn now needs those of `at`; `None` while they are not known.
    pub fn want(&mut self, at: Moment) -> Option<&Known> {
        self.wanted = Some(at);
        self.known.as_ref().filter(|known| moment_of(&known.tests) == at)
    }

    /// Those of `at`, where they are known.
    #[must_use]
    pub fn of(&self, at: Moment) -> Option<&Known> {
        self.known.as_ref().filter(|known| moment_of(&known.tests) == at)
    }

    /// Why there are none of `at`, with the mend.
    #[must_use]
    pub fn failed(&self, at: Moment) -> Option<&str> {
        self.failed.as_ref().filter(|(of, _)| *of == at).map(|(_, reason)| reason.as_str())
    }

    /// The moment whose tests are needed, once.
    pub fn ask(&mut self) -> Option<Moment> {
        let wanted = self.wanted.take()?;
        let is_there = self.of(wanted).is_some() || self.failed(wanted).is_some() || self.asked == Some(wanted);
        if is_there {
            return None;
        }
        self.asked = Some(wanted);
        self.asked
    }

    /// The answer about a moment; one that was not asked last is dropped.
    pub fn answer(&mut self, at: Moment, result: Result<Arc<StepTests>, String>) {
        if self.asked.take_if(|asked| *asked == at).is_none() {
            return;
        }
        match result {
            Ok(tests) => {
                let outcomes = Arc::new(tests.outcomes());
                let histogram = outcomes.histogram();
                let pixels = std::array::from_fn(|outcome| histogram[outcome]);
                self.known = Some(Known { tests, outcomes, pixels });
            }
            Err(reason) => self.failed = Some((at, reason)),
        }
    }

    /// Another frame is shown.
    pub fn forget(&mut self) {
        *self = TestsState::default();
    }
}

fn moment_of(tests: &StepTests) -> Moment {
    Moment { step: tests.step, draw: tests.draw }
}

/// The combinations that can occur, with their names and what they mean.
pub const OUTCOMES: [(u8, &str, &str); 6] = [
    (TestCounts::PASSED, "passed", "Every fragment here passed both tests"),
    (TestCounts::DEPTH_FAILED, "depth failed", "Every fragment here failed the depth test: hits of z-fail"),
    (TestCounts::PASSED | TestCounts::DEPTH_FAILED, "mixed", "Some passed both tests, some failed the depth test"),
    (TestCounts::STENCIL_FAILED, "stencil failed", "The stencil test let no fragment through"),
    (TestCounts::UNKNOWN, "? not known", "The step writes what it tests, and several fragments came here"),
    (0, "no fragment", "The step drew nothing here"),
];
