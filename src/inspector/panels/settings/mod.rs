//! The settings: technique with its settings, lights, camera, picture. Every change asks for a run.

pub mod animation;
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
use crate::technique::{Choice, SettingSpec, SettingValues, Technique};
use egui::{DragValue, RichText, Ui};
use std::sync::Arc;

/// Draws the panel Scene settings: the technique and its settings, lights, camera and objects of the open scene; a
/// change runs it. Where no scene is open, only why nothing can be set.
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
        techniques(ui, model, actions);
        let mut changed = technique_settings(ui, model);
        if let Some(scene) = &mut model.scene {
            changed |= up_axis::ui(ui, scene);
            changed |= scene::ui(ui, scene);
            changed |= making::ui(ui, scene);
        }
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

fn techniques(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    theme::heading(ui, "Technique");
    let Some(current) = model.scene.as_ref().map(|scene| scene.draft.choice.technique()) else { return };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for technique in Technique::ALL {
            let is_current = technique == current;
            let name = RichText::new(technique.name()).color(theme::of(ui).text);
            let button = egui::Button::selectable(is_current, name).frame_when_inactive(true);
            let button = ui.add(button).accessible_name(format!("Technique {}", technique.name()));
            if button.on_hover_text(technique.summary()).clicked() {
                model.choose_technique(technique, actions);
            }
        }
    });
    ui.add(egui::Label::new(theme::note(current.summary())).wrap());
}

/// Draws the settings of the technique in use, each with a reset button where it was changed and off where it has no
/// effect; returns true when one changed. Nothing is run.
fn technique_settings(ui: &mut Ui, model: &mut Model) -> bool {
    let Some(scene) = &mut model.scene else { return false };
    let mut changed = false;
    ui.add_space(8.0);
    egui::Grid::new("technique settings").num_columns(3).min_col_width(0.0).spacing([6.0, 4.0]).show(ui, |ui| {
        for spec in scene.draft.choice.technique().settings() {
            let off = scene.draft.choice.without_effect(spec.key);
            let is_changed = scene.draft.choice.settings().get(spec.key).is_some_and(|value| value != spec.default);
            if widgets::reset(ui, spec.key, is_changed, spec.default) {
                changed |= scene.draft.choice.set(spec.key, spec.default).is_ok();
            }
            let label = match off {
                Some(_) => ui.label(theme::note(spec.key).color(theme::of(ui).faint)),
                None => widgets::setting_name(ui, spec.key, is_changed),
            };
            let label = label.on_hover_text(hover(spec, off));
            let value = ui.add_enabled_ui(off.is_none(), |ui| setting(ui, &scene.draft.choice, spec, label.id, off));
            if let Some(value) = value.inner {
                changed |= scene.draft.choice.set(spec.key, &value).is_ok();
            }
            ui.end_row();
        }
    });
    changed
}

/// Returns what a setting does, with a capital letter, and after an empty line the reason `off` why it does nothing
/// now, if any.
fn hover(spec: &SettingSpec, off: Option<&str>) -> String {
    let mut letters = spec.meaning.chars();
    let meaning: String =
        letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect());
    off.map_or_else(|| meaning.clone(), |reason| format!("{meaning}\n\n{reason}"))
}

