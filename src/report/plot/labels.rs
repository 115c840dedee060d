//! Placement of texts beside points, so that none covers another, or a point.
//!
//! Labels are placed one by one, those that matter most first; each takes the best free place around its point. One
//! that must be shown goes further away where nothing is free nearby, with a thin line back; any other is left out.

use super::{PlotInk, PlotLine, PlotRect, PlotText, RADIUS, SMALL_SIZE, TextAnchor, text_width};

/// A text that is to be placed beside a mark, with the area that it must stay in.
#[derive(Debug, Clone)]
pub struct LabelRequest {
    /// Centre of the mark, points.
    pub at: [f64; 2],
    /// How far its whiskers reach to the left and to the right of it, points.
    pub whiskers: [f64; 2],
    /// The text.
    pub text: String,
    /// Its colour.
    pub ink: PlotInk,
    /// The rectangle that the text must stay in.
    pub area: PlotRect,
    /// True where the text must not be left out.
    pub must: bool,
}

/// The marks and lines that texts must not cover.
#[derive(Debug, Default)]
pub struct LabelObstacles {
    /// Centres of marks, points; they are never covered.
    pub marks: Vec<[f64; 2]>,
    /// Ends of lines, points; lines are covered only where there is no other place.
    pub segments: Vec<[[f64; 2]; 2]>,
}

/// A text beside a mark at the position found for it.
#[derive(Debug, Clone)]
pub struct PlacedLabel {
    /// The text with its position.
    pub text: PlotText,
    /// Ends of a line from the mark to the text, points; `None` where the text is near.
    pub leader: Option<[[f64; 2]; 2]>,
}

/// Distance between a mark and its label, points.
const AWAY: f64 = RADIUS + 4.0;
/// Texts leave whiskers up to this long uncovered, points.
const LONGEST_FREE: f64 = 26.0;
/// Directions around a point with the cost of each: right is read most easily.
const AROUND: [([f64; 2], f64); 8] = [
    ([1.0, 0.0], 0.0),
    ([-1.0, 0.0], 1.0),
    ([0.0, -1.0], 1.5),
    ([0.0, 1.0], 2.0),
    ([0.75, -0.9], 2.0),
    ([-0.75, -0.9], 2.5),
    ([0.75, 0.9], 2.5),
    ([-0.75, 0.9], 3.0),
];
/// The cost of covering a line.
const LINE_COST: f64 = 2.6;
/// Gap between a text and a line, points.
const LINE_GAP: f64 = 2.0;

/// Returns the texts that [`place`] places, and the lines from marks to texts that are far away.
pub fn words_and_leaders(wishes: &[LabelRequest], obstacles: &LabelObstacles) -> (Vec<PlotText>, Vec<PlotLine>) {
    let placed: Vec<PlacedLabel> = place(wishes, obstacles).into_iter().flatten().collect();
    let leader = |placed: &PlacedLabel| {
        let points = placed.leader?.to_vec();
        Some(PlotLine { points, width: 0.8, ink: placed.text.ink, faint: true })
    };
    let leaders = placed.iter().filter_map(leader).collect();
    (placed.into_iter().map(|placed| placed.text).collect(), leaders)
}

/// Returns the place of each label, found in the order of `wishes`: near its mark; where nothing is free there, farther
/// away with a line to it if it must be shown, else `None`.
pub fn place(wishes: &[LabelRequest], obstacles: &LabelObstacles) -> Vec<Option<PlacedLabel>> {
    let mut taken: Vec<PlotRect> = Vec::new();
    wishes
        .iter()
        .map(|wish| {
            let near = best(wish, AWAY, obstacles, &taken);
            let far = || (1..12).find_map(|ring| best(wish, AWAY + 11.0 * f64::from(ring), obstacles, &taken));
            let text = near.clone().or_else(|| if wish.must { far() } else { None })?;
            let rect = text.rect();
            taken.push(rect);
            let leader = near.is_none().then(|| leader(wish.at, &rect));
            Some(PlacedLabel { text, leader })
        })
        .collect()
}

/// Returns the free position with the lowest cost at the distance `away` from the mark, in points; `None` where none is
/// free.
fn best(wish: &LabelRequest, away: f64, obstacles: &LabelObstacles, taken: &[PlotRect]) -> Option<PlotText> {
    let candidates = AROUND.iter().filter_map(|(direction, cost)| {
        let text = beside(wish, *direction, away);
        let rect = text.rect();
        let covers_mark = obstacles.marks.iter().any(|mark| around(*mark).overlaps(&rect));
        if covers_mark || !wish.area.holds(&rect) || taken.iter().any(|other| other.overlaps(&rect)) {
            return None;
        }
        let [[left, top], [right, bottom]] = [rect.min, rect.max];
        let area = PlotRect { min: [left - LINE_GAP, top], max: [right + LINE_GAP, bottom] };
        let lines = obstacles.segments.iter().filter(|segment| crosses(segment, &area)).count();
        Some((cost + LINE_COST * lines as f64, text))
    });
    candidates.min_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, text)| text)
}

