//! Filtered shadow maps that darken lit surfaces in part: texels around a point show the surface itself, nearer to the
//! light than the one depth that all of them are compared with.
//!
//! And filters at a border between two faces of a cube, which read the last texels of one face again instead of those of
//! the next.
//!
//! A texel is the surface's own where it would be lit if it were compared with the depth that the surface's plane has at
//! that texel. A soft edge is none of that: there, texels show what stands before the plane.

use super::map_comparison::find_face;
use crate::capture::{Capture, Image};
use crate::diagnosis::RegionKind;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause, amount};
use crate::diagnosis::fix::Fix;
use crate::numbers;
use crate::plan::{FramePlan, MapLookup, PlanMap};
use crate::truth::{LIT, SHADOW, SeenSurface, Tracer};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;

pub(crate) const RULES: &[CauseRule] = &[acne, map_seam];

/// By what share of the light a pixel must be off at a border, at least: a sixteenth is seen.
const SEEN: f64 = 1.0 / 16.0;

/// Returns whether some light of a plan is read through a filter, so that surfaces may be dark in part.
pub(crate) fn may_darken_in_part(plan: &FramePlan) -> bool {
    plan.lights.iter().any(|light| filtered(light.map.as_ref()).is_some())
}

/// Returns how a map is read, where it is read through a filter that compares all texels with one depth, that of the
/// point itself. With a receiver-plane bias each is compared with the plane's own depth, so that none is the surface's;
/// with a normal offset the surface is compared from elsewhere, which is not followed here.
fn filtered(map: Option<&PlanMap>) -> Option<(&PlanMap, MapLookup)> {
    let map = map?;
    let is_plain = |lookup: &MapLookup| !lookup.bias_receiver_plane && lookup.bias_normal == 0.0;
    map.lookup.filter(|lookup| lookup.filter_width > 1 && is_plain(lookup)).map(|lookup| (map, lookup))
}

/// Returns the indices of pixels, row-major, that are lit by label and by the `truth` of a light, and whose filter has
/// texels that the surface itself darkens. Empty where the light's map has no filter, or the capture no visibility.
pub(crate) fn darkened_in_part(
    plan: &FramePlan,
    capture: &Capture,
    tracer: &Tracer,
    light: usize,
    truth: &[u8],
) -> Vec<usize> {
    let Some(captured) = capture.lights.get(light) else { return Vec::new() };
    let (Some(visibility), Some(labels)) = (&captured.visibility, &captured.shadow) else { return Vec::new() };
    let Some(reading) = FilterReading::new(plan, capture, light) else { return Vec::new() };
    let shares = visibility.values();
    let labels: Vec<u8> = labels.rows().flatten().copied().collect();
    let is_dark = |index: &usize| {
        if truth[*index] != LIT || labels[*index] != LIT || shares[*index] >= 1.0 {
            return false;
        }
        let [x, y] = crate::accuracy::place(*index, plan.size);
        let seen = tracer.seen_at([f64::from(x) + 0.5, f64::from(y) + 0.5]);
        seen.and_then(|seen| reading.at(&seen)).is_some_and(|filter| filter.own > 0)
    };
    (0..shares.len()).into_par_iter().filter(is_dark).collect()
}

/// Returns the indices of pixels, row-major, whose label of a light agrees with the `truth`, and to which another share
/// of the light arrives than if their filter read on in the next face of the cube. Empty where the light's map has no
/// filter or only one face, or the capture no visibility.
pub(crate) fn broken_at_a_seam(
    plan: &FramePlan,
    capture: &Capture,
    tracer: &Tracer,
    light: usize,
    truth: &[u8],
) -> Vec<usize> {
    let Some(captured) = capture.lights.get(light) else { return Vec::new() };
    let (Some(visibility), Some(labels)) = (&captured.visibility, &captured.shadow) else { return Vec::new() };
    let Some(reading) = FilterReading::new(plan, capture, light) else { return Vec::new() };
    let shares = visibility.values();
    let labels: Vec<u8> = labels.rows().flatten().copied().collect();
    let is_broken = |index: &usize| {
        if !(truth[*index] == labels[*index] && [LIT, SHADOW].contains(&labels[*index])) {
            return false;
        }
        let [x, y] = crate::accuracy::place(*index, plan.size);
        let border = tracer.seen_at([f64::from(x) + 0.5, f64::from(y) + 0.5]).and_then(|seen| reading.across(&seen));
        // Where rounding reads other texels than the shader did, nothing is known.
        border.is_some_and(|border| border.off() >= SEEN && (f64::from(shares[*index]) - border.share).abs() < 1e-3)
    };
    (0..shares.len()).into_par_iter().filter(is_broken).collect()
}

