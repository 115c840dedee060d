//! Directions from a ray origin in two dimensions: where its rays and the triangles they may hit lie.
//!
//! All view rays begin in the eye, and all light rays in the light. Seen from there a ray is a point and a triangle a
//! patch, so that "which triangles may this ray hit" is a question about boxes in the plane. A point's surroundings are
//! projected on the six faces of a cube, laid out side by side; what a point sees from afar, through a window that fits
//! it; a direction's, on one plane across it. The third coordinate grows with the distance from the origin.
//!
//! Boxes are `f32`, rounded outwards: a box may be too large, never too small.

use super::tree::ProjectedRect;
use glam::{DVec2, DVec3, DVec4, Vec2, Vec3A, Vec3Swizzles};

/// A scene farther away than this many times its radius is projected onto one plane (window) instead of a cube.
const FAR: f64 = 4.0;
/// From this many times its radius on, rays are projected as if they were parallel.
const VERY_FAR: f64 = 1e5;
/// A ray at an angle to the window's axis with a smaller cosine misses the scene, which lies within asin(1 / [`FAR`])
/// of the axis.
const WINDOW_COSINE: f64 = 0.5;
/// Distance between the middles of neighbouring faces in the projection; each face spans −1 to 1.
const FACE_SPACING: f64 = 4.0;
/// An upper bound for the rounding error of a projected point, as long as its triangle is [`NEAREST`] away from the
/// origin.
const PADDING: f64 = 1e-7;
/// An upper bound for the rounding error of a point that is projected in single precision.
const COARSE_PADDING: f64 = 1e-6;
/// A ray whose largest coordinate, scaled to a cube of half side 1, is above this surely crosses that face, or one
/// whose triangles are on this face too.
const FACE_SURE: f32 = 1.0 - 4.0 * f32::EPSILON;
/// A triangle whose plane is nearer to the origin than this, relative to its size, may be projected anywhere.
pub const NEAREST: f64 = 1e-7;
/// How far faces reach over their borders, so that a ray on a border is found on either face.
const OVERLAP: f64 = 1e-5;

/// A box in the projection: a rectangle with its range of depths.
#[derive(Debug, Clone, Copy)]
struct ProjectedBox {
    low: DVec3,
    high: DVec3,
}

/// The rectangles of a triangle or a packet of rays in the projection, one for each cube face that it is on.
pub type FaceRects = [Option<ProjectedRect>; 6];

/// The projection of all directions from a ray origin onto rectangles: a cube, a window or a plane.
#[derive(Debug, Clone, Copy)]
pub enum DirectionProjection {
    /// Onto the six faces of a cube around a point. `middle` is the distance that becomes depth ½.
    Cube { center: DVec3, middle: f64 },
    /// From a distant point: two unit vectors across the axis, and the unit axis towards the scene's middle, which is
    /// `distance` away; the scene reaches as far as `reach` around that.
    Window { center: DVec3, across: [DVec3; 2], axis: DVec3, distance: f64, reach: f64 },
    /// Across lines that are parallel, or nearly so, as their centre is `distance` away: two unit
    /// vectors across and the unit direction towards the centre; places are relative to `middle`
    /// and divided by `reach`.
    Plane { center: DVec4, middle: DVec3, across: [DVec3; 2], towards: DVec3, reach: f64, distance: f64 },
}

/// A ray from the ray origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OriginRay {
    /// It ends at this point.
    To(DVec3),
    /// It passes through this point from an origin at infinity, and has no end.
    Through(DVec3),
    /// It goes in this direction, and has no end.
    Along(DVec3),
}

impl DirectionProjection {
    /// Returns the projection for the view rays of an eye that sees what lies within `reach` of `middle`.
    pub fn of_eye(center: DVec4, middle: DVec3, reach: f64) -> DirectionProjection {
        match center.w == 0.0 {
            true => DirectionProjection::of_light(center, middle, reach),
            false => DirectionProjection::of_point(center.truncate(), middle, reach),
        }
    }

    fn of_point(center: DVec3, middle: DVec3, reach: f64) -> DirectionProjection {
        let distance = (middle - center).length();
        if distance > FAR * reach {
            let axis = (middle - center) / distance;
            let u = axis.any_orthonormal_vector();
            return DirectionProjection::Window { center, across: [u, axis.cross(u)], axis, distance, reach };
        }
        DirectionProjection::Cube { center, middle: distance.max(reach) }
    }

