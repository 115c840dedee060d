//! How a mesh is connected: what is open, torn, doubled, flipped or without area, and where.
//!
//! Nothing here is repaired; z-fail with all casters needs no repair. It is what a person wants to know of a model, and
//! what decides whether simpler ways would do.

use super::connectivity::{Connectivity, FoundPlaces, MOST_PLACES};
use crate::math::{Sign, side_of_line};
use crate::scene::Mesh;
use foldhash::fast::RandomState;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::fmt::{self, Display, Formatter};
use std::sync::Arc;

/// Distinct vertices nearer to each other than this, relative to the mesh's size, are suspected to be one vertex,
/// split.
const NEAR: f64 = 1e-6;

/// The defects of a mesh that matter for shadow volumes: connectivity, split vertices and degenerate triangles. Places
/// of triangles are their centroids.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Topology {
    /// Number of the mesh's triangles.
    pub triangles: usize,
    /// How its triangles are connected by their edges.
    pub connectivity: Arc<Connectivity>,
    /// Pairs of distinct vertices nearer to each other than a millionth of the mesh's size. Welding joins equal
    /// positions only, so these leave cracks.
    pub split_vertices: FoundPlaces,
    /// Triangles whose corners are collinear.
    pub flat_triangles: FoundPlaces,
    /// Number of triangles with two equal corners, which were left out on loading.
    pub dropped_triangles: usize,
}

impl Topology {
    /// Examines a mesh for split vertices and flat triangles (in object space); its connectivity and dropped triangles
    /// are taken over.
    pub fn new(mesh: &Mesh, connectivity: Arc<Connectivity>) -> Topology {
        let (positions, triangles) = (mesh.positions(), mesh.triangles());
        let mut topology = Topology {
            triangles: triangles.len(),
            connectivity,
            split_vertices: split_vertices(mesh),
            flat_triangles: FoundPlaces::default(),
            dropped_triangles: mesh.dropped_triangles(),
        };
        for corners in triangles {
            let corners = corners.map(|vertex| positions[vertex as usize]);
            if is_flat(corners) {
                topology.flat_triangles.add(corners.iter().sum::<DVec3>() / 3.0);
            }
        }
        topology
    }

    /// Returns whether every edge joins exactly two triangles ([`Connectivity::is_closed`]).
    pub fn is_closed(&self) -> bool {
        self.connectivity.is_closed()
    }

    /// Returns whether neighbouring triangles are wound alike ([`Connectivity::is_oriented`]).
    pub fn is_oriented(&self) -> bool {
        self.connectivity.is_oriented()
    }
}

/// One line: `960 triangles in 1 part, closed, consistently wound`.
impl Display for Topology {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let some = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
        write!(
            f,
            "{} in {}",
            some(self.triangles, "triangle", "triangles"),
            some(self.connectivity.components, "part", "parts")
        )?;
        if self.is_closed() {
            write!(f, ", closed")?;
        }
        if self.is_oriented() {
            write!(f, ", consistently wound")?;
        }
        for (found, one, many) in [
            (&self.connectivity.open_edges, "open edge", "open edges"),
            (
                &self.connectivity.non_manifold_edges,
                "edge of more than two triangles",
                "edges of more than two triangles",
            ),
            (&self.connectivity.inconsistent_edges, "edge wound both ways", "edges wound both ways"),
            (&self.split_vertices, "pair of split vertices", "pairs of split vertices"),
            (&self.flat_triangles, "triangle without area", "triangles without area"),
        ] {
            if found.count > 0 {
                write!(f, ", {}", some(found.count, one, many))?;
            }
        }
        if self.dropped_triangles > 0 {
            write!(f, ", {} with two equal corners left out", some(self.dropped_triangles, "triangle", "triangles"))?;
        }
        Ok(())
    }
}

/// Returns whether the corners are exactly collinear: the triangle has no area along any axis.
fn is_flat(corners: [DVec3; 3]) -> bool {
    let is_flat_along = |axis: usize| {
        let [a, b, c] = corners.map(|p| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]));
        side_of_line([a, b], c) == Sign::Zero
    };
    (0..3).all(is_flat_along)
}

/// Finds vertices that are nearer to an earlier one than [`NEAR`] times the mesh's size: counts pairs, in crowded
/// places not all of them. Finds none in a mesh without size.
fn split_vertices(mesh: &Mesh) -> FoundPlaces {
    let mut found = FoundPlaces::default();
    let Some((low, high)) = mesh.bounds() else { return found };
    let near = (high - low).length() * NEAR;
    if near.is_nan() || near <= 0.0 {
        return found;
    }
    let cell_of = |p: DVec3| ((p - low) / (2.0 * near)).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>, RandomState> = HashMap::default();
    cells.reserve(mesh.positions().len());
    for (index, &position) in mesh.positions().iter().enumerate() {
        // Of the cells within reach, mostly one.
        let (first, last) = (cell_of(position - near), cell_of(position + near));
        for x in first[0]..=last[0] {
            for y in first[1]..=last[1] {
                for z in first[2]..=last[2] {
                    let others = cells.get(&[x, y, z]).into_iter().flatten();
                    // A cell full of vertices is reported, not counted in full.
                    for other in others.take(MOST_PLACES) {
                        if mesh.positions()[*other as usize].distance(position) <= near {
                            found.add(position);
                        }
                    }
                }
            }
        }
        cells.entry(cell_of(position)).or_default().push(index as u32);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::EdgeList;
    use super::*;
    use crate::scene::MeshBuilder;

    fn topology(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Topology {
        let positions = positions.iter().map(|p| DVec3::from_array(*p)).collect();
        let builder = MeshBuilder { positions, triangles: triangles.to_vec(), ..MeshBuilder::default() };
        let mesh = builder.build().expect("a mesh");
        let edges = EdgeList::new(mesh.triangles(), mesh.positions().len());
        Topology::new(&mesh, Arc::new(Connectivity::new(&mesh, &edges)))
    }

    const CORNERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_is_closed_and_one_with_a_hole_is_not() {
        let whole = topology(&CORNERS, &TETRAHEDRON);
        assert_eq!(whole.to_string(), "4 triangles in 1 part, closed, consistently wound");
        let open = topology(&CORNERS, &TETRAHEDRON[..3]);
        assert_eq!(open.connectivity.open_edges.count, 3);
        assert!(open.connectivity.open_edges.places.contains(&DVec3::new(0.0, 0.5, 0.5)));
        assert_eq!(open.to_string(), "3 triangles in 1 part, consistently wound, 3 open edges");
    }

    #[test]
    fn turned_doubled_flat_and_split_are_distinguished() {
        let mut flipped = TETRAHEDRON;
        flipped[0].swap(0, 1);
        assert_eq!(topology(&CORNERS, &flipped).connectivity.inconsistent_edges.count, 3);
        let doubled = topology(&CORNERS, &[TETRAHEDRON.to_vec(), vec![TETRAHEDRON[0]]].concat());
        assert_eq!((doubled.connectivity.non_manifold_edges.count, doubled.is_closed()), (3, false));
        let flat = topology(&[[0.0; 3], [0.25; 3], [0.5; 3]], &[[0, 1, 2], [0, 1, 1]]);
        assert_eq!((flat.flat_triangles.count, flat.dropped_triangles), (1, 1));
        let split = topology(
            &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1e-7, 0.0], [0.0, 1.0 - 1e-7, 0.0], [1.0, 1.0, 0.0]],
            &[[0, 1, 2], [3, 5, 4]],
        );
        assert_eq!((split.split_vertices.count, split.connectivity.components), (2, 2));
    }
}
