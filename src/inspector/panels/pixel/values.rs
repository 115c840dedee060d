//! The picked pixel's values after the shown step: what the buffers hold there, as numbers.

use crate::capture::{Capture, FrameSnapshot};
use crate::inspector::look::coloring;
use crate::inspector::look::palette;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::numbers;
use crate::reading::counts;
use crate::reading::depth::{DepthMeasure, FIXED_BITS};
use crate::reading::format;
use crate::reading::layers::MapContent;
use crate::reading::picture_view::PictureKind;
use egui::{Color32, Ui};

/// How a distance of the picture is measured.
const ALONG_AXIS: &str = "Along the camera's axis, as depth is: not along the ray through this pixel";
/// What one step of the depth is.
const ONE_STEP: &str =
    "One step of the depth buffer here, as a distance: surfaces that lie closer together can have the same depth";

/// Draws the names and values of the picked pixel after the shown step, `in_row` in each row; then the light's count and
/// the picked map texel, where they are shown.
pub fn ui(ui: &mut Ui, model: &Model, capture: &Capture, at: [u32; 2], in_row: usize) {
    let preview = if model.frame.is_preview { ", in the preview" } else { "" };
    theme::heading(ui, &format!("After {}{preview}", model.shown_point().words(capture)));
    let row_height = ui.spacing().interact_size.y.min(20.0);
    let grid = |name| egui::Grid::new(name).min_row_height(row_height);
    let spacing = if in_row > 1 { [10.0, 0.0] } else { [16.0, 2.0] };
    grid("pixel values").num_columns(2 * in_row).spacing(spacing).show(ui, |ui| {
        let mut pairs = ValuePairs { in_row, done: 0 };
        pairs.text(ui, "pixel", "Counted from the picture's upper left corner", &format!("{}, {}", at[0], at[1]));
        match model.shown_point().frame(capture) {
            Some(frame) => frame_values(ui, &mut pairs, capture, frame, at),
            None => pairs.text(ui, "picture", "No pass has drawn anything yet", "not begun yet"),
        }
    });
    let has_count = model.shown_point().frame(capture).is_some() && model.counts_to_show(capture).is_some();
    let texel = model.selection.map_pick.filter(|_| model.kind() == Some(PictureKind::Map));
    if has_count || texel.is_some() {
        // Some of these values are long.
        grid("pixel further values").num_columns(2).spacing(spacing).show(ui, |ui| {
            if has_count {
                count_row(ui, model, capture, at);
            }
            if let Some(texel) = texel {
                map_values(ui, model, capture, texel);
            }
        });
    }
}

/// Cells of a grid: pairs of name and value, so many in a row.
struct ValuePairs {
    in_row: usize,
    done: usize,
}

impl ValuePairs {
    /// Adds a value whose name says on hovering what it `means`.
    fn add(&mut self, ui: &mut Ui, name: &str, means: &str, value: impl FnOnce(&mut Ui)) {
        ui.label(theme::note(name)).on_hover_text(means);
        value(ui);
        self.done += 1;
        if self.done.is_multiple_of(self.in_row) {
            ui.end_row();
        }
    }

    fn text(&mut self, ui: &mut Ui, name: &str, means: &str, value: &str) {
        self.add(ui, name, means, |ui| {
            ui.label(theme::number(value).color(theme::of(ui).text));
        });
    }
}

fn frame_values(ui: &mut Ui, pairs: &mut ValuePairs, capture: &Capture, frame: &FrameSnapshot, at: [u32; 2]) {
    if let Some([red, green, blue, _]) = frame.color.image.rgba_at(at) {
        let is_alone = pairs.in_row == 1;
        pairs.add(ui, "colour", "What the colour buffer holds, in sRGB", |ui| {
            ui.horizontal(|ui| {
                theme::swatch(ui, Color32::from_rgb(red, green, blue));
                ui.label(theme::number(format!("{red} {green} {blue}"))).on_hover_text("sRGB");
                if is_alone {
                    ui.label(theme::note("sRGB"));
                }
            });
        });
    }
    if let Some(depth) = frame.depth.image.depth_at(at) {
        pairs.text(ui, "depth", "What the depth buffer holds", &format::depth(depth));
        let measure = DepthMeasure::of_camera(capture);
        let distance = measure.value(depth);
        let none = if capture.depth.tells_distances() { "no surface" } else { "not known" };
        let unit = capture.depth.unit.name();
        let distance = distance.map_or_else(|| none.to_owned(), |away| format::length(away, unit));
        let length = |step: Option<f64>| {
            step.map_or_else(|| "–".to_owned(), |step| numbers::small_length(step, capture.depth.unit.name()))
        };
        let [step, fixed] = [measure.step_at(depth), measure.fixed_step_at(depth, FIXED_BITS)].map(length);
        pairs.add(ui, "distance", ALONG_AXIS, |ui| {
            ui.label(theme::number(distance).color(theme::of(ui).text)).on_hover_text(ALONG_AXIS);
        });
        pairs.text(ui, "one step", ONE_STEP, &step);
        let fixed_step = format!("The same step if the depth buffer held {FIXED_BITS} bits");
        pairs.text(ui, &format!("in {FIXED_BITS} bits"), &fixed_step, &fixed);
    }
    match frame.stencil.as_ref().map(|stencil| stencil.image.byte_at(at)) {
        Some(Some(stencil)) => stencil_cells(ui, pairs, stencil),
        Some(None) => {}
        None if capture.lights.iter().any(|light| light.count.is_some()) => {}
        None => pairs.text(ui, "stencil", "This frame has no stencil buffer", "no buffer"),
    }
}

