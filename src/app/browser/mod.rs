//! The window in a browser: eframe's shell draws the panels into the page's canvas, and hands them its events.
//!
//! ```text
//! assets/web/main.js ─ files, links ─► page.rs ─► Controller ─► worker (on the same thread, in turns)
//!         ▲                                │
//!         └──── ready, failed, downloads ──┘
//! ```
//!
//! There are no files here: those that are dropped on the page are kept in memory, where everything that opens files finds
//! them, and what is exported becomes a download.

mod page;
mod shell;
mod surroundings;
mod tree;

pub use shell::start;
