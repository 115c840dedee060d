use super::*;

/// With the areas that they have.
fn pair_meets(world: &[DVec3], one: [u32; 3], other: [u32; 3]) -> bool {
    let has_area = |triangle: [u32; 3]| FlatTriangle::of(triangle.map(|vertex| world[vertex as usize])).is_some();
    meet(world, [one, other].map(|triangle| (triangle, has_area(triangle))))
}

fn p(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Two triangles over welded points; the answer must not depend on their order or corners.
fn meets(one: [DVec3; 3], other: [DVec3; 3]) -> bool {
    let mut world: Vec<DVec3> = Vec::new();
    let mut index_of = |point: DVec3| {
        let known = world.iter().position(|known| *known == point);
        known.unwrap_or_else(|| {
            world.push(point);
            world.len() - 1
        }) as u32
    };
    let (one, other) = (one.map(&mut index_of), other.map(&mut index_of));
    let answer = pair_meets(&world, one, other);
    let variants = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]];
    for x in variants(one) {
        for y in variants(other) {
            assert_eq!(pair_meets(&world, x, y), answer, "{x:?} {y:?}");
            assert_eq!(pair_meets(&world, y, x), answer, "{y:?} {x:?}");
        }
    }
    answer
}

#[test]
fn triangles_apart_or_through_each_other() {
    let floor = [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, 4.0, 0.0)];
    let moved = |by: DVec3| floor.map(|corner| corner + by);
    let standing = |x: f64, y: f64, low: f64| [p(x, y, low), p(x + 0.1, y, 1.0), p(x, y + 0.2, 1.0)];
    assert!(!meets(floor, moved(p(0.0, 0.0, 1.0))), "parallel");
    assert!(!meets(floor, moved(p(9.0, 0.0, 0.0))), "beside in the plane");
    assert!(meets(floor, moved(p(0.5, 0.5, 0.0))), "overlapping in the plane");
    assert!(
        !meets(floor, [p(2.1, 2.1, 0.0), p(3.0, 3.0, 0.0), p(2.1, 5.0, 0.0)]),
        "bounds overlap, the triangles do not"
    );
    assert!(meets(floor, standing(1.0, 1.0, -1.0)), "through");
    assert!(meets(floor, standing(1.0, 1.0, 0.0)), "a corner on it");
    assert!(!meets(floor, standing(1.0, 1.0, f64::MIN_POSITIVE)), "a corner as near as can be");
    assert!(!meets(floor, standing(3.0, 3.0, -1.0)), "past it");
    assert!(meets(floor, [p(2.0, -1.0, 0.0), p(2.0, 1.0, 0.0), p(2.0, 0.0, 1.0)]), "an edge in its plane, into it");
    assert!(!meets(floor, [p(5.0, -1.0, 0.0), p(5.0, 1.0, 0.0), p(5.0, 0.0, 1.0)]), "an edge in its plane, beside");
    assert!(meets(floor, [p(1.0, 1.0, 0.0), p(1.0, 1.0, 1.0), p(1.0, 1.0, 2.0)]), "no area: not proven apart");
}

#[test]
fn triangles_with_a_common_edge() {
    let floor = [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, 4.0, 0.0)];
    let beside = |tip: DVec3| [floor[1], floor[0], tip];
    assert!(!meets(floor, beside(p(1.0, -3.0, 0.0))), "flat on");
    assert!(!meets(floor, beside(p(1.0, 1.0, 1e-300))), "folded nearly shut");
    assert!(meets(floor, beside(p(1.0, 1.0, 0.0))), "folded shut");
    assert!(meets(floor, beside(p(9.0, 9.0, 0.0))), "folded shut, larger");
    assert!(meets(floor, floor), "twice the same");
}

