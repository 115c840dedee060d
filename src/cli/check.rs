//! `stencilscope check`: whether this machine's adapter draws as it should.

use super::options::open_session;
use super::progress::with_bar;
use super::{CliError, output};
use crate::check::{CheckReference, CheckReferenceError};
use crate::progress::Progress;
use crate::scene::builtin::{self, Builtin};
use crate::scene::suggestion;
use clap::Args;
use std::path::Path;

/// The largest size of a reference, bytes; larger files are refused.
const LARGEST_REFERENCE: u64 = 16 << 20;

#[derive(Debug, Args)]
pub struct CheckArguments {
    /// A part of the GPU's name; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Only this built-in scene; repeatable [default: all]
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// Machine-readable, to a file or to standard output in place of the text
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
    /// What to compare with, in place of what comes with the program
    #[arg(long, value_name = "FILE", hide = true)]
    reference: Option<String>,
    /// Write what this adapter draws to a file, for others to be compared with, and compare it with nothing
    #[arg(long, value_name = "FILE", hide = true, conflicts_with_all = ["json", "reference"])]
    write_reference: Option<String>,
}

/// Runs the command `check`: prints how the adapter draws, or writes JSON.
///
/// # Errors
/// A scene that does not exist; no GPU; a reference that can't be read; a file that can't be written;
/// [`CliError::Unexplained`] where something is not as it should be and no known cause explains it.
pub fn run(arguments: &CheckArguments) -> Result<(), CliError> {
    let named = |name: &String| Builtin::named(name).ok_or_else(|| unknown(name));
    let chosen = arguments.scene.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    let chosen = if chosen.is_empty() { builtin::ALL.iter().collect() } else { chosen };
    let json = arguments.json.as_ref().and_then(Option::as_deref);
    let files = [json, arguments.write_reference.as_deref()];
    files.into_iter().flatten().try_for_each(output::check_target)?;
    let given = arguments.reference.as_deref().map(read).transpose()?;
    let mut session = open_session(arguments.adapter.as_deref())?;
    let reference = match (given, &arguments.write_reference) {
        (Some(given), _) => given,
        (None, Some(_)) => CheckReference::empty(session.adapter()),
        (None, None) => CheckReference::shipped().map_err(|error| refused("assets/check.json", &error))?,
    };
    let check = with_bar("check", &Progress::default(), |progress| session.check(&chosen, &reference, progress))?;
    let failed = |error: serde_json::Error| CliError::Output { path: "the check".to_owned(), source: error.into() };
    if let Some(file) = &arguments.write_reference {
        return output::write(file, CheckReference::of(&check).to_json().map_err(failed)?.as_bytes());
    }
    match &arguments.json {
        Some(_) => output::deliver(&check.to_json().map_err(failed)?, json)?,
        None => output::print(&check.to_text())?,
    }
    let unexplained = check.unexplained();
    if unexplained.is_none() { Ok(()) } else { Err(CliError::Unexplained { what: unexplained.in_words() }) }
}

fn read(file: &str) -> Result<CheckReference, CliError> {
    let unread = |why: String| CliError::Usage(format!("{}: {why}", file.escape_debug()));
    let bytes = crate::files::read_plain(Path::new(file), LARGEST_REFERENCE).map_err(|why| unread(why.to_string()))?;
    let text = String::from_utf8(bytes).map_err(|_| unread("it is no text: give a reference".to_owned()))?;
    CheckReference::from_json(&text).map_err(|error| refused(file, &error))
}

fn refused(file: &str, error: &CheckReferenceError) -> CliError {
    CliError::Usage(format!("{}: {error}", file.escape_debug()))
}

fn unknown(name: &str) -> CliError {
    let names: Vec<&str> = builtin::ALL.iter().map(|builtin| builtin.name).collect();
    let hint = suggestion(name, &names);
    CliError::Usage(format!("no built-in scene is called `{}`: {hint}", name.escape_debug()))
}
