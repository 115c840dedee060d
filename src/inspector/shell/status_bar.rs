//! The bar at the bottom: the picture's facts, the texel under the pointer, the cost of a frame.

use crate::ask::{FilmOf, QuestionKind, TimingOf};
use crate::capture::{AdapterProfile, Capture};
use crate::inspector::look::coloring::{self, Coloring};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::numbers;
use crate::reading::format;
use crate::reading::picture_view::{PictureKind, ShownPicture, TexelZoom};
use egui::{Margin, Ui};
use std::sync::Arc;

/// A bar narrower than this, points, has no space for all.
const NARROW: f32 = 900.0;

/// Width of the values of a texel, points: what is shown is named beside them only where there is so much space left.
const VALUES_WIDTH: f32 = 440.0;

/// Space for depth, stencil and count of a texel, points: less is left free.
const LEAST_REST: f32 = 220.0;
/// Space for the stencil alone, which comes first where the picture shows it.
const LEAST_STENCIL: f32 = 96.0;

/// Draws the status bar at the lower edge: the shown picture, the texel under the pointer, the GPU, and times.
pub fn ui(ui: &mut Ui, model: &mut Model) {
    let frame = egui::Frame::new().fill(theme::of(ui).background).inner_margin(Margin::symmetric(8, 2));
    egui::Panel::bottom("status bar").frame(frame).exact_size(26.0).show(ui, |ui| {
        let is_narrow = ui.available_width() < NARROW;
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            costs(ui, model, is_narrow);
            // What is left of the bar, so that neither lies over the other.
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                let shown = |capture: &Arc<Capture>| Some((Arc::clone(capture), model.shown(capture)?));
                if let Some((capture, shown)) = model.frame.capture.as_ref().and_then(shown) {
                    picture(ui, model, &capture, &shown, is_narrow);
                }
            });
        });
    });
}

/// Draws what is shown, and the values of the texel under the pointer; in a narrow bar the values alone while there are
/// some.
fn picture(ui: &mut Ui, model: &Model, capture: &Capture, shown: &ShownPicture, is_narrow: bool) {
    let [width, height] = shown.images.first().map_or([0, 0], |image| image.size());
    // Beside the buttons it would push them into another row.
    let zoom = match model.view.zoom {
        TexelZoom::Pixels(pixels) => format!(" at {:.0} %", pixels * 100.0),
        TexelZoom::Fit => String::new(),
    };
    let preview = if model.frame.is_preview { "preview of " } else { "" };
    let size = format!("{preview}{width}×{height}{zoom}");
    let time = model.frame.time.map_or_else(String::new, |time| format!(" · at {}", format::time(time)));
    let words = format!("{}{time} · {size} · {}", shown.title, shown.format);
    let font = egui::FontId::proportional(theme::SMALL_SIZE);
    let needed = ui.painter().layout_no_wrap(words.clone(), font, theme::of(ui).dim).size().x + VALUES_WIDTH;
    if model.selection.hover.is_none() || (!is_narrow && needed <= ui.available_width()) {
        ui.add(egui::Label::new(theme::note(words)).truncate());
    }
    let Some(hover) = model.selection.hover else { return };
    let [x, y] = hover.at;
    ui.add_space(4.0);
    match Coloring::of_shown(shown, model.view.depth_range.unwrap_or([0.0, 1.0])) {
        Coloring::Depth(scale) if shown.kind == PictureKind::Map => {
            let depth = shown.images.get(hover.image).and_then(|image| image.depth_at(hover.at));
            let value = depth.map_or_else(String::new, format::depth);
            let metres = depth.and_then(|depth| scale.measure.value(depth)).map_or_else(String::new, format::digits);
            ui.label(theme::number(format!("texel {x}, {y}   depth {value}   {metres}")));
        }
        Coloring::Linear => {
            let layer = shown.layers.get(hover.image).filter(|_| shown.layers.len() > 1);
            if let Some(layer) = layer {
                ui.label(theme::note(layer.name.as_str()));
            }
            if let Some(texel) = shown.images.get(hover.image).and_then(|image| image.rgba_at(hover.at)) {
                theme::swatch(ui, coloring::linear(texel));
                ui.label(theme::number(format!("texel {x}, {y}   lets through {}", format::shares(texel))));
            }
        }
        _ => frame_values(ui, capture, model, hover.at),
    }
}

fn frame_values(ui: &mut Ui, capture: &Capture, model: &Model, at: [u32; 2]) {
    let [x, y] = at;
    let Some(frame) = model.shown_point().frame(capture) else { return };
    if let Some([red, green, blue, _]) = frame.color.image.rgba_at(at) {
        theme::swatch(ui, egui::Color32::from_rgb(red, green, blue));
        ui.label(theme::number(format!("{x}, {y}   colour {red} {green} {blue}")));
    }
    // In the narrowest bar the rest is read in the Pixel tab.
    let least = if model.kind() == Some(PictureKind::Stencil) { LEAST_STENCIL } else { LEAST_REST };
    if ui.available_width() < least {
        return;
    }
    let depth = frame.depth.image.depth_at(at).map(|depth| format!("depth {}", format::depth(depth)));
    let stencil = frame.stencil.as_ref().and_then(|stencil| stencil.image.byte_at(at));
    let stencil = stencil.map(|stencil| format!("stencil {}", numbers::signed(stencil)));
    // What the picture shows comes first, where there is no space for all.
    let in_order = if model.kind() == Some(PictureKind::Stencil) { [stencil, depth] } else { [depth, stencil] };
    for words in in_order.into_iter().flatten() {
        ui.label(theme::number(words));
    }
    if let Some(count) = model.counts_to_show(capture).and_then(|(_, image)| image.value_at(at)) {
        ui.label(theme::number(format!("count {}", numbers::count_in_float(count))));
    }
}

