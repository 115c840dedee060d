//! The Explain tab: the step's purpose, its formula with this scene's numbers, the guided tours, and
//! what the frame left out and why.

use super::explain_facts::{Known, facts};
use super::state::State;
use super::theme;
use super::tour;
use egui::{Label, RichText, Ui};

/// Draws the tab.
pub fn ui(ui: &mut Ui, state: &mut State) {
    let Some(capture) = state.capture.clone() else {
        ui.add(Label::new(theme::note("Open a scene: what each pass is for is told here.")).wrap());
        return;
    };
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        if let Some(step) = capture.steps.get(state.step) {
            theme::heading(ui, &format!("{} · {}", state.step + 1, step.name));
            ui.add(Label::new(step.purpose.as_str()).wrap());
            ui.add_space(8.0);
        }
        let history = state.pick.and_then(|at| state.history.of_frame(at)).cloned();
        let known = Known {
            capture: &capture,
            step: state.step,
            lights: state.scene.as_ref().map_or(&[], |scene| &scene.draft.lights),
            pick: state.pick,
            history: history.as_deref(),
        };
        // Counting a picture is not free: it is done once for each step and pixel.
        let told = state.explained.of(&known);
        for fact in told.iter() {
            theme::card(ui).show(ui, |ui| {
                ui.set_width(ui.available_width());
                ui.add(Label::new(RichText::new(&fact.formula).color(theme::of(ui).text)).wrap());
                for line in &fact.here {
                    ui.add(Label::new(theme::note(line.as_str())).wrap());
                }
            });
            ui.add_space(4.0);
        }
        ui.add_space(8.0);
        tour::list(ui, state);
        ui.add_space(8.0);
        left_out(ui, &capture);
        ui.add_space(16.0);
    });
}

fn left_out(ui: &mut Ui, capture: &crate::capture::Capture) {
    theme::heading(ui, "Left out");
    if capture.left_out.is_empty() {
        ui.add(Label::new(theme::note("Nothing: this scene needs all that the technique has.")).wrap());
    }
    for left in &capture.left_out {
        ui.add(Label::new(left.to_string()).wrap());
        ui.add(Label::new(theme::note(left.because.as_str())).wrap());
    }
}

/// The facts that were told last, with what they were told of.
#[derive(Debug, Default)]
pub struct Explained {
    of: Option<Key>,
    facts: std::rc::Rc<Vec<super::explain_facts::Fact>>,
}

/// Facts change with these: frame, step, pixel, and whether its history is there.
type Key = (usize, usize, Option<[u32; 2]>, bool, bool);

impl Explained {
    fn of(&mut self, known: &Known) -> std::rc::Rc<Vec<super::explain_facts::Fact>> {
        let has_truth = known.capture.lights.iter().any(|light| light.truth.is_some());
        let frame = std::ptr::from_ref(known.capture) as usize;
        let key = (frame, known.step, known.pick, known.history.is_some(), has_truth);
        if self.of != Some(key) {
            self.of = Some(key);
            self.facts = std::rc::Rc::new(facts(known));
        }
        std::rc::Rc::clone(&self.facts)
    }

    /// Another frame is shown.
    pub fn forget(&mut self) {
        self.of = None;
    }
}
