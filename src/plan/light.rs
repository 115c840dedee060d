//! What shaders know of a light: its position, its colour, and its shadow map or textures.

use super::ids::{AttachmentId, ViewId};
use super::{CountOf, DecidedBy, Visibility};
use glam::{DMat4, Mat4};
use serde::{Deserialize, Serialize};

/// A light as shaders get it, with the attachments that its passes use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanLight {
    /// Homogeneous, relative to the eye: `(L.xyz − L.w·eye, L.w)`.
    pub relative_position: [f32; 4],
    /// Linear RGB times intensity.
    pub color: [f32; 3],
    /// Distance in metres at which the light has faded to nothing; `None` without falloff.
    pub range: Option<f32>,
    /// What its light pass reads to decide whether a pixel is in shadow.
    pub decided_by: DecidedBy,
    /// What 1 in the count of its volumes stands for; `None` where that is not known.
    #[serde(default)]
    pub count_of: Option<CountOf>,
    /// Its shadow map or textures; `None` where the technique makes none.
    pub map: Option<PlanMap>,
    /// The float attachment in which its volumes are counted; `None` where they are counted in the stencil, or not at
    /// all.
    pub count: Option<AttachmentId>,
    /// The attachment to which its mask pass writes labels.
    pub labels: AttachmentId,
    /// The attachment to which its visibility pass writes the share of it that arrives; `None` where a technique knows
    /// no shares, only lit and dark.
    #[serde(default)]
    pub visibility: Option<AttachmentId>,
}

impl PlanLight {
    /// Returns whether a shader that finds as `how` says how much of the light arrives may find a share between none
    /// and all: from textures, which are filtered, and from more than one texel of a map of depths.
    pub fn knows_shares(&self, how: Visibility) -> bool {
        let filter_width = self.map.as_ref().and_then(|map| map.lookup).map_or(1, |lookup| lookup.filter_width);
        match how {
            Visibility::Map => filter_width > 1,
            Visibility::ReceiverTexture | Visibility::Projected => true,
            Visibility::Everywhere | Visibility::Labels | Visibility::Count => false,
        }
    }
}

/// A light's texture array: the faces of a shadow map (one, or six of a cube in wgpu's order +x −x +y −y +z −z), the
/// texture of each receiver, or the silhouette of each caster.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanMap {
    /// The attachment that stores its texels.
    pub attachment: AttachmentId,
    /// The view of each face; `None` for a face that contains no caster: it takes no memory and reads as clear.
    pub faces: Vec<Option<ViewId>>,
    /// Light space from world space.
    pub light_from_world: DMat4,
    /// Clip space of each face from light space.
    pub clip_from_light: Vec<DMat4>,
    /// Clip space of each face from positions relative to the eye, with which shaders look fragments up.
    pub clip_from_relative: Vec<Mat4>,
    /// Name of the receiver or caster of each layer, where the map stores colours. Empty for the faces of a depth map.
    pub layer_names: Vec<String>,
    /// How depths are compared; `None` where the map stores colours.
    pub lookup: Option<MapLookup>,
    /// Whether silhouettes are projected behind the light too (reverse projection).
    pub projects_backwards: bool,
    /// True clamps lookups outside of the map to its edge; false lets all of the light through there.
    #[serde(default)]
    pub repeats_edge: bool,
    /// Whether its texture is cached from frame to frame while what draws it is the same.
    #[serde(rename = "is_kept")]
    pub is_cached: bool,
}

impl PlanMap {
    /// The most faces or layers that a light's map can have: as many as its shader constants have space for.
    pub const MOST_FACES: usize = 64;
}

/// How a shader looks a fragment up in a depth map: which texels it reads, and with which depth it compares them.
/// Constant and slope bias are not here: the draws that make the map have them, in their raster state.
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

impl MapLookup {
    /// How another program's map is read here, whatever its shader does: one texel, against the depth that the surface's
    /// plane has at its middle, which is the least bias that causes no acne. The depth of empty texels is another one where
    /// depth is reversed.
    pub const RECORDED: MapLookup =
        MapLookup { clear_depth: 1.0, bias_normal: 0.0, bias_receiver_plane: true, filter_width: 1 };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_earlier_versions_are_read() {
        let written = r#"{"attachment": 1, "faces": [1], "light_from_world": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
            "clip_from_light": [], "clip_from_relative": [], "layer_names": [], "lookup": null,
            "projects_backwards": false, "repeats_edge": false, "is_kept": true}"#;
        let map: PlanMap = serde_json::from_str(written).expect("a map");
        assert!(map.is_cached);
        let rewritten = serde_json::to_value(&map).expect("a value");
        let written: serde_json::Value = serde_json::from_str(written).expect("a value");
        let keys =
            |value: &serde_json::Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
        assert_eq!(keys(&rewritten), keys(&written));
    }
}