#[test]
fn triangles_with_a_common_corner() {
    let o = DVec3::ZERO;
    let floor = [o, p(4.0, 0.0, 0.0), p(0.0, 4.0, 0.0)];
    assert!(!meets(floor, [o, p(-4.0, 0.0, 0.0), p(0.0, -4.0, 0.0)]), "opposite in the plane");
    assert!(!meets(floor, [o, p(-1.0, 4.0, 0.0), p(-4.0, 0.0, 0.0)]), "beside in the plane");
    assert!(meets(floor, [o, p(1.0, 1.0, 0.0), p(-4.0, 0.0, 0.0)]), "overlapping wedges");
    assert!(meets(floor, [o, p(1.0, 2.0, 0.0), p(2.0, 1.0, 0.0)]), "a wedge inside a wedge");
    assert!(meets(floor, [o, p(-1.0, 4.0, 0.0), p(4.0, -1.0, 0.0)]), "a wedge around a wedge");
    assert!(meets(floor, [o, p(1.0, 0.0, 0.0), p(1.0, -1.0, 0.0)]), "part of an edge in common");
    assert!(!meets(floor, [o, p(1.0, 1.0, 1.0), p(1.0, 2.0, 1.0)]), "above");
    assert!(!meets(floor, [o, p(1.0, -1.0, 0.0), p(1.0, 1.0, 1.0)]), "an edge in its plane, outside the wedge");
    assert!(meets(floor, [o, p(1.0, 1.0, 0.0), p(1.0, 1.0, 1.0)]), "an edge in its plane, inside the wedge");
    assert!(meets(floor, [o, p(1.0, 1.0, 1.0), p(1.0, 1.0, -1.0)]), "through");
    assert!(!meets(floor, [o, p(-1.0, -1.0, 1.0), p(-1.0, -1.0, -1.0)]), "through the plane on the other side");
    assert!(!meets(floor, [o, p(1.0, -3.0, 1.0), p(1.0, -3.0, -1.0)]), "through the plane beside");
}

/// Compared with points of both triangles: where some of them coincide in fine steps, the triangles intersect.
#[test]
fn random_pairs_agree_with_points_sampled_on_them() {
    let mut state = 3u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % 5) as f64
    };
    let mut answers = [0; 2];
    for _ in 0..4000 {
        let mut triangle = || [0; 3].map(|_| p(next(), next(), next()));
        let (one, other) = (triangle(), triangle());
        let is_flat = |t: [DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]) == DVec3::ZERO;
        if is_flat(one) || is_flat(other) || one.iter().any(|corner| other.contains(corner)) {
            continue;
        }
        // The distance of the closest pair of an edge and a triangle, where one pierces the other.
        let pierced = |edges: [DVec3; 3], [a, b, c]: [DVec3; 3]| {
            let normal = (b - a).cross(c - a);
            (0..3).any(|i| {
                let (from, to) = (edges[i], edges[(i + 1) % 3]);
                let [h, k] = [from, to].map(|end| normal.dot(end - a));
                let at = from + (to - from) * (h / (h - k));
                let inside = [[a, b], [b, c], [c, a]].map(|[p, q]| normal.dot((q - p).cross(at - p)));
                h * k < 0.0 && inside.iter().all(|side| *side > 1e-9)
            })
        };
        let answer = meets(one, other);
        answers[usize::from(answer)] += 1;
        assert!(answer || !(pierced(one, other) || pierced(other, one)), "{one:?} {other:?}");
    }
    assert!(answers.iter().all(|count| *count > 300), "{answers:?}");
}

/// Pairs that share nothing, a corner or an edge; wherever their corners are moved within the distance, those that are
/// proven to stay apart do, and most that are apart by far are proven to.
#[test]
fn pairs_that_are_proven_to_stay_apart_do_however_their_corners_move() {
    let mut state = 9u64;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut outcomes = [[0; 2]; 3];
    for round in 0..6000 {
        let distance = [1e-9, 1e-3, 0.03][round % 3];
        let shared = round / 3 % 3;
        // Every other round on a lattice, where much is coplanar.
        let lattice = if round / 9 % 2 == 0 { 3.0 } else { 1e9 };
        let world: Vec<DVec3> = (0..6 - shared)
            .map(|_| p(number(), number(), number()))
            .map(|at| (at * lattice).round() / lattice)
            .collect();
        let pair = [[0, 1, 2], [[3, 4, 5], [3, 0, 4], [1, 0, 3]][shared]];
        let perturbation = Perturbation::by(distance);
        let keep_area = pair.iter().all(|corners| perturbation.keeps_area(corners.map(|at| world[at as usize])));
        if !keep_area || !stay_apart(&world, pair, perturbation) {
            outcomes[shared][0] += usize::from(!pair_meets(&world, pair[0], pair[1]));
            continue;
        }
        outcomes[shared][1] += 1;
        for _ in 0..40 {
            let mut aside = || p(number(), number(), number()).normalize_or_zero() * distance;
            let moved: Vec<DVec3> = world.iter().map(|at| *at + aside()).collect();
            assert!(!pair_meets(&moved, pair[0], pair[1]), "{pair:?} {world:?} {moved:?}");
        }
    }
    // Apart but not proven, and proven.
    assert!(outcomes.iter().all(|[open, proven]| *proven > 500 && open < proven), "{outcomes:?}");
}

