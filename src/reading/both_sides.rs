//! Two frames side by side: what each is called, which passes belong together, and which draws.

use super::capture_point::CapturePoint;
use super::steps;
use crate::capture::{Capture, DrawSummary, Step};
use crate::technique::Technique;
use std::sync::Arc;

/// Where a frame is while another one, or it alone, is shown pass by pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SidePoint {
    /// Before its first pass.
    Before,
    /// After the pass of this index.
    At(usize),
    /// It has no pass like the other frame's: still after the pass of this index.
    StaysAt(usize),
}

/// Returns what each frame is called beside the others: its technique, with the settings that are not the defaults, and
/// for frames of one technique those that differ.
pub fn names(frames: &[Arc<Capture>]) -> Vec<String> {
    let name = |frame: &Arc<Capture>| {
        let specs = Technique::from_name(&frame.technique).map_or(&[][..], |technique| technique.settings());
        let settings = specs.iter().filter_map(|spec| {
            let value = frame.settings.get(spec.key)?;
            let differs = |other: &Arc<Capture>| {
                other.technique == frame.technique && other.settings.get(spec.key).is_some_and(|other| other != value)
            };
            (value != spec.default || frames.iter().any(differs)).then(|| format!(", {} {value}", spec.key))
        });
        settings.fold(frame.technique.clone(), |name, setting| name + &setting)
    };
    frames.iter().map(name).collect()
}

/// Returns where each frame is in each picture of them pass by pass: one after the other; of two, passes of the same name
/// and light at once, in the order of both, as many of them as there can be.
pub fn aligned(frames: &[Arc<Capture>]) -> Vec<Vec<SidePoint>> {
    let [first, second] = frames else {
        let of_one = frames.first().into_iter().flat_map(|frame| steps::numbered(frame));
        return of_one.map(|step| vec![SidePoint::At(step)]).collect();
    };
    let [a, b]: [Vec<usize>; 2] = [first, second].map(|frame| steps::numbered(frame).collect());
    let is_same = |i: usize, j: usize| is_like(&first.steps[a[i]], &second.steps[b[j]]);
    // The most passes that belong together, from pass i of one and pass j of the other on.
    let mut most = vec![vec![0_u32; b.len() + 1]; a.len() + 1];
    for i in (0..a.len()).rev() {
        for j in (0..b.len()).rev() {
            let alone = most[i + 1][j].max(most[i][j + 1]);
            most[i][j] = if is_same(i, j) { alone.max(most[i + 1][j + 1] + 1) } else { alone };
        }
    }
    let stays = |steps: &[usize], next: usize| match next.checked_sub(1) {
        Some(last) => SidePoint::StaysAt(steps[last]),
        None => SidePoint::Before,
    };
    let (mut i, mut j, mut pictures) = (0, 0, Vec::new());
    while i < a.len() || j < b.len() {
        let (has_a, has_b) = (i < a.len(), j < b.len());
        if has_a && has_b && is_same(i, j) && most[i][j] == most[i + 1][j + 1] + 1 {
            pictures.push(vec![SidePoint::At(a[i]), SidePoint::At(b[j])]);
            (i, j) = (i + 1, j + 1);
        } else if has_a && (!has_b || most[i + 1][j] >= most[i][j + 1]) {
            pictures.push(vec![SidePoint::At(a[i]), stays(&b, j)]);
            i += 1;
        } else {
            pictures.push(vec![stays(&a, i), SidePoint::At(b[j])]);
            j += 1;
        }
    }
    pictures
}

/// The point of another frame that belongs to one of the shown frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Counterpart {
    /// The point.
    pub point: CapturePoint,
    /// What the other frame lacks, so that the point is another moment, in a few words; `None` where it is the same.
    pub lacks: Option<String>,
}

/// Returns the point of `other` that belongs to a point of `frame`: the last step to the last; otherwise the pass of the
/// same name and light, or the last step where there is none, and in it the draw of the same name; where there is
/// none the last one before it that is in both, or the whole pass. A draw is meant where its state is known.
pub fn counterpart(frame: &Capture, at: CapturePoint, other: &Capture) -> Counterpart {
    let last = other.steps.len().saturating_sub(1);
    let Some(step) = frame.steps.get(at.step) else { return Counterpart { point: last.into(), lacks: None } };
    let is_last = at.step + 1 == frame.steps.len();
    let same = same_step(frame, at.step, other);
    let is_found = is_last || other.steps.get(same).is_some_and(|found| is_like(found, step));
    if !is_found {
        return Counterpart { point: same.into(), lacks: Some(format!("no {}: the whole frame", step.name)) };
    }
    let Some(draw) = at.draw else { return Counterpart { point: same.into(), lacks: None } };
    let draws = other.steps.get(same).map_or(&[][..], |step| &step.draws);
    let Some(found) = same_draw(&step.draws, draw, draws) else {
        let name = step.draws.get(draw).map_or("such", |draw| draw.name.as_str());
        // Nothing is drawn there meanwhile: it stays after the draw before.
        let before = (0..draw).rev().find_map(|earlier| same_draw(&step.draws, earlier, draws));
        let stays = before.map(|found| CapturePoint { step: same, draw: Some(found) });
        let stays = stays.filter(|point| point.is_known(other));
        return Counterpart {
            point: stays.unwrap_or(same.into()),
            lacks: Some(if stays.is_some() { format!("no {name}") } else { format!("no {name}: the whole pass") }),
        };
    };
    let point = CapturePoint { step: same, draw: Some(found) };
    match point.is_known(other) {
        true => Counterpart { point, lacks: None },
        false => {
            Counterpart { point: same.into(), lacks: Some("the whole pass, until its draws are captured".to_owned()) }
        }
    }
}

/// Returns the step of `now` that means what step `index` of `before` meant: the last stays the last; else the pass of
/// the same name and light; else the last, which shows the whole frame.
pub fn same_step(before: &Capture, index: usize, now: &Capture) -> usize {
    let last = now.steps.len().saturating_sub(1);
    let Some(step) = before.steps.get(index).filter(|_| index + 1 < before.steps.len()) else { return last };
    if now.steps.get(index).is_some_and(|candidate| is_like(candidate, step)) {
        return index;
    }
    now.steps.iter().position(|candidate| is_like(candidate, step)).unwrap_or(last)
}

fn is_like(one: &Step, other: &Step) -> bool {
    one.name == other.name && one.light == other.light
}

/// Returns the draw of the same name and part as draw `index`; of several alike, the one that comes as late among them.
fn same_draw(draws: &[DrawSummary], index: usize, others: &[DrawSummary]) -> Option<usize> {
    let draw = draws.get(index)?;
    let is_same = |other: &DrawSummary| (&other.name, other.part) == (&draw.name, draw.part);
    let earlier = draws[..index].iter().filter(|other| is_same(other)).count();
    (0..others.len()).filter(|other| is_same(&others[*other])).nth(earlier)
}
