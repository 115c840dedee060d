//! The steps of a frame in the order in which a user goes through them. A mask is not one of them: it is not part of
//! the frame, has no number, and is passed over.

use crate::capture::{Capture, Snapshot};
use crate::plan::DecidedBy;
use crate::reading::format;

/// Returns whether a step is not part of the frame: a mask pass or a visibility pass, which
/// write what the technique finds only for comparing it.
/// Labels that the light pass reads are part of the frame.
pub fn is_beside(capture: &Capture, index: usize) -> bool {
    capture.steps.get(index).is_some_and(|step| {
        let is_beside = matches!(&step.snapshot, Snapshot::Frame(frame) if frame.target.is_beside());
        is_beside && step.light.is_none_or(|light| capture.decided_by(light) != DecidedBy::Labels)
    })
}

/// Returns the indices of the steps that have a number (all but masks), in order.
pub fn numbered(capture: &Capture) -> impl DoubleEndedIterator<Item = usize> {
    (0..capture.steps.len()).filter(|index| !is_beside(capture, *index))
}

/// Returns how many steps have a number.
pub fn count(capture: &Capture) -> usize {
    numbered(capture).count()
}

/// Returns the number of the step with this index, from 1; `None` for a mask.
pub fn number(capture: &Capture, index: usize) -> Option<usize> {
    numbered(capture).position(|step| step == index).map(|place| place + 1)
}

/// Returns the index of the step with this number, counted from 1; of the last numbered step where there are fewer, of
/// the first for 0, and 0 for a capture without steps.
pub fn of_number(capture: &Capture, number: usize) -> usize {
    let last = numbered(capture).next_back();
    numbered(capture).nth(number.saturating_sub(1)).or(last).unwrap_or(0)
}

/// Returns the index of the next step that has a number; `None` at the end.
pub fn next(capture: &Capture, index: usize) -> Option<usize> {
    numbered(capture).find(|step| *step > index)
}

/// Returns the index of the previous step that has a number; `None` at the start.
pub fn previous(capture: &Capture, index: usize) -> Option<usize> {
    numbered(capture).rfind(|step| *step < index)
}

/// Returns a step in words: `step 2`, or, for a mask, which has no number, `the mask of light 1`. An index without a
/// step is named as if it had that number.
pub fn words(capture: &Capture, index: usize) -> String {
    match (number(capture, index), capture.steps.get(index)) {
        (Some(number), _) => format!("step {number}"),
        (None, Some(step)) => {
            let of = step.light.map_or_else(String::new, |light| format!(" of {}", format::light(light)));
            format!("the {}{of}", step.name)
        }
        (None, None) => format!("step {}", index + 1),
    }
}

/// Returns the title of a step's row: `2 · volumes`, or only its name, `mask`, where it has no number; empty for an
/// index without a step.
pub fn title(capture: &Capture, index: usize) -> String {
    let name = capture.steps.get(index).map_or("", |step| step.name.as_str());
    number(capture, index).map_or_else(|| name.to_owned(), |number| format!("{number} · {name}"))
}
