//! The selected triangle of a history, outlined in the picture.
//!
//! Its visible part is found in [`projected`](crate::reading::projected).

use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::reading::projected::outline;
use egui::{Color32, Pos2, Rect, Shape, Stroke, Ui, vec2};

/// Draws the outline of the triangle that is selected in the picked pixel's history over the picture in `rect`. Draws
/// nothing over a map, or where no triangle is selected.
pub fn ui(ui: &Ui, model: &Model, rect: Rect, shown: &ShownPicture, placement: Placement) {
    let Some(plan) = &model.frame.plan else { return };
    let Some(history) = model.history_of_frame().filter(|_| shown.kind != PictureKind::Map) else { return };
    let Some(index) = model.selected_in(&history) else { return };
    let texels = outline(plan, &history.events[index]);
    let points: Vec<Pos2> =
        texels.iter().map(|at| placement.origin + vec2(at.x as f32, at.y as f32) * placement.scale).collect();
    if points.len() < 3 {
        return;
    }
    let painter = ui.painter_at(placement.rect().intersect(rect));
    let fill = theme::of(ui).selected.gamma_multiply(0.14);
    painter.add(Shape::convex_polygon(points.clone(), fill, Stroke::NONE));
    // Light on dark, so that it shows on any picture.
    painter.add(Shape::closed_line(points.clone(), Stroke::new(4.0, Color32::from_black_alpha(150))));
    painter.add(Shape::closed_line(points, Stroke::new(1.5, theme::of(ui).selected)));
}
