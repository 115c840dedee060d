//! Wrong pixels, grouped: by light, kind, caster, receiver and what they look like.

use super::RegionKind;
use super::cause::Cause;
use crate::accuracy::{place, take_connected};

/// Pixels are connected if they are at most this many columns and rows apart, so that speckle is one region.
const REACH: u32 = 3;

/// The properties that all pixels of a region share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RegionKey {
    pub kind: RegionKind,
    /// Index of the object whose shadow is missing, in the truth's scene.
    pub caster: Option<usize>,
    /// Index of the object that is visible.
    pub receiver: Option<usize>,
    /// The cause that each single pixel suggests by itself; `None` where it suggests none.
    pub hint: Option<Cause>,
}

/// A connected region of wrong pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ConnectedRegion {
    pub key: RegionKey,
    pub light: usize,
    /// Indices of its pixels (row · width + column), ascending.
    pub pixels: Vec<usize>,
    /// Its first and last column and row: left, top, right, bottom.
    pub bounds: [u32; 4],
}

/// Finds the connected regions of a light, in reading order of their first pixels. `keys` has a key for each pixel,
/// row-major, `None` for a right one; pixels with equal keys that are at most `REACH` columns and rows apart are of one
/// region.
pub(crate) fn find(light: usize, mut keys: Vec<Option<RegionKey>>, size: [u32; 2]) -> Vec<ConnectedRegion> {
    let mut regions = Vec::new();
    for start in 0..keys.len() {
        let Some(key) = keys[start] else { continue };
        let mut pixels = Vec::new();
        take_connected(&mut keys, None, start, size, REACH, |index| pixels.push(index));
        pixels.sort_unstable();
        regions.extend(ConnectedRegion::of(key, light, pixels, size));
    }
    regions
}

impl ConnectedRegion {
    /// Makes the region of these pixels, ascending; `None` without any.
    pub fn of(key: RegionKey, light: usize, pixels: Vec<usize>, size: [u32; 2]) -> Option<ConnectedRegion> {
        let [x, y] = place(*pixels.first()?, size);
        let grow = |[left, top, right, bottom]: [u32; 4], index: &usize| {
            let [x, y] = place(*index, size);
            [left.min(x), top.min(y), right.max(x), bottom.max(y)]
        };
        let bounds = pixels.iter().fold([x, y, x, y], grow);
        Some(ConnectedRegion { key, light, pixels, bounds })
    }

    /// Returns up to `most` different pixels of the region (column, row): the innermost first, then others spread
    /// evenly in reading order.
    pub fn samples(&self, size: [u32; 2], most: usize) -> Vec<[u32; 2]> {
        let count = self.pixels.len();
        let inmost = self.inmost(size);
        let spread = (0..most).map(|step| self.pixels[(2 * step + 1) * count / (2 * most)]);
        let mut samples = vec![inmost];
        for index in spread {
            if samples.len() < most && !samples.contains(&index) {
                samples.push(index);
            }
        }
        samples.into_iter().map(|index| place(index, size)).collect()
    }

    /// Returns the index (row-major in the picture of this size) of a pixel among those that are left last when the
    /// region is eroded ring by ring.
    fn inmost(&self, size: [u32; 2]) -> usize {
        let [left, top, right, bottom] = self.bounds;
        let [width, height] = [right - left + 3, bottom - top + 3].map(|n| n as usize);
        let local = |index: usize| {
            let [x, y] = place(index, size);
            (y - top + 1) as usize * width + (x - left + 1) as usize
        };
        // Erodes the region ring by ring: the last pixel is the inmost.
        let mut inside = vec![false; width * height];
        self.pixels.iter().for_each(|index| inside[local(*index)] = true);
        let mut left_over = self.pixels.clone();
        loop {
            let is_inner = |index: &usize| {
                let at = local(*index);
                [at - 1, at + 1, at - width, at + width].iter().all(|near| inside[*near])
            };
            let inner: Vec<usize> = left_over.iter().copied().filter(is_inner).collect();
            if inner.is_empty() {
                return left_over[left_over.len() / 2];
            }
            inside.fill(false);
            inner.iter().for_each(|index| inside[local(*index)] = true);
            left_over = inner;
        }
    }

    /// Returns the region's bounding box: left, top, columns, rows.
    pub fn window(&self) -> [u32; 4] {
        let [left, top, right, bottom] = self.bounds;
        [left, top, right - left + 1, bottom - top + 1]
    }

    /// Returns the row-major indices of all pixels of the region's bounding box, also of those that are not in the
    /// region.
    pub fn boxed(&self, [width, _]: [u32; 2]) -> impl Iterator<Item = usize> + use<> {
        let [left, top, right, bottom] = self.bounds;
        (top..=bottom).flat_map(move |y| (left..=right).map(move |x| y as usize * width as usize + x as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::Finding;

    fn key(caster: usize) -> Option<RegionKey> {
        let kind = RegionKind::Wrong(Finding::FalseShadow);
        Some(RegionKey { kind, caster: Some(caster), receiver: None, hint: None })
    }

    #[test]
    fn speckle_is_one_region_and_another_caster_is_another() {
        let mut keys = vec![None; 40];
        (keys[0], keys[3], keys[9], keys[1]) = (key(0), key(0), key(0), key(1));
        let regions = find(0, keys, [20, 2]);
        let pixels: Vec<&[usize]> = regions.iter().map(|region| &region.pixels[..]).collect();
        assert_eq!(pixels, [&[0, 3][..], &[1], &[9]]);
        assert_eq!(regions[0].bounds, [0, 0, 3, 0]);
    }

    #[test]
    fn the_first_sample_lies_well_inside() {
        let size = [9, 9];
        let keys = (0..81).map(|index| key(0).filter(|_| index % 9 < 5 && index / 9 < 5)).collect();
        let regions = find(0, keys, size);
        let samples = regions[0].samples(size, 3);
        assert_eq!((samples.len(), samples[0]), (3, [2, 2]));
        assert_eq!(regions[0].boxed(size).count(), 25);
        let alone = find(0, (0..81).map(|index| key(0).filter(|_| index == 80)).collect(), size);
        assert_eq!(alone[0].samples(size, 3), [[8, 8]]);
    }
}
