//! Ground truth: what is lit and what is not, by rays in `f64` from the scene alone.
//!
//! It shares no code with shadow volumes, plans or techniques, so that no mistake can hide in both answers. A view ray
//! goes through each pixel's centre, from the near plane on; where it hits a surface, a light ray is followed from the
//! light to that point. Which triangles a ray hits is decided by exact orientation signs, so rays slip through no edge
//! and hit no edge twice; nothing is moved off a surface by an offset, which would lose occluders at grazing angles.
//! What is left out instead are triangles whose plane goes through the point itself.
//!
//! ```text
//! scene ─► TracedTriangles ─► RayOriginHierarchy of the eye    ─► nearest triangle ─┐
//!                           ► RayOriginHierarchy of each light ─► anything between? ┴► labels
//! ```
//!
//! All rays of a frame begin in the eye or end in a light. A hierarchy of the triangles as they are seen from there
//! makes a test cheap enough for a picture in a tenth of a second.

mod ask;
mod coarse;
mod direction_projection;
mod hierarchy;
mod packet;
mod shadow;
#[cfg(test)]
mod tests;
mod tree;
mod view;
mod world;

pub use ask::{OccluderHit, SeenSurface};
pub use world::TriangleSource;

use crate::math::Sign;
use crate::progress::Progress;
use crate::scene::{Ray, Scene};
use direction_projection::OriginRay;
use glam::{DVec3, DVec4};
use hierarchy::{RayKind, RayOriginHierarchy, ScaledPlane, SearchLimit, point_rounding};
use packet::RayPacket;
use rayon::prelude::*;
use shadow::{LightRays, TracedLight};
use std::collections::BTreeSet;
use std::ops::Range;
use tree::set_bits;
use view::PictureRays;
use world::TracedTriangles;

named_enum! {
    /// What a light does at a pixel in truth: lights it, leaves it in shadow, or has nothing to light. Label masks
    /// store it as a byte.
    pub enum PixelLabel {
        /// The light reaches the surface.
        Lit = "lit",
        /// Something lies between the light and the surface.
        Shadow = "in shadow",
        /// No surface is at this pixel.
        Background = "background",
        /// The light adds nothing: it and the eye are on different sides of the surface's plane, or the point is not
        /// within the light's range.
        FacesAway = "faces away",
    }
}

impl PixelLabel {
    /// Returns the label that label masks store as this byte; `None` for a byte that is no label.
    pub fn from_byte(byte: u8) -> Option<PixelLabel> {
        PixelLabel::ALL.get(usize::from(byte)).copied()
    }
}

/// The byte that label masks store for [`PixelLabel::Lit`].
pub const LIT: u8 = PixelLabel::Lit as u8;
/// The byte that label masks store for [`PixelLabel::Shadow`].
pub const SHADOW: u8 = PixelLabel::Shadow as u8;
/// The byte that label masks store for [`PixelLabel::Background`].
pub const BACKGROUND: u8 = PixelLabel::Background as u8;
/// The byte that label masks store for [`PixelLabel::FacesAway`].
pub const FACES_AWAY: u8 = PixelLabel::FacesAway as u8;

/// Pixels along each side of the tiles whose rays are followed together.
pub const TILE: usize = 4;
/// Rows of pixels that one task traces: tiles below each other hit mostly the same triangles as those beside each
/// other, and these are then still in the processor's cache.
const BAND: usize = 4 * TILE;
/// Units in the last place by which a surface point may be off: the eye, the direction and their
/// sum are rounded.
const POINT_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Why the truth of a scene can't be computed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{problem}")]
pub struct TruthError {
    /// What is wrong and how to fix it, in a sentence.
    problem: String,
}

/// The ray-traced label of each light at each pixel of a picture: [`LIT`], [`SHADOW`], [`BACKGROUND`] or
/// [`FACES_AWAY`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Truth {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// For each of the scene's lights in order, one label byte for each pixel, row by row from the upper left corner.
    pub labels: Vec<Vec<u8>>,
}

impl Truth {
    /// Returns the label of the light with index `light` at the pixel (x, y).
    pub fn label(&self, light: usize, [x, y]: [u32; 2]) -> u8 {
        self.labels[light][y as usize * self.size[0] as usize + x as usize]
    }
}

