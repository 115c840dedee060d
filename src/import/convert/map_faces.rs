//! The faces of shadow maps among a frame's depth targets: layers of textures, or viewports in one.

use crate::capture::Image;
use crate::import::raw::{RawDraw, RawFormat, RawFrame, RawKind, RawTarget, RawTexture};
use crate::plan::{PlanMap, Viewport};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What one view of a light is drawn into: a layer of a texture, or a part of it where several views share it, as in an
/// atlas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct MapFace {
    /// The layer of the texture.
    pub target: RawTarget,
    /// Left, top, columns and rows in texels.
    pub area: [u32; 4],
}

impl MapFace {
    /// Returns the whole of a target as a face.
    pub fn whole(frame: &RawFrame, target: RawTarget) -> MapFace {
        let [columns, rows] = frame.size_of(target);
        MapFace { target, area: [0, 0, columns, rows] }
    }

    /// Returns the faces of all shadow maps of a frame whose picture has the depth texture `picture`, in the order of
    /// their textures' first draws: of those textures that are read, where the recording says what is.
    pub fn all(frame: &RawFrame, reads: &MapReads, picture: usize) -> Vec<MapFace> {
        let mut maps: Vec<(usize, u32)> = Vec::new();
        for (target, _) in drawn(frame) {
            let RawTexture { format, samples, layers, .. } = &frame.textures[target.texture];
            let is_whole = *samples == 1 && *layers as usize <= PlanMap::MOST_FACES;
            let is_read = !reads.are_known || reads.by_any.contains(&target.texture);
            let is_known = maps.iter().any(|(texture, _)| *texture == target.texture);
            if target.texture != picture && !is_known && is_read && format.has_depth() && is_whole {
                maps.push((target.texture, target.mip));
            }
        }
        let layers = maps.into_iter().flat_map(|(texture, mip)| {
            let layers = frame.textures[texture].layers.max(1);
            (0..layers).map(move |layer| RawTarget { texture, layer, mip })
        });
        layers.flat_map(|target| MapFace::of(frame, target)).collect()
    }

    /// Returns the faces of a layer: one for each viewport that draws have there, in the order of their first draws, where no
    /// two overlap; else the whole.
    fn of(frame: &RawFrame, target: RawTarget) -> Vec<MapFace> {
        let size = frame.size_of(target);
        let of_target = drawn(frame).filter(|(of, _)| *of == target);
        let mut viewports: Vec<[u32; 4]> = Vec::new();
        for viewport in of_target.filter_map(|(_, draw)| texels_of(draw.view.viewport, size)) {
            if !viewports.contains(&viewport) {
                viewports.push(viewport);
            }
            if viewports.len() > PlanMap::MOST_FACES {
                return vec![MapFace::whole(frame, target)];
            }
        }
        let is_apart = |one: &[u32; 4], other: &[u32; 4]| {
            (0..2).any(|axis| one[axis] + one[axis + 2] <= other[axis] || other[axis] + other[axis + 2] <= one[axis])
        };
        let are_apart = viewports.iter().all(|one| viewports.iter().all(|other| one == other || is_apart(one, other)));
        if viewports.is_empty() || !are_apart {
            return vec![MapFace::whole(frame, target)];
        }
        viewports.into_iter().map(|area| MapFace { target, area }).collect()
    }

    /// Returns columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.area[2], self.area[3]]
    }

    /// Returns whether a draw with this viewport draws into the face, and not into another one of its layer.
    pub fn holds(&self, viewport: &Viewport) -> bool {
        let [left, top, width, height] = viewport.area;
        let middle = [left + width / 2.0, top + height / 2.0];
        let is_in = |axis: usize| {
            let [first, count] = [self.area[axis], self.area[axis + 2]].map(|texels| texels as f32);
            (first..first + count).contains(&middle[axis])
        };
        is_in(0) && is_in(1)
    }

    /// Returns a viewport of the layer as one of the face.
    pub fn viewport(&self, viewport: Viewport) -> Viewport {
        let [left, top, width, height] = viewport.area;
        Viewport { area: [left - self.area[0] as f32, top - self.area[1] as f32, width, height], ..viewport }
    }

    /// Returns the face's part of an image of its layer.
    pub fn part_of(&self, image: &Arc<Image>) -> Arc<Image> {
        if image.size() == self.size() {
            return image.clone();
        }
        let rows: Vec<u8> = self.rows_of(image).flatten().copied().collect();
        Arc::new(Image::packed(image.format(), self.size(), rows))
    }

    /// Returns whether two images of its layer differ within the face.
    pub fn differs(&self, one: &Image, other: &Image) -> bool {
        one.size() != other.size() || self.rows_of(one).ne(self.rows_of(other))
    }

    fn rows_of<'a>(&self, image: &'a Image) -> impl Iterator<Item = &'a [u8]> {
        let [left, top, columns, rows] = self.area.map(|texels| texels as usize);
        let bytes = image.format().texel_bytes();
        image.rows().skip(top).take(rows).filter_map(move |row| row.get(left * bytes..(left + columns) * bytes))
    }
}

