//! How many casting triangles a light's ray can hit at most: eight bits count to 255.
//!
//! All directions from a light are divided into cells until no ray in one hits more than the limit, or a small one
//! still may. A cell is the cone between four planes through the light. A triangle that one of them has outside is not
//! in it, nor is one that has the whole cell beyond the plane through the light and one of its edges; all others are
//! taken to be in it. So the answer errs to the safe side.
//!
//! What all triangles cover is first counted in many small cells (boxes), with one look at each triangle: that settles
//! most meshes, and only full boxes are divided. A quarter as many boxes are counted before, since most often none of
//! these is full either.

use crate::math::AxisBox;
use glam::{DVec3, DVec4};
use rayon::prelude::*;
use std::sync::atomic::{AtomicI32, Ordering};

/// How often a cell of directions is divided into quarters at most.
const MOST_HALVINGS: u32 = 12;

/// Returns whether a ray of the light may hit more than `limit` of the triangles of some meshes, of each its vertices
/// (world space) and the triangles' corners. Conservative: true where that can't be ruled out, or where a corner is not
/// finite.
pub fn may_exceed<'a>(
    meshes: impl IntoIterator<Item = (&'a [DVec3], Vec<[u32; 3]>)>,
    light: DVec4,
    limit: usize,
) -> bool {
    let mut all = RelativeTriangles::of(meshes, light);
    if all.triangles.len() <= limit {
        return false;
    }
    let triangles = all.triangles.par_iter().with_min_len(SHARE);
    if !triangles.all(|corners| all.corners(corners).iter().all(|corner| corner.is_finite())) {
        return true;
    }
    all.look_around(light);
    // Each of these boxes holds four of the others: where none is full, none of those is.
    if all.full_boxes(&all.grids(light, 2), limit, 0).is_some() {
        return false;
    }
    let grids = all.grids(light, 1);
    all.exceeds_in_boxes(&grids, limit).unwrap_or_else(|| {
        grids.iter().any(|grid| {
            let seen = SeenTriangles { face: grid.face, all: &all };
            let indices = (0..all.triangles.len() as u32).into_par_iter().with_min_len(SHARE);
            let inner: Vec<u32> = indices.filter(|index| grid.cell.may_hold(&seen.corners(*index))).collect();
            grid.cell.exceeds(seen, &inner, limit, MOST_HALVINGS)
        })
    })
}

/// Triangles as a light sees them.
struct RelativeTriangles {
    /// Relative to a point light. For a directional light their coordinates across its direction with z = 1, so that all of
    /// its rays are (x, y, 1).
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// For each position, the planes around the faces that it is surely outside of ([`CubeFace::outside`]); empty where
    /// that was not asked for.
    outside: Vec<u32>,
}

