//! The picked pixel: one sentence, then its values at the selected step, then its history.

pub mod coordinates;
pub mod history_rows;
pub mod ladder;
pub mod map;
pub mod other_answer;
pub mod picked;
pub mod rays;
pub mod row_budget;
pub mod run;
pub mod shading;
pub mod truth;
mod values;

use crate::accuracy::Finding;
use crate::capture::{Capture, CapturedLight};
use crate::history::Verdict;
use crate::inspector::action::TourSubject;
use crate::inspector::look::findings;
use crate::inspector::look::palette;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::panels::picture::error_legend;
use crate::inspector::panels::tour_mark;
use crate::inspector::tours::tour_of;
use crate::reading::format;
use crate::reading::map_decision::MapDecision;
use crate::reading::moment;
use crate::reading::picture_view::has_truth;
use crate::reading::shadow_casters;
use crate::technique::Technique;
use egui::{RichText, Ui};

use picked::PickedHistory;
pub use picked::PixelPanel;

/// Height of a row of values where vertical space is short, points.
const TIGHT_ROW: f32 = 18.0;

/// Draws the panel Pixel: why the picked pixel is lit or dark, its values, its label for each light, and its history.
/// Without a capture, or without a pick, a hint on what to do.
pub fn ui(ui: &mut Ui, own: &mut PixelPanel, model: &mut Model) {
    let Some(capture) = model.frame.capture.clone() else {
        ui.add(egui::Label::new(theme::note("Open a scene to look at its pixels.")).wrap());
        return;
    };
    let Some(at) = model.selection.pick else { return how_to_pick(ui, model) };
    let picked = own.picked_history(model);
    let size = ui.available_size();
    let is_tight = row_budget::is_tight(size);
    let gap = if is_tight { 4.0 } else { 8.0 };
    if is_tight {
        ui.spacing_mut().interact_size.y = TIGHT_ROW;
        ui.spacing_mut().item_spacing.y = 2.0;
    }
    let bottom = ui.cursor().top() + size.y;
    let light = model.light_in_question(&capture, at);
    let map = map::decision(model, &capture, light, at);
    let answer = |ui: &mut Ui, model: &mut Model| {
        other_answer::beside(ui, model, &capture, at, |ui, model| {
            tour_mark::about(ui, model, TourSubject::Answer, |ui, model| {
                sentence(ui, model, &picked, &capture, at, map.as_ref());
            });
        });
    };
    // The answer stays in view while what led to it is scrolled, where that leaves enough height for both.
    let is_pinned = row_budget::pins_answer(size);
    if is_pinned {
        answer(ui, model);
    }
    let mut area = egui::ScrollArea::vertical().auto_shrink([false, false]);
    // What a tour's stop has scrolled to is not what the next one is about.
    let subject = model.tour_focus.and_then(|focus| focus.subject);
    if std::mem::replace(&mut own.toured, subject) != subject {
        area = area.vertical_scroll_offset(0.0);
    }
    area.show(ui, |ui| {
        if !is_pinned {
            answer(ui, model);
        }
        let numbers = |ui: &mut Ui, own: &mut PixelPanel, model: &mut Model| {
            if !capture.lights.is_empty() {
                ui.add_space(gap);
                of_lights(ui, own, model, &capture, at, map.as_ref());
            }
            ui.add_space(gap);
            values::ui(ui, model, &capture, at, row_budget::values_in_row(size));
        };
        let details = |ui: &mut Ui, own: &mut PixelPanel, model: &mut Model| {
            shading::ui(ui, model, &capture, &picked);
            coordinates::ui(ui, own, model, &capture, at, &picked);
            ui.add_space(gap);
            run::ui(ui, model, &capture, at);
        };
        // What led to the answer comes before numbers that picture and status bar show as well.
        let has_steps = capture.decided_by(light).counts_volumes();
        if !has_steps {
            numbers(ui, own, model);
        }
        ui.add_space(gap);
        let events = picked.history.as_ref().map_or(0, |history| history.events.len());
        let rows = row_budget::rows(bottom - ui.cursor().top(), events, ladder::rungs(&picked, &capture, light));
        // The card of a selected event moves the ladder, and takes none of its height: else its rungs would fold under
        // the pointer.
        let end = tour_mark::about(ui, model, TourSubject::History, |ui, model| {
            history_rows::ui(ui, own, model, &picked, &capture, at, rows)
        });
        ui.add_space(gap);
        tour_mark::about(ui, model, TourSubject::Ladder, |ui, model| {
            ladder::ui(ui, own, model, &picked, &capture, light, bottom - end - gap);
        });
        if has_steps {
            numbers(ui, own, model);
        }
        ui.add_space(gap);
        details(ui, own, model);
    });
}

