//! The picked pixel's point, or a corner of its triangle, in every space, with the matrices between them.

use super::picked::{Conventions, PickedHistory, PixelPanel};
use crate::capture::Capture;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::segments;
use crate::inspector::model::Model;
use crate::reading::coordinates::{
    Coordinates, PixelCoordinates, Spherical, TransformStep, VertexCoordinates, matrix_text, vector,
};
use crate::reading::format;
use egui::{CollapsingHeader, Grid, Label, RichText, Ui};

/// Decimals that fit into a narrow panel.
const DIGITS: u32 = 4;
/// The same of a matrix in a narrow panel, at least.
const LEAST_DIGITS: u32 = 2;

/// Draws the section Coordinates, folded at first: the pixel's point, or a chosen corner of its triangle, in each
/// space, and the matrices between them. Draws nothing for another program's frame.
pub fn ui(ui: &mut Ui, own: &mut PixelPanel, model: &Model, capture: &Capture, at: [u32; 2], picked: &PickedHistory) {
    // Another program's camera is a guess, and so is its unit.
    if capture.origin.is_some() {
        return;
    }
    let header = CollapsingHeader::new("Coordinates").id_salt("coordinates");
    header.show(ui, |ui| {
        let history = picked.history.as_ref().filter(|_| picked.is_of_pick && picked.wrong.is_empty());
        let place = match (history, &model.frame.plan) {
            (Some(history), Some(plan)) => PixelCoordinates::of(capture, at).with_vertices(capture, plan, history),
            _ => PixelCoordinates::of(capture, at),
        };
        ui.add(Label::new(theme::note(&place.projection)).wrap());
        conventions(ui, &mut own.conventions);
        choose(ui, &mut own.corner, &place.vertices);
        let Conventions { is_opengl, has_rows } = own.conventions;
        let corner = place.vertices.iter().find(|vertex| Some(vertex.index) == own.corner).cloned();
        let height = f64::from(capture.size[1]);
        match is_opengl {
            false => points(ui, &place, place.point, corner),
            true => {
                let point = place.point.map(|point| point.in_opengl(height));
                points(ui, &place, point, corner.map(|corner| corner.in_opengl(height)));
            }
        }
        let after_eye = if is_opengl { &place.opengl } else { &place.chain[1..] };
        chain(ui, &place.chain[..1], has_rows);
        chain(ui, after_eye, has_rows);
        let lights = place.lights.iter().cloned();
        for light in lights.map(|light| if is_opengl { light.in_opengl() } else { light }) {
            ui.add_space(6.0);
            ui.label(theme::note(&light.name));
            Grid::new(("coordinates in a light", light.light, light.layer)).num_columns(2).spacing([12.0, 2.0]).show(
                ui,
                |ui| {
                    for (name, values) in light.rows() {
                        ui.label(theme::note(name));
                        ui.label(theme::number(vector(&values, DIGITS)).color(theme::of(ui).text));
                        ui.end_row();
                    }
                },
            );
            chain(ui, &light.chain, has_rows);
        }
        for shadow in &place.flattened {
            ui.add_space(6.0);
            for (index, line) in shadow.lines(DIGITS).into_iter().enumerate() {
                ui.label(theme::note(line));
                if index == 0 {
                    matrix(ui, &shadow.matrix, has_rows);
                }
            }
        }
    });
}

/// Draws the two switches of how matrices and coordinates are written.
fn conventions(ui: &mut Ui, own: &mut Conventions) {
    ui.horizontal_wrapped(|ui| {
        let depths = [
            (
                "WebGPU, 0 to 1",
                "NDC's z is depth, from 0 to 1; the window's rows are counted from above. Also Direct3D's, Vulkan's",
            ),
            ("OpenGL, −1 to 1", "NDC's z is twice the depth less 1; the window's rows are counted from below"),
        ];
        if let Some(index) = segments(ui, &depths, Some(usize::from(own.is_opengl))) {
            own.is_opengl = index == 1;
        }
        let ways = [
            ("M · p", "Points are columns on the matrix's right, as OpenGL's books have it"),
            ("p · M", "Points are rows on the matrix's left, as Direct3D's books have it: each matrix is transposed"),
        ];
        if let Some(index) = segments(ui, &ways, Some(usize::from(own.has_rows))) {
            own.has_rows = index == 1;
        }
    });
}

