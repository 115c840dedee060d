//! Placement of texts beside points, so that none covers another, a point, a whisker or another's line.
//!
//! Labels are placed one by one, those that matter most first; each takes the best free place around its point. One
//! that must be shown goes further away where nothing is free nearby, with a thin line back; any other is left out. A
//! label that is near another mark than its own has a line back, too.

use super::{CLEAR, PlotInk, PlotLine, PlotRect, PlotText, RADIUS, SMALL_SIZE, TextAnchor, text_width};

/// A text that is to be placed beside a mark, with the areas that it may stay in.
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
    /// The rectangle that the text stays in.
    pub area: PlotRect,
    /// True where the text must not be left out, if there is any place for it.
    pub must: bool,
}

/// The marks and lines that texts must not cover.
#[derive(Debug, Default)]
pub struct LabelObstacles {
    /// Centres of marks, points; they are never covered, and neither is the ring around a selected one.
    pub marks: Vec<[f64; 2]>,
    /// Ends of whiskers, points; they are never covered.
    pub whiskers: Vec<[[f64; 2]; 2]>,
    /// Ends of other lines, points; they are covered only where there is no other place.
    pub segments: Vec<[[f64; 2]; 2]>,
}

/// A text beside a mark at the position found for it.
#[derive(Debug, Clone)]
pub struct PlacedLabel {
    /// The text with its position.
    pub text: PlotText,
    /// Ends of a line from the mark to the text, points; `None` where the text is near, and nearer than to any other mark.
    pub leader: Option<[[f64; 2]; 2]>,
}

/// Distance between a mark and a text to the left or right of it, points.
const AWAY: f64 = CLEAR + 1.0;
/// Distance between one try and the next farther away, points, and how many there are.
const RING_STEP: f64 = 9.0;
const MOST_RINGS: u32 = 26;
/// Texts go as far as behind whiskers of this length, points.
const LONGEST_FREE: f64 = 26.0;
/// The directions around a point with the cost of each: right is read most easily.
const AROUND: [([f64; 2], f64); 12] = [
    ([1.0, 0.0], 0.0),
    ([-1.0, 0.0], 1.0),
    ([0.0, -1.0], 1.5),
    ([0.0, 1.0], 2.0),
    ([0.75, -0.9], 2.0),
    ([-0.75, -0.9], 2.5),
    ([0.75, 0.9], 2.5),
    ([-0.75, 0.9], 3.0),
    ([1.0, -0.4], 2.2),
    ([1.0, 0.4], 2.4),
    ([-1.0, -0.4], 3.0),
    ([-1.0, 0.4], 3.2),
];
/// The cost of covering a line, of lying between marks that are as near, and of each step away.
const LINE_COST: f64 = 2.6;
const UNCLEAR_COST: f64 = 2.2;
const RING_COST: f64 = 1.5;
/// Gap between a text and a line, points.
const LINE_GAP: f64 = 2.0;
/// A text is its own mark's where any other is so much farther from it, points.
const CLEARLY_NEARER: f64 = 4.0;

/// Returns the texts that [`place`] places, and the lines from marks to texts that are far away.
pub fn words_and_leaders(wishes: &[LabelRequest], obstacles: &LabelObstacles) -> (Vec<PlotText>, Vec<PlotLine>) {
    let placed: Vec<PlacedLabel> = place(wishes, obstacles).into_iter().flatten().collect();
    let leader = |placed: &PlacedLabel| {
        let points = placed.leader?.to_vec();
        Some(PlotLine { points, width: 0.8, ink: placed.text.ink, faint: false })
    };
    let leaders = placed.iter().filter_map(leader).collect();
    (placed.into_iter().map(|placed| placed.text).collect(), leaders)
}

/// Returns the place of each label, found in the order of `wishes`: near its mark; where nothing is free there, farther
/// away with a line to it if it must be shown; `None` where it has none.
pub fn place(wishes: &[LabelRequest], obstacles: &LabelObstacles) -> Vec<Option<PlacedLabel>> {
    let mut taken = TakenPlaces::default();
    wishes
        .iter()
        .map(|wish| {
            let near = best(wish, 0..1, (obstacles, &taken), Strictness::Free);
            let far = |strictness| best(wish, 1..MOST_RINGS, (obstacles, &taken), strictness);
            // In the middle of a crowd every line leads through another mark, and whiskers leave no place at all.
            let must = || {
                let free = far(Strictness::Free).or_else(|| far(Strictness::LineThroughMarks));
                free.or_else(|| best(wish, 0..MOST_RINGS, (obstacles, &taken), Strictness::OverWhiskers))
            };
            let placed = near.or_else(|| wish.must.then(must).flatten())?;
            taken.texts.push(placed.text.rect());
            taken.leaders.extend(placed.leader);
            Some(placed)
        })
        .collect()
}

