//! Single extremes: places where a rule of thumb, a tolerance or a sign goes wrong.

mod eyes;
mod lights;
mod meshes;
mod receivers;
mod wrong_forms;

pub use eyes::under_a_roof;

use crate::stress::StressCase;

/// Returns all stress cases that are single extremes.
pub fn all() -> impl Iterator<Item = &'static StressCase> {
    [eyes::ALL, lights::ALL, meshes::ALL, receivers::ALL, wrong_forms::ALL].into_iter().flatten()
}

/// Returns the number that is `steps` floats (`f64`) above `value`, below it for negative steps; a fraction of a step
/// is dropped.
fn ulps(value: f64, steps: f64) -> f64 {
    let step = if steps > 0.0 { f64::next_up } else { f64::next_down };
    (0..steps.abs() as u32).fold(value, |value, _| step(value))
}
