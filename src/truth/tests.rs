//! Lines and triangles: watertight at edges and vertices, and complete against brute force.

use super::direction_projection::OriginRay;
use super::hierarchy::{RayKind, RayOriginHierarchy, SearchLimit, side_of};
use super::packet::RayPacket;
use super::tree::set_bits;
use crate::math::side_of_triangle;
use glam::{DVec3, DVec4};

/// Returns which triangles each of up to 16 rays hits.
fn hit<const N: usize>(hierarchy: &RayOriginHierarchy, lines: [OriginRay; N]) -> [Vec<u32>; N] {
    let mut packet = RayPacket::new(match lines[0] {
        OriginRay::To(_) => OriginRay::To,
        OriginRay::Through(_) => OriginRay::Through,
        OriginRay::Along(_) => OriginRay::Along,
    });
    for line in lines {
        match line {
            OriginRay::To(point) | OriginRay::Through(point) | OriginRay::Along(point) => packet.push(point),
        }
    }
    let mut hit = lines.map(|_| Vec::new());
    hierarchy.for_each_hit(&packet, |triangle, _, lines| {
        set_bits(lines).for_each(|line| hit[line].push(triangle.index));
        SearchLimit::NOTHING
    });
    for hit in &mut hit {
        hit.sort_unstable();
        hit.dedup();
    }
    hit
}

/// Returns the ray from an origin through a point.
fn through(center: DVec4, point: DVec3) -> OriginRay {
    if center.w == 0.0 { OriginRay::To(point) } else { OriginRay::Along(point - center.truncate()) }
}

/// A square sheet in the plane z = 0 from −n to n, in triangles of side 1 that share corners.
fn sheet(n: i32) -> Vec<[DVec3; 3]> {
    let corner = |x: i32, y: i32| DVec3::new(f64::from(x), f64::from(y), 0.0);
    let quad = |x: i32, y: i32| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        // Diagonals and the way round differ from quad to quad.
        if (x + y) % 2 == 0 { [[a, b, c], [c, a, d]] } else { [[a, b, d], [b, c, d]] }
    };
    (-n..n).flat_map(|y| (-n..n).flat_map(move |x| quad(x, y))).collect()
}

