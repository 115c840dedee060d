//! The steps of a frame as one goes through them. A mask is none of them: it stands beside the frame, has no number,
//! and is passed over.

use crate::capture::{Capture, FrameTarget, Snapshot};
use crate::plan::DecidedBy;
use crate::reading::format;

/// Does a step stand beside the frame? So does a mask: it writes what the technique says of a light at every pixel, to
/// compare techniques, and nothing reads it. Labels that the light pass reads are part of the frame.
pub fn is_beside(capture: &Capture, index: usize) -> bool {
    capture.steps.get(index).is_some_and(|step| {
        let writes_labels = matches!(&step.snapshot, Snapshot::Frame(frame) if frame.target == FrameTarget::Labels);
        writes_labels && step.light.is_none_or(|light| capture.decided_by(light) != DecidedBy::Labels)
    })
}

/// The steps that have a number, by index, in order.
pub fn numbered(capture: &Capture) -> impl DoubleEndedIterator<Item = usize> {
    (0..capture.steps.len()).filter(|index| !is_beside(capture, *index))
}

/// How many steps have a number.
pub fn count(capture: &Capture) -> usize {
    numbered(capture).count()
}

/// The number of a step, from 1; `None` for a mask.
pub fn number(capture: &Capture, index: usize) -> Option<usize> {
    numbered(capture).position(|step| step == index).map(|place| place + 1)
}

/// The step of this number, by index; the last where there are fewer, the first for 0.
pub fn of_number(capture: &Capture, number: usize) -> usize {
    let last = numbered(capture).next_back();
    numbered(capture).nth(number.saturating_sub(1)).or(last).unwrap_or(0)
}

/// The step with a number after this one.
pub fn next(capture: &Capture, index: usize) -> Option<usize> {
    numbered(capture).find(|step| *step > index)
}

/// The step with a number before this one.
pub fn previous(capture: &Capture, index: usize) -> Option<usize> {
    numbered(capture).rfind(|step| *step < index)
}

/// `step 2`, `the mask of light 1`.
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

/// `2 · volumes`, `mask`: what its row is called.
pub fn title(capture: &Capture, index: usize) -> String {
    let name = capture.steps.get(index).map_or("", |step| step.name.as_str());
    number(capture, index).map_or_else(|| name.to_owned(), |number| format!("{number} · {name}"))
}
