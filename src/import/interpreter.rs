//! The Python interpreter that has RenderDoc's module. A distribution installs the module for its own interpreter, and the
//! `python3` that a shell finds first is often another one.

use super::error::ImportError;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The usual name of a Python 3 interpreter on this system.
const PYTHON: &str = if cfg!(windows) { "python" } else { "python3" };
/// Where Debian and others have the interpreter of their own packages.
const OF_SYSTEM: &str = "/usr/bin/python3";
/// An interpreter that does not answer for so long is not waited for.
const PATIENCE: Duration = Duration::from_secs(20);

/// Returns the first interpreter that can load RenderDoc's module: of those named `python3` or `python3.N` in the folders
/// where programs are looked for, and the system's own.
///
/// # Errors
/// There is no interpreter, or none has the module.
pub fn with_module() -> Result<String, ImportError> {
    let candidates = candidates(&search_path());
    if let Some(found) = candidates.iter().find(|python| has_module(python)) {
        return Ok(found.display().to_string());
    }
    let tried: Vec<String> = candidates.iter().map(|python| format!("`{}`", python.display())).collect();
    Err(ImportError::NoModuleFound { tried: if tried.is_empty() { format!("`{PYTHON}`") } else { tried.join(", ") } })
}

/// Returns the folders where programs are looked for.
fn search_path() -> Vec<PathBuf> {
    std::env::var_os("PATH").map_or_else(Vec::new, |path| std::env::split_paths(&path).collect())
}

/// Returns the interpreters in these folders, each once: first those without a version in their name, then the newest; and
/// last the system's own.
fn candidates(folders: &[PathBuf]) -> Vec<PathBuf> {
    let plain = folders.iter().map(|folder| folder.join(PYTHON));
    let mut versioned: Vec<(u32, PathBuf)> = folders.iter().flat_map(|folder| versions_in(folder)).collect();
    versioned.sort_by_key(|(version, _)| std::cmp::Reverse(*version));
    let all = plain.chain(versioned.into_iter().map(|(_, path)| path)).chain(std::iter::once(PathBuf::from(OF_SYSTEM)));
    // One program may have several names, as where /bin is a link to /usr/bin.
    let mut known = BTreeSet::new();
    all.filter(|path| path.canonicalize().is_ok_and(|real| known.insert(real))).collect()
}

/// Returns the programs named `python3.N` in a folder, each with its N.
fn versions_in(folder: &Path) -> Vec<(u32, PathBuf)> {
    let version = |path: PathBuf| {
        let version = path.file_name()?.to_str()?.strip_prefix("python3.")?.parse().ok()?;
        Some((version, path))
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| version(entry.path())).collect()
}

/// Returns whether an interpreter loads the module. One that can't be started, or does not answer, has none.
fn has_module(python: &Path) -> bool {
    let mut command = Command::new(python);
    command.args(["-c", "import renderdoc"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let Ok(mut child) = command.spawn() else { return false };
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) => std::thread::sleep(Duration::from_millis(10)),
            Err(_) => break,
        }
    }
    // Whether it has ended meanwhile does not matter.
    drop(child.kill());
    drop(child.wait());
    false
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
        std::os::unix::fs::symlink(second.path().join("python3"), first.path().join("python3")).expect("a link");
        let found = candidates(&[first.path().to_owned(), second.path().to_owned(), "/nothing".into()]);
        let names = ["python3", "python3.10", "python3.9"].map(|name| first.path().join(name));
        assert_eq!(found[..3], names, "{found:?}");
        // The system's own, where it has one.
        assert!(found[3..].iter().all(|path| path == Path::new(OF_SYSTEM)), "{found:?}");
    }

    #[test]
    fn a_missing_module_is_named_with_its_package_and_where_it_was_looked_for() {
        let said = ImportError::NoModuleFound { tried: "`/bin/python3`".to_owned() }.to_string();
        for words in ["`/bin/python3`", "python3-renderdoc", "--python"] {
            assert!(said.contains(words), "{said}");
        }
    }
}
