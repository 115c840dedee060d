//! Shadow volumes of any triangle soup: sides and two caps that close exactly.
//!
//! Vertices are the caster's own, followed by the same carried away from the light ([`Extruder`]): to infinity, where a
//! directional light needs only one point, or by a finite factor. Indices:
//!
//! - *sides*: |m| quads an edge of multiplicity m, directed by its sign and split along a
//!   diagonal that depends only on vertex indices. Where all far vertices are one point, triangles.
//! - *light cap*: the casting triangles in the surface's own vertex order, so that their depths
//!   are bit-equal to the surface's; those that face the light first, then those that are
//!   flipped, which are drawn with front and back operations swapped.
//! - *dark cap*: closes the far end ([`FarEnd`]): where all far vertices are one point, with nothing;
//!   at infinity with a [`CapFan`]; otherwise with the same triangles carried away. Those have no
//!   indices of their own: they are the light cap's with the number of near vertices added to each,
//!   and they must face away from the light, so it is the other of the two ranges that counts as flipped.
//!
//! Where each range begins follows from the counts of facings alone, so indices are written once, into a buffer that
//! may be reused, by several threads where there are many.

use super::facing::{MIXED, RUN};
use super::far_end::CapFan;
use super::{Carry, ClampedEnd, Facings, SilhouetteEdge, relative};
use crate::math::AxisBox;
use glam::{DVec3, DVec4};
use rayon::prelude::*;
use std::ops::Range;

/// Number of a cap's triangles that one thread writes at once.
const SHARE: usize = 64 * 1024;

/// How far shadow volumes extend from their casters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extrusion {
    /// To infinity: far vertices are directions, `V·L.w − L` with `w = 0`.
    Infinite,
    /// Far vertices are points: `V + K·(V − L)` for a point light, `V − K·s·D/|D|` for a directional
    /// one, with `s` the length of the caster's bounding box's diagonal. What lies beyond is lit:
    /// a point light close to its caster moves vertices hardly at all.
    Finite(f64),
    /// A known mistake: `(K + 1)·(V − L)` without adding the light back, so that far vertices are carried from the
    /// world's origin. For a directional light the same as [`Extrusion::Finite`].
    FromOrigin(f64),
    /// To a plane beyond all that is looked at. Vertex shaders can't do this.
    Clamped(ClampedEnd),
}

/// How a volume is closed at its far end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FarEnd {
    /// Not at all: all sides meet in the point at infinity of a directional light.
    Point,
    /// With a fan: a triangle from the far edge of each side to one direction.
    Fan(CapFan),
    /// With the casting triangles, carried away from the light.
    Caps,
}

/// Carries the vertices of one caster away from one light, by a chosen extrusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extruder {
    light: DVec4,
    extrusion: Extrusion,
    /// Length of the diagonal of the caster's bounding box; 0 where it is not needed.
    size: f64,
}

impl Extruder {
    /// Makes the extruder of a caster with vertices `world` under a homogeneous `light`.
    pub fn new(world: &[DVec3], light: DVec4, extrusion: Extrusion) -> Extruder {
        let size = match (extrusion, light.w == 0.0) {
            (Extrusion::Finite(_) | Extrusion::FromOrigin(_), true) => {
                AxisBox::around(world.iter().copied()).diagonal()
            }
            _ => 0.0,
        };
        Extruder { light, extrusion, size }
    }

    /// Returns the world position of a point light whose volumes extend to infinity; otherwise `None`.
    pub fn infinite_from(&self) -> Option<DVec3> {
        let is_infinite = self.extrusion == Extrusion::Infinite && self.light.w != 0.0;
        is_infinite.then(|| self.light.truncate() / self.light.w)
    }

    /// Returns whether all far vertices are one point: the point at infinity of a directional light.
    pub fn is_one_point(&self) -> bool {
        self.light.w == 0.0 && self.extrusion == Extrusion::Infinite
    }

    /// Returns the homogeneous world position of the far copy of a vertex: w 0 with infinite extrusion, else 1.
    pub fn carry(&self, position: DVec3) -> DVec4 {
        let light = self.light.truncate();
        match self.extrusion {
            Extrusion::Infinite => (position * self.light.w - light).extend(0.0),
            Extrusion::Clamped(end) => end.carry(position, self.light).extend(1.0),
            Extrusion::Finite(factor) | Extrusion::FromOrigin(factor) if self.light.w == 0.0 => {
                // The largest component first: a light's direction may have any length.
                let direction = (light / light.abs().max_element()).normalize();
                (position - direction * (factor * self.size)).extend(1.0)
            }
            Extrusion::Finite(factor) => (position + (position - light) * factor).extend(1.0),
            Extrusion::FromOrigin(factor) => ((position - light) * (factor + 1.0)).extend(1.0),
        }
    }