impl RelativeTriangles {
    fn of<'a>(meshes: impl IntoIterator<Item = (&'a [DVec3], Vec<[u32; 3]>)>, light: DVec4) -> RelativeTriangles {
        let (right, up) = light.truncate().normalize_or_zero().any_orthonormal_pair();
        let seen = |place: &DVec3| match light.w == 0.0 {
            true => DVec3::new(right.dot(*place), up.dot(*place), 1.0),
            false => *place - light.truncate() / light.w,
        };
        let mut all = RelativeTriangles { positions: Vec::new(), triangles: Vec::new(), outside: Vec::new() };
        for (positions, triangles) in meshes {
            let first = all.positions.len() as u32;
            all.positions.extend(positions.iter().map(seen));
            if first == 0 {
                all.triangles = triangles;
                continue;
            }
            all.triangles.extend(triangles.iter().map(|corners| corners.map(|vertex| first + vertex)));
        }
        all
    }

    /// Finds for each position which planes around the cube's faces it is outside of; of a directional light, whose rays
    /// all are before one face, for none.
    fn look_around(&mut self, light: DVec4) {
        if light.w != 0.0 {
            let positions = self.positions.par_iter().with_min_len(SHARE);
            self.outside = positions.map(CubeFace::outside).collect();
        }
    }

    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        triangle.map(|vertex| self.positions[vertex as usize])
    }

    /// Returns what [`CoverageGrid::touched`] does of a triangle. Most are surely before another face, and so much is
    /// known from their corners without a look at the grid.
    fn touched(&self, grid: &CoverageGrid, triangle: &[u32; 3]) -> Option<[[usize; 2]; 2]> {
        let outside = |vertex: u32| self.outside.get(vertex as usize).copied().unwrap_or(0);
        let of_all = triangle.iter().fold(grid.face.planes(), |of_all, vertex| of_all & outside(*vertex));
        if of_all != 0 { None } else { grid.touched(&self.corners(triangle)) }
    }

    /// Returns grids over the parts of the light's faces that the triangles may cover, of boxes that are so many times
    /// `as_wide` as the number of triangles asks for.
    fn grids(&self, light: DVec4, as_wide: u32) -> Vec<CoverageGrid> {
        let of_share = |share: &[[u32; 3]]| AxisBox::around(share.iter().flat_map(|corners| self.corners(corners)));
        let shares = self.triangles.par_chunks(SHARE).map(of_share);
        let around = shares.reduce(|| AxisBox::around([]), |one, other| one.joined(other));
        let (faces, whole): (&[CubeFace], _) = match light.w == 0.0 {
            true => (&[CubeFace::AHEAD], DirectionCell::PLANE),
            false => (&CubeFace::ALL, DirectionCell::FACE),
        };
        // Whole boxes: what is beyond the last one would be nobody's.
        let boxes = (BOXES_A_ROOT * (self.triangles.len() as f64).sqrt()).clamp(BOXES[0], BOXES[1]).floor();
        let grid = |face: &CubeFace| {
            let cell = whole.part_before(&face.seen(&around.corners()))?;
            Some(CoverageGrid::new(*face, cell, boxes / f64::from(as_wide)))
        };
        faces.iter().filter_map(grid).collect()
    }
}

/// Triangles as a face of the cube around the light sees them.
#[derive(Clone, Copy)]
struct SeenTriangles<'a> {
    face: CubeFace,
    all: &'a RelativeTriangles,
}

impl SeenTriangles<'_> {
    fn corners(&self, index: u32) -> [DVec3; 3] {
        self.face.seen(&self.all.corners(&self.all.triangles[index as usize]))
    }
}

/// How many triangles one thread looks at, at least.
const SHARE: usize = 16 * 1024;
/// How many boxes along each side of a face's grid there are for one triangle; with four times the triangles, twice as many.
const BOXES_A_ROOT: f64 = 2.0;
/// The fewest and the most of them.
const BOXES: [f64; 2] = [16.0, 4096.0];
/// The most full boxes that are examined one by one; with more, all directions are divided instead.
const MOST_FULL: usize = 256;
/// How many triangles in full boxes are examined in any case, four bytes each.
const MOST_IN_FULL: usize = 1 << 16;
/// An upper bound for the rounding error of a position on a face, relative to 1 or, beyond that, to the position.
const BESIDE: f64 = 1e-9;
/// Far more than that: what is beyond an end by so much is beyond it with any rounding.
const CLEAR: f64 = 1e-6;

/// Returns the range from `low` to `high` on a face, widened at both ends by the rounding error of such positions.
fn around(low: f64, high: f64) -> [f64; 2] {
    [low - BESIDE * low.abs().max(1.0), high + BESIDE * high.abs().max(1.0)]
}

/// A face of the cube around a light: its axis (0, 1, 2) and side (1 or −1).
#[derive(Debug, Clone, Copy)]
struct CubeFace {
    axis: usize,
    side: f64,
}

impl CubeFace {
    const AHEAD: CubeFace = CubeFace { axis: 2, side: 1.0 };
    const ALL: [CubeFace; 6] = [
        CubeFace { axis: 0, side: 1.0 },
        CubeFace { axis: 0, side: -1.0 },
        CubeFace { axis: 1, side: 1.0 },
        CubeFace { axis: 1, side: -1.0 },
        CubeFace::AHEAD,
        CubeFace { axis: 2, side: -1.0 },
    ];

