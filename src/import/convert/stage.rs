//! Which of a frame's targets are the picture, and which are depth maps.

use super::map_faces::{MapFace, MapReads};
use crate::import::ImportError;
use crate::import::raw::{RawEvent, RawFormat, RawFrame, RawKind, RawTarget};
use crate::plan::{Attachment, AttachmentRole, LightId, Viewport};
use std::collections::BTreeMap;
use wgpu_types::TextureFormat;

/// Which of the followed targets a draw draws into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum DrawTarget {
    /// The picture, with its depth.
    Picture,
    /// The picture's colours alone.
    Colors,
    /// A face of a light's shadow map, by the indices of both.
    Map(usize, usize),
}

/// The targets of an imported frame that the plan has: the picture, its depth and stencil, and shadow maps.
#[derive(Debug)]
pub(super) struct FollowedTargets {
    /// The picture's depth and stencil.
    pub depth: RawTarget,
    /// The picture's colours, if it has any.
    pub color: Option<RawTarget>,
    /// Shadow maps, one a light, each with its faces: layers of any textures, or viewports in them.
    pub maps: Vec<Vec<MapFace>>,
    /// Which depth textures draws sample.
    reads: MapReads,
}

impl FollowedTargets {
    /// Chooses the targets that are followed. The picture's depth is the depth target that gets most triangles, of equal
    /// ones the largest, one with colour targets first, and none that scene draws into another one sample; its colour the
    /// colour target drawn with most. Other depth textures are maps: those that are sampled, where the recording says what
    /// is. Each of their faces is a map of its own, as it is not known yet which of them share a light. Fails without a
    /// depth target, or with a multisampled one of which no sample was recorded.
    pub fn of(frame: &RawFrame) -> Result<FollowedTargets, ImportError> {
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
            let area = |of: &RawTarget| frame.size_of(*of).map(u64::from).into_iter().product::<u64>();
            counts.iter().max_by_key(|((is_shown, of), count)| (*is_shown, **count, area(of))).map(|((_, of), _)| *of)
        };
        let depth = most(&drawn).ok_or(ImportError::NoDepth)?;
        let is_known = |event: &RawEvent| event.depth_target == Some(depth) && event.after.depth.is_some();
        if frame.textures[depth.texture].samples > 1 && !frame.events.iter().any(is_known) {
            return Err(ImportError::Multisampled { samples: frame.textures[depth.texture].samples });
        }
        let of_picture = colors.iter().filter(|((of, _), _)| *of == depth);
        let color = of_picture.max_by_key(|(_, triangles)| **triangles).map(|((_, color), _)| *color);
        let faces = MapFace::all(frame, &readers, depth.texture);
        let maps = faces.into_iter().map(|face| vec![face]).collect();
        let mut stage = FollowedTargets { depth, color, maps, reads: readers };
        let size = stage.size(frame);
        stage.color = stage.color.filter(|color| frame.size_of(*color) == size);
        Ok(stage)
    }

    /// Returns the width and height of the picture in pixels.
    pub fn size(&self, frame: &RawFrame) -> [u32; 2] {
        frame.size_of(self.depth)
    }

    /// Returns which target a draw with this viewport draws into; `None` where it is not followed.
    pub fn place(&self, target: RawTarget, viewport: &Viewport) -> Option<DrawTarget> {
        self.places(target).find(|place| self.face(*place).is_none_or(|face| face.holds(viewport)))
    }

    /// Returns the picture, or the faces of maps, that are parts of a depth target.
    pub fn places(&self, target: RawTarget) -> impl Iterator<Item = DrawTarget> {
        let picture = (target == self.depth).then_some(DrawTarget::Picture);
        let faces = self.maps.iter().enumerate().flat_map(move |(map, faces)| {
            let of_target = faces.iter().enumerate().filter(move |(_, face)| face.target == target);
            of_target.map(move |(face, _)| DrawTarget::Map(map, face))
        });
        picture.into_iter().chain(faces)
    }

    /// Returns the lights whose maps the draw of an event samples.
    pub fn sampled_by(&self, event: u32) -> Vec<LightId> {
        let Some(read) = self.reads.by_draws.get(&event) else { return Vec::new() };
        let is_read = |map: &usize| self.maps[*map].iter().any(|face| read.contains(&face.target.texture));
        (0..self.maps.len()).filter(is_read).map(LightId).collect()
    }

    /// Returns the face of a map; `None` for the picture.
    pub fn face(&self, place: DrawTarget) -> Option<&MapFace> {
        match place {
            DrawTarget::Picture | DrawTarget::Colors => None,
            DrawTarget::Map(map, face) => Some(&self.maps[map][face]),
        }
    }

    /// Returns the recorded depth target of a place: the picture's depth also for draws into colours alone.
    pub fn target(&self, place: DrawTarget) -> RawTarget {
        self.face(place).map_or(self.depth, |face| face.target)
    }

    /// Returns the part of the recorded depth target that a place is: left, top, columns and rows.
    pub fn area(&self, frame: &RawFrame, place: DrawTarget) -> [u32; 4] {
        self.face(place).map_or_else(|| MapFace::whole(frame, self.depth).area, |face| face.area)
    }

    /// Returns the plan's attachment for a place's depth and stencil, with the recorded name and size; of layers as
    /// many as a map has faces, else one.
    pub fn attachment(&self, frame: &RawFrame, place: DrawTarget, role: AttachmentRole) -> Attachment {
        let target = self.target(place);
        let texture = &frame.textures[target.texture];
        let layers = if let DrawTarget::Map(map, _) = place { self.maps[map].len() as u32 } else { 1 };
        let [_, _, columns, rows] = self.area(frame, place);
        Attachment {
            name: texture.name.clone(),
            role,
            format: format_of(&texture.format),
            size: [columns, rows],
            layers,
            depth_bits: None,
        }
    }
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
