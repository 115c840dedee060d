//! The help window: every key and what it does, from the one table of keys.

use crate::inspector::action::DialogKind;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::shell::keys::{BINDINGS, KeyBinding, KeyScope, PICTURE, ZOOM};
use crate::inspector::shell::walk;
use egui::{Context, Id, Ui};

/// Width of the column of keys, points.
const KEYS_WIDTH: f32 = 168.0;

/// Draws the window Help, with all keys, while it is open.
pub fn ui(ctx: &Context, model: &mut Model) {
    if model.dialog != Some(DialogKind::Help) {
        return;
    }
    let modal = egui::Modal::new(Id::unique("help")).frame(theme::dialog(ctx));
    let answer = modal.show(ctx, |ui| {
        ui.set_width(520.0_f32.min(ctx.content_rect().width() - 64.0).max(1.0));
        // At its full height at once: an area otherwise grows by a little a frame, and its buttons slide away.
        let most = (ctx.content_rect().height() - 140.0).max(80.0);
        let scroll = egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most);
        scroll.show(ui, contents);
        ui.add_space(8.0);
        ui.button("Close help").on_hover_text("Escape").clicked()
    });
    if answer.inner || answer.should_close() {
        model.dialog = None;
    }
}

fn contents(ui: &mut Ui) {
    theme::heading(ui, "Keys");
    section(ui, "Anywhere", of_scope(KeyScope::Anywhere).chain([ZOOM]));
    section(ui, "Through the frame", of_scope(KeyScope::Steps));
    section(ui, "While no text is typed", of_scope(KeyScope::Picture));
    section(ui, "On the picture", PICTURE.into_iter().chain(of_scope(KeyScope::Free)));
    section(ui, "While walking (Tab over the picture, or Walk)", walk::KEYS.iter().map(|key| (key.keys, key.does)));
}

fn of_scope(scope: KeyScope) -> impl Iterator<Item = (&'static str, &'static str)> {
    let has_words = |binding: &&KeyBinding| !binding.keys.is_empty();
    BINDINGS
        .iter()
        .filter(has_words)
        .filter(move |binding| binding.scope == scope)
        .map(|binding| (binding.keys, binding.does))
}

fn section(ui: &mut Ui, title: &str, rows: impl Iterator<Item = (&'static str, &'static str)>) {
    ui.add_space(8.0);
    ui.label(theme::note(title));
    let grid = egui::Grid::new(title).num_columns(2).spacing([16.0, 2.0]).min_row_height(theme::ROW_HEIGHT - 4.0);
    grid.show(ui, |ui| {
        ui.spacing_mut().interact_size.y = theme::ROW_HEIGHT - 4.0;
        for (keys, does) in rows {
            ui.horizontal(|ui| {
                // Aligns the columns of all sections.
                ui.set_min_width(KEYS_WIDTH);
                ui.label(theme::number(keys).color(theme::of(ui).text));
            });
            ui.label(does);
            ui.end_row();
        }
    });
}
