//! The settings: technique with its settings, lights, camera, picture. Every change asks for a run.

use super::action::Action;
use super::settings_scene;
use super::state::State;
use super::theme;
use crate::technique::{Choice, SettingSpec, SettingValues, Technique};
use egui::{DragValue, RichText, Ui};

/// Draws the panel.
pub fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    if state.scene.is_none() {
        let text = match (&state.capture, &state.job) {
            (Some(_), _) => {
                "This is a capture folder: what is in it can be looked at, not run again. Open a scene to change settings."
            }
            (None, Some(_)) => "The settings appear here with the scene.",
            (None, None) => "Open a scene to choose its technique, lights and camera.",
        };
        ui.add(egui::Label::new(theme::note(text)).wrap());
        return;
    }
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        techniques(ui, state, actions);
        let mut changed = technique_settings(ui, state);
        if let Some(scene) = &mut state.scene {
            changed |= settings_scene::ui(ui, &mut scene.draft, scene.animated);
        }
        if changed {
            state.run_draft(actions);
        }
        if let Some(problem) = state.scene.as_ref().and_then(|scene| scene.problem.as_ref()) {
            ui.add_space(8.0);
            let text = RichText::new(format!("× Not run: {problem}")).color(theme::ERROR);
            ui.add(egui::Label::new(text).wrap());
        }
        ui.add_space(16.0);
    });
}

fn techniques(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    theme::heading(ui, "Technique");
    let Some(current) = state.scene.as_ref().map(|scene| scene.draft.choice.technique()) else { return };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for technique in Technique::ALL {
            let is_current = technique == current;
            let name = RichText::new(technique.name()).color(theme::TEXT);
            let button = egui::Button::selectable(is_current, name).frame_when_inactive(true);
            let button = ui.add(button).accessible_name(format!("Technique {}", technique.name()));
            if button.on_hover_text(technique.summary()).clicked() {
                state.choose_technique(technique, actions);
            }
        }
    });
    ui.add(egui::Label::new(theme::note(current.summary())).wrap());
}

/// The settings of the technique; true when one changed.
fn technique_settings(ui: &mut Ui, state: &mut State) -> bool {
    let Some(scene) = &mut state.scene else { return false };
    let mut changed = false;
    ui.add_space(8.0);
    egui::Grid::new("technique settings").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        for spec in scene.draft.choice.technique().settings() {
            let label = ui.label(theme::note(spec.key)).on_hover_text(spec.meaning);
            if let Some(value) = setting(ui, &scene.draft.choice, spec, label.id) {
                changed |= scene.draft.choice.set(spec.key, &value).is_ok();
            }
            ui.end_row();
        }
    });
    changed
}

/// The widget of one setting; its new value when it changed.
fn setting(ui: &mut Ui, choice: &Choice, spec: &SettingSpec, label: egui::Id) -> Option<String> {
    let current = choice.settings().get(spec.key).map_or(spec.default, String::as_str);
    match spec.values {
        // Nothing to choose: a fact, not a widget.
        SettingValues::OneOf([_] | []) => {
            ui.label(theme::number(current).color(theme::FAINT)).on_hover_text(spec.meaning);
            None
        }
        SettingValues::OneOf(words) => {
            let mut value = current.to_owned();
            let combo = egui::ComboBox::from_id_salt(spec.key).selected_text(current);
            let combo = combo.show_ui(ui, |ui| {
                for word in words {
                    ui.selectable_value(&mut value, (*word).to_owned(), *word);
                }
            });
            combo.response.labelled_by(label).on_hover_text(spec.meaning);
            (value != current).then_some(value)
        }
        SettingValues::Integer(low, high) => {
            let mut value: i64 = current.parse().unwrap_or(low);
            let widget = DragValue::new(&mut value).range(low..=high).update_while_editing(false);
            let response = ui.add(widget).labelled_by(label).on_hover_text(spec.meaning);
            response.changed().then(|| value.to_string())
        }
        SettingValues::Number(low, high) => {
            let mut value: f64 = current.parse().unwrap_or(low);
            let widget = DragValue::new(&mut value).range(low..=high).speed(0.05).update_while_editing(false);
            let response = ui.add(widget).labelled_by(label).on_hover_text(spec.meaning);
            response.changed().then(|| value.to_string())
        }
        SettingValues::WordOrNumber { word, prefix, low, high } => {
            let number = current.strip_prefix(prefix).and_then(|number| number.parse::<f64>().ok());
            ui.horizontal(|ui| {
                let mut is_word = number.is_none();
                let first = ui.checkbox(&mut is_word, word).labelled_by(label).on_hover_text(spec.meaning);
                if first.changed() {
                    // Far enough to look right until the light comes close.
                    return Some(if is_word {
                        word.to_owned()
                    } else {
                        format!("{prefix}{}", 100f64.clamp(low, high))
                    });
                }
                let mut value = number?;
                let widget = DragValue::new(&mut value).range(low..=high).speed(0.05).update_while_editing(false);
                let response = ui.add(widget.prefix(prefix)).labelled_by(label).on_hover_text(spec.meaning);
                response.changed().then(|| format!("{prefix}{value}"))
            })
            .inner
        }
    }
}
