//! Where a light's shadow map is read for a point of a surface: the face that sees it, the texel, and its own depth there.

use super::{Capture, CapturedMap, Image, StoredQuantity};
use crate::math::depth::DepthCurve;
use crate::plan::MapLookup;
use glam::{DMat2, DMat4, DVec2, DVec3, DVec4};
use std::sync::Arc;

/// Factor by which a face is enlarged, so that points on the border between two faces belong to both, as in
/// `arriving_by_map.wgsl`.
const BORDER: f64 = 1.0001;

/// The transforms and settings with which points are looked up in a light's shadow map.
#[derive(Debug)]
pub struct MapProjection {
    /// Clip space of each face from world space.
    matrices: Vec<DMat4>,
    /// For each face, whether no pass draws it. Empty where that is not known, as for a capture folder.
    left_out: Vec<bool>,
    /// Columns and rows of texels.
    size: [u32; 2],
    /// The light's position, homogeneous, world space.
    light: DVec4,
    /// How depths are compared.
    lookup: MapLookup,
    /// What its texels hold.
    quantity: StoredQuantity,
    /// By how much rounding may change depths; `None` for a frame of our own, which rounds as its shaders do.
    rounding: Option<DepthRounding>,
}

/// By how much rounding may move depths that another program stored, and a surface that is found by them.
#[derive(Debug, Clone, Copy)]
struct DepthRounding {
    /// The least difference of two depths of the map.
    of_map: f64,
    /// The least difference of two depths of the picture.
    of_picture: f64,
    /// The picture's depths by distance.
    curve: DepthCurve,
}

impl DepthRounding {
    /// How many steps a stored depth may be off: its own rounding, and that of the vertices and of their interpolation.
    const STEPS: f64 = 4.0;

    fn new(capture: &Capture, faces: &[Arc<Image>]) -> DepthRounding {
        let step = |is_short: bool| f64::from(if is_short { 16 } else { 24 }).exp2().recip();
        let is_short = |depth: f32| {
            let steps = depth * f32::from(u16::MAX);
            (steps - steps.round()).abs() <= 4.0 * f32::EPSILON * f32::from(u16::MAX)
        };
        let mut stored = faces.iter().flat_map(|face| face.rows()).flat_map(|row| row.chunks_exact(4));
        let of_map = step(stored.all(|texel| is_short(bytemuck::pod_read_unaligned(texel))));
        let of_picture = step(capture.origin.as_ref().is_some_and(|origin| origin.depth_format == "D16"));
        DepthRounding { of_map, of_picture, curve: capture.depth }
    }

    /// Returns how far a point in the eye's space may be off along its view ray.
    fn along_ray(&self, world: DVec3) -> f64 {
        let distance = -world.z;
        let slope = self.curve.scale / if self.curve.is_linear { 1.0 } else { distance * distance };
        let far = DepthRounding::STEPS * self.of_picture / slope.abs() + distance * f64::from(f32::EPSILON);
        far * world.length() / distance
    }
}

impl MapProjection {
    /// Returns the projection of the shadow map of the light with this index; `left_out` says of each face whether no pass
    /// draws it, and is empty where that is not known. `None` where it has no map, one of colours instead of depths, or
    /// another program's of which no view is known, or not what it holds.
    pub fn new(capture: &Capture, light: usize, lookup: MapLookup, left_out: Vec<bool>) -> Option<MapProjection> {
        let of = capture.lights.get(light)?;
        let map: &CapturedMap = of.map.as_ref().filter(|map| !map.holds_colors())?;
        let is_unknown = of.position == DVec4::ZERO || map.quantity == StoredQuantity::Unknown;
        if capture.origin.is_some() && is_unknown {
            return None;
        }
        Some(MapProjection {
            left_out,
            matrices: map.clip_from_light.iter().map(|clip| *clip * map.light_from_world).collect(),
            size: map.faces.first()?.size(),
            light: of.position,
            lookup,
            quantity: map.quantity,
            rounding: capture.origin.as_ref().map(|_| DepthRounding::new(capture, &map.faces)),
        })
    }