/// A light's map as a filter reads it.
struct FilterReading<'a> {
    map: &'a PlanMap,
    lookup: MapLookup,
    faces: Vec<FaceMatrices<'a>>,
    eye: DVec3,
}

/// A face's texels, and the matrices between it and the world.
struct FaceMatrices<'a> {
    image: &'a Image,
    clip_from_world: DMat4,
    world_from_clip: DMat4,
}

impl FaceMatrices<'_> {
    /// Returns the number of texels along each side.
    fn size(&self) -> f64 {
        f64::from(self.image.size()[0])
    }

    /// Returns where a point of normalized device coordinates lies, in texels from the upper left corner.
    fn place(&self, device: DVec3) -> DVec2 {
        (device.truncate() * DVec2::new(0.5, -0.5) + 0.5) * self.size()
    }

    /// Returns the middle of a texel, normalized device coordinates.
    fn center(&self, texel: DVec2) -> DVec2 {
        ((texel + 0.5) / self.size() - 0.5) * DVec2::new(2.0, -2.0)
    }
}

/// What the filter finds at a surface point.
struct FilteredPoint {
    /// Texels that are compared, and those of them that the surface itself darkens.
    all: u32,
    own: u32,
    /// How much nearer to the light the surface's plane is at the nearest of its own texels than at the point, metres,
    /// and by how much the map's depth is moved away there.
    rise: f64,
    bias: f64,
}

/// What the filter finds at a surface point beside a border of its face.
struct BorderPoint {
    /// Texels that lie beyond the border.
    beyond: u32,
    /// The share of the light that arrives, and that would if those were read in the next face.
    share: f64,
    across: f64,
}

impl BorderPoint {
    fn off(&self) -> f64 {
        (self.share - self.across).abs()
    }
}

impl<'a> FilterReading<'a> {
    /// Returns the reading of a light's map; `None` where it has no filter, or its faces were not captured.
    fn new(plan: &'a FramePlan, capture: &'a Capture, light: usize) -> Option<FilterReading<'a>> {
        let (map, lookup) = filtered(plan.lights.get(light)?.map.as_ref())?;
        let images = &capture.lights.get(light)?.map.as_ref()?.faces;
        let faces = map.clip_from_light.iter().zip(images).map(|(clip_from_light, image)| {
            let clip_from_world = *clip_from_light * map.light_from_world;
            FaceMatrices { image, clip_from_world, world_from_clip: clip_from_world.inverse() }
        });
        Some(FilterReading { map, lookup, faces: faces.collect(), eye: plan.views.first()?.origin })
    }

    /// Returns whether a depth is at the stored one or nearer to the light.
    fn is_lit(&self, depth: f64, stored: f64) -> bool {
        if self.lookup.clear_depth == 0.0 { depth >= stored } else { depth <= stored }
    }

    /// Compares all texels of the filter at a surface point, once as the shader does, which reads the last texels of a
    /// face again beyond its border, and once with those of the next face. `None` where no texel lies beyond the border,
    /// and for a map of one face.
    fn across(&self, seen: &SeenSurface) -> Option<BorderPoint> {
        let face = self.faces.get(find_face(self.map, seen.point - self.eye)?).filter(|_| self.faces.len() > 1)?;
        let depth = face.clip_from_world.project_point3(seen.point).z;
        let is_passed =
            |stored: f32, depth: f64| stored == self.lookup.clear_depth || self.is_lit(depth, stored.into());
        let (mut beyond, mut lit, mut lit_across) = (0, 0, 0);
        for texel in self.texels(face, seen) {
            let last = texel.clamp(DVec2::ZERO, DVec2::splat(face.size() - 1.0));
            let is_lit = is_passed(face.image.depth_at([last.x as u32, last.y as u32])?, depth);
            lit += u32::from(is_lit);
            if last == texel {
                lit_across += u32::from(is_lit);
                continue;
            }
            beyond += 1;
            let point = face.world_from_clip.project_point3(face.center(texel).extend(depth));
            let other = self.faces.get(find_face(self.map, point - self.eye)?)?;
            let place = other.place(other.clip_from_world.project_point3(point));
            let place = place.floor().clamp(DVec2::ZERO, DVec2::splat(other.size() - 1.0));
            let own = other.clip_from_world.project_point3(seen.point).z;
            lit_across += u32::from(is_passed(other.image.depth_at([place.x as u32, place.y as u32])?, own));
        }
        let all = f64::from(self.lookup.filter_width.pow(2));
        (beyond > 0).then(|| BorderPoint { beyond, share: f64::from(lit) / all, across: f64::from(lit_across) / all })
    }

    /// Returns the texels of the filter at a surface point, row by row; some may lie beyond the face's border.
    fn texels(&self, face: &FaceMatrices, seen: &SeenSurface) -> impl Iterator<Item = DVec2> + use<> {
        let width = self.lookup.filter_width;
        let place = face.place(face.clip_from_world.project_point3(seen.point));
        let first = (place - 0.5 * f64::from(width - 1)).floor();
        let steps = (0..width).flat_map(move |row| (0..width).map(move |column| DVec2::new(column.into(), row.into())));
        steps.map(move |step| first + step)
    }

    /// Compares all texels of the filter at a surface point, once as the shader does, and once with the depths of the
    /// surface's own plane; `None` outside the map, and for a surface that the light sees edge-on.
    fn at(&self, seen: &SeenSurface) -> Option<FilteredPoint> {
        let face = self.faces.get(find_face(self.map, seen.point - self.eye)?)?;
        let device = face.clip_from_world.project_point3(seen.point);
        let normal = (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]).normalize_or_zero();
        let mut found = FilteredPoint { all: self.lookup.filter_width.pow(2), own: 0, rise: 0.0, bias: 0.0 };
        for texel in self.texels(face, seen) {
            let texel = texel.clamp(DVec2::ZERO, DVec2::splat(face.size() - 1.0));
            let stored = face.image.depth_at([texel.x as u32, texel.y as u32])?;
            if stored == self.lookup.clear_depth || self.is_lit(device.z, stored.into()) {
                continue;
            }
            let center = face.center(texel);
            let [near, far] = [0.25, 0.75].map(|depth| face.world_from_clip.project_point3(center.extend(depth)));
            let along = far - near;
            let on_plane = near + along * (normal.dot(seen.point - near) / normal.dot(along));
            let own = face.clip_from_world.project_point3(on_plane).z;
            if !on_plane.is_finite() || !self.is_lit(own, stored.into()) {
                continue;
            }
            found.own += 1;
            let at_depth = |depth: f64| face.world_from_clip.project_point3(center.extend(depth));
            let [rise, bias] = [device.z, f64::from(stored)].map(|depth| at_depth(depth).distance(on_plane));
            if rise - bias > found.rise - found.bias {
                (found.rise, found.bias) = (rise, bias);
            }
        }
        Some(found)
    }
}

