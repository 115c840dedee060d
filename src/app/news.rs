//! What wakes the window: news of the worker, a chosen file, a wish to repaint.

use crate::ask::{Answer, RunRequest};
use crate::capture::Capture;
use crate::scene::Scene;
use crate::session::RunFrame;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// What the worker has to tell.
#[derive(Debug)]
pub enum News {
    /// It works on something, in a few words.
    Busy(String),
    /// It has nothing to do.
    Idle,
    /// A scene was opened and will be run as the request says.
    Opened {
        /// Tells runs of this scene from those of the one before.
        scene_number: u64,
        /// As loaded.
        scene: Box<Scene>,
        /// What opens it again; `None`: nothing does by name.
        source: Option<String>,
        /// The files that it is made of.
        files: Vec<PathBuf>,
        /// Its first run.
        request: Box<RunRequest>,
    },
    /// A capture folder was opened.
    OpenedFolder {
        /// What is in it.
        capture: Arc<Capture>,
        /// Its path.
        source: String,
    },
    /// A frame was captured.
    Captured {
        /// Tells it from those before.
        frame: u64,
        /// What was run, and what was seen.
        run: RunFrame,
    },
    /// The answer to a question, or why there is none, with the mend; not told of what was cancelled.
    Answered {
        /// The question that is meant.
        ticket: u64,
        /// What was found.
        result: Result<Answer, String>,
    },
    /// A part of the answer to a question, of which more comes.
    AnsweredPart {
        /// The question that is meant.
        ticket: u64,
        /// What was found by now.
        answer: Answer,
    },
    /// No more parts come.
    AnswerEnded {
        /// The question that is meant.
        ticket: u64,
    },
    /// An export of the scene ended.
    Exported(Exported),
    /// What a scene that was loaded again has no place for.
    Dropped(String),
    /// Something failed; the text has the mend.
    Failed(String),
}

/// How an export ended.
#[derive(Debug)]
pub enum Exported {
    /// In words.
    Done(String),
    /// Something is there already.
    Taken(String),
    /// Why not, with the mend.
    Failed(String),
}

/// Wakes whoever draws the panels; one that is gone needs no news.
pub type Notify = Arc<dyn Fn(WindowNews) + Send + Sync>;

/// An event of the window's loop that is not the system's.
#[derive(Debug)]
pub enum WindowNews {
    /// From the worker.
    Worker(News),
    /// The system's dialog gave this path.
    Chosen(String),
    /// The system's dialog gave this place for an export.
    ChosenExport(String),
    /// An export ended.
    Exported(Exported),
    /// The answer to a question that follows from the capture.
    Read {
        /// The question that is meant.
        ticket: u64,
        /// What was found.
        result: Result<Answer, String>,
    },
    /// A file of the open scene changed.
    FileChanged(String),
    /// egui wants to draw at this time.
    Repaint(Instant),
    /// From assistive technology.
    Access(egui_winit::accesskit_winit::Event),
}

impl From<egui_winit::accesskit_winit::Event> for WindowNews {
    fn from(event: egui_winit::accesskit_winit::Event) -> WindowNews {
        WindowNews::Access(event)
    }
}
