//! Faces of model files as triangles: cutting one with any number of corners, strips, and normals where a file has
//! none.
//!
//! The face is projected along its Newell normal (which exists for corners that are not quite coplanar, too), by
//! dropping the axis in which that normal is longest. Convex faces become a fan, others are cut ear by ear. Triangles
//! have the winding of the face.

use glam::{DVec2, DVec3, Vec3};

/// Corners of the largest face whose ears are cut: where it crosses itself that takes time by their square. A larger
/// one is a fan, of the same outline.
const MOST_EARS: usize = 1 << 14;

/// Calls `add` with each triangle of a face, as indices into its corners, of which there are at least three: ears where
/// it is not convex, otherwise, or where that fails or there are very many corners, a fan. All have the face's winding.
pub fn triangulate(corners: &[DVec3], add: impl FnMut([usize; 3])) {
    let ears = match corners.len() {
        3 | MOST_EARS.. => None,
        _ => projected(corners).filter(|flat| !is_convex(flat)).and_then(|flat| cut_ears(&flat)),
    };
    match ears {
        Some(ears) => ears.into_iter().for_each(add),
        None => fan(corners.len()).for_each(add),
    }
}

/// Returns triangles of a strip, as indices into its corners, all with the winding of the first.
#[cfg(feature = "formats")]
pub fn strip(count: usize) -> impl Iterator<Item = [usize; 3]> {
    (2..count).map(|last| if last % 2 == 0 { [last - 2, last - 1, last] } else { [last - 2, last, last - 1] })
}

/// Returns the normal of a triangle, of unit length; zero where it has no area.
pub fn normal([a, b, c]: [DVec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

fn fan(count: usize) -> impl Iterator<Item = [usize; 3]> {
    (2..count).map(|last| [0, last - 1, last])
}

/// Returns the corners in the plane in which they are seen largest, counter-clockwise and scaled; `None` where the face
/// has no area.
fn projected(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    // Scaled to about 1, so that no product overflows.
    let first = *corners.first()? / 2.0;
    let halves = || corners.iter().map(|corner| *corner / 2.0 - first);
    let size = halves().map(|half| half.abs().max_element()).fold(0.0, f64::max);
    if size == 0.0 {
        return None;
    }
    let scaled: Vec<DVec3> = halves().map(|half| half / size).collect();
    let following = scaled.iter().cycle().skip(1);
    let normal: DVec3 = scaled.iter().zip(following).map(|(a, b)| a.cross(*b)).sum();
    let axis = normal.abs().max_position();
    let (u, v) = if normal[axis] > 0.0 { ((axis + 1) % 3, (axis + 2) % 3) } else { ((axis + 2) % 3, (axis + 1) % 3) };
    (normal[axis] != 0.0).then(|| scaled.iter().map(|p| DVec2::new(p[u], p[v])).collect())
}

/// Returns whether the outline never turns right (straight on counts as left) and goes round once.
fn is_convex(flat: &[DVec2]) -> bool {
    let edge = |i: usize| flat[(i + 1) % flat.len()] - flat[i % flat.len()];
    let turns_left = (0..flat.len()).all(|i| edge(i).perp_dot(edge(i + 1)) >= 0.0);
    // A star turns left everywhere, too, but runs back and forth more than once.
    let directions: Vec<bool> = (0..flat.len()).map(edge).filter(|e| e.x != 0.0).map(|e| e.x > 0.0).collect();
    let reversals = (0..directions.len()).filter(|i| directions[*i] != directions[(i + 1) % directions.len()]).count();
    turns_left && reversals <= 2
}

/// Cuts a counter-clockwise face into triangles, all counter-clockwise; `None` where that gives none. A face that
/// crosses itself may not be covered.
fn cut_ears(flat: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let no_holes: [usize; 0] = [];
    let mut indices: Vec<usize> = Vec::new();
    earcut::Earcut::new().earcut(flat.iter().map(|p| p.to_array()), &no_holes, &mut indices);
    let area = |[a, b, c]: [usize; 3]| (flat[b] - flat[a]).perp_dot(flat[c] - flat[a]);
    let (triples, _) = indices.as_chunks::<3>();
    let flipped = triples.iter().map(|&[a, b, c]| if area([a, b, c]) < 0.0 { [a, c, b] } else { [a, b, c] });
    (!triples.is_empty()).then(|| flipped.collect())
}
