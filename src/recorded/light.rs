//! The position of a light, from the shadow volumes that are counted for it.
//!
//! Every edge of a side that runs from a caster's corner to that corner carried away lies on a line through the light.
//! Other edges of the volume, diagonals of its sides and silhouettes, lie anywhere. So edges vote: two of them
//! intersect near a point, and the point that most edges point away from is the light; where most run the same way, it
//! is a direction. The winner is fitted by least squares over its voters, repeatedly with a smaller limit for voting.

use super::corners::{KnownCorners, is_same_place};
use super::{FoundLight, LightEvidence};
use glam::{DMat3, DVec3, DVec4};
use std::collections::BTreeMap;

/// Limit on the silhouette edges that are used to find a light.
const MOST_EDGES: usize = 2000;
/// The number of pairs of edges that are tried.
const TRIES: usize = 3000;
/// How far an edge may point past the light and vote for it: the sine of the angle.
const REACH: f64 = 1e-3;
/// The limits of the fits that follow: sines of the angle.
const FINER: [f64; 3] = [1e-3, 2e-4, 5e-5];
/// A light is found if at least this many edges agree, and at least this part of all edges.
pub(super) const LEAST_EDGES: usize = 6;
const LEAST_SHARE: f64 = 0.1;

/// The same of edges that begin at a caster's corner and end elsewhere.
const LEAST_EDGES_OF_CASTER: usize = 3;
const LEAST_SHARE_OF_CASTER: f64 = 1.0 / 3.0;

/// The part of the edges, the longest, that vote where too few of all agree; then this part of them must.
const LONGEST: usize = 5;
const LEAST_SHARE_OF_LONGEST: f64 = 0.25;

/// An edge of a volume, as a line.
#[derive(Debug, Clone, Copy)]
struct EdgeLine {
    from: DVec3,
    /// Direction, of unit length.
    along: DVec3,
    /// Distance between its ends; infinite where one is at infinity.
    length: f64,
    /// True where it is known to begin at the caster.
    is_directed: bool,
}

impl EdgeLine {
    /// Returns the other end; not finite where it is at infinity.
    fn to(&self) -> DVec3 {
        self.from + self.along * self.length
    }

    /// Returns the line as it begins at the one of its ends that is a corner of surfaces, `None` where both are or neither is.
    fn beginning_at_corner(self, corners: &KnownCorners) -> Option<EdgeLine> {
        let is_corner = |end: DVec3| end.is_finite() && corners.is_corner(end);
        match [self.from, self.to()].map(is_corner) {
            [true, false] => Some(EdgeLine { is_directed: true, ..self }),
            [false, true] => Some(EdgeLine { from: self.to(), along: -self.along, is_directed: true, ..self }),
            _ => None,
        }
    }
}

/// Finds the position of a light from the edges of triangles of its volumes, places in view space: a share of them must run
/// away from one point or in one direction; `None` where too few agree. Where caps of many triangles outvote the sides, the
/// longest edges are asked alone, then the longest of those: sides reach farther than their caster is large.
///
/// The sides of volumes that end somewhere run both ways along a direction. It comes from where their casters are, which
/// have `corners`.
pub(super) fn light_of(triangles: &[[DVec4; 3]], corners: &KnownCorners) -> Option<FoundLight> {
    let lines = lines(triangles);
    found_by_longest(lines.clone()).and_then(|found| from_casters(&lines, found, corners))
}

/// Returns the light, a direction on the side of its casters; `None` where that is not known.
fn from_casters(lines: &[EdgeLine], found: FoundLight, corners: &KnownCorners) -> Option<FoundLight> {
    if found.position.w != 0.0 {
        return Some(found);
    }
    let position = away_from_casters(lines, found.position, corners)?;
    Some(FoundLight { position, ..found })
}

/// Finds the position of a light as [`light_of`] does, of the volumes of one caster, which begin at `corners`: of edges that
/// begin at one and end elsewhere half are diagonals, so that few are enough.
pub(super) fn light_of_caster(triangles: &[[DVec4; 3]], corners: &KnownCorners) -> Option<FoundLight> {
    let lines: Vec<EdgeLine> =
        lines(triangles).into_iter().filter_map(|line| line.beginning_at_corner(corners)).collect();
    let found = found_by(thinned(&lines), LEAST_SHARE_OF_CASTER, LEAST_EDGES_OF_CASTER);
    found.and_then(|found| from_casters(&lines, found, corners)).or_else(|| light_of(triangles, corners))
}

