//! The settings of techniques that count shadow volumes.

use super::super::lesson::{Lesson, cited};
use super::common::{CommonSettings, with_own};
use super::face::{NumberOrWordSetting, SettingMap, SettingSpec, WordSetting, number_or, words};
use crate::geometry::{Casters, Extrusion, SilhouetteBy};
use crate::plan::Decision;

const CASTERS: WordSetting<CasterRule> = words(
    "casters",
    &["by-topology", "all", "light-facing", "light-back-facing"],
    &[
        CasterRule::ByTopology,
        CasterRule::Always(Casters::All),
        CasterRule::Always(Casters::LightFacing),
        CasterRule::Always(Casters::LightBackFacing),
    ],
    "which triangles cast",
    Lesson {
        text: "`all` lets every triangle cast, turned towards the light: right for any mesh, at twice the volume of \
             a closed one. `light-facing` suffices for a closed mesh with the light outside, and is wrong for \
             others: holes and inner lights. `light-back-facing` keeps the other half. `by-topology` proves that \
             `light-facing` suffices, or says what it could not prove; z-fail then draws no volume of a caster \
             behind which nothing receives, as a floor (`leave-out`: `caster`).",
        formula: "an edge bounds the shadow |m| times, with m the sum of +1 or -1 of each casting triangle at it, by \
             the way in which the triangle, turned towards the light, runs along it",
        sources: &[cited::ALDRIDGE, cited::KIM],
    },
);
// Farther than this, single precision loses the silhouette; less than 0 makes no sense.
const EXTRUSION: NumberOrWordSetting = number_or(
    "extrusion",
    &["infinite"],
    "finite:",
    [0.0, 1e6],
    false,
    "how far volumes reach: without end, or K times a vertex's distance from the light (of a sun, the caster's diagonal)",
    Lesson {
        text: "With `infinite`, volumes end nowhere. `finite:K` ends volumes at K times a vertex's distance from \
             the light, beyond the vertex: a light that comes close to its caster ends the shadow in mid-air. A sun is \
             at no distance, and of it volumes are K times the diagonal of the caster's bounding box long: a small caster \
             ends its shadow in mid-air.",
        formula: "with the light L and the vertex V: infinite is the direction (V - L, 0); finite:K is the point (V + \
             K(V - L), 1); of a sun in the unit direction D, with the diagonal s of the caster's box, (-D, 0) and (V - K s D, 1)",
        sources: &[cited::CROW, cited::EVERITT_KILGARD],
    },
);
const FACES: WordSetting<bool> = words(
    "faces",
    &["two-sided", "two-pass"],
    &[false, true],
    "front and back faces in one draw, or in passes of their own",
    Lesson {
        text: "With `two-sided`, each face has its own stencil operation in one draw. `two-pass` draws front and \
             back faces apart, as hardware without two-sided stencil had to.",
        formula: "z-pass: +1 front, -1 back, where the depth test passes; z-fail: +1 back, -1 front, where it fails",
        sources: &[cited::HEIDMANN, cited::EVERITT_KILGARD],
    },
);
const OPERATIONS: WordSetting<CountOperations> = words(
    "operations",
    &["wrap", "clamp", "invert"],
    &[CountOperations::Wrapping, CountOperations::Clamping, CountOperations::Inverting],
    "what a face does: steps that wrap round the ends of the count or stop there, or one bit turned over (parity)",
    Lesson {
        text: "With `wrap`, 255 and one more are 0, and 0 less one is 255: the order of faces makes no difference, and \
             counts are right but for multiples of 256. With `clamp` they stop at 0 and 255, as before wrapping \
             operations existed. With `invert` each face turns one bit over, which tells odd from even alone: two \
             volumes over one surface read as none.",
        formula: "wrap (count + 1) mod 256; clamp min(count + 1, 255); invert 1 - count",
        sources: &[cited::HEIDMANN, cited::EVERITT_KILGARD],
    },
);
const ORDER: WordSetting<bool> = words(
    "order",
    &["add-first", "subtract-first"],
    &[false, true],
    "which of the two passes comes first: the faces that add, or those that take away",
    Lesson {
        text: "With `faces = two-pass` and counts that stop at 0 and 255, the order decides: `add-first` loses nothing below \
             256, `subtract-first` loses every step that comes before its other half, which is the classic fault. With \
             counts that wrap it makes no difference.",
        formula: "clamped, from 0: 0 + 1 - 1 = 0, but 0 - 1 + 1 = 1",
        sources: &[cited::HEIDMANN, cited::EVERITT_KILGARD],
    },
);
const BITS: WordSetting<u8> = words(
    "stencil-bits",
    &["8", "4", "2", "1"],
    &[0xff, 0xf, 0x3, 0x1],
    "how many bits of the stencil are counted in, by its masks: counts are kept modulo 2 to that power",
    Lesson {
        text: "A stencil of `8` bits is what all have today; `4`, `2` and `1` are left of it by its masks. A count of 16 reads as none in four bits, and one bit is parity. Masks cut off \
             what is stored and not what is computed: a count of four bits does not stop at 15.",
        formula: "stored = count mod 2^bits, with read and write mask 2^bits - 1",
        sources: &[cited::SEGAL_AKELEY],
    },
);
const CAPS: WordSetting<[bool; 2]> = words(
    "caps",
    &["both", "light", "dark", "none"],
    &[[true, true], [true, false], [false, true], [false, false]],
    "which of the caps that the count needs are drawn",
    Lesson {
        text: "`both` draws what the count needs: of z-fail light cap and dark cap, of z-pass none but for casters that are \
             not drawn or volumes that end. With `light` the far end is open, with `dark` the end at the caster, with \
             `none` both: z-fail then miscounts every surface behind the open end. Of a parallel camera a dark cap at \
             infinity is a number that the count begins at, and is left out with it.",
        formula: "z-fail is right where each volume is closed: what a ray to infinity enters it leaves again",
        sources: &[cited::CARMACK, cited::BILODEAU, cited::EVERITT_KILGARD],
    },
);
const START: WordSetting<bool> = words(
    "start",
    &["zero", "eye-count"],
    &[false, true],
    "what the count begins with: nothing, or the volumes around the eye as the clear value",
    Lesson {
        text: "`zero` is right where the eye is in no volume. `eye-count` clears the stencil to the number of volumes around \
             the eye, found by exact tests on the CPU: right where the whole near plane is in those and no others, and \
             wrong for part of the picture where the near plane cuts a volume. Lines of sight of a parallel camera begin at \
             the near plane, and its middle is counted at in place of the eye. Z-fail needs neither.",
        formula: "count(p) = start + front faces before p - back faces before p",
        sources: &[cited::CROW, cited::EVERITT_KILGARD],
    },
);
const FAR_VERTICES: WordSetting<bool> = words(
    "far-vertices",
    &["from-light", "from-origin"],
    &[false, true],
    "where a finite volume's far vertices are carried from: the light, or the origin as the light is not added back",
    Lesson {
        text: "Far vertices of finite volumes are on the way from the light through each vertex, with `from-light`. \
             `from-origin` forgets to \
             add the light back after scaling that way: right only while the light is the world's origin, and the \
             volumes lean towards the origin the more the farther it is.",
        formula: "with light L, vertex V and factor K: from-light L + (K + 1)(V - L); from-origin (K + 1)(V - L)",
        sources: &[],
    },
);
const COUNTER: WordSetting<bool> = words(
    "counter",
    &["stencil", "float"],
    &[false, true],
    "where counts are kept: in eight bits, or signed in a float a pixel",
    Lesson {
        text: "`stencil` counts in eight bits. `float` counts signed, beyond eight bits, in a target of its own; it \
             is what fixes 256 nested volumes.",
        formula: "stencil: the count mod 256; float: the count",
        sources: &[],
    },
);
const LIGHT_CAPS: WordSetting<bool> = words(
    "light-caps",
    &["tested", "never"],
    &[false, true],
    "caps nearest the light pass the depth test, or never do",
    Lesson {
        text: "`never` lets light caps fail the depth test without asking: right while every caster is drawn, since \
             its surface is there, wrong for casters that are not. `tested` asks, and a cap that coincides with \
             its surface fails.",
        formula: "tested: fails where the cap's depth is not nearer than what is stored, and it is equal to its \
             surface's bit for bit; never: fails",
        sources: &[cited::EVERITT_KILGARD],
    },
);
const SILHOUETTE: WordSetting<SilhouetteBy> = words(
    "silhouette",
    &["adjacency", "edge-list", "shared-corners"],
    &[SilhouetteBy::Adjacency, SilhouetteBy::Search, SilhouetteBy::SharedCorners],
    "how shared edges are found: built once, from a stack each time, or between triangles that share corners in the file",
    Lesson {
        text: "`edge-list` keeps a stack of directed edges: each side of a casting triangle, turned towards the light, is \
             pushed on it, unless its reverse is there, which is taken away instead; what is left is the silhouette. It \
             looks through the stack for each side, anew for each light: a quadratic search. `adjacency` finds the \
             triangles of each edge once, and for a light only adds up +1 and -1. Both ask where corners are. `shared-corners` asks for the file's own numbers of corners, and makes \
             sides of edges that two triangles share so: where a file splits corners (seams of normals or textures), or a \
             corner lies on another triangle's edge (a T-junction), edges have one triangle and get no side, volumes \
             stay open, and streaks of light or shadow run through the picture.",
        formula: "with n edges: adjacency n steps a frame; edge-list up to n^2; shared-corners n, of edges of two triangles or \
             more",
        sources: &[cited::LENGYEL],
    },
);

