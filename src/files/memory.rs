//! Files in memory, for a build without a file system: those that were dropped on a browser's page are read, and those
//! that are written become its downloads.
//!
//! Paths have `/` between folders, and are relative to one root: `a.obj`, `./a.obj` and `/a.obj` are one file. A browser
//! runs the module on one thread, which owns the files; in a test each thread has its own.

use super::{FileSystem, PlainFile, ReadError, UnfinishedFile};
use bytes::Bytes;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Cursor, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

thread_local! {
    static STORE: RefCell<MemoryStore> = const { RefCell::new(MemoryStore::new()) };
}

/// The content of a file that was dropped on the page.
#[derive(Debug)]
pub(super) struct BroughtFile {
    pub bytes: Bytes,
    /// Number of the drop that brought it; the oldest is 1.
    #[cfg_attr(not(any(test, feature = "web")), expect(dead_code, reason = "without a window nothing is dropped"))]
    pub of_drop: u64,
}

/// All files in memory, by their paths from the root, without a leading `/`.
#[derive(Debug)]
pub(super) struct MemoryStore {
    /// Files that can be read. Folders are where there are files.
    pub brought: BTreeMap<String, BroughtFile>,
    /// The number of drops so far.
    #[cfg_attr(not(any(test, feature = "web")), expect(dead_code, reason = "without a window nothing is dropped"))]
    pub drops: u64,
    /// Files that were written and not handed on yet.
    pub written: Vec<(String, Bytes)>,
}

impl MemoryStore {
    /// Returns a store without files.
    pub const fn new() -> MemoryStore {
        MemoryStore { brought: BTreeMap::new(), drops: 0, written: Vec::new() }
    }

    fn is_file(&self, path: &Path) -> bool {
        self.brought.contains_key(&key(path))
    }

    /// Returns whether a folder is at a path: the root, or one with a file in it.
    fn is_folder(&self, path: &Path) -> bool {
        let key = key(path);
        if key.is_empty() {
            // As in every file system, a path without a part is none.
            return !path.as_os_str().is_empty();
        }
        let folder = key + "/";
        self.brought.range(folder.clone()..).next().is_some_and(|(first, _)| first.starts_with(&folder))
    }

    fn open(&self, path: &Path) -> Result<Bytes, ReadError> {
        match self.brought.get(&key(path)) {
            Some(file) => Ok(file.bytes.clone()),
            None if self.is_folder(path) => Err(ReadError::Folder),
            None => Err(ReadError::Missing),
        }
    }

    /// Adds a finished file to those that are handed on. It can't be read: a page's copy of what the browser saves would only
    /// take memory.
    fn write(&mut self, path: &Path, bytes: Bytes) {
        let key = key(path);
        self.written.retain(|(other, _)| *other != key);
        self.written.push((key, bytes));
    }

    /// Removes a file from those that can be read and those that are handed on; returns whether there was one.
    fn remove(&mut self, path: &Path) -> bool {
        let key = key(path);
        let written = self.written.len();
        self.written.retain(|(other, _)| *other != key);
        self.brought.remove(&key).is_some() || self.written.len() < written
    }
}

