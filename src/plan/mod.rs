//! A frame as data: everything that a GPU is given, and why.
//!
//! A technique turns a scene into a [`FramePlan`]; `gpu::Executor` runs any plan. A plan has no GPU object, so it can
//! be printed ([`text`]), checked ([`lint`]), diffed and tested without one, and a broken frame is a good plan with one
//! thing changed.
//!
//! ```text
//! FramePlan ─ attachments   pictures that passes draw into
//!           ─ views         a matrix each: the camera, and every face of every shadow map
//!           ─ lights        what shaders know of a light, and where its map and labels are
//!           ─ passes ─ draws ─ raster state, program, mesh range, constants
//!           ─ left_out      what was not needed, and why
//! ```

mod attachment;
mod buffers;
mod cache_key;
mod channel;
mod clipped;
mod count_bits;
mod coverage;
mod decided_by;
mod decision;
mod draw;
mod ids;
mod image;
mod left_out;
mod light;
pub mod lint;
mod near_triangles;
mod pass;
mod pieces;
mod pixel_rasteriser;
mod planar_shadows;
mod program;
mod raster;
mod recorded_pass;
mod split;
mod stored;
pub mod text;
mod unseen;
pub mod words;

pub use crate::geometry::{Blob, Carry, Extruded, ExtrudedCorner, NormalsPer, SurfaceNormals};
pub use attachment::{Attachment, AttachmentRole};
pub use buffers::{DrawMesh, PlanTexture, SurfaceData};
pub use channel::LightChannel;
pub use clipped::ExactRange;
pub use count_bits::CountBits;
pub use coverage::{Coverage, Covering, FragmentLog, LoggedFragment, VisibleFace};
pub use decided_by::{CountOf, CountedSide, DecidedBy};
pub use decision::Decision;
pub use draw::{Draw, DrawConstants, DrawPart, DrawPieces, RasterisedTriangles};
pub use ids::{AttachmentId, LightId, MeshId, TextureId, ViewId};
pub use image::{CpuImage, MakeImage};
pub use left_out::LeftOut;
pub use light::{MapLookup, PlanLight, PlanMap};
pub use near_triangles::TriangleBoxes;
pub use pass::{ColorTarget, DepthStencilTarget, Pass};
pub(crate) use pieces::depth_plane;
pub use program::{ClipPlane, Program, ShaderEffect, Visibility};
pub use raster::{ColorWrite, FaceMasks, RasterState, StencilFace};
pub use recorded_pass::{RecordedPass, StartContent, Viewport};

use crate::math::depth::DepthCurve;
use glam::{DVec3, Mat4, Vec4};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A frame as data, ready to be run: attachments, meshes, lights, and passes with their draws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FramePlan {
    /// Name of the technique that planned it.
    pub technique: String,
    /// The value of every setting of the technique by its key, defaults included.
    pub settings: BTreeMap<String, String>,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// The mapping from distance to stored depth.
    pub depth: DepthCurve,
    /// Whether diffuse light is wrapped around surfaces instead of Lambert's.
    pub wraps_diffuse: bool,
    /// The share of each light's diffuse light that arrives whatever stands between, 0 to 1.
    #[serde(default)]
    pub ambient_diffuse: f32,
    /// Textures that passes draw into.
    pub attachments: Vec<Attachment>,
    /// The views that passes are drawn from: the camera first, then lights.
    pub views: Vec<PlanView>,
    /// The lights, in the scene's order.
    pub lights: Vec<PlanLight>,
    /// Linear RGB light that reaches every surface.
    pub ambient: [f32; 3],
    /// Vertices and indices of the draws. Capture folders store them as arrays.
    #[serde(skip)]
    pub meshes: Vec<DrawMesh>,
    /// Textures on surfaces. Capture folders store them as pictures.
    #[serde(skip)]
    pub textures: Vec<PlanTexture>,
    /// Passes in the order in which they run.
    pub passes: Vec<Pass>,
    /// What was left out, with reasons.
    pub left_out: Vec<LeftOut>,
}

