//! The arrays of a page: each is stored once, however often it is referred to.
//!
//! An array is rows of elements, an element is lanes of words, a word one byte or four. Packed, a word is the
//! difference from its prediction by its neighbours (left + above − above left, as integers: stored depth and most
//! colours are nearly planes) with the sign as its lowest bit, so that small differences have zeros in the upper bits;
//! then come the first bytes of all words, then all second ones, and so on; then zlib, then base64.
//! `assets/page/arrays.js` reverses this. Integers wrap, so every bit is restored.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use foldhash::quality::FixedState;
use serde::Serialize;
use std::collections::BTreeMap;
use std::hash::BuildHasher;
use std::io::Write;

/// The number type of an array's elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ArrayWord {
    /// A byte.
    U8,
    /// A little-endian integer of four bytes.
    U32,
    /// A little-endian float of four bytes.
    F32,
}

impl ArrayWord {
    fn bytes(self) -> usize {
        if self == ArrayWord::U8 { 1 } else { 4 }
    }
}

/// The word type, size and row length of an array's elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ArrayLayout {
    /// The number type of an array's elements.
    pub word: ArrayWord,
    /// How many words an element has.
    pub lanes: usize,
    /// How many elements a row has; 0: all are in one row.
    pub width: usize,
}

/// Index of an array in the page's list of arrays.
pub type ArrayIndex = usize;

/// The binary arrays of a page; the same bytes with the same layout are stored once.
#[derive(Debug, Default)]
pub struct PageArrays {
    entries: Vec<PageArray>,
    known: BTreeMap<(ArrayLayout, usize, u64), ArrayIndex>,
}

/// An array as the page stores it.
#[derive(Debug, Serialize)]
pub struct PageArray {
    word: ArrayWord,
    lanes: usize,
    width: usize,
    /// How many elements it has.
    length: usize,
    /// Words are differences from their predictions.
    predicted: bool,
    data: String,
}

impl PageArrays {
    /// Adds an array of little-endian bytes, and returns its index; that of an earlier one where the same bytes were
    /// added with the same layout.
    pub fn add(&mut self, layout: ArrayLayout, bytes: &[u8]) -> ArrayIndex {
        let key = (layout, bytes.len(), FixedState::with_seed(0).hash_one(bytes));
        if let Some(index) = self.known.get(&key) {
            return *index;
        }
        self.entries.push(pack(layout, bytes));
        self.known.insert(key, self.entries.len() - 1);
        self.entries.len() - 1
    }

    /// Returns all arrays, in the order of their indices.
    pub fn into_entries(self) -> Vec<PageArray> {
        self.entries
    }
}

fn pack(layout: ArrayLayout, bytes: &[u8]) -> PageArray {
    let ArrayLayout { word, lanes, width } = layout;
    let words = words(word, bytes);
    let [plain, predicted] = [deflated(&planes(&words, layout)), deflated(&planes(&residuals(&words, layout), layout))];
    let is_predicted = predicted.len() < plain.len();
    let data = BASE64_STANDARD.encode(if is_predicted { predicted } else { plain });
    PageArray { word, lanes, width, length: words.len() / lanes, predicted: is_predicted, data }
}

fn words(word: ArrayWord, bytes: &[u8]) -> Vec<u32> {
    match word {
        ArrayWord::U8 => bytes.iter().copied().map(u32::from).collect(),
        ArrayWord::U32 | ArrayWord::F32 => bytes.as_chunks().0.iter().copied().map(u32::from_le_bytes).collect(),
    }
}

/// Returns the difference of each word from its prediction (left plus up minus up-left neighbour of the same lane, with
/// zero for neighbours outside the array), folded so that small differences of either sign are small numbers: 0, −1, 1,
/// −2 become 0, 1, 2, 3.
fn residuals(words: &[u32], ArrayLayout { word, lanes, width }: ArrayLayout) -> Vec<u32> {
    let row = if width == 0 { words.len().max(1) } else { width * lanes };
    let at = |index: usize, left: usize, up: usize| {
        let is_inside = index % row >= left && index >= up;
        if is_inside { words[index - left - up] } else { 0 }
    };
    let residual = |index: usize| {
        let foretold = at(index, lanes, 0).wrapping_add(at(index, 0, row)).wrapping_sub(at(index, lanes, row));
        let residual = words[index].wrapping_sub(foretold);
        match word {
            ArrayWord::U8 => {
                let signed = (residual as u8).cast_signed();
                u32::from((signed << 1 ^ signed >> 7).cast_unsigned())
            }
            ArrayWord::U32 | ArrayWord::F32 => {
                (residual.cast_signed() << 1 ^ residual.cast_signed() >> 31).cast_unsigned()
            }
        }
    };
    (0..words.len()).map(residual).collect()
}

