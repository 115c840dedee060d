//! A frame without the draws of which no sample showed in the frame before.

use super::{Decision, FramePlan, LeftOut};

impl FramePlan {
    /// Leaves out of the timed passes each draw of which no sample passed its tests. `samples`: by pass and draw, of
    /// this very plan; `None` where that is not known, or where samples are not all that the draw does.
    ///
    /// A draw that changes nothing where it fails its tests, and passes them nowhere, changes nothing: so the frame is
    /// the same without it.
    #[must_use]
    pub fn without_unseen(mut self, samples: &[Vec<Option<u64>>]) -> FramePlan {
        for (pass, samples) in self.passes.iter_mut().zip(samples).filter(|(pass, _)| pass.timed) {
            let mut samples = samples.iter();
            let (draws, name, left_out) = (&mut pass.draws, &pass.name, &mut self.left_out);
            draws.retain(|draw| {
                let is_unseen = samples.next().is_some_and(|samples| *samples == Some(0));
                if is_unseen {
                    let because = "no sample of it passed its tests in the last frame, and nothing has moved";
                    let of = format!("the pass `{name}`");
                    left_out.push(LeftOut::named(Decision::Unseen, &draw.name, of, because));
                }
                !is_unseen
            });
        }
        self
    }
}
