//! What another program's frame reveals by itself: its lights' positions, its surfaces, and its labels.
//!
//! ```text
//! FramePlan ─ space.rs   clip space as the view space of an assumed eye: straight lines stay straight
//!           ─ light.rs   the sides of shadow volumes run away from the light: it is where they intersect
//!           ─ lights.rs  one light for all volumes, or one for each caster
//!           ─ map_views.rs  meshes drawn into a shadow map and the picture tell the map's view, and so its light
//!           ─ stored_quantity.rs  whether a map's texels hold depths or distances, by casting its own draws
//!           ─ edges.rs   where volumes are open
//!           ─ corners.rs  which object has a corner at a place
//!           ─ ends.rs    which end of a volume is the caster's
//!           ─ volume_parts.rs  the volumes of several casters that one draw has, or one caster's in many draws
//!           ─ objects.rs  surfaces as objects
//!           ─ volumes.rs  what casts a volume
//!           ─ one_sided.rs  triangles of meshes with holes whose volume is not drawn
//!           ─ scene.rs   what casts in which light, and casters that are out of view by their volumes
//!           ─ darkening.rs  whether a pass adds light where its stencil test passes, or takes it away
//!           ─ seen.rs    the triangle that each pixel shows
//!           ─ labels.rs  what the stencil test of the light's pass lets through is lit, or darkened
//!           ─ surfaces.rs  which pixels show a surface of these triangles at all
//! ```
//!
//! The resulting scene can be traced like any other, so the truth of the frame is known from nothing but its draws.

mod corners;
mod darkening;
mod edges;
mod ends;
mod labels;
mod light;
mod lights;
mod map_views;
mod objects;
mod one_sided;
mod scene;
mod seen;
mod space;
mod stored_quantity;
mod surfaces;
mod volume_parts;
mod volumes;

use crate::numbers;
use crate::plan::LightId;

/// What is said of a frame whose projection is not known: a limit of its origin.
pub const UNKNOWN_DEPTH: &str =
    "how depth comes from distance can't be found from the vertices, so that no light is looked for";

/// What is said of a frame with a shadow map that holds what a shader wrote, and that is no known quantity: a limit of its
/// origin.
pub const UNKNOWN_QUANTITY: &str =
    "what a shader writes into a shadow map is neither depth nor a distance, so that nothing is compared with it";

pub use darkening::darkens;
pub use edges::OpenEdges;
pub use ends::far_ends;
pub use labels::{MapReading, labels, outside_cone};
pub use lights::light;
pub use map_views::{FoundMapLight, FoundMapView, lights_of_faces, map_light};
pub use one_sided::{UncastTriangles, uncast_triangles};
pub use scene::{lights_of_casters, scene};
pub use seen::SeenSurfaces;
pub use space::PassSpace;
pub use stored_quantity::stored_quantity;
pub use surfaces::StoredSurfaces;
pub use volumes::{asked_volumes, casters, volumes_with_lights};

/// A light of another program, as its draws determine it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundLight {
    /// Homogeneous position in the eye's space: a point, or with `w = 0` the direction towards it.
    pub position: glam::DVec4,
    /// What it was found by.
    pub evidence: LightEvidence,
}

/// What a light's position was found by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightEvidence {
    /// Edges of shadow volumes that run away from it.
    Edges {
        /// The number of edges that do.
        agree: usize,
        /// The number of edges that could.
        of: usize,
    },
    /// Edges of shadow volumes that run away from where it is for their caster.
    EdgesOfCasters {
        /// The number of triangles of the volumes that have such an edge.
        agree: usize,
        /// The number of triangles of the volumes.
        of: usize,
        /// The number of places where it is for one caster or more.
        places: usize,
        /// The number of casters in the picture whose volumes run away from one of them.
        casters: usize,
        /// The number of other parts of volumes that do, which share no corner: those of casters that the picture does not show.
        unseen: usize,
        /// The number of casters whose volumes run away from none: their shadows are not known.
        without: usize,
    },
    /// Meshes that are drawn into its shadow map and into the picture.
    Map {
        /// The number of the map's draws whose corners agree, in all faces.
        agree: usize,
        /// The number of the map's draws.
        of: usize,
        /// How far corners that had no part in a fit are off, at most, in texels.
        residual: f64,
    },
}

impl FoundLight {
    /// Says of a light that has a position for each caster which of them is shown as the light, and of how many casters none is
    /// known; empty for a light in one place.
    pub fn limits(&self, light: LightId) -> Vec<String> {
        let LightEvidence::EdgesOfCasters { places, without, .. } = self.evidence else { return Vec::new() };
        let elsewhere = format!(
            "{} is in {places} places, as in engines that give each model a light of its own: rays follow the volumes of \
             {}, and the light is shown where that of the most volumes is",
            light.name(),
            self.evidence.casters_words()
        );
        let unknown = (without > 0).then(|| {
            let casters = numbers::counted(without as u64, "caster");
            let [have, they] = if without == 1 { ["has", "it darkens"] } else { ["have", "they darken"] };
            format!("{casters} {have} no light that is known: what {they} counts as wrong")
        });
        std::iter::once(elsewhere).chain(unknown).collect()
    }
}

impl LightEvidence {
    /// Says whose volumes run away from a light of their own, `5 casters and 1 that begins at no surface of the picture`; empty
    /// where the light is one.
    pub fn casters_words(&self) -> String {
        let LightEvidence::EdgesOfCasters { casters, unseen, .. } = self else { return String::new() };
        let casters = numbers::counted(*casters as u64, "caster");
        match unseen {
            0 => casters,
            1 => format!("{casters} and 1 that begins at no surface of the picture"),
            unseen => format!("{casters} and {unseen} that begin at no surface of the picture"),
        }
    }

    /// Returns the number of edges that tell the light; 0 where others do.
    fn edges(&self) -> usize {
        match *self {
            LightEvidence::Edges { agree, .. } => agree,
            LightEvidence::EdgesOfCasters { .. } | LightEvidence::Map { .. } => 0,
        }
    }
}

impl FoundMapLight {
    /// Returns the light.
    pub fn light(&self) -> FoundLight {
        let faces = || self.faces.iter().flatten();
        let evidence = LightEvidence::Map {
            agree: faces().map(|face| face.agree).sum(),
            of: faces().map(|face| face.of).sum(),
            residual: faces().map(|face| face.residual).fold(0.0, f64::max),
        };
        FoundLight { position: self.position, evidence }
    }
}
