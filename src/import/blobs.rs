//! `data.bin`: byte strings, each compressed, each read when it is asked for.
//!
//! No length is believed: each is held against the file and against what may be read in all before any memory is
//! taken for it.

use super::document::Blob;
use super::error::ImportError;
use flate2::read::ZlibDecoder;
use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};

/// Bytes that may be read or made in all.
pub const MOST_BYTES: u64 = 8 << 30;
/// Bytes of pieces that are kept for the next picture.
const MOST_RECENT: u64 = 256 << 20;

/// A file, or bytes in memory.
trait Source: Read + Seek {}

impl<T: Read + Seek> Source for T {}

/// The file, and where each byte string is in it.
pub struct Blobs {
    file: Box<dyn Source>,
    table: Vec<Blob>,
    left: u64,
    /// Pieces that were read lately: the next picture has most of them too.
    recent: BTreeMap<usize, Vec<u8>>,
    recent_bytes: u64,
}

impl Blobs {
    /// Looks through the table.
    ///
    /// # Errors
    /// A file that can't be read; a byte string that lies outside of it.
    pub fn new(file: impl Read + Seek + 'static, table: Vec<Blob>) -> Result<Self, ImportError> {
        let mut file = Box::new(file);
        let length = file.seek(SeekFrom::End(0)).map_err(|error| ImportError::Folder(format!("data.bin: {error}")))?;
        let lies_inside = |blob: &Blob| match blob {
            Blob::Stored([at, packed, _]) => at.checked_add(*packed).is_some_and(|end| end <= length),
            Blob::Joined { .. } => true,
        };
        if let Some(at) = table.iter().position(|entry| !lies_inside(entry)) {
            return Err(ImportError::Folder(format!("data.bin: byte string {at} lies outside of it")));
        }
        Ok(Self { file, table, left: MOST_BYTES, recent: BTreeMap::new(), recent_bytes: 0 })
    }

    /// Takes `bytes` from what may still be made.
    ///
    /// # Errors
    /// There is not so much left.
    pub fn reserve(&mut self, bytes: u64) -> Result<(), ImportError> {
        let too_large = || ImportError::TooLarge { what: format!("more than {} GiB", MOST_BYTES >> 30) };
        self.left = self.left.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }

    /// Gives back what was taken and is not kept.
    pub fn give_back(&mut self, bytes: u64) {
        self.left = self.left.saturating_add(bytes).min(MOST_BYTES);
    }

    /// How long a byte string says that it is.
    ///
    /// # Errors
    /// There is none of that number.
    pub fn length(&self, index: usize) -> Result<u64, ImportError> {
        match self.entry(index)? {
            Blob::Stored([_, _, length]) => Ok(*length),
            Blob::Joined { pieces } => pieces
                .iter()
                .map(|piece| Ok(self.stored(*piece)?[2]))
                .try_fold(0_u64, |sum, length| Ok(sum.saturating_add(length?))),
        }
    }

    /// A byte string.
    ///
    /// # Errors
    /// There is none of that number, it is not what the table says, or it is too long.
    pub fn read(&mut self, index: usize) -> Result<Vec<u8>, ImportError> {
        self.reserve(self.length(index)?)?;
        let Blob::Joined { pieces } = self.entry(index)? else { return self.unpacked(index) };
        let mut bytes = Vec::new();
        for piece in pieces.clone() {
            if !self.recent.contains_key(&piece) {
                let unpacked = self.unpacked(piece)?;
                if self.recent_bytes > MOST_RECENT {
                    self.recent.clear();
                    self.recent_bytes = 0;
                }
                self.recent_bytes += unpacked.len() as u64;
                self.recent.insert(piece, unpacked);
            }
            bytes.extend_from_slice(&self.recent[&piece]);
        }
        Ok(bytes)
    }

    /// What is stored under a number.
    fn unpacked(&mut self, index: usize) -> Result<Vec<u8>, ImportError> {
        let [at, packed, length] = self.stored(index)?;
        let broken =
            |what: &dyn std::fmt::Display| ImportError::Folder(format!("data.bin: byte string {index}: {what}"));
        self.file.seek(SeekFrom::Start(at)).map_err(|error| broken(&error))?;
        // The bytes are what takes memory, not the length that the table has.
        let mut bytes = Vec::new();
        let mut unpacked = ZlibDecoder::new(self.file.by_ref().take(packed)).take(length.saturating_add(1));
        unpacked.read_to_end(&mut bytes).map_err(|error| broken(&error))?;
        if bytes.len() as u64 != length {
            return Err(broken(&format!("it is not {length} bytes long")));
        }
        Ok(bytes)
    }

    fn entry(&self, index: usize) -> Result<&Blob, ImportError> {
        self.table.get(index).ok_or_else(|| ImportError::Folder(format!("there is no byte string {index}")))
    }

    /// Pieces have no pieces.
    fn stored(&self, index: usize) -> Result<[u64; 3], ImportError> {
        match self.entry(index)? {
            Blob::Stored(stored) => Ok(*stored),
            Blob::Joined { .. } => Err(ImportError::Folder(format!("byte string {index} is a piece that has pieces"))),
        }
    }
}
