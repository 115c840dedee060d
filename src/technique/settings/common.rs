//! The settings that every technique has.

use super::super::lesson::{Lesson, cited};
use super::face::{NumberSetting, SettingMap, SettingSpec, SettingValues, WordSetting, depth_range, number, words};
use crate::math::DepthBits;
use crate::math::depth::DepthMapping;
use crate::plan::Decision;
use crate::scene::Shading;

const DEPTH: WordSetting<DepthMapping> = words(
    "depth",
    &DEPTH_NAMES,
    &DepthMapping::ALL,
    "how distance becomes depth",
    Lesson {
        text: "A far plane cuts volumes open, and what is cut away is not counted: compare `standard-finite` with \
             `reversed-infinite`, and `standard-finite-clamp`, which mends it by clamping depth. Reversed depth \
             is also the finest: floats are dense near 0, where the far end then lies. `standard-infinite` puts \
             infinity at 1, `standard-infinite-epsilon` a little before it. A parallel camera's depth is linear, and \
             no number in it is infinity: where there is no far plane it ends behind all that is in view, and \
             volumes that go on are clamped there.",
        formula: "with the distance d along the view, near plane n, far plane f and epsilon e: reversed-infinite n/d; \
             standard-infinite 1 - n/d; standard-infinite-epsilon (1 - e)(1 - n/d); standard-finite and \
             standard-finite-clamp f(d - n) / (d(f - n)); of a parallel camera (d - n) / (f - n), or reversed one less \
             that",
        sources: &[cited::EVERITT_KILGARD, cited::LENGYEL, cited::REED],
    },
);
const DEPTH_NAMES: [&str; 5] = {
    let [a, b, c, d, e] = DepthMapping::ALL;
    [a.name(), b.name(), c.name(), d.name(), e.name()]
};
const DEPTH_BITS: WordSetting<Option<DepthBits>> = words(
    "depth-bits",
    &["32", "24", "16"],
    &[None, Some(DepthBits::TWENTY_FOUR), Some(DepthBits::SIXTEEN)],
    "in how many bits depth is tested and stored: as a float, or floored to an integer",
    Lesson {
        text: "A depth buffer of k bits knows only 2^k depths. With `24` or `16`, every pass floors its depths to one \
             of them, volumes and shadow maps too: surfaces and flattened shadows that are apart become equal \
             (z-fighting), a volume's side lands on the wrong side of the surface (a miscount), and a map darkens \
             what it saw itself. Most of the integers lie near the near plane: move it out, or take more bits; \
             reversed depth saves floats alone, as integers are no denser near 0. With `32`, depth is a float. \
             wgpu can't copy 24-bit depth and has no 16-bit depth with stencil: depths here are floored in the \
             fragment shader, before the test, and only `light`, `clear`, `map-faces` and `scissor` of \
             `leave-out` are decided.",
        formula: "stored z_i = floor(s z) with s = 2^k - 1 and the depth z of `depth`; back to distance by z = z_i / \
             s: reversed-infinite d = n s / z_i; standard-infinite d = n / (1 - z_i / s); standard-finite d = f n \
             / (f - (f - n) z_i / s); of a parallel camera d = n + (f - n) z_i / s. One step of a perspective \
             camera is d^2 / (n s) long",
        sources: &[cited::LENGYEL, cited::REED, cited::SEGAL_AKELEY],
    },
);
const DEPTH_RANGE: SettingSpec = SettingSpec {
    key: "depth-range",
    values: SettingValues::DepthRange,
    default: "0,1",
    meaning: "the depths N,F between which depth is stored: the viewport's depth range (glDepthRange)",
    lesson: Lesson {
        text: "The last step from clip space to what is stored: z over w, from 0 to 1, is put between N and F. Order stays, \
             so that every depth test does, and the shadows with it, but a narrower range has fewer numbers to tell depths \
             apart: with `0.5,0.50001` surfaces fight and counts are off. With N = F all depths are one number: the surface \
             that is drawn first stays, wherever it is, and no face of a volume passes: z-pass counts none, and for z-fail, \
             which counts what fails, each counts, before the surface and behind it, so that a closed volume adds to 0. All is \
             lit. (With reversed depth and N = F = 0, the depth that is cleared to, ambient light draws nothing, and the light \
             passes, which ask for equal depth, draw alone.) WebGPU refuses N above F, as it has reversed depth by `depth`; glDepthRange takes it. With another range \
             than `0,1` only `light`, `clear`, `map-faces` and `scissor` of `leave-out` are decided. Maps keep 0 to 1. \
             `help window_from_ndc` has the matrix.",
        formula: "stored z_w = N + (F - N) z with z from 0 to 1; OpenGL's z_w = (F - N) z / 2 + (F + N) / 2 with z from -1 to \
             1; for standard-finite back to distance by d = n f (F - N) / (f F - n N - z_w (f - n))",
        sources: &[cited::SEGAL_AKELEY],
    },
};
// Two to the power of −22 by default.
const EPSILON: NumberSetting = number(
    "epsilon",
    [0.0, 0.1],
    "2.4e-7",
    "by how much standard-infinite-epsilon pulls infinity in",
    Lesson {
        text: "Infinity is stored as 1 minus this, so that rounding can't carry it beyond 1, where it would be \
             clipped.",
        formula: "depth at infinity = 1 - epsilon",
        sources: &[cited::LENGYEL],
    },
);
const DIFFUSE: WordSetting<bool> = words(
    "diffuse",
    &["lambert", "wrapped"],
    &[false, true],
    "how brightness falls off with the angle of light",
    Lesson {
        text: "With `lambert`, light ends where the surface turns away from it, and so does the shadow's own edge. \
             With `wrapped` it reaches round that edge, where a caster's own shadow then shows its triangles.",
        formula: "with the angle a between the surface's normal and the light: lambert max(0, cos a); wrapped (cos a + \
             1) / 2",
        sources: &[cited::LAMBERT, cited::GREEN],
    },
);
const AMBIENT_DIFFUSE: NumberSetting = number(
    "ambient-diffuse",
    [0.0, 1.0],
    "0",
    "the share of each light's diffuse light that arrives whatever stands between",
    Lesson {
        text: "Ambient light is the same from all sides: in it, and so in every shadow, a surface has one flat colour. With \
             `0.2`, the ambient passes add a fifth of each light's diffuse light, too, which no shadow takes away: what \
             is in shadow keeps some of its shape. What is lit stays as bright, since the light pass adds the rest. It is no \
             light that exists: surfaces that face away from the light have none of it, and shadows are never darker than \
             it. `0` has none, and no pass for it.",
        formula: "with a share s, the diffuse term D, the highlight H and 1 for V where the light arrives, else 0: ambient + \
             the sum over lights of s D + V ((1 - s) D + H)",
        sources: &[cited::LAMBERT],
    },
);
const SHADING: WordSetting<Option<Shading>> = words(
    "shading",
    &["as-given", "flat", "gouraud", "phong"],
    &[None, Some(Shading::Flat), Some(Shading::Gouraud), Some(Shading::Phong)],
    "where light is computed: as each material says, or for all alike once a triangle, a vertex or a pixel",
    Lesson {
        text: "`as-given` is what the materials say. `flat` has one normal a triangle, and its edges show. `gouraud` \
             computes light at the corners and mixes colours between them: a highlight in the middle of a triangle is \
             lost. `phong` mixes normals and computes light at every pixel. Shadows are the same in all; scene `spheres` \
             tells them apart. Where a file gives none, the normal of a vertex is the average of the normals of the triangles \
             that meet there, each as much as its area; flat shading has the triangle's own.",
        formula: "averaged normal n = the sum of (b - a) x (c - a) over the triangles at a vertex, made unit length; with weights a + b + c = 1 of a triangle's corners: flat light(n); gouraud a light(n1) + b light(n2) + c \
             light(n3); phong light(a n1 + b n2 + c n3), its normal made unit length",
        sources: &[cited::GOURAUD, cited::PHONG],
    },
);
const LEAVE_OUT: SettingSpec = SettingSpec {
    key: "leave-out",
    values: SettingValues::SomeOf(&Decision::NAMES),
    default: "all",
    meaning: "what the frame may do without where that is proven to change nothing",
    lesson: Lesson {
        text: "What a frame costs when nothing is left out: `none`; `caps,view` allows these two alone. Labels and \
             picture stay the same either way, but that a pixel at the very edge of a shadow may round otherwise where \
             other triangles (`away-triangles`) or other far corners (`beyond-receivers`) draw that edge. Under another \
             `depth` than `reversed-infinite`, which may cut volumes, only `light`, `stencil`, `clear`, `map-faces` and \
             `scissor` are decided; under fewer `depth-bits` than 32, which tie depths, these without `stencil`: it keeps \
             surfaces of one depth from being lit twice.\n\
             \n\
             | decision | what is left out | where |\n\
             |---|---|---|\n\
             | `light` | all passes of a light | all that is in view faces away from it |\n\
             | `caster` | a volume | nothing that receives is behind the caster, as the light sees it |\n\
             | `view` | a volume | it lies outside a side of the view, to infinity or to \
             where it ends |\n\
             | `umbra` | a volume, or part of one | a convex caster, or a convex part of the same one, holds all \
             of it in its umbra |\n\
             | `away-triangles` | half of a mesh's silhouettes and caps | it is proven closed, wound outwards, \
             not meeting itself, with the light outside and no triangle edge-on to it |\n\
             | `caps` | both caps: z-pass counts | the caster is outside the near-clip volume |\n\
             | `light-cap`, `dark-cap` | one cap of z-fail's | the caster, or the far end, is out of view |\n\
             | `beyond-receivers` | the far part of a volume | z-pass counts it and all casters that touch it, \
             and the eye and what shows and receives, within the light's range, end before it |\n\
             | `surfaces` | surfaces | they are out of view |\n\
             | `hidden-triangles` | triangles of surfaces | they are on the far side of a closed surface |\n\
             | `unlit-triangles` | triangles of surfaces, in a light's pass | they face away from that light |\n\
             | `stencil` | the stencil buffer | nothing counts or marks |\n\
             | `clear` | a clear of the stencil | nothing was written |\n\
             | `map-faces` | faces of a cube map | no caster shows in them |\n\
             | `scissor` | pixels of a light's passes | they are beyond the `range` of a lamp that fades |",
        formula: "caps are needed only in the near-clip volume, the hull of the near rectangle and the light: a caster \
             wholly outside one of its planes has none; a volume ends on a plane outside of the box around the eye and \
             all that shows and receives, where every ray through the caster and all that touch it leaves it by one side",
        sources: &[cited::LENGYEL, cited::MCGUIRE, cited::LLOYD],
    },
};
const OCCLUSION: WordSetting<bool> = words(
    "occlusion",
    &["off", "queries"],
    &[false, true],
    "a frame before the frame asks what shows; draws that show nothing are left out of the next",
    Lesson {
        text: "With `queries`, a first frame counts the samples of every draw that does nothing where it fails its \
             tests, and draws without any are left out: the rest leaves the same pixels. It pays where much is \
             hidden. Counts of z-fail, which happen where tests fail, and maps that are kept are not asked about. \
             `off` draws all.",
        formula: "a draw is left out where it passed 0 samples",
        sources: &[cited::BITTNER],
    },
);
const WORLD: WordSetting<bool> = words(
    "world",
    &["f64", "f32"],
    &[false, true],
    "the precision of world space: positions are rounded to single precision only relative to the eye, or before",
    Lesson {
        text: "With `f64`, positions are in double precision until the eye is subtracted, and a scene may lie anywhere. \
             With `f32`, corners, lights and the eye are rounded to single precision in world space first, as engines do \
             whose world is made of floats: far from the origin their grid is coarse, touching surfaces part, and cracks \
             and steps show that move with the scene.",
        formula: "the step of f32 at a coordinate x is 2^(floor(log2 |x|) - 23): 0.06 mm at 1 km, 4 mm at 35 km, 6 cm at 1 000 \
             km",
        sources: &[cited::THORNE],
    },
);
/// Keys of the settings that change the brightness of lit surfaces.
pub(in crate::technique) const SHADING_KEYS: [&str; 3] = [DIFFUSE.spec.key, AMBIENT_DIFFUSE.spec.key, SHADING.spec.key];
const SPECS: [SettingSpec; 10] = [
    DEPTH.spec,
    DEPTH_BITS.spec,
    DEPTH_RANGE,
    EPSILON.spec,
    DIFFUSE.spec,
    AMBIENT_DIFFUSE.spec,
    SHADING.spec,
    LEAVE_OUT,
    OCCLUSION.spec,
    WORLD.spec,
];

