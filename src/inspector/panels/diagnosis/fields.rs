//! What the tab remembers.

use crate::diagnosis::Diagnosis;
use crate::technique::Choice;
use std::sync::Arc;

/// A mend that was applied from the tab: how shadows were made before, and are after.
#[derive(Debug, Clone, PartialEq)]
pub struct AppliedFix {
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
    pub applied: Option<AppliedFix>,
    of: Option<Arc<Diagnosis>>,
}

impl DiagnosisPanel {
    /// Of a diagnosis that says something else nothing is selected.
    pub fn follow(&mut self, diagnosis: &Arc<Diagnosis>) {
        let is_shown = |of: &Arc<Diagnosis>| Arc::ptr_eq(of, diagnosis) || of == diagnosis;
        if !self.of.as_ref().is_some_and(is_shown) {
            *self = DiagnosisPanel::default();
        }
        self.of = Some(Arc::clone(diagnosis));
    }
}
