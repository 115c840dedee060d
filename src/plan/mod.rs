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

mod buffers;
mod cache_key;
mod count_bits;
mod coverage;
mod decided_by;
mod decision;
mod image;
mod left_out;
pub mod lint;
mod raster;
mod recorded;
mod split;
mod stored;
pub mod text;
mod unseen;
pub mod words;

pub use crate::geometry::{Blob, Carry, Extruded, ExtrudedCorner};
pub use buffers::{DrawMesh, PlanTexture, SurfaceData};
pub use count_bits::CountBits;
pub use coverage::{ClipPlane, Coverage, Covering, FragmentLog, LoggedFragment, VisibleFace};
pub use decided_by::{CountOf, CountedSide, DecidedBy};
pub use decision::Decision;
pub use image::{CpuImage, MakeImage};
pub use left_out::LeftOut;
pub use raster::{ColorWrite, FaceMasks, RasterState, StencilFace};
pub use recorded::{RecordedPass, ShaderEffect, StartContent, Viewport};

use crate::math::depth::DepthCurve;
use glam::{DMat4, DVec3, Mat4, Vec4};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Index into [`FramePlan::attachments`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct AttachmentId(pub usize);

/// Index into [`FramePlan::views`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ViewId(pub usize);

/// Index of a light, in the scene and in [`FramePlan::lights`] alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LightId(pub usize);

impl LightId {
    /// Shown to people, counted from 1: `light 1`.
    pub fn name(self) -> String {
        crate::numbers::light(self.0)
    }
}

/// Index into [`FramePlan::meshes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MeshId(pub usize);

/// Index into [`FramePlan::textures`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TextureId(pub usize);

/// One frame, ready to be run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FramePlan {
    /// Name of the technique that planned it.
    pub technique: String,
    /// Every setting of the technique, defaults included, as in `--set`.
    pub settings: BTreeMap<String, String>,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// How the camera's distance becomes stored depth.
    pub depth: DepthCurve,
    /// Diffuse light wraps round the edge that Lambert's ends at.
    pub wraps_diffuse: bool,
    /// Pictures that passes draw into.
    pub attachments: Vec<Attachment>,
    /// The camera first, then the faces of shadow maps.
    pub views: Vec<PlanView>,
    /// Parallel to the scene's lights.
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
    /// Work that this scene does not need.
    pub left_out: Vec<LeftOut>,
}

/// A picture that passes draw into.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Attachment {
    /// Shown to people: `color`, `depth and stencil`, `light 0 map`, `light 0 labels`.
    pub name: String,
    /// Purpose: how it is read back and shown.
    pub role: AttachmentRole,
    /// The GPU format of its texels.
    pub format: wgpu::TextureFormat,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// 1, or the faces of a shadow map; the memory is [`FramePlan::stored_layers`].
    pub layers: u32,
}

/// What an attachment is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum AttachmentRole {
    /// The picture.
    Color,
    /// Depth, and stencil where the format has it, of the picture.
    DepthStencil,
    /// What a light sees: depth, or the colour of what it lets through.
    Map(LightId),
    /// How many shadow volumes of a light contain each pixel's surface, signed.
    Count(LightId),
    /// The technique's labels of a light, one byte a pixel: 0 lit, 1 in shadow, 2 background, 3 faces away from the
    /// light or is beyond its range.
    Labels(LightId),
}

/// The view that a pass is drawn from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanView {
    /// Shown to people: `camera`, `light 0 face +x`.
    pub name: String,
    /// World position that the vertices of this view's meshes are relative to.
    pub origin: DVec3,
    /// Where view rays begin, homogeneous and relative to `origin`; of a parallel view the direction towards its eye.
    /// Specular highlights use it.
    #[serde(default = "PlanView::at_origin")]
    pub eye: Vec4,
    /// Clip space from positions relative to `origin`.
    pub clip_from_relative: Mat4,
}

impl PlanView {
    /// An eye at the origin that vertices are relative to.
    pub fn at_origin() -> Vec4 {
        Vec4::W
    }
}

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