/// Draws every light with its label, its rays where they are unfolded, and the texel of its map that decided.
fn of_lights(
    ui: &mut Ui,
    own: &mut PixelPanel,
    model: &mut Model,
    capture: &Capture,
    at: [u32; 2],
    map: Option<&MapDecision>,
) {
    rays::heading(ui, &mut own.shows_rays, model, capture);
    lights(ui, capture, at);
    if own.shows_rays && model.scene.is_some() && capture.origin.is_none() {
        rays::ui(ui, model, capture, at);
    }
    if let Some(decision) = map {
        tour_mark::about(ui, model, TourSubject::Texel, |ui, model| map::ui(ui, model, capture, decision));
    }
}

/// Returns the tour to begin with: `auto` counts as z-pass does wherever it can, and the tour of z-pass explains
/// counting.
fn first_tour(technique: Technique) -> Technique {
    if technique == Technique::Auto { Technique::ZPass } else { technique }
}

/// Draws, while no pixel is picked, how to pick one, and an offer to take the tour for the chosen technique, where
/// there is one.
fn how_to_pick(ui: &mut Ui, model: &mut Model) {
    theme::heading(ui, "No pixel is picked.");
    let text = "Click a pixel of the picture, or drag with the right button: why it is dark or lit is said here. \
                Shift and the arrow keys move the pick, Esc takes it away.";
    ui.add(egui::Label::new(theme::note(text)).wrap());
    let is_touring = model.tour_focus.is_some();
    let current = model.scene.as_ref().filter(|_| !is_touring).map(|scene| scene.draft.choice.technique());
    let Some((index, tour)) = current.map(first_tour).and_then(tour_of) else { return };
    ui.add_space(12.0);
    theme::card(ui).show(ui, |ui| {
        ui.set_width(ui.available_width());
        theme::heading(ui, "New here?");
        let words = format!("{}: {} stops with {}.", tour.promise, tour.stops.len(), tour.technique.name());
        ui.add(egui::Label::new(theme::note(words)).wrap());
        ui.add_space(4.0);
        let hover = "Goes through the technique stop by stop, and moves the panels for you";
        if ui.button("Take the tour").on_hover_text(hover).clicked() {
            model.requests.tour = Some(index);
        }
    });
}

/// Draws the verdict on the picked pixel of the shown frame. Until its history is there, it says what the capture alone
/// does: a sentence about another pixel or frame must not stand beside these values. A history that contradicts the GPU
/// is not used.
fn sentence(
    ui: &mut Ui,
    model: &mut Model,
    picked: &PickedHistory,
    capture: &Capture,
    at: [u32; 2],
    map: Option<&MapDecision>,
) {
    let light = model.light_in_question(capture, at);
    // A history that contradicts the GPU explains nothing.
    let history = picked.history.as_ref().filter(|_| picked.is_of_pick && picked.wrong.is_empty());
    let verdict = Verdict::of(capture, light, at);
    let verdict = match history {
        Some(history) => verdict.with_history(history),
        None => verdict,
    };
    let verdict = match map {
        Some(decision) => verdict.with_texels(decision.light, || decision.sentence()),
        None => verdict,
    };
    let is_counted = capture.lights.get(light).is_some_and(|light| light.decided_by.counted_side().is_some());
    let whose = history.filter(|_| verdict.is_in_shadow());
    let mut whose = whose.map_or_else(Vec::new, |history| shadow_casters::casters(history, light, &capture.depth));
    let mut by_ray = None;
    // Maps, textures and rays leave no history of who stands between.
    if whose.is_empty()
        && !is_counted
        && verdict.is_in_shadow()
        && let Some((names, words)) = rays::casters(model, capture, light, at)
    {
        (whose, by_ray) = (names, Some(words));
    }
    if let Some([left, top, width, height]) = viewport_beside(model, at) {
        return outside(ui, &format!("{width}×{height} pixels from {left}, {top}"));
    }
    let title = moment::title(&verdict, capture, model.shown_point(), at);
    let finding = capture.finding_at(light, at);
    theme::card(ui).show(ui, |ui| {
        ui.set_width(ui.available_width());
        other_answer::own_name(ui, model, capture);
        if let Some(words) = shadow_casters::sentence(&whose, finding) {
            // Who and why comes first, the number that says so second.
            theme::heading(ui, &words);
            ui.add(egui::Label::new(title).wrap());
        } else {
            theme::heading(ui, &title);
        }
        // That it is wrong comes before why it is so.
        let is_wrong = finding.is_some_and(Finding::is_wrong);
        if is_wrong {
            truth::ui(ui, model, capture, light, at);
        }
        ui.add(egui::Label::new(theme::note(verdict.reason())).wrap());
        if let Some(words) = by_ray {
            ui.add(egui::Label::new(theme::note(words)).wrap());
        }
        if !is_wrong {
            truth::ui(ui, model, capture, light, at);
        }
    });
}