    /// Returns the projection for the rays of a homogeneous light onto what lies within `reach` of `middle`: onto a
    /// plane where the light is directional or very far, else that of a point.
    pub fn of_light(center: DVec4, middle: DVec3, reach: f64) -> DirectionProjection {
        let place = center.truncate();
        let distance = if center.w == 0.0 { f64::INFINITY } else { (place - middle).length() };
        if distance <= VERY_FAR * reach {
            return DirectionProjection::of_point(place, middle, reach);
        }
        let towards = if center.w == 0.0 { place } else { place - middle };
        let towards = towards.normalize();
        let u = towards.any_orthonormal_vector();
        DirectionProjection::Plane { center, middle, across: [u, towards.cross(u)], towards, reach, distance }
    }

    /// Calls `add` with each rectangle that a triangle covers in the projection. With `is_near`, the triangle's plane
    /// all but contains the centre, and it may be anywhere.
    pub fn for_each_area(&self, corners: [DVec3; 3], is_near: bool, mut add: impl FnMut(ProjectedRect)) {
        let DirectionProjection::Cube { center, .. } = self else {
            add(self.on_sheet(corners.into_iter().map(OriginRay::To)).of_triangle());
            return;
        };
        let corners = corners.map(|corner| corner - *center);
        let face = face_of(corners[0]);
        if is_near {
            (0..6).for_each(|face| add(whole_face(face).of_triangle()));
        } else if corners.iter().all(|corner| is_within(face, *corner)) {
            add(self.on_face_alone(face, corners).of_triangle());
        } else {
            (0..6).filter_map(|face| self.clipped(face, corners)).for_each(|span| add(span.of_triangle()));
        }
    }

    /// Returns for each face of the projection the rectangle that a packet of rays covers, with the largest depth;
    /// `None` for a face that none of them meets.
    pub fn packet(&self, lines: impl Iterator<Item = OriginRay> + Clone) -> FaceRects {
        let is_endless = lines.clone().any(|line| !matches!(line, OriginRay::To(_)));
        let open = |span: ProjectedBox| span.of_lines(is_endless);
        let mut boxes = FaceRects::default();
        match self {
            DirectionProjection::Plane { .. } => boxes[0] = Some(open(self.on_sheet(lines))),
            DirectionProjection::Window { center, axis, .. } => {
                let may_meet = |line: &OriginRay| {
                    let along = line.from(*center);
                    along.dot(*axis) > WINDOW_COSINE * along.length()
                };
                let is_any = lines.clone().any(|line| may_meet(&line));
                boxes[0] = is_any.then(|| open(self.on_sheet(lines.filter(may_meet))));
            }
            DirectionProjection::Cube { center, .. } => {
                let mut spans = [(DVec3::INFINITY, DVec3::NEG_INFINITY); 6];
                for line in lines {
                    let point = line.from(*center);
                    let face = face_of(point);
                    let place = self.on_face(face, point);
                    spans[face] = (spans[face].0.min(place), spans[face].1.max(place));
                }
                for (face, (low, high)) in spans.into_iter().enumerate().filter(|(_, (low, high))| low.x <= high.x) {
                    boxes[face] = Some(open(padded(low, high, face, PADDING)));
                }
            }
        }
        boxes
    }

    /// Returns the rectangle of rays that all cross one face of the cube. `low` and `high` are the box of the points
    /// where they cross the cube of half side 1 around the origin, `end` the largest coordinate of their ends. `None`
    /// where they don't clearly cross one face only.
    pub fn on_one_face(&self, low: Vec3A, high: Vec3A, end: f32) -> Option<ProjectedRect> {
        let DirectionProjection::Cube { middle, .. } = self else { return None };
        let is_sure = |axis: &usize| low[*axis] > FACE_SURE || high[*axis] < -FACE_SURE;
        let axis = (0..3).find(is_sure)?;
        let face = axis * 2 + usize::from(high[axis] < 0.0);
        let flat = |corner: Vec3A| DVec2::new(f64::from(corner[(axis + 1) % 3]), f64::from(corner[(axis + 2) % 3]));
        let depth =
            |end: f32| if end == f32::INFINITY { f64::INFINITY } else { f64::from(end) / (f64::from(end) + middle) };
        Some(padded(flat(low).extend(0.0), flat(high).extend(depth(end)), face, COARSE_PADDING).of_lines(false))
    }

