//! The state of the Passes tab.

use crate::inspector::model::StepSearch;
use std::collections::BTreeSet;

/// The state of the panel Passes: search, folded groups, and the step whose draws are all listed.
#[derive(Debug, Default)]
pub struct PassesPanel {
    /// The search field, while it is open.
    pub search: Option<StepSearch>,
    /// The search field has just been opened.
    pub search_wants_focus: bool,
    /// The step whose draws are all listed, however many.
    pub all_draws: Option<usize>,
    /// Debug groups whose passes are hidden: index of the first of their passes, and depth of the group.
    pub folded: BTreeSet<[usize; 2]>,
    /// Height that the list had in the last frame, points: in another one, the selected row is scrolled to.
    pub height: f32,
    /// The scene to which `folded` belongs, as the number of scenes opened.
    pub folded_of: u64,
}
