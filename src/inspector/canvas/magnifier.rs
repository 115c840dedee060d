//! An inset that shows the texels around the pick with their numbers, while the picture is too
//! small to show them itself.

use crate::inspector::canvas;
use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::theme;
use crate::reading::picture_view::ShownPicture;
use egui::{Color32, CornerRadius, Rect, Stroke, StrokeKind, Ui, Vec2, pos2, vec2};

/// Texels across and down; odd, so that the pick is in the middle.
const CELLS: [i64; 2] = [7, 5];
/// Size of a texel in the inset, points.
const CELL: f32 = 26.0;

/// Distance between the inset and the picture's borders, points.
const MARGIN: f32 = 12.0;

/// Draws an inset of 7 × 5 enlarged texels, with their numbers, around `pick` into a lower corner of `rect`. Draws
/// nothing where texels are so large that the picture shows numbers itself, or `rect` is less than twice as large as
/// the inset.
pub fn ui(ui: &Ui, pick: [u32; 2], rect: Rect, shown: &ShownPicture, coloring: Coloring, placement: Placement) {
    let size = vec2(CELLS[0] as f32, CELLS[1] as f32) * CELL;
    let is_large = placement.pixels(ui.pixels_per_point()) >= canvas::NUMBERS_FROM;
    if is_large || rect.width() < size.x * 2.0 || rect.height() < size.y * 2.0 {
        return;
    }
    let inset = place(rect, size, placement.rect_of(pick).expand(canvas::CROSSHAIR));
    let painter = ui.painter_at(rect);
    painter.rect_filled(inset, CornerRadius::same(4), theme::of(ui).background);
    let image = &shown.images[0];
    for row in 0..CELLS[1] {
        for column in 0..CELLS[0] {
            let offset = [column - CELLS[0] / 2, row - CELLS[1] / 2];
            let cell = Rect::from_min_size(inset.min + vec2(column as f32, row as f32) * CELL, vec2(CELL, CELL));
            let texel = [0, 1].map(|axis| u32::try_from(i64::from(pick[axis]) + offset[axis]));
            let [Ok(x), Ok(y)] = texel else { continue };
            let Some(color) = coloring.color_at(image, [x, y]) else { continue };
            painter.rect_filled(cell, CornerRadius::ZERO, color);
            canvas::texel_number(&painter, image, coloring, [x, y], cell);
        }
    }
    // Drawn over the cells, so that it is also seen on a count of zero, which is as dark as the background.
    let grid = Stroke::new(1.0, theme::of(ui).faint);
    for column in 1..CELLS[0] {
        painter.vline(inset.left() + column as f32 * CELL, inset.y_range(), grid);
    }
    for row in 1..CELLS[1] {
        painter.hline(inset.x_range(), inset.top() + row as f32 * CELL, grid);
    }
    let middle = Rect::from_center_size(inset.center(), vec2(CELL, CELL));
    // Light on dark, so that it shows on any texel.
    for (width, color) in [(5.0, Color32::from_black_alpha(170)), (2.0, Color32::WHITE)] {
        painter.rect_stroke(middle, CornerRadius::ZERO, Stroke::new(width, color), StrokeKind::Middle);
    }
    painter.rect_stroke(
        inset.expand(1.0),
        CornerRadius::same(4),
        Stroke::new(1.0, theme::of(ui).faint),
        StrokeKind::Outside,
    );
}

/// Returns the inset's rectangle, at a margin from the lower left corner of `rect`, or from the lower right one where
/// `pick`, the rectangle of the picked texel with its crosshair, would be under it.
fn place(rect: Rect, size: Vec2, pick: Rect) -> Rect {
    let left = Rect::from_min_size(pos2(rect.left() + MARGIN, rect.bottom() - MARGIN - size.y), size);
    if left.intersects(pick) { left.translate(vec2(rect.right() - MARGIN - left.right(), 0.0)) } else { left }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pick_is_beside_the_inset_wherever_it_is() {
        let rect = Rect::from_min_size(pos2(30.0, 50.0), vec2(500.0, 400.0));
        let size = vec2(CELLS[0] as f32, CELLS[1] as f32) * CELL;
        for x in 0..=50 {
            for y in 0..=40 {
                let at = rect.min + vec2(x as f32, y as f32) * 10.0;
                let pick = Rect::from_center_size(at, vec2(1.0, 1.0)).expand(canvas::CROSSHAIR);
                let inset = place(rect, size, pick);
                assert!(rect.contains_rect(inset) && !inset.intersects(pick), "{at}");
            }
        }
    }
}
