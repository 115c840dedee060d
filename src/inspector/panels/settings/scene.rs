//! The settings of what is seen: lights and camera by number, the picture's size, the moment.

use crate::ask::RunRequest;
use crate::inspector::look::theme;
use crate::reading::format;
use crate::scene::Light;
use egui::{DragValue, Ui};
use glam::DVec3;

/// Largest side of a picture that the panel offers, pixels.
const MOST_PIXELS: u32 = 8192;

/// Draws the settings into the panel; true when one changed.
pub fn ui(ui: &mut Ui, draft: &mut RunRequest, objects: &[String], animated: bool) -> bool {
    let mut changed = false;
    for (index, light) in draft.lights.iter_mut().enumerate() {
        ui.add_space(12.0);
        changed |= light_settings(ui, index, light);
    }
    ui.add_space(12.0);
    changed |= camera(ui, draft);
    ui.add_space(12.0);
    changed |= picture(ui, draft, animated);
    ui.add_space(12.0);
    changed |= objects_on(ui, draft, objects);
    changed
}

/// Which objects are there.
fn objects_on(ui: &mut Ui, draft: &mut RunRequest, objects: &[String]) -> bool {
    theme::heading(ui, "Objects");
    let mut changed = false;
    for (index, name) in objects.iter().enumerate() {
        let mut is_on = !draft.off.contains(&index);
        let check = ui.checkbox(&mut is_on, name).on_hover_text("Drawn, and casts and receives as the scene says");
        if check.changed() {
            changed = true;
            if is_on {
                draft.off.remove(&index)
            } else {
                draft.off.insert(index)
            };
        }
    }
    changed
}

fn light_settings(ui: &mut Ui, index: usize, light: &mut Light) -> bool {
    let name = format::light(index);
    theme::heading(ui, &format!("Light {}", index + 1));
    let mut changed = false;
    egui::Grid::new(("light settings", index)).num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        ui.label(theme::note("kind"));
        changed |= light_kind(ui, &name, light);
        ui.end_row();
        let place = if light.is_directional() { "towards" } else { "position" };
        let mut position = light.position.truncate();
        changed |= vector(ui, &format!("{name} {place}"), place, &mut position);
        light.position = position.extend(light.position.w);
        ui.end_row();
        ui.label(theme::note("colour"));
        let picker = ui.color_edit_button_rgb(&mut light.color).accessible_name(format!("{name} colour"));
        changed |= picker.on_hover_text("Linear red, green and blue").changed();
        ui.end_row();
        ui.label(theme::note("intensity"));
        let intensity = DragValue::new(&mut light.intensity).range(0.0..=1000.0).speed(0.01);
        changed |= ui.add(intensity).accessible_name(format!("{name} intensity")).changed();
        ui.end_row();
    });
    changed
}

/// Point or directional. The numbers stay: they are a place, or the way towards the light.
fn light_kind(ui: &mut Ui, name: &str, light: &mut Light) -> bool {
    let mut is_directional = light.is_directional();
    let before = is_directional;
    let combo = egui::ComboBox::from_id_salt(("kind", name));
    let combo = combo.selected_text(if is_directional { "directional" } else { "point" }).show_ui(ui, |ui| {
        ui.selectable_value(&mut is_directional, false, "point");
        ui.selectable_value(&mut is_directional, true, "directional");
    });
    combo.response.accessible_name(format!("{name} kind"));
    light.position.w = if is_directional { 0.0 } else { 1.0 };
    is_directional != before
}

fn camera(ui: &mut Ui, draft: &mut RunRequest) -> bool {
    theme::heading(ui, "Camera");
    let camera = &mut draft.camera;
    let mut changed = false;
    egui::Grid::new("camera settings").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        changed |= vector(ui, "camera eye", "eye", &mut camera.eye);
        ui.end_row();
        changed |= vector(ui, "camera target", "target", &mut camera.target);
        ui.end_row();
        changed |= vector(ui, "camera up", "up", &mut camera.up);
        ui.end_row();
        ui.label(theme::note("field of view"));
        let fov = DragValue::new(&mut camera.fov_y_degrees).range(1.0..=179.0).speed(0.2).suffix("°");
        changed |= ui.add(fov.update_while_editing(false)).accessible_name("Field of view").changed();
        ui.end_row();
        ui.label(theme::note("near plane"));
        let near = DragValue::new(&mut camera.near).range(1e-6..=1e6).speed(0.001).max_decimals(6).suffix(" m");
        changed |= ui.add(near.update_while_editing(false)).accessible_name("Near plane").changed();
        ui.end_row();
    });
    changed
}

fn picture(ui: &mut Ui, draft: &mut RunRequest, animated: bool) -> bool {
    theme::heading(ui, "Picture");
    let mut changed = false;
    egui::Grid::new("picture settings").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        ui.label(theme::note("size"));
        ui.horizontal(|ui| {
            for (index, name) in ["Picture width", "Picture height"].into_iter().enumerate() {
                let side = DragValue::new(&mut draft.size[index]).range(1..=MOST_PIXELS).update_while_editing(false);
                changed |= ui.add(side).accessible_name(name).changed();
            }
        });
        ui.end_row();
        if animated {
            ui.label(theme::note("time"));
            let time = DragValue::new(&mut draft.time).speed(0.02).suffix(" s").update_while_editing(false);
            changed |= ui.add(time).accessible_name("Scene time").changed();
            ui.end_row();
        }
    });
    changed
}

/// Three numbers in a row.
fn vector(ui: &mut Ui, name: &str, label: &str, value: &mut DVec3) -> bool {
    let mut changed = false;
    ui.label(theme::note(label));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (axis, number) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
            let widget = DragValue::new(number).speed(0.02).max_decimals(4).update_while_editing(false);
            changed |= ui.add(widget).accessible_name(format!("{name} {axis}")).changed();
        }
    });
    changed
}
