//! A recorded frame as a plan and a capture: another program's frame in the form of our own.
//!
//! ```text
//! RawFrame ─ stage.rs     which targets are the picture, and which are depth maps
//!          ─ map_faces.rs the views that a depth map holds: layers, or viewports of an atlas; those of one light are its map
//!          ─ states.rs    a draw's states as a raster state, its vertices in wgpu's clip space, its role
//!          ─ passes.rs    runs of draws that do the same become passes, what was stored after each becomes steps
//!          ─ eye.rs       the eye's projection: depth by distance, from the surfaces' vertices
//! ```
//!
//! Nothing is recomputed here: every picture is what was read back.

mod eye;
mod map_faces;
mod passes;
mod stage;
mod states;

use super::ImportError;
use super::raw::RawFrame;
use crate::capture::{
    AdapterInfo, Capture, CapturedLight, CapturedMap, Image, Origin, PixelFormat, Step, StoredQuantity, Timing,
};
use crate::math::depth::DepthCurve;
use crate::plan::{
    Attachment, AttachmentId, AttachmentRole, CountedSide, DecidedBy, FramePlan, LightId, MapLookup, Pass, PlanLight,
    PlanMap, PlanView, RecordedPass, ViewId,
};
use crate::recorded::{self, FoundLight, FoundMapLight, SeenSurfaces};
use crate::scene::Scene;
use glam::{DMat4, DVec3, DVec4, Mat4};
use map_faces::MapFace;
use passes::PassBuilder;
use stage::{DrawTarget, FollowedTargets};
use states::DrawRole;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The technique's name in plans and captures of other programs' frames.
pub const RECORDED: &str = "recorded";

/// The attachment of the picture's depth and stencil; those of depth maps follow.
const DEPTH_STENCIL: AttachmentId = AttachmentId(0);

/// Returns the id of the plan's attachment for the shadow map of this index.
fn map_attachment(map: usize) -> AttachmentId {
    AttachmentId(DEPTH_STENCIL.0 + 1 + map)
}

/// Another program's frame as a plan and a capture, like our own frames.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvertedFrame {
    /// The draws.
    pub plan: FramePlan,
    /// The stored pictures.
    pub capture: Capture,
    /// The scene, where all of its lights were found.
    pub scene: Option<Scene>,
    /// The positions of its lights, where the draws determine them.
    pub lights: Vec<Option<FoundLight>>,
}

/// Converts a recorded frame to a plan and a capture, whose scene is called `name`. Draws that can't be followed are
/// left out with the reason.
pub fn convert(frame: &RawFrame, name: &str) -> Result<ConvertedFrame, ImportError> {
    let mut stage = FollowedTargets::of(frame)?;
    stage.maps = maps_of_lights(frame, &stage)?;
    let converted = converted(frame, name, &stage)?;
    let is_found = |map: usize| converted.lights.get(map).is_some_and(Option::is_some);
    let (found, others): (Vec<usize>, Vec<usize>) = (0..stage.maps.len()).partition(|map| is_found(*map));
    let mut converted = converted;
    if !found.is_empty() && !others.is_empty() {
        // Depths that are sampled for other reasons, beside maps that are known, are no lights'.
        let left_out: Vec<MapFace> = others.into_iter().flat_map(|map| stage.maps[map].clone()).collect();
        stage.maps = found.into_iter().map(|map| stage.maps[map].clone()).collect();
        converted = self::converted(frame, name, &stage)?;
        let limits = left_out.iter().map(|face| {
            let [left, top, columns, rows] = face.area;
            let part = format!(" ({columns}x{rows} texels from {left},{top} on)");
            format!(
                "`{}`{} is drawn and sampled like a shadow map, and no light is found for it: it is left out",
                frame.textures[face.target.texture].name,
                if face.is_whole { "" } else { &part },
            )
        });
        // Layers of one texture are one.
        let limits: BTreeSet<String> = limits.collect();
        converted.capture.origin.iter_mut().for_each(|origin| origin.limits.extend(limits.iter().cloned()));
    }
    let apart = maps_of_one_light(&converted.lights, stage.maps.len());
    converted.capture.origin.iter_mut().for_each(|origin| origin.limits.extend(apart.clone()));
    Ok(converted)
}

