//! Which triangles of a mesh are near a pixel, without a look at all of them.
//!
//! On which side of a plane through the eye a corner lies is the sign of a sum that is linear in its four homogeneous
//! coordinates. So a box in these four says it of all corners inside: before the eye, behind it and at infinity. Those at
//! infinity have a box of their own: one that reaches from w = 0 to 1 would hardly be clear of any plane. A triangle is
//! passed over only where its corners, one by one, would be, so boxes change no result.
//!
//! ```text
//! level 1     ┌───────────────┬─ … one box of RUNS boxes
//! level 0     ├───┬───┬───┬───┼─ … one box of RUN triangles, neighbours in the mesh's list
//! triangles   ▲▲▲▲▲▲▲▲▲▲▲▲▲▲▲▲▲▲ …
//! ```
//!
//! In the list of most meshes neighbours are near each other, too. Where they are not, the tree has an order of its own,
//! along a curve through space (Morton 1966).

use crate::geometry::Blob;
use glam::{Mat4, Vec4, Vec4Swizzles};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// How many triangles one of the smallest boxes holds.
const RUN: usize = 64;
/// How many boxes a larger box holds.
const RUNS: usize = 8;
/// So many triangles are looked at one by one sooner than by boxes.
const FEW: usize = 4 * RUN;
/// A tree has an order of its own where a ray through the mesh would meet more of its smallest boxes than this.
const MOST_MET: f32 = 256.0;
/// The rounding error of a corner's distance from a plane in `f32`, relative to the largest term of its sum.
const ROUNDING: f32 = 1e-6;

/// Four planes through the eye round a pixel, by which corners are sorted in `f32`.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelSieve {
    /// A row for each plane.
    planes: Mat4,
    /// What is past a plane by less, relative to a corner's largest coordinate, may be on the other side.
    rounding: f32,
}

impl PixelSieve {
    /// Makes the sieve of four planes, a row each; what is beyond all four by its positive sum is far from the pixel.
    pub fn new(planes: glam::DMat4) -> PixelSieve {
        let largest = planes.to_cols_array().into_iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        PixelSieve { planes: planes.as_mat4(), rounding: ROUNDING * 4.0 * largest as f32 }
    }

    /// Returns four bits: of which planes a corner is certainly outside. A bit that is not set says nothing.
    fn outside(&self, corner: [f32; 4]) -> u32 {
        let corner = Vec4::from_array(corner);
        let bound = corner.abs().max_element() * self.rounding;
        (self.planes * corner).cmpgt(Vec4::splat(bound)).bitmask()
    }

    /// Returns four bits: of which planes every corner in a box is outside by [`PixelSieve::outside`]. Sums over a box
    /// are rounded like those of corners, so it is held to twice their bound.
    fn outside_all(&self, corners: &CornerBox) -> u32 {
        let CornerBox { low, high } = corners;
        if low.x > high.x {
            return u32::MAX;
        }
        let bound = 2.0 * low.abs().max(high.abs()).max_element() * self.rounding;
        let term = |axis: usize| {
            let factors = self.planes.col(axis);
            (factors * low[axis]).min(factors * high[axis])
        };
        let least = term(0) + term(1) + term(2) + term(3);
        least.cmpgt(Vec4::splat(bound)).bitmask()
    }
}

/// Boxes round a mesh's triangles, made when they are first asked for and shared with clones. They say nothing that the
/// mesh does not.
#[derive(Debug, Clone, Default)]
pub struct TriangleBoxes(Arc<Mutex<BTreeMap<TreeKey, Arc<BoxTree>>>>);

/// Hashes of positions and indices, and the range of triangles with what is added to their indices.
type TreeKey = ([u64; 2], [u32; 3]);

impl PartialEq for TriangleBoxes {
    fn eq(&self, _: &TriangleBoxes) -> bool {
        true
    }
}

impl TriangleBoxes {
    /// Returns the triangles of a range of the mesh whose corners are not all outside of one of the sieve's planes, in
    /// the mesh's order. A corner that does not exist is outside of all.
    pub(super) fn near(
        &self,
        vertices: &Blob<[f32; 4]>,
        indices: &Blob<u32>,
        triangles: &Range<u32>,
        base_vertex: u32,
        sieve: &PixelSieve,
    ) -> Vec<u32> {
        let list = TriangleList::new(vertices.data(), indices.data(), triangles, base_vertex);
        if list.len() < FEW {
            return list.near(0..list.len(), None, sieve).collect();
        }
        let key = ([vertices.hash(), indices.hash()], [triangles.start, triangles.end, base_vertex]);
        let known = self.trees().get(&key).map(Arc::clone);
        // Boxes are made by all cores: meanwhile nobody may wait for a lock. Twice made, they are the same.
        let tree = known.unwrap_or_else(|| {
            let made = Arc::new(BoxTree::new(&list));
            Arc::clone(self.trees().entry(key).or_insert(made))
        });
        tree.near(&list, sieve)
    }

