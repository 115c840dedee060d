//! A new folder that appears whole or not at all.

use super::{CaptureError, MANIFEST};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// May a capture be written to `folder`? To be asked before long work; [`super::write`] asks again.
///
/// # Errors
/// Something is there that may not be replaced, or the folder to write into is missing.
pub fn check_target(folder: &Path, overwrite: bool) -> Result<(), CaptureError> {
    let (parent, _) = split(folder)?;
    if !parent.is_dir() {
        return Err(CaptureError::write(&parent, "there is no such folder"));
    }
    if fs::symlink_metadata(folder).is_err_and(|error| error.kind() == ErrorKind::NotFound) {
        return Ok(());
    }
    match (is_capture_folder(folder), overwrite) {
        (false, _) => Err(CaptureError::NotReplaceable(folder.to_owned())),
        (true, false) => Err(CaptureError::Exists(folder.to_owned())),
        (true, true) => Ok(()),
    }
}

/// Is it a folder with a manifest?
#[must_use]
pub fn is_capture_folder(folder: &Path) -> bool {
    folder.is_dir() && folder.join(MANIFEST).is_file()
}

/// A hidden folder beside the wanted one; removed unless it was put in its place.
#[derive(Debug)]
pub struct Draft {
    path: PathBuf,
    target: PathBuf,
    aside: PathBuf,
}

impl Draft {
    /// An empty folder beside `target`, which [`check_target`] has accepted.
    ///
    /// # Errors
    /// The folder beside can't be made.
    pub fn beside(target: &Path) -> Result<Draft, CaptureError> {
        // A link is followed, so that what it points to is replaced and not the link.
        let target = fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        let (parent, name) = split(&target)?;
        let process = std::process::id();
        let path = parent.join(format!(".{name}.new-{process}"));
        let aside = parent.join(format!(".{name}.old-{process}"));
        fs::create_dir(&path).map_err(|error| CaptureError::write(&parent, error))?;
        Ok(Draft { path, target, aside })
    }

    /// Where to write.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives the folder its name; what had the name before is moved aside until then.
    ///
    /// # Errors
    /// A rename fails; the old folder is back in its place then.
    pub fn put_in_place(self) -> Result<(), CaptureError> {
        let fail = |error| CaptureError::write(&self.target, error);
        let replaces = self.target.exists();
        if replaces {
            fs::rename(&self.target, &self.aside).map_err(fail)?;
        }
        if let Err(error) = fs::rename(&self.path, &self.target) {
            if replaces {
                fs::rename(&self.aside, &self.target).map_err(fail)?;
            }
            return Err(fail(error));
        }
        if replaces {
            fs::remove_dir_all(&self.aside).map_err(|error| CaptureError::write(&self.aside, error))?;
        }
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // Gone already where it was put in place; where it can't be removed, nothing more can be done.
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// The folder that `folder` is in, and its name.
fn split(folder: &Path) -> Result<(PathBuf, String), CaptureError> {
    let name = folder.file_name().ok_or_else(|| CaptureError::NoName(folder.to_owned()))?;
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Ok((parent.to_owned(), name.to_string_lossy().into_owned()))
}