fn stencil_cells(ui: &mut Ui, pairs: &mut ValuePairs, stencil: u8) {
    let bits = theme::number(format!("{:04b} {:04b}", stencil >> 4, stencil & 15)).color(theme::of(ui).dim);
    let is_alone = pairs.in_row == 1;
    let beside = is_alone.then(|| bits.clone());
    pairs.add(ui, "stencil", "What the stencil buffer holds", |ui| {
        ui.horizontal(|ui| {
            theme::swatch(ui, palette::stencil(stencil));
            ui.label(theme::number(numbers::signed(stencil)).color(theme::of(ui).text));
            if let Some(bits) = beside {
                ui.label(bits);
            }
        });
    });
    if !is_alone {
        pairs.add(ui, "its bits", "The stencil value in binary", |ui| {
            ui.label(bits);
        });
    }
}

/// Draws the float count at the pixel, with what eight bits would read where that differs; nothing where no counts are
/// known after the step.
fn count_row(ui: &mut Ui, model: &Model, capture: &Capture, at: [u32; 2]) {
    let Some((light, image)) = model.counts_to_show(capture) else { return };
    let Some(count) = image.value_at(at) else { return };
    let is_only = capture.lights.iter().filter(|light| light.count.is_some()).count() < 2;
    let name = if is_only { "count".to_owned() } else { format!("count, {}", format::light(light)) };
    ui.label(theme::note(name));
    ui.horizontal(|ui| {
        theme::swatch(ui, palette::count(count));
        ui.label(theme::number(numbers::count_in_float(count)).color(theme::of(ui).text));
        let read = counts::in_eight_bits(count);
        if f32::from(read) != count {
            ui.label(theme::number(format!("would read {read} in eight bits")).color(theme::of(ui).dim));
        }
    });
    ui.end_row();
}

/// Draws the picked texel of a map of the light that is let through: its linear shares, stored bytes, and whether
/// labels take the light for blocked (alpha below 128).
fn let_through_values(ui: &mut Ui, what: &str, layer: &str, texel: [u32; 2], [r, g, b, a]: [u8; 4]) {
    row(ui, what, layer);
    row(ui, "texel", &format!("{}, {}", texel[0], texel[1]));
    ui.label(theme::note("lets through")).on_hover_text("Linear shares of the light's red, green and blue");
    ui.horizontal(|ui| {
        theme::swatch(ui, coloring::linear([r, g, b, a]));
        ui.label(theme::number(format::shares([r, g, b, a])).color(theme::of(ui).text));
    });
    ui.end_row();
    row(ui, "stored", &format!("{r} {g} {b}, alpha {a}"));
    ui.label(theme::note("for labels")).on_hover_text("Alpha: below a half, labels take the light for blocked");
    ui.label(theme::number(if a < 128 { "blocked" } else { "arrives" }).color(theme::of(ui).text));
    ui.end_row();
}

/// Draws the picked texel of the map that is shown: its depth and distance, or the light let through. Draws nothing
/// where several layers are shown, or the texel lies outside.
fn map_values(ui: &mut Ui, model: &Model, capture: &Capture, texel: [u32; 2]) {
    let Some(shown) = model.view.shown(capture, model.shown_point()).filter(|shown| shown.images.len() == 1) else {
        return;
    };
    if let (Some(bytes), Some(layer)) = (shown.images[0].rgba_at(texel), shown.layers.first()) {
        let what = MapContent::of_capture(capture).map_or("map", MapContent::one);
        return let_through_values(ui, what, &layer.name, texel, bytes);
    }
    let Some(depth) = shown.images[0].depth_at(texel) else { return };
    row(ui, "map texel", &format!("{}, {}", texel[0], texel[1]));
    row(ui, "map depth", &format::depth(depth));
    if shown.measure != DepthMeasure::Raw {
        let distance = shown.measure.value(depth);
        row(ui, "map distance", &distance.map_or_else(|| "nothing seen".to_owned(), format::metres));
    }
}

fn row(ui: &mut Ui, name: &str, value: &str) {
    ui.label(theme::note(name));
    ui.label(theme::number(value).color(theme::of(ui).text));
    ui.end_row();
}