/// Draws the widget of one setting, or plain text where it has only one value; returns its new value when it changed.
/// On hover it shows what it does and why it is `off`.
fn setting(ui: &mut Ui, choice: &Choice, spec: &SettingSpec, label: egui::Id, off: Option<&str>) -> Option<String> {
    let hover = hover(spec, off);
    let explained = |response: egui::Response| response.on_hover_text(&hover).on_disabled_hover_text(&hover);
    let current = choice.settings().get(spec.key).map_or(spec.default, String::as_str);
    match spec.values {
        // There is nothing to choose, so this is text, not a widget.
        SettingValues::OneOf([_] | []) => {
            explained(ui.label(theme::number(current).color(theme::of(ui).faint)));
            None
        }
        SettingValues::OneOf(words) => {
            let (response, chosen) = choose(ui, spec.key, words, current);
            explained(response.labelled_by(label));
            chosen
        }
        SettingValues::SomeOf(words) => some_of(ui, spec.key, words, current, &explained),
        SettingValues::WordOr { words, prefix, low, high, whole } => {
            let number = current.strip_prefix(prefix).and_then(|number| number.parse::<f64>().ok());
            let numbered = prefix.trim_end_matches(':');
            let options: Vec<&str> = words.iter().copied().chain([numbered]).collect();
            ui.horizontal(|ui| {
                let (response, chosen) = choose(ui, spec.key, &options, number.map_or(current, |_| numbered));
                explained(response.labelled_by(label));
                let chosen =
                    chosen.map(|word| if word == numbered { format!("{prefix}{}", low.max(3.0)) } else { word });
                let Some(mut value) = number else { return chosen };
                let widget = DragValue::new(&mut value).range(low..=high).update_while_editing(false);
                let widget = if whole { widget.fixed_decimals(0) } else { any_size(widget, current) };
                let response = explained(ui.add(widget).accessible_name(format!("{} {numbered}", spec.key)));
                let number = response.changed().then(|| format!("{prefix}{value}"));
                chosen.or(number)
            })
            .inner
        }
        SettingValues::WordOrFrustum(words) => frustum(ui, spec.key, words, current, label, &explained),
        SettingValues::Receivers(words) => receivers(ui, spec.key, words, current, label, &explained),
        SettingValues::Integer(low, high) => {
            let mut value: i64 = current.parse().unwrap_or(low);
            let widget = DragValue::new(&mut value).range(low..=high).update_while_editing(false);
            explained(ui.add(widget).labelled_by(label)).changed().then(|| value.to_string())
        }
        SettingValues::Number(low, high) => {
            let mut value: f64 = current.parse().unwrap_or(low);
            let widget = any_size(DragValue::new(&mut value).range(low..=high), current);
            explained(ui.add(widget).labelled_by(label)).changed().then(|| value.to_string())
        }
    }
}

/// Draws the choice between words and a frustum's numbers, and fields for these where they are chosen. Returns the new
/// value when it changed.
fn frustum(
    ui: &mut Ui,
    name: &str,
    words: &[&str],
    current: &str,
    label: egui::Id,
    explained: &impl Fn(egui::Response) -> egui::Response,
) -> Option<String> {
    const NUMBERS: &str = "FOV:NEAR:FAR";
    const FIRST: &str = "90:0.1:100";
    let numbers: Vec<f64> = current.split(':').filter_map(|number| number.parse().ok()).collect();
    let given: Option<[f64; 3]> = numbers.try_into().ok();
    let options: Vec<&str> = words.iter().copied().chain([NUMBERS]).collect();
    ui.horizontal_wrapped(|ui| {
        let (response, chosen) = choose(ui, name, &options, given.map_or(current, |_| NUMBERS));
        explained(response.labelled_by(label));
        let chosen = chosen.map(|word| if word == NUMBERS { FIRST.to_owned() } else { word });
        let Some(mut given) = given else { return chosen };
        let mut is_changed = false;
        for (number, part) in given.iter_mut().zip(["field of view", "near", "far"]) {
            let widget = any_size(DragValue::new(number).range(1e-6..=1e9).update_while_editing(false), current);
            let response = ui.add(widget).accessible_name(format!("{name} {part}"));
            is_changed |= explained(response).changed();
        }
        let [fov, near, far] = given;
        chosen.or(is_changed.then(|| format!("{fov}:{near}:{far}")))
    })
    .inner
}