/// Says which lights are in one place though each has a map: of maps of several sizes, or of one view, none is read in place of
/// another.
fn maps_of_one_light(lights: &[Option<FoundLight>], maps: usize) -> Option<String> {
    let place = |map: &usize| lights.get(*map).copied().flatten().map(|light| light.position);
    let is_near = |one: DVec4, other: DVec4| (one - other).length() <= 1e-3 * one.truncate().length();
    let is_shared = |map: &usize| {
        let others = (0..maps).filter(|other| other != map).filter_map(|other| place(&other));
        place(map).is_some_and(|own| others.into_iter().any(|other| is_near(own, other)))
    };
    let shared: Vec<String> = (0..maps).filter(is_shared).map(|map| LightId(map).name()).collect();
    (!shared.is_empty()).then(|| {
        format!(
            "{} are in one place: maps of several sizes, or of one view, are read each by itself",
            shared.join(" and ")
        )
    })
}

/// A frame with more faces of maps than these is not asked which of them share a light.
const MOST_FACES_TOGETHER: usize = 256;

/// Returns the faces of maps, of which each is a map of its own, as one map for each light: those that share its place and
/// their size. Where no light is found for a face it is taken to be of one with others of its texture.
fn maps_of_lights(frame: &RawFrame, stage: &FollowedTargets) -> Result<Vec<Vec<MapFace>>, ImportError> {
    let faces: Vec<MapFace> = stage.maps.iter().flatten().copied().collect();
    if faces.len() < 2 {
        return Ok(stage.maps.clone());
    }
    let DrawsAsPlan { plan, curve, .. } = draws_as_plan(frame, stage)?;
    // A part of a layer may be any light's; whole layers of one texture are mostly one light's.
    let layers_of = |(index, face): (usize, &MapFace)| match face.is_whole {
        true => face.target.texture,
        false => frame.textures.len() + index,
    };
    let layers_of: Vec<usize> = faces.iter().enumerate().map(layers_of).collect();
    let is_asked = curve.is_some() && faces.len() <= MOST_FACES_TOGETHER;
    let lights = if is_asked { recorded::lights_of_faces(&plan, &layers_of) } else { vec![None; faces.len()] };
    let of_texture = |texture: usize| {
        let of_it = faces.iter().zip(&lights).filter(|(face, _)| face.target.texture == texture);
        let found: BTreeSet<usize> = of_it.filter_map(|(_, light)| *light).collect();
        found.first().copied().filter(|_| found.len() == 1)
    };
    // By its light, or the texture that has none, and the size of its faces.
    type MapKey = (Result<usize, usize>, [u32; 2]);
    let mut maps: Vec<(MapKey, Vec<MapFace>)> = Vec::new();
    for (face, light) in faces.iter().zip(&lights) {
        let texture = face.target.texture;
        let key = (light.or_else(|| of_texture(texture)).ok_or(texture), face.size());
        match maps.iter_mut().find(|(known, faces)| *known == key && faces.len() < PlanMap::MOST_FACES) {
            Some((_, faces)) => faces.push(*face),
            None => maps.push((key, vec![*face])),
        }
    }
    Ok(maps.into_iter().map(|(_, faces)| faces).collect())
}

/// The draws of a frame as a plan, before anything is known of its lights.
struct DrawsAsPlan {
    plan: FramePlan,
    steps: Vec<Step>,
    /// What each face of each map stores at the end.
    faces: Vec<Vec<Arc<Image>>>,
    /// The mapping from distance to stored depth, where the vertices tell it.
    curve: Option<DepthCurve>,
}

fn draws_as_plan(frame: &RawFrame, stage: &FollowedTargets) -> Result<DrawsAsPlan, ImportError> {
    let mut making = PassBuilder::new(frame, stage);
    frame.events.iter().for_each(|event| making.event(event));
    if making.passes.is_empty() {
        let because = making.left_out.first().map_or_else(String::new, |first| format!(" ({})", first.because));
        return Err(ImportError::NothingDrawn { because });
    }
    let faces: Vec<Vec<Arc<Image>>> = (0..stage.maps.len()).map(|map| faces(frame, stage, &making, map)).collect();
    let PassBuilder { passes, steps, meshes, left_out, .. } = making;
    let mut attachments = vec![stage.attachment(frame, DrawTarget::Picture, AttachmentRole::DepthStencil)];
    for map in 0..stage.maps.len() {
        attachments.push(stage.attachment(frame, DrawTarget::Map(map, 0), AttachmentRole::Map(LightId(map))));
    }
    let size = stage.size(frame);
    let mut plan = FramePlan {
        technique: RECORDED.to_owned(),
        settings: BTreeMap::new(),
        size,
        // Replaced below by the curve that fits the draws.
        depth: crate::math::depth::DepthMapping::StandardInfinite.curve(1.0, 0.0, 0.0),
        wraps_diffuse: false,
        ambient_diffuse: 0.0,
        attachments,
        views: vec![PlanView {
            name: "camera".to_owned(),
            origin: DVec3::ZERO,
            eye: PlanView::at_origin(),
            clip_from_relative: Mat4::IDENTITY,
        }],
        lights: Vec::new(),
        ambient: [0.0; 3],
        meshes,
        textures: Vec::new(),
        passes,
        left_out,
    };
    let curve = eye::curve(&plan);
    plan.depth = curve.unwrap_or_else(|| eye::unknown(&plan));
    plan.views[0].clip_from_relative = eye::clip_from_view(&plan.depth, size).as_mat4();
    Ok(DrawsAsPlan { plan, steps, faces, curve })
}

