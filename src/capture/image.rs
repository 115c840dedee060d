//! A picture in memory: rows of texels, top row first, possibly padded.
//!
//! Rows may be longer than their texels need (a GPU copy pads them to 256 bytes), so that a mapped GPU buffer can be
//! shown without copying it again. A picture that differs little from another in memory can share that one's rows
//! ([`Image::sharing`]): in a sequence of pictures, each costs only the rows that changed. Texels are read one at a
//! time or by row; [`PartialEq`] compares texels, not padding.

use bytes::Bytes;
use std::ops::Range;

/// Format of one texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PixelFormat {
    /// Four bytes: red, green, blue (sRGB), alpha.
    Rgba8Srgb,
    /// Four bytes: red, green, blue and alpha, linear.
    Rgba8,
    /// One little-endian `f32`: a stored depth.
    Depth32F,
    /// One little-endian `f32`: a signed count, a change of depth, or a share of light.
    Value32F,
    /// One byte: a stencil count or a label.
    U8,
}

impl PixelFormat {
    /// Returns the number of bytes of one texel: 1 or 4.
    pub fn texel_bytes(self) -> usize {
        match self {
            PixelFormat::Rgba8Srgb | PixelFormat::Rgba8 | PixelFormat::Depth32F | PixelFormat::Value32F => 4,
            PixelFormat::U8 => 1,
        }
    }
}

/// Rows of a strip: rows are shared by whole strips.
const STRIP_ROWS: u32 = 8;
/// A picture shares rows with another where at most so many quarters of its strips differ.
const MOST_CHANGED_QUARTERS: usize = 3;

/// A picture of texels of one format, rows from the top. Clones and parts of equal pictures may share memory.
#[derive(Clone)]
pub struct Image {
    format: PixelFormat,
    size: [u32; 2],
    /// Rows of a strip; the last may have fewer.
    strip_rows: u32,
    strips: Vec<RowStrip>,
}

/// Consecutive rows in one piece of memory.
#[derive(Clone)]
struct RowStrip {
    row_stride: usize,
    bytes: Bytes,
}

impl RowStrip {
    fn row(&self, y: u32, row_bytes: usize) -> &[u8] {
        let start = y as usize * self.row_stride;
        &self.bytes[start..start + row_bytes]
    }

    /// Returns these rows (counted from the strip's first) as a strip that shares its memory. `row_bytes` is the length
    /// of a row without padding.
    fn part(&self, rows: Range<u32>, row_bytes: usize) -> RowStrip {
        let start = rows.start as usize * self.row_stride;
        let last = rows.end.saturating_sub(1) as usize * self.row_stride;
        RowStrip { row_stride: self.row_stride, bytes: self.bytes.slice(start..last + row_bytes) }
    }
}

impl Image {
    /// Wraps rows, top first, that begin `row_stride` bytes apart. Nothing is copied where `bytes` is owned already;
    /// padding and bytes after the last row are ignored.
    ///
    /// # Panics
    /// If `bytes` is too short for the rows, or `row_stride` for the texels of one.
    pub fn from_rows(format: PixelFormat, size: [u32; 2], row_stride: usize, bytes: impl Into<Bytes>) -> Image {
        let bytes = bytes.into();
        let [width, height] = size.map(|n| n as usize);
        let row_bytes = width * format.texel_bytes();
        assert!(row_stride >= row_bytes, "a row of {row_bytes} bytes does not fit a stride of {row_stride}");
        let needed = height.checked_sub(1).map_or(0, |rows| rows * row_stride + row_bytes);
        assert!(bytes.len() >= needed, "{} bytes are too few for {needed}", bytes.len());
        Image::of_one_strip(format, size, RowStrip { row_stride, bytes })
    }

    fn of_one_strip(format: PixelFormat, size: [u32; 2], strip: RowStrip) -> Image {
        Image { format, size, strip_rows: size[1].max(1), strips: vec![strip] }
    }

