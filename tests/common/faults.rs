//! Plans made wrong, for tests of what finds that.

use stencilscope::plan::{Blob, Draw, DrawPart, FramePlan};

/// All draws of a part, in every pass.
pub fn draws(plan: &mut FramePlan, part: DrawPart) -> impl Iterator<Item = &mut Draw> {
    plan.passes.iter_mut().flat_map(|pass| &mut pass.draws).filter(move |draw| draw.part == part)
}

/// Caps with their corners in another order: the same triangles, counted the same way, but their depths are no
/// longer those of the surface, bit for bit. Dark caps that are fans have triangles of their own, and stay.
pub fn turn_caps(plan: &mut FramePlan) {
    for part in [DrawPart::LightCap, DrawPart::DarkCap] {
        for draw in draws(plan, part).filter(|draw| part == DrawPart::LightCap || draw.base_vertex != 0) {
            let stencil = &mut draw.raster.stencil;
            std::mem::swap(&mut stencil.front, &mut stencil.back);
        }
    }
    let mut caps: Vec<_> = draws(plan, DrawPart::LightCap).map(|draw| (draw.mesh, draw.triangles.clone())).collect();
    caps.dedup();
    for (mesh, triangles) in caps {
        let mut indices = plan.meshes[mesh.0].indices.data().to_vec();
        triangles.for_each(|triangle| indices.swap(triangle as usize * 3, triangle as usize * 3 + 1));
        plan.meshes[mesh.0].indices = Blob::new(indices);
    }
}
