//! The controls of the scene's animation.

use crate::inspector::action::Action;
use crate::inspector::look::number_field::number_field;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use egui::Ui;

/// The scene's time that is offered is within so many seconds of its start.
const MOST_TIME: f64 = 1e6;

/// Draws the controls of the animation: run or stop, one step, back to the start; nothing where nothing in the scene
/// moves.
pub fn ui(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    if !model.is_animated() {
        return;
    }
    ui.horizontal(|ui| {
        theme::heading(ui, "Animation");
        let Some(scene) = &mut model.scene else { return };
        ui.label(theme::note("at"));
        let time = &mut scene.draft.time;
        let widget = number_field(time, -MOST_TIME..=MOST_TIME, |widget| widget.speed(0.02).suffix(" s"));
        let field = ui.add(widget).accessible_name("Scene time");
        if field.on_hover_text("The scene's time: drag it, or type a moment").changed() {
            model.animation.is_running = false;
            model.run_draft(actions);
        }
    });
    ui.horizontal_wrapped(|ui| {
        let (word, hint) = if model.animation.is_running {
            ("Stop animation", "Stay at this moment (T)")
        } else {
            ("Run animation", "Objects and lights move; each shown moment is captured (T)")
        };
        if ui.button(word).on_hover_text(hint).clicked() {
            model.animation.toggle();
        }
        if ui.button("Step").on_hover_text("A thirtieth of a second on (.)").clicked() {
            model.step_animation(actions);
        }
        let is_started = model.scene.as_ref().is_some_and(|scene| scene.draft.time != 0.0);
        let back = ui.add_enabled(is_started, egui::Button::new("To the start"));
        let back = back.on_disabled_hover_text("The scene is at its start");
        if back.on_hover_text("The moment at which the scene was loaded").clicked()
            && let Some(scene) = &mut model.scene
        {
            scene.draft.time = 0.0;
            model.animation.is_running = false;
            model.run_draft(actions);
        }
    });
}
