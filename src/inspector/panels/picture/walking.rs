//! The button that begins walking, and the banner over the picture while the user walks.

use crate::inspector::look::theme;
use crate::inspector::model::Model;
use egui::{Rect, Ui, UiBuilder, vec2};

/// Height of the banner over the picture, points.
const BANNER_HEIGHT: f32 = 56.0;

/// Draws the button that starts and stops walking; off where no scene is open, and not drawn for another program's
/// frame.
pub fn button(ui: &mut Ui, model: &mut Model) {
    if model.origin().is_some() {
        return;
    }
    let can = model.scene.is_some() && model.frame.capture.is_some();
    let word = theme::switch_word(ui, "Walk", model.walk.is_on());
    let button = ui.add_enabled(can, egui::Button::selectable(model.walk.is_on(), word));
    let button = button.on_hover_text("Walk through the scene: the mouse looks, W S A D move (Tab over the picture)");
    if button.on_disabled_hover_text("Open a scene to walk in it").clicked() {
        if model.walk.is_on() { model.stop_walking(ui.ctx()) } else { model.start_walking(ui.ctx()) }
    }
}

/// Returns the part of the picture that is free for cards in its corners: while the user walks, below the banner.
pub fn under_banner(model: &Model, rect: Rect) -> Rect {
    if model.walk.is_on() { rect.with_min_y((rect.top() + BANNER_HEIGHT + 8.0).min(rect.bottom())) } else { rect }
}

/// Draws at the top of `rect` that the user is walking, how, and how it ends, or why the last key did nothing; draws
/// nothing while the user does not walk.
pub fn banner(ui: &mut Ui, model: &Model, rect: Rect) {
    if !model.walk.is_on() {
        return;
    }
    let size = vec2(460.0_f32.min(rect.width() - 16.0), BANNER_HEIGHT);
    let place = Rect::from_min_size(rect.center_top() + vec2(-size.x / 2.0, 12.0), size);
    ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("walk banner"), |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.set_width((size.x - 16.0).max(1.0));
            theme::heading(ui, "Walking: Esc stops and frees the pointer");
            let walls = if model.walk.collides { "walls stop (C)" } else { "through walls (C)" };
            let weight = match model.walk.weight.as_ref().map(|weight| weight.standing) {
                None => "floating (G)",
                Some(Some(standing)) if standing.is_on_ground => "on the ground (G)",
                Some(_) => "falling (G)",
            };
            let speed = model.walk.speed;
            let texels = model.scene.as_ref().and_then(|scene| scene.draft.choice.texels());
            let texels = texels.map_or_else(String::new, |texels| format!(" · {texels} texels (I)"));
            let words =
                format!("W S A D and the mouse · {walls} · {speed:.1} m/s (< >) · {weight}{texels} · F1 lists all");
            let words = model.walk.nothing_because.as_ref().unwrap_or(&words);
            ui.add(egui::Label::new(theme::note(words)).truncate());
        });
    });
}
