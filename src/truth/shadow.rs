//! Whether anything lies between a light and surfaces.

use super::direction_projection::OriginRay;
use super::hierarchy::{Hit, PlaneRounding, RayOriginHierarchy, ScaledPlane, SearchLimit, point_rounding};
use super::packet::RayPacket;
use super::tree::set_bits;
use super::{BACKGROUND, FACES_AWAY, LIT, POINT_ROUNDING, SHADOW, TracedSurface, Tracer};
use crate::math::{Sign, side_of_triangle};
use glam::{DVec3, DVec4};

/// Where a light is for some casters, with the hierarchy of their triangles for tracing rays to there.
#[derive(Debug)]
pub struct LightRays {
    /// Homogeneous, world space.
    pub position: DVec4,
    pub hierarchy: RayOriginHierarchy,
}

/// A light, with what is between it and surfaces.
#[derive(Debug)]
pub struct TracedLight {
    /// Its index among the scene's lights.
    pub index: usize,
    /// Distance in metres from which on a light that fades lights nothing; `None` without falloff.
    pub range: Option<f64>,
    /// The light where it is, with the casters that have no light position of their own.
    pub own: LightRays,
    /// Each other position, with the casters that have it.
    pub of_casters: Vec<LightRays>,
}

impl TracedLight {
    /// Returns the light at each of its positions, its own first.
    pub fn rays(&self) -> impl Iterator<Item = &LightRays> {
        std::iter::once(&self.own).chain(&self.of_casters)
    }

    /// Returns whether a world position is at the light's range or beyond.
    fn is_out_of_range(&self, point: DVec3) -> bool {
        self.range.is_some_and(|range| self.own.position.truncate().distance_squared(point) >= range * range)
    }
}

/// Some of up to 16 surfaces: bit `i` is the one with index `i`.
type SurfaceMask = u32;

/// A triangle that may lie between a light and surfaces, with its plane and rounding bounds.
#[derive(Debug)]
pub struct OccludingTriangle {
    triangle: usize,
    light_side: Sign,
    plane: ScaledPlane,
    rounding: PlaneRounding,
    /// The sum of the normal's absolute coordinates.
    normal_span: f64,
    /// The surface triangle that it was compared with last, and whether the two share a plane.
    compared: (usize, bool),
}

impl OccludingTriangle {
    /// Computes a triangle's plane relative to the hierarchy's origin.
    pub fn new(origin: DVec3, hit: &Hit, corners: &[DVec3; 3]) -> OccludingTriangle {
        let plane = ScaledPlane::new(origin, corners);
        OccludingTriangle {
            triangle: hit.index as usize,
            light_side: hit.center_side,
            plane,
            rounding: PlaneRounding::new(origin, corners),
            normal_span: plane.normal.abs().element_sum(),
            compared: (usize::MAX, false),
        }
    }
}

impl Tracer {
    /// Writes a label for each surface (`None` is background) into `labels`: faces away where the light is on the other
    /// side or out of range; in shadow where a ray of one packet is blocked; else lit, always where the object does not
    /// receive.
    ///
    /// A light that casters have elsewhere shades by none of its positions: a surface that faces away from one of them is
    /// lit, unless a caster that has it there is between, or it is such a caster's own. Whether that is shadow is not asked, as
    /// where there is one position.
    pub(super) fn label_surfaces(&self, light: &TracedLight, surfaces: &[Option<TracedSurface>], labels: &mut [u8]) {
        let is_one = light.of_casters.is_empty();
        let (mut dark, mut unasked) = (0, 0);
        for rays in light.rays() {
            let (away, receiving) = self.facing(light, rays, surfaces);
            let blocked = self.blocked(rays, surfaces, receiving & !dark & if is_one { !away } else { !0 });
            dark |= blocked & !away;
            unasked |= away & if is_one { !0 } else { blocked | self.of_casters(light, rays, surfaces) };
        }
        for (index, (surface, label)) in surfaces.iter().zip(labels).enumerate() {
            let is_in = |mask: SurfaceMask| mask & (1 << index) != 0;
            *label = match surface {
                None => BACKGROUND,
                Some(_) if is_in(dark) => SHADOW,
                Some(_) if is_in(unasked) => FACES_AWAY,
                Some(_) => LIT,
            };
        }
    }

    /// Returns which surfaces are those of casters that have the light at this position of it.
    fn of_casters(&self, light: &TracedLight, rays: &LightRays, surfaces: &[Option<TracedSurface>]) -> SurfaceMask {
        let is_own = |surface: &TracedSurface| {
            let object = self.world.object(surface.triangle);
            object.casts && object.light_positions.get(&light.index).unwrap_or(&light.own.position) == &rays.position
        };
        let own = surfaces.iter().map(|surface| SurfaceMask::from(surface.as_ref().is_some_and(is_own)));
        own.enumerate().fold(0, |mask, (index, is_own)| mask | is_own << index)
    }

