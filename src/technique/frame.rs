//! What all techniques share: the camera, surfaces, and the ambient, light and mask passes.
//!
//! A technique starts a [`Frame`], adds its own passes between `ambient_pass` and, for each
//! light, `mask_pass` and `light_pass`, and finishes it into a plan.

use super::{Choice, CommonSettings, PlanError, surfaces};
use crate::geometry::{self, GeometryCache, RangeInView, relative};
use crate::math::depth::{DepthCurve, DepthMapping};
use crate::math::projection;
use crate::numbers;
use crate::plan::{
    Attachment, AttachmentId, AttachmentRole, ColorTarget, ColorWrite, DecidedBy, Decision, DepthStencilTarget, Draw,
    DrawConstants, DrawMesh, FramePlan, LeftOut, LightId, MeshId, Part, Pass, PlanLight, PlanView, Program,
    RasterState, StencilFace, ViewId, Visibility,
};
use crate::scene::{Material, Object, Scene};
use glam::{DMat4, DVec3};
use std::ops::Range;
use wgpu::{CompareFunction, StencilOperation, TextureFormat};

/// Linear colour of pixels that show no surface.
const BACKGROUND: [f64; 4] = [0.007, 0.008, 0.012, 1.0];
/// Beyond it, products of single-precision coordinates overflow.
const MOST_DISTANCE: f64 = 1e18;
/// Lights are bits of one word a triangle; the last bit is taken.
pub const MOST_LIGHTS: usize = 31;

/// Room behind the farthest surface for a far plane that the scene does not give.
const FAR_MARGIN: f64 = 1.01;

const LIT: u32 = 0;
const SHADOW: u32 = 1;
const BACKGROUND_LABEL: f64 = 2.0;

/// What a technique is asked for.
#[derive(Debug)]
pub struct Job<'a> {
    /// At one moment.
    pub scene: &'a Scene,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Technique and settings.
    pub choice: &'a Choice,
    /// Kept between plans.
    pub cache: &'a mut GeometryCache,
}

/// An object with its vertices in world space and its drawn surface.
#[derive(Debug)]
pub struct Placed<'a> {
    /// As the scene has it.
    pub object: &'a Object,
    /// Welded, world space.
    pub world: Vec<DVec3>,
    /// `None` for what is not drawn.
    pub surface: Option<MeshId>,
}

/// A part of a visible surface that is drawn by itself: one group of an object, or less.
#[derive(Debug, Clone)]
pub struct Piece {
    /// For people: the object, and which of its groups.
    pub name: String,
    /// Index into [`Frame::placed`].
    pub object: usize,
    /// Of its surface.
    pub material: Material,
    /// The mesh that it is a part of.
    pub mesh: MeshId,
    /// Which triangles of the mesh's index list.
    pub triangles: Range<u32>,
    /// The layer of each light's map that is its own.
    pub layer: Option<u32>,
}

/// A plan in the making: objects and lights are placed, and passes are added in the order in which they run.
#[derive(Debug)]
pub struct Frame<'a> {
    /// What is asked for.
    pub job: Job<'a>,
    /// The job's settings that every technique has.
    pub common: CommonSettings,
    /// Parallel to the scene's objects.
    pub placed: Vec<Placed<'a>>,
    /// All visible surfaces, in the order in which they are drawn.
    pub pieces: Vec<Piece>,
    /// Those that the next light's pass draws, where they are not all.
    pub lit: Option<Vec<Piece>>,
    /// What there is of the plan; passes of other kinds than the methods make are pushed here.
    pub plan: FramePlan,
    /// Clamped depth clips volumes at the near plane all the same: what counts in front of surfaces
    /// must not begin before them.
    pub clips_volumes: bool,
    color: AttachmentId,
    depth_stencil: AttachmentId,
    has_stencil: bool,
    /// The light whose passes have last written the stencil.
    stencil_of: Option<LightId>,
    /// By light: the pixels that its passes are cut to.
    scissors: Vec<Option<[u32; 4]>>,
}

/// How surfaces are drawn in a pass.
#[derive(Debug, Clone)]
pub struct Drawn {
    program: Program,
    raster: RasterState,
    /// What a label program writes.
    label: u32,
}

