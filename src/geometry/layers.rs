//! How many casting triangles a light's ray can meet at most: eight bits hold 255.
//!
//! All directions from a light are divided into cells until none is met by more than the limit, or one
//! that is small still is. A cell is the cone between four planes through the light. A triangle that one
//! of them has outside is not in it, nor is one that has the whole cell beyond the plane through the light
//! and one of its edges; all others are taken to be in it. So the answer errs to the safe side.
//!
//! Around a lamp, many small cells (boxes) are counted first, with one look at each triangle: that settles most meshes, and
//! only full boxes are divided.

use crate::math::AxisBox;
use glam::{DVec3, DVec4};

/// How often a cell is halved each way.
const MOST_HALVINGS: u32 = 12;

/// Can a ray of the light meet more than `limit` of these triangles, world space?
#[must_use]
pub fn may_exceed(triangles: &[[DVec3; 3]], light: DVec4, limit: usize) -> bool {
    if triangles.len() <= limit {
        return false;
    }
    if light.w != 0.0 {
        let light = light.truncate() / light.w;
        if let Some(exceeds) = exceeds_in_boxes(triangles, light, limit) {
            return exceeds;
        }
        let faces = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        return faces.into_iter().any(|ahead| {
            let side = DVec3::new(ahead.y.abs(), ahead.z.abs(), ahead.x.abs());
            let axes = [side, ahead.cross(side), ahead];
            let along = |corner: DVec3| DVec3::from_array(axes.map(|axis| axis.dot(corner - light)));
            let relative = triangles.iter().map(|corners| corners.map(along));
            let inner: Vec<_> = relative.filter(|corners| Cell::FACE.may_hold(corners)).collect();
            Cell::FACE.exceeds(&inner, limit, MOST_HALVINGS)
        });
    }
    let towards = light.truncate().normalize_or_zero();
    let (right, up) = towards.any_orthonormal_pair();
    // At distance 1 from a light that is nowhere: the cone's planes are parallel.
    let flat = |corner: DVec3| DVec3::new(right.dot(corner), up.dot(corner), 1.0);
    let triangles: Vec<[DVec3; 3]> = triangles.iter().map(|corners| corners.map(flat)).collect();
    let AxisBox { low, high } = AxisBox::around(triangles.iter().flatten().copied());
    Cell { low: [low.x, low.y], high: [high.x, high.y] }.exceeds(&triangles, limit, MOST_HALVINGS)
}

/// Boxes along each side of a face of the cube around a light, at most.
const MOST_BOXES: usize = 1024;
/// Full boxes that are looked into one by one; of more, all directions are divided.
const MOST_FULL: usize = 256;
/// Triangles in them together that are always looked at, some 70 bytes each.
const MOST_IN_FULL: usize = 1 << 16;
/// More than rounding moves a place on a face by, in parts of its half.
const BESIDE: f64 = 1e-9;

/// A face of the cube around a light: its axis, and on which side.
#[derive(Debug, Clone, Copy)]
struct Face {
    axis: usize,
    side: f64,
}

impl Face {
    const ALL: [Face; 6] = [
        Face { axis: 0, side: 1.0 },
        Face { axis: 0, side: -1.0 },
        Face { axis: 1, side: 1.0 },
        Face { axis: 1, side: -1.0 },
        Face { axis: 2, side: 1.0 },
        Face { axis: 2, side: -1.0 },
    ];

    /// Across, across and ahead.
    fn seen(self, corner: DVec3) -> DVec3 {
        let [across, other] = [1, 2].map(|step| corner[(self.axis + step) % 3]);
        DVec3::new(across, other, corner[self.axis] * self.side)
    }

    /// Which of so many boxes along each side the box around a triangle touches: first and last along both; `None` where it
    /// is beyond the face. What reaches behind the light, or is no number, may be anywhere.
    fn touched(self, corners: &[DVec3; 3], boxes: usize) -> Option<[[usize; 2]; 2]> {
        let [a, b, c] = corners.map(|corner| self.seen(corner));
        if a.z.max(b.z).max(c.z) < 0.0 {
            return None;
        }
        let is_ahead = a.z.min(b.z).min(c.z) > 0.0;
        if !is_ahead && !Cell::FACE.may_hold(&[a, b, c]) {
            return None;
        }
        let along = |side: usize| {
            let [a, b, c] = [a, b, c].map(|corner| corner[side] / corner.z);
            let (low, high) = (a.min(b).min(c) - BESIDE, a.max(b).max(c) + BESIDE);
            let index = |place: f64| ((place + 1.0) / 2.0 * boxes as f64).clamp(0.0, boxes as f64 - 1.0) as usize;
            let misses = is_ahead && (low > 1.0 + BESIDE || high < -1.0 - BESIDE);
            let is_told = is_ahead && low <= high;
            (!misses).then(|| if is_told { [index(low), index(high)] } else { [0, boxes - 1] })
        };
        Some([along(0)?, along(1)?])
    }
}

