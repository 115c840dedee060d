//! Writes what the panels export, beside the window: a large capture takes a while.

use super::news::{Exported, Notify, WindowNews};
use super::task;
use crate::capture::disk::{self, FolderContents};
use crate::files::{exists, is_folder, write_whole};
use crate::inspector::{ExportData, KnownDiagnosis, whole_path};
use crate::page;
use crate::picture::Picture;
use crate::report::Report;
use crate::session::RunFrame;
use std::path::{Path, PathBuf};

/// The content of an export.
#[derive(Debug, Clone)]
pub enum ExportContent {
    /// A frame with its plan, as a capture folder.
    Frame(Box<RunFrame>),
    /// A frame with its plan, as a page for a browser.
    Page {
        /// The frame.
        run: Box<RunFrame>,
        /// What the page opens at.
        look: String,
        /// Why the frame is wrong, where that is known.
        diagnosis: Option<KnownDiagnosis>,
    },
    /// Data of the panels.
    Panels(ExportData),
}

/// Writes `data` to `path`, and reports to the window how that ended. An existing file is replaced only where `replace`
/// says so. Scenes are written by the worker.
pub fn start(data: ExportContent, path: String, replace: bool, notify: Notify) -> std::io::Result<()> {
    let run = async move || {
        let news = write(&data, &path, replace);
        notify(WindowNews::Exported(news));
    };
    task::start("export", run).map(drop)
}

/// Returns why nothing may be written to `path`: it is a folder (even with `replace`), its folder is none, or something
/// exists there and `replace` is false; `None` where writing is allowed.
pub fn check(path: &Path, replace: bool) -> Option<Exported> {
    if is_folder(path) {
        return Some(Exported::Failed(format!("{} is a folder: give the file a name", path.display())));
    }
    // A download is in no folder.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && cfg!(not(target_family = "wasm")));
    if let Some(folder) = folder.filter(|folder| !is_folder(folder)) {
        return Some(Exported::Failed(format!("there is no folder {}: choose another place", folder.display())));
    }
    // A download replaces nothing.
    let may_replace = replace || cfg!(target_family = "wasm");
    (exists(path) && !may_replace).then(|| Exported::Taken(path.display().to_string()))
}

fn write(data: &ExportContent, path: &str, replace: bool) -> Exported {
    match data {
        ExportContent::Frame(run) => write_folder(run.contents(), path, replace),
        ExportContent::Page { run, look, diagnosis } => write_page(run, look, diagnosis.as_ref(), path, replace),
        ExportContent::Panels(ExportData::Capture(capture)) => write_folder(capture.as_ref().into(), path, replace),
        ExportContent::Panels(data) => write_file(data, path, replace),
    }
}

fn write_folder(contents: FolderContents, path: &str, replace: bool) -> Exported {
    let folder = PathBuf::from(path);
    if let Some(taken) = taken_folder(&folder, replace) {
        return taken;
    }
    match disk::write(contents, &folder, replace) {
        Ok(_) => Exported::Done(format!("wrote the capture to {}", whole_path(&folder))),
        Err(error) => Exported::Failed(error.to_string()),
    }
}

fn write_page(run: &RunFrame, look: &str, diagnosis: Option<&KnownDiagnosis>, path: &str, replace: bool) -> Exported {
    let file = PathBuf::from(path);
    if let Some(problem) = check(&file, replace) {
        return problem;
    }
    let diagnosis = match diagnosis.map(KnownDiagnosis::to_json).transpose() {
        Ok(diagnosis) => diagnosis,
        Err(error) => return Exported::Failed(format!("the diagnosis can't be written ({error}): diagnose again")),
    };
    match page::write_at(&run.capture, &run.plan, look, diagnosis.as_deref(), &file) {
        Ok(_) => Exported::Done(format!("wrote {}: open it in a browser", whole_path(&file))),
        Err(error) => Exported::Failed(error.to_string()),
    }
}

