//! A caster's volume as a mesh and draws: sides, light cap and dark cap, each range of triangles with its own
//! operations.

use super::counting::{CountedPart, CountingMode, FaceSelection, VolumeSpec};
use super::far_count::FarPoint;
use crate::geometry::{CapFan, Caster, Casters, DarkCap, Extruder, Extrusion, VolumeParts, VolumeRequest, relative};
use crate::math::{DepthBits, Sign, side_of_triangle};
use crate::numbers;
use crate::plan::{Decision, Draw, DrawConstants, DrawMesh, DrawPart, LeftOut, LightId, MeshId, Program, RasterState};
use crate::technique::casters::{self, DarkenedObjects};
use crate::technique::frame::FrameBuilder;
use crate::technique::settings::VolumeSettings;
use glam::{DVec3, DVec4};
use std::ops::Range;
use wgpu_types::FrontFace;

/// Depths of so many bits have steps like those of a float near 1; of fewer, steps longer than any rounding.
const FINE_BITS: DepthBits = DepthBits::TWENTY_FOUR;

/// What replaces the dark cap of an infinite volume where view rays are parallel: a number that the count begins at.
#[derive(Debug, Clone, Copy)]
pub struct ParallelFarEnd {
    /// How many casting triangles the ray from the light along the view direction hits: so many volumes contain the far
    /// end.
    pub count: u32,
    /// How far beside the light lies the point that far vertices are carried away from: metres, or radians for a
    /// directional light; 0 at the light itself.
    pub beside: f64,
    /// Whether the light is a point light.
    pub is_point: bool,
}

/// A caster's volume, with all that its draws are made from.
pub struct VolumePlan {
    /// Index of its caster in [`FrameBuilder::placed`].
    pub object: usize,
    pub caster: String,
    pub counting: CountingMode,
    /// Whether the caster is a body that is proven closed, of which only light-facing triangles cast.
    pub is_body: bool,
    /// Whether the volume is wound the other way round than it is in the world: of a mirrored object whose mesh's winding
    /// is kept. Never of a parallel camera, whose counts begin at numbers instead of caps.
    pub is_wound_backwards: bool,
    /// Whether no receiver is behind the caster, so that the volume's count is 0 at each.
    pub darkens_nothing: bool,
    pub mesh: MeshId,
    pub casting: CastingTriangles,
    /// The parts that the counting pass draws.
    pub needed: Vec<CountedPart>,
    /// Whether a light cap and a dark cap that would count are left out by the settings, in this order.
    pub lacks_caps: [bool; 2],
    /// The number that this volume adds to the start of the count, where no dark cap is drawn for it; otherwise 0.
    pub begins_with: u32,
}

/// Which triangles of a volume's caster cast.
#[derive(Debug, Clone)]
pub enum CastingTriangles {
    /// Ranges of triangles of the volume's mesh: those that face the light, then those that were flipped to face it.
    Runs([Range<usize>; 2]),
    /// The rule by which the vertex shader chooses them from all triangles of the caster.
    Picked(Casters),
}

/// A volume's mesh, and the parts of it that count.
pub struct VolumeMesh {
    pub mesh: DrawMesh,
    pub casting: CastingTriangles,
    pub needed: Vec<CountedPart>,
    /// The number that this volume adds to the start of the count, where no dark cap is drawn for it; otherwise 0.
    pub begins_with: u32,
    /// Records for the plan: the parts of the volume that are not needed.
    pub left_out: Vec<LeftOut>,
}

/// The input for making the volume of one caster under one light.
#[derive(Debug, Clone, Copy)]
pub struct CasterVolume<'a> {
    pub light: LightId,
    /// Index of its caster in [`FrameBuilder::placed`].
    pub index: usize,
    /// Which of the caster's triangles cast.
    pub casters: Casters,
    /// For each triangle, whether another part of the caster contains it in its umbra; empty where none is.
    pub hidden: &'a [bool],
    pub form: VolumeSpec,
}