    /// Returns a bit for each of the five planes around each face, in their order, that a position relative to the light is
    /// surely outside of: behind the light, or beyond one of the face's four edges as seen from there.
    fn outside(position: &DVec3) -> u32 {
        let mut outside = 0;
        for (index, face) in CubeFace::ALL.into_iter().enumerate() {
            let [DVec3 { x, y, z }] = face.seen(&[*position]);
            let edge = (DirectionCell::FACE.high[0] + CLEAR) * z;
            let beyond = [z < 0.0, x > edge, x < -edge, y > edge, y < -edge];
            let bits = beyond.into_iter().enumerate().fold(0, |bits, (plane, is)| bits | (u32::from(is) << plane));
            outside |= bits << (index * beyond.len());
        }
        outside
    }

    /// Returns the bits of this face's planes among those of all faces.
    fn planes(self) -> u32 {
        0b11111 << (5 * (2 * self.axis + usize::from(self.side < 0.0)))
    }

    /// Returns each corner's coordinates for this cube face: the two across it (in cyclic order of the axes), and the
    /// distance ahead, negative behind the light.
    fn seen<const N: usize>(self, corners: &[DVec3; N]) -> [DVec3; N] {
        corners.map(|corner| {
            let [across, other] = [1, 2].map(|step| corner[(self.axis + step) % 3]);
            DVec3::new(across, other, corner[self.axis] * self.side)
        })
    }
}

/// A grid of boxes over the part of a face that triangles may cover.
struct CoverageGrid {
    face: CubeFace,
    cell: DirectionCell,
    /// Along both sides, what is surely beyond the cell's ends, however it is rounded.
    beyond: [[f64; 2]; 2],
    boxes: usize,
    /// Boxes per unit along both sides.
    scale: [f64; 2],
}

impl CoverageGrid {
    fn new(face: CubeFace, cell: DirectionCell, boxes: f64) -> CoverageGrid {
        let scale = [0, 1].map(|axis| boxes / (cell.high[axis] - cell.low[axis]));
        let beyond = [0, 1].map(|axis| [cell.low[axis], cell.high[axis]].map(|end| CLEAR * end.abs().max(1.0)));
        let beyond = [0, 1].map(|axis| [cell.low[axis] - beyond[axis][0], cell.high[axis] + beyond[axis][1]]);
        CoverageGrid { face, cell, beyond, boxes: boxes as usize, scale }
    }

    /// Returns which boxes the bounding box of a triangle touches: first and last along both sides. `None` where it
    /// touches none; all boxes where the triangle reaches behind the light.
    fn touched(&self, corners: &[DVec3; 3]) -> Option<[[usize; 2]; 2]> {
        let [a, b, c] = self.face.seen(corners);
        if a.z.max(b.z).max(c.z) < 0.0 {
            return None;
        }
        if a.z.min(b.z).min(c.z) <= 0.0 {
            return self.cell.may_hold(&[a, b, c]).then_some([[0, self.boxes - 1]; 2]);
        }
        // Most triangles are before another face, and so much is known without a division.
        let is_beyond = |axis: usize| {
            let [low, high] = self.beyond[axis];
            let all = |is_past: &dyn Fn(&DVec3) -> bool| [a, b, c].iter().all(is_past);
            all(&|p| p[axis] > high * p.z) || all(&|p| p[axis] < low * p.z)
        };
        if is_beyond(0) || is_beyond(1) {
            return None;
        }
        let along = |axis: usize| {
            let [a, b, c] = [a, b, c].map(|corner| corner[axis] / corner.z);
            let [low, high] = around(a.min(b).min(c), a.max(b).max(c));
            let index = |place: f64| {
                ((place - self.cell.low[axis]) * self.scale[axis]).clamp(0.0, self.boxes as f64 - 1.0) as usize
            };
            let misses = low > self.cell.high[axis] || high < self.cell.low[axis];
            (!misses).then(|| [index(low), index(high)])
        };
        Some([along(0)?, along(1)?])
    }

    /// Returns the range of directions (position across over distance ahead) that the grid's box in this column and row
    /// covers.
    fn directions(&self, at: [usize; 2]) -> DirectionCell {
        let border = |axis: usize, index: usize| self.cell.low[axis] + index as f64 / self.scale[axis];
        let borders = |more: usize| [border(0, at[0] + more), border(1, at[1] + more)];
        DirectionCell { low: borders(0), high: borders(1) }
    }
}

/// A box that more triangles may reach into than the limit, with those triangles.
struct OverLimit<'a> {
    grid: &'a CoverageGrid,
    at: [usize; 2],
    inner: Vec<u32>,
}

