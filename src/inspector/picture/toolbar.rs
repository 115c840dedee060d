//! Which picture, of which light and face, how depth is shown, and how large.

use super::super::texture::Textures;
use super::super::{PictureKind, State, theme};
use super::{FACES, faces, near_of};
use egui::{Align, Button, ComboBox, Layout, Ui};

pub(super) fn ui(ui: &mut Ui, state: &mut State, textures: &mut Textures) {
    ui.horizontal_wrapped(|ui| {
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.x = 1.0;
            for (index, kind) in state.available().into_iter().enumerate() {
                let button = ui.add(Button::selectable(state.picture == kind, kind.name()));
                if button.on_hover_text(format!("key {}", index + 1)).clicked() {
                    state.picture = kind;
                }
            }
        });
        if matches!(state.picture, PictureKind::Mask | PictureKind::Map) {
            light(ui, state);
        }
        match state.picture {
            PictureKind::Depth => depth(ui, state, textures),
            PictureKind::Map if faces(state).len() > 1 => face(ui, state),
            _ => {}
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(theme::dim(format!("{:.0} %", state.placement.zoom * 100.0)));
            if ui.button("Fit").clicked() {
                state.place(true);
            }
            if ui.button("1:1").clicked() {
                state.place(false);
            }
        });
    });
    ui.add_space(theme::SPACE);
}

fn light(ui: &mut Ui, state: &mut State) {
    let count = state.capture.as_ref().map_or(0, |capture| capture.lights.len());
    if count < 2 {
        return;
    }
    let label = ui.label(theme::dim("of"));
    let combo = ComboBox::from_id_salt("light").selected_text(format!("light {}", state.light + 1)).show_ui(ui, |ui| {
        for index in 0..count {
            ui.selectable_value(&mut state.light, index, format!("light {}", index + 1));
        }
    });
    combo.response.labelled_by(label.id);
}

fn face(ui: &mut Ui, state: &mut State) {
    let name = state.face.and_then(|face| FACES.get(face)).copied().unwrap_or("all");
    let label = ui.label(theme::dim("face"));
    let combo = ComboBox::from_id_salt("face").selected_text(name).show_ui(ui, |ui| {
        ui.selectable_value(&mut state.face, None, "all");
        for (index, name) in FACES.into_iter().enumerate() {
            ui.selectable_value(&mut state.face, Some(index), name);
        }
    });
    combo.response.labelled_by(label.id);
}

/// Black and white ends; picked values are never changed by them.
fn depth(ui: &mut Ui, state: &mut State, textures: &mut Textures) {
    let raw = state.depth.raw;
    for (name, value) in [("Linear", false), ("Raw", true)] {
        if ui.add(Button::selectable(raw == value, name)).clicked() && raw != value {
            state.depth.raw = value;
            state.depth.ends = None;
        }
    }
    let Some(image) = state.image().cloned() else { return };
    let fitted = textures.fitted_ends(&image, near_of(state));
    let [mut low, mut high] = state.depth.ends.unwrap_or(fitted);
    ui.spacing_mut().slider_width = 120.0;
    let range = fitted[0].min(low)..=fitted[1].max(high).max(fitted[0] + f32::MIN_POSITIVE);
    let slider = egui::RangeSlider::new(&mut low, &mut high, range).text(if state.depth.raw { "" } else { "m" });
    let response = ui.add(slider);
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("Depth range"));
    if response.changed() {
        state.depth.ends = Some([low, high]);
    }
    if ui.button("Autofit").clicked() {
        state.depth.ends = None;
    }
}