    fn trees(&self) -> MutexGuard<'_, BTreeMap<TreeKey, Arc<BoxTree>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A range of a mesh's triangles.
#[derive(Clone, Copy)]
struct TriangleList<'a> {
    vertices: &'a [[f32; 4]],
    triangles: &'a [[u32; 3]],
    /// Index of the first of `triangles` in the mesh.
    first: u32,
    base_vertex: u32,
}

impl<'a> TriangleList<'a> {
    /// Makes the list of those triangles of the range that exist.
    fn new(vertices: &'a [[f32; 4]], indices: &'a [u32], range: &Range<u32>, base_vertex: u32) -> TriangleList<'a> {
        let all = indices.as_chunks::<3>().0;
        let end = (range.end as usize).min(all.len());
        let triangles = all.get(range.start as usize..end).unwrap_or_default();
        TriangleList { vertices, triangles, first: range.start, base_vertex }
    }

    fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the corners that exist of a triangle of the list.
    fn corners(&self, triangle: usize) -> impl Iterator<Item = [f32; 4]> {
        let TriangleList { vertices, base_vertex, .. } = *self;
        let corner = move |index: u32| vertices.get(index.saturating_add(base_vertex) as usize).copied();
        self.triangles[triangle].into_iter().filter_map(corner)
    }

    /// Returns, by their indices in the mesh, which triangles are near the pixel of those at some places: of the list, or
    /// of an order of it.
    fn near(&self, places: Range<usize>, order: Option<&[u32]>, sieve: &PixelSieve) -> impl Iterator<Item = u32> {
        let triangles = places.map(move |place| order.map_or(place, |order| order[place] as usize));
        let is_near = |triangle: &usize| {
            self.corners(*triangle).fold(u32::MAX, |outside, corner| outside & sieve.outside(corner)) == 0
        };
        triangles.filter(is_near).map(|triangle| self.first + triangle as u32)
    }
}

/// A box in homogeneous coordinates; empty where low is above high.
#[derive(Debug, Clone, Copy)]
struct CornerBox {
    low: Vec4,
    high: Vec4,
}

