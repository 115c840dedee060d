//! How far long work has come, and the wish to stop it; shared between threads.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Shared by who works and who watches; clones are the same progress.
#[derive(Debug, Clone, Default)]
pub struct Progress(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    done: AtomicUsize,
    /// The index of what is worked on, and one more; 0: nothing of what was asked for.
    item: AtomicUsize,
    of: AtomicUsize,
    cancelled: AtomicBool,
}

impl Progress {
    /// Starts over with `of` steps to do.
    pub fn start(&self, of: usize) {
        self.0.done.store(0, Ordering::Relaxed);
        self.0.item.store(0, Ordering::Relaxed);
        self.0.of.store(of, Ordering::Relaxed);
    }

    /// One more step is done.
    pub fn advance(&self) {
        self.0.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Turns to one of the things that were asked for, by its index.
    pub fn turn_to(&self, item: usize) {
        self.0.item.store(item + 1, Ordering::Relaxed);
    }

    /// What was turned to last; `None` while what all of them need is made.
    pub fn item(&self) -> Option<usize> {
        self.0.item.load(Ordering::Relaxed).checked_sub(1)
    }

    /// Steps done, and how many there are.
    pub fn steps(&self) -> (usize, usize) {
        (self.0.done.load(Ordering::Relaxed), self.0.of.load(Ordering::Relaxed))
    }

    /// Asks the work to stop soon and give up its result.
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Was it asked to stop?
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }
}
