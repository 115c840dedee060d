//! How a shadow map compares at a surface point: the texel that answers, what it should store, and by how much the bias
//! is too small or too large.
//!
//! The texel's own ray is followed through the truth's scene, along which the map stores the first of the faces that it
//! draws. If the pixel is wrong with that depth as well, the texel is too coarse; else the bias is too small or too
//! large, by numbers that are held against each other. Where all faces between light and surface are of those that the
//! map leaves out, no texel can be right.

use crate::accuracy::Finding;
use crate::capture::Image;
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::facts::FrameFacts;
use crate::math::DepthBits;
use crate::plan::{DrawPart, MapLookup, PlanMap, depth_plane};
use crate::technique::{MapSettings, Technique};
use crate::truth::{OccluderHit, SeenSurface};
use glam::{DMat4, DVec2, DVec3};
use wgpu_types::Face;

/// Distances below this part of the map's depth range are rounding.
const ROUNDING: f64 = 1e-6;
/// How far a place may be off by rounding, in texels: places are computed in single precision, with up to 8192 texels.
pub(super) const TEXEL_ROUNDING: f64 = 0.02;
/// Parts of a normal offset after each of which it is examined whether a point has left the shadow.
const OFFSET_STEPS: u32 = 8;

/// How a shadow map compares at a wrong surface point: the texel, the bias, and the cause that follows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapComparison {
    pub cause: Cause,
    /// Index of the object that the texel shows, or would show.
    pub caster: Option<usize>,
    /// Width of a texel at the surface, metres.
    pub(super) texel: f64,
    /// How much farther from the light the receiver gets within one texel, metres.
    pub(super) slope: f64,
    /// How far the first face that the texel's ray meets lies before the surface that is compared with it, metres.
    pub(super) gap: f64,
    /// How far the bias moves the map's depth from the true one, or the lookup towards the light, metres.
    pub(super) bias: f64,
    /// How far a bias may be off by rounding, metres.
    pub(super) rounding: f64,
    /// Distance from the middle of the map's face, 1 at its border.
    pub(super) place: f64,
    /// The number of points of the texel where the truth is not what it is at the pixel.
    pub(super) unlike: usize,
    /// Triangles between light and surface of faces that the map leaves out, and of those that it keeps.
    pub(super) left_out: usize,
    pub(super) kept: usize,
}

/// Compares a shadow map with the truth at a wrong surface point and returns the cause with its numbers;
/// [`Cause::OutsideMap`] where no face contains the point. `None` for other techniques, where the light reads no map,
/// or where the numbers show no cause.
pub(crate) fn look(facts: &FrameFacts, light: usize, kind: RegionKind, seen: &SeenSurface) -> Option<MapComparison> {
    if facts.technique() != Technique::ShadowMap {
        return None;
    }
    let map = facts.plan.lights.get(light)?.map.as_ref()?;
    let lookup = map.lookup?;
    let relative = seen.point - facts.eye();
    let Some(face) = find_face(map, relative) else {
        let caster = facts.tracer.between(light, seen).last().map(|hit| hit.place.object);
        return Some(MapComparison {
            cause: Cause::OutsideMap,
            caster,
            texel: 0.0,
            slope: 0.0,
            gap: 0.0,
            bias: 0.0,
            rounding: 0.0,
            place: farthest(map, relative),
            unlike: 0,
            left_out: 0,
            kept: 0,
        });
    };
    FaceReading::new(facts, light, seen, map, lookup, face)?.compare(kind)
}

/// Returns how many steps of depths of `bits` bits lie between a surface point and what its texel stores, and how long one is
/// there, metres; `None` where the light reads no map, or the texel stores nothing.
pub(super) fn steps_apart(
    facts: &FrameFacts,
    light: usize,
    kind: RegionKind,
    seen: &SeenSurface,
    bits: DepthBits,
) -> Option<[f64; 2]> {
    let map = facts.plan.lights.get(light)?.map.as_ref()?;
    let face = find_face(map, seen.point - facts.eye())?;
    let reading = FaceReading::new(facts, light, seen, map, map.lookup?, face)?;
    let texel = reading.answering(kind != RegionKind::Wrong(Finding::FalseShadow))?;
    let [stored, next] = bits.step_at(texel.stored).map(|depth| reading.unproject(texel.center, depth));
    let apart = (texel.compared - texel.stored).abs() * f64::from(bits.steps());
    (!reading.is_clear(&texel)).then(|| [apart, stored.distance(next)])
}

