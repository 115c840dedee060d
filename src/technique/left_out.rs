//! Which decisions may be taken: those that `leave-out` allows, where they are proven to change nothing.

use super::Choice;
use crate::math::depth::DepthMapping;
use crate::plan::Decision;

impl Decision {
    /// May it be taken? Depth that is not reversed and infinite cuts volumes off, or lets surfaces tie that
    /// are apart: what hides nothing elsewhere may decide a pixel there.
    pub(super) fn is_allowed(self, choice: &Choice) -> bool {
        use Decision::{Clear, Light, MapFaces, Scissor, Stencil};
        let asks_no_depth = matches!(self, Light | Stencil | Clear | MapFaces | Scissor);
        if !asks_no_depth && choice.word("depth") != DepthMapping::ReversedInfinite.name() {
            return false;
        }
        match choice.word("leave-out") {
            "none" => false,
            "all" => true,
            some => some.split(',').any(|name| name.trim() == self.name()),
        }
    }
}
