//! The capture folder: a manifest, NumPy arrays and PNG pictures.
//!
//! [`write`] fills a hidden folder beside the wanted one and renames it when all is there, the
//! manifest last, so that a folder with the wanted name is always whole. A folder that is to be
//! replaced is moved aside first and removed last; if the new one can't take its place, it is
//! moved back. [`read`] gives back what was written, without a GPU.
//!
//! ```text
//! manifest.json              plan.txt (where the plan's text is known)
//! 000-ambient.color.png      000-ambient.depth.npy     000-ambient.stencil.npy
//! light0.shadow.npy          light0.map.npy
//! ```

mod arrays;
mod folder;
mod pictures;
mod reader;
mod writer;

use std::path::{Path, PathBuf};

pub use folder::{check_target, is_capture_folder};
pub use reader::read;
pub use writer::write;

/// The manifest's file name: what makes a folder a capture folder.
pub const MANIFEST: &str = "manifest.json";

/// Why a capture folder can't be written or read.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The folder is there and may not be replaced.
    #[error("{}: exists already: choose another folder, or add --overwrite to replace it", .0.display())]
    Exists(PathBuf),
    /// Something that is no capture folder is in the way.
    #[error("{}: exists and is no capture folder, so it is left alone: choose another folder", .0.display())]
    NotReplaceable(PathBuf),
    /// The path does not end in a name.
    #[error("{}: is no name for a new folder: give a path that ends in a name", .0.display())]
    NoName(PathBuf),
    /// The system refuses to write.
    #[error("{}: can't be written ({reason}): choose a folder that can", path.display())]
    Write {
        /// The folder or file.
        path: PathBuf,
        /// The system's words.
        reason: String,
    },
    /// There is no manifest.
    #[error("{}: is no capture folder: it has no {MANIFEST}; make one with `stencilscope capture`", .0.display())]
    NotACapture(PathBuf),
    /// A file of the folder is broken.
    #[error("{}: {reason}; capture the scene again", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl CaptureError {
    fn write(path: &Path, error: impl std::fmt::Display) -> CaptureError {
        CaptureError::Write { path: path.to_owned(), reason: one_line(error) }
    }

    fn broken(path: &Path, reason: impl std::fmt::Display) -> CaptureError {
        CaptureError::Broken { path: path.to_owned(), reason: one_line(reason) }
    }
}

fn one_line(text: impl std::fmt::Display) -> String {
    text.to_string().replace('\n', " ")
}

#[cfg(test)]
mod tests;