const MIRRORED: WordSetting<bool> = words(
    "mirrored",
    &["flipped", "kept"],
    &[false, true],
    "the winding of volumes of mirrored objects: flipped with the mirror, or kept as the mesh has it",
    Lesson {
        text: "A scale of negative determinant mirrors an object, and turns its front faces into back faces. `flipped` \
             winds its volume for that. `kept` winds it as the mesh's own indices say, as engines do that find silhouettes \
             in the object's space and forget the mirror: its volume adds where it should take away, so that it takes \
             other casters' shadows away, and has none of its own where counts stop at 0. Of a parallel camera, whose counts begin at a \
             number in place of a cap, it changes nothing.",
        formula: "front faces of a volume become back faces where det(world from object) < 0",
        sources: &[cited::EVERITT_KILGARD],
    },
);

const RELIGHT: WordSetting<bool> = words(
    "relight",
    &["guarded", "unguarded"],
    &[false, true],
    "whether the light pass raises the count where it has lit, so that of surfaces at one depth one is lit",
    Lesson {
        text: "The light pass draws surfaces again where their depth is equal to what is stored and the count is 0. Where two lie \
             in one plane, as a tile in its floor, depths tie and both pass. `guarded` raises the count where the first has \
             added the light, and the second finds it there. With `unguarded` both add it: bright patches, in specks where \
             rounding parts the depths. Labels are the same, so no shadow is wrong.",
        formula: "light is added where depth = stored and count = 0; guarded: then count + 1",
        sources: &[cited::EVERITT_KILGARD],
    },
);
const EXTRUDED_BY: WordSetting<bool> = words(
    "extruded-by",
    &["cpu", "vertex-shader"],
    &[false, true],
    "who carries volumes away from the light: the CPU, which finds silhouettes, or a vertex shader",
    Lesson {
        text: "With `cpu`, exact signs say which triangles face the light, and only the edges between those that do \
             and those that don't are carried. With `vertex-shader`, each triangle has vertices of its own that know \
             its plane. Of a mesh that is closed, where the triangles that face the light cast, each edge has a quad that is empty until \
             its triangles face different ways; of any other each triangle is a prism of its own, drawn twice with a quad at each edge. \
             No vertex is uploaded anew when the light moves, and several times as many triangles are drawn. It tells in single \
             precision which way a triangle faces, so where the light grazes one the shadow's edge may run beside its place; \
             volumes are closed all the same.",
        formula: "with the light L and the plane p of the vertex's own triangle, both relative to the eye: where p . L > 0 \
             the vertex stays, else it goes where `extrusion` says",
        sources: &[cited::BRENNAN],
    },
);

