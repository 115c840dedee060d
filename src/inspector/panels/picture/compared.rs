//! The picture that the shown one is compared with: its name, how many texels differ, and both pictures side by side.

use super::{PicturePanel, legend, overlays};
use crate::capture::Capture;
use crate::history::Verdict;
use crate::inspector::canvas::magnifier::{self, Occupied};
use crate::inspector::canvas::{self, Canvas};
use crate::inspector::look::coloring::{ColorMapping, Coloring};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::model::comparing::{ComparedWith, Comparison, FrameBeside, sentence};
use crate::inspector::model::selection::Hover;
use crate::inspector::panels::pixel::light_in_question;
use crate::reading::both_sides::{self, Counterpart};
use crate::reading::capture_point::CapturePoint;
use crate::reading::change::ChangeCache;
use crate::reading::format;
use crate::reading::moment;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use egui::{Label, Rect, RichText, Stroke, Ui, UiBuilder, vec2};
use std::sync::Arc;

/// Width of the note on how many texels differ, points.
const NOTE_WIDTH: f32 = 232.0;
/// Height of a picture's name above it, and of what is said of the picked pixel in it, points.
const NAME_HEIGHT: f32 = 24.0;
const VERDICT_HEIGHT: f32 = 20.0;
/// Kinds of picture whose legends count texels: each of two pictures side by side has its own.
const LEGENDS: [PictureKind; 4] = [PictureKind::Stencil, PictureKind::Count, PictureKind::Mask, PictureKind::Truth];
/// In a narrower half there is only space for the name, points.
const ASIDE_FROM: f32 = 260.0;
/// Name of the canvas of the picture that the shown one is compared with.
const COMPARED: &str = "Compared canvas";

/// Returns the names of the two sides of a comparison: first the compared picture's, then the shown one's; steps by
/// their words, techniques by their names, settings by their values.
pub fn names(model: &Model, capture: &Capture, compare: &Comparison) -> [String; 2] {
    let now = match compare.with {
        ComparedWith::Step(_) => model.shown_point().words(capture),
        ComparedWith::Technique(_) => capture.technique.clone(),
        ComparedWith::Setting { key, .. } => match capture.settings.get(key) {
            Some(value) => format!("{key} {value}"),
            None => capture.technique.clone(),
        },
        ComparedWith::Defaults => "as it is set".to_owned(),
        ComparedWith::Fixed { .. } => "as it was drawn".to_owned(),
    };
    [compare.with.words(capture), now]
}

/// Returns how the compared picture is coloured beside one of this mapping: in the same bit or range.
pub fn coloring_beside(other: &ShownPicture, ColorMapping { coloring, range }: ColorMapping) -> Coloring {
    match coloring {
        Coloring::Bit(_) => coloring,
        _ => Coloring::of_shown(other, range),
    }
}

/// Returns what stands below each picture of a comparison in a file, first the compared one's: its technique with what is
/// set of it, which picture after which step it is, the pass's name, and the scene's time where something moves.
pub fn captions(
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
    other: &FrameBeside,
    beside: &ShownPicture,
) -> [String; 2] {
    let frames = [Arc::clone(&other.capture), Arc::clone(capture)];
    let names = both_sides::names(&frames);
    let words = |side: usize, title: &str, point: CapturePoint, time: Option<f64>| {
        let step = frames[side].steps.get(point.step);
        let pass = step.map_or_else(String::new, |step| format!(" ({})", step.name));
        let time = time.map_or_else(String::new, |time| format!(" · {}", format::time(time)));
        format!("{} · {title}{pass}{time}", names[side])
    };
    let point = model.compared_point(capture, &other.capture).point;
    [words(0, &beside.title, point, other.time), words(1, &shown.title, model.shown_point(), model.frame.time)]
}