/// One render pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// Short, lower case: `ambient`, `volumes`, `light`.
    pub name: String,
    /// One sentence that explains the pass to a learner.
    pub purpose: String,
    /// The light it belongs to; `None` for the scene's own passes.
    pub light: Option<LightId>,
    /// True for passes whose time counts for the frame; mask passes do not count.
    pub timed: bool,
    /// The view it is drawn from.
    pub view: ViewId,
    /// Colour target, if any.
    pub color: Option<ColorTarget>,
    /// Depth-stencil target, if any.
    pub depth_stencil: Option<DepthStencilTarget>,
    /// Scissor rectangle: left, top, columns, rows. Draws change nothing outside of it; clears do.
    pub scissor: Option<[u32; 4]>,
    /// Draws in order.
    pub draws: Vec<Draw>,
    /// A picture computed on the CPU that goes into its colour target in place of draws. Capture folders store it as an
    /// array.
    #[serde(skip)]
    pub image: Option<CpuImage>,
    /// Further data of a pass of another program's frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recorded: Option<Box<RecordedPass>>,
}

impl Pass {
    /// Returns whether its draws may change a pixel, by its scissor rectangle.
    pub fn reaches(&self, [x, y]: [u32; 2]) -> bool {
        let holds = |[left, top, columns, rows]: [u32; 4]| {
            (left..left.saturating_add(columns)).contains(&x) && (top..top.saturating_add(rows)).contains(&y)
        };
        self.scissor.is_none_or(holds)
    }

    /// Returns whether the pass counts the volumes that contain the near plane, as z-pass-plus begins. Its view is from
    /// the light.
    pub fn counts_at_near_plane(&self) -> bool {
        self.view != ViewId(0) && self.draws.iter().any(|draw| draw.part.is_of_volume())
    }
}

/// The colour target of a pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ColorTarget {
    /// The attachment that is drawn into.
    pub attachment: AttachmentId,
    /// The layer that is drawn into.
    pub layer: u32,
    /// Value that it is cleared to at the start (linear RGBA, or a label in the first component); `None` loads what is
    /// stored.
    pub clear: Option<[f64; 4]>,
}

/// The depth-stencil target of a pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DepthStencilTarget {
    /// The attachment that is tested and drawn into.
    pub attachment: AttachmentId,
    /// The layer that is tested and drawn into.
    pub layer: u32,
    /// Depth that it is cleared to at the start; `None` loads what is stored.
    pub clear_depth: Option<f32>,
    /// Stencil value that it is cleared to at the start; `None` loads what is stored.
    pub clear_stencil: Option<u8>,
}

/// One draw call.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Draw {
    /// Short: `sides of bunny`.
    pub name: String,
    /// The object that it shows, or whose shadow it draws.
    pub caster: Option<String>,
    /// Which part of the object or of its shadow it draws.
    pub part: DrawPart,
    /// The shader.
    pub program: Program,
    /// The whole raster state.
    pub raster: RasterState,
    /// Vertices and indices.
    pub mesh: MeshId,
    /// Range of triangles in the mesh's index list.
    pub triangles: Range<u32>,
    /// Added to every index: a dark cap is its light cap at the far vertices.
    pub base_vertex: u32,
    /// For a part of a shadow volume: true where its triangles' fronts face into the volume, and their backs outwards.
    /// Caps are runs of the caster's own triangles, so either is possible.
    pub faces_inwards: bool,
    /// Values for the shader.
    pub constants: DrawConstants,
}

impl Draw {
    /// Returns which part a triangle of the draw is: of caps that a vertex shader carries, light cap or dark cap.
    pub fn part_of(&self, mesh: &DrawMesh, corners: [u32; 3]) -> DrawPart {
        match (self.part, mesh.extruded.as_ref().map(|extruded| extruded.carried(corners))) {
            (DrawPart::Caps, Some([true, ..])) => DrawPart::DarkCap,
            (DrawPart::Caps, Some([false, ..])) => DrawPart::LightCap,
            (part, _) => part,
        }
    }

    /// Returns a draw of a whole mesh by position only, as into the stencil.
    pub fn of_positions(
        name: impl Into<String>,
        part: DrawPart,
        mesh: MeshId,
        triangles: u32,
        raster: RasterState,
    ) -> Draw {
        Draw {
            name: name.into(),
            caster: None,
            part,
            program: Program::Position,
            raster,
            mesh,
            triangles: 0..triangles,
            base_vertex: 0,
            faces_inwards: false,
            constants: DrawConstants::default(),
        }
    }
}