/// Returns the draws of a frame that have a depth target, with that.
fn drawn(frame: &RawFrame) -> impl Iterator<Item = (RawTarget, &RawDraw)> {
    frame.events.iter().filter_map(|event| match &event.kind {
        RawKind::Draw(draw) => Some((event.depth_target?, draw.as_ref())),
        _ => None,
    })
}

/// Returns a viewport in whole texels; `None` where it is empty or reaches beyond a target of this size.
fn texels_of(viewport: [f32; 4], size: [u32; 2]) -> Option<[u32; 4]> {
    let [left, top, width, height] = viewport;
    let is_inside = |first: f32, length: f32, side: u32| first >= 0.0 && length >= 1.0 && first + length <= side as f32;
    let is_inside = is_inside(left, width, size[0]) && is_inside(top, height, size[1]);
    is_inside.then(|| viewport.map(|texels| texels.round() as u32))
}

/// Which depth targets draws into others read: themselves, or a colour target that was drawn with them, or from what was,
/// and holds depths.
#[derive(Debug, Default)]
pub(super) struct MapReads {
    /// Whether the recording says what draws sample.
    pub are_known: bool,
    /// Textures of depth targets that draws of a scene read, or colours of any kind that were drawn with them: draws that
    /// test depth, and are more than a rectangle.
    pub by_scenes: BTreeSet<usize>,
    /// Textures of depth targets that any draws read.
    pub by_any: BTreeSet<usize>,
    /// Textures of depth targets that each draw reads, by its event.
    pub by_draws: BTreeMap<u32, BTreeSet<usize>>,
}

impl MapReads {
    pub fn of(frame: &RawFrame) -> MapReads {
        let mut reads = MapReads::default();
        // For each texture the depth textures that were drawn with it.
        let mut along: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        let mut of_depths: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for event in &frame.events {
            let RawKind::Draw(draw) = &event.kind else { continue };
            reads.are_known |= draw.sampled.is_some();
            let own = event.depth_target.map(|target| target.texture);
            let sampled = |by: &BTreeMap<usize, BTreeSet<usize>>| -> Vec<usize> {
                let depths = draw.sampled.iter().flatten().filter_map(|texture| by.get(texture)).flatten();
                depths.copied().filter(|depth| Some(*depth) != own).collect()
            };
            if draw.depth.is_some() && draw.triangles.len() > 2 {
                reads.by_scenes.extend(sampled(&along));
            }
            let read: BTreeSet<usize> = sampled(&of_depths).into_iter().collect();
            reads.by_any.extend(&read);
            reads.by_draws.insert(event.id, read);
            if draw.depth.is_none() {
                // Depths that are blurred, or brought into another form, are the map's own.
                for by in [&mut along, &mut of_depths] {
                    let from = sampled(by);
                    let colors = event.color_targets.iter().map(|target| target.texture);
                    for texture in colors.filter(|texture| holds_depths(&frame.textures[*texture].format)) {
                        by.entry(texture).or_default().extend(&from);
                    }
                }
            }
            let Some(depth) = own else { continue };
            let with = event.color_targets.iter().map(|target| target.texture).chain([depth]);
            for texture in with {
                along.entry(texture).or_default().insert(depth);
                // A mirror or a monitor is sampled in colours: they are no depths.
                if texture == depth || holds_depths(&frame.textures[texture].format) {
                    of_depths.entry(texture).or_default().insert(depth);
                }
            }
        }
        reads
    }
}

/// Returns whether colours of a format may be depths or their moments: one or two floats.
fn holds_depths(format: &RawFormat) -> bool {
    let RawFormat::Other(name) = format else { return false };
    matches!(name.as_str(), "R16_FLOAT" | "R32_FLOAT" | "R16G16_FLOAT" | "R32G32_FLOAT")
}
