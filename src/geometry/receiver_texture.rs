//! The box into which a light's frustum over a parallelogram is mapped, for shadows drawn into a texture of the
//! receiver (Heckbert and Herf 1997, "Simulating Soft Shadows with Graphics Hardware").
//!
//! x and y run from 0 to 1 along the parallelogram's edges, whatever the distance to the light; z is 1 on the receiver,
//! more between receiver and light, less behind it. Clipping at z ≥ 1 leaves neither what is beyond the light nor what
//! is behind the receiver.

use super::planar::Receiver;
use glam::{DMat4, DVec3, DVec4};

/// Depth of the clip box towards the light, so small that only what touches the light is clipped.
const CLIP_DEPTH: f64 = 1e-6;
/// How far the fourth corner of a parallelogram may be off, relative to the edges.
const PARALLEL: f64 = 1e-9;

/// A parallelogram around a flat receiver, world space: the area that its texture covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReceiverParallelogram {
    /// The corner at the texture's origin.
    pub corner: DVec3,
    /// The edge from that corner in the direction of the texture's x.
    pub ex: DVec3,
    /// The edge from that corner in the direction of the texture's y.
    pub ey: DVec3,
}

impl ReceiverParallelogram {
    /// Returns the receiver itself where it has four vertices that form a parallelogram, else the smallest rectangle
    /// around it that is parallel to one of its triangles' edges.
    pub fn around(receiver: &Receiver, world: &[DVec3], triangles: &[[u32; 3]]) -> ReceiverParallelogram {
        let members = || receiver.triangles.iter().map(|triangle| triangles[*triangle as usize]);
        let mut vertices: Vec<u32> = members().flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let points: Vec<DVec3> = vertices.iter().map(|vertex| world[*vertex as usize]).collect();
        let whole = match points[..] {
            [a, b, c, d] => [[a, b, c, d], [a, b, d, c], [a, c, d, b]].into_iter().find_map(parallelogram),
            _ => None,
        };
        whole.unwrap_or_else(|| {
            let edges = members().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
            let directions = edges.map(|(from, to)| world[to as usize] - world[from as usize]);
            let rectangles = directions.filter_map(|edge| rectangle(&points, edge, receiver.plane.normal));
            let smallest = rectangles.min_by(|a, b| a.area().total_cmp(&b.area()));
            smallest.unwrap_or(ReceiverParallelogram { corner: points[0], ex: DVec3::X, ey: DVec3::Y })
        })
    }

    fn area(&self) -> f64 {
        self.ex.cross(self.ey).length()
    }

    /// Returns the matrix from world space to the box: x and y from 0 to 1 across the parallelogram, z 1 on it and more
    /// towards the homogeneous light. `None` where the light lies in its plane.
    pub fn box_from_world(&self, light: DVec4) -> Option<DMat4> {
        let ReceiverParallelogram { corner: b, ex, ey } = *self;
        // From the light to the corner; for a directional light against its direction.
        let ew = b * light.w - light.truncate();
        let across_x = ew.cross(ey);
        let across_y = ex.cross(ew);
        let normal = ey.cross(ex);
        let (ax, ay, aw) = (1.0 / across_x.dot(ex), 1.0 / across_y.dot(ey), 1.0 / normal.dot(ew));
        let x = (across_x * ax).extend(-ax * across_x.dot(b));
        let y = (across_y * ay).extend(-ay * across_y.dot(b));
        let distance = (normal * aw).extend(-aw * normal.dot(light.truncate()));
        let one = DVec4::W;
        let (z, w) = match light.w == 0.0 {
            // No distance to divide by: z grows with the height over the receiver.
            true => ((normal * -aw).extend(1.0 + aw * normal.dot(b)), one),
            false => (one, distance),
        };
        let is_usable = [x, y, z, w].iter().all(|row| row.is_finite());
        is_usable.then(|| DMat4::from_cols(x, y, z, w).transpose())
    }

    /// Returns clip space from world space for drawing casters into the texture: clipping leaves what lies between
    /// receiver and light. x runs along `ex`, and `ey` runs downwards. `None` where the light lies in the plane.
    pub fn clip_from_world(&self, light: DVec4) -> Option<DMat4> {
        let clip_from_box = DMat4::from_cols(
            DVec4::new(2.0, 0.0, 0.0, 0.0),
            DVec4::new(0.0, -2.0, 0.0, 0.0),
            DVec4::new(0.0, 0.0, CLIP_DEPTH, 0.0),
            DVec4::new(-1.0, 1.0, -CLIP_DEPTH, 1.0),
        );
        self.box_from_world(light).map(|box_from_world| clip_from_box * box_from_world)
    }
}

