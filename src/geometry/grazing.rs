//! Which sides graze the surface that casts them.
//!
//! Where the light grazes a triangle, the sides of its edges run so close behind it that single precision can no longer
//! decide which of them is in front. Such sides are drawn a little behind their place; others are not, since that moves
//! the edges of shadows on whatever else the light grazes.

use super::{Caster, Edge, EdgeList, SilhouetteEdge};
use glam::DVec4;
use rayon::prelude::*;

/// A light grazes a triangle where the sine of its angle to the plane is at most this, about a tenth of a degree:
/// beyond it, what is within rounding of a side is within a tenth of a pixel of the edge.
const GRAZING: f64 = 0.002;

/// The sine below which single precision may take the light to be on a triangle's other side.
const EDGE_ON: f64 = 1e-6;

/// How many edges or triangles one thread looks at, at least.
const SHARE: usize = 8 * 1024;

/// Moves the silhouette edges at which some triangle of `caster` is grazed by the light to the end, keeping the order
/// otherwise; returns how many there are. `edges` is only a faster way to find the triangles.
pub fn move_grazing_last(
    silhouette: &mut [SilhouetteEdge],
    caster: Caster,
    light: DVec4,
    edges: Option<&EdgeList>,
) -> usize {
    let triangles = caster.mesh.triangles();
    let is_grazed = |corners: &[u32; 3]| is_grazed(caster, *corners, light, GRAZING);
    let grazes: Box<dyn Fn(Edge) -> bool + Sync> = match edges {
        Some(edges) => Box::new(move |edge| {
            let index = edges.edges().binary_search(&edge);
            index.is_ok_and(|index| edges.incident(index).any(|(triangle, _)| is_grazed(&triangles[triangle])))
        }),
        None => {
            let mut grazed: Vec<Edge> =
                triangles.iter().filter(|corners| is_grazed(corners)).flat_map(edges_of).collect();
            grazed.sort_unstable();
            Box::new(move |edge| grazed.binary_search(&edge).is_ok())
        }
    };
    let grazed: Vec<bool> = silhouette.par_iter().with_min_len(SHARE).map(|edge| grazes(edge.edge)).collect();
    let of = |is_grazed: bool| silhouette.iter().zip(&grazed).filter(move |(_, of)| **of == is_grazed);
    let mut ordered: Vec<SilhouetteEdge> = of(false).map(|(edge, _)| *edge).collect();
    let others = ordered.len();
    ordered.extend(of(true).map(|(edge, _)| *edge));
    silhouette.copy_from_slice(&ordered);
    silhouette.len() - others
}

/// Returns whether the light lies so nearly in the plane of some triangle that single precision can't decide its side.
pub fn has_edge_on(caster: Caster, light: DVec4) -> bool {
    let triangles = caster.mesh.triangles().par_iter().with_min_len(SHARE);
    triangles.any(|corners| is_grazed(caster, *corners, light, EDGE_ON))
}

fn is_grazed(caster: Caster, corners: [u32; 3], light: DVec4, sine: f64) -> bool {
    let [a, b, c] = corners.map(|corner| caster.world[corner as usize]);
    let normal = (b - a).cross(c - a);
    let to_light = light.truncate() - a * light.w;
    normal.dot(to_light).abs() <= sine * normal.length() * to_light.length()
}

fn edges_of(&[a, b, c]: &[u32; 3]) -> [Edge; 3] {
    [[a, b], [b, c], [c, a]].map(|[from, to]| Edge { low: from.min(to), high: from.max(to) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{CasterPlanes, Casters, Facings, silhouette};
    use crate::scene::{MeshBuilder, Pose};
    use glam::DVec3;

    /// A level square, and a triangle that stands on one of its edges.
    #[test]
    fn sides_along_a_grazed_triangle_graze_it() {
        let positions =
            vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.0, -1.0), DVec3::NEG_Z, DVec3::new(0.5, 1.0, 0.0)];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 1, 4]];
        let mesh = MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().expect("a mesh");
        let caster = Caster { mesh: &mesh, pose: &Pose::default(), world: mesh.positions() };
        let edges = EdgeList::new(mesh.triangles(), 5);
        let grazing = |light: DVec4| {
            let (mut facings, mut found) = (Facings::default(), Vec::new());
            CasterPlanes::new(caster.world, mesh.triangles()).facings(
                caster.world,
                mesh.triangles(),
                light,
                &mut facings,
            );
            facings.keep_casting(Casters::All);
            silhouette(&edges, &facings, &mut found);
            let (mut by_search, all) = (found.clone(), found.len());
            let count = move_grazing_last(&mut found, caster, light, Some(&edges));
            assert_eq!(move_grazing_last(&mut by_search, caster, light, None), count);
            assert_eq!(by_search, found);
            let names: Vec<[u32; 2]> = found[all - count..].iter().map(|of| [of.edge.low, of.edge.high]).collect();
            names
        };
        // The square's edges but the one it shares: that one goes on in the standing triangle, or bounds both.
        let low_sun = grazing(DVec4::new(0.3, 1e-4, 1.0, 0.0));
        assert!([[0, 3], [1, 2], [2, 3]].iter().all(|edge| low_sun.contains(edge)), "{low_sun:?}");
        assert!(!low_sun.contains(&[0, 4]) && !low_sun.contains(&[1, 4]), "{low_sun:?}");
        assert_eq!(grazing(DVec4::new(0.3, 0.01, 1.0, 0.0)), [[0; 2]; 0]);
        let low_lamp = grazing(DVec4::new(0.5, 0.001, 9.0, 1.0));
        assert!([[0, 3], [1, 2], [2, 3]].iter().all(|edge| low_lamp.contains(edge)), "{low_lamp:?}");
    }
}
