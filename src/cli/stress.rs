//! `stencilscope stress`: every technique driven until it breaks.

use super::options::{picture_size, technique_named};
use super::progress::with_bar;
use super::{CliError, output};
use crate::progress::Progress;
use crate::scene::suggestion;
use crate::session::Session;
use crate::stress::{Case, Stress, cases};
use crate::technique::Technique;
use clap::Args;

#[derive(Debug, Args)]
pub struct StressArguments {
    /// Only this case; repeatable [default: all]
    #[arg(long, value_name = "NAME")]
    case: Vec<String>,
    /// List the cases, a line each, and run none
    #[arg(long, conflicts_with_all = ["case", "json"])]
    list: bool,
    /// Only these techniques; repeatable
    #[arg(short, long, value_name = "NAME")]
    technique: Vec<String>,
    /// Width and height of the picture
    #[arg(long, value_name = "WxH", value_parser = picture_size, default_value = "320x240")]
    size: [u32; 2],
    /// A part of the GPU's name; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Machine-readable, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
}

/// Runs the cases.
///
/// # Errors
/// A case or technique that does not exist; no GPU; a file that can't be written;
/// [`CliError::Unexpected`] where a technique did not do as expected.
pub fn run(arguments: &StressArguments) -> Result<(), CliError> {
    if arguments.list {
        let line = |case: &Case| {
            format!("{:22}  {} values of {}: {}\n", case.name, case.values.len(), case.parameter, case.lesson)
        };
        return output::print(&cases::all().map(line).collect::<String>());
    }
    let named = |name: &String| Case::named(name).ok_or_else(|| unknown(name));
    let chosen = arguments.case.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    let chosen = if chosen.is_empty() { cases::all().collect() } else { chosen };
    let only = arguments.technique.iter().map(|name| technique_named(name)).collect::<Result<Vec<Technique>, _>>()?;
    let file = arguments.json.as_ref().and_then(Option::as_deref);
    file.map_or(Ok(()), output::check_target)?;
    let mut session = Session::new(arguments.adapter.as_deref())?;
    let rows =
        with_bar("stress", &Progress::default(), |progress| session.stress(&chosen, &only, arguments.size, progress))?;
    let stress = Stress { adapter: session.adapter().clone(), size: arguments.size, rows };
    match &arguments.json {
        Some(_) => output::deliver(
            &stress
                .to_json()
                .map_err(|error| CliError::Output { path: "the rows".to_owned(), source: error.into() })?,
            file,
        )?,
        None => output::print(&stress.to_table())?,
    }
    let unexpected =
        stress.summary().into_iter().filter(|summary| summary.verdict == crate::stress::Verdict::Unexpected).count();
    if unexpected > 0 { Err(CliError::Unexpected { count: unexpected }) } else { Ok(()) }
}

fn unknown(name: &str) -> CliError {
    let names: Vec<&str> = cases::all().map(|case| case.name).collect();
    let hint = suggestion(name, &names);
    CliError::Usage(format!("no stress case is called `{}`: {hint}", name.escape_debug()))
}
