//! What geometry is worth keeping between plans: edge lists by the mesh's content, planes by the
//! mesh and its place, and buffers.

use super::caster::Caster;
use super::grazing::{has_edge_on, move_grazing_last};
use super::holes::CappedMesh;
use super::planar::FlattenedCaster;
use super::solid::NotSolid;
use super::solid_proof::SolidProof;
use super::{
    Blob, CapFan, CasterPlanes, Casters, Connectivity, EdgeList, ExtrudedForm, ExtrudedVolume, Extruder, Facings,
    FarEnd, SilhouetteEdge, SurfaceNormals, Topology, VolumeParts, silhouette, silhouette_by_search,
    silhouette_of_shared_corners, solid, write_indices,
};
use crate::last_used::LastUsed;
use crate::scene::{Mesh, PoseBits, Shading};
use glam::{DVec3, DVec4};
use std::collections::HashMap;
use std::sync::Arc;

/// The most triangles whose edges, planes, connectivity or topology are cached, of each of these (about 60 bytes each, planes
/// as much again for each pose); beyond, only those of the last plan stay.
const MOST_TRIANGLES_CACHED: usize = 1_000_000;

/// A mesh of more triangles is searched for edge-on ones before it is proven solid: of a round one a millionth are, so that
/// the proof, which takes seconds, would seldom be used. Of a smaller one it is quick, and serves the next light.
const EDGE_ON_FIRST_ABOVE: usize = 4_000_000;

/// The most placed meshes whose short results (is it solid, does it have doubles) are cached.
const MOST_PLACES_CACHED: usize = 16_384;

/// The most triangles of drawn surfaces that are cached, some 32 bytes each; beyond, surfaces are made anew for each
/// plan.
const MOST_SURFACES_CACHED: usize = 2_000_000;

/// The most flattened triangles that are cached, 96 bytes each; beyond, they are made anew for each plan.
const MOST_FLATTENED_CACHED: usize = 500_000;

/// Geometry derived from meshes, kept between plans: edge lists, planes, topology, flattened casters and drawn
/// surfaces. A plan is the same with a full or an empty cache.
#[derive(Debug, Default)]
pub struct GeometryCache {
    edges: LastUsed<u64, Arc<EdgeList>>,
    flattened: LastUsed<u64, FlattenedTriangles>,
    planes: LastUsed<(u64, PoseBits), Arc<CasterPlanes>>,
    connectivities: LastUsed<u64, Arc<Connectivity>>,
    topologies: LastUsed<u64, Arc<Topology>>,
    solid_proofs: LastUsed<u64, Arc<SolidProof>>,
    solids: HashMap<(u64, PoseBits), Result<(), NotSolid>>,
    /// By mesh, where it has holes and bounds solids with caps on them.
    capped: LastUsed<u64, Option<Arc<CappedMesh>>>,
    /// By mesh and pose: whether two of its triangles have the same corners.
    doubled: HashMap<(u64, PoseBits), bool>,
    shown: LastUsed<(u64, PoseBits, [u64; 4]), Option<Arc<ShownTriangles>>>,
    extruded: LastUsed<ExtrudedKey, ExtrudedVolume>,
    surfaces: LastUsed<SurfaceKey, DrawnSurface>,
    facings: Facings,
    silhouette: Vec<SilhouetteEdge>,
}

/// Which triangles of a mesh may show from a place outside it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShownTriangles {
    /// Whether each triangle may show.
    pub shows: Vec<bool>,
    /// How many may not.
    pub hidden: u64,
    /// The number of the mesh's holes, behind which triangles may show that face away; 0 for a closed mesh.
    pub holes: usize,
}

/// Homogeneous world positions of a caster's triangles flattened onto a plane.
type FlattenedTriangles = Arc<Vec<[DVec4; 3]>>;

/// Hash of the mesh, pose, form, and the origin that positions are relative to.
type ExtrudedKey = (u64, PoseBits, ExtrudedForm, [u64; 3]);

