//! The picture's second row of tools: what to draw over it and what to compare with; before, after, the change; bits of
//! the stencil.

use super::overlays;
use crate::capture::Capture;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{ButtonSegment, explained, segments_of};
use crate::inspector::model::Model;
use crate::inspector::model::comparing::{ComparedWith, SidesLayout, step_words};
use crate::inspector::model::looking::StepPhase;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::technique::Technique;
use egui::{Button, Ui, vec2};

/// Tools in the second row that stay together where it wraps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ToolGroup {
    /// What to show beside the picture, and over it.
    BesideAndOver,
    /// The state before, the state after, the change.
    Phases,
    /// The choice of a bit, of stencil pictures.
    Bits,
    /// The other tools of one kind of picture.
    Options,
    /// What to compare with.
    ComparedWith,
    /// How the compared pictures are shown.
    ComparedHow,
}

impl ToolGroup {
    /// All, the permanent ones first, so that they do not move.
    pub const ALL: [ToolGroup; 6] = [
        ToolGroup::BesideAndOver,
        ToolGroup::Phases,
        ToolGroup::Bits,
        ToolGroup::Options,
        ToolGroup::ComparedWith,
        ToolGroup::ComparedHow,
    ];
}

/// Least width of the list of what to compare with, and its height before it scrolls, points.
const LIST_WIDTH: f32 = 380.0;
const LIST_HEIGHT: f32 = 560.0;
/// Width of the list of layouts, points.
const LAYOUT_WIDTH: f32 = 72.0;
/// Width of a setting's name before its values, points.
const KEY_WIDTH: f32 = 104.0;

/// Draws a group of the tools for `shown`, those for one kind of picture only for that. Comparison and overlays are off
/// where several images are shown at once.
pub fn ui(ui: &mut Ui, group: ToolGroup, model: &mut Model, capture: &Capture, shown: Option<&ShownPicture>) {
    let kind = shown.map(|shown| shown.kind).or_else(|| model.kind());
    let is_single = shown.is_none_or(|shown| shown.images.len() == 1);
    match group {
        ToolGroup::BesideAndOver => {
            ui.add_enabled_ui(is_single, |ui| {
                toggle(ui, model);
                overlays::menu(ui, model);
            });
        }
        ToolGroup::Phases => phases(ui, model, kind),
        ToolGroup::ComparedWith => compared_with(ui, model, capture),
        ToolGroup::ComparedHow => compared_how(ui, model),
        ToolGroup::Bits if kind == Some(PictureKind::Stencil) => bits(ui, model),
        ToolGroup::Bits | ToolGroup::Options => {}
    }
}

/// Draws the choice between the state before, the state after, and the change or, while comparing, the difference; it is
/// off, but stays in its place, for kinds of picture without such states.
fn phases(ui: &mut Ui, model: &mut Model, kind: Option<PictureKind>) {
    let has_phases = kind.is_some_and(PictureKind::has_phases);
    let is_compared = model.modes.compare.is_some();
    // Of two sides the difference is shown, whatever the kind.
    let can_show = |phase: StepPhase| has_phases || is_compared && phase != StepPhase::Before;
    let segment = |phase: StepPhase| {
        let is_enabled = can_show(phase);
        let explanation = if is_enabled { phase.explanation() } else { "Of colour, stencil and depth only" };
        ButtonSegment { is_enabled, ..ButtonSegment::new(phase.name(), explanation) }
    };
    let chosen = StepPhase::ALL.iter().position(|phase| *phase == model.modes.phase);
    let chosen = chosen.filter(|_| can_show(model.modes.phase));
    if let Some(index) = segments_of(ui, &StepPhase::ALL.map(segment), chosen) {
        model.modes.phase = StepPhase::ALL[index];
    }
}

fn bits(ui: &mut Ui, model: &mut Model) {
    let name = |bit: Option<u8>| bit.map_or_else(|| "All bits".to_owned(), |bit| format!("Bit {bit}"));
    let combo = egui::ComboBox::new("picture bits", "").width(76.0).selected_text(name(model.modes.bit));
    let combo = combo.show_ui(ui, |ui| {
        for bit in std::iter::once(None).chain((0..8).map(Some)) {
            ui.selectable_value(&mut model.modes.bit, bit, name(bit));
        }
    });
    let hover = "One bit of every value as a plane of its own; bit 0 is the lowest";
    combo.response.on_hover_text(hover).accessible_name("Bits of the stencil");
}

fn toggle(ui: &mut Ui, model: &mut Model) {
    let is_on = model.modes.compare.is_some();
    let word = theme::switch_word(ui, "Compare", is_on);
    let button = ui.add(Button::selectable(is_on, word));
    let button = button.on_disabled_hover_text("Several pictures at once: choose one of them to compare it");
    if button.on_hover_text("Another step, technique or setting beside this picture").clicked() {
        model.modes.compare = if is_on { None } else { Some(model.first_comparison()) };
    }
}