/// Can a ray from `light` meet more than `limit`? Directions are divided into many boxes, in each of which the triangles
/// that may reach into it are counted, with one look at each triangle; only full boxes are divided further. `None` where
/// they are many.
fn exceeds_in_boxes(triangles: &[[DVec3; 3]], light: DVec3, limit: usize) -> Option<bool> {
    let boxes = (2.0 * (triangles.len() as f64).sqrt()).clamp(16.0, MOST_BOXES as f64) as usize;
    let width = boxes + 1;
    let relative = |corners: &[DVec3; 3]| corners.map(|corner| corner - light);
    // Of each face, how the number changes from box to box along rows and columns.
    let mut changes = vec![0_i32; Face::ALL.len() * width * width];
    for corners in triangles.iter().map(relative) {
        for (face, change) in Face::ALL.iter().zip(changes.chunks_exact_mut(width * width)) {
            let Some([[left, right], [top, bottom]]) = face.touched(&corners, boxes) else { continue };
            change[top * width + left] += 1;
            change[top * width + right + 1] -= 1;
            change[(bottom + 1) * width + left] -= 1;
            change[(bottom + 1) * width + right + 1] += 1;
        }
    }
    let mut full: Vec<(usize, [usize; 2], Vec<[DVec3; 3]>)> = Vec::new();
    let mut in_full = 0;
    for (face, changes) in changes.chunks_exact(width * width).enumerate() {
        let mut row = vec![0; width];
        for (y, changes) in changes.chunks_exact(width).enumerate() {
            let mut sum = 0;
            for (x, (count, change)) in row.iter_mut().zip(changes).enumerate() {
                sum += change;
                *count += sum;
                if *count as usize > limit {
                    in_full += *count as usize;
                    if full.len() >= MOST_FULL || in_full > MOST_IN_FULL.max(2 * triangles.len()) {
                        return None;
                    }
                    full.push((face, [x, y], Vec::new()));
                }
            }
        }
    }
    if full.is_empty() {
        return Some(false);
    }
    for corners in triangles.iter().map(relative) {
        let mut last = None;
        for (face, [x, y], inner) in &mut full {
            let touched = match last {
                Some((of, touched)) if of == *face => touched,
                _ => Face::ALL[*face].touched(&corners, boxes),
            };
            last = Some((*face, touched));
            if touched
                .is_some_and(|[[left, right], [top, bottom]]| (left..=right).contains(x) && (top..=bottom).contains(y))
            {
                inner.push(corners.map(|corner| Face::ALL[*face].seen(corner)));
            }
        }
    }
    let border = |index: usize| index as f64 / boxes as f64 * 2.0 - 1.0;
    Some(full.iter().any(|(_, [x, y], inner)| {
        let cell = Cell { low: [border(*x), border(*y)], high: [border(*x + 1), border(*y + 1)] };
        cell.exceeds(inner, limit, MOST_HALVINGS)
    }))
}

/// What rounding may make of a sine of 0: some hundred times more than it does.
const FLAT: f64 = 1e-13;

/// Directions (x, y, 1) with x and y in a range.
#[derive(Clone, Copy)]
struct Cell {
    low: [f64; 2],
    high: [f64; 2],
}

impl Cell {
    /// A face of the cube around a light.
    const FACE: Cell = Cell { low: [-1.0 - BESIDE; 2], high: [1.0 + BESIDE; 2] };

    fn exceeds(&self, triangles: &[[DVec3; 3]], limit: usize, halvings: u32) -> bool {
        if triangles.len() <= limit {
            return false;
        }
        if halvings == 0 {
            return true;
        }
        let middle = [0, 1].map(|axis| (self.low[axis] + self.high[axis]) / 2.0);
        let quarters = [(false, false), (true, false), (false, true), (true, true)].map(|(right, upper)| Cell {
            low: [if right { middle[0] } else { self.low[0] }, if upper { middle[1] } else { self.low[1] }],
            high: [if right { self.high[0] } else { middle[0] }, if upper { self.high[1] } else { middle[1] }],
        });
        quarters.iter().any(|quarter| {
            let mut inner: Vec<_> = triangles.iter().filter(|corners| quarter.may_hold(corners)).copied().collect();
            // Looking at edges takes longest, and is needed only where cells as such don't tell.
            if inner.len() > limit {
                inner.retain(|corners| !quarter.is_beyond_an_edge(corners));
            }
            quarter.exceeds(&inner, limit, halvings - 1)
        })
    }

    /// May a triangle reach into the cell, as far as the four planes around it tell?
    fn may_hold(&self, corners: &[DVec3; 3]) -> bool {
        let some = |inside: &dyn Fn(&DVec3) -> bool| corners.iter().any(inside);
        some(&|p| p.z >= 0.0)
            && some(&|p| p.x >= self.low[0] * p.z)
            && some(&|p| p.x <= self.high[0] * p.z)
            && some(&|p| p.y >= self.low[1] * p.z)
            && some(&|p| p.y <= self.high[1] * p.z)
    }

