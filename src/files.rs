//! Files that are written whole or not at all, reading of files that another file names, and relative paths between
//! files.

use std::fs::{File, FileType};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file does not exist.
    #[error("there is no such file: check the path")]
    Missing,
    /// Permission is denied.
    #[error("can't be read: allow reading it")]
    Denied,
    /// It is a folder.
    #[error("is a folder: name a file in it")]
    Folder,
    /// It is a device or a pipe, which reading could wait for without end; its kind in words.
    #[error("is a {0}: only plain files are read")]
    NoFile(&'static str),
    /// It is longer than the limit.
    #[error("has more than {} MiB: give a smaller file", .most >> 20)]
    TooLarge {
        /// The limit, bytes.
        most: u64,
    },
    /// Reading failed with the system's error.
    #[error("can't be read: {0}; check the file")]
    Failed(io::Error),
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> ReadError {
        match error.kind() {
            ErrorKind::NotFound => ReadError::Missing,
            ErrorKind::PermissionDenied => ReadError::Denied,
            _ => ReadError::Failed(error),
        }
    }
}

/// Opens a plain file. A path that another file names may be anything: a device or a pipe, which opening could wait
/// for, is refused before.
pub fn open_plain(path: &Path) -> Result<File, ReadError> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(ReadError::Folder);
    }
    if !metadata.is_file() {
        return Err(ReadError::NoFile(kind(metadata.file_type())));
    }
    Ok(File::open(path)?)
}

/// Returns the bytes of a plain file; an error where it is longer than `most` bytes, also if it grows beyond that while
/// it is read, or is no plain file.
pub fn read_plain(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    let file = open_plain(path)?;
    if file.metadata()?.len() > most {
        return Err(ReadError::TooLarge { most });
    }
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(ReadError::TooLarge { most }) } else { Ok(bytes) }
}

#[cfg(unix)]
fn kind(of: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    match of {
        of if of.is_fifo() => "pipe",
        of if of.is_socket() => "socket",
        of if of.is_char_device() || of.is_block_device() => "device",
        _ => "special file",
    }
}

#[cfg(not(unix))]
fn kind(_: FileType) -> &'static str {
    "special file"
}

/// A file that is written beside its place, and moved there once it is finished. If it never is, nothing is left of it,
/// and the file that was there before stays.
#[derive(Debug)]
pub struct WholeFile {
    file: File,
    /// Path that it is written to; `None` where it is written to its place directly.
    beside: Option<PathBuf>,
    target: PathBuf,
}

/// The number of files that were begun.
static BEGUN: AtomicU64 = AtomicU64::new(0);

impl WholeFile {
    /// Begins a file under another name beside `path`; [`WholeFile::finish`] moves it there. Links are followed; a
    /// device or a pipe at `path` is written directly. Dropped unfinished, the new file is removed and what was at
    /// `path` stays.
    pub fn create(path: &Path) -> io::Result<WholeFile> {
        // A link to a file stays a link: what it points to is replaced.
        let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.into());
        // Nothing can be renamed to the path of a device or a pipe.
        let is_in_place = target.exists() && !target.is_file();
        let mut beside = target.clone().into_os_string();
        // Two that are written to one place at a time are two files until they are finished.
        let number = BEGUN.fetch_add(1, Ordering::Relaxed);
        beside.push(format!(".new-{}-{number}", std::process::id()));
        let beside = (!is_in_place).then(|| PathBuf::from(beside));
        let file = match &beside {
            Some(beside) => File::create(beside)?,
            None => File::options().write(true).open(&target)?,
        };
        Ok(WholeFile { file, beside, target })
    }

    /// Returns a buffered writer to the file. It must be flushed before the file is finished.
    #[cfg(feature = "formats")]
    pub fn writer(&self) -> io::Result<io::BufWriter<File>> {
        Ok(io::BufWriter::new(self.file.try_clone()?))
    }

    /// Moves the file to its place, replacing what is there; does nothing where it was written in place.
    pub fn finish(mut self) -> io::Result<()> {
        if let Some(beside) = &self.beside {
            std::fs::rename(beside, &self.target)?;
            self.beside = None;
        }
        Ok(())
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if let Some(beside) = &self.beside {
            // The first failure is the error that is returned.
            let _ = std::fs::remove_file(beside);
        }
    }
}

