//! The layout of a ladder's rungs: in order of distance, the near plane and infinity both visible, and no two marks
//! closer than a line of text.
//!
//! A distance d is placed at d / (d + s), s the surface's: the eye is at 0, the surface in the middle, infinity at 1.
//! Marks that would overlap are moved apart, in order. Where there are more rungs than can be read, some are folded
//! into a line that says how many they are and what they added. In little space lines are closer, and then more rungs
//! are folded.

use crate::history::Ladder;
use crate::plan::CountedSide;
use std::ops::Range;

/// The usual distance between two neighbouring marks of the ladder, in points.
pub const LINE: f32 = 20.0;
const LEAST_LINE: f32 = 14.0;
/// The least height of a ladder, in points, where its panel has the space.
const LEAST_HEIGHT: f32 = 220.0;
/// The most rungs that are shown one by one; with more, some are folded.
const MOST_RUNGS: usize = 16;
/// With folded rungs, how many stay open at either end and on either side of the surface and of the selected rung.
const ENDS: usize = 2;
/// Number of marks that are not rungs.
const OTHERS: usize = 4;

/// A mark on the ladder, which draws a pixel's view ray with the volume faces it crosses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LadderMark {
    /// Where the ray begins.
    Eye,
    /// The near plane.
    Near,
    /// A volume face that the ray crosses: its index in the ladder's rungs.
    Rung(usize),
    /// Folded rungs: index of the first, and of the one after the last.
    More(usize, usize),
    /// The visible surface.
    Surface,
    /// The end of the ray, at infinity.
    Infinity,
}

/// A mark and its position in points below the ladder's top.
pub type PlacedMark = (LadderMark, f32);

/// A stretch of the ray between two neighbouring marks, with the count of volumes there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CountStretch {
    /// Its upper end, points below the ladder's top.
    pub top: f32,
    /// Its lower end, points below the ladder's top.
    pub bottom: f32,
    /// The count of volumes along it.
    pub count: i32,
}

/// Computes the position of each mark within `height` points, folding rungs where they do not fit. `near` is the near
/// plane's distance in metres, `selected` the index of the selected rung, `open` has ranges of rungs that stay
/// unfolded. Also returns the distance between neighbouring marks.
pub fn place(
    ladder: &Ladder,
    near: f64,
    selected: Option<usize>,
    open: &[Range<usize>],
    height: f32,
) -> (Vec<PlacedMark>, f32) {
    let fitting = ((height / LEAST_LINE) as usize + 1).saturating_sub(OTHERS).min(MOST_RUNGS);
    let is_whole = |marks: &Vec<LadderMark>| LEAST_LINE * (marks.len() - 1) as f32 <= height;
    let mut marks_of = [(MOST_RUNGS, ENDS), (fitting, ENDS), (fitting, 1)]
        .into_iter()
        .map(|(most, ends)| marks(ladder, near, selected, open, most, ends));
    let all = marks_of.next().unwrap_or_default();
    // What the user has opened stays open, however little space there is.
    let marks = if is_whole(&all) || !open.is_empty() {
        all
    } else {
        let fewer: Vec<Vec<LadderMark>> = marks_of.collect();
        let first = fewer.iter().position(is_whole).unwrap_or(fewer.len() - 1);
        fewer.into_iter().nth(first).unwrap_or(all)
    };
    let line = (height / (marks.len() - 1) as f32).clamp(LEAST_LINE, LINE);
    let scale = ladder.surface.unwrap_or_else(|| middle_distance(ladder).unwrap_or(near * 10.0));
    let share = |distance: f64| if distance.is_finite() { distance / (distance + scale) } else { 1.0 };
    let distance = |rung: usize| ladder.rungs[rung].distance;
    let share_of = |mark: LadderMark| match mark {
        LadderMark::Eye => 0.0,
        LadderMark::Near => share(near),
        LadderMark::Rung(rung) => share(distance(rung)),
        LadderMark::More(from, to) => (share(distance(from)) + share(distance(to - 1))) / 2.0,
        LadderMark::Surface => share(scale),
        LadderMark::Infinity => 1.0,
    };
    let height = (line * (marks.len() - 1) as f32).max(height.min(LEAST_HEIGHT));
    let mut placed: Vec<PlacedMark> = marks.into_iter().map(|mark| (mark, share_of(mark) as f32 * height)).collect();
    for index in 1..placed.len() {
        placed[index].1 = placed[index].1.max(placed[index - 1].1 + line);
    }
    let mut below = height + line;
    for (_, y) in placed.iter_mut().rev() {
        *y = y.min(below - line);
        below = *y;
    }
    (placed, line)
}

