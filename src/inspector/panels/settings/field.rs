//! The widget of one setting of a technique: a number, words, or words with numbers.

use crate::inspector::look::number_field::number_field;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{explained, menu_button};
use crate::reading::setting_values;
use crate::technique::{SettingSpec, SettingValues};
use egui::{ComboBox, DragValue, Id, Response, TextEdit, Ui};
use std::ops::RangeInclusive;

/// Least width of a list of words, points.
const LEAST_LIST: f32 = 56.0;
/// Width of a field beside a list, with the gap between, points.
const FIELD: f32 = 68.0;

/// A setting as it is drawn.
pub struct SettingField<'a> {
    /// The setting.
    pub spec: &'a SettingSpec,
    /// Its value.
    pub current: &'a str,
    /// The widget that names it.
    pub label: Id,
    /// What it does, and why it does nothing now where that is so.
    pub hover: String,
}

impl SettingField<'_> {
    /// Draws the widget, or plain text where there is only one value; returns the new value when it changed.
    pub fn ui(&self, ui: &mut Ui) -> Option<String> {
        match self.spec.values {
            // There is nothing to choose, so this is text, not a widget.
            SettingValues::OneOf([_] | []) => {
                self.explained(ui.label(theme::number(self.current).color(theme::of(ui).faint)));
                None
            }
            SettingValues::OneOf(words) => self.choose(ui, words, self.current, false),
            SettingValues::SomeOf(words) => self.some_of(ui, words),
            SettingValues::WordOr { words, prefix, low, high, whole } => {
                let numbered = prefix.trim_end_matches(':');
                let number = self.current.strip_prefix(prefix).and_then(|number| number.parse::<f64>().ok());
                let options: Vec<&str> = words.iter().copied().chain([numbered]).collect();
                ui.horizontal(|ui| {
                    let chosen = self.choose(ui, &options, number.map_or(self.current, |_| numbered), number.is_some());
                    let chosen =
                        chosen.map(|word| if word == numbered { format!("{prefix}{}", low.max(3.0)) } else { word });
                    let Some(mut value) = number else { return chosen };
                    let looks =
                        |widget| if whole { DragValue::fixed_decimals(widget, 0) } else { self.any_size(widget) };
                    let response = self.number(ui, numbered, &mut value, low..=high, looks);
                    chosen.or(response.changed().then(|| format!("{prefix}{value}")))
                })
                .inner
            }
            SettingValues::WordOrFrustum(words) => self.frustum(ui, words),
            SettingValues::DepthRange => self.depth_range(ui),
            SettingValues::Receivers(words) => self.receivers(ui, words),
            SettingValues::Integer(low, high) => {
                let mut value: i64 = self.current.parse().unwrap_or(low);
                let widget = number_field(&mut value, low as f64..=high as f64, |widget| widget);
                self.explained(ui.add(widget).labelled_by(self.label)).changed().then(|| value.to_string())
            }
            SettingValues::Number(low, high) => {
                let mut value: f64 = self.current.parse().unwrap_or(low);
                let widget = number_field(&mut value, low..=high, |widget| self.any_size(widget));
                self.explained(ui.add(widget).labelled_by(self.label)).changed().then(|| value.to_string())
            }
        }
    }

    /// Returns the response, with what the setting does on hover.
    fn explained(&self, response: Response) -> Response {
        response.on_hover_text(&self.hover).on_disabled_hover_text(&self.hover)
    }

    /// Draws a field for a number that is a part of the setting, under the setting's name with `part`.
    fn number<'a>(
        &self,
        ui: &mut Ui,
        part: &str,
        value: &'a mut f64,
        range: RangeInclusive<f64>,
        looks: impl FnOnce(DragValue<'a>) -> DragValue<'a>,
    ) -> Response {
        let field = ui.add(number_field(value, range, looks));
        self.explained(field.accessible_name(format!("{} {part}", self.spec.key)))
    }

    /// Draws the widget for one of several words, of which `current` is chosen, with space for a field beside it where one
    /// `follows`; returns the new word when it changed.
    fn choose(&self, ui: &mut Ui, words: &[&str], current: &str, follows: bool) -> Option<String> {
        let mut value = current.to_owned();
        // Where the panel is narrow and names are long, as wide as there is space for.
        let beside = if follows { FIELD } else { 0.0 };
        let width = ui.spacing().combo_width.min(ui.available_width() - beside).max(LEAST_LIST);
        let combo = ComboBox::from_id_salt(self.spec.key).selected_text(current).width(width).truncate();
        let combo = combo.show_ui(ui, |ui| {
            for word in words {
                let line = ui.selectable_value(&mut value, (*word).to_owned(), *word);
                explained(ui, line, &setting_values::meaning(self.spec, word));
            }
        });
        self.explained(combo.response.labelled_by(self.label).on_hover_text(current));
        (value != current).then_some(value)
    }

    /// Draws the choice between words and a frustum's numbers, and fields for these where they are chosen. Returns the
    /// new value when it changed.
    fn frustum(&self, ui: &mut Ui, words: &[&str]) -> Option<String> {
        const NUMBERS: &str = "FOV:NEAR:FAR";
        const FIRST: &str = "90:0.1:100";
        let numbers: Vec<f64> = self.current.split(':').filter_map(|number| number.parse().ok()).collect();
        let given: Option<[f64; 3]> = numbers.try_into().ok();
        let options: Vec<&str> = words.iter().copied().chain([NUMBERS]).collect();
        ui.horizontal_wrapped(|ui| {
            let chosen = self.choose(ui, &options, given.map_or(self.current, |_| NUMBERS), false);
            let chosen = chosen.map(|word| if word == NUMBERS { FIRST.to_owned() } else { word });
            let Some(mut given) = given else { return chosen };
            let mut is_changed = false;
            for (number, part) in given.iter_mut().zip(["field of view", "near", "far"]) {
                is_changed |= self.number(ui, part, number, 1e-6..=1e9, |widget| self.any_size(widget)).changed();
            }
            let [fov, near, far] = given;
            chosen.or(is_changed.then(|| format!("{fov}:{near}:{far}")))
        })
        .inner
    }

    /// Draws fields for both ends of a range of depths, which stay in order. Returns the new value when it changed.
    fn depth_range(&self, ui: &mut Ui) -> Option<String> {
        let (near, far) = self.current.split_once(',')?;
        let [mut near, mut far] = [near, far].map(|end| end.trim().parse().unwrap_or(0.0_f64));
        ui.horizontal(|ui| {
            let looks = |widget| DragValue::speed(widget, 0.005).max_decimals(6);
            let (low, high) = (near, far);
            let is_near = self.number(ui, "near", &mut near, 0.0..=high, looks).changed();
            let is_far = self.number(ui, "far", &mut far, low..=1.0, looks).changed();
            (is_near || is_far).then(|| format!("{near},{far}"))
        })
        .inner
    }

    /// Draws the choice between the ways to choose receivers, and a field for the number or the names of the chosen one.
    /// Returns the new value when it changed.
    fn receivers(&self, ui: &mut Ui, words: &[&str]) -> Option<String> {
        let (word, rest) = self.current.split_once(':').unwrap_or((self.current, ""));
        ui.horizontal(|ui| {
            let chosen = self.choose(ui, words, word, !rest.is_empty()).map(|word| match word.as_str() {
                "share" => "share:0.5".to_owned(),
                "largest" => "largest:3".to_owned(),
                "named" => "named:floor".to_owned(),
                _ => word,
            });
            let mut value: f64 = rest.parse().unwrap_or(1.0);
            let field = match word {
                "share" => {
                    let looks = |widget| DragValue::speed(widget, 0.05).suffix("\u{a0}%");
                    self.number(ui, word, &mut value, 0.0..=100.0, looks).changed().then(|| format!("{word}:{value}"))
                }
                "largest" => {
                    let looks = |widget| DragValue::speed(widget, 0.1).fixed_decimals(0);
                    self.number(ui, word, &mut value, 1.0..=1e6, looks).changed().then(|| format!("{word}:{value}"))
                }
                "named" => self.names(ui, rest),
                _ => None,
            };
            chosen.or(field)
        })
        .inner
    }

    /// Draws a field for names, of which `current` are set. What is typed is taken when the field is left: half a name is
    /// none. Returns the new value when it changed.
    fn names(&self, ui: &mut Ui, current: &str) -> Option<String> {
        let id = ui.scope_id().with((self.spec.key, "names"));
        let mut text = ui.data_mut(|data| data.get_temp::<String>(id)).unwrap_or_else(|| current.to_owned());
        let response = self
            .explained(ui.add(TextEdit::singleline(&mut text).desired_width(ui.available_width().clamp(FIELD, 140.0))));
        let response = response.accessible_name(format!("{} named", self.spec.key));
        if !response.lost_focus() {
            ui.data_mut(|data| data.insert_temp(id, text));
            return None;
        }
        ui.data_mut(|data| data.remove::<String>(id));
        (text != current && !text.trim().is_empty()).then(|| format!("named:{text}"))
    }

    /// Draws a menu of words to tick. Returns the new value when it changed: the ticked words, separated by commas,
    /// `all` or `none`.
    fn some_of(&self, ui: &mut Ui, words: &[&str]) -> Option<String> {
        let is_ticked = |word: &str| self.current == "all" || self.current.split(',').any(|one| one.trim() == word);
        let ticked: Vec<&str> = words.iter().copied().filter(|word| is_ticked(word)).collect();
        let shown = match ticked.len() {
            0 => "none".to_owned(),
            count if count == words.len() => "all".to_owned(),
            count => format!("{count} of {}", words.len()),
        };
        let mut chosen = None;
        let menu = menu_button(ui, &shown, |ui| {
            theme::outline_boxes(ui);
            for word in words {
                let mut is_on = ticked.contains(word);
                let line = ui.checkbox(&mut is_on, *word);
                if explained(ui, line, &setting_values::meaning(self.spec, word)).changed() {
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
        self.explained(menu.response.accessible_name(self.spec.key));
        chosen
    }

    /// Sets up a number that may be tiny: for a value below 0.001 (the number after the last `:`), dragging changes it in
    /// proportion, and it is shown as a power of ten.
    fn any_size<'a>(&self, widget: DragValue<'a>) -> DragValue<'a> {
        let number = self.current.rsplit(':').next().and_then(|number| number.parse::<f64>().ok());
        let size = number.map_or(0.0, f64::abs);
        if size == 0.0 || size >= 1e-3 {
            return widget.speed(0.05);
        }
        widget.speed(size * 0.02).custom_formatter(|value, _| format!("{value:.1e}"))
    }
}
