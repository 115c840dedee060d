//! Lines and triangles: watertight at edges and vertices, and complete against brute force.

use super::pencil::{Bundle, Pencil, Then};
use glam::{DVec3, DVec4};

/// Which triangles the line through a point meets.
fn met(pencil: &Pencil, triangles: &[[DVec3; 3]], point: DVec3) -> Vec<u32> {
    let mut bundle = Bundle::default();
    bundle.push(point - pencil.origin);
    let mut met = Vec::new();
    pencil.for_each_meeting(triangles, &bundle, true, |seen, _| {
        met.push(seen.index);
        Then::Continue
    });
    met.sort_unstable();
    met.dedup();
    met
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
        let pencil = Pencil::new(center, &triangles, |_| true);
        // Halves: vertices, middles of edges and of diagonals.
        for y in -5..=5 {
            for x in -5..=5 {
                let point = DVec3::new(f64::from(x) / 2.0, f64::from(y) / 2.0, 0.0);
                let count = met(&pencil, &triangles, point).len();
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
        let pencil = Pencil::new(center, &triangles, |_| true);
        for i in -4..=4 {
            for j in -4..=4 {
                for point in [
                    DVec3::new(f64::from(i) / 4.0, f64::from(j) / 4.0, 0.0),
                    DVec3::new(0.0, f64::from(i) / 4.0, f64::from(j) / 4.0),
                ] {
                    let met = met(&pencil, &triangles, point);
                    let balance: i32 = met.iter().map(|index| side(&triangles[*index as usize], center)).sum();
                    assert_eq!(balance, 0, "from {center} through {point}: {met:?}");
                    crossed += met.len();
                }
            }
        }
    }
    assert!(crossed > 200, "{crossed} crossings");
}

fn side(corners: &[DVec3; 3], center: DVec4) -> i32 {
    crate::math::side_of_triangle(*corners, center).value()
}

/// Random triangles, some of them close to the centre, through it and across all faces of the
/// cube around it: the hierarchy finds what a test of every triangle finds.
#[test]
fn the_hierarchy_finds_every_triangle_that_a_line_meets() {
    let mut seed = 7u64;
    let mut number = |reach: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0) * reach
    };
    let mut found = 0;
    for round in 0..60 {
        let reach = [1.0, 1e-6, 1e6][round % 3];
        let mut point = |reach: f64| DVec3::new(number(reach), number(reach), number(reach));
        let offset = if round % 2 == 0 { DVec3::ZERO } else { DVec3::new(1e4, -3e3, 77.0) };
        let triangles: Vec<[DVec3; 3]> = (0..40)
            .map(|index| {
                let near = if index % 4 == 0 { reach * 1e-9 } else { reach };
                [point(near) + offset, point(reach) + offset, point(reach * 3.0) + offset]
            })
            .collect();
        let center = match round % 5 {
            0 => point(1.0).extend(0.0),
            1 => (triangles[0][0]).extend(1.0),
            3 => {
                // Right above the middle of a triangle that reaches all round.
                let [a, b, c] = triangles[1];
                let normal = (b - a).cross(c - a).normalize();
                ((a + b + c) / 3.0 + normal * reach * 10f64.powi(-3 - round as i32 % 12)).extend(1.0)
            }
            2 => (point(reach).normalize() * reach * 10f64.powi(1 + round as i32 % 9) + offset).extend(1.0),
            _ => (point(reach) + offset).extend(1.0),
        };
        let pencil = Pencil::new(center, &triangles, |_| true);
        for _ in 0..60 {
            let target = point(reach) + offset;
            let towards = if center.w == 0.0 { center.truncate() } else { target - center.truncate() };
            let expected: Vec<u32> = (0..40u32)
                .filter(|index| {
                    let corners = triangles[*index as usize];
                    let apex = if center.w == 0.0 { target } else { center.truncate() };
                    let sides = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
                        crate::math::side_of_triangle([apex, corners[i], corners[j]], towards.extend(0.0)).value()
                    });
                    let on_line = sides == [1; 3] || sides == [-1; 3];
                    // Only on the point's side of a centre.
                    let [a, b, c] = corners;
                    let normal = (b - a).cross(c - a);
                    on_line && (center.w == 0.0 || normal.dot(a - apex) / normal.dot(towards) > 0.0)
                })
                .collect();
            let mut met = met(&pencil, &triangles, target);
            met.retain(|index| {
                let [a, b, c] = triangles[*index as usize];
                let normal = (b - a).cross(c - a);
                center.w == 0.0 || normal.dot(a - center.truncate()) / normal.dot(towards) > 0.0
            });
            // On the line exactly, but for the rounding of `target − centre`, which both use.
            assert_eq!(met, expected, "round {round}, centre {center}, through {target}");
            found += expected.len();
        }
    }
    assert!(found > 3000, "{found} meetings");
}
