//! Answers what follows from the capture on a thread of its own: pictures do not wait for it.

use super::news::{Tell, WindowNews};
use crate::ask::Asked;
use crate::capture::Capture;
use crate::plan::FramePlan;
use std::sync::Arc;

/// A question, and what it is answered from.
#[derive(Debug)]
pub struct Reading {
    /// The question.
    pub asked: Asked,
    /// What was seen.
    pub capture: Arc<Capture>,
    /// What was run.
    pub plan: Option<Arc<FramePlan>>,
}

/// One question at a time; of those that come meanwhile only the newest counts.
#[derive(Debug, Default)]
pub struct Reader {
    is_running: bool,
    next: Option<Reading>,
}

impl Reader {
    /// Answers now, or after what is under way.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn read(&mut self, reading: Reading, tell: &Tell) -> std::io::Result<()> {
        if self.is_running {
            self.next = Some(reading);
            return Ok(());
        }
        let tell = Arc::clone(tell);
        let run = move || {
            let Reading { asked, capture, plan } = reading;
            let result = asked.ask.read_from(&capture, plan.as_ref());
            tell(WindowNews::Read { ticket: asked.ticket, result });
        };
        std::thread::Builder::new().name("reader".to_owned()).spawn(run)?;
        self.is_running = true;
        Ok(())
    }

    /// What was under way is done.
    ///
    /// # Errors
    /// As [`Reader::read`].
    pub fn go_on(&mut self, tell: &Tell) -> std::io::Result<()> {
        self.is_running = false;
        self.next.take().map_or(Ok(()), |next| self.read(next, tell))
    }
}
