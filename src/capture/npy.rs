//! NumPy's array files (`.npy`; NumPy Enhancement Proposal 1): little-endian numbers in C order.
//!
//! Of all that such a header may describe, our folders have four kinds of numbers and a shape. Only these are written
//! and read here, in one piece instead of number by number; everything else is refused by name.

use std::io::{self, Read, Write};

const MAGIC: &[u8; 6] = b"\x93NUMPY";
/// The numbers begin at a multiple of this many bytes.
const ALIGNMENT: usize = 64;
/// Bytes of the longest header that is read, and dimensions of the deepest array.
const LONGEST: usize = 4096;
const MOST_DIMENSIONS: usize = 8;

// Numbers are written in their byte order in memory.
const _: () = assert!(cfg!(target_endian = "little"));

/// A type of number that arrays have.
pub(super) trait Element: bytemuck::Pod {
    /// NumPy's name of it (`dtype.str`).
    const KIND: &'static str;
}

impl Element for u8 {
    const KIND: &'static str = "|u1";
}

impl Element for u32 {
    const KIND: &'static str = "<u4";
}

impl Element for f32 {
    const KIND: &'static str = "<f4";
}

/// Writes the header (version 1.0) of a C-order NumPy array of this shape. The caller writes the numbers after it, row
/// by row.
pub(super) fn write_header<T: Element>(out: &mut impl Write, shape: &[u64]) -> io::Result<()> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let words = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({sides}), }}", T::KIND);
    let begins = MAGIC.len() + 4;
    // One byte more is the newline at the header's end.
    let length = (begins + words.len() + 1).next_multiple_of(ALIGNMENT) - begins;
    let length_bytes = u16::try_from(length).map_err(io::Error::other)?.to_le_bytes();
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&length_bytes)?;
    writeln!(out, "{words:<width$}", width = length - 1)
}

/// The header of an array, and its file from the numbers on.
#[derive(Debug)]
pub(super) struct Array<R> {
    kind: String,
    shape: Vec<u64>,
    numbers: R,
}

impl<R: Read> Array<R> {
    /// Reads the header of a NumPy file (format version 1 to 3) and leaves `file` at its first number.
    ///
    /// # Errors
    /// The file is no array, or one of a kind that our folders don't have.
    pub fn open(mut file: R) -> Result<Array<R>, String> {
        let cut = |error: io::Error| format!("no NumPy array ({error})");
        let mut start = [0; 8];
        file.read_exact(&mut start).map_err(cut)?;
        if start[..6] != MAGIC[..] {
            return Err("no NumPy array (it does not begin like one)".to_owned());
        }
        let mut length = [0; 4];
        let length_bytes = match start[6] {
            1 => 2,
            2 | 3 => 4,
            version => return Err(format!("a NumPy array of version {version}")),
        };
        file.read_exact(&mut length[..length_bytes]).map_err(cut)?;
        let length = u32::from_le_bytes(length) as usize;
        if length > LONGEST {
            return Err(format!("a NumPy array whose header has {length} bytes"));
        }
        let mut words = vec![0; length];
        file.read_exact(&mut words).map_err(cut)?;
        let words = str::from_utf8(&words).map_err(|error| format!("no NumPy array ({error})"))?;
        let header = Header::read(words).ok_or("a NumPy array whose header can't be read")?;
        match header {
            Header { kind: Some(kind), is_fortran: Some(false), shape: Some(shape) } => {
                Ok(Array { kind, shape, numbers: file })
            }
            Header { is_fortran: Some(true), .. } => Err("not in C order".to_owned()),
            _ => Err("a NumPy array whose header lacks a key".to_owned()),
        }
    }

    /// Returns the length of each dimension, the slowest first.
    pub fn shape(&self) -> &[u64] {
        &self.shape
    }

    /// Returns NumPy's name of the numbers' type.
    pub fn kind(&self) -> &str {
        &self.kind
    }

    /// Returns the file from the first number on.
    pub fn into_numbers(self) -> R {
        self.numbers
    }

    /// Reads the numbers of a file with so many bytes: a shape that claims more is refused before memory is allocated.
    ///
    /// # Errors
    /// They are of another kind, or cut off.
    pub fn into_vec<T: Element>(mut self, file_bytes: u64) -> Result<Vec<T>, String> {
        if self.kind != T::KIND {
            return Err(format!("its numbers are {}, not {}", self.kind.escape_debug(), T::KIND));
        }
        let count = self.shape.iter().try_fold(1u64, |product, side| product.checked_mul(*side));
        let bytes = count.and_then(|count| count.checked_mul(size_of::<T>() as u64));
        let fits = bytes.filter(|bytes| *bytes <= file_bytes).and_then(|_| usize::try_from(count?).ok());
        let mut values = vec![T::zeroed(); fits.ok_or("it is cut off")?];
        let read = self.numbers.read_exact(bytemuck::cast_slice_mut(&mut values));
        read.map_err(|error| format!("it is cut off ({error})"))?;
        Ok(values)
    }
}

/// The keys of a header, `None` where one is missing.
#[derive(Default)]
struct Header {
    kind: Option<String>,
    is_fortran: Option<bool>,
    shape: Option<Vec<u64>>,
}