/// Hashes of the mesh and its normals, pose, origin, and for each group the end of its triangles and its shading.
type SurfaceKey = (u64, u64, PoseBits, [u64; 3], Vec<(usize, Shading)>);

/// The vertex data of a drawn surface that does not depend on lights.
#[derive(Debug, Clone)]
pub struct DrawnSurface {
    /// Positions relative to an origin, with w = 1.
    pub vertices: Blob<[f32; 4]>,
    /// Vertex indices of the mesh's triangles, three a triangle.
    pub indices: Blob<u32>,
    /// Unit normals, world space.
    pub normals: SurfaceNormals,
}

/// How a volume's silhouette is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SilhouetteBy {
    /// From the mesh's edge list, built once.
    Adjacency,
    /// By searching a list for every edge's reverse, anew for each light.
    Search,
    /// Between triangles that share corners by the file's own numbers: edges of one triangle have no side, so that
    /// volumes may stay open. For showing what that does.
    SharedCorners,
}

/// The input for the indices of a shadow volume ([`GeometryCache::volume_indices`]).
#[derive(Debug, Clone, Copy)]
pub struct VolumeRequest<'a> {
    /// The caster.
    pub caster: Caster<'a>,
    /// Whether the caster is drawn too, so that its sides may graze visible surfaces.
    pub is_drawn: bool,
    /// Homogeneous world position of the light; w = 0 for a directional one.
    pub light: DVec4,
    /// Which of the caster's triangles cast.
    pub casters: Casters,
    /// For each triangle, whether it need not cast, as its shadow is dark without it; empty where none is.
    pub hidden: &'a [bool],
    /// How the silhouette is found.
    pub by: SilhouetteBy,
    /// Carries the vertices away from the light.
    pub extruder: &'a Extruder,
}

impl GeometryCache {
    /// Drops surfaces, flattened casters and volumes for vertex shaders that the last plan did not ask for, and of the rest
    /// what is too much.
    pub fn next_plan(&mut self) {
        self.edges.next_plan_beyond(MOST_TRIANGLES_CACHED);
        self.planes.next_plan_beyond(MOST_TRIANGLES_CACHED);
        self.connectivities.next_plan_beyond(MOST_TRIANGLES_CACHED);
        self.topologies.next_plan_beyond(MOST_TRIANGLES_CACHED);
        self.solid_proofs.next_plan_beyond(MOST_TRIANGLES_CACHED);
        self.capped.next_plan_beyond(MOST_TRIANGLES_CACHED);
        self.shown.next_plan();
        self.extruded.next_plan();
        self.surfaces.next_plan();
        self.flattened.next_plan();
    }

    /// Returns a flattened caster; calls `make` only if plane, caster or light are new.
    pub fn flattened(&mut self, what: &FlattenedCaster, make: impl FnOnce() -> Vec<[DVec4; 3]>) -> FlattenedTriangles {
        self.flattened.get_or_make_within(MOST_FLATTENED_CACHED, what.key(), || {
            let triangles = Arc::new(make());
            let count = triangles.len();
            (triangles, count)
        })
    }

    /// Returns the edge list of `mesh`, built on first use and then cached by the mesh's content.
    pub fn edges(&mut self, mesh: &Mesh) -> Arc<EdgeList> {
        let build = || Arc::new(EdgeList::new(mesh.triangles(), mesh.positions().len()));
        self.edges.get_or_make_within(usize::MAX, mesh.content_hash(), || (build(), mesh.triangles().len()))
    }

    /// Returns the planes of a caster's triangles in world space, computed on first use and then cached by the mesh's
    /// content and its pose.
    pub fn planes(&mut self, caster: Caster) -> Arc<CasterPlanes> {
        let key = (caster.mesh.content_hash(), caster.pose.bits());
        let triangles = caster.mesh.triangles();
        let compute = || Arc::new(CasterPlanes::new(caster.world, triangles));
        self.planes.get_or_make_within(usize::MAX, key, || (compute(), triangles.len()))
    }

