//! How many casting triangles a light's ray can meet at most, by the edges that bound the shadow alone.
//!
//! Turned towards the light, casting triangles cover directions from it, and how many cover a direction changes only at
//! an edge of the silhouette, by the edge's multiplicity. So along a meridian that begins at a pole that no caster
//! covers, it never exceeds the number of edges that the meridian crosses. Silhouettes are small and known, and no
//! triangle is looked at. A directional light's meridians are parallel lines that begin at infinity.
//!
//! Edges also take away, so the bound is higher than the number itself; where it is too high, [`super::layers`] knows
//! more.

use crate::math::AxisBox;
use glam::{DVec2, DVec3, DVec4};

/// How many sectors edges are counted in for each edge. Narrow ones tell edges apart that lie almost along a meridian.
const SECTORS_AN_EDGE: usize = 32;
/// The fewest and the most sectors.
const SECTORS: [usize; 2] = [64, 1 << 20];
/// A point this near to the poles' axis may have any longitude, as rounding goes; relative to the largest coordinate.
const NEAR_AXIS: f64 = 1e-9;
/// Far more than the rounding error of a place beside a directional light; relative to the largest coordinate.
const BESIDE: f64 = 1e-12;
/// Products of two coordinates below this are finite.
const LARGEST: f64 = 1e150;

/// Returns whether surely no ray of the light meets more than `limit` casting triangles. `silhouettes` has the ends of
/// each edge of the casters' silhouettes (world space), as often as its multiplicity; `boxes` contain the casters.
/// False also where this can't tell.
pub fn is_within(silhouettes: impl Iterator<Item = [DVec3; 2]>, boxes: &[AxisBox], light: DVec4, limit: usize) -> bool {
    let edges: Vec<[DVec3; 2]> = silhouettes.collect();
    let is_low =
        |meridians: Meridians| edges.len() <= limit || meridians.crossed(&edges).into_iter().all(|n| n <= limit);
    Meridians::all(boxes, light).any(is_low)
}

/// The meridians that an edge crosses, as shares of all of them: from `from` on to `to`, through 1 where `to` is lower.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Span {
    from: f64,
    to: f64,
}

impl Span {
    const ALL: Span = Span { from: 0.0, to: 1.0 };
}

/// How directions from a light are divided into meridians.
enum Meridians {
    /// Half planes from the axis through a point light that is parallel to a coordinate axis; `across` are the others.
    Around { light: DVec3, across: [usize; 2], near_axis: f64 },
    /// Planes along a directional light, by their place along `across`, which is known to within `doubt`.
    Beside { across: DVec3, from: f64, width: f64, doubt: f64 },
}

impl Meridians {
    /// Returns all ways to divide directions by meridians of which each begins where no box is: of a point light, around each
    /// axis along which on one side of it no box lies. None where something is not finite or too large to multiply.
    fn all(boxes: &[AxisBox], light: DVec4) -> impl Iterator<Item = Meridians> {
        let around = boxes.iter().fold(AxisBox::around([]), |all, one| all.joined(*one));
        let largest = around.low.abs().max(around.high.abs()).max_element();
        let is_point = light.w != 0.0;
        let beside = (!is_point).then(|| Meridians::beside(&around, light.truncate(), BESIDE * largest)).flatten();
        let light = light.truncate() / light.w;
        let near_axis = NEAR_AXIS * largest.max(light.abs().max_element());
        let is_free = move |axis: usize, is_up: bool| {
            let [u, v] = others(axis);
            let holds = |of: &AxisBox, axis: usize| of.low[axis] <= light[axis] && light[axis] <= of.high[axis];
            let is_ahead = |of: &AxisBox| match is_up {
                true => of.high[axis] >= light[axis],
                false => of.low[axis] <= light[axis],
            };
            !boxes.iter().any(|of| holds(of, u) && holds(of, v) && is_ahead(of))
        };
        let axes = if is_point && near_axis < NEAR_AXIS * LARGEST { 0..3 } else { 0..0 };
        let free = axes.filter(move |axis| is_free(*axis, true) || is_free(*axis, false));
        let around = free.map(move |axis| Meridians::Around { light, across: others(axis), near_axis });
        beside.into_iter().chain(around)
    }

