//! Geometry of shadows on the CPU: who casts, along which edges, onto which planes.
//!
//! Everything is computed in world space in `f64`; [`relative`] alone rounds to the GPU's `f32`,
//! after subtracting the eye.

mod cache;
mod edges;
pub mod light_frame;
pub mod planar;
mod receiver_texture;
pub mod relative;
mod silhouette;
mod volume;

pub use cache::GeometryCache;
pub use edges::{Edge, EdgeList};
pub use receiver_texture::Parallelogram;
pub use silhouette::{facing, multiplicities};
pub use volume::{Volume, VolumeParts};