fn chain(ui: &mut Ui, chain: &[TransformStep], has_rows: bool) {
    for step in chain {
        let back = if step.inverse.is_some() { "then back" } else { "which has no inverse" };
        ui.add(Label::new(theme::note(format!("{}, {back}:", step.name))).wrap());
        matrix(ui, &step.matrix, has_rows);
        step.inverse.iter().for_each(|inverse| matrix(ui, inverse, has_rows));
    }
}

/// Draws a matrix, given by rows for points as columns; transposed where points are rows.
fn matrix(ui: &mut Ui, rows: &[[f64; 4]; 4], has_rows: bool) {
    let written = |row: usize| [0, 1, 2, 3].map(|column| if has_rows { rows[column][row] } else { rows[row][column] });
    let color = theme::of(ui).text;
    let all = [0, 1, 2, 3].map(written);
    let of_digits = |digits: u32| theme::number(matrix_text(&all, digits)).color(color);
    // A column that is cut would be read as another number: where all four don't fit, all have fewer digits.
    let width = |text: &RichText| {
        let text = egui::WidgetText::from(text.clone());
        text.into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, egui::TextStyle::Body).size().x
    };
    let fits = |digits: &u32| width(&of_digits(*digits)) <= ui.available_width();
    let digits = (LEAST_DIGITS..=DIGITS).rev().find(fits).unwrap_or(LEAST_DIGITS);
    let label = ui.add(Label::new(of_digits(digits)).extend());
    if digits < DIGITS {
        label.on_hover_text(of_digits(DIGITS));
    }
}

/// Draws the choice between the coordinates of the pixel's point (`None`) and those of a corner of its triangle; a
/// chosen corner of another triangle is cleared. Draws nothing where no corner is known.
fn choose(ui: &mut Ui, corner: &mut Option<u32>, vertices: &[VertexCoordinates]) {
    let Some(first) = vertices.first() else { return };
    // For another triangle than before, the point comes first.
    *corner = corner.filter(|index| vertices.iter().any(|vertex| vertex.index == *index));
    ui.horizontal_wrapped(|ui| {
        let mut option = |ui: &mut Ui, value, text: String, hover: String| {
            ui.selectable_value(corner, value, text).on_hover_text(hover);
        };
        option(ui, None, "the point".to_owned(), "Of the surface at the pixel's middle".to_owned());
        for vertex in vertices {
            let hover = format!("A corner of the triangle of {} that the pixel shows", first.object);
            option(ui, Some(vertex.index), format!("vertex {}", vertex.index), hover);
        }
    });
}

fn points(ui: &mut Ui, place: &PixelCoordinates, point: Option<Coordinates>, corner: Option<VertexCoordinates>) {
    let is_of_point = corner.is_none();
    Grid::new("coordinates of the point").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(theme::note(name));
            ui.label(theme::number(value).color(theme::of(ui).text));
            ui.end_row();
        };
        match (corner, point) {
            (Some(vertex), _) => vertex.rows(DIGITS).into_iter().for_each(|(name, value)| row(name, value)),
            (None, None) if place.has_no_distances() => row("point", "not known: all depths are one".to_owned()),
            (None, None) => row("point", "no surface".to_owned()),
            (None, Some(point)) => {
                point.rows().into_iter().for_each(|(name, values)| row(name, vector(values, DIGITS)))
            }
        }
        for step in place.depth_steps.iter().filter(|_| is_of_point) {
            row(
                &format!("step, {}", step.stored_in),
                step.metres.map_or_else(|| "to infinity".to_owned(), format::metres),
            );
        }
        let Spherical { r, theta_degrees, phi_degrees } = place.camera;
        row("camera", format!("r {}, θ {theta_degrees:.1}°, φ {phi_degrees:.1}°", format::metres(r)));
    });
}