/// Writes a file so that `path` has all of these bytes or what it had before: beside its place, then renamed. A device
/// or a pipe is written directly.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    file.file.write_all(bytes)?;
    file.finish()
}

/// Returns the path to `other` as the file `file` would name it: relative to the folder of `file`; `other` unchanged
/// where its path can't be resolved or lies on another drive. `other` must exist to become relative.
pub fn from_beside(file: &Path, other: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let both = folder.canonicalize().ok().zip(other.canonicalize().ok());
    let way = both.and_then(|(folder, other)| relative(&folder, &other));
    way.unwrap_or_else(|| other.to_owned()).to_string_lossy().into_owned()
}

/// Returns the relative path from a folder to a file, both absolute and resolved; `None` where they have nothing in
/// common, as on two drives.
fn relative(folder: &Path, file: &Path) -> Option<PathBuf> {
    let (folder, file): (Vec<Component>, Vec<Component>) = (folder.components().collect(), file.components().collect());
    let common = folder.iter().zip(&file).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return None;
    }
    let up = folder[common..].iter().map(|_| Component::ParentDir);
    Some(up.chain(file[common..].iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An animation takes minutes: a file that is written to its place meanwhile is whole, and so is the animation.
    #[test]
    fn two_that_write_to_one_place_do_not_meet() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        let mut slow = WholeFile::create(&path).expect("begun");
        slow.file.write_all(b"slow").expect("written");
        drop(WholeFile::create(&path).expect("begun, and called off"));
        write_whole(&path, b"quick").expect("written");
        assert_eq!(std::fs::read(&path).expect("there"), b"quick");
        slow.finish().expect("finished");
        assert_eq!(std::fs::read(&path).expect("there"), b"slow");
    }

    #[test]
    fn a_file_is_there_once_it_is_finished_and_one_that_never_is_leaves_what_was_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        write_whole(&path, b"old").expect("written");
        let mut file = WholeFile::create(&path).expect("begun");
        file.file.write_all(b"new").expect("written");
        drop(file);
        let names = || std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!((std::fs::read(&path).expect("a file"), names()), (b"old".to_vec(), 1));
        let mut file = WholeFile::create(&path).expect("begun");
        file.file.write_all(b"new").expect("written");
        assert_eq!(std::fs::read(&path).expect("a file"), b"old");
        file.finish().expect("in its place");
        assert_eq!((std::fs::read(&path).expect("a file"), names()), (b"new".to_vec(), 1));
    }

    #[test]
    fn a_plain_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        std::fs::write(&path, [7; 9]).expect("written");
        assert_eq!(read_plain(&path, 9).expect("nine bytes"), [7; 9]);
        assert!(matches!(read_plain(&path, 8), Err(ReadError::TooLarge { most: 8 })));
        assert!(matches!(read_plain(folder.path(), 8), Err(ReadError::Folder)));
        assert!(matches!(read_plain(&folder.path().join("b"), 8), Err(ReadError::Missing)));
    }

    #[cfg(unix)]
    #[test]
    fn devices_pipes_and_sockets_are_refused_by_name_and_links_are_followed() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        let refused = |path: &Path| read_plain(path, 8).expect_err("refused").to_string();
        assert!(refused(Path::new("/dev/zero")).starts_with("is a device: "));
        std::os::unix::fs::symlink("/dev/zero", place("zero")).expect("a link");
        assert!(refused(&place("zero")).starts_with("is a device: "));
        let _listener = std::os::unix::net::UnixListener::bind(place("socket")).expect("a socket");
        assert!(refused(&place("socket")).starts_with("is a socket: "));
        let made = std::process::Command::new("mkfifo").arg(place("pipe")).status().expect("mkfifo");
        assert!(made.success() && refused(&place("pipe")).starts_with("is a pipe: "), "and nobody waits for a writer");
        // Such files have a size of 0.
        assert!(matches!(read_plain(Path::new("/proc/self/maps"), 8), Err(ReadError::TooLarge { .. })));
    }

    #[test]
    fn a_way_goes_up_and_down() {
        let way = |folder: &str, file: &str| relative(Path::new(folder), Path::new(file));
        assert_eq!(way("/a/b", "/a/b/m.obj"), Some("m.obj".into()));
        assert_eq!(way("/a/b/c", "/a/d/m.obj"), Some("../../d/m.obj".into()));
        assert_eq!(way("a", "b/m.obj"), None);
    }
}