    /// Computes the shadow volume of a caster and a light: writes its vertex indices into `out`, replacing what it
    /// held, and returns which ranges of triangles are sides and caps. Facings and silhouette are computed anew each
    /// time, planes and edges are cached.
    pub fn volume_indices(&mut self, of: &VolumeRequest, out: &mut Vec<u32>) -> VolumeParts {
        let VolumeRequest { caster, light, .. } = *of;
        let triangles = caster.mesh.triangles();
        let planes = self.planes(caster);
        let edges = (of.by == SilhouetteBy::Adjacency).then(|| self.edges(caster.mesh));
        let is_of_shared_corners = of.by == SilhouetteBy::SharedCorners;
        planes.facings(caster.world, triangles, light, &mut self.facings);
        self.facings.keep_casting(of.casters);
        self.facings.leave_out(of.hidden);
        let found = &mut self.silhouette;
        match &edges {
            Some(edges) => silhouette(edges, &self.facings, found),
            None if is_of_shared_corners => silhouette_of_shared_corners(caster.mesh, &self.facings, found),
            None => silhouette_by_search(triangles, &self.facings, found),
        }
        let grazing = if of.is_drawn { move_grazing_last(found, caster, light, edges.as_deref()) } else { 0 };
        let fan = |light| CapFan::new(caster.world, triangles, &self.facings, found, light);
        let far_end = match of.extruder.infinite_from().map(fan) {
            Some(Some(fan)) => FarEnd::Fan(fan),
            None if of.extruder.is_one_point() => FarEnd::Point,
            _ => FarEnd::Caps,
        };
        write_indices(triangles, caster.world.len(), &self.facings, found, grazing, far_end, out)
    }

    /// Returns a caster's volume for a vertex shader, with positions relative to `origin`; made only if caster, origin
    /// or form are new.
    pub fn extruded(&mut self, caster: Caster, origin: DVec3, form: ExtrudedForm) -> ExtrudedVolume {
        let Caster { mesh, pose, world } = caster;
        let key = (mesh.content_hash(), pose.bits(), form, origin.to_array().map(f64::to_bits));
        if let Some(volume) = self.extruded.get(&key) {
            return volume;
        }
        let edges = self.edges(mesh);
        self.extruded.get_or_make(key, || ExtrudedVolume::new(world, mesh.triangles(), &edges, origin, form))
    }

    /// Returns a surface's vertex data relative to `origin`, with this shading of each group; calls `make` only if one
    /// of these is new, or where too much is cached.
    pub fn surface(
        &mut self,
        of: Caster,
        origin: DVec3,
        shadings: &[Shading],
        make: impl FnOnce() -> DrawnSurface,
    ) -> DrawnSurface {
        let Caster { mesh, pose, .. } = of;
        let groups = mesh.groups().iter().map(|group| group.triangles.end).zip(shadings.iter().copied()).collect();
        let origin = origin.to_array().map(f64::to_bits);
        let key = (mesh.content_hash(), mesh.normals_hash(), pose.bits(), origin, groups);
        self.surfaces.get_or_make_within(MOST_SURFACES_CACHED, key, || (make(), mesh.triangles().len()))
    }

    /// Returns which triangles of a placed mesh may show from a homogeneous place; `find_out` is called only if mesh, pose or
    /// place are new. `None` where all may.
    pub fn shown(
        &mut self,
        of: Caster,
        from: DVec4,
        find_out: impl FnOnce(&mut GeometryCache) -> Option<ShownTriangles>,
    ) -> Option<Arc<ShownTriangles>> {
        let key = (of.mesh.content_hash(), of.pose.bits(), from.to_array().map(f64::to_bits));
        if let Some(known) = self.shown.get(&key) {
            return known;
        }
        let found = find_out(self).map(Arc::new);
        self.shown.get_or_make(key, || found)
    }

    /// Returns the topology of `mesh`, examined on first use and then cached by the mesh's content.
    pub fn topology(&mut self, mesh: &Mesh) -> Arc<Topology> {
        let connectivity = self.connectivity(mesh);
        let build = || Arc::new(Topology::new(mesh, connectivity));
        self.topologies.get_or_make_within(usize::MAX, mesh.content_hash(), || (build(), mesh.triangles().len()))
    }

