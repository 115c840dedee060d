//! One rule a cause: evidence in numbers, or none.
//!
//! Several causes share a mend (z-fail mends much), so a rule that speaks without evidence would be proven for
//! nothing. Each looks at the region's samples, and keeps silent where they do not show what it is about.

pub(crate) mod count;
pub(crate) mod map;
pub(crate) mod mesh;
pub(crate) mod number;
pub(crate) mod planar;
pub(crate) mod projective;
pub(crate) mod volume;

use super::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause};

/// All of them.
pub(crate) const ALL: &[&[CauseRule]] =
    &[volume::RULES, count::RULES, mesh::RULES, planar::RULES, map::RULES, projective::RULES, number::RULES];

/// What may be the cause of a region.
pub(crate) fn suspicions(facts: &FrameFacts, case: &RegionSamples) -> Vec<SuspectedCause> {
    ALL.iter().flat_map(|rules| rules.iter()).filter_map(|rule| rule(facts, case)).collect()
}