/// What the texts placed so far take.
#[derive(Debug, Default)]
struct TakenPlaces {
    texts: Vec<PlotRect>,
    leaders: Vec<[[f64; 2]; 2]>,
}

/// What a label may do where nothing is free. It never covers marks and other labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Strictness {
    /// It may cover whiskers and others' lines, and its line may lead through marks.
    OverWhiskers,
    /// Its line may lead through other marks.
    LineThroughMarks,
    /// Nothing of that.
    Free,
}

/// Returns the free place with the lowest cost in the label's area, so many steps away from the mark; `None` where none is
/// free.
fn best(
    wish: &LabelRequest,
    rings: std::ops::Range<u32>,
    (obstacles, taken): (&LabelObstacles, &TakenPlaces),
    strictness: Strictness,
) -> Option<PlacedLabel> {
    let tries = rings.flat_map(|ring| AROUND.iter().map(move |(direction, cost)| (ring, direction, cost)));
    let candidates = tries.filter_map(|(ring, direction, cost)| {
        let text = beside(wish, *direction, f64::from(ring) * RING_STEP);
        let rect = text.rect();
        let [[left, top], [right, bottom]] = [rect.min, rect.max];
        let wide = PlotRect { min: [left - LINE_GAP, top], max: [right + LINE_GAP, bottom] };
        let covers_mark = obstacles.marks.iter().any(|mark| around(*mark).overlaps(&rect));
        let covers = |lines: &[[[f64; 2]; 2]]| lines.iter().any(|line| crosses(line, &wide));
        if covers_mark || !wish.area.holds(&rect) || taken.texts.iter().any(|other| other.overlaps(&rect)) {
            return None;
        }
        let is_covering = covers(&obstacles.whiskers) || covers(&taken.leaders);
        if is_covering && strictness > Strictness::OverWhiskers {
            return None;
        }
        let own = distance(wish.at, &rect);
        let others = obstacles.marks.iter().filter(|mark| **mark != wish.at);
        let is_clear = ring == 0 && others.clone().all(|mark| distance(*mark, &rect) >= own + CLEARLY_NEARER);
        let leader = (!is_clear).then(|| leader(wish.at, &rect));
        // A line that leads through another text or mark leads nowhere.
        let is_lost = |line: &[[f64; 2]; 2]| {
            let is_through_mark = || others.clone().any(|mark| crosses(line, &core(*mark)));
            taken.texts.iter().any(|text| crosses(line, text)) || strictness == Strictness::Free && is_through_mark()
        };
        if leader.as_ref().is_some_and(is_lost) {
            return None;
        }
        let lines = obstacles.segments.iter().filter(|segment| crosses(segment, &wide)).count();
        let met = leader.iter().flat_map(|leader| taken.leaders.iter().filter(|other| meet(leader, other))).count();
        let unclear = if is_clear { 0.0 } else { UNCLEAR_COST };
        let cost = cost + unclear + RING_COST * f64::from(ring) + LINE_COST * (lines + met) as f64;
        Some((cost, PlacedLabel { text, leader }))
    });
    candidates.min_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, placed)| placed)
}

/// Returns the label's text `farther` than beside its mark in a direction, points, anchored towards it. To the left or right
/// it is also clear of the mark's whisker, if that is not too long.
fn beside(wish: &LabelRequest, [right, down]: [f64; 2], farther: f64) -> PlotText {
    let anchor = if right > 0.0 {
        TextAnchor::Start
    } else if right < 0.0 {
        TextAnchor::End
    } else {
        TextAnchor::Middle
    };
    let free = |whisker: f64| {
        let behind = if down == 0.0 { whisker.min(LONGEST_FREE) + LINE_GAP + 1.0 } else { 0.0 };
        AWAY.max(behind) + farther
    };
    let [left_away, right_away] = wish.whiskers.map(free);
    let across = if right < 0.0 { right * left_away } else { right * right_away };
    // Above and below, half of the text's height is between it and the mark too.
    let at = [wish.at[0] + across, wish.at[1] + down * (AWAY + SMALL_SIZE * 0.6 + farther)];
    PlotText::new(at, wish.text.clone(), SMALL_SIZE, wish.ink).anchored(anchor)
}

/// Returns the square around a mark with this centre that texts leave free.
fn around([x, y]: [f64; 2]) -> PlotRect {
    PlotRect { min: [x - CLEAR, y - CLEAR], max: [x + CLEAR, y + CLEAR] }
}

/// Returns the square that a mark with this centre covers.
fn core([x, y]: [f64; 2]) -> PlotRect {
    PlotRect { min: [x - RADIUS, y - RADIUS], max: [x + RADIUS, y + RADIUS] }
}