/// A view that passes are drawn from: the camera, or a light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanView {
    /// A name for people: `camera`, `light 0 face +x`.
    pub name: String,
    /// World position that the vertices of this view's meshes are relative to.
    pub origin: DVec3,
    /// Where view rays meet, homogeneous and relative to `origin`, for specular highlights; for a parallel view the
    /// direction towards its eye (w = 0).
    #[serde(default = "PlanView::at_origin")]
    pub eye: Vec4,
    /// Clip space from positions relative to `origin`.
    pub clip_from_relative: Mat4,
}

impl PlanView {
    /// Returns an eye at the view's origin.
    pub fn at_origin() -> Vec4 {
        Vec4::W
    }
}

impl FramePlan {
    /// Returns the attachment with this id.
    ///
    /// # Panics
    /// If the id is of another plan; [`lint::check`] finds that beforehand.
    pub fn attachment(&self, id: AttachmentId) -> &Attachment {
        &self.attachments[id.0]
    }

    /// Returns the plan without normals and textures, which pixel histories don't ask for. It can be read, not run.
    #[must_use]
    pub fn without_shading(&self) -> FramePlan {
        let mut plan = FramePlan { textures: Vec::new(), ..self.clone() };
        for mesh in &mut plan.meshes {
            mesh.surface = None;
        }
        for draw in plan.passes.iter_mut().flat_map(|pass| &mut pass.draws) {
            draw.constants.texture = None;
        }
        plan
    }

    /// Returns how many triangles the draws of the frame submit, culled ones included; mask passes don't count.
    pub fn triangles(&self) -> u64 {
        let draws = self.timed_passes().flat_map(|pass| &pass.draws);
        draws.map(|draw| u64::from(draw.triangles.end - draw.triangles.start)).sum()
    }

    /// Returns how many bytes of GPU memory the frame's attachments, vertices, indices and textures take, without what
    /// only mask passes use.
    pub fn bytes(&self) -> u64 {
        let (mut attachments, mut blobs, mut textures) = (BTreeSet::new(), BTreeMap::new(), BTreeSet::new());
        for pass in self.timed_passes() {
            attachments.extend(pass.color.iter().map(|target| target.attachment));
            attachments.extend(pass.depth_stencil.iter().map(|target| target.attachment));
            for mesh in pass.draws.iter().filter_map(|draw| self.meshes.get(draw.rasterised().mesh.0)) {
                blobs.extend(mesh.blobs());
            }
            textures.extend(pass.draws.iter().filter_map(|draw| draw.constants.texture));
        }
        let textures = textures.into_iter().filter_map(|id| self.textures.get(id.0)).map(PlanTexture::bytes);
        attachments.into_iter().map(|id| self.attachment_bytes(id)).sum::<u64>()
            + blobs.values().sum::<u64>()
            + textures.sum::<u64>()
    }

    /// Restricts every pass to a part of the picture: left, top, columns, rows. Shadow maps stay whole, as any part may
    /// read any of their texels, and may be cached for other parts.
    pub(crate) fn draw_only(&mut self, area: [u32; 4]) {
        self.picture_passes_mut().for_each(|pass| pass.restrict_to(area));
        self.lights.iter_mut().filter_map(|light| light.map.as_mut()).for_each(|map| map.is_cached = true);
    }

    /// Returns the passes that draw into targets of the picture's size: all but those of maps.
    pub(crate) fn picture_passes_mut(&mut self) -> impl Iterator<Item = &mut Pass> {
        let attachments = &self.attachments;
        let is_map = |pass: &Pass| {
            let mut roles = pass.targets().map(|id| attachments[id.0].role);
            roles.any(|role| matches!(role, AttachmentRole::Map(_)))
        };
        self.passes.iter_mut().filter(move |pass| !is_map(pass))
    }

    fn timed_passes(&self) -> impl Iterator<Item = &Pass> {
        self.passes.iter().filter(|pass| pass.timed)
    }
}
