//! What a device, its queue, its encoders and its surfaces have in common.

use super::command::FinishedCommands;
use std::any::Any;
use std::collections::VecDeque;
use std::fmt::Debug;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Who may keep what a device is told.
pub trait CallRecorder: Any + Debug + Send + Sync {
    /// Do encoders keep lists now?
    fn is_recording(&self) -> bool;

    /// Does what encoders have made.
    fn submit(&self, shared: &SharedDevice, buffers: Vec<FinishedCommands>) -> wgpu::SubmissionIndex;

    /// A picture was shown.
    fn presented(&self, shared: &SharedDevice);
}

/// Nobody keeps anything.
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

/// Makes the recorder of a device.
pub type MakeRecorder = fn() -> Box<dyn CallRecorder>;

/// What a device, its queue and its encoders have in common.
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

    /// From now on a frame ends where it is shown, not where it is submitted.
    pub fn has_surface(&self) {
        self.is_presented.store(true, Ordering::Relaxed);
    }

    /// Does a frame end where it is shown?
    pub fn is_presented(&self) -> bool {
        self.is_presented.load(Ordering::Relaxed)
    }

    /// The program's number of a submission.
    pub fn submitted(&self, index: wgpu::SubmissionIndex) -> u64 {
        self.submissions().add(index)
    }

    /// The real submission of the program's number.
    pub fn submission(&self, number: u64) -> Option<wgpu::SubmissionIndex> {
        self.submissions().real(number)
    }

    fn submissions(&self) -> MutexGuard<'_, Submissions> {
        self.submissions.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Submissions that a program may wait for. What is older than all that are kept is waited for with the oldest: it ends no later.
#[derive(Debug, Default)]
struct Submissions {
    waiting: VecDeque<wgpu::SubmissionIndex>,
    /// The number of the first that is kept.
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