/// Finds the position of a light as [`light_of`] does, of the volume of a caster that is not known. The sides of one that ends
/// somewhere run both ways along a direction: it is the one on whose side all other lights are, points left out; `None` where
/// they are not, or there is none.
pub(super) fn light_of_unseen(
    triangles: &[[DVec4; 3]],
    corners: &KnownCorners,
    others: &[FoundLight],
) -> Option<FoundLight> {
    let lines = lines(triangles);
    let found = found_by_longest(lines.clone())?;
    let on_one_side = |found: FoundLight| {
        let mut directions = others.iter().map(|other| other.position).filter(|other| other.w == 0.0).peekable();
        directions.peek()?;
        directions.all(|other| other.dot(found.position) > 0.0).then_some(found)
    };
    let opposite = FoundLight { position: (-found.position.truncate()).extend(0.0), ..found };
    from_casters(&lines, found, corners).or_else(|| on_one_side(found)).or_else(|| on_one_side(opposite))
}

/// The edges of volumes that may run away from a light, of each triangle by itself.
pub(super) struct TriangleEdges(Vec<Vec<EdgeLine>>);

impl TriangleEdges {
    /// Returns the edges of triangles, places in view space, of casters that have `corners`.
    pub fn of(triangles: &[[DVec4; 3]], corners: &KnownCorners) -> TriangleEdges {
        let directed = |line: EdgeLine| line.beginning_at_corner(corners).unwrap_or(line);
        let lines = |triangle| lines(std::slice::from_ref(triangle)).into_iter().map(directed).collect();
        TriangleEdges(triangles.iter().map(lines).collect())
    }

    /// Returns how many of the triangles have an edge that runs along the line through a light.
    pub fn along(&self, light: DVec4) -> usize {
        self.0.iter().filter(|lines| voters(lines, light, REACH).next().is_some()).count()
    }

    /// Returns both ends of the edges along the lines through a light, where they are not at infinity.
    pub fn ends(&self, light: DVec4) -> Vec<DVec3> {
        let lines = self.0.iter().flat_map(|lines| voters(lines, light, REACH));
        lines.flat_map(|line| [line.from, line.to()]).filter(|end| end.is_finite()).collect()
    }
}

/// Returns the direction or its opposite: the one at whose ends of the lines along it most corners of surfaces are. `None`
/// where neither has more. Lines that run to infinity all run away from the light.
fn away_from_casters(lines: &[EdgeLine], towards: DVec4, corners: &KnownCorners) -> Option<DVec4> {
    let mut excess = 0;
    for line in voters(lines, towards, REACH) {
        if line.length.is_infinite() {
            return Some(towards);
        }
        let ends = [line.from, line.to()].map(|end| i64::from(corners.is_corner(end)));
        let runs_away = line.along.dot(towards.truncate()) < 0.0;
        excess += if runs_away { ends[0] - ends[1] } else { ends[1] - ends[0] };
    }
    (excess != 0).then(|| if excess > 0 { towards } else { (-towards.truncate()).extend(0.0) })
}

fn found_by_longest(mut lines: Vec<EdgeLine>) -> Option<FoundLight> {
    let mut least = LEAST_SHARE;
    loop {
        if let Some(found) = found_by(thinned(&lines), least, LEAST_EDGES) {
            return Some(found);
        }
        least = LEAST_SHARE_OF_LONGEST;
        let longest = lines.len() / LONGEST;
        if (longest as f64) * least < LEAST_EDGES as f64 {
            return None;
        }
        lines.sort_by(|a, b| b.length.total_cmp(&a.length));
        lines.truncate(longest);
    }
}

