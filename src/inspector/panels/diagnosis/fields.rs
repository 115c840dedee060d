//! The state of the Diagnosis tab.

use crate::diagnosis::Diagnosis;
use crate::technique::Choice;
use std::sync::Arc;

/// A fix that was applied from the tab: technique and settings before it and with it.
#[derive(Debug, Clone, PartialEq)]
pub struct AppliedFix {
    /// Without the fix.
    pub before: Choice,
    /// With it.
    pub after: Choice,
}

/// The state of the tab Diagnosis: the selected region, the applied fix, and the diagnosis that they belong to.
#[derive(Debug, Default)]
pub struct DiagnosisPanel {
    /// Index of the selected region.
    pub selected: usize,
    /// The fix that was applied last.
    pub applied: Option<AppliedFix>,
    of: Option<Arc<Diagnosis>>,
}

impl DiagnosisPanel {
    /// Clears the selected region and the applied fix where the diagnosis is another one than before, by content.
    pub fn follow(&mut self, diagnosis: &Arc<Diagnosis>) {
        let is_shown = |of: &Arc<Diagnosis>| Arc::ptr_eq(of, diagnosis) || of == diagnosis;
        if !self.of.as_ref().is_some_and(is_shown) {
            *self = DiagnosisPanel::default();
        }
        self.of = Some(Arc::clone(diagnosis));
    }
}
