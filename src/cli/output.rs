//! Results on standard output or in a file. A reader that goes away is no failure.

use super::CliError;
use std::io::{ErrorKind, Write};

/// Writes `text` to standard output.
///
/// # Errors
/// Nobody reads it, or it can't be written.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = std::io::stdout().lock();
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    written.map_err(|source| match source.kind() {
        ErrorKind::BrokenPipe => CliError::ClosedOutput,
        _ => CliError::Output { path: "standard output".to_owned(), source },
    })
}

/// Writes `text` to `file`, or to standard output where there is none.
///
/// # Errors
/// As [`print`]; the file can't be written.
pub fn deliver(text: &str, file: Option<&str>) -> Result<(), CliError> {
    let Some(path) = file else { return print(text) };
    std::fs::write(path, text).map_err(|source| CliError::Output { path: path.to_owned(), source })
}

/// Says something that is no result.
pub fn note(text: &str) {
    // Standard error may be closed; then nobody wants to know.
    let _ = writeln!(std::io::stderr(), "stencilscope: {text}");
}