/// Returns the position from which or in whose direction most of the lines run; `None` where fewer agree than
/// `least_edges`, or than the share `least` of them.
fn found_by(lines: Vec<EdgeLine>, least: f64, least_edges: usize) -> Option<FoundLight> {
    let best = candidates(&lines).into_iter().max_by_key(|position| voters(&lines, *position, REACH).count())?;
    let mut position = best;
    for reach in FINER {
        let fine = voters(&lines, position, reach).collect::<Vec<_>>();
        position = fitted(&fine, position).unwrap_or(position);
    }
    let agree = voters(&lines, position, REACH).count();
    let is_found = agree >= least_edges && agree as f64 >= least * lines.len() as f64;
    is_found.then_some(FoundLight { position, evidence: LightEvidence::Edges { agree, of: lines.len() } })
}

/// Returns the edges of volumes that may run away from a light: those to infinity where there are any, else all finite
/// edges, each once.
fn lines(triangles: &[[DVec4; 3]]) -> Vec<EdgeLine> {
    let (mut infinite, mut finite) = (Vec::new(), BTreeMap::new());
    for corners in triangles {
        for index in 0..3 {
            let (from, to) = (corners[index], corners[(index + 1) % 3]);
            let (from, to) = if from.w == 0.0 { (to, from) } else { (from, to) };
            let between = to.truncate() - from.truncate() * to.w;
            let Some(along) = between.try_normalize().filter(|_| from.w != 0.0) else { continue };
            let length = if to.w == 0.0 { f64::INFINITY } else { between.length() };
            let line = EdgeLine { from: from.truncate(), along, length, is_directed: false };
            if to.w == 0.0 {
                infinite.push(line);
            } else {
                // Two triangles share an edge.
                let ends = [from, to].map(|end| end.to_array().map(f64::to_bits));
                finite.insert((ends[0].min(ends[1]), ends[0].max(ends[1])), line);
            }
        }
    }
    if infinite.is_empty() { finite.into_values().collect() } else { infinite }
}

/// Returns every n-th line, so that at most the limit is left; all where they are not more.
fn thinned(lines: &[EdgeLine]) -> Vec<EdgeLine> {
    let step = lines.len().div_ceil(MOST_EDGES).max(1);
    lines.iter().copied().step_by(step).collect()
}

/// Returns homogeneous positions where the light may be: for pairs of lines the point where they come nearest to each other;
/// for parallel ones the direction against the first. Empty for fewer than two lines.
fn candidates(lines: &[EdgeLine]) -> Vec<DVec4> {
    let candidate = |[first, second]: [usize; 2]| {
        let (a, b) = (lines[first], lines[second]);
        let across = a.along.cross(b.along);
        // An edge that runs away from the light runs opposite to the direction towards it.
        if across.length() < REACH {
            return Some((-a.along).extend(0.0));
        }
        let system = DMat3::from_cols(a.along, -b.along, across);
        let shares = system.inverse() * (b.from - a.from);
        let point = a.from + a.along * shares.x;
        point.is_finite().then(|| point.extend(1.0))
    };
    pairs(lines.len()).into_iter().filter_map(candidate).collect()
}

/// Returns pairs of as many lines: all where they are few, else some, the same in every run.
fn pairs(count: usize) -> Vec<[usize; 2]> {
    if count * count <= TRIES {
        return (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second])).collect();
    }
    // Steps that have no common pattern with how meshes list their edges.
    let (mut first, mut second) = (0, 0);
    let mut next = || {
        first = (first + 7919) % count;
        second = (second + 104_729 + first) % count;
        [first, second]
    };
    (0..TRIES).map(|_| next()).collect()
}

/// Returns the lines that run along the line through the light at `position`, within the angle `reach` (radians, as a
/// sine). Directed ones must run away, as must those to infinity from a directional light; all others may run either way. None
/// that ends at the light votes: all edges of a corner run away from it.
fn voters(lines: &[EdgeLine], position: DVec4, reach: f64) -> impl Iterator<Item = EdgeLine> + '_ {
    let is_at_light = move |end: DVec3| position.w != 0.0 && is_same_place(end, position.truncate() / position.w);
    lines.iter().copied().filter(move |line| {
        if is_at_light(line.from) || is_at_light(line.to()) {
            return false;
        }
        let away = (line.from * position.w - position.truncate()).normalize_or_zero();
        let may_run_towards = !line.is_directed && (position.w != 0.0 || line.length.is_finite());
        line.along.cross(away).length() < reach && (may_run_towards || line.along.dot(away) > 0.0)
    })
}

