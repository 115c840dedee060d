//! Shadow maps: the depth that a light sees, compared at every pixel.
//!
//! One pass a face draws the casters' depth from the light, pushed away by a bias so that a
//! surface does not shadow itself; the light pass carries each fragment into the map and skips it
//! where the map holds something nearer to the light. Casters behind which nothing lies that
//! could be darkened are left out: a floor under everything would only widen the map.

use super::PlanError;
use super::casters::{self, DarkenedObjects};
use super::description::{ComparisonRole, TechniqueDescription};
use super::frame::{FrameBuilder, PlanRequest, StencilUse};
use super::lesson::{Lesson, cited};
use super::settings::MapSettings;
use crate::geometry::light_frame::{self, CUBE_FACES, LightFrame, LightFrustum, MapCover, MapStorage};
use crate::geometry::relative;
use crate::plan::{
    Attachment, AttachmentId, AttachmentRole, ColorWrite, DecidedBy, Decision, DepthStencilTarget, Draw, DrawConstants,
    DrawMesh, DrawPart, FramePlan, LeftOut, LightId, MapLookup, MeshId, Pass, PlanMap, PlanView, Program, RasterState,
    ViewId, Visibility,
};
use glam::{DMat4, DVec3};
use rayon::prelude::*;
use std::ops::Range;
use wgpu_types::{DepthBiasState, TextureFormat};

/// How many vertices or triangles one thread looks at, at least.
const SHARE: usize = 8 * 1024;

/// A caster that is drawn into a light's shadow map.
struct MapCaster {
    name: String,
    mesh: MeshId,
    /// Its triangles among those of all casters.
    triangles: Range<usize>,
}

/// The attachment and the raster state for drawing a map's faces.
struct MapTarget {
    attachment: AttachmentId,
    raster: RasterState,
}

/// Describes `shadow-map` for commands, tables and the inspector.
pub(super) const DESCRIPTION: TechniqueDescription = TechniqueDescription {
    summary: "Stores the depth of what the light sees, and darkens what lies behind it.",
    lesson: Lesson {
        text: "One face, or the six of a cube around a lamp. Any surface casts and receives; the price is \
             resolution (stairs) and bias (too little: surfaces darken themselves; too much: shadows leave their \
             casters). Casters behind which nothing could be darkened are left out of the map.",
        formula: "light is added where the map holds nothing nearer to the light than the surface, the bias allowed \
             for",
        sources: &[cited::WILLIAMS, cited::REEVES],
    },
    plan,
    // Sizes with the default bias, and with so little that surfaces shadow themselves; other ways to prevent that; and
    // a soft edge.
    report_rows: &[
        &[("size", "256")],
        &[("size", "512")],
        &[("size", "1024")],
        &[("size", "2048")],
        &[("size", "4096")],
        &[("size", "256"), ("bias-slope", "0")],
        &[("size", "512"), ("bias-slope", "0")],
        &[("size", "1024"), ("bias-slope", "0")],
        &[("size", "2048"), ("bias-slope", "0")],
        &[("size", "4096"), ("bias-slope", "0")],
        &[("bias-slope", "0"), ("cull", "front")],
        &[("bias-slope", "0"), ("bias-normal", "1.5")],
        &[("bias-slope", "1"), ("bias-receiver-plane", "on"), ("bias-constant", "64")],
        &[("filter", "pcf:3")],
        &[("redraw", "changed")],
    ],
    standing: ComparisonRole::Rival {
        place: 4,
        right_because: "its texels are finer than pixels, and its bias is enough",
        texels: Some((0.002, "1024 texels hold all that casts: where the light spreads them, each shows")),
    },
};