    /// Returns the projection of another program's map, of which [`MapLookup::RECORDED`] tells how it is compared.
    pub fn recorded(capture: &Capture, light: usize) -> Option<MapProjection> {
        capture.origin.as_ref()?;
        let clear_depth = capture.map_clear_depth(light);
        MapProjection::new(capture, light, MapLookup { clear_depth, ..MapLookup::RECORDED }, Vec::new())
    }

    /// Returns columns and rows of texels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns how depths are compared.
    pub fn lookup(&self) -> &MapLookup {
        &self.lookup
    }

    /// Returns clip space of a face from world space; `None` where there is no such face.
    pub fn matrix(&self, face: usize) -> Option<&DMat4> {
        self.matrices.get(face)
    }

    /// Returns the face that sees a world position, and the clip-space position in that face; where two do, one that is
    /// drawn. `None` where no face does: the position is behind the light or outside.
    fn seen(&self, world: DVec3) -> Option<(usize, DVec4)> {
        let is_in = |clip: &DVec4| clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w * BORDER;
        let clips = || self.matrices.iter().map(|matrix| *matrix * world.extend(1.0)).enumerate();
        if self.is_cascaded() {
            // Of cascades the first one that has the whole depth there is the finest.
            let is_within = |clip: &DVec4| {
                clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w && (0.0..=clip.w).contains(&clip.z)
            };
            let within = clips().find(|(_, clip)| is_within(clip));
            return within.or_else(|| clips().find(|(_, clip)| is_in(clip)));
        }
        // On a border between two faces, the shader finds the one that is drawn: it has no other.
        let is_drawn = |face: usize| !self.left_out.get(face).copied().unwrap_or(false);
        let drawn = clips().find(|(face, clip)| is_drawn(*face) && is_in(clip));
        drawn.or_else(|| clips().find(|(_, clip)| is_in(clip)))
    }

    /// Returns whether the faces are cascades of another program: views of one direction, each of another part of what is
    /// seen.
    fn is_cascaded(&self) -> bool {
        self.rounding.is_some() && self.light.w == 0.0 && self.matrices.len() > 1
    }

    /// Returns the face that a point of a surface reads, and the clip-space position at which it is looked up, moved by the
    /// normal offset; the face is chosen before that. `None` where no face sees it.
    pub fn place(&self, world: DVec3, normal: DVec3) -> Option<(usize, DVec4)> {
        let (face, _) = self.seen(world)?;
        Some((face, self.matrices[face] * (world + self.push(face, world, normal)?).extend(1.0)))
    }

    /// Returns the normal offset of a point with this normal for a lookup in a face, a world-space vector in metres: so many texels,
    /// times the sine of the angle between normal and light. `None` where the face does not see the point.
    pub fn push(&self, face: usize, world: DVec3, normal: DVec3) -> Option<DVec3> {
        let bias_normal = f64::from(self.lookup.bias_normal);
        if bias_normal == 0.0 {
            return Some(DVec3::ZERO);
        }
        let to_light = (self.light.truncate() - world * self.light.w).normalize_or_zero();
        let cosine = normal.dot(to_light);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        Some(normal * (bias_normal * self.width(face, world)? * sine))
    }