fn converted(frame: &RawFrame, name: &str, stage: &FollowedTargets) -> Result<ConvertedFrame, ImportError> {
    let DrawsAsPlan { mut plan, mut steps, faces, curve } = draws_as_plan(frame, stage)?;
    let size = plan.size;
    mark_darkening(&mut plan, &mut steps);
    let of_passes = plan.passes.iter().filter_map(|pass| pass.light).map(|light| light.0 + 1).max();
    let lights = of_passes.unwrap_or(0).max(stage.maps.len());
    for light in (0..lights).map(LightId) {
        let made = plan_light(&plan, light, faces.get(light.0).map_or(0, Vec::len));
        plan.lights.push(made);
        plan.attachments.push(Attachment {
            name: format!("{} labels", light.name()),
            role: AttachmentRole::Labels(light),
            format: wgpu_types::TextureFormat::R8Uint,
            size,
            layers: 1,
            depth_bits: None,
        });
    }
    let mut found: Vec<Option<FoundLight>> = Vec::new();
    for index in 0..plan.lights.len() {
        let faces = faces.get(index).map_or(0, Vec::len);
        let of_map = curve.and_then(|_| recorded::map_light(&plan, LightId(index), faces));
        let one = of_map.as_ref().map(FoundMapLight::light);
        let one = one.or_else(|| curve.and_then(|_| recorded::light(&plan, LightId(index))));
        let light = &mut plan.lights[index];
        light.relative_position = one.map_or([0.0; 4], |one| one.position.as_vec4().to_array());
        if let (Some(map), Some(of_map)) = (&mut light.map, of_map) {
            // A face that is not known sees nothing.
            let views = of_map.faces.iter().map(|face| face.map_or(DMat4::ZERO, |face| face.clip_from_eye));
            map.clip_from_light = views.collect();
            map.clip_from_relative = map.clip_from_light.iter().map(DMat4::as_mat4).collect();
        }
        found.push(one);
    }
    let captured = |(index, light): (usize, &PlanLight)| CapturedLight {
        position: found[index].map_or(DVec4::ZERO, |found| found.position),
        of_casters: BTreeMap::new(),
        decided_by: light.decided_by,
        count_of: None,
        shadow: None,
        count: None,
        visibility: None,
        map: light.map.as_ref().zip(faces.get(index)).map(|(map, faces)| CapturedMap {
            faces: faces.clone(),
            layer_names: Vec::new(),
            light_from_world: map.light_from_world,
            clip_from_light: map.clip_from_light.clone(),
            quantity: recorded::stored_quantity(&plan, LightId(index), faces),
        }),
        truth: None,
    };
    let mut capture = Capture {
        scene: name.to_owned(),
        technique: RECORDED.to_owned(),
        settings: BTreeMap::new(),
        size,
        profile: None,
        adapter: AdapterInfo { name: frame.adapter.clone(), driver: String::new(), kind: "other".to_owned() },
        camera: eye::camera(&plan.depth),
        depth: plan.depth,
        steps,
        lights: plan.lights.iter().enumerate().map(captured).collect(),
        left_out: plan.left_out.clone(),
        timing: Timing::default(),
        plan_text: plan.to_string(),
        origin: Some(Origin {
            program: frame.program.clone(),
            api: frame.api.name().to_owned(),
            depth_format: format!("{:?}", frame.textures[stage.depth.texture].format),
            recorder: frame.recorder.clone(),
            limits: frame.limits.clone(),
        }),
    };
    let is_unknown =
        |light: &CapturedLight| light.map.as_ref().is_some_and(|map| map.quantity == StoredQuantity::Unknown);
    if capture.lights.iter().any(is_unknown) {
        capture.origin.iter_mut().for_each(|origin| origin.limits.push(recorded::UNKNOWN_QUANTITY.to_owned()));
    }
    let seen = SeenSurfaces::of(&plan, &capture);
    let labels = (0..plan.lights.len()).map(|light| recorded::labels(&plan, &capture, LightId(light), &seen));
    let labels: Vec<_> = labels.collect();
    for (light, shadow) in capture.lights.iter_mut().zip(labels) {
        light.shadow = shadow;
    }
    if curve.is_none() {
        capture.origin.iter_mut().for_each(|origin| origin.limits.push(recorded::UNKNOWN_DEPTH.to_owned()));
    }
    let limits = found.iter().enumerate().filter_map(|(index, found)| Some(found.as_ref()?.limits(LightId(index))));
    let limits: Vec<String> = limits.flatten().collect();
    capture.origin.iter_mut().for_each(|origin| origin.limits.extend(limits.iter().cloned()));
    let all: Option<Vec<FoundLight>> = found.iter().copied().collect();
    let scene = all.filter(|_| curve.is_some()).map(|lights| recorded::scene(&plan, capture.camera, name, &lights));
    for (index, light) in capture.lights.iter_mut().enumerate() {
        light.of_casters = scene.as_ref().map_or_else(BTreeMap::new, |scene| recorded::lights_of_casters(scene, index));
    }
    Ok(ConvertedFrame { plan, capture, scene, lights: found })
}

