//! A recorded frame's draws into a light's shadow map, and its plan with the map changed: other states, another view, more
//! texels, a caster more.

use super::RecordedLight;
use crate::capture::{Capture, MapProjection};
use crate::plan::{Blob, Draw, DrawMesh, FramePlan, LightId, MeshId, Pass, PlanMap, RasterState};
use glam::{DMat4, DVec3, DVec4};

/// The most texels along a side of a map that is made larger.
const MOST_TEXELS: u32 = 8192;
/// The most texels of all faces of a map that is made larger: a quarter of a GiB of depths.
const MOST_ALL: f64 = (1_u32 << 26) as f64;

/// Returns the map of a light, if its view is known.
fn map_of(plan: &FramePlan, light: LightId) -> Option<&PlanMap> {
    let light = plan.lights.get(light.0)?;
    light.map.as_ref().filter(|_| light.relative_position != [0.0; 4])
}

fn is_into_map(map: &PlanMap, pass: &Pass) -> bool {
    pass.depth_stencil.as_ref().is_some_and(|target| target.attachment == map.attachment)
}

impl RecordedLight<'_> {
    pub(super) fn map(&self) -> Option<&PlanMap> {
        map_of(self.plan, self.light)
    }

    pub(super) fn is_into_map(&self, pass: &Pass) -> bool {
        self.map().is_some_and(|map| is_into_map(map, pass))
    }

    pub(super) fn map_draws(&self) -> impl Iterator<Item = (&Pass, &Draw)> {
        let passes = self.plan.passes.iter().filter(|pass| self.is_into_map(pass));
        passes.flat_map(|pass| pass.draws.iter().map(move |draw| (pass, draw)))
    }

    pub(super) fn is_reversed(&self) -> bool {
        self.capture.map_clear_depth(self.light.0) == 0.0
    }

    /// Returns the plan with the raster states of the draws into the map changed.
    pub(super) fn with_map_states(&self, change: impl Fn(&mut RasterState)) -> FramePlan {
        let mut plan = self.plan.clone();
        let passes = plan.passes.iter_mut().zip(&self.plan.passes).filter(|(_, own)| self.is_into_map(own));
        passes.flat_map(|(pass, _)| &mut pass.draws).for_each(|draw| change(&mut draw.raster));
        plan
    }

    /// Returns the plan with another view in the map: `changed` is multiplied to the clip space of the whole map, of draws
    /// and lookups alike.
    pub(super) fn with_view(&self, changed: DMat4) -> FramePlan {
        let mut plan = self.with_map_vertices(|clip| changed * clip);
        if let Some(map) = &mut plan.lights[self.light.0].map {
            map.clip_from_light.iter_mut().for_each(|clip| *clip = changed * *clip);
            map.clip_from_relative = map.clip_from_light.iter().map(DMat4::as_mat4).collect();
        }
        plan
    }

    /// Returns the plan with the vertices of the draws into the map changed, in the clip space of the whole map.
    pub(super) fn with_map_vertices(&self, change: impl Fn(DVec4) -> DVec4) -> FramePlan {
        let mut plan = self.plan.clone();
        let Some(size) = self.map().and_then(|map| Some(self.plan.attachments.get(map.attachment.0)?.size)) else {
            return plan;
        };
        for (pass, draw) in self.map_draws() {
            let (mesh, viewport) = (&mut plan.meshes[draw.mesh.0], pass.viewport(size));
            let vertex = |vertex: &[f32; 4]| {
                let clip = viewport.clip_of_target(size, DVec4::from_array(vertex.map(f64::from)));
                viewport.clip_from_target(size, change(clip)).as_vec4().to_array()
            };
            mesh.vertices = Blob::new(mesh.vertices.data().iter().map(vertex).collect());
        }
        plan
    }

    /// Makes the map of a plan larger by a factor, as far as maps can be; returns whether it is larger now.
    pub(super) fn enlarge(&self, plan: &mut FramePlan, factor: f64) -> bool {
        let Some(map) = self.map() else { return false };
        let attachment = &mut plan.attachments[map.attachment.0];
        let old = attachment.size;
        let all = old.map(f64::from).into_iter().product::<f64>() * f64::from(attachment.layers.max(1));
        let factor = factor.min((MOST_ALL / all).sqrt());
        let larger = |side: u32| ((f64::from(side) * factor).round() as u32).min(MOST_TEXELS).max(side);
        let size = old.map(larger);
        attachment.size = size;
        let scale = [0, 1].map(|axis| size[axis] as f32 / old[axis] as f32);
        let clear = self.capture.map_clear_depth(self.light.0);
        let mut begun: Vec<u32> = Vec::new();
        for pass in plan.passes.iter_mut().filter(|pass| is_into_map(map, pass)) {
            let Some(recorded) = &mut pass.recorded else { continue };
            let [left, top, width, height] = recorded.viewport.area;
            recorded.viewport.area = [left * scale[0], top * scale[1], width * scale[0], height * scale[1]];
            // What it held before has another size.
            recorded.start = None;
            pass.scissor = None;
            let Some(target) = &mut pass.depth_stencil else { continue };
            if !begun.contains(&target.layer) {
                begun.push(target.layer);
                target.clear_depth = target.clear_depth.or(Some(clear));
            }
        }
        size != old
    }

    /// Returns the corners of the draws into the map, in the clip space of the whole map, that lie before the light and
    /// within the sides of its view.
    pub(super) fn inside_sides(&self) -> Vec<DVec4> {
        let Some(size) = self.map().and_then(|map| Some(self.plan.attachments.get(map.attachment.0)?.size)) else {
            return Vec::new();
        };
        let clip = self.map_draws().flat_map(|(pass, draw)| {
            let viewport = pass.viewport(size);
            let vertices = self.plan.meshes[draw.mesh.0].vertices.data().iter();
            vertices.map(move |vertex| viewport.clip_of_target(size, DVec4::from_array(vertex.map(f64::from))))
        });
        clip.filter(|clip| clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w).collect()
    }
}