/// Draws the choice between the ways to choose receivers, and a field for the number or the names of the chosen one.
/// Returns the new value when it changed.
fn receivers(
    ui: &mut Ui,
    name: &str,
    words: &[&str],
    current: &str,
    label: egui::Id,
    explained: &impl Fn(egui::Response) -> egui::Response,
) -> Option<String> {
    let (word, rest) = current.split_once(':').unwrap_or((current, ""));
    ui.horizontal(|ui| {
        let (response, chosen) = choose(ui, name, words, word);
        explained(response.labelled_by(label));
        let chosen = chosen.map(|word| match word.as_str() {
            "share" => "share:0.5".to_owned(),
            "largest" => "largest:3".to_owned(),
            "named" => "named:floor".to_owned(),
            _ => word,
        });
        let label = format!("{name} {word}");
        let field = match word {
            "share" | "largest" => {
                let mut value: f64 = rest.parse().unwrap_or(1.0);
                let widget = DragValue::new(&mut value).update_while_editing(false);
                let widget = match word {
                    "share" => widget.range(0.0..=100.0).speed(0.05).suffix("\u{a0}%"),
                    _ => widget.range(1.0..=1e6).speed(0.1).fixed_decimals(0),
                };
                let response = explained(ui.add(widget).accessible_name(label));
                response.changed().then(|| format!("{word}:{value}"))
            }
            "named" => {
                // What is typed is taken when the field is left: half a name is none.
                let id = ui.scope_id().with((name, "names"));
                let mut text = ui.data_mut(|data| data.get_temp::<String>(id)).unwrap_or_else(|| rest.to_owned());
                let response = explained(ui.add(egui::TextEdit::singleline(&mut text).desired_width(140.0)));
                let response = response.accessible_name(label);
                if response.lost_focus() {
                    ui.data_mut(|data| data.remove::<String>(id));
                    (text != rest && !text.trim().is_empty()).then(|| format!("named:{text}"))
                } else {
                    ui.data_mut(|data| data.insert_temp(id, text));
                    None
                }
            }
            _ => None,
        };
        chosen.or(field)
    })
    .inner
}

/// Draws a menu of words to tick. Returns the new value when it changed: the ticked words, separated by commas, `all`
/// or `none`.
fn some_of(
    ui: &mut Ui,
    name: &str,
    words: &[&str],
    current: &str,
    explained: &impl Fn(egui::Response) -> egui::Response,
) -> Option<String> {
    let is_ticked = |word: &str| current == "all" || current.split(',').any(|one| one.trim() == word);
    let ticked: Vec<&str> = words.iter().copied().filter(|word| is_ticked(word)).collect();
    let shown = match ticked.len() {
        0 => "none".to_owned(),
        count if count == words.len() => "all".to_owned(),
        count => format!("{count} of {}", words.len()),
    };
    let mut chosen = None;
    let menu = ui.menu_button(shown, |ui| {
        for word in words {
            let mut is_on = ticked.contains(word);
            if ui.checkbox(&mut is_on, *word).changed() {
                let on = |other: &&&str| if **other == *word { is_on } else { ticked.contains(*other) };
                let some: Vec<&str> = words.iter().filter(on).copied().collect();
                chosen = Some(match some.len() {
                    0 => "none".to_owned(),
                    count if count == words.len() => "all".to_owned(),
                    _ => some.join(","),
                });
            }
        }
    });
    explained(menu.response.accessible_name(name));
    chosen
}

/// Sets up a number that may be tiny: for a value below 0.001 (the number after the last `:` of `current`), dragging
/// changes it in proportion, and it is shown as a power of ten. Changes take effect when editing ends.
fn any_size<'a>(widget: DragValue<'a>, current: &str) -> DragValue<'a> {
    let size = current.rsplit(':').next().and_then(|number| number.parse::<f64>().ok()).map_or(0.0, f64::abs);
    if size == 0.0 || size >= 1e-3 {
        return widget.speed(0.05).update_while_editing(false);
    }
    widget.speed(size * 0.02).update_while_editing(false).custom_formatter(|value, _| format!("{value:.1e}"))
}

/// Draws the widget for one of several words, of which `current` is chosen; returns its response, and the new word when
/// it changed.
fn choose(ui: &mut Ui, key: &str, words: &[&str], current: &str) -> (egui::Response, Option<String>) {
    let mut value = current.to_owned();
    let combo = egui::ComboBox::from_id_salt(key).selected_text(current);
    let combo = combo.show_ui(ui, |ui| {
        for word in words {
            ui.selectable_value(&mut value, (*word).to_owned(), *word);
        }
    });
    (combo.response, (value != current).then_some(value))
}
