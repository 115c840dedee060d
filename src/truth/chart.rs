//! Charts: where the lines through a pencil's centre lie in two dimensions, and how far along.
//!
//! All lines of sight meet in the eye, and all lines of light in the light. Seen from there a
//! line is a point and a triangle a patch, so that "which triangles may this line meet" is a
//! question about boxes in the plane. A point's surroundings are charted on the six faces of a
//! cube, laid out side by side; what a point sees from afar, through a window that fits it; a
//! direction's, on one plane across it. The third coordinate grows with the distance from the
//! centre.
//!
//! Boxes are `f32`, rounded outwards: a box may be too large, never too small.

use glam::{DVec2, DVec3, Vec3A};
use obvhs::aabb::Aabb;

/// From farther than this many times its radius, a scene is seen through a window.
const FAR: f64 = 4.0;
/// A line that leaves the window's axis by more than the angle with this cosine misses the scene,
/// which lies within asin(1 / [`FAR`]) of it.
const WINDOW_COSINE: f64 = 0.5;
/// Room between the faces' charts, each of which spans −1 to 1.
const FACE_SPACING: f64 = 4.0;
/// More than what rounding moves a charted point by, as long as its triangle keeps
/// [`NEAREST`] away from the centre.
const PADDING: f64 = 1e-7;
/// A triangle whose plane is nearer to the centre than this part of its size may lie anywhere.
const NEAREST: f64 = 1e-7;
/// Faces reach this far over their borders: a line on a border is found on either face.
const OVERLAP: f64 = 1e-5;

/// Where a triangle or a bundle of lines is seen: a box for each face that it is on.
pub type Boxes = [Option<Aabb>; 6];

/// A chart of the lines through a centre.
#[derive(Debug, Clone, Copy)]
pub enum Chart {
    /// Around a point. `middle`: the distance that becomes depth ½.
    Cube { middle: f64 },
    /// From a point far off: two unit vectors across the axis, and the unit axis towards the
    /// scene's middle, which is `distance` away; it reaches as far as `reach` around that.
    Window { across: [DVec3; 2], axis: DVec3, distance: f64, reach: f64 },
    /// Across a direction towards the centre: two unit vectors and the direction; coordinates
    /// are divided by `reach`.
    Plane { across: [DVec3; 2], towards: DVec3, reach: f64 },
}

impl Chart {
    /// For lines through a point that see what lies within `reach` of `middle` (relative to it).
    pub fn around_point(middle: DVec3, reach: f64) -> Chart {
        let distance = middle.length();
        if distance > FAR * reach {
            let axis = middle / distance;
            let u = axis.any_orthonormal_vector();
            return Chart::Window { across: [u, axis.cross(u)], axis, distance, reach };
        }
        Chart::Cube { middle: distance.max(reach) }
    }

    /// For parallel lines towards a light, of points within `reach` of their origin.
    pub fn across(towards: DVec3, reach: f64) -> Chart {
        let towards = towards.normalize();
        let u = towards.any_orthonormal_vector();
        Chart::Plane { across: [u, towards.cross(u)], towards, reach }
    }

    /// Where a triangle is seen. Corners are relative to the pencil's origin; `distance` is its
    /// plane's from there, not zero.
    pub fn triangle(&self, corners: [DVec3; 3], distance: f64) -> Boxes {
        let mut boxes = Boxes::default();
        match self {
            Chart::Plane { .. } | Chart::Window { .. } => boxes[0] = Some(self.on_sheet(corners.into_iter())),
            Chart::Cube { .. } => {
                let [face, b, c] = corners.map(face_of);
                let size = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
                if face == b && face == c {
                    boxes[0] = Some(bounds(corners.map(|corner| self.on_face(face, corner)), face));
                } else if distance < NEAREST * size {
                    boxes = std::array::from_fn(|face| Some(whole_face(face)));
                } else {
                    boxes = std::array::from_fn(|face| self.clipped(face, corners));
                }
            }
        }
        boxes
    }

    /// Where a bundle of lines is seen, from the centre up to the points given (relative to the
    /// pencil's origin); `endless`: beyond them too.
    pub fn bundle(&self, points: impl Iterator<Item = DVec3> + Clone, endless: bool) -> Boxes {
        let open = |mut area: Aabb| {
            area.min.z = f32::NEG_INFINITY;
            if endless {
                area.max.z = f32::INFINITY;
            }
            area
        };
        let mut boxes = Boxes::default();
        match self {
            Chart::Plane { .. } => boxes[0] = Some(open(self.on_sheet(points))),
            Chart::Window { axis, .. } => {
                let may_meet = |point: &DVec3| point.dot(*axis) > WINDOW_COSINE * point.length();
                let is_any = points.clone().any(|point| may_meet(&point));
                boxes[0] = is_any.then(|| open(self.on_sheet(points.filter(may_meet))));
            }
            Chart::Cube { .. } => {
                let on = |face: usize| {
                    let here = points.clone().filter(move |point| face_of(*point) == face);
                    Some(open(bounds(here.map(|point| self.on_face(face, point)), face)))
                };
                let faces = points.clone().fold(0, |faces, point| faces | 1u8 << face_of(point));
                let is_touched = |face: &usize| faces >> face & 1 == 1;
                (0..6).filter(is_touched).for_each(|face| boxes[face] = on(face));
            }
        }
        boxes
    }