impl Drawn {
    /// Writes "lit" everywhere, or what a later layer says.
    pub fn lit() -> Drawn {
        Drawn::label(LIT)
    }

    /// Writes "in shadow" everywhere.
    pub fn shadow() -> Drawn {
        Drawn::label(SHADOW)
    }

    /// Writes "in shadow" where less than half of the light arrives.
    pub fn lit_by(how: Visibility) -> Drawn {
        Drawn { program: Program::Label(how), ..Drawn::label(LIT) }
    }

    fn label(label: u32) -> Drawn {
        let raster = RasterState::visible_surface(ColorWrite::Replace);
        Drawn { program: Program::Label(Visibility::Everywhere), raster, label }
    }

    /// Only where the masked stencil equals `reference`.
    pub fn where_stencil(mut self, read_mask: u32, reference: u8) -> Drawn {
        let equal = StencilFace { compare: CompareFunction::Equal, ..StencilFace::IGNORE };
        self.raster = self.raster.with_stencil(equal, reference);
        self.raster.stencil.read_mask = read_mask;
        self.raster.stencil.write_mask = 0;
        self
    }

    /// Adds light where the masked stencil is zero, and raises it there, so that of surfaces at one
    /// depth only the first is lit.
    pub fn light_once_where_zero(read_mask: u32) -> Drawn {
        let once = StencilFace {
            compare: CompareFunction::Equal,
            pass_op: StencilOperation::IncrementClamp,
            ..StencilFace::IGNORE
        };
        let mut raster = RasterState::visible_surface(ColorWrite::Add).with_stencil(once, 0);
        raster.stencil.read_mask = read_mask;
        Drawn { program: Program::Light(Visibility::Everywhere), raster, label: LIT }
    }
}

/// What a technique wants of the stencil buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StencilUse {
    /// It counts or marks.
    Always,
    /// Nothing, but where surfaces coincide it keeps them from being lit twice.
    ToLightOnce,
}

impl<'a> Frame<'a> {
    /// Places objects and lights, and makes the attachments.
    ///
    /// # Errors
    /// A camera, light or object that can't be drawn, or too many lights.
    pub fn new(job: Job<'a>, stencil: StencilUse) -> Result<Frame<'a>, PlanError> {
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
            attachments: Vec::new(),
            views: Vec::new(),
            lights: Vec::new(),
            ambient: scene.ambient,
            meshes: Vec::new(),
            passes: Vec::new(),
            left_out: Vec::new(),
        };
        let no_target = AttachmentId(0);
        let mut frame = Frame {
            placed: Vec::new(),
            pieces: Vec::new(),
            lit: None,
            plan,
            clips_volumes: false,
            color: no_target,
            depth_stencil: no_target,
            has_stencil: stencil == StencilUse::Always || !common.allows(Decision::Stencil),
            stencil_of: None,
            scissors: Vec::new(),
            common,
            job,
        };
        frame.place_objects()?;
        frame.plan.depth = frame.depth_curve();
        frame.plan.views.push(camera_view(scene, frame.job.size, &frame.plan.depth));
        // Looking at every triangle pays only where it decides something.
        frame.has_stencil = frame.has_stencil || surfaces::coincide(&frame.placed);
        frame.add_attachments();
        frame.add_lights()?;
        Ok(frame)
    }

    /// The eye, world space: what every vertex of the camera's passes is relative to.
    pub fn eye(&self) -> DVec3 {
        self.job.scene.camera.eye
    }

    /// The lights in order.
    pub fn light_ids(&self) -> impl Iterator<Item = LightId> + use<> {
        (0..self.job.scene.lights.len()).map(LightId)
    }

    /// Homogeneous world position of a light.
    pub fn light_position(&self, light: LightId) -> glam::DVec4 {
        self.job.scene.lights[light.0].homogeneous()
    }

    /// Light added everywhere, or only once to each pixel where surfaces coincide.
    pub fn light_everywhere(&self) -> Drawn {
        let once = Drawn::light_once_where_zero(0xff);
        if self.has_stencil { once } else { Drawn { raster: RasterState::visible_surface(ColorWrite::Add), ..once } }
    }