    /// Returns the meridians of a directional light, over a box and `doubt` on either side; `None` where something is not
    /// finite, or nothing lies across.
    fn beside(around: &AxisBox, light: DVec3, doubt: f64) -> Option<Meridians> {
        let across = light.try_normalize()?.any_orthonormal_vector();
        let places = around.corners().map(|corner| across.dot(corner));
        let low = places.into_iter().fold(f64::INFINITY, f64::min) - doubt;
        let width = places.into_iter().fold(f64::NEG_INFINITY, f64::max) + doubt - low;
        (width.is_finite() && width > 0.0).then_some(Meridians::Beside { across, from: low, width, doubt })
    }

    /// Returns for each sector, an equal share of all meridians, how many edges one of it may cross.
    fn crossed(&self, edges: &[[DVec3; 2]]) -> Vec<usize> {
        let sectors = (edges.len() * SECTORS_AN_EDGE).clamp(SECTORS[0], SECTORS[1]);
        let sector = |share: f64| ((share * sectors as f64) as usize).min(sectors - 1);
        // By how many edges more or fewer than the sector before it each sector is crossed.
        let mut changes = vec![0_isize; sectors + 1];
        for [from, to] in edges {
            let Span { from, to } = self.span(*from, *to);
            let [first, last] = [from, to].map(sector);
            // A sector more on both sides, for rounding; they go round, and an edge goes less than half round.
            let begin = (first + sectors - 1) % sectors;
            let count = match (from, to) {
                (0.0, 1.0) => sectors,
                _ => ((last + sectors - first) % sectors + 3).min(sectors),
            };
            changes[begin] += 1;
            if begin + count <= sectors {
                changes[begin + count] -= 1;
            } else {
                changes[0] += 1;
                changes[begin + count - sectors] -= 1;
            }
        }
        let sums = changes[..sectors].iter().scan(0_isize, |crossed, change| {
            *crossed += change;
            Some(crossed.unsigned_abs())
        });
        sums.collect()
    }

    /// Returns the meridians that an edge may cross.
    fn span(&self, from: DVec3, to: DVec3) -> Span {
        match *self {
            Meridians::Beside { across, from: low, width, doubt } => {
                let [one, other] = [from, to].map(|end| across.dot(end) - low);
                let share = |place: f64| (place / width).clamp(0.0, 1.0);
                Span { from: share(one.min(other) - doubt), to: share(one.max(other) + doubt) }
            }
            Meridians::Around { light, across: [u, v], near_axis } => {
                let [from, to] = [from, to].map(|end| DVec2::new(end[u] - light[u], end[v] - light[v]));
                let turn = from.perp_dot(to);
                // Where the edge may meet the axis, any meridian may cross it.
                let nearest = from.length().min(to.length());
                let is_straight = turn.abs() <= near_axis * from.distance(to) && from.dot(to) <= 0.0;
                if nearest <= near_axis || is_straight {
                    return Span::ALL;
                }
                let [from, to] = if turn >= 0.0 { [from, to] } else { [to, from] }.map(longitude);
                Span { from, to }
            }
        }
    }
}

/// Returns the two other axes.
fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Returns a number from 0 to 1 that grows with the angle of a direction, anticlockwise from the first axis.
fn longitude(direction: DVec2) -> f64 {
    let DVec2 { x, y } = direction;
    let of_quarter = y / (x.abs() + y.abs());
    let quarters = match (x < 0.0, y < 0.0) {
        (true, _) => 2.0 - of_quarter,
        (false, true) => 4.0 + of_quarter,
        (false, false) => of_quarter,
    };
    quarters / 4.0
}

#[cfg(test)]
mod tests {
    use super::super::{CasterPlanes, EdgeList, Facings, silhouette};
    use super::*;
    use crate::scene::{Mesh, shapes};
    use std::sync::Arc;

    /// A caster as the bound sees it: the ends of its silhouette's edges, its box, and its casting triangles.
    fn caster(world: &[DVec3], triangles: &[[u32; 3]], light: DVec4) -> (Vec<[DVec3; 2]>, AxisBox, Vec<[DVec3; 3]>) {
        let (mut facings, mut edges) = (Facings::default(), Vec::new());
        CasterPlanes::new(world, triangles).facings(world, triangles, light, &mut facings);
        silhouette(&EdgeList::new(triangles, world.len()), &facings, &mut edges);
        let ends = edges.iter().flat_map(|edge| {
            let ends = [edge.edge.low, edge.edge.high].map(|vertex| world[vertex as usize]);
            std::iter::repeat_n(ends, edge.multiplicity.unsigned_abs() as usize)
        });
        let casting = triangles.iter().zip(facings.signs()).filter(|(_, sign)| **sign != 0);
        let casting = casting.map(|(corners, _)| corners.map(|vertex| world[vertex as usize]));
        (ends.collect(), AxisBox::around(world.iter().copied()), casting.collect())
    }

