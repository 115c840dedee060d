//! How many casting triangles a light's ray can meet at most: eight bits hold 255.
//!
//! All directions from a light are divided into cells until none is met by more than the limit, or one
//! that is small still is. A cell is the cone between four planes through the light. A triangle that one
//! of them has outside is not in it, nor is one that has the whole cell beyond the plane through the light
//! and one of its edges; all others are taken to be in it. So the answer errs to the safe side.

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
        let faces = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        return faces.into_iter().any(|ahead| {
            let side = DVec3::new(ahead.y.abs(), ahead.z.abs(), ahead.x.abs());
            let axes = [side, ahead.cross(side), ahead];
            let along = |corner: DVec3| DVec3::from_array(axes.map(|axis| axis.dot(corner - light)));
            let cell = Cell { low: [-1.0; 2], high: [1.0; 2] };
            let relative = triangles.iter().map(|corners| corners.map(along));
            let inner: Vec<_> = relative.filter(|corners| cell.may_hold(corners)).collect();
            cell.exceeds(&inner, limit, MOST_HALVINGS)
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

/// What rounding may make of a sine of 0: some hundred times more than it does.
const FLAT: f64 = 1e-13;

/// Directions (x, y, 1) with x and y in a range.
#[derive(Clone, Copy)]
struct Cell {
    low: [f64; 2],
    high: [f64; 2],
}

impl Cell {
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
