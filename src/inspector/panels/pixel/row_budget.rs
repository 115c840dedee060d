//! How the Pixel panel's height is shared, so that the ladder is seen without scrolling: in a low window rows are lower, and
//! fewer rows of a long history are shown at once.

use super::ladder::LEAST_HEIGHT;

/// Below this height of the panel everything is closer together, points.
const TIGHT_BELOW: f32 = 1100.0;
/// From this height on the answer stays in view while the rest is scrolled, points.
const PINNED_FROM: f32 = 480.0;
/// The least width at which two values are shown in a row, points.
const LEAST_WIDTH: f32 = 290.0;
/// The height of the history without its whole rows: title, head, half a row and gaps, points.
const HISTORY_AROUND: f32 = 65.0;
/// The height of a ladder with its title, note and gaps, the preferred one and the least of one with many rungs, points.
const LADDER: f32 = 316.0;
const LEAST_LADDER: f32 = 250.0;
/// Height of its title, note and gaps alone, and of each of its rungs and ends where they are close together, points.
const LADDER_AROUND: f32 = 80.0;
const RUNG: f32 = 18.0;
/// How many rows a ladder has besides its rungs: eye, surface and infinity.
const ENDS: usize = 3;
/// How many rows are shown before they scroll: at most, and at least where space is short.
const MOST_ROWS: usize = 12;
const LEAST_ROWS: usize = 8;
/// So many rows are not worth a scroll bar of their own: the panel scrolls.
const FEW_ROWS: usize = 3;

/// Height and number of the history's rows that are visible at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HistoryRows {
    /// Height of one row, points.
    pub height: f32,
    /// How many are shown before they scroll.
    pub most: usize,
}

impl HistoryRows {
    /// The rows where there is space for all.
    const ROOMY: HistoryRows = HistoryRows { height: 22.0, most: MOST_ROWS };
    /// Height of a row where space is short, points.
    const LOW: f32 = 18.0;
}

/// Returns whether a panel of this size is so small that everything is drawn closer together.
pub fn is_tight(size: egui::Vec2) -> bool {
    size.y < TIGHT_BELOW
}

/// Returns how many values a panel of this size shows in a row.
pub fn values_in_row(size: egui::Vec2) -> usize {
    if is_tight(size) && size.x >= LEAST_WIDTH { 2 } else { 1 }
}

/// Returns whether a panel of this size is so high that the answer does not scroll.
pub fn pins_answer(size: egui::Vec2) -> bool {
    size.y >= PINNED_FROM
}

/// Returns the rows for a history of `events`, where `left` points remain for it and for the ladder of so many rungs below
/// it, `None` where there is none: high rows for all if they fit, otherwise low ones, as many as fit within limits; the
/// rest scrolls, unless it is a few.
pub fn rows(left: f32, events: usize, rungs: Option<usize>) -> HistoryRows {
    let all = events.min(MOST_ROWS);
    let [wished, least] = rungs.map_or([0.0; 2], |rungs| [LADDER, least_ladder(rungs)]);
    if HISTORY_AROUND + HistoryRows::ROOMY.height * all as f32 + wished <= left {
        return HistoryRows::ROOMY;
    }
    let fitting = ((left - HISTORY_AROUND - least) / HistoryRows::LOW).max(0.0) as usize;
    let most = fitting.clamp(LEAST_ROWS, MOST_ROWS);
    let most = if events <= most + FEW_ROWS { events } else { most };
    HistoryRows { height: HistoryRows::LOW, most }
}

/// Returns the least height in which a ladder of so many rungs can be read, points.
fn least_ladder(rungs: usize) -> f32 {
    (LADDER_AROUND + (RUNG * (rungs + ENDS) as f32).max(LEAST_HEIGHT)).min(LEAST_LADDER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_room_for_all_rows_are_high_and_else_low_and_fewer() {
        assert_eq!(rows(900.0, 40, Some(9)), HistoryRows::ROOMY);
        assert_eq!(rows(400.0, 3, None), HistoryRows::ROOMY);
        let heights = [560.0, 480.0, 420.0, 380.0, 200.0];
        let most: Vec<usize> = heights.iter().map(|left| rows(*left, 40, Some(9)).most).collect();
        assert!(most.windows(2).all(|pair| pair[0] >= pair[1]), "{most:?}");
        assert_eq!((most[0], most[4]), (12, LEAST_ROWS));
        for left in heights.into_iter().filter(|left| *left >= HISTORY_AROUND + LEAST_LADDER + 8.0 * HistoryRows::LOW) {
            let HistoryRows { height, most } = rows(left, 40, Some(9));
            assert!(HISTORY_AROUND + height * most as f32 + LEAST_LADDER <= left, "the ladder has its room in {left}");
        }
        assert!(rows(380.0, 40, None).most > rows(380.0, 40, Some(9)).most);
        // One or two more are not hidden.
        assert_eq!([9, 11, 12].map(|events| rows(200.0, events, Some(9)).most), [9, 11, LEAST_ROWS]);
        // A short ladder leaves more rows.
        let [long, short] = [9, 2].map(|rungs| rows(460.0, 40, Some(rungs)).most);
        assert!(long == LEAST_ROWS && short > long, "{long}, {short}");
    }
}
