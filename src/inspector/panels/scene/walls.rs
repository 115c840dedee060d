//! Walls: the planes of what holds everything, which all else is behind or before.
//!
//! A painter who goes by distances cuts a teeth-like border where a long face runs through a wall. So
//! faces are split where they cross the plane of a wall, and what is behind a wall is painted before
//! it, whatever the distances (Fuchs, Kedem and Naylor 1980, for a few planes). From its other side a
//! wall is glass: it hides nothing.

use crate::anatomy::{Anatomy, PlacedObject};
use glam::{DVec3, DVec4};

/// Planes that are split by at most.
const MOST_PLANES: usize = 8;
/// An object of more triangles is no wall.
const MOST_TRIANGLES: usize = 12;
/// What is so near to a plane lies in it, in parts of what there is to see.
const IN_PLANE: f64 = 1e-4;

/// On which sides of the walls' planes something lies, a bit a plane: neither where it lies in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sides {
    /// Where its normal goes.
    pub over: u8,
    /// On the other side.
    pub under: u8,
}

impl Sides {
    /// Is it on any of these sides?
    #[must_use]
    pub fn meets(self, other: Sides) -> bool {
        (self.over & other.over) | (self.under & other.under) != 0
    }
}

/// The planes of all walls.
#[derive(Debug, Clone, Default)]
pub struct Walls {
    /// Of unit normals, and whether the camera is where they go.
    planes: Vec<(DVec4, bool)>,
    is_wall: Vec<bool>,
    /// Metres.
    near: f64,
}

impl Walls {
    /// Those of the `holders` that have few planes.
    #[must_use]
    pub fn new(anatomy: &Anatomy, holders: &[bool], middle: DVec3, radius: f64) -> Walls {
        let near = IN_PLANE * radius.max((anatomy.camera.eye - middle).length());
        let mut walls = Walls { planes: Vec::new(), is_wall: vec![false; anatomy.objects.len()], near };
        for (index, object) in anatomy.objects.iter().enumerate() {
            let is_small = object.mesh.triangles().len() <= MOST_TRIANGLES;
            if !(holders[index] && object.visible && is_small) {
                continue;
            }
            let before = walls.planes.len();
            for plane in planes(object) {
                let is_known =
                    |(known, _): &(DVec4, bool)| (*known - plane).length() < near || (*known + plane).length() < near;
                if !walls.planes.iter().any(is_known) {
                    walls.planes.push((plane, distance(plane, anatomy.camera.eye) >= 0.0));
                }
            }
            walls.is_wall[index] = walls.planes.len() <= MOST_PLANES;
            if !walls.is_wall[index] {
                walls.planes.truncate(before);
            }
        }
        walls
    }

    /// Is the object of this index a wall?
    #[must_use]
    pub fn is_wall(&self, object: usize) -> bool {
        self.is_wall.get(object).is_some_and(|is_wall| *is_wall)
    }

    /// Where a point of the world lies.
    #[must_use]
    pub fn sides(&self, place: DVec3) -> Sides {
        let mut sides = Sides::default();
        for (bit, (plane, _)) in self.planes.iter().enumerate() {
            let distance = distance(*plane, place);
            sides.over |= u8::from(distance > self.near) << bit;
            sides.under |= u8::from(distance < -self.near) << bit;
        }
        sides
    }

    /// The sides that are hidden from a viewer: a point of the world, or a direction where `w = 0`.
    #[must_use]
    pub fn hidden(&self, viewer: DVec4) -> Sides {
        let mut sides = Sides::default();
        for (bit, (plane, camera_is_over)) in self.planes.iter().enumerate() {
            let is_over = plane.dot(viewer) >= 0.0;
            if is_over == *camera_is_over {
                let side = if is_over { &mut sides.under } else { &mut sides.over };
                *side |= 1 << bit;
            }
        }
        sides
    }

    /// Does a triangle cross any plane?
    #[must_use]
    pub fn cut(&self, corners: &[DVec3; 3]) -> bool {
        self.planes.iter().any(|(plane, _)| self.crosses(*plane, corners))
    }

