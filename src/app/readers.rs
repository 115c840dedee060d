//! Finds which texel of a light's map each pixel reads, on a thread of its own: pictures do not wait for it.

use super::news::{Tell, WindowNews};
use crate::inspector::MapReadersJob;
use std::sync::Arc;

/// One job at a time; of those that come meanwhile only the newest counts.
#[derive(Debug, Default)]
pub struct Readers {
    is_running: bool,
    next: Option<MapReadersJob>,
}

impl Readers {
    /// Finds them now, or after what is under way.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn find(&mut self, job: MapReadersJob, tell: &Tell) -> std::io::Result<()> {
        if self.is_running {
            self.next = Some(job);
            return Ok(());
        }
        let tell = Arc::clone(tell);
        let run = move || tell(WindowNews::MapReaders(job.find()));
        std::thread::Builder::new().name("map readers".to_owned()).spawn(run)?;
        self.is_running = true;
        Ok(())
    }

    /// What was under way is done.
    ///
    /// # Errors
    /// As [`Readers::find`].
    pub fn go_on(&mut self, tell: &Tell) -> std::io::Result<()> {
        self.is_running = false;
        self.next.take().map_or(Ok(()), |next| self.find(next, tell))
    }

    /// Is any under way?
    pub fn is_running(&self) -> bool {
        self.is_running
    }
}