    /// Returns the lowest limit that the bound allows.
    fn bound(edges: &[[DVec3; 2]], boxes: &[AxisBox], light: DVec4) -> Option<usize> {
        (0..=edges.len() + 1).find(|limit| is_within(edges.iter().copied(), boxes, light, *limit))
    }

    fn random(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 23) - 1.0
        }
    }

    /// Returns the direction of a light's ray through a point.
    fn ray(light: DVec4, towards: DVec3) -> DVec3 {
        if light.w == 0.0 { -light.truncate() } else { towards - light.truncate() / light.w }
    }

    /// Returns how many edges the meridian of a light's ray through a point may cross.
    fn crossed_by(meridians: &Meridians, crossed: &[usize], light: DVec4, towards: DVec3) -> usize {
        let share = match meridians {
            Meridians::Around { across: [u, v], .. } => {
                let ray = ray(light, towards);
                longitude(DVec2::new(ray[*u], ray[*v]))
            }
            Meridians::Beside { across, from, width, .. } => (across.dot(towards) - from) / width,
        };
        if !(0.0..=1.0).contains(&share) {
            return 0;
        }
        crossed[((share * crossed.len() as f64) as usize).min(crossed.len() - 1)]
    }

    /// Returns how many of the triangles the light's ray through a point meets.
    fn met(triangles: &[[DVec3; 3]], light: DVec4, towards: DVec3) -> usize {
        let meets = |corners: &&[DVec3; 3]| {
            let ray = ray(light, towards);
            let [a, b, c] = corners
                .map(|corner| if light.w == 0.0 { corner - towards } else { corner - light.truncate() / light.w });
            let sides = [a.cross(b).dot(ray), b.cross(c).dot(ray), c.cross(a).dot(ray)];
            let is_inside = sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0);
            is_inside && (light.w == 0.0 || a.cross(b).dot(c) * sides[0] > 0.0)
        };
        triangles.iter().filter(meets).count()
    }

    /// Soups of triangles, from outside and from between them, beside, above and below: no ray meets more.
    #[test]
    fn no_ray_meets_more_triangles_than_the_bound() {
        let mut number = random(11);
        let (mut bounded, mut reached) = (0, 0);
        for turn in 0..400 {
            let mut point = |reach: f64| DVec3::new(number(), number(), number()) * reach;
            let world: Vec<DVec3> = (0..12).map(|_| point(1.0)).collect();
            let count = 1 + turn % 40;
            let triangles: Vec<[u32; 3]> = (0..count as u32)
                .map(|at| [at * 5 % 12, (at * 5 + 1 + at % 3) % 12, (at * 5 + 5 + at % 2) % 12])
                .collect();
            let light = point([0.5, 3.0, 9.0][turn % 3]).extend(f64::from(turn % 4 != 0)) * (1.0 + (turn % 5) as f64);
            let (edges, around, casting) = caster(&world, &triangles, light);
            for meridians in Meridians::all(&[around], light) {
                bounded += 1;
                let crossed = meridians.crossed(&edges);
                for towards in (0..200).map(|_| point(1.0)) {
                    let (met, crossed) =
                        (met(&casting, light, towards), crossed_by(&meridians, &crossed, light, towards));
                    assert!(met <= crossed, "{turn}: {met} of {crossed}, light {light}, towards {towards}");
                    reached += usize::from(met > 0 && 2 * met >= crossed);
                }
            }
        }
        assert!(bounded > 600 && reached > 1500, "{bounded} {reached}");
    }

    /// However fine a mesh is, and wherever the light, its silhouette crosses a meridian a few times.
    #[test]
    fn fine_bodies_have_low_bounds() {
        let bodies =
            [shapes::torus(1.0, 0.4, 120, 80), shapes::sphere(1.0, 400, 300)].map(|made| made.expect("a body"));
        for mesh in &bodies {
            for light in [[0.0, 5.0, 1.0, 1.0], [1.7, 0.1, 0.2, 1.0], [-3.0, -4.0, 2.0, 1.0], [0.0, 1.0, 0.3, 0.0]] {
                let light = DVec4::from_array(light);
                let (edges, around, _) = caster(mesh.positions(), mesh.triangles(), light);
                let bound = bound(&edges, &[around], light).expect("a bound");
                assert!((1..40).contains(&bound), "{bound} of {} edges, {light}", edges.len());
            }
        }
    }

    /// Copies of a body one behind the other are met by one ray; side by side they are not.
    #[test]
    fn casters_add_up_where_they_share_a_meridian() {
        let mesh: Arc<Mesh> = Arc::new(shapes::sphere(0.4, 24, 12).expect("a sphere"));
        let light = DVec4::new(0.0, 40.0, 0.0, 1.0);
        let all = |place: &dyn Fn(f64) -> DVec3| {
            let copies = (0..60).map(|copy| {
                let world: Vec<DVec3> = mesh.positions().iter().map(|at| *at + place(f64::from(copy))).collect();
                caster(&world, mesh.triangles(), light)
            });
            let copies: Vec<_> = copies.collect();
            let edges: Vec<_> = copies.iter().flat_map(|copy| copy.0.clone()).collect();
            let boxes: Vec<AxisBox> = copies.iter().map(|copy| copy.1).collect();
            let casting: Vec<_> = copies.iter().flat_map(|copy| copy.2.clone()).collect();
            (bound(&edges, &boxes, light).expect("a bound"), casting)
        };
        let (stacked, casting) = all(&|copy| DVec3::new(5.0, -copy, 0.0));
        assert!((60..400).contains(&stacked), "{stacked}");
        let through = |copy: i32| met(&casting, light, DVec3::new(5.011, -f64::from(copy), 0.007));
        let most = (0..60).map(through).max().expect("rays");
        assert!((5..=stacked).contains(&most), "{most} of {stacked}");
        let (around, _) = all(&|copy| 5.0 * DVec3::new((copy / 9.5).sin(), 0.0, (copy / 9.5).cos()));
        assert!(around < 40, "{around}");
    }

    /// In a box that holds the light, no pole is free; nor is a bound known of what is not finite.
    #[test]
    fn nothing_is_said_where_no_pole_is_free() {
        let mesh = shapes::cuboid([1.0; 3]).expect("a box");
        let (edges, around, _) = caster(mesh.positions(), mesh.triangles(), DVec4::W);
        assert!(!is_within(edges.iter().copied(), &[around], DVec4::W, 255));
        let above = DVec4::new(0.0, 3.0, 0.0, 1.0);
        assert!(is_within(edges.iter().copied(), &[around], above, 255));
        for far in [f64::INFINITY, 1e200] {
            let endless = AxisBox { high: DVec3::splat(far), ..around };
            assert!(!is_within(edges.iter().copied(), &[endless], above, 255));
        }
    }

    /// An edge right over the axis may be crossed by all meridians; one beside it, by those on its side.
    #[test]
    fn a_span_goes_the_short_way_around() {
        let boxes = [AxisBox::around([DVec3::new(-1.0, -2.0, -1.0), DVec3::new(1.0, -1.0, 1.0)])];
        let around_up = |of: &Meridians| matches!(of, Meridians::Around { across: [2, 0], .. });
        let meridians = Meridians::all(&boxes, DVec4::W).find(around_up).expect("up is free");
        let span = |from: [f64; 2], to: [f64; 2]| {
            let [from, to] = [from, to].map(|[x, z]| DVec3::new(x, -1.0, z));
            meridians.span(from, to)
        };
        // The axes across up are z and x, in this order.
        assert_eq!(span([0.0, 1.0], [1.0, 0.0]), Span { from: 0.0, to: 0.25 });
        assert_eq!(span([1.0, 0.0], [0.0, 1.0]), Span { from: 0.0, to: 0.25 });
        assert_eq!(span([-0.5, 0.5], [0.5, 0.5]), Span { from: 0.875, to: 0.125 });
        assert_eq!(span([0.5, -0.5], [-0.5, -0.5]), Span { from: 0.375, to: 0.625 });
        assert_eq!(span([0.5, -0.5], [-0.5, 0.5]), Span::ALL);
        assert_eq!(span([0.0, 0.0], [0.5, 0.5]), Span::ALL);
    }
}
