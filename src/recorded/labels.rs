//! The labels of another program's frame: lit is what the stencil test of the light's pass lets through, or in shadow
//! where that pass darkens the picture; or lit is what the light's shadow map holds nothing nearer for.

use super::SeenSurfaces;
use super::darkening::{asking_pass, passes_uncounted};
use crate::capture::{Capture, Image, MapProjection, PixelFormat, PixelUnprojection};
use crate::plan::{ColorWrite, FramePlan, LightId};
use crate::stencil_machine::stencil_passes;
use crate::truth::{BACKGROUND, LIT, SHADOW};
use glam::{DVec2, DVec3, UVec2};
use std::sync::Arc;

/// Returns a byte a pixel, as techniques label them: lit, in shadow, or background where no surface was drawn. `None`
/// where no pass of the light tests the stencil, and no view of a map of its is known.
pub fn labels(plan: &FramePlan, capture: &Capture, light: LightId, seen: &SeenSurfaces) -> Option<Arc<Image>> {
    by_stencil(plan, capture, light).or_else(|| by_map(capture, light, seen))
}

/// Returns labels by the light's map as it is at the end; outside of it all is lit.
fn by_map(capture: &Capture, light: LightId, seen: &SeenSurfaces) -> Option<Arc<Image>> {
    let reading = MapReading::new(capture, light, seen)?;
    let [width, height] = capture.size;
    let labels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).map(|at| reading.label(at));
    Some(Arc::new(Image::packed(PixelFormat::U8, capture.size, labels.collect::<Vec<u8>>())))
}

/// Returns for each pixel whether its surface lies outside of what the map of a point light with a single face covers, as a
/// spot light's: what a program lights there, if anything, is not for the map to say. `None` for other lights.
pub fn outside_cone(capture: &Capture, light: LightId) -> Option<Vec<bool>> {
    let of = capture.lights.get(light.0)?;
    let is_spot = of.position.w != 0.0 && of.map.as_ref()?.faces.len() == 1;
    let projection = MapProjection::recorded(capture, light.0).filter(|_| is_spot)?;
    let depth = &capture.frame_at(capture.steps.len().checked_sub(1)?)?.depth.image;
    let pixels = PixelUnprojection::new(capture);
    let is_outside = |at: [u32; 2]| {
        let world = depth.depth_at(at).and_then(|depth| pixels.at(at, depth));
        world.is_some_and(|world| projection.place(world, DVec3::ZERO).is_none())
    };
    let [width, height] = capture.size;
    Some((0..height).flat_map(|y| (0..width).map(move |x| [x, y])).map(is_outside).collect())
}

/// How pixels read a light's map: as [`MapLookup::RECORDED`](crate::plan::MapLookup::RECORDED) says, whatever the program's
/// shader does.
#[derive(Debug)]
pub struct MapReading<'a> {
    projection: MapProjection,
    faces: &'a [Arc<Image>],
    depth: &'a Image,
    seen: &'a SeenSurfaces,
}