const OWN: [SettingSpec; 15] = [
    CASTERS.spec,
    EXTRUSION.spec,
    FAR_VERTICES.spec,
    CAPS.spec,
    FACES.spec,
    ORDER.spec,
    OPERATIONS.spec,
    BITS.spec,
    COUNTER.spec,
    LIGHT_CAPS.spec,
    SILHOUETTE.spec,
    MIRRORED.spec,
    RELIGHT.spec,
    EXTRUDED_BY.spec,
    START.spec,
];

/// The settings of `z-pass`, in the order in which they are shown.
pub(super) const Z_PASS: [SettingSpec; 25] = with_own(OWN);
/// The settings of `z-fail`: those of z-pass without `start`, as a count from infinity always begins in the same way.
pub(super) const Z_FAIL: [SettingSpec; 24] = with_own({
    let [own @ .., _] = OWN;
    own
});
/// The settings of `z-pass-plus`: those of z-pass without `start` and `extruded-by`, as the CPU has to know the casting
/// triangles to draw them at the near plane.
pub(super) const Z_PASS_PLUS: [SettingSpec; 23] = with_own({
    let [own @ .., _, _] = OWN;
    own
});

/// The settings of shadow volumes, parsed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeSettings {
    /// Which of a caster's triangles cast.
    pub casters: CasterRule,
    /// How far volumes extend.
    pub extrusion: Extrusion,
    /// Whether faces that increment and faces that decrement are drawn in separate passes.
    pub two_pass: bool,
    /// Whether, with two passes, the faces that decrement are drawn first.
    pub takes_away_first: bool,
    /// The stencil operations that faces use.
    pub operations: CountOperations,
    /// The stencil read and write mask: the bits that are counted in.
    pub bits: u8,
    /// Whether light caps and dark caps are drawn where the count needs them, in this order.
    pub caps: [bool; 2],
    /// Whether the count begins at the number of volumes around the eye instead of 0.
    pub starts_at_eye: bool,
    /// Whether volumes are counted in a float target instead of the stencil.
    pub counts_in_float: bool,
    /// Whether light caps always fail the depth test (compare function Never).
    pub light_caps_never_pass: bool,
    /// How shared edges are found for the silhouette: by adjacency, or by searching all edges.
    pub silhouette: SilhouetteBy,
    /// Whether volumes of mirrored objects are wound as their meshes are, as if nothing were mirrored.
    pub keeps_mirrored_winding: bool,
    /// Whether the light pass leaves the count as it is where it adds the light, so that surfaces at one depth are each lit.
    pub relights: bool,
    /// Whether a vertex shader extrudes volumes instead of the CPU.
    pub by_vertex_shader: bool,
}

