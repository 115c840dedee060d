//! The topology of each object's mesh, in a line, and which techniques it affects and how.

use crate::inspector::look::theme;
use crate::reading::format;
use crate::reading::meshes::{ObjectMesh, effects, is_whole, line};
use egui::Ui;

/// How many objects are listed one by one.
const MOST_OBJECTS: usize = 24;

/// Draws the section Meshes: the topology of each object, those with findings first, as many as are listed; `meshes` is
/// `None` until they have been examined.
pub fn ui(ui: &mut Ui, meshes: Option<&[ObjectMesh]>) {
    theme::heading(ui, "Meshes");
    let Some(meshes) = meshes else {
        ui.label(theme::note("They are looked at once the first frame is captured."));
        return;
    };
    // Meshes with findings come first.
    let (whole, other): (Vec<_>, Vec<_>) = meshes.iter().partition(|mesh| is_whole(&mesh.topology));
    let listed = other.iter().chain(&whole).take(MOST_OBJECTS);
    egui::Grid::new("meshes").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        for ObjectMesh { object, topology } in listed {
            let name = egui::Label::new(theme::note(object.as_str())).wrap_mode(egui::TextWrapMode::Extend);
            ui.add(name).on_hover_text(topology.to_string());
            let ink = if is_whole(topology) { theme::of(ui).dim } else { theme::of(ui).text };
            let line = egui::RichText::new(line(topology)).size(theme::SMALL_SIZE).color(ink);
            ui.add(egui::Label::new(line).wrap()).on_hover_text(effects(topology));
            ui.end_row();
        }
    });
    let more = meshes.len().saturating_sub(MOST_OBJECTS);
    if more > 0 {
        let all_closed = if other.len() <= MOST_OBJECTS { ", all closed" } else { "" };
        ui.label(theme::note(format!("{}{all_closed}", format::counted(more as u64, "more object"))));
    }
}
