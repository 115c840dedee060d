//! `stencilscope stress`: every technique driven until it breaks.

use super::options::{open_session, picture_size, technique_named};
use super::progress::with_bar;
use super::report_results::{is_png, page_file, plot_file};
use super::results::{self, ResultFormat, ResultTarget};
use super::{CliError, output};
use crate::progress::Progress;
use crate::report::PageOrigin;
use crate::scene::suggestion;
use crate::session::StressSteps;
use crate::shards::Shard;
use crate::stress::{StressCase, StressResults, cases, right_because};
use crate::technique::Technique;
use clap::Args;

#[derive(Debug, Args)]
pub struct StressArguments {
    /// Only this case; repeatable [default: all]
    #[arg(long, value_name = "NAME")]
    case: Vec<String>,
    /// List the cases, a line each, and run none
    #[arg(long, conflicts_with_all = ["case", "json", "markdown", "plot", "output"])]
    list: bool,
    /// Only these techniques; repeatable
    #[arg(short, long, value_name = "NAME")]
    technique: Vec<String>,
    /// Width and height of the picture
    #[arg(long, value_name = "WxH", value_parser = picture_size, default_value = "320x240")]
    size: [u32; 2],
    /// The K-th of N disjoint parts of the rows, for `report merge`
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// A part of the GPU's name; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Machine-readable, to a file or to standard output in place of the table: rows, and by their
    /// `case` and `entrant` a summary of each
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
    /// A Markdown table, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    markdown: Option<Option<String>>,
    /// A picture of error against each sweep's number (.svg or .png)
    #[arg(long, value_name = "FILE", value_parser = plot_file)]
    plot: Option<String>,
    /// A page in Markdown: this command, the machine, the plot, the table, and how to read it
    #[arg(short, long, value_name = "FILE.md", value_parser = page_file)]
    output: Option<String>,
}

/// Runs the stress cases and prints a table of the results, or writes the files that are asked for; with `--list`, only
/// lists the cases. `command` is the command line to print in the page.
///
/// # Errors
/// A case or technique that does not exist; no GPU; a file that can't be written;
/// [`CliError::Unexpected`] where a technique did not do as expected.
pub fn run(arguments: &StressArguments, command: &str) -> Result<(), CliError> {
    if arguments.list {
        let line = |case: &StressCase| {
            format!("{:22}  {} values of {}: {}\n", case.name, case.values.len(), case.parameter, case.lesson)
        };
        return output::print(&cases::all().map(line).collect::<String>());
    }
    let named = |name: &String| StressCase::named(name).ok_or_else(|| unknown(name));
    let chosen = arguments.case.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    let chosen = if chosen.is_empty() { cases::all().collect() } else { chosen };
    let only = arguments.technique.iter().map(|name| technique_named(name)).collect::<Result<Vec<Technique>, _>>()?;
    let is_named = !arguments.case.is_empty();
    check_that_all_run(&chosen, is_named, &only)?;
    results::check(&[&arguments.json, &arguments.markdown, &results::target(&arguments.output)], &arguments.plot)?;
    let mut session = open_session(arguments.adapter.as_deref())?;
    let steps = StressSteps::new(&chosen, &only, arguments.size);
    let (steps, part) = match arguments.shard {
        None => (steps, None),
        Some(shard) => {
            let (steps, part) = steps.of(shard);
            (steps, Some(part))
        }
    };
    let rows = with_bar("stress", &Progress::default(), |progress| session.stress_rows(steps, progress))?;
    let stress = StressResults { adapter: session.adapter().clone(), size: arguments.size, rows, part };
    let page = results::target(&arguments.output);
    let forms = [&arguments.json, &arguments.markdown, &page];
    deliver(&stress, command, forms, &arguments.output, &arguments.plot)
}

/// Fails where a technique of `only` runs in none of the chosen cases, or, if cases were named (`is_named`), where a
/// chosen case runs none of `only`: a run that compares nothing is no success. An empty `only` passes.
fn check_that_all_run(chosen: &[&StressCase], is_named: bool, only: &[Technique]) -> Result<(), CliError> {
    let runs = |case: &StressCase, technique| case.entrants().iter().any(|entrant| entrant.technique == technique);
    if let Some(technique) = only.iter().find(|technique| !chosen.iter().any(|case| runs(case, **technique))) {
        return Err(runs_nowhere(chosen, is_named, *technique));
    }
    let is_idle = |case: &&&StressCase| !only.iter().any(|technique| runs(case, *technique));
    match (chosen.iter().find(is_idle), only) {
        (Some(case), [technique, ..]) if is_named => Err(runs_nowhere(&[*case], true, *technique)),
        _ => Ok(()),
    }
}

