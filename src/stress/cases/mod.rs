//! The cases as data. Adding one is adding one value.
//!
//! Expectations begin from `spec/stress.md`. What a case does not say is expected to be right, for
//! the reason that [`right_because`](super::right_because) has; where a map or texture is right only because its
//! texels are finer than the pixels of a small picture, that holds at the default size.

mod extremes;
mod random;
mod stage;
mod sweeps;
mod who;

use super::Case;

/// Every case: sweeps, then random scenes, then single extremes.
pub fn all() -> impl Iterator<Item = &'static Case> {
    sweeps::ALL.iter().chain([&random::RANDOM]).chain(extremes::all())
}
