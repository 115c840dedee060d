//! Step controls: back, forward, play, draw by draw, a scrubber, and the search fields of Ctrl-G and Ctrl-F.

use super::fields::PassesPanel;
use crate::capture::Capture;
use crate::inspector::look::theme;
use crate::inspector::model::{Model, StepSearch};
use crate::reading::format;
use crate::reading::steps;
use egui::{Key, Ui, vec2};

/// Width of a panel from which on all controls stand in one row, points.
const ONE_ROW_FROM: f32 = 320.0;

/// Draws the controls above the passes: buttons for steps, playing and draws, the selected step's number, and the
/// search field while it is open. Draws nothing without a capture.
pub fn ui(ui: &mut Ui, own: &mut PassesPanel, model: &mut Model) {
    let Some(capture) = model.frame.capture.clone() else { return };
    let count = model.steps();
    let is_wide = ui.available_width() >= ONE_ROW_FROM;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let [before, after] = model.neighbours();
        let back = ui.add_enabled(before.is_some(), egui::Button::new(symbol("◀")));
        let back = back.accessible_name("Previous step").on_hover_text("Previous step (left arrow)");
        let back = back.on_disabled_hover_text("This is the first step");
        let forth = ui.add_enabled(after.is_some(), egui::Button::new(symbol("▶")));
        let forth = forth.accessible_name("Next step").on_hover_text("Next step (right arrow)");
        let forth = forth.on_disabled_hover_text("This is the last step");
        let (sign, word) = if model.selection.playing.is_some() { ("■", "Pause") } else { ("▷", "Play") };
        let play = ui.add_enabled(count > 1, egui::Button::new((symbol(sign), word)));
        let play = play.accessible_name(word).on_hover_text("Step through the frame (Space)");
        let play = play.on_disabled_hover_text("The frame has no second step");
        if back.clicked() {
            model.step_by(-1);
        }
        if forth.clicked() {
            model.step_by(1);
        }
        if play.clicked() {
            model.toggle_play(ui.input(|input| input.time));
        }
        let words = match steps::number(&capture, model.selection.step) {
            Some(number) => format!("step {number} of {count}"),
            None => "beside the frame".to_owned(),
        };
        if is_wide {
            draw_buttons(ui, model, &capture);
            at_the_right(ui, format!("{words}, {}", draw_words(model, &capture)));
        } else {
            at_the_right(ui, words);
        }
    });
    if !is_wide {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            draw_buttons(ui, model, &capture);
            at_the_right(ui, draw_words(model, &capture));
        });
    }
    if count > 1 {
        scrubber(ui, model, &capture);
    }
    search(ui, own, model);
}

/// Draws the buttons that go to the previous and next draw through the whole frame.
fn draw_buttons(ui: &mut Ui, model: &mut Model, capture: &Capture) {
    let at = model.selected();
    let back = ui.add_enabled(at.previous(capture).is_some(), egui::Button::new(symbol("▲")));
    let back = back.accessible_name("Previous draw").on_hover_text("Previous draw (up arrow)");
    let back = back.on_disabled_hover_text("No draw comes before");
    let forth = ui.add_enabled(at.next(capture).is_some(), egui::Button::new(symbol("▼")));
    let forth = forth.accessible_name("Next draw").on_hover_text("Next draw (down arrow)");
    let forth = forth.on_disabled_hover_text("No draw comes after");
    if back.clicked() {
        model.draw_by(-1);
    }
    if forth.clicked() {
        model.draw_by(1);
    }
}

/// Returns the selected draw's number, or how many draws the selected step has.
fn draw_words(model: &Model, capture: &Capture) -> String {
    let at = model.selected();
    let draws = capture.steps.get(at.step).map_or(0, |step| step.draws.len());
    match at.draw {
        Some(draw) => format!("draw {} of {draws}", draw + 1),
        None if draws == 0 => "it draws nothing".to_owned(),
        None => format!("after its {}", format::counted(draws as u64, "draw")),
    }
}

/// Draws words at the right end of a row, cut off with an ellipsis where they do not fit.
fn at_the_right(ui: &mut Ui, words: String) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        ui.add(egui::Label::new(theme::note(words)).truncate());
    });
}

/// Returns a symbol in the monospaced face, the only one that has it.
fn symbol(text: &str) -> egui::RichText {
    theme::number(text)
}

fn scrubber(ui: &mut Ui, model: &mut Model, capture: &Capture) {
    ui.spacing_mut().slider_width = ui.available_width();
    // A mask lies between two numbered steps.
    let reached = steps::numbered(capture).take_while(|step| *step <= model.selection.step).count();
    let mut number = reached.max(1);
    let slider = egui::Slider::new(&mut number, 1..=steps::count(capture)).show_value(false).trailing_fill(true);
    let response = ui.add(slider).accessible_name("Step scrubber");
    if response.changed() {
        model.selection.playing = None;
        model.select_step(steps::of_number(capture, number));
    }
}

/// Draws the search field while it is open. Enter goes to the step with that number (Ctrl-G), or to the first pass that
/// contains the words (Ctrl-F); Escape closes it.
fn search(ui: &mut Ui, own: &mut PassesPanel, model: &mut Model) {
    let Some(mut search) = own.search.take() else { return };
    let (text, name, hint) = match &mut search {
        StepSearch::GoTo(text) => (text, "Go to step", "step number"),
        StepSearch::Find(text) => (text, "Find a pass", "name, light or caster"),
    };
    let field = egui::TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY).min_size(vec2(0.0, 22.0));
    let field = field.align(egui::Align2::LEFT_CENTER);
    let field = ui.add(field).accessible_name(name);
    if own.search_wants_focus {
        field.request_focus();
        own.search_wants_focus = false;
    }
    let (entered, escaped) = ui.input(|input| (input.key_pressed(Key::Enter), input.key_pressed(Key::Escape)));
    if field.lost_focus() && entered {
        go(model, &search);
    } else if !(field.lost_focus() && escaped) {
        // A filter stays while it has words; an empty field closes when it loses the focus.
        let stays = field.has_focus() || matches!(&search, StepSearch::Find(words) if !words.is_empty());
        own.search = (stays || field.gained_focus() || !field.lost_focus()).then_some(search);
    }
}

fn go(model: &mut Model, search: &StepSearch) {
    match search {
        StepSearch::GoTo(text) => {
            if let Ok(number) = text.trim().parse::<usize>() {
                let Some(capture) = model.frame.capture.clone() else { return };
                model.select_step(steps::of_number(&capture, number));
            }
        }
        StepSearch::Find(words) => {
            let Some(capture) = model.frame.capture.clone() else { return };
            let found = capture.steps.iter().position(|step| matches(step, words));
            if let Some(index) = found {
                model.select_step(index);
            }
        }
    }
}

/// Returns whether a pass contains all words, each anywhere in its name, its light (`scene` without one), or the names
/// and parts of its draws; upper and lower case are the same. True for no words.
pub fn matches(step: &crate::capture::Step, words: &str) -> bool {
    let light = step.light.map_or_else(|| "scene".to_owned(), format::light);
    let draws = step.draws.iter().flat_map(|draw| [draw.name.as_str(), draw.part.name()]);
    let text =
        [step.name.as_str(), light.as_str()].into_iter().chain(draws).collect::<Vec<_>>().join(" ").to_lowercase();
    words.to_lowercase().split_whitespace().all(|word| text.contains(word))
}
