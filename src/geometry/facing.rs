//! Which way every triangle faces a light: quick where it is clear, exact where it is not.
//!
//! Each triangle's plane is stored once for a caster, in `f32`, scaled so that one bound on rounding holds for all of
//! them. For a new light a plane is evaluated in four multiplications; outside the bound the sign is certain, inside it
//! (for a 70 000-triangle mesh: hardly one triangle) the exact test decides. For every 16 triangles the extremes of
//! their planes are stored too: neighbours mostly face the same way, and then the extremes decide for all of them at
//! once. So the result equals the exact sign on every triangle, for the reading of 2 bytes a triangle, or 18 near the
//! silhouette.
//!
//! ```text
//! plane      n = N / s, d = N·(o − a) / (s·r)       N the normal of triangle a b c, s its largest
//! light      l = (L − o) / r, or D / |D|            component; o, r the caster's middle and reach
//! value      n·l + d·w                              = (exact determinant) / (s·r), but for rounding
//! ```

use crate::math::{Sign, side_of_triangle};
use glam::{DVec3, DVec4};
use rayon::prelude::*;

/// Which triangles of a mesh cast its shadow volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Casters {
    /// Every triangle, turned towards the light: right for any triangle soup.
    All,
    /// Those that face the light: right only for a closed, outward-wound mesh with the light outside it.
    LightFacing,
    /// Those that face away from the light, flipped: right under the same conditions.
    LightBackFacing,
}

/// Number of triangles in a block of planes.
const LANES: usize = 64;
/// Number of runs in a block of planes.
const RUNS: usize = LANES / RUN;
/// Number of triangles in a run, whose common facing is stored so that the run can be skipped.
pub(super) const RUN: usize = 16;
/// Stands for the facing of a run whose triangles do not all face the same way.
pub(super) const MIXED: i8 = 2;
/// Number of triangles that one thread takes at once.
const SHARE: usize = 1024 * LANES;
/// Relative rounding error of one `f32` operation.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// The planes of a caster's triangles, world space, in blocks for fast facing tests.
#[derive(Debug, Clone, Default)]
pub struct CasterPlanes {
    blocks: Vec<PlaneBlock>,
    extremes: Vec<PlaneExtremes>,
    middle: DVec3,
    /// An upper bound for the distance of any corner from `middle` along any axis.
    reach: f64,
}

/// Planes of [`LANES`] triangles; NaN where the plane is too uncertain to decide a side.
#[derive(Debug, Clone)]
struct PlaneBlock {
    normal: [[f32; LANES]; 3],
    offset: [f32; LANES],
}

/// The smallest and largest plane components (x, y, z, offset) of each of a block's [`RUNS`] runs; NaN where one of the
/// planes is uncertain.
#[derive(Debug, Clone)]
struct PlaneExtremes {
    low: [[f32; RUNS]; 4],
    high: [[f32; RUNS]; 4],
}

/// For each triangle of a caster whether it faces a light, and how many face it or face away.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Facings {
    /// 1 towards the light, −1 away, 0 edge-on; one more 0 at the end stands for "no triangle".
    signs: Vec<i8>,
    /// The common sign of every [`RUN`] triangles, or [`MIXED`].
    runs: Vec<i8>,
    towards: usize,
    away: usize,
}

impl Facings {
    /// Returns facings with these signs, one for each triangle in order: positive towards the light, negative away,
    /// zero edge-on.
    pub fn from_signs(signs: impl IntoIterator<Item = Sign>) -> Facings {
        let mut facings = Facings::default();
        facings.signs.extend(signs.into_iter().map(|sign| sign.value() as i8));
        facings.note_runs();
        facings.signs.push(0);
        facings
    }

    fn note_runs(&mut self) {
        let Facings { signs, runs, towards, away } = self;
        runs.clear();
        runs.extend(signs.chunks(RUN).map(sign_of_run));
        (*towards, *away) = (signs.iter().filter(|sign| **sign > 0).count(), signs.iter().filter(|s| **s < 0).count());
    }

    /// Returns a sign for each triangle: 1 where it faces the light, −1 where it faces away, 0 edge-on.
    pub fn signs(&self) -> &[i8] {
        &self.signs[..self.signs.len().saturating_sub(1)]
    }

    /// Returns the signs with a last 0 that stands for a missing triangle.
    pub(super) fn signs_and_none(&self) -> &[i8] {
        &self.signs
    }

    /// Returns the common sign of each run of [`RUN`] triangles, or [`MIXED`].
    pub(super) fn runs(&self) -> &[i8] {
        &self.runs
    }