    /// Wraps rows without padding.
    ///
    /// # Panics
    /// If `bytes` is too short.
    pub fn packed(format: PixelFormat, size: [u32; 2], bytes: impl Into<Bytes>) -> Image {
        Image::from_rows(format, size, size[0] as usize * format.texel_bytes(), bytes)
    }

    /// Returns a picture with the same texel everywhere, as a cleared attachment has. One row is stored.
    ///
    /// # Panics
    /// If `texel` has not the format's length.
    pub fn uniform(format: PixelFormat, size: [u32; 2], texel: &[u8]) -> Image {
        assert_eq!(texel.len(), format.texel_bytes());
        let row = texel.repeat(size[0] as usize);
        Image::of_one_strip(format, size, RowStrip { row_stride: 0, bytes: row.into() })
    }

    /// Returns an equal picture that uses the memory of `other` for every strip of rows that is equal there, and a copy
    /// of the rest; `None` where more than three quarters differ. The memory of `other` lives on as long as either
    /// picture.
    pub fn sharing(&self, other: &Image) -> Option<Image> {
        if (self.format, self.size) != (other.format, other.size) {
            return None;
        }
        let starts = (0..self.size[1]).step_by(STRIP_ROWS as usize);
        let rows_from = |start: u32| start..(start + STRIP_ROWS).min(self.size[1]);
        let shared = |rows: Range<u32>| {
            let is_equal = rows.clone().all(|y| self.row(y) == other.row(y));
            is_equal.then(|| other.strip(rows))
        };
        let shared: Vec<Option<RowStrip>> = starts.clone().map(|start| shared(rows_from(start))).collect();
        let changed = shared.iter().filter(|strip| strip.is_none()).count();
        if changed * 4 > shared.len() * MOST_CHANGED_QUARTERS {
            return None;
        }
        let copied = |start: u32| {
            let mut bytes = Vec::with_capacity(rows_from(start).len() * self.row_bytes());
            rows_from(start).for_each(|y| bytes.extend_from_slice(self.row(y)));
            RowStrip { row_stride: self.row_bytes(), bytes: bytes.into() }
        };
        let strips = starts.zip(shared).map(|(start, shared)| shared.unwrap_or_else(|| copied(start))).collect();
        Some(Image { format: self.format, size: self.size, strip_rows: STRIP_ROWS, strips })
    }

    /// Returns these rows of the picture in the same memory. All of them must lie in one of its strips.
    fn strip(&self, rows: Range<u32>) -> RowStrip {
        let index = rows.start / self.strip_rows;
        let first = index * self.strip_rows;
        self.strips[index as usize].part(rows.start - first..rows.end - first, self.row_bytes())
    }

    fn row_bytes(&self) -> usize {
        self.size[0] as usize * self.format.texel_bytes()
    }

    /// Returns the format of its texels.
    pub fn format(&self) -> PixelFormat {
        self.format
    }

    /// Returns the width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the ranges of memory addresses of its strips of rows, padding included: pictures that share rows return
    /// overlapping ranges.
    pub fn memory(&self) -> impl Iterator<Item = Range<usize>> {
        let place = |strip: &RowStrip| {
            let start = strip.bytes.as_ptr() as usize;
            start..start + strip.bytes.len()
        };
        self.strips.iter().map(place)
    }

    /// Returns the number of bytes of its memory that `other` does not use too; all of them where `other` is `None`.
    pub fn bytes_beside(&self, other: Option<&Image>) -> u64 {
        let others: Vec<Range<usize>> = other.into_iter().flat_map(Image::memory).collect();
        covered(self.memory().chain(others.iter().cloned()).collect()) - covered(others)
    }

