//! Which texel of a light's shadow map each pixel of the picture reads: the pixel's surface is moved along its normal
//! and then transformed into the map, as in `arriving_by_map.wgsl`. Computed once for a frame and light.

use crate::capture::{Capture, MapProjection};
use crate::plan::{FramePlan, MapLookup};
use crate::reading::fragments::SurfaceFragments;
use crate::technique::MapSettings;
use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;
use std::sync::Arc;

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
    /// Whether the light sends out nothing: it is off, or black. False where no plan tells.
    is_off: bool,
}

impl MapReaders {
    /// Finds the texels that pixels read of the map of the light with this index, at the end of the frame; `None` where
    /// the light has no shadow map, nothing is drawn, or another program drew the frame and the map's view is not known.
    pub fn new(capture: &Capture, plan: Option<&Arc<FramePlan>>, light: usize) -> Option<MapReaders> {
        if capture.origin.is_none() {
            return MapReaders::of_own(capture, plan, light);
        }
        let lookup = MapProjection::recorded(capture, light)?;
        Some(MapReaders::find(capture, plan, light, lookup, SurfaceFragments::new(capture, plan, light)?))
    }

    /// As [`MapReaders::new`] for a frame of our own.
    pub fn of_own(capture: &Capture, plan: Option<&Arc<FramePlan>>, light: usize) -> Option<MapReaders> {
        let lookup = own_projection(capture, plan, light)?;
        Some(MapReaders::find(capture, plan, light, lookup, SurfaceFragments::of_own(capture, plan, light)?))
    }

    fn find(
        capture: &Capture,
        plan: Option<&Arc<FramePlan>>,
        light: usize,
        lookup: MapProjection,
        fragments: SurfaceFragments,
    ) -> MapReaders {
        let of_pixel = |at: [u32; 2]| match lookup.lookup().bias_normal == 0.0 {
            // Normals take time to compute, and change nothing here.
            true => fragments.place(at).filter(|(_, reads)| *reads).and_then(|(world, _)| lookup.first_of(world)),
            false => {
                let fragment = fragments.at(at).filter(|fragment| fragment.reads)?;
                let (face, clip) = lookup.place(fragment.world, fragment.normal)?;
                Some(lookup.first_at(face, clip))
            }
        };
        let [width, height] = capture.size.map(|side| side as usize);
        let place = |index: usize| [(index % width) as u32, (index / width) as u32];
        let first = (0..width * height).into_par_iter().map(|index| of_pixel(place(index))).collect();
        let plan_light = plan.and_then(|plan| plan.lights.get(light));
        let is_off = plan_light.is_some_and(|light| light.color == [0.0; 3]);
        MapReaders { size: capture.size, lookup, fragments, first, is_off }
    }

    /// Returns whether the light sends out nothing; false where that is not known.
    pub fn is_off(&self) -> bool {
        self.is_off
    }

    /// Returns whether a pixel (column, row) shows a surface that the map decides about and no face of the map sees.
    pub fn is_outside(&self, pixel: [u32; 2]) -> bool {
        self.texel_of(pixel).is_none() && self.fragments.place(pixel).is_some_and(|(_, reads)| reads)
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
        let middle = (self.lookup.lookup().filter_width / 2) as i16;
        let at = [0, 1].map(|axis| {
            let first = [column, row][axis].saturating_add(middle).max(0) as u32;
            first.min(self.lookup.size()[axis].saturating_sub(1))
        });
        Some(MapTexel { face: face as usize, at })
    }

    /// Returns the pixels (column, row) that read a texel, also those whose filter includes it, in reading order.
    pub fn of_texel(&self, texel: MapTexel) -> Vec<[u32; 2]> {
        let reads = |first: [i16; 3]| {
            let is_in = |first: i16, at: u32, side: u32| {
                let last = i32::from(first) + self.lookup.lookup().filter_width as i32 - 1;
                let [from, to] = [i32::from(first), last].map(|place| place.clamp(0, (side as i32 - 1).max(0)));
                (from..=to).contains(&(at as i32))
            };
            first[0] as usize == texel.face
                && is_in(first[1], texel.at[0], self.lookup.size()[0])
                && is_in(first[2], texel.at[1], self.lookup.size()[1])
        };
        let width = self.size[0].max(1) as usize;
        let place = |index: usize| [(index % width) as u32, (index / width) as u32];
        let found = self.first.iter().enumerate().filter(|(_, first)| first.is_some_and(reads));
        found.map(|(index, _)| place(index)).collect()
    }

