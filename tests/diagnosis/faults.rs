//! Plans made wrong: what no setting does.

use super::provoke::PlanFault;
use crate::common::faults::{draws, turn_caps};
use glam::{DMat4, DVec3, Mat4};
use std::collections::BTreeMap;
use stencilscope::plan::{Blob, Draw, DrawPart, FramePlan};

/// A part of volumes is not drawn.
pub fn without(part: DrawPart) -> PlanFault {
    Box::new(move |plan| plan.passes.iter_mut().for_each(|pass| pass.draws.retain(|draw| draw.part != part)))
}

/// Caps with their corners in another order: the same triangles, counted the same way.
pub fn flipped_caps() -> PlanFault {
    Box::new(turn_caps)
}

/// Silhouettes as a textbook has them, where only light-facing triangles cast: an edge that has not exactly
/// two triangles is none.
pub fn textbook_silhouettes() -> PlanFault {
    Box::new(|plan| {
        if plan.settings.get("casters").is_none_or(|casters| casters != "light-facing") {
            return;
        }
        let surface = |plan: &FramePlan, caster: &Option<String>| {
            let all = plan.passes.iter().flat_map(|pass| &pass.draws);
            let mesh = all
                .filter(|draw| draw.part == DrawPart::Surface && draw.caster == *caster)
                .map(|draw| draw.mesh)
                .next();
            mesh.map(|mesh| plan.meshes[mesh.0].indices.data().to_vec())
        };
        let sides: Vec<Draw> = draws(plan, DrawPart::Side).map(|draw| draw.clone()).collect();
        for side in sides {
            let Some(surface) = surface(plan, &side.caster) else { continue };
            let mut used: BTreeMap<[u32; 2], u32> = BTreeMap::new();
            for corners in surface.chunks_exact(3) {
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    let [a, b] = [corners[a], corners[b]];
                    *used.entry([a.min(b), a.max(b)]).or_default() += 1;
                }
            }
            let near = plan.meshes[side.mesh.0].vertices.data().len() as u32 / 2;
            let mut indices = plan.meshes[side.mesh.0].indices.data().to_vec();
            let run = side.triangles.start as usize * 3..side.triangles.end as usize * 3;
            for corners in indices[run].chunks_exact_mut(3) {
                // The vertices of the near edge, whether a corner is carried to the far end or not.
                let mut edge: Vec<u32> = corners.iter().map(|vertex| vertex % near).collect();
                edge.sort_unstable();
                edge.dedup();
                let [a, b] = edge[..] else { continue };
                if used.get(&[a, b]).is_none_or(|count| *count != 2) {
                    corners[1] = corners[0];
                    corners[2] = corners[0];
                }
            }
            plan.meshes[side.mesh.0].indices = Blob::new(indices);
        }
    })
}

/// Shadow maps that show only the middle of what they should.
pub fn narrowed_map(factor: f64) -> PlanFault {
    Box::new(move |plan| {
        let scale = DMat4::from_scale(DVec3::new(factor, factor, 1.0));
        let coarse: Mat4 = scale.as_mat4();
        let mut views = Vec::new();
        for light in &mut plan.lights {
            let Some(map) = &mut light.map else { continue };
            map.clip_from_light.iter_mut().for_each(|clip| *clip = scale * *clip);
            map.clip_from_relative.iter_mut().for_each(|clip| *clip = coarse * *clip);
            views.extend(map.faces.iter().flatten().copied());
        }
        for view in views {
            plan.views[view.0].clip_from_relative = coarse * plan.views[view.0].clip_from_relative;
        }
    })
}