    /// The same, as far as it arrives.
    pub fn light_by(&self, how: Visibility) -> Drawn {
        Drawn { program: Program::Light(how), ..self.light_everywhere() }
    }

    /// Darkens what is visible by one layer of a light's map.
    pub fn darken_through(&self) -> Drawn {
        let raster = RasterState::visible_surface(ColorWrite::Multiply);
        Drawn { program: Program::Through, raster, label: LIT }
    }

    /// Adds an attachment.
    pub fn add_attachment(&mut self, attachment: Attachment) -> AttachmentId {
        self.plan.attachments.push(attachment);
        AttachmentId(self.plan.attachments.len() - 1)
    }

    /// Adds a mesh for draws.
    pub fn add_mesh(&mut self, mesh: DrawMesh) -> MeshId {
        self.plan.meshes.push(mesh);
        MeshId(self.plan.meshes.len() - 1)
    }

    /// Records that something is not needed.
    pub fn leave_out(&mut self, decision: Decision, of: impl Into<String>, because: impl Into<String>) {
        self.plan.left_out.push(LeftOut::new(decision, of, because));
    }

    /// A pass of a light into stencil alone, over the camera's depth. The first one of a light
    /// clears what the light before has left.
    pub fn stencil_pass(&mut self, light: LightId, name: &str, purpose: &str, draws: Vec<Draw>) {
        let is_untouched = self.stencil_of.is_none();
        let is_left_out = is_untouched && self.common.allows(Decision::Clear);
        if is_left_out {
            self.leave_out(Decision::Clear, light.name(), "nothing has written the stencil before");
        }
        self.push_pass(light, name, purpose, None, draws);
        let target = self.plan.passes.last_mut().and_then(|pass| pass.depth_stencil.as_mut());
        if let Some(target) = target.filter(|_| is_untouched && !is_left_out) {
            target.clear_stencil = Some(0);
        }
    }

    /// A timed pass of a light, seen by the camera. The first one of a light clears what another has left
    /// in the stencil.
    fn push_pass(&mut self, light: LightId, name: &str, purpose: &str, color: Option<ColorTarget>, draws: Vec<Draw>) {
        let depth_stencil = self.depth_stencil_of(light);
        self.stencil_of = Some(light);
        self.plan.passes.push(Pass {
            name: name.to_owned(),
            image: None,
            scissor: self.scissors.get(light.0).copied().flatten(),
            purpose: purpose.to_owned(),
            light: Some(light),
            timed: true,
            view: ViewId(0),
            color,
            depth_stencil: Some(depth_stencil),
            draws,
        });
    }

    /// The picture, as it is.
    fn kept_color(&self) -> ColorTarget {
        ColorTarget { attachment: self.color, layer: 0, clear: None }
    }

    /// Gives a light a float target to count its volumes in.
    pub fn add_count(&mut self, light: LightId) {
        let count = self.add_attachment(Attachment {
            name: format!("{} count", light.name()),
            role: AttachmentRole::Count(light),
            format: TextureFormat::R32Float,
            size: self.job.size,
            layers: 1,
        });
        self.plan.lights[light.0].count = Some(count);
    }

    /// A pass of a light that adds to its count, over the camera's depth. The first clears it.
    pub fn count_pass(&mut self, light: LightId, name: &str, purpose: &str, draws: Vec<Draw>) {
        let Some(attachment) = self.plan.lights[light.0].count else { return };
        let is_same = |pass: &Pass| pass.color.as_ref().is_some_and(|target| target.attachment == attachment);
        let is_first = !self.plan.passes.iter().any(is_same);
        let target = ColorTarget { attachment, layer: 0, clear: is_first.then_some([0.0; 4]) };
        self.push_pass(light, name, purpose, Some(target), draws);
    }

