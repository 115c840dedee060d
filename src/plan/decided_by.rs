//! How a frame decides where a light's shadow is: what its light pass reads.
//!
//! It is stated for each light, not for the technique: a light that reaches nothing in view is decided by nothing, and
//! `auto` counts in the stencil or, where eight bits could be too few, in floats.

use serde::{Deserialize, Serialize};

/// What a light pass reads to decide whether a pixel is in shadow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum DecidedBy {
    /// The count of shadow volumes around the surface in the stencil, in eight bits: 0 is lit.
    StencilCount {
        /// On which side of the surface faces count.
        side: CountedSide,
    },
    /// The count of shadow volumes around the surface in a float target, signed: 0 is lit.
    FloatCount {
        /// On which side of the surface faces count.
        side: CountedSide,
    },
    /// A shadow map: the depth that the light sees.
    Map,
    /// A texture on each flat receiver of the light that arrives on it.
    ReceiverTextures,
    /// Projected silhouettes of casters: the light that they let through.
    Silhouettes,
    /// Casters flattened onto flat receivers (planar shadows).
    Flattened,
    /// Labels that were ray-traced on the CPU.
    Labels,
    /// Nothing: the light reaches every surface that faces it.
    Nothing,
}

named_enum! {
    /// On which side of the visible surface the faces of shadow volumes are counted.
    pub enum CountedSide(
        /// `behind`, as in "faces behind the surface".
        preposition
    ) {
        /// Between the eye and the surface (z-pass).
        InFront = "in-front" ("in front of"),
        /// Between the surface and infinity (z-fail).
        Behind = "behind" ("behind"),
        /// In front of the surface for some volumes, behind it for others.
        AsNeeded = "as-needed" ("on either side of"),
    }
}

named_enum! {
    /// What 1 in a light's count of shadow volumes stands for: a closed body, or a single surface.
    pub enum CountOf(
        /// `bodies`, `surfaces`, `bodies and surfaces`.
        what,
        /// A clause that explains a count to its reader.
        meaning
    ) {
        /// Casters that are proven closed: of each, only triangles that face the light cast. A caster that has no
        /// surface behind it counts so too.
        Bodies = "bodies" (
            "bodies",
            "A count is of bodies: every caster that can darken a surface here is proven closed, and counts 1 each \
             time the way to the light goes through it."
        ),
        /// Triangles, whichever way they face: both sides of a closed mesh cast.
        Surfaces = "surfaces" (
            "surfaces",
            "A count is of surfaces, not of bodies: each one on the way to the light counts 1, so that a closed body \
             whose both sides cast counts 2."
        ),
        /// Some casters are proven closed; every surface of the others counts.
        Mixed = "mixed" (
            "bodies and surfaces",
            "A count is of bodies and of surfaces: a caster that is proven closed counts 1 each time the way to the \
             light goes through it, of the others each surface counts 1."
        ),
    }
}

impl DecidedBy {
    /// Returns whether shadow volumes are counted, in the stencil or in a float target.
    pub fn counts_volumes(self) -> bool {
        self.counted_side().is_some()
    }

    /// Returns whether shadow volumes are counted in a float target instead of the stencil.
    pub fn counts_in_floats(self) -> bool {
        matches!(self, DecidedBy::FloatCount { .. })
    }

    /// Returns on which side of the surface shadow volumes are counted, in the stencil or in floats; `None` where no
    /// count decides.
    pub fn counted_side(self) -> Option<CountedSide> {
        match self {
            DecidedBy::StencilCount { side } | DecidedBy::FloatCount { side } => Some(side),
            DecidedBy::Map
            | DecidedBy::ReceiverTextures
            | DecidedBy::Silhouettes
            | DecidedBy::Flattened
            | DecidedBy::Labels
            | DecidedBy::Nothing => None,
        }
    }
}