    /// Returns an upper bound for the depth of points whose coordinates relative to the origin are at most `end`.
    pub fn depth(&self, end: f64) -> f32 {
        match self {
            DirectionProjection::Cube { middle, .. } => above(end / (end + middle) + COARSE_PADDING),
            DirectionProjection::Window { .. } | DirectionProjection::Plane { .. } => f32::INFINITY,
        }
    }

    /// Returns the position that points are subtracted from before rounding: the ray origin, or the scene's middle.
    pub fn origin(&self) -> DVec3 {
        match self {
            DirectionProjection::Cube { center, .. } | DirectionProjection::Window { center, .. } => *center,
            DirectionProjection::Plane { middle, .. } => *middle,
        }
    }

    /// Returns the vector from the ray origin to a corner; where the origin is at infinity, the same vector, away from
    /// it, for all corners.
    pub fn lever(&self, corner: DVec3) -> DVec3 {
        match self {
            DirectionProjection::Cube { center, .. } | DirectionProjection::Window { center, .. } => corner - center,
            DirectionProjection::Plane { center, .. } if center.w == 0.0 => -center.truncate(),
            DirectionProjection::Plane { center, .. } => corner - center.truncate(),
        }
    }

    /// Returns whether [`DirectionProjection::origin`] is the ray origin.
    pub fn is_centered(&self) -> bool {
        !matches!(self, DirectionProjection::Plane { .. })
    }

    /// Returns the box of points or rays in a projection that is one plane, padded for rounding; for a cube, the whole
    /// of face 0.
    fn on_sheet(&self, lines: impl Iterator<Item = OriginRay> + Clone) -> ProjectedBox {
        match self {
            DirectionProjection::Cube { .. } => whole_face(0),
            DirectionProjection::Plane { middle, across: [u, v], towards, reach, distance, .. } => {
                let places = lines.map(|line| line.from(*middle));
                // Lines lean towards their centre: the more, the farther off they are.
                let farthest = places.clone().map(|place| place.length()).fold(*reach, f64::max);
                let leaning = 8.0 * farthest / distance * (farthest / reach);
                let place = |place: DVec3| DVec3::new(place.dot(*u), place.dot(*v), -place.dot(*towards)) / *reach;
                bounds(places.map(place), 0, PADDING * farthest / reach + leaning)
            }
            DirectionProjection::Window { center, across: [u, v], axis, distance, reach } => {
                let place = |line: OriginRay| {
                    let point = line.from(*center);
                    let along = point.dot(*axis);
                    let [x, y] = [u, v].map(|side| point.dot(*side) / along * (distance / reach));
                    DVec3::new(x, y, (along - distance) / reach)
                };
                // Points are rounded at their distance from the origin, and projected at the scene's size.
                bounds(lines.map(place), 0, PADDING + 64.0 * f64::EPSILON * distance / reach)
            }
        }
    }

    /// Projects a point (relative to the ray origin) onto a face of the cube: the two coordinates across it, then its
    /// depth.
    fn on_face(&self, face: usize, point: DVec3) -> DVec3 {
        self.projected(along_face(face, point))
    }

    /// Returns the projected box, padded for rounding, of a triangle (relative to the ray origin) that is on this face
    /// alone.
    fn on_face_alone(&self, face: usize, corners: [DVec3; 3]) -> ProjectedBox {
        let corners = corners.map(|corner| along_face(face, corner));
        let [a, b, c] = corners.map(|corner| corner.truncate() * corner.z.recip());
        let nearest = corners[0].z.min(corners[1].z).min(corners[2].z);
        let nearest = self.projected(DVec3::new(0.0, 0.0, nearest)).z;
        padded(a.min(b).min(c).extend(nearest), a.max(b).max(c).extend(nearest), face, PADDING)
    }

    /// Projects a point that is given in a face's own coordinates, the third along its axis: the first two over the
    /// third, and a depth from 0 to 1. Unchanged for a projection that is no cube.
    fn projected(&self, point: DVec3) -> DVec3 {
        let DirectionProjection::Cube { middle, .. } = self else { return point };
        let place: DVec2 = point.truncate() / point.z;
        place.extend(point.z / (point.z + middle))
    }