/// Returns how far a place is from a rectangle, points.
fn distance(from: [f64; 2], rect: &PlotRect) -> f64 {
    let [right, down] = [0, 1].map(|axis| from[axis] - from[axis].clamp(rect.min[axis], rect.max[axis]));
    right.hypot(down)
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

/// Returns whether two segments cross.
fn meet([a, b]: &[[f64; 2]; 2], [c, d]: &[[f64; 2]; 2]) -> bool {
    let side = |from: &[f64; 2], to: &[f64; 2], at: &[f64; 2]| {
        (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Returns the width that a label takes beside a point with such a whisker, points: for those that are laid out in
/// lanes.
pub fn reach(text: &str, whisker: f64) -> f64 {
    AWAY.max(whisker.min(LONGEST_FREE) + LINE_GAP + 1.0) + text_width(text, SMALL_SIZE)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: PlotRect = PlotRect { min: [0.0, 0.0], max: [200.0, 100.0] };

    fn wish(at: [f64; 2], must: bool) -> LabelRequest {
        let text = "1024".to_owned();
        LabelRequest { at, whiskers: [0.0; 2], text, ink: PlotInk::Text, area: AREA, must }
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
        let obstacles = LabelObstacles { marks: (0..25).map(at).collect(), ..LabelObstacles::default() };
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
    fn where_whiskers_leave_no_place_one_that_must_be_shown_lies_over_them() {
        let whiskers: Vec<[[f64; 2]; 2]> =
            (0..26).map(|y| [[0.0, f64::from(y) * 4.0], [200.0, f64::from(y) * 4.0]]).collect();
        let obstacles = LabelObstacles { marks: vec![[100.0, 50.0]], whiskers, ..LabelObstacles::default() };
        let found = placed(&[wish([100.0, 50.0], true), wish([100.0, 50.0], false)], &obstacles);
        let text = found[0].as_ref().expect("its name is shown").text.rect();
        assert!(AREA.holds(&text) && !around([100.0, 50.0]).overlaps(&text), "{text:?}");
        assert!(found[1].is_none(), "another label is left out");
    }

    #[test]
    fn words_far_away_have_a_line_back() {
        let marks: Vec<[f64; 2]> =
            (0..49).map(|i| [76.0 + f64::from(i % 7) * 8.0, 26.0 + f64::from(i / 7) * 8.0]).collect();
        let obstacles = LabelObstacles { marks, ..LabelObstacles::default() };
        let found = placed(&[wish([100.0, 50.0], true)], &obstacles);
        assert!(found[0].as_ref().is_some_and(|placed| placed.leader.is_some()));
    }

    #[test]
    fn a_line_is_covered_only_where_there_is_no_other_place() {
        let obstacles = LabelObstacles { segments: vec![[[50.0, 50.0], [200.0, 50.0]]], ..LabelObstacles::default() };
        let found = placed(&[wish([50.0, 50.0], false)], &obstacles);
        assert_eq!(found[0].as_ref().map(|placed| placed.text.anchor), Some(TextAnchor::End));
    }

    #[test]
    fn a_whisker_is_never_covered_and_a_text_between_two_marks_has_a_line_to_its_own() {
        let whiskers = vec![[[0.0, 50.0], [200.0, 50.0]]];
        let found = placed(&[wish([100.0, 50.0], false)], &LabelObstacles { whiskers, ..LabelObstacles::default() });
        let text = found[0].as_ref().expect("a place above").text.rect();
        assert!(text.max[1] < 50.0 && text.min[1] > 20.0, "{text:?}");
        // Below and above there is no room, and to the right another mark is as near.
        let area = PlotRect { min: [0.0, 43.0], max: [200.0, 57.0] };
        let end = 60.0 + AWAY + text_width("1024", SMALL_SIZE);
        let marks = vec![[60.0, 50.0], [end + CLEAR + 0.5, 50.0]];
        let found = placed(
            &[LabelRequest { area, ..wish([60.0, 50.0], false) }],
            &LabelObstacles { marks, segments: vec![[[10.0, 50.0], [40.0, 50.0]]; 4], ..LabelObstacles::default() },
        );
        assert!(found[0].as_ref().is_some_and(|placed| placed.leader.is_some()), "{found:?}");
    }

    #[test]
    fn segments_touch_rectangles() {
        assert!(crosses(&[[-10.0, 50.0], [300.0, 60.0]], &AREA));
        assert!(crosses(&[[10.0, 10.0], [20.0, 20.0]], &AREA));
        assert!(!crosses(&[[-10.0, 50.0], [-10.0, 60.0]], &AREA));
        assert!(!crosses(&[[-30.0, 20.0], [20.0, -30.0]], &AREA));
    }
}
