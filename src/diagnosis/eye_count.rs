//! What z-pass misses where the eye stands in shadow: the faces of volumes that it is already in.

use crate::plan::{Draw, FramePlan, RasterState};
use crate::recorded::OpenEdges;
use glam::DVec3;
use wgpu_types::{Face, FrontFace, StencilOperation};

/// Returns the number that counting in front of the surface should begin with: how many volumes of these draws the eye is
/// in, with the sign of a face that enters one; 0 where it is in none, or where the view rays are parallel. Open volumes
/// are taken as closed by fans over their edges.
///
/// All around an eye outside of closed volumes as many faces enter as leave. Within one more leaves, and the sum of all,
/// each by its share of the sphere around the eye, is the number that is missed.
pub fn missed_at_eye(plan: &FramePlan, draws: &[&Draw]) -> i32 {
    let mut sum = 0.0;
    let mut states: Vec<&RasterState> = Vec::new();
    let mut is_parallel = true;
    for draw in draws {
        let mesh = &plan.meshes[draw.mesh.0];
        let range = draw.triangles.start as usize..draw.triangles.end as usize;
        for corners in mesh.indices.data().as_chunks::<3>().0.get(range).unwrap_or_default() {
            let at = |corner: u32| mesh.vertices.data().get((corner + draw.base_vertex) as usize).copied();
            let [Some(a), Some(b), Some(c)] = corners.map(at) else { continue };
            is_parallel &= [a, b, c].iter().all(|[_, _, _, w]| *w == 1.0);
            sum += counted(&draw.raster, [a, b, c]);
        }
        if !states.contains(&&draw.raster) {
            states.push(&draw.raster);
        }
    }
    // A volume may be drawn once for each face: a cap is counted by the states of both.
    for cap in OpenEdges::of(plan, draws.iter().copied()).caps() {
        sum += states.iter().map(|raster| counted(raster, cap)).sum::<f64>();
    }
    if is_parallel { 0 } else { -sum.round() as i32 }
}

/// Returns what a triangle (clip space) adds to the count where it passes, times its share of the sphere around the eye;
/// 0 for a culled one.
fn counted(raster: &RasterState, corners: [[f32; 4]; 3]) -> f64 {
    // The eye is the origin of x, y and w, whatever the field of view is.
    let [a, b, c] = corners.map(|[x, y, _, w]| DVec3::new(x.into(), y.into(), w.into()).normalize_or_zero());
    let volume = a.dot(b.cross(c));
    // w grows away from the eye, so that this space is left-handed.
    let is_front = (volume > 0.0) == (raster.front_face == FrontFace::Ccw);
    let face = if is_front { &raster.stencil.front } else { &raster.stencil.back };
    let step = match face.pass_op {
        _ if raster.cull == Some(if is_front { Face::Front } else { Face::Back }) => 0.0,
        StencilOperation::IncrementClamp | StencilOperation::IncrementWrap => 1.0,
        StencilOperation::DecrementClamp | StencilOperation::DecrementWrap => -1.0,
        _ => 0.0,
    };
    let solid_angle = 2.0 * volume.abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
    step * solid_angle / (4.0 * std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box around `middle` (x, y, w), each face once, counted up where it is seen from outside.
    fn sum_of_box(middle: [f32; 3]) -> f64 {
        let corner = |index: usize| {
            let at = |axis: usize| middle[axis] + if index >> axis & 1 == 1 { 1.0 } else { -1.0 };
            [at(0), at(1), 0.0, at(2)]
        };
        let mut front = RasterState::surface();
        front.stencil.front.pass_op = StencilOperation::IncrementWrap;
        front.stencil.back.pass_op = StencilOperation::DecrementWrap;
        front.cull = None;
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        triangles.map(|corners| counted(&front, corners.map(corner))).sum()
    }

    #[test]
    fn an_eye_within_a_volume_misses_one_face() {
        assert!((sum_of_box([0.2, -0.3, 0.1]).abs() - 1.0).abs() < 1e-9);
        assert!(sum_of_box([4.0, 0.5, 2.0]).abs() < 1e-9);
    }
}
