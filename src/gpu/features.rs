//! What a plan asks of a device beyond what every frame uses. A device is opened with nothing that no plan
//! has asked for yet.

use super::GpuError;
use crate::plan::FramePlan;
use wgpu::Features;

/// A GPU feature that only few plans need.
struct OptionalFeature {
    feature: Features,
    is_needed: fn(&FramePlan) -> bool,
    /// The feature in plain words.
    name: &'static str,
    /// What to do without it.
    instead: &'static str,
}

const ON_DEMAND: [OptionalFeature; 2] = [
    OptionalFeature {
        feature: Features::DEPTH_CLIP_CONTROL,
        is_needed: |plan| plan.passes.iter().flat_map(|pass| &pass.draws).any(|draw| draw.raster.unclipped_depth),
        name: "depth clamping",
        instead: "choose another `depth`, and of a parallel camera z-pass",
    },
    OptionalFeature {
        feature: Features::FLOAT32_BLENDABLE,
        is_needed: |plan| plan.lights.iter().any(|light| light.count.is_some()),
        name: "blending of 32-bit floats",
        instead: "count in the stencil",
    },
];

/// Returns the optional GPU features that this plan needs.
pub(super) fn needed(plan: &FramePlan) -> Features {
    let needed = ON_DEMAND.iter().filter(|one| (one.is_needed)(plan));
    needed.fold(Features::empty(), |all, one| all | one.feature)
}

/// Returns the names of the features among `open`, in plain words.
pub(super) fn names(open: Features) -> Vec<&'static str> {
    ON_DEMAND.iter().filter(|one| open.contains(one.feature)).map(|one| one.name).collect()
}

/// Fails where an adapter does not offer all of the `needed` optional features; the error names the first that is
/// missing and what to use instead.
pub(super) fn check(needed: Features, offered: Features) -> Result<(), GpuError> {
    match ON_DEMAND.iter().find(|one| needed.contains(one.feature) && !offered.contains(one.feature)) {
        Some(OptionalFeature { name, instead, .. }) => Err(GpuError::MissingFeature { name, instead }),
        None => Ok(()),
    }
}
