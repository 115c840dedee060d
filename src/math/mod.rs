//! Planes, projections and exact signs, in `f64`, with no GPU and no scene.
//!
//! Conventions: world space is right-handed with Y up; view space looks down −z; normalised
//! device z is in [0, 1]; front faces are counter-clockwise. A transform is named for the spaces
//! it joins, target first, so that `a_from_b * b_from_c = a_from_c` reads right. A light is a
//! homogeneous point: `w = 1` a point light, `w = 0` the direction towards a directional one.

pub mod angle;
mod axis_box;
pub mod clip;
pub mod depth;
mod depth_bits;
mod exact;
mod plane;
pub mod projection;

pub use axis_box::AxisBox;
pub use depth_bits::{DepthBits, DepthBitsError};
pub use exact::{Sign, side_of_line, side_of_triangle, sign_of_sum};
pub use plane::Plane;
