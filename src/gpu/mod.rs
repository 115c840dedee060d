//! Runs plans on a GPU. Knows plans and captures, and no technique.
//!
//! ```text
//! Context      adapter and device
//! Pipelines    shaders and pipelines, interned by description
//! Buffers      vertices and indices, by the hash of their content
//! Pictures     pictures on surfaces with their levels, by the hash of their content
//! Attachments  textures that plans draw into, handed on
//! Maps         what lights see, kept while nothing that makes it changes
//! features     what few plans need, asked for when one does
//! Executor     a plan → prepared textures, bind groups and draws → one command buffer, or more
//! fragment_log every fragment of one pixel, tests or no tests
//! queries      times of passes, samples of draws
//! start        what depth and stencil hold as a pass begins
//! readback     snapshots: copies recorded between passes, mapped
//! room         how much memory a frame may hold
//! collect      mapped copies → steps, with what did not change shared
//! ```

mod answer;
mod attachments;
mod budget;
mod buffers;
mod collect;
mod context;
mod error;
mod executor;
mod features;
mod fragment_log;
mod maps;
mod pictures;
mod pipelines;
mod prepared;
mod queries;
mod readback;
mod shaders;
mod specialization;
mod start;
mod uniforms;

pub use collect::{ExecutorOutput, SnapshotMemory};
pub use context::GpuContext;
#[cfg(feature = "inspector")]
pub use context::MEMORY_HINTS;
pub use error::GpuError;
pub use executor::Executor;
pub use prepared::Prepared;
