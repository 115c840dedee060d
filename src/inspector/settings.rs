//! Technique, lights, camera and moment by number. Every change asks for a new capture.

use super::{Action, Setup, State, theme};
use crate::scene::Light;
use crate::technique::{SettingSpec, SettingValues};
use egui::{ComboBox, DragValue, Grid, Ui};
use glam::DVec3;

pub(super) fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let Some(setup) = &mut state.setup else {
        ui.label("Nothing to set.");
        ui.label(theme::dim("A capture folder holds pictures, not the scene they were made from."));
        return;
    };
    let before = setup.clone();
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        technique(ui, setup);
        lights(ui, setup);
        camera(ui, setup);
        frame(ui, setup);
    });
    if *setup != before {
        match check(setup) {
            Ok(()) => actions.push(Action::Run(Box::new(setup.clone()))),
            // What can't be drawn is not even tried; the values stay as they were.
            Err(_) => *setup = before,
        }
    }
}

fn check(setup: &Setup) -> Result<(), &'static str> {
    setup.camera.check()?;
    setup.lights.iter().try_for_each(Light::check)
}

fn technique(ui: &mut Ui, setup: &mut Setup) {
    let technique = setup.choice.technique();
    theme::heading(ui, technique.name());
    ui.label(theme::dim(technique.summary()));
    Grid::new("technique settings").num_columns(2).show(ui, |ui| {
        for spec in technique.settings() {
            let label = ui.label(theme::dim(spec.key)).on_hover_text(spec.meaning);
            let value = setup.choice.settings().get(spec.key).cloned().unwrap_or_default();
            if let Some(changed) = setting(ui, spec, &value, label.id) {
                // Only offered values come from the widgets.
                if setup.choice.set(spec.key, &changed).is_err() {
                    continue;
                }
            }
            ui.end_row();
        }
    });
}

/// A widget for a setting; the new value, if it was changed.
fn setting(ui: &mut Ui, spec: &SettingSpec, value: &str, label: egui::Id) -> Option<String> {
    match spec.values {
        SettingValues::OneOf([only]) => {
            ui.label(theme::number(*only));
            None
        }
        SettingValues::OneOf(words) => {
            let mut chosen = value.to_owned();
            let combo = ComboBox::from_id_salt(spec.key).selected_text(value).show_ui(ui, |ui| {
                for word in words {
                    ui.selectable_value(&mut chosen, (*word).to_owned(), *word);
                }
            });
            combo.response.labelled_by(label);
            (chosen != value).then_some(chosen)
        }
        SettingValues::Integer(low, high) => {
            let mut number: i64 = value.parse().unwrap_or(low);
            let drag = DragValue::new(&mut number).range(low..=high).update_while_editing(false);
            ui.add(drag).labelled_by(label).changed().then(|| number.to_string())
        }
        SettingValues::Number(low, high) => {
            let mut number: f64 = value.parse().unwrap_or(low);
            let drag = DragValue::new(&mut number).range(low..=high).speed(0.05).update_while_editing(false);
            ui.add(drag).labelled_by(label).changed().then(|| number.to_string())
        }
    }
}

fn lights(ui: &mut Ui, setup: &mut Setup) {
    for (index, light) in setup.lights.iter_mut().enumerate() {
        let directional = light.is_directional();
        let kind = if directional { "directional" } else { "point" };
        theme::heading(ui, &format!("Light {} · {kind}", index + 1));
        Grid::new(("light", index)).num_columns(4).show(ui, |ui| {
            let mut position = light.position.truncate();
            let name = if directional { "towards" } else { "position" };
            vector(ui, &format!("light {} {name}", index + 1), name, &mut position);
            light.position = position.extend(light.position.w);
            ui.end_row();
            ui.label(theme::dim("intensity"));
            named(
                ui,
                &format!("light {} intensity", index + 1),
                DragValue::new(&mut light.intensity).range(0.0..=100.0).speed(0.01),
            );
            let mut color = light.color;
            if ui.color_edit_button_rgb(&mut color).changed() {
                light.color = color;
            }
            ui.end_row();
        });
    }
}

fn camera(ui: &mut Ui, setup: &mut Setup) {
    theme::heading(ui, "Camera");
    let camera = &mut setup.camera;
    Grid::new("camera").num_columns(4).show(ui, |ui| {
        vector(ui, "camera eye", "eye", &mut camera.eye);
        ui.end_row();
        vector(ui, "camera target", "target", &mut camera.target);
        ui.end_row();
        vector(ui, "camera up", "up", &mut camera.up);
        ui.end_row();
        ui.label(theme::dim("view"));
        named(ui, "field of view", DragValue::new(&mut camera.fov_y_degrees).range(1.0..=170.0).speed(0.2).suffix("°"));
        ui.end_row();
        let near_speed = camera.near * 0.01;
        ui.label(theme::dim("near"));
        named(ui, "near plane", DragValue::new(&mut camera.near).range(1e-9..=1e9).speed(near_speed).suffix(" m"));
        ui.end_row();
    });
}

fn frame(ui: &mut Ui, setup: &mut Setup) {
    theme::heading(ui, "Frame");
    Grid::new("frame").num_columns(3).show(ui, |ui| {
        ui.label(theme::dim("size"));
        for (name, length) in ["width", "height"].into_iter().zip(&mut setup.size) {
            named(ui, name, DragValue::new(length).range(1..=8192).update_while_editing(false));
        }
        ui.end_row();
        if setup.is_animated {
            ui.label(theme::dim("time"));
            named(ui, "time", DragValue::new(&mut setup.time).speed(0.02).suffix(" s"));
            ui.end_row();
        }
    });
}

/// Three numbers after a name.
fn vector(ui: &mut Ui, spoken: &str, name: &str, value: &mut DVec3) {
    ui.label(theme::dim(name));
    let speed = value.length().max(0.1) * 0.005;
    for (axis, component) in ["x", "y", "z"].into_iter().zip([&mut value.x, &mut value.y, &mut value.z]) {
        named(ui, &format!("{spoken} {axis}"), DragValue::new(component).speed(speed).max_decimals(4));
    }
}

/// A number whose spoken name is not beside it.
fn named(ui: &mut Ui, name: &str, drag: DragValue) {
    let response = ui.add(drag);
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
}
