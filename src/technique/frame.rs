//! What all techniques share: the builder of a frame's plan.
//!
//! A technique starts a [`FrameBuilder`], in which objects and lights are then placed (`places.rs`), adds its own
//! passes between `ambient_pass` and, for each light, `mask_pass` and `light_pass` (`passes.rs`, drawn as `drawn.rs`
//! says), and finishes it into a plan.

mod coincident;
mod drawn;
mod passes;
mod places;

use super::error::MOST_LIGHTS;
use super::{Choice, CommonSettings, PlanError};
use crate::geometry::{self, GeometryCache};
use crate::math::AxisBox;
use crate::math::depth::{DepthCurve, DepthMapping};
use crate::plan::{
    Attachment, AttachmentId, Decision, DrawMesh, DrawPart, FramePlan, LeftOut, LightId, MeshId, PlanTexture,
    TextureId, ViewId, Viewport,
};
use crate::scene::{Camera, Material, MaterialTexture, Object, Scene};
pub use drawn::SurfaceDrawing;
use glam::{DVec3, DVec4};
use std::ops::Range;

/// The input from which a technique plans a frame.
#[derive(Debug)]
pub struct PlanRequest<'a> {
    /// The scene, already moved to the frame's time.
    pub scene: &'a Scene,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The technique and its settings.
    pub choice: &'a Choice,
    /// Geometry that is derived from meshes, cached between plans.
    pub cache: &'a mut GeometryCache,
    /// The camera whose view maps are fitted to where they follow the view; `None` for the scene's own. Another one gives
    /// the maps of a picture before or after this one.
    pub map_camera: Option<&'a Camera>,
}

/// An object of the scene with its world-space vertices and the mesh of its drawn surface.
#[derive(Debug)]
pub struct FrameObject<'a> {
    /// The object of the scene.
    pub object: &'a Object,
    /// World positions of its welded vertices, metres.
    pub world: Vec<DVec3>,
    /// The mesh of its drawn surface; `None` for an object that is not drawn.
    pub surface: Option<MeshId>,
}

/// A range of a visible surface that is one draw: one group of an object, or some of its triangles.
#[derive(Debug, Clone)]
pub struct SurfacePiece {
    /// A name for people: the object's, followed by the group's.
    pub name: String,
    /// Index of its object in [`FrameBuilder::placed`].
    pub object: usize,
    /// The material of its surface.
    pub material: Material,
    /// The mesh that it is a part of.
    pub mesh: MeshId,
    /// Its triangles, as a range of the mesh's index list: the first index is 3 × the start.
    pub triangles: Range<u32>,
    /// The layer of each light's texture array that is its own (receiver textures, silhouettes); `None` where it has
    /// none.
    pub layer: Option<u32>,
    /// The texture on it, if any.
    pub texture: Option<TextureId>,
}

/// Builds a frame's plan: places objects and lights, then adds passes in the order in which they run.
#[derive(Debug)]
pub struct FrameBuilder<'a> {
    /// The input of the plan.
    pub job: PlanRequest<'a>,
    /// The settings that every technique has.
    pub common: CommonSettings,
    /// The objects as the frame shows them, in the scene's order.
    pub placed: Vec<FrameObject<'a>>,
    /// All visible surfaces, in the order in which they are drawn.
    pub pieces: Vec<SurfacePiece>,
    /// The pieces that the next light pass draws; `None` for all pieces.
    pub lit: Option<Vec<SurfacePiece>>,
    /// The plan so far; passes of other kinds than the methods make are pushed here.
    pub plan: FramePlan,
    /// Whether volumes are clipped at the near plane even where depth is clamped: faces that are counted in front of
    /// surfaces must not begin before it.
    pub clips_volumes: bool,
    color: AttachmentId,
    depth_stencil: AttachmentId,
    has_stencil: bool,
    /// The cached result of [`FrameBuilder::surfaces_coincide`]; `None` before it is first asked for.
    coincide: Option<bool>,
    /// The light whose passes wrote the stencil last.
    stencil_of: Option<LightId>,
    /// For each light, the scissor rectangle of its passes (x, y, width, height in pixels); `None` for the whole
    /// picture.
    scissors: Vec<Option<[u32; 4]>>,
}