/// Plans a frame with shadow maps: one fitted face for each light, or six of a cube map. A light under which no caster
/// can darken anything gets no map and lights everything.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let settings = MapSettings::read(job.choice.settings());
    let mut frame = FrameBuilder::new(job, StencilUse::ToLightOnce)?;
    let has_lamp = frame.light_ids().any(|light| frame.light_position(light).w != 0.0);
    if let LightFrustum::Given { fov, .. } = settings.frustum
        && has_lamp
        && fov > light_frame::WIDEST_GIVEN
    {
        let most = light_frame::WIDEST_GIVEN;
        let problem = format!("a lamp's light-frustum can't be {fov} degrees wide: give at most {most}");
        return Err(PlanError::Unusable { problem });
    }
    for light in frame.light_ids() {
        add_map(&mut frame, light, &settings);
    }
    frame.ambient_pass();
    for light in frame.light_ids() {
        let (how, purpose) = match frame.plan.lights[light.0].map {
            Some(_) => (
                Visibility::Map,
                "Adds the light, carrying every fragment into the light's map: where the map holds something nearer to \
                 the light, the fragment is in shadow and gets nothing.",
            ),
            None => (
                Visibility::Everywhere,
                "Adds the light everywhere: no caster can darken anything, and there is no map.",
            ),
        };
        frame.mask_and_light_passes(light, how, purpose);
    }
    Ok(frame.finish())
}

fn add_map(frame: &mut FrameBuilder, light: LightId, settings: &MapSettings) {
    let size = settings.size;
    let indices = darkening_casters(frame, light);
    // Of all casters one after the other, world space.
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    let place = |index: &usize| {
        let first = triangles.len();
        casters::add_world_triangles(frame, *index, &mut triangles);
        first..triangles.len()
    };
    let ranges: Vec<Range<usize>> = indices.iter().map(place).collect();
    let storage = MapStorage { size, depth: frame.common.depth, epsilon: frame.common.epsilon };
    let view = match settings.frustum {
        LightFrustum::View { .. } => frame.view_corners(),
        LightFrustum::Casters | LightFrustum::Given { .. } => [DVec3::ZERO; 8],
    };
    let cover = MapCover { casters: &triangles, view, frustum: settings.frustum };
    let Some(light_frame) = light_frame::fit(&cover, frame.light_position(light), &storage) else {
        frame.leave_out(Decision::Map, light.name(), "nothing casts a shadow on anything");
        return;
    };
    let casters: Vec<MapCaster> = indices
        .into_iter()
        .zip(ranges)
        .map(|(index, triangles)| MapCaster {
            name: frame.placed[index].object.name.clone(),
            mesh: add_caster_mesh(frame, index, light_frame.origin),
            triangles,
        })
        .collect();
    let attachment = frame.add_attachment(Attachment {
        name: format!("{} map", light.name()),
        role: AttachmentRole::Map(light),
        format: TextureFormat::Depth32Float,
        size: [size; 2],
        layers: light_frame.clip_from_light.len() as u32,
        depth_bits: None,
    });
    let target = MapTarget { attachment, raster: map_raster(settings) };
    let of = FacesOfMap { light, light_frame: &light_frame, casters: &casters, triangles: &triangles, target: &target };
    let faces = (0..light_frame.clip_from_light.len()).map(|face| add_face(frame, &of, face));
    let faces: Vec<Option<ViewId>> = faces.collect();
    let light_from_eye = light_frame.light_from_world * DMat4::from_translation(frame.eye());
    let from_relative = |clip_from_light: &DMat4| (*clip_from_light * light_from_eye).as_mat4();
    frame.plan.lights[light.0].decided_by = DecidedBy::Map;
    frame.plan.lights[light.0].map = Some(PlanMap {
        attachment,
        faces,
        layer_names: Vec::new(),
        light_from_world: light_frame.light_from_world,
        clip_from_relative: light_frame.clip_from_light.iter().map(from_relative).collect(),
        clip_from_light: light_frame.clip_from_light,
        lookup: Some(MapLookup {
            clear_depth: frame.common.depth.clear_depth(),
            bias_normal: settings.bias_normal as f32,
            bias_receiver_plane: settings.bias_receiver_plane,
            filter_width: settings.filter_width,
        }),
        projects_backwards: false,
        repeats_edge: false,
        is_cached: settings.keeps,
    });
}

/// Returns the indices of casters that may darken a receiver, themselves included; records in the plan each other
/// caster that has triangles.
fn darkening_casters(frame: &mut FrameBuilder, light: LightId) -> Vec<usize> {
    let mut darkening = Vec::new();
    for index in 0..frame.placed.len() {
        let object = frame.placed[index].object;
        if !object.casts || object.mesh.triangles().is_empty() {
            continue;
        }
        if casters::can_darken(frame, index, light, DarkenedObjects::All) {
            darkening.push(index);
        } else {
            let because = "everything that receives lies on the light's side of its triangles";
            let left_out = LeftOut::named(Decision::MapCaster, &object.name, light.name(), because);
            frame.plan.left_out.push(left_out);
        }
    }
    darkening
}

