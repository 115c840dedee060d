//! The events that wake the window: news of the worker, a chosen file, an answer.

use crate::ask::{Answer, RunRequest};
use crate::capture::Capture;
use crate::plan::FramePlan;
use crate::scene::Scene;
use crate::session::RunFrame;
use std::path::PathBuf;
use std::sync::Arc;

/// What the worker reports.
#[derive(Debug)]
pub enum News {
    /// It works on something, in a few words.
    Busy(String),
    /// It has nothing to do.
    Idle,
    /// A scene was opened and will be run as the request says.
    Opened {
        /// Distinguishes runs of this scene from those of the previous one.
        scene_number: u64,
        /// The scene, as loaded.
        scene: Box<Scene>,
        /// The source that opens it again; `None` where it can't be opened by name.
        source: Option<String>,
        /// The files from which it was loaded.
        files: Vec<PathBuf>,
        /// Its first run.
        request: Box<RunRequest>,
    },
    /// A capture folder was opened.
    OpenedFolder {
        /// Its content.
        capture: Arc<Capture>,
        /// Its path.
        source: String,
    },
    /// A frame was captured.
    Captured {
        /// The frame's number, which no earlier frame has.
        frame: u64,
        /// The plan that was run, and its capture.
        run: RunFrame,
    },
    /// A preview of a scene that is being changed was captured; the whole frame follows once it is at rest.
    Previewed {
        /// The preview's number, as of a frame.
        frame: u64,
        /// The plan that was run, for fewer pixels.
        plan: Arc<FramePlan>,
        /// Its capture, enlarged to the size that was asked for.
        capture: Arc<Capture>,
    },
    /// The answer to a question, or why there is none and how to fix it; not sent for a cancelled question.
    Answered {
        /// Ticket of the question.
        ticket: u64,
        /// The answer.
        result: Result<Answer, String>,
    },
    /// A part of the answer to a question, of which more comes.
    AnsweredPart {
        /// Ticket of the question.
        ticket: u64,
        /// The parts that are known by now.
        answer: Answer,
    },
    /// An answer in parts is complete.
    AnswerEnded {
        /// Ticket of the question.
        ticket: u64,
    },
    /// An export of the scene ended.
    Exported(Exported),
    /// Something went otherwise than asked, and the work goes on: changes that could not be applied to a scene that was
    /// loaded again, an adapter that gave no device.
    Warned(String),
    /// Something failed; the text says how to fix it.
    Failed(String),
    /// What was asked to be opened can't be.
    NotOpened {
        /// The name or path.
        source: String,
        /// Why, and how to fix it.
        reason: String,
    },
}

/// How an export ended.
#[derive(Debug)]
pub enum Exported {
    /// It succeeded; says what was written.
    Done(String),
    /// Something exists at this path already.
    Taken(String),
    /// Why it failed, and how to fix it.
    Failed(String),
}

/// Sends news to the event loop that draws the panels, from any thread, and wakes it; does nothing after it has ended.
pub type Notify = Arc<dyn Fn(WindowNews) + Send + Sync>;

/// What wakes the panels besides the user.
#[derive(Debug)]
pub enum WindowNews {
    /// News of the worker.
    Worker(News),
    /// The system's dialog gave this path.
    Chosen(String),
    /// The system's dialog gave this path for an export.
    #[cfg_attr(target_family = "wasm", expect(dead_code, reason = "a download has no path"))]
    ChosenExport(String),
    /// The system has no dialog that chooses files: why, and what to do instead.
    #[cfg_attr(target_family = "wasm", expect(dead_code, reason = "a browser has one"))]
    NoChooser(String),
    /// An export ended.
    Exported(Exported),
    /// The answer to a question that is answered from the capture.
    Read {
        /// Ticket of the question.
        ticket: u64,
        /// The answer.
        result: Result<Answer, String>,
    },
    /// A file of the open scene changed.
    #[cfg_attr(target_family = "wasm", expect(dead_code, reason = "dropped files don't change"))]
    FileChanged(String),
}
