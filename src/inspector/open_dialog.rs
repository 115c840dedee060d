//! Opening: built-in scenes with their lessons, a path, the system's dialog, or a dropped file.

use super::{Action, State, theme};
use egui::{Key, Ui};
use std::path::PathBuf;

/// Files dropped on the window are opened, the last one of several.
pub(super) fn take_dropped(ui: &Ui, actions: &mut Vec<Action>) {
    let dropped = ui.ctx().input(|input| input.raw.dropped_files.last().map(|file| file.path().to_owned()));
    actions.extend(dropped.map(Action::Open));
}

pub(super) fn ui(ui: &Ui, state: &mut State, actions: &mut Vec<Action>) {
    let Some(mut path) = state.open.take() else { return };
    let mut stays = true;
    let mut chosen = None;
    egui::Window::new("Open a scene").collapsible(false).resizable(false).open(&mut stays).show(ui.ctx(), |ui| {
        ui.set_width(440.0);
        ui.label(theme::dim(
            "A scene file (.toml), a model (.obj) or a capture folder. Dropping it on the window works too.",
        ));
        ui.horizontal(|ui| {
            let label = ui.label("Path");
            let field = ui.add(egui::TextEdit::singleline(&mut path).desired_width(270.0)).labelled_by(label.id);
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            if (ui.button("Open").clicked() || entered) && !path.trim().is_empty() {
                chosen = Some(Action::Open(PathBuf::from(path.trim())));
            }
            if ui.button("Browse…").clicked() {
                chosen = Some(Action::Browse);
            }
        });
        theme::heading(ui, "Built-in scenes");
        for scene in &state.scenes {
            ui.horizontal(|ui| {
                if ui.button(&scene.name).clicked() {
                    chosen = Some(Action::Open(PathBuf::from(&scene.name)));
                }
                ui.label(theme::dim(&scene.lesson));
            });
        }
    });
    let cancelled = ui.ctx().input(|input| input.key_pressed(Key::Escape));
    if let Some(action) = chosen {
        actions.push(action);
    } else if stays && !cancelled {
        state.open = Some(path);
    }
}
