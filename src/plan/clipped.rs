//! Which of a frame's triangles are clipped in double precision before a GPU sees them.
//!
//! Rasterisers are exact for triangles within the picture. Corners behind the eye, at infinity or far outside of the
//! picture are left to each one's own clipping, and some make a triangle's plane of depth from corners that the view
//! can't see. What is clipped here ([`ViewPlanes`]) covers the same pixels, and asks for none of that.
//!
//! The plan's draws and meshes stay as they are: a draw has its pieces beside its triangles, and each piece knows its
//! triangle.

use super::pieces::{Grid, PieceRanges, ViewPlanes};
use super::{Draw, DrawMesh, DrawPieces, FramePlan, MeshId, Pass, ViewId};
use glam::{DMat4, DVec2, DVec4};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// What a rasteriser draws as exactly as triangles within the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactRange {
    /// How far outside of the picture corners may lie, pixels.
    pub far: f64,
    /// Whether corners may lie behind the eye.
    pub behind_eye: bool,
    /// Whether corners may lie at infinity: `w = 0` in clip space.
    pub infinity: bool,
    /// The step that corners are moved to without their depth, pixels; `None` where depths are those of the triangle as
    /// it is given.
    pub coarse_step: Option<f64>,
}

/// How many vertices one thread looks at, at least.
const SHARE: usize = 16 * 1024;

/// A mesh as a group of draws uses it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct MeshUse {
    view: ViewId,
    /// Pixels of the target that is drawn into.
    size: [u32; 2],
    mesh: MeshId,
    base_vertex: u32,
    /// Whether depth is clamped to the near and the far plane instead of clipped there.
    is_unclipped: bool,
}

impl FramePlan {
    /// Returns the plan with pieces ([`Draw::pieces`]) of all triangles that our own passes draw, clipped to their target: of
    /// all views where the rasteriser moves corners without their depth; else of the camera's, where a corner lies outside
    /// of what is drawn exactly. Pieces that the plan has already are replaced. Volumes that a vertex shader extrudes are
    /// then drawn from the vertices that it would compute. Views without depth and counts at the near plane stay as they
    /// are.
    #[must_use]
    pub fn clipped(self, exact: &ExactRange) -> FramePlan {
        let mut plan = self.without_pieces();
        let uses = plan.uses();
        let needs = |(of, triangles): (&MeshUse, &Range<u32>)| {
            let clip_from_relative = plan.views[of.view.0].clip_from_relative.as_dmat4();
            let limits = ExactLimits::new(of.size, exact, &clip_from_relative);
            limits.exceeds(&plan.meshes[of.mesh.0], of.base_vertex, triangles)
        };
        let is_of_camera = |of: &MeshUse| of.view == ViewId(0);
        // All of a view or nothing: techniques would show other edges else. Where only far corners are drawn inexactly, the
        // camera's view alone: they are off by less than a map's texels show.
        let is_coarse = exact.coarse_step.is_some();
        if !is_coarse && !uses.iter().filter(|(of, _)| is_of_camera(of)).any(needs) {
            return plan;
        }
        let mut made = BTreeMap::new();
        for (of, triangles) in uses.into_iter().filter(|(of, _)| is_coarse || is_of_camera(of)) {
            let clip_from_relative = plan.views[of.view.0].clip_from_relative.as_dmat4();
            let planes = ViewPlanes::new(of.size, plan.depth.mapping.is_reversed(), of.is_unclipped);
            let grid = exact.coarse_step.map(|step| Grid::new(of.size, step, &clip_from_relative, of.is_unclipped));
            let mesh = &plan.meshes[of.mesh.0];
            let pieces = planes.clipped(mesh, of.base_vertex, triangles, &clip_from_relative, grid.as_ref());
            if let Some((mesh, pieces)) = pieces {
                made.insert(of, (MeshId(plan.meshes.len()), pieces));
                plan.meshes.push(mesh);
            }
        }
        for pass in 0..plan.passes.len() {
            let Some(size) = plan.clipped_size(&plan.passes[pass]) else { continue };
            let pass = &mut plan.passes[pass];
            for draw in &mut pass.draws {
                let of = MeshUse::new(pass.view, size, draw);
                draw.pieces = made.get(&of).map(|(mesh, PieceRanges { starts, is_cut_in_depth })| {
                    let [start, end] = [draw.triangles.start, draw.triangles.end].map(|at| starts[at as usize]);
                    DrawPieces { mesh: *mesh, triangles: start..end, is_cut_in_depth: *is_cut_in_depth }
                });
            }
        }
        plan
    }

    /// Returns the plan with draws of whole triangles.
    fn without_pieces(mut self) -> FramePlan {
        self.passes.iter_mut().flat_map(|pass| &mut pass.draws).for_each(|draw| draw.pieces = None);
        // They were added after all others; one that has others after it is only not drawn.
        while self.meshes.last().is_some_and(|mesh| mesh.pieces_of.is_some()) {
            self.meshes.pop();
        }
        self
    }