fn write_file(data: &ExportData, path: &str, replace: bool) -> Exported {
    let file = PathBuf::from(path);
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
        ExportData::BothSides(both) => both.finish().map_err(|error| failed(&error)).and_then(|picture| png(&picture)),
        ExportData::Data(images) => disk::write_arrays(&file, images).map_err(|error| error.to_string()),
        ExportData::Report(report) => {
            report_bytes(report, &file).and_then(|bytes| write_whole(&file, &bytes).map_err(|error| failed(&error)))
        }
        ExportData::Diagnosis(diagnosis) => diagnosis_bytes(diagnosis, &file)
            .and_then(|bytes| write_whole(&file, &bytes).map_err(|error| failed(&error))),
        ExportData::Page { .. } => Err("this folder holds pictures alone: capture the scene again".to_owned()),
        ExportData::Capture(_) | ExportData::Scene(_) | ExportData::Film(_) => {
            Err("it is written elsewhere".to_owned())
        }
    };
    match written {
        Ok(()) => Exported::Done(format!("wrote {}", whole_path(&file))),
        Err(reason) => Exported::Failed(reason),
    }
}

/// Returns a report in the format of the file's extension, in any case: `csv`, `md` or `json` for the rows, `svg` or
/// `png` for the plot. Another extension, or none, is an error.
fn report_bytes(report: &Report, file: &Path) -> Result<Vec<u8>, String> {
    let ending = file.extension().unwrap_or_default().to_ascii_lowercase();
    let made = match ending.to_str() {
        Some("csv") => Ok(report.to_csv().into_bytes()),
        Some("md") => Ok(report.to_markdown().into_bytes()),
        Some("json") => report.to_json().map(String::into_bytes),
        Some("svg") => Ok(report.to_svg().into_bytes()),
        Some("png") => report.to_png(),
        _ => {
            let what = "rows are written as .csv, .md or .json, the plot as .svg or .png";
            return Err(format!("{what}: give the file's name one of these endings"));
        }
    };
    made.map_err(|error| error.to_string())
}

/// Returns a diagnosis in the format of the file's extension, in any case: `txt` or `json`. Another extension, or none, is an
/// error.
fn diagnosis_bytes(diagnosis: &KnownDiagnosis, file: &Path) -> Result<Vec<u8>, String> {
    let ending = file.extension().unwrap_or_default().to_ascii_lowercase();
    match ending.to_str() {
        Some("txt") => Ok(diagnosis.to_text().into_bytes()),
        Some("json") => diagnosis.to_json().map(String::into_bytes).map_err(|error| error.to_string()),
        _ => Err("a diagnosis is written as .txt or .json: give the file's name one of these endings".to_owned()),
    }
}

/// Returns why nothing may be written as `data` at a path, as far as that is known before anything is made; `None` where
/// writing may begin.
pub fn refused(data: &ExportContent, path: &str, replace: bool) -> Option<Exported> {
    match data {
        ExportContent::Frame(_) | ExportContent::Panels(ExportData::Capture(_)) => {
            taken_folder(Path::new(path), replace)
        }
        _ => check(Path::new(path), replace),
    }
}

