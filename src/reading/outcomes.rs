//! The results of a step's tests on its fragments, and their statistics over the whole picture.

use crate::capture::{Image, StepTests, TestCounts};
use std::sync::Arc;

/// The depth and stencil tests of a step's fragments, summed up for each pixel.
#[derive(Debug, Clone)]
pub struct TestOutcomes {
    /// The counts of tested fragments.
    pub tests: Arc<StepTests>,
    /// [`TestCounts::outcomes`] of every pixel.
    pub outcomes: Arc<Image>,
    /// How many pixels have each combination of outcomes, by its bits ([`TestCounts`]).
    pub pixels: [u64; 16],
}

impl TestOutcomes {
    /// Returns a step's test counts with the outcome of each pixel as a picture, and how many pixels have each outcome.
    pub fn new(tests: StepTests) -> TestOutcomes {
        let outcomes = Arc::new(tests.outcomes());
        let histogram = outcomes.histogram();
        let pixels = std::array::from_fn(|outcome| histogram[outcome]);
        TestOutcomes { tests: Arc::new(tests), outcomes, pixels }
    }
}

/// The explanation of pixels for which counts do not tell which fragments passed.
pub const SEVERAL: &str = "Several fragments came to these pixels, and the step changes what it tests: their number does \
                           not tell which of them passed. The history of a pixel does: click one.";

/// The combinations of outcomes that can occur: bits, name, and explanation.
pub const OUTCOMES: [(u8, &str, &str); 6] = [
    (TestCounts::PASSED, "passed", "Every fragment here passed both tests"),
    (TestCounts::DEPTH_FAILED, "depth failed", "Every fragment here failed the depth test: hits of z-fail"),
    (TestCounts::PASSED | TestCounts::DEPTH_FAILED, "mixed", "Some passed both tests, some failed the depth test"),
    (TestCounts::STENCIL_FAILED, "stencil failed", "The stencil test let no fragment through"),
    (TestCounts::UNKNOWN, "? several", SEVERAL),
    (0, "no fragment", "The step drew nothing here"),
];