    /// Returns the values by which a vertex shader carries vertices that are relative to `origin`, in single precision.
    ///
    /// # Panics
    /// If it carries onto a plane, [`Extrusion::Clamped`].
    pub fn carry_from(&self, origin: DVec3) -> Carry {
        assert!(!matches!(self.extrusion, Extrusion::Clamped(_)), "a plane's factor differs by vertex");
        let light = relative::homogeneous(self.light, origin);
        // Linear in the place: where the origin goes, and what a metre makes.
        let (zero, one) = (self.carry(origin), self.carry(origin + DVec3::X));
        let [x, y, z, w] = relative::homogeneous(zero, origin);
        Carry { light, scale: (one.x - zero.x) as f32, offset: [x, y, z], w }
    }

    /// Returns the caster's vertices, then their far copies (one, where all are the same point), homogeneous in world
    /// space. A fan's vertices follow them.
    pub fn vertices(&self, world: &[DVec3]) -> impl Iterator<Item = DVec4> {
        let far = if self.is_one_point() { &world[..1.min(world.len())] } else { world };
        world.iter().map(|position| position.extend(1.0)).chain(far.iter().map(|position| self.carry(*position)))
    }
}

/// The ranges of a volume's triangles that are its sides and caps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VolumeParts {
    /// Quads from silhouette edges to their far vertices, except grazing ones.
    pub sides: Range<usize>,
    /// Sides that graze a triangle at their own silhouette edge.
    pub grazing_sides: Range<usize>,
    /// Casting triangles that face the light.
    pub light_cap: Range<usize>,
    /// Casting triangles that face away; they keep their vertex order and count as flipped.
    pub light_cap_flipped: Range<usize>,
    /// The triangles that close the far end.
    pub dark_cap: DarkCap,
}

/// How the triangles that close a volume's far end are drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum DarkCap {
    /// No triangles: the sides meet in one point.
    #[default]
    None,
    /// A range of triangles that face outwards, with vertices after all others.
    Fan(Range<usize>, CapFan),
    /// The light cap's triangles drawn with this base vertex: the number of near vertices.
    Carried(u32),
}

impl VolumeParts {
    fn new(sides: [usize; 2], facings: &Facings, dark_cap: DarkCap) -> VolumeParts {
        let all = sides[0] + sides[1];
        let [towards, away] = [all + facings.towards(), all + facings.towards() + facings.away()];
        VolumeParts {
            sides: 0..sides[0],
            grazing_sides: sides[0]..all,
            light_cap: all..towards,
            light_cap_flipped: towards..away,
            dark_cap,
        }
    }

    /// Returns how many triangles a volume with both caps has: sides, grazing sides, light caps and the dark cap.
    pub fn triangles(&self) -> usize {
        let light_caps = self.light_cap.len() + self.light_cap_flipped.len();
        let dark_cap = match &self.dark_cap {
            DarkCap::None => 0,
            DarkCap::Fan(triangles, _) => triangles.len(),
            DarkCap::Carried(_) => light_caps,
        };
        self.grazing_sides.end + light_caps + dark_cap
    }
}