impl VolumePlan {
    /// Returns the casting triangles as light cap parts that can be drawn: those that face the light, then the flipped
    /// ones. Empty runs are left out, and all where a vertex shader chooses them.
    pub fn casting(&self) -> impl Iterator<Item = CountedPart> {
        let runs = match &self.casting {
            CastingTriangles::Runs([light_cap, flipped]) => vec![(false, light_cap), (true, flipped)],
            CastingTriangles::Picked(_) => Vec::new(),
        };
        let parts =
            runs.into_iter().map(|(flipped, triangles)| CountedPart::new(DrawPart::LightCap, flipped, triangles));
        parts.filter(|part| !part.triangles.is_empty())
    }

    /// Returns the caster's vertices in world space and the corners of its casting triangles: of those that face the light,
    /// then of the flipped ones in the surface's own vertex order. Where a vertex shader chooses, of those that face `light`
    /// as its rule says, edge-on ones included for `All`.
    pub fn casting_triangles<'a>(&self, frame: &'a FrameBuilder, light: DVec4) -> (&'a [DVec3], Vec<[u32; 3]>) {
        let placed = &frame.placed[self.object];
        let (corners, casters) = match &self.casting {
            CastingTriangles::Runs([light_cap, flipped]) => {
                let indices = frame.plan.meshes[self.mesh.0].indices.data();
                (&indices[light_cap.start * 3..flipped.end * 3], Casters::All)
            }
            CastingTriangles::Picked(casters) => (placed.object.mesh.triangles().as_flattened(), *casters),
        };
        let place = |vertex: u32| placed.world[vertex as usize];
        let casts = |corners: &&[u32; 3]| match casters {
            Casters::All => true,
            Casters::LightFacing => side_of_triangle(corners.map(place), light) == Sign::Positive,
            Casters::LightBackFacing => side_of_triangle(corners.map(place), light) == Sign::Negative,
        };
        (&placed.world, corners.as_chunks::<3>().0.iter().filter(casts).copied().collect())
    }

    /// Returns the ends of the silhouette's edges in world space, each as often as its multiplicity says; `None` where a
    /// vertex shader finds the silhouette.
    pub fn silhouette<'a>(&self, frame: &'a FrameBuilder) -> Option<impl Iterator<Item = [DVec3; 2]> + use<'a>> {
        let CastingTriangles::Runs([light_cap, _]) = &self.casting else { return None };
        let indices = frame.plan.meshes[self.mesh.0].indices.data();
        let sides = &indices.as_chunks().0[..light_cap.start];
        Some(near_edges(sides, &frame.placed[self.object].world))
    }

    pub fn draws(&self, options: &VolumeSettings, step: FaceSelection) -> Vec<Draw> {
        self.needed.iter().map(|part| self.draw(part, self.counting.raster(part, options, step))).collect()
    }

    /// Returns a draw for each needed part that adds to, or subtracts from, a float count.
    pub fn float_draws(&self, options: &VolumeSettings) -> Vec<Draw> {
        let draw = |part: &CountedPart| {
            let (raster, count) = self.counting.float_raster(part, options);
            let constants = DrawConstants { count, ..DrawConstants::default() };
            Draw { program: Program::Count, constants, ..self.draw(part, raster) }
        };
        self.needed.iter().map(draw).collect()
    }

    /// Returns the draw of one part of the volume by position only, with this raster state and a name such as `sides of
    /// bunny`.
    pub fn draw(&self, part: &CountedPart, raster: RasterState) -> Draw {
        let what = match (part.part, part.flipped) {
            (DrawPart::Side, _) if part.grazes => "grazing sides",
            (DrawPart::Side, _) => "sides",
            (DrawPart::LightCap, false) => "light cap",
            (DrawPart::LightCap, true) => "turned light cap",
            (DrawPart::Caps, false) => "caps",
            (DrawPart::Caps, true) => "turned caps",
            // A triangle that faces the light faces inwards at the far end.
            (_, false) if part.base_vertex != 0 => "turned dark cap",
            (_, _) => "dark cap",
        };
        let front_face = if self.is_wound_backwards { FrontFace::Cw } else { raster.front_face };
        Draw {
            name: format!("{what} of {}", self.caster),
            caster: Some(self.caster.clone()),
            part: part.part,
            program: Program::Position,
            raster: RasterState { front_face, ..raster },
            mesh: self.mesh,
            triangles: part.triangles.start as u32..part.triangles.end as u32,
            base_vertex: part.base_vertex,
            pieces: None,
            faces_inwards: part.flipped,
            constants: DrawConstants::default(),
            samples_maps_of: Vec::new(),
        }
    }
}