impl RelativeTriangles {
    /// Returns the boxes that more than `limit` triangles reach into, without the triangles; `None` where these are more
    /// than `most`, or hold too many triangles.
    fn full_boxes<'a>(&self, grids: &'a [CoverageGrid], limit: usize, most: usize) -> Option<Vec<OverLimit<'a>>> {
        let mut full: Vec<OverLimit> = Vec::new();
        let mut in_full = 0;
        for grid in grids {
            let width = grid.boxes + 1;
            // How the number changes from box to box along rows and columns.
            let mut changes: Vec<AtomicI32> = (0..width * width).map(|_| AtomicI32::new(0)).collect();
            let triangles = self.triangles.par_iter().with_min_len(SHARE);
            triangles.filter_map(|corners| self.touched(grid, corners)).for_each(|[[left, right], [top, bottom]]| {
                let change = |x: usize, y: usize, by: i32| changes[y * width + x].fetch_add(by, Ordering::Relaxed);
                change(left, top, 1);
                change(right + 1, top, -1);
                change(left, bottom + 1, -1);
                change(right + 1, bottom + 1, 1);
            });
            let mut row = vec![0; width];
            for (y, changes) in changes.chunks_exact_mut(width).enumerate() {
                let mut sum = 0;
                for (x, (count, change)) in row.iter_mut().zip(changes).enumerate() {
                    sum += *change.get_mut();
                    *count += sum;
                    if *count as usize > limit {
                        in_full += *count as usize;
                        if full.len() >= most || in_full > MOST_IN_FULL.max(2 * self.triangles.len()) {
                            return None;
                        }
                        full.push(OverLimit { grid, at: [x, y], inner: Vec::new() });
                    }
                }
            }
        }
        Some(full)
    }

    /// Returns whether a ray may hit more than `limit` triangles: counts the triangles that reach into each box, and
    /// divides only full boxes further. `None` where full boxes are too many.
    fn exceeds_in_boxes(&self, grids: &[CoverageGrid], limit: usize) -> Option<bool> {
        let mut full = self.full_boxes(grids, limit, MOST_FULL)?;
        for of_grid in full.chunk_by_mut(|one, next| std::ptr::eq(one.grid, next.grid)) {
            let grid = of_grid[0].grid;
            for (index, corners) in (0..).zip(&self.triangles) {
                let Some([[left, right], [top, bottom]]) = self.touched(grid, corners) else { continue };
                for OverLimit { at: [x, y], inner, .. } in &mut *of_grid {
                    if (left..=right).contains(x) && (top..=bottom).contains(y) {
                        inner.push(index);
                    }
                }
            }
        }
        Some(full.iter().any(|full| {
            let seen = SeenTriangles { face: full.grid.face, all: self };
            full.grid.directions(full.at).exceeds(seen, &full.inner, limit, MOST_HALVINGS)
        }))
    }
}

/// The largest sine that rounding may make of 0, with a wide margin.
const FLAT: f64 = 1e-13;

/// A cell of directions (x, y, 1), with x and y between `low` and `high`.
#[derive(Clone, Copy)]
struct DirectionCell {
    low: [f64; 2],
    high: [f64; 2],
}

impl DirectionCell {
    /// The directions through a face of the cube around a light.
    const FACE: DirectionCell = DirectionCell { low: [-1.0 - BESIDE; 2], high: [1.0 + BESIDE; 2] };
    /// All directions with positive z.
    const PLANE: DirectionCell = DirectionCell { low: [f64::NEG_INFINITY; 2], high: [f64::INFINITY; 2] };

