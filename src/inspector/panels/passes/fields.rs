//! What the panel remembers.

use crate::inspector::model::StepSearch;
use std::collections::BTreeSet;

/// The panel.
#[derive(Debug, Default)]
pub struct PassesPanel {
    /// The search field, while it is open.
    pub search: Option<StepSearch>,
    /// It has just been opened.
    pub search_wants_focus: bool,
    /// The step of which all draws are listed, however many.
    pub all_draws: Option<usize>,
    /// Debug groups whose passes are hidden: the first of their passes, and how deep they are.
    pub folded: BTreeSet<[usize; 2]>,
    /// Which frame that is of, by how many scenes were opened.
    pub folded_of: u64,
}
