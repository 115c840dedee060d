//! Proof that the triangles that face a light cast the shadow of the whole mesh.
//!
//! They do where the mesh bounds solids with their outside out: closed, consistently wound, with a
//! winding number that is nowhere negative, and the light where it is 0. The winding number is
//! constant on either side of a connected surface that does not meet itself, and every region of
//! space borders on some component; so one look at either side of one triangle a component
//! settles it. All of it is decided by exact signs of world positions, so that a mirrored pose or
//! its rounding can't deceive; what can't be decided counts as not proven.

use super::connectivity::Connectivity;
use super::intersection::self_meeting;
use super::winding::{crossings, winding_number};
use crate::math::{AxisBox, Sign, side_of_triangle};
use glam::{DVec3, DVec4};

/// The most work that is done: components times triangles.
const MOST_WORK: usize = 200_000_000;
/// How often the points beside a triangle are moved closer to it before giving up.
const TRIES: i32 = 4;

/// Returns in words how many edges are of one triangle, and how many of more than two.
fn not_two(open: usize, non_manifold: usize) -> String {
    let edges = |count: usize, open: &str| format!("{count} {open}edge{}", if count == 1 { "" } else { "s" });
    match (open, non_manifold) {
        (0, many) => format!("{} of more than two triangles", edges(many, "")),
        (one, 0) => edges(one, "open "),
        (one, many) => format!("{}, {many} of more than two triangles", edges(one, "open ")),
    }
}

/// Why a mesh is not proven to bound solids with their outside out. The fix is `casters = all`, which needs no proof.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotSolid {
    /// Edges of one triangle or more than two.
    #[error("it is not closed: {}", not_two(*open, *non_manifold))]
    NotClosed {
        /// Edges of one triangle.
        open: usize,
        /// Edges of more than two.
        non_manifold: usize,
    },
    /// Neighbours disagree on which side is out.
    #[error("its triangles are wound inconsistently along {edges} edges")]
    NotOriented {
        /// How many edges are wound inconsistently.
        edges: usize,
    },
    /// These two triangles intersect, or are not proven not to.
    #[error("it meets itself, as at triangles {0} and {1}")]
    MeetsItself(usize, usize),
    /// The winding number beside a component is negative: it is inside out.
    #[error("part {component} is inside out: the winding number beside it is {winding}")]
    InsideOut {
        /// Counted from 0.
        component: usize,
        /// The winding number, less than 0.
        winding: i32,
    },
    /// The winding number beside a component could not be determined.
    #[error("no look at part {component} could be decided")]
    Undecided {
        /// Counted from 0.
        component: usize,
    },
    /// Components times triangles are too many to examine.
    #[error("{components} parts of {triangles} triangles are too many to look at")]
    TooMany {
        /// Number of components.
        components: usize,
        /// Number of the mesh's triangles.
        triangles: usize,
    },
}

/// Proves that a mesh with vertices `world` bounds solids with their outside out: closed, consistently wound, not
/// intersecting itself, and no component inside out.
///
/// # Errors
/// What speaks against it, or is not proven.
pub fn check(world: &[DVec3], triangles: &[[u32; 3]], connectivity: &Connectivity) -> Result<(), NotSolid> {
    check_connectivity(triangles.len(), connectivity)?;
    if let Some([one, other]) = self_meeting(world, triangles) {
        return Err(NotSolid::MeetsItself(one, other));
    }
    check_windings(world, triangles, connectivity)
}

/// Checks what does not depend on where the mesh is: that it is closed, consistently wound, and not too large to examine.
///
/// # Errors
/// What speaks against it.
pub fn check_connectivity(triangles: usize, connectivity: &Connectivity) -> Result<(), NotSolid> {
    if !connectivity.is_closed() {
        let (open, non_manifold) = (connectivity.open_edges.count, connectivity.non_manifold_edges.count);
        return Err(NotSolid::NotClosed { open, non_manifold });
    }
    if !connectivity.is_oriented() {
        return Err(NotSolid::NotOriented { edges: connectivity.inconsistent_edges.count });
    }
    if connectivity.components.saturating_mul(triangles) > MOST_WORK {
        return Err(NotSolid::TooMany { components: connectivity.components, triangles });
    }
    Ok(())
}

