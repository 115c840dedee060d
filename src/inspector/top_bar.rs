//! Name, opening, the scene, and one button a technique.

use super::{Action, State, theme};
use crate::technique::{Choice, Technique};
use egui::{Button, RichText, Ui};

pub(super) fn ui(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("stencilscope").strong());
        ui.separator();
        if ui.button("Open…").on_hover_text("Ctrl-O").clicked() {
            state.open = Some(String::new());
        }
        let scene = state.capture.as_ref().map_or("no scene", |capture| capture.scene.as_str());
        ui.label(theme::number(scene));
        ui.separator();
        techniques(ui, state, actions);
    });
}

/// The techniques; a capture folder has only the one it was made with.
fn techniques(ui: &mut Ui, state: &mut State, actions: &mut Vec<Action>) {
    let Some(setup) = &mut state.setup else {
        if let Some(capture) = &state.capture {
            ui.label(theme::dim(format!("{} · from a capture folder", capture.technique)));
        }
        return;
    };
    ui.spacing_mut().item_spacing.x = 1.0;
    let mut chosen = None;
    for technique in Technique::ALL {
        let selected = setup.choice.technique() == technique;
        let button = ui.add(Button::selectable(selected, technique.name())).on_hover_text(technique.summary());
        if button.clicked() && !selected {
            chosen = Some(technique);
        }
    }
    if let Some(technique) = chosen {
        setup.choice = Choice::new(technique);
        actions.push(Action::Run(Box::new(setup.clone())));
    }
}
