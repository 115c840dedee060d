//! The system's files. A file is written under another name beside its place, and renamed once it is finished.

use super::{FileSystem, PlainFile, ReadError, UnfinishedFile};
use std::fs::{File, FileType};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// The file system of the operating system.
pub(super) struct SystemFileSystem;

impl FileSystem for SystemFileSystem {
    fn open(&self, path: &Path) -> Result<PlainFile, ReadError> {
        let metadata = std::fs::metadata(path)?;
        if metadata.is_dir() {
            return Err(ReadError::Folder);
        }
        if !metadata.is_file() {
            return Err(ReadError::NoFile(kind(metadata.file_type())));
        }
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        Ok(PlainFile { content: Box::new(file), length })
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn is_folder(&self, path: &Path) -> bool {
        path.is_dir()
    }

    fn is_file(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn resolved(&self, path: &Path) -> io::Result<PathBuf> {
        std::fs::canonicalize(path)
    }

    fn begin(&self, path: &Path) -> io::Result<Box<dyn UnfinishedFile>> {
        FileBeside::create(path).map(|file| Box::new(file) as _)
    }

    fn begin_in_place(&self, path: &Path) -> io::Result<Box<dyn UnfinishedFile>> {
        let file = FileBeside { file: File::create(path)?, beside: None, target: path.to_owned() };
        Ok(Box::new(file))
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        std::fs::remove_file(path)
    }
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

/// A file that is written beside its place.
#[derive(Debug)]
struct FileBeside {
    file: File,
    /// Path that it is written to; `None` where it is written to its place directly.
    beside: Option<PathBuf>,
    target: PathBuf,
}

/// The number of files that were begun.
static BEGUN: AtomicU64 = AtomicU64::new(0);

impl FileBeside {
    /// Begins a file under another name beside `path`; a device or a pipe there is written directly.
    fn create(path: &Path) -> io::Result<FileBeside> {
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
        Ok(FileBeside { file, beside, target })
    }
}

impl UnfinishedFile for FileBeside {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(Box::new(self.file.try_clone()?))
    }

    fn finish(&mut self) -> io::Result<u64> {
        let length = self.file.metadata()?.len();
        if let Some(beside) = &self.beside {
            std::fs::rename(beside, &self.target)?;
            self.beside = None;
        }
        Ok(length)
    }
}

impl Drop for FileBeside {
    fn drop(&mut self) {
        if let Some(beside) = &self.beside {
            // The first failure is the error that is returned.
            let _ = std::fs::remove_file(beside);
        }
    }
}