/// Makes the volume of a caster with far vertices that the CPU extrudes away from the light, with the parts that count.
/// Parts may have no triangles, and caps that `options.caps` leaves out are among them: the caller sorts both out. Adds
/// nothing to the plan.
///
/// # Errors
/// Returns what to record where the caster needs no volume.
pub fn make(frame: &mut FrameBuilder, of: &CasterVolume, options: &VolumeSettings) -> Result<VolumeMesh, LeftOut> {
    let (mesh, mut parts, far_end) = outlined(frame, of, options);
    if frame.common.depth_bits.is_some_and(|bits| bits.steps() < FINE_BITS.steps()) {
        // What rounding parts is equal in such long steps, which counts as behind: a bias would move it farther than that.
        parts.sides.end = parts.grazing_sides.end;
        parts.grazing_sides.start = parts.grazing_sides.end;
    }
    let object = frame.placed[of.index].object;
    if parts.light_cap_flipped.end == 0 {
        let because = match of.casters {
            Casters::All => "every triangle is edge-on to the light",
            Casters::LightFacing => "no triangle faces the light",
            Casters::LightBackFacing => "no triangle faces away from the light",
        };
        return Err(LeftOut::new(Decision::NothingCasts, &object.name, because));
    }
    // The bias of grazing sides is a few steps, and rounding may be more.
    if !parts.grazing_sides.is_empty() && !casters::can_darken(frame, of.index, of.light, DarkenedObjects::All) {
        let because = "the light grazes it, so that depth can't tell it from its sides, and nothing is behind it";
        return Err(LeftOut::new(Decision::Caster, &object.name, because));
    }
    let casting = CastingTriangles::Runs([parts.light_cap.clone(), parts.light_cap_flipped.clone()]);
    let mut made = VolumeMesh { mesh, casting, needed: Vec::new(), begins_with: 0, left_out: Vec::new() };
    made.add_parts(of.form, &parts, far_end, options.caps[1], &object.name);
    Ok(made)
}

/// Returns the mesh of a volume and the ranges of triangles that are its parts; for parallel view rays and infinite
/// extrusion also what replaces its far end, `None` otherwise.
fn outlined(
    frame: &mut FrameBuilder,
    of: &CasterVolume,
    options: &VolumeSettings,
) -> (DrawMesh, VolumeParts, Option<ParallelFarEnd>) {
    let CasterVolume { light, index, casters, hidden, form: VolumeSpec { extrusion, .. } } = *of;
    let (position, eye) = (frame.light_position(light), frame.eye());
    let placed = &frame.placed[index];
    let caster = Caster { mesh: &placed.object.mesh, pose: &placed.object.pose, world: &placed.world };
    let extruder = Extruder::new(&placed.world, position, extrusion);
    let mut indices = Vec::new();
    let (is_drawn, by) = (placed.object.visible, options.silhouette);
    let volume = VolumeRequest { caster, is_drawn, light: position, casters, hidden, by, extruder: &extruder };
    let parts = frame.job.cache.volume_indices(&volume, &mut indices);
    let fan = if let DarkCap::Fan(_, fan) = parts.dark_cap { Some(fan) } else { None };
    let far_point = FarPoint::of(&frame.job.scene.camera).filter(|_| extrusion == Extrusion::Infinite);
    let far_end = far_point.map(|far_point| {
        let (sides, caps) = indices.as_chunks().0.split_at(parts.grazing_sides.end);
        let edges: Vec<_> = near_edges(sides, &placed.world).collect();
        let from = far_point.settled(position, &edges);
        let caps = &caps[..parts.light_cap_flipped.end - parts.light_cap.start];
        let casting = caps.iter().map(|corners| corners.map(|vertex| placed.world[vertex as usize]));
        let is_point = position.w != 0.0;
        let scale = if is_point { position.w } else { position.truncate().length() };
        let beside = (from - position).length() / scale;
        (from, ParallelFarEnd { count: far_point.count(from, casting), beside, is_point })
    });
    let extruder = far_end.map_or(extruder, |(from, _)| Extruder::new(&placed.world, from, extrusion));
    let vertices = extruder.vertices(&placed.world).chain(fan.iter().flat_map(CapFan::vertices));
    let vertices = vertices.map(|vertex| relative::homogeneous(vertex, eye)).collect();
    let mesh = DrawMesh::of_positions(format!("volume of {}", placed.object.name), vertices, indices);
    (mesh, parts, far_end.map(|(_, far_end)| far_end))
}

