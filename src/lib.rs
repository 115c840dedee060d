//! An interactive visual debugger for stencil shadows and shadow maps.
//!
//! ```text
//! scene ──► technique ──► FramePlan ──► gpu::Executor ──► Capture ──► cli, inspector
//! ```
//!
//! A frame is data: a technique turns a scene into a plan, one executor runs any plan and keeps
//! colour, depth and stencil after every pass, and everything after that only reads.

#[cfg(feature = "inspector")]
pub mod app;
pub mod capture;
pub mod cli;
pub mod geometry;
pub mod gpu;
#[cfg(feature = "inspector")]
pub mod inspector;
pub mod math;
pub mod plan;
pub mod scene;
pub mod session;
pub mod stencil_machine;
pub mod technique;