fn add_caster_mesh(frame: &mut FrameBuilder, index: usize, origin: DVec3) -> MeshId {
    let placed = &frame.placed[index];
    let vertices = placed.world.par_iter().with_min_len(SHARE);
    let vertices = vertices.map(|position| relative::point(*position, origin)).collect();
    let name = format!("{} from the light", placed.object.name);
    let indices = placed.object.mesh.triangles().as_flattened().to_vec();
    frame.add_mesh(DrawMesh::of_positions(name, vertices, indices))
}

/// What all faces of a light's map have in common.
struct FacesOfMap<'a> {
    light: LightId,
    light_frame: &'a LightFrame,
    casters: &'a [MapCaster],
    /// Those of all casters, world space.
    triangles: &'a [[DVec3; 3]],
    target: &'a MapTarget,
}

/// Adds the view and the pass of one face of a map, with draws of the casters that show in it, and returns the view. Where
/// none does and faces may be left out, records that and returns `None`.
fn add_face(frame: &mut FrameBuilder, of: &FacesOfMap, face: usize) -> Option<ViewId> {
    let FacesOfMap { light, light_frame, casters, triangles, target } = *of;
    let clip_from_light = light_frame.clip_from_light[face];
    let clip_from_origin = clip_from_light * light_frame.light_from_relative;
    let shows = |caster: &&MapCaster| {
        triangles[caster.triangles.clone()].par_iter().with_min_len(SHARE).any(|corners| {
            let relative = corners.map(|corner| corner - light_frame.origin);
            light_frame::may_show(clip_from_origin, relative)
        })
    };
    let is_cube = light_frame.clip_from_light.len() > 1;
    let name = if is_cube { format!("map {}", CUBE_FACES[face].0) } else { "map".to_owned() };
    let draws: Vec<Draw> = casters.iter().filter(shows).map(|caster| map_draw(caster, &target.raster)).collect();
    if draws.is_empty() && frame.common.allows(Decision::MapFaces) {
        let left_out = LeftOut::named(Decision::MapFaces, &name, light.name(), "no caster shows in this face");
        frame.plan.left_out.push(left_out);
        return None;
    }
    frame.plan.views.push(PlanView {
        name: format!("{} {name}", light.name()),
        origin: light_frame.origin,
        eye: PlanView::at_origin(),
        clip_from_relative: (clip_from_light * light_frame.light_from_relative).as_mat4(),
    });
    let view = ViewId(frame.plan.views.len() - 1);
    let purpose = "Draws the casters as the light sees them and keeps only how far they are: what lies behind them, \
                   seen from the light, is in shadow.";
    frame.plan.passes.push(Pass {
        image: None,
        viewport: None,
        recorded: None,
        scissor: None,
        name,
        purpose: purpose.to_owned(),
        light: Some(light),
        timed: true,
        view,
        color: None,
        depth_stencil: Some(DepthStencilTarget {
            attachment: target.attachment,
            layer: face as u32,
            clear_depth: Some(0.0),
            clear_stencil: None,
        }),
        draws,
    });
    Some(view)
}

/// Returns the raster state of a map's draws. Biases change sign, as with reversed depth farther from the light is
/// smaller.
fn map_raster(settings: &MapSettings) -> RasterState {
    let depth_bias =
        DepthBiasState { constant: -settings.bias_constant, slope_scale: 0.0 - settings.bias_slope as f32, clamp: 0.0 };
    RasterState { depth_bias, cull: settings.cull, color: ColorWrite::None, ..RasterState::surface() }
}

fn map_draw(caster: &MapCaster, raster: &RasterState) -> Draw {
    Draw {
        name: caster.name.clone(),
        caster: Some(caster.name.clone()),
        part: DrawPart::Map,
        program: Program::Position,
        raster: raster.clone(),
        mesh: caster.mesh,
        triangles: 0..caster.triangles.len() as u32,
        base_vertex: 0,
        pieces: None,
        faces_inwards: false,
        constants: DrawConstants::default(),
        samples_maps_of: Vec::new(),
    }
}