    /// Returns the texels of row `y` (0 at the top), without padding.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, y: u32) -> &[u8] {
        assert!(y < self.size[1], "row {y} of {}", self.size[1]);
        self.strips[(y / self.strip_rows) as usize].row(y % self.strip_rows, self.row_bytes())
    }

    /// Returns a picture that is `times` smaller on each side: of each square of `times` by `times` texels, the texel
    /// in its middle, unfiltered. Columns and rows that don't fill a square are dropped.
    pub fn every(&self, times: u32) -> Image {
        let size = self.size.map(|side| side / times.max(1));
        let middle = |at: u32| at * times + times / 2;
        let texel = |x: u32, y: u32| self.texel([middle(x), middle(y)]).unwrap_or_default().to_vec();
        let bytes: Vec<u8> = (0..size[1]).flat_map(|y| (0..size[0]).flat_map(move |x| texel(x, y))).collect();
        Image::packed(self.format, size, bytes)
    }

    /// Returns a picture of `size` texels: each has what the texel of this picture has in which its middle lies.
    pub fn enlarged(&self, size: [u32; 2]) -> Image {
        // The middle of texel i of n is (2 i + 1) / 2 n of the way.
        let of = |at: u32, axis: usize| {
            let [from, to] = [self.size[axis], size[axis].max(1)].map(u64::from);
            ((2 * u64::from(at) + 1) * from / (2 * to)) as usize
        };
        let texel = self.format.texel_bytes();
        let columns: Vec<usize> = (0..size[0]).map(|x| of(x, 0) * texel).collect();
        let mut bytes = Vec::with_capacity(columns.len() * size[1] as usize * texel);
        let mut last = None;
        for y in (0..size[1]).map(|y| of(y, 1)) {
            let start = bytes.len();
            if last.replace(y) == Some(y) {
                bytes.extend_from_within(start - columns.len() * texel..);
            } else {
                let row = self.row(y as u32);
                columns.iter().for_each(|from| bytes.extend_from_slice(&row[*from..from + texel]));
            }
        }
        Image::packed(self.format, size, bytes)
    }

    /// Returns all rows, top first.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[u8]> {
        (0..self.size[1]).map(|y| self.row(y))
    }

    /// Returns the bytes of one texel; `None` outside the picture.
    pub fn texel(&self, [x, y]: [u32; 2]) -> Option<&[u8]> {
        if x >= self.size[0] || y >= self.size[1] {
            return None;
        }
        let bytes = self.format.texel_bytes();
        self.row(y).get(x as usize * bytes..(x as usize + 1) * bytes)
    }

    /// Returns one byte texel; `None` outside the picture or for another format.
    pub fn byte_at(&self, at: [u32; 2]) -> Option<u8> {
        (self.format == PixelFormat::U8).then(|| self.texel(at).map(|texel| texel[0])).flatten()
    }

    /// Returns the stored depth at a texel; `None` outside the picture, or where its format is not
    /// [`PixelFormat::Depth32F`].
    pub fn depth_at(&self, at: [u32; 2]) -> Option<f32> {
        let texel = (self.format == PixelFormat::Depth32F).then(|| self.texel(at)).flatten()?;
        Some(bytemuck::pod_read_unaligned(texel))
    }

    /// Returns all values, row by row; empty where its format is not [`PixelFormat::Value32F`].
    pub fn values(&self) -> Vec<f32> {
        let rows = self.rows().filter(|_| self.format == PixelFormat::Value32F);
        rows.flat_map(|row| row.chunks_exact(4)).map(bytemuck::pod_read_unaligned).collect()
    }

    /// Returns the signed count or the share of light at a texel; `None` outside the picture, or where its format is not
    /// [`PixelFormat::Value32F`].
    pub fn value_at(&self, at: [u32; 2]) -> Option<f32> {
        let texel = (self.format == PixelFormat::Value32F).then(|| self.texel(at)).flatten()?;
        Some(bytemuck::pod_read_unaligned(texel))
    }

    /// Returns one colour texel as its stored bytes, sRGB or linear as the format says; `None` outside the picture or
    /// for a format without colour.
    pub fn rgba_at(&self, at: [u32; 2]) -> Option<[u8; 4]> {
        let is_color = matches!(self.format, PixelFormat::Rgba8Srgb | PixelFormat::Rgba8);
        let texel = is_color.then(|| self.texel(at)).flatten()?;
        texel.try_into().ok()
    }

    /// Returns how many texels of a byte picture ([`PixelFormat::U8`]) have each value; all zero for another format.
    pub fn histogram(&self) -> [u64; 256] {
        let mut counts = [0; 256];
        if self.format == PixelFormat::U8 {
            self.rows().flatten().for_each(|value| counts[usize::from(*value)] += 1);
        }
        counts
    }
}

