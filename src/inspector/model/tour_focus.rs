//! What the stop of the running tour speaks of: panels frame it, and leave out what would draw attention from it.

use crate::inspector::action::TourSubject;

/// What the stop of the running tour draws attention to.
#[derive(Debug, Clone, Copy, Default)]
pub struct TourFocus {
    /// The part of a panel that its text speaks of.
    pub subject: Option<TourSubject>,
    /// In so many frames more that part is scrolled into view, if it is not.
    pub scrolls: u8,
    /// Name of the caster whose volume alone the view of the scene shows; `None`: those that the user chose.
    pub volume_of: Option<&'static str>,
}