/// Asks whether to replace a capture folder, where one is there and `replace` is false.
fn taken_folder(folder: &Path, replace: bool) -> Option<Exported> {
    let is_taken = !replace && cfg!(not(target_family = "wasm")) && disk::is_capture(folder);
    is_taken.then(|| Exported::Taken(folder.display().to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Image, PixelFormat};
    use crate::report::tests::{adapter, row};
    use std::sync::Arc;

    #[test]
    fn a_taken_place_is_asked_about_and_replaced_only_where_that_is_wished() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png").display().to_string();
        let data = ExportContent::Panels(ExportData::Picture(Picture::filled([3, 2], [1, 2, 3])));
        assert!(matches!(write(&data, &path, false), Exported::Done(_)));
        assert!(matches!(write(&data, &path, false), Exported::Taken(_)));
        assert!(matches!(write(&data, &path, true), Exported::Done(_)));
        let is_png = std::fs::read(&path).expect("a file").starts_with(b"\x89PNG");
        assert!(is_png);
    }

    #[test]
    fn a_place_in_no_folder_is_refused_before_anything_begins() {
        let folder = tempfile::tempdir().expect("a folder");
        let refused =
            |path: &Path| matches!(check(path, true), Some(Exported::Failed(why)) if why.contains("no folder"));
        assert!(refused(&folder.path().join("missing/a.png")));
        assert!(!refused(&folder.path().join("a.png")) && !refused(Path::new("a.png")));
    }

    #[test]
    fn a_page_needs_the_frame_and_not_pictures_alone() {
        let scene = crate::scene::open(&crate::scene::OpenSpec::new("tori")).expect("a scene");
        let choice = crate::technique::Choice::new(crate::technique::Technique::ZFail);
        let request = crate::session::CaptureRequest::new(choice, [32, 24]);
        let run = crate::session::Session::new(None).expect("a GPU").render(scene, request).expect("a frame");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.html").display().to_string();
        let look = "step=2&view=stencil&pixel=3,4".to_owned();
        let data = ExportData::Page { capture: Arc::clone(&run.capture), look: look.clone(), diagnosis: None };
        let alone = ExportContent::Panels(data);
        let answer = write(&alone, &path, false);
        assert!(matches!(answer, Exported::Failed(reason) if reason.contains("capture the scene again")));
        let page = ExportContent::Page { run: Box::new(run), look: look.clone(), diagnosis: None };
        assert!(matches!(write(&page, &path, false), Exported::Done(said) if said.contains("browser")));
        assert!(matches!(write(&page, &path, false), Exported::Taken(_)));
        let written = std::fs::read_to_string(&path).expect("a file");
        assert!(written.starts_with("<!doctype html>") && written.contains(&format!("\"opens\":\"{look}\"")));
    }

    #[test]
    fn what_was_written_is_named_with_its_folder() {
        let whole = whole_path(Path::new("a.png"));
        let folder = std::env::current_dir().expect("a folder").display().to_string();
        assert!(whole.starts_with(&folder) && whole.ends_with("a.png"), "{whole}");
    }

    #[test]
    fn values_are_what_numpy_reads() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy").display().to_string();
        let image = Arc::new(Image::uniform(PixelFormat::U8, [3, 2], &[7]));
        assert!(matches!(
            write(&ExportContent::Panels(ExportData::Data(vec![image])), &path, false),
            Exported::Done(_)
        ));
        let bytes = std::fs::read(&path).expect("a file");
        assert!(bytes.starts_with(b"\x93NUMPY") && bytes.ends_with(&[7; 6]));
    }

    #[test]
    fn a_place_that_can_not_be_written_to_is_reported_with_the_fix() {
        let data = ExportContent::Panels(ExportData::Picture(Picture::filled([1, 1], [0; 3])));
        let answer = write(&data, "/no such folder/a.png", false);
        assert!(matches!(answer, Exported::Failed(reason) if reason.contains("choose another place")));
    }

    #[test]
    fn a_report_is_written_as_its_ending_says() {
        let folder = tempfile::tempdir().expect("a folder");
        let report = Report::new(adapter(), vec![row("tori", "z-fail", "", 3, 9.5)]);
        let written = |name: &str| {
            let path = folder.path().join(name).display().to_string();
            let data = ExportContent::Panels(ExportData::Report(Box::new(report.clone())));
            (write(&data, &path, false), std::fs::read(&path).unwrap_or_default())
        };
        let starts: [(&str, &[u8]); 5] = [
            ("r.csv", b"scene,technique"),
            ("r.MD", b"|"),
            ("r.json", b"{\n  \"schema\": 1"),
            ("r.svg", b"<svg"),
            ("r.png", b"\x89PNG"),
        ];
        for (name, start) in starts {
            let (answer, bytes) = written(name);
            assert!(matches!(answer, Exported::Done(_)), "{name}: {answer:?}");
            let head = String::from_utf8_lossy(&bytes[..bytes.len().min(40)]).into_owned();
            assert!(bytes.starts_with(start), "{name}: {head}");
        }
        for name in ["r", "r.txt"] {
            let (answer, bytes) = written(name);
            assert!(matches!(answer, Exported::Failed(reason) if reason.contains("endings")), "{name}");
            assert!(bytes.is_empty());
        }
    }
}
