//! What the other side of a comparison answers for the picked pixel, beside the answer of the shown one.

use super::truth;
use crate::capture::Capture;
use crate::history::Verdict;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::model::comparing::{Comparison, ONCE_WHOLE};
use crate::inspector::panels::picture::compared;
use crate::reading::moment;
use egui::{Label, Ui};
use std::sync::Arc;

/// Returns the comparison where it is with another frame.
fn with_another_frame(model: &Model) -> Option<Comparison> {
    model.modes.compare.filter(|compare| compare.with.is_of_another_frame())
}

/// Draws, while two frames are compared, whose answer follows: the shown one's.
pub fn own_name(ui: &mut Ui, model: &Model, capture: &Capture) {
    if let Some(compare) = with_another_frame(model) {
        let [_, now] = compared::names(model, capture, &compare);
        ui.add(Label::new(theme::note(now)).wrap());
    }
}

/// Draws with `own` the answer of the shown frame, and, while two frames are compared, the other's: in the order in which
/// both pictures stand, and under them whose values follow.
pub fn beside(
    ui: &mut Ui,
    model: &mut Model,
    capture: &Arc<Capture>,
    at: [u32; 2],
    own: impl FnOnce(&mut Ui, &mut Model),
) {
    let Some(compare) = with_another_frame(model) else { return own(ui, model) };
    let names = compared::names(model, capture, &compare);
    if !compare.flipped {
        other(ui, model, capture, at, &names[0]);
    }
    own(ui, model);
    if compare.flipped {
        other(ui, model, capture, at, &names[0]);
    }
    let [technique, side] = [&capture.technique, &names[1]];
    let whose = if side == technique { side.clone() } else { format!("{technique}, {side}") };
    ui.add(Label::new(theme::note(format!("Below: the values of {whose}"))).wrap());
}

/// Draws the compared frame's name and its answer for the picked pixel of the same light, or why there is none yet.
fn other(ui: &mut Ui, model: &Model, capture: &Arc<Capture>, at: [u32; 2], name: &str) {
    let frame = model.compared_frame(capture);
    theme::card(ui).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.add(Label::new(theme::note(name)).wrap());
        match frame {
            Ok(frame) if !model.frame.is_preview => {
                let light = model.light_in_question(capture, at);
                let verdict = Verdict::of(&frame.capture, light, at);
                let point = model.compared_point(capture, &frame.capture).point;
                theme::heading(ui, &moment::title(&verdict, &frame.capture, point, at));
                ui.add(Label::new(theme::note(verdict.reason())).wrap());
                let _ = truth::of_frame(ui, &frame.capture, light, at);
            }
            Ok(_) => drop(ui.label(theme::note(ONCE_WHOLE))),
            Err(reason) => drop(ui.add(Label::new(theme::note(reason)).wrap())),
        }
    });
}