/// Makes a parallelogram of a corner, its two neighbours and the opposite corner; `None` where they do not form one.
fn parallelogram([corner, a, b, opposite]: [DVec3; 4]) -> Option<ReceiverParallelogram> {
    let (ex, ey) = (a - corner, b - corner);
    let is_closed = (corner + ex + ey - opposite).length() <= PARALLEL * (ex.length() + ey.length());
    is_closed.then_some(ReceiverParallelogram { corner, ex, ey })
}

/// Returns the smallest rectangle around points of a plane that is parallel to `along`; `None` where that has no
/// length.
fn rectangle(points: &[DVec3], along: DVec3, normal: DVec3) -> Option<ReceiverParallelogram> {
    let u = along.try_normalize()?;
    let v = normal.cross(u).try_normalize()?;
    let first = *points.first()?;
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in points {
        for (axis, value) in [u, v].into_iter().map(|axis| axis.dot(*point - first)).enumerate() {
            (low[axis], high[axis]) = (low[axis].min(value), high[axis].max(value));
        }
    }
    let corner = first + u * low[0] + v * low[1];
    Some(ReceiverParallelogram { corner, ex: u * (high[0] - low[0]), ey: v * (high[1] - low[1]) })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLANTED: ReceiverParallelogram = ReceiverParallelogram {
        corner: DVec3::new(1.0, 0.5, -2.0),
        ex: DVec3::new(2.0, 0.25, 0.0),
        ey: DVec3::new(0.5, -0.25, 3.0),
    };

    fn mapped(matrix: DMat4, point: DVec3) -> (DVec3, f64) {
        let mapped = matrix * point.extend(1.0);
        (mapped.truncate() / mapped.w, mapped.w)
    }

    /// Points on lines through the light share x and y; z says where they are on it.
    #[test]
    fn the_lights_frustum_becomes_a_box() {
        for light in [DVec4::new(1.0, 6.0, 2.0, 1.0), DVec4::new(0.4, 2.0, -0.3, 0.0)] {
            let matrix = SLANTED.box_from_world(light).expect("a light above");
            for (s, t) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.3, 0.8)] {
                let on_receiver = SLANTED.corner + SLANTED.ex * s + SLANTED.ey * t;
                let to_light = if light.w == 0.0 { light.truncate() } else { light.truncate() - on_receiver };
                for along in [-0.5, 0.0, 0.25, 0.9, 1.5] {
                    let (place, w) = mapped(matrix, on_receiver + to_light * along);
                    if light.w == 0.0 || along < 1.0 {
                        assert!((place.x - s).abs() < 1e-12 && (place.y - t).abs() < 1e-12, "{place} for {s} {t}");
                        assert!((place.z - 1.0).abs() < 1e-12 || (place.z > 1.0) == (along > 0.0), "{place} {along}");
                    }
                    assert_eq!(w > 0.0, light.w == 0.0 || along < 1.0, "beyond the light w is negative");
                }
            }
        }
    }

    #[test]
    fn clip_space_keeps_what_is_between_receiver_and_light() {
        let light = DVec4::new(1.0, 6.0, 2.0, 1.0);
        let matrix = SLANTED.clip_from_world(light).expect("a light above");
        let on_receiver = SLANTED.corner + SLANTED.ex * 0.25 + SLANTED.ey * 0.75;
        for along in [-0.5, -1e-6, 1e-6, 0.5, 0.99, 1.1] {
            let clip = matrix * on_receiver.lerp(light.truncate(), along).extend(1.0);
            let is_inside = clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w;
            assert_eq!(is_inside, (0.0..1.0).contains(&along), "{along}: {clip}");
            if is_inside {
                assert!((clip.truncate().truncate() / clip.w - glam::DVec2::new(-0.5, -0.5)).length() < 1e-9);
            }
        }
    }

    #[test]
    fn a_light_in_the_plane_maps_nothing() {
        assert_eq!(SLANTED.box_from_world((SLANTED.corner + SLANTED.ex * 3.0).extend(1.0)), None);
        assert_eq!(SLANTED.box_from_world((SLANTED.ex).extend(0.0)), None);
    }
}