/// Draws from right to left: adapter, frame time, which is asked for where it is not known, the capture's bytes, a
/// film's progress, and the file that is being written or the running job, or the last export where nothing runs. A narrow
/// bar has the frame time alone of the first three, and the others in its tooltip.
fn costs(ui: &mut Ui, model: &mut Model, is_narrow: bool) {
    if let Some(capture) = &model.frame.capture {
        let adapter = &capture.adapter;
        let short_name = adapter.name.split(" (").next().unwrap_or_default();
        let words: Vec<&str> = [short_name, &adapter.driver].into_iter().filter(|word| !word.is_empty()).collect();
        if !is_narrow {
            ui.label(theme::note(words.join(", "))).on_hover_text(adapter_in_words(capture));
        }
        if capture.timing.frame_ms.is_none() && model.scene.is_some() {
            model.answers.want(TimingOf {});
        }
        if let Some(frame) = capture.timing.frame_ms {
            let meaning = "Median time of a frame without snapshots".to_owned();
            let rest =
                format!("{meaning}\ncapture {}\n{}", format::bytes(model.frame.bytes), adapter_in_words(capture));
            ui.label(theme::note(format!("frame {}", format::milliseconds(Some(frame))))).on_hover_text(if is_narrow {
                rest
            } else {
                meaning
            });
        }
        if !is_narrow {
            ui.label(theme::note(format!("capture {}", format::bytes(model.frame.bytes))))
                .on_hover_text("Memory of all pictures of this capture");
        }
    }
    film(ui, model);
    if let Some(name) = model.activity.exporting.first() {
        let begun = model.activity.exporting.len();
        let words = match begun.saturating_sub(model.activity.written) {
            _ if begun == 1 => format!("writing {name} …"),
            1 => "writing the last of several files …".to_owned(),
            left => format!("writing {left} files …"),
        };
        ui.add(egui::Label::new(theme::note(words)).truncate());
        spinner(ui, model.is_drawn_slowly);
    } else if let Some(job) = &model.activity.job {
        ui.add(egui::Label::new(theme::note(job.clone())).truncate());
        spinner(ui, model.is_drawn_slowly);
    } else if let Some(done) = model.activity.exported.as_ref().filter(|_| {
        // It gives way to the values under the pointer.
        model.selection.hover.is_none() || ui.available_width() > VALUES_WIDTH + LEAST_REST
    }) {
        ui.add(egui::Label::new(theme::note(done.as_str())).truncate()).on_hover_text("The last export");
    }
}

/// Returns the adapter's name, and what was measured of its rasteriser, a sentence a line.
fn adapter_in_words(capture: &Capture) -> String {
    let measured = capture.profile.iter().flat_map(AdapterProfile::sentences);
    std::iter::once(capture.adapter.name.clone()).chain(measured).collect::<Vec<_>>().join("\n")
}

/// Draws the progress of a film that is being written, with a button that cancels it; nothing where none is.
fn film(ui: &mut Ui, model: &mut Model) {
    let Some(progress) = model.answers.under_way::<FilmOf>().running else { return };
    if ui.small_button("Cancel").on_hover_text("Stop writing the animation; nothing of it is left").clicked() {
        model.answers.cancel(QuestionKind::FilmOf);
    }
    let (done, of) = progress.steps();
    let words = if of == 0 { "animation begins".to_owned() } else { format!("animation: {done} of {of} pictures") };
    ui.label(theme::note(words));
    spinner(ui, model.is_drawn_slowly);
}

/// Draws a rotating arc. It moves a few times a second only, and seldom where `is_slow`: on a software GPU every frame that
/// is drawn here takes time from the work that it stands for.
fn spinner(ui: &mut Ui, is_slow: bool) {
    const TURN_SECONDS: f64 = 1.2;
    const FRAMES: f64 = 12.0;
    let (rect, _) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::hover());
    let turn = (ui.input(|input| input.time) / TURN_SECONDS * FRAMES).floor() / FRAMES;
    let points = (0..=9).map(|step| {
        let angle = ((turn + f64::from(step) / 12.0) * std::f64::consts::TAU) as f32;
        rect.center() + egui::Vec2::angled(angle) * 5.0
    });
    ui.painter().line(points.collect(), egui::Stroke::new(1.5, theme::of(ui).dim));
    let seconds = if is_slow { TURN_SECONDS } else { TURN_SECONDS / FRAMES };
    ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(seconds));
}
