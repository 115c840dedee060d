//! Results on standard output or in a file. A reader that closes standard output is no error.

use super::CliError;
use crate::scene::Scene;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Writes `text` to standard output and flushes it; no newline is added. A closed pipe is [`CliError::ClosedOutput`].
pub fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = std::io::stdout().lock();
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    written.map_err(|source| match source.kind() {
        ErrorKind::BrokenPipe => CliError::ClosedOutput,
        _ => CliError::Output { path: "standard output".to_owned(), source },
    })
}

/// Fails, before long work, where `path` is a folder or its parent folder does not exist. A file that is there, and
/// permissions, are not checked.
pub fn check_target(path: &str) -> Result<(), CliError> {
    let path_of = Path::new(path);
    let folder = path_of.parent().filter(|folder| !folder.as_os_str().is_empty());
    let problem = if path_of.is_dir() {
        Some(ErrorKind::IsADirectory)
    } else if folder.is_some_and(|folder| !folder.is_dir()) {
        Some(ErrorKind::NotFound)
    } else {
        None
    };
    problem.map_or(Ok(()), |kind| Err(CliError::Output { path: path.to_owned(), source: kind.into() }))
}

/// Writes `text` to `file`, which is replaced if it is there; to standard output where `file` is `None`.
pub fn deliver(text: &str, file: Option<&str>) -> Result<(), CliError> {
    let Some(path) = file else { return print(text) };
    write(path, text.as_bytes())
}

/// Writes a file under another name beside its path and renames it, so that it is there as a whole or not at all.
pub fn write(path: &str, bytes: &[u8]) -> Result<(), CliError> {
    let failed = |source| CliError::Output { path: path.to_owned(), source };
    crate::files::write_whole(Path::new(path), bytes).map_err(failed)
}

/// Writes `text` to standard error: a remark that is not part of the result.
pub fn note(text: &str) {
    // Standard error may be closed; then nothing reads the note.
    let _ = writeln!(std::io::stderr(), "stencilscope: {text}");
}

/// Writes to standard error, in one line, what a scene's files ask for and no frame shows, if there is anything. `name` is
/// the scene as on the command line, `plan` the file where reasons are; without one the line says how to get it.
pub fn note_left_out(name: &str, scene: &Scene, plan: Option<&Path>) {
    let Some(line) = scene.unsupported_in_a_line() else { return };
    let reasons = match plan {
        Some(file) => format!("see {}", file.display()),
        None => "plan.txt of a capture says why".to_owned(),
    };
    note(&format!("{}: {line}; {reasons}", name.escape_debug()));
}