/// Checks that no component of a mesh that passes all other checks is inside out.
///
/// # Errors
/// The first component that is, or may be.
pub fn check_windings(world: &[DVec3], triangles: &[[u32; 3]], connectivity: &Connectivity) -> Result<(), NotSolid> {
    let beside = windings(world, triangles, connectivity);
    beside.into_iter().enumerate().try_for_each(|(component, sides)| check_winding(component, sides))
}

/// Checks one component by the winding numbers on its two sides.
pub(super) fn check_winding(component: usize, sides: Option<[i32; 2]>) -> Result<(), NotSolid> {
    let winding = sides.ok_or(NotSolid::Undecided { component })?.into_iter().fold(0, i32::min);
    if winding < 0 { Err(NotSolid::InsideOut { component, winding }) } else { Ok(()) }
}

/// Returns the winding numbers on both sides of each component, seen beside its largest triangle; `None` for those where
/// no look could be decided.
pub(super) fn windings(world: &[DVec3], triangles: &[[u32; 3]], connectivity: &Connectivity) -> Vec<Option<[i32; 2]>> {
    let mut largest: Vec<Option<(f64, usize)>> = vec![None; connectivity.components];
    for (triangle, corners) in triangles.iter().enumerate() {
        let area = normal(corners.map(|vertex| world[vertex as usize])).length_squared();
        let best = &mut largest[connectivity.component_of(triangle)];
        if best.is_none_or(|(known, _)| area > known) {
            *best = Some((area, triangle));
        }
    }
    let beside = |(_, triangle): (f64, usize)| windings_beside(world, triangles, triangle);
    largest.into_iter().map(|largest| largest.and_then(beside)).collect()
}

/// Returns whether a light is outside a closed mesh (its winding number there is 0), exactly: false where it is or may
/// be on the surface, always true for a directional light.
pub fn light_is_outside(world: &[DVec3], triangles: &[[u32; 3]], light: DVec4) -> bool {
    let is_beyond = || !AxisBox::around(world.iter().copied()).holds(light.truncate() / light.w);
    light.w == 0.0 || is_beyond() || winding_number(world, triangles, light.truncate()) == Some(0)
}

/// Returns the winding numbers on both sides of a triangle, at points so near to it that the line between them crosses
/// no other triangle; `None` where no such points were found.
fn windings_beside(world: &[DVec3], triangles: &[[u32; 3]], triangle: usize) -> Option<[i32; 2]> {
    let corners = |triangle: usize| triangles[triangle].map(|vertex| world[vertex as usize]);
    let [a, b, c] = corners(triangle);
    let normal = normal([a, b, c]).abs();
    let axis = (0..3).max_by(|i, j| normal[*i].total_cmp(&normal[*j]))?;
    let middle = (a + b + c) / 3.0;
    let size = (b - a).length().max((c - a).length());
    (0..TRIES).find_map(|attempt| {
        let mut points = [middle; 2];
        let step = size * 1e-3f64.powi(attempt + 1);
        points[0][axis] -= step;
        points[1][axis] += step;
        let hits = crossings(world, triangles, middle, axis);
        let side = |of: usize, point: DVec3| side_of_triangle(corners(of), point.extend(1.0));
        let between = hits.iter().filter(|hit| side(hit.triangle, points[0]) != side(hit.triangle, points[1]));
        let is_alone = between.map(|hit| hit.triangle).eq([triangle]);
        let is_clear = hits.iter().all(|hit| points.iter().all(|point| side(hit.triangle, *point) != Sign::Zero));
        (is_alone && is_clear).then(|| {
            points.map(|point| {
                let ahead = hits.iter().filter(|hit| side(hit.triangle, point).value() == -hit.direction);
                ahead.map(|hit| hit.direction).sum()
            })
        })
    })
}

fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::super::EdgeList;
    use super::*;
    use crate::scene::Mesh;
    use crate::scene::shapes;

    fn checked(mesh: &Mesh, place: impl Fn(DVec3) -> DVec3) -> Result<(), NotSolid> {
        let world: Vec<DVec3> = mesh.positions().iter().map(|p| place(*p)).collect();
        let edges = EdgeList::new(mesh.triangles(), world.len());
        check(&world, mesh.triangles(), &Connectivity::new(mesh, &edges))
    }

    /// Spheres of the given radii around one point, those with a negative radius inside out.
    fn shells(radii: &[f64]) -> Mesh {
        let mut builder = crate::scene::MeshBuilder::default();
        for radius in radii {
            let sphere = shapes::sphere(1.0, 16, 8).expect("a sphere");
            let first = builder.positions.len() as u32;
            builder.positions.extend(sphere.positions().iter().map(|p| *p * radius.abs()));
            let oriented = |&[a, b, c]: &[u32; 3]| if *radius < 0.0 { [a, c, b] } else { [a, b, c] };
            let triangles = sphere.triangles().iter().map(|corners| oriented(corners).map(|v| v + first));
            builder.triangles.extend(triangles);
        }
        builder.build().expect("a mesh")
    }

    #[test]
    fn solids_are_proven_and_inside_out_ones_are_not() {
        let stay = |p: DVec3| p;
        for radii in [&[1.0][..], &[1.0, 2.0], &[3.0, -2.0], &[3.0, -2.0, 1.0], &[3.0, 2.0, -1.0]] {
            assert_eq!(checked(&shells(radii), stay), Ok(()), "{radii:?}");
        }
        assert_eq!(checked(&shells(&[-1.0]), stay), Err(NotSolid::InsideOut { component: 0, winding: -1 }));
        assert!(matches!(checked(&shells(&[1.0, -2.0]), stay), Err(NotSolid::InsideOut { .. })));
        assert!(matches!(checked(&shells(&[3.0, -2.0, -1.0]), stay), Err(NotSolid::InsideOut { component: 2, .. })));
        assert!(matches!(checked(&shells(&[1.0, 1.01]), |p| p * DVec3::new(1.0, 2.0, 0.5)), Ok(())));
    }

    #[test]
    fn mirroring_turns_a_solid_inside_out() {
        let mirror = |p: DVec3| p * DVec3::new(-1.0, 1.0, 1.0);
        assert!(matches!(checked(&shells(&[1.0]), mirror), Err(NotSolid::InsideOut { .. })));
        assert_eq!(checked(&shells(&[-1.0]), mirror), Ok(()));
    }

    #[test]
    fn what_meets_itself_is_not_proven() {
        let mut two = shells(&[1.0]);
        assert_eq!(checked(&two, |p| p), Ok(()));
        let moved: Vec<DVec3> = two.positions().iter().map(|p| *p + DVec3::new(0.7, 0.1, 0.2)).collect();
        let first = two.positions().len() as u32;
        let builder = crate::scene::MeshBuilder {
            positions: [two.positions(), &moved].concat(),
            triangles: [two.triangles().to_vec(), two.triangles().iter().map(|t| t.map(|v| v + first)).collect()]
                .concat(),
            ..Default::default()
        };
        two = builder.build().expect("a mesh");
        assert!(matches!(checked(&two, |p| p), Err(NotSolid::MeetsItself(..))));
    }

    #[test]
    fn a_light_is_inside_or_outside_and_the_sun_is_always_outside() {
        let mesh = shells(&[1.0]);
        let outside = |light: DVec4| light_is_outside(mesh.positions(), mesh.triangles(), light);
        assert!(outside(DVec4::new(0.0, 3.0, 0.0, 1.0)) && outside(DVec4::new(0.0, 1.0, 0.0, 0.0)));
        assert!(!outside(DVec4::new(0.0, 0.0, 0.0, 1.0)));
        assert!(!outside(mesh.positions()[0].extend(1.0)), "on the surface is not proven outside");
    }
}
