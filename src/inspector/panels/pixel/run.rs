//! The picked pixel's values after each step: what each pass changed here, and what it left.

use crate::capture::{Capture, FrameSnapshot, Snapshot};
use crate::inspector::look::palette;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::numbers;
use crate::reading::counts;
use crate::reading::depth::DepthMeasure;
use crate::reading::format;
use crate::reading::layers::MapContent;
use crate::reading::steps;
use egui::{Color32, CornerRadius, FontId, RichText, Ui};

/// Points of a pass's name at most: beside all columns, and where there is no stencil.
const WIDEST_NAMES: [f32; 2] = [88.0, 120.0];

/// A value in the table, with the colour that stands for it.
#[derive(Debug, Clone, PartialEq)]
struct RunValue {
    text: String,
    color: Option<Color32>,
}

/// The pixel's values after a step.
#[derive(Debug, Clone, PartialEq)]
struct RunValues {
    stencil: Option<RunValue>,
    count: Option<RunValue>,
    color: Option<RunValue>,
    depth: Option<RunValue>,
}

/// In a panel narrower than this, points, colours are shown without their numbers, which a tooltip has.
const NARROW: f32 = 300.0;

/// From this width on, points, columns stand so far apart that values of two are not taken for one.
const SPACIOUS: f32 = 352.0;

/// In one narrower than this the columns stand closer, where a stencil value is written as a negative number, too: `−1 (255)`.
const NARROW_WITH_SIGNS: f32 = 340.0;

/// Draws a table of the pixel's values after each step, those that the step did not change faint; a click on a pass
/// selects its step. Steps that draw a map have no values.
pub fn ui(ui: &mut Ui, model: &mut Model, capture: &Capture, at: [u32; 2]) {
    theme::heading(ui, "Over the steps");
    let mut selected = None;
    let last = capture.steps.len().saturating_sub(1);
    let has_stencil = capture.frame_at(last).is_some_and(|frame| frame.stencil.is_some());
    let runs = capture.steps.iter().enumerate().map(|(index, step)| match &step.snapshot {
        Snapshot::Frame(frame) => Some(values(capture, index, frame, at)),
        Snapshot::Map { .. } => None,
    });
    let runs: Vec<Option<RunValues>> = runs.collect();
    let has_count = runs.iter().flatten().any(|values| values.count.is_some());
    let has = [has_stencil, has_count];
    // So that the columns beside it do not move.
    let mut stencils = runs.iter().flatten().filter_map(|values| values.stencil.as_ref());
    let has_signs = stencils.any(|value| value.text.contains('('));
    let width = ui.available_width();
    let is_narrow = width < NARROW;
    let apart = if width >= SPACIOUS {
        18.0
    } else if is_narrow {
        9.0
    } else if has_signs && width < NARROW_WITH_SIGNS {
        7.0
    } else {
        12.0
    };
    let widest = WIDEST_NAMES[usize::from(!has_stencil)] - if is_narrow { 12.0 } else { 0.0 };
    let of_map = MapContent::of_capture(capture).map_or("map", MapContent::one);
    let grid = egui::Grid::new("pixel over the steps").num_columns(5).spacing([apart, 2.0]);
    let row_height = ui.spacing().interact_size.y.min(20.0);
    grid.min_row_height(row_height).show(ui, |ui| {
        head(ui, has);
        let mut before: Option<&RunValues> = None;
        for (index, run) in runs.iter().enumerate() {
            if pass_cell(ui, capture, index, widest, index == model.selection.step) {
                selected = Some(index);
            }
            match run {
                Some(now) => {
                    row(ui, now, before, has, is_narrow);
                    before = Some(now);
                }
                None => {
                    ui.label(
                        RichText::new(format!("{of_map} only")).size(theme::SMALL_SIZE).color(theme::of(ui).faint),
                    );
                }
            }
            ui.end_row();
        }
    });
    if let Some(index) = selected {
        model.selection.playing = None;
        model.select_step(index);
    }
}