    /// Returns the part of this cell that a box with these corners can cover, as seen from the light. Where the box
    /// reaches behind the light, all of the cell if it may reach into it at all. `None` where it covers none.
    fn part_before(&self, corners: &[DVec3; 8]) -> Option<DirectionCell> {
        if corners.iter().any(|corner| corner.z <= 0.0) {
            return self.may_hold(corners).then_some(*self);
        }
        let along = |axis: usize| {
            let places = || corners.iter().map(|corner| corner[axis] / corner.z);
            let [low, high] =
                around(places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
            let (low, high) = (low.max(self.low[axis]), high.min(self.high[axis]));
            (low < high).then_some((low, high))
        };
        let ((left, right), (lower, upper)) = (along(0)?, along(1)?);
        Some(DirectionCell { low: [left, lower], high: [right, upper] })
    }

    /// Returns whether more than `limit` of the triangles with these indices may be met in one direction of the cell.
    fn exceeds(&self, seen: SeenTriangles, triangles: &[u32], limit: usize, halvings: u32) -> bool {
        if triangles.len() <= limit {
            return false;
        }
        if halvings == 0 {
            return true;
        }
        let middle = [0, 1].map(|axis| (self.low[axis] + self.high[axis]) / 2.0);
        let quarters =
            [(false, false), (true, false), (false, true), (true, true)].map(|(right, upper)| DirectionCell {
                low: [if right { middle[0] } else { self.low[0] }, if upper { middle[1] } else { self.low[1] }],
                high: [if right { self.high[0] } else { middle[0] }, if upper { self.high[1] } else { middle[1] }],
            });
        quarters.into_par_iter().any(|quarter| {
            let held = triangles.iter().filter(|index| quarter.may_hold(&seen.corners(**index)));
            let mut inner: Vec<u32> = held.copied().collect();
            // Looking at edges takes longest, and is needed only where cells as such don't decide.
            if inner.len() > limit {
                inner.retain(|index| !quarter.is_beyond_an_edge(&seen.corners(*index)));
            }
            quarter.exceeds(seen, &inner, limit, halvings - 1)
        })
    }

    /// Returns whether something with these corners may reach into the cell: false only where all corners are behind
    /// the light, or outside one of the four planes around the cell.
    fn may_hold<const N: usize>(&self, corners: &[DVec3; N]) -> bool {
        let some = |inside: &dyn Fn(&DVec3) -> bool| corners.iter().any(inside);
        some(&|p| p.z >= 0.0)
            && some(&|p| p.x >= self.low[0] * p.z)
            && some(&|p| p.x <= self.high[0] * p.z)
            && some(&|p| p.y >= self.low[1] * p.z)
            && some(&|p| p.y <= self.high[1] * p.z)
    }

    /// Returns whether a plane through the light and an edge of the triangle separates the triangle from all of the
    /// cell.
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

    /// Returns triangles as a mesh that shares no corner.
    fn mesh(triangles: &[[DVec3; 3]]) -> [(&[DVec3], Vec<[u32; 3]>); 1] {
        [(triangles.as_flattened(), (0..triangles.len() as u32).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect())]
    }

    fn may_exceed(triangles: Vec<[DVec3; 3]>, light: DVec4, limit: usize) -> bool {
        super::may_exceed(mesh(&triangles), light, limit)
    }

    /// Returns the answer of `may_exceed` where boxes settle it.
    fn in_boxes(triangles: &[[DVec3; 3]], light: DVec3, limit: usize) -> Option<bool> {
        let mut all = RelativeTriangles::of(mesh(triangles), light.extend(1.0));
        all.look_around(light.extend(1.0));
        all.exceeds_in_boxes(&all.grids(light.extend(1.0), 1), limit)
    }

    fn stack(count: usize) -> Vec<[DVec3; 3]> {
        let pane = |height: f64| [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]].map(|[x, z]| DVec3::new(x, height, z));
        (0..count).map(|index| pane(index as f64 * 0.01)).collect()
    }

    /// Of as many boxes as a root has, the last one is as wide as the others.
    #[test]
    fn a_ray_at_the_very_end_of_what_is_covered_meets_all_that_is_there() {
        let corners = [[-5.0, -5.0], [4.999, -5.0], [-5.0, 4.999], [4.999, 4.999]];
        let tiny = |[x, z]: [f64; 2], height: f64| {
            [[0.0, 0.0], [0.001, 0.0], [0.0, 0.001]].map(|[along, across]| DVec3::new(x + along, height, z + across))
        };
        for count in 65..75 {
            let each = |height: i32| corners.map(|corner| tiny(corner, f64::from(height) * 0.01));
            let all: Vec<_> = (0..count).flat_map(each).collect();
            let sun = DVec4::new(0.0, 1.0, 0.0, 0.0);
            assert!(may_exceed(all.clone(), sun, count as usize - 1), "{count}");
            assert!(!may_exceed(all, sun, count as usize), "{count}");
        }
    }

