//! Files: those of the system, or files in memory where there is no file system, as in a browser's page. They are read
//! whole up to a limit, and written whole or not at all.
//!
//! ```text
//! mod.rs ─┬─► system.rs                   the system's files
//!         └─► memory.rs ◄── brought.rs    files that were dropped on a page, and those that it hands on as downloads
//! archive.rs                              .zip files, to lists of files and back
//! ```
//!
//! What the window opens comes from here alone, so that a model is opened by the same code wherever it is; what only the
//! command line does, and the moving of a native capture folder into its place, takes the system's.

#[cfg(any(test, all(feature = "web", target_family = "wasm")))]
pub mod archive;
#[cfg(any(test, all(feature = "web", target_family = "wasm")))]
pub mod brought;
#[cfg(any(test, target_family = "wasm"))]
mod memory;
#[cfg(not(target_family = "wasm"))]
mod system;

use std::fmt::Debug;
use std::io::{self, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Component, Path, PathBuf};

/// How to fix that a file is missing. A page has the files alone that were dropped on it.
const FIX_OF_MISSING: &str = match cfg!(target_family = "wasm") {
    true => "drop it together with the file that names it",
    false => "check the path",
};

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file does not exist.
    #[error("there is no such file: {}", FIX_OF_MISSING)]
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

/// What the crate does with files, by any file system.
trait FileSystem {
    /// Opens a plain file; links are followed. A device or a pipe is refused before it is opened.
    fn open(&self, path: &Path) -> Result<PlainFile, ReadError>;
    /// Returns whether anything is at a path; links are followed.
    fn exists(&self, path: &Path) -> bool;
    /// Returns whether a folder is at a path; links are followed.
    fn is_folder(&self, path: &Path) -> bool;
    /// Returns whether a plain file is at a path; links are followed.
    fn is_file(&self, path: &Path) -> bool;
    /// Returns the absolute path of what is at a path, without links and `..`; an error where nothing is.
    fn resolved(&self, path: &Path) -> io::Result<PathBuf>;
    /// Begins a file at `path`, whatever becomes of it.
    fn begin_in_place(&self, path: &Path) -> io::Result<Box<dyn UnfinishedFile>>;
    /// Begins a file that is at `path` once it is finished.
    fn begin(&self, path: &Path) -> io::Result<Box<dyn UnfinishedFile>>;
    /// Removes a file.
    fn remove(&self, path: &Path) -> io::Result<()>;
}

/// A file that is being written. Dropped unfinished, it leaves nothing.
trait UnfinishedFile: Debug + Send {
    /// Returns a writer that goes on where the last one ended.
    fn writer(&self) -> io::Result<Box<dyn Write + Send>>;
    /// Moves the file to its place, replacing what is there, and returns its length in bytes.
    fn finish(&mut self) -> io::Result<u64>;
}

/// Returns the file system that this build has.
#[cfg(not(any(test, target_family = "wasm")))]
fn current() -> &'static dyn FileSystem {
    &system::SystemFileSystem
}

/// Returns the file system that this build has.
#[cfg(target_family = "wasm")]
fn current() -> &'static dyn FileSystem {
    &memory::MemoryFileSystem
}

/// Returns the file system that the test on this thread uses.
#[cfg(all(test, not(target_family = "wasm")))]
fn current() -> &'static dyn FileSystem {
    if brought::InMemory::is_on() { &memory::MemoryFileSystem } else { &system::SystemFileSystem }
}

/// The bytes of a plain file.
trait FileContent: Read + Seek + Send {}

impl<T: Read + Seek + Send> FileContent for T {}

/// A plain file that is open for reading.
pub struct PlainFile {
    content: Box<dyn FileContent>,
    length: u64,
}

impl PlainFile {
    /// Returns its length in bytes, as it was when it was opened. Some files of the system say 0 and have content.
    pub fn length(&self) -> u64 {
        self.length
    }
}

impl Read for PlainFile {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.content.read(into)
    }
}

impl Seek for PlainFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.content.seek(to)
    }
}

