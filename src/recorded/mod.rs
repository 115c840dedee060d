//! What another program's frame reveals by itself: its lights' positions, its surfaces, and its labels.
//!
//! ```text
//! FramePlan ─ space.rs   clip space as the view space of an assumed eye: straight lines stay straight
//!           ─ light.rs   the sides of shadow volumes run away from the light: it is where they intersect
//!           ─ edges.rs   where volumes are open
//!           ─ ends.rs    which end of a volume is the caster's
//!           ─ scene.rs   surfaces as objects, and casters that are out of view by their volumes
//!           ─ darkening.rs  whether a pass adds light where its stencil test passes, or takes it away
//!           ─ labels.rs  what the stencil test of the light's pass lets through is lit, or darkened
//! ```
//!
//! The resulting scene can be traced like any other, so the truth of the frame is known from nothing but its draws.

mod darkening;
mod edges;
mod ends;
mod labels;
mod light;
mod scene;
mod space;

/// What is said of a frame whose projection is not known: a limit of its origin.
pub const UNKNOWN_DEPTH: &str =
    "how depth comes from distance can't be found from the vertices, so that no light is looked for";

pub use darkening::darkens;
pub use edges::OpenEdges;
pub use ends::far_ends;
pub use labels::labels;
pub use light::{FoundLight, light};
pub use scene::{casters, scene};
pub use space::PassSpace;
