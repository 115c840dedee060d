//! Archives (`.zip`): read without trust, and written.
//!
//! Nothing is unpacked to a disk. The names are paths from the archive's root, with `/` between folders; an archive within
//! an archive stays one file.

use std::io::{Cursor, Read, Write};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// The most files and folders of an archive that is read.
const MOST_ENTRIES: usize = 1 << 16;

/// Why an archive can't be unpacked or packed.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// It is no archive, or a part of it is missing or contradicts another.
    #[error("the archive is broken ({0}): pack the files again")]
    Broken(String),
    /// It has more entries than are read.
    #[error("the archive has {found} files, and at most {most} are unpacked: pack only what the scene needs", most = MOST_ENTRIES)]
    TooMany {
        /// How many there are.
        found: usize,
    },
    /// Its files are longer than the limit, whatever it says of their lengths.
    #[error("the files in the archive have more than {} MiB: pack only what the scene needs", .most >> 20)]
    TooLarge {
        /// The limit, bytes.
        most: u64,
    },
    /// A name leads out of the archive, or has no meaning in it.
    #[error("the archive names `{}`: pack the files again, with relative names and / between folders", .0.escape_debug())]
    Name(String),
    /// A file is encrypted.
    #[error("`{}` in the archive is encrypted: pack the files again, without a password", .0.escape_debug())]
    Encrypted(String),
    /// A file is compressed by a method that is not read.
    #[error(
        "`{}` in the archive is compressed in a way that is not read here: pack the files again as an ordinary .zip \
         (deflate)",
        .0.escape_debug()
    )]
    Method(String),
    /// An entry is a link to another file.
    #[error("`{}` in the archive is a link: pack the file that it points to", .0.escape_debug())]
    Link(String),
    /// A file can't be added, as one of its name was before, or its name is too long.
    #[error("`{}` can't be packed ({reason}): give it another name", name.escape_debug())]
    Unpackable {
        /// Name of the file.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
}

/// Returns the files of an archive, each with its path, in the archive's order; folders without files are left out.
///
/// # Errors
/// The archive is broken, its files have together more than `most` bytes, or one of them can't be unpacked, with how to
/// fix it.
pub fn unpack(bytes: &[u8], most: u64) -> Result<Vec<(String, Vec<u8>)>, ArchiveError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    if archive.len() > MOST_ENTRIES {
        return Err(ArchiveError::TooMany { found: archive.len() });
    }
    let mut files = Vec::new();
    let mut left = most;
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index).map_err(broken)?;
        let name = entry.name().map_err(broken)?.into_owned();
        if !is_inside(&name) {
            return Err(ArchiveError::Name(name));
        }
        if entry.is_dir() {
            continue;
        }
        if entry.is_symlink() {
            return Err(ArchiveError::Link(name));
        }
        if entry.encrypted() {
            return Err(ArchiveError::Encrypted(name));
        }
        if !matches!(entry.compression(), CompressionMethod::Stored | CompressionMethod::Deflated) {
            return Err(ArchiveError::Method(name));
        }
        drop(entry);
        let file = archive.by_index(index).map_err(broken)?;
        let mut content = Vec::new();
        // The length that the archive states is not trusted.
        file.take(left.saturating_add(1)).read_to_end(&mut content).map_err(|error| broken(error.into()))?;
        left = left.checked_sub(content.len() as u64).ok_or(ArchiveError::TooLarge { most })?;
        files.push((name, content));
    }
    Ok(files)
}

fn broken(error: ZipError) -> ArchiveError {
    ArchiveError::Broken(error.to_string())
}

/// Returns whether a name is a path below the archive's root, with `/` between folders; one of a folder ends with it.
fn is_inside(name: &str) -> bool {
    let path = name.strip_suffix('/').unwrap_or(name);
    !path.contains(['\\', '\0', ':']) && path.split('/').all(|part| !matches!(part, "" | "." | ".."))
}

/// Returns an archive of files, each compressed. The same files make the same archive.
///
/// # Errors
/// Two files have the same name, or a name is longer than 64 KiB.
pub fn pack<B: AsRef<[u8]>>(files: impl IntoIterator<Item = (String, B)>) -> Result<Vec<u8>, ArchiveError> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        let content = content.as_ref();
        let is_large = content.len() as u64 >= u64::from(u32::MAX);
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated).large_file(is_large);
        let packed = archive.start_file(&name, options).and_then(|()| Ok(archive.write_all(content)?));
        packed.map_err(|error| ArchiveError::Unpackable { name, reason: error.to_string() })?;
    }
    archive.finish().map(Cursor::into_inner).map_err(broken)
}
