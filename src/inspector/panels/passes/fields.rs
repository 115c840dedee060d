//! What the panel remembers.

use crate::inspector::model::StepSearch;
use egui::Id;

/// The panel.
#[derive(Debug, Default)]
pub struct Passes {
    /// The search field, while it is open.
    pub search: Option<StepSearch>,
    /// It has just been opened.
    pub search_wants_focus: bool,
    /// The step of which all draws are listed, however many.
    pub all_draws: Option<usize>,
    /// Its widgets: they leave the stepping keys alone.
    pub widgets: Vec<Id>,
}
