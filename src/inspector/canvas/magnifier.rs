//! An inset that shows the texels around the pick with their numbers, while the picture is too
//! small to show them itself.

use crate::accuracy::Finding;
use crate::capture::Image;
use crate::inspector::canvas;
use crate::inspector::canvas::corners;
use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::theme;
use crate::reading::picture_view::ShownPicture;
use egui::{Align2, Color32, CornerRadius, Rect, Stroke, StrokeKind, Ui, vec2};

/// Texels across and down, in a large picture and in a small one; odd, so that the pick is in the middle.
const CELLS: [i64; 2] = [7, 5];
const FEW_CELLS: [i64; 2] = [5, 3];
/// The least size of a texel in the inset and the largest, in which three lines of numbers can be read, points.
const LEAST_CELL: f32 = 18.0;
const MOST_CELL: f32 = 26.0;
/// Shares of the picture's width and height that the inset takes at most, where that is not too little.
const SHARES: [f32; 2] = [0.3, 0.36];
/// In which corner it lies, if that is free.
const CORNERS: [Align2; 4] = [Align2::LEFT_BOTTOM, Align2::RIGHT_BOTTOM, Align2::LEFT_TOP, Align2::RIGHT_TOP];
/// The most rows, and columns, that are looked at for wrong pixels.
const MOST_ROWS: u32 = 60;

/// What else lies over the picture.
#[derive(Debug, Default)]
pub struct Occupied {
    /// Corners in which there is something already.
    pub taken: Vec<Align2>,
    /// Rectangles that must stay free.
    pub kept: Vec<Rect>,
}

