//! Where two pictures of one kind differ: regions, the largest first, to go from one to the next, and a veil over all else.

use crate::accuracy::{place, take_connected};
use crate::capture::{Image, PixelFormat};
use std::cmp::Reverse;
use std::sync::Arc;

/// How many pairs of pictures are cached.
const MOST_CACHED: usize = 4;
/// Texels of the largest region that is hardly seen.
const SPECK: u64 = 9;
/// The grey under what differs where no picture can lie there.
const PLAIN_GROUND: u8 = 40;
/// The grey around what differs: much lighter than any ground, as what differs is often a shadow, and as dark as that.
const OUTLINE: u8 = 236;

/// A connected region of texels that differ, corners included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DifferingPlace {
    /// A texel of it that is as far from its edge as any: column and row.
    pub inmost: [u32; 2],
    /// The number of its texels.
    pub texels: u64,
}

/// The regions in which two pictures differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DifferingRegions {
    size: [u32; 2],
    /// For each texel, row by row, the index of its region plus 1; 0 where both are the same.
    of: Vec<u32>,
    /// The regions, the largest first.
    pub regions: Vec<DifferingPlace>,
    /// The inmost texels of regions that are so small that they are hardly seen.
    pub specks: Vec<[u32; 2]>,
}

impl DifferingRegions {
    /// Finds the regions in which two pictures differ bit by bit; `None` where they are of other formats or sizes.
    pub fn of(a: &Image, b: &Image) -> Option<DifferingRegions> {
        let size = a.size();
        let mut differs: Vec<bool> = differing(a, b)?.collect();
        let away = edge_distances(&differs, size[0] as usize);
        let mut found = Vec::new();
        for start in 0..differs.len() {
            if differs[start] {
                let mut texels: Vec<u32> = Vec::new();
                // A picture has fewer texels than 2³².
                take_connected(&mut differs, false, start, size, 1, |index| texels.push(index as u32));
                texels.sort_unstable();
                found.push(texels);
            }
        }
        found.sort_by_key(|texels| Reverse(texels.len()));
        let mut of = vec![0_u32; differs.len()];
        for (region, texels) in (1_u32..).zip(&found) {
            texels.iter().for_each(|index| of[*index as usize] = region);
        }
        let regions = found.iter().filter_map(|texels| {
            let away = |index: &u32| away[*index as usize];
            let most = texels.iter().map(away).max()?;
            let inmost = || texels.iter().filter(|index| away(index) == most);
            let inmost = place(*inmost().nth(inmost().count() / 2)? as usize, size);
            Some(DifferingPlace { inmost, texels: texels.len() as u64 })
        });
        let regions: Vec<DifferingPlace> = regions.collect();
        let specks = regions.iter().filter(|region| region.texels <= SPECK).map(|region| region.inmost).collect();
        Some(DifferingRegions { size, regions, specks, of })
    }

    /// Returns the index of the region that contains a texel; `None` where both pictures are the same there, and outside.
    pub fn at(&self, [x, y]: [u32; 2]) -> Option<usize> {
        let is_inside = x < self.size[0] && y < self.size[1];
        let index = (y as usize * self.size[0] as usize) + x as usize;
        is_inside.then(|| self.of[index].checked_sub(1)).flatten().map(|region| region as usize)
    }

    /// Returns the region to go to from a texel, `by` regions on, or back where it is negative: from one outside of all, or
    /// from none, the largest; after the smallest, the largest again. `None` where nothing differs.
    pub fn from(&self, at: Option<[u32; 2]>, by: isize) -> Option<&DifferingPlace> {
        let next = match at.and_then(|at| self.at(at)) {
            Some(region) => (region as isize + by).rem_euclid(self.regions.len() as isize) as usize,
            None => 0,
        };
        self.regions.get(next)
    }
}

/// Returns for each texel, row by row, whether two pictures differ there bit by bit; `None` where they are of other formats
/// or sizes.
fn differing<'a>(a: &'a Image, b: &'a Image) -> Option<impl Iterator<Item = bool> + 'a> {
    let texel = a.format().texel_bytes();
    let of_rows =
        move |(a, b): (&'a [u8], &'a [u8])| a.chunks_exact(texel).zip(b.chunks_exact(texel)).map(|(a, b)| a != b);
    ((a.format(), a.size()) == (b.format(), b.size())).then(|| a.rows().zip(b.rows()).flat_map(of_rows))
}