/// Returns the label's text `away` points from its mark in a direction, anchored towards it. To the left or right it is
/// also clear of the mark's whisker, if that is not too long.
fn beside(wish: &LabelRequest, [right, down]: [f64; 2], away: f64) -> PlotText {
    let anchor = if right > 0.0 {
        TextAnchor::Start
    } else if right < 0.0 {
        TextAnchor::End
    } else {
        TextAnchor::Middle
    };
    let free = |whisker: f64| if down == 0.0 { away.max(whisker.min(LONGEST_FREE) + 3.0) } else { away };
    let [left_away, right_away] = wish.whiskers.map(free);
    let across = if right < 0.0 { right * left_away } else { right * right_away };
    // Above and below, half of the text's height is between it and the mark too.
    let at = [wish.at[0] + across, wish.at[1] + down * (away + SMALL_SIZE * 0.3)];
    PlotText::new(at, wish.text.clone(), SMALL_SIZE, wish.ink).anchored(anchor)
}

/// Returns the square that a mark with this centre covers.
fn around([x, y]: [f64; 2]) -> PlotRect {
    PlotRect { min: [x - RADIUS, y - RADIUS], max: [x + RADIUS, y + RADIUS] }
}

fn leader(from: [f64; 2], rect: &PlotRect) -> [[f64; 2]; 2] {
    let to = [from[0].clamp(rect.min[0], rect.max[0]), from[1].clamp(rect.min[1], rect.max[1])];
    let [right, down] = [to[0] - from[0], to[1] - from[1]];
    let length = right.hypot(down).max(f64::MIN_POSITIVE);
    let start = [from[0] + right / length * (RADIUS + 1.0), from[1] + down / length * (RADIUS + 1.0)];
    [start, to]
}

/// Returns whether a segment touches the rectangle, its border included (Liang and Barsky 1984).
fn crosses([from, to]: &[[f64; 2]; 2], rect: &PlotRect) -> bool {
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let along = to[axis] - from[axis];
        let [low, high] = [rect.min[axis] - from[axis], rect.max[axis] - from[axis]];
        if along == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
        } else {
            let [one, other] = [low / along, high / along];
            enters = enters.max(one.min(other));
            leaves = leaves.min(one.max(other));
        }
    }
    enters <= leaves
}

/// Returns the width that a label takes beside a point with such a whisker, points: for those that are laid out in
/// lanes.
pub fn reach(text: &str, whisker: f64) -> f64 {
    AWAY.max(whisker.min(LONGEST_FREE) + 3.0) + text_width(text, SMALL_SIZE)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: PlotRect = PlotRect { min: [0.0, 0.0], max: [200.0, 100.0] };

    fn wish(at: [f64; 2], must: bool) -> LabelRequest {
        LabelRequest { at, whiskers: [0.0; 2], text: "1024".to_owned(), ink: PlotInk::Text, area: AREA, must }
    }

    fn placed(wishes: &[LabelRequest], obstacles: &LabelObstacles) -> Vec<Option<PlacedLabel>> {
        place(wishes, obstacles)
    }

    #[test]
    fn a_lone_label_is_to_the_right_and_at_the_edge_to_the_left() {
        let found = placed(&[wish([50.0, 50.0], false), wish([195.0, 50.0], false)], &LabelObstacles::default());
        let anchors: Vec<_> = found.iter().flatten().map(|placed| placed.text.anchor).collect();
        assert_eq!(anchors, [TextAnchor::Start, TextAnchor::End]);
    }

    #[test]
    fn in_a_crowd_none_overlap_and_those_that_must_are_shown() {
        let at = |index: usize| [90.0 + (index % 5) as f64 * 4.0, 45.0 + (index / 5) as f64 * 4.0];
        let wishes: Vec<LabelRequest> = (0..25).map(|index| wish(at(index), index < 4)).collect();
        let obstacles = LabelObstacles { marks: (0..25).map(at).collect(), segments: Vec::new() };
        let found = placed(&wishes, &obstacles);
        assert!(found[..4].iter().all(Option::is_some));
        assert!(found.iter().any(Option::is_none), "there is no room for all");
        let rects: Vec<PlotRect> = found.iter().flatten().map(|placed| placed.text.rect()).collect();
        for (index, rect) in rects.iter().enumerate() {
            assert!(AREA.holds(rect));
            assert!(rects[..index].iter().all(|other| !other.overlaps(rect)));
            assert!((0..25).all(|mark| !around(at(mark)).overlaps(rect)));
        }
    }

    #[test]
    fn words_far_away_have_a_line_back() {
        let marks: Vec<[f64; 2]> =
            (0..49).map(|i| [76.0 + f64::from(i % 7) * 8.0, 26.0 + f64::from(i / 7) * 8.0]).collect();
        let obstacles = LabelObstacles { marks, segments: Vec::new() };
        let found = placed(&[wish([100.0, 50.0], true)], &obstacles);
        assert!(found[0].as_ref().is_some_and(|placed| placed.leader.is_some()));
    }

    #[test]
    fn a_line_is_covered_only_where_there_is_no_other_place() {
        let obstacles = LabelObstacles { marks: Vec::new(), segments: vec![[[50.0, 50.0], [200.0, 50.0]]] };
        let found = placed(&[wish([50.0, 50.0], false)], &obstacles);
        assert_eq!(found[0].as_ref().map(|placed| placed.text.anchor), Some(TextAnchor::End));
    }

    #[test]
    fn segments_touch_rectangles() {
        assert!(crosses(&[[-10.0, 50.0], [300.0, 60.0]], &AREA));
        assert!(crosses(&[[10.0, 10.0], [20.0, 20.0]], &AREA));
        assert!(!crosses(&[[-10.0, 50.0], [-10.0, 60.0]], &AREA));
        assert!(!crosses(&[[-30.0, 20.0], [20.0, -30.0]], &AREA));
    }
}
