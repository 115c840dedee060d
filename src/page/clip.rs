//! Corners in clip space, as the vertex shader computes them: the page needs no matrices.
//!
//! Another driver's last bits may differ; the page compares its results with what was stored.

use super::arrays::{ArrayIndex, ArrayLayout, ArrayWord, PageArrays};
use crate::plan::{DrawMesh, FramePlan, ViewId, clip_position};
use glam::Mat4;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A mesh that passes of the picture draw: its triangles, and its corners as each view shows them.
#[derive(Debug, Serialize)]
pub struct PageMesh {
    /// Three indices of corners for each triangle.
    indices: ArrayIndex,
    /// For each view that shows it, its corners in clip space.
    corners: BTreeMap<usize, ArrayIndex>,
}

/// Returns the meshes of a plan, in its order; `None` for a mesh that no pass of the picture draws. Corners are added
/// to `arrays` in the clip space of each view that shows them.
pub fn meshes(plan: &FramePlan, arrays: &mut PageArrays) -> Vec<Option<PageMesh>> {
    let mut shown: BTreeMap<usize, BTreeSet<(ViewId, bool)>> = BTreeMap::new();
    for pass in plan.passes.iter().filter(|pass| plan.is_of_picture(pass)) {
        for draw in &pass.draws {
            shown.entry(draw.rasterised().mesh.0).or_default().insert((pass.view, draw.program.is_recorded()));
        }
    }
    let entry = |(index, mesh): (usize, &DrawMesh)| {
        let views = shown.get(&index)?;
        let layout = ArrayLayout { word: ArrayWord::U32, lanes: 3, width: 0 };
        let indices = arrays.add(layout, bytemuck::cast_slice(mesh.indices.data()));
        let corners = views.iter().map(|(view, is_recorded)| {
            // Another program's corners are in clip space already.
            let matrix = (!is_recorded).then(|| plan.views[view.0].clip_from_relative);
            (view.0, add(mesh.vertices.data(), matrix, arrays))
        });
        Some(PageMesh { indices, corners: corners.collect() })
    };
    plan.meshes.iter().enumerate().map(entry).collect()
}

fn add(corners: &[[f32; 4]], matrix: Option<Mat4>, arrays: &mut PageArrays) -> ArrayIndex {
    let layout = ArrayLayout { word: ArrayWord::F32, lanes: 4, width: 0 };
    match matrix {
        None => arrays.add(layout, bytemuck::cast_slice(corners)),
        Some(matrix) => {
            let clip: Vec<[f32; 4]> = corners.iter().map(|corner| clip_position(matrix, *corner)).collect();
            arrays.add(layout, bytemuck::cast_slice(&clip))
        }
    }
}
