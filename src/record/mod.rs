//! Frames of any wgpu program, with one line changed: `record::instance(descriptor)` in place of `wgpu::Instance::new`.
//!
//! ```text
//! program ─► crate::wrap   hands every call to the real wgpu; stores a list beside while a frame is recorded
//!              └► recorder.rs   which frame that is, and what is done with it
//!                   └► replay.rs     runs the list draw by draw, and reads what each draw left
//!                        ├ probes.rs     runs a draw once more to follow its vertices and fragments
//!                        │  ├ vertices.rs   positions of its vertices: its shader, rewritten by rewrite.rs, logs them
//!                        │  ├ fragments.rs  which of its fragments its shader does not discard, where it may discard some
//!                        │  └ probe.rs      the pipeline that such a shader runs in
//!                        ├ states.rs     wgpu's states as a `RawFrame` has them
//!                        └ readback.rs   textures and buffers as bytes
//!                   └► RawFrame ─► import::convert ─► capture folder
//! ```
//!
//! Which frame is recorded is decided by [`next_frame`], or by the environment: `STENCILSCOPE_RECORD=DIR` for the first
//! frame, `STENCILSCOPE_RECORD=DIR:N` for the one after `N` others, `STENCILSCOPE_RECORD=DIR:A..B` for each from `A` to
//! before `B`. [`start`] and [`stop`] record every frame between two calls. [`frame`] records what a closure encodes,
//! as tests do. A frame ends where it is presented; in a program without a surface with each submission that has a
//! render pass, except that a recorded one continues until something is drawn.
//!
//! The cost of a frame is reported with it: its draws, the time that the program would not have spent, the bytes of its
//! folder. In a series, the frames after the first reuse the rewritten shaders.
//!
//! The module [`example`] is a renderer with a fault, the test that finds it, and the fix.
//!
//! A wrapped program draws what it draws anyway, whether or not it is recorded. It may do a little more than it asked
//! for: copy from its targets and its index and indirect buffers, bind one more group, read and write two more storage
//! buffers. Acceleration structures and mesh shaders are hidden from it. So is the API beneath: `Device::as_hal` and
//! similar functions return nothing, and objects from `create_texture_from_hal` and similar functions are of no device
//! that is recorded, so that wgpu panics.
//!
//! A recorded submission is run in parts, and other threads can't submit meanwhile. What they write with
//! `Queue::write_buffer` or `Queue::write_texture` meanwhile may come between two parts, where it would come before or
//! after all of them.

pub mod example {
    #![doc = include_str!("example.md")]
}
mod error;
mod fragments;
mod probe;
mod probes;
mod readback;
mod recorder;
mod replay;
mod rewrite;
mod states;
mod vertices;

pub use error::RecordError;
pub use recorder::{RecordedFrame, RecordingCost, SeriesFrame};

use crate::wrap;
use recorder::Recorder;
use std::any::Any;
use std::path::Path;

/// Name of the environment variable that requests a recording: `DIR`, `DIR:N` for the Nth frame, or `DIR:A..B`.
pub const VARIABLE: &str = "STENCILSCOPE_RECORD";

/// Returns an instance of wgpu whose frames can be recorded.
pub fn instance(descriptor: wgpu::InstanceDescriptor) -> wgpu::Instance {
    wgpu::Instance::from_custom(wrap::Instance::recorded_by(descriptor, || Box::new(Recorder::default())))
}

/// Records what `draw` encodes, and writes it to `folder` as a capture folder. What else is submitted meanwhile is part
/// of it.
///
/// # Errors
/// The device is of another instance than [`instance`] returns; the frame has no depth buffer to follow or draws
/// nothing that can be followed; the folder can't be written.
pub fn frame(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    folder: &Path,
    draw: impl FnOnce(&mut wgpu::CommandEncoder),
) -> Result<RecordedFrame, RecordError> {
    let (shared, recorder) = recorder_of(device)?;
    let recording = recorder.begin(folder.to_owned())?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("recorded frame") });
    draw(&mut encoder);
    queue.submit([encoder.finish()]);
    recording.end(shared)
}

/// Records the next frame that the program begins on a device, and writes it to `folder` as a capture folder. The
/// outcome is reported in a line on standard error, since no caller waits for it.
pub fn next_frame(device: &wgpu::Device, folder: &Path) -> Result<(), RecordError> {
    let (shared, recorder) = recorder_of(device)?;
    recorder.wish(shared, folder.to_owned())
}

/// Records every frame that begins from now on, until [`stop`]: each in a folder of its own within `folder`,
/// `frame-0000` and on. The cost of each is reported in a line on standard error; the series ends with the first folder
/// that can't be written.
pub fn start(device: &wgpu::Device, folder: &Path) -> Result<(), RecordError> {
    let (shared, recorder) = recorder_of(device)?;
    recorder.start_series(shared, folder.to_owned())
}

/// Stops a series, and returns the outcome of each frame since [`start`]. A frame that has begun is still written when
/// it ends, and reported on standard error.
pub fn stop(device: &wgpu::Device) -> Result<Vec<SeriesFrame>, RecordError> {
    Ok(recorder_of(device)?.1.stop_series())
}

fn recorder_of(device: &wgpu::Device) -> Result<(&wrap::SharedDevice, &Recorder), RecordError> {
    let shared = &device.as_custom::<wrap::Device>().ok_or(RecordError::NotWrapped)?.shared;
    let recorder: &dyn Any = &*shared.recorder;
    Ok((shared, recorder.downcast_ref().ok_or(RecordError::NotWrapped)?))
}
