//! One rule for each cause: it returns evidence in numbers, or nothing.
//!
//! Several causes share a fix (z-fail fixes many), so a rule without evidence would be proven for nothing. Each
//! examines the region's samples, and returns nothing where they do not show its cause; else the numbers it decided by
//! come with it, and decide whether a fix that helps proves it ([`Evidence::holds`](crate::diagnosis::Evidence::holds)).

pub(crate) mod count;
mod depth_bits;
mod engine;
pub(crate) mod filter;
mod frustum;
mod map;
pub(crate) mod map_comparison;
pub(crate) mod mesh;
pub(crate) mod number;
pub(crate) mod planar;
pub(crate) mod projective;
mod rasteriser;
mod receivers;
pub(crate) mod relit;
pub(crate) mod swim;
mod texels;
pub(crate) mod volume;

use super::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause};

/// The rules of all families.
pub(crate) const ALL: &[&[CauseRule]] = &[
    volume::RULES,
    count::RULES,
    mesh::RULES,
    engine::RULES,
    planar::RULES,
    receivers::RULES,
    texels::RULES,
    map::RULES,
    frustum::RULES,
    filter::RULES,
    swim::RULES,
    projective::RULES,
    number::RULES,
    rasteriser::RULES,
    relit::RULES,
    depth_bits::RULES,
];

/// Returns every cause for which a rule finds evidence in a region.
pub(crate) fn suspicions(facts: &FrameFacts, case: &RegionSamples) -> Vec<SuspectedCause> {
    ALL.iter().flat_map(|rules| rules.iter()).filter_map(|rule| rule(facts, case)).collect()
}
