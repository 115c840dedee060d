//! The settings of planar shadows.

use super::super::lesson::{Lesson, cited};
use super::common::with_own;
use super::face::{SettingMap, SettingSpec, WordSetting, words};
use crate::geometry::planar::FlattenClip;
use wgpu_types::{CompareFunction, DepthBiasState};

const NO_OFFSET: DepthBiasState = DepthBiasState { constant: 0, slope_scale: 0.0, clamp: 0.0 };
/// A depth bias towards the eye, enough to separate a flattened caster from the surface in whose plane it lies.
const OFFSET: DepthBiasState = DepthBiasState { constant: 64, slope_scale: 2.0, clamp: 0.0 };

const STENCIL: WordSetting<bool> = words(
    "stencil",
    &["on", "off"],
    &[true, false],
    "keeps shadows on their receiver",
    Lesson {
        text: "With `off`, the flattened casters are not kept on their receiver: shadows run off it, into the air. \
             With `on`, each receiver's pixels have a mark of its own first.",
        formula: "a receiver's mark is even; a flattened caster raises it by 1 where it is found; light is added where \
             the stencil is even",
        sources: &[cited::KILGARD],
    },
);
const BLEND: WordSetting<bool> = words(
    "blend",
    &["once", "twice"],
    &[true, false],
    "how often overlapping triangles darken a pixel",
    Lesson {
        text: "With `twice`, each layer of a flattened caster darkens what is below once more. With `once`, the \
             first one takes the mark away that the next would need.",
        formula: "once: the light, or none of it; twice: light * b^k under k layers, of which each leaves the share b",
        sources: &[cited::KILGARD],
    },
);
const CLIP: WordSetting<FlattenClip> = words(
    "clip",
    &["on", "off"],
    &[FlattenClip::BetweenPlaneAndLight, FlattenClip::Off],
    "drops what is beyond the light or below the receiver",
    Lesson {
        text: "With `off`, what is beyond the light or below the receiver throws a shadow too: the anti-shadow and \
             the false shadow. `on` keeps what is between the two.",
        formula: "with heights over the receiver's plane: a point casts where 0 < height < the light's height",
        sources: &[cited::BLINN],
    },
);
const Z_FIGHTING: WordSetting<(CompareFunction, DepthBiasState)> = words(
    "z-fighting",
    &["depth-off", "polygon-offset", "none"],
    &[
        (CompareFunction::Always, NO_OFFSET),
        (CompareFunction::GreaterEqual, OFFSET),
        (CompareFunction::GreaterEqual, NO_OFFSET),
    ],
    "how a shadow wins over the surface it lies on",
    Lesson {
        text: "A flattened caster lies in its receiver's plane: depths tie, and rounding decides pixel by pixel. \
             With `depth-off` marked pixels have no depth test; `polygon-offset` pulls the shadow towards the \
             eye; `none` shows the fight.",
        formula: "offset = slope * m + constant * r, with the triangle's depth slope m a pixel and the smallest step \
             of depth r",
        sources: &[cited::BLINN, cited::SEGAL_AKELEY],
    },
);
const CACHE: WordSetting<bool> = words(
    "cache",
    &["on", "off"],
    &[true, false],
    "keeps flattened casters until plane, caster or light change",
    Lesson {
        text: "With `off`, every frame flattens every caster anew: what a moving light costs. `on` keeps what was \
             flattened until plane, caster or light change.",
        formula: "flattened point = (P.L) V - (P.V) L, for the plane P, the light L and the point V: the same while \
             none of the three changes",
        sources: &[cited::BLINN],
    },
);

/// The settings of `planar`, in the order in which they are shown.
pub(super) const SETTINGS: [SettingSpec; 12] =
    with_own([STENCIL.spec, BLEND.spec, CLIP.spec, Z_FIGHTING.spec, CACHE.spec]);

/// The settings of planar shadows, parsed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSettings {
    /// Whether each receiver's pixels are marked in the stencil first, which keeps shadows on them.
    pub marks: bool,
    /// Whether the stencil keeps overlapping triangles from darkening a pixel twice.
    pub blends_once: bool,
    /// Which part of a caster is flattened: what lies between plane and light, or all of it.
    pub clip: FlattenClip,
    /// The depth test of a shadow against the surface that it lies on.
    pub depth_compare: CompareFunction,
    /// The depth bias of a shadow against the surface that it lies on.
    pub depth_bias: DepthBiasState,
    /// Whether flattened casters are cached between plans.
    pub keeps: bool,
}

impl PlanarSettings {
    /// Parses the settings of planar shadows; missing and invalid values become their defaults.
    pub fn read(values: &SettingMap) -> PlanarSettings {
        let (depth_compare, depth_bias) = Z_FIGHTING.read(values);
        PlanarSettings {
            marks: STENCIL.read(values),
            blends_once: BLEND.read(values),
            clip: CLIP.read(values),
            depth_compare,
            depth_bias,
            keeps: CACHE.read(values),
        }
    }

    /// Returns why a setting does nothing with the other settings as they are; `None` where it has an effect.
    pub(in crate::technique) fn without_effect(&self, key: &str) -> Option<&'static str> {
        let is_off = key == BLEND.spec.key && !self.marks;
        is_off.then_some("No effect: without the stencil nothing keeps a pixel from being darkened twice")
    }
}
