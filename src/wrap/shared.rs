//! What a device, its queue, its encoders and its surfaces share.

use super::command::FinishedCommands;
use std::any::Any;
use std::collections::VecDeque;
use std::fmt::Debug;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Receives the calls of a wrapped device.
pub trait CallRecorder: Any + Debug + Send + Sync {
    /// Returns whether encoders should record their calls as lists of commands.
    fn is_recording(&self) -> bool;

    /// Submits what encoders have finished, to the queue or to a replay.
    fn submit(&self, shared: &SharedDevice, buffers: Vec<FinishedCommands>) -> wgpu::SubmissionIndex;

    /// Is called after the program has presented a picture.
    fn presented(&self, shared: &SharedDevice);
}

/// A call recorder that records nothing.
#[derive(Debug)]
pub struct NoRecorder;

impl CallRecorder for NoRecorder {
    fn is_recording(&self) -> bool {
        false
    }

    fn submit(&self, shared: &SharedDevice, buffers: Vec<FinishedCommands>) -> wgpu::SubmissionIndex {
        shared.queue.submit(buffers.into_iter().map(|finished| finished.inner))
    }

    fn presented(&self, _: &SharedDevice) {}
}

/// Creates the recorder of a device.
pub type MakeRecorder = fn() -> Box<dyn CallRecorder>;

/// What a device, its queue and its encoders share.
#[derive(Debug)]
pub struct SharedDevice {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub adapter: wgpu::Adapter,
    pub recorder: Box<dyn CallRecorder>,
    is_presented: AtomicBool,
    submissions: Mutex<Submissions>,
}

impl SharedDevice {
    /// Returns the shared part of a device, with a new recorder made by `recorder`, and not presented yet.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        adapter: &wgpu::Adapter,
        recorder: MakeRecorder,
    ) -> SharedDevice {
        SharedDevice {
            device: device.clone(),
            queue: queue.clone(),
            adapter: adapter.clone(),
            recorder: recorder(),
            is_presented: AtomicBool::new(false),
            submissions: Mutex::default(),
        }
    }

    /// From now on a frame ends where it is presented, not where it is submitted.
    pub fn has_surface(&self) {
        self.is_presented.store(true, Ordering::Relaxed);
    }

    /// Returns whether the program presents pictures, so that a frame ends there; otherwise it ends with a submission.
    pub fn is_presented(&self) -> bool {
        self.is_presented.load(Ordering::Relaxed)
    }

    /// Stores a real submission; returns the program's number of it.
    pub fn submitted(&self, index: wgpu::SubmissionIndex) -> u64 {
        self.submissions().add(index)
    }

    /// Returns the real submission with the program's number; the oldest that is stored where it is stored no more,
    /// which ends no earlier. `None` for a number that was not given out yet.
    pub fn submission(&self, number: u64) -> Option<wgpu::SubmissionIndex> {
        self.submissions().real(number)
    }

    fn submissions(&self) -> MutexGuard<'_, Submissions> {
        self.submissions.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Submissions that a program may wait for. Waiting for one that is older than all that are stored waits for the
/// oldest, which ends no earlier.
#[derive(Debug, Default)]
struct Submissions {
    waiting: VecDeque<wgpu::SubmissionIndex>,
    /// The number of the first that is stored.
    first: u64,
}

impl Submissions {
    const MOST: usize = 1024;

    fn add(&mut self, index: wgpu::SubmissionIndex) -> u64 {
        self.waiting.push_back(index);
        if self.waiting.len() > Self::MOST {
            self.waiting.pop_front();
            self.first += 1;
        }
        self.first + self.waiting.len() as u64 - 1
    }

    fn real(&self, number: u64) -> Option<wgpu::SubmissionIndex> {
        let at = number.saturating_sub(self.first) as usize;
        self.waiting.get(at).cloned()
    }
}