    /// Does a plane through the light and an edge of the triangle have the triangle on its one side, and
    /// all of the cell on the other?
    fn is_beyond_an_edge(&self, corners: &[DVec3; 3]) -> bool {
        let ([left, lower], [right, upper]) = (self.low, self.high);
        let cell = [[left, lower], [right, lower], [left, upper], [right, upper]].map(|[x, y]| DVec3::new(x, y, 1.0));
        (0..3).any(|first| {
            let [a, b, c] = [0, 1, 2].map(|step| corners[(first + step) % 3]);
            let normal = a.cross(b);
            // Of products of these lengths, rounding leaves less.
            let doubt = FLAT * a.length() * b.length();
            let side = normal.dot(c);
            let inwards = if side > doubt * c.length() { 1.0 } else { -1.0 };
            let is_sure = side.abs() > doubt * c.length();
            is_sure && cell.iter().all(|corner| inwards * normal.dot(*corner) < -doubt * corner.length())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shapes;

    fn stack(count: usize) -> Vec<[DVec3; 3]> {
        let pane = |height: f64| [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]].map(|[x, z]| DVec3::new(x, height, z));
        (0..count).map(|index| pane(index as f64 * 0.01)).collect()
    }

    #[test]
    fn a_stack_is_met_whole() {
        for light in [DVec4::new(0.1, 9.0, 0.1, 1.0), DVec4::new(0.1, 1.0, 0.1, 0.0)] {
            assert!(!may_exceed(&stack(255), light, 255));
            assert!(may_exceed(&stack(256), light, 255));
        }
        // From beside it, a ray meets a few.
        assert!(!may_exceed(&stack(256), DVec4::new(40.0, 1.1, 0.1, 1.0), 255));
    }

    /// Boards of two triangles each, of which a ray meets one: both only where it meets the diagonal.
    #[test]
    fn halves_of_a_board_count_as_one_layer_off_their_diagonal() {
        let board = |height: f64| {
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let [a, b, c, d] = corners.map(|[x, z]| DVec3::new(x, height, z));
            [[a, b, c], [a, c, d]]
        };
        let stack: Vec<_> = (0..200).flat_map(|index| board(f64::from(index) * 0.01)).collect();
        let beside = DVec4::new(0.3, 9.0, -0.1, 1.0);
        assert!(!may_exceed(&stack, beside, 255));
        assert!(may_exceed(&stack, beside, 199));
        // From the plane of all diagonals, a ray does meet both halves of each.
        assert!(may_exceed(&stack, DVec4::new(0.3, 9.0, 0.3, 1.0), 255));
    }

    /// Boxes never miss a triangle: beside, around and through a light, and where one spans faces.
    #[test]
    fn no_box_is_short_of_a_triangle() {
        let mut seed = 7u64;
        let mut number = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1 << 23) - 1.0
        };
        for _ in 0..200 {
            let mut point = || DVec3::new(number(), number(), number());
            let (light, tip) = (point(), point());
            let triangles: Vec<[DVec3; 3]> = (0..40).map(|_| [tip + point() * 0.4, tip + point() * 0.4, tip]).collect();
            // The ray to the common corner meets all of them.
            assert_eq!(exceeds_in_boxes(&triangles, light, 39), Some(true), "{light} {tip}");
            assert_eq!(exceeds_in_boxes(&triangles, light, 40), Some(false), "{light} {tip}");
            assert_ne!(exceeds_in_boxes(&triangles, tip, 39), Some(false), "{tip}");
        }
    }

    /// Around a pole, a hundred triangles meet in a point; a ray beside it meets few.
    #[test]
    fn a_full_box_is_divided() {
        let mesh = shapes::sphere(1.0, 400, 300).expect("a sphere");
        let corners = |t: &[u32; 3]| t.map(|vertex| mesh.positions()[vertex as usize]);
        let triangles: Vec<[DVec3; 3]> = mesh.triangles().iter().map(corners).collect();
        for light in [DVec3::new(0.1, 5.0, 1.0), DVec3::new(4.0, 0.3, 0.2)] {
            assert_eq!(exceeds_in_boxes(&triangles, light, 700), Some(false), "{light}");
            assert_eq!(exceeds_in_boxes(&triangles, light, 255), Some(true), "{light}: 400 at the pole");
        }
    }

    /// A torus of many triangles has four layers, wherever the light is.
    #[test]
    fn a_fine_mesh_has_few_layers() {
        let mesh = shapes::torus(1.0, 0.4, 60, 40).expect("a torus");
        let corners = |t: &[u32; 3]| t.map(|vertex| mesh.positions()[vertex as usize]);
        let triangles: Vec<[DVec3; 3]> = mesh.triangles().iter().map(corners).collect();
        for light in [[0.0, 5.0, 1.0, 1.0], [1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.3, 0.0]] {
            assert!(!may_exceed(&triangles, DVec4::from_array(light), 255), "{light:?}");
        }
    }
}
