//! The window: joins the session, which runs things, and the inspector, which shows them.
//!
//! ```text
//! Inspector ──Action──► Controller ─Order─► Worker (owns the session)
//!     ▲                   │  ▲                    │
//!     └────── data ───────┘  └──────── News ──────┘
//! ```
//!
//! The worker opens files and renders, the window only draws. Natively the worker has a thread, so that nothing holds the
//! window up; in a browser it gives way while the GPU works and while rays are followed, and not while a file is read. The
//! worker starts before the window is made, so that the GPU's first frame and the window's come together.
//!
//! The same controller runs natively (`desktop/`: winit's event loop, threads, the system's dialogs and clipboard), without
//! a window (`headless.rs`), and in a browser (`browser/`: eframe's shell, one thread, dropped files and downloads).

mod allocator;
#[cfg(target_family = "wasm")]
mod browser;
mod controller;
#[cfg(not(target_family = "wasm"))]
mod desktop;
mod export;
#[cfg(not(target_family = "wasm"))]
pub mod headless;
mod input;
mod news;
mod no_capture;
mod queue;
#[cfg(any(test, target_family = "wasm"))]
mod quiet;
mod reader;
mod task;
mod worker;

#[cfg(target_family = "wasm")]
pub use browser::start as start_in_page;
#[cfg(not(target_family = "wasm"))]
pub use desktop::run;
pub use no_capture::why as why_no_capture;

use crate::capture::Capture;
use crate::capture::disk::WholeFrame;
use crate::scene::{OpenSpec, Scene};
use crate::session::CaptureRequest;

/// What the window opens, and what it shows first.
#[derive(Debug, Clone)]
pub struct ViewRequest {
    /// The scene or capture to open.
    pub source: ViewSource,
    /// What opens it again: a built-in name or a path.
    pub name: OpenSpec,
    /// How to render a scene, where the scene itself does not say.
    pub capture: CaptureRequest,
    /// The time in an animated scene, seconds.
    pub time: f64,
    /// Part of the name of the GPU to use; `None`: the fastest.
    pub adapter: Option<String>,
    /// Index of the step to select; `None`: the last.
    pub step: Option<usize>,
    /// The pixel to pick.
    pub pick: Option<[u32; 2]>,
    /// Show where the technique is wrong.
    pub truth: bool,
}

/// What the window opens, already loaded.
#[derive(Debug, Clone)]
pub enum ViewSource {
    /// A scene, as loaded: at time 0.
    Scene(Box<Scene>),
    /// The content of a capture folder, to be looked at without a GPU run.
    Folder(Box<WholeFrame>),
}

/// Why the window or its headless panels can't be opened or go on.
#[derive(Debug, thiserror::Error)]
pub enum AppError {
    /// There is no display, or no GPU that can draw on it.
    #[cfg(not(target_family = "wasm"))]
    #[error("there can be no window ({0}): use `stencilscope capture` instead")]
    NoWindow(String),
    /// There is no GPU that can draw the panels.
    #[cfg(not(target_family = "wasm"))]
    #[error("no picture can be made of the panels ({0}): install a GPU driver, such as mesa-vulkan-drivers")]
    NoPicture(String),
    /// The worker did not finish in time.
    #[cfg(not(target_family = "wasm"))]
    #[error("nothing was heard of the GPU for two minutes: try a smaller picture")]
    Silent,
    /// The system could not start a thread.
    #[error("the worker thread can't be started: {0}")]
    NoThread(std::io::Error),
}

/// Returns the window's title for a capture.
fn title(capture: &Capture) -> String {
    format!("{} · {} — stencilscope", capture.scene, capture.technique)
}
