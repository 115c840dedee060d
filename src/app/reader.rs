//! Answers what follows from the capture on a thread of its own: pictures do not wait for it.

use super::news::{Notify, WindowNews};
use crate::ask::PendingQuestion;
use crate::capture::Capture;
use crate::plan::FramePlan;
use std::sync::Arc;

/// A question, and what it is answered from.
#[derive(Debug)]
pub struct ReadRequest {
    /// The question.
    pub asked: PendingQuestion,
    /// What was seen.
    pub capture: Arc<Capture>,
    /// What was run.
    pub plan: Option<Arc<FramePlan>>,
}

/// A question that nothing answers: the system gives no thread.
#[derive(Debug)]
pub struct NoReader {
    /// Whose it is.
    pub ticket: u64,
    /// What the system says.
    pub why: std::io::Error,
}

/// One question at a time; of those that come meanwhile only the newest counts.
#[derive(Debug, Default)]
pub struct ReaderThread {
    is_running: bool,
    next: Option<ReadRequest>,
}

impl ReaderThread {
    /// Answers now, or after what is under way.
    pub fn read(&mut self, reading: ReadRequest, notify: &Notify) -> Result<(), NoReader> {
        if self.is_running {
            self.next = Some(reading);
            return Ok(());
        }
        let (notify, ticket) = (Arc::clone(notify), reading.asked.ticket);
        let run = move || {
            let ReadRequest { asked, capture, plan } = reading;
            let result = asked.ask.read_from(&capture, plan.as_ref());
            notify(WindowNews::Read { ticket: asked.ticket, result });
        };
        std::thread::Builder::new().name("reader".to_owned()).spawn(run).map_err(|why| NoReader { ticket, why })?;
        self.is_running = true;
        Ok(())
    }

    /// What was under way is done.
    pub fn go_on(&mut self, notify: &Notify) -> Result<(), NoReader> {
        self.is_running = false;
        self.next.take().map_or(Ok(()), |next| self.read(next, notify))
    }
}
