//! The menu View: layouts of the panels, how large everything is, and the theme.

use crate::inspector::action::LayoutPreset;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::explained;
use crate::inspector::model::comparing::{Comparison, SidesLayout};
use crate::inspector::model::memory::ThemeChoice;
use crate::inspector::model::{Model, WindowPlace};
use egui::{Button, Ui};
use std::ops::RangeInclusive;

/// How much larger than usual everything may be: smaller, words can't be read; larger, nothing fits into a window.
pub const ZOOMS: RangeInclusive<f32> = 0.5..=3.0;
/// By how much a press makes everything larger or smaller, as egui's keys do.
const ZOOM_STEP: f32 = 0.1;
/// How large everything is for a projector, and the width that is left for the panels then, points: in a smaller window
/// everything is less large.
const LARGE: f32 = 1.4;
const LEAST_LARGE_WIDTH: f32 = 900.0;
/// Least width of the menu, points: its lines have keys at their ends.
const WIDTH: f32 = 176.0;

/// Draws the menu's entries.
pub fn menu(ui: &mut Ui, model: &mut Model) {
    ui.set_min_width(WIDTH);
    for preset in LayoutPreset::ALL {
        let entry = ui.selectable_label(model.layout == Some(preset), preset.name());
        if explained(ui, entry, preset.explanation()).clicked() {
            let width = ui.ctx().content_rect().width() * ui.ctx().zoom_factor();
            arrange(model, preset, width);
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

/// Asks for a layout, and for what it shows: two pictures to compare, type of a size. `width` is that of the window in points
/// of the usual size.
fn arrange(model: &mut Model, preset: LayoutPreset, width: f32) {
    model.requests.layout = Some(preset);
    match preset {
        LayoutPreset::First => model.requests.zoom = Some(1.0),
        LayoutPreset::Teach => {
            let fits = (width / LEAST_LARGE_WIDTH * 10.0).floor() / 10.0;
            model.requests.zoom = Some(fits.clamp(1.0, LARGE));
        }
        LayoutPreset::CompareTwo => {
            let compare = model.modes.compare.unwrap_or_else(|| model.other_technique());
            model.modes.compare = Some(Comparison { layout: SidesLayout::Beside, ..compare });
        }
        // Half of the window is too narrow for two pictures.
        LayoutPreset::PictureAndScene => model.modes.compare = None,
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
