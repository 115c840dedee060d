//! The settings of techniques that count shadow volumes.

use super::super::lesson::{Lesson, cited};
use super::common::{CommonSettings, with_own};
use super::face::{NumberOr, SettingSpec, Values, Words, number_or, words};
use crate::geometry::{Casters, Extrusion, SilhouetteBy};
use crate::plan::Decision;

const CASTERS: Words<WhoCasts> = words(
    "casters",
    &["by-topology", "all", "light-facing", "light-back-facing"],
    &[
        WhoCasts::ByTopology,
        WhoCasts::Always(Casters::All),
        WhoCasts::Always(Casters::LightFacing),
        WhoCasts::Always(Casters::LightBackFacing),
    ],
    "which triangles cast",
    Lesson {
        text: "`all` lets every triangle cast, turned towards the light: right for any mesh, at twice the volume of \
             a closed one. `light-facing` suffices for a closed mesh with the light outside, and is wrong for \
             others: holes and inner lights. `light-back-facing` keeps the other half. `by-topology` proves that \
             `light-facing` suffices, or says what it could not prove.",
        formula: "an edge bounds the shadow |m| times, with m the sum of +1 or -1 of each casting triangle at it, by \
             the way in which the triangle, turned towards the light, runs along it",
        sources: &[cited::ALDRIDGE, cited::KIM],
    },
);
// Farther, single precision loses the silhouette; nearer than not at all makes no sense.
const EXTRUSION: NumberOr = number_or(
    "extrusion",
    &["infinite"],
    ("finite:", [0.0, 1e6], false),
    "how far volumes reach: without end, or K times a vertex's distance from the light",
    Lesson {
        text: "With `infinite`, volumes end nowhere. `finite:K` ends volumes at K times a vertex's distance from \
             the light, beyond the vertex: a light that comes close to its caster ends the shadow in mid-air.",
        formula: "with the light L and the vertex V: infinite is the direction (V - L, 0); finite:K is the point (V + \
             K(V - L), 1)",
        sources: &[cited::CROW, cited::EVERITT_KILGARD],
    },
);
const FACES: Words<bool> = words(
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
const OPERATIONS: Words<bool> = words(
    "operations",
    &["wrap", "clamp"],
    &[false, true],
    "what counts do beyond 0 and 255",
    Lesson {
        text: "With `wrap`, counts go round, and the order of faces does not matter. `clamp` stops at 0 and 255 \
             instead: counts that go below 0 on the way, or above 255, are lost, and what is drawn first decides.",
        formula: "with the count c: wrap (c + 1) mod 256 and (c - 1) mod 256; clamp min(c + 1, 255) and max(c - 1, 0)",
        sources: &[cited::EVERITT_KILGARD],
    },
);
const COUNTER: Words<bool> = words(
    "counter",
    &["stencil", "float"],
    &[false, true],
    "where counts are kept: in eight bits, or signed in a float a pixel",
    Lesson {
        text: "`stencil` counts in eight bits. `float` counts signed, beyond eight bits, in a target of its own; it \
             is what mends 256 nested volumes.",
        formula: "stencil: the count mod 256; float: the count",
        sources: &[],
    },
);
const LIGHT_CAPS: Words<bool> = words(
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
const SILHOUETTE: Words<SilhouetteBy> = words(
    "silhouette",
    &["adjacency", "edge-list"],
    &[SilhouetteBy::Adjacency, SilhouetteBy::Search],
    "how shared edges are found: built once, or searched each time",
    Lesson {
        text: "`edge-list` searches all edges for each edge's other triangle: a quadratic search that `adjacency` \
             does once.",
        formula: "with n edges: adjacency n steps a frame; edge-list n^2",
        sources: &[cited::LENGYEL],
    },
);

/// In the order in which they are shown.
pub(super) const VOLUME: [SettingSpec; 12] = with_own([
    CASTERS.spec,
    EXTRUSION.spec,
    FACES.spec,
    OPERATIONS.spec,
    COUNTER.spec,
    LIGHT_CAPS.spec,
    SILHOUETTE.spec,
]);

/// What a technique that counts volumes is told, as types.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeSettings {
    /// Which triangles cast.
    pub casters: WhoCasts,
    /// How far volumes reach.
    pub extrusion: Extrusion,
    /// Front and back faces in passes of their own.
    pub two_pass: bool,
    /// Counts stop at 0 and 255.
    pub clamp: bool,
    /// In a float target instead of the stencil.
    pub counts_in_float: bool,
    /// Light caps never pass the depth test, whatever is in front of them.
    pub light_caps_never_pass: bool,
    /// How shared edges are found.
    pub silhouette: SilhouetteBy,
}

/// Which triangles cast, or what decides it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhoCasts {
    /// The same of every caster.
    Always(Casters),
    /// Those that face the light where that is proven to be enough, else all.
    ByTopology,
}

impl VolumeSettings {
    /// What `auto` decides itself: it has no such settings, and triangles cast by topology unless that is forbidden.
    #[must_use]
    pub fn of_auto(common: &CommonSettings) -> VolumeSettings {
        let by_topology = common.allows(Decision::AwayTriangles);
        let casters = if by_topology { WhoCasts::ByTopology } else { WhoCasts::Always(Casters::All) };
        VolumeSettings { casters, ..VolumeSettings::read(&Values::new()) }
    }

    /// As they are set.
    #[must_use]
    pub fn read(values: &Values) -> VolumeSettings {
        VolumeSettings {
            casters: CASTERS.read(values),
            extrusion: EXTRUSION.read(values).map_or(Extrusion::Infinite, Extrusion::Finite),
            two_pass: FACES.read(values),
            clamp: OPERATIONS.read(values),
            counts_in_float: COUNTER.read(values),
            light_caps_never_pass: LIGHT_CAPS.read(values),
            silhouette: SILHOUETTE.read(values),
        }
    }

    /// Why a setting does nothing as the others are.
    pub(in crate::technique) fn without_effect(&self, key: &str) -> Option<&'static str> {
        match key {
            _ if !self.counts_in_float => None,
            key if key == FACES.spec.key => Some("No effect: a float target adds and takes away in one draw"),
            key if key == OPERATIONS.spec.key => Some("No effect: a float target has no limits to wrap or stop at"),
            _ => None,
        }
    }

    /// Key and value that count in floats.
    pub(in crate::technique) fn in_floats() -> [&'static str; 2] {
        [COUNTER.spec.key, COUNTER.word(true)]
    }
}