    /// Any point of the same line, near the chart: bundles are narrow there.
    pub fn on_chart(&self, point: DVec3) -> DVec3 {
        match self {
            Chart::Cube { .. } | Chart::Window { .. } => point / point.abs().max_element(),
            Chart::Plane { towards, .. } => point - *towards * point.dot(*towards),
        }
    }

    /// The box of points on a chart that is one sheet.
    fn on_sheet(&self, points: impl Iterator<Item = DVec3>) -> Aabb {
        match self {
            Chart::Cube { .. } => whole_face(0),
            Chart::Plane { across: [u, v], towards, reach } => {
                let place = |point: DVec3| DVec3::new(point.dot(*u), point.dot(*v), -point.dot(*towards)) / *reach;
                padded_bounds(points.map(place), 0, PADDING)
            }
            Chart::Window { across: [u, v], axis, distance, reach } => {
                let place = |point: DVec3| {
                    let along = point.dot(*axis);
                    let [x, y] = [u, v].map(|side| point.dot(*side) / along * (distance / reach));
                    DVec3::new(x, y, (along - distance) / reach)
                };
                // Points are rounded at their distance from the centre, and charted at the scene's size.
                padded_bounds(points.map(place), 0, PADDING + 64.0 * f64::EPSILON * distance / reach)
            }
        }
    }

    /// A point on a face's chart, with its depth.
    fn on_face(&self, face: usize, point: DVec3) -> DVec3 {
        self.projected(along_face(face, point))
    }

    /// From a face's own coordinates, the third along its axis.
    fn projected(&self, point: DVec3) -> DVec3 {
        let Chart::Cube { middle } = self else { return point };
        let place: DVec2 = point.truncate() / point.z;
        place.extend(point.z / (point.z + middle))
    }

    /// The part of a triangle within a face's pyramid (Sutherland and Hodgman 1974).
    fn clipped(&self, face: usize, corners: [DVec3; 3]) -> Option<Aabb> {
        let mut polygon: Vec<DVec3> = corners.iter().map(|corner| along_face(face, *corner)).collect();
        for side in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y] {
            let inwards = side + DVec3::Z * (1.0 + OVERLAP);
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (index, from) in polygon.iter().enumerate() {
                let to = polygon[(index + 1) % polygon.len()];
                let (inside, inside_next) = (inwards.dot(*from), inwards.dot(to));
                if inside >= 0.0 {
                    kept.push(*from);
                }
                if (inside >= 0.0) != (inside_next >= 0.0) {
                    kept.push(*from + (to - *from) * (inside / (inside - inside_next)));
                }
            }
            polygon = kept;
        }
        let is_on_face = !polygon.is_empty();
        is_on_face.then(|| bounds(polygon.into_iter().map(|point| self.projected(point)), face))
    }
}

fn bounds(charted: impl IntoIterator<Item = DVec3>, face: usize) -> Aabb {
    padded_bounds(charted, face, PADDING)
}

/// The box around charted points, at the place of their face.
fn padded_bounds(charted: impl IntoIterator<Item = DVec3>, face: usize, padding: f64) -> Aabb {
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = charted.into_iter().fold(empty, |(low, high), place| (low.min(place), high.max(place)));
    let shift = DVec3::new(face as f64 * FACE_SPACING, 0.0, 0.0);
    let (low, high) = (low + shift - padding, high + shift + padding);
    Aabb::new(
        Vec3A::new(below(low.x), below(low.y), below(low.z)),
        Vec3A::new(above(high.x), above(high.y), above(high.z)),
    )
}

/// The face that a direction points to: twice its largest axis, one more where it is negative.
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

/// A point in a face's own coordinates: two across the face, the third along its axis.
fn along_face(face: usize, point: DVec3) -> DVec3 {
    let axis = face / 2;
    let along = if face % 2 == 1 { -point[axis] } else { point[axis] };
    DVec3::new(point[(axis + 1) % 3], point[(axis + 2) % 3], along)
}

fn whole_face(face: usize) -> Aabb {
    let center = face as f32 * FACE_SPACING as f32;
    Aabb::new(Vec3A::new(center - 1.5, -1.5, 0.0), Vec3A::new(center + 1.5, 1.5, 1.0))
}

/// The nearest `f32` not above a number.
fn below(value: f64) -> f32 {
    let rounded = value as f32;
    if f64::from(rounded) > value { rounded.next_down() } else { rounded }
}

/// The nearest `f32` not below a number.
fn above(value: f64) -> f32 {
    -below(-value)
}