/// Returns the count along the ray in stretches: from where counting begins as far as the surface; along the whole ray
/// where faces count on both sides of the surface.
pub fn stretches(ladder: &Ladder, placed: &[PlacedMark]) -> Vec<CountStretch> {
    let mut stretches = Vec::new();
    let mut count = ladder.start;
    let running = |mark: LadderMark| match mark {
        LadderMark::Rung(rung) => Some(ladder.rungs[rung].running),
        LadderMark::More(from, to) => Some(ladder.rungs[if ladder.is_from_infinity() { from } else { to - 1 }].running),
        _ => None,
    };
    let mut go = |from: &PlacedMark, to: &PlacedMark| {
        count = running(from.0).unwrap_or(count);
        stretches.push(CountStretch { top: from.1.min(to.1), bottom: from.1.max(to.1), count });
        to.0 != LadderMark::Surface || ladder.side == CountedSide::AsNeeded
    };
    // Stops after the stretch that reaches the surface, unless faces count beyond it too.
    if ladder.is_from_infinity() {
        placed.windows(2).rev().all(|pair| go(&pair[1], &pair[0]));
    } else {
        // What lies before the near plane is not drawn.
        let from_near = placed.iter().skip_while(|(mark, _)| *mark != LadderMark::Near).copied().collect::<Vec<_>>();
        from_near.windows(2).all(|pair| go(&pair[0], &pair[1]));
    }
    stretches
}

/// Returns all marks in order of distance. Of more than `most` rungs, only `ends` of them on either side of eye, near
/// plane, surface, selected rung and last rung, and those in `open`, are listed; the rest is folded.
fn marks(
    ladder: &Ladder,
    near: f64,
    selected: Option<usize>,
    open: &[Range<usize>],
    most: usize,
    ends: usize,
) -> Vec<LadderMark> {
    let before_near = ladder.rungs.partition_point(|rung| rung.distance < near);
    let before_surface = ladder.surface.map(|surface| {
        // A face at the surface's distance is on the side that its depth test says.
        let is_before = |added: i32| (added != 0) != ladder.is_from_infinity();
        let rungs = ladder.rungs.iter();
        let nearer = |distance: f64, added: i32| distance < surface || (distance == surface && is_before(added));
        rungs.take_while(|rung| nearer(rung.distance, rung.added)).count()
    });
    let edges = [Some(0), Some(before_near), before_surface, selected, Some(ladder.rungs.len())];
    let is_shown = |rung: usize| {
        let near_edge = |edge: usize| rung + ends >= edge && rung < edge + ends;
        ladder.rungs.len() <= most
            || edges.iter().flatten().any(|edge| near_edge(*edge))
            || open.iter().any(|open| open.contains(&rung))
    };
    let mut marks = vec![LadderMark::Eye];
    for rung in 0..=ladder.rungs.len() {
        if rung == before_near {
            marks.push(LadderMark::Near);
        }
        if Some(rung) == before_surface {
            marks.push(LadderMark::Surface);
        }
        if rung == ladder.rungs.len() {
            break;
        }
        match marks.last_mut() {
            _ if is_shown(rung) => marks.push(LadderMark::Rung(rung)),
            Some(LadderMark::More(_, to)) if *to == rung => *to += 1,
            _ => marks.push(LadderMark::More(rung, rung + 1)),
        }
    }
    // A line for one rung says less than the rung.
    for mark in &mut marks {
        if let LadderMark::More(from, to) = *mark
            && to == from + 1
        {
            *mark = LadderMark::Rung(from);
        }
    }
    marks.push(LadderMark::Infinity);
    marks
}