/// Draws an inset of enlarged texels, 7 × 5 or over a small picture fewer or smaller ones, with their numbers, around `pick` into a corner of `rect`, off the pick,
/// off what is occupied, and off wrong pixels of a picture of findings as far as possible. Draws
/// nothing where texels are so large that the picture shows numbers itself, or `rect` is less than twice as large as
/// the inset.
pub fn ui(
    ui: &Ui,
    pick: [u32; 2],
    rect: Rect,
    shown: &ShownPicture,
    coloring: Coloring,
    placement: Placement,
    Occupied { taken, kept }: &Occupied,
) {
    let (cells, side) = grid(rect, coloring.lines());
    let size = vec2(cells[0] as f32, cells[1] as f32) * side;
    let is_large = placement.pixels(ui.pixels_per_point()) >= canvas::NUMBERS_FROM;
    if is_large || rect.width() < size.x * 2.0 || rect.height() < size.y * 2.0 {
        return;
    }
    let crosshair = placement.rect_of(pick).expand(canvas::CROSSHAIR);
    let corners: Vec<Align2> = CORNERS.into_iter().filter(|corner| !taken.contains(corner)).collect();
    let wrong = |place| wrong_under(place, &shown.images[0], coloring, placement);
    let corner = corners::freest(rect, size, &corners, |place| hidden(place, crosshair, kept, wrong));
    let Some(inset) = corner.map(|corner| corners::place(rect, size, corner)) else { return };
    let painter = ui.painter_at(rect);
    painter.rect_filled(inset, CornerRadius::same(4), theme::of(ui).background);
    let image = &shown.images[0];
    for row in 0..cells[1] {
        for column in 0..cells[0] {
            let offset = [column - cells[0] / 2, row - cells[1] / 2];
            let cell = Rect::from_min_size(inset.min + vec2(column as f32, row as f32) * side, vec2(side, side));
            let texel = [0, 1].map(|axis| u32::try_from(i64::from(pick[axis]) + offset[axis]));
            let [Ok(x), Ok(y)] = texel else { continue };
            let Some(color) = coloring.color_at(image, [x, y]) else { continue };
            painter.rect_filled(cell, CornerRadius::ZERO, color);
            canvas::texel_number(&painter, image, coloring, [x, y], cell);
        }
    }
    // Drawn over the cells, so that it is also seen on a count of zero, which is as dark as the background.
    let grid = Stroke::new(1.0, theme::of(ui).faint);
    for column in 1..cells[0] {
        painter.vline(inset.left() + column as f32 * side, inset.y_range(), grid);
    }
    for row in 1..cells[1] {
        painter.hline(inset.x_range(), inset.top() + row as f32 * side, grid);
    }
    let middle = Rect::from_center_size(inset.center(), vec2(side, side));
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

/// Returns how many texels the inset over a picture in `rect` has across and down, and the size of one, points: where seven
/// across would hide too much, they are smaller, or, where numbers have several lines and need their size, fewer.
fn grid(rect: Rect, lines: usize) -> ([i64; 2], f32) {
    let [across, down] = [rect.width() * SHARES[0] / CELLS[0] as f32, rect.height() * SHARES[1] / CELLS[1] as f32];
    let fitting = across.min(down).clamp(LEAST_CELL, MOST_CELL).floor();
    match lines {
        1 => (CELLS, fitting),
        _ if fitting < MOST_CELL => (FEW_CELLS, MOST_CELL),
        _ => (CELLS, MOST_CELL),
    }
}

/// Returns how bad it is that a card hides what lies in `place`: the pick or one of `kept` more than any number of wrong
/// pixels, of which there are some in a picture of findings alone.
fn hidden(place: Rect, pick: Rect, kept: &[Rect], wrong: impl Fn(Rect) -> u64) -> u64 {
    let covered = std::iter::once(&pick).chain(kept).filter(|rect| rect.intersects(place)).count();
    (covered as u64) << 32 | wrong(place).min(u64::from(u32::MAX))
}

/// Returns how many of the texels under `place` are wrong, of so many as are looked at.
fn wrong_under(place: Rect, image: &Image, coloring: Coloring, placement: Placement) -> u64 {
    if coloring != Coloring::Findings {
        return 0;
    }
    let [low, high] = [place.min, place.max].map(|at| placement.texel_position(at));
    let range = |low: f32, high: f32, side: u32| {
        let [low, high] = [low, high].map(|at| at.clamp(0.0, side as f32) as u32);
        (low..high).step_by(((high - low) / MOST_ROWS).max(1) as usize)
    };
    let [width, height] = image.size();
    let rows = range(low.y, high.y, height);
    let is_wrong = |at: [u32; 2]| image.byte_at(at).and_then(Finding::from_byte).is_some_and(Finding::is_wrong);
    rows.map(|y| range(low.x, high.x, width).filter(|x| is_wrong([*x, y])).count() as u64).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::PixelFormat;
    use egui::pos2;

    const SCREEN: [f32; 2] = [500.0, 400.0];

    fn inset(pick: Rect, kept: &[Rect], wrong: impl Fn(Rect) -> u64) -> Rect {
        let rect = Rect::from_min_size(pos2(30.0, 50.0), SCREEN.into());
        let (cells, side) = grid(rect, 1);
        let size = vec2(cells[0] as f32, cells[1] as f32) * side;
        let corner = corners::freest(rect, size, &CORNERS, |place| hidden(place, pick, kept, &wrong));
        corners::place(rect, size, corner.expect("a corner"))
    }

    #[test]
    fn the_pick_is_beside_the_inset_wherever_it_is() {
        let rect = Rect::from_min_size(pos2(30.0, 50.0), SCREEN.into());
        for x in 0..=50 {
            for y in 0..=40 {
                let at = rect.min + vec2(x as f32, y as f32) * 10.0;
                let pick = Rect::from_center_size(at, vec2(1.0, 1.0)).expand(canvas::CROSSHAIR);
                let inset = inset(pick, &[], |_| 0);
                assert!(rect.contains_rect(inset) && !inset.intersects(pick), "{at}");
            }
        }
    }

    #[test]
    fn cards_and_wrong_pixels_are_beside_it_too() {
        let rect = Rect::from_min_size(pos2(30.0, 50.0), SCREEN.into());
        let nowhere = Rect::from_min_size(pos2(0.0, 0.0), vec2(1.0, 1.0));
        let first = inset(nowhere, &[], |_| 0);
        assert!(first.left() < rect.center().x && first.top() > rect.center().y, "at the lower left");
        let second = inset(nowhere, &[first], |_| 0);
        assert!(!second.intersects(first));
        // As many wrong texels as there may be weigh less than a card.
        let third = inset(nowhere, &[first], |place| if place.intersects(first) { 0 } else { u64::MAX });
        assert!(!third.intersects(first));
        // Wrong in the lower half alone.
        let size = [50, 40];
        let findings = (0..size[0] * size[1]).map(|at| {
            let finding = if at / size[0] >= 20 { Finding::FalseShadow } else { Finding::Agrees };
            finding as u8
        });
        let image = Image::packed(PixelFormat::U8, size, findings.collect::<Vec<u8>>());
        let placement = Placement { origin: rect.min, scale: 10.0, size };
        let wrong = |place| wrong_under(place, &image, Coloring::Findings, placement);
        let free = inset(nowhere, &[], wrong);
        assert!(wrong(free) == 0 && wrong(first) > 0, "{free}");
        assert_eq!(wrong_under(first, &image, Coloring::Stencil, placement), 0, "of other pictures nothing is asked");
    }

    #[test]
    fn it_is_smaller_over_a_small_picture() {
        let of = |width, height, lines| grid(Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height)), lines);
        assert_eq!([1, 3].map(|lines| of(900.0, 600.0, lines)), [(CELLS, MOST_CELL); 2]);
        assert_eq!(of(420.0, 380.0, 1), (CELLS, LEAST_CELL));
        assert_eq!(of(420.0, 380.0, 3), (FEW_CELLS, MOST_CELL), "three lines need their height");
    }
}