/// Returns the bytes that ranges of memory cover together; those of overlapping ranges count once.
pub(super) fn covered(mut places: Vec<Range<usize>>) -> u64 {
    places.sort_unstable_by_key(|place| (place.start, place.end));
    let mut end = 0;
    let own = places.into_iter().map(|place| {
        let own = place.end.saturating_sub(place.start.max(end));
        end = end.max(place.end);
        own as u64
    });
    own.sum()
}

impl PartialEq for Image {
    fn eq(&self, other: &Image) -> bool {
        self.format == other.format && self.size == other.size && self.rows().eq(other.rows())
    }
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Image({:?}, {}x{})", self.format, self.size[0], self.size[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 5×20 stencil values, `at` of them 9.
    fn picture(row_stride: usize, at: &[(usize, usize)]) -> Image {
        let mut bytes = vec![0xEE; row_stride * 20];
        bytes.chunks_mut(row_stride).for_each(|row| row[..5].fill(1));
        at.iter().for_each(|(x, y)| bytes[y * row_stride + x] = 9);
        Image::from_rows(PixelFormat::U8, [5, 20], row_stride, bytes)
    }

    fn shared_bytes(images: &[&Image]) -> usize {
        let places: std::collections::BTreeSet<(usize, usize)> =
            images.iter().flat_map(|image| image.memory()).map(|place| (place.start, place.end)).collect();
        places.iter().map(|(start, end)| end - start).sum()
    }

    #[test]
    fn what_is_shared_is_the_same_picture_and_takes_what_differs() {
        let first = picture(8, &[]);
        let second = picture(8, &[(2, 9)]);
        let shared = second.sharing(&first).expect("one strip of three differs");
        assert_eq!((&shared, shared.texel([2, 9])), (&second, Some(&[9][..])));
        assert_ne!(shared, first);
        let within = first.memory().next().expect("a place");
        let own = shared.memory().filter(|place| place.start < within.start || place.end > within.end);
        assert_eq!(own.map(|place| place.len()).collect::<Vec<_>>(), [8 * 5]);
        // A third has the strips of both.
        let third = picture(16, &[(2, 9), (4, 19)]);
        let of_both = third.sharing(&shared).expect("one strip differs");
        assert_eq!((&of_both, of_both.rows().len()), (&third, 20));
        assert_eq!(shared_bytes(&[&shared, &of_both]), shared_bytes(&[&shared]) + 4 * 5);
    }

    #[test]
    fn memory_that_overlaps_counts_once() {
        let first = picture(8, &[]);
        let shared = picture(8, &[(2, 9)]).sharing(&first).expect("one strip of three differs");
        let places = first.memory().chain(shared.memory()).collect();
        assert_eq!(covered(places), 8 * 20 + 8 * 5);
        assert_eq!(covered(vec![3..5, 0..10, 10..12, 20..21]), 13);
    }

    #[test]
    fn a_cleared_picture_shares_its_one_row() {
        let cleared = Image::uniform(PixelFormat::U8, [5, 20], &[1]);
        let drawn = picture(8, &[(0, 0)]);
        let shared = drawn.sharing(&cleared).expect("one strip differs");
        assert_eq!(shared, drawn);
        assert_eq!(shared_bytes(&[&shared]), 5 + 8 * 5);
    }

    #[test]
    fn what_differs_everywhere_or_is_of_another_kind_shares_nothing() {
        let everywhere: Vec<(usize, usize)> = (0..20).map(|y| (y % 5, y)).collect();
        assert!(picture(8, &everywhere).sharing(&picture(8, &[])).is_none());
        let other = Image::uniform(PixelFormat::U8, [5, 19], &[1]);
        assert!(picture(8, &[]).sharing(&other).is_none());
    }
}
