//! What shadow-volume geometry costs on the CPU.

use crate::geometry::{
    CapFan, CasterPlanes, Casters, EdgeList, Extruder, Extrusion, Facings, FarEnd, silhouette, write_indices,
};
use crate::math::angle;
use crate::plan::Blob;
use crate::scene::Mesh;
use glam::{DVec3, DVec4};
use std::hint::black_box;
use std::time::Duration;
use web_time::Instant;

/// Distance of the lights from the mesh, in distances of its farthest corner from the origin.
const LIGHT_DISTANCE: f64 = 4.0;

/// Times of building what a mesh needs once, and of a volume for a light never seen before: sides and both caps of
/// every triangle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VolumeCost {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Edges of the mesh.
    pub edges: usize,
    /// Edges of the last light's volume that have sides.
    pub silhouette_edges: usize,
    /// Triangles of the last light's volume.
    pub volume_triangles: usize,
    /// Once a mesh: the edge list.
    pub edge_list: Vec<Duration>,
    /// Once a mesh and place: the planes.
    pub planes: Vec<Duration>,
    /// For each light: the exact facing of every triangle.
    pub facing: Vec<Duration>,
    /// For each light: every edge's multiplicity, storing those that are not 0.
    pub multiplicities: Vec<Duration>,
    /// For each light: indices of sides and caps, into a buffer that is reused.
    pub indices: Vec<Duration>,
    /// Facing, multiplicities and indices together.
    pub new_light: Vec<Duration>,
    /// Not part of it: what a plan adds, hashing and sharing the indices.
    pub hashing: Vec<Duration>,
}

/// Times each step of building shadow volumes `runs` times after a warm-up, each time for another light, the steps that
/// need no light fewer times; it takes no GPU.
pub fn volume_cost(mesh: &Mesh, runs: usize) -> VolumeCost {
    let (world, triangles) = (mesh.positions(), mesh.triangles());
    let mut cost = VolumeCost { triangles: triangles.len(), ..VolumeCost::default() };
    let reach = world.iter().map(|position| position.length()).fold(0.0, f64::max);
    let (mut facings, mut edges_found, mut indices) = (Facings::default(), Vec::new(), Vec::new());
    let (mut edges, mut planes) = (EdgeList::new(&[], 0), CasterPlanes::default());
    for run in 0..=runs {
        let is_timed = run > 0;
        // A mesh is built once; the light changes, so it gets more runs.
        if run <= runs.div_ceil(8) {
            let [edge_list, of_planes] = [&mut cost.edge_list, &mut cost.planes];
            edges = timed(edge_list, is_timed, || EdgeList::new(black_box(triangles), world.len()));
            planes = timed(of_planes, is_timed, || CasterPlanes::new(black_box(world), triangles));
        }
        let light = light(run, reach);
        let extruder = Extruder::new(world, light, Extrusion::Infinite);
        let start = Instant::now();
        timed(&mut cost.facing, is_timed, || planes.facings(black_box(world), triangles, light, &mut facings));
        facings.keep_casting(Casters::All);
        timed(&mut cost.multiplicities, is_timed, || silhouette(&edges, black_box(&facings), &mut edges_found));
        let parts = timed(&mut cost.indices, is_timed, || {
            let from = extruder.infinite_from();
            let fan = from.and_then(|light| CapFan::new(world, triangles, &facings, &edges_found, light));
            let far_end = fan.map_or(FarEnd::Caps, FarEnd::Fan);
            write_indices(triangles, world.len(), &facings, black_box(&edges_found), 0, far_end, &mut indices)
        });
        let new_light = start.elapsed();
        if is_timed {
            cost.new_light.push(new_light);
        }
        cost.silhouette_edges = edges_found.len();
        cost.volume_triangles = parts.triangles();
    }
    // Apart, since it would push everything above out of the processor's caches.
    for run in 0..=runs.div_ceil(8) {
        let shared = indices.clone();
        black_box(timed(&mut cost.hashing, run > 0, || Blob::new(shared)));
    }
    cost.edges = edges.edges().len();
    cost
}

fn timed<T>(times: &mut Vec<Duration>, is_timed: bool, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = black_box(work());
    if is_timed {
        times.push(start.elapsed());
    }
    done
}

/// Returns the point light of run number `run` around the origin, at a multiple of `reach`; no two are on the same
/// side.
fn light(run: usize, reach: f64) -> DVec4 {
    // The golden angle about one axis, any other about the next.
    let turn = angle::rotation(DVec3::Y, 2.399_963 * run as f64) * angle::rotation(DVec3::X, 0.9 * run as f64);
    (turn * DVec3::new(0.3, 0.5, 1.0).normalize() * (reach * LIGHT_DISTANCE)).extend(1.0)
}