/// Returns the point nearest to all lines where `position` is a point, else the direction opposite to their mean;
/// `None` with too few lines for a point, or where it is not finite.
fn fitted(lines: &[EdgeLine], position: DVec4) -> Option<DVec4> {
    if position.w == 0.0 {
        let against =
            |line: &EdgeLine| if line.along.dot(position.truncate()) > 0.0 { line.along } else { -line.along };
        let towards = lines.iter().map(against).sum::<DVec3>();
        return towards.try_normalize().map(|towards| towards.extend(0.0));
    }
    let mut system = DMat3::ZERO;
    let mut right = DVec3::ZERO;
    for line in lines {
        // Errors are angles: a line that is far away determines the position less.
        let weight = 1.0 / (line.from - position.truncate()).length_squared().max(f64::MIN_POSITIVE);
        let across = DMat3::IDENTITY
            - DMat3::from_cols(line.along * line.along.x, line.along * line.along.y, line.along * line.along.z);
        system += across * weight;
        right += across * line.from * weight;
    }
    let point = system.inverse() * right;
    (lines.len() >= LEAST_EDGES && point.is_finite()).then(|| point.extend(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: [f64; 3], along: [f64; 3]) -> EdgeLine {
        let along = DVec3::from_array(along);
        EdgeLine { from: DVec3::from_array(from), along: along.normalize(), length: along.length(), is_directed: false }
    }

    #[test]
    fn lines_that_meet_find_their_point_among_others_that_do_not() {
        let light = DVec3::new(3.0, 5.0, -7.0);
        let corner = |index: usize| {
            let at = index as f64;
            DVec3::new((at * 1.7).sin() * 4.0, (at * 0.9).cos() * 2.0 - 3.0, -10.0 - (at * 2.3).sin() * 5.0)
        };
        let mut lines: Vec<EdgeLine> =
            (0..40).map(|index| line(corner(index).to_array(), (corner(index) - light).to_array())).collect();
        lines.extend((0..60).map(|index| line(corner(index).to_array(), corner(index * 3 + 1).to_array())));
        let best = candidates(&lines).into_iter().max_by_key(|one| voters(&lines, *one, REACH).count());
        let fine: Vec<EdgeLine> = voters(&lines, best.expect("one"), REACH).collect();
        let found = fitted(&fine, best.expect("one")).expect("a light");
        assert!((found.truncate() - light).length() < 1e-6 && found.w == 1.0, "{found}");
    }

    #[test]
    fn sides_are_found_among_many_more_edges_of_caps() {
        let light = DVec3::new(3.0, 5.0, -7.0);
        let corner = |index: usize| {
            let at = index as f64;
            DVec3::new((at * 1.7).sin() * 4.0, (at * 0.9).cos() * 2.0 - 3.0, -10.0 - (at * 2.3).sin() * 5.0)
        };
        let towards = |index: usize| corner(index * 3 + 1) - corner(index);
        let mut lines: Vec<EdgeLine> =
            (0..1800).map(|index| line(corner(index).to_array(), towards(index).to_array())).collect();
        lines.extend((0..110).map(|index| {
            let away = (corner(index) - light) * 100.0;
            line(corner(index).to_array(), away.to_array())
        }));
        assert!(found_by(thinned(&lines), LEAST_SHARE, LEAST_EDGES).is_none());
        let found = found_by_longest(lines).expect("a light");
        assert!((found.position.truncate() - light).length() < 1e-6, "{found:?}");
        assert!(matches!(found.evidence, LightEvidence::Edges { of: 382, .. }), "{:?}", found.evidence);
    }

    #[test]
    fn lines_that_run_the_same_way_find_a_direction_towards_the_light() {
        let along = DVec3::new(-1.0, -3.0, 0.5);
        let mut lines: Vec<EdgeLine> =
            (0..30).map(|index| line([f64::from(index), 0.0, -9.0], along.to_array())).collect();
        lines.extend((0..20).map(|index| line([f64::from(index), 1.0, -5.0], [1.0, f64::from(index), 0.3])));
        let best = candidates(&lines).into_iter().max_by_key(|one| voters(&lines, *one, REACH).count()).expect("one");
        assert!((best - (-along.normalize()).extend(0.0)).length() < 1e-9, "{best}");
    }
}
