//! `data.bin`: byte strings, each compressed, each read when it is asked for.
//!
//! No length is trusted: each is checked against the file and against the budget of bytes before any memory is
//! allocated for it.

use super::document::RenderDocBlob;
use super::error::ImportError;
use flate2::read::ZlibDecoder;
use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};

/// The budget of bytes that importing a frame may read or compute in all; beyond it the import fails.
pub const MOST_BYTES: u64 = 8 << 30;
/// Bytes of pieces that are cached for the next picture.
const MOST_RECENT: u64 = 256 << 20;
/// Bytes of the largest piece that is cached.
const LARGEST_PIECE: usize = 1 << 20;

/// The bytes that blobs are read from: a file, or memory.
trait BlobSource: Read + Seek {}

impl<T: Read + Seek> BlobSource for T {}

/// The file `data.bin` with the table of its byte strings, and what is left of the budget of bytes.
pub struct BlobFile {
    file: Box<dyn BlobSource>,
    table: Vec<RenderDocBlob>,
    /// Uncompressed length of each byte string.
    lengths: Vec<u64>,
    left: u64,
    /// Pieces that were read recently: most of them occur in the next picture too.
    recent: BTreeMap<usize, Vec<u8>>,
    recent_bytes: u64,
}

impl BlobFile {
    /// Checks that all byte strings of the table lie in the file and all pieces exist, and returns them with the file
    /// and the full budget. Nothing is decompressed.
    pub fn new(file: impl Read + Seek + 'static, table: Vec<RenderDocBlob>) -> Result<Self, ImportError> {
        let broken = |what: String| ImportError::Folder(format!("data.bin: {what}"));
        let mut file = Box::new(file);
        let end = file.seek(SeekFrom::End(0)).map_err(|error| broken(error.to_string()))?;
        let stored = |at: usize| match table.get(at) {
            Some(RenderDocBlob::Stored([_, _, 0])) => Err(broken(format!("byte string {at} is an empty piece"))),
            Some(RenderDocBlob::Stored([_, _, length])) => Ok(*length),
            Some(RenderDocBlob::Joined { .. }) => Err(broken(format!("byte string {at} is a piece that has pieces"))),
            None => Err(broken(format!("there is no byte string {at}"))),
        };
        let length = |(at, blob): (usize, &RenderDocBlob)| match blob {
            RenderDocBlob::Stored([start, packed, length]) => {
                match start.checked_add(*packed).is_some_and(|last| last <= end) {
                    true => Ok(*length),
                    false => Err(broken(format!("byte string {at} lies outside of it"))),
                }
            }
            RenderDocBlob::Joined { pieces } => {
                pieces.iter().try_fold(0_u64, |sum, piece| Ok(sum.saturating_add(stored(*piece)?)))
            }
        };
        let lengths = table.iter().enumerate().map(length).collect::<Result<_, ImportError>>()?;
        Ok(Self { file, table, lengths, left: MOST_BYTES, recent: BTreeMap::new(), recent_bytes: 0 })
    }

    /// Takes `bytes` from the budget; takes nothing where fewer are left.
    ///
    /// # Errors
    /// The budget has fewer left.
    pub fn reserve(&mut self, bytes: u64) -> Result<(), ImportError> {
        let too_large = || ImportError::TooLarge { what: format!("more than {} GiB", MOST_BYTES >> 30) };
        self.left = self.left.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }

    /// Returns `bytes` to the budget that were reserved and are free again.
    pub fn give_back(&mut self, bytes: u64) {
        self.left = self.left.saturating_add(bytes).min(MOST_BYTES);
    }

    /// Returns the length that the table states for a byte string.
    pub fn length(&self, index: usize) -> Result<u64, ImportError> {
        self.lengths.get(index).copied().ok_or_else(|| none_of(index))
    }

    /// Reads and decompresses the byte string of this index, its pieces joined, and takes its length from the budget
    /// each time, also for pieces that are cached.
    pub fn read(&mut self, index: usize) -> Result<Vec<u8>, ImportError> {
        self.reserve(self.length(index)?)?;
        let Some(RenderDocBlob::Joined { pieces }) = self.table.get(index) else { return self.unpacked(index) };
        let mut bytes = Vec::new();
        for piece in pieces.clone() {
            if let Some(known) = self.recent.get(&piece) {
                bytes.extend_from_slice(known);
                continue;
            }
            let unpacked = self.unpacked(piece)?;
            bytes.extend_from_slice(&unpacked);
            self.keep(piece, unpacked);
        }
        Ok(bytes)
    }

    /// Caches a decompressed piece for the next picture. One that is too large is not cached; where the cache is full,
    /// it is emptied first.
    fn keep(&mut self, piece: usize, bytes: Vec<u8>) {
        if bytes.len() > LARGEST_PIECE {
            return;
        }
        if self.recent_bytes + bytes.len() as u64 > MOST_RECENT {
            self.recent.clear();
            self.recent_bytes = 0;
        }
        self.recent_bytes += bytes.len() as u64;
        self.recent.insert(piece, bytes);
    }

    /// Reads and decompresses the stored byte string of this index. Fails where there is none, it consists of pieces,
    /// or its length is not the stated one.
    fn unpacked(&mut self, index: usize) -> Result<Vec<u8>, ImportError> {
        let Some(RenderDocBlob::Stored([at, packed, length])) = self.table.get(index) else {
            return Err(none_of(index));
        };
        let (at, packed, length) = (*at, *packed, *length);
        let broken =
            |what: &dyn std::fmt::Display| ImportError::Folder(format!("data.bin: byte string {index}: {what}"));
        self.file.seek(SeekFrom::Start(at)).map_err(|error| broken(&error))?;
        // Memory grows with the bytes that come, not with the length that the table states.
        let mut bytes = Vec::new();
        let mut unpacked = ZlibDecoder::new(self.file.by_ref().take(packed)).take(length.saturating_add(1));
        unpacked.read_to_end(&mut bytes).map_err(|error| broken(&error))?;
        if bytes.len() as u64 != length {
            return Err(broken(&format!("it is not {length} bytes long")));
        }
        Ok(bytes)
    }
}

fn none_of(index: usize) -> ImportError {
    ImportError::Folder(format!("there is no byte string {index}"))
}
