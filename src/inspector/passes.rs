//! The passes of the frame as a tree: scene, then each light, then what was left out.
//!
//! A pass shows a thumbnail of what it changed; the selected one lists its draws and says why it
//! is there.

use super::texture::{Look, THUMBNAIL, Textures};
use super::{State, theme};
use crate::capture::{Capture, Image, Snapshot, Step};
use egui::{Align2, Color32, Key, Rect, RichText, Sense, Ui, vec2};
use std::sync::Arc;

pub(super) fn ui(ui: &mut Ui, state: &mut State, textures: &mut Textures) {
    let Some(capture) = state.capture.clone() else {
        empty(ui, state);
        return;
    };
    controls(ui, state, capture.steps.len());
    fields(ui, state, &capture);
    let purpose_height = 132.0;
    let list_height = (ui.available_height() - purpose_height).max(theme::PASS_ROW);
    egui::ScrollArea::vertical().max_height(list_height).auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let mut heading = None;
        for (index, step) in capture.steps.iter().enumerate() {
            if heading != Some(step.light) {
                heading = Some(step.light);
                theme::heading(ui, &light_heading(&capture, step.light));
            }
            if is_found(state, step) {
                row(ui, state, textures, &capture, index);
            }
        }
        left_out(ui, &capture);
    });
    purpose(ui, state);
}

fn empty(ui: &mut Ui, state: &State) {
    if state.job.is_some() {
        ui.label(theme::dim("The first frame is on its way."));
    } else {
        ui.label("Nothing is open.");
        ui.label(theme::dim("Open a built-in scene, a model or a capture folder with “Open…”, or drop one here."));
    }
}

fn light_heading(capture: &Capture, light: Option<usize>) -> String {
    let Some(index) = light else { return "Scene".to_owned() };
    let is_directional = capture.lights.get(index).is_some_and(|light| light.position.w == 0.0);
    format!("Light {} · {}", index + 1, if is_directional { "directional" } else { "point" })
}

fn controls(ui: &mut Ui, state: &mut State, count: usize) {
    ui.horizontal(|ui| {
        if ui.button("◀").on_hover_text("Previous pass (←)").labelled("Previous pass").clicked() {
            state.go_to_step(state.step.saturating_sub(1));
        }
        if ui.button("▶").on_hover_text("Next pass (→)").labelled("Next pass").clicked() {
            state.go_to_step(state.step + 1);
        }
        if ui.button(if state.playing { "Pause" } else { "Play" }).on_hover_text("Space").clicked() {
            state.toggle_playing();
        }
        ui.label(theme::dim(format!("step {} of {count}", (state.step + 1).min(count))));
    });
    if count > 1 {
        let mut number = state.step + 1;
        ui.spacing_mut().slider_width = ui.available_width() - 2.0 * theme::SPACE;
        let slider = egui::Slider::new(&mut number, 1..=count).show_value(false);
        if ui.add(slider).labelled("Scrubber").changed() {
            state.go_to_step(number - 1);
        }
    }
}

/// Gives a widget whose text is a sign a name that can be spoken.
trait Labelled {
    fn labelled(self, name: &str) -> Self;
}

impl Labelled for egui::Response {
    fn labelled(self, name: &str) -> Self {
        self.ctx.accesskit_node_builder(self.id, |node| node.set_label(name));
        self
    }
}

/// The find and go-to fields, while they are shown.
fn fields(ui: &mut Ui, state: &mut State, capture: &Capture) {
    if let Some(mut text) = state.find.take() {
        let stays = field(ui, "Find pass", &mut text);
        let entered = ui.input(|input| input.key_pressed(Key::Enter));
        state.find = stays.then_some(text);
        if entered && let Some(found) = capture.steps.iter().position(|step| is_found(state, step)) {
            state.go_to_step(found);
        }
    }
    if let Some(mut text) = state.go_to.take() {
        let stays = field(ui, "Go to step", &mut text);
        let entered = ui.input(|input| input.key_pressed(Key::Enter));
        if let (true, Ok(number)) = (entered, text.trim().parse::<usize>()) {
            state.go_to_step(number.saturating_sub(1));
        } else if stays {
            state.go_to = Some(text);
        }
    }
}

/// A text field that keeps the focus; false once Escape closed it.
fn field(ui: &mut Ui, name: &str, text: &mut String) -> bool {
    ui.horizontal(|ui| {
        let label = ui.label(theme::dim(name));
        let edit = ui.add(egui::TextEdit::singleline(text).desired_width(140.0)).labelled_by(label.id);
        if !edit.has_focus() && !edit.lost_focus() {
            edit.request_focus();
        }
    });
    !ui.input(|input| input.key_pressed(Key::Escape))
}

fn is_found(state: &State, step: &Step) -> bool {
    let Some(text) = &state.find else { return true };
    let text = text.to_lowercase();
    let draws = step.draws.iter().map(|draw| &draw.name);
    std::iter::once(&step.name).chain(draws).any(|name| name.to_lowercase().contains(&text))
}

