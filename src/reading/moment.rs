//! Of which moment of the frame a verdict speaks: the stencil that is shown is not always the one that was tested.

use crate::capture::{Capture, FrameSnapshot, FrameTarget, Snapshot, Step};
use crate::history::{Verdict, VolumeCount};
use crate::numbers;
use crate::plan::DrawPart;
use crate::reading::capture_point::CapturePoint;

/// Returns whether a pass adds a light to the picture: it draws surfaces, and nothing else, in colour. Passes that count or
/// mark draw volumes and receivers; those that darken what is lit draw flattened casters.
fn adds_light(step: &Step, light: usize) -> bool {
    let is_picture = matches!(&step.snapshot, Snapshot::Frame(frame) if frame.target == FrameTarget::Picture);
    let draws_surfaces = step.draws.iter().all(|draw| draw.part == DrawPart::Surface);
    step.light == Some(light) && is_picture && draws_surfaces && !step.draws.is_empty()
}

/// Returns a verdict's title as it is read beside the stencil after `point` at pixel `at` (column, row): where another
/// value stands there than the light pass tested, it says when the count was so.
pub fn title(verdict: &Verdict, capture: &Capture, point: CapturePoint, at: [u32; 2]) -> String {
    let stencil = |frame: &FrameSnapshot| frame.stencil.as_ref()?.image.byte_at(at);
    let pass = capture.steps.iter().rposition(|step| adds_light(step, verdict.light));
    let (Ok(subject), Some(VolumeCount::Stencil(tested)), Some(shown), Some(pass)) =
        (verdict.subject(), verdict.count, point.frame(capture).and_then(stencil), pass)
    else {
        return verdict.title();
    };
    let count = numbers::signed(tested);
    let after = capture.frame_at(pass).and_then(stencil).filter(|after| *after != tested);
    match (shown == tested, point.step < pass, after.map(numbers::signed)) {
        (true, ..) => verdict.title(),
        (_, true, _) => format!("{subject}: its stencil count is {count} once the light pass tests it."),
        (.., None) => format!("{subject}: its stencil count was {count} when the light pass tested it."),
        (.., Some(after)) => format!(
            "{subject}: its stencil count was {count} when the light pass tested it; the pass then made it {after}."
        ),
    }
}