impl Header {
    /// Parses a header's Python dictionary with the keys `descr`, `fortran_order` and `shape`, in any order; a missing
    /// key leaves its field `None`. `None` for any other key, broken syntax or more than eight dimensions.
    fn read(words: &str) -> Option<Header> {
        let mut header = Header::default();
        let mut rest = words.trim().strip_prefix('{')?.strip_suffix('}')?.trim_start();
        while !rest.is_empty() {
            let (key, after) = quoted(rest)?;
            rest = after.trim_start().strip_prefix(':')?.trim_start();
            match key {
                "descr" => {
                    let (kind, after) = quoted(rest)?;
                    (header.kind, rest) = (Some(kind.to_owned()), after);
                }
                "fortran_order" => {
                    let is_fortran = rest.starts_with("True");
                    rest = rest.strip_prefix(if is_fortran { "True" } else { "False" })?;
                    header.is_fortran = Some(is_fortran);
                }
                "shape" => {
                    let (sides, after) = rest.strip_prefix('(')?.split_once(')')?;
                    let sides = sides.split(',').map(str::trim).filter(|side| !side.is_empty());
                    let shape: Vec<u64> = sides.map(|side| side.parse().ok()).collect::<Option<_>>()?;
                    if shape.len() > MOST_DIMENSIONS {
                        return None;
                    }
                    (header.shape, rest) = (Some(shape), after);
                }
                _ => return None,
            }
            rest = rest.trim_start();
            rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
        }
        Some(header)
    }
}

/// Parses a string in single or double quotes at the very beginning of `words`; returns it without quotes (no escapes
/// are known) and the text after it. `None` without a quote, or without its end.
fn quoted(words: &str) -> Option<(&str, &str)> {
    let quote = words.chars().next().filter(|quote| matches!(quote, '\'' | '"'))?;
    words[1..].split_once(quote)
}

#[cfg(test)]
mod tests {
    use super::{Array, write_header};

    fn file(words: &str, numbers: &[u8]) -> Vec<u8> {
        let length = u16::try_from(words.len()).unwrap().to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], words.as_bytes(), numbers].concat()
    }

    #[test]
    fn what_is_written_is_read_and_begins_at_a_multiple_of_64() {
        for shape in [&[3u64][..], &[2, 3], &[1, 1, 3, 1], &[1_000_000_000, 3, 0]] {
            let mut bytes = Vec::new();
            write_header::<f32>(&mut bytes, shape).unwrap();
            assert_eq!((bytes.len() % 64, bytes.last()), (0, Some(&b'\n')), "{shape:?}");
            let values: Vec<f32> = (0..shape.iter().product::<u64>()).map(|n| n as f32).collect();
            bytes.extend_from_slice(bytemuck::cast_slice(&values));
            let array = Array::open(&bytes[..]).unwrap();
            assert_eq!(array.shape(), shape);
            assert_eq!(array.into_vec::<f32>(bytes.len() as u64).unwrap(), values);
        }
    }

    #[test]
    fn what_numpy_writes_is_read() {
        for words in [
            "{'descr': '|u1', 'fortran_order': False, 'shape': (2,), }  \n",
            "{\"shape\": (2, 1), \"fortran_order\": False, \"descr\": \"|u1\"}",
            "{'shape':(1,2),'descr':'|u1','fortran_order':False}",
        ] {
            let bytes = file(words, &[7, 8]);
            let array = Array::open(&bytes[..]).unwrap();
            assert_eq!(array.into_vec::<u8>(bytes.len() as u64).unwrap(), [7, 8], "{words}");
        }
    }

    #[test]
    fn what_is_no_array_of_ours_is_refused_in_words() {
        let of = |words: &str| {
            let bytes = file(words, &[0; 8]);
            let array = Array::open(&bytes[..]);
            array.and_then(|array| array.into_vec::<u8>(bytes.len() as u64)).expect_err(words)
        };
        assert_eq!(of("{'descr': '|u1', 'fortran_order': True, 'shape': (2,), }"), "not in C order");
        assert_eq!(of("{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }"), "its numbers are <f8, not |u1");
        assert_eq!(
            of("{'descr': '|u1', 'fortran_order': False, 'shape': (9,), }"),
            "it is cut off (failed to fill whole buffer)"
        );
        for claims in ["(18446744073709551615, 2)", "(4294967296, 4294967296)", "(1000000000000,)"] {
            assert_eq!(
                of(&format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {claims}, }}")),
                "it is cut off"
            );
        }
        assert_eq!(of("{'descr': '|u1', 'shape': (2,), }"), "a NumPy array whose header lacks a key");
        for words in [
            "",
            "{",
            "{'descr'}",
            "{'descr': |u1}",
            "{'shape': (-1,)}",
            "{'shape': (2",
            "{'é': 1}",
            "{é}",
            "{'shape': (1,1,1,1,1,1,1,1,1)}",
        ] {
            assert_eq!(of(words), "a NumPy array whose header can't be read", "{words}");
        }
        for bytes in [
            &b""[..],
            b"\x93NUM",
            b"\x93NUMPY\x01\x00",
            b"\x93NUMPY\x01\x00\xff\xff",
            b"PK\x03\x04....",
            b"\x93NUMPY\x09\x00\x00\x00",
        ] {
            Array::open(bytes).expect_err("no array");
        }
    }
}
