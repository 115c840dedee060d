//! The picked pixel's point in every space, with the matrices between them.

use crate::capture::Capture;
use crate::inspector::look::theme;
use crate::reading::coordinates::{Place, Spherical, matrix_row, vector};
use crate::reading::format;
use egui::{CollapsingHeader, Grid, Label, Ui};

/// Digits that a narrow panel has room for.
const DIGITS: u32 = 4;

/// Folded until somebody asks.
pub fn ui(ui: &mut Ui, capture: &Capture, at: [u32; 2]) {
    // Another program's camera is a guess, and so is its unit.
    if capture.origin.is_some() {
        return;
    }
    let header = CollapsingHeader::new("Coordinates").id_salt("coordinates");
    header.show(ui, |ui| {
        let place = Place::of(capture, at);
        points(ui, &place);
        for step in &place.chain {
            ui.label(theme::note(format!("{}, then back:", step.name)));
            for rows in [&step.matrix, &step.inverse] {
                let text: Vec<String> = rows.iter().map(|row| matrix_row(row, DIGITS)).collect();
                ui.add(Label::new(theme::number(text.join("\n")).color(theme::of(ui).text)).extend());
            }
        }
    });
}

fn points(ui: &mut Ui, place: &Place) {
    Grid::new("coordinates of the point").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(theme::note(name));
            ui.label(theme::number(value).color(theme::of(ui).text));
            ui.end_row();
        };
        match place.point {
            None => row("point", "no surface".to_owned()),
            Some(point) => point.rows().into_iter().for_each(|(name, values)| row(name, vector(values, DIGITS))),
        }
        for step in &place.depth_steps {
            row(
                &format!("step, {}", step.stored_in),
                step.metres.map_or_else(|| "to infinity".to_owned(), format::metres),
            );
        }
        let Spherical { r, theta_degrees, phi_degrees } = place.camera;
        row("camera", format!("r {}, θ {theta_degrees:.1}°, φ {phi_degrees:.1}°", format::metres(r)));
    });
}
