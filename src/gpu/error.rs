//! What can go wrong on a GPU.

/// Why a plan did not run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// No adapter, or none of that name, or none that can.
    #[error("no usable GPU adapter{found}: install a driver (Debian's software one: apt install mesa-vulkan-drivers)")]
    NoAdapter {
        /// What is there and why it does not do; empty where there is none.
        found: String,
    },
    /// The adapter would not give a device.
    #[error("{adapter} gave no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// The driver's words.
        reason: String,
    },
    /// The picture or a map is larger than the adapter allows.
    #[error(
        "{what} is too large: {needed} asked for, {most} fit; choose a smaller size (--size, or the setting `size` of the technique)"
    )]
    TooLarge {
        /// The attachment or buffer.
        what: String,
        /// The amount with its unit.
        needed: String,
        /// The amount with its unit.
        most: String,
    },
    /// The plan needs what the adapter does not have.
    #[error("this adapter has no {name}: {instead}")]
    MissingFeature {
        /// The feature in plain words.
        name: &'static str,
        /// What to do without it.
        instead: &'static str,
    },
    /// The plan breaks a rule: a bug of the technique.
    #[error("the plan can't run, which is a bug of stencilscope: {0}")]
    Plan(#[from] crate::plan::lint::LintError),
    /// The driver refused or failed.
    #[error("the GPU failed: {0}")]
    Driver(String),
}