/// Returns the names of the two sides with the moment that each shows: the step or draw, what the compared side lacks of the
/// shown one's, and the scene's time where something moves; first the compared side's, without a moment while there is no
/// picture of it.
pub fn names_with_moment(
    model: &Model,
    capture: &Capture,
    compare: &Comparison,
    other: Option<&FrameBeside>,
) -> [String; 2] {
    let [other_name, now_name] = names(model, capture, compare);
    let at = |time: Option<f64>| time.map_or_else(String::new, |time| format!(" · {}", format::time(time)));
    let now = model.shown_point();
    let now_name = match compare.with.is_of_another_frame() {
        true => format!("{now_name} · {}{}", now.words(capture), at(model.frame.time)),
        false => now_name,
    };
    let Some(FrameBeside { capture: of, time, is_behind }) = other.filter(|_| compare.with.is_of_another_frame())
    else {
        return [other_name, now_name];
    };
    let Counterpart { point, lacks } = model.compared_point(capture, of);
    let lacks = lacks.map_or_else(String::new, |lacks| format!(" ({lacks})"));
    let behind = if *is_behind && time.is_none() { " · as it was before" } else { "" };
    [format!("{other_name} · {}{lacks}{}{behind}", point.words(of), at(*time)), now_name]
}

/// Draws the compared picture into one half of `rect`, and over both halves what they show and what each says of the picked
/// pixel; returns the rest of the other half, for the shown picture. Both halves show the same part, and a pick in one is
/// that of the other. Until there is a picture to compare with, its half says why.
pub fn beside(
    ui: &mut Ui,
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    rect: Rect,
    shown: &ShownPicture,
    compare: &Comparison,
) -> Rect {
    let (first, second) = halves(rect);
    let [now_half, other_half] = if compare.flipped { [first, second] } else { [second, first] };
    let other = model.compared_frame(capture).ok();
    let [other_name, now_name] = names_with_moment(model, capture, compare, other.as_ref());
    let differ = difference(&mut own.changes, model, capture, shown);
    let aside = differ.as_ref().map_or("", String::as_str);
    let verdict = |of: Option<(&Arc<Capture>, CapturePoint)>| verdict(model, of, capture, shown.kind);
    let now_place = head(ui, now_half, [&now_name, ""], verdict(Some((capture, model.shown_point()))));
    let other_at = other.as_ref().map(|other| (&other.capture, model.compared_point(capture, &other.capture).point));
    let other_place = head(ui, other_half, [&other_name, aside], verdict(other_at));
    match model.shown_compared(capture, shown) {
        Ok(other) => {
            let coloring = coloring_beside(&other, model.shown_coloring(shown));
            let canvas = Canvas {
                name: COMPARED,
                view: &mut model.view,
                pick: model.selection.pick_of(shown.kind),
                textures: &mut model.textures,
                has_arrows: false,
            };
            let (placement, hover) = canvas::ui(ui, canvas, other_place, &other, coloring, &[]);
            model.selection.hover = hover.map(|at| Hover { image: 0, at });
            if shown.kind != PictureKind::Map {
                let is_of_one_frame = !compare.with.is_of_another_frame();
                overlays::over_compared(ui, &mut own.overlays, model, other_place, placement, is_of_one_frame);
            }
            let mut occupied = Occupied::default();
            if LEGENDS.contains(&shown.kind) {
                // Its counts are those of its own picture.
                let range = model.shown_coloring(&other).range;
                let legend = |ui: &mut Ui| {
                    legend::ui(ui, &mut own.counts_findings, model, other_place, &other, range, &Occupied::default())
                };
                occupied.kept.extend(ui.push_id("legend of the compared picture", legend).inner);
            }
            if let Some(pick) = *model.selection.pick_of(shown.kind) {
                magnifier::ui(ui, pick, other_place, &other, coloring, placement, &occupied);
            }
        }
        Err(reason) => {
            canvas::background(ui, other_place, None);
            let size = vec2((other_place.width() - 32.0).clamp(1.0, NOTE_WIDTH), VERDICT_HEIGHT);
            let text = Label::new(theme::note(reason)).wrap().halign(egui::Align::Center);
            ui.put(Rect::from_center_size(other_place.center(), size), text);
        }
    }
    let line = Stroke::new(1.0, theme::of(ui).line);
    if first.top() == second.top() {
        ui.painter().vline(second.left(), rect.y_range(), line);
    } else {
        ui.painter().hline(rect.x_range(), second.top(), line);
    }
    now_place
}