/// Writes the vertex indices of a volume into `out` (overwritten): three a triangle, into the vertices of
/// [`Extruder::vertices`], front faces outwards except for flipped light-cap triangles. The sides of the last `grazing`
/// silhouette edges are a range of their own.
pub fn write_indices(
    triangles: &[[u32; 3]],
    vertex_count: usize,
    facings: &Facings,
    silhouette: &[SilhouetteEdge],
    grazing: usize,
    far_end: FarEnd,
    out: &mut Vec<u32>,
) -> VolumeParts {
    let far = FarVertices { first: vertex_count as u32, is_one_point: matches!(far_end, FarEnd::Point) };
    let edges = silhouette.split_at(silhouette.len() - grazing);
    let quads = |edges: &[SilhouetteEdge]| -> usize {
        edges.iter().map(|edge| edge.multiplicity.unsigned_abs() as usize).sum()
    };
    let quads = [quads(edges.0), quads(edges.1)];
    let sides = quads.map(|quads| if far.is_one_point { quads } else { 2 * quads });
    let mut parts = VolumeParts::new(sides, facings, DarkCap::None);
    let caps_end = parts.light_cap_flipped.end;
    let mut end = caps_end;
    parts.dark_cap = match far_end {
        FarEnd::Point => DarkCap::None,
        FarEnd::Fan(fan) => {
            end += quads[0] + quads[1] + fan.sphere_triangles();
            DarkCap::Fan(caps_end..end, fan)
        }
        FarEnd::Caps => DarkCap::Carried(far.first),
    };
    let length = end * 3;
    if out.capacity() < length {
        *out = vec![0; length]; // zeroed by the system, not by us
    } else {
        out.resize(length, 0);
    }
    let (sides, rest) = out.as_chunks_mut().0.split_at_mut(parts.grazing_sides.end);
    write_sides(sides, silhouette, far);
    let (caps, fan) = rest.split_at_mut(facings.towards() + facings.away());
    if let FarEnd::Fan(of) = far_end {
        let (fan, spheres) = fan.split_at_mut(quads[0] + quads[1]);
        write_fan(fan, silhouette, far);
        spheres.iter_mut().zip(of.sphere_indices(far.apex() + 1)).for_each(|(out, triangle)| *out = triangle);
    }
    let (towards, away) = caps.split_at_mut(facings.towards());
    let caps = CapIndices { towards, away };
    if triangles.len() <= 2 * SHARE {
        caps.write(triangles, facings.signs(), facings.runs());
    } else {
        let runs = facings.runs().chunks(SHARE / RUN);
        let shares = triangles.chunks(SHARE).zip(facings.signs().chunks(SHARE)).zip(runs);
        let mut rest = caps;
        let with_space = |((triangles, signs), runs)| (rest.split_off(signs), triangles, signs, runs);
        let tasks: Vec<_> = shares.map(with_space).collect();
        tasks.into_par_iter().for_each(|(caps, triangles, signs, runs)| caps.write(triangles, signs, runs));
    }
    parts
}

/// The indices of far vertices.
#[derive(Clone, Copy)]
struct FarVertices {
    first: u32,
    is_one_point: bool,
}

impl FarVertices {
    fn of(self, vertex: u32) -> u32 {
        if self.is_one_point { self.first } else { self.first + vertex }
    }

    /// Returns the index of a fan's apex, which follows as many far vertices as there are near ones.
    fn apex(self) -> u32 {
        2 * self.first
    }
}

/// The output slices for a cap's triangles: those that face the light, and those that are flipped.
struct CapIndices<'a> {
    towards: &'a mut [[u32; 3]],
    away: &'a mut [[u32; 3]],
}

impl<'a> CapIndices<'a> {
    /// Splits off the front of both slices, as long as triangles with these signs need it (positive: towards, negative:
    /// away, 0: neither), and leaves the rest in `self`.
    fn split_off(&mut self, signs: &[i8]) -> CapIndices<'a> {
        let towards = signs.iter().filter(|sign| **sign > 0).count();
        let away = signs.iter().filter(|sign| **sign < 0).count();
        CapIndices { towards: front(&mut self.towards, towards), away: front(&mut self.away, away) }
    }

    fn write(mut self, triangles: &[[u32; 3]], signs: &[i8], runs: &[i8]) {
        // Neighbours mostly face the same way: whole stretches are copied at once.
        let mut start = 0;
        for stretch in runs.chunk_by(|one, other| one == other) {
            let end = triangles.len().min(start + stretch.len() * RUN);
            match stretch[0] {
                MIXED => {
                    let signs = signs[start..end].chunk_by(|one, other| one == other);
                    for same in signs {
                        self.push(&triangles[start..start + same.len()], same[0]);
                        start += same.len();
                    }
                }
                sign => self.push(&triangles[start..end], sign),
            }
            start = end;
        }
    }

    /// Writes triangles that all have the facing `sign` to the front of its slice and advances that; writes nothing for
    /// 0.
    fn push(&mut self, triangles: &[[u32; 3]], sign: i8) {
        let space = match sign {
            1 => &mut self.towards,
            -1 => &mut self.away,
            _ => return,
        };
        front(space, triangles.len()).copy_from_slice(triangles);
    }
}

/// Splits the first `count` elements off `space`, which becomes the rest, and returns them. Panics where there are
/// fewer.
fn front<'a>(space: &mut &'a mut [[u32; 3]], count: usize) -> &'a mut [[u32; 3]] {
    let (taken, rest) = std::mem::take(space).split_at_mut(count);
    *space = rest;
    taken
}