    /// Depth of all surfaces, and their colour under ambient light.
    pub fn ambient_pass(&mut self) {
        // Depth that is clamped lets through what lies between eye and near plane.
        let from_near = self.common.depth.clamps();
        let drawn = Drawn { program: Program::Ambient { from_near }, raster: RasterState::surface(), label: LIT };
        let draws = self.surface_draws(|_| Some(&drawn));
        let purpose = "Draws every surface in ambient light only, and leaves in the depth buffer how far the nearest \
                       one is: all later passes ask about that surface.";
        self.plan.passes.push(Pass {
            name: "ambient".to_owned(),
            image: None,
            scissor: None,
            purpose: purpose.to_owned(),
            light: None,
            timed: true,
            view: ViewId(0),
            color: Some(ColorTarget { attachment: self.color, layer: 0, clear: Some(BACKGROUND) }),
            depth_stencil: Some(DepthStencilTarget {
                attachment: self.depth_stencil,
                layer: 0,
                clear_depth: Some(0.0),
                clear_stencil: self.has_stencil.then_some(0),
            }),
            draws,
        });
    }

    /// Adds a light's diffuse and highlight to the surfaces already visible; `shadowed` says how on
    /// objects that receive shadows. The others are lit as if nothing stood between.
    pub fn light_pass(&mut self, light: LightId, purpose: &str, shadowed: &Drawn) {
        let unshadowed = Drawn {
            program: Program::Light(Visibility::Everywhere),
            raster: RasterState::visible_surface(ColorWrite::Add),
            label: LIT,
        };
        let look = |object: &Object| Some(if object.receives { shadowed } else { &unshadowed });
        let draws = match &self.lit {
            Some(lit) => self.draws_of(lit, look),
            None => self.surface_draws(look),
        };
        self.push_pass(light, "light", purpose, Some(self.kept_color()), draws);
    }

    /// From here on, passes of a lamp whose light ends somewhere are cut to the pixels that it can reach.
    /// `true` for the lights that reach none.
    pub fn cut_to_ranges(&mut self) -> Vec<bool> {
        let scene = self.job.scene;
        let mut misses = vec![false; scene.lights.len()];
        self.scissors = vec![None; scene.lights.len()];
        for id in self.light_ids() {
            let light = &scene.lights[id.0];
            let Some(range) = light.range.filter(|_| !light.is_directional()) else { continue };
            if !self.common.allows(Decision::Scissor) {
                continue;
            }
            match geometry::range_in_view(&scene.camera, self.job.size, light.position.truncate(), range) {
                RangeInView::All => {}
                RangeInView::Nothing => misses[id.0] = true,
                RangeInView::Pixels(pixels) => {
                    let [_, _, columns, rows] = pixels;
                    let because = format!(
                        "its light ends {} from it, which is within {columns}x{rows} pixels",
                        numbers::metres(range)
                    );
                    self.leave_out(Decision::Scissor, id.name(), because);
                    self.scissors[id.0] = Some(pixels);
                }
            }
        }
        misses
    }

    /// By how many metres an object lies beyond the light's range.
    pub fn beyond_range(&self, light: LightId, index: usize) -> Option<f64> {
        let light = &self.job.scene.lights[light.0];
        let range = light.range.filter(|_| !light.is_directional())?;
        geometry::beyond_range(&self.placed[index].world, light.position.truncate(), range, self.eye())
    }

    /// Blends draws over the picture, and tests depth and stencil without changing them.
    pub fn blend_pass(&mut self, light: LightId, name: &str, purpose: &str, draws: Vec<Draw>) {
        self.push_pass(light, name, purpose, Some(self.kept_color()), draws);
    }

    /// Writes the light's labels, later layers over earlier ones. Triangles and draws run in
    /// reverse, so that of surfaces at one depth the first drawn decides here too.
    pub fn mask_pass(&mut self, light: LightId, layers: &[Drawn]) {
        self.mask_pass_with(light, layers, Vec::new());
    }

