//! How much memory a frame may take.

use super::GpuError;

/// Counts the bytes of GPU memory that a frame takes, against the most that it may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct MemoryBudget {
    most: u64,
    used: u64,
}

impl MemoryBudget {
    /// Returns a budget of `most` bytes, none of which are taken.
    pub fn of(most: u64) -> MemoryBudget {
        MemoryBudget { most, used: 0 }
    }

    /// Adds this many bytes to those in use; fails where the sum exceeds the budget. They count as used also after a
    /// failure.
    pub fn take(&mut self, bytes: u64) -> Result<(), GpuError> {
        self.used = self.used.saturating_add(bytes);
        if self.used <= self.most {
            return Ok(());
        }
        let [needed, most] = [self.used, self.most].map(|bytes| format!("{} MiB", bytes.div_ceil(1 << 20)));
        Err(GpuError::TooLarge { what: "the frame".to_owned(), needed: format!("at least {needed}"), most })
    }
}