/// Returns the first face of a map that a point (relative to the eye) is on; its depth is not checked. `None` where no
/// face contains it.
pub(super) fn find_face(map: &PlanMap, relative: DVec3) -> Option<usize> {
    map.clip_from_relative.iter().position(|matrix| {
        let clip = matrix.as_dmat4() * relative.extend(1.0);
        clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w
    })
}

/// Returns how far a point (relative to the eye) is from the middle of the nearest face: the larger of x and y, where 1
/// is the border. Infinite where it is behind all faces.
fn farthest(map: &PlanMap, relative: DVec3) -> f64 {
    let off = map.clip_from_relative.iter().map(|matrix| {
        let clip = matrix.as_dmat4() * relative.extend(1.0);
        if clip.w > 0.0 { clip.x.abs().max(clip.y.abs()) / clip.w } else { f64::INFINITY }
    });
    off.fold(f64::INFINITY, f64::min)
}

/// Returns whether the map draws the side of a triangle that its light sees.
fn keeps(cull: Option<Face>, hit: &OccluderHit) -> bool {
    match cull {
        None => true,
        Some(Face::Front) => !hit.faces_light,
        Some(Face::Back) => hit.faces_light,
    }
}

/// One face of a map, read for one surface point.
struct FaceReading<'a> {
    facts: &'a FrameFacts<'a>,
    light: usize,
    seen: &'a SeenSurface,
    lookup: MapLookup,
    image: std::sync::Arc<Image>,
    /// Texels along each side.
    size: f64,
    clip_from_world: DMat4,
    world_from_clip: DMat4,
    /// Where the point is looked up, normalized device coordinates of the face.
    device: DVec3,
    /// The normal offset that the lookup is moved by, metres; zero without one.
    offset: DVec3,
    /// How far that raises the point towards the light, metres.
    raised: f64,
    /// The receiver's unit normal.
    normal: DVec3,
    cull: Option<Face>,
}

/// A texel that answers for a surface point.
struct TexelReading {
    /// Its middle, normalized device coordinates.
    center: DVec2,
    /// What it stores, and what is compared with it.
    stored: f64,
    compared: f64,
}

