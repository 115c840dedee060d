//! A row with one setting, in the grid under a heading.

use crate::inspector::look::widgets;
use egui::Ui;

/// Draws one setting in a row of a grid: a button that resets it to `before` where it differs, its name, its widget.
/// Returns true when `widget` returned true or it was reset. `name` is the setting's name for assistive technology,
/// `label` the one that is drawn.
pub fn row<T: PartialEq + Clone>(
    ui: &mut Ui,
    name: &str,
    label: &str,
    value: &mut T,
    before: &T,
    widget: impl FnOnce(&mut Ui, &mut T) -> bool,
) -> bool {
    let is_changed = value != before;
    let goes_back = widgets::reset(ui, name, is_changed, "what the scene was opened with");
    if goes_back {
        value.clone_from(before);
    }
    widgets::setting_name(ui, label, is_changed);
    let changed = widget(ui, value) || goes_back;
    ui.end_row();
    changed
}