fn runs_nowhere(chosen: &[&StressCase], is_named: bool, technique: Technique) -> CliError {
    let name = technique.name();
    let reason = |case: &&StressCase| {
        let (_, because) = case.without.iter().find(|(without, _)| *without == technique)?;
        Some(format!("`{name}` does not run in `{}`, as {because}: choose another technique or case", case.name))
    };
    let of_case = chosen.iter().filter(|_| is_named).find_map(reason);
    CliError::Usage(of_case.unwrap_or_else(|| {
        format!("`{name}` runs in no stress case, as {}: choose another technique", right_because(technique))
    }))
}

/// Writes the plot, and JSON, Markdown and the page where asked for, else prints the table. Then fails where a case's
/// result is not the expected one.
pub fn deliver(
    stress: &StressResults,
    command: &str,
    [json, markdown, page]: [&ResultTarget; 3],
    page_file: &Option<String>,
    plot: &Option<String>,
) -> Result<(), CliError> {
    if let Some(file) = plot {
        let plot = stress.to_plot();
        let bytes = if is_png(file) { plot.to_png()? } else { plot.to_svg().into_bytes() };
        output::write(file, &bytes)?;
    }
    let failed = |error: serde_json::Error| CliError::Output { path: "the rows".to_owned(), source: error.into() };
    let plot = results::plot_beside(page_file, plot);
    let origin = PageOrigin { command, plot: plot.as_deref() };
    let forms: [ResultFormat; 3] = [
        (json, &|| stress.to_json().map_err(failed)),
        (markdown, &|| Ok(stress.to_markdown())),
        (page, &|| Ok(stress.to_page(origin))),
    ];
    results::deliver(&forms, || stress.to_table())?;
    let unexpected = stress
        .summary()
        .into_iter()
        .filter(|summary| summary.verdict == crate::stress::StressVerdict::Unexpected)
        .count();
    if unexpected > 0 { Err(CliError::Unexpected { count: unexpected }) } else { Ok(()) }
}

fn unknown(name: &str) -> CliError {
    let names: Vec<&str> = cases::all().map(|case| case.name).collect();
    let hint = suggestion(name, &names);
    CliError::Usage(format!("no stress case is called `{}`: {hint}", name.escape_debug()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(cases: &[&str], only: &[Technique]) -> Option<String> {
        let chosen: Vec<&StressCase> = match cases {
            [] => cases::all().collect(),
            names => names.iter().filter_map(|name| StressCase::named(name)).collect(),
        };
        let error = check_that_all_run(&chosen, !cases.is_empty(), only).err()?;
        assert_eq!(error.exit_code(), 2);
        Some(error.to_string())
    }

    #[test]
    fn what_runs_nothing_is_refused_with_the_reason() {
        let reason = |cases: &[&str], only: &[Technique]| refused(cases, only).expect("it runs nothing");
        let random = StressCase::named("random").expect("a case");
        let because = random.without.iter().find(|(without, _)| *without == Technique::ZPass).expect("a reason").1;
        let text = reason(&["random"], &[Technique::ZPass]);
        assert!(text.contains("`z-pass` does not run in `random`") && text.contains(because), "{text}");
        let text = reason(&["sliver"], &[Technique::RayTraced]);
        assert!(text.contains("`ray-traced` runs in no stress case, as it is the truth"), "{text}");
        assert!(reason(&[], &[Technique::None]).contains("`none` runs in no stress case"));
        // That other techniques run does not make up for it.
        assert!(reason(&["random"], &[Technique::ZFail, Technique::ZPass]).contains("z-pass"));
        assert!(reason(&["nested", "random"], &[Technique::ZPass]).contains("`random`"));
    }

    #[test]
    fn what_runs_somewhere_is_not() {
        assert_eq!(refused(&["sliver"], &[]), None);
        assert_eq!(refused(&["nested", "random"], &[Technique::ZPass, Technique::ZFail]), None);
        assert_eq!(refused(&[], &[Technique::ZPass]), None, "cases that are not named may be without it");
    }
}
