//! The Python interpreter that has RenderDoc's module. A distribution installs the module for its own interpreter, and the
//! `python3` that a shell finds first is often another one.

use super::error::ImportError;
use super::process::{ProcessLimits, ReaderProcess};
use crate::progress::Progress;
use std::collections::BTreeSet;
use std::env::consts::EXE_SUFFIX;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The usual name of a Python 3 interpreter on this system.
const PYTHON: &str = if cfg!(windows) { "python" } else { "python3" };
/// Where Debian and others have the interpreter of their own packages.
const OF_SYSTEM: &str = "/usr/bin/python3";
/// What an interpreter is asked. A folder named `renderdoc` would be a module, too, of which nothing can be asked.
const PROBE: &str = "import renderdoc; renderdoc.OpenCaptureFile; print('done', renderdoc.GetVersionString())";
/// An interpreter has so much for its answer.
const LIMITS: ProcessLimits = ProcessLimits { time: Duration::from_secs(20), memory: 1 << 30 };

/// Returns the first interpreter that can load RenderDoc's module: of those named `python3` or `python3.N` in the folders
/// where programs are looked for, and the system's own.
///
/// # Errors
/// There is no interpreter, none has the module, or the work was cancelled.
pub fn with_module(progress: &Progress) -> Result<String, ImportError> {
    let candidates: Vec<String> =
        candidates(&search_path()).iter().map(|python| python.display().to_string()).collect();
    if candidates.is_empty() {
        let source = std::io::Error::from(std::io::ErrorKind::NotFound);
        return Err(ImportError::NoInterpreter { python: PYTHON.to_owned(), source });
    }
    for python in &candidates {
        // One that can't be started, or does not answer, has none.
        let has_module = ReaderProcess::start(python, &[["probe.py", PROBE]], &[], LIMITS)
            .is_ok_and(|mut run| run.finish(progress).is_ok());
        if progress.is_cancelled() {
            return Err(ImportError::Cancelled);
        }
        if has_module {
            return Ok(python.clone());
        }
    }
    let tried: Vec<String> = candidates.iter().map(|python| format!("`{python}`")).collect();
    Err(ImportError::NoModuleFound { tried: tried.join(", ") })
}

/// Returns the folders where programs are looked for.
fn search_path() -> Vec<PathBuf> {
    std::env::var_os("PATH").map_or_else(Vec::new, |path| std::env::split_paths(&path).collect())
}

/// Returns the interpreters in these folders, each once: first those without a version in their name, then the newest; and
/// last the system's own.
fn candidates(folders: &[PathBuf]) -> Vec<PathBuf> {
    let plain = folders.iter().map(|folder| folder.join(format!("{PYTHON}{EXE_SUFFIX}")));
    let mut versioned: Vec<(u32, PathBuf)> = folders.iter().flat_map(|folder| versions_in(folder)).collect();
    versioned.sort_by_key(|(version, _)| std::cmp::Reverse(*version));
    let all = plain.chain(versioned.into_iter().map(|(_, path)| path)).chain(std::iter::once(PathBuf::from(OF_SYSTEM)));
    // A folder may have several names, as where /bin is a link to /usr/bin. That a program is a link to another says nothing:
    // one in a virtual environment has other modules than what it links to.
    let mut known = BTreeSet::new();
    all.filter(|path| path.is_file())
        .filter(|path| {
            let folder = path.parent().and_then(|folder| folder.canonicalize().ok());
            known.insert((folder, path.file_name().map(ToOwned::to_owned)))
        })
        .collect()
}

/// Returns the programs named `python3.N` in a folder, each with its N.
fn versions_in(folder: &Path) -> Vec<(u32, PathBuf)> {
    let version = |path: PathBuf| {
        let version = path.file_name()?.to_str()?.strip_suffix(EXE_SUFFIX)?.strip_prefix("python3.")?.parse().ok()?;
        Some((version, path))
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| version(entry.path())).collect()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn interpreters_are_tried_once_and_in_an_order() {
        let [first, second] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        for (folder, name) in
            [(&first, "python3.9"), (&first, "python3.10"), (&second, "python3"), (&first, "python3.x")]
        {
            fs::write(folder.path().join(name), "").expect("written");
        }
        // A virtual environment: a link to an interpreter that has other modules.
        std::os::unix::fs::symlink(second.path().join("python3"), first.path().join("python3")).expect("a link");
        let other_name = first.path().join("itself");
        std::os::unix::fs::symlink(first.path(), &other_name).expect("a link");
        let found = candidates(&[first.path().to_owned(), other_name, second.path().to_owned(), "/nothing".into()]);
        let of = |folder: &tempfile::TempDir, name: &str| folder.path().join(name);
        let names = [of(&first, "python3"), of(&second, "python3"), of(&first, "python3.10"), of(&first, "python3.9")];
        assert_eq!(found[..4], names, "{found:?}");
        // The system's own, where it has one.
        assert!(found[4..].iter().all(|path| path == Path::new(OF_SYSTEM)), "{found:?}");
    }

    #[test]
    fn a_missing_module_is_named_with_its_package_and_where_it_was_looked_for() {
        let said = ImportError::NoModuleFound { tried: "`/bin/python3`".to_owned() }.to_string();
        for words in ["`/bin/python3`", "python3-renderdoc", "--python"] {
            assert!(said.contains(words), "{said}");
        }
    }
}