/// Returns for each texel of rows of this width how many steps along rows and columns it is from the nearest one that does
/// not differ, or from the border; 0 where it does not itself.
fn edge_distances(differs: &[bool], width: usize) -> Vec<u32> {
    let mut away: Vec<u32> = differs.iter().map(|differs| if *differs { u32::MAX } else { 0 }).collect();
    let nearer = |away: &[u32], index: usize, has_row: bool, has_column: bool, [row, column]: [usize; 2]| {
        let [row, column] = [(has_row, row), (has_column, column)].map(|(has, near)| if has { away[near] } else { 0 });
        away[index].min(row.min(column).saturating_add(1))
    };
    for index in 0..away.len() {
        let near = [index.wrapping_sub(width), index.wrapping_sub(1)];
        away[index] = nearer(&away, index, index >= width, !index.is_multiple_of(width), near);
    }
    for index in (0..away.len()).rev() {
        let has_next = !(index + 1).is_multiple_of(width);
        away[index] = nearer(&away, index, index + width < away.len(), has_next, [index + width, index + 1]);
    }
    away
}

/// What was found of so many images; `None` where there is nothing to find.
type FoundOf<const IMAGES: usize, Found> = ([Arc<Image>; IMAGES], Option<Arc<Found>>);

/// A small cache of where pictures differ, found again by the images' addresses.
#[derive(Debug, Default)]
pub struct DifferenceCache {
    regions: Vec<FoundOf<2, DifferingRegions>>,
    veils: Vec<FoundOf<3, Image>>,
}

impl DifferenceCache {
    /// Drops all.
    pub fn forget(&mut self) {
        *self = DifferenceCache::default();
    }

    /// Returns the regions in which two pictures differ; `None` where they are of other formats or sizes.
    pub fn regions(&mut self, pair: [&Arc<Image>; 2]) -> Option<Arc<DifferingRegions>> {
        found(&mut self.regions, pair, || DifferingRegions::of(pair[0], pair[1]).map(Arc::new))
    }

    /// Returns the regions in which two pictures differ where they were asked for before.
    pub fn known_regions(&self, pair: [&Arc<Image>; 2]) -> Option<Arc<DifferingRegions>> {
        self.regions.iter().find(|(of, _)| is_of(of, pair)).and_then(|(_, regions)| regions.clone())
    }

    /// Returns what lies over either of two pictures, so that only what differs is seen: `ground`, of sRGB bytes, see-through
    /// (alpha 0) where the two differ and light on the texels beside those, or one grey where it has another size; `None`
    /// where they are of other formats or sizes.
    pub fn veil(&mut self, pair: [&Arc<Image>; 2], ground: &Arc<Image>) -> Option<Arc<Image>> {
        found(&mut self.veils, [pair[0], pair[1], ground], || veil(pair, ground).map(Arc::new))
    }
}

fn is_of<const N: usize>(of: &[Arc<Image>; N], images: [&Arc<Image>; N]) -> bool {
    of.iter().zip(images).all(|(of, image)| Arc::ptr_eq(of, image))
}

/// Returns what is cached for these images, or makes and caches it.
fn found<const N: usize, T: Clone>(
    cached: &mut Vec<([Arc<Image>; N], T)>,
    images: [&Arc<Image>; N],
    make: impl FnOnce() -> T,
) -> T {
    if let Some((_, known)) = cached.iter().find(|(of, _)| is_of(of, images)) {
        return known.clone();
    }
    if cached.len() >= MOST_CACHED {
        cached.remove(0);
    }
    let made = make();
    cached.push((images.map(Arc::clone), made.clone()));
    made
}

