//! The bar at the top: what is open, and the technique.

use super::action::Action;
use super::export;
use super::memory::ThemeChoice;
use super::state::{OpenDialog, State};
use super::theme;
use crate::technique::Technique;
use egui::{CornerRadius, Margin, RichText, Stroke, Ui, vec2};

/// Room for a button a technique, and the tools to their right, points.
const WIDE: f32 = 960.0;

/// Draws the bar.
pub fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let frame = egui::Frame::new().fill(theme::of(ui).background).inner_margin(Margin::symmetric(8, 4));
    egui::Panel::top("top bar").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            theme::heading(ui, "stencilscope");
            ui.separator();
            if ui.button("Open…").on_hover_text("Open a scene, a model or a capture folder (Ctrl-O)").clicked() {
                state.dialog = Some(OpenDialog::default());
            }
            recent(ui, state, actions);
            ui.add_space(8.0);
            techniques(ui, state, actions);
            let right = egui::Layout::right_to_left(egui::Align::Center);
            ui.with_layout(right, |ui| tools(ui, state, actions));
        });
    });
}

/// What is open, and what was: a menu.
fn recent(ui: &mut Ui, state: &State, actions: &mut Vec<Action>) {
    let Some(name) = open_name(state) else { return };
    let menu = ui.menu_button(RichText::new(&name).color(theme::of(ui).text), |ui| {
        ui.label(theme::note("Opened before"));
        if state.recent.is_empty() {
            ui.label("nothing yet");
        }
        for source in &state.recent {
            if ui.button(source).clicked() {
                actions.push(Action::Open(source.clone()));
                ui.close();
            }
        }
    });
    menu.response.accessible_name(format!("What is open: {name}")).on_hover_text("What is open, and what was");
}

/// Right to left: help, theme, export, redo, undo.
fn tools(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    if ui.button("Help").on_hover_text("All keys (F1)").clicked() {
        state.help_is_open = true;
    }
    let other = match state.theme.other() {
        ThemeChoice::Dark => "Dark",
        ThemeChoice::Light => "Light",
    };
    let theme = ui.button(other).on_hover_text(format!("Change to the {} theme (Ctrl-L)", other.to_lowercase()));
    if theme.clicked() {
        state.theme = state.theme.other();
    }
    let menu = ui.menu_button("Export", |ui| export::menu(ui, state));
    menu.response.on_hover_text("Save the picture, its values, the capture or the scene (Ctrl-S)");
    let redo = ui.add_enabled(state.undo.can_redo(), egui::Button::new("Redo"));
    if redo.on_hover_text("Make the change again (Ctrl-Shift-Z)").clicked() {
        state.redo(actions);
    }
    let undo = ui.add_enabled(state.undo.can_undo(), egui::Button::new("Undo"));
    if undo.on_hover_text("Take the last change of scene or technique back (Ctrl-Z)").clicked() {
        state.undo(actions);
    }
}

fn open_name(state: &State) -> Option<String> {
    let of_scene = state.scene.as_ref().map(|scene| scene.name.clone());
    of_scene.or_else(|| state.capture.as_ref().map(|capture| format!("{} (capture)", capture.scene)))
}

/// A button a technique, joined into one.
fn techniques(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let Some(scene) = &state.scene else {
        // A capture folder: its technique is a fact, not a choice.
        if let Some(capture) = &state.capture {
            ui.label(theme::note(format!("technique {}", capture.technique)));
        }
        return;
    };
    let current = scene.draft.choice.technique();
    let labels = Technique::ALL.map(|technique| (technique.name(), technique.summary()));
    let chosen = Technique::ALL.iter().position(|technique| *technique == current);
    let picked = if ui.available_width() < WIDE {
        let mut picked = None;
        let combo = egui::ComboBox::from_id_salt("technique").selected_text(current.name()).show_ui(ui, |ui| {
            for (index, (name, summary)) in labels.iter().enumerate() {
                if ui.selectable_label(chosen == Some(index), *name).on_hover_text(*summary).clicked() {
                    picked = Some(index);
                }
            }
        });
        combo.response.accessible_name("Technique");
        picked.filter(|index| chosen != Some(*index))
    } else {
        segments(ui, &labels, chosen)
    };
    if let Some(index) = picked {
        state.choose_technique(Technique::ALL[index], actions);
    }
}

/// Buttons side by side in one frame, of which one is chosen: label and explanation of each.
/// Returns the one that was clicked.
pub fn segments(ui: &mut Ui, labels: &[(&str, &str)], chosen: Option<usize>) -> Option<usize> {
    let mut clicked = None;
    let frame = egui::Frame::new()
        .fill(theme::of(ui).raised)
        .stroke(Stroke::new(1.0, theme::of(ui).line))
        .corner_radius(CornerRadius::same(4));
    frame.show(ui, |ui| {
        // Laid out left to right whatever surrounds them.
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            for (index, (label, explanation)) in labels.iter().enumerate() {
                let is_chosen = chosen == Some(index);
                let color = if is_chosen { theme::of(ui).text } else { theme::of(ui).dim };
                let fill = if is_chosen { theme::of(ui).selected_row } else { theme::of(ui).raised };
                let text = RichText::new(*label).color(color);
                let button = egui::Button::selectable(is_chosen, text)
                    .fill(fill)
                    .stroke(Stroke::NONE)
                    .corner_radius(CornerRadius::same(3))
                    .min_size(vec2(0.0, theme::ROW_HEIGHT - 2.0));
                if ui.add(button).on_hover_text(*explanation).clicked() {
                    clicked = Some(index);
                }
            }
        });
    });
    clicked
}