impl CornerBox {
    const EMPTY: CornerBox = CornerBox { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    const EVERYTHING: CornerBox = CornerBox { low: Vec4::NEG_INFINITY, high: Vec4::INFINITY };

    fn add(&mut self, corner: Vec4) {
        self.low = self.low.min(corner);
        self.high = self.high.max(corner);
    }

    /// Returns whether it is neither empty nor round what is no number.
    fn has_ends(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    fn joined(self, other: CornerBox) -> CornerBox {
        CornerBox { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// Boxes of the finite corners of some triangles, and of those at infinity (w = 0).
#[derive(Debug, Clone, Copy)]
struct CornerBoxes {
    finite: CornerBox,
    infinite: CornerBox,
}

impl CornerBoxes {
    const EMPTY: CornerBoxes = CornerBoxes { finite: CornerBox::EMPTY, infinite: CornerBox::EMPTY };

    fn of(corners: impl Iterator<Item = [f32; 4]>) -> CornerBoxes {
        let mut boxes = CornerBoxes::EMPTY;
        // 0, but for corners that are no numbers: of those nothing is certain.
        let mut doubt = Vec4::ZERO;
        corners.for_each(|corner| {
            let among = if corner[3] == 0.0 { &mut boxes.infinite } else { &mut boxes.finite };
            let corner = Vec4::from_array(corner);
            doubt += corner * 0.0;
            among.add(corner);
        });
        if doubt.is_nan() { CornerBoxes { finite: CornerBox::EVERYTHING, ..boxes } } else { boxes }
    }

    fn joined(self, other: CornerBoxes) -> CornerBoxes {
        CornerBoxes { finite: self.finite.joined(other.finite), infinite: self.infinite.joined(other.infinite) }
    }

    /// Returns the box of the finite corners, or of those at infinity where there are no others.
    fn main(&self) -> &CornerBox {
        if self.finite.low.x <= self.finite.high.x { &self.finite } else { &self.infinite }
    }

    fn is_near(&self, sieve: &PixelSieve) -> bool {
        sieve.outside_all(&self.finite) & sieve.outside_all(&self.infinite) == 0
    }
}

/// Boxes of runs of triangles, of runs of these boxes, and so on.
#[derive(Debug)]
struct BoxTree {
    /// The triangles of the list in the order in which boxes hold them; `None` where that is the list's.
    order: Option<Vec<u32>>,
    /// The smallest boxes first, at the end at most [`RUNS`].
    levels: Vec<Vec<CornerBoxes>>,
}

impl BoxTree {
    fn new(list: &TriangleList) -> BoxTree {
        let tree = BoxTree::ordered(list, None);
        match tree.rays_meet() > MOST_MET {
            true => BoxTree::ordered(list, Some(along_curve(list, &tree.whole()))),
            false => tree,
        }
    }

    fn ordered(list: &TriangleList, order: Option<Vec<u32>>) -> BoxTree {
        let run = |index: usize| {
            let places = index * RUN..list.len().min((index + 1) * RUN);
            let triangle = |place: usize| order.as_ref().map_or(place, |order| order[place] as usize);
            CornerBoxes::of(places.flat_map(|place| list.corners(triangle(place))))
        };
        let runs = list.len().div_ceil(RUN);
        let mut levels: Vec<Vec<CornerBoxes>> = vec![(0..runs).into_par_iter().with_min_len(RUN).map(run).collect()];
        while let Some(below) = levels.last().filter(|level| level.len() > RUNS) {
            let joined = |boxes: &[CornerBoxes]| boxes.iter().copied().fold(CornerBoxes::EMPTY, CornerBoxes::joined);
            levels.push(below.chunks(RUNS).map(joined).collect());
        }
        BoxTree { order, levels }
    }

    /// Returns the boxes round all of the smallest that have ends.
    fn whole(&self) -> CornerBoxes {
        let ended = |of: CornerBox| if of.has_ends() { of } else { CornerBox::EMPTY };
        let boxes =
            self.levels[0].iter().map(|of| CornerBoxes { finite: ended(of.finite), infinite: ended(of.infinite) });
        boxes.fold(CornerBoxes::EMPTY, CornerBoxes::joined)
    }

    /// Returns about how many of the smallest boxes a ray through the mesh meets: the sum of their sections, relative to
    /// the mesh's. 0 for what has no section.
    fn rays_meet(&self) -> f32 {
        let section = |CornerBox { low, high }: &CornerBox| {
            // Of the three sections across the axes the largest: a flat box has it, too.
            let size = *high - *low;
            (size.xyz() * size.yzx()).max_element()
        };
        let ended = self.levels[0].iter().map(CornerBoxes::main).filter(|of| of.has_ends());
        let met = ended.map(section).sum::<f32>() / section(self.whole().main());
        if met.is_finite() { met } else { 0.0 }
    }

    fn near(&self, list: &TriangleList, sieve: &PixelSieve) -> Vec<u32> {
        let mut found = Vec::new();
        let top = self.levels.len() - 1;
        // What is next is at the end.
        let mut left: Vec<(usize, usize)> = (0..self.levels[top].len()).rev().map(|index| (top, index)).collect();
        while let Some((level, index)) = left.pop() {
            if !self.levels[level][index].is_near(sieve) {
                continue;
            }
            match level.checked_sub(1) {
                Some(below) => {
                    let held = index * RUNS..self.levels[below].len().min((index + 1) * RUNS);
                    left.extend(held.rev().map(|index| (below, index)));
                }
                None => {
                    let places = index * RUN..list.len().min((index + 1) * RUN);
                    found.extend(list.near(places, self.order.as_deref(), sieve));
                }
            }
        }
        if self.order.is_some() {
            found.sort_unstable();
        }
        found
    }
}

/// Returns the triangles of a list along a curve through the box of its finite corners; those without any along one
/// through the box of the others, after them.
fn along_curve(list: &TriangleList, whole: &CornerBoxes) -> Vec<u32> {
    let key = |triangle: usize| {
        let finite = list.corners(triangle).find(|corner| corner[3] != 0.0);
        let Some(corner) = finite.or_else(|| list.corners(triangle).next()) else { return u32::MAX };
        let CornerBox { low, high } = if finite.is_some() { &whole.finite } else { &whole.infinite };
        let share = (Vec4::from_array(corner) - *low) / (*high - *low);
        // Of what is no number, as in a box without extent, this makes 0.
        let cell = (share.xyz() * 1023.0).to_array().map(|share| spread(share as u32));
        u32::from(finite.is_none()) << 30 | cell[0] | cell[1] << 1 | cell[2] << 2
    };
    let mut keyed: Vec<(u32, u32)> =
        (0..list.len()).into_par_iter().map(|triangle| (key(triangle), triangle as u32)).collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, triangle)| triangle).collect()
}

/// Returns the lowest ten bits of a number with two zeros before each.
fn spread(number: u32) -> u32 {
    let number = number.min(1023);
    let number = (number | number << 16) & 0x0300_00ff;
    let number = (number | number << 8) & 0x0300_f00f;
    let number = (number | number << 4) & 0x030c_30c3;
    (number | number << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat4, DVec3, DVec4};

    /// Numbers that look random, the same in each run (Knuth's MMIX constants).
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// A sheet in waves of a `height`, of `side` times `side` squares with every seventh corner carried to infinity from a
    /// place beside it, and one that is no number; `shuffles` puts its triangles in no order.
    fn sheet(side: u32, height: f32, seed: u64, shuffles: bool) -> (Vec<[f32; 4]>, Vec<u32>) {
        let mut next = numbers(seed);
        let at = |index: u32| {
            let (x, z) = ((index % (side + 1)) as f32 / side as f32, (index / (side + 1)) as f32 / side as f32);
            let y = (x * 9.0).sin() * (z * 7.0).cos() * height;
            if index % 7 == 3 { [x - 0.3, y - 2.0, z - 0.4, 0.0] } else { [x * 4.0 - 2.0, y, z * 4.0 - 2.0, 1.0] }
        };
        let mut vertices: Vec<[f32; 4]> = (0..(side + 1) * (side + 1)).map(at).collect();
        vertices[5][1] = f32::NAN;
        let square = |index: u32| {
            let a = index / side * (side + 1) + index % side;
            [[a, a + 1, a + side + 1], [a + 1, a + side + 2, a + side + 1]]
        };
        let mut triangles: Vec<[u32; 3]> = (0..side * side).flat_map(square).collect();
        if shuffles {
            for index in (1..triangles.len()).rev() {
                triangles.swap(index, (next() * (index + 1) as f64) as usize);
            }
        }
        // One corner that does not exist.
        triangles[9][1] = u32::MAX - 3;
        (vertices, triangles.into_iter().flatten().collect())
    }

    /// The planes of a small square round a random direction from a random eye, which may be inside or behind the mesh.
    fn random_sieve(next: &mut impl FnMut() -> f64) -> PixelSieve {
        let mut within = |reach: f64| DVec3::new(next(), next(), next()).map(|one| (2.0 * one - 1.0) * reach);
        let (eye, towards) = (within(3.0), within(1.0));
        let right = towards.cross(DVec3::new(0.1, 1.0, 0.2)).normalize();
        let row = |axis: DVec3| axis.extend(-axis.dot(eye));
        let [x, y, w] = [right, right.cross(towards).normalize(), towards.normalize()].map(row);
        let (center, reach) = (within(1.0), 0.01);
        let planes: [DVec4; 4] = [
            x - w * (center.x + reach),
            w * (center.x - reach) - x,
            y - w * (center.y + reach),
            w * (center.y - reach) - y,
        ];
        PixelSieve::new(DMat4::from_cols(planes[0], planes[1], planes[2], planes[3]).transpose())
    }

    /// Boxes find just what a look at each triangle finds, in the same order, whether or not neighbours in the list are
    /// near each other, in parts of a mesh too, and look at few.
    #[test]
    fn boxes_find_what_a_look_at_each_triangle_finds() {
        let mut found = 0;
        let sheets = [(150, 0.2, false), (150, 0.2, true), (11, 0.2, false), (12, 0.2, true), (150, 0.0, true)];
        for (seed, (side, height, shuffles)) in (1..).zip(sheets) {
            let (vertices, indices) = sheet(side, height, seed, shuffles);
            let [all, part] = [0..side * side * 2, side * 3..side * side + 7];
            let (vertices, indices) = (Blob::new(vertices), Blob::new(indices));
            let boxes = TriangleBoxes::default();
            let mut next = numbers(seed);
            for index in 0..400 {
                let sieve = random_sieve(&mut next);
                let range = if index % 3 == 0 { &part } else { &all };
                let base_vertex = if index % 5 == 0 { 4 } else { 0 };
                let list = TriangleList::new(vertices.data(), indices.data(), range, base_vertex);
                let expected: Vec<u32> = list.near(0..list.len(), None, &sieve).collect();
                assert_eq!(boxes.near(&vertices, &indices, range, base_vertex, &sieve), expected, "{side}, {index}");
                found += expected.len();
            }
            let list = TriangleList::new(vertices.data(), indices.data(), &all, 0);
            assert_eq!(BoxTree::new(&list).order.is_some(), shuffles && side > 100, "{side}, {height}");
        }
        assert!(found > 10_000, "{found}");
    }

    #[test]
    fn bits_are_spread_for_the_curve() {
        for number in [0, 1, 2, 0b11_0101, 1023] {
            let expected: u32 = (0..10).map(|bit| (number >> bit & 1) << (3 * bit)).sum();
            assert_eq!(spread(number), expected);
        }
        assert_eq!(spread(5000), spread(1023));
    }
}
