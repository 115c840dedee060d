//! The progress of some work, and the request to cancel it; shared between threads.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Shared by the thread that works and the one that watches; clones are the same progress.
#[derive(Debug, Clone, Default)]
pub struct Progress(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    done: AtomicUsize,
    /// One more than the index of the current item; 0: none of the requested items yet.
    item: AtomicUsize,
    of: AtomicUsize,
    cancelled: AtomicBool,
}

impl Progress {
    /// Starts over with `of` steps to do: none is done, and there is no current item. A request to stop stays.
    pub fn start(&self, of: usize) {
        self.0.done.store(0, Ordering::Relaxed);
        self.0.item.store(0, Ordering::Relaxed);
        self.0.of.store(of, Ordering::Relaxed);
    }

    /// Counts one more step as done.
    pub fn advance(&self) {
        self.0.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Sets the index of the item that is being worked on, of those that were asked for.
    pub fn turn_to(&self, item: usize) {
        self.0.item.store(item + 1, Ordering::Relaxed);
    }

    /// Returns the index of the current item; `None` while common work for all of them is done.
    pub fn item(&self) -> Option<usize> {
        self.0.item.load(Ordering::Relaxed).checked_sub(1)
    }

    /// Returns how many steps are done, and how many there are to do in all (0 before the start).
    pub fn steps(&self) -> (usize, usize) {
        (self.0.done.load(Ordering::Relaxed), self.0.of.load(Ordering::Relaxed))
    }

    /// Asks the work to stop soon and discard its result; it must look for that itself ([`Progress::is_cancelled`]).
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Returns whether the work was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }
}
