//! A picture that a pass gets from the CPU instead of from draws.

use std::fmt::Debug;
use std::sync::Arc;

/// Makes a picture, each time the frame runs: its time is part of the frame's.
pub trait MakeImage: Debug + Send + Sync {
    /// Texels of the pass's colour target, row by row without padding.
    fn make(&self) -> Vec<u8>;
}

/// How a pass's picture is made.
#[derive(Debug, Clone)]
pub struct CpuImage {
    /// For people: `rays of light 1`.
    pub name: String,
    /// Does the work.
    pub source: Arc<dyn MakeImage>,
}

/// The name says what is made: two plans of one scene make the same.
impl PartialEq for CpuImage {
    fn eq(&self, other: &CpuImage) -> bool {
        self.name == other.name
    }
}
