//! The cases as data. Adding one is adding one value.

mod extremes;
mod stage;
mod sweeps;

use super::Case;

/// Every case: sweeps, then single extremes.
pub fn all() -> impl Iterator<Item = &'static Case> {
    sweeps::ALL.iter().chain(extremes::ALL)
}