/// The depths that a viewport has unless another range is set.
const WHOLE_RANGE: [f64; 2] = [0.0, 1.0];

/// Returns the settings that every technique has, followed by a technique's `own`.
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

/// The settings that every technique has, parsed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonSettings {
    /// How distance is mapped to depth.
    pub depth: DepthMapping,
    /// To how many bits every pass floors depths; `None` where they are floats.
    pub depth_bits: Option<DepthBits>,
    /// What depth 0 and depth 1 are stored as, each from 0 to 1, the first not the greater.
    pub depth_range: [f64; 2],
    /// By how much `standard-infinite-epsilon` moves the depth of infinity below 1.
    pub epsilon: f64,
    /// Whether diffuse light is wrapped, (cos a + 1) / 2, instead of Lambert's max(0, cos a).
    pub wraps_diffuse: bool,
    /// The share of each light's diffuse light that arrives whatever stands between, 0 to 1.
    pub ambient_diffuse: f32,
    /// The shading of all surfaces; `None` where each is shaded as its material says.
    pub shading: Option<Shading>,
    /// Whether a frame before this one finds by occlusion queries which draws show.
    pub asks_what_shows: bool,
    /// Whether positions are rounded to single precision in world space, before the eye is subtracted.
    pub rounds_world: bool,
    /// For each decision that may be forbidden, in the order of [`Decision::NAMES`], whether it is allowed.
    allowed: [bool; Decision::NAMES.len()],
}