    /// Returns how many triangles face the light.
    pub fn towards(&self) -> usize {
        self.towards
    }

    /// Returns how many triangles face away from the light.
    pub fn away(&self) -> usize {
        self.away
    }

    /// Sets the sign of triangles that do not cast to 0, as if they were edge-on: none for [`Casters::All`], else those
    /// that face the other way.
    pub fn keep_casting(&mut self, casters: Casters) {
        let keep = |sign: i8| match casters {
            Casters::All => sign,
            Casters::LightFacing => sign.max(0),
            Casters::LightBackFacing => sign.min(0),
        };
        if casters != Casters::All {
            self.signs.iter_mut().for_each(|sign| *sign = keep(*sign));
            self.note_runs_again();
        }
    }

    /// Sets the sign of each triangle for which `left_out` is true to 0; changes nothing where it is empty.
    pub fn leave_out(&mut self, left_out: &[bool]) {
        if left_out.is_empty() {
            return;
        }
        self.signs.iter_mut().zip(left_out).filter(|(_, is_out)| **is_out).for_each(|(sign, _)| *sign = 0);
        self.note_runs_again();
    }

    fn note_runs_again(&mut self) {
        let none = self.signs.pop();
        self.note_runs();
        self.signs.extend(none);
    }
}

/// Returns the sign that all triangles of a run have in common; [`MIXED`] where they differ or there are none.
fn sign_of_run(signs: &[i8]) -> i8 {
    let first = signs.first().copied().unwrap_or(MIXED);
    if signs.iter().fold(0, |different, sign| different | (sign ^ first)) == 0 { first } else { MIXED }
}

impl CasterPlanes {
    /// Computes single-precision planes of `triangles` with vertices `world`, and their error bound, for
    /// [`CasterPlanes::facings`]. A triangle without a usable plane is marked by NaN: its facing is always computed
    /// exactly.
    pub fn new(world: &[DVec3], triangles: &[[u32; 3]]) -> CasterPlanes {
        let Some(first) = world.first() else { return CasterPlanes::default() };
        let (low, high) = world.iter().fold((*first, *first), |(low, high), p| (low.min(*p), high.max(*p)));
        let middle = low + (high - low) / 2.0;
        let reach = (high - middle).max(middle - low).max_element();
        let block = |corners: &[[u32; 3]]| {
            let mut block = PlaneBlock { normal: [[f32::NAN; LANES]; 3], offset: [0.0; LANES] };
            for (lane, corners) in corners.iter().enumerate() {
                if let Some((normal, offset)) = plane(corners.map(|vertex| world[vertex as usize]), middle, reach) {
                    (0..3).for_each(|axis| block.normal[axis][lane] = normal[axis] as f32);
                    block.offset[lane] = offset as f32;
                }
            }
            block
        };
        let blocks: Vec<PlaneBlock> = triangles.par_chunks(LANES).with_min_len(SHARE / LANES / 2).map(block).collect();
        let counts = triangles.chunks(LANES).map(<[_]>::len);
        let extremes = blocks.iter().zip(counts).map(|(block, count)| PlaneExtremes::of(block, count)).collect();
        CasterPlanes { blocks, extremes, middle, reach }
    }

    /// Computes for every triangle on which side of its plane a homogeneous `light` is, exactly, and replaces `out` by
    /// it: positive in front of it. `world` and `triangles` must be those that the planes were made of.
    pub fn facings(&self, world: &[DVec3], triangles: &[[u32; 3]], light: DVec4, out: &mut Facings) {
        let view = PlaneLight::new(self, light);
        if out.signs.len() != triangles.len() + 1 {
            out.signs.clear();
            out.signs.resize(triangles.len() + 1, 0);
            out.runs.resize(triangles.len().div_ceil(RUN), MIXED);
        }
        let signs = &mut out.signs[..triangles.len()];
        let share = |(index, (signs, runs)): (usize, (&mut [i8], &mut [i8]))| {
            let (mut sum, mut clear) = (0, 0);
            let blocks = signs.chunks_mut(LANES).zip(runs.chunks_mut(LANES / RUN));
            for (index, (signs, runs)) in (index * (SHARE / LANES)..).zip(blocks) {
                let exact = |lane: usize| {
                    let corners = triangles[index * LANES + lane].map(|vertex| world[vertex as usize]);
                    side_of_triangle(corners, light).value() as i8
                };
                let known = view.runs(&self.extremes[index]);
                let mut block_sum = 0;
                let mut block_clear = 0;
                let each = signs.chunks_mut(RUN).zip(runs).zip(known).enumerate();
                for (run, ((signs, run_sign), known)) in each {
                    let (run_sum, run_clear) = if known == MIXED {
                        let found = view.run(&self.blocks[index], run, signs, exact);
                        *run_sign = sign_of_run(signs);
                        found
                    } else {
                        signs.fill(known);
                        *run_sign = known;
                        (i64::from(known) * signs.len() as i64, signs.len() as i64)
                    };
                    block_sum += run_sum;
                    block_clear += run_clear;
                }
                sum += block_sum;
                clear += block_clear;
            }
            (sum, clear)
        };
        let add = |a: (i64, i64), b: (i64, i64)| (a.0 + b.0, a.1 + b.1);
        let runs = &mut out.runs;
        let (sum, clear) = match triangles.len() <= 2 * SHARE {
            true => signs.chunks_mut(SHARE).zip(runs.chunks_mut(SHARE / RUN)).enumerate().map(share).fold((0, 0), add),
            false => {
                let shares = signs.par_chunks_mut(SHARE).zip(runs.par_chunks_mut(SHARE / RUN)).enumerate();
                shares.map(share).reduce(|| (0, 0), add)
            }
        };
        out.towards = ((clear + sum) / 2) as usize;
        out.away = ((clear - sum) / 2) as usize;
    }
}