/// Draws, while comparing, the list of what to compare the picture with, in groups: where a scene is open, other techniques
/// and other settings, a line for each; then the steps.
fn compared_with(ui: &mut Ui, model: &mut Model, capture: &Capture) {
    let settings = model.settings_to_compare();
    let has_scene = model.scene.is_some();
    let has_fix = model.fix_in_use().is_some();
    let change = model.before_last_change().and_then(|_| model.undo.undoes(model.object_names()));
    let step = model.selection.step;
    let Some(compare) = &mut model.modes.compare else { return };
    ui.label(theme::note("with"));
    let combo = egui::ComboBox::new("compare with", "").width(112.0).truncate();
    let combo = combo.selected_text(compare.with.words(capture)).height(LIST_HEIGHT).show_ui(ui, |ui| {
        if has_scene {
            ui.set_min_width(LIST_WIDTH);
            ui.set_max_width(LIST_WIDTH);
            if has_fix || compare.with == ComparedWith::BeforeFix {
                let line = entry(ui, &mut compare.with, ComparedWith::BeforeFix, "before the fix", "before the fix");
                explained(ui, line, "The frame as it was before the fix that was applied last");
            }
            if change.is_some() || compare.with == ComparedWith::BeforeChange {
                let words = change.map_or_else(String::new, |change| format!(": {change}"));
                let chosen = compare.with == ComparedWith::BeforeChange;
                let line = ui.add(Button::selectable(chosen, format!("before the change{words}")).truncate());
                if line.clicked() {
                    compare.with = ComparedWith::BeforeChange;
                }
                explained(ui, line, "The frame as it was before what Undo takes back");
            }
            ui.label(theme::note("Another technique").strong());
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for technique in Technique::ALL.into_iter().filter(|technique| technique.name() != capture.technique) {
                    let words = format!("technique {}", technique.name());
                    let other = ComparedWith::Technique(technique);
                    let line = entry(ui, &mut compare.with, other, technique.name(), &words);
                    explained(ui, line, technique.summary());
                }
            });
            ui.label(theme::note(format!("Another setting of {}", capture.technique)).strong());
            for group in settings.chunk_by(|one, other| one.key().is_some() && one.key() == other.key()) {
                ui.horizontal_top(|ui| {
                    ui.spacing_mut().item_spacing.x = 2.0;
                    let size = vec2(KEY_WIDTH, ui.spacing().interact_size.y);
                    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
                        ui.set_min_width(KEY_WIDTH);
                        ui.label(theme::note(group[0].key().unwrap_or("all of them")));
                    });
                    // Values that wrap stay beside their name.
                    let rest = vec2((LIST_WIDTH - KEY_WIDTH).min(ui.available_width()), size.y);
                    let layout = egui::Layout::left_to_right(egui::Align::Center).with_main_wrap(true);
                    ui.allocate_ui_with_layout(rest, layout, |ui| {
                        for other in group {
                            entry(ui, &mut compare.with, *other, other.value(), &other.words(capture));
                        }
                    });
                });
            }
            ui.label(theme::note("Another step").strong());
        }
        for other in 0..capture.steps.len() {
            let this = if other == step { " (this)" } else { "" };
            let text = format!("{}{this}", step_words(capture, other));
            ui.selectable_value(&mut compare.with, ComparedWith::Step(other), text);
        }
    });
    combo.response.accessible_name("Compare with");
}

/// Draws an entry that is short, as it stands behind the name of its group, and has a whole name for assistive technology.
fn entry(ui: &mut Ui, with: &mut ComparedWith, other: ComparedWith, short: &str, whole: &str) -> egui::Response {
    ui.selectable_value(with, other, short).accessible_name(whole)
}

/// Draws, while comparing, how both pictures are shown: a list, which also swaps the sides. In a window of 1280 points there is
/// no space for more without another row.
fn compared_how(ui: &mut Ui, model: &mut Model) {
    let Some(compare) = &mut model.modes.compare else { return };
    let combo = egui::ComboBox::new("layout of the comparison", "").width(LAYOUT_WIDTH);
    let combo = combo.selected_text(compare.layout.name()).show_ui(ui, |ui| {
        for layout in SidesLayout::ALL {
            let line = ui.selectable_value(&mut compare.layout, layout, layout.name());
            explained(ui, line, layout.explanation());
        }
        ui.separator();
        let flip = ui.add(Button::new("Flip the sides").shortcut_text(theme::number("X")));
        if flip.accessible_name("Flip the sides").clicked() {
            compare.flipped = !compare.flipped;
        }
    });
    combo.response.on_hover_text(compare.layout.explanation()).accessible_name("Layout of the comparison");
}