/// Returns the words' bytes sorted by lane and place: the first (lowest) byte of each of the first lane's words, then
/// their second bytes, and so on, then those of the next lane.
fn planes(words: &[u32], ArrayLayout { word, lanes, .. }: ArrayLayout) -> Vec<u8> {
    let plane =
        |lane: usize, byte: usize| words.iter().skip(lane).step_by(lanes).map(move |word| word.to_le_bytes()[byte]);
    (0..lanes).flat_map(|lane| (0..word.bytes()).flat_map(move |byte| plane(lane, byte))).collect()
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.expect("memory takes what is written to it")
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    /// Unpacks an array as `arrays.js` does.
    fn unpacked(entry: &PageArray) -> Vec<u8> {
        let deflated = BASE64_STANDARD.decode(&entry.data).expect("base64");
        let mut planes = Vec::new();
        ZlibDecoder::new(&deflated[..]).read_to_end(&mut planes).expect("zlib");
        let (size, lanes, length) = (entry.word.bytes(), entry.lanes, entry.length);
        assert_eq!(planes.len(), size * lanes * length);
        let row = if entry.width == 0 { length } else { entry.width } * lanes;
        let mut words = vec![0_u32; lanes * length];
        for index in 0..words.len() {
            let byte = |byte: usize| u32::from(planes[(index % lanes * size + byte) * length + index / lanes]);
            words[index] = (0..size).map(|at| byte(at) << (8 * at)).sum();
        }
        for index in (0..words.len()).filter(|_| entry.predicted) {
            let (left, up) = (index % row >= lanes, index >= row);
            let [a, b] =
                [left.then(|| words[index - lanes]), up.then(|| words[index - row])].map(Option::unwrap_or_default);
            let c = if left && up { words[index - lanes - row] } else { 0 };
            let own = words[index] >> 1 ^ (words[index] & 1).wrapping_neg();
            words[index] = own.wrapping_add(a).wrapping_add(b).wrapping_sub(c);
        }
        words.iter().flat_map(|word| word.to_le_bytes().into_iter().take(size)).collect()
    }

    fn noise(count: usize) -> Vec<u8> {
        let mut state = 7_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn every_bit_comes_back() {
        for (word, lanes, width) in [
            (ArrayWord::U8, 1, 12),
            (ArrayWord::U8, 4, 6),
            (ArrayWord::F32, 1, 6),
            (ArrayWord::F32, 4, 0),
            (ArrayWord::U32, 3, 0),
            (ArrayWord::U32, 3, 2),
        ] {
            let layout = ArrayLayout { word, lanes, width };
            let smooth: Vec<u8> = (0..144_u32).map(|at| (at / 12 + at % 12) as u8).collect();
            for bytes in [noise(144), smooth, vec![0xff; 144], Vec::new()] {
                assert_eq!(unpacked(&pack(layout, &bytes)), bytes, "{layout:?}");
            }
        }
    }

    /// Depth over the screen is a plane to the last bits; the remaining differences are small.
    #[test]
    fn a_plane_of_depths_packs_small() {
        let depth = |x: usize, y: usize| (0.001 + 0.000_01 * x as f64 + 0.000_02 * y as f64) as f32;
        let bytes: Vec<u8> = (0..64 * 64).flat_map(|at| depth(at % 64, at / 64).to_le_bytes()).collect();
        let entry = pack(ArrayLayout { word: ArrayWord::F32, lanes: 1, width: 64 }, &bytes);
        assert!(entry.predicted && entry.data.len() * 3 < bytes.len(), "{} of {}", entry.data.len(), bytes.len());
    }

    #[test]
    fn an_array_is_there_once() {
        let mut arrays = PageArrays::default();
        let layout = ArrayLayout { word: ArrayWord::U8, lanes: 1, width: 4 };
        let first = arrays.add(layout, &[1, 2, 3, 4]);
        let others = [arrays.add(layout, &[1, 2, 3, 5]), arrays.add(ArrayLayout { width: 2, ..layout }, &[1, 2, 3, 4])];
        assert_eq!(arrays.add(layout, &[1, 2, 3, 4]), first);
        assert!(!others.contains(&first) && arrays.into_entries().len() == 3);
    }
}
