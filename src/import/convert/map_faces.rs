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
    /// Whether that is the whole layer.
    pub is_whole: bool,
}

impl MapFace {
    /// Returns the whole of a target as a face.
    pub fn whole(frame: &RawFrame, target: RawTarget) -> MapFace {
        let [columns, rows] = frame.size_of(target);
        MapFace { target, area: [0, 0, columns, rows], is_whole: true }
    }

    /// Returns the faces of all shadow maps of a frame whose picture has the depth texture `picture`, in the order of
    /// their textures' first draws, and by layers: of those textures that are read, where the recording says what is.
    pub fn all(frame: &RawFrame, reads: &MapReads, picture: usize) -> Vec<MapFace> {
        let mut maps: Vec<(usize, u32)> = Vec::new();
        let mut viewports: BTreeMap<RawTarget, Vec<Option<[u32; 4]>>> = BTreeMap::new();
        for (target, draw) in drawn(frame) {
            let RawTexture { format, samples, layers, .. } = &frame.textures[target.texture];
            let is_whole = *samples == 1 && *layers as usize <= PlanMap::MOST_FACES;
            let is_read = !reads.are_known || reads.by_any.contains(&target.texture);
            if target.texture == picture || !is_read || !format.has_depth() || !is_whole {
                continue;
            }
            let of_target = viewports.entry(target).or_insert_with(|| {
                if !maps.iter().any(|(texture, _)| *texture == target.texture) {
                    maps.push((target.texture, target.mip));
                }
                Vec::new()
            });
            let viewport = texels_of(draw.view.viewport, frame.size_of(target));
            // One more than there may be says that they are too many.
            if of_target.len() <= PlanMap::MOST_FACES && !of_target.contains(&viewport) {
                of_target.push(viewport);
            }
        }
        let layers = maps.into_iter().flat_map(|(texture, mip)| {
            let layers = frame.textures[texture].layers.max(1);
            (0..layers).map(move |layer| RawTarget { texture, layer, mip })
        });
        layers
            .flat_map(|target| MapFace::of(frame, target, viewports.get(&target).map_or(&[], Vec::as_slice)))
            .collect()
    }

    /// Returns the faces of a layer: one for each viewport that draws have there, in the order of their first draws, where
    /// all are in the layer and no two overlap; else the whole.
    fn of(frame: &RawFrame, target: RawTarget, viewports: &[Option<[u32; 4]>]) -> Vec<MapFace> {
        let whole = MapFace::whole(frame, target);
        let is_apart = |one: &[u32; 4], other: &[u32; 4]| {
            (0..2).any(|axis| one[axis] + one[axis + 2] <= other[axis] || other[axis] + other[axis + 2] <= one[axis])
        };
        let are_known = viewports.iter().copied().collect::<Option<Vec<[u32; 4]>>>();
        let areas = are_known.filter(|areas| (1..=PlanMap::MOST_FACES).contains(&areas.len())).filter(|areas| {
            areas.iter().enumerate().all(|(index, one)| areas[..index].iter().all(|other| is_apart(one, other)))
        });
        let face = |area| MapFace { target, area, is_whole: area == whole.area };
        areas.map_or_else(|| vec![whole], |areas| areas.into_iter().map(face).collect())
    }