    /// Returns how the triangles of a mesh are connected by their edges, examined on first use and then cached by the
    /// mesh's content.
    pub fn connectivity(&mut self, mesh: &Mesh) -> Arc<Connectivity> {
        let edges = self.edges(mesh);
        let build = || Arc::new(Connectivity::new(mesh, &edges));
        self.connectivities.get_or_make_within(usize::MAX, mesh.content_hash(), || (build(), mesh.triangles().len()))
    }

    /// Checks that the triangles that face the light cast the shadow of the whole mesh: it is solid, and the light is
    /// outside. The mesh is examined once for all poses, or once for each, the light each time.
    ///
    /// # Errors
    /// What speaks against it, or is not proven.
    pub fn light_facing_suffices(&mut self, caster: Caster, light: DVec4) -> Result<(), String> {
        self.light_facing_suffices_with(caster, light, EDGE_ON_FIRST_ABOVE)
    }

    /// [`GeometryCache::light_facing_suffices`], searching a mesh of more triangles than `first_above`, unless it is known
    /// to be solid, for edge-on ones first. The verdict is the same; the reason is not where something else speaks against
    /// it as well.
    fn light_facing_suffices_with(&mut self, caster: Caster, light: DVec4, first_above: usize) -> Result<(), String> {
        let mesh = caster.mesh;
        let check_edge_on = || match has_edge_on(caster, light) {
            true => Err("some triangle is edge-on to it, as far as single precision can tell".to_owned()),
            false => Ok(()),
        };
        let is_known = self.solids.get(&(mesh.content_hash(), caster.pose.bits())).is_some_and(Result::is_ok);
        let is_first = mesh.triangles().len() > first_above && !is_known;
        if is_first {
            let connectivity = self.connectivity(mesh);
            solid::check_connectivity(mesh.triangles().len(), &connectivity).map_err(|doubt| doubt.to_string())?;
            check_edge_on()?;
        }
        self.solid(caster, solid::check).map_err(|doubt| doubt.to_string())?;
        if !is_first {
            check_edge_on()?;
        }
        match solid::light_is_outside(caster.world, mesh.triangles(), light) {
            true => Ok(()),
            false => Err("the light is inside it, or on it".to_owned()),
        }
    }

    /// Returns which triangles of a mesh with holes face away from a homogeneous place and are hidden from it by the mesh
    /// itself, with the number of its holes: what they darken is dark without them. `None` for a mesh without holes, and
    /// where it is not proven to bound solids that the place is outside of, once its holes are closed.
    pub fn hidden_behind_no_hole(&mut self, caster: Caster, place: DVec4) -> Option<(Vec<bool>, usize)> {
        let mesh = caster.mesh;
        let connectivity = self.connectivity(mesh);
        if connectivity.open_edges.count == 0 {
            return None;
        }
        let edges = self.edges(mesh);
        let cap = || CappedMesh::new(mesh, &edges, &connectivity).map(Arc::new);
        let make = || (cap(), mesh.triangles().len());
        let capped = self.capped.get_or_make_within(usize::MAX, mesh.content_hash(), make)?;
        let world = capped.world(caster);
        let closed = Caster { mesh: &capped.mesh, world: &world, ..caster };
        self.solid(closed, solid::check).ok()?;
        let is_outside = solid::light_is_outside(&world, capped.mesh.triangles(), place);
        is_outside.then(|| capped.hidden(&world, place)).flatten().map(|hidden| (hidden, capped.holes()))
    }