/// Returns the camera's viewport where it does not contain a pixel: left, top, width and height; `None` where it does.
fn viewport_beside(model: &Model, [x, y]: [u32; 2]) -> Option<[u32; 4]> {
    let scene = model.scene.as_ref().filter(|_| model.origin().is_none())?;
    let [left, top, width, height] = scene.draft.camera.viewport_in(model.frame.capture.as_ref()?.size);
    let is_in = (left..left + width).contains(&x) && (top..top + height).contains(&y);
    (!is_in).then_some([left, top, width, height])
}

/// Says that a pixel lies outside of the viewport, which is described by `what`.
fn outside(ui: &mut Ui, what: &str) {
    theme::card(ui).show(ui, |ui| {
        ui.set_width(ui.available_width());
        theme::heading(ui, "Outside the viewport.");
        let words = format!("The camera draws into {what} (Scene settings, Camera): here no pass draws anything.");
        ui.add(egui::Label::new(theme::note(words)).wrap());
    });
}

/// Draws every light with its label at the pixel in words; where the truth is known, also the true label and the
/// finding.
fn lights(ui: &mut Ui, capture: &Capture, at: [u32; 2]) {
    if has_truth(capture) {
        for (index, light) in capture.lights.iter().enumerate() {
            judged(ui, capture, index, light, at);
        }
        return;
    }
    egui::Grid::new("pixel lights").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (index, light) in capture.lights.iter().enumerate() {
            ui.label(theme::note(format::light(index)));
            let label = light.shadow.as_ref().and_then(|mask| mask.byte_at(at));
            ui.horizontal(|ui| label_words(ui, label, "no mask"));
            ui.end_row();
        }
    });
}

fn label_words(ui: &mut Ui, label: Option<u8>, without: &str) {
    match label.and_then(|label| palette::LABELS.get(usize::from(label))) {
        Some(label) => {
            theme::swatch(ui, label.color);
            ui.label(RichText::new(label.name).color(theme::of(ui).text)).on_hover_text(label.meaning);
        }
        None => {
            ui.label(theme::note(without));
        }
    }
}

/// What a label takes besides its words, at most: a swatch and the space between all, points.
const BESIDE_LABEL: f32 = 32.0;

/// Draws a light's label beside the truth's, and below them the finding that follows, if there is one.
fn judged(ui: &mut Ui, capture: &Capture, index: usize, light: &CapturedLight, at: [u32; 2]) {
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::note(format::light(index)));
        ui.add_space(4.0);
        ui.label(theme::note(capture.technique.as_str()));
        label_words(ui, light.shadow.as_ref().and_then(|mask| mask.byte_at(at)), "no mask");
        ui.add_space(4.0);
        let label = light.truth.as_ref().and_then(|truth| truth.labels.byte_at(at));
        // What belongs together stands in one row.
        let words =
            label.and_then(|label| palette::LABELS.get(usize::from(label))).map_or("unknown", |label| label.name);
        let font = egui::TextStyle::Body.resolve(ui.style());
        let width = ui.painter().layout_no_wrap(format!("truth {words}"), font, theme::of(ui).text).size().x;
        if ui.available_size_before_wrap().x < width + BESIDE_LABEL {
            ui.end_row();
        }
        ui.label(theme::note("truth"));
        label_words(ui, label, "unknown");
    });
    if let Some(finding) = capture.finding_at(index, at) {
        let style = findings::style(finding);
        ui.horizontal(|ui| {
            error_legend::hatched(ui, style);
            ui.add(egui::Label::new(RichText::new(style.meaning).color(theme::of(ui).text)).wrap());
        });
    }
    ui.add_space(4.0);
}