fn veil([a, b]: [&Arc<Image>; 2], ground: &Image) -> Option<Image> {
    let ground = (ground.size() == a.size()).then_some(ground);
    let mut under = ground.into_iter().flat_map(|ground| ground.rows().flat_map(|row| row.chunks_exact(4)));
    let differs: Vec<bool> = differing(a, b)?.collect();
    let width = a.size()[0] as usize;
    let mut bytes = Vec::with_capacity(differs.len() * 4);
    for index in 0..differs.len() {
        let ground = under.next().map_or([PLAIN_GROUND; 3], |texel| [texel[0], texel[1], texel[2]]);
        let is_beside = || {
            let column = index % width;
            column > 0 && differs[index - 1]
                || column + 1 < width && differs[index + 1]
                || index >= width && differs[index - width]
                || differs.get(index + width) == Some(&true)
        };
        let [red, green, blue] = if !differs[index] && is_beside() { [OUTLINE; 3] } else { ground };
        bytes.extend([red, green, blue, if differs[index] { 0 } else { 255 }]);
    }
    Some(Image::packed(PixelFormat::Rgba8Srgb, a.size(), bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(values: &[u8]) -> Arc<Image> {
        Arc::new(Image::packed(PixelFormat::U8, [values.len() as u32, 1], values.to_vec()))
    }

    #[test]
    fn a_veil_lies_where_nothing_differs() {
        let mut cache = DifferenceCache::default();
        let pair = [bytes(&[1, 2, 2]), bytes(&[1, 2, 3])];
        let ground = Arc::new(Image::packed(PixelFormat::Rgba8Srgb, [3, 1], vec![84; 12]));
        let veil = cache.veil([&pair[0], &pair[1]], &ground).expect("pictures of one kind");
        let outline = [OUTLINE, OUTLINE, OUTLINE, 255];
        assert_eq!(veil.row(0), [[84, 84, 84, 255], outline, [84, 84, 84, 0]].concat());
        let again = cache.veil([&pair[0], &pair[1]], &ground).expect("pictures of one kind");
        assert!(Arc::ptr_eq(&veil, &again));
        let larger = Arc::new(Image::uniform(PixelFormat::Rgba8Srgb, [4, 1], &[200; 4]));
        let plain = cache.veil([&pair[0], &pair[1]], &larger).expect("pictures of one kind");
        assert_eq!(plain.row(0)[0], PLAIN_GROUND);
        assert_eq!(cache.veil([&pair[0], &bytes(&[1])], &ground), None);
    }

    #[test]
    fn what_differs_is_outlined_on_all_four_sides_and_not_across_a_border() {
        let picture = |at: usize| {
            let mut bytes = vec![0; 12];
            bytes[at] = 1;
            Arc::new(Image::packed(PixelFormat::U8, [4, 3], bytes))
        };
        let plain = Arc::new(Image::uniform(PixelFormat::U8, [4, 3], &[0]));
        let ground = Arc::new(Image::uniform(PixelFormat::Rgba8Srgb, [4, 3], &[9, 9, 9, 255]));
        let outlined = |at: usize| {
            let veil = veil([&plain, &picture(at)], &ground).expect("pictures of one kind");
            let texels: Vec<u8> = veil.rows().flat_map(|row| row.chunks_exact(4).map(|texel| texel[0])).collect();
            (0..12).filter(|index| texels[*index] == OUTLINE).collect::<Vec<_>>()
        };
        assert_eq!(outlined(5), [1, 4, 6, 9]);
        assert_eq!(outlined(4), [0, 5, 8], "the end of the row before is not beside it");
        assert_eq!(outlined(11), [7, 10]);
    }

    #[test]
    fn the_largest_is_the_first_and_the_way_leads_round() {
        let picture = |rows: [&[u8; 7]; 4]| Image::packed(PixelFormat::U8, [7, 4], rows.map(|row| &row[..]).concat());
        let a = picture([&[0; 7]; 4]);
        let b =
            picture([&[9, 0, 1, 1, 1, 0, 0], &[0, 0, 1, 1, 1, 0, 0], &[0, 0, 1, 1, 1, 0, 0], &[2, 0, 0, 0, 0, 0, 0]]);
        let found = DifferingRegions::of(&a, &b).expect("pictures of one kind");
        let places: Vec<([u32; 2], u64)> = found.regions.iter().map(|one| (one.inmost, one.texels)).collect();
        assert_eq!(places, [([3, 1], 9), ([0, 0], 1), ([0, 3], 1)]);
        assert_eq!(found.specks.len(), 3);
        assert_eq!([found.at([4, 2]), found.at([6, 3]), found.at([7, 0])], [Some(0), None, None]);
        let from = |at: Option<[u32; 2]>, by: isize| found.from(at, by).expect("a region").inmost;
        assert_eq!([from(None, 1), from(Some([6, 3]), -1), from(Some([2, 0]), 1)], [[3, 1], [3, 1], [0, 0]]);
        assert_eq!([from(Some([0, 3]), 1), from(Some([4, 2]), -1)], [[3, 1], [0, 3]]);
        assert_eq!(DifferingRegions::of(&a, &a).expect("pictures of one kind").from(None, 1), None);
        assert_eq!(DifferingRegions::of(&a, &Image::uniform(PixelFormat::U8, [7, 3], &[0])), None);
    }
}
