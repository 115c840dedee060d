//! Where the view ray of a pixel crosses faces of volumes that count, in the world.

use super::pick_ray;
use crate::capture::Capture;
use crate::history::{Ladder, Rung};
use glam::DVec3;

/// Faces that a view ray crosses in one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayCrossing {
    /// Where, world space; of those at infinity, the end of what is drawn of the ray.
    pub place: DVec3,
    /// What they add to the count: of those at infinity their sum.
    pub added: i32,
    /// Whether they lie at infinity.
    pub is_at_infinity: bool,
}

/// The faces that count on a pixel's view ray.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RayCrossings {
    /// The faces, those at infinity last.
    pub faces: Vec<RayCrossing>,
    /// To where the ray is drawn behind the surface, world space; `None` where no face counts there.
    pub end: Option<DVec3>,
}

impl RayCrossings {
    /// Returns the faces of a ladder at the pixel `at` (column, row). Those at infinity are `beyond` metres behind the last
    /// one that is not, or the surface.
    pub fn of(ladder: &Ladder, capture: &Capture, at: [u32; 2], beyond: f64) -> RayCrossings {
        let ray = pick_ray::ray(capture, at);
        let place = |distance: f64| capture.camera.eye + ray.at(distance);
        let (finite, infinite): (Vec<&Rung>, Vec<&Rung>) =
            ladder.rungs.iter().filter(|rung| rung.added != 0).partition(|rung| rung.distance.is_finite());
        let near = ladder.surface.unwrap_or(capture.camera.near);
        let mut farthest = finite.iter().map(|rung| rung.distance).fold(near, f64::max);
        let face = |rung: &&Rung| RayCrossing { place: place(rung.distance), added: rung.added, is_at_infinity: false };
        let mut faces: Vec<RayCrossing> = finite.iter().map(face).collect();
        let added: i32 = infinite.iter().map(|rung| rung.added).sum();
        if added != 0 {
            farthest += beyond;
            faces.push(RayCrossing { place: place(farthest), added, is_at_infinity: true });
        }
        RayCrossings { faces, end: (farthest > near).then(|| place(farthest)) }
    }
}