/// Opens a plain file. A path that another file names may be anything: a device or a pipe, which opening could wait
/// for, is refused before.
pub fn open_plain(path: &Path) -> Result<PlainFile, ReadError> {
    current().open(path)
}

/// Returns the bytes of a plain file; an error where it is longer than `most` bytes, also if it grows beyond that while
/// it is read, or is no plain file.
pub fn read_plain(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    let file = open_plain(path)?;
    if file.length() > most {
        return Err(ReadError::TooLarge { most });
    }
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(ReadError::TooLarge { most }) } else { Ok(bytes) }
}

/// Returns whether anything is at a path; links are followed.
pub fn exists(path: &Path) -> bool {
    current().exists(path)
}

/// Returns whether a folder is at a path; links are followed.
pub fn is_folder(path: &Path) -> bool {
    current().is_folder(path)
}

/// Returns whether a plain file is at a path; links are followed.
pub fn is_file(path: &Path) -> bool {
    current().is_file(path)
}

/// Removes a file.
pub fn remove(path: &Path) -> io::Result<()> {
    current().remove(path)
}

/// What a file is written with. It must be flushed before the file is finished.
pub type FileWriter = BufWriter<Box<dyn Write + Send>>;

/// A file that is in its place once it is finished. If it never is, nothing is left of it, and the file that was there
/// before stays.
#[derive(Debug)]
pub struct WholeFile(Box<dyn UnfinishedFile>);

impl WholeFile {
    /// Begins a file that [`WholeFile::finish`] moves to `path`. Links are followed; a device or a pipe at `path` is
    /// written directly. Dropped unfinished, the new file is removed and what was at `path` stays.
    pub fn create(path: &Path) -> io::Result<WholeFile> {
        current().begin(path).map(WholeFile)
    }

    /// Returns a buffered writer to the file. It must be flushed before the file is finished.
    pub fn writer(&self) -> io::Result<FileWriter> {
        self.0.writer().map(BufWriter::new)
    }

    /// Moves the file to its place, replacing what is there, and returns its length in bytes; does not move it where it
    /// was written in place.
    pub fn finish(mut self) -> io::Result<u64> {
        self.0.finish()
    }
}

/// Writes a file so that `path` has all that `fill` writes or what it had before. A device or a pipe is written
/// directly.
pub fn write_filled(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    filled(WholeFile::create(path)?, fill)
}

/// Writes a file of a folder that is put in its place as a whole: it needs no care of its own.
pub fn write_in_place(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    filled(WholeFile(current().begin_in_place(path)?), fill)
}

fn filled(file: WholeFile, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = file.writer()?;
    fill(&mut out)?;
    out.flush()?;
    file.finish().map(drop)
}

/// Drops what was written into a folder, which is not complete.
#[cfg(target_family = "wasm")]
pub fn discard(folder: &Path) {
    memory::discard(folder);
}

/// Writes a file so that `path` has all of these bytes or what it had before. A device or a pipe is written directly.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_filled(path, |out| out.write_all(bytes))
}

/// Returns the path to `other` as the file `file` would name it: relative to the folder of `file`; `other` unchanged
/// where its path can't be resolved or lies on another drive. `other` must exist to become relative.
pub fn from_beside(file: &Path, other: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let both = current().resolved(folder).ok().zip(current().resolved(other).ok());
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

    fn fill(file: &WholeFile, bytes: &[u8]) {
        let mut out = file.writer().expect("a writer");
        out.write_all(bytes).and_then(|()| out.flush()).expect("written");
    }

    /// An animation takes minutes: a file that is written to its place meanwhile is whole, and so is the animation.
    #[test]
    fn two_that_write_to_one_place_do_not_meet() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        let slow = WholeFile::create(&path).expect("begun");
        fill(&slow, b"slow");
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
        let file = WholeFile::create(&path).expect("begun");
        fill(&file, b"new");
        drop(file);
        let names = || std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!((std::fs::read(&path).expect("a file"), names()), (b"old".to_vec(), 1));
        let file = WholeFile::create(&path).expect("begun");
        fill(&file, b"new");
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
