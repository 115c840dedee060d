//! The list of what a frame left out, by reason.

use super::theme;
use crate::plan::LeftOut;
use crate::reading::left_out::{LeftOutThing, by_reason};
use egui::{CollapsingHeader, Label, RichText, Ui};

/// How many things that were left out for one reason are listed before the others are folded away.
const MOST_TITLES: usize = 4;

/// Draws each reason under what was left out for it, in the words that `style` makes of a title; what each object has of a
/// sum is said where the pointer rests. Long lists are folded.
pub fn ui(ui: &mut Ui, left_out: &[LeftOut], style: impl Fn(String) -> RichText) {
    for reason in by_reason(left_out) {
        let because = reason.because;
        // One that is left over takes no more space than a line that says so.
        let count = reason.things.len();
        let shown = if count > MOST_TITLES + 1 { MOST_TITLES } else { count };
        let mut things = reason.things.into_iter();
        let one = |ui: &mut Ui, LeftOutThing { title, each }: LeftOutThing| {
            let line = ui.add(Label::new(style(title)).wrap());
            if !each.is_empty() {
                line.on_hover_text(each.join("\n"));
            }
        };
        things.by_ref().take(shown).for_each(|thing| one(ui, thing));
        if things.len() > 0 {
            let more = RichText::new(format!("{} more for this reason", things.len())).size(theme::SMALL_SIZE);
            CollapsingHeader::new(more)
                .id_salt(("left out", because))
                .show(ui, |ui| things.for_each(|thing| one(ui, thing)));
        }
        ui.add(Label::new(theme::note(because).color(theme::of(ui).faint)).wrap());
        ui.add_space(4.0);
    }
}
