//! clap's messages, in one line.

use super::{CliError, output};
use clap::error::ErrorKind;

/// Prints the text where the "error" is a request for help or the version; returns any other as a one-line usage error.
pub fn answer(error: &clap::Error) -> Result<(), CliError> {
    let text = error.render().to_string();
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => output::print(&text),
        _ => Err(CliError::Usage(one_line(&text))),
    }
}

/// Returns clap's message and its tips on one line, without `error: ` and the usage text, and with a hint at `--help`
/// at the end.
fn one_line(text: &str) -> String {
    let message = text.split("\nUsage:").next().unwrap_or(text);
    let message = message.split("\nFor more information").next().unwrap_or(message);
    let words: Vec<&str> = message.split_whitespace().collect();
    let line = words.join(" ");
    let line = line.strip_prefix("error: ").unwrap_or(&line).replace(" tip: ", "; ");
    format!("{line} (see `stencilscope --help`)")
}
