//! Which texel of a light's shadow map each pixel of the picture reads: the pixel's surface is moved along its normal
//! and then transformed into the map, as in `arriving_by_map.wgsl`. Computed once for a frame and light.

use crate::capture::{Capture, CapturedMap};
use crate::plan::FramePlan;
use crate::reading::fragments::{FragmentInputs, SurfaceFragments};
use crate::technique::MapSettings;
use glam::{DMat4, DVec2, DVec3, DVec4};
use rayon::prelude::*;
use std::sync::Arc;

/// Factor by which a face is enlarged, so that points on the border between two faces belong to both, as in
/// `arriving_by_map.wgsl`.
const BORDER: f64 = 1.0001;

/// A texel of a light's map: its face, column and row, counted from the upper left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapTexel {
    /// Index of the face.
    pub face: usize,
    /// Column and row.
    pub at: [u32; 2],
}

/// For every pixel, which texels of a light's shadow map its shader reads.
#[derive(Debug)]
pub struct MapReaders {
    size: [u32; 2],
    lookup: MapProjection,
    fragments: SurfaceFragments,
    /// For each pixel the first texel that it reads: face, column, row.
    first: Vec<Option<[i16; 3]>>,
}

impl MapReaders {
    /// Finds the texels that pixels read of the map of the light with this index, at the end of the frame; `None` where
    /// the light has no shadow map, nothing is drawn, or another program drew the frame.
    pub fn new(capture: &Capture, plan: Option<&Arc<FramePlan>>, light: usize) -> Option<MapReaders> {
        // How another program looks its map up is not known.
        let lookup = MapProjection::new(capture, plan, light).filter(|_| capture.origin.is_none())?;
        let fragments = SurfaceFragments::new(capture, plan, light)?;
        let of_pixel = |at: [u32; 2]| match lookup.bias_normal == 0.0 {
            // Normals take time to compute, and change nothing here.
            true => fragments.place(at).filter(|(_, reads)| *reads).and_then(|(world, _)| lookup.first_of(world)),
            false => fragments.at(at).filter(|fragment| fragment.reads).and_then(|fragment| lookup.first(&fragment)),
        };
        let [width, height] = capture.size.map(|side| side as usize);
        let place = |index: usize| [(index % width) as u32, (index / width) as u32];
        let first = (0..width * height).into_par_iter().map(|index| of_pixel(place(index))).collect();
        Some(MapReaders { size: capture.size, lookup, fragments, first })
    }

    /// Returns whether normals are those that the shader had; otherwise they are guessed from depths.
    pub fn knows_normals(&self) -> bool {
        self.fragments.are_drawn()
    }

    /// Returns the texel that a pixel (column, row) reads, with a filter the middle one, kept inside the map; `None`
    /// where it reads none or lies outside the picture.
    pub fn texel_of(&self, [x, y]: [u32; 2]) -> Option<MapTexel> {
        let index = (y as usize).checked_mul(self.size[0] as usize)? + x as usize;
        let [face, column, row] = (*self.first.get(index).filter(|_| x < self.size[0])?)?;
        let middle = (self.lookup.filter / 2) as i16;
        let at = [0, 1].map(|axis| {
            let first = [column, row][axis].saturating_add(middle).max(0) as u32;
            first.min(self.lookup.size[axis].saturating_sub(1))
        });
        Some(MapTexel { face: face as usize, at })
    }

    /// Returns the pixels (column, row) that read a texel, also those whose filter includes it, in reading order.
    pub fn of_texel(&self, texel: MapTexel) -> Vec<[u32; 2]> {
        let reads = |first: [i16; 3]| {
            let is_in = |first: i16, at: u32, side: u32| {
                let last = i32::from(first) + self.lookup.filter as i32 - 1;
                let [from, to] = [i32::from(first), last].map(|place| place.clamp(0, (side as i32 - 1).max(0)));
                (from..=to).contains(&(at as i32))
            };
            first[0] as usize == texel.face
                && is_in(first[1], texel.at[0], self.lookup.size[0])
                && is_in(first[2], texel.at[1], self.lookup.size[1])
        };
        let width = self.size[0].max(1) as usize;
        let place = |index: usize| [(index % width) as u32, (index / width) as u32];
        let found = self.first.iter().enumerate().filter(|(_, first)| first.is_some_and(reads));
        found.map(|(index, _)| place(index)).collect()
    }

    /// Returns the depth of the pixel's surface in the map (normalised device z), with which texels are compared;
    /// `None` where it reads none.
    pub fn depth_of(&self, pixel: [u32; 2]) -> Option<f64> {
        let fragment = self.fragments.at(pixel).filter(|fragment| fragment.reads)?;
        let (_, clip) = self.lookup.place(&fragment)?;
        Some(clip.z / clip.w)
    }