#[test]
fn a_closed_surface_does_not_meet_itself_until_it_is_bent_through() {
    use crate::scene::shapes;
    let torus = shapes::torus(1.0, 0.4, 40, 20).expect("a torus");
    assert_eq!(self_meeting(torus.positions(), torus.triangles()), None);
    let mut bent = torus.positions().to_vec();
    bent[7] = -bent[7];
    assert!(self_meeting(&bent, torus.triangles()).is_some());
}

/// The hierarchy leaves nothing out: the first triangle that meets a later one is that of trying all pairs.
#[test]
fn the_first_triangle_that_meets_another_is_found() {
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    let mut outcomes = [0, 0];
    for round in 0..60 {
        // Small ones of a thousand, which meet at times.
        let size = 0.002 * f64::from(1 + round);
        let world: Vec<DVec3> = (0..1000)
            .flat_map(|_| {
                let middle = p(random(), random(), random());
                [0, 1, 2].map(|_| middle + size * p(random(), random(), random()))
            })
            .collect();
        let triangles: Vec<[u32; 3]> = (0..1000).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect();
        let pairs = (0..1000).flat_map(|one| (one + 1..1000).map(move |other| [one, other]));
        let first = pairs.into_iter().find(|pair| {
            let [one, other] = pair.map(|at| triangles[at]);
            pair_meets(&world, one, other)
        });
        let found = self_meeting(&world, &triangles);
        // With which of those that it meets is left to the hierarchy.
        assert_eq!(found.map(|[one, _]| one), first.map(|[one, _]| one), "{size}");
        let boxes: Vec<Aabb> =
            triangles.iter().map(|of| outer_box(of.map(|vertex| world[vertex as usize]), 0.0)).collect();
        let meets = |pair: [usize; 2]| pair_meets(&world, triangles[pair[0]], triangles[pair[1]]);
        for group in [3, 8, 2000] {
            let search = IntersectionSearch::of_groups(&boxes, group, &meets);
            assert_eq!(search.finds_any(), first.is_some(), "{size}: groups of {group}");
            let found = search.first();
            assert_eq!(found.map(|[one, _]| one), first.map(|[one, _]| one), "{size}: groups of {group}");
        }
        assert!(found.is_none_or(|[one, other]| pair_meets(&world, triangles[one], triangles[other])));
        outcomes[usize::from(first.is_some())] += 1;
    }
    assert!(outcomes.iter().all(|count| *count > 3), "{outcomes:?}");
}

#[test]
fn a_hierarchy_is_the_one_that_obvhs_builds() {
    let corners = |index: usize| {
        let at = |salt: usize| ((index * 3 + salt) * 2_654_435_761 % 4096) as f64 / 256.0;
        [0, 1, 2].map(|corner| p(at(corner), at(corner + 10), at(corner + 20)))
    };
    for count in [1, 2, 3, 100, 5000] {
        let boxes: Vec<Aabb> = (0..count).map(|index| outer_box(corners(index), 0.0)).collect();
        let clock = &mut std::time::Duration::default();
        let expected = obvhs::bvh2::builder::build_bvh2(&boxes, BvhBuildParams::very_fast_build(), clock);
        let built = hierarchy(&boxes);
        let bytes = |hierarchy: &Bvh2| bytemuck::cast_slice::<Bvh2Node, u8>(&hierarchy.nodes).to_vec();
        assert!(bytes(&built) == bytes(&expected), "{count}");
        assert_eq!(built.primitive_indices, expected.primitive_indices, "{count}");
    }
}