/// A light's position scaled as the planes are, with the rounding error bound.
struct PlaneLight {
    light: [f32; 3],
    w: f32,
    /// Plane values of larger magnitude are sure to have the exact sign.
    bound: f32,
}

impl PlaneLight {
    fn new(planes: &CasterPlanes, light: DVec4) -> PlaneLight {
        let relative = match light.w == 0.0 {
            true => light.truncate() / light.truncate().abs().max_element(),
            false => (light.truncate() - planes.middle) / planes.reach,
        };
        // With S the sum of |l|, rounding moves the value by less than 2^-24 · (6.25 S + 15.75): half
        // of the plane's own error (2^-26 a component), the rounding of n and d to f32, of l to
        // f32, and of four products and three sums.
        let sum = relative.abs().element_sum();
        let bound = (ROUNDING * (8.0 * sum + 20.0)) as f32;
        PlaneLight { light: relative.to_array().map(|part| part as f32), w: f32::from(u8::from(light.w != 0.0)), bound }
    }

    /// Returns for each run of triangles the sign that all certainly have (1 or −1), or [`MIXED`] where the extremes of
    /// their planes do not decide.
    fn runs(&self, extremes: &PlaneExtremes) -> [i8; RUNS] {
        let mut signs = [MIXED; RUNS];
        let light = [self.light[0], self.light[1], self.light[2], self.w];
        let (mut low, mut high) = ([0.0; RUNS], [0.0; RUNS]);
        for (axis, part) in light.into_iter().enumerate() {
            let (of_low, of_high) = match part >= 0.0 {
                true => (&extremes.low[axis], &extremes.high[axis]),
                false => (&extremes.high[axis], &extremes.low[axis]),
            };
            for run in 0..RUNS {
                low[run] += of_low[run] * part;
                high[run] += of_high[run] * part;
            }
        }
        for (run, sign) in signs.iter_mut().enumerate() {
            if low[run] > self.bound {
                *sign = 1;
            } else if high[run] < -self.bound {
                *sign = -1;
            }
        }
        signs
    }

    /// Writes the signs of a run's triangles into `out`, by their planes where these decide, else by `exact` (called
    /// with the triangle's number in the block); returns the signs' sum, and how many are not 0.
    fn run(&self, block: &PlaneBlock, run: usize, out: &mut [i8], exact: impl Fn(usize) -> i8) -> (i64, i64) {
        let [x, y, z] = self.light;
        let [nx, ny, nz] = &block.normal;
        let first = run * RUN;
        let mut signs = [0i8; RUN];
        for (lane, sign) in signs.iter_mut().enumerate() {
            let at = first + lane;
            let value = nx[at] * x + ny[at] * y + nz[at] * z + block.offset[at] * self.w;
            *sign = i8::from(value > self.bound) - i8::from(value < -self.bound);
        }
        for (lane, (out, sign)) in out.iter_mut().zip(signs).enumerate() {
            *out = if sign == 0 { exact(first + lane) } else { sign };
        }
        (out.iter().map(|sign| i64::from(*sign)).sum(), out.iter().map(|sign| i64::from(sign & 1)).sum())
    }
}

