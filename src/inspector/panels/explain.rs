//! The Explain tab: the step's purpose, its formula with this scene's numbers, the guided tours, and
//! what the frame left out and why.

use crate::capture::Capture;
use crate::inspector::action::TourSubject;
use crate::inspector::look::{left_out, theme};
use crate::inspector::model::Model;
use crate::inspector::panels::pixel::map;
use crate::inspector::panels::tour_mark;
use crate::inspector::tours::TOURS;
use crate::reading::explain_facts::{ExplainContext, ExplainFact, facts};
use crate::reading::format;
use crate::reading::steps;
use egui::{Label, RichText, Ui};

/// Draws the tab Explain: the selected step's purpose and what it does, in sentences with this frame's numbers, and the
/// list of tours. Without a capture, only a hint to open a scene.
pub fn ui(ui: &mut Ui, own: &mut ExplainPanel, model: &mut Model) {
    let Some(capture) = model.frame.capture.clone() else {
        ui.add(Label::new(theme::note("Open a scene: what each pass is for is explained here.")).wrap());
        return;
    };
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        if let Some(step) = capture.steps.get(model.selection.step) {
            theme::heading(ui, &steps::title(&capture, model.selection.step));
            ui.add(Label::new(step.purpose.as_str()).wrap());
            ui.add_space(8.0);
        }
        let history = model.history_of_frame();
        let light = capture.steps.get(model.selection.step).and_then(|step| step.light).unwrap_or(0);
        let map = model.selection.pick.and_then(|at| map::decision(model, &capture, light, at));
        let known = ExplainContext {
            capture: &capture,
            step: model.selection.step,
            lights: model.scene.as_ref().map_or(&[], |scene| &scene.draft.lights),
            pick: model.selection.pick,
            history: history.as_deref(),
            map: map.as_ref(),
        };
        // Counting a picture takes time: it is done once for each step and pixel.
        let facts = own.of(model.frame.number, &known);
        tour_mark::about(ui, model, TourSubject::Formula, |ui, _| formulas(ui, &facts));
        ui.add_space(12.0);
        // During a tour another one is not what is looked for; the bar below leads on.
        if model.tour_focus.is_none() {
            tours(ui, model);
            ui.add_space(8.0);
        }
        tour_mark::about(ui, model, TourSubject::LeftOut, |ui, model| left_out(ui, model, &capture));
        ui.add_space(16.0);
    });
}

fn formulas(ui: &mut Ui, facts: &[ExplainFact]) {
    for fact in facts {
        theme::card(ui).show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.add(Label::new(RichText::new(&fact.formula).color(theme::of(ui).text)).wrap());
            for line in &fact.here {
                ui.add(Label::new(theme::note(line.as_str())).wrap());
            }
        });
    }
}

/// Draws what the frame left out and why; folded while a tour speaks of something else.
fn left_out(ui: &mut Ui, model: &Model, capture: &Capture) {
    if capture.origin.is_some() && capture.left_out.is_empty() {
        return;
    }
    if model.tour_focus.is_some_and(|focus| focus.subject != Some(TourSubject::LeftOut)) {
        let title = format!("Left out: {}", format::counted(capture.left_out.len() as u64, "thing"));
        egui::CollapsingHeader::new(theme::note(title))
            .id_salt("left out during a tour")
            .show(ui, |ui| left_out::ui(ui, &capture.left_out, RichText::new));
        return;
    }
    theme::heading(ui, "Left out");
    if capture.left_out.is_empty() {
        ui.add(Label::new(theme::note("Nothing: this scene needs all that the technique has.")).wrap());
    }
    left_out::ui(ui, &capture.left_out, RichText::new);
}

/// The state of the tab: the facts that were computed last, with their inputs.
#[derive(Debug, Default)]
pub struct ExplainPanel {
    of: Option<ExplainKey>,
    facts: std::rc::Rc<Vec<ExplainFact>>,
}

/// The inputs of the facts: frame, step, pixel, pixel of the history, whether there is a truth, and the light under
/// which a texel is known.
type ExplainKey = (u64, usize, Option<[u32; 2]>, Option<[u32; 2]>, (bool, Option<usize>));

impl ExplainPanel {
    fn of(&mut self, frame: u64, known: &ExplainContext) -> std::rc::Rc<Vec<ExplainFact>> {
        let has_truth = known.capture.lights.iter().any(|light| light.truth.is_some());
        let key = (
            frame,
            known.step,
            known.pick,
            known.history.map(|history| history.pixel),
            (has_truth, known.map.map(|map| map.light)),
        );
        if self.of != Some(key) {
            self.of = Some(key);
            self.facts = std::rc::Rc::new(facts(known));
        }
        std::rc::Rc::clone(&self.facts)
    }
}

/// Draws a button for each tour, the chosen technique's first; a click asks for that tour to begin.
fn tours(ui: &mut Ui, model: &mut Model) {
    theme::heading(ui, "Guided tours");
    ui.add(
        Label::new(theme::note("Each goes through a technique, stop by stop, and moves the panels for you.")).wrap(),
    );
    let current = model.scene.as_ref().map(|scene| scene.draft.choice.technique());
    let mut order: Vec<usize> = (0..TOURS.len()).collect();
    order.sort_by_key(|index| Some(TOURS[*index].technique) != current);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for index in order {
            let tour = &TOURS[index];
            let button = ui.button(format!("Tour of {}", tour.technique.name()));
            if button.on_hover_text(tour.promise).clicked() {
                model.requests.tour = Some(index);
            }
        }
    });
}