named_enum! {
    /// Which part of a frame's geometry a draw is.
    pub enum DrawPart {
        /// Visible surface.
        Surface = "surface",
        /// Side of a shadow volume.
        Side = "side",
        /// The casting triangles themselves.
        LightCap = "light-cap",
        /// The casting triangles carried to infinity.
        DarkCap = "dark-cap",
        /// Light cap and dark cap in one: the vertex shader decides which triangle is which.
        Caps = "caps",
        /// A plane that planar shadows fall on.
        Receiver = "receiver",
        /// A caster flattened onto a receiver.
        PlanarShadow = "planar-shadow",
        /// Surface as a light sees it.
        Map = "map",
    }
}

impl DrawPart {
    /// Returns whether it is a part of a shadow volume.
    pub fn is_of_volume(self) -> bool {
        matches!(self, DrawPart::Side | DrawPart::LightCap | DrawPart::DarkCap | DrawPart::Caps)
    }

    /// Returns whether this part is `part`, or contains it.
    pub fn includes(self, part: DrawPart) -> bool {
        self == part || (self == DrawPart::Caps && matches!(part, DrawPart::LightCap | DrawPart::DarkCap))
    }
}

/// The shader of a draw. All share one vertex transformation, so depths are bit-equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Program {
    /// Writes depth and stencil only: volumes, caps, planar shadows, shadow maps, receiver marks.
    Position,
    /// Writes the draw's flat colour.
    Flat,
    /// Writes the draw's label, whichever way the surface faces.
    FlatLabel,
    /// Adds the draw's count where the front of a triangle is seen, and subtracts it where its back is.
    Count,
    /// Writes the material's colour times the ambient light.
    Ambient {
        /// Discards fragments nearer than the near plane, where nothing else clips them.
        from_near: bool,
    },
    /// Adds the pass's light, as far as it arrives.
    Light(Visibility),
    /// Writes what the draw's layer of the light's map lets through, to darken what is there.
    Through,
    /// Writes a label: 3 where the triangle faces away from the light or is beyond its range, 1 where less than half of
    /// the light arrives, else the draw's `label`. Triangles run in reverse order, so that of
    /// surfaces at one depth the first drawn decides, as it did for the picture.
    Label(Visibility),
    /// Another program's shader: vertices are clip-space positions, and go through unchanged. Its colours are not
    /// known.
    Recorded {
        /// Whether it may discard fragments.
        may_discard: ShaderEffect,
        /// Whether it may write a depth of its own.
        writes_depth: ShaderEffect,
    },
}

/// What a shader reads to find how much of a light arrives at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Visibility {
    /// Nothing: all that passes the depth and stencil tests is lit.
    Everywhere,
    /// The light's shadow map.
    Map,
    /// The light's labels, computed on the CPU.
    Labels,
    /// The light's count: zero is lit.
    Count,
    /// The receiver's texture: the draw's layer of the light's map.
    ReceiverTexture,
    /// The silhouettes of all casters, projected, except the one in the draw's own layer.
    Projected,
}

impl Visibility {
    /// Returns whether the shader branches on properties of the light's map.
    pub(crate) fn branches_on_light(self) -> bool {
        matches!(self, Visibility::Map | Visibility::ReceiverTexture | Visibility::Projected)
    }

    /// All six, in order.
    pub const ALL: [Visibility; 6] = [
        Visibility::Everywhere,
        Visibility::Map,
        Visibility::Labels,
        Visibility::Count,
        Visibility::ReceiverTexture,
        Visibility::Projected,
    ];

    /// Returns whether it reads the light's map.
    pub fn reads_map(self) -> bool {
        matches!(self, Visibility::Map | Visibility::ReceiverTexture | Visibility::Projected)
    }
}

