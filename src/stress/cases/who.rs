//! Variants of techniques that run beside the usual ones, names of their failures, and sentences that many cases share.

use crate::stress::{CaseNumber, Entrant, KnownFailure, LeastShares, StressCase};
use crate::technique::Technique;

/// The technique `auto` with its default settings.
pub const AUTO: Entrant = Entrant::of(Technique::Auto);
/// Z-fail with its default settings.
pub const Z_FAIL: Entrant = Entrant::of(Technique::ZFail);
/// Z-pass with its default settings.
pub const Z_PASS: Entrant = Entrant::of(Technique::ZPass);
/// Z-pass-plus with its default settings.
pub const Z_PASS_PLUS: Entrant = Entrant::of(Technique::ZPassPlus);
/// Shadow maps with their default settings.
pub const MAP: Entrant = Entrant::of(Technique::ShadowMap);
/// Planar shadows with their default settings.
pub const PLANAR: Entrant = Entrant::of(Technique::Planar);
/// Receiver textures (`planar-texture`) with their default settings.
pub const TEXTURE: Entrant = Entrant::of(Technique::PlanarTexture);
/// Projective shadow textures (`projective`) with their default settings.
pub const SILHOUETTE: Entrant = Entrant::of(Technique::Projective);

/// Z-fail with a far plane that clips volumes (`depth = standard-finite`).
pub const FAR_CLIP: Entrant = Entrant::with(Technique::ZFail, &[("depth", "standard-finite")]);
/// Z-fail with depth clamped at the far plane (`depth = standard-finite-clamp`).
pub const FAR_CLAMP: Entrant = Entrant::with(Technique::ZFail, &[("depth", "standard-finite-clamp")]);
/// Z-fail with standard depth without a far plane (`depth = standard-infinite`).
pub const TO_INFINITY: Entrant = Entrant::with(Technique::ZFail, &[("depth", "standard-infinite")]);
/// Z-fail with volumes that end: far vertices are carried on by twice their distance from a point light (`extrusion =
/// finite:2`).
pub const FINITE: Entrant = Entrant::with(Technique::ZFail, &[("extrusion", "finite:2")]);
/// Z-fail that counts in a float target (`counter = float`).
pub const IN_FLOAT: Entrant = Entrant::with(Technique::ZFail, &[("counter", "float")]);
/// Z-fail whose stencil operations clamp instead of wrapping (`operations = clamp`), both faces in one pass.
pub const CLAMPED: Entrant = Entrant::with(Technique::ZFail, &[("operations", "clamp")]);
/// Z-fail with clamping operations in two passes, incrementing faces first.
pub const CLAMPED_IN_TURN: Entrant = Entrant::with(Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass")]);
/// Z-fail with clamping operations in two passes, decrementing faces first.
pub const CLAMPED_BACKWARDS: Entrant =
    Entrant::with(Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass"), ("order", "subtract-first")]);
/// Z-fail that inverts a bit instead of counting (`operations = invert`).
pub const PARITY: Entrant = Entrant::with(Technique::ZFail, &[("operations", "invert")]);
/// Z-fail that counts in four bits of the stencil.
pub const FOUR_BITS: Entrant = Entrant::with(Technique::ZFail, &[("stencil-bits", "4")]);
/// Z-pass whose count begins at the number of volumes around the eye (`start = eye-count`).
pub const EYE_COUNT: Entrant = Entrant::with(Technique::ZPass, &[("start", "eye-count")]);
/// Z-fail that finds the silhouette by searching a list of edges (`silhouette = edge-list`).
pub const EDGE_LIST: Entrant = Entrant::with(Technique::ZFail, &[("silhouette", "edge-list")]);
/// Z-fail that finds silhouettes between triangles that share corners by their file's numbers.
pub const SHARED_CORNERS: Entrant = Entrant::with(Technique::ZFail, &[("silhouette", "shared-corners")]);
/// Z-fail whose volumes of mirrored objects are wound as if nothing were mirrored, and whose counts stop at 0.
pub const UNFLIPPED: Entrant =
    Entrant::with(Technique::ZFail, &[("mirrored", "kept"), ("operations", "clamp"), ("faces", "two-pass")]);
/// Z-fail whose positions are rounded to single precision in world space.
pub const F32_WORLD: Entrant = Entrant::with(Technique::ZFail, &[("world", "f32")]);
/// Shadow maps of a lamp with given near and far planes, at 0.5 and 1.5 metres.
pub const GIVEN_PLANES: Entrant = Entrant::with(Technique::ShadowMap, &[("light-frustum", "120:0.5:1.5")]);
/// Shadow maps that are fitted to what the camera sees, whose texels move over the world as it moves.
pub const VIEW_MAP: Entrant = Entrant::with(Technique::ShadowMap, &[("light-frustum", "view")]);
/// Shadow maps that follow the view by whole texels.
pub const SNAPPED_MAP: Entrant = Entrant::with(Technique::ShadowMap, &[("light-frustum", "view-snapped")]);
/// Z-fail whose volumes a vertex shader extrudes.
pub const BY_VERTEX_SHADER: Entrant = Entrant::with(Technique::ZFail, &[("extruded-by", "vertex-shader")]);
/// Z-fail in which only light-facing triangles cast.
pub const LIGHT_FACING: Entrant = Entrant::with(Technique::ZFail, &[("casters", "light-facing")]);
/// Z-fail in which every triangle casts (`casters = all`).
pub const ALL_CAST: Entrant = Entrant::with(Technique::ZFail, &[("casters", "all")]);
/// Z-fail whose light caps always fail the depth test (`light-caps = never`).
pub const CAPS_NEVER: Entrant = Entrant::with(Technique::ZFail, &[("light-caps", "never")]);
/// Shadow maps without any bias, which have acne.
pub const UNBIASED: Entrant = Entrant::with(Technique::ShadowMap, &[("bias-slope", "0"), ("bias-constant", "0")]);
/// Shadow maps of 128 texels a side.
pub const COARSE: Entrant = Entrant::with(Technique::ShadowMap, &[("size", "128")]);
/// Shadow maps with a slope-scaled bias of 200, which detaches shadows from their casters (peter-panning).
pub const DETACHED: Entrant = Entrant::with(Technique::ShadowMap, &[("bias-slope", "200")]);
/// Planar shadows of casters that are not clipped (`clip = off`), with anti-shadows and false shadows.
pub const UNCLIPPED: Entrant = Entrant::with(Technique::Planar, &[("clip", "off")]);
/// Projective shadow textures that are also projected behind the light (`reverse = on`).
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

/// The known failure of planar shadows to darken receivers that are not flat: missing shadow, at most 0.7 per cent of
/// compared pixels.
pub const NOT_PLANAR: KnownFailure =
    fails(PLANAR, "not-planar", "a receiver that is not flat gets no shadow").is_missing().at_most(0.007);
/// The known failure of receiver textures to darken receivers that are not flat: missing shadow, at most 0.8 per cent
/// of compared pixels.
pub const NOT_PLANAR_TEXTURE: KnownFailure =
    fails(TEXTURE, "not-planar", "a receiver that is not flat has no texture, so it gets no shadow")
        .is_missing()
        .at_most(0.008);
/// The known failure of planar shadows to darken flat receivers that cover less of the picture than their default asks
/// for: missing shadow, at most 0.6 per cent of compared pixels.
pub const RECEIVER_LEFT_OUT: KnownFailure =
    fails(PLANAR, "receiver-left-out", "a flat receiver that covers less than 0.5 % of the picture gets no shadow")
        .is_missing()
        .at_most(0.006);
/// The known failure of projective shadow textures to darken their own caster: missing shadow, at most 0.5 per cent of
/// compared pixels.
pub const NO_SELF_SHADOW: KnownFailure =
    fails(SILHOUETTE, "self-shadow", "a silhouette is not thrown on the object that it is of")
        .is_missing()
        .at_most(0.005);
/// The known failure of projective shadow textures that darken what lies between light and caster: false shadow, at
/// most 2 per cent of compared pixels.
pub const BETWEEN: KnownFailure = fails(
    SILHOUETTE,
    "between",
    "no depth is compared: what stands between light and caster is darkened like what lies behind",
)
.is_false()
.at_most(0.02);
/// The known failure of projective shadow textures that no picture holds a caster that reaches behind the light:
/// missing shadow, of any share.
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
