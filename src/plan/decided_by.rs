//! How a frame decides where a light's shadow is: what its light pass asks.
//!
//! It is said for each light, not for the technique: a light that reaches nothing in view is decided by
//! nothing, and `auto` counts in the stencil or, where eight bits could be too few, in floats.

use serde::{Deserialize, Serialize};

/// What decides whether a light's shadow is at a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum DecidedBy {
    /// How many shadow volumes hold the surface, as eight bits of stencil: 0 is lit.
    StencilCount {
        /// On which side of the surface faces count.
        side: CountedSide,
    },
    /// How many shadow volumes hold the surface, as a signed float: 0 is lit.
    FloatCount {
        /// On which side of the surface faces count.
        side: CountedSide,
    },
    /// The depth that the light sees in its map.
    Map,
    /// What arrives on a flat receiver, drawn into a texture of its own.
    ReceiverTextures,
    /// What the casters let through, thrown over the scene.
    Silhouettes,
    /// Casters flattened onto flat receivers.
    Flattened,
    /// Labels that rays made on the CPU.
    Labels,
    /// Nobody asks: the light reaches all that faces it.
    Nothing,
}

named_enum! {
    /// On which side of the visible surface the faces of shadow volumes count.
    pub enum CountedSide(
        /// `behind`, as in "faces behind the surface".
        preposition
    ) {
        /// Between the eye and the surface: z-pass.
        InFront = "in-front" ("in front of"),
        /// Between the surface and infinity: z-fail.
        Behind = "behind" ("behind"),
        /// Those of some volumes in front of it, those of others behind it.
        AsNeeded = "as-needed" ("on either side of"),
    }
}

named_enum! {
    /// What a count of a light's shadow volumes is a count of.
    pub enum CountOf(
        /// `bodies`, `surfaces`, `bodies and surfaces`.
        what,
        /// In a sentence, for whoever reads a count.
        meaning
    ) {
        /// Casters that are proven closed: of each, only triangles that face the light cast. Others too, that have no
        /// surface behind them.
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
        /// Some casters are proven closed, of others every surface counts.
        Mixed = "mixed" (
            "bodies and surfaces",
            "A count is of bodies and of surfaces: a caster that is proven closed counts 1 each time the way to the \
             light goes through it, of the others each surface counts 1."
        ),
    }
}

impl DecidedBy {
    /// Are shadow volumes counted, in whatever way?
    pub fn counts_volumes(self) -> bool {
        self.counted_side().is_some()
    }

    /// Are they counted in a float for each pixel, and not in eight bits?
    pub fn counts_in_floats(self) -> bool {
        matches!(self, DecidedBy::FloatCount { .. })
    }

    /// The side on which shadow volumes count; `None` where none are counted.
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
