//! Results of the depth and stencil tests for the fragments of a step, or of one of its draws, pixel by pixel.

use super::Image;
use std::sync::Arc;

/// Counts of fragments stop here: larger numbers are not distinguished.
pub const MOST_FRAGMENTS: u8 = u8::MAX;

/// Results of the tests of a step, or of one of its draws. All pictures have a byte a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct StepTests {
    /// Index of the step.
    pub step: usize,
    /// Index of the draw; `None` for the whole step.
    pub draw: Option<usize>,
    /// How many fragments reached the pixel, [`MOST_FRAGMENTS`] at most.
    pub fragments: Arc<Image>,
    /// How many of them would pass the depth test if there were no stencil test.
    pub depth_passes: Arc<Image>,
    /// A [`StencilVerdict`] for each pixel.
    pub stencil: Arc<Image>,
}

/// Result of the stencil test for a pixel's fragments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum StencilVerdict {
    /// All fragments pass.
    Passes = 0,
    /// All fragments fail.
    Fails = 1,
    /// The step writes the bits that it tests: the result depends on the order of fragments.
    Unknown = 2,
}

/// Test results of one pixel's fragments; `None` where a number is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TestCounts {
    /// Number of fragments.
    pub fragments: u8,
    /// Number that failed the stencil test.
    pub stencil_failed: Option<u8>,
    /// Number that passed the stencil test and failed the depth test.
    pub depth_failed: Option<u8>,
    /// Number that passed both tests.
    pub passed: Option<u8>,
}

impl TestCounts {
    /// Bit: some fragments passed both tests.
    pub const PASSED: u8 = 1;
    /// Bit: some fragments failed the depth test.
    pub const DEPTH_FAILED: u8 = 2;
    /// Bit: fragments failed the stencil test.
    pub const STENCIL_FAILED: u8 = 4;
    /// Bit: the results are not known.
    pub const UNKNOWN: u8 = 8;

    /// Returns the bits of all that happened to at least one fragment.
    pub fn outcomes(self) -> u8 {
        let bit = |count: Option<u8>, bit: u8| if count.is_some_and(|count| count > 0) { bit } else { 0 };
        let known = bit(self.passed, Self::PASSED) | bit(self.depth_failed, Self::DEPTH_FAILED);
        let known = known | bit(self.stencil_failed, Self::STENCIL_FAILED);
        if self.passed.is_none() { Self::UNKNOWN } else { known }
    }
}

impl StepTests {
    /// Returns the test results of a pixel's fragments; `None` outside the picture.
    pub fn at(&self, pixel: [u32; 2]) -> Option<TestCounts> {
        let byte = |image: &Image| image.byte_at(pixel);
        Some(counts(byte(&self.fragments)?, byte(&self.depth_passes)?, byte(&self.stencil)?))
    }

    /// Returns the [`TestCounts::outcomes`] of every pixel.
    pub fn outcomes(&self) -> Image {
        let rows = self.fragments.rows().zip(self.depth_passes.rows()).zip(self.stencil.rows());
        let texels = rows.flat_map(|((all, passes), verdicts)| all.iter().zip(passes).zip(verdicts));
        let bytes: Vec<u8> =
            texels.map(|((all, passes), verdict)| counts(*all, *passes, *verdict).outcomes()).collect();
        Image::packed(super::PixelFormat::U8, self.fragments.size(), bytes)
    }
}

fn counts(fragments: u8, passes: u8, verdict: u8) -> TestCounts {
    let known = |stencil_failed, depth_failed, passed| TestCounts {
        fragments,
        stencil_failed: Some(stencil_failed),
        depth_failed: Some(depth_failed),
        passed: Some(passed),
    };
    const FAILS: u8 = StencilVerdict::Fails as u8;
    const PASSES: u8 = StencilVerdict::Passes as u8;
    // Where counts stopped, the number that failed is not known.
    let failed = |passed: u8| (fragments < MOST_FRAGMENTS).then(|| fragments.saturating_sub(passed));
    match verdict {
        _ if fragments == 0 => known(0, 0, 0),
        FAILS => known(fragments, 0, 0),
        PASSES => TestCounts { depth_failed: failed(passes), ..known(0, 0, passes) },
        _ => TestCounts { fragments, stencil_failed: None, depth_failed: None, passed: None },
    }
}