impl<'a> MapReading<'a> {
    /// Returns the reading of the map of a light of another program by what is seen; `None` where it has none whose view is
    /// known.
    pub fn new(capture: &'a Capture, light: LightId, seen: &'a SeenSurfaces) -> Option<MapReading<'a>> {
        Some(MapReading {
            projection: MapProjection::recorded(capture, light.0)?,
            faces: &capture.lights.get(light.0)?.map.as_ref()?.faces,
            depth: &capture.frame_at(capture.steps.len().checked_sub(1)?)?.depth.image,
            seen,
        })
    }

    /// Returns the label of a pixel: lit outside of the map, and background where nothing is drawn.
    pub fn label(&self, at: [u32; 2]) -> u8 {
        match self.seen.at(at, self.depth) {
            None => BACKGROUND,
            Some((world, plane)) => self.compared(world, plane).map_or(LIT, label),
        }
    }

    /// Returns by how much a pixel's depth in the map is greater than what its texel stores (less, where depth is reversed),
    /// beyond rounding and with no bias at all; `None` outside of the map, and where no caster is stored.
    pub fn margin(&self, at: [u32; 2]) -> Option<f64> {
        let (world, plane) = self.seen.at(at, self.depth)?;
        let (face, clip) = self.projection.place(world, plane)?;
        let [_, column, row] = self.projection.first_at(face, clip);
        let stored = self.faces.get(face)?.depth_at([u32::try_from(column).ok()?, u32::try_from(row).ok()?])?;
        let clear = self.projection.lookup().clear_depth;
        let margin = self.projection.own_depth(face, clip, world) - f64::from(stored);
        (stored != clear).then_some(if clear == 0.0 { -margin } else { margin })
    }

    /// Returns the pixels that are lit, but whose texel stores their own surface as nearer: without a bias they are dark.
    pub fn self_shadowed(&self) -> Vec<[u32; 2]> {
        let [width, height] = self.depth.size();
        let all = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        all.filter(|at| self.margin(*at).is_some_and(|margin| margin > 0.0) && self.label(*at) == LIT).collect()
    }

    /// Returns where the plane that a pixel shows is seen from the light through the middle of the texel that the pixel reads,
    /// or so many columns and rows beside it; `None` outside of the map, and where the light sees the plane edge-on.
    pub fn texel_point(&self, at: [u32; 2], beside: DVec2) -> Option<DVec3> {
        let (world, plane) = self.seen.at(at, self.depth)?;
        let (face, clip) = self.projection.place(world, plane)?;
        let (texel, _) = self.projection.compared(face, clip, world, plane).next()?;
        self.projection.on_plane(face, world, plane, UVec2::from(texel).as_dvec2() + 0.5 + beside)
    }

    /// Returns whether the texel that a surface's point reads lets the light pass; `None` outside of the map.
    fn compared(&self, world: DVec3, plane: DVec3) -> Option<bool> {
        let (face, clip) = self.projection.place(world, plane)?;
        let (at, own) = self.projection.compared(face, clip, world, plane).next()?;
        Some(self.projection.is_lit(self.faces.get(face)?.depth_at(at)?, own as f32))
    }
}

fn label(is_lit: bool) -> u8 {
    if is_lit { LIT } else { SHADOW }
}

/// Returns labels by the stencil test of the light's pass; `None` where no pass of the light tests the stencil.
fn by_stencil(plan: &FramePlan, capture: &Capture, light: LightId) -> Option<Arc<Image>> {
    let index = asking_pass(plan, light)?;
    let raster = &plan.passes[index].draws.iter().find(|draw| draw.raster.stencil.is_enabled())?.raster;
    // The stencil that it tests is what the pass before left: where it sets its own, nothing was counted.
    let pass = &plan.passes[index];
    let is_set = pass.depth_stencil.as_ref().is_some_and(|target| target.clear_stencil.is_some())
        || pass
            .recorded
            .as_ref()
            .is_some_and(|recorded| recorded.start.as_ref().is_some_and(|start| start.stencil.is_some()));
    let before = capture.frame_at(index.checked_sub(1).filter(|_| !is_set)?)?;
    let stencil = &before.stencil.as_ref()?.image;
    let darkens = pass.recorded.as_ref().is_some_and(|recorded| recorded.darkens);
    // What replaces colours shows by none of them whether it is light or shadow: where nothing is counted there is light.
    let is_of_shadow = raster.color == ColorWrite::Replace && !passes_uncounted(plan, light, raster);
    let is_dark = darkens || is_of_shadow;
    let clear = plan.depth.mapping.clear_depth().to_le_bytes();
    let rows = stencil.rows().zip(before.depth.image.rows());
    let label = |(stencil, depth): (&u8, &[u8])| match depth == clear {
        true => BACKGROUND,
        false if stencil_passes(raster, true, *stencil) != is_dark => LIT,
        false => SHADOW,
    };
    let labels: Vec<u8> =
        rows.flat_map(|(stencil, depth)| stencil.iter().zip(depth.chunks_exact(4)).map(label)).collect();
    Some(Arc::new(Image::packed(PixelFormat::U8, plan.size, labels)))
}
