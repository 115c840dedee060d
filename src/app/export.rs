//! Writes what the panels export, on a thread of its own: a large capture takes a while.

use super::news::{Tell, WindowNews};
use crate::capture::disk;
use crate::files::write_whole;
use crate::inspector::ExportData;
use crate::picture::Picture;
use std::path::{Path, PathBuf};

/// How an export ended.
#[derive(Debug)]
pub enum Exported {
    /// In words.
    Done(String),
    /// Something is there already.
    Taken(String),
    /// Why not, with the mend.
    Failed(String),
}

/// Writes `data` to `path`, and tells the window how that ended. What is there is replaced only where `replace`
/// says so. Scenes are the worker's to write.
pub fn start(data: ExportData, path: String, replace: bool, tell: Tell) -> std::io::Result<()> {
    let run = move || {
        let news = write(&data, &path, replace);
        tell(WindowNews::Exported(news));
    };
    std::thread::Builder::new().name("export".to_owned()).spawn(run).map(drop)
}

/// May something be written there?
pub fn check(path: &Path, replace: bool) -> Option<Exported> {
    if path.is_dir() {
        return Some(Exported::Failed(format!("{} is a folder: give the file a name", path.display())));
    }
    (path.exists() && !replace).then(|| Exported::Taken(path.display().to_string()))
}

fn write(data: &ExportData, path: &str, replace: bool) -> Exported {
    let file = PathBuf::from(path);
    if let ExportData::Capture(capture) = data {
        if !replace && disk::is_capture(&file) {
            return Exported::Taken(path.to_owned());
        }
        return match disk::write(capture, &file, replace) {
            Ok(_) => Exported::Done(format!("wrote the capture to {path}")),
            Err(error) => Exported::Failed(error.to_string()),
        };
    }
    if let Some(problem) = check(&file, replace) {
        return problem;
    }
    let failed = |error: &dyn std::fmt::Display| format!("{path} can't be written ({error}): choose another place");
    let png = |picture: &Picture| match picture.to_png() {
        Ok(png) => write_whole(&file, &png).map_err(|error| failed(&error)),
        Err(error) => Err(failed(&error)),
    };
    let written = match data {
        ExportData::Picture(picture) => png(picture),
        ExportData::AsShown(drawing) => png(&drawing.finish()),
        ExportData::Data(images) => disk::write_arrays(&file, images).map_err(|error| error.to_string()),
        ExportData::Capture(_) | ExportData::Scene(_) => Err("it is written elsewhere".to_owned()),
    };
    match written {
        Ok(()) => Exported::Done(format!("wrote {path}")),
        Err(reason) => Exported::Failed(reason),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Image, PixelFormat};
    use std::sync::Arc;

    #[test]
    fn a_taken_place_is_asked_about_and_replaced_only_where_that_is_wished() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png").display().to_string();
        let data = ExportData::Picture(Picture::filled([3, 2], [1, 2, 3]));
        assert!(matches!(write(&data, &path, false), Exported::Done(_)));
        assert!(matches!(write(&data, &path, false), Exported::Taken(_)));
        assert!(matches!(write(&data, &path, true), Exported::Done(_)));
        let is_png = std::fs::read(&path).expect("a file").starts_with(b"\x89PNG");
        assert!(is_png);
    }

    #[test]
    fn values_are_what_numpy_reads() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy").display().to_string();
        let image = Arc::new(Image::uniform(PixelFormat::U8, [3, 2], &[7]));
        assert!(matches!(write(&ExportData::Data(vec![image]), &path, false), Exported::Done(_)));
        let bytes = std::fs::read(&path).expect("a file");
        assert!(bytes.starts_with(b"\x93NUMPY") && bytes.ends_with(&[7; 6]));
    }

    #[test]
    fn a_place_that_can_not_be_written_to_is_told_with_the_mend() {
        let data = ExportData::Picture(Picture::filled([1, 1], [0; 3]));
        let answer = write(&data, "/no such folder/a.png", false);
        assert!(matches!(answer, Exported::Failed(reason) if reason.contains("choose another place")));
    }
}
