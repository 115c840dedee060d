//! Geometry of shadows on the CPU: what casts, along which edges, onto which planes.
//!
//! Everything is computed in world space in `f64`; [`relative`] alone rounds to the GPU's `f32`, after subtracting the
//! eye, and [`Extruded`] is what a vertex shader computes in it.

mod blob;
mod cache;
mod caster;
mod clamping;
mod connectivity;
mod darkening;
mod edges;
mod extruded;
mod facing;
mod far_end;
mod grazing;
mod holes;
mod intersection;
pub mod layers;
pub mod light_frame;
mod light_range;
pub mod near_view;
mod normals;
mod perturbed;
pub mod planar;
mod reach;
mod receiver_texture;
pub mod relative;
mod silhouette;
pub mod silhouette_bound;
pub mod solid;
mod solid_proof;
pub mod topology;
pub mod umbra;
mod volume;
mod winding;

pub use blob::Blob;
pub use cache::{DrawnSurface, GeometryCache, ShownTriangles, SilhouetteBy, VolumeRequest};
pub use caster::Caster;
pub use clamping::{ClampedEnd, touching};
pub use connectivity::{Connectivity, FoundPlaces};
pub use darkening::object_can_darken;
pub use edges::{Edge, EdgeList};
pub use extruded::{Carry, Extruded, ExtrudedCorner, ExtrudedForm, ExtrudedVolume};
pub use facing::{CasterPlanes, Casters, Facings};
pub use far_end::CapFan;
pub use intersection::self_meeting;
pub use light_range::{RangeInView, beyond_range, range_in_view, reached};
pub use normals::{NormalsPer, SurfaceNormals};
pub use reach::{NearClipVolume, OutsidePlane, ViewVolume};
pub use receiver_texture::ReceiverParallelogram;
pub use silhouette::{
    MOST_TO_SEARCH, SilhouetteEdge, facing, silhouette, silhouette_by_search, silhouette_of_shared_corners,
};
pub use topology::Topology;
pub use volume::{DarkCap, Extruder, Extrusion, FarEnd, VolumeParts, write_indices};
pub use winding::winding_number;
