//! The corners of a picture, in which legends, notes and the magnifier lie over it: each keeps off what must be seen.

use egui::{Align2, Rect, Vec2, vec2};

/// Distance between a card in a corner and the picture's borders, points.
pub const MARGIN: f32 = 12.0;

/// Returns the rectangle of a card of this size in a corner of `rect`.
pub fn place(rect: Rect, size: Vec2, corner: Align2) -> Rect {
    corner.align_size_within_rect(size, rect.shrink2(vec2(MARGIN, MARGIN)))
}

/// Returns the first of `corners` in which a card of this size hides the least; `hidden` says how bad it is to hide what
/// lies in a rectangle, 0 where nothing is lost. `None` without corners.
pub fn freest(rect: Rect, size: Vec2, corners: &[Align2], hidden: impl Fn(Rect) -> u64) -> Option<Align2> {
    corners.iter().copied().min_by_key(|corner| hidden(place(rect, size, *corner)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn a_card_lies_in_the_first_corner_where_nothing_is_lost_or_else_the_least() {
        let rect = Rect::from_min_size(pos2(30.0, 50.0), vec2(500.0, 400.0));
        let size = vec2(100.0, 60.0);
        let corners = [Align2::RIGHT_TOP, Align2::LEFT_TOP, Align2::RIGHT_BOTTOM];
        assert_eq!(freest(rect, size, &corners, |_| 0), Some(Align2::RIGHT_TOP));
        let handle = place(rect, vec2(20.0, 20.0), Align2::RIGHT_TOP);
        let hidden = |card: Rect| u64::from(card.intersects(handle));
        assert_eq!(freest(rect, size, &corners, hidden), Some(Align2::LEFT_TOP));
        let more_above = |card: Rect| if card.top() < rect.center().y { 2 } else { 1 };
        assert_eq!(freest(rect, size, &corners, more_above), Some(Align2::RIGHT_BOTTOM));
        assert_eq!(freest(rect, size, &[], |_| 0), None);
        for corner in corners {
            assert!(rect.contains_rect(place(rect, size, corner)));
        }
    }
}
