//! What may be left out of a frame: one decision each, taken where it is proven to change nothing.

use super::Choice;
use crate::math::depth::DepthMapping;

/// Something that a scene may not need.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Decision {
    /// A light that reaches no surface in view: its passes.
    Light,
    /// A caster behind which, as the light sees it, there is nothing: its volume, map or silhouette.
    Caster,
    /// A volume that misses the view.
    View,
    /// A caster wholly in the umbra of another, or a part of one in that of another part: its volume.
    Umbra,
    /// Of a closed caster, the triangles that face away from the light.
    AwayTriangles,
    /// Caps of a caster that holds no point of the near plane in its shadow: z-pass counts without.
    Caps,
    /// The light cap of a caster that is not in view.
    LightCap,
    /// The dark cap of a volume whose far end is not in view.
    DarkCap,
    /// Surfaces that are not in view.
    Surfaces,
    /// Triangles of a closed surface that face away from the eye.
    HiddenTriangles,
    /// In a light's pass, triangles that face away from it.
    UnlitTriangles,
    /// The stencil buffer where nothing counts or marks.
    Stencil,
    /// Clearing a stencil that nothing has written.
    Clear,
    /// Faces of a cube map that no caster shows in.
    MapFaces,
    /// Pixels that a light of limited range does not reach.
    Scissor,
}

impl Decision {
    /// The names that `leave-out` knows, in order.
    pub const NAMES: [&str; 15] = [
        Decision::Light.name(),
        Decision::Caster.name(),
        Decision::View.name(),
        Decision::Umbra.name(),
        Decision::AwayTriangles.name(),
        Decision::Caps.name(),
        Decision::LightCap.name(),
        Decision::DarkCap.name(),
        Decision::Surfaces.name(),
        Decision::HiddenTriangles.name(),
        Decision::UnlitTriangles.name(),
        Decision::Stencil.name(),
        Decision::Clear.name(),
        Decision::MapFaces.name(),
        Decision::Scissor.name(),
    ];

    /// As in `--set leave-out=caps,umbra`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Decision::Light => "light",
            Decision::Caster => "caster",
            Decision::View => "view",
            Decision::Umbra => "umbra",
            Decision::AwayTriangles => "away-triangles",
            Decision::Caps => "caps",
            Decision::LightCap => "light-cap",
            Decision::DarkCap => "dark-cap",
            Decision::Surfaces => "surfaces",
            Decision::HiddenTriangles => "hidden-triangles",
            Decision::UnlitTriangles => "unlit-triangles",
            Decision::Stencil => "stencil",
            Decision::Clear => "clear",
            Decision::MapFaces => "map-faces",
            Decision::Scissor => "scissor",
        }
    }

    /// May it be taken? Depth that is not reversed and infinite cuts volumes off, or lets surfaces tie that
    /// are apart: what hides nothing elsewhere may decide a pixel there.
    pub(super) fn is_allowed(self, choice: &Choice) -> bool {
        use Decision::{Clear, Light, MapFaces, Scissor, Stencil};
        let asks_no_depth = matches!(self, Light | Stencil | Clear | MapFaces | Scissor);
        if !asks_no_depth && choice.word("depth") != DepthMapping::ReversedInfinite.name() {
            return false;
        }
        match choice.word("leave-out") {
            "none" => false,
            "all" => true,
            some => some.split(',').any(|name| name.trim() == self.name()),
        }
    }
}
