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
        let name = entry.name().to_owned();
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

#[cfg(test)]
mod tests {
    use super::*;

    const MOST: u64 = 1 << 20;
    /// Signatures of a file's header, before its content and in the directory, with where their flags are; the method
    /// follows these.
    const HEADERS: [(&[u8; 4], usize); 2] = [(b"PK\x03\x04", 6), (b"PK\x01\x02", 8)];

    fn archive_of(files: &[(&str, &[u8])]) -> Vec<u8> {
        pack(files.iter().map(|(name, bytes)| ((*name).to_owned(), *bytes))).expect("packed")
    }

    /// Returns an archive of one file, in each of whose headers `change` has changed what follows from the flags on.
    fn changed(content: &[u8], change: impl Fn(&mut [u8])) -> Vec<u8> {
        let mut bytes = archive_of(&[("a.obj", content)]);
        for (signature, flags) in HEADERS {
            let at = bytes.windows(4).position(|four| four == signature).expect("a header");
            change(&mut bytes[at + flags..]);
        }
        bytes
    }

    fn refused(bytes: &[u8]) -> String {
        unpack(bytes, MOST).expect_err("refused").to_string()
    }

    #[test]
    fn packed_files_are_unpacked_in_order_and_the_same_files_make_the_same_archive() {
        let long = vec![7; 100_000];
        let inner = archive_of(&[("m.obj", b"v")]);
        let files: [(&str, &[u8]); 4] =
            [("b/manifest.json", b"{}"), ("b/\u{e4} \u{6f22}.npy", &long), ("a.obj", b""), ("inner.zip", &inner)];
        let bytes = archive_of(&files);
        assert!(bytes.len() < 2000, "{} bytes", bytes.len());
        let found = unpack(&bytes, 100_003 + inner.len() as u64).expect("unpacked");
        let found: Vec<(&str, &[u8])> = found.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
        assert_eq!(found, files);
        assert_eq!(archive_of(&files), bytes);
        assert_eq!(unpack(&archive_of(&[]), 0).expect("empty"), []);
    }

    #[test]
    fn what_two_files_are_called_is_packed_once() {
        let twice = [("a".to_owned(), b"1"), ("a".to_owned(), b"2")];
        assert!(pack(twice).expect_err("two of a name").to_string().contains("give it another name"));
        assert!(pack([("a".repeat(1 << 16), b"1")]).is_err());
    }

    #[test]
    fn files_that_unpack_to_more_than_the_limit_are_refused_whatever_their_stated_length() {
        let zeros = vec![0; 4 << 20];
        let bomb = archive_of(&[("a.obj", b"v"), ("b.obj", &zeros)]);
        assert!(bomb.len() < 10_000, "{} bytes", bomb.len());
        assert!(matches!(unpack(&bomb, MOST), Err(ArchiveError::TooLarge { most: MOST })));
        assert!(refused(&bomb).contains("more than 1 MiB"));
        assert!(matches!(unpack(&archive_of(&[("a", b"12"), ("b", b"34")]), 3), Err(ArchiveError::TooLarge { .. })));
        // The length follows 16 bytes after the flags.
        let liar = changed(&zeros, |header| header[16..20].copy_from_slice(&1_u32.to_le_bytes()));
        assert!(unpack(&liar, MOST).is_err());
    }

    #[test]
    fn names_that_lead_out_of_the_archive_are_refused() {
        for name in
            ["../a.obj", "a/../../b.obj", "/etc/a.obj", "a\\b.obj", "C:/a.obj", "a//b.obj", "./a.obj", "a\0.obj"]
        {
            let bytes = archive_of(&[(name, b"v")]);
            assert!(matches!(unpack(&bytes, MOST), Err(ArchiveError::Name(found)) if found == name), "{name}");
        }
        assert!(refused(&archive_of(&[("../a", b"v")])).contains("relative names"));
    }

    #[test]
    fn folders_are_left_out_and_links_refused() {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        archive.add_directory("models", SimpleFileOptions::default()).expect("a folder");
        archive.start_file("models/a.obj", SimpleFileOptions::default()).expect("a file");
        archive.write_all(b"v").expect("written");
        let folder = archive.finish().expect("finished").into_inner();
        assert_eq!(unpack(&folder, 1).expect("unpacked"), [("models/a.obj".to_owned(), b"v".to_vec())]);
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        archive.add_symlink("b.obj", "/etc/passwd", SimpleFileOptions::default()).expect("a link");
        assert!(
            refused(&archive.finish().expect("finished").into_inner()).contains("`b.obj` in the archive is a link")
        );
    }

    #[test]
    fn encrypted_files_and_other_methods_are_refused_with_the_fix() {
        assert!(refused(&changed(b"v", |header| header[0] |= 1)).contains("without a password"));
        for method in [1, 9, 12, 14, 93, 98, 1000_u16] {
            let other = changed(b"v", |header| header[2..4].copy_from_slice(&method.to_le_bytes()));
            assert!(refused(&other).contains("(deflate)"), "{method}: {}", refused(&other));
        }
    }

    #[test]
    fn broken_archives_are_refused_and_never_panic() {
        let whole = archive_of(&[("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), ("b/c.mtl", b"newmtl a\n")]);
        for length in 0..whole.len() {
            assert!(refused(&whole[..length]).contains("pack the files again"), "{length} bytes");
        }
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.clone();
                bytes[at] ^= 1 << bit;
                // Some bits mean nothing here, as those of the time.
                let _ = unpack(&bytes, MOST);
            }
        }
        let text = whole.windows(3).position(|three| three == b"PK\x01").expect("a directory") - 3;
        let mut bytes = whole.clone();
        bytes[text] ^= 0xff;
        assert!(unpack(&bytes, MOST).is_err(), "a checksum");
        assert!(refused(b"v 0 0 0\n").contains("broken"));
    }

    #[test]
    fn too_many_files_are_refused() {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        (0..=MOST_ENTRIES).for_each(|number| archive.start_file(number.to_string(), options).expect("a file"));
        let bytes = archive.finish().expect("finished").into_inner();
        assert!(matches!(unpack(&bytes, MOST), Err(ArchiveError::TooMany { found }) if found == MOST_ENTRIES + 1));
    }
}