/// A scene prepared for ray tracing from the eye and to each light, at one picture size; it computes the [`Truth`].
#[derive(Debug)]
pub struct Tracer {
    world: TracedTriangles,
    view: PictureRays,
    size: [u32; 2],
    eye: RayOriginHierarchy,
    lights: Vec<TracedLight>,
    /// What does not depend on a surface of how far its point may be off, or more.
    most_rounding: f64,
}

/// Where the rays of a hierarchy begin or end, homogeneous, world space, and whose triangles are in it.
#[derive(Debug, Clone, Copy)]
enum RayOrigin {
    /// The eye, with what is visible.
    Eye(DVec4),
    /// The light with this index, with the casters that have no light position of their own.
    Light(usize, DVec4),
    /// The light with this index, with the casters that have it here.
    OfCasters(usize, DVec4),
}

/// Returns each other position that a light has for casters.
fn elsewhere(scene: &Scene, light: usize) -> Vec<DVec4> {
    let mut known = BTreeSet::new();
    let casting = scene.objects.iter().filter(|object| object.casts);
    let positions = casting.filter_map(|object| object.light_positions.get(&light).copied());
    positions.filter(|at| known.insert(at.to_array().map(|value| (value + 0.0).to_bits()))).collect()
}

/// A [`Tracer`] whose hierarchies are built one after the other, with something else between them.
#[derive(Debug)]
pub struct TracerBuilder {
    world: TracedTriangles,
    view: PictureRays,
    size: [u32; 2],
    /// How far each light reaches.
    ranges: Vec<Option<f64>>,
    /// The origins of the rays of each hierarchy: the eye, then the positions of each light.
    origins: Vec<RayOrigin>,
    /// The eye's largest coordinate, metres.
    eye_extent: f64,
    built: Vec<RayOriginHierarchy>,
}

impl TracerBuilder {
    /// Places a scene's triangles, for a picture of `size` pixels.
    ///
    /// # Errors
    /// A camera, a light or an object that can't be traced.
    pub fn new(scene: &Scene, size: [u32; 2]) -> Result<TracerBuilder, TruthError> {
        let problem = |problem: &str| TruthError { problem: problem.to_owned() };
        scene.camera.check().map_err(problem)?;
        scene.lights.iter().try_for_each(|light| light.check()).map_err(problem)?;
        let world = TracedTriangles::new(scene)?;
        let range = |light: &crate::scene::Light| light.range.filter(|_| !light.is_directional());
        let lights = scene.lights.iter().enumerate().flat_map(|(index, light)| {
            let of_casters = elsewhere(scene, index).into_iter().map(move |at| RayOrigin::OfCasters(index, at));
            std::iter::once(RayOrigin::Light(index, light.homogeneous())).chain(of_casters)
        });
        let origins = std::iter::once(RayOrigin::Eye(scene.camera.eye_position())).chain(lights).collect();
        let view = PictureRays::new(&scene.camera, size);
        Ok(TracerBuilder {
            world,
            view,
            size,
            ranges: scene.lights.iter().map(range).collect(),
            origins,
            eye_extent: scene.camera.eye.abs().max_element(),
            built: Vec::new(),
        })
    }

    /// Returns how many hierarchies there are to build: for the eye, and for each position of each light.
    pub fn hierarchy_count(&self) -> usize {
        self.origins.len()
    }

    /// Builds the next `count` hierarchies, in parallel; fewer where no more are left.
    pub fn build_next(&mut self, count: usize) {
        let world = &self.world;
        let build = |index: usize| {
            let triangles = &world.triangles;
            let is_caster = |light: usize, at: Option<DVec4>| {
                move |index: usize| {
                    let object = world.object(index);
                    object.casts && object.light_positions.get(&light).copied() == at
                }
            };
            match self.origins[index] {
                RayOrigin::Eye(origin) => {
                    RayOriginHierarchy::new(RayKind::Eye, origin, triangles, |index| world.object(index).visible)
                }
                RayOrigin::Light(light, origin) => {
                    RayOriginHierarchy::new(RayKind::Light, origin, triangles, is_caster(light, None))
                }
                RayOrigin::OfCasters(light, origin) => {
                    RayOriginHierarchy::new(RayKind::Light, origin, triangles, is_caster(light, Some(origin)))
                }
            }
        };
        let next = self.built.len()..self.origins.len().min(self.built.len() + count);
        self.built.append(&mut next.into_par_iter().map(build).collect());
    }

