//! What shaders know of a light: its position, its colour, and its shadow map or textures.

use super::ids::{AttachmentId, ViewId};
use super::{CountOf, DecidedBy};
use glam::{DMat4, Mat4};
use serde::{Deserialize, Serialize};

/// The data of a light that shaders get.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanLight {
    /// Homogeneous, relative to the eye: `(L.xyz − L.w·eye, L.w)`.
    pub relative_position: [f32; 4],
    /// Linear RGB times intensity.
    pub color: [f32; 3],
    /// Distance at which the light has faded to nothing; `None`: no falloff.
    pub range: Option<f32>,
    /// What its light pass reads to decide where the shadow is.
    pub decided_by: DecidedBy,
    /// What a count of its volumes counts, where that is known.
    #[serde(default)]
    pub count_of: Option<CountOf>,
    /// Its shadow map or textures, where the technique makes any.
    pub map: Option<PlanMap>,
    /// Where its volumes are counted, if not in the stencil.
    pub count: Option<AttachmentId>,
    /// Where its mask pass writes labels.
    pub labels: AttachmentId,
}

/// What a light sees, in layers: the face of a shadow map or the six of a cube in wgpu's order
/// (+x −x +y −y +z −z), the texture of each receiver, or the silhouette of each caster.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanMap {
    /// The attachment that stores its texels.
    pub attachment: AttachmentId,
    /// The view of each face; `None` where a face sees no caster: it takes no memory, and shows as clear.
    pub faces: Vec<Option<ViewId>>,
    /// Light space from world space.
    pub light_from_world: DMat4,
    /// Clip space of each face from light space.
    pub clip_from_light: Vec<DMat4>,
    /// Clip space of each face from positions relative to the eye: receivers' fragments are projected with it.
    pub clip_from_relative: Vec<Mat4>,
    /// Name of the receiver or caster of each layer, where the map stores colours. Empty for the faces of a depth map.
    pub layer_names: Vec<String>,
    /// How depths are looked up; `None` where the map stores colours.
    pub lookup: Option<MapLookup>,
    /// Projected colours reach behind the light too.
    pub projects_backwards: bool,
    /// True clamps lookups outside of the map to its edge; false lets all of the light through there.
    #[serde(default)]
    pub repeats_edge: bool,
    /// Its texture is cached from frame to frame while what draws it is the same.
    pub is_cached: bool,
}

impl PlanMap {
    /// The largest number of faces that a shader's light has space for.
    pub const MOST_FACES: usize = 64;
}

/// How a shadow map is looked up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MapLookup {
    /// Depth of texels that no caster covers; 0 where depth is reversed.
    pub clear_depth: f32,
    /// Normal offset: how far the point is moved along its normal, in texels, times the sine of the light's angle.
    pub bias_normal: f32,
    /// Receiver-plane bias: each texel is compared with the depth that the surface's plane has there.
    pub bias_receiver_plane: bool,
    /// Width of the filter: texels averaged along each side.
    pub filter_width: u32,
}
