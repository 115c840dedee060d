//! Which of a frame's targets are the picture, and which are depth maps.

use crate::import::ImportError;
use crate::import::raw::{RawFormat, RawFrame, RawKind, RawTarget, RawTexture};
use crate::plan::{Attachment, AttachmentRole, PlanMap};
use std::collections::{BTreeMap, BTreeSet};
use wgpu_types::TextureFormat;

/// Which of the followed targets a draw draws into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum DrawTarget {
    /// The picture, with its depth.
    Picture,
    /// The picture's colours alone.
    Colors,
    /// A layer of a depth map.
    Map(usize, u32),
}

/// The targets of an imported frame that the plan has: the picture, its depth and stencil, and shadow maps.
#[derive(Debug)]
pub(super) struct FollowedTargets {
    /// The picture's depth and stencil.
    pub depth: RawTarget,
    /// The picture's colours, if it has any.
    pub color: Option<RawTarget>,
    /// Textures of depth maps, each with its mip level, in the order of their first draws.
    pub maps: Vec<RawTarget>,
}

impl FollowedTargets {
    /// Chooses the targets that are followed. The picture's depth is the depth target that gets most triangles, one with
    /// colour targets first, and none that scene draws into another one sample; its colour the colour target drawn with
    /// most. Other depth textures are maps: those that are sampled, where the recording says what is. Maps for which
    /// `is_left_out` is true (by their texture) are not followed. Fails without a depth target, or with a multisampled
    /// one.
    pub fn of(frame: &RawFrame, is_left_out: impl Fn(usize) -> bool) -> Result<FollowedTargets, ImportError> {
        let mut drawn: BTreeMap<(bool, RawTarget), usize> = BTreeMap::new();
        let mut colors: BTreeMap<(RawTarget, RawTarget), usize> = BTreeMap::new();
        let readers = MapReads::of(frame);
        for event in &frame.events {
            let (RawKind::Draw(draw), Some(depth)) = (&event.kind, event.depth_target) else { continue };
            let is_shown = !event.color_targets.is_empty() && !readers.by_scenes.contains(&depth.texture);
            *drawn.entry((is_shown, depth)).or_default() += draw.triangles.len();
            if let Some(color) = event.color_targets.first() {
                *colors.entry((depth, *color)).or_default() += draw.triangles.len();
            }
        }
        let most = |counts: &BTreeMap<(bool, RawTarget), usize>| {
            counts.iter().max_by_key(|((is_shown, _), triangles)| (*is_shown, **triangles)).map(|((_, of), _)| *of)
        };
        let depth = most(&drawn).ok_or(ImportError::NoDepth)?;
        if frame.textures[depth.texture].samples > 1 {
            return Err(ImportError::Multisampled { samples: frame.textures[depth.texture].samples });
        }
        let of_picture = colors.iter().filter(|((of, _), _)| *of == depth);
        let color = of_picture.max_by_key(|(_, triangles)| **triangles).map(|((_, color), _)| *color);
        let mut stage = FollowedTargets { depth, color, maps: Vec::new() };
        let size = stage.size(frame);
        stage.color = stage.color.filter(|color| size_of(frame, *color) == size);
        for event in frame.events.iter().filter(|event| matches!(event.kind, RawKind::Draw(_))) {
            let Some(target) = event.depth_target.filter(|target| target.texture != depth.texture) else { continue };
            let is_known = stage.maps.iter().any(|map| map.texture == target.texture);
            let RawTexture { format, samples, layers, .. } = &frame.textures[target.texture];
            let is_whole = *samples == 1 && *layers as usize <= PlanMap::MOST_FACES;
            let is_read = !readers.are_known || readers.by_any.contains(&target.texture);
            if !is_known && is_read && format.has_depth() && is_whole && !is_left_out(target.texture) {
                stage.maps.push(RawTarget { layer: 0, ..target });
            }
        }
        Ok(stage)
    }

    /// Returns the width and height of the picture in pixels.
    pub fn size(&self, frame: &RawFrame) -> [u32; 2] {
        size_of(frame, self.depth)
    }

    /// Returns whether a depth target is the picture or a face of a map; `None` where it is neither and not followed.
    pub fn place(&self, target: RawTarget) -> Option<DrawTarget> {
        if target == self.depth {
            return Some(DrawTarget::Picture);
        }
        let map = self.maps.iter().position(|map| (map.texture, map.mip) == (target.texture, target.mip))?;
        (target.layer < PlanMap::MOST_FACES as u32).then_some(DrawTarget::Map(map, target.layer))
    }

    /// Returns the recorded depth target of a place: the picture's depth also for draws into colours alone.
    pub fn target(&self, place: DrawTarget) -> RawTarget {
        match place {
            DrawTarget::Picture | DrawTarget::Colors => self.depth,
            DrawTarget::Map(map, layer) => RawTarget { layer, ..self.maps[map] },
        }
    }

    /// Returns the plan's attachment for a place's depth and stencil, with the recorded name and size; of layers as
    /// many as a map's texture has, else one.
    pub fn attachment(&self, frame: &RawFrame, place: DrawTarget, role: AttachmentRole) -> Attachment {
        let target = self.target(place);
        let texture = &frame.textures[target.texture];
        let layers = if matches!(place, DrawTarget::Map(..)) { texture.layers.max(1) } else { 1 };
        Attachment {
            name: texture.name.clone(),
            role,
            format: format_of(&texture.format),
            size: size_of(frame, target),
            layers,
        }
    }
}

/// Which depth targets draws into others read: themselves, or a colour target that was drawn with them, or from what was,
/// and holds depths.
#[derive(Debug, Default)]
struct MapReads {
    /// Whether the recording says what draws sample.
    are_known: bool,
    /// Textures of depth targets that draws of a scene read, or colours of any kind that were drawn with them: draws that
    /// test depth, and are more than a rectangle.
    by_scenes: BTreeSet<usize>,
    /// Textures of depth targets that any draws read.
    by_any: BTreeSet<usize>,
}

impl MapReads {
    fn of(frame: &RawFrame) -> MapReads {
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
            reads.by_any.extend(sampled(&of_depths));
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

/// Returns width and height of a mip level.
pub(super) fn size_of(frame: &RawFrame, target: RawTarget) -> [u32; 2] {
    frame.textures[target.texture].size.map(|side| (side >> target.mip.min(31)).max(1))
}

fn format_of(format: &RawFormat) -> TextureFormat {
    match format {
        RawFormat::D16 => TextureFormat::Depth16Unorm,
        RawFormat::D24 => TextureFormat::Depth24Plus,
        RawFormat::D24S8 => TextureFormat::Depth24PlusStencil8,
        RawFormat::D32FS8 | RawFormat::S8 => TextureFormat::Depth32FloatStencil8,
        _ => TextureFormat::Depth32Float,
    }
}