    /// Returns the tracer.
    ///
    /// # Panics
    /// If a hierarchy is not built yet.
    pub fn finish(self) -> Tracer {
        let TracerBuilder { world, view, size, ranges, origins, eye_extent, built } = self;
        assert_eq!(built.len(), origins.len(), "every hierarchy is built");
        let mut built = built.into_iter();
        let eye = built.next().expect("the eye's hierarchy is the first");
        let mut lights: Vec<TracedLight> = Vec::new();
        for (hierarchy, origin) in built.zip(&origins[1..]) {
            match *origin {
                RayOrigin::Light(light, position) => {
                    let own = LightRays { position, hierarchy };
                    lights.push(TracedLight { index: light, range: ranges[light], own, of_casters: Vec::new() });
                }
                RayOrigin::OfCasters(light, position) => {
                    lights[light].of_casters.push(LightRays { position, hierarchy });
                }
                RayOrigin::Eye(_) => unreachable!("the eye is the first origin alone"),
            }
        }
        let most_rounding = 3.0 * POINT_ROUNDING * eye_extent
            + 4.0 * point_rounding(DVec3::ZERO, &[DVec3::splat(world.reach(eye.origin)); 3]);
        Tracer { view, world, size, eye, lights, most_rounding }
    }
}

/// Returns the middle of a pixel (column, row), in pixels.
fn center(pixel: [usize; 2]) -> [f64; 2] {
    pixel.map(|side| side as f64 + 0.5)
}

/// The surface that a view ray hits first.
#[derive(Debug, Clone, Copy)]
struct TracedSurface {
    triangle: usize,
    /// The side of the surface's plane that the eye is on.
    eye_side: Sign,
    /// The point that is hit, in world space, rounded.
    point: DVec3,
    /// The vector from the eye, of which `point` is the rounded sum.
    offset: DVec3,
    /// The largest coordinate of where the ray is at distance 0, relative to the eye.
    from: f64,
}

/// The nearest surface that a view ray has hit so far.
#[derive(Debug, Clone, Copy)]
struct NearestHit {
    /// Distance from the eye along the view's axis, in world units.
    distance: f64,
    triangle: u32,
    eye_side: Sign,
}

impl NearestHit {
    const NOTHING: NearestHit = NearestHit { distance: f64::INFINITY, triangle: u32::MAX, eye_side: Sign::Zero };
}

impl Tracer {
    /// The largest number of rays that are traced together.
    pub const MOST_POINTS: usize = RayPacket::MOST;

    /// Places a scene's triangles and builds their hierarchies for the eye and for each light, for a picture of `size`
    /// pixels.
    ///
    /// # Errors
    /// A camera, a light or an object that can't be traced.
    pub fn new(scene: &Scene, size: [u32; 2]) -> Result<Tracer, TruthError> {
        let mut builder = TracerBuilder::new(scene, size)?;
        builder.build_next(builder.hierarchy_count());
        Ok(builder.finish())
    }

    /// Returns the tracer with view rays that end at a far plane. A far plane is a part of another program's picture;
    /// in our own frames it belongs to a technique, which may be wrong because of it.
    #[must_use]
    pub fn ending_at(mut self, far: Option<f64>) -> Tracer {
        self.view.far = far.unwrap_or(f64::INFINITY);
        self
    }

    /// Returns the width and height of the picture in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the indices of all lights.
    pub fn lights(&self) -> Vec<usize> {
        (0..self.lights.len()).collect()
    }

    /// Returns how many rays a truth follows: a view ray for each pixel, and for each light a ray to every surface
    /// point that faces it and receives shadows.
    pub fn rays(truth: &Truth) -> u64 {
        let is_followed = |label: &&u8| matches!(**label, LIT | SHADOW);
        let of_light = truth.labels.iter().map(|labels| labels.iter().filter(is_followed).count() as u64);
        u64::from(truth.size[0]) * u64::from(truth.size[1]) + of_light.sum::<u64>()
    }

    /// Computes the label of every pixel for every light; `None` where it was cancelled.
    pub fn trace(&self, progress: &Progress) -> Option<Truth> {
        self.trace_lights(&self.lights(), progress)
    }

    /// Computes the labels of the lights with these indices, in the order given; `None` where it was cancelled.
    pub fn trace_lights(&self, lights: &[usize], progress: &Progress) -> Option<Truth> {
        let mut truth = self.begin(lights, progress);
        self.trace_rows(0..self.size[1] as usize, lights, &mut truth, progress)?;
        Some(truth)
    }