    /// Returns the texels that a pixel is compared with, row by row, each with the depth of the pixel's surface there
    /// (normalised device z, on its plane where the bias is by plane); beyond the map's border, the border's texel
    /// again. Empty where no face sees the surface or its shader has no lookup; surfaces facing away are looked up.
    pub fn compared(&self, pixel: [u32; 2]) -> Vec<(MapTexel, f64)> {
        let found = self.fragments.at(pixel).filter(|fragment| fragment.reads);
        let found = found.and_then(|fragment| Some((fragment, self.lookup.place(&fragment)?)));
        let Some((fragment, (face, clip))) = found else { return Vec::new() };
        let [_, column, row] = self.lookup.first_at(face, clip).map(i64::from);
        let slope = if self.lookup.by_plane { self.lookup.slope(face, clip, fragment.plane) } else { DVec2::ZERO };
        let place = self.lookup.texel(clip);
        let size = DVec2::new(f64::from(self.lookup.size[0]), f64::from(self.lookup.size[1]));
        let at = |first: i64, offset: u32, side: u32| {
            (first + i64::from(offset)).clamp(0, i64::from(side.saturating_sub(1))) as u32
        };
        let texels = (0..self.lookup.filter).flat_map(|down| (0..self.lookup.filter).map(move |right| [right, down]));
        let compare = |[right, down]: [u32; 2]| {
            let at = [at(column, right, self.lookup.size[0]), at(row, down, self.lookup.size[1])];
            let middle = DVec2::new(f64::from(at[0]) + 0.5, f64::from(at[1]) + 0.5);
            let offset = (middle - place) / size * DVec2::new(2.0, -2.0);
            (MapTexel { face, at }, clip.z / clip.w + slope.dot(offset))
        };
        texels.map(compare).collect()
    }

    /// Returns the pixel's footprint in the map: the face that it reads, and its four corners on the plane of its
    /// surface, in texels and in order round it. `None` where it reads none, or a corner is behind the light.
    pub fn footprint(&self, pixel: [u32; 2]) -> Option<(usize, [DVec2; 4])> {
        let fragment = self.fragments.at(pixel).filter(|fragment| fragment.reads)?;
        let (face, _) = self.lookup.place(&fragment)?;
        let pushed = self.lookup.push(face, &fragment)?;
        let corners = self.fragments.corners(pixel, &fragment)?;
        let place = |corner: DVec3| {
            let clip = self.lookup.matrices[face] * (corner + pushed).extend(1.0);
            (clip.w > 0.0).then(|| self.lookup.texel(clip))
        };
        let [a, b, c, d] = corners.map(place);
        Some((face, [a?, b?, c?, d?]))
    }

    /// Projects a texel onto the plane of the surface that a pixel shows: returns its four corners, world space, in
    /// order round it. `None` where the pixel reads no texel, or the plane is edge-on to the light.
    pub fn texel_on_surface(&self, texel: MapTexel, pixel: [u32; 2]) -> Option<[DVec3; 4]> {
        let fragment = self.fragments.at(pixel).filter(|fragment| fragment.reads)?;
        let pushed = self.lookup.push(texel.face, &fragment)?;
        let world_from_clip = self.lookup.matrices.get(texel.face)?.inverse();
        // A point of this plane, once moved, is looked up on the surface.
        let plane = fragment.plane.extend(-fragment.plane.dot(fragment.world + pushed));
        let corner = |right: u32, down: u32| {
            let place = DVec2::new(f64::from(texel.at[0] + right), f64::from(texel.at[1] + down));
            let size = DVec2::new(f64::from(self.lookup.size[0]), f64::from(self.lookup.size[1]));
            let device = (place / size * 2.0 - 1.0) * DVec2::new(1.0, -1.0);
            // The ends of the light ray through the texel's corner: one point of it, and another at another depth.
            let at = world_from_clip * device.extend(0.0).extend(1.0);
            let along = world_from_clip * DVec4::Z;
            let point = at - along * (plane.dot(at) / plane.dot(along));
            let point = point.truncate() / point.w;
            point.is_finite().then(|| point - pushed)
        };
        Some([corner(0, 0)?, corner(1, 0)?, corner(1, 1)?, corner(0, 1)?])
    }

    /// Returns the width in metres of a face's texel at a pixel's surface; `None` where the face does not see it.
    pub fn texel_width(&self, face: usize, pixel: [u32; 2]) -> Option<f64> {
        self.lookup.width(face, self.fragments.at(pixel)?.world)
    }
}

/// The transforms and settings with which points are looked up in a light's shadow map.
#[derive(Debug)]
struct MapProjection {
    /// Clip space of each face from world space.
    matrices: Vec<DMat4>,
    /// For each face, whether no pass draws it. Empty where that is not known, as for a capture folder.
    left_out: Vec<bool>,
    /// Texels along each side.
    size: [u32; 2],
    /// The light's position, homogeneous, world space.
    light: DVec4,
    /// Texels along each side that are compared (PCF).
    filter: u32,
    /// Normal offset: how many texels points are moved along their normals.
    bias_normal: f64,
    /// Receiver-plane bias: whether each texel is compared with the depth of the surface's plane there.
    by_plane: bool,
}