impl Program {
    /// Returns all programs of our own frames.
    pub fn all() -> Vec<Program> {
        let unlit = [false, true].map(|from_near| Program::Ambient { from_near });
        let flat = [Program::Position, Program::Flat, Program::FlatLabel, Program::Count, Program::Through];
        let lit = Visibility::ALL.into_iter().flat_map(|how| [Program::Light(how), Program::Label(how)]);
        let recorded = Program::Recorded { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::No };
        flat.into_iter().chain(unlit).chain(lit).chain([recorded]).collect()
    }

    /// Returns the clip plane beyond which the shader discards a fragment of this depth: where depth is clamped,
    /// nothing else clips at near and far (`discard` in the shaders' files).
    pub fn discards(self, depth: f32) -> Option<ClipPlane> {
        match self {
            Program::Ambient { from_near: true } if depth < 0.0 => Some(ClipPlane::Near),
            Program::Light(_) | Program::Label(_) | Program::Through if depth > 1.0 => Some(ClipPlane::Far),
            _ => None,
        }
    }

    /// Returns whether it shows a surface's texture, where there is one.
    pub fn shows_texture(self) -> bool {
        matches!(self, Program::Ambient { .. } | Program::Light(_))
    }

    /// Returns whether it reads nothing but positions and the draw's flat colour.
    pub fn is_flat(self) -> bool {
        matches!(self, Program::Position | Program::Flat)
    }

    /// What it reads to find how much light arrives; `None` for programs that do not light.
    pub fn visibility(self) -> Option<Visibility> {
        match self {
            Program::Light(visibility) | Program::Label(visibility) => Some(visibility),
            Program::Through => Some(Visibility::Projected),
            Program::Position
            | Program::Flat
            | Program::FlatLabel
            | Program::Count
            | Program::Ambient { .. }
            | Program::Recorded { .. } => None,
        }
    }
}

/// Values that one draw passes to its shader.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DrawConstants {
    /// Material of the surface.
    pub material: crate::scene::Material,
    /// What [`Program::Label`] and [`Program::FlatLabel`] write: 0 lit or 1 shadow.
    pub label: u32,
    /// Linear RGBA that [`Program::Flat`] writes.
    pub flat: [f32; 4],
    /// What [`Program::Count`] adds for a front face: 1 or −1.
    pub count: f32,
    /// Index of the draw's own layer in the light's map.
    pub layer: Option<u32>,
    /// The eye's world X and Z, less whole periods of the material's checks: where their pattern begins, in metres.
    #[serde(default)]
    pub checks_from: [f32; 2],
    /// The texture that the material's colour is multiplied with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<TextureId>,
}

impl FramePlan {
    /// Returns the attachment with this id.
    ///
    /// # Panics
    /// If the id is of another plan; [`lint::check`] finds that beforehand.
    pub fn attachment(&self, id: AttachmentId) -> &Attachment {
        &self.attachments[id.0]
    }

    /// The number of triangles that the frame submits, without those of mask passes.
    pub fn triangles(&self) -> u64 {
        let draws = self.timed_passes().flat_map(|pass| &pass.draws);
        draws.map(|draw| u64::from(draw.triangles.end - draw.triangles.start)).sum()
    }

    /// Bytes of GPU memory that the frame needs for attachments, vertices, indices and textures. What only mask passes
    /// need is left out.
    pub fn bytes(&self) -> u64 {
        let (mut attachments, mut blobs, mut textures) = (BTreeSet::new(), BTreeMap::new(), BTreeSet::new());
        for pass in self.timed_passes() {
            attachments.extend(pass.color.iter().map(|target| target.attachment));
            attachments.extend(pass.depth_stencil.iter().map(|target| target.attachment));
            for mesh in pass.draws.iter().filter_map(|draw| self.meshes.get(draw.mesh.0)) {
                blobs.extend(mesh.blobs());
            }
            textures.extend(pass.draws.iter().filter_map(|draw| draw.constants.texture));
        }
        let textures = textures.into_iter().filter_map(|id| self.textures.get(id.0)).map(PlanTexture::bytes);
        attachments.into_iter().map(|id| self.attachment_bytes(id)).sum::<u64>()
            + blobs.values().sum::<u64>()
            + textures.sum::<u64>()
    }

    fn timed_passes(&self) -> impl Iterator<Item = &Pass> {
        self.passes.iter().filter(|pass| pass.timed)
    }
}