    /// Returns whether a mesh is proven solid at its place. It is examined once for all poses; `examine` is called only
    /// for a pose to which that does not carry over ([`SolidProof::at`]).
    fn solid(
        &mut self,
        caster: Caster,
        examine: impl FnOnce(&[DVec3], &[[u32; 3]], &Connectivity) -> Result<(), NotSolid>,
    ) -> Result<(), NotSolid> {
        let mesh = caster.mesh;
        let key = (mesh.content_hash(), caster.pose.bits());
        if let Some(known) = self.solids.get(&key) {
            return known.clone();
        }
        let connectivity = self.connectivity(mesh);
        let prove = || {
            let proof = SolidProof::new(mesh.positions(), mesh.triangles(), &connectivity);
            let parts = 1 + proof.unsettled() + connectivity.components;
            (Arc::new(proof), parts)
        };
        let proof = self.solid_proofs.get_or_make_within(usize::MAX, mesh.content_hash(), prove);
        let carried = proof.at(caster, &connectivity);
        let found = carried.unwrap_or_else(|| examine(caster.world, mesh.triangles(), &connectivity));
        insert_among(&mut self.solids, key, found.clone());
        found
    }

    /// Returns the result of `find_out`: whether two triangles of a placed mesh have the same corners. It is called
    /// once for each mesh and pose, then the cached result is returned; it is not called where the mesh is known to be
    /// solid there, as it then does not meet itself.
    pub fn has_doubles(&mut self, caster: Caster, find_out: impl FnOnce() -> bool) -> bool {
        let key = (caster.mesh.content_hash(), caster.pose.bits());
        if self.solids.get(&key).is_some_and(Result::is_ok) {
            return false;
        }
        if let Some(known) = self.doubled.get(&key) {
            return *known;
        }
        let found = find_out();
        insert_among(&mut self.doubled, key, found);
        found
    }
}