    /// The same, and after the surfaces `over` them.
    pub fn mask_pass_with(&mut self, light: LightId, layers: &[Drawn], over: Vec<Draw>) {
        let mut draws = Vec::new();
        let unshadowed = Drawn::lit();
        for (index, layer) in layers.iter().enumerate() {
            let mut of_layer = self.surface_draws(|object| match (object.receives, index) {
                (true, _) => Some(layer),
                (false, 0) => Some(&unshadowed),
                (false, _) => None,
            });
            of_layer.reverse();
            draws.extend(of_layer);
        }
        draws.extend(over);
        let purpose = "Writes what this technique says of the light at every pixel: lit, in shadow, or facing away. \
                       It is not part of the frame; it is how techniques are compared.";
        self.plan.passes.push(Pass {
            name: "mask".to_owned(),
            image: None,
            scissor: None,
            purpose: purpose.to_owned(),
            light: Some(light),
            timed: false,
            view: ViewId(0),
            color: Some(ColorTarget {
                attachment: self.plan.lights[light.0].labels,
                layer: 0,
                clear: Some([BACKGROUND_LABEL, 0.0, 0.0, 0.0]),
            }),
            depth_stencil: Some(self.depth_stencil_of(light)),
            draws,
        });
    }

    /// What is visible and receives, darkened by one layer of the light's map; but the layer's own pieces.
    pub fn draws_through(&self, layer: usize) -> Vec<Draw> {
        let drawn = self.darken_through();
        let mut draws = self.surface_draws(|object| object.receives.then_some(&drawn));
        draws.retain(|draw| draw.constants.layer != Some(layer as u32));
        draws.iter_mut().for_each(|draw| draw.constants.layer = Some(layer as u32));
        draws
    }

