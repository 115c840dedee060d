//! What can go wrong on a GPU.

/// Why the GPU could not be opened, or a plan could not be run on it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// No GPU adapter was found, none has the name asked for, or none has the required features.
    #[error("no usable GPU adapter{found}: install a driver (Debian's software one: apt install mesa-vulkan-drivers)")]
    NoAdapter {
        /// The adapters that were found and why each can't be used; empty where none was found.
        found: String,
    },
    /// The adapter failed to open a device.
    #[error("{adapter} gave no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// The driver's error message.
        reason: String,
    },
    /// The picture or a map is larger than the adapter allows.
    #[error(
        "{what} is too large: {needed} asked for, {most} fit; choose a smaller size (--size, or the setting `size` of the technique)"
    )]
    TooLarge {
        /// The attachment or buffer that is too large.
        what: String,
        /// The amount that the plan needs, with its unit.
        needed: String,
        /// The largest amount that the adapter allows, with its unit.
        most: String,
    },
    /// A mesh has an array that is larger than the adapter takes.
    #[error(
        "a mesh is too large: {needed} bytes asked for at once, {most} fit; split the object in its file, or choose another \
         adapter (--adapter)"
    )]
    MeshTooLarge {
        /// Bytes of the array.
        needed: u64,
        /// The most bytes that the adapter takes at once.
        most: u64,
    },
    /// The plan needs a feature that the adapter does not have.
    #[error("this adapter has no {name}: {instead}")]
    MissingFeature {
        /// The feature in plain words.
        name: &'static str,
        /// What to do without it.
        instead: &'static str,
    },
    /// The plan breaks a rule of [`lint`](crate::plan::lint): a bug in the technique that built it.
    #[error("the plan can't run, which is a bug of stencilscope: {0}")]
    Plan(#[from] crate::plan::lint::LintError),
    /// The driver reported an error, in its own words.
    #[error("the GPU failed: {0}")]
    Driver(String),
}
