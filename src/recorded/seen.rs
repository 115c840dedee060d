//! The triangles of a frame's own draws that its pixels show: points and planes without the rounding of stored depths.

use super::objects::surfaces;
use crate::capture::{Capture, CapturedLight, Image, PixelUnprojection};
use crate::plan::FramePlan;
use crate::truth::Tracer;
use glam::{DVec3, DVec4};

/// The surfaces that a frame draws, of which the visible one is found at any pixel.
#[derive(Debug)]
pub struct SeenSurfaces {
    pixels: PixelUnprojection,
    /// `None` where no light has a shadow map whose view is known: nothing else asks for planes.
    tracer: Option<Tracer>,
}

impl SeenSurfaces {
    /// How far a drawn point may be from the one of the stored depth and be the same surface: a part of its distance.
    const SAME: f64 = 2e-3;

    /// Returns the surfaces of another program's frame.
    pub fn of(plan: &FramePlan, capture: &Capture) -> SeenSurfaces {
        let has_map = |light: &CapturedLight| light.map.is_some() && light.position != DVec4::ZERO;
        let is_asked = capture.lights.iter().any(has_map);
        let tracer = is_asked.then(|| Tracer::new(&surfaces(plan, capture.camera), capture.size).ok()).flatten();
        SeenSurfaces { pixels: PixelUnprojection::new(capture), tracer }
    }

    /// Returns the point and the unit normal of the plane that the centre of a pixel (column, row) shows, where it stores
    /// this depth: those of a triangle that was drawn there, else guessed from the depths of `stored` round it. `None` for
    /// the background.
    pub fn at(&self, at: [u32; 2], stored: &Image) -> Option<(DVec3, DVec3)> {
        let world = self.pixels.at(at, stored.depth_at(at)?)?;
        let drawn = self.drawn(at, world);
        Some(drawn.unwrap_or_else(|| (world, self.pixels.guessed_normal(stored, at, world))))
    }

    /// Returns the point and the unit normal of the drawn triangle's plane at a pixel, if `world` is a point of it but for
    /// rounding.
    pub fn drawn(&self, at: [u32; 2], world: DVec3) -> Option<(DVec3, DVec3)> {
        let seen = self.tracer.as_ref()?.seen_at(at.map(|at| f64::from(at) + 0.5))?;
        let [a, b, c] = seen.corners;
        let plane = (b - a).cross(c - a).try_normalize()?;
        let is_same = seen.point.distance(world) <= SeenSurfaces::SAME * world.length();
        is_same.then_some((seen.point, plane))
    }
}
