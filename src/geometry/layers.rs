//! How many casting triangles a light's ray can meet at most: eight bits hold 255.
//!
//! All directions from a light are divided into cells until none is met by more than the limit, or one
//! that is small still is. A cell is the cone between four planes through the light; a triangle that
//! no plane has outside is taken to be in it. So the answer errs to the safe side.

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
        let relative = |axes: [DVec3; 3]| {
            let along = |corner: DVec3| DVec3::from_array(axes.map(|axis| axis.dot(corner - light)));
            triangles.iter().map(|corners| corners.map(along)).collect::<Vec<_>>()
        };
        let faces = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        return faces.into_iter().any(|ahead| {
            let side = DVec3::new(ahead.y.abs(), ahead.z.abs(), ahead.x.abs());
            let cell = Cell { low: [-1.0; 2], high: [1.0; 2] };
            cell.exceeds(&cell.of(&relative([side, ahead.cross(side), ahead])), limit, MOST_HALVINGS)
        });
    }
    let towards = light.truncate().normalize_or_zero();
    let (right, up) = towards.any_orthonormal_pair();
    // At distance 1 from a light that is nowhere: the cone's planes are parallel.
    let flat = |corner: DVec3| DVec3::new(right.dot(corner), up.dot(corner), 1.0);
    let triangles: Vec<[DVec3; 3]> = triangles.iter().map(|corners| corners.map(flat)).collect();
    let low = triangles.iter().flatten().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = triangles.iter().flatten().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    Cell { low: [low.x, low.y], high: [high.x, high.y] }.exceeds(&triangles, limit, MOST_HALVINGS)
}

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
        quarters.iter().any(|quarter| quarter.exceeds(&quarter.of(triangles), limit, halvings - 1))
    }

    /// Those that none of the cell's planes has outside.
    fn of(&self, triangles: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
        let is_in = |corners: &&[DVec3; 3]| {
            let some = |inside: &dyn Fn(&DVec3) -> bool| corners.iter().any(inside);
            some(&|p| p.z >= 0.0)
                && some(&|p| p.x >= self.low[0] * p.z)
                && some(&|p| p.x <= self.high[0] * p.z)
                && some(&|p| p.y >= self.low[1] * p.z)
                && some(&|p| p.y <= self.high[1] * p.z)
        };
        triangles.iter().filter(is_in).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::shapes;

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
