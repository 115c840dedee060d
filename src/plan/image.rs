//! A picture that a pass gets from the CPU instead of from draws.

use std::fmt::Debug;
use std::sync::Arc;

/// Computes a picture on the CPU each time the frame runs; its time is part of the frame's.
pub trait MakeImage: Debug + Send + Sync {
    /// Returns the texels of the pass's colour target, row by row without padding.
    fn make(&self) -> Vec<u8>;
}

/// A picture that the CPU computes in place of a pass's draws.
#[derive(Debug, Clone)]
pub struct CpuImage {
    /// A name for people: `rays of light 1`.
    pub name: String,
    /// Hash of all that the picture depends on.
    pub content: u64,
    /// Computes the picture.
    pub source: Arc<dyn MakeImage>,
}

impl PartialEq for CpuImage {
    fn eq(&self, other: &CpuImage) -> bool {
        self.name == other.name && self.content == other.content
    }
}