#[test]
fn a_line_through_an_edge_or_a_vertex_meets_exactly_one_triangle_of_a_sheet() {
    let triangles = sheet(3);
    let centers = [
        DVec4::new(0.0, 0.0, 7.0, 1.0),
        DVec4::new(1.0, -2.0, 0.5, 1.0),
        DVec4::new(0.3, 0.7, -4.1, 1.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(0.3, -0.7, 1.1, 0.0),
    ];
    for center in centers {
        // A light's line to a point in the sheet would end there; an eye's goes on.
        let ray_kind = if center.w == 0.0 { RayKind::Light } else { RayKind::Eye };
        let hierarchy = RayOriginHierarchy::new(ray_kind, center, &triangles, |_| true);
        // Halves: vertices, middles of edges and of diagonals.
        for y in -5..=5 {
            for x in -5..=5 {
                let point = DVec3::new(f64::from(x) / 2.0, f64::from(y) / 2.0, 0.0);
                let [hit] = hit(&hierarchy, [through(center, point)]);
                let count = hit.len();
                assert_eq!(count, 1, "from {center} through {point}");
            }
        }
    }
}

/// An octahedron has front and back: a line through its edges and vertices passes as many of each.
#[test]
fn a_line_through_a_closed_mesh_enters_as_often_as_it_leaves() {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let signs = [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0]];
    let mut triangles = Vec::new();
    for sign in signs.into_iter().flat_map(|s| [s, s.map(|c: f64| -c)]) {
        let [a, b, c] = [axes[0] * sign[0], axes[1] * sign[1], axes[2] * sign[2]];
        triangles.push(if sign[0] * sign[1] * sign[2] > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    let mut crossed = 0;
    for center in [DVec4::new(0.0, 0.0, 5.0, 1.0), DVec4::new(3.0, 3.0, 3.0, 1.0), DVec4::new(1.0, 1.0, 0.0, 0.0)] {
        let ray_kind = if center.w == 0.0 { RayKind::Light } else { RayKind::Eye };
        let hierarchy = RayOriginHierarchy::new(ray_kind, center, &triangles, |_| true);
        for i in -4..=4 {
            for j in -4..=4 {
                for point in [
                    DVec3::new(f64::from(i) / 4.0, f64::from(j) / 4.0, 0.0),
                    DVec3::new(0.0, f64::from(i) / 4.0, f64::from(j) / 4.0),
                ] {
                    // A sun's line is followed from its far side on.
                    let line = if center.w == 0.0 {
                        OriginRay::To(point - center.truncate() * 9.0)
                    } else {
                        through(center, point)
                    };
                    let [hit] = hit(&hierarchy, [line]);
                    let balance: i32 = hit.iter().map(|index| side(&triangles[*index as usize], center)).sum();
                    assert_eq!(balance, 0, "from {center} through {point}: {hit:?}");
                    crossed += hit.len();
                }
            }
        }
    }
    assert!(crossed > 200, "{crossed} crossings");
}

fn side(corners: &[DVec3; 3], center: DVec4) -> i32 {
    side_of_triangle(*corners, center).value()
}

/// Does the line from a centre pass all edges of a triangle on one side? Exact.
fn is_on_line(corners: [DVec3; 3], center: DVec4, line: OriginRay) -> bool {
    let [a, b, c] = corners;
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| match line {
        OriginRay::To(point) | OriginRay::Through(point) if center.w == 0.0 => side(&[point, p, q], center),
        OriginRay::To(point) | OriginRay::Through(point) => side(&[center.truncate(), p, q], point.extend(1.0)),
        OriginRay::Along(direction) => side(&[center.truncate(), p, q], direction.extend(0.0)),
    });
    sides == [1; 3] || sides == [-1; 3]
}

/// Returns whether a triangle on the ray must be found: between the origin and the ray's end, or before the eye;
/// anywhere on a parallel view ray.
fn is_on_the_way(corners: [DVec3; 3], center: DVec4, line: OriginRay) -> bool {
    match line {
        OriginRay::To(point) => side(&corners, center) == -side(&corners, point.extend(1.0)),
        OriginRay::Through(_) => true,
        OriginRay::Along(direction) => side(&corners, center) == -side(&corners, direction.extend(0.0)),
    }
}

/// Random triangles, some of them close to the origin, through it and across all faces of the cube around it, small
/// ones in a tall scene, origins near, far and at infinity: packets find what a test of every triangle finds.
#[test]
fn packets_find_every_triangle_that_their_rays_hit() {
    let mut seed = 7u64;
    let mut number = |reach: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0) * reach
    };
    let mut found = 0;
    for round in 0..240 {
        let reach = [1.0, 1e-6, 1e6][round % 3];
        let mut point = |reach: f64| DVec3::new(number(reach), number(reach), number(reach));
        let offset = if round % 2 == 0 { DVec3::ZERO } else { DVec3::new(1e4, -3e3, 77.0) };
        let is_tall = round % 7 == 0;
        let triangles: [[DVec3; 3]; 40] = std::array::from_fn(|index| {
            let near = if index % 4 == 0 { reach * 1e-9 } else { reach };
            let size = if is_tall { reach * 1e-3 } else { reach * 3.0 };
            let first = point(near) * if is_tall { DVec3::new(1e-3, 1.0, 1e-3) } else { DVec3::ONE } + offset;
            [first, first + point(size), first + point(size)]
        });
        let center = match round % 8 {
            0 => (point(1.0) * if is_tall { DVec3::new(1e-3, 1.0, 1e-3) } else { DVec3::ONE }).extend(0.0),
            1 => triangles[0][0].extend(1.0),
            2 => (point(reach).normalize() * reach * 10f64.powi(1 + round as i32 % 17) + offset).extend(1.0),
            3 => {
                // Right above the middle of a triangle that reaches all round.
                let [a, b, c] = triangles[1];
                let normal = (b - a).cross(c - a).normalize();
                ((a + b + c) / 3.0 + normal * reach * 10f64.powi(-3 - round as i32 % 12)).extend(1.0)
            }
            _ => (point(reach) + offset).extend(1.0),
        };
        for ray_kind in [RayKind::Eye, RayKind::Light] {
            let hierarchy = RayOriginHierarchy::new(ray_kind, center, &triangles, |_| true);
            for packet in 0..8 {
                let middle = triangles[packet * 3][1];
                let spread = [reach, reach * 1e-3][packet % 2];
                // Some lines run exactly through edges and corners.
                let lines: [OriginRay; 16] = std::array::from_fn(|line| {
                    let [a, b, _] = triangles[packet * 3];
                    let target = match line {
                        0 => a,
                        1 => (a + b) / 2.0,
                        _ if is_tall && center.w == 0.0 => {
                            middle - center.truncate().normalize() * reach + point(spread * 1e-3)
                        }
                        _ => middle + point(spread),
                    };
                    match (ray_kind, center.w == 0.0) {
                        (RayKind::Light, _) => OriginRay::To(target),
                        (RayKind::Eye, true) => OriginRay::Through(target),
                        (RayKind::Eye, false) => OriginRay::Along(target - center.truncate()),
                    }
                });
                for (line, hit) in lines.into_iter().zip(hit(&hierarchy, lines)) {
                    for (index, corners) in (0..).zip(triangles) {
                        let (is_hit, is_on) = (hit.contains(&index), is_on_line(corners, center, line));
                        let must_be = is_on && is_on_the_way(corners, center, line);
                        assert!(
                            is_hit || !must_be,
                            "round {round}, {ray_kind:?} {center}, {line:?}: {index} is missed"
                        );
                        // Exactly on an edge it may be hit or not, as the perturbation says.
                        let is_off = !is_on && !is_on_an_edge(corners, center, line);
                        assert!(
                            !is_hit || !is_off,
                            "round {round}, {ray_kind:?} {center}, {line:?}: {index} is not met"
                        );
                        found += usize::from(must_be);
                    }
                }
            }
        }
    }
    assert!(found > 20_000, "{found} meetings");
}

