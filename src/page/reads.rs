//! Which texels of a light's shadow map each pixel reads, as arrays.

use super::arrays::{ArrayIndex, Arrays, Layout, Word};
use crate::capture::Capture;
use crate::plan::{DecidedBy, FramePlan};
use crate::reading::map_readers::MapReaders;
use crate::technique::MapSettings;
use serde::Serialize;
use std::sync::Arc;

/// What pixels read of a map.
#[derive(Debug, Serialize)]
pub struct ReadsEntry {
    /// Of each pixel the face, column and row of the texel in the middle of those that it reads, each with one added;
    /// zeros where it reads none.
    texels: ArrayIndex,
    /// Of each pixel the depth that they are compared with.
    depths: ArrayIndex,
    /// Texels along each side that are read.
    filter: u32,
    /// Each texel is compared with a depth of its own, which is not here.
    by_plane: bool,
}

/// Of a light; `None` where no map decides, or it is not known how it is read.
pub fn reads(capture: &Capture, plan: &Arc<FramePlan>, light: usize, arrays: &mut Arrays) -> Option<ReadsEntry> {
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
    let depths: Vec<f32> = pixels().map(|pixel| readers.depth_of(pixel).unwrap_or(0.0) as f32).collect();
    let width = width as usize;
    let lookup = plan.lights.get(light)?.map.as_ref()?.lookup?;
    Some(ReadsEntry {
        texels: arrays.put(Layout { word: Word::U32, lanes: 3, width }, bytemuck::cast_slice(&texels)),
        depths: arrays.put(Layout { word: Word::F32, lanes: 1, width }, bytemuck::cast_slice(&depths)),
        filter: lookup.filter_width,
        by_plane: MapSettings::read(&capture.settings).bias_receiver_plane,
    })
}
