//! Answers questions from the capture beside the worker: pictures do not wait for it.

use super::news::{Notify, WindowNews};
use super::task;
use crate::ask::PendingQuestion;
use crate::capture::Capture;
use crate::plan::FramePlan;
use std::sync::Arc;

/// A question, with the capture and plan from which it is answered.
#[derive(Debug)]
pub struct ReadRequest {
    /// The question.
    pub asked: PendingQuestion,
    /// The frame's capture.
    pub capture: Arc<Capture>,
    /// The frame's plan; `None` for a capture folder.
    pub plan: Option<Arc<FramePlan>>,
}

/// A question that can't be answered, as the system could not start a thread.
#[derive(Debug)]
pub struct NoReader {
    /// Ticket of the question.
    pub ticket: u64,
    /// The system's error.
    pub why: std::io::Error,
}

/// Answers one question at a time; of those that come meanwhile only the newest is answered.
#[derive(Debug, Default)]
pub struct Reader {
    is_running: bool,
    next: Option<ReadRequest>,
}

impl Reader {
    /// Answers a question beside the window; while one is being answered, this one waits in place of any other
    /// that waits, which is dropped unanswered. The answer comes as `WindowNews::Read`.
    pub fn read(&mut self, reading: ReadRequest, notify: &Notify) -> Result<(), NoReader> {
        if self.is_running {
            self.next = Some(reading);
            return Ok(());
        }
        let (notify, ticket) = (Arc::clone(notify), reading.asked.ticket);
        let run = async move || {
            let ReadRequest { asked, capture, plan } = reading;
            let result = asked.ask.read_from(&capture, plan.as_ref());
            notify(WindowNews::Read { ticket: asked.ticket, result });
        };
        task::start("reader", run).map_err(|why| NoReader { ticket, why })?;
        self.is_running = true;
        Ok(())
    }

    /// Begins the waiting question, if there is one; call it once the present one is answered.
    pub fn go_on(&mut self, notify: &Notify) -> Result<(), NoReader> {
        self.is_running = false;
        self.next.take().map_or(Ok(()), |next| self.read(next, notify))
    }
}
