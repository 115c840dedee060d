//! The passes that techniques share: ambient, light and mask, and what techniques add between them.

use super::{FrameBuilder, SurfaceDrawing, SurfacePiece};
use crate::geometry::{self, RangeInView};
use crate::numbers;
use crate::plan::{
    Attachment, AttachmentRole, ColorTarget, ColorWrite, Decision, DepthStencilTarget, Draw, DrawConstants, DrawPart,
    LightId, Pass, Program, RasterState, ViewId, Visibility,
};
use crate::scene::{Material, Object};
use crate::truth::{BACKGROUND as BACKGROUND_LABEL, LIT};
use glam::DVec3;
use wgpu_types::TextureFormat;

/// Linear colour of pixels that show no surface.
const BACKGROUND: [f64; 4] = [0.007, 0.008, 0.012, 1.0];

impl FrameBuilder<'_> {
    /// Returns a drawing that adds the light of the pass it is put into, without a shadow test. With a stencil buffer
    /// it draws only where the stencil is 0 and increments it, so that coinciding surfaces are lit once at each pixel.
    pub fn light_everywhere(&self) -> SurfaceDrawing {
        let once = SurfaceDrawing::light_once_where_zero(0xff);
        if self.has_stencil {
            once
        } else {
            SurfaceDrawing { raster: RasterState::visible_surface(ColorWrite::Add), ..once }
        }
    }

    /// Returns a drawing that adds the share of a light that arrives, which the shader finds as `how` says.
    pub fn light_by(&self, how: Visibility) -> SurfaceDrawing {
        SurfaceDrawing { program: Program::Light(how), ..self.light_everywhere() }
    }

    /// Returns a drawing that multiplies the picture, where surfaces are visible, by what one layer of a light's
    /// texture lets through. The caller sets the layer of its draws.
    pub fn darken_through(&self) -> SurfaceDrawing {
        let raster = RasterState::visible_surface(ColorWrite::Multiply);
        SurfaceDrawing { program: Program::Through, raster, label: LIT.into() }
    }

    /// Adds a pass of a light that writes the stencil alone, tested against the camera's depth. The first such pass of
    /// a light clears the stencil if another light wrote it.
    pub fn stencil_pass(&mut self, light: LightId, name: &str, purpose: &str, draws: Vec<Draw>) {
        self.stencil_pass_from(0, light, name, purpose, draws);
    }

    /// Adds a pass that writes the stencil alone, which begins at `start`. With 0 it is cleared only where another
    /// light has written it, or where clears may not be left out; one that is left out is recorded in the plan.
    pub fn stencil_pass_from(&mut self, start: u8, light: LightId, name: &str, purpose: &str, draws: Vec<Draw>) {
        let is_untouched = self.stencil_of.is_none();
        let is_cleared = start != 0 || (is_untouched && !self.common.allows(Decision::Clear));
        if is_untouched && !is_cleared {
            self.leave_out(Decision::Clear, light.name(), "nothing has written the stencil before");
        }
        self.push_pass(light, name, purpose, None, draws);
        let target = self.plan.passes.last_mut().and_then(|pass| pass.depth_stencil.as_mut());
        if let Some(target) = target.filter(|_| is_cleared) {
            target.clear_stencil = Some(start);
        }
    }

    /// Adds a timed pass of a light from the camera's view, limited to the light's scissor. It clears the stencil to 0
    /// if another light wrote it, and counts as having written it itself.
    fn push_pass(&mut self, light: LightId, name: &str, purpose: &str, color: Option<ColorTarget>, draws: Vec<Draw>) {
        let depth_stencil = self.depth_stencil_of(light);
        self.stencil_of = Some(light);
        self.plan.passes.push(Pass {
            name: name.to_owned(),
            image: None,
            viewport: None,
            recorded: None,
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

    /// Returns the picture as a colour target that is not cleared.
    fn stored_color(&self) -> ColorTarget {
        ColorTarget { attachment: self.color, layer: 0, clear: None }
    }

    /// Adds a float attachment of the picture's size in which a light's shadow volumes are counted, and sets it as the
    /// light's count.
    pub fn add_count(&mut self, light: LightId) {
        let count = self.add_attachment(Attachment {
            name: format!("{} count", light.name()),
            role: AttachmentRole::Count(light),
            format: TextureFormat::R32Float,
            size: self.job.size,
            layers: 1,
            depth_bits: None,
        });
        self.plan.lights[light.0].count = Some(count);
    }

    /// Adds a pass that adds to a light's float count, tested against the camera's depth. The light's first such pass
    /// clears the count to `start`, later ones don't. Adds nothing where the light has no float count.
    pub fn count_pass(&mut self, start: u32, light: LightId, name: &str, purpose: &str, draws: Vec<Draw>) {
        let Some(attachment) = self.plan.lights[light.0].count else { return };
        let is_same = |pass: &Pass| pass.color.as_ref().is_some_and(|target| target.attachment == attachment);
        let is_first = !self.plan.passes.iter().any(is_same);
        let target = ColorTarget { attachment, layer: 0, clear: is_first.then_some([f64::from(start), 0.0, 0.0, 0.0]) };
        self.push_pass(light, name, purpose, Some(target), draws);
    }

    /// Adds the first pass of the picture: clears colour, depth and stencil, and draws the depth of all surfaces and
    /// their colour in ambient light. A pass for each light follows where a share of its diffuse light belongs to that.
    pub fn ambient_pass(&mut self) {
        // Clamped depth lets through what lies between eye and near plane.
        let from_near = self.common.depth.clamps();
        let drawn = SurfaceDrawing {
            program: Program::Ambient { from_near },
            raster: RasterState::surface(),
            label: LIT.into(),
        };
        let draws = self.surface_draws(|_| Some(&drawn));
        let purpose = "Draws every surface in ambient light only, and leaves in the depth buffer how far the nearest \
                       one is: all later passes ask about that surface.";
        self.plan.passes.push(Pass {
            name: "ambient".to_owned(),
            image: None,
            viewport: None,
            recorded: None,
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
        if self.common.ambient_diffuse > 0.0 {
            self.light_ids().for_each(|light| self.ambient_diffuse_pass(light));
        }
    }

    /// Adds the pass that adds the share of a light's diffuse light that arrives whatever stands between.
    fn ambient_diffuse_pass(&mut self, light: LightId) {
        let coincide = self.surfaces_coincide();
        let raster = match coincide {
            true => self.light_everywhere().raster,
            false => RasterState::visible_surface(ColorWrite::Add),
        };
        let drawn = SurfaceDrawing { program: Program::AmbientDiffuse, raster, label: LIT.into() };
        let draws = self.surface_draws(|_| Some(&drawn));
        let purpose = "Adds a share of the light's diffuse light to every surface that faces it, whatever stands between: \
                       shadows keep some of the shape of what they fall on.";
        let before = self.stencil_of;
        self.push_pass(light, "ambient diffuse", purpose, Some(self.stored_color()), draws);
        // Where surfaces coincide their mark is in the stencil, and whoever is next clears it, the same light too.
        self.stencil_of = if coincide { Some(LightId(usize::MAX)) } else { before };
    }

    /// Adds the pass that adds a light's diffuse and specular light to visible surfaces: receivers are drawn as
    /// `shadowed` says, other objects are lit without shadows.
    pub fn light_pass(&mut self, light: LightId, purpose: &str, shadowed: &SurfaceDrawing) {
        let unshadowed = SurfaceDrawing {
            program: Program::Light(Visibility::Everywhere),
            raster: RasterState::visible_surface(ColorWrite::Add),
            label: LIT.into(),
        };
        let look = |object: &Object| Some(if object.receives { shadowed } else { &unshadowed });
        let draws = match &self.lit {
            Some(lit) => self.draws_of(lit, look),
            None => self.surface_draws(look),
        };
        self.push_pass(light, "light", purpose, Some(self.stored_color()), draws);
    }

    /// Adds a light's mask pass and light pass, where the shader finds as `how` says whether the light arrives.
    pub fn mask_and_light_passes(&mut self, light: LightId, how: Visibility, purpose: &str) {
        self.mask_pass(light, &[SurfaceDrawing::lit_by(how)]);
        self.light_pass(light, purpose, &self.light_by(how));
    }

    /// Adds a pass that blends draws over the picture; it tests depth, and changes it as little as the draws say.
    pub fn blend_pass(&mut self, light: LightId, name: &str, purpose: &str, draws: Vec<Draw>) {
        self.push_pass(light, name, purpose, Some(self.stored_color()), draws);
    }

    /// Adds the pass that writes each pixel's label of the light (lit or in shadow) for measuring accuracy; later
    /// layers overwrite earlier ones. Draws and triangles run in reverse, so that of surfaces at one depth the first
    /// drawn decides here too. Where the shader may find a share of the light between none and all, its visibility pass
    /// follows.
    pub fn mask_pass(&mut self, light: LightId, layers: &[SurfaceDrawing]) {
        self.mask_pass_with(light, layers, Vec::new());
        let knows_shares = |layer: &SurfaceDrawing| {
            layer.program.visibility().is_some_and(|how| self.plan.lights[light.0].knows_shares(how))
        };
        if layers.iter().any(knows_shares) {
            self.visibility_pass(light);
        }
    }

    /// Adds a mask pass ([`FrameBuilder::mask_pass`]) with the draws `over` after its surfaces. Objects that receive
    /// nothing are labelled as lit, in the first layer.
    pub fn mask_pass_with(&mut self, light: LightId, layers: &[SurfaceDrawing], over: Vec<Draw>) {
        let mut draws = Vec::new();
        let unshadowed = SurfaceDrawing::lit();
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
            viewport: None,
            recorded: None,
            scissor: None,
            purpose: purpose.to_owned(),
            light: Some(light),
            timed: false,
            view: ViewId(0),
            color: Some(ColorTarget {
                attachment: self.plan.lights[light.0].labels,
                layer: 0,
                clear: Some([BACKGROUND_LABEL.into(), 0.0, 0.0, 0.0]),
            }),
            depth_stencil: Some(self.depth_stencil_of(light)),
            draws,
        });
    }

    /// Adds the pass that writes which share of the light arrives at each pixel, with the draws of the mask pass before
    /// it.
    fn visibility_pass(&mut self, light: LightId) {
        let Some(mask) = self.plan.passes.last() else { return };
        let arriving = |draw: &Draw| match draw.program {
            Program::Label(how) => Draw { program: Program::Arriving(how), ..draw.clone() },
            _ => draw.clone(),
        };
        let draws = mask.draws.iter().map(arriving).collect();
        let attachment = self.add_attachment(Attachment {
            name: format!("{} visibility", light.name()),
            role: AttachmentRole::Visibility(light),
            format: TextureFormat::R32Float,
            size: self.job.size,
            layers: 1,
            depth_bits: None,
        });
        self.plan.lights[light.0].visibility = Some(attachment);
        let purpose = "Writes which share of the light arrives at every pixel, from 0 (dark) to 1 (lit): between them lie \
                       soft edges, and what a filter mixes in. It is not part of the frame; by it the error of \
                       partly dark pixels is counted, too.";
        self.plan.passes.push(Pass {
            name: "visibility".to_owned(),
            image: None,
            viewport: None,
            recorded: None,
            scissor: None,
            purpose: purpose.to_owned(),
            light: Some(light),
            timed: false,
            view: ViewId(0),
            color: Some(ColorTarget { attachment, layer: 0, clear: Some([0.0; 4]) }),
            depth_stencil: Some(self.depth_stencil_of(light)),
            draws,
        });
    }

    /// Returns draws that darken visible receivers by one layer of the light's texture. Pieces whose own layer that is
    /// are left out: a silhouette does not fall on its caster.
    pub fn draws_through(&self, layer: usize) -> Vec<Draw> {
        let drawn = self.darken_through();
        let mut draws = self.surface_draws(|object| object.receives.then_some(&drawn));
        draws.retain(|draw| draw.constants.layer != Some(layer as u32));
        draws.iter_mut().for_each(|draw| draw.constants.layer = Some(layer as u32));
        draws
    }

    /// Returns a draw for each piece of every visible object, in the way that `look` returns for the object; skips
    /// objects for which it returns `None`.
    fn surface_draws<'d>(&self, look: impl Fn(&Object) -> Option<&'d SurfaceDrawing>) -> Vec<Draw> {
        self.draws_of(&self.pieces, look)
    }

    fn draws_of<'d>(&self, pieces: &[SurfacePiece], look: impl Fn(&Object) -> Option<&'d SurfaceDrawing>) -> Vec<Draw> {
        let draw = |piece: &SurfacePiece| {
            let object = self.placed[piece.object].object;
            let drawn = look(object)?;
            let material = self.material_under(drawn.program, piece.material);
            let layer = piece.layer;
            Some(Draw {
                name: piece.name.clone(),
                caster: Some(object.name.clone()),
                part: DrawPart::Surface,
                program: drawn.program,
                raster: drawn.raster.clone(),
                mesh: piece.mesh,
                triangles: piece.triangles.clone(),
                base_vertex: 0,
                pieces: None,
                faces_inwards: false,
                constants: DrawConstants {
                    material,
                    label: drawn.label,
                    layer,
                    checks_from: checks_from(self.eye(), material.checks),
                    texture: piece.texture.filter(|_| drawn.program.shows_texture()),
                    ..DrawConstants::default()
                },
                samples_maps_of: Vec::new(),
            })
        };
        pieces.iter().filter_map(draw).collect()
    }

    /// Returns a material as a program of a light sees it: what arrives whatever stands between and what is asked about are
    /// shares of its diffuse light, and highlights are asked about.
    fn material_under(&self, program: Program, material: Material) -> Material {
        let share = self.common.ambient_diffuse;
        let times = |share: f32| material.color.map(|part| part * share);
        match program {
            Program::AmbientDiffuse => Material { color: times(share), specular: 0.0, ..material },
            Program::Light(_) if share > 0.0 => Material { color: times(1.0 - share), ..material },
            _ => material,
        }
    }

    /// Returns the picture's depth-stencil target for a pass of `light`: depth is kept; the stencil, if there is one,
    /// is cleared to 0 if another light wrote it last.
    fn depth_stencil_of(&self, light: LightId) -> DepthStencilTarget {
        let is_of_another = self.stencil_of.is_some_and(|other| other != light);
        let clear_stencil = (self.has_stencil && is_of_another).then_some(0);
        DepthStencilTarget { attachment: self.depth_stencil, layer: 0, clear_depth: None, clear_stencil }
    }

    /// Computes the scissor rectangle of every point light with a range: the pixels it can reach; later passes use it.
    /// Returns, for each light, whether it reaches no pixel.
    pub fn cut_to_ranges(&mut self) -> Vec<bool> {
        let scene = self.job.scene;
        let mut misses = vec![false; scene.lights.len()];
        self.scissors = vec![None; scene.lights.len()];
        for id in self.light_ids() {
            let Some((place, range)) = self.range_of(id) else { continue };
            if !self.common.allows(Decision::Scissor) {
                continue;
            }
            match geometry::range_in_view(&scene.camera, self.job.size, place, range) {
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
}

/// Returns [`DrawConstants::checks_from`]: the eye's x and z modulo two checks of the size `checks`, metres, small
/// enough for single precision; zero without checks.
fn checks_from(eye: DVec3, checks: f32) -> [f32; 2] {
    let pair = f64::from(checks) * 2.0;
    if pair > 0.0 { [eye.x, eye.z].map(|at| at.rem_euclid(pair) as f32) } else { [0.0; 2] }
}
