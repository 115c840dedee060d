//! Lists, strips and fans as triangles of three indices, each with the winding that the API gives it.

use super::raw::RawTopology;

/// Returns the triangles of a run of corners; empty for points and lines. `corners` are indices of vertices, `None`
/// where the primitive restarts.
pub fn triangles(topology: RawTopology, corners: &[Option<u32>]) -> Vec<[u32; 3]> {
    corners.split(Option::is_none).flat_map(|run| of_run(topology, run)).collect()
}

fn of_run(topology: RawTopology, run: &[Option<u32>]) -> Vec<[u32; 3]> {
    let run: Vec<u32> = run.iter().copied().flatten().collect();
    let every_second = || run.iter().copied().step_by(2).collect::<Vec<u32>>();
    match topology {
        RawTopology::TriangleList => run.as_chunks::<3>().0.to_vec(),
        RawTopology::TriangleStrip => strip(&run),
        RawTopology::TriangleFan => fan(&run),
        RawTopology::TriangleListAdjacency => {
            run.as_chunks::<6>().0.iter().map(|[a, _, b, _, c, _]| [*a, *b, *c]).collect()
        }
        // Corners and adjacent corners alternate; a last corner without an adjacent one makes no triangle.
        RawTopology::TriangleStripAdjacency => strip(&every_second()[..run.len() / 2]),
        RawTopology::Points | RawTopology::Lines | RawTopology::Other => Vec::new(),
    }
}

/// Returns the triangles of a strip, corners less two. Every second one has its first two corners swapped, so that all
/// have the same winding.
fn strip(run: &[u32]) -> Vec<[u32; 3]> {
    let triangle = |(at, three): (usize, &[u32])| match at % 2 {
        0 => [three[0], three[1], three[2]],
        _ => [three[1], three[0], three[2]],
    };
    run.windows(3).enumerate().map(triangle).collect()
}

fn fan(run: &[u32]) -> Vec<[u32; 3]> {
    let Some((first, rest)) = run.split_first() else { return Vec::new() };
    rest.windows(2).map(|two| [*first, two[0], two[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unrolled(topology: RawTopology, corners: &[u32]) -> Vec<[u32; 3]> {
        triangles(topology, &corners.iter().map(|&corner| (corner != 99).then_some(corner)).collect::<Vec<_>>())
    }

    #[test]
    fn lists_leave_out_an_unfinished_triangle() {
        assert_eq!(unrolled(RawTopology::TriangleList, &[4, 5, 6, 7, 8, 9, 1, 2]), [[4, 5, 6], [7, 8, 9]]);
    }

    /// A strip that zigzags over a square grid: all triangles have the same winding.
    #[test]
    fn all_triangles_of_a_strip_turn_the_same_way() {
        let place = |corner: u32| [f64::from(corner / 2), f64::from(corner % 2)];
        let found = unrolled(RawTopology::TriangleStrip, &[0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(found.len(), 5);
        for [a, b, c] in found.into_iter().map(|triangle| triangle.map(place)) {
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert_eq!(area, -1.0);
        }
    }

    #[test]
    fn a_fan_shares_its_first_corner() {
        assert_eq!(unrolled(RawTopology::TriangleFan, &[7, 1, 2, 3]), [[7, 1, 2], [7, 2, 3]]);
        assert!(unrolled(RawTopology::TriangleFan, &[7, 1]).is_empty());
        assert!(unrolled(RawTopology::TriangleFan, &[]).is_empty());
    }

    #[test]
    fn a_restart_begins_anew() {
        let strip = unrolled(RawTopology::TriangleStrip, &[0, 1, 2, 3, 99, 4, 5, 6, 99, 99, 7, 8]);
        assert_eq!(strip, [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
        assert_eq!(unrolled(RawTopology::TriangleFan, &[0, 1, 2, 99, 3, 4, 5]), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(unrolled(RawTopology::TriangleList, &[0, 1, 99, 2, 3, 4]), [[2, 3, 4]]);
    }

    #[test]
    fn neighbours_across_edges_are_no_corners() {
        let list = unrolled(RawTopology::TriangleListAdjacency, &[0, 10, 1, 11, 2, 12, 3]);
        assert_eq!(list, [[0, 1, 2]]);
        let strip = unrolled(RawTopology::TriangleStripAdjacency, &[0, 10, 1, 11, 2, 12, 3, 13]);
        assert_eq!(strip, [[0, 1, 2], [2, 1, 3]]);
    }

    #[test]
    fn points_and_lines_have_no_triangles() {
        for topology in [RawTopology::Points, RawTopology::Lines, RawTopology::Other] {
            assert!(unrolled(topology, &[0, 1, 2, 3]).is_empty());
        }
    }
}
