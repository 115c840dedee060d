//! A frame that another program drew, out of a RenderDoc capture.
//!
//! ```text
//! PROGRAM ──launch.py──► capture.rdc ──extract.py──► frame.json, data.bin ──read──► RawFrame ──convert──► plan, capture
//!                                  └ draw_runs.py: thousands of small draws, as few as their states are
//! ```
//!
//! A capture is read by RenderDoc's own Python module, in a process of its own with a limit of time and memory: anybody
//! may have made it. The scripts do as little as they can; what they write to a folder is read here, without trust, and
//! becomes plain data: [`RawFrame`]. [`convert`] expresses it in the form of our own frames; module `recorded`
//! interprets such frames.

mod blobs;
mod convert;
mod document;
mod error;
mod geometry;
#[cfg(feature = "program")]
mod interpreter;
mod layers;
mod list;
pub(crate) mod pictures;
mod preprocessor;
#[cfg(feature = "program")]
mod process;
mod raw;
mod read;
#[cfg(feature = "program")]
mod renderdoc;
mod shader;
mod shipped;
mod states;
pub(crate) mod unroll;

pub use convert::{ConvertedFrame, RECORDED, convert};
pub use error::ImportError;
pub use list::list;
pub use raw::*;
pub use read::read;
#[cfg(feature = "program")]
pub use renderdoc::{RecordingRequest, RenderDocOptions, import, record};
pub use shipped::{SHIPPED, ShippedFrame};