    /// Returns the pixels of the viewport of a pass whose triangles are clipped; `None` without a target, for a view that
    /// flattens all depths to one (there, a place on the grid has no place in space), and for a count on the near plane,
    /// which is in the light's view and has no depth to get wrong.
    fn clipped_size(&self, pass: &Pass) -> Option<[u32; 2]> {
        let has_depth = self.views[pass.view.0].clip_from_relative.as_dmat4().inverse().is_finite();
        let is_clipped = has_depth && !pass.counts_at_near_plane();
        let target = pass.targets().next().filter(|_| is_clipped)?;
        let [_, _, columns, rows] = pass.viewport(self.attachment(target).size).area;
        Some([columns, rows].map(|side| side as u32))
    }

    /// Returns what the passes draw of which mesh, with the triangles from the first to the last that are drawn.
    fn uses(&self) -> BTreeMap<MeshUse, Range<u32>> {
        let mut uses: BTreeMap<MeshUse, Range<u32>> = BTreeMap::new();
        for (pass, size) in self.passes.iter().filter_map(|pass| Some((pass, self.clipped_size(pass)?))) {
            for draw in pass.draws.iter().filter(|draw| !draw.program.is_recorded() && !draw.triangles.is_empty()) {
                let range = uses.entry(MeshUse::new(pass.view, size, draw)).or_insert_with(|| draw.triangles.clone());
                *range = range.start.min(draw.triangles.start)..range.end.max(draw.triangles.end);
            }
        }
        uses
    }
}

impl MeshUse {
    fn new(view: ViewId, size: [u32; 2], draw: &Draw) -> MeshUse {
        let Draw { mesh, base_vertex, .. } = *draw;
        MeshUse { view, size, mesh, base_vertex, is_unclipped: draw.raster.unclipped_depth }
    }
}

/// What a rasteriser draws exactly, for corners in the clip space of a view.
struct ExactLimits<'a> {
    exact: &'a ExactRange,
    clip_from_relative: &'a DMat4,
    /// How far to the side and up corners may lie, as parts of the way from the picture's middle to its border.
    far: DVec2,
}

impl<'a> ExactLimits<'a> {
    fn new(size: [u32; 2], exact: &'a ExactRange, clip_from_relative: &'a DMat4) -> ExactLimits<'a> {
        let half = DVec2::from_array(size.map(|side| f64::from(side.max(1)))) / 2.0;
        ExactLimits { exact, clip_from_relative, far: 1.0 + exact.far / half }
    }

    /// Returns whether a triangle that may be seen has a corner outside of the limits. Where no vertex is, no triangle is
    /// looked at: each vertex is a corner of six.
    fn exceeds(&self, mesh: &DrawMesh, base_vertex: u32, triangles: &Range<u32>) -> bool {
        let vertices = mesh.vertices.data().par_iter().with_min_len(SHARE);
        let place = |vertex: &[f32; 4]| DVec4::from_array(vertex.map(f64::from));
        if !vertices.map(place).any(|place| self.is_outside(place.w == 0.0, *self.clip_from_relative * place)) {
            return false;
        }
        let exceeds = |triangle: u32| {
            let Some(corners) = mesh.corners(triangle, base_vertex) else { return false };
            let places = corners.map(|vertex| DVec4::from_array(mesh.vertices.data()[vertex as usize].map(f64::from)));
            let clips = places.map(|place| *self.clip_from_relative * place);
            let beside = clips.map(|DVec4 { x, y, w, .. }| [x > w, x < -w, y > w, y < -w]);
            let is_beside = (0..4).any(|side| beside.iter().all(|beside| beside[side]));
            !is_beside && places.iter().zip(clips).any(|(place, clip)| self.is_outside(place.w == 0.0, clip))
        };
        triangles.clone().into_par_iter().with_min_len(SHARE).any(exceeds)
    }

    /// Corners of volumes at infinity may lie as far outside as they like: their edges are off by hundredths of a pixel,
    /// and techniques that draw no volumes would clip other triangles than those that do.
    fn is_outside(&self, is_endless: bool, clip: DVec4) -> bool {
        let w = clip.w.abs();
        let is_far = !is_endless && (clip.x.abs() > self.far.x * w || clip.y.abs() > self.far.y * w);
        (clip.w < 0.0 && !self.exact.behind_eye) || (clip.w == 0.0 && !self.exact.infinity) || is_far
    }
}

#[cfg(test)]
mod tests {
    use super::super::pieces::tests::{looking, strip};
    use super::*;

    #[test]
    fn only_what_is_not_drawn_exactly_needs_clipping() {
        let (mesh, size) = (strip(), [64, 48]);
        let exact = ExactRange { far: 1e9, behind_eye: true, infinity: true, coarse_step: None };
        let needs = |exact: &ExactRange| ExactLimits::new(size, exact, &looking()).exceeds(&mesh, 0, &(0..2));
        assert!(!needs(&exact));
        assert!(needs(&ExactRange { behind_eye: false, ..exact }));
        assert!(needs(&ExactRange { far: 100.0, ..exact }));
        assert!(!needs(&ExactRange { infinity: false, ..exact }), "it looks along no edge of the world's infinity");
    }
}
