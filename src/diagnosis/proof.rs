//! Decides what the run of a fix shows about a region, and which cause is named first.

use super::facts::SuspectedCause;
use super::fix::Fix;
use super::regions::ConnectedRegion;
use super::{Cause, CauseFound, FixWithinTechnique, FrameEffect, Proof, RegionKind};

/// The wrong pixels of one run; pixels that are too dark count as wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct WrongPixels {
    /// For each light, whether each pixel is wrong.
    pub lights: Vec<Vec<bool>>,
    /// For each light, whether each pixel is right or wrong by chance, as its map swims.
    pub swimming: Vec<Vec<bool>>,
}

/// How many pixels of a run are wrong, and how many are right or wrong by chance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct WrongCount {
    pub wrong: u64,
    pub swimming: u64,
}

impl WrongCount {
    /// Returns the number by which runs are compared: the fewer, the better.
    pub fn all(self) -> u64 {
        self.wrong + self.swimming
    }
}

impl WrongPixels {
    /// Returns the numbers of pixels, summed over the lights.
    pub fn count(&self) -> WrongCount {
        let count = |lights: &[Vec<bool>]| lights.iter().flatten().filter(|wrong| **wrong).count() as u64;
        WrongCount { wrong: count(&self.lights), swimming: count(&self.swimming) }
    }

    /// Returns what a fix does to the whole frame, of which `after` are the wrong pixels with it.
    pub fn effect(&self, after: &WrongPixels) -> FrameEffect {
        FrameEffect { before: self.count().all(), after: after.count().all() }
    }

    /// Returns, for each pixel of a region's light, whether it has the fault that regions of this kind are of.
    fn of(&self, region: &ConnectedRegion) -> &[bool] {
        let lights = if region.key.kind == RegionKind::Swims { &self.swimming } else { &self.lights };
        &lights[region.light]
    }
}

/// Compares the wrong pixels of a run with a fix to those before: returns the proof for one region, and how many of its
/// pixels are still wrong plus how many are newly wrong in its bounding box. Proven only where that is 0; partly where
/// any of its pixels is right now.
pub(crate) fn judge(
    region: &ConnectedRegion,
    before: &WrongPixels,
    after: &WrongPixels,
    size: [u32; 2],
) -> (Proof, u64) {
    let (before, after) = (before.of(region), after.of(region));
    let still = region.pixels.iter().filter(|index| after[**index]).count();
    let new = region.boxed(size).filter(|index| after[*index] && !before[*index]).count();
    let proof = match (still, new) {
        (0, 0) => Proof::Proven,
        (still, _) if still < region.pixels.len() => Proof::Part,
        _ => Proof::NotIt,
    };
    (proof, (still + new) as u64)
}

/// A suspected cause with the best result of its fixes.
#[derive(Debug, Clone)]
pub(crate) struct TriedCause {
    pub suspicion: SuspectedCause,
    pub fix: Option<Fix>,
    pub proof: Proof,
    pub left: Option<u64>,
    pub whole_frame: Option<FrameEffect>,
    pub staying: Option<FixWithinTechnique>,
    pub together_with: Vec<Cause>,
}

impl TriedCause {
    /// Returns the sort key of a cause: proven first, then partly, then refuted, then not run (an `f32` limit without a
    /// run comes second); then fewer pixels left, more samples, larger weight, smaller fix.
    fn rank(&self) -> (u8, u64, std::cmp::Reverse<usize>, std::cmp::Reverse<usize>, usize, Cause) {
        let is_limit = self.suspicion.cause == Cause::F32Limit;
        let proof = match self.proof {
            Proof::Proven => 0,
            // Nothing can prove such a limit; but a fix that takes only some pixels away makes a cause unlikely.
            Proof::NotRun if is_limit => 1,
            Proof::Part => 2,
            Proof::NotIt => 3,
            Proof::NotRun => 4,
        };
        (
            proof,
            self.left.unwrap_or(0),
            std::cmp::Reverse(self.suspicion.evidence.shown_by),
            std::cmp::Reverse(self.suspicion.weight),
            self.fix.as_ref().map_or(0, Fix::weight),
            self.suspicion.cause,
        )
    }
}

/// Sorts the tried causes, the most likely first, and converts them; none is dropped.
pub(crate) fn ranked(mut tried: Vec<TriedCause>) -> Vec<CauseFound> {
    tried.sort_by_key(TriedCause::rank);
    let found = |tried: TriedCause| CauseFound {
        cause: tried.suspicion.cause,
        evidence: tried.suspicion.evidence,
        fix: tried.fix,
        proof: tried.proof,
        pixels_left: tried.left,
        whole_frame: tried.whole_frame,
        staying: tried.staying,
        together_with: tried.together_with,
    };
    tried.into_iter().map(found).collect()
}

#[cfg(test)]
mod tests {
    use super::super::RegionKind;
    use super::super::regions::RegionKey;
    use super::*;
    use crate::accuracy::Finding;

    #[test]
    fn proven_is_only_what_leaves_nothing_wrong_in_the_box() {
        let key = RegionKey { kind: RegionKind::Wrong(Finding::FalseShadow), caster: None, receiver: None, hint: None };
        let region = ConnectedRegion { key, light: 0, pixels: vec![0, 5], bounds: [0, 0, 1, 1] };
        let wrong = |pixels: &[usize]| WrongPixels {
            lights: vec![(0..8).map(|index| pixels.contains(&index)).collect()],
            swimming: vec![vec![false; 8]],
        };
        let before = wrong(&[0, 5, 7]);
        let judged = |after: &[usize]| judge(&region, &before, &wrong(after), [4, 2]);
        assert_eq!(judged(&[7]), (Proof::Proven, 0), "what lies outside is not asked");
        assert_eq!(judged(&[5]), (Proof::Part, 1));
        assert_eq!(judged(&[1]), (Proof::Part, 1), "newly wrong");
        assert_eq!(judged(&[0, 5]), (Proof::NotIt, 2));
        assert_eq!(before.count(), WrongCount { wrong: 3, swimming: 0 });
    }
}
