//! The transform from clip space to the eye's space.
//!
//! A perspective has w = distance along the view axis and z = a·w + b·h, where h is 1 for a finite point and 0 for one
//! at infinity. So (x, y, −w, h) is view space except for a stretch of x and y, which depends on the unknown field of
//! view. The stretch is taken as that of an eye that sees 90 degrees in square pixels: lines, planes and the order
//! along a line are preserved by any stretch.

use crate::math::depth::DepthCurve;
use crate::plan::{Draw, FramePlan, Pass, Viewport};
use glam::DVec4;

/// Points of smaller h are at infinity: depths near the far end round.
const INFINITE: f64 = 0.5;
/// How far h is off 1 by rounding, at most.
const ROUNDED: f64 = 0.01;

/// The conversion from a recorded pass's clip space to the view space of the frame's assumed eye.
#[derive(Debug, Clone, Copy)]
pub struct PassSpace {
    curve: DepthCurve,
    viewport: Viewport,
    size: [u32; 2],
}

impl PassSpace {
    /// Returns the transform of a pass of the picture.
    pub fn new(plan: &FramePlan, pass: &Pass) -> PassSpace {
        PassSpace { curve: plan.depth, viewport: pass.viewport(plan.size), size: plan.size }
    }

    /// Returns a clip-space vertex as a homogeneous point of view space: w is 1, or 0 where it is so far that only its
    /// direction is known. `None` where it is not finite.
    pub fn place(&self, vertex: [f32; 4]) -> Option<DVec4> {
        let clip = self.viewport.clip_of_target(self.size, DVec4::from_array(vertex.map(f64::from)));
        let [columns, rows] = self.size.map(f64::from);
        let h = (clip.z - self.curve.offset * clip.w) / self.curve.scale;
        let place = DVec4::new(clip.x * columns / rows, clip.y, -clip.w, h);
        if !place.is_finite() {
            return None;
        }
        // A value near 1 or 0 was exactly that before it was rounded, and x, y and w are more exact than it.
        Some(match h.abs() > INFINITE {
            true if (h - 1.0).abs() < ROUNDED => place.truncate().extend(1.0),
            true => (place / h).truncate().extend(1.0),
            false => place.truncate().extend(0.0),
        })
    }

    /// Returns the clip-space vertex of a homogeneous place of view space: the inverse of [`PassSpace::place`], in
    /// single precision.
    pub fn clip(&self, place: DVec4) -> [f32; 4] {
        let [columns, rows] = self.size.map(f64::from);
        let w = -place.z;
        let z = self.curve.offset * w + self.curve.scale * place.w;
        let clip = DVec4::new(place.x * rows / columns, place.y, z, w);
        self.viewport.clip_from_target(self.size, clip).as_vec4().to_array()
    }

    /// Returns all vertices of a draw's mesh as places of view space, in order, also those that the draw does not use;
    /// `None` for those that are not finite.
    pub fn places(&self, plan: &FramePlan, draw: &Draw) -> Vec<Option<DVec4>> {
        plan.meshes[draw.mesh.0].vertices.data().iter().map(|vertex| self.place(*vertex)).collect()
    }
}

/// Returns a cell and those that touch it: a place that was rounded may be in the next one.
pub fn neighbours([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |index| [x + index % 3 - 1, y + index / 3 % 3 - 1, z + index / 9 - 1])
}

/// Returns the triangles of a draw whose corners all have places: their vertex indices, without the base vertex, and
/// the places, with it. Others are left out.
pub(super) fn triangles<'a>(
    plan: &'a FramePlan,
    draw: &'a Draw,
    places: &'a [Option<DVec4>],
) -> impl Iterator<Item = ([u32; 3], [DVec4; 3])> + 'a {
    let indices = plan.meshes[draw.mesh.0].indices.data();
    let range = draw.triangles.start as usize..draw.triangles.end as usize;
    let corners = indices.as_chunks::<3>().0.get(range).unwrap_or_default();
    corners.iter().filter_map(|corners| {
        let place = |corner: u32| *places.get((corner + draw.base_vertex) as usize)?;
        Some((*corners, [place(corners[0])?, place(corners[1])?, place(corners[2])?]))
    })
}
