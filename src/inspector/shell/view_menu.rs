//! The menu View: layouts of the panels, how large everything is, and the theme.

use crate::inspector::action::LayoutPreset;
use crate::inspector::look::theme;
use crate::inspector::model::comparing::{Comparison, SidesLayout};
use crate::inspector::model::memory::ThemeChoice;
use crate::inspector::model::{Model, WindowPlace};
use egui::{Button, Ui};
use std::ops::RangeInclusive;

/// How much larger than usual everything may be: smaller, words can't be read; larger, nothing fits into a window.
pub const ZOOMS: RangeInclusive<f32> = 0.5..=3.0;
/// By how much a press makes everything larger or smaller, as egui's keys do.
const ZOOM_STEP: f32 = 0.1;
/// How large everything is for a projector.
const LARGE: f32 = 1.4;
/// Least width of the menu, points: its lines have keys at their ends.
const WIDTH: f32 = 176.0;

/// Draws the menu's entries.
pub fn menu(ui: &mut Ui, model: &mut Model) {
    ui.set_min_width(WIDTH);
    for preset in LayoutPreset::ALL {
        if ui.button(preset.name()).on_hover_text(preset.explanation()).clicked() {
            arrange(model, preset);
            ui.close();
        }
        if preset == LayoutPreset::First {
            ui.separator();
        }
    }
    ui.separator();
    sizes(ui, model);
    ui.separator();
    // "Light" alone could be taken for one of the scene's lights.
    let other = match model.theme.other() {
        ThemeChoice::Dark => "Dark theme",
        ThemeChoice::Light => "Light theme",
    };
    if ui.add(with_keys(other, "Ctrl-L")).on_hover_text("Every colour means the same in both").clicked() {
        model.theme = model.theme.other();
        ui.close();
    }
}

/// Asks for a layout, and for what it shows: two pictures to compare, type of a size.
fn arrange(model: &mut Model, preset: LayoutPreset) {
    model.requests.layout = Some(preset);
    match preset {
        LayoutPreset::First => model.requests.zoom = Some(1.0),
        LayoutPreset::Teach => model.requests.zoom = Some(LARGE),
        LayoutPreset::CompareTwo => {
            let compare = model.modes.compare.unwrap_or_else(|| model.other_technique());
            model.modes.compare = Some(Comparison { layout: SidesLayout::Beside, ..compare });
        }
        LayoutPreset::PictureAndScene => {}
    }
}

/// Draws the entries that change how large everything is. In a page the browser has keys for it, which do the same to all
/// pages.
fn sizes(ui: &mut Ui, model: &mut Model) {
    let zoom = model.zoom.unwrap_or(1.0);
    let keys = |keys| if model.place == WindowPlace::Desktop { keys } else { "" };
    let [least, most] = [*ZOOMS.start(), *ZOOMS.end()];
    let step = |by: f32| (((zoom + by) * 10.0).round() / 10.0).clamp(least, most);
    let entries = [
        ("Larger", keys("Ctrl-+"), step(ZOOM_STEP)),
        ("Smaller", keys("Ctrl-−"), step(-ZOOM_STEP)),
        ("Usual size", keys("Ctrl-0"), 1.0),
    ];
    ui.label(theme::note(format!("Everything at {:.0} %", zoom * 100.0)));
    for (name, keys, next) in entries {
        if ui.add_enabled(next != zoom, with_keys(name, keys)).clicked() {
            model.requests.zoom = Some(next);
        }
    }
}

fn with_keys(name: &str, keys: &str) -> Button<'static> {
    let button = Button::new(name.to_owned());
    if keys.is_empty() { button } else { button.shortcut_text(theme::number(keys)) }
}
