//! Whether any two drawn triangles have the same three corners: then both are visible at one depth, and a light must
//! not be added twice.
//!
//! Whether a mesh has two such triangles of its own is found out once for each pose. Between objects, all triangles of
//! small ones are compared; those of large ones only where the boxes around two objects intersect.

use super::FrameObject;
use crate::geometry::{Caster, GeometryCache};
use crate::math::AxisBox;
use foldhash::fast::RandomState;
use rayon::prelude::*;
use std::collections::HashSet;
use std::hash::BuildHasher;

/// Objects with more triangles are compared pair by pair, the others all at once.
const MOST_OF_SMALL: usize = 256;

/// How often each triangle may be compared in pairs of objects; where that would be more, all are compared at once.
const MOST_LOOKS: usize = 4;

/// A triangle's corners as bits, sorted: equal for triangles with the same corners, whatever their order or winding.
type CornersKey = [[u64; 3]; 3];

type CornersKeys = HashSet<CornersKey, RandomState>;

/// Returns whether any two drawn triangles, of one object or of two, have the same three corners, bit for bit and in
/// any order. Results about large objects are cached.
pub(super) fn coincide(placed: &[FrameObject], cache: &mut GeometryCache) -> bool {
    let drawn: Vec<&FrameObject> = placed.iter().filter(|placed| placed.surface.is_some()).collect();
    let is_small = |placed: &FrameObject| placed.object.mesh.triangles().len() <= MOST_OF_SMALL;
    let mut keys = CornersKeys::default();
    for placed in drawn.iter().filter(|placed| is_small(placed)) {
        if has_doubles(placed, &mut keys) {
            return true;
        }
    }
    for large in drawn.iter().filter(|placed| !is_small(placed)) {
        let caster = Caster { mesh: &large.object.mesh, pose: &large.object.pose, world: &large.world };
        if cache.has_doubles(caster, || may_have_doubles(large) && has_doubles(large, &mut CornersKeys::default())) {
            return true;
        }
    }
    let boxes: Vec<AxisBox> = drawn.iter().map(|placed| AxisBox::around(placed.world.iter().copied())).collect();
    let mut pairs = Vec::new();
    let mut work = 0;
    let count = |index: usize| drawn[index].object.mesh.triangles().len();
    let most_work = MOST_LOOKS * (0..drawn.len()).map(count).sum::<usize>();
    for one in (0..drawn.len()).filter(|one| !is_small(drawn[*one])) {
        // Two large ones are one pair.
        for other in (0..drawn.len()).filter(|other| is_small(drawn[*other]) || *other > one) {
            let shared = boxes[one].common(boxes[other]);
            if shared.low.cmple(shared.high).all() {
                work += count(other);
                pairs.push(([one, other], shared));
            }
        }
        if work > most_work {
            let mut keys = CornersKeys::default();
            return drawn.iter().any(|placed| has_doubles(placed, &mut keys));
        }
    }
    pairs.into_iter().any(|([one, other], shared)| {
        let keys: CornersKeys = keys_within(drawn[other], shared).collect();
        !keys.is_empty() && keys_within(drawn[one], shared).any(|key| keys.contains(&key))
    })
}

/// Returns whether a triangle of an object has the same corners as an earlier one of it or as one in `keys`, and adds
/// its triangles to `keys`; stops adding at the first such triangle.
fn has_doubles(placed: &FrameObject, keys: &mut CornersKeys) -> bool {
    let triangles = placed.object.mesh.triangles();
    keys.reserve(triangles.len());
    triangles.iter().any(|corners| !keys.insert(key(placed, corners)))
}

/// Returns whether two triangles of an object have the same hash, so that they may coincide; false is certain. Takes a
/// tenth of the memory of [`has_doubles`].
fn may_have_doubles(placed: &FrameObject) -> bool {
    let state = RandomState::default();
    let hash = |corners: &[u32; 3]| state.hash_one(key(placed, corners));
    let mut hashes: Vec<u64> = placed.object.mesh.triangles().par_iter().map(hash).collect();
    hashes.par_sort_unstable();
    hashes.windows(2).any(|pair| pair[0] == pair[1])
}

/// Returns the keys of an object's triangles whose corners all lie in a box.
fn keys_within(placed: &FrameObject, within: AxisBox) -> impl Iterator<Item = CornersKey> {
    let holds = move |vertex: &u32| within.holds(placed.world[*vertex as usize]);
    let inner = placed.object.mesh.triangles().iter().filter(move |corners| corners.iter().all(holds));
    inner.map(|corners| key(placed, corners))
}

fn key(placed: &FrameObject, corners: &[u32; 3]) -> CornersKey {
    // −0 and 0 are one place.
    let mut key = corners.map(|vertex| (placed.world[vertex as usize] + 0.0).to_array().map(f64::to_bits));
    key.sort_unstable();
    key
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::MeshId;
    use crate::scene::{Object, shapes};

    fn together(objects: &[Object]) -> bool {
        let placed = |object| FrameObject { object, world: object.world_positions(), surface: Some(MeshId(0)) };
        coincide(&objects.iter().map(placed).collect::<Vec<_>>(), &mut GeometryCache::default())
    }

    #[test]
    fn triangles_of_small_and_of_large_objects_are_found_where_they_coincide() {
        let small = |x: f64| Object::of("box", shapes::cuboid([1.0; 3]).expect("a box")).at([x, 0.0, 0.0]);
        let large = |x: f64| Object::of("ring", shapes::torus(2.0, 0.5, 40, 20).expect("a torus")).at([x, 0.0, 0.0]);
        assert!(!together(&[small(0.0), small(0.25), large(0.0), large(0.25)]));
        assert!(together(&[small(0.5), large(0.0), small(0.5)]));
        assert!(together(&[large(0.5), small(0.0), large(0.5)]));
        // A small one that has a triangle of a large one.
        let ring = large(0.5);
        let world = ring.world_positions();
        let corners = ring.mesh.triangles()[77].map(|vertex| world[vertex as usize].to_array());
        let part = shapes::triangles(&corners, &[[1, 0, 2]]).expect("a triangle");
        assert!(together(&[Object::of("part", part.clone()), ring.clone()]));
        assert!(!together(&[Object::of("part", part).at([0.0, 1e-9, 0.0]), ring]));
    }
}