/// The stencil operations with which volume faces count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountOperations {
    /// Increment and decrement, wrapping around at the ends.
    Wrapping,
    /// Increment and decrement, clamped to 0 and 255.
    Clamping,
    /// Invert one bit, which only distinguishes odd counts from even.
    Inverting,
}

/// Which of a caster's triangles cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CasterRule {
    /// These triangles of every caster.
    Always(Casters),
    /// The light-facing triangles where they are proven to suffice, otherwise all.
    ByTopology,
}

impl VolumeSettings {
    /// Returns whether these settings make closed volumes in their right place and lose no step of the count, so that a
    /// surface outside all volumes reads 0 (but for casters whose file splits corners, where silhouettes ask for shared ones):
    /// both caps, tested light caps, no mirrored winding kept,
    /// no far vertices from the origin, no clamping in the stencil.
    pub fn volumes_count_right(&self) -> bool {
        let is_misplaced = matches!(self.extrusion, Extrusion::FromOrigin(_));
        let loses_steps = self.operations == CountOperations::Clamping && !self.counts_in_float;
        let is_right = self.caps == [true; 2] && !self.light_caps_never_pass && !self.keeps_mirrored_winding;
        is_right && !is_misplaced && !loses_steps
    }

    /// Returns the settings that `auto` uses: the defaults, with casters by topology unless the decision
    /// `away-triangles` is forbidden.
    pub fn of_auto(common: &CommonSettings) -> VolumeSettings {
        let by_topology = common.allows(Decision::AwayTriangles);
        let casters = if by_topology { CasterRule::ByTopology } else { CasterRule::Always(Casters::All) };
        VolumeSettings { casters, ..VolumeSettings::read(&SettingMap::new()) }
    }