impl<'a> FaceReading<'a> {
    /// Reads a face for a point; `None` where the capture has no such face.
    fn new(
        facts: &'a FrameFacts<'a>,
        light: usize,
        seen: &'a SeenSurface,
        map: &PlanMap,
        lookup: MapLookup,
        face: usize,
    ) -> Option<FaceReading<'a>> {
        let image = facts.capture.lights.get(light)?.map.as_ref()?.faces.get(face)?.clone();
        let size = f64::from(image.size()[0]);
        let clip_from_world: DMat4 = *map.clip_from_light.get(face)? * map.light_from_world;
        let towards = facts.tracer.towards(light, seen.point);
        let normal = (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]).normalize_or_zero();
        let to_eye = if normal.dot(facts.eye() - seen.point) < 0.0 { -normal } else { normal };
        let from_relative = map.clip_from_relative.get(face)?.as_dmat4();
        let relative = seen.point - facts.eye();
        let clip = from_relative * relative.extend(1.0);
        let sine = (1.0 - to_eye.dot(towards).powi(2)).max(0.0).sqrt();
        let texel = 2.0 * clip.w / (from_relative.row(0).truncate().length() * size);
        let offset = to_eye * (f64::from(lookup.bias_normal) * texel * sine);
        let clip = from_relative * (relative + offset).extend(1.0);
        Some(FaceReading {
            facts,
            light,
            seen,
            lookup,
            image,
            size,
            clip_from_world,
            world_from_clip: clip_from_world.inverse(),
            device: clip.truncate() / clip.w,
            offset,
            raised: offset.dot(towards),
            normal,
            cull: facts.map().cull,
        })
    }

    /// Returns how far, in metres, the surface point moves on its plane for a step of so many pixels in the picture: so far
    /// may the point be off that the shader gets, where corners are moved without it. `None` for a plane seen edge-on.
    fn moved_by(&self, step: f64) -> Option<f64> {
        let clip_from_relative = self.facts.plan.views.first()?.clip_from_relative.as_dmat4();
        let relative_from_clip = clip_from_relative.inverse();
        let relative = self.seen.point - self.facts.eye();
        let plane =
            depth_plane(self.seen.corners.map(|corner| clip_from_relative * (corner - self.facts.eye()).extend(1.0)))?;
        let here = clip_from_relative.project_point3(relative).truncate();
        let along = DVec2::splat(2.0 * step) / DVec2::from_array(self.facts.plan.size.map(f64::from));
        let moved = [DVec2::new(along.x, 0.0), DVec2::new(0.0, along.y)].map(|along| {
            let place = here + along;
            relative_from_clip.project_point3(place.extend(plane.dot(place.extend(1.0)))).distance(relative)
        });
        Some(moved[0].max(moved[1])).filter(|moved| moved.is_finite())
    }

    fn unproject(&self, place: DVec2, depth: f64) -> DVec3 {
        self.world_from_clip.project_point3(place.extend(depth))
    }

    /// Returns how far the receiver's plane lies above a point, towards the light, metres.
    fn receiver_above(&self, point: DVec3) -> f64 {
        let towards = self.facts.tracer.towards(self.light, point);
        self.normal.dot(self.seen.point - point) / self.normal.dot(towards)
    }

    /// Returns the texel that answers as the picture does, the nearest to the point; where the point lies on a border of
    /// texels within rounding, also of those beside it. The nearest of all where none answers so, and `None` where the
    /// map has none.
    fn answering(&self, is_lit: bool) -> Option<TexelReading> {
        let place = (self.device.truncate() * DVec2::new(0.5, -0.5) + 0.5) * self.size;
        let steps = [0.0, -TEXEL_ROUNDING, TEXEL_ROUNDING];
        let places = steps.into_iter().flat_map(|x| steps.map(|y| place + DVec2::new(x, y)));
        let mut answers = places.flat_map(|place| self.texels(place));
        answers.find(|texel| self.says_lit(texel) == is_lit).or_else(|| self.texels(place).into_iter().next())
    }

    /// Returns the texels that are compared for a place in texels, the nearest to it first.
    fn texels(&self, place: DVec2) -> Vec<TexelReading> {
        let width = self.lookup.filter_width.max(1);
        let first = (place - 0.5 * f64::from(width - 1)).floor();
        let steps = (0..width).flat_map(|row| (0..width).map(move |column| DVec2::new(column.into(), row.into())));
        let mut texels: Vec<DVec2> =
            steps.map(|step| (first + step).clamp(DVec2::ZERO, DVec2::splat(self.size - 1.0))).collect();
        let apart = |texel: &DVec2| (*texel + 0.5 - place).length_squared();
        texels.sort_by(|a, b| apart(a).total_cmp(&apart(b)));
        let read = |texel: DVec2| {
            let stored = f64::from(self.image.depth_at([texel.x as u32, texel.y as u32])?);
            let center = ((texel + 0.5) / self.size - 0.5) * DVec2::new(2.0, -2.0);
            let compared = if self.lookup.bias_receiver_plane {
                let point = self.unproject(center, self.device.z);
                let towards = self.facts.tracer.towards(self.light, point);
                let on_plane = point + towards * (self.receiver_above(point) + self.raised);
                self.clip_from_world.project_point3(on_plane).z
            } else {
                self.device.z
            };
            Some(TexelReading { center, stored, compared })
        };
        texels.into_iter().filter_map(read).collect()
    }

    fn is_clear(&self, texel: &TexelReading) -> bool {
        texel.stored == f64::from(self.lookup.clear_depth)
    }

    fn says_lit(&self, texel: &TexelReading) -> bool {
        let is_reversed = self.lookup.clear_depth == 0.0;
        let is_nearer = if is_reversed { texel.compared >= texel.stored } else { texel.compared <= texel.stored };
        self.is_clear(texel) || is_nearer
    }

    /// Returns the faces of drawn casters that the map keeps on the ray through a point, between it and the light and
    /// behind it, the nearest to the light last.
    fn kept_along(&self, point: DVec3) -> Vec<OccluderHit> {
        let (tracer, light) = (self.facts.tracer, self.light);
        let to_light = tracer.light_distance(light, point);
        let mut hits = tracer.along(light, point);
        hits.retain(|hit| {
            let is_kept = hit.towards_light < to_light && self.is_drawn(hit) && keeps(self.cull, hit);
            is_kept && self.is_between_planes(point, hit)
        });
        hits
    }

    /// Returns whether a hit on the ray through a point lies between the map's near plane and its far one: what does not
    /// is clipped away.
    fn is_between_planes(&self, point: DVec3, hit: &OccluderHit) -> bool {
        let towards = self.facts.tracer.towards(self.light, point);
        let depth = self.clip_from_world.project_point3(point + towards * hit.towards_light).z;
        (0.0..=1.0).contains(&depth)
    }

    fn is_drawn(&self, hit: &OccluderHit) -> bool {
        let name = self.facts.tracer.name(hit.place);
        self.facts.draws(self.light, DrawPart::Map).any(|draw| draw.caster.as_deref() == Some(name))
    }

    /// Returns the number of nine points of a texel, its border included, at which the truth is not what it is at the
    /// pixel: dark for a false shadow, lit for a missing one. Faces within `reach` of the receiver's plane that are its
    /// own object's do not count.
    fn unlike(&self, texel: &TexelReading, is_false: bool, reach: f64) -> usize {
        let steps = [-1.0, 0.0, 1.0];
        let offsets = steps.into_iter().flat_map(|x| steps.map(|y| DVec2::new(x, y)));
        let is_dark = |offset: DVec2| {
            let point = self.unproject(texel.center + offset / self.size, texel.compared);
            let plane = self.receiver_above(point);
            let is_before = |hit: &OccluderHit| {
                let above = hit.towards_light - plane;
                let is_own = hit.place.object == self.seen.place.object;
                above > if is_own { reach } else { 0.0 }
            };
            self.kept_along(point).iter().any(is_before)
        };
        offsets.filter(|offset| is_dark(*offset) == is_false).count()
    }

    /// Returns whether a constant or slope bias pushes the map's depths away from the light.
    fn is_biased(&self) -> bool {
        let MapSettings { bias_constant, bias_slope, .. } = self.facts.map();
        bias_constant > 0 || bias_slope > 0.0
    }

    /// Returns how far along the normal offset the point leaves the shadow, metres; `None` where it does not, where it is
    /// in none, or without an offset. Faces within `rounding` of the receiver's plane throw none.
    fn moved_out(&self, rounding: f64) -> Option<f64> {
        let is_dark = |part: f64| {
            let point = self.seen.point + self.offset * part;
            let plane = self.receiver_above(point);
            self.kept_along(point).iter().any(|hit| hit.towards_light > plane.max(0.0) + rounding)
        };
        let steps = 1..=OFFSET_STEPS;
        let is_moved = self.offset != DVec3::ZERO && is_dark(0.0);
        let mut parts = steps.map(|step| f64::from(step) / f64::from(OFFSET_STEPS));
        is_moved.then(|| parts.find(|part| !is_dark(*part)))?.map(|part| part * self.offset.length())
    }

    /// Returns the cause with its numbers, as far as they hold; `None` where none does.
    fn compare(&self, kind: RegionKind) -> Option<MapComparison> {
        let (facts, light, seen) = (self.facts, self.light, self.seen);
        let RegionKind::Wrong(finding) = kind else { return None };
        let is_false = match finding {
            Finding::FalseShadow => true,
            Finding::MissingShadow => false,
            _ => return None,
        };
        let texel = &self.answering(!is_false)?;
        let target = self.unproject(texel.center, texel.compared);
        let beside = self.unproject(texel.center + DVec2::new(2.0 / self.size, 0.0), texel.compared);
        let width = (beside - target).length();
        let towards = facts.tracer.towards(light, target);
        let height_of = |depth: f64| towards.dot(self.unproject(texel.center, depth) - target);
        let cosine = self.normal.dot(towards).abs().max(1e-9);
        let slope = width * (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
        let to_light = facts.tracer.light_distance(light, target);
        let range = if to_light.is_finite() { to_light } else { (height_of(1.0) - height_of(0.0)).abs() };
        let moved = match facts.coarse_step {
            Some(step) => self.moved_by(step)?,
            None => 0.0,
        };
        let rounding = ROUNDING * range + slope / width * moved;
        let hits = self.kept_along(target);
        let first = hits.last();
        // Without a bias, what the stored depth is off is its rounding.
        let MapSettings { bias_constant, bias_slope, .. } = facts.map();
        let is_moved = bias_constant != 0 || bias_slope != 0.0;
        let off = |first: &OccluderHit| first.towards_light - height_of(texel.stored);
        let bias = first.filter(|_| !self.is_clear(texel)).map(|first| if is_moved { off(first) } else { 0.0 });
        let filter = f64::from(self.lookup.filter_width.max(1));
        let reach = (slope + width) * 1.5 * filter + rounding;
        let between = facts.tracer.between(light, seen);
        let drawn = between.iter().filter(|hit| self.is_drawn(hit) && self.is_between_planes(seen.point, hit));
        let (kept, left_out): (Vec<&OccluderHit>, Vec<&OccluderHit>) = drawn.partition(|hit| keeps(self.cull, hit));
        if !is_false && kept.is_empty() && left_out.is_empty() {
            return None;
        }
        let mut found = MapComparison {
            cause: Cause::Aliasing,
            caster: first.map(|first| first.place.object),
            texel: width,
            slope,
            gap: first.map_or(0.0, |first| first.towards_light + self.raised),
            bias: bias.unwrap_or(0.0) + self.raised,
            rounding,
            place: self.device.truncate().abs().max_element(),
            unlike: 0,
            left_out: left_out.len(),
            kept: kept.len(),
        };
        let is_own = |first: &OccluderHit| {
            let above = first.towards_light - self.receiver_above(target);
            // What lies in the receiver's plane is as its own surface.
            above.abs() <= if first.place.object == seen.place.object { reach } else { rounding }
        };
        let hides = |first: &OccluderHit| first.towards_light > 0.0;
        let moved_out = self.moved_out(rounding).filter(|_| !first.is_some_and(hides));
        found.cause = match (is_false, first, bias) {
            (true, Some(first), Some(_)) if is_own(first) && found.gap + rounding > found.bias => Cause::Acne,
            (false, ..) if kept.is_empty() && !left_out.is_empty() => {
                found.caster = left_out.last().map(|hit| hit.place.object);
                Cause::MapFacesCulled
            }
            (false, Some(first), Some(_)) if hides(first) && found.bias + rounding >= found.gap => Cause::PeterPanning,
            (false, Some(first), None)
                if hides(first) && self.is_biased() && self.unlike(texel, is_false, reach) == 0 =>
            {
                // Depths that are pushed past the last one become that of no caster.
                let out = first.towards_light - height_of(texel.stored);
                found.bias = if out.is_finite() { out.abs() } else { f64::INFINITY };
                Cause::PeterPanning
            }
            (false, ..) if moved_out.is_some() => {
                (found.bias, found.gap) = (self.offset.length(), moved_out.unwrap_or(0.0));
                found.caster = kept.last().map(|hit| hit.place.object);
                Cause::PeterPanning
            }
            _ => Cause::Aliasing,
        };
        if found.cause == Cause::Aliasing {
            found.unlike = self.unlike(texel, is_false, reach);
            if found.caster.is_none() {
                found.caster = kept.last().map(|hit| hit.place.object);
            }
            if found.unlike == 0 {
                return None;
            }
        }
        Some(found)
    }
}