    fn crosses(&self, plane: DVec4, corners: &[DVec3; 3]) -> bool {
        let distances = corners.map(|corner| distance(plane, corner));
        distances.iter().any(|one| *one > self.near) && distances.iter().any(|one| *one < -self.near)
    }

    /// The pieces of a triangle, each on one side of every plane, as long as there is room for more.
    #[must_use]
    pub fn split(&self, corners: [DVec3; 3], room: &mut usize) -> Vec<[DVec3; 3]> {
        let mut pieces = vec![corners];
        for (plane, _) in &self.planes {
            for index in 0..pieces.len() {
                let piece = pieces[index];
                if *room >= 2 && self.crosses(*plane, &piece) {
                    let [over, under] = [half(&piece, *plane), half(&piece, -*plane)];
                    let mut parts = over.into_iter().chain(under);
                    if let Some(first) = parts.next() {
                        pieces[index] = first;
                    }
                    let before = pieces.len();
                    pieces.extend(parts);
                    *room = room.saturating_sub(pieces.len() - before);
                }
            }
        }
        pieces
    }
}

fn distance(plane: DVec4, place: DVec3) -> f64 {
    plane.dot(place.extend(1.0))
}

fn planes(object: &PlacedObject) -> impl Iterator<Item = DVec4> {
    object.mesh.triangles().iter().filter_map(|corners| {
        let [a, b, c] = corners.map(|corner| object.positions[corner as usize]);
        let normal = (b - a).cross(c - a).try_normalize()?;
        Some(normal.extend(-normal.dot(a)))
    })
}

/// What of a triangle is where a plane is positive: up to two triangles.
fn half(corners: &[DVec3; 3], plane: DVec4) -> Vec<[DVec3; 3]> {
    let mut kept: Vec<DVec3> = Vec::with_capacity(4);
    for (index, &corner) in corners.iter().enumerate() {
        let next = corners[(index + 1) % 3];
        let [here, there] = [distance(plane, corner), distance(plane, next)];
        if here >= 0.0 {
            kept.push(corner);
        }
        if (here < 0.0) != (there < 0.0) {
            kept.push(corner.lerp(next, here / (here - there)));
        }
    }
    (2..kept.len()).map(|last| [kept[0], kept[last - 1], kept[last]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The floor, seen from above, and a wall at x = 4, seen from the left.
    fn walls() -> Walls {
        let planes = vec![(DVec4::new(0.0, 1.0, 0.0, 0.0), true), (DVec4::new(1.0, 0.0, 0.0, -4.0), false)];
        Walls { planes, is_wall: vec![true], near: 1e-4 }
    }

    #[test]
    fn pieces_are_on_one_side_of_every_wall_and_cover_the_triangle() {
        let corners = [DVec3::new(-2.0, -3.0, 0.0), DVec3::new(9.0, -1.0, 1.0), DVec3::new(3.0, 6.0, 2.0)];
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
        let walls = walls();
        assert!(walls.cut(&corners));
        let pieces = walls.split(corners, &mut 100);
        assert!(pieces.len() > 3 && pieces.iter().all(|piece| !walls.cut(piece)), "{pieces:?}");
        let covered: f64 = pieces.iter().copied().map(area).sum();
        assert!((covered - area(corners)).abs() < 1e-9, "{covered}");
        assert_eq!(walls.split(corners, &mut 1), [corners], "there is no room");
    }

    #[test]
    fn a_wall_hides_what_is_behind_it_from_the_camera_s_side_only() {
        let walls = walls();
        let above = walls.hidden(DVec4::new(0.0, 5.0, 0.0, 1.0));
        let [cellar, outside] = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(6.0, 1.0, 0.0)].map(|at| walls.sides(at));
        let [inside, ground] = [DVec3::new(0.0, 1.0, 0.0), DVec3::ZERO].map(|at| walls.sides(at));
        assert!(cellar.meets(above) && outside.meets(above));
        assert!(!inside.meets(above) && !ground.meets(above));
        // A direction from below and from the right: both walls are glass.
        let below = walls.hidden(DVec4::new(1.0, -1.0, 0.0, 0.0));
        assert!([cellar, outside, inside, ground].iter().all(|sides| !sides.meets(below)));
    }
}