    /// Returns the texels (column, row) of a face that are compared for a clip-space position, row by row, each with the
    /// depth of the surface there (normalised device z, on its plane with the world normal `plane` where the bias is by
    /// plane); beyond the map's border, the border's texel again. The surface's point is `world`; in another program's
    /// frame its depth is moved towards the light by what rounding may have added.
    pub fn compared(
        &self,
        face: usize,
        clip: DVec4,
        world: DVec3,
        plane: DVec3,
    ) -> impl Iterator<Item = ([u32; 2], f64)> + use<> {
        let [_, column, row] = self.first_at(face, clip).map(i64::from);
        let [slope, nearer] =
            if self.lookup.bias_receiver_plane { self.slopes(face, clip, plane) } else { [DVec2::ZERO; 2] };
        let (place, sides, filter) = (self.texel(clip), self.size, self.lookup.filter_width);
        let (quantity, rounding) = (self.quantity, self.rounding(face, clip, world));
        let (device, depth, nearness) = (clip.truncate().truncate() / clip.w, clip.z / clip.w, clip.w.recip());
        let size = DVec2::new(f64::from(sides[0]), f64::from(sides[1]));
        let at = |first: i64, offset: u32, side: u32| {
            (first + i64::from(offset)).clamp(0, i64::from(side.saturating_sub(1))) as u32
        };
        (0..filter).flat_map(move |down| (0..filter).map(move |right| [right, down])).map(move |[right, down]| {
            let at = [at(column, right, sides[0]), at(row, down, sides[1])];
            let middle = DVec2::new(f64::from(at[0]) + 0.5, f64::from(at[1]) + 0.5);
            let offset = (middle - place) / size * DVec2::new(2.0, -2.0);
            let own = quantity.at(device + offset, depth + slope.dot(offset), nearness + nearer.dot(offset));
            (at, own - rounding)
        })
    }

    /// Returns what a face would hold of a surface's point `world` (normalised device z, if it holds depths), without any
    /// bias; in another program's frame it is moved towards the light by what rounding may have added.
    pub fn own_depth(&self, face: usize, clip: DVec4, world: DVec3) -> f64 {
        self.quantity.of(clip) - self.rounding(face, clip, world)
    }

    /// Returns what the texels hold.
    pub fn quantity(&self) -> &StoredQuantity {
        &self.quantity
    }

    /// Returns by how much rounding may have moved a surface's depth away from the light, with its sign.
    fn rounding(&self, face: usize, clip: DVec4, world: DVec3) -> f64 {
        let Some(rounding) = self.rounding else { return 0.0 };
        let moved = self.matrices[face] * (world.normalize_or_zero() * rounding.along_ray(world)).extend(0.0);
        let by_picture = self.quantity.change(clip, moved);
        let all = DepthRounding::STEPS * rounding.of_map + by_picture.abs() + self.quantity.residual();
        if self.lookup.clear_depth == 0.0 { -all } else { all }
    }

    /// Returns whether the comparison of what a texel stores with a surface's own depth there lets the light pass:
    /// nothing nearer to the light is stored.
    pub fn is_lit(&self, stored: f32, depth: f32) -> bool {
        let clear = self.lookup.clear_depth;
        stored == clear || if clear == 0.0 { depth >= stored } else { depth <= stored }
    }

    /// Returns the width of a face's texel at a world position, metres, as it lies across the light's view; `None`
    /// behind the light.
    pub fn width(&self, face: usize, world: DVec3) -> Option<f64> {
        let matrix = self.matrices.get(face)?;
        let distance = (*matrix * world.extend(1.0)).w;
        let focal = matrix.row(0).truncate().length();
        (distance > 0.0 && focal > 0.0).then(|| 2.0 * distance / (focal * f64::from(self.size[0])))
    }

    /// Converts a clip-space position to texels of the face, from its upper left corner; the result may lie outside.
    pub fn texel(&self, clip: DVec4) -> DVec2 {
        let size = DVec2::new(f64::from(self.size[0]), f64::from(self.size[1]));
        (DVec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5) * size
    }

    /// Returns the point of a plane, through `world` with the normal `plane`, that a face sees at a place (texels from the upper left
    /// corner); `None` where the light sees the plane edge-on, or not there.
    pub fn on_plane(&self, face: usize, world: DVec3, plane: DVec3, place: DVec2) -> Option<DVec3> {
        let matrix = self.matrices.get(face)?;
        let size = DVec2::new(f64::from(self.size[0]), f64::from(self.size[1]));
        let to = (place / size * 2.0 - 1.0) * DVec2::new(1.0, -1.0);
        // How far a clip-space vector is from the view ray there, along x and y.
        let off = |clip: DVec4| clip.truncate().truncate() - to * clip.w;
        let (right, up) = plane.any_orthonormal_pair();
        let along = DMat2::from_cols(off(*matrix * right.extend(0.0)), off(*matrix * up.extend(0.0)));
        let steps = along.try_inverse()? * -off(*matrix * world.extend(1.0));
        let point = world + right * steps.x + up * steps.y;
        ((*matrix * point.extend(1.0)).w > 0.0).then_some(point)
    }