/// Returns the median of the rungs' finite distances, metres; `None` without any.
fn middle_distance(ladder: &Ladder) -> Option<f64> {
    let finite = ladder.rungs.partition_point(|rung| rung.distance.is_finite());
    ladder.rungs[..finite].get(finite / 2).map(|rung| rung.distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::{Rung, VolumeCount};
    use crate::plan::CountBits;

    /// Returns the marks at their heights where there is space for all.
    fn placed(ladder: &Ladder, near: f64, selected: Option<usize>, open: &[Range<usize>]) -> Vec<PlacedMark> {
        place(ladder, near, selected, open, 2000.0).0
    }

    /// Rungs at distances, each with what it added, counted from infinity.
    fn ladder(surface: Option<f64>, rungs: &[(f64, i32)]) -> Ladder {
        let mut ladder = Ladder {
            surface,
            side: CountedSide::Behind,
            start: 0,
            cleared_to: 0,
            bits: CountBits::EIGHT,
            count: 0,
            tested: VolumeCount::Stencil(0),
            rungs: Vec::new(),
        };
        let rung = |(event, (distance, added)): (usize, &(f64, i32))| Rung {
            event,
            distance: *distance,
            added: *added,
            running: 0,
        };
        ladder.rungs = rungs.iter().enumerate().map(rung).collect();
        for rung in ladder.rungs.iter_mut().rev() {
            ladder.count += rung.added;
            rung.running = ladder.count;
        }
        ladder
    }

    #[test]
    fn the_surface_is_between_what_is_before_and_behind_it() {
        let ladder = ladder(Some(5.0), &[(0.05, 0), (2.0, 0), (7.0, -1), (9.0, 1), (f64::INFINITY, 1)]);
        let placed = placed(&ladder, 0.1, None, &[]);
        let marks: Vec<LadderMark> = placed.iter().map(|(mark, _)| *mark).collect();
        use LadderMark::{Eye, Infinity, Near, Rung, Surface};
        assert_eq!(marks, [Eye, Rung(0), Near, Rung(1), Surface, Rung(2), Rung(3), Rung(4), Infinity]);
        assert!(placed.windows(2).all(|pair| pair[1].1 - pair[0].1 >= LINE - 1e-3), "{placed:?}");
        assert!(placed.iter().all(|(_, y)| (0.0..=LEAST_HEIGHT).contains(y)), "{placed:?}");
    }

    #[test]
    fn a_face_as_far_as_the_surface_is_on_the_side_that_its_test_says() {
        for (added, expected) in [(1, 2), (0, 3)] {
            let placed = placed(&ladder(Some(5.0), &[(5.0, added)]), 0.1, None, &[]);
            assert_eq!(placed.iter().position(|(mark, _)| *mark == LadderMark::Surface), Some(expected));
        }
    }

    #[test]
    fn the_count_runs_from_infinity_to_the_surface_and_no_further() {
        let ladder = ladder(Some(5.0), &[(2.0, 0), (7.0, -1), (9.0, 1), (12.0, 1)]);
        let stretches = stretches(&ladder, &placed(&ladder, 0.1, None, &[]));
        assert_eq!(stretches.iter().map(|one| one.count).collect::<Vec<_>>(), [0, 1, 2, 1]);
        assert!(stretches.windows(2).all(|pair| pair[1].bottom == pair[0].top));
    }

    #[test]
    fn from_the_eye_the_count_begins_with_what_holds_the_near_plane() {
        let mut ladder = ladder(Some(5.0), &[(2.0, -1), (7.0, 0)]);
        (ladder.side, ladder.start) = (CountedSide::InFront, 1);
        ladder.rungs[0].running = 0;
        let stretches = stretches(&ladder, &placed(&ladder, 0.1, None, &[]));
        assert_eq!(stretches.iter().map(|one| one.count).collect::<Vec<_>>(), [1, 0]);
    }

    #[test]
    fn of_many_rungs_every_one_is_shown_or_counted_once() {
        let rungs: Vec<(f64, i32)> = (0..600).map(|index| (1.0 + f64::from(index) * 0.01, 1 - index % 2 * 2)).collect();
        for selected in [None, Some(0), Some(100), Some(300), Some(599)] {
            let placed = placed(&ladder(Some(4.0), &rungs), 0.1, selected, &[]);
            let mut next = 0;
            for (mark, _) in &placed {
                match mark {
                    LadderMark::Rung(rung) => {
                        assert_eq!(*rung, next);
                        next += 1;
                    }
                    LadderMark::More(from, to) => {
                        assert!(*from == next && to > from);
                        next = *to;
                    }
                    _ => {}
                }
            }
            assert_eq!(next, 600);
            assert!(placed.len() < 28, "{} marks", placed.len());
            assert!(selected.is_none_or(|rung| placed.iter().any(|(mark, _)| *mark == LadderMark::Rung(rung))));
        }
    }

    #[test]
    fn in_little_room_lines_are_closer_and_then_more_rungs_are_folded() {
        let rungs: Vec<(f64, i32)> = (0..12).map(|index| (1.0 + f64::from(index), 1 - index % 2 * 2)).collect();
        let ladder = ladder(Some(6.5), &rungs);
        let rungs_of =
            |placed: &[PlacedMark]| placed.iter().filter(|(mark, _)| matches!(mark, LadderMark::Rung(_))).count();
        for (height, all) in [(400.0, true), (300.0, true), (215.0, true), (180.0, false), (140.0, false)] {
            let (placed, line) = place(&ladder, 0.1, None, &[], height);
            assert!((LEAST_LINE..=LINE).contains(&line), "{line} in {height}");
            assert_eq!(rungs_of(&placed) == 12, all, "in {height}: {placed:?}");
            let [first, last] = [placed.first(), placed.last()].map(|one| one.expect("a mark").1);
            assert!(first >= -1e-3 && last <= height + 1e-3, "{placed:?} lies in {height}");
            assert!(placed.windows(2).all(|pair| pair[1].1 - pair[0].1 >= line - 1e-3), "{placed:?}");
            let ends = stretches(&ladder, &placed).last().map(|one| one.count);
            assert_eq!(ends, Some(ladder.count), "the sum is the same");
        }
        // What was opened stays open, and what is selected stays visible.
        let opened = [2..6, 6..10];
        let (open, line) = place(&ladder, 0.1, None, &opened, 140.0);
        assert_eq!((rungs_of(&open), line), (12, LEAST_LINE));
        let (selected, _) = place(&ladder, 0.1, Some(3), &[], 140.0);
        assert!(selected.iter().any(|(mark, _)| *mark == LadderMark::Rung(3)));
    }

    #[test]
    fn what_is_open_is_not_folded_and_counts_as_before() {
        let rungs: Vec<(f64, i32)> = (0..40).map(|index| (1.0 + f64::from(index), 1 - index % 2 * 2)).collect();
        let ladder = ladder(Some(100.0), &rungs);
        let opened = [2..20, 20..38];
        let folded = placed(&ladder, 0.1, None, &[]);
        assert!(folded.iter().any(|(mark, _)| *mark == LadderMark::More(2, 38)));
        let open = placed(&ladder, 0.1, None, &opened[..1]);
        assert!((2..20).all(|rung| open.iter().any(|(mark, _)| *mark == LadderMark::Rung(rung))));
        assert!(open.iter().any(|(mark, _)| *mark == LadderMark::More(20, 38)));
        let all = placed(&ladder, 0.1, None, &opened);
        assert!(all.iter().all(|(mark, _)| !matches!(mark, LadderMark::More(..))));
        assert!(all.windows(2).all(|pair| pair[1].1 >= pair[0].1 + LINE - 0.01));
        let last = |placed: &[PlacedMark]| stretches(&ladder, placed).last().map(|one| one.count);
        assert_eq!(last(&all), last(&folded));
    }

    #[test]
    fn without_a_surface_the_count_runs_to_the_eye() {
        let ladder = ladder(None, &[(3.0, 1)]);
        let placed = placed(&ladder, 0.1, None, &[]);
        assert!(!placed.iter().any(|(mark, _)| *mark == LadderMark::Surface));
        assert_eq!(stretches(&ladder, &placed).last().map(|one| (one.top, one.count)), Some((0.0, 1)));
    }
}