/// Returns which faces of casters the draws into the map of a light keep: those towards the light (`true`) or those away from it
/// (`false`). `None` where both are kept, or draws differ.
pub fn kept_faces(plan: &FramePlan, capture: &Capture, light: LightId) -> Option<bool> {
    let map = map_of(plan, light)?;
    let projection = MapProjection::recorded(capture, light.0)?;
    let mut all = plan.passes.iter().filter(|pass| is_into_map(map, pass)).flat_map(|pass| {
        let face = pass.depth_stencil.as_ref().map_or(0, |target| target.layer as usize);
        let keeps_winding = projection.keeps_winding(face);
        pass.draws.iter().map(move |draw| {
            let is_front_towards = keeps_winding? == (draw.raster.front_face == wgpu_types::FrontFace::Ccw);
            let culled = draw.raster.cull?;
            Some((culled == wgpu_types::Face::Back) == is_front_towards)
        })
    });
    let first = all.next()??;
    all.all(|kept| kept == Some(first)).then_some(first)
}

/// Returns the plan with triangles in the eye's space drawn into the map of a light, too, after all that it draws; `None`
/// where its view is not known, or it draws nothing.
pub fn with_caster_in_map(plan: &FramePlan, light: LightId, name: &str, triangles: &[[DVec3; 3]]) -> Option<FramePlan> {
    let map = map_of(plan, light)?;
    let mut fixed = plan.clone();
    let mut is_drawn = false;
    for (face, clip_from_eye) in map.clip_from_light.iter().enumerate() {
        let is_into_face = |pass: &&Pass| {
            let layer = pass.depth_stencil.as_ref().map(|target| target.layer as usize);
            is_into_map(map, pass) && layer == Some(face) && !pass.draws.is_empty()
        };
        let last = plan.passes.iter().rposition(|pass| is_into_face(&pass));
        let Some(index) = last.filter(|_| *clip_from_eye != DMat4::ZERO) else { continue };
        let size = plan.attachments.get(map.attachment.0)?.size;
        let viewport = plan.passes[index].viewport(size);
        let vertex = |corner: &DVec3| {
            let clip = viewport.clip_from_target(size, *clip_from_eye * corner.extend(1.0));
            clip.as_vec4().to_array()
        };
        let vertices: Vec<[f32; 4]> = triangles.as_flattened().iter().map(vertex).collect();
        let (mesh, count) = (MeshId(fixed.meshes.len()), triangles.len() as u32);
        fixed.meshes.push(DrawMesh::of_positions(name, vertices, (0..count * 3).collect()));
        let like = plan.passes[index].draws.last()?;
        let raster = RasterState { cull: None, ..like.raster.clone() };
        let draw = like.of_other_mesh(name, mesh, count, raster);
        fixed.passes[index].draws.push(draw);
        is_drawn = true;
    }
    is_drawn.then_some(fixed)
}