impl PlaneExtremes {
    /// Returns the least and greatest of each plane component for every run among the first `count` planes of a block;
    /// NaN for a run with a plane that is NaN.
    fn of(block: &PlaneBlock, count: usize) -> PlaneExtremes {
        let mut extremes = PlaneExtremes { low: [[f32::NAN; RUNS]; 4], high: [[f32::NAN; RUNS]; 4] };
        let [x, y, z] = &block.normal;
        for (axis, parts) in [x, y, z, &block.offset].into_iter().enumerate() {
            for (run, parts) in parts[..count].chunks(RUN).enumerate() {
                // `min` and `max` would pass over NaN.
                if !parts.iter().any(|part| part.is_nan()) {
                    extremes.low[axis][run] = parts.iter().copied().fold(f32::INFINITY, f32::min);
                    extremes.high[axis][run] = parts.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                }
            }
        }
        extremes
    }
}

/// Returns the scaled normal and offset of a triangle's plane; `None` where rounding may have moved the normal by more
/// than 2^-26 of its largest component, or the numbers are out of range.
fn plane([a, b, c]: [DVec3; 3], middle: DVec3, reach: f64) -> Option<(DVec3, f64)> {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    let scale = normal.abs().max_element();
    let (p, q) = (u.abs(), v.abs());
    let products = DVec3::new(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x).max_element();
    // Four roundings of relative size 2^-53 a product; products that vanish say nothing.
    let error = 8.0 * f64::EPSILON * products;
    let is_certain = error < scale * (ROUNDING / 4.0) && scale > 1e-200 && scale < 1e200 && reach > 1e-100;
    is_certain.then(|| (normal / scale, normal.dot((middle - a) / reach) / scale))
}

#[cfg(test)]
mod tests {
    use super::super::facing;
    use super::*;

    fn random(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 33) as f64 / f64::from(1u32 << 31)
    }

    fn assert_exact(world: &[DVec3], triangles: &[[u32; 3]], light: DVec4) {
        let mut facings = Facings::default();
        CasterPlanes::new(world, triangles).facings(world, triangles, light, &mut facings);
        assert_eq!(facings, Facings::from_signs(facing(world, triangles, light)), "{light}");
    }

    #[test]
    fn quick_signs_equal_exact_ones_on_random_triangles() {
        let seed = &mut 7;
        let size_and_middle = [(1.0, 0.0), (1e-3, 1e4), (1e9, -3.0), (1.0, 1e15), (1e-150, 0.0)];
        for (size, middle) in size_and_middle {
            let world: Vec<DVec3> = (0..3000)
                .map(|_| DVec3::new(random(seed), random(seed), random(seed)) * size + DVec3::splat(middle))
                .collect();
            let triangles: Vec<[u32; 3]> = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            for distance in [0.0, 0.5, 3.0, 1e6, 1e20] {
                let away = DVec3::new(random(seed), random(seed), random(seed)) * size * distance;
                assert_exact(&world, &triangles, (world[5] + away).extend(1.0));
                assert_exact(&world, &triangles, (away + DVec3::splat(size)).extend(0.0));
            }
        }
    }

    /// Points of a coarse lattice: many are collinear, coplanar with the light, or at it.
    #[test]
    fn quick_signs_equal_exact_ones_on_degenerate_triangles() {
        let seed = &mut 11;
        for round in 0..60 {
            let jitter = if round % 2 == 0 { 0.0 } else { 1e-15 };
            let world: Vec<DVec3> = (0..400)
                .map(|_| DVec3::new(random(seed), random(seed), random(seed)))
                .map(|p| (p * 4.0).floor() * 0.1 + p * jitter)
                .collect();
            let corner = |seed: &mut u64| (random(seed) * 400.0) as u32;
            let triangles: Vec<[u32; 3]> = (0..777).map(|_| [corner(seed), corner(seed), corner(seed)]).collect();
            assert_exact(&world, &triangles, world[round].extend(1.0));
            assert_exact(&world, &triangles, (world[round] - world[round + 1]).extend(0.0));
            assert_exact(&world, &triangles, DVec4::new(0.1, 0.2, 0.3, 1.0));
        }
    }

    #[test]
    fn leaving_out_one_side_keeps_the_counts() {
        let signs = [Sign::Positive, Sign::Negative, Sign::Zero, Sign::Negative];
        let mut facings = Facings::from_signs(signs);
        assert_eq!((facings.towards(), facings.away()), (1, 2));
        facings.keep_casting(Casters::LightBackFacing);
        assert_eq!((facings.signs(), facings.towards(), facings.away()), (&[0, -1, 0, -1][..], 0, 2));
    }
}
