//! One HTML file of a frame: it opens in a browser, from disk, and makes no network requests.
//!
//! ```text
//! Capture, FramePlan ─► files of the capture folder ─► arrays ─┐
//!                     assets/page/*.{html,css,js,wasm} ────────┼─► html ─► one file
//!                       names, numbers, colours (document) ────┘
//! ```
//!
//! The file contains what `capture` would write but for the scene, the plan as text, times and what no question needs. A
//! pixel's history, its verdict and its ladder are computed in the browser by this crate's own code, compiled to
//! WebAssembly (`answers.rs`), and compared with what was stored; JavaScript draws and listens. The same frame gives the
//! same bytes: no times are stored.

mod answers;
#[cfg(feature = "formats")]
mod arrays;
#[cfg(feature = "formats")]
mod document;
#[cfg(feature = "formats")]
mod error;
#[cfg(feature = "formats")]
mod html;
#[cfg(feature = "formats")]
mod written;

pub use answers::{PageFrame, PageQuestionError};
#[cfg(feature = "formats")]
pub use error::PageError;
#[cfg(feature = "formats")]
pub use html::{PageAsset, STYLE, TEMPLATE, module, modules, script};
#[cfg(feature = "formats")]
pub use written::{html, write, write_at};
