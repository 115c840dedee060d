//! The settings: lights, what is added, those of the technique, camera, picture. Every change asks for a run.

pub mod animation;
mod field;
mod groups;
pub mod making;
pub mod meshes;
mod projection;
mod row;
pub mod scene;
pub mod up_axis;

use crate::ask::MeshesOf;
use crate::inspector::action::Action;
use crate::inspector::look::{theme, widgets};
use crate::inspector::model::Model;
use crate::reading::format;
use crate::technique::SettingSpec;
use egui::{RichText, Ui};
use field::SettingField;
use groups::SettingGroup;
use std::sync::Arc;

/// Draws the panel Scene settings: lights, the technique's settings, camera and objects of the open scene; a change runs
/// it. Where no scene is open, only why nothing can be set.
pub fn ui(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    if model.scene.is_none() {
        let text = match (&model.frame.capture, &model.activity.job) {
            (Some(_), _) if model.origin().is_some() => {
                "Another program drew this frame: its lights, camera and technique can't be changed here."
            }
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
        animation::ui(ui, model, actions);
        // Lights come first: they are moved more often than a technique's two dozen settings are changed.
        let mut changed = model.scene.as_mut().is_some_and(|scene| scene::lights(ui, scene) | making::ui(ui, scene));
        changed |= technique_settings(ui, model);
        changed |= model.scene.as_mut().is_some_and(|scene| up_axis::ui(ui, scene) | scene::ui(ui, scene));
        if changed {
            model.run_draft(actions);
        }
        if let Some(problem) = model.scene.as_ref().and_then(|scene| scene.problem.as_ref()) {
            ui.add_space(8.0);
            let text = RichText::new(format!("× Not run: {problem}")).color(theme::of(ui).error);
            ui.add(egui::Label::new(text).wrap());
        }
        ui.add_space(12.0);
        let objects = model.scene.iter().flat_map(|scene| &scene.draft.objects.added);
        let added = objects.map(|object| (object.name.clone(), Arc::clone(&object.mesh))).collect();
        let known = model.answers.want(MeshesOf { added }).ready;
        meshes::ui(ui, known.as_ref().map(|meshes| &meshes[..]));
        ui.add_space(16.0);
    });
}

/// Draws the settings of the technique in use in groups under headings, each with a reset button where it was changed and
/// off where it has no effect; returns true when one changed. Nothing is run.
fn technique_settings(ui: &mut Ui, model: &mut Model) -> bool {
    let Some(scene) = &mut model.scene else { return false };
    let mut changed = false;
    ui.add_space(12.0);
    let technique = scene.draft.choice.technique();
    theme::heading(ui, &format!("Settings of {}", technique.name()));
    ui.add(egui::Label::new(theme::note(technique.summary())).wrap());
    egui::Grid::new("technique settings").num_columns(3).min_col_width(0.0).spacing([6.0, 4.0]).show(ui, |ui| {
        let mut specs: Vec<&SettingSpec> = technique.settings().iter().collect();
        specs.sort_by_key(|spec| SettingGroup::of(spec.key));
        let mut before = None;
        for spec in specs {
            let group = SettingGroup::of(spec.key);
            if before.replace(group) != Some(group) {
                group_heading(ui, group);
            }
            let off = scene.draft.choice.without_effect(spec.key);
            let value = scene.draft.choice.settings().get(spec.key);
            let is_changed = value.is_some_and(|value| !is_same(value, spec.default));
            if widgets::reset(ui, spec.key, is_changed, spec.default) {
                changed |= scene.draft.choice.set(spec.key, spec.default).is_ok();
            }
            let label = match off {
                Some(_) => ui.label(theme::note(spec.key).color(theme::of(ui).faint)),
                None => widgets::setting_name(ui, spec.key, is_changed),
            };
            let hover = hover(spec, off);
            let label = label.on_hover_text(&hover).id;
            let current = scene.draft.choice.settings().get(spec.key).map_or(spec.default, String::as_str);
            let field = SettingField { spec, current, label, hover };
            if let Some(value) = ui.add_enabled_ui(off.is_none(), |ui| field.ui(ui)).inner {
                changed |= scene.draft.choice.set(spec.key, &value).is_ok();
            }
            ui.end_row();
        }
    });
    changed
}

/// Returns whether two values of a setting mean the same: their numbers may be written in several ways, such as `2` and
/// `2.0`.
pub fn is_same(one: &str, other: &str) -> bool {
    let parts = |value: &str| -> Vec<String> {
        let normal = |part: &str| part.trim().parse::<f64>().map_or_else(|_| part.trim().to_owned(), |n| n.to_string());
        value.split([',', ':']).map(normal).collect()
    };
    one == other || parts(one) == parts(other)
}

/// Draws a row with the name of a group, over the names of its settings.
fn group_heading(ui: &mut Ui, group: SettingGroup) {
    ui.label("");
    ui.label(theme::note(group.name()).strong()).on_hover_text(group.explanation());
    ui.end_row();
}

/// Returns what a setting does, with a capital letter, and after an empty line the reason `off` why it does nothing
/// now, if any.
fn hover(spec: &SettingSpec, off: Option<&str>) -> String {
    let meaning = format::capitalized(spec.meaning);
    off.map_or_else(|| meaning.clone(), |reason| format!("{meaning}\n\n{reason}"))
}
