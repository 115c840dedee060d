//! The settings that every technique has.

use super::face::{Number, SettingSpec, SettingValues, Values, Words, number, words};
use crate::math::depth::DepthMapping;
use crate::plan::Decision;
use crate::scene::Shading;

const DEPTH: Words<DepthMapping> = words("depth", &DEPTH_NAMES, &DepthMapping::ALL, "how distance becomes depth");
const DEPTH_NAMES: [&str; 5] = {
    let [a, b, c, d, e] = DepthMapping::ALL;
    [a.name(), b.name(), c.name(), d.name(), e.name()]
};
// Two to the power of −22.
const EPSILON: Number =
    number("epsilon", [0.0, 0.1], "2.4e-7", "by how much standard-infinite-epsilon pulls infinity in");
const DIFFUSE: Words<bool> =
    words("diffuse", &["lambert", "wrapped"], &[false, true], "how brightness falls off with the angle of light");
const SHADING: Words<Option<Shading>> = words(
    "shading",
    &["as-given", "flat", "gouraud", "phong"],
    &[None, Some(Shading::Flat), Some(Shading::Gouraud), Some(Shading::Phong)],
    "where light is computed: as each material says, or for all alike once a triangle, a vertex or a pixel",
);
const LEAVE_OUT: SettingSpec = SettingSpec {
    key: "leave-out",
    values: SettingValues::SomeOf(&Decision::NAMES),
    default: "all",
    meaning: "what the frame may do without where that is proven to change nothing",
};
const OCCLUSION: Words<bool> = words(
    "occlusion",
    &["off", "queries"],
    &[false, true],
    "a frame before the frame asks what shows; draws that show nothing are left out of the next",
);
const SPECS: [SettingSpec; 6] = [DEPTH.spec, EPSILON.spec, DIFFUSE.spec, SHADING.spec, LEAVE_OUT, OCCLUSION.spec];

/// A technique's settings: those that every technique has, and its `own`.
pub(in crate::technique) const fn with_own<const OWN: usize, const ALL: usize>(
    own: [SettingSpec; OWN],
) -> [SettingSpec; ALL] {
    assert!(ALL == SPECS.len() + OWN, "all settings are the common ones and its own");
    let mut all = [LEAVE_OUT; ALL];
    let mut index = 0;
    while index < ALL {
        all[index] = if index < SPECS.len() { SPECS[index] } else { own[index - SPECS.len()] };
        index += 1;
    }
    all
}

/// What every technique is told, as types.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonSettings {
    /// How distance becomes depth.
    pub depth: DepthMapping,
    /// By how much `standard-infinite-epsilon` pulls infinity in.
    pub epsilon: f64,
    /// Diffuse light wraps round the edge that Lambert's ends at.
    pub wraps_diffuse: bool,
    /// How all surfaces are shaded; `None` for each as its material says.
    pub shading: Option<Shading>,
    /// A frame before the frame asks what shows.
    pub asks_what_shows: bool,
    /// By decision that may be forbidden: it is not.
    allowed: [bool; Decision::NAMES.len()],
}

impl CommonSettings {
    pub(in crate::technique) fn read(values: &Values) -> CommonSettings {
        let allowed = match LEAVE_OUT.of(values) {
            "none" => [false; Decision::NAMES.len()],
            "all" => [true; Decision::NAMES.len()],
            some => Decision::NAMES.map(|name| some.split(',').any(|one| one.trim() == name)),
        };
        CommonSettings {
            depth: DEPTH.read(values),
            epsilon: EPSILON.read(values),
            wraps_diffuse: DIFFUSE.read(values),
            shading: SHADING.read(values),
            asks_what_shows: OCCLUSION.read(values),
            allowed,
        }
    }

    /// Why a setting does nothing as the others are; `None` where it does something.
    pub(in crate::technique) fn without_effect(values: &Values, key: &str) -> Option<&'static str> {
        let is_off = key == EPSILON.spec.key && DEPTH.read(values) != DepthMapping::StandardInfiniteEpsilon;
        is_off.then_some("No effect: only depth = standard-infinite-epsilon pulls infinity in")
    }

    /// May it be left out? Depth that is not reversed and infinite cuts volumes off, or lets surfaces tie that
    /// are apart: what hides nothing elsewhere may decide a pixel there.
    #[must_use]
    pub fn allows(&self, decision: Decision) -> bool {
        use Decision::{Clear, Light, MapFaces, Scissor, Stencil};
        let asks_no_depth = matches!(decision, Light | Stencil | Clear | MapFaces | Scissor);
        let is_safe = asks_no_depth || self.depth == DepthMapping::ReversedInfinite;
        is_safe && self.allowed.get(decision as usize).is_none_or(|allowed| *allowed)
    }
}
