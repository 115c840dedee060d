//! Which texels of a light's shadow map each pixel reads, as arrays.

use super::arrays::{ArrayIndex, ArrayLayout, ArrayWord, PageArrays};
use crate::capture::Capture;
use crate::plan::{DecidedBy, FramePlan};
use crate::reading::map_readers::{MapReaders, MapTexel};
use crate::technique::MapSettings;
use serde::Serialize;
use std::sync::Arc;

/// For each pixel, the texels of a light's map that it reads, and the depths that they are compared with.
#[derive(Debug, Serialize)]
pub struct PageReads {
    /// For each pixel the face, column and row of the texel in the middle of those that it reads, each plus 1; zeros
    /// where it reads none.
    texels: ArrayIndex,
    /// For each pixel the depth that the middle texel is compared with.
    depths: ArrayIndex,
    /// How much that depth grows from one column and row to the next, where texels are compared with the plane of the
    /// surface.
    slopes: Option<ArrayIndex>,
    /// How many texels are read along each side.
    filter: u32,
}

/// Adds, for each pixel, row by row, what it reads of a light's shadow map. `None` for another program's frame, or
/// where no shadow map decides this light, or it is not known how it is read.
pub fn reads(capture: &Capture, plan: &Arc<FramePlan>, light: usize, arrays: &mut PageArrays) -> Option<PageReads> {
    if capture.origin.is_some() || capture.decided_by(light) != DecidedBy::Map {
        return None;
    }
    let readers = MapReaders::new(capture, Some(plan), light)?;
    let [width, height] = capture.size;
    let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let texel = |pixel: [u32; 2]| {
        let texel = readers.texel_of(pixel);
        texel.map_or([0; 3], |texel| [texel.face as u32 + 1, texel.at[0] + 1, texel.at[1] + 1])
    };
    let texels: Vec<[u32; 3]> = pixels().map(texel).collect();
    let width = width as usize;
    let filter = plan.lights.get(light)?.map.as_ref()?.lookup?.filter_width;
    let is_by_plane = MapSettings::read(&capture.settings).bias_receiver_plane;
    let (depths, slopes): (Vec<f32>, Vec<[f32; 2]>) = pixels()
        .map(|pixel| match is_by_plane {
            true => on_plane(&readers.compared(pixel), filter as usize),
            false => (readers.depth_of(pixel).unwrap_or(0.0) as f32, [0.0; 2]),
        })
        .unzip();
    Some(PageReads {
        texels: arrays.add(ArrayLayout { word: ArrayWord::U32, lanes: 3, width }, bytemuck::cast_slice(&texels)),
        depths: arrays.add(ArrayLayout { word: ArrayWord::F32, lanes: 1, width }, bytemuck::cast_slice(&depths)),
        slopes: is_by_plane
            .then(|| arrays.add(ArrayLayout { word: ArrayWord::F32, lanes: 2, width }, bytemuck::cast_slice(&slopes))),
        filter,
    })
}

/// Returns the depth that is compared at the middle of `filter` × `filter` texels, given row by row, and how much it
/// grows from one column and one row to the next; zeros where there are no texels.
fn on_plane(compared: &[(MapTexel, f64)], filter: usize) -> (f32, [f32; 2]) {
    let middle = filter / 2 * (filter + 1);
    let Some((_, depth)) = compared.get(middle) else { return (0.0, [0.0; 2]) };
    let (first, first_depth) = compared[0];
    // The last one of the first row, and of the first column: at a map's border some are the same texel.
    let slope = |axis: usize, last: usize| {
        let (texel, depth) = compared[last];
        let texels = texel.at[axis] - first.at[axis];
        if texels == 0 { 0.0 } else { ((depth - first_depth) / f64::from(texels)) as f32 }
    };
    (*depth as f32, [slope(0, filter - 1), slope(1, filter * (filter - 1))])
}
