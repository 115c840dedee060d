//! An interactive visual debugger for stencil shadows and shadow maps.
//!
//! ```text
//! scene ──► technique ──► FramePlan ──► gpu::Executor ──► Capture ──┬─► history, difference ──► cli, inspector, testing
//!    └────► truth ──────────────────────────────────► accuracy ◄─────┴─► report, stress
//! ```
//!
//! A frame is data: a technique turns a scene into a plan, one executor runs any plan and captures
//! colour, depth and stencil after every pass, and everything after that only reads. [`accuracy`] measures how
//! right a frame is: [`truth`] follows rays through the same scene and knows nothing of plans.
//!
//! ```
//! use stencilscope::scene::{OpenSpec, open};
//! use stencilscope::session::{CaptureRequest, Session};
//! use stencilscope::technique::{Choice, Technique};
//!
//! let scene = open(&OpenSpec::new("tori"))?;
//! let request = CaptureRequest::new(Choice::new(Technique::ZFail), [320, 180]);
//! let capture = Session::new(None)?.capture(&scene, &request)?;
//!
//! // Step 1 has counted the shadow volumes of the light: which pixels are in shadow, and in how many volumes?
//! assert_eq!(capture.steps[1].name, "volumes");
//! let counts = &capture.frame_at(1).and_then(|frame| frame.stencil.as_ref()).expect("a stencil").image;
//! let shadowed: u64 = counts.histogram()[1..].iter().sum();
//! assert!(shadowed > 1000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The words are the field's: the [`glossary`] has them.
//!
//! # Where things are
//!
//! - **A technique**: one file in [`technique`]. z-fail is `technique/volume.rs`, whose `plan` adds the pass `volumes`,
//!   with two-sided stencil operations from `technique/volume/counting.rs`. The module's page writes one from outside
//!   the crate.
//! - **A frame**: [`plan`] is what a GPU should do, `gpu/executor.rs` makes it do that, and [`capture`] is the result.
//!   A capture never changes: what is computed later is the answer to a question ([`ask`]).
//! - **A question**: an entry in the table of `ask/mod.rs`, an arm of [`Session::answer`](session::Session::answer),
//!   and the panel that wants it.
//! - **A dragged light**: a handle (`inspector/canvas/handles.rs`) changes the draft of the next run,
//!   `Model::run_draft` (`inspector/model/scene.rs`) asks for it, `app/controller.rs` passes the order to the queue
//!   (`app/queue.rs`, where of waiting runs only the newest counts), `app/worker.rs` runs it, and `Model::set_capture`
//!   (`inspector/model/frame.rs`) shows it; answers about the frame before are dropped.
//! - **A frame of another program**: `import/extract.py` takes it out of a RenderDoc capture, `import/read.rs` reads
//!   that without trust, and the result is an [`import::RawFrame`].
//! - **A frame of a wgpu program**: `wrap/` forwards every call of the program, and writes a list while a frame is
//!   recorded; `record/replay.rs` runs the list draw by draw. The result is an [`import::RawFrame`], too.
//! - **A texture on a surface**: `scene/files/obj/materials.rs` (`map_Kd`) and `scene/files/file/build.rs` (`texture`)
//!   read it, `scene/picture.rs` decodes it and computes its mip chain, `technique/surfaces.rs` computes each corner's
//!   texture coordinates, `shaders/texture.wgsl` looks it up, and `reading/shading.rs` computes the same on the CPU.
//! - **A file**: `files/mod.rs` reads and writes it, on disk (`files/system.rs`) or, in a browser, in memory
//!   (`files/memory.rs`): what is dropped on a page (`files/brought.rs`) is opened by the code that opens it on disk.
//! - **A panel**: a file in `inspector/panels/`, a field and an arm in `inspector/panels/mod.rs`, a name in
//!   `inspector/action.rs`, and its place in `inspector/shell/dock.rs`. Its sentences about a frame come from
//!   [`reading`].
//! - **An animation**: [`film`] renders the pictures of an animated PNG, `picture/apng.rs` writes each when it is done,
//!   for `cli/animate.rs` and for the window's worker (`app/worker/film.rs`, one picture at a time).
//! - **A page**: [`page`] writes the files of a frame's capture folder and `assets/page/` into one HTML file. In a
//!   browser the files are read, and questions about pixels answered, by this crate as WebAssembly (`page/answers.rs`,
//!   `assets/page/page.wasm`, which `.ci/web` makes); JavaScript draws and listens.
//! - **The window in a browser**: `.ci/live` makes `target/web/` of `assets/web/` and of `app/browser/`, eframe's shell over
//!   the same `app/controller.rs`. `app/task.rs` runs the worker in turns with the page, `files/memory.rs` holds what is
//!   dropped on it, and [`link`] reads its address and writes the one that is shared.
//! - **A wait for the GPU**: `gpu/waiting.rs` waits, natively and in a browser, and everything up to
//!   [`AsyncSession`](session::AsyncSession) is async; `session/blocking.rs` blocks on it for programs without an executor.
//! - **A docking**: `inspector/shell/arrangement.rs` decides which arrangements of panels are possible.
//! - **The Scene tab**: `inspector/panels/scene/stage.rs` draws a frame's [`anatomy`] as faces and lines, and
//!   `viewport.rs` draws these with a depth buffer on the GPU that draws the window, whichever device has run the
//!   frame.
//! - **What the window shows**: `repaint/damage.rs` finds what changed since the frame before, and `repaint/mod.rs` draws that
//!   alone into a texture that is kept.
//!
//! World space is right-handed with Y up, in `f64`; positions go to the GPU relative to the eye.
//! Depth is reversed and infinite unless set otherwise: 1 at the near plane, 0 at infinity. Front faces are
//! counter-clockwise. Row 0 of a picture is at the top. See [`math`] for the names of transforms.

