//! The list of what a frame left out, by reason.

use super::theme;
use crate::plan::LeftOut;
use crate::reading::left_out::by_reason;
use egui::{CollapsingHeader, Label, RichText, Ui};

/// How many things that were left out for one reason are listed before the others are folded away.
const MOST_TITLES: usize = 4;

/// Draws each reason under what was left out for it, in the words that `style` makes of a title. Long lists are folded.
pub fn ui(ui: &mut Ui, left_out: &[LeftOut], style: impl Fn(String) -> RichText) {
    for (because, titles) in by_reason(left_out) {
        // One that is left over takes no more space than a line that says so.
        let shown = if titles.len() > MOST_TITLES + 1 { MOST_TITLES } else { titles.len() };
        let mut titles = titles.into_iter();
        for title in titles.by_ref().take(shown) {
            ui.add(Label::new(style(title)).wrap());
        }
        if titles.len() > 0 {
            let more = RichText::new(format!("{} more for this reason", titles.len())).size(theme::SMALL_SIZE);
            CollapsingHeader::new(more).id_salt(("left out", because)).show(ui, |ui| {
                for title in titles {
                    ui.add(Label::new(style(title)).wrap());
                }
            });
        }
        ui.add(Label::new(theme::note(because).color(theme::of(ui).faint)).wrap());
        ui.add_space(4.0);
    }
}