/// Is a line exactly on the plane of one of a triangle's edges?
fn is_on_an_edge(corners: [DVec3; 3], center: DVec4, line: OriginRay) -> bool {
    let [a, b, c] = corners;
    [(a, b), (b, c), (c, a)].into_iter().any(|(p, q)| match line {
        OriginRay::To(point) | OriginRay::Through(point) if center.w == 0.0 => side(&[point, p, q], center) == 0,
        OriginRay::To(point) | OriginRay::Through(point) => side(&[center.truncate(), p, q], point.extend(1.0)) == 0,
        OriginRay::Along(direction) => side(&[center.truncate(), p, q], direction.extend(0.0)) == 0,
    })
}

/// A lamp as far off as a sun, all but in a small triangle's plane: no rounding may turn the side it is on.
#[test]
fn the_side_of_a_far_center_is_exact() {
    let mut seed = 11u64;
    let mut number = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / f64::from(1 << 23) - 1.0
    };
    let mut quick = 0;
    for (distance, edge) in [(1e7, 1e-3), (1e8, 1e-3), (1e9, 1e-2)] {
        for _ in 0..2000 {
            let mut point = |size: f64| DVec3::new(number(), number(), number()) * size;
            let (corner, along, across) = (point(1.0), point(edge), point(edge));
            let tilt = 10f64.powf(4.0 * point(1.0).x - 5.0);
            let towards = (along + across * point(1.0).y).normalize() + along.cross(across).normalize() * tilt;
            let corners = [corner, corner + along, corner + across];
            let center = (corner + towards * distance).extend(1.0);
            let exact = side_of_triangle(corners, center);
            let side = side_of(center, &corners);
            assert_eq!(
                side.map(|(side, _)| side),
                Some(exact).filter(|side| side.value() != 0),
                "{corners:?} {center}"
            );
            quick += usize::from(side.is_some_and(|(_, is_near)| !is_near));
        }
    }
    assert!(quick > 1000, "{quick}");
}