    /// Returns what the map would hold of the pixel's surface (normalised device z, if it holds depths), with which texels
    /// are compared; `None` where it reads none.
    pub fn depth_of(&self, pixel: [u32; 2]) -> Option<f64> {
        let fragment = self.fragments.at(pixel).filter(|fragment| fragment.reads)?;
        let (_, clip) = self.lookup.place(fragment.world, fragment.normal)?;
        Some(self.lookup.quantity().of(clip))
    }

    /// Returns the texels that a pixel is compared with, row by row, each with the depth of the pixel's surface there
    /// (normalised device z, on its plane where the bias is by plane); beyond the map's border, the border's texel
    /// again. Empty where no face sees the surface or its shader has no lookup; surfaces facing away are looked up.
    pub fn compared(&self, pixel: [u32; 2]) -> Vec<(MapTexel, f64)> {
        let found = self.fragments.at(pixel).filter(|fragment| fragment.reads);
        let found = found.and_then(|fragment| Some((fragment, self.lookup.place(fragment.world, fragment.normal)?)));
        let Some((fragment, (face, clip))) = found else { return Vec::new() };
        let compared = self.lookup.compared(face, clip, fragment.world, fragment.plane);
        compared.map(|(at, depth)| (MapTexel { face, at }, depth)).collect()
    }

    /// Returns how depths are compared.
    pub fn projection(&self) -> &MapProjection {
        &self.lookup
    }

    /// Returns the pixel's footprint in the map: the face that it reads, and its four corners on the plane of its
    /// surface, in texels and in order round it. `None` where it reads none, or a corner is behind the light.
    pub fn footprint(&self, pixel: [u32; 2]) -> Option<(usize, [DVec2; 4])> {
        let fragment = self.fragments.at(pixel).filter(|fragment| fragment.reads)?;
        let (face, _) = self.lookup.place(fragment.world, fragment.normal)?;
        let pushed = self.lookup.push(face, fragment.world, fragment.normal)?;
        let corners = self.fragments.corners(pixel, &fragment)?;
        let place = |corner: DVec3| {
            let clip = *self.lookup.matrix(face)? * (corner + pushed).extend(1.0);
            (clip.w > 0.0).then(|| self.lookup.texel(clip))
        };
        let [a, b, c, d] = corners.map(place);
        Some((face, [a?, b?, c?, d?]))
    }

    /// Projects a texel onto the plane of the surface that a pixel shows: returns its four corners, world space, in
    /// order round it. `None` where the pixel reads no texel, or the plane is edge-on to the light.
    pub fn texel_on_surface(&self, texel: MapTexel, pixel: [u32; 2]) -> Option<[DVec3; 4]> {
        let fragment = self.fragments.at(pixel).filter(|fragment| fragment.reads)?;
        let pushed = self.lookup.push(texel.face, fragment.world, fragment.normal)?;
        let world_from_clip = self.lookup.matrix(texel.face)?.inverse();
        // A point of this plane, once moved, is looked up on the surface.
        let plane = fragment.plane.extend(-fragment.plane.dot(fragment.world + pushed));
        let corner = |right: u32, down: u32| {
            let place = DVec2::new(f64::from(texel.at[0] + right), f64::from(texel.at[1] + down));
            let size = DVec2::new(f64::from(self.lookup.size()[0]), f64::from(self.lookup.size()[1]));
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

/// Returns the projection of a light's shadow map of our own with its filter and bias; `None` where it has no map, or one
/// of colours instead of depths.
fn own_projection(capture: &Capture, plan: Option<&Arc<FramePlan>>, light: usize) -> Option<MapProjection> {
    let MapSettings { filter_width, bias_normal, bias_receiver_plane, .. } = MapSettings::read(&capture.settings);
    let left_out = plan
        .and_then(|plan| plan.lights.get(light)?.map.as_ref())
        .map_or_else(Vec::new, |map| map.faces.iter().map(Option::is_none).collect());
    let clear_depth = capture.map_clear_depth(light);
    let lookup = MapLookup { clear_depth, bias_normal: bias_normal as f32, bias_receiver_plane, filter_width };
    MapProjection::new(capture, light, lookup, left_out)
}