/// Adds a result about a mesh at a pose; empties the map first where it is full.
fn insert_among<T>(known: &mut HashMap<(u64, PoseBits), T>, key: (u64, PoseBits), found: T) {
    if known.len() >= MOST_PLACES_CACHED {
        known.clear();
    }
    known.insert(key, found);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::planar::FlattenClip;
    use crate::math::Plane;
    use crate::scene::{Object, Pose, shapes};

    #[test]
    fn a_mesh_that_moves_is_examined_once() {
        let mut cache = GeometryCache::default();
        let torus = Object::of("torus", shapes::torus(0.66, 0.22, 24, 12).expect("a torus"));
        let (mut examined, mut proofs) = (0, Vec::new());
        let mut ask = |object: &Object| {
            cache.next_plan();
            let world = object.world_positions();
            let known = cache.solid(Caster { mesh: &object.mesh, pose: &object.pose, world: &world }, |_, _, _| {
                examined += 1;
                Ok(())
            });
            assert_eq!(known, Ok(()));
            proofs.extend(cache.solid_proofs.get(&object.mesh.content_hash()));
            (proofs.iter().all(|proof| Arc::ptr_eq(proof, &proofs[0])), examined)
        };
        for turn in 0..20 {
            let turned = torus.clone().rotated([f64::from(turn) * 17.0, 5.0, 0.0]).at([f64::from(turn), 0.5, -2.0]);
            assert_eq!(ask(&turned), (true, 0), "one proof serves every pose");
        }
        let away = torus.at([1e9, 0.0, 0.0]);
        assert_eq!([ask(&away), ask(&away)], [(true, 1); 2], "too far away for that it is examined there, once");
    }

    #[test]
    fn a_large_mesh_with_an_edge_on_triangle_is_not_proven_solid_for_nothing() {
        let torus = Object::of("torus", shapes::torus(0.66, 0.22, 24, 12).expect("a torus"));
        let world = torus.world_positions();
        let [a, b, c] = torus.mesh.triangles()[7].map(|vertex| world[vertex as usize]);
        let in_its_plane = (a + 9.0 * (b - a) + 5.0 * (c - a)).extend(1.0);
        let beside = DVec4::new(0.1, 4.0, 0.2, 1.0);
        // Whether its light-facing triangles suffice, and whether that it is solid was looked into.
        let ask = |cache: &mut GeometryCache, object: &Object, light: DVec4, first_above: usize| {
            let world = object.world_positions();
            let caster = Caster { mesh: &object.mesh, pose: &object.pose, world: &world };
            let found = cache.light_facing_suffices_with(caster, light, first_above);
            let is_looked_into = cache.solid_proofs.get(&object.mesh.content_hash()).is_some();
            assert_eq!(found.is_ok(), cache.light_facing_suffices(caster, light).is_ok(), "the verdict is the same");
            (found.is_ok(), is_looked_into)
        };
        let once = |light, first_above| ask(&mut GeometryCache::default(), &torus, light, first_above);
        assert_eq!(once(in_its_plane, 100), (false, false), "large");
        assert_eq!(once(in_its_plane, 1000), (false, true), "small: the proof serves the next light");
        assert_eq!([once(beside, 100), once(beside, 1000)], [(true, true); 2], "no triangle is edge-on");
        let known = &mut GeometryCache::default();
        assert_eq!([beside, in_its_plane].map(|light| ask(known, &torus, light, 100).0), [true, false]);
        // A fat ring meets itself.
        let fat = Object::of("fat", shapes::torus(0.66, 0.9, 24, 12).expect("a torus"));
        for first_above in [100, 1000] {
            assert_eq!(ask(&mut GeometryCache::default(), &fat, beside, first_above), (false, true));
        }
    }

    #[test]
    fn a_caster_is_flattened_again_only_if_something_changed() {
        let mut cache = GeometryCache::default();
        let what = FlattenedCaster {
            mesh: 7,
            faces_light: false,
            pose: Pose::default(),
            plane: Plane::through(DVec3::ZERO, DVec3::Y),
            light: DVec4::new(0.0, 4.0, 0.0, 1.0),
            clip: FlattenClip::BetweenPlaneAndLight,
            own: None,
        };
        let mut made = 0;
        let mut ask = |what: &FlattenedCaster, is_next_plan: bool| {
            if is_next_plan {
                cache.next_plan();
            }
            cache.flattened(what, || {
                made += 1;
                Vec::new()
            });
            made
        };
        assert_eq!([ask(&what, true), ask(&what, false), ask(&what, true)], [1, 1, 1]);
        let moved = FlattenedCaster { light: DVec4::new(0.0, 4.0, 1e-12, 1.0), ..what };
        assert_eq!([ask(&moved, true), ask(&FlattenedCaster { own: Some(0), ..what }, false)], [2, 3]);
        // A result that one plan does not ask for is dropped by the next.
        assert_eq!([ask(&moved, true), ask(&what, true)], [3, 4]);
    }
    /// What shows stays known while the light moves, also that nothing is known; not where the eye or the mesh do.
    #[test]
    fn what_shows_of_a_mesh_is_found_out_again_only_if_eye_or_mesh_moved() {
        let mut cache = GeometryCache::default();
        let torus = Object::of("torus", shapes::torus(0.66, 0.22, 24, 12).expect("a torus"));
        let turned = torus.clone().rotated([0.0, 20.0, 0.0]);
        let mut asked = 0;
        let mut ask = |object: &Object, eye: DVec3, is_known: bool| {
            cache.next_plan();
            let world = object.world_positions();
            let caster = Caster { mesh: &object.mesh, pose: &object.pose, world: &world };
            let found = ShownTriangles { shows: vec![true, false], hidden: 1, holes: 0 };
            let shown = cache.shown(caster, eye.extend(1.0), |_| {
                asked += 1;
                is_known.then(|| found.clone())
            });
            assert_eq!(shown.as_deref(), is_known.then_some(&found));
            asked
        };
        let eyes = [DVec3::new(0.0, 1.0, 5.0), DVec3::new(0.0, 1.0, 6.0)];
        assert_eq!([ask(&torus, eyes[0], true), ask(&torus, eyes[0], true)], [1, 1], "the light moved");
        assert_eq!([ask(&torus, eyes[1], false), ask(&torus, eyes[1], false)], [2, 2], "the eye moved");
        assert_eq!([ask(&turned, eyes[1], true), ask(&turned, eyes[1], true)], [3, 3], "the mesh moved");
        assert_eq!(ask(&torus, eyes[0], true), 4, "what no plan asked for meanwhile is dropped");
    }
}
