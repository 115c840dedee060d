//! What clap has to say, in one line.

use super::{CliError, output};
use clap::error::ErrorKind;

/// Help and version are results; everything else is an error line that names the mend.
pub fn answer(error: &clap::Error) -> Result<(), CliError> {
    let text = error.render().to_string();
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => output::print(&text),
        _ => Err(CliError::Usage(one_line(&text))),
    }
}

/// The message and its tips, without the usage text below them.
fn one_line(text: &str) -> String {
    let message = text.split("\nUsage:").next().unwrap_or(text);
    let message = message.split("\nFor more information").next().unwrap_or(message);
    let words: Vec<&str> = message.split_whitespace().collect();
    let line = words.join(" ");
    let line = line.strip_prefix("error: ").unwrap_or(&line).replace(" tip: ", "; ");
    format!("{line} (see `stencilscope --help`)")
}