    /// Returns the truth of the lights with these indices, of which no row is traced yet ([`Tracer::trace_rows`]), and
    /// starts `progress`, of which a step is a band of 16 rows.
    pub fn begin(&self, lights: &[usize], progress: &Progress) -> Truth {
        let [width, height] = self.size.map(|n| n as usize);
        progress.start(height.div_ceil(BAND));
        Truth { size: self.size, labels: vec![Vec::with_capacity(width * height); lights.len()] }
    }

    /// Adds these rows to a truth that has all rows above them and none below; `None` where it was cancelled. They begin
    /// at a multiple of [`TILE`] where they are to take the least time.
    pub fn trace_rows(
        &self,
        rows: Range<usize>,
        lights: &[usize],
        truth: &mut Truth,
        progress: &Progress,
    ) -> Option<()> {
        let height = self.size[1] as usize;
        let bands: Vec<usize> = rows.clone().step_by(BAND).collect();
        let traced: Option<Vec<Vec<Vec<u8>>>> = bands
            .into_par_iter()
            .map(|top| {
                let bottom = rows.end.min(top + BAND);
                let band = (!progress.is_cancelled()).then(|| self.trace_band(top..bottom, lights));
                if bottom == height || bottom.is_multiple_of(BAND) {
                    progress.advance();
                }
                band
            })
            .collect();
        for band in traced? {
            truth.labels.iter_mut().zip(band).for_each(|(all, part)| all.extend(part));
        }
        Some(())
    }

    /// Returns the labels of one light at up to [`Tracer::MOST_POINTS`] points near each other, in pixels from the
    /// picture's upper left corner: the first pixel's centre is (0.5, 0.5).
    ///
    /// # Panics
    /// If there are more points, or no such light.
    pub fn labels_at<const N: usize>(&self, light: usize, points: [[f64; 2]; N]) -> [u8; N] {
        let mut labels = [BACKGROUND; N];
        self.label_surfaces(&self.lights[light], &self.surfaces_at(points), &mut labels);
        labels
    }

    /// Returns the triangle that is visible at each of up to [`Tracer::MOST_POINTS`] points in pixels, near each other;
    /// `None` where there is none.
    ///
    /// # Panics
    /// If there are more points.
    pub fn visible_at<const N: usize>(&self, points: [[f64; 2]; N]) -> [Option<TriangleSource>; N] {
        self.surfaces_at(points).map(|surface| surface.map(|surface| self.world.place(surface.triangle)))
    }

    /// Returns the distance along the view's axis of what each pixel's centre shows, row by row, metres; infinite where
    /// there is nothing.
    pub fn distances(&self) -> Vec<f64> {
        let [width, height] = self.size.map(|side| side as usize);
        let columns: Vec<usize> = (0..width).collect();
        let of_row = |y: usize| {
            columns
                .chunks(RayPacket::MOST)
                .flat_map(move |columns| {
                    let rays: Vec<Ray> = columns.iter().map(|x| self.view.ray(center([*x, y]))).collect();
                    let mut surfaces = [None; RayPacket::MOST];
                    self.hit_surfaces(&rays, &mut surfaces[..rays.len()]);
                    let distance = |surface: Option<TracedSurface>| {
                        surface.map_or(f64::INFINITY, |surface| surface.offset.dot(self.view.axis()))
                    };
                    let distances = surfaces.map(distance).into_iter().take(rays.len());
                    distances.zip(columns).map(move |(distance, x)| match self.view.is_drawn(center([*x, y])) {
                        true => distance,
                        false => f64::INFINITY,
                    })
                })
                .collect::<Vec<f64>>()
        };
        (0..height).into_par_iter().flat_map_iter(of_row).collect()
    }

    fn surfaces_at<const N: usize>(&self, points: [[f64; 2]; N]) -> [Option<TracedSurface>; N] {
        let mut surfaces = [None; N];
        self.hit_surfaces(&points.map(|point| self.view.ray(point)), &mut surfaces);
        for (surface, point) in surfaces.iter_mut().zip(points) {
            *surface = surface.filter(|_| self.view.is_drawn(point));
        }
        surfaces
    }