    /// Returns whether a triangle whose corners run counter-clockwise as the light sees it has them so in a face, too (with y
    /// up): a view may be mirrored. `None` where there is no such face, or it sees nothing.
    pub fn keeps_winding(&self, face: usize) -> Option<bool> {
        let matrix = self.matrices.get(face)?;
        let middle = matrix.inverse() * DVec4::new(0.0, 0.0, 0.5, 1.0);
        let middle = middle.truncate() / middle.w;
        let towards = (self.light.truncate() - middle * self.light.w).try_normalize()?;
        let right = towards.any_orthonormal_vector();
        let [x, y] = [right, towards.cross(right)].map(|step| (*matrix * step.extend(0.0)).truncate().truncate());
        let area = x.perp_dot(y);
        (area != 0.0 && area.is_finite()).then_some(area > 0.0)
    }

    /// Returns how depth and 1 / w change along x and y of a face (normalised device coordinates) on a plane through `clip`
    /// with the world normal `plane`; zero where the light sees the plane edge-on.
    fn slopes(&self, face: usize, clip: DVec4, plane: DVec3) -> [DVec2; 2] {
        // Of x, y, z and 1 / w.
        let along = |direction: DVec3| {
            let moved = self.matrices[face] * direction.extend(0.0);
            ((moved.truncate() - clip.truncate() * (moved.w / clip.w)) / clip.w).extend(-moved.w / (clip.w * clip.w))
        };
        let (right, up) = plane.any_orthonormal_pair();
        let (a, b) = (along(right), along(up));
        let area = a.x * b.y - a.y * b.x;
        if area == 0.0 {
            return [DVec2::ZERO; 2];
        }
        [(a.z, b.z), (a.w, b.w)].map(|(a_by, b_by)| DVec2::new(a_by * b.y - b_by * a.y, b_by * a.x - a_by * b.x) / area)
    }

    /// Returns face, column and row of the first texel (upper left of the filter, which may lie outside the map) that a
    /// world position reads without normal offset; `None` where no face sees it.
    pub fn first_of(&self, world: DVec3) -> Option<[i16; 3]> {
        self.seen(world).map(|(face, clip)| self.first_at(face, clip))
    }

    /// Returns face, column and row of the first texel that is read for a clip-space position of a face.
    pub fn first_at(&self, face: usize, clip: DVec4) -> [i16; 3] {
        let first = (self.texel(clip) - 0.5 * f64::from(self.lookup.filter_width - 1)).floor();
        [face as i16, first.x as i16, first.y as i16]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::depth::DepthMapping;

    #[test]
    fn a_cascade_whose_view_is_not_known_is_read_by_no_point() {
        let curve = DepthMapping::StandardInfinite.curve(0.1, 0.0, 0.0);
        let projection = MapProjection {
            matrices: vec![DMat4::ZERO, DMat4::from_scale(DVec3::splat(0.5)), DMat4::from_scale(DVec3::splat(0.1))],
            left_out: Vec::new(),
            size: [64, 64],
            light: DVec4::Z,
            lookup: MapLookup::RECORDED,
            quantity: StoredQuantity::Depth,
            rounding: Some(DepthRounding { of_map: 1e-7, of_picture: 1e-7, curve }),
        };
        let face = |world: [f64; 3]| projection.seen(DVec3::from_array(world)).map(|(face, _)| face);
        assert_eq!(face([1.0, 1.0, 1.0]), Some(1));
        assert_eq!(face([5.0, 1.0, 1.0]), Some(2));
        assert_eq!(face([50.0, 1.0, 1.0]), None);
    }
}
