//! Where labels of places that lie close together go, so that none lies over another.

use egui::{Pos2, Rect, Vec2, vec2};

/// From a place to its label at the right above it, points.
const ASIDE: Vec2 = vec2(7.0, -7.0);
/// Space that is left free around a label, points.
const MARGIN: f32 = 2.0;
/// How many rows above and below its place a label may lie.
const MOST_ROWS: u32 = 24;
/// Columns to either side in which a label may lie.
const MOST_COLUMNS: u32 = 3;

/// The place of a label.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LabelPlace {
    /// Where it lies.
    pub rect: Rect,
    /// It lies so far from what it is of that a line has to lead there.
    pub is_led: bool,
}

/// Returns where labels of these sizes go that are of these places: beside it at the right, or, where that is taken by an
/// earlier one or by one of `signs`, or lies outside of `within`, as near to it as there is space, in rows above and below,
/// to the right and to the left. Where there is no space at all, one lies beside its place over others.
pub fn spread(labels: &[(Pos2, Vec2)], signs: &[Rect], within: Rect) -> Vec<LabelPlace> {
    let mut taken: Vec<Rect> = signs.to_vec();
    let mut places = Vec::with_capacity(labels.len());
    for (at, size) in labels {
        let first = Rect::from_min_size(*at + ASIDE - vec2(0.0, size.y), *size);
        let is_free = |rect: &Rect| {
            let around = rect.expand(MARGIN);
            within.contains_rect(*rect) && !taken.iter().any(|other| other.intersects(around))
        };
        let candidates = (0..MOST_COLUMNS).flat_map(|column| (0..=MOST_ROWS).map(move |row| (column, row)));
        let mut candidates: Vec<(u32, u32)> = candidates.collect();
        // A row further is nearer than a column further.
        candidates.sort_by_key(|(column, row)| 4 * column + row);
        let moved = candidates.into_iter().flat_map(|(column, row)| {
            let down = row as f32 * (size.y + MARGIN);
            let right = column as f32 * (size.x + 2.0 * MARGIN);
            let left = -(size.x + 2.0 * ASIDE.x) - right;
            [vec2(right, -down), vec2(right, down), vec2(left, -down), vec2(left, down)]
        });
        let rect = moved.map(|by| first.translate(by)).find(is_free).unwrap_or(first);
        taken.push(rect);
        let is_beside = rect.distance_to_pos(*at) < size.y;
        places.push(LabelPlace { rect, is_led: !is_beside });
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn labels_of_one_place_lie_one_over_the_other_and_are_led_to_it() {
        let within = Rect::from_min_size(Pos2::ZERO, vec2(300.0, 200.0));
        // In a corner, in the middle, and two rows that lie close together.
        for first in [pos2(295.0, 4.0), pos2(150.0, 100.0), pos2(2.0, 198.0)] {
            let label = |index: u32| (first + vec2(0.0, (index % 2) as f32 * 5.0), vec2(50.0, 13.0));
            let labels: Vec<(Pos2, Vec2)> = (0..12).map(label).collect();
            let places = spread(&labels, &[], within);
            for (index, one) in places.iter().enumerate() {
                assert!(within.contains_rect(one.rect), "{one:?}");
                let over = places[index + 1..].iter().find(|other| other.rect.intersects(one.rect));
                assert_eq!(over, None, "over {one:?}");
            }
            assert!(places.iter().any(|place| place.is_led));
        }
        let alone = spread(&[(pos2(150.0, 100.0), vec2(50.0, 13.0))], &[], within)[0];
        assert_eq!((alone.rect.left_bottom(), alone.is_led), (pos2(157.0, 93.0), false));
        let sign = Rect::from_center_size(pos2(170.0, 90.0), vec2(24.0, 24.0));
        let beside = spread(&[(pos2(150.0, 100.0), vec2(50.0, 13.0))], &[sign], within)[0];
        assert!(!beside.rect.intersects(sign), "{beside:?} lies under a handle");
    }
}