    /// Parses the settings of shadow volumes; missing and invalid values become their defaults.
    pub fn read(values: &SettingMap) -> VolumeSettings {
        VolumeSettings {
            casters: CASTERS.read(values),
            extrusion: match (EXTRUSION.read(values), FAR_VERTICES.read(values)) {
                (None, _) => Extrusion::Infinite,
                (Some(factor), false) => Extrusion::Finite(factor),
                (Some(factor), true) => Extrusion::FromOrigin(factor),
            },
            two_pass: FACES.read(values),
            takes_away_first: ORDER.read(values),
            operations: OPERATIONS.read(values),
            bits: BITS.read(values),
            caps: CAPS.read(values),
            starts_at_eye: START.read(values),
            counts_in_float: COUNTER.read(values),
            light_caps_never_pass: LIGHT_CAPS.read(values),
            silhouette: SILHOUETTE.read(values),
            keeps_mirrored_winding: MIRRORED.read(values),
            relights: RELIGHT.read(values),
            by_vertex_shader: EXTRUDED_BY.read(values),
        }
    }

    /// Returns the stencil mask that faces write and the light pass reads: 1 for parity, otherwise the chosen bits.
    pub fn mask(&self) -> u8 {
        if self.operations == CountOperations::Inverting { 1 } else { self.bits }
    }

    /// Returns why a setting does nothing with the other settings as they are; `None` where it has an effect.
    pub(in crate::technique) fn without_effect(&self, key: &str) -> Option<&'static str> {
        let is = |spec: SettingSpec| key == spec.key;
        if is(FAR_VERTICES.spec) && self.extrusion == Extrusion::Infinite {
            return Some("No effect: carried without end, a vertex is a direction, and no place is added to it");
        }
        if self.by_vertex_shader {
            let both = "No effect where the vertex shader carries volumes: light cap and dark cap are one draw there, which it \
                        tells apart; `none` leaves both out";
            let searches = "No effect where the vertex shader carries volumes: it searches no silhouette";
            match key {
                _ if is(SILHOUETTE.spec) => return Some(searches),
                _ if is(LIGHT_CAPS.spec) || (is(CAPS.spec) && self.caps[0] != self.caps[1]) => return Some(both),
                _ => {}
            }
        }
        if self.counts_in_float {
            return match key {
                _ if is(FACES.spec) || is(ORDER.spec) => {
                    Some("No effect: a float target adds and takes away in one draw")
                }
                _ if is(OPERATIONS.spec) => Some("No effect: a float target has no limits to wrap or stop at"),
                _ if is(BITS.spec) => Some("No effect: a float target has no bits that a mask could leave out"),
                _ if is(RELIGHT.spec) => Some("No effect: the light pass reads a float target, and can't raise it"),
                _ => None,
            };
        }
        match key {
            _ if is(ORDER.spec) && !self.two_pass => Some("No effect: faces = two-sided draws both in one pass"),
            _ if is(BITS.spec) && self.operations == CountOperations::Inverting => {
                Some("No effect: parity is kept in one bit")
            }
            _ => None,
        }
    }

    /// Returns the key and the value of the setting that counts volumes in floats.
    pub(in crate::technique) fn in_floats() -> [&'static str; 2] {
        [COUNTER.spec.key, COUNTER.word(true)]
    }
}