/// What a technique uses the stencil buffer for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StencilUse {
    /// The technique counts or marks in it, so the frame always has one.
    Always,
    /// Only where triangles have the same three corners: there the stencil prevents that they are lit twice. Other
    /// triangles that overlap in one plane are lit twice where their depths round alike.
    ToLightOnce,
}

impl<'a> FrameBuilder<'a> {
    /// Checks the scene and begins a plan: places objects and lights, and adds the attachments, the camera's view and
    /// the surfaces; no pass yet. A stencil is there where `stencil` asks for it.
    pub fn new(job: PlanRequest<'a>, stencil: StencilUse) -> Result<FrameBuilder<'a>, PlanError> {
        let scene = job.scene;
        job.cache.next_plan();
        scene.camera.check().map_err(|problem| PlanError::Unusable { problem: problem.to_owned() })?;
        if scene.lights.len() > MOST_LIGHTS {
            return Err(PlanError::TooManyLights { count: scene.lights.len() });
        }
        let common = job.choice.common();
        let technique = job.choice.technique().name().to_owned();
        let plan = FramePlan {
            technique,
            settings: job.choice.settings().clone(),
            size: job.size,
            depth: DepthMapping::ReversedInfinite.curve(scene.camera.near, 0.0, 0.0),
            wraps_diffuse: common.wraps_diffuse,
            ambient_diffuse: common.ambient_diffuse,
            attachments: Vec::new(),
            views: Vec::new(),
            lights: Vec::new(),
            ambient: scene.ambient,
            meshes: Vec::new(),
            textures: Vec::new(),
            passes: Vec::new(),
            left_out: Vec::new(),
        };
        let no_target = AttachmentId(0);
        let mut frame = FrameBuilder {
            placed: Vec::new(),
            pieces: Vec::new(),
            lit: None,
            plan,
            clips_volumes: false,
            color: no_target,
            depth_stencil: no_target,
            has_stencil: stencil == StencilUse::Always || !common.allows(Decision::Stencil),
            coincide: None,
            stencil_of: None,
            scissors: Vec::new(),
            common,
            job,
        };
        frame.place_objects()?;
        let curve = frame.depth_curve().stored_in(frame.common.depth_range);
        frame.plan.depth = DepthCurve { bits: frame.common.depth_bits, ..curve };
        frame.plan.views.push(places::camera_view(scene, frame.job.size, &frame.plan.depth));
        // Looking at every triangle pays only where it decides something.
        frame.has_stencil = frame.has_stencil || frame.surfaces_coincide();
        frame.add_attachments();
        frame.add_lights()?;
        Ok(frame)
    }

    /// Returns the eye in world space; vertex positions of the camera's passes are relative to it.
    pub fn eye(&self) -> DVec3 {
        self.job.scene.camera.eye
    }

    /// Returns where view rays meet, homogeneous, in world space: the eye, or with w = 0 the direction towards a
    /// parallel projection's camera.
    pub fn eye_position(&self) -> DVec4 {
        self.job.scene.camera.eye_position()
    }

    /// Returns whether any two drawn triangles have the same three corners, so that both are visible at one depth. The
    /// result is cached.
    pub fn surfaces_coincide(&mut self) -> bool {
        *self.coincide.get_or_insert_with(|| coincident::coincide(&self.placed, self.job.cache))
    }

    /// Returns the scene's lights in order.
    pub fn light_ids(&self) -> impl Iterator<Item = LightId> + use<> {
        (0..self.job.scene.lights.len()).map(LightId)
    }

    /// Returns the homogeneous world position of a light: w is 0 for a directional one.
    pub fn light_position(&self, light: LightId) -> DVec4 {
        self.job.scene.lights[light.0].homogeneous()
    }

    /// Adds an attachment to the plan and returns its id.
    pub fn add_attachment(&mut self, attachment: Attachment) -> AttachmentId {
        let depth_bits = self.common.depth_bits.filter(|_| attachment.format.has_depth_aspect());
        self.plan.attachments.push(Attachment { depth_bits, ..attachment });
        AttachmentId(self.plan.attachments.len() - 1)
    }

    /// Adds a mesh to the plan and returns its id.
    pub fn add_mesh(&mut self, mesh: DrawMesh) -> MeshId {
        self.plan.meshes.push(mesh);
        MeshId(self.plan.meshes.len() - 1)
    }

    /// Returns the id of a material's texture in the plan, adding it unless the plan has the same one.
    pub(super) fn add_texture(&mut self, texture: &MaterialTexture) -> TextureId {
        let wanted = PlanTexture { picture: texture.picture.clone(), clamps: texture.clamps };
        let textures = &mut self.plan.textures;
        let known = textures.iter().position(|texture| *texture == wanted);
        TextureId(known.unwrap_or_else(|| {
            textures.push(wanted);
            textures.len() - 1
        }))
    }

    /// Records in the plan that `of` is left out by `decision`, with the reason.
    pub fn leave_out(&mut self, decision: Decision, of: impl Into<String>, because: impl Into<String>) {
        self.plan.left_out.push(LeftOut::new(decision, of, because));
    }

    /// Returns by how many metres the object `index` lies wholly beyond the light's range; `None` where some of it may
    /// be within, or the light has no range or is directional.
    pub fn beyond_range(&self, light: LightId, index: usize) -> Option<f64> {
        let (place, range) = self.range_of(light)?;
        geometry::beyond_range(&self.placed[index].world, place, range, self.eye())
    }

    /// Returns the world-space box that contains everything within a light's range; `None` for a light without a range.
    pub fn reached(&self, light: LightId) -> Option<AxisBox> {
        let (place, range) = self.range_of(light)?;
        Some(geometry::reached(place, range, self.eye()))
    }

    /// Returns a point light's world position and its range in metres; `None` for a light without a range, or a
    /// directional one.
    fn range_of(&self, light: LightId) -> Option<(DVec3, f64)> {
        let light = &self.job.scene.lights[light.0];
        Some(light.position.truncate()).zip(light.range.filter(|_| !light.is_directional()))
    }

    /// Returns the finished plan. Techniques are written for reversed depth: this reverses depth tests and clear values
    /// where another mapping is set, and decides which draws are not clipped by depth.
    pub fn finish(mut self) -> FramePlan {
        let mapping = self.plan.depth.mapping;
        let camera = &self.job.scene.camera;
        let area = camera.viewport_in(self.job.size).map(|pixels| pixels as f32);
        let range = self.plan.depth.range.map_or([0.0, 1.0], |range| range.stored.map(|depth| depth as f32));
        // Maps have depths and places of their own.
        for pass in self.plan.picture_passes_mut().filter(|pass| !pass.draws.is_empty()) {
            // What is counted from elsewhere is, whatever its depth.
            let depth = if pass.view == ViewId(0) { range } else { [0.0, 1.0] };
            let viewport = Viewport { area, depth };
            pass.viewport = Some(viewport).filter(|viewport| *viewport != Viewport::whole(self.job.size));
        }
        for pass in &mut self.plan.passes {
            let target = pass.depth_stencil.as_mut();
            if let Some(clear) = target.and_then(|target| target.clear_depth.as_mut()) {
                *clear = mapping.clear_depth();
            }
            let is_of_camera = pass.view == ViewId(0);
            for draw in &mut pass.draws {
                // For a perspective camera, a volume that counts in front and is not clipped at the near plane ends at
                // the eye; for a parallel one, nowhere.
                let is_of_these = self.plan.depth.is_linear && draw.part.is_of_volume() && !draw.raster.unclipped_depth;
                let is_in_front = self.clips_volumes || is_of_these;
                let is_unclipped = match self.plan.depth.keeps_volumes() {
                    // Light caps are clipped as the surfaces that they coincide with.
                    true => draw.raster.unclipped_depth && !draw.part.includes(DrawPart::LightCap),
                    false => mapping.clamps() && !(is_in_front && draw.part != DrawPart::Surface),
                };
                draw.raster.unclipped_depth = is_of_camera && is_unclipped;
                if !mapping.is_reversed() {
                    draw.raster = draw.raster.clone().for_standard_depth();
                }
            }
        }
        self.plan
    }
}
