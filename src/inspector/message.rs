//! An error with its mend, above the panels, until it is dismissed. The last picture stays.

use super::{State, theme};
use egui::{RichText, Ui};

pub(super) fn ui(ui: &mut Ui, state: &mut State) {
    let Some(notice) = &state.notice else { return };
    let mut dismissed = false;
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("✗").color(theme::FAILED));
        ui.label(RichText::new(&notice.text).color(theme::TEXT));
        dismissed = ui.button("Dismiss").clicked();
    });
    if dismissed {
        state.notice = None;
    }
}