fn write_sides(out: &mut [[u32; 3]], silhouette: &[SilhouetteEdge], far: FarVertices) {
    let mut space = out.iter_mut();
    for &SilhouetteEdge { edge, multiplicity } in silhouette {
        // The oriented triangle runs from `low` to `high` where the multiplicity is positive; the side beside it must
        // run back along the edge for the volume to close.
        let (p, q) = (edge.low, edge.high);
        let (p_away, q_away) = (far.of(p), far.of(q));
        let (first, second) = match (multiplicity > 0, far.is_one_point) {
            (true, true) => ([q, p, p_away], None),
            (false, true) => ([p, q, p_away], None),
            // Both directions are split along the diagonal from p to q's far vertex.
            (true, false) => ([q, p, q_away], Some([p, p_away, q_away])),
            (false, false) => ([p, q, q_away], Some([p, q_away, p_away])),
        };
        for _ in 0..multiplicity.unsigned_abs() {
            let triangles = std::iter::once(first).chain(second);
            triangles.zip(&mut space).for_each(|(triangle, out)| *out = triangle);
        }
    }
}

/// Writes the fan's triangles, as many for each silhouette edge as its multiplicity says. Each runs along its side's
/// far edge, opposite to the side, and to the apex.
fn write_fan(out: &mut [[u32; 3]], silhouette: &[SilhouetteEdge], far: FarVertices) {
    let mut space = out.iter_mut();
    for &SilhouetteEdge { edge, multiplicity } in silhouette {
        let (p, q) = (far.of(edge.low), far.of(edge.high));
        let triangle = if multiplicity > 0 { [q, p, far.apex()] } else { [p, q, far.apex()] };
        (0..multiplicity.unsigned_abs()).zip(&mut space).for_each(|(_, out)| *out = triangle);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CasterPlanes, Casters, EdgeList, silhouette};
    use super::*;
    use crate::math::Sign;
    use std::collections::BTreeMap;

    struct Volume {
        vertices: Vec<DVec4>,
        triangles: Vec<[u32; 3]>,
        parts: VolumeParts,
    }

    impl Volume {
        fn new(world: &[DVec3], triangles: &[[u32; 3]], light: DVec4) -> Volume {
            Volume::of(world, triangles, light, Casters::All, Extrusion::Infinite)
        }

        fn of(world: &[DVec3], corners: &[[u32; 3]], light: DVec4, casters: Casters, extrusion: Extrusion) -> Volume {
            let (mut facings, mut edges, mut indices) = (Facings::default(), Vec::new(), Vec::new());
            CasterPlanes::new(world, corners).facings(world, corners, light, &mut facings);
            facings.keep_casting(casters);
            silhouette(&EdgeList::new(corners, world.len()), &facings, &mut edges);
            let extruder = Extruder::new(world, light, extrusion);
            let far_end = match extruder.infinite_from() {
                Some(light) => FarEnd::Fan(CapFan::new(world, corners, &facings, &edges, light).expect("a fan")),
                None if extruder.is_one_point() => FarEnd::Point,
                None => FarEnd::Caps,
            };
            let grazing = edges.len() / 3;
            let parts = write_indices(corners, world.len(), &facings, &edges, grazing, far_end, &mut indices);
            let mut triangles: Vec<[u32; 3]> = indices.as_chunks().0.to_vec();
            // As they face outwards: the light cap's flipped range, and the carried dark cap's other one.
            if let DarkCap::Carried(base) = parts.dark_cap {
                let carried = |[a, b, c]: [u32; 3]| [a + base, b + base, c + base];
                let flipped = |[a, b, c]: [u32; 3]| [a, c, b];
                let towards: Vec<_> = triangles[parts.light_cap.clone()].iter().map(|t| flipped(carried(*t))).collect();
                let away: Vec<_> = triangles[parts.light_cap_flipped.clone()].iter().map(|t| carried(*t)).collect();
                triangles.extend(towards.into_iter().chain(away));
            }
            let fan = if let DarkCap::Fan(_, fan) = &parts.dark_cap { Some(*fan) } else { None };
            let vertices = extruder.vertices(world).chain(fan.iter().flat_map(CapFan::vertices)).collect();
            Volume { vertices, triangles, parts }
        }
    }

    /// Every edge of a closed surface is run equally often either way. Flipped light-cap triangles count as flipped.
    fn assert_closed(volume: &Volume) {
        let mut balance = BTreeMap::new();
        for (index, &[a, b, c]) in volume.triangles.iter().enumerate() {
            let corners = if volume.parts.light_cap_flipped.contains(&index) { [a, c, b] } else { [a, b, c] };
            for side in 0..3 {
                let (from, to) = (corners[side], corners[(side + 1) % 3]);
                if from != to {
                    *balance.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
                }
            }
        }
        assert!(balance.values().all(|sum| *sum == 0), "{balance:?}");
    }

    fn soup(seed: u64, triangles: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut state = seed;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        let world = (0..12).map(|_| DVec3::new(next(7) as f64, next(7) as f64, next(7) as f64)).collect();
        let corners = |start: u64, step: u64, jump: u64| [start, start + step, start + step + jump];
        let list = (0..triangles).map(|_| corners(next(12), 1 + next(5), 1 + next(5)).map(|i| (i % 12) as u32));
        (world, list.collect())
    }

    #[test]
    fn volumes_of_random_soups_close() {
        for seed in 0..300 {
            let (world, triangles) = soup(seed, 1 + seed as usize % 20);
            assert_closed(&Volume::new(&world, &triangles, DVec4::new(3.0, 20.0, 2.0, 1.0)));
            for light in [DVec4::new(1.0, 2.0, 2.0, 1.0), DVec4::new(1.0, 2.0, 0.5, 0.0)] {
                for casters in [Casters::All, Casters::LightFacing, Casters::LightBackFacing] {
                    let finite = Volume::of(&world, &triangles, light, casters, Extrusion::Finite(3.0));
                    assert_closed(&finite);
                    assert!(finite.vertices.iter().all(|vertex| vertex.w == 1.0));
                    if light.w == 1.0 {
                        assert_closed(&Volume::of(&world, &triangles, light, casters, Extrusion::Infinite));
                    }
                }
            }
        }
    }

    /// Seen from the light, one triangle has three sides, and all parts face outwards.
    #[test]
    fn a_single_triangle_turned_away_casts_like_one_turned_towards() {
        let world = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for (corners, is_flipped) in [([0, 1, 2], false), ([0, 2, 1], true)] {
            let volume = Volume::new(&world, &[corners], DVec4::new(0.2, 0.2, 4.0, 1.0));
            assert_eq!([volume.parts.sides.len(), volume.parts.grazing_sides.len()], [4, 2]);
            assert_eq!(volume.parts.light_cap.len(), usize::from(!is_flipped));
            assert_eq!(volume.parts.light_cap_flipped.len(), usize::from(is_flipped));
            assert!(matches!(&volume.parts.dark_cap, DarkCap::Fan(triangles, _) if *triangles == (7..10)));
            assert_eq!(volume.triangles.len(), 10);
            assert_closed(&volume);
            let inside = DVec3::new(0.3, 0.3, -1.0);
            for index in 0..volume.parts.grazing_sides.end {
                let [a, b, c] = volume.triangles[index].map(|v| volume.vertices[v as usize]);
                let matrix = glam::DMat4::from_cols(a, b, c, inside.extend(1.0));
                assert!(matrix.determinant() > 0.0, "the inside is behind every side");
            }
        }
    }

    #[test]
    fn a_directional_light_needs_no_dark_cap_and_half_the_sides() {
        let world = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let volume = Volume::new(&world, &[[0, 1, 2]], DVec4::new(0.0, 0.0, 1.0, 0.0));
        assert_eq!(volume.parts.grazing_sides.end, 3);
        assert_eq!(volume.parts.dark_cap, DarkCap::None);
        assert_eq!(volume.vertices.len(), 4);
    }

    #[test]
    fn finite_extrusion_carries_points_and_not_directions() {
        let world = [DVec3::ZERO, DVec3::new(3.0, 0.0, 4.0)];
        let point = Extruder::new(&world, DVec4::new(0.0, 2.0, 0.0, 1.0), Extrusion::Finite(100.0));
        assert_eq!(point.carry(DVec3::X), DVec4::new(101.0, -200.0, 0.0, 1.0));
        // The bounding box's diagonal is 5.
        let sun = Extruder::new(&world, DVec4::new(0.0, 7.0, 0.0, 0.0), Extrusion::Finite(2.0));
        assert_eq!(sun.carry(DVec3::X), DVec4::new(1.0, -10.0, 0.0, 1.0));
        assert_eq!([point.infinite_from(), sun.infinite_from()], [None; 2]);
    }

    /// Many triangles, so that several threads write; the same runs as one by one.
    #[test]
    fn caps_keep_the_order_of_their_triangles() {
        let count = 3 * SHARE as u32 + 5;
        let triangles: Vec<[u32; 3]> = (0..count).map(|i| [i, i + 1, i + 2]).collect();
        let sign_of = |i: u32| [Sign::Positive, Sign::Negative, Sign::Zero][(i / 40 % 7 % 3) as usize];
        let facings = Facings::from_signs((0..count).map(sign_of));
        let mut indices = vec![9; 7];
        let parts = write_indices(&triangles, count as usize + 2, &facings, &[], 0, FarEnd::Caps, &mut indices);
        let of = |sign: Sign| triangles.iter().zip(0..count).filter(move |(_, i)| sign_of(*i) == sign).map(|(t, _)| *t);
        let written = indices.as_chunks::<3>().0;
        let expected: Vec<[u32; 3]> = of(Sign::Positive).chain(of(Sign::Negative)).collect();
        assert_eq!(written[..parts.light_cap_flipped.end], expected);
        assert_eq!((written.len(), parts.dark_cap), (expected.len(), DarkCap::Carried(count + 2)));
    }

    /// Returns how often triangles of directions contain `ray`, with sign.
    fn windings(volume: &Volume, triangles: impl Iterator<Item = [u32; 3]>, ray: DVec3) -> i32 {
        let of = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|corner| volume.vertices[corner as usize].truncate());
            let sides = [a.cross(b).dot(ray), b.cross(c).dot(ray), c.cross(a).dot(ray)];
            // All three signs, and the same: it is in the triangle, or in the one opposite.
            let is_ahead = a.cross(b).dot(c) * sides[0] > 0.0;
            let holds = sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0);
            if holds && is_ahead { sides[0].signum() as i32 } else { 0 }
        };
        triangles.map(of).sum()
    }

    /// From all sides of random soups, and from so near that the carried triangles are half-spaces.
    #[test]
    fn a_fan_counts_like_the_carried_triangles() {
        let mut seen = 0;
        for seed in 0..200 {
            let (world, corners) = soup(seed, 1 + seed as usize % 20);
            // Beside it, and inside: between triangles, and at a thousandth of a millionth from one.
            let near = (world[0] + world[1] + world[2]) / 3.0 + DVec3::new(1e-9, 2e-9, -1e-9);
            let inside = [[3.1, 2.2, 2.7], [0.7, 5.3, 1.9], near.to_array()];
            let beside = [[9.0, 7.5, 2.0], [3.1, 6.0 + 1e-7, 2.9], [-0.5, 2.2, 3.3], [3.0, 2.5, -40.0]];
            let lights = [&beside[..], &inside[..]].concat();
            for light in lights.into_iter().map(|light| DVec3::from_array(light).extend(1.0)) {
                let fan = Volume::new(&world, &corners, light);
                let DarkCap::Fan(range, _) = fan.parts.dark_cap.clone() else { panic!("{light} is a point") };
                let base = world.len() as u32;
                for _ in 0..40 {
                    seen += 1;
                    let angle = f64::from(seen);
                    let ray = DVec3::new(angle.sin(), (1.7 * angle).cos(), (2.3 * angle).sin() + 0.01);
                    let by_fan = windings(&fan, fan.triangles[range.clone()].iter().copied(), ray);
                    let carried = |run: &Range<usize>, is_flipped: bool| {
                        let far = fan.triangles[run.clone()].iter().map(|t| t.map(|corner| corner + base));
                        let sum = windings(&fan, far, ray);
                        if is_flipped { -sum } else { sum }
                    };
                    // Flipped as in `assert_closed`: away from the light.
                    let by_caps = carried(&fan.parts.light_cap, true) + carried(&fan.parts.light_cap_flipped, false);
                    assert_eq!(by_fan, by_caps, "{seed} {light} {ray}");
                }
            }
        }
    }

    /// All round it is dark: one sphere.
    #[test]
    fn a_light_in_a_closed_mesh_is_closed_by_a_sphere() {
        let corners = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let world = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let volume = Volume::new(&world, &corners, DVec4::new(0.2, 0.2, 0.2, 1.0));
        let DarkCap::Fan(triangles, fan) = &volume.parts.dark_cap else { panic!("a point light") };
        assert_eq!((triangles.len(), fan.spheres, volume.parts.grazing_sides.end), (8, 1, 0));
        assert_closed(&volume);
    }
}
