//! The cases as data. Adding one is adding one value.
//!
//! Where a case lists no failure, a technique is expected to be right, for the reason that
//! [`right_because`](super::right_because) gives; shadow maps, planar textures and projected silhouettes are never
//! promised to be, so there a small share of wrong pixels is known as `aliasing`. Shares and the values at which a
//! failure must show are those of pictures of 320 × 240.

mod extremes;
mod random;
mod stage;
mod sweeps;
mod who;

use super::StressCase;

/// Returns every stress case: sweeps, then random scenes, then single extremes.
pub fn all() -> impl Iterator<Item = &'static StressCase> {
    sweeps::ALL.iter().chain([&random::RANDOM]).chain(extremes::all())
}
