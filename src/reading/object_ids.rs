//! The object that is seen at each pixel: triangles are drawn on the CPU, the nearest wins, once for a frame.

use crate::anatomy::Anatomy;
use crate::capture::{Capture, Image, PixelFormat};
use crate::reading::projected::Projector;
use glam::DVec2;

/// Texel values of [`ObjectIds::receivers`]: not on a receiver, inside one, at a receiver's outline.
pub const RECEIVER_INKS: [u8; 3] = [0, 1, 2];

/// What a picture shows of each object: a mask of receivers, and a pixel to label each object at.
#[derive(Debug)]
pub struct ObjectIds {
    /// Where receivers are seen: a byte for each pixel, one of [`RECEIVER_INKS`].
    pub receivers: Image,
    /// For each object, its pixel nearest to the mean of its visible pixels; `None` where it is hidden.
    pub middles: Vec<Option<[u32; 2]>>,
}

impl ObjectIds {
    /// Draws the visible objects of `anatomy` on the CPU as the camera of `capture` sees them, and returns where
    /// receivers are, with their outlines, and a pixel in the middle of each object.
    pub fn new(anatomy: &Anatomy, capture: &Capture) -> ObjectIds {
        let ids = draw(anatomy, capture);
        let [width, height] = capture.size.map(|side| side as usize);
        let middles = middles(&ids, width, anatomy.objects.len());
        let receives = |id: u32| id > 0 && anatomy.objects[id as usize - 1].receives;
        let ink = |index: usize| {
            let (x, y) = (index % width, index / width);
            let here = ids[index];
            if !receives(here) {
                return RECEIVER_INKS[0];
            }
            let differs = |other: usize| ids[other] != here;
            let is_edge = (x > 0 && differs(index - 1))
                || (x + 1 < width && differs(index + 1))
                || (y > 0 && differs(index - width))
                || (y + 1 < height && differs(index + width));
            RECEIVER_INKS[if is_edge { 2 } else { 1 }]
        };
        let bytes: Vec<u8> = (0..ids.len()).map(ink).collect();
        ObjectIds { receivers: Image::packed(PixelFormat::U8, capture.size, bytes), middles }
    }
}

/// Returns for each pixel, row by row, the index of the nearest visible object plus 1; 0 where there is none. Of two at
/// the same depth, the first one stays.
fn draw(anatomy: &Anatomy, capture: &Capture) -> Vec<u32> {
    let size = capture.size.map(|side| side as usize);
    let projector = Projector::new(capture);
    let mut ids = vec![0_u32; size[0] * size[1]];
    let mut nearness = vec![0.0_f64; ids.len()];
    for (index, object) in anatomy.objects.iter().enumerate().filter(|(_, object)| object.visible) {
        for triangle in object.mesh.triangles() {
            let polygon = projector.polygon(triangle.map(|corner| object.positions[corner as usize].extend(1.0)));
            for last in 2..polygon.len() {
                fill([polygon[0], polygon[last - 1], polygon[last]], size, |at, near| {
                    if near > nearness[at] {
                        nearness[at] = near;
                        ids[at] = index as u32 + 1;
                    }
                });
            }
        }
    }
    ids
}

/// Rasterises a triangle: calls `add` with the index of each pixel whose centre it covers, and its interpolated
/// nearness there. Each corner is a position in pixels and its nearness.
pub fn fill(corners: [(DVec2, f64); 3], [width, height]: [usize; 2], mut add: impl FnMut(usize, f64)) {
    let [a, b, c] = corners.map(|(place, _)| place);
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 {
        return;
    }
    let low = a.min(b).min(c).floor().max(DVec2::ZERO);
    let high = a.max(b).max(c).ceil();
    let end = |value: f64, most: usize| (value.max(0.0) as usize).min(most);
    for y in low.y as usize..end(high.y, height) {
        for x in low.x as usize..end(high.x, width) {
            let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let shares =
                [(c - b).perp_dot(at - b), (a - c).perp_dot(at - c), (b - a).perp_dot(at - a)].map(|s| s / area);
            if shares.iter().all(|share| *share >= 0.0) {
                let near = shares[0] * corners[0].1 + shares[1] * corners[1].1 + shares[2] * corners[2].1;
                add(y * width + x, near);
            }
        }
    }
}

/// Returns, for each object, the pixel of it that is nearest to the mean of its pixels; `None` where no pixel shows it.
/// `ids` are object indices plus 1, row by row.
fn middles(ids: &[u32], width: usize, objects: usize) -> Vec<Option<[u32; 2]>> {
    let mut sums = vec![(DVec2::ZERO, 0.0_f64); objects];
    let place = |index: usize| DVec2::new((index % width) as f64, (index / width) as f64);
    let seen = || ids.iter().enumerate().filter_map(|(index, id)| Some((place(index), id.checked_sub(1)? as usize)));
    for (at, object) in seen() {
        sums[object].0 += at;
        sums[object].1 += 1.0;
    }
    let mut nearest = vec![(f64::INFINITY, None); objects];
    for (at, object) in seen() {
        let (sum, count) = sums[object];
        let distance = at.distance_squared(sum / count);
        if distance < nearest[object].0 {
            nearest[object] = (distance, Some([at.x as u32, at.y as u32]));
        }
    }
    nearest.into_iter().map(|(_, at)| at).collect()
}