// Without a GPU there are no sessions, and what only they use is unused.
#![cfg_attr(not(feature = "gpu"), allow(dead_code, unused_imports))]

/// The words of this crate.
#[doc = include_str!("../assets/glossary.md")]
pub mod glossary {}

#[macro_use]
mod named;

pub mod accuracy;
#[cfg(feature = "gpu")]
mod adapters;
pub mod anatomy;
#[cfg(any(feature = "inspector", all(feature = "web", target_family = "wasm")))]
mod app;
pub mod ask;
pub mod capture;
pub mod check;
#[cfg(feature = "program")]
pub mod cli;
pub mod diagnosis;
pub mod difference;
mod files;
#[cfg(feature = "formats")]
pub mod film;
pub mod geometry;
#[cfg(feature = "gpu")]
mod gpu;
pub mod history;
pub mod import;
#[cfg(feature = "panels")]
pub mod inspector;
mod last_used;
#[cfg(feature = "formats")]
pub mod link;
pub mod math;
mod numbers;
#[cfg(feature = "inspector")]
pub mod offscreen;
pub mod page;
pub mod picture;
pub mod plan;
pub mod progress;
pub mod reading;
#[cfg(feature = "record")]
pub mod record;
pub mod recorded;
#[cfg(feature = "inspector")]
mod repaint;
pub mod report;
pub mod scene;
#[cfg(feature = "gpu")]
pub mod session;
pub mod shards;
pub mod stencil_machine;
pub mod stress;
pub mod technique;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub mod testing;
pub mod truth;
#[cfg(feature = "panels")]
pub mod viewport;
#[cfg(feature = "record")]
mod wrap;

/// Opens the window in the page that has loaded this module, with what the page's address asks for; where that fails, the
/// page says why.
#[cfg(all(feature = "web", target_family = "wasm"))]
pub use app::start_in_page;
/// The libraries whose vectors, matrices and raster states this crate's interface uses.
#[cfg(feature = "gpu")]
pub use wgpu;
pub use {glam, wgpu_types};
