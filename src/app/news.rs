//! What wakes the window: news of the worker, a chosen file, a wish to repaint.

use crate::anatomy::Anatomy;
use crate::capture::{Capture, StepTests};
use crate::diagnosis::Diagnosis;
use crate::history::PixelHistory;
use crate::inspector::{MapReadersFound, ObjectMesh, RunRequest};
use crate::plan::FramePlan;
use crate::report::Report;
use crate::scene::{Scene, Walls};
use crate::technique::Choice;
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
        generation: u64,
        /// As loaded.
        scene: Box<Scene>,
        /// What opens it again; `None`: nothing does by name.
        source: Option<String>,
        /// The files that it is made of.
        files: Vec<PathBuf>,
        /// Its first run.
        request: Box<RunRequest>,
    },
    /// How the meshes of a scene hang together.
    Meshes {
        /// The scene that is meant.
        generation: u64,
        /// One an object.
        meshes: Vec<ObjectMesh>,
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
        /// What was seen.
        capture: Arc<Capture>,
        /// What was run.
        plan: Arc<FramePlan>,
    },
    /// The open scene as another technique draws it.
    Compared {
        /// The scene that is meant.
        generation: u64,
        /// What was asked.
        request: Box<RunRequest>,
        /// What was seen, or why it can't be, with the mend.
        result: Result<Arc<Capture>, String>,
    },
    /// How fragments fared in the tests.
    Tests {
        /// The frame that is meant.
        frame: u64,
        /// Index of the step.
        step: usize,
        /// Index of the draw; `None`: all of the step.
        draw: Option<usize>,
        /// What was counted, or why nothing was, with the mend.
        result: Result<Arc<StepTests>, String>,
    },
    /// The same frame was timed.
    Timed {
        /// The frame that is meant.
        frame: u64,
        /// With its time.
        capture: Arc<Capture>,
    },
    /// The same frame, with the states after the draws of one more step.
    Draws {
        /// The frame that is meant.
        frame: u64,
        /// With its draws.
        capture: Arc<Capture>,
    },
    /// The states after the draws of a step can't be had.
    NoDraws {
        /// The frame that is meant.
        frame: u64,
        /// Index of the step.
        step: usize,
        /// Why, with the mend.
        reason: String,
    },
    /// The same frame was held against the truth.
    Judged {
        /// The frame that is meant.
        frame: u64,
        /// With its truth.
        capture: Arc<Capture>,
    },
    /// The truth of a frame can't be told.
    NotJudged {
        /// The frame that is meant.
        frame: u64,
        /// Why, with the mend.
        reason: String,
    },
    /// What happened to a pixel.
    History {
        /// The frame that is meant.
        frame: u64,
        /// Column and row.
        at: [u32; 2],
        /// Its history, or why there is none, with the mend.
        history: Result<Arc<PixelHistory>, String>,
    },
    /// What a frame is made of in space.
    Anatomy {
        /// The frame that is meant.
        frame: u64,
        /// Its anatomy, or why there is none, with the mend.
        anatomy: Result<Arc<Anatomy>, String>,
    },
    /// What can't be walked through.
    Walls {
        /// The scene that is meant.
        generation: u64,
        /// At the moment that was asked for.
        walls: Arc<Walls>,
    },
    /// Techniques were measured, or could not be; not told of what was cancelled.
    Measured {
        /// The measuring that is meant.
        job: u64,
        /// The report, or why there is none.
        result: Result<Report, String>,
        /// What would have taken too much memory.
        left_out: Vec<Choice>,
    },
    /// A frame was diagnosed, or could not be; not told of what was cancelled.
    Diagnosed {
        /// The diagnosing that is meant.
        job: u64,
        /// The diagnosis, or why there is none.
        result: Result<Arc<Diagnosis>, String>,
    },
    /// The rows of a stress case.
    Stressed {
        /// The running that is meant.
        job: u64,
        /// Every technique at every value.
        rows: Vec<crate::stress::Row>,
    },
    /// Stress cases run no more; not told of what was cancelled.
    StressEnded {
        /// The running that is meant.
        job: u64,
        /// Why they do not, where it was not that all are done.
        error: Option<String>,
    },
    /// An export of the scene ended.
    Exported(super::export::Exported),
    /// Something failed; the text has the mend.
    Failed(String),
}

/// Wakes whoever draws the panels; one that is gone needs no news.
pub type Tell = Arc<dyn Fn(WindowNews) + Send + Sync>;

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
    Exported(super::export::Exported),
    /// Which texel of a light's map each pixel reads.
    MapReaders(MapReadersFound),
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