/// What is said in place of what a preview does not tell.
const ONCE_WHOLE: &str = "known once the frame is whole";

/// Returns the halves of a panel: left and right, or, where it is higher than wide, top and bottom.
fn halves(rect: Rect) -> (Rect, Rect) {
    let middle = rect.center();
    if rect.width() >= rect.height() {
        (rect.with_max_x(middle.x), rect.with_min_x(middle.x))
    } else {
        (rect.with_max_y(middle.y), rect.with_min_y(middle.y))
    }
}

/// Returns why the picked pixel is dark or lit in the picture of a capture, as it is read beside the stencil at a point of it,
/// once that is known; `None` where no pixel is picked, or a map is shown. The light is the one that is spoken of in `shown`,
/// the capture that is shown.
fn verdict(
    model: &Model,
    of: Option<(&Arc<Capture>, CapturePoint)>,
    shown: &Capture,
    kind: PictureKind,
) -> Option<String> {
    let at = model.selection.pick.filter(|_| kind != PictureKind::Map)?;
    if model.frame.is_preview {
        return Some(ONCE_WHOLE.to_owned());
    }
    let title = |(of, point): (&Arc<Capture>, CapturePoint)| {
        moment::title(&Verdict::of(of, light_in_question(model, shown, at), at), of, point, at)
    };
    let said = of.map(title);
    Some(said.unwrap_or_else(|| "not known yet".to_owned()))
}

/// Draws over one half the name of what it shows, at its right end what else there is to say where there is space, and the
/// verdict on the picked pixel; returns the rest of the half.
fn head(ui: &mut Ui, half: Rect, [name, aside]: [&str; 2], verdict: Option<String>) -> Rect {
    let height = NAME_HEIGHT + if verdict.is_some() { VERDICT_HEIGHT } else { 0.0 };
    let place = half.with_max_y((half.top() + height).min(half.bottom()));
    ui.painter().rect_filled(place, 0, theme::of(ui).panel);
    let inner = place.shrink2(vec2(8.0, 2.0));
    ui.scope_builder(UiBuilder::new().max_rect(inner).id_salt(("compared", name)), |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let row = vec2(inner.width(), NAME_HEIGHT - 4.0);
        ui.allocate_ui_with_layout(row, egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if !aside.is_empty() && inner.width() >= ASIDE_FROM {
                ui.label(theme::note(aside));
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.add(Label::new(RichText::new(name).color(theme::of(ui).text)).truncate());
            });
        });
        if let Some(verdict) = verdict {
            ui.add(Label::new(theme::note(verdict)).truncate());
        }
    });
    half.with_min_y(place.bottom())
}

/// Returns how many texels differ between the compared pictures.
///
/// # Errors
/// They can't be compared, or not yet: why, in a sentence.
fn difference(
    changes: &mut ChangeCache,
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
) -> Result<String, String> {
    if model.frame.is_preview {
        return Err(ONCE_WHOLE.to_owned());
    }
    let other = model.shown_compared(capture, shown)?;
    if !model.is_of_one_moment(&model.compared_frame(capture)?) {
        return Err("counted once both are of one moment".to_owned());
    }
    let [width, height] = shown.images[0].size().map(u64::from);
    let texels = changes.differing([&other.images[0], &shown.images[0]]);
    Ok(sentence(texels, width * height))
}

/// Draws in the upper left corner of `rect` how many texels differ between the compared pictures, or why they can't be
/// compared; nothing while nothing is compared.
pub fn note(
    ui: &mut Ui,
    changes: &mut ChangeCache,
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
    rect: Rect,
) {
    if model.modes.compare.is_none() {
        return;
    }
    let text = difference(changes, model, capture, shown).unwrap_or_else(|reason| reason);
    card(ui, rect, &text);
}

/// Draws a card with a note in the upper left corner of `rect`.
pub fn card(ui: &mut Ui, rect: Rect, text: &str) {
    let size = vec2(NOTE_WIDTH.min(rect.width() / 2.0), rect.height());
    let place = Rect::from_min_size(rect.min + vec2(12.0, 12.0), size);
    ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("note in the corner"), |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.add(Label::new(theme::note(text)).wrap());
        });
    });
}