/// Draws the head of the columns: stencil only where there is one, and the distance only where no float counts take its
/// place.
fn head(ui: &mut Ui, [has_stencil, has_count]: [bool; 2]) {
    let columns =
        [("pass", true), ("stencil", has_stencil), ("count", has_count), ("colour", true), ("distance", !has_count)];
    for (name, _) in columns.into_iter().filter(|(_, is_shown)| *is_shown) {
        ui.label(theme::note(name));
    }
    ui.end_row();
}

/// Draws a button with number (a dash for a mask) and name of a pass, the name at most `widest` points wide, with an
/// ellipsis in its middle where it is longer; returns true when it is clicked.
fn pass_cell(ui: &mut Ui, capture: &Capture, index: usize, widest: f32, is_selected: bool) -> bool {
    let name = &capture.steps[index].name;
    let color = if is_selected { theme::of(ui).text } else { theme::of(ui).dim };
    let short = theme::elided(ui, name, &FontId::proportional(theme::SMALL_SIZE), widest);
    let number = steps::number(capture, index).map_or_else(|| "–".to_owned(), |number| number.to_string());
    let text = RichText::new(format!("{number} {short}")).size(theme::SMALL_SIZE).color(color);
    let button = egui::Button::selectable(is_selected, text).corner_radius(CornerRadius::same(2));
    ui.add(button).on_hover_text(format!("Go to {}, {name}", steps::words(capture, index))).clicked()
}

fn values(capture: &Capture, step: usize, frame: &FrameSnapshot, at: [u32; 2]) -> RunValues {
    let count = counts::known_after(capture, step).and_then(|(_, image)| image.value_at(at));
    let stencil = frame.stencil.as_ref().and_then(|aspect| aspect.image.byte_at(at));
    RunValues {
        stencil: stencil.map(|value| RunValue { text: numbers::signed(value), color: Some(palette::stencil(value)) }),
        count: count.map(|count| RunValue { text: numbers::count_in_float(count), color: Some(palette::count(count)) }),
        color: frame.color.image.rgba_at(at).map(|[red, green, blue, _]| RunValue {
            text: format!("{red} {green} {blue}"),
            color: Some(Color32::from_rgb(red, green, blue)),
        }),
        depth: frame.depth.image.depth_at(at).map(|depth| RunValue { text: distance(capture, depth), color: None }),
    }
}

fn distance(capture: &Capture, depth: f32) -> String {
    DepthMeasure::of_camera(capture)
        .value(depth)
        .map_or_else(|| "–".to_owned(), |away| format::length(away, capture.depth.unit.letter()))
}

fn row(ui: &mut Ui, now: &RunValues, before: Option<&RunValues>, [has_stencil, has_count]: [bool; 2], is_narrow: bool) {
    if has_stencil {
        cell(ui, now.stencil.as_ref(), before.and_then(|before| before.stencil.as_ref()), true);
    }
    if has_count {
        cell(ui, now.count.as_ref(), before.and_then(|before| before.count.as_ref()), true);
    }
    cell(ui, now.color.as_ref(), before.and_then(|before| before.color.as_ref()), !is_narrow);
    if !has_count {
        cell(ui, now.depth.as_ref(), before.and_then(|before| before.depth.as_ref()), true);
    }
}

/// Draws a value with its swatch, if it has a colour, its text in a tooltip where it is not `written`; faint where it equals
/// the one before, and an empty cell for `None`.
fn cell(ui: &mut Ui, now: Option<&RunValue>, before: Option<&RunValue>, written: bool) {
    let Some(value) = now else {
        ui.label("");
        return;
    };
    let unchanged = before == Some(value);
    let ink = if unchanged { theme::of(ui).faint } else { theme::of(ui).text };
    let line = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        if let Some(color) = value.color {
            // A paler colour would be that of another value.
            theme::swatch(ui, color);
        }
        if written {
            ui.label(theme::number(value.text.as_str()).color(ink));
        }
    });
    let said = [(!written).then_some(value.text.as_str()), unchanged.then_some("Unchanged here by this pass")];
    let said: Vec<&str> = said.into_iter().flatten().collect();
    if !said.is_empty() {
        line.response.on_hover_text(said.join(": "));
    }
}