/// Marks passes that take light away, in the plan, and names them so, there and in its steps.
fn mark_darkening(plan: &mut FramePlan, steps: &mut [Step]) {
    let darkening: Vec<usize> = (0..plan.passes.len()).filter(|index| recorded::darkens(plan, steps, *index)).collect();
    for index in darkening {
        let (pass, step) = (&mut plan.passes[index], &mut steps[index]);
        pass.recorded.iter_mut().for_each(|recorded| recorded.darkens = true);
        (pass.name, pass.purpose) = (RecordedPass::DARKENING.to_owned(), DrawRole::Darkens.purpose().to_owned());
        (step.name, step.purpose) = (pass.name.clone(), pass.purpose.clone());
    }
}

/// Returns what each face of a map stores at the end; a face that nothing is drawn into is at the largest distance.
fn faces(frame: &RawFrame, stage: &FollowedTargets, making: &PassBuilder, map: usize) -> Vec<Arc<Image>> {
    let Attachment { size, layers, .. } =
        stage.attachment(frame, DrawTarget::Map(map, 0), AttachmentRole::Map(LightId(map)));
    let clear = Arc::new(Image::uniform(PixelFormat::Depth32F, size, &1.0_f32.to_le_bytes()));
    (0..layers as usize).map(|face| making.face(map, face).unwrap_or_else(|| clear.clone())).collect()
}

/// Returns a light of another program's plan without position or colour: only what decides its shadow is known, from
/// its map (`faces` more than 0) or from the stencil operations of its draws.
fn plan_light(plan: &FramePlan, light: LightId, faces: usize) -> PlanLight {
    let of_light = plan.passes.iter().filter(|pass| pass.light == Some(light));
    let draws = of_light.flat_map(|pass: &Pass| &pass.draws);
    let sides: Vec<CountedSide> = draws.flat_map(|draw| states::counted_sides(&draw.raster)).collect();
    let decided_by = match (faces > 0, sides.contains(&CountedSide::InFront), sides.contains(&CountedSide::Behind)) {
        (true, ..) => DecidedBy::Map,
        (_, true, true) => DecidedBy::StencilCount { side: CountedSide::AsNeeded },
        (_, true, false) => DecidedBy::StencilCount { side: CountedSide::InFront },
        (_, false, true) => DecidedBy::StencilCount { side: CountedSide::Behind },
        (_, false, false) => DecidedBy::Nothing,
    };
    let map = PlanMap {
        attachment: map_attachment(light.0),
        faces: vec![Some(ViewId(0)); faces],
        light_from_world: DMat4::IDENTITY,
        clip_from_light: vec![DMat4::IDENTITY; faces],
        clip_from_relative: vec![Mat4::IDENTITY; faces],
        layer_names: Vec::new(),
        lookup: Some(MapLookup::RECORDED),
        projects_backwards: false,
        repeats_edge: false,
        is_cached: false,
    };
    PlanLight {
        relative_position: [0.0; 4],
        color: [1.0; 3],
        range: None,
        decided_by,
        count_of: None,
        map: (faces > 0).then_some(map),
        count: None,
        labels: AttachmentId(plan.attachments.len()),
        visibility: None,
    }
}
