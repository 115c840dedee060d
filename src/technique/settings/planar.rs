//! The settings of planar shadows.

use super::common::with_own;
use super::face::{SettingSpec, Values, Words, words};
use crate::geometry::planar::Clip;
use wgpu::{CompareFunction, DepthBiasState};

const NO_OFFSET: DepthBiasState = DepthBiasState { constant: 0, slope_scale: 0.0, clamp: 0.0 };
/// Towards the eye, in steps of depth and in depth slopes a pixel: enough for a plane that is
/// projected apart from the surface that lies in it.
const OFFSET: DepthBiasState = DepthBiasState { constant: 64, slope_scale: 2.0, clamp: 0.0 };

const STENCIL: Words<bool> = words("stencil", &["on", "off"], &[true, false], "keeps shadows on their receiver");
const BLEND: Words<bool> =
    words("blend", &["once", "twice"], &[true, false], "how often overlapping triangles darken a pixel");
const CLIP: Words<Clip> = words(
    "clip",
    &["on", "off"],
    &[Clip::BetweenPlaneAndLight, Clip::Off],
    "drops what is beyond the light or below the receiver",
);
const Z_FIGHTING: Words<(CompareFunction, DepthBiasState)> = words(
    "z-fighting",
    &["depth-off", "polygon-offset", "none"],
    &[
        (CompareFunction::Always, NO_OFFSET),
        (CompareFunction::GreaterEqual, OFFSET),
        (CompareFunction::GreaterEqual, NO_OFFSET),
    ],
    "how a shadow wins over the surface it lies on",
);
const CACHE: Words<bool> =
    words("cache", &["on", "off"], &[true, false], "keeps flattened casters until plane, caster or light change");

/// In the order in which they are shown.
pub(super) const SETTINGS: [SettingSpec; 11] =
    with_own([STENCIL.spec, BLEND.spec, CLIP.spec, Z_FIGHTING.spec, CACHE.spec]);

/// What planar shadows are told, as types.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSettings {
    /// Receivers are marked first.
    pub marks: bool,
    /// The stencil keeps pixels from being darkened twice.
    pub blends_once: bool,
    /// What is kept of a caster.
    pub clip: Clip,
    /// By which test a shadow wins over the surface it lies on.
    pub depth_compare: CompareFunction,
    /// And by how much.
    pub depth_bias: DepthBiasState,
    /// Flattened casters are kept between plans.
    pub keeps: bool,
}

impl PlanarSettings {
    /// As they are set.
    #[must_use]
    pub fn read(values: &Values) -> PlanarSettings {
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

    /// Why a setting does nothing as the others are.
    pub(in crate::technique) fn without_effect(&self, key: &str) -> Option<&'static str> {
        let is_off = key == BLEND.spec.key && !self.marks;
        is_off.then_some("No effect: without the stencil nothing keeps a pixel from being darkened twice")
    }
}
