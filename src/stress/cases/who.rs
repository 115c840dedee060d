//! Variants of techniques that run beside the usual ones, names of their failures, and sentences that many cases share.

use crate::stress::{CaseNumber, Entrant, KnownFailure, LeastShares, StressCase};
use crate::technique::Technique;

pub const AUTO: Entrant = Entrant::of(Technique::Auto);
pub const Z_FAIL: Entrant = Entrant::of(Technique::ZFail);
pub const Z_PASS: Entrant = Entrant::of(Technique::ZPass);
pub const Z_PASS_PLUS: Entrant = Entrant::of(Technique::ZPassPlus);
pub const MAP: Entrant = Entrant::of(Technique::ShadowMap);
pub const PLANAR: Entrant = Entrant::of(Technique::Planar);
pub const TEXTURE: Entrant = Entrant::of(Technique::PlanarTexture);
pub const SILHOUETTE: Entrant = Entrant::of(Technique::Projective);

pub const FAR_CLIP: Entrant = Entrant::with(Technique::ZFail, &[("depth", "standard-finite")]);
pub const FAR_CLAMP: Entrant = Entrant::with(Technique::ZFail, &[("depth", "standard-finite-clamp")]);
pub const TO_INFINITY: Entrant = Entrant::with(Technique::ZFail, &[("depth", "standard-infinite")]);
pub const FINITE: Entrant = Entrant::with(Technique::ZFail, &[("extrusion", "finite:2")]);
pub const IN_FLOAT: Entrant = Entrant::with(Technique::ZFail, &[("counter", "float")]);
pub const CLAMPED: Entrant = Entrant::with(Technique::ZFail, &[("operations", "clamp")]);
pub const CLAMPED_IN_TURN: Entrant = Entrant::with(Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass")]);
pub const CLAMPED_BACKWARDS: Entrant =
    Entrant::with(Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass"), ("order", "subtract-first")]);
pub const PARITY: Entrant = Entrant::with(Technique::ZFail, &[("operations", "invert")]);
pub const FOUR_BITS: Entrant = Entrant::with(Technique::ZFail, &[("stencil-bits", "4")]);
pub const EYE_COUNT: Entrant = Entrant::with(Technique::ZPass, &[("start", "eye-count")]);
pub const EDGE_LIST: Entrant = Entrant::with(Technique::ZFail, &[("silhouette", "edge-list")]);
pub const BY_VERTEX_SHADER: Entrant = Entrant::with(Technique::ZFail, &[("extruded-by", "vertex-shader")]);
pub const LIGHT_FACING: Entrant = Entrant::with(Technique::ZFail, &[("casters", "light-facing")]);
pub const ALL_CAST: Entrant = Entrant::with(Technique::ZFail, &[("casters", "all")]);
pub const CAPS_NEVER: Entrant = Entrant::with(Technique::ZFail, &[("light-caps", "never")]);
pub const UNBIASED: Entrant = Entrant::with(Technique::ShadowMap, &[("bias-slope", "0"), ("bias-constant", "0")]);
pub const COARSE: Entrant = Entrant::with(Technique::ShadowMap, &[("size", "128")]);
pub const DETACHED: Entrant = Entrant::with(Technique::ShadowMap, &[("bias-slope", "200")]);
pub const UNCLIPPED: Entrant = Entrant::with(Technique::Planar, &[("clip", "off")]);
pub const REVERSED: Entrant = Entrant::with(Technique::Projective, &[("reverse", "on")]);

/// Returns a known failure of a technique that shows at every value, by its name and reason.
pub const fn fails(of: Entrant, name: &'static str, because: &'static str) -> KnownFailure {
    KnownFailure::new(of, name, because)
}

/// Rounding in a vertex shader that computes facing and far vertices in 24 bits.
pub const FACING_IN_F32: KnownFailure = fails(
    BY_VERTEX_SHADER,
    "f32-limit",
    "a vertex shader tells in 24 bits which way a triangle faces and its vertices go, and the light is too near its plane",
);

pub const NOT_PLANAR: KnownFailure =
    fails(PLANAR, "not-planar", "a receiver that is not flat gets no shadow").is_missing().at_most(0.007);
pub const NOT_PLANAR_TEXTURE: KnownFailure =
    fails(TEXTURE, "not-planar", "a receiver that is not flat has no texture, so it gets no shadow")
        .is_missing()
        .at_most(0.008);
pub const NO_SELF_SHADOW: KnownFailure =
    fails(SILHOUETTE, "self-shadow", "a silhouette is not thrown on the object that it is of")
        .is_missing()
        .at_most(0.005);
pub const BETWEEN: KnownFailure = fails(
    SILHOUETTE,
    "between",
    "no depth is compared: what stands between light and caster is darkened like what lies behind",
)
.is_false()
.at_most(0.02);
pub const NO_FIT: KnownFailure = fails(
    SILHOUETTE,
    "no-fit",
    "no picture holds a caster that reaches behind the light, so it casts nothing and the plan says so",
)
.is_missing();
/// Volumes cut by the near plane, so that z-pass misses counts; each case has its own share of wrong pixels.
pub const CUT_BY_NEAR: KnownFailure =
    fails(Z_PASS, "near-plane", "faces that the near plane cuts away, or that are behind the eye, are not counted");

/// The defaults of a case's fields: one value, in the easiest scene.
pub const PLAIN: StressCase = StressCase {
    name: "",
    lesson: "",
    parameter: "form",
    values: &[0.0],
    drives: CaseNumber::Scene(|_| super::stage::still_life()),
    size: None,
    timed: false,
    also: &[],
    without: &[],
    up_to: &[],
    heavy_above: None,
    failures: &[],
    least: |_| LeastShares::USUAL,
    trend: None,
};
