//! What the stop of the running tour speaks of: panels frame it, and leave out what would draw attention from it.

use crate::inspector::action::TourSubject;

/// What the stop of the running tour draws attention to.
#[derive(Debug, Clone, Copy, Default)]
pub struct TourFocus {
    /// The part of a panel that its text speaks of.
    pub subject: Option<TourSubject>,
    /// That part is to be scrolled into view.
    pub wants_scroll: bool,
    /// Name of the caster whose volume alone the view of the scene shows; `None`: those that the user chose.
    pub volume_of: Option<&'static str>,
}