/// Returns the path from the root, with `/` between folders, without `.` and `..`; empty for the root, which nothing is
/// above.
pub(super) fn key(path: &Path) -> String {
    let mut parts = Vec::new();
    for component in path.components() {
        match component {
            Component::Normal(part) => parts.push(part.to_string_lossy()),
            Component::ParentDir => drop(parts.pop()),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    parts.join("/")
}

/// Runs `body` with this thread's files.
pub(super) fn with_store<T>(body: impl FnOnce(&mut MemoryStore) -> T) -> T {
    STORE.with_borrow_mut(body)
}

/// Drops what was written into a folder and not handed on yet.
#[cfg(target_family = "wasm")]
pub(super) fn discard(folder: &Path) {
    let folder = format!("{}/", key(folder));
    with_store(|store| store.written.retain(|(key, _)| !key.starts_with(&folder)));
}

/// The file system in memory.
pub(super) struct MemoryFileSystem;

impl FileSystem for MemoryFileSystem {
    fn open(&self, path: &Path) -> Result<PlainFile, ReadError> {
        let bytes = with_store(|store| store.open(path))?;
        let length = bytes.len() as u64;
        Ok(PlainFile { content: Box::new(Cursor::new(bytes)), length })
    }

    fn exists(&self, path: &Path) -> bool {
        self.is_file(path) || self.is_folder(path)
    }

    fn is_folder(&self, path: &Path) -> bool {
        with_store(|store| store.is_folder(path))
    }

    fn is_file(&self, path: &Path) -> bool {
        with_store(|store| store.is_file(path))
    }

    fn resolved(&self, path: &Path) -> io::Result<PathBuf> {
        if self.exists(path) { Ok(Path::new("/").join(key(path))) } else { Err(ErrorKind::NotFound.into()) }
    }

    fn begin_in_place(&self, path: &Path) -> io::Result<Box<dyn UnfinishedFile>> {
        self.begin(path)
    }

    fn begin(&self, path: &Path) -> io::Result<Box<dyn UnfinishedFile>> {
        if path.file_name().is_none() || self.is_folder(path) {
            return Err(ErrorKind::IsADirectory.into());
        }
        Ok(Box::new(MemoryFile { path: path.to_owned(), bytes: Arc::default() }))
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        if with_store(|store| store.remove(path)) { Ok(()) } else { Err(ErrorKind::NotFound.into()) }
    }
}

/// A file that is being written to memory.
#[derive(Debug)]
struct MemoryFile {
    path: PathBuf,
    bytes: Arc<Mutex<Vec<u8>>>,
}

impl UnfinishedFile for MemoryFile {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(Box::new(MemoryWriter(Arc::clone(&self.bytes))))
    }

    fn finish(&mut self) -> io::Result<u64> {
        let bytes = std::mem::take(&mut *self.bytes.lock().unwrap_or_else(PoisonError::into_inner));
        let length = bytes.len() as u64;
        with_store(|store| store.write(&self.path, bytes.into()));
        Ok(length)
    }
}

/// Appends to a file that is being written to memory.
struct MemoryWriter(Arc<Mutex<Vec<u8>>>);

impl Write for MemoryWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::brought::{InMemory, take_written};
    use crate::files::{self, WholeFile, read_plain, write_whole};

    #[test]
    fn a_path_is_the_same_with_and_without_a_root_and_dots() {
        let _files = InMemory::with(&[("a/b.obj", b"v"), ("/c.obj", b"w")]);
        for path in ["a/b.obj", "./a/b.obj", "/a/b.obj", "a/../a/./b.obj", "../../a/b.obj"] {
            assert_eq!(read_plain(Path::new(path), 1).expect(path), b"v");
        }
        assert!(files::is_file(Path::new("c.obj")) && !files::is_folder(Path::new("c.obj")));
        for folder in [".", "/", "a", "a/", "a/.."] {
            assert!(files::is_folder(Path::new(folder)) && !files::is_file(Path::new(folder)), "{folder}");
            assert!(matches!(read_plain(Path::new(folder), 1), Err(ReadError::Folder)), "{folder}");
        }
        for nothing in ["", "b.obj", "a/b", "a/b.obj/c", "A"] {
            assert!(!files::exists(Path::new(nothing)), "{nothing}");
            assert!(matches!(read_plain(Path::new(nothing), 1), Err(ReadError::Missing)), "{nothing}");
        }
        assert!(matches!(read_plain(Path::new("c.obj"), 0), Err(ReadError::TooLarge { most: 0 })));
    }

    #[test]
    fn a_file_that_is_never_finished_leaves_nothing() {
        let _files = InMemory::with(&[("a.png", b"old")]);
        let path = Path::new("a.png");
        let file = WholeFile::create(path).expect("begun");
        let mut out = file.writer().expect("a writer");
        out.write_all(b"new").and_then(|()| out.flush()).expect("written");
        drop((out, file));
        assert_eq!((read_plain(path, 3).expect("as it was"), take_written()), (b"old".to_vec(), Vec::new()));
    }

    #[test]
    fn written_files_are_handed_on_once_and_not_read() {
        let _files = InMemory::with(&[("a.toml", b"old")]);
        write_whole(Path::new("./out/b.png"), b"first").expect("written");
        write_whole(Path::new("out/b.png"), b"picture").expect("written again");
        write_whole(Path::new("a.toml"), b"new").expect("written");
        let file = WholeFile::create(Path::new("c.png")).expect("begun");
        file.writer().expect("a writer").write_all(b"film").expect("written as the writer is dropped");
        assert_eq!(file.finish().expect("finished"), 4);
        assert!(!files::exists(Path::new("out/b.png")) && !files::exists(Path::new("c.png")));
        assert_eq!(read_plain(Path::new("a.toml"), 3).expect("as it was dropped"), b"old");
        let written = take_written();
        let names: Vec<(&str, &[u8])> = written.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
        assert_eq!(names, [("out/b.png", &b"picture"[..]), ("a.toml", b"new"), ("c.png", b"film")]);
        assert_eq!(take_written(), []);
    }

    #[test]
    fn a_removed_file_is_neither_read_nor_handed_on() {
        let _files = InMemory::with(&[("a.obj", b"v")]);
        write_whole(Path::new("b.obj"), b"v").expect("written");
        files::remove(Path::new("a.obj")).expect("removed");
        files::remove(Path::new("b.obj")).expect("removed");
        assert!(files::remove(Path::new("b.obj")).is_err_and(|error| error.kind() == ErrorKind::NotFound));
        assert!(!files::exists(Path::new("a.obj")) && take_written().is_empty());
    }

    #[test]
    fn a_folder_is_no_place_for_a_file() {
        let _files = InMemory::with(&[("a/b.obj", b"v")]);
        for folder in ["a", ".", "/", "", ".."] {
            assert!(write_whole(Path::new(folder), b"v").is_err(), "{folder}");
        }
    }

    #[test]
    fn a_brought_file_is_named_from_beside_another() {
        let _files = InMemory::with(&[("models/a.obj", b"v"), ("b.obj", b"v")]);
        let named = |file: &str, other: &str| files::from_beside(Path::new(file), Path::new(other));
        assert_eq!(named("scene.toml", "models/a.obj"), "models/a.obj");
        assert_eq!(named("models/scene.toml", "./b.obj"), "../b.obj");
        assert_eq!(named("new/scene.toml", "b.obj"), "b.obj", "a folder that is not there");
    }
}