impl CommonSettings {
    /// Parses the common settings of a choice's or a capture's values; missing and invalid values become their defaults.
    pub fn read(values: &SettingMap) -> CommonSettings {
        let allowed = match LEAVE_OUT.of(values) {
            "none" => [false; Decision::NAMES.len()],
            "all" => [true; Decision::NAMES.len()],
            some => Decision::NAMES.map(|name| some.split(',').any(|one| one.trim() == name)),
        };
        CommonSettings {
            depth: DEPTH.read(values),
            depth_bits: DEPTH_BITS.read(values),
            depth_range: depth_range(DEPTH_RANGE.of(values)).unwrap_or(WHOLE_RANGE),
            epsilon: EPSILON.read(values),
            wraps_diffuse: DIFFUSE.read(values),
            ambient_diffuse: AMBIENT_DIFFUSE.read(values) as f32,
            shading: SHADING.read(values),
            asks_what_shows: OCCLUSION.read(values),
            rounds_world: WORLD.read(values),
            allowed,
        }
    }

    /// Returns why a setting does nothing with the other settings as they are; `None` where it has an effect.
    pub(in crate::technique) fn without_effect(values: &SettingMap, key: &str) -> Option<&'static str> {
        let is_off = key == EPSILON.spec.key && DEPTH.read(values) != DepthMapping::StandardInfiniteEpsilon;
        is_off.then_some("No effect: only depth = standard-infinite-epsilon pulls infinity in")
    }

    /// Returns whether this decision may leave something out. Decisions that ask about depth need reversed infinite
    /// depth in floats from 0 to 1: other mappings clip volumes, or give equal depths to surfaces that are apart, as fewer
    /// bits and narrower ranges do. The stencil keeps surfaces of equal depth from being lit twice.
    pub fn allows(&self, decision: Decision) -> bool {
        use Decision::{Clear, Light, MapFaces, Scissor, Stencil};
        let asks_no_depth = matches!(decision, Light | Stencil | Clear | MapFaces | Scissor);
        let is_coarse = self.depth_bits.is_some() || self.depth_range != WHOLE_RANGE;
        let is_safe = match is_coarse {
            false => asks_no_depth || self.depth == DepthMapping::ReversedInfinite,
            true => asks_no_depth && decision != Stencil,
        };
        is_safe && self.allowed.get(decision as usize).is_none_or(|allowed| *allowed)
    }
}