    /// Returns the projected box of the part of a triangle (relative to the ray origin) within the frustum of a face,
    /// which overlaps its neighbours a little (Sutherland and Hodgman 1974); `None` where there is none.
    fn clipped(&self, face: usize, corners: [DVec3; 3]) -> Option<ProjectedBox> {
        let mut polygon: Vec<DVec3> = corners.iter().map(|corner| along_face(face, *corner)).collect();
        for side in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y] {
            let inwards = side + DVec3::Z * (1.0 + OVERLAP);
            let mut clipped = Vec::with_capacity(polygon.len() + 1);
            for (index, from) in polygon.iter().enumerate() {
                let to = polygon[(index + 1) % polygon.len()];
                let (inside, inside_next) = (inwards.dot(*from), inwards.dot(to));
                if inside >= 0.0 {
                    clipped.push(*from);
                }
                if (inside >= 0.0) != (inside_next >= 0.0) {
                    clipped.push(*from + (to - *from) * (inside / (inside - inside_next)));
                }
            }
            polygon = clipped;
        }
        let is_on_face = !polygon.is_empty();
        is_on_face.then(|| bounds(polygon.into_iter().map(|point| self.projected(point)), face, PADDING))
    }
}

/// Returns the padded box around projected points, shifted to the face's place.
fn bounds(on_faces: impl IntoIterator<Item = DVec3>, face: usize, padding: f64) -> ProjectedBox {
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = on_faces.into_iter().fold(empty, |(low, high), place| (low.min(place), high.max(place)));
    padded(low, high, face, padding)
}

fn padded(low: DVec3, high: DVec3, face: usize, padding: f64) -> ProjectedBox {
    let shift = DVec3::new(face as f64 * FACE_SPACING, 0.0, 0.0);
    ProjectedBox { low: low + shift - padding, high: high + shift + padding }
}

impl ProjectedBox {
    fn area(&self, depth: f32) -> ProjectedRect {
        let (low, high) = (self.low, self.high);
        ProjectedRect {
            low: Vec2::new(below(low.x), below(low.y)),
            high: Vec2::new(above(high.x), above(high.y)),
            depth,
        }
    }

    fn of_triangle(self) -> ProjectedRect {
        self.area(below(self.low.z))
    }

    fn of_lines(self, are_endless: bool) -> ProjectedRect {
        self.area(if are_endless { f32::INFINITY } else { above(self.high.z) })
    }
}

impl OriginRay {
    /// Returns the ray's target relative to `center`; its direction as it is where it has no target.
    pub fn from(self, center: DVec3) -> DVec3 {
        match self {
            OriginRay::To(point) | OriginRay::Through(point) => point - center,
            OriginRay::Along(direction) => direction,
        }
    }
}

/// Returns whether the direction to a corner (relative to the ray origin) lies within a face and not in the overlap
/// along its border.
fn is_within(face: usize, corner: DVec3) -> bool {
    let along = along_face(face, corner);
    along.x.abs().max(along.y.abs()) < along.z * (1.0 - OVERLAP)
}

/// Returns the index of the face that a direction points to: twice the axis of its largest coordinate (the first of
/// equal ones), plus 1 where that is negative.
fn face_of(direction: DVec3) -> usize {
    let size = direction.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    axis * 2 + usize::from(direction[axis] < 0.0)
}

/// Returns a point in a face's own coordinates: the two across the face in cyclic order of the axes, the third along
/// its axis, positive ahead.
fn along_face(face: usize, point: DVec3) -> DVec3 {
    let rotated = match face / 2 {
        0 => point.yzx(),
        1 => point.zxy(),
        _ => point,
    };
    if face % 2 == 1 { rotated.with_z(-rotated.z) } else { rotated }
}

fn whole_face(face: usize) -> ProjectedBox {
    let center = DVec3::new(face as f64 * FACE_SPACING, 0.0, 0.0);
    ProjectedBox { low: center - DVec3::new(1.5, 1.5, 0.0), high: center + DVec3::new(1.5, 1.5, 1.0) }
}

/// Returns an `f32` that is less than the number, by about one or two steps: a safe lower bound.
fn below(value: f64) -> f32 {
    let rounded = value as f32;
    rounded - (rounded.abs() * f32::EPSILON + f32::MIN_POSITIVE)
}

/// Returns an `f32` that is greater than the number, by about one or two steps: a safe upper bound.
fn above(value: f64) -> f32 {
    let rounded = value as f32;
    rounded + (rounded.abs() * f32::EPSILON + f32::MIN_POSITIVE)
}