    /// One draw a piece of every visible object, as `look` says for the object.
    fn surface_draws<'d>(&self, look: impl Fn(&Object) -> Option<&'d Drawn>) -> Vec<Draw> {
        self.draws_of(&self.pieces, look)
    }

    fn draws_of<'d>(&self, pieces: &[Piece], look: impl Fn(&Object) -> Option<&'d Drawn>) -> Vec<Draw> {
        let draw = |piece: &Piece| {
            let object = self.placed[piece.object].object;
            let drawn = look(object)?;
            let (material, layer) = (piece.material, piece.layer);
            Some(Draw {
                name: piece.name.clone(),
                caster: Some(object.name.clone()),
                part: Part::Surface,
                program: drawn.program,
                raster: drawn.raster.clone(),
                mesh: piece.mesh,
                triangles: piece.triangles.clone(),
                base_vertex: 0,
                faces_inwards: false,
                constants: DrawConstants { material, label: drawn.label, layer, ..DrawConstants::default() },
            })
        };
        pieces.iter().filter_map(draw).collect()
    }

    /// The picture's depth-stencil target for a pass of `light`: what another light has left in the
    /// stencil is cleared.
    fn depth_stencil_of(&self, light: LightId) -> DepthStencilTarget {
        let is_of_another = self.stencil_of.is_some_and(|other| other != light);
        let clear_stencil = (self.has_stencil && is_of_another).then_some(0);
        DepthStencilTarget { attachment: self.depth_stencil, layer: 0, clear_depth: None, clear_stencil }
    }

    /// How depth is stored, as the settings say. Without a far plane of its own, the camera's is put
    /// behind the farthest surface.
    fn depth_curve(&self) -> DepthCurve {
        let camera = &self.job.scene.camera;
        let ahead = (camera.target - camera.eye).normalize_or_zero();
        let drawn = self.placed.iter().filter(|placed| placed.surface.is_some()).flat_map(|placed| &placed.world);
        let farthest = drawn.map(|position| (*position - camera.eye).dot(ahead)).fold(camera.near * 2.0, f64::max);
        let far = camera.far.unwrap_or(farthest * FAR_MARGIN);
        self.common.depth.curve(camera.near, far, self.common.epsilon)
    }

    /// The plan. Techniques are written for reversed depth: this turns it round where another is set.
    pub fn finish(mut self) -> FramePlan {
        let mapping = self.plan.depth.mapping;
        for pass in &mut self.plan.passes {
            let target = pass.depth_stencil.as_mut();
            if let Some(clear) = target.and_then(|target| target.clear_depth.as_mut()) {
                *clear = mapping.clear_depth();
            }
            let is_of_camera = pass.view == ViewId(0);
            for draw in &mut pass.draws {
                let is_clipped = self.clips_volumes && draw.part != Part::Surface;
                draw.raster.unclipped_depth = is_of_camera && mapping.clamps() && !is_clipped;
                if !mapping.is_reversed() {
                    draw.raster = draw.raster.clone().for_standard_depth();
                }
            }
        }
        self.plan
    }

    fn add_attachments(&mut self) {
        let size = self.job.size;
        self.color = self.add_attachment(Attachment {
            name: "color".to_owned(),
            role: AttachmentRole::Color,
            format: TextureFormat::Rgba8UnormSrgb,
            size,
            layers: 1,
        });
        let (name, format) = match self.has_stencil {
            true => ("depth and stencil", TextureFormat::Depth32FloatStencil8),
            false => ("depth", TextureFormat::Depth32Float),
        };
        if !self.has_stencil {
            let because = "this technique counts and marks nothing, and no two triangles coincide";
            self.leave_out(Decision::Stencil, "the frame", because);
        }
        let role = AttachmentRole::DepthStencil;
        self.depth_stencil = self.add_attachment(Attachment { name: name.to_owned(), role, format, size, layers: 1 });
    }

    fn add_lights(&mut self) -> Result<(), PlanError> {
        for (light, id) in self.job.scene.lights.iter().zip(self.light_ids()) {
            light.check().map_err(|problem| PlanError::Unusable { problem: problem.to_owned() })?;
            let labels = self.add_attachment(Attachment {
                name: format!("{} labels", id.name()),
                role: AttachmentRole::Labels(id),
                format: TextureFormat::R8Uint,
                size: self.job.size,
                layers: 1,
            });
            let relative_position = relative::homogeneous(light.homogeneous(), self.eye());
            if !relative_position.iter().all(|component| component.is_finite()) {
                let problem = format!("{} is too far from the eye for single precision", id.name());
                return Err(PlanError::Unusable { problem });
            }
            let color = light.color.map(|channel| channel * light.intensity);
            let range = light.range.map(|range| range as f32);
            self.plan.lights.push(PlanLight {
                relative_position,
                color,
                range,
                decided_by: DecidedBy::Nothing,
                map: None,
                count: None,
                labels,
            });
        }
        Ok(())
    }

    fn place_objects(&mut self) -> Result<(), PlanError> {
        for object in &self.job.scene.objects {
            let world = object.world_positions();
            let is_usable = |position: &DVec3| (*position - self.eye()).abs().max_element() <= MOST_DISTANCE;
            if !world.iter().all(is_usable) {
                let problem = format!("{} is too large or too far from the eye for single precision", object.name);
                return Err(PlanError::Unusable { problem });
            }
            let drawn = object.visible && !object.mesh.triangles().is_empty();
            let surface = drawn.then(|| self.add_mesh(surfaces::draw_mesh(object, &world, self.job.scene)));
            self.pieces.extend(surface.into_iter().flat_map(|mesh| pieces_of(object, self.placed.len(), mesh)));
            self.placed.push(Placed { object, world, surface });
        }
        Ok(())
    }
}

/// One piece a group.
fn pieces_of(object: &Object, index: usize, mesh: MeshId) -> impl Iterator<Item = Piece> {
    object.mesh.groups().iter().map(move |group| Piece {
        name: match group.name.as_str() {
            "" => object.name.clone(),
            group => format!("{} · {group}", object.name),
        },
        object: index,
        material: group.material.unwrap_or(object.material),
        mesh,
        triangles: group.triangles.start as u32..group.triangles.end as u32,
        layer: None,
    })
}

fn camera_view(scene: &Scene, size: [u32; 2], depth: &DepthCurve) -> PlanView {
    let camera = &scene.camera;
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let clip_from_view = projection::perspective(camera.fov_y_degrees, aspect, depth);
    let rotation = projection::view_from_world_rotation(camera.target - camera.eye, camera.up);
    let clip_from_relative = (clip_from_view * DMat4::from_mat3(rotation)).as_mat4();
    PlanView { name: "camera".to_owned(), origin: camera.eye, clip_from_relative }
}
