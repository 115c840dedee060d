//! clap's messages, in one line.

use super::{CliError, output};
use clap::error::ErrorKind;

/// Prints help and version, which are results; returns everything else as an error line that says how to fix it.
pub fn answer(error: &clap::Error) -> Result<(), CliError> {
    let text = error.render().to_string();
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => output::print(&text),
        _ => Err(CliError::Usage(one_line(&text))),
    }
}

/// Returns the message and its tips, without the usage text below them.
fn one_line(text: &str) -> String {
    let message = text.split("\nUsage:").next().unwrap_or(text);
    let message = message.split("\nFor more information").next().unwrap_or(message);
    let words: Vec<&str> = message.split_whitespace().collect();
    let line = words.join(" ");
    let line = line.strip_prefix("error: ").unwrap_or(&line).replace(" tip: ", "; ");
    format!("{line} (see `stencilscope --help`)")
}