fn acne(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if case.region.key.kind != RegionKind::PartlyDark {
        return None;
    }
    let reading = FilterReading::new(facts.plan, facts.capture, case.light())?;
    let (FilteredPoint { all, own, rise, bias }, shown_by) =
        case.shown(|sample| reading.at(&sample.seen?).filter(|filter| filter.own > 0))?;
    let sentence = format!(
        "{} of the {all} that the filter compares show the surface itself: over the filter's radius it gets {} nearer to \
         the light than the one depth that they are compared with, and the bias is {}",
        amount(own.into(), "texel"),
        numbers::metres(rise),
        numbers::metres(bias)
    );
    let too_little = Quantity::less_than("the bias, in metres", bias, rise);
    let mut fixes = vec![Fix::setting("bias-receiver-plane", "on")];
    let slope = facts.map().bias_slope;
    let reach = f64::from(facts.map().filter_width) + 2.0;
    fixes.extend((slope < reach).then(|| Fix::setting("bias-slope", &format!("{reach}"))));
    fixes.push(Fix::setting("filter", "none"));
    Some(SuspectedCause::new(Cause::Acne, case.evidence(sentence, shown_by, [too_little]), fixes))
}

fn map_seam(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if case.region.key.kind != RegionKind::Seam {
        return None;
    }
    let reading = FilterReading::new(facts.plan, facts.capture, case.light())?;
    let (border, shown_by) =
        case.shown(|sample| reading.across(&sample.seen?).filter(|border| border.off() >= SEEN))?;
    let reach = f64::from(facts.map().filter_width / 2);
    let sentence = format!(
        "beyond the border of the face, of {} of the filter's {}, its last ones are read again: {} of the light \
         arrives, and {} would if they were read in the next face; faces {} wider on each side would hold them, of \
         texels {} times as wide",
        amount(border.beyond.into(), "texel"),
        facts.map().filter_width.pow(2),
        numbers::digits(border.share),
        numbers::digits(border.across),
        amount(reach as u64, "texel"),
        numbers::digits((facts.texels() + 2.0 * reach) / facts.texels())
    );
    let quantities = [
        Quantity::at_least("texels of the filter beyond the border of their face", border.beyond.into(), 1.0),
        Quantity::at_least("the share of the light that they change", border.off(), SEEN),
    ];
    let fixes = vec![Fix::setting("filter", "none")];
    Some(SuspectedCause::new(Cause::MapSeam, case.evidence(sentence, shown_by, quantities), fixes))
}
