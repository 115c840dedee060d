//! The files of a page, packed.
//!
//! A file is a header and numbers: those of a NumPy array, or bytes without a header. The numbers are rows of elements,
//! an element is lanes of words, a word one byte or four. Packed, a word is the difference from its prediction by its
//! neighbours (left + above − above left, as integers: stored depth and most colours are nearly planes) with the sign as
//! its lowest bit, so that small differences have zeros in the upper bits; then come the first bytes of all words, then
//! all second ones, and so on; then zlib, then base64. `assets/page/arrays.js` reverses this. Integers wrap, so every bit
//! is restored.

use crate::capture::disk::array_file;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use std::io::Write;

/// The number type of an array's elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum ArrayWord {
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ArrayLayout {
    /// The number type of an array's elements.
    word: ArrayWord,
    /// How many words an element has.
    lanes: usize,
    /// How many elements a row has; 0: all are in one row.
    width: usize,
}

/// A file as the page stores it.
#[derive(Debug, Serialize)]
pub struct PageFile {
    /// What is before the numbers, in base64.
    #[serde(skip_serializing_if = "String::is_empty")]
    header: String,
    /// The length of each dimension of an array, the slowest first; empty for a file that is no array.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shape: Vec<u64>,
    word: ArrayWord,
    lanes: usize,
    width: usize,
    /// How many elements it has.
    length: usize,
    /// Words are differences from their predictions.
    predicted: bool,
    data: String,
}

/// The most words that an element has: those of a corner, or of a colour.
const MOST_LANES: u64 = 8;

impl PageFile {
    /// Packs a file: the numbers of a NumPy array by its type and shape, any other file as bytes.
    pub fn pack(file: &[u8]) -> PageFile {
        let Some(array) = array_file(file) else {
            let layout = ArrayLayout { word: ArrayWord::U8, lanes: 1, width: 0 };
            return packed(layout, String::new(), Vec::new(), file);
        };
        let word = match array.kind.as_str() {
            "|u1" => ArrayWord::U8,
            "<u4" => ArrayWord::U32,
            _ => ArrayWord::F32,
        };
        // Of a picture the last dimension is its width, where texels have no lanes of their own.
        let (lanes, rows) = match array.shape.split_last() {
            Some((lanes @ 1..=MOST_LANES, rows)) if !rows.is_empty() => (*lanes as usize, rows),
            _ => (1, &array.shape[..]),
        };
        let width = if rows.len() > 1 { rows[rows.len() - 1] as usize } else { 0 };
        packed(
            ArrayLayout { word, lanes, width },
            BASE64_STANDARD.encode(array.header),
            array.shape.clone(),
            array.numbers,
        )
    }
}

fn packed(layout: ArrayLayout, header: String, shape: Vec<u64>, bytes: &[u8]) -> PageFile {
    let ArrayLayout { word, lanes, width } = layout;
    let words = words(word, bytes);
    let [plain, predicted] = [deflated(&planes(&words, layout)), deflated(&planes(&residuals(&words, layout), layout))];
    let is_predicted = predicted.len() < plain.len();
    let data = BASE64_STANDARD.encode(if is_predicted { predicted } else { plain });
    PageFile { header, shape, word, lanes, width, length: words.len() / lanes, predicted: is_predicted, data }
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

/// Returns bytes in zlib's form.
pub fn deflated(bytes: &[u8]) -> Vec<u8> {
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
    fn unpacked(entry: &PageFile) -> Vec<u8> {
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
        let numbers = words.iter().flat_map(|word| word.to_le_bytes().into_iter().take(size));
        let header = BASE64_STANDARD.decode(&entry.header).expect("base64");
        header.into_iter().chain(numbers).collect()
    }

    fn noise(count: usize) -> Vec<u8> {
        let mut state = 7_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..count).map(|_| next()).collect()
    }

    fn array(kind: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
        let words = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let length = u16::try_from(words.len()).expect("a short header").to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], words.as_bytes(), numbers].concat()
    }

    #[test]
    fn every_bit_of_a_file_comes_back() {
        for (kind, shape, lanes, width) in [
            ("|u1", "12, 12,", 1, 12),
            ("|u1", "6, 6, 4,", 4, 6),
            ("|u1", "36, 4,", 4, 0),
            ("<f4", "6, 6,", 6, 0),
            ("<f4", "9, 4,", 4, 0),
            ("<u4", "12, 3,", 3, 0),
            ("<u4", "36,", 1, 0),
            ("<f4", "3, 1, 12,", 1, 12),
        ] {
            let smooth: Vec<u8> = (0..144_u32).map(|at| (at / 12 + at % 12) as u8).collect();
            for bytes in [noise(144), smooth, vec![0xff; 144]] {
                let file = array(kind, shape, &bytes);
                let entry = PageFile::pack(&file);
                assert_eq!((entry.lanes, entry.width), (lanes, width), "{kind} {shape}");
                assert_eq!(unpacked(&entry), file, "{kind} {shape}");
            }
        }
        for text in [&b""[..], b"{}", &noise(100)] {
            assert_eq!(unpacked(&PageFile::pack(text)), text);
        }
    }

    /// Depth over the screen is a plane to the last bits; the remaining differences are small.
    #[test]
    fn a_plane_of_depths_packs_small() {
        let depth = |x: usize, y: usize| (0.001 + 0.000_01 * x as f64 + 0.000_02 * y as f64) as f32;
        let bytes: Vec<u8> = (0..64 * 64).flat_map(|at| depth(at % 64, at / 64).to_le_bytes()).collect();
        let entry = PageFile::pack(&array("<f4", "64, 64,", &bytes));
        assert!(entry.predicted && entry.data.len() * 3 < bytes.len(), "{} of {}", entry.data.len(), bytes.len());
    }
}
