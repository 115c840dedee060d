//! Where the files of a capture are: in a folder on disk, or in memory, as within a page.

use super::CaptureError;
use crate::files::{exists, open_plain, read_plain, write_in_place};
use bytes::Bytes;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, BufReader, Cursor, Read, Write};
use std::path::{Path, PathBuf};

/// The contents of files by name.
pub type MemoryFiles = BTreeMap<String, Bytes>;

/// The files of a capture.
pub(super) enum CaptureFiles<'a> {
    /// In a folder.
    Disk(PathBuf),
    /// In memory, to be read.
    Memory(&'a MemoryFiles),
    /// Handed on one by one as they are written.
    Stream(RefCell<&'a mut dyn FnMut(String, Vec<u8>)>),
}

impl CaptureFiles<'_> {
    /// Returns the files in a folder, which need not exist yet.
    pub fn of_folder(folder: &Path) -> CaptureFiles<'static> {
        CaptureFiles::Disk(folder.to_owned())
    }

    /// Returns the path of a file, for what opens it itself and for messages; in memory its name.
    pub fn path(&self, file: &str) -> PathBuf {
        match self {
            CaptureFiles::Disk(folder) => folder.join(file),
            CaptureFiles::Memory(_) | CaptureFiles::Stream(_) => PathBuf::from(file),
        }
    }

    /// Returns how the names of pictures end: but for a folder they are arrays, as nobody opens them in a viewer.
    pub fn picture_ending(&self) -> &'static str {
        match self {
            CaptureFiles::Disk(_) => "png",
            CaptureFiles::Memory(_) | CaptureFiles::Stream(_) => "npy",
        }
    }

    /// Returns whether there is a file of this name.
    pub fn has(&self, file: &str) -> bool {
        match self {
            CaptureFiles::Disk(folder) => exists(&folder.join(file)),
            CaptureFiles::Memory(files) => files.contains_key(file),
            CaptureFiles::Stream(_) => false,
        }
    }

    /// Creates a file, lets `fill` write it, and makes sure that all of it was written.
    pub fn write(&self, file: &str, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), CaptureError> {
        let filled = match self {
            CaptureFiles::Disk(folder) => write_in_place(&folder.join(file), fill),
            CaptureFiles::Stream(take) => {
                let mut bytes = Vec::new();
                fill(&mut bytes).map(|()| (take.borrow_mut())(file.to_owned(), bytes))
            }
            CaptureFiles::Memory(_) => Err(io::ErrorKind::ReadOnlyFilesystem.into()),
        };
        filled.map_err(|source| CaptureError::Write { file: self.path(file), source })
    }

    /// Opens a file, and returns it with its length in bytes.
    pub fn open(&self, file: &str) -> Result<(Box<dyn Read>, u64), String> {
        match self {
            CaptureFiles::Disk(folder) => {
                let file = open_plain(&folder.join(file)).map_err(|error| error.to_string())?;
                let length = file.length();
                Ok((Box::new(BufReader::new(file)), length))
            }
            CaptureFiles::Memory(_) | CaptureFiles::Stream(_) => {
                let bytes = self.in_memory(file)?;
                let length = bytes.len() as u64;
                Ok((Box::new(Cursor::new(bytes)), length))
            }
        }
    }

    /// Reads a whole file; fails where it is longer than `most` bytes.
    pub fn read(&self, file: &str, most: u64) -> Result<Bytes, String> {
        match self {
            CaptureFiles::Disk(folder) => {
                read_plain(&folder.join(file), most).map(Bytes::from).map_err(|error| error.to_string())
            }
            CaptureFiles::Memory(_) | CaptureFiles::Stream(_) => self.in_memory(file),
        }
    }

    fn in_memory(&self, file: &str) -> Result<Bytes, String> {
        let found = if let CaptureFiles::Memory(files) = self { files.get(file).cloned() } else { None };
        found.ok_or_else(|| "there is no such file".to_owned())
    }
}
