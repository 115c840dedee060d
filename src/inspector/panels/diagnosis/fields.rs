//! What the tab remembers.

use crate::diagnosis::Diagnosis;
use crate::technique::Choice;
use std::sync::{Arc, Weak};

/// A mend that was applied from the tab: how shadows were made before, and are after.
#[derive(Debug, Clone, PartialEq)]
pub struct Applied {
    /// Without the mend.
    pub before: Choice,
    /// With it.
    pub after: Choice,
}

/// The tab: what is selected in a diagnosis.
#[derive(Debug, Default)]
pub struct DiagnosisPanel {
    /// Index of the selected region.
    pub selected: usize,
    /// The mend that was applied last.
    pub applied: Option<Applied>,
    of: Weak<Diagnosis>,
}

impl DiagnosisPanel {
    /// Of another diagnosis nothing is selected.
    pub fn follow(&mut self, diagnosis: &Arc<Diagnosis>) {
        if !std::ptr::eq(self.of.as_ptr(), Arc::as_ptr(diagnosis)) {
            *self = DiagnosisPanel { of: Arc::downgrade(diagnosis), ..DiagnosisPanel::default() };
        }
    }
}
