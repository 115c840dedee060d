//! Watches whether the files of the open scene change on disk.
//!
//! It reads their times every second: no system has to support watching, and a file that an editor replaces by another
//! is noticed too. Nothing is reported, and nothing drawn, unless one changed.

use crate::app::news::{Notify, WindowNews};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

/// How often the files are checked.
const EVERY: Duration = Duration::from_secs(1);

/// When a file was last written, and its size in bytes; `None` while it does not exist.
type FileStamp = Option<(SystemTime, u64)>;

/// Watches a list of files for changed times and sizes, once a second, on a thread that ends when the last clone is
/// dropped.
#[derive(Debug, Default, Clone)]
pub struct Watch {
    files: Arc<Mutex<Vec<(PathBuf, FileStamp)>>>,
}

impl Watch {
    /// Starts the thread, with an empty list of files; each change of a file is reported as `WindowNews::FileChanged`,
    /// at most one a second.
    pub fn start(notify: Notify) -> std::io::Result<Watch> {
        let watch = Watch::default();
        let files = Arc::clone(&watch.files);
        let look = move || {
            loop {
                std::thread::sleep(EVERY);
                if Arc::strong_count(&files) == 1 {
                    // The window is closed.
                    return;
                }
                let changed = files.lock().ok().and_then(|mut files| first_changed(&mut files));
                if let Some(file) = changed {
                    notify(WindowNews::FileChanged(file));
                }
            }
        };
        std::thread::Builder::new().name("file watch".to_owned()).spawn(look)?;
        Ok(watch)
    }

    /// Replaces the list of watched files. Only changes from now on are reported.
    pub fn look_at(&self, files: Vec<PathBuf>) {
        if let Ok(mut watched) = self.files.lock() {
            *watched = files.into_iter().map(|file| (file.clone(), stamp(&file))).collect();
        }
    }
}

fn stamp(file: &Path) -> FileStamp {
    let facts = std::fs::metadata(file).ok()?;
    Some((facts.modified().ok()?, facts.len()))
}

/// Returns the first file whose time or size differs from its stamp and that exists, and updates its stamp, so that
/// each change is reported once; other changed files wait for the next call. `None` where none changed: a file that is
/// deleted is not reported until it is back.
fn first_changed(files: &mut [(PathBuf, FileStamp)]) -> Option<String> {
    files.iter_mut().find_map(|(file, before)| {
        let now = stamp(file);
        // A file that is missing for a moment is being replaced.
        let has_changed = now.is_some() && now != *before;
        has_changed.then(|| {
            *before = now;
            file.display().to_string()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_reported_once_and_a_missing_file_is_no_change() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.obj");
        std::fs::write(&file, "v 0 0 0").expect("a file");
        let mut files = vec![(file.clone(), stamp(&file))];
        assert_eq!(first_changed(&mut files), None);
        std::fs::write(&file, "v 0 0 0\nv 1 0 0").expect("a file");
        assert_eq!(first_changed(&mut files), Some(file.display().to_string()));
        assert_eq!(first_changed(&mut files), None);
        std::fs::remove_file(&file).expect("it is there");
        assert_eq!(first_changed(&mut files), None);
        std::fs::write(&file, "v 0 0 0").expect("a file");
        assert_eq!(first_changed(&mut files), Some(file.display().to_string()));
    }
}