    /// Returns columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.area[2], self.area[3]]
    }

    /// Returns whether a draw with this viewport draws into the face, and not into another one of its layer. A whole layer
    /// is drawn into by any, however far it reaches.
    pub fn holds(&self, viewport: &Viewport) -> bool {
        let [left, top, width, height] = viewport.area;
        let middle = [left + width / 2.0, top + height / 2.0];
        let is_in = |axis: usize| {
            let [first, count] = [self.area[axis], self.area[axis + 2]].map(|texels| texels as f32);
            (first..first + count).contains(&middle[axis])
        };
        self.is_whole || (is_in(0) && is_in(1))
    }

    /// Returns a viewport of the layer as one of the face.
    pub fn viewport(&self, viewport: Viewport) -> Viewport {
        let [left, top, width, height] = viewport.area;
        Viewport { area: [left - self.area[0] as f32, top - self.area[1] as f32, width, height], ..viewport }
    }

    /// Returns the face's part of an image of its layer.
    pub fn part_of(&self, image: &Arc<Image>) -> Arc<Image> {
        if self.is_whole {
            return image.clone();
        }
        let [_, _, columns, rows] = self.area.map(|texels| texels as usize);
        let mut bytes = Vec::with_capacity(columns * rows * image.format().texel_bytes());
        self.rows_of(image).for_each(|row| bytes.extend_from_slice(row));
        Arc::new(Image::packed(image.format(), self.size(), bytes))
    }

    /// Returns whether two images of its layer differ within the face.
    pub fn differs(&self, one: &Image, other: &Image) -> bool {
        one.size() != other.size() || self.rows_of(one).ne(self.rows_of(other))
    }

    fn rows_of<'a>(&self, image: &'a Image) -> impl Iterator<Item = &'a [u8]> {
        let [left, top, columns, rows] = self.area.map(|texels| texels as usize);
        let bytes = image.format().texel_bytes();
        image.rows().skip(top).take(rows).map(move |row| &row[left * bytes..(left + columns) * bytes])
    }
}

/// Returns the draws of a frame that have a depth target, with that.
fn drawn(frame: &RawFrame) -> impl Iterator<Item = (RawTarget, &RawDraw)> {
    frame.events.iter().filter_map(|event| match &event.kind {
        RawKind::Draw(draw) => Some((event.depth_target?, draw.as_ref())),
        _ => None,
    })
}

/// Returns a viewport in whole texels: left, top, columns and rows; `None` where it is empty or reaches beyond a target of this
/// size.
fn texels_of(viewport: [f32; 4], size: [u32; 2]) -> Option<[u32; 4]> {
    let span = |axis: usize| {
        let [first, last] = [viewport[axis], viewport[axis] + viewport[axis + 2]].map(f32::round);
        let is_inside = first >= 0.0 && last > first && last <= size[axis] as f32;
        is_inside.then_some([first as u32, (last - first) as u32])
    };
    let ([left, columns], [top, rows]) = (span(0)?, span(1)?);
    Some([left, top, columns, rows])
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::PixelFormat;

    #[test]
    fn viewports_are_whole_texels_within_their_target() {
        assert_eq!(texels_of([0.0, 4.0, 8.0, 4.0], [8, 8]), Some([0, 4, 8, 4]));
        // Both edges are rounded, so that halves lie beside each other and within.
        assert_eq!(texels_of([0.0, 0.0, 4.5, 9.0], [9, 9]), Some([0, 0, 5, 9]));
        assert_eq!(texels_of([4.5, 0.0, 4.5, 9.0], [9, 9]), Some([5, 0, 4, 9]));
        for outside in [[0.0, 0.0, 9.0, 8.0], [-1.0, 0.0, 4.0, 4.0], [f32::NAN, 0.0, 4.0, 4.0], [0.0, 0.0, 0.2, 4.0]] {
            assert_eq!(texels_of(outside, [8, 8]), None, "{outside:?}");
        }
    }

    #[test]
    fn a_part_has_its_own_texels_and_is_asked_for_them_alone() {
        let target = RawTarget { texture: 0, layer: 0, mip: 0 };
        let face = MapFace { target, area: [1, 2, 2, 1], is_whole: false };
        let image = |changed: u8| {
            let mut bytes: Vec<u8> = (0..12).collect();
            bytes[0] = changed;
            Arc::new(Image::packed(PixelFormat::U8, [4, 3], bytes))
        };
        assert_eq!(face.part_of(&image(0)).rows().collect::<Vec<_>>(), [&[9_u8, 10][..]]);
        assert!(!face.differs(&image(0), &image(7)), "what differs is beside it");
        let whole = MapFace { area: [0, 0, 4, 3], is_whole: true, ..face };
        assert!(whole.differs(&image(0), &image(7)));
        let beyond = Viewport { area: [-2.0, 0.0, 40.0, 30.0], depth: [0.0, 1.0] };
        assert_eq!([face.holds(&beyond), whole.holds(&beyond)], [false, true]);
        assert_eq!(face.viewport(Viewport { area: [1.0, 2.0, 2.0, 1.0], ..beyond }).area, [0.0, 0.0, 2.0, 1.0]);
    }
}