    /// Returns which surfaces face away from a light's position or are out of its range, and which receive shadows.
    fn facing(
        &self,
        light: &TracedLight,
        rays: &LightRays,
        surfaces: &[Option<TracedSurface>],
    ) -> (SurfaceMask, SurfaceMask) {
        let (mut away, mut receiving) = (0, 0);
        let mut last = (usize::MAX, Sign::Zero, false);
        for (index, surface) in surfaces.iter().enumerate() {
            let Some(surface) = surface else { continue };
            if last.0 != surface.triangle {
                let side = side_of_triangle(self.world.triangles[surface.triangle], rays.position);
                last = (surface.triangle, side, self.world.object(surface.triangle).receives);
            }
            let is_away = last.1 != surface.eye_side || light.is_out_of_range(surface.point);
            away |= SurfaceMask::from(is_away) << index;
            receiving |= SurfaceMask::from(last.2) << index;
        }
        (away, receiving)
    }

    /// Returns which of the surfaces that are asked for something is between, by the rays of one packet.
    fn blocked(&self, rays: &LightRays, surfaces: &[Option<TracedSurface>], asked: SurfaceMask) -> SurfaceMask {
        let mut packet = RayPacket::new(OriginRay::To);
        let mut lines = [0; RayPacket::MOST];
        for index in set_bits(asked) {
            if let Some(surface) = &surfaces[index] {
                lines[packet.len()] = index;
                packet.push(surface.point);
            }
        }
        let mut all = 0;
        if packet.len() == 0 {
            return all;
        }
        rays.hierarchy.for_each_hit(&packet, |hit, corners, hit_rays| {
            let mut occluder = None;
            let mut dark = 0;
            for line in set_bits(hit_rays) {
                let Some(surface) = surfaces[lines[line]].as_ref().filter(|of| of.triangle != hit.index as usize)
                else {
                    continue;
                };
                let occluder =
                    occluder.get_or_insert_with(|| OccludingTriangle::new(rays.hierarchy.origin, hit, corners));
                if self.lies_between(rays, occluder, surface) {
                    all |= 1 << lines[line];
                    dark |= 1 << line;
                }
            }
            SearchLimit { lines: dark, ..SearchLimit::NOTHING }
        });
        all
    }

    /// Returns whether a triangle that the ray hits separates the light from a surface point. It does not where the
    /// point is in its plane as far as rounding shows, nor where the two triangles share a plane.
    pub(super) fn lies_between(
        &self,
        light: &LightRays,
        occluder: &mut OccludingTriangle,
        surface: &TracedSurface,
    ) -> bool {
        let other = occluder.triangle;
        if other == surface.triangle {
            return false;
        }
        let place = surface.point - light.hierarchy.origin;
        let height = occluder.plane.height(place);
        let of_height = occluder.rounding.of_height(place);
        let is_sure = |of_point: f64| height.abs() > of_height + occluder.normal_span * of_point;
        // Most are so far from the plane that a rough bound will do.
        let is_sure = is_sure(self.most_rounding(surface)) || is_sure(self.rounding(surface));
        let height = if is_sure { height } else { self.height_near(other, surface) };
        if !is_opposite(height, occluder.light_side) {
            return false;
        }
        if occluder.compared.0 != surface.triangle {
            occluder.compared = (surface.triangle, self.world.share_plane(surface.triangle, other));
        }
        !occluder.compared.1
    }

    /// Returns the height over a triangle's plane, scaled by twice its area, of a surface's point that is so near that
    /// rounding matters; 0 where rounding can't distinguish it from the plane.
    fn height_near(&self, triangle: usize, surface: &TracedSurface) -> f64 {
        let [a, b, c] = self.world.triangles[triangle];
        let (ab, ac, offset) = (b - a, c - a, surface.point - a);
        let normal = ab.cross(ac);
        let height = normal.dot(offset);
        let products = ab.abs().element_sum() * ac.abs().element_sum() * offset.abs().element_sum();
        let rounding = 16.0 * f64::EPSILON * products + normal.abs().element_sum() * self.rounding(surface);
        if height.abs() > rounding { height } else { 0.0 }
    }

    /// Returns an upper bound for [`Tracer::rounding`] that takes less time.
    fn most_rounding(&self, surface: &TracedSurface) -> f64 {
        self.most_rounding + 3.0 * POINT_ROUNDING * (surface.from + surface.offset.abs().element_sum())
    }

    /// Returns an upper bound of how far rounding may move a surface's point along any axis, metres.
    fn rounding(&self, surface: &TracedSurface) -> f64 {
        // The sum is rounded at the size of its larger part.
        let parts = surface.from + surface.offset.abs().max_element();
        let size = self.view.eye.abs().max_element() + parts + surface.point.abs().max_element();
        POINT_ROUNDING * size + point_rounding(self.eye.origin, &self.world.triangles[surface.triangle])
    }
}

fn is_opposite(height: f64, side: Sign) -> bool {
    (height > 0.0 && side == Sign::Negative) || (height < 0.0 && side == Sign::Positive)
}
