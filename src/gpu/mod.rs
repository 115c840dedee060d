//! Runs plans on a GPU. Knows plans and captures, and no technique.
//!
//! ```text
//! context      adapter and device
//! pipelines    shaders and pipelines, interned by description
//! buffers      vertices and indices, by the hash of their content
//! pictures     textures of surfaces with their mip levels, by the hash of their content
//! attachments  a pool of the textures that plans draw into
//! maps         shadow maps, cached while nothing that makes them changes
//! features     what few plans need, asked for when one does
//! executor     a plan → prepared textures, bind groups and draws → one command buffer, or more
//! fragment_log every fragment of one pixel, with or without its tests
//! probe        what the rasteriser does with triangles, measured by drawing
//! queries      times of passes, samples of draws
//! small_triangles  what the rasteriser need not be given for a preview
//! start        what depth and stencil store as a pass begins
//! readback     snapshots: copies recorded between passes, mapped
//! waiting      waits for the GPU, natively and in a browser
//! budget       how much memory a frame may take
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
mod log_pipelines;
mod maps;
mod pictures;
mod pipelines;
mod prepared;
mod probe;
mod queries;
mod readback;
mod shaders;
mod small_triangles;
mod specialization;
mod start;
mod uniforms;
mod waiting;

pub use attachments::AttachmentPool;
pub use collect::{ExecutorOutput, SnapshotMemory};
pub use context::GpuContext;
#[cfg(feature = "inspector")]
pub use context::MEMORY_HINTS;
pub use error::GpuError;
pub use executor::Executor;
pub use prepared::Prepared;
pub use waiting::work_parts;