/// Returns the edges that a volume's sides begin at, from their triangles; `world` has the caster's vertices, which the
/// far ones follow.
fn near_edges(sides: &[[u32; 3]], world: &[DVec3]) -> impl Iterator<Item = [DVec3; 2]> {
    // A triangle of a side has two corners of the caster, or one.
    sides.iter().filter_map(|corners| {
        let mut near = corners.iter().filter_map(|vertex| world.get(*vertex as usize).copied());
        near.next().zip(near.next()).map(|(from, to)| [from, to])
    })
}

impl VolumeMesh {
    /// Appends the parts that count to `needed`: sides, light caps and dark cap as `form` says. Records dark caps that
    /// are not needed or are smaller, except where the settings leave them out anyway.
    fn add_parts(
        &mut self,
        form: VolumeSpec,
        parts: &VolumeParts,
        far_end: Option<ParallelFarEnd>,
        draws_dark_caps: bool,
        caster: &str,
    ) {
        let run = CountedPart::new;
        let grazing = CountedPart { grazes: true, ..run(DrawPart::Side, false, &parts.grazing_sides) };
        self.needed.extend([run(DrawPart::Side, false, &parts.sides), grazing]);
        if form.light_cap {
            self.needed.push(run(DrawPart::LightCap, false, &parts.light_cap));
            self.needed.push(run(DrawPart::LightCap, true, &parts.light_cap_flipped));
        }
        if !form.dark_cap {
            return;
        }
        match (&parts.dark_cap, far_end) {
            (DarkCap::Fan(..), Some(far_end)) if draws_dark_caps => {
                self.left_out.push(LeftOut::new(Decision::DarkCap, caster, far_end.because()));
                self.begins_with = far_end.count;
            }
            (DarkCap::None, far_end) => {
                let beside = far_end.map_or_else(String::new, ParallelFarEnd::beside);
                let because = format!("a directional light's volume closes in one point at infinity{beside}");
                self.left_out.push(LeftOut::new(Decision::DarkCap, caster, because));
            }
            (DarkCap::Fan(triangles, _), _) => {
                self.needed.push(run(DrawPart::DarkCap, false, triangles));
                let cap = parts.light_cap.len() + parts.light_cap_flipped.len();
                if triangles.len() < cap && draws_dark_caps {
                    let because = format!(
                        "at infinity only its outline matters: {} triangles close what {cap} would",
                        triangles.len()
                    );
                    let inner = (cap - triangles.len()) as u64;
                    self.left_out.push(LeftOut::counted(Decision::InnerDarkCap, inner, caster, because));
                }
            }
            (DarkCap::Carried(base), _) => {
                let carried = |part: CountedPart| CountedPart { base_vertex: *base, ..part };
                self.needed.push(carried(run(DrawPart::DarkCap, true, &parts.light_cap)));
                self.needed.push(carried(run(DrawPart::DarkCap, false, &parts.light_cap_flipped)));
            }
        }
    }
}

impl ParallelFarEnd {
    /// Returns words for how far from the light the point lies that the sides lead away from: metres for a point light,
    /// radians for a directional one; empty where it is the light itself.
    fn beside(self) -> String {
        match self.beside > 0.0 {
            true => {
                let beside = match self.is_point {
                    true => format!("{} beside the light", numbers::metres(self.beside)),
                    false => format!("{} radians off the light", numbers::digits(self.beside)),
                };
                format!("; as a side is seen edge-on, sides lead from {beside}")
            }
            false => String::new(),
        }
    }

    /// Returns why an infinite volume gets no dark cap under a parallel (orthographic or oblique) camera, as a sentence
    /// for the user, with the number that the count begins at instead.
    fn because(self) -> String {
        let beside = self.beside();
        format!(
            "lines of sight are parallel, and what lies at infinity is a line in the picture: the count begins at {} \
             for it, the casting triangles that a ray from the light along them meets{beside}",
            self.count
        )
    }
}