impl MapProjection {
    /// Returns the projection of a light's shadow map with its filter and bias; `None` where it has no map, or one of
    /// colours instead of depths.
    fn new(capture: &Capture, plan: Option<&Arc<FramePlan>>, light: usize) -> Option<MapProjection> {
        let of = capture.lights.get(light)?;
        let map: &CapturedMap = of.map.as_ref().filter(|map| !map.holds_colors())?;
        let settings = MapSettings::read(&capture.settings);
        Some(MapProjection {
            left_out: plan
                .and_then(|plan| plan.lights.get(light)?.map.as_ref())
                .map_or_else(Vec::new, |map| map.faces.iter().map(Option::is_none).collect()),
            matrices: map.clip_from_light.iter().map(|clip| *clip * map.light_from_world).collect(),
            size: map.faces.first()?.size(),
            light: of.position,
            filter: settings.filter_width,
            bias_normal: settings.bias_normal,
            by_plane: settings.bias_receiver_plane,
        })
    }

    /// Returns the face that sees a world position, and the clip-space position in that face; where two do, one that is
    /// drawn. `None` where no face does: the position is behind the light or outside.
    fn seen(&self, world: DVec3) -> Option<(usize, DVec4)> {
        let is_in = |clip: &DVec4| clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w * BORDER;
        let clips = || self.matrices.iter().map(|matrix| *matrix * world.extend(1.0)).enumerate();
        // On a border between two faces, the shader finds the one that is drawn: it has no other.
        let is_drawn = |face: usize| !self.left_out.get(face).copied().unwrap_or(false);
        let drawn = clips().find(|(face, clip)| is_drawn(*face) && is_in(clip));
        drawn.or_else(|| clips().find(|(_, clip)| is_in(clip)))
    }

    /// Returns the face that a fragment reads, and the clip-space position at which it is looked up, moved by the
    /// normal offset; the face is chosen before that. `None` where no face sees it.
    fn place(&self, fragment: &FragmentInputs) -> Option<(usize, DVec4)> {
        let (face, _) = self.seen(fragment.world)?;
        Some((face, self.matrices[face] * (fragment.world + self.push(face, fragment)?).extend(1.0)))
    }

    /// Returns the normal offset of a fragment for a lookup in a face, a world-space vector in metres: so many texels,
    /// times the sine of the angle between normal and light. `None` where the face does not see the fragment.
    fn push(&self, face: usize, fragment: &FragmentInputs) -> Option<DVec3> {
        if self.bias_normal == 0.0 {
            return Some(DVec3::ZERO);
        }
        let to_light = (self.light.truncate() - fragment.world * self.light.w).normalize_or_zero();
        let cosine = fragment.normal.dot(to_light);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        Some(fragment.normal * (self.bias_normal * self.width(face, fragment.world)? * sine))
    }

    /// Returns the width of a face's texel at a world position, metres, as it lies across the light's view; `None`
    /// behind the light.
    fn width(&self, face: usize, world: DVec3) -> Option<f64> {
        let matrix = self.matrices.get(face)?;
        let distance = (*matrix * world.extend(1.0)).w;
        let focal = matrix.row(0).truncate().length();
        (distance > 0.0 && focal > 0.0).then(|| 2.0 * distance / (focal * f64::from(self.size[0])))
    }

    /// Converts a clip-space position to texels of the face, from its upper left corner; the result may lie outside.
    fn texel(&self, clip: DVec4) -> DVec2 {
        let size = DVec2::new(f64::from(self.size[0]), f64::from(self.size[1]));
        (DVec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5) * size
    }

    /// Returns how depth changes along x and y of a face (normalized device coordinates) on a plane through `clip` with
    /// the world normal `plane`; zero where the light sees the plane edge-on.
    fn slope(&self, face: usize, clip: DVec4, plane: DVec3) -> DVec2 {
        let along = |direction: DVec3| {
            let moved = self.matrices[face] * direction.extend(0.0);
            (moved.truncate() - clip.truncate() * (moved.w / clip.w)) / clip.w
        };
        let (right, up) = plane.any_orthonormal_pair();
        let (a, b) = (along(right), along(up));
        let area = a.x * b.y - a.y * b.x;
        if area == 0.0 {
            return DVec2::ZERO;
        }
        DVec2::new(a.z * b.y - b.z * a.y, b.z * a.x - a.z * b.x) / area
    }

    /// Returns face, column and row of the first texel (upper left of the filter, which may lie outside the map) that a
    /// fragment reads; `None` where no face sees it.
    fn first(&self, fragment: &FragmentInputs) -> Option<[i16; 3]> {
        let (face, clip) = self.place(fragment)?;
        Some(self.first_at(face, clip))
    }

    /// Returns face, column and row of the first texel that a world position reads without normal offset; `None` where
    /// no face sees it.
    fn first_of(&self, world: DVec3) -> Option<[i16; 3]> {
        self.seen(world).map(|(face, clip)| self.first_at(face, clip))
    }

    fn first_at(&self, face: usize, clip: DVec4) -> [i16; 3] {
        let first = (self.texel(clip) - 0.5 * f64::from(self.filter - 1)).floor();
        [face as i16, first.x as i16, first.y as i16]
    }
}