fn row(ui: &mut Ui, state: &mut State, textures: &mut Textures, capture: &Capture, index: usize) {
    let step = &capture.steps[index];
    let selected = state.step == index;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::PASS_ROW), Sense::click());
    let name = format!("{} · {}", index + 1, step.name);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, selected, name.as_str()));
    if response.clicked() {
        state.go_to_step(index);
    }
    if selected {
        ui.painter().rect_filled(rect, 0.0, theme::SELECTED_ROW);
        ui.painter().rect_filled(rect.with_max_x(rect.left() + 3.0), 0.0, theme::SELECTED);
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 0.0, theme::RAISED);
    }
    let picture = Rect::from_min_size(rect.min + vec2(8.0, 6.0), vec2(52.0, theme::PASS_ROW - 12.0));
    thumbnail(ui, textures, capture, step, picture);
    let left = picture.right() + theme::SPACE * 2.0;
    let text = |ui: &Ui, x, y, align, text: String, style, color| {
        let font = egui::TextStyle::resolve(&style, ui.style());
        ui.painter().with_clip_rect(rect).text(egui::pos2(x, y), align, text, font, color);
    };
    let (upper, lower) = (rect.top() + 14.0, rect.bottom() - 13.0);
    text(ui, left, upper, Align2::LEFT_CENTER, name, egui::TextStyle::Body, theme::TEXT);
    let draws = step.draws.len();
    let plural = if draws == 1 { "" } else { "s" };
    let counts = format!("{draws} draw{plural} · {} triangles", theme::thousands(step.triangles()));
    text(ui, left, lower, Align2::LEFT_CENTER, counts, egui::TextStyle::Small, theme::DIM);
    let time = step.gpu_ms.map_or("-".to_owned(), |ms| format!("{ms:.1} ms"));
    text(ui, rect.right() - 8.0, upper, Align2::RIGHT_CENTER, time, egui::TextStyle::Monospace, theme::DIM);
    if selected {
        draw_rows(ui, step);
    }
}

fn draw_rows(ui: &mut Ui, step: &Step) {
    for draw in &step.draws {
        ui.horizontal(|ui| {
            ui.set_min_height(theme::ROW);
            ui.add_space(60.0);
            theme::swatch(ui, theme::part_color(draw.part));
            ui.add(egui::Label::new(theme::dim(&draw.name)).truncate()).on_hover_text(draw.part.name());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add_space(8.0);
                ui.label(RichText::new(theme::thousands(draw.triangles)).monospace().color(theme::DIM));
            });
        });
    }
}

/// What the pass changed: the map face, the labels, the stencil, or else the colour.
fn thumbnail(ui: &Ui, textures: &mut Textures, capture: &Capture, step: &Step, frame: Rect) {
    let Some((image, look)) = changed(textures, capture, step) else { return };
    let texture = textures.get(ui.ctx(), &image, look, THUMBNAIL);
    let [width, height] = image.size().map(|n| n as f32);
    let scale = (frame.width() / width).min(frame.height() / height);
    let place = Rect::from_center_size(frame.center(), vec2(width, height) * scale);
    let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    ui.painter().image(texture.id(), place, whole, Color32::WHITE);
    ui.painter().rect_stroke(place, 0.0, egui::Stroke::new(1.0, theme::LINE), egui::StrokeKind::Outside);
}

fn changed(textures: &mut Textures, capture: &Capture, step: &Step) -> Option<(Arc<Image>, Look)> {
    let frame = match &step.snapshot {
        Snapshot::Map { light, face } => {
            let image = capture.lights.get(*light)?.map.as_ref()?.faces.get(*face)?;
            return Some((image.clone(), textures.depth_look(image, None, None)));
        }
        Snapshot::Frame(frame) => frame,
    };
    if frame.writes_labels {
        let labels = capture.lights.get(step.light?)?.shadow.as_ref()?;
        return Some((labels.clone(), Look::Labels));
    }
    match &frame.stencil {
        Some(stencil) if frame.color.unchanged => Some((stencil.image.clone(), Look::Stencil)),
        _ => Some((frame.color.image.clone(), Look::Color)),
    }
}

/// Absence is a lesson too.
fn left_out(ui: &mut Ui, capture: &Capture) {
    if capture.left_out.is_empty() {
        return;
    }
    theme::heading(ui, "Left out");
    for left in &capture.left_out {
        ui.add_space(theme::SPACE);
        ui.label(theme::dim(format!("{} · {}", left.what, left.of)));
        ui.label(theme::faint(&left.because));
    }
}

fn purpose(ui: &mut Ui, state: &State) {
    let Some(step) = state.current() else { return };
    ui.separator();
    ui.label(RichText::new("Why this pass").strong());
    egui::ScrollArea::vertical().id_salt("purpose").show(ui, |ui| ui.label(theme::dim(&step.purpose)));
}