    /// Returns the labels of a band of rows, one list for each of `lights`.
    fn trace_band(&self, band: Range<usize>, lights: &[usize]) -> Vec<Vec<u8>> {
        let (width, top, bottom) = (self.size[0] as usize, band.start, band.end);
        let mut labels = vec![vec![BACKGROUND; (bottom - top) * width]; lights.len()];
        let across: Vec<f64> = (0..width).map(|x| self.view.across(x as f64 + 0.5)).collect();
        let down: Vec<f64> = (top..bottom).map(|y| self.view.down(y as f64 + 0.5)).collect();
        let mut rays = [Ray { from: DVec3::ZERO, along: DVec3::ZERO }; TILE * TILE];
        let mut places = [0; TILE * TILE];
        for left in (0..width).step_by(TILE) {
            for first in (0..bottom - top).step_by(TILE) {
                let mut count = 0;
                for (row, y) in (first..).zip(&down[first..down.len().min(first + TILE)]) {
                    for (column, x) in (left..).zip(&across[left..width.min(left + TILE)]) {
                        if !self.view.is_drawn(center([column, top + row])) {
                            continue;
                        }
                        rays[count] = self.view.ray_through([*x, *y]);
                        places[count] = row * width + column;
                        count += 1;
                    }
                }
                if count == 0 {
                    continue;
                }
                let mut surfaces = [None; TILE * TILE];
                let surfaces = &mut surfaces[..count];
                self.hit_surfaces(&rays[..count], surfaces);
                for (light, labels) in lights.iter().zip(&mut labels) {
                    let mut tile = [BACKGROUND; TILE * TILE];
                    self.label_surfaces(&self.lights[*light], surfaces, &mut tile[..count]);
                    places[..count].iter().zip(tile).for_each(|(place, label)| labels[*place] = label);
                }
            }
        }
        labels
    }

    /// Finds what view rays hit first. Of surfaces at one distance it is the one that is first in the scene, as a
    /// rasteriser would draw it.
    fn hit_surfaces(&self, rays: &[Ray], surfaces: &mut [Option<TracedSurface>]) {
        let mut packet = RayPacket::new(if self.view.is_parallel { OriginRay::Through } else { OriginRay::Along });
        for ray in rays {
            packet.push(if self.view.is_parallel { self.view.eye + ray.from } else { ray.along });
        }
        let mut nearest = [NearestHit::NOTHING; RayPacket::MOST];
        let mut open = (1_u32 << rays.len()) - 1;
        self.eye.for_each_hit(&packet, |hit, corners, lines| {
            let plane = ScaledPlane::new(self.eye.origin, corners);
            let depths = self.depths(corners);
            let mut is_changed = false;
            for line in set_bits(lines) {
                let distance = self.distance(&plane, depths, &rays[line]);
                let best = nearest[line];
                let is_nearer = distance < best.distance || (distance == best.distance && hit.index < best.triangle);
                if (self.view.near..=self.view.far).contains(&distance) && is_nearer {
                    nearest[line] = NearestHit { distance, triangle: hit.index, eye_side: hit.center_side };
                    open &= !(1 << line);
                    is_changed = true;
                }
            }
            if open != 0 || !is_changed || self.view.is_parallel {
                return SearchLimit::NOTHING;
            }
            let distances = nearest[..rays.len()].iter().map(|nearest| nearest.distance);
            SearchLimit {
                lines: 0,
                distance: distances.fold(0.0, |most, distance| if distance > most { distance } else { most }),
            }
        });
        for ((surface, ray), nearest) in surfaces.iter_mut().zip(rays).zip(nearest) {
            if nearest.triangle == u32::MAX {
                continue;
            }
            let offset = ray.at(nearest.distance);
            *surface = Some(TracedSurface {
                triangle: nearest.triangle as usize,
                eye_side: nearest.eye_side,
                point: self.view.eye + offset,
                offset,
                from: if self.view.is_parallel { ray.from.abs().max_element() } else { 0.0 },
            });
        }
    }

    /// Returns the least and the greatest distance of a triangle from the eye, along the view's axis.
    fn depths(&self, corners: &[DVec3; 3]) -> [f64; 2] {
        let axis = self.view.axis();
        let [a, b, c] = corners.map(|corner| (corner - self.view.eye).dot(axis));
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// Returns the distance along the view's axis at which a ray meets a triangle's plane, clamped to the triangle's
    /// own distances: a sliver's plane may be so steep that rounding puts the meeting anywhere.
    fn distance(&self, plane: &ScaledPlane, [least, most]: [f64; 2], ray: &Ray) -> f64 {
        let from = match self.view.is_parallel {
            // Relative to the same place as the hierarchy's points.
            true => plane.normal.dot(self.view.eye - self.eye.origin + ray.from),
            false => 0.0,
        };
        ((plane.offset - from) / plane.normal.dot(ray.along)).max(least).min(most)
    }
}