    #[test]
    fn a_stack_is_met_whole() {
        for light in [DVec4::new(0.1, 9.0, 0.1, 1.0), DVec4::new(0.1, 1.0, 0.1, 0.0)] {
            assert!(!may_exceed(stack(255), light, 255));
            assert!(may_exceed(stack(256), light, 255));
        }
        // From beside it, a ray meets a few.
        assert!(!may_exceed(stack(256), DVec4::new(40.0, 1.1, 0.1, 1.0), 255));
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
        assert!(!may_exceed(stack.clone(), beside, 255));
        assert!(may_exceed(stack.clone(), beside, 199));
        // From the plane of all diagonals, a ray does meet both halves of each.
        assert!(may_exceed(stack.clone(), DVec4::new(0.3, 9.0, 0.3, 1.0), 255));
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
            assert_eq!(in_boxes(&triangles, light, 39), Some(true), "{light} {tip}");
            assert_eq!(in_boxes(&triangles, light, 40), Some(false), "{light} {tip}");
            assert_ne!(in_boxes(&triangles, tip, 39), Some(false), "{tip}");
        }
    }

    /// What is passed over without a division is what divisions find beside a face.
    #[test]
    fn a_quick_look_passes_over_nothing_that_touches_a_grid() {
        let mut seed = 3u64;
        let mut number = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1 << 23) - 1.0
        };
        let (mut touching, mut beside) = (0, 0);
        for turn in 0..60 {
            let mut point = |reach: f64| DVec3::new(number(), number(), number()) * reach;
            let (middle, size) = (point(2.0), [0.5, 1e-7][turn % 2]);
            let mut triangle = |_| {
                let at = point(2.0);
                [at + point(size), at + point(size), if turn % 3 == 0 { middle } else { at }]
            };
            let triangles: Vec<[DVec3; 3]> = (0..200).map(&mut triangle).collect();
            let light = if turn % 5 == 0 { point(1.0).extend(0.0) } else { point(1.0).extend(1.0) };
            let mut all = RelativeTriangles::of(mesh(&triangles), light);
            all.look_around(light);
            for grid in all.grids(light, 1) {
                let divides = CoverageGrid { beyond: [[f64::NEG_INFINITY, f64::INFINITY]; 2], ..grid };
                let quick = CoverageGrid::new(divides.face, divides.cell, divides.boxes as f64);
                for triangle in &all.triangles {
                    let corners = all.corners(triangle);
                    let expected = divides.touched(&corners);
                    assert_eq!(quick.touched(&corners), expected, "{turn} {corners:?}");
                    assert_eq!(all.touched(&quick, triangle), expected, "{turn} {corners:?}");
                    *if expected.is_some() { &mut touching } else { &mut beside } += 1;
                }
            }
        }
        assert!(touching > 2000 && beside > 2000, "{touching} {beside}");
    }

    /// Around a pole, a hundred triangles meet in a point; a ray beside it meets few.
    #[test]
    fn a_full_box_is_divided() {
        let mesh = shapes::sphere(1.0, 400, 300).expect("a sphere");
        let corners = |t: &[u32; 3]| t.map(|vertex| mesh.positions()[vertex as usize]);
        let triangles: Vec<[DVec3; 3]> = mesh.triangles().iter().map(corners).collect();
        for light in [DVec3::new(0.1, 5.0, 1.0), DVec3::new(4.0, 0.3, 0.2)] {
            assert_eq!(in_boxes(&triangles, light, 700), Some(false), "{light}");
            assert_eq!(in_boxes(&triangles, light, 255), Some(true), "{light}: 400 at the pole");
        }
    }

    /// A torus of many triangles has four layers, wherever the light is.
    #[test]
    fn a_fine_mesh_has_few_layers() {
        let mesh = shapes::torus(1.0, 0.4, 60, 40).expect("a torus");
        let corners = |t: &[u32; 3]| t.map(|vertex| mesh.positions()[vertex as usize]);
        let triangles: Vec<[DVec3; 3]> = mesh.triangles().iter().map(corners).collect();
        for light in [[0.0, 5.0, 1.0, 1.0], [1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.3, 0.0]] {
            assert!(!may_exceed(triangles.clone(), DVec4::from_array(light), 255), "{light:?}");
        }
    }
}
